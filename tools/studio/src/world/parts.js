// A world in the form of JSON, and how its parts are found, moved, turned, added and deleted.
//
// A form is never changed: each change makes a new one. Knows no page and no file.

import { WORLD_LIMITS } from '../page/words.js';

/** @typedef {[number, number]} Place x and y in cm, from the lower left corner of the floor */
/** @typedef {{x_cm: number, y_cm: number, heading: number}} Start */
/** @typedef {{points: Place[]}} Wall */
/** @typedef {{x_cm: number, y_cm: number, length_cm: number, width_cm: number, heading: number}} Box */
/** @typedef {{points: Place[], width_cm: number}} Line */
/** @typedef {{x_cm: number, y_cm: number, reach_cm: number}} Lamp */
/** @typedef {{x_cm: number, y_cm: number, reach_cm: number, rests: boolean}} Flag `rests`: the robot is to stand there */
/** @typedef {{x_cm: number, y_cm: number, radius_cm: number, edge_cm: number}} Ring dark, with a white edge */
/** @typedef {{x_cm: number, y_cm: number, heading: number, length_cm: number, width_cm: number, speed_cm_s: number, power_percent: number}} Rival */
/**
 * @typedef {object} World
 * @property {string} name
 * @property {Record<string, string>} labels in each language; of one that somebody has drawn, none
 * @property {number} width_cm
 * @property {number} height_cm
 * @property {boolean} has_border
 * @property {number} ambient_percent
 * @property {Start} start
 * @property {Wall[]} walls
 * @property {Box[]} boxes
 * @property {Line[]} lines
 * @property {Lamp[]} lamps
 * @property {Flag[]} flags to be taken in their order
 * @property {number} seconds for them; 0 is as long as it takes
 * @property {Ring[]} rings
 * @property {Rival[]} rivals to be pushed out of the rings
 */
/** @typedef {'walls' | 'boxes' | 'lines' | 'lamps' | 'flags' | 'rings' | 'rivals'} Kind of what can be added */
/** @typedef {{kind: Kind | 'floor' | 'start', index: number}} Part */

/** @type {readonly Kind[]} */
export const KINDS = ['walls', 'boxes', 'lines', 'lamps', 'flags', 'rings', 'rivals'];
/** @type {Part} */
export const FLOOR = { kind: 'floor', index: 0 };
/** @type {Part} */
export const START = { kind: 'start', index: 0 };
const LARGEST_CM = WORLD_LIMITS.cm;
const LEAST_FLOOR_CM = 20;
const ROBOT_CM = 9; // from its middle: where it is taken
const HANDLE_CM = 10; // from the front of a part to what turns it
const TURNED_TO = 5; // degrees
const SMALLEST_CM = 1; // of what is drawn
const TAP_CM = 3; // a finger that moves less has not moved
const ROUGH_CM = 1; // how far a line may be from the way of a finger

/**
 * The numbers of a kind of part: their key, and what they may be.
 * @type {Record<Part['kind'], [string, number, number][]>}
 */
export const NUMBERS = {
  floor: [['width_cm', LEAST_FLOOR_CM, LARGEST_CM], ['height_cm', LEAST_FLOOR_CM, LARGEST_CM], ['ambient_percent', 0, 100], ['seconds', 0, WORLD_LIMITS.seconds]],
  start: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['heading', -360, 360]],
  walls: [],
  boxes: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['length_cm', SMALLEST_CM, LARGEST_CM], ['width_cm', SMALLEST_CM, LARGEST_CM], ['heading', -360, 360]],
  lines: [['width_cm', 0.1, 100]],
  lamps: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['reach_cm', 1, LARGEST_CM]],
  flags: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['reach_cm', 1, LARGEST_CM]],
  rings: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['radius_cm', 5, LARGEST_CM], ['edge_cm', 0, 100]],
  rivals: [['x_cm', 0, LARGEST_CM], ['y_cm', 0, LARGEST_CM], ['heading', -360, 360], ['length_cm', 5, 50], ['width_cm', 5, 50], ['speed_cm_s', 1, 200], ['power_percent', 0, 100]],
};

