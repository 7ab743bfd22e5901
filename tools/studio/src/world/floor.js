// Draws the floor of a world: what stands, lies and shines there, and its flags.
//
// x and y are centimetres from its lower left corner. Knows no robot.

import { drawDot, drawPath } from '../page/shapes.js';
import { cornersOf } from './parts.js';

/** @typedef {import('../page/shapes.js').Pen} Pen */
/** @typedef {import('./parts.js').World} World */
/** @typedef {{x_cm: number, y_cm: number, is_flag: boolean, radius_cm?: number, around?: import('./parts.js').Point[]}} Goal */

const GRID_CM = 10; // while a world is changed
const TILE_CM = 25;
const LAWN_CM = 7; // around a house
const WALL_CM = 2, WALL_HEIGHT_CM = 7, BOX_HEIGHT_CM = 12;
const DASH_CM = 6; // of the white line in the middle of a street
const NIGHT_PERCENT = 5; // of light, at most, where it is night
const PAPER_COLOR = '#fffdf6', NIGHT_COLOR = '#27324b';
const TILE_COLORS = ['#fbeefc', '#e3f0fd', '#fff3cf'], LIT_TILE_COLORS = ['#f3b8f7', '#a9d3fb', '#ffe08a']; // as on the picture of a dance
/** What the floor of a world is. @type {Record<string, 'night' | 'tiles' | 'kitchen' | 'city' | 'ring'>} */
const THEMES = { dance: 'tiles', obstacles: 'kitchen', delivery: 'city', ring: 'ring', sumo: 'ring' };

/**
 * @param {Pen} pen
 * @param {World} world
 * @param {Goal[]} goals where a task leads; one without a radius is part of the world
 * @param {number} takenFlagCount flags
 * @param {boolean} isEdited now, by a finger
 */
export function drawWorld(pen, world, goals, takenFlagCount, isEdited) {
  drawTheme(pen, world);
  if (isEdited) drawGrid(pen, world);
  for (const goal of goals) drawGoal(pen, goal);
  world.flags.forEach((flag, index) => drawFlag(pen, flag, index - takenFlagCount, index + 1));
  for (const ring of world.rings) drawRing(pen, ring);
  for (const line of world.lines) drawPath(pen, line.points, '#20242a', line.width_cm);
  for (const { x_cm: x, y_cm: y } of world.lamps) {
    const radii = themeOf(world) === 'night' ? [46, 30, 17] : [];
    for (const radius of radii) drawDot(pen, x, y, radius, '#ffe9a324');
    drawDot(pen, x, y, 9, '#ffe9a3');
    drawDot(pen, x, y, 3, '#e08a1e');
  }
  for (const box of world.boxes) drawPath(pen, cornersOf(box), '#6b4a2f', 1, '#c79a6b');
  for (const wall of world.walls) drawPath(pen, wall.points, '#6b4a2f', WALL_CM);
  if (world.has_border) {
    pen.strokeStyle = '#6b4a2f';
    pen.lineWidth = WALL_CM;
    pen.strokeRect(0, 0, world.width_cm, world.height_cm);
  }
}

/**
 * Raises what stands on a floor that is seen from behind a robot: above the middle of the picture is far away.
 * @param {Pen} pen of the picture, in its pixels
 * @param {World} world
 * @param {DOMMatrix} floorToPicture from the floor, in centimetres, to the picture
 * @param {number} scale pixels of a centimetre
 */
export function drawSolids(pen, world, floorToPicture, scale) {
  const { width_cm: x, height_cm: y } = world;
  const rows = [...world.walls.map(({ points }) => points), ...world.has_border ? [[[0, 0], [x, 0], [x, y], [0, y], [0, 0]]] : []];
  const walls = rows.flatMap((points) => points.slice(1).map((to, k) => ({ corners: plankCorners(points[k] ?? to, to), high_cm: WALL_HEIGHT_CM, top: '#8a6544', side: '#6b4a2f' })));
  const boxes = world.boxes.map((box) => ({ corners: cornersOf(box), high_cm: BOX_HEIGHT_CM, top: '#c79a6b', side: '#9c7346' }));
  const solids = [...walls, ...boxes].map((each) => ({ ...each, base: each.corners.map(([floorX = 0, floorY = 0]) => floorToPicture.transformPoint({ x: floorX, y: floorY })) }));
  const lowestY = (/** @type {{y: number}[]} */ base) => Math.max(...base.map((each) => each.y));
  for (const { base, high_cm, top, side } of solids.sort((a, b) => lowestY(a.base) - lowestY(b.base))) {
    const height = high_cm * scale, edges = base.map((from, k) => /** @type {const} */ ([from, base[(k + 1) % base.length] ?? from]));
    for (const [from, to] of edges.sort(([a, b], [c, d]) => a.y + b.y - c.y - d.y)) {
      drawPath(pen, [[from.x, from.y], [to.x, to.y], [to.x, to.y - height], [from.x, from.y - height]], '#5a3d26', 1, side);
    }
    drawPath(pen, base.map((each) => [each.x, each.y - height]), '#5a3d26', 1, top);
  }
}

