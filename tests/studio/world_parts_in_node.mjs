// node world_parts_in_node.mjs SOURCES MADE FIRST SEEDS: worlds through random histories of what is drawn, moved, turned, set and
// deleted. Says where a change is not the one that was asked for, or changes anything else. Prints the last world of each.

import { chanceOf, freshPage, replaceNavigator, words } from './page_in_node.mjs';

replaceNavigator({});
const page = freshPage();
const parts = await page.load('world/parts.js');
const { WORLDS, WORLD_LIMITS } = await page.load('page/words.js');
const { KINDS, FLOOR, START, NUMBERS, TOGGLE_KEYS } = parts;
const ABOVE = ['start', 'rivals', 'flags', 'lamps', 'walls', 'boxes', 'lines', 'rings']; // what lies above comes first
const NEAR = 0.11; // of what is rounded

const freeze = (value) => {
  if (value && typeof value === 'object') Object.values(Object.freeze(value)).forEach(freeze);
  return value;
};
const norm = (degrees) => (((degrees + 180) % 360) + 360) % 360 - 180;
const turned = ([x, y], [cx, cy], degrees) => {
  const [sin, cos] = [Math.sin, Math.cos].map((of) => of(degrees * Math.PI / 180));
  return [cx + (x - cx) * cos - (y - cy) * sin, cy + (x - cx) * sin + (y - cy) * cos];
};
const far = ([ax, ay], [bx, by]) => Math.hypot(ax - bx, ay - by);
/** How far a place is from a line, by its points one after the other. */
const fromPath = (points, place) => Math.min(...points.slice(1).map((end, k) => {
  const [from, length] = [points[k], far(points[k], end)];
  if (!length) return far(from, place);
  const along = ((place[0] - from[0]) * (end[0] - from[0]) + (place[1] - from[1]) * (end[1] - from[1])) / length;
  const share = Math.min(1, Math.max(0, along / length));
  return far([from[0] + share * (end[0] - from[0]), from[1] + share * (end[1] - from[1])], place);
}));