/** What a kind of part is, or not: its key. @type {Partial<Record<Part['kind'], string>>} */
export const CHOICES = { floor: 'has_border', flags: 'rests' };

/** @param {World} world @returns {Part[]} all of its parts */
export function partsOf(world) {
  return [FLOOR, START, ...KINDS.flatMap((kind) => world[kind].map((_, index) => ({ kind, index })))];
}

/** @param {Part} one @param {Part} other */
export function isSame(one, other) {
  return one.kind === other.kind && one.index === other.index;
}

/** @param {World} world @param {Part} part @returns {any} what the part is in the form */
export function valueOf(world, part) {
  if (part.kind === 'floor') return world;
  return part.kind === 'start' ? world.start : world[part.kind][part.index];
}

/** @param {World} world @param {Part} part @param {any} value @returns {World} */
function withValue(world, part, value) {
  if (part.kind === 'floor') return value;
  if (part.kind === 'start') return { ...world, start: value };
  return { ...world, [part.kind]: world[part.kind].map((each, k) => (k === part.index ? value : each)) };
}

/** @param {Box} box @returns {Place[]} its corners */
export function cornersOf({ x_cm, y_cm, length_cm, width_cm, heading }) {
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([along = 0, across = 0]) =>
    turned([x_cm + (along * length_cm) / 2, y_cm + (across * width_cm) / 2], [x_cm, y_cm], heading));
}

/** @param {World} world @param {Part} part @returns {Place[]} what can be taken of a part */
export function pointsOf(world, part) {
  const value = valueOf(world, part);
  if (part.kind === 'floor') return [];
  return value.points ?? [[value.x_cm, value.y_cm]];
}

/**
 * Moves a part, or one of its points, but not off the floor.
 * @param {World} world
 * @param {Part} part
 * @param {number} right_cm
 * @param {number} up_cm
 * @param {number} [point] -1 for the whole part
 * @returns {World}
 */
export function moved(world, part, right_cm, up_cm, point = -1) {
  const points = pointsOf(world, part);
  const taken = point < 0 ? points : points.slice(point, point + 1);
  if (!taken.length) return world;
  const right = within(right_cm, taken.map(([x]) => x), world.width_cm);
  const up = within(up_cm, taken.map(([, y]) => y), world.height_cm);
  /** @param {Place} place @returns {Place} */
  const there = ([x, y]) => [neatOn(x + right, world.width_cm), neatOn(y + up, world.height_cm)];
  const value = valueOf(world, part);
  if (!value.points) {
    const [x_cm, y_cm] = there([value.x_cm, value.y_cm]);
    return withValue(world, part, { ...value, x_cm, y_cm });
  }
  const all = points.map((each, k) => (point < 0 || k === point ? there(each) : each));
  return withValue(world, part, { ...value, points: all });
}

/** A way that leaves none of `places` off the floor, if it was on it. @param {number} way @param {number[]} places @param {number} end */
function within(way, places, end) {
  const low = Math.min(0, -Math.min(...places)), high = Math.max(0, end - Math.max(...places));
  return Math.max(low, Math.min(high, way));
}

/** @param {World} world @param {Part} part @param {number} degrees @returns {World} */
export function turnedPart(world, part, degrees) {
  const value = valueOf(world, part);
  if ('heading' in value) return withValue(world, part, { ...value, heading: around(value.heading + degrees) });
  if (!value.points) return world;
  const middle = middleOf(value.points);
  /** @type {Place[]} */
  const points = value.points.map((/** @type {Place} */ each) => {
    const [x, y] = turned(each, middle, degrees);
    return [neat(x), neat(y)];
  });
  return points.every((each) => isOnFloor(each, world)) ? withValue(world, part, { ...value, points }) : world;
}

