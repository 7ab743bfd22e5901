// A world in the form of JSON, and how its parts are found, moved, turned, added and deleted.
//
// A form is never changed: each change makes a new one. Knows no page and no file.

import { WORLD_LIMITS } from '../page/words.js';

/** @typedef {[number, number]} Point x and y in cm, from the lower left corner of the floor */
/** @typedef {{x_cm: number, y_cm: number, heading: number}} Start */
/** @typedef {{points: Point[]}} Wall */
/** @typedef {{x_cm: number, y_cm: number, length_cm: number, width_cm: number, heading: number}} Box */
/** @typedef {{points: Point[], width_cm: number}} Line */
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
/** @typedef {'walls' | 'boxes' | 'lines' | 'lamps' | 'flags' | 'rings' | 'rivals'} PartKind of what can be added */
/** @typedef {{kind: PartKind | 'floor' | 'start', index: number}} Part */

/** @type {readonly PartKind[]} */
export const KINDS = ['walls', 'boxes', 'lines', 'lamps', 'flags', 'rings', 'rivals'];
/** @type {Part} */
export const FLOOR = { kind: 'floor', index: 0 };
/** @type {Part} */
export const START = { kind: 'start', index: 0 };
const LARGEST_CM = WORLD_LIMITS.cm;
const MIN_FLOOR_CM = 20;
const ROBOT_RADIUS_CM = 9; // from its middle: where it is taken
const HANDLE_CM = 10; // from the front of a part to what turns it
const TURN_STEP_DEGREES = 5; // degrees
const SMALLEST_CM = 1; // of what is drawn
const TAP_CM = 3; // a finger that moves less has not moved
const LINE_TOLERANCE_CM = 1; // how far a line may be from the way of a finger

/**
 * The numbers of a kind of part: their key, and what they may be.
 * @type {Record<Part['kind'], [string, number, number][]>}
 */
export const NUMBERS = {
  floor: [['width_cm', MIN_FLOOR_CM, LARGEST_CM], ['height_cm', MIN_FLOOR_CM, LARGEST_CM], ['ambient_percent', 0, 100], ['seconds', 0, WORLD_LIMITS.seconds]],
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
export const TOGGLE_KEYS = { floor: 'has_border', flags: 'rests' };

/** @param {World} world @returns {Part[]} all of its parts */
export function partsOf(world) {
  return [FLOOR, START, ...KINDS.flatMap((kind) => world[kind].map((_, index) => ({ kind, index })))];
}

/** @param {Part} first @param {Part} second */
export function isSamePart(first, second) {
  return first.kind === second.kind && first.index === second.index;
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
  return { ...world, [part.kind]: world[part.kind].map((oldValue, index) => (index === part.index ? value : oldValue)) };
}

/** @param {Box} box @returns {Point[]} its corners */
export function cornersOf({ x_cm, y_cm, length_cm, width_cm, heading }) {
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([alongSign = 0, acrossSign = 0]) =>
    rotatePoint([x_cm + (alongSign * length_cm) / 2, y_cm + (acrossSign * width_cm) / 2], [x_cm, y_cm], heading));
}

/** @param {World} world @param {Part} part @returns {Point[]} what can be taken of a part */
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
 * @param {number} [pointIndex] -1 for the whole part
 * @returns {World}
 */
export function withMovedPart(world, part, right_cm, up_cm, pointIndex = -1) {
  const points = pointsOf(world, part);
  const movedPoints = pointIndex < 0 ? points : points.slice(pointIndex, pointIndex + 1);
  if (!movedPoints.length) return world;
  const offsetX_cm = offsetWithin(right_cm, movedPoints.map(([x]) => x), world.width_cm);
  const offsetY_cm = offsetWithin(up_cm, movedPoints.map(([, y]) => y), world.height_cm);
  /** @param {Point} place @returns {Point} */
  const shift = ([x, y]) => [roundOnFloor(x + offsetX_cm, world.width_cm), roundOnFloor(y + offsetY_cm, world.height_cm)];
  const value = valueOf(world, part);
  if (!value.points) {
    const [x_cm, y_cm] = shift([value.x_cm, value.y_cm]);
    return withValue(world, part, { ...value, x_cm, y_cm });
  }
  const newPoints = points.map((point, index) => (pointIndex < 0 || index === pointIndex ? shift(point) : point));
  return withValue(world, part, { ...value, points: newPoints });
}

/** A way that leaves none of `coordinates` off the floor, if it was on it. @param {number} offset @param {number[]} coordinates @param {number} end */
function offsetWithin(offset, coordinates, end) {
  const low = Math.min(0, -Math.min(...coordinates)), high = Math.max(0, end - Math.max(...coordinates));
  return Math.max(low, Math.min(high, offset));
}