function history(seed) {
  const random = chanceOf(seed + 1), acted = [];
  const fail = (error) => { throw new Error(`seed ${seed}, after ${acted.slice(-8).join(', ')}: ${error}`); };
  const assertSame = (found, wanted, what) => { if (JSON.stringify(found) !== JSON.stringify(wanted)) fail(`${what}: ${JSON.stringify(found)} in place of ${JSON.stringify(wanted)}`); };
  const assertNear = (found, wanted, what, by = NEAR) => { if (!(Math.abs(found - wanted) <= by)) fail(`${what}: ${found} in place of ${wanted}`); };
  let world = structuredClone(random.of(WORLDS));
  if (random() < 0.2) { // one that is nearly full
    for (const kind of KINDS) while (world[kind].length < (kind === 'rivals' ? WORLD_LIMITS.rivals : WORLD_LIMITS.parts) - 1) world = parts.withDrawnPart(world, kind, [[10 + random.below(80), 10 + random.below(80)]]);
    world.lines[0].points = Array.from({ length: WORLD_LIMITS.points - random.below(2) }, (_, k) => [k % 100, 10 + k % 7]);
  }
  if (random() < 0.3) world.width_cm += 0.37; // as a file may have it
  world = freeze(world);
  const isOn = ([x, y], { width_cm, height_cm } = world) => x >= 0 && y >= 0 && x <= width_cm && y <= height_cm;
  const some = () => (random() < 0.3 ? random.of([FLOOR, FLOOR, START]) : random.of(parts.partsOf(world)));
  const somewhere = () => [random() * world.width_cm, random() * world.height_cm];
  /** All but this part is as before. */
  const checkOthers = (changed, part, but = []) => {
    for (const item of parts.partsOf(world)) if (item.kind !== 'floor' && !parts.isSamePart(item, part) && !but.includes(item.kind)) assertSame(parts.valueOf(changed, item), parts.valueOf(world, item), `another ${item.kind}`);
    if (part.kind !== 'floor') for (const key of ['width_cm', 'height_cm', 'ambient_percent', 'seconds', 'has_border', 'name']) assertSame(changed[key], world[key], key);
  };
  const actions = {
    move() {
      const part = some(), before = parts.pointsOf(world, part), index = before.length > 1 && random() < 0.5 ? random.below(before.length) : -1;
      const [right, up] = [random.below(120) - 60, random.of([0, random.below(120) - 60])];
      const changed = parts.withMovedPart(world, part, right, up, index);
      if (part === FLOOR) assertSame(changed, world, 'a floor that is moved');
      const after = parts.pointsOf(changed, part);
      checkOthers(changed, part);
      const moved = before.filter((_, k) => index < 0 || k === index);
      const reach = (offset, axis, end) => Math.max(Math.min(0, -Math.min(...moved.map((point) => point[axis]))), Math.min(Math.max(0, end - Math.max(...moved.map((point) => point[axis]))), offset));
      const way = [reach(right, 0, world.width_cm), reach(up, 1, world.height_cm)];
      after.forEach((point, k) => {
        const wanted = index < 0 || k === index ? [before[k][0] + way[0], before[k][1] + way[1]] : before[k];
        assertNear(far(point, wanted), 0, `point ${k} of ${part.kind}`, 0.15);
        if (isOn(before[k]) && !isOn(point)) fail(`a point of ${part.kind} is off the floor`);
      });
      return changed;
    },
    turn() {
      const part = some(), degrees = random.of([15, -15, 90, 370]), value = parts.valueOf(world, part), changed = parts.withTurnedPart(world, part, degrees);
      const after = parts.valueOf(changed, part);
      checkOthers(changed, part);
      if ('heading' in value) assertNear(norm(after.heading), norm(Math.round(norm(value.heading + degrees) * 10) / 10), 'the heading', 0.001);
      if ('heading' in value && (after.heading < -180 || after.heading > 180)) fail(`a heading of ${after.heading}`);
      if (!value.points) return changed;
      const [xs, ys] = [0, 1].map((axis) => value.points.map((point) => point[axis]));
      const middle = [xs, ys].map((all) => (Math.min(...all) + Math.max(...all)) / 2);
      const wanted = value.points.map((point) => turned(point, middle, degrees));
      const isRoomy = wanted.every((point) => isOn(point.map((cm) => Math.round(cm * 10) / 10)));
      after.points.forEach((point, k) => assertNear(far(point, isRoomy ? wanted[k] : value.points[k]), 0, 'a turned point', 0.15));
      return changed;
    },
    takeHandle() {
      const part = some(), handle = parts.turnHandleOf(world, part), value = parts.valueOf(world, part);
      assertSame(handle !== null, value.heading !== undefined, 'whether it has a handle');
      if (!handle) return world;
      const middle = [value.x_cm, value.y_cm], way = (value.length_cm ?? 18) / 2 + 10;
      const [ahead, behind] = [way, -way].map((cm) => turned([value.x_cm + cm, value.y_cm], middle, value.heading));
      assertNear(far(handle, isOn(ahead) || !isOn(behind) ? ahead : behind), 0, 'the handle', 0.001);
      const to = somewhere();
      if (far(to, middle) < 1) return world;
      const changed = parts.withTurnedHandle(world, part, handle, to), after = parts.valueOf(changed, part);
      checkOthers(changed, part);
      const angle = ([x, y]) => Math.atan2(y - middle[1], x - middle[0]) * 180 / Math.PI;
      assertSame(Math.abs(after.heading % 5), 0, 'a step of its heading');
      assertNear(norm(after.heading - value.heading - angle(to) + angle(handle)), 0, 'how far it is turned', 2.6);
      return changed;
    },
    delete() {
      const part = some(), changed = parts.withoutPart(world, part);
      const wanted = KINDS.includes(part.kind) ? { ...world, [part.kind]: world[part.kind].toSpliced(part.index, 1) } : world;
      assertSame(changed, wanted, 'what is left');
      return changed;
    },
    set() {
      const part = some();
      if (!NUMBERS[part.kind].length) return world;
      const [key, low, high] = random.of(part === FLOOR ? NUMBERS.floor.slice(0, 1 + random.below(4)) : NUMBERS[part.kind]), number = random.of([low - 1, high + 1, low, high, random() * 100, NaN, Infinity]);
      const changed = parts.withNumber(world, part, key, number);
      if (!Number.isFinite(number)) {
        assertSame(changed, world, 'what is no number');
        return changed;
      }
      const most = key === 'x_cm' ? world.width_cm : key === 'y_cm' ? world.height_cm : high;
      assertSame(parts.valueOf(changed, part)[key], Math.max(low, Math.min(most, Math.round(number * 10) / 10)), key);
      checkOthers(changed, part, part.kind === 'floor' ? ['start'] : []);
      if (part.kind === 'floor') assertSame([changed.start.x_cm <= changed.width_cm, changed.start.y_cm <= changed.height_cm], [true, true], 'a start off the floor');
      if (part.kind === 'floor') assertSame(changed.start, { ...world.start, x_cm: Math.min(world.start.x_cm, changed.width_cm), y_cm: Math.min(world.start.y_cm, changed.height_cm) }, 'the start');
      return changed;
    },
    toggle() {
      const [kind, key] = random.of(Object.entries(TOGGLE_KEYS)), part = parts.partsOf(world).findLast((item) => item.kind === kind), isOnNow = random() < 0.5;
      if (!part) return world;
      const changed = parts.withToggle(world, part, key, isOnNow);
      assertSame(parts.valueOf(changed, part)[key], isOnNow, key);
      checkOthers(changed, part);
      return changed;
    },
    draw() {
      const kind = random.of(KINDS), from = somewhere(), isTap = random() < 0.3, length = random.of([2, 10, 10, 300]), to = random.of([somewhere(), somewhere(), [from[0], somewhere()[1]], [somewhere()[0], from[1]]]);
      const track = isTap ? [from] : Array.from({ length }, (_, k) => [0, 1].map((axis) => from[axis] + (to[axis] - from[axis]) * k / (length - 1) + (k % (length - 1) ? random.of([0, 0, random() * 20 - 10]) : 0)).map((cm, axis) => Math.min([world.width_cm, world.height_cm][axis], Math.max(0, cm))));
      const isFull = world[kind].length >= (kind === 'rivals' ? WORLD_LIMITS.rivals : WORLD_LIMITS.parts);
      const changed = parts.withDrawnPart(world, kind, track);
      assertSame(changed === null, isFull, 'whether there is room');
      if (!changed) return world;
      assertSame(changed[kind].slice(0, -1), world[kind], 'those of before');
      const part = changed[kind].at(-1), [a, b] = [track[0], track.at(-1)];
      const isShort = track.every((point) => far(point, a) < 2.8), isLong = track.some((point) => far(point, a) > 3.2);
      if (part.points) {
        if (part.points.some((point) => !isOn([point[0] - 0.05, point[1] - 0.05]) && !isOn(point) && !isOn([point[0] - 0.05, point[1]]) && !isOn([point[0], point[1] - 0.05]))) fail(`${kind} is drawn off the floor`);
        if (part.points.length > WORLD_LIMITS.points) fail(`a line of ${part.points.length} points`);
        if (isLong) [[part.points[0], a], [part.points.at(-1), b]].forEach(([found, wanted]) => assertNear(far(found, wanted), 0, `an end of ${kind}`, 0.15));
        if (isLong && kind === 'lines' && length < 50) for (const point of track) if (fromPath(part.points, point) > 1.3) fail(`a line is ${fromPath(part.points, point)} cm off the way of the finger`);
        if (isShort) assertNear(far(part.points[0], part.points.at(-1)), Math.min(40, 2 * Math.round(world.width_cm * 2.5) / 10), 'the length of a tap');
      } else if (kind === 'boxes') {
        assertNear(far([part.x_cm, part.y_cm], isLong ? [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2] : a), 0, 'the middle of a box', 3);
        if (isLong) [[part.length_cm, a[0] - b[0]], [part.width_cm, a[1] - b[1]]].forEach(([found, wanted]) => assertNear(found, Math.max(1, Math.abs(wanted)), 'a side of a box', 0.2));
      } else assertNear(far([part.x_cm, part.y_cm], a), 0, `the place of ${kind}`, 0.15);
      if (kind === 'rings' && isLong) assertNear(part.radius_cm, Math.max(5, far(a, b)), 'the radius', 0.2);
      return changed;
    },
    grow() { // a point more
      const part = random() < 0.5 && world.lines.length ? { kind: 'lines', index: 0 } : some(), value = parts.valueOf(world, part), points = value.points ?? [], index = random.below(points.length + 1) - 1;
      const found = parts.withPoint(world, part, index);
      assertSame(found !== null, points.length > 0 && points.length < WORLD_LIMITS.points, 'whether it can have one more');
      if (!found) return world;
      checkOthers(found.world, part);
      const after = parts.pointsOf(found.world, part), at = index < 0 ? points.length - 1 : index;
      assertSame(found.pointIndex, at + 1, 'the place of the new one');
      assertSame(after.toSpliced(found.pointIndex, 1), points, 'those of before');
      const isBetween = points[at + 1] && isOn(points[at]) && isOn(points[at + 1]); // a floor may have become smaller
      if (isBetween) assertNear(fromPath([points[at], points[at + 1]], after[found.pointIndex]), 0, 'the new one', 0.1);
      if (isBetween) assertNear(far(points[at], after[found.pointIndex]), far(points[at + 1], after[found.pointIndex]), 'its place between both', 0.2);
      if (!isOn(after[found.pointIndex].map((cm) => cm - 0.05)) && !isOn(after[found.pointIndex])) fail('the new one is off the floor');
      return found.world;
    },
    find() {
      const place = somewhere(), reach = random.of([0, 3, 10]);
      const distance = (part) => {
        const value = parts.valueOf(world, part), middle = [value.x_cm, value.y_cm];
        if (part.kind === 'rings') return Math.max(value.radius_cm - value.edge_cm - far(middle, place), far(middle, place) - value.radius_cm);
        if (part.kind === 'boxes') {
          const [x, y] = turned(place, middle, -value.heading);
          return Math.hypot(Math.max(0, Math.abs(x - middle[0]) - value.length_cm / 2), Math.max(0, Math.abs(y - middle[1]) - value.width_cm / 2));
        }
        if (value.points) return fromPath(value.points, place) - (value.width_cm ?? 2) / 2;
        return far(middle, place) - ({ start: 9, rivals: value.width_cm / 2 }[part.kind] ?? 4);
      };
      const all = parts.partsOf(world).filter((item) => item.kind !== 'floor').map((part) => [part, Math.max(0, distance(part))]).filter(([, cm]) => cm <= reach);
      const wanted = all.reduce((best, item) => {
        if (!best || item[1] < best[1] - 1e-9) return item;
        if (item[1] > best[1] + 1e-9) return best;
        const above = ABOVE.indexOf(item[0].kind) - ABOVE.indexOf(best[0].kind);
        return above < 0 || (!above && item[0].index > best[0].index) ? item : best;
      }, null);
      assertSame(parts.partAt(world, place, reach), wanted?.[0] ?? null, 'what is there');
      const points = parts.pointsOf(world, some());
      if (!points.length) return world;
      const found = parts.pointIndexAt(points, place, reach), least = Math.min(...points.map((point) => far(point, place)));
      if (found < 0 ? least <= reach - 1e-9 : far(points[found], place) > least + 1e-9 || least > reach) fail(`point ${found} is taken`);
      return world;
    },
  };
  for (let k = 0; k < 80; k += 1) {
    const act = random.of([...Object.keys(actions), 'draw', 'draw', 'draw']);
    acted.push(act);
    world = freeze(actions[act]());
    assertSame(parts.partsOf(world).length, 2 + KINDS.reduce((sum, kind) => sum + world[kind].length, 0), 'all of its parts');
  }
  assertSame([parts.valueOf(world, FLOOR) === world, parts.valueOf(world, START)], [true, world.start], 'the floor and the start');
  return world;
}

const [first, seeds] = words.map(Number);
for (let seed = first; seed < first + seeds; seed += 1) console.log(JSON.stringify(history(seed)));
process.exit(0);