/** Where a part that has a front is taken to turn it: in front of it, or behind it at the edge. @param {World} world @param {Part} part @returns {Place | null} */
export function handleOf(world, part) {
  const { x_cm = 0, y_cm = 0, heading, length_cm = ROBOT_CM * 2 } = valueOf(world, part);
  if (heading === undefined) return null;
  const far = length_cm / 2 + HANDLE_CM;
  const [ahead, behind] = [far, -far].map((way) => turned([x_cm + way, y_cm], [x_cm, y_cm], heading));
  return ahead && behind && !isOnFloor(ahead, world) && isOnFloor(behind, world) ? behind : ahead ?? null;
}

/** A part whose handle was taken to a place. @param {World} world @param {Part} part @param {Place} from where its handle was @param {Place} to @returns {World} */
export function turnedBy(world, part, from, to) {
  const { x_cm, y_cm, heading } = valueOf(world, part);
  const [before, now] = [from, to].map(([x, y]) => (Math.atan2(y - y_cm, x - x_cm) * 180) / Math.PI);
  const wanted = Math.round((heading + (now ?? 0) - (before ?? 0)) / TURNED_TO) * TURNED_TO;
  return withValue(world, part, { ...valueOf(world, part), heading: around(wanted) });
}

/** @param {World} world @param {Part} part @returns {World} */
export function without(world, part) {
  const { kind, index } = part;
  if (kind === 'floor' || kind === 'start') return world;
  return { ...world, [kind]: world[kind].filter((_, k) => k !== index) };
}

/** Sets a number of a part; it becomes one that may be there. @param {World} world @param {Part} part @param {string} key @param {number} number @returns {World} */
export function withNumber(world, part, key, number) {
  const [, low = 0, high = 0] = NUMBERS[part.kind].find(([name]) => name === key) ?? [];
  if (!Number.isFinite(number)) return world;
  const most = key === 'x_cm' ? world.width_cm : key === 'y_cm' ? world.height_cm : high;
  const set = Math.max(low, Math.min(most, Math.round(number * 10) / 10));
  const changed = withValue(world, part, { ...valueOf(world, part), [key]: set });
  return moved(changed, START, ...toFloor(changed));
}

/** @param {World} world @param {Part} part @param {string} key @param {boolean} isSo @returns {World} */
export function withChoice(world, part, key, isSo) {
  return withValue(world, part, { ...valueOf(world, part), [key]: isSo });
}

/** How far the start has to go to be on the floor. @param {World} world @returns {Place} */
function toFloor({ start, width_cm, height_cm }) {
  return [Math.min(0, width_cm - start.x_cm), Math.min(0, height_cm - start.y_cm)];
}

/**
 * Adds what was drawn from one place to another: what a tap has drawn gets a usual size.
 * @param {World} world
 * @param {Kind} kind
 * @param {Place[]} way
 * @returns {World | null} null where there is no room for one more
 */