/** The corners of a wall as thick as it is drawn. @param {number[]} from @param {number[]} to */
function plankCorners([fromX = 0, fromY = 0], [toX = 0, toY = 0]) {
  const length_cm = Math.hypot(toX - fromX, toY - fromY) || 1;
  const x = (fromY - toY) / length_cm * WALL_CM / 2, y = (toX - fromX) / length_cm * WALL_CM / 2;
  return [[fromX + x, fromY + y], [toX + x, toY + y], [toX - x, toY - y], [fromX - x, fromY - y]];
}

/** @param {World} world */
function themeOf({ name, ambient_percent: light_percent }) {
  return light_percent <= NIGHT_PERCENT ? 'night' : THEMES[name];
}

/** @param {Pen} pen @param {World} world */
function drawTheme(pen, world) {
  const { width_cm: width, height_cm: height } = world, theme = themeOf(world);
  pen.fillStyle = theme === 'night' ? NIGHT_COLOR : theme === 'city' ? '#dfe2e6' : theme === 'ring' ? '#e9eef2' : PAPER_COLOR;
  pen.fillRect(0, 0, width, height);
  if (theme === 'tiles') {
    for (let x = 0; x < width; x += TILE_CM) for (let y = 0; y < height; y += TILE_CM) fillTile(pen, world, x, y, TILE_COLORS);
  }
  if (theme === 'kitchen') {
    for (let line_cm = TILE_CM; line_cm < Math.max(width, height); line_cm += TILE_CM) {
      if (line_cm < width) drawPath(pen, [[line_cm, 0], [line_cm, height]], '#efe6d2', 0.5);
      if (line_cm < height) drawPath(pen, [[0, line_cm], [width, line_cm]], '#efe6d2', 0.5);
    }
  }
  if (!theme) { // beside a robot that is followed, nothing else would move
    for (let x = TILE_CM; x < width; x += TILE_CM) for (let y = TILE_CM; y < height; y += TILE_CM) drawDot(pen, x, y, 0.9, '#e6dcc4');
  }
  if (theme === 'city') drawStreets(pen, world);
  if (theme === 'ring') for (const { points } of world.lines) drawPath(pen, points, 'transparent', 0, '#f6e3bd');
}

/** Lawns around the houses, and in the middle of each street a line. @param {Pen} pen @param {World} world */
function drawStreets(pen, { boxes, width_cm, height_cm }) {
  const lawns = boxes.map((box) => cornersOf({ ...box, length_cm: box.length_cm + 2 * LAWN_CM, width_cm: box.width_cm + 2 * LAWN_CM }));
  pen.setLineDash([DASH_CM, DASH_CM]);
  for (const x of gapMiddles(lawns.map((corners) => corners.map(([x]) => x)), width_cm)) drawPath(pen, [[x, 0], [x, height_cm]], '#fff', 1.2);
  for (const y of gapMiddles(lawns.map((corners) => corners.map(([, y]) => y)), height_cm)) drawPath(pen, [[0, y], [width_cm, y]], '#fff', 1.2);
  pen.setLineDash([]);
  for (const lawn of lawns) drawPath(pen, lawn, '#b7d3a6', 1, '#cfe3c2');
}

/** The middles of what lies between things, from one edge of the floor to the other. @param {number[][]} intervals the coordinates of each @param {number} floorSize of the floor */
function gapMiddles(intervals, floorSize) {
  const ranges = intervals.map((coordinates) => [Math.min(...coordinates), Math.max(...coordinates)]).sort(([a = 0], [b = 0]) => a - b);
  const middles = [];
  let coveredUntil = 0;
  for (const [low = 0, high = 0] of [...ranges, [floorSize, floorSize]]) {
    if (low > coveredUntil) middles.push((coveredUntil + low) / 2);
    coveredUntil = Math.max(coveredUntil, high);
  }
  return middles;
}