/** @param {World} world @param {Part} part @param {number} degrees @returns {World} */
export function withTurnedPart(world, part, degrees) {
  const value = valueOf(world, part);
  if ('heading' in value) return withValue(world, part, { ...value, heading: normalizeAngle(value.heading + degrees) });
  if (!value.points) return world;
  const center = centerOf(value.points);
  /** @type {Point[]} */
  const points = value.points.map((/** @type {Point} */ point) => {
    const [x, y] = rotatePoint(point, center, degrees);
    return [roundCm(x), roundCm(y)];
  });
  return points.every((point) => isOnFloor(point, world)) ? withValue(world, part, { ...value, points }) : world;
}

/** Where a part that has a front is taken to turn it: in front of it, or behind it at the edge. @param {World} world @param {Part} part @returns {Point | null} */
export function turnHandleOf(world, part) {
  const { x_cm = 0, y_cm = 0, heading, length_cm = ROBOT_RADIUS_CM * 2 } = valueOf(world, part);
  if (heading === undefined) return null;
  const distance = length_cm / 2 + HANDLE_CM;
  const [ahead, behind] = [distance, -distance].map((offset) => rotatePoint([x_cm + offset, y_cm], [x_cm, y_cm], heading));
  return ahead && behind && !isOnFloor(ahead, world) && isOnFloor(behind, world) ? behind : ahead ?? null;
}

/** A part whose handle was taken to a place. @param {World} world @param {Part} part @param {Point} fromPoint where its handle was @param {Point} toPoint @returns {World} */
export function withTurnedHandle(world, part, fromPoint, toPoint) {
  const { x_cm, y_cm, heading } = valueOf(world, part);
  const [angleBefore, angleNow] = [fromPoint, toPoint].map(([x, y]) => (Math.atan2(y - y_cm, x - x_cm) * 180) / Math.PI);
  const newHeading = Math.round((heading + (angleNow ?? 0) - (angleBefore ?? 0)) / TURN_STEP_DEGREES) * TURN_STEP_DEGREES;
  return withValue(world, part, { ...valueOf(world, part), heading: normalizeAngle(newHeading) });
}

/** @param {World} world @param {Part} part @returns {World} */
export function withoutPart(world, part) {
  const { kind, index } = part;
  if (kind === 'floor' || kind === 'start') return world;
  return { ...world, [kind]: world[kind].filter((_, partIndex) => partIndex !== index) };
}

/** Sets a number of a part; it becomes one that may be there. @param {World} world @param {Part} part @param {string} key @param {number} number @returns {World} */
export function withNumber(world, part, key, number) {
  const [, low = 0, high = 0] = NUMBERS[part.kind].find(([name]) => name === key) ?? [];
  if (!Number.isFinite(number)) return world;
  const upperLimit = key === 'x_cm' ? world.width_cm : key === 'y_cm' ? world.height_cm : high;
  const newNumber = Math.max(low, Math.min(upperLimit, Math.round(number * 10) / 10));
  const changedWorld = withValue(world, part, { ...valueOf(world, part), [key]: newNumber });
  return withMovedPart(changedWorld, START, ...shiftToFloor(changedWorld));
}

/** @param {World} world @param {Part} part @param {string} key @param {boolean} isOn @returns {World} */
export function withToggle(world, part, key, isOn) {
  return withValue(world, part, { ...valueOf(world, part), [key]: isOn });
}

/** How far the start has to go to be on the floor. @param {World} world @returns {Point} */
function shiftToFloor({ start, width_cm, height_cm }) {
  return [Math.min(0, width_cm - start.x_cm), Math.min(0, height_cm - start.y_cm)];
}

/**
 * Adds what was drawn from one place to another: what a tap has drawn gets a usual size.
 * @param {World} world
 * @param {PartKind} kind
 * @param {Point[]} track
 * @returns {World | null} null where there is no room for one more
 */