export function withDrawn(world, kind, way) {
  if (world[kind].length >= (kind === 'rivals' ? WORLD_LIMITS.rivals : WORLD_LIMITS.parts)) return null;
  const half = Math.min(20, neat(world.width_cm / 4));
  const places = way.map(([x, y]) => /** @type {Place} */ ([neat(x), neat(y)]));
  const from = places[0] ?? [neat(world.width_cm / 2), neat(world.height_cm / 2)];
  const to = places.at(-1) ?? from;
  const isTap = places.every(([x, y]) => Math.hypot(x - from[0], y - from[1]) < TAP_CM);
  const middle = Math.max(half, Math.min(world.width_cm - half, from[0]));
  /** @type {Place[]} */
  const across = isTap ? [[middle - half, from[1]], [middle + half, from[1]]] : [from, to];
  const [width_cm, height_cm] = isTap ? [20, 20]
    : [Math.max(SMALLEST_CM, neat(Math.abs(to[0] - from[0]))), Math.max(SMALLEST_CM, neat(Math.abs(to[1] - from[1])))];
  const part = {
    walls: () => ({ points: across }),
    lines: () => ({ points: isTap ? across : simple(places), width_cm: 2 }),
    lamps: () => ({ x_cm: from[0], y_cm: from[1], reach_cm: 100 }),
    flags: () => ({ x_cm: from[0], y_cm: from[1], reach_cm: 12, rests: false }),
    rings: () => ({ x_cm: from[0], y_cm: from[1], radius_cm: isTap ? 60 : Math.max(5, neat(Math.hypot(to[0] - from[0], to[1] - from[1]))), edge_cm: 4 }),
    rivals: () => ({ x_cm: from[0], y_cm: from[1], heading: 0, length_cm: 11, width_cm: 11, speed_cm_s: 40, power_percent: 50 }),
    boxes: () => ({ x_cm: neat((from[0] + to[0]) / 2), y_cm: neat((from[1] + to[1]) / 2), length_cm: width_cm, width_cm: height_cm, heading: 0 }),
  }[kind]();
  return { ...world, [kind]: [...world[kind], part] };
}

/** Adds a point after a chosen one, or the last. @param {World} world @param {Part} part @param {number} point @returns {{world: World, point: number} | null} */
export function withPoint(world, part, point) {
  const value = valueOf(world, part);
  if (!value?.points || value.points.length >= WORLD_LIMITS.points) return null;
  /** @type {Place[]} */
  const points = value.points;
  const at = point < 0 ? points.length - 1 : point;
  const here = /** @type {Place} */ (points[at]), next = points[at + 1], before = /** @type {Place} */ (points[at - 1] ?? here);
  /** @type {Place} */
  const added = next ? [(here[0] + next[0]) / 2, (here[1] + next[1]) / 2]
    : [here[0] + (here[0] - before[0]) / 2, here[1] + (here[1] - before[1]) / 2];
  /** @type {Place} */
  const place = [Math.max(0, Math.min(world.width_cm, neat(added[0]))), Math.max(0, Math.min(world.height_cm, neat(added[1])))];
  return { world: withValue(world, part, { ...value, points: points.toSpliced(at + 1, 0, place) }), point: at + 1 };
}

/**
 * Finds what is at a place: what lies above what is below.
 * @param {World} world
 * @param {Place} place
 * @param {number} reach_cm how far a finger may miss
 * @returns {Part | null}
 */
export function partAt(world, place, reach_cm) {
  /** @type {[Part, number][]} */
  const found = [];
  for (const part of partsOf(world)) {
    const value = valueOf(world, part);
    if (part.kind === 'floor') continue;
    else if (part.kind === 'rings') found.push([part, Math.abs(Math.hypot(value.x_cm - place[0], value.y_cm - place[1]) - value.radius_cm + value.edge_cm / 2) - value.edge_cm / 2]);
    else if (part.kind === 'boxes') found.push([part, outside(value, place)]);
    else if (value.points) found.push([part, fromWay(value.points, place) - (value.width_cm ?? 2) / 2]);
    else found.push([part, Math.hypot(value.x_cm - place[0], value.y_cm - place[1]) - (part.kind === 'start' ? ROBOT_CM : part.kind === 'rivals' ? value.width_cm / 2 : 4)]);
  }
  const near = found.map(([part, far]) => /** @type {[Part, number]} */ ([part, Math.max(0, far)])).filter(([, far]) => far <= reach_cm);
  near.sort(([one, near_cm], [other, far_cm]) => near_cm - far_cm || ORDER.indexOf(one.kind) - ORDER.indexOf(other.kind) || other.index - one.index);
  return near[0]?.[0] ?? null;
}

const ORDER = ['start', 'rivals', 'flags', 'lamps', 'walls', 'boxes', 'lines', 'rings'];

