// Small pictures of worlds and robots, for who chooses one.

import { makeSvg, makeElement } from './made.js';
import { COLOURS } from './own_robot.js';
import { pageState } from './page_state.js';
import { drawRobot } from '../virtual/robot_drawing.js';
import { cornersOf } from '../world/parts.js';

/** @import { World, Point } from '../world/parts.js' */

const WIDTH_PX = 96, HEIGHT_PX = 66; // pixels of a robot's picture
const VISIBLE_CM = 34; // that are seen of one

/** @param {World} world @returns {SVGElement} it from above */
export function makeWorldPicture(world) {
  const { width_cm, height_cm, start } = world;
  const borderColour = world.has_border ? '#6b4a2f' : '#c8d2dc';
  const floor = makeSvg('g', { transform: `translate(0 ${height_cm}) scale(1 -1)`, 'stroke-linecap': 'round', 'stroke-linejoin': 'round' },
    makeSvg('rect', { width: width_cm, height: height_cm, fill: '#fffdf6', stroke: borderColour, 'stroke-width': 5 }),
    ...world.rings.flatMap(({ x_cm, y_cm, radius_cm, edge_cm }) => [makeDisc(x_cm, y_cm, radius_cm + 2, '#8b97a3'), makeDisc(x_cm, y_cm, radius_cm, '#fff'), makeDisc(x_cm, y_cm, Math.max(0, radius_cm - edge_cm), '#3b434c')]),
    ...world.lamps.flatMap(({ x_cm, y_cm }) => [makeDisc(x_cm, y_cm, 20, '#ffe9a3'), makeDisc(x_cm, y_cm, 7, '#e08a1e')]),
    ...world.lines.map(({ points }) => makePolyline(points, 'none', '#20242a')),
    ...world.boxes.map((box) => makePolyline([...cornersOf(box), ...cornersOf(box).slice(0, 1)], '#c79a6b', '#6b4a2f')),
    ...world.walls.map(({ points }) => makePolyline(points, 'none', '#6b4a2f')),
    ...world.flags.map(({ x_cm: x, y_cm: y }) => makePolyline([[x, y - 6], [x, y + 20], [x + 18, y + 13], [x, y + 6]], '#ffd84d', '#0d6040')),
    ...world.rivals.map(({ x_cm, y_cm }) => makeDisc(x_cm, y_cm, 11, '#9a4fc0')),
    makeDisc(start.x_cm, start.y_cm, 11, '#2a9d6f'),
  );
  return makeSvg('svg', { viewBox: `-3 -3 ${width_cm + 6} ${height_cm + 6}`, 'aria-hidden': 'true' }, floor);
}

/** @param {typeof import('./words.js').ROBOTS[number]} robot @returns {HTMLCanvasElement} it from above */
export function makeRobotPicture(robot) {
  const picture = document.createElement('canvas');
  Object.assign(picture, { width: WIDTH_PX, height: HEIGHT_PX });
  const pen = picture.getContext('2d');
  const scale = WIDTH_PX / VISIBLE_CM;
  pen?.setTransform(scale, 0, 0, -scale, WIDTH_PX / 2 - 2 * scale, HEIGHT_PX / 2);
  if (pen) drawRobot(pen, robot, null, { rolled_cm: [0, 0], isBeeping: false, colours: COLOURS[pageState.ownRobot.value.colour] ?? COLOURS[0] });
  return picture;
}

/** @param {number} count @returns {SVGElement} so many blocks */
export function makeBlocksPicture(count) {
  const firstTop = 14 - 4.5 * count;
  return makeSvg('svg', { viewBox: '0 0 28 28', 'aria-hidden': 'true' }, ...['var(--said-blue)', '#c56a1b', '#2a9d6f'].slice(0, count)
    .map((fill, index) => makeSvg('path', { d: `M3 ${firstTop + 9 * index}h5q1 2.500 3 2.500t3-2.500h11v8H14q-1 2.500-3 2.500t-3-2.500H3z`, fill })));
}

/** @param {number} share of what it can show @returns {SVGElement} a dial */
export function makeDialPicture(share) {
  const angle = Math.PI * share;
  const handPath = `M14 19L${14 - 9 * Math.cos(angle)} ${19 - 9 * Math.sin(angle)}`;
  return makeSvg('svg', { viewBox: '0 0 28 28', 'aria-hidden': 'true' },
    makeSvg('path', { d: `M3 21a11.500 11.500 0 1 1 22 0${handPath}`, fill: 'none', stroke: 'currentColor', 'stroke-width': 3, 'stroke-linecap': 'round' }));
}

/** @param {string} id of a drawing of the page @returns {SVGElement} it alone */
export function makeSymbolPicture(id) {
  return makeSvg('svg', { viewBox: '-30 -24 60 48', 'aria-hidden': 'true' }, makeSvg('use', { href: `#${id}` }));
}

/** An option with a picture, where the browser shows one. @param {string} label @param {string} value @param {Element} picture */
export function makePictureOption(label, value, picture) {
  const option = new Option('', value);
  option.append(picture, makeElement('span', '', label));
  return option;
}

/** Offers these instead of those before; what shows the chosen one stays. @param {HTMLSelectElement} select @param {HTMLOptionElement[]} options */
export function replaceOptions(select, options) {
  select.replaceChildren(...select.querySelectorAll('button'), ...options);
}

/** In a list of pictures an arrow key goes to the picture that is there, and not to the next one. */
export function listenToPictureKeys() {
  document.addEventListener('keydown', (event) => {
    const { target, key } = event, direction = { ArrowUp: [0, -1], ArrowDown: [0, 1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] }[key];
    if (!(target instanceof HTMLElement) || target.localName !== 'option' || !direction) return;
    const place = middleOf(target), [x = 0, y = 0] = direction;
    const distances = [...target.parentElement?.querySelectorAll('option') ?? []].map((option) => {
      const other = middleOf(option), along = (other.x - place.x) * x + (other.y - place.y) * y, beside = Math.abs((other.x - place.x) * y) + Math.abs((other.y - place.y) * x);
      return /** @type {const} */ ([option, along > 1 && beside < target.offsetWidth / 2 ? along : Infinity]);
    });
    const [nearest, distance] = distances.reduce((best, next) => (next[1] < best[1] ? next : best));
    event.preventDefault();
    if (distance < Infinity) nearest.focus();
  });
}

/** @param {HTMLElement} part */
function middleOf(part) {
  const { x, y, width, height } = part.getBoundingClientRect();
  return { x: x + width / 2, y: y + height / 2 };
}

/** @param {number} cx @param {number} cy @param {number} r @param {string} fill */
function makeDisc(cx, cy, r, fill) {
  return makeSvg('circle', { cx, cy, r, fill });
}

/** @param {Point[]} points @param {string} fill @param {string} stroke */
function makePolyline(points, fill, stroke) {
  return makeSvg('polyline', { points: points.map((point) => point.join(' ')).join(' '), fill, stroke, 'stroke-width': 5 });
}