export function withDrawnPart(world, kind, track) {
  if (world[kind].length >= (kind === 'rivals' ? WORLD_LIMITS.rivals : WORLD_LIMITS.parts)) return null;
  const halfLength = Math.min(20, roundCm(world.width_cm / 4));
  const points = track.map(([x, y]) => /** @type {Point} */ ([roundCm(x), roundCm(y)]));
  const firstPoint = points[0] ?? [roundCm(world.width_cm / 2), roundCm(world.height_cm / 2)];
  const lastPoint = points.at(-1) ?? firstPoint;
  const isTap = points.every(([x, y]) => Math.hypot(x - firstPoint[0], y - firstPoint[1]) < TAP_CM);
  const centerX = Math.max(halfLength, Math.min(world.width_cm - halfLength, firstPoint[0]));
  /** @type {Point[]} */
  const endPoints = isTap ? [[centerX - halfLength, firstPoint[1]], [centerX + halfLength, firstPoint[1]]] : [firstPoint, lastPoint];
  const [width_cm, height_cm] = isTap ? [20, 20]
    : [Math.max(SMALLEST_CM, roundCm(Math.abs(lastPoint[0] - firstPoint[0]))), Math.max(SMALLEST_CM, roundCm(Math.abs(lastPoint[1] - firstPoint[1])))];
  const part = {
    walls: () => ({ points: endPoints }),
    lines: () => ({ points: isTap ? endPoints : simplifyTrack(points), width_cm: 2 }),
    lamps: () => ({ x_cm: firstPoint[0], y_cm: firstPoint[1], reach_cm: 100 }),
    flags: () => ({ x_cm: firstPoint[0], y_cm: firstPoint[1], reach_cm: 12, rests: false }),
    rings: () => ({ x_cm: firstPoint[0], y_cm: firstPoint[1], radius_cm: isTap ? 60 : Math.max(5, roundCm(Math.hypot(lastPoint[0] - firstPoint[0], lastPoint[1] - firstPoint[1]))), edge_cm: 4 }),
    rivals: () => ({ x_cm: firstPoint[0], y_cm: firstPoint[1], heading: 0, length_cm: 11, width_cm: 11, speed_cm_s: 40, power_percent: 50 }),
    boxes: () => ({ x_cm: roundCm((firstPoint[0] + lastPoint[0]) / 2), y_cm: roundCm((firstPoint[1] + lastPoint[1]) / 2), length_cm: width_cm, width_cm: height_cm, heading: 0 }),
  }[kind]();
  return { ...world, [kind]: [...world[kind], part] };
}

/** Adds a point after a chosen one, or the last. @param {World} world @param {Part} part @param {number} pointIndex @returns {{world: World, pointIndex: number} | null} */
export function withPoint(world, part, pointIndex) {
  const value = valueOf(world, part);
  if (!value?.points || value.points.length >= WORLD_LIMITS.points) return null;
  /** @type {Point[]} */
  const points = value.points;
  const index = pointIndex < 0 ? points.length - 1 : pointIndex;
  const point = /** @type {Point} */ (points[index]), nextPoint = points[index + 1], previousPoint = /** @type {Point} */ (points[index - 1] ?? point);
  /** @type {Point} */
  const newPoint = nextPoint ? [(point[0] + nextPoint[0]) / 2, (point[1] + nextPoint[1]) / 2]
    : [point[0] + (point[0] - previousPoint[0]) / 2, point[1] + (point[1] - previousPoint[1]) / 2];
  /** @type {Point} */
  const pointOnFloor = [Math.max(0, Math.min(world.width_cm, roundCm(newPoint[0]))), Math.max(0, Math.min(world.height_cm, roundCm(newPoint[1])))];
  return { world: withValue(world, part, { ...value, points: points.toSpliced(index + 1, 0, pointOnFloor) }), pointIndex: index + 1 };
}

/**
 * Finds what is at a place: what lies above what is below.
 * @param {World} world
 * @param {Point} point
 * @param {number} reach_cm how far a finger may miss
 * @returns {Part | null}
 */
export function partAt(world, point, reach_cm) {
  /** @type {[Part, number][]} */
  const distances = [];
  for (const part of partsOf(world)) {
    const value = valueOf(world, part);
    if (part.kind === 'floor') continue;
    else if (part.kind === 'rings') distances.push([part, Math.abs(Math.hypot(value.x_cm - point[0], value.y_cm - point[1]) - value.radius_cm + value.edge_cm / 2) - value.edge_cm / 2]);
    else if (part.kind === 'boxes') distances.push([part, distanceFromBox(value, point)]);
    else if (value.points) distances.push([part, distanceFromPath(value.points, point) - (value.width_cm ?? 2) / 2]);
    else distances.push([part, Math.hypot(value.x_cm - point[0], value.y_cm - point[1]) - (part.kind === 'start' ? ROBOT_RADIUS_CM : part.kind === 'rivals' ? value.width_cm / 2 : 4)]);
  }
  const nearParts = distances.map(([part, distance]) => /** @type {[Part, number]} */ ([part, Math.max(0, distance)])).filter(([, distance]) => distance <= reach_cm);
  nearParts.sort(([first, firstDistance], [second, secondDistance]) => firstDistance - secondDistance || KIND_ORDER.indexOf(first.kind) - KIND_ORDER.indexOf(second.kind) || second.index - first.index);
  return nearParts[0]?.[0] ?? null;
}