/** @param {Place[]} points @param {Place} place @param {number} reach_cm @returns {number} the point that is nearest, or -1 */
export function pointAt(points, place, reach_cm) {
  const far = points.map(([x, y]) => Math.hypot(x - place[0], y - place[1]));
  const least = Math.min(...far);
  return least <= reach_cm ? far.indexOf(least) : -1;
}

/** How far a place is outside of a box. @param {Box} box @param {Place} place */
function outside(box, place) {
  const [x, y] = turned(place, [box.x_cm, box.y_cm], -box.heading);
  const right = Math.abs(x - box.x_cm) - box.length_cm / 2, up = Math.abs(y - box.y_cm) - box.width_cm / 2;
  return Math.hypot(Math.max(0, right), Math.max(0, up));
}

/** @param {Place[]} points @param {Place} place */
function fromWay(points, place) {
  return Math.min(...points.slice(1).map((to, k) => fromSegment(/** @type {Place} */ (points[k]), to, place)));
}

/** @param {Place} from @param {Place} to @param {Place} place */
function fromSegment([x, y], [toX, toY], place) {
  const length = (toX - x) ** 2 + (toY - y) ** 2;
  const part = length ? Math.max(0, Math.min(1, ((place[0] - x) * (toX - x) + (place[1] - y) * (toY - y)) / length)) : 0;
  return Math.hypot(x + part * (toX - x) - place[0], y + part * (toY - y) - place[1]);
}

/** Leaves out the points of a finger's way that a line hardly needs. @param {Place[]} way @returns {Place[]} */
export function simple(way) {
  for (let rough = ROUGH_CM; ; rough *= 2) {
    const kept = new Set([0, way.length - 1]);
    const spans = [[0, way.length - 1]];
    for (let span = spans.pop(); span; span = spans.pop()) {
      const [first = 0, last = 0] = span;
      let far = rough, at = -1;
      for (let k = first + 1; k < last; k += 1) {
        const off = fromSegment(/** @type {Place} */ (way[first]), /** @type {Place} */ (way[last]), /** @type {Place} */ (way[k]));
        if (off > far) [far, at] = [off, k];
      }
      if (at >= 0) {
        kept.add(at);
        spans.push([first, at], [at, last]);
      }
    }
    if (kept.size <= WORLD_LIMITS.points) return way.filter((_, k) => kept.has(k));
  }
}

/** @param {Place[]} points @returns {Place} */
function middleOf(points) {
  const xs = points.map(([x]) => x), ys = points.map(([, y]) => y);
  return [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
}

/** @param {Place} place @param {Place} middle @param {number} degrees @returns {Place} */
function turned([x, y], [midX, midY], degrees) {
  const cos = Math.cos((degrees * Math.PI) / 180), sin = Math.sin((degrees * Math.PI) / 180);
  return [midX + (x - midX) * cos - (y - midY) * sin, midY + (x - midX) * sin + (y - midY) * cos];
}

/** @param {Place} place @param {World} world */
function isOnFloor([x, y], { width_cm, height_cm }) {
  return x >= 0 && y >= 0 && x <= width_cm && y <= height_cm;
}

/** @param {Place} place @param {World} world @returns {Place} the nearest on the floor */
export function onFloor([x, y], { width_cm, height_cm }) {
  return [Math.max(0, Math.min(width_cm, x)), Math.max(0, Math.min(height_cm, y))];
}

/** @param {number} degrees */
function around(degrees) {
  return Math.round((((((degrees + 180) % 360) + 360) % 360) - 180) * 10) / 10;
}

/** @param {number} cm */
function neat(cm) {
  return Math.round(cm * 10) / 10;
}

/** The same, but what is on the floor is not rounded off it. @param {number} cm @param {number} end */
function neatOn(cm, end) {
  const rounded = neat(cm);
  return rounded - end < SMALLEST_CM / 10 ? Math.min(end, rounded) : rounded;
}