/** @param {Pen} pen @param {World} world @param {number} x @param {number} y @param {string[]} colors */
function fillTile(pen, { width_cm, height_cm }, x, y, colors) {
  const column = Math.floor(x / TILE_CM), row = Math.floor(y / TILE_CM);
  pen.fillStyle = colors[(column + 2 * row) % colors.length] ?? PAPER_COLOR;
  pen.fillRect(column * TILE_CM, row * TILE_CM, Math.min(TILE_CM, width_cm - column * TILE_CM), Math.min(TILE_CM, height_cm - row * TILE_CM));
}

/** Lights the tile under a robot, where the floor has such tiles. @param {Pen} pen @param {World} world @param {number} x @param {number} y */
export function drawLitTile(pen, world, x, y) {
  const isOnFloor = x > 0 && y > 0 && x < world.width_cm && y < world.height_cm;
  if (isOnFloor && THEMES[world.name] === 'tiles') fillTile(pen, world, x, y, LIT_TILE_COLORS);
}

/** @param {Pen} pen @param {World} world */
function drawGrid(pen, { width_cm, height_cm }) {
  for (let line_cm = GRID_CM; line_cm < Math.max(width_cm, height_cm); line_cm += GRID_CM) {
    const color = line_cm % (5 * GRID_CM) ? '#eee8d8' : '#d9cfb4';
    if (line_cm < width_cm) drawPath(pen, [[line_cm, 0], [line_cm, height_cm]], color, 0.4);
    if (line_cm < height_cm) drawPath(pen, [[0, line_cm], [width_cm, line_cm]], color, 0.4);
  }
}

/** @param {Pen} pen @param {import('./parts.js').Ring} ring */
function drawRing(pen, { x_cm: x, y_cm: y, radius_cm, edge_cm }) {
  drawDot(pen, x, y, radius_cm, '#fff');
  pen.strokeStyle = '#8b97a3';
  pen.lineWidth = 0.5;
  pen.stroke();
  drawDot(pen, x, y, Math.max(0, radius_cm - edge_cm), '#3b434c');
}

/** @param {Pen} pen @param {Goal} goal */
function drawGoal(pen, { x_cm: x, y_cm: y, is_flag, radius_cm, around }) {
  if (!around && !radius_cm) return; // a wall is seen as it is
  pen.setLineDash([4, 2.5]);
  if (around) drawPath(pen, around, '#0d6040', 0.8, 'transparent');
  else {
    drawDot(pen, x, y, Number(radius_cm), '#2a9d6f22');
    pen.strokeStyle = '#0d6040';
    pen.lineWidth = 0.8;
    pen.stroke();
  }
  pen.setLineDash([]);
  if (is_flag) drawCloth(pen, x, y, '#ffd84d');
}

/**
 * A flag of the world: taken, the next one, or one of those after it.
 * @param {Pen} pen
 * @param {import('./parts.js').Flag} flag
 * @param {number} offsetFromNext the next one, by so many flags
 * @param {number} number
 */
function drawFlag(pen, { x_cm: x, y_cm: y, reach_cm, rests }, offsetFromNext, number) {
  const isTaken = offsetFromNext < 0, isNext = offsetFromNext === 0;
  drawDot(pen, x, y, reach_cm, isTaken ? '#2a9d6f44' : isNext ? '#ffd84d77' : '#c8d2dc66');
  if (!isTaken) pen.setLineDash(rests ? [] : [4, 2.5]);
  pen.strokeStyle = isTaken || isNext ? '#0d6040' : '#66727e';
  pen.lineWidth = rests ? 1.4 : 0.8;
  pen.stroke();
  pen.setLineDash([]);
  if (isTaken) drawPath(pen, [[x - 5, y], [x - 1.5, y - 4], [x + 6, y + 5]], '#0d6040', 2.4);
  else {
    drawCloth(pen, x, y, isNext ? '#ffd84d' : '#fff');
    drawNumber(pen, x + 3.6, y + 9.6, String(number));
  }
}

/** @param {Pen} pen @param {number} x @param {number} y of its foot @param {string} color */
function drawCloth(pen, x, y, color) {
  drawPath(pen, [[x, y], [x, y + 14], [x + 11, y + 10], [x, y + 6]], '#0d6040', 1, color);
}

/** @param {Pen} pen @param {number} x @param {number} y its middle @param {string} number */
function drawNumber(pen, x, y, number) {
  pen.save();
  pen.translate(x, y);
  pen.scale(1, -1);
  pen.font = '700 6px system-ui, sans-serif';
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.fillStyle = '#123b63';
  pen.fillText(number, 0, 0);
  pen.restore();
}
