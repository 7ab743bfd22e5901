// Small pictures of worlds and robots, for who chooses one.

import { drawn, made } from './made.js';
import { COLOURS } from './own_robot.js';
import { pageState } from './page_state.js';
import { drawRobot } from '../virtual/robot_drawing.js';
import { cornersOf } from '../world/parts.js';

/** @import { World, Place } from '../world/parts.js' */

const WIDE = 96, HIGH = 66; // pixels of a robot's picture
const ROBOT_CM = 34; // that are seen of one

/** @param {World} world @returns {SVGElement} it from above */
export function worldPicture(world) {
  const { width_cm, height_cm, start } = world;
  const border = world.has_border ? '#6b4a2f' : '#c8d2dc';
  const floor = drawn('g', { transform: `translate(0 ${height_cm}) scale(1 -1)`, 'stroke-linecap': 'round', 'stroke-linejoin': 'round' },
    drawn('rect', { width: width_cm, height: height_cm, fill: '#fffdf6', stroke: border, 'stroke-width': 5 }),
    ...world.rings.flatMap(({ x_cm, y_cm, radius_cm, edge_cm }) => [disc(x_cm, y_cm, radius_cm + 2, '#8b97a3'), disc(x_cm, y_cm, radius_cm, '#fff'), disc(x_cm, y_cm, Math.max(0, radius_cm - edge_cm), '#3b434c')]),
    ...world.lamps.flatMap(({ x_cm, y_cm }) => [disc(x_cm, y_cm, 20, '#ffe9a3'), disc(x_cm, y_cm, 7, '#e08a1e')]),
    ...world.lines.map(({ points }) => row(points, 'none', '#20242a')),
    ...world.boxes.map((box) => row([...cornersOf(box), ...cornersOf(box).slice(0, 1)], '#c79a6b', '#6b4a2f')),
    ...world.walls.map(({ points }) => row(points, 'none', '#6b4a2f')),
    ...world.flags.map(({ x_cm: x, y_cm: y }) => row([[x, y - 6], [x, y + 20], [x + 18, y + 13], [x, y + 6]], '#ffd84d', '#0d6040')),
    ...world.rivals.map(({ x_cm, y_cm }) => disc(x_cm, y_cm, 11, '#9a4fc0')),
    disc(start.x_cm, start.y_cm, 11, '#2a9d6f'),
  );
  return drawn('svg', { viewBox: `-3 -3 ${width_cm + 6} ${height_cm + 6}`, 'aria-hidden': 'true' }, floor);
}

/** @param {typeof import('./words.js').ROBOTS[number]} robot @returns {HTMLCanvasElement} it from above */
export function robotPicture(robot) {
  const picture = document.createElement('canvas');
  Object.assign(picture, { width: WIDE, height: HIGH });
  const pen = picture.getContext('2d');
  const scale = WIDE / ROBOT_CM;
  pen?.setTransform(scale, 0, 0, -scale, WIDE / 2 - 2 * scale, HIGH / 2);
  if (pen) drawRobot(pen, robot, null, { rolled: [0, 0], isBeeping: false, colours: COLOURS[pageState.ownRobot.value.colour] ?? COLOURS[0] });
  return picture;
}

/** @param {number} count @returns {SVGElement} so many blocks */
export function blocksPicture(count) {
  const first = 14 - 4.5 * count;
  return drawn('svg', { viewBox: '0 0 28 28', 'aria-hidden': 'true' }, ...['var(--said-blue)', '#c56a1b', '#2a9d6f'].slice(0, count)
    .map((fill, k) => drawn('path', { d: `M3 ${first + 9 * k}h5q1 2.500 3 2.500t3-2.500h11v8H14q-1 2.500-3 2.500t-3-2.500H3z`, fill })));
}

/** @param {number} share of what it can show @returns {SVGElement} a dial */
export function dialPicture(share) {
  const angle = Math.PI * share;
  const hand = `M14 19L${14 - 9 * Math.cos(angle)} ${19 - 9 * Math.sin(angle)}`;
  return drawn('svg', { viewBox: '0 0 28 28', 'aria-hidden': 'true' },
    drawn('path', { d: `M3 21a11.500 11.500 0 1 1 22 0${hand}`, fill: 'none', stroke: 'currentColor', 'stroke-width': 3, 'stroke-linecap': 'round' }));
}

/** @param {string} id of a drawing of the page @returns {SVGElement} it alone */
export function drawnPicture(id) {
  return drawn('svg', { viewBox: '-30 -24 60 48', 'aria-hidden': 'true' }, drawn('use', { href: `#${id}` }));
}

/** An option with a picture, where the browser shows one. @param {string} label @param {string} value @param {Element} picture */
export function pictured(label, value, picture) {
  const option = new Option('', value);
  option.append(picture, made('span', '', label));
  return option;
}

/** Offers these instead of those before; what shows the chosen one stays. @param {HTMLSelectElement} choice @param {HTMLOptionElement[]} options */
export function offer(choice, options) {
  choice.replaceChildren(...choice.querySelectorAll('button'), ...options);
}

/** @param {number} cx @param {number} cy @param {number} r @param {string} fill */
function disc(cx, cy, r, fill) {
  return drawn('circle', { cx, cy, r, fill });
}

/** @param {Place[]} points @param {string} fill @param {string} stroke */
function row(points, fill, stroke) {
  return drawn('polyline', { points: points.map((each) => each.join(' ')).join(' '), fill, stroke, 'stroke-width': 5 });
}