const KIND_ORDER = ['start', 'rivals', 'flags', 'lamps', 'walls', 'boxes', 'lines', 'rings'];

/** @param {Point[]} points @param {Point} point @param {number} reach_cm @returns {number} the point that is nearest, or -1 */
export function pointIndexAt(points, point, reach_cm) {
  const distances = points.map(([x, y]) => Math.hypot(x - point[0], y - point[1]));
  const leastDistance = Math.min(...distances);
  return leastDistance <= reach_cm ? distances.indexOf(leastDistance) : -1;
}

/** How far a place is outside of a box. @param {Box} box @param {Point} point */
function distanceFromBox(box, point) {
  const [x, y] = rotatePoint(point, [box.x_cm, box.y_cm], -box.heading);
  const excessX = Math.abs(x - box.x_cm) - box.length_cm / 2, excessY = Math.abs(y - box.y_cm) - box.width_cm / 2;
  return Math.hypot(Math.max(0, excessX), Math.max(0, excessY));
}

/** @param {Point[]} points @param {Point} point */
function distanceFromPath(points, point) {
  return Math.min(...points.slice(1).map((end, index) => distanceFromSegment(/** @type {Point} */ (points[index]), end, point)));
}

/** @param {Point} from @param {Point} to @param {Point} point */
function distanceFromSegment([x, y], [toX, toY], point) {
  const squaredLength = (toX - x) ** 2 + (toY - y) ** 2;
  const fraction = squaredLength ? Math.max(0, Math.min(1, ((point[0] - x) * (toX - x) + (point[1] - y) * (toY - y)) / squaredLength)) : 0;
  return Math.hypot(x + fraction * (toX - x) - point[0], y + fraction * (toY - y) - point[1]);
}

/** Leaves out the points of a finger's way that a line hardly needs. @param {Point[]} track @returns {Point[]} */
export function simplifyTrack(track) {
  for (let tolerance = LINE_TOLERANCE_CM; ; tolerance *= 2) {
    const keptIndexes = new Set([0, track.length - 1]);
    const spans = [[0, track.length - 1]];
    for (let span = spans.pop(); span; span = spans.pop()) {
      const [firstIndex = 0, lastIndex = 0] = span;
      let farthestDistance = tolerance, farthestIndex = -1;
      for (let index = firstIndex + 1; index < lastIndex; index += 1) {
        const distance = distanceFromSegment(/** @type {Point} */ (track[firstIndex]), /** @type {Point} */ (track[lastIndex]), /** @type {Point} */ (track[index]));
        if (distance > farthestDistance) [farthestDistance, farthestIndex] = [distance, index];
      }
      if (farthestIndex >= 0) {
        keptIndexes.add(farthestIndex);
        spans.push([firstIndex, farthestIndex], [farthestIndex, lastIndex]);
      }
    }
    if (keptIndexes.size <= WORLD_LIMITS.points) return track.filter((_, index) => keptIndexes.has(index));
  }
}

/** @param {Point[]} points @returns {Point} */
function centerOf(points) {
  const xs = points.map(([x]) => x), ys = points.map(([, y]) => y);
  return [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
}

/** @param {Point} place @param {Point} middle @param {number} degrees @returns {Point} */
function rotatePoint([x, y], [centerX, centerY], degrees) {
  const cos = Math.cos((degrees * Math.PI) / 180), sin = Math.sin((degrees * Math.PI) / 180);
  return [centerX + (x - centerX) * cos - (y - centerY) * sin, centerY + (x - centerX) * sin + (y - centerY) * cos];
}

/** @param {Point} place @param {World} world */
function isOnFloor([x, y], { width_cm, height_cm }) {
  return x >= 0 && y >= 0 && x <= width_cm && y <= height_cm;
}

/** @param {Point} place @param {World} world @returns {Point} the nearest on the floor */
export function clampToFloor([x, y], { width_cm, height_cm }) {
  return [Math.max(0, Math.min(width_cm, x)), Math.max(0, Math.min(height_cm, y))];
}

/** @param {number} degrees */
function normalizeAngle(degrees) {
  return Math.round((((((degrees + 180) % 360) + 360) % 360) - 180) * 10) / 10;
}

/** @param {number} cm */
function roundCm(cm) {
  return Math.round(cm * 10) / 10;
}

/** The same, but what is on the floor is not rounded off it. @param {number} cm @param {number} end */
function roundOnFloor(cm, end) {
  const rounded_cm = roundCm(cm);
  return rounded_cm - end < SMALLEST_CM / 10 ? Math.min(end, rounded_cm) : rounded_cm;
}
