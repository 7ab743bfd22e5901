// Draws a robot from above: its wheels as far as they have turned, its lamps, what it senses and says.
//
// x is ahead of the middle between its wheels, y to its left. Knows no world.

import { dot, path } from '../page/shapes.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {typeof import('../page/words.js').ROBOTS[number]} Robot */
/** @typedef {import('../page/shapes.js').Pen} Pen */
/**
 * @typedef {object} Seen what a robot does that its state does not say
 * @property {[number, number]} rolled how far each wheel has turned, in cm
 * @property {boolean} isBeeping
 */

const CONE = (15 * Math.PI) / 180; // of an ultrasonic sensor, to both sides
const WHEEL = { length: 8, width: 3, tread: 1.6 };
const USUAL_CM = 9; // from the middle between its wheels to its back
const LOOK_CM = 14; // of a ray of light

/**
 * @param {Pen} pen at the robot, turned as it is
 * @param {Robot} robot
 * @param {RobotState | null} state null of a robot that is off
 * @param {Seen} seen
 */
export function drawRobot(pen, robot, state, seen) {
  if (state) drawSenses(pen, robot, state);
  actuatorsOf(robot).forEach((device, k) => {
    if (!device.is_yes_no && !carriesSensor(robot, device.text)) drawJaws(pen, robot, (state?.actuators[k] ?? 0) / (device.arguments[0]?.high || 1));
  });
  path(pen, robot.outline, '#0d4f38', 0.8, state?.fault ? '#c8372a' : '#2a9d6f');
  const side = robot.wheel_base_cm / 2, size = sizeOf(robot);
  drawWheel(pen, side, seen.rolled[0], size);
  drawWheel(pen, -side, seen.rolled[1], size);
  drawEyes(pen, robot, size);
  pen.save();
  pen.scale(size, size);
  path(pen, [[6, 0], [1.5, 2.6], [1.5, -2.6]], '#fff', 0.4, '#fff');
  drawLamps(pen, robot, state);
  drawBuzzer(pen, seen.isBeeping);
  pen.restore();
  if (state) drawFeelers(pen, robot, state);
}

/** How large what is on a robot is: on a short one it has less room. @param {Robot} robot */
function sizeOf(robot) {
  return Math.min(1, Math.max(...robot.outline.map(([x = 0]) => -x)) / USUAL_CM);
}

/**
 * Another body that drives, from above: its wheels at its sides, and where it looks.
 * @param {Pen} pen
 * @param {import('../world/parts.js').Rival} rival
 * @param {number[]} pose
 */
export function drawRival(pen, { length_cm, width_cm }, [x = 0, y = 0, heading = 0]) {
  const round = Math.min(length_cm, width_cm) / 2, half = length_cm / 2;
  pen.save();
  pen.translate(x, y);
  pen.rotate((heading * Math.PI) / 180);
  for (const side of [-1, 1]) {
    pen.fillStyle = '#20242a';
    pen.beginPath();
    pen.roundRect(-2.5, side * (width_cm / 2 - 0.6) - 1, 5, 2, 0.6);
    pen.fill();
  }
  pen.beginPath();
  pen.roundRect(-half, -width_cm / 2 + 0.8, length_cm, width_cm - 1.6, Math.min(round, width_cm / 2 - 0.8));
  pen.fillStyle = '#9a4fc0';
  pen.strokeStyle = '#5b2179';
  pen.lineWidth = 0.8;
  pen.fill();
  pen.stroke();
  for (const across of [-1.7, 1.7]) {
    dot(pen, half - 2.6, across, 1.3, '#fff');
    dot(pen, half - 2.1, across, 0.6, '#20242a');
  }
  pen.restore();
}

/** In the order of the state's. @param {Robot} robot */
function actuatorsOf(robot) {
  return robot.devices.filter((each) => each.role === 'actuator');
}

/** @param {Pen} pen @param {number} y @param {number} rolled @param {number} size */
function drawWheel(pen, y, rolled, size) {
  const length = WHEEL.length * size, width = WHEEL.width * size, { tread } = WHEEL;
  pen.fillStyle = '#20242a';
  pen.beginPath();
  pen.roundRect(-length / 2, y - width / 2, length, width, 1);
  pen.fill();
  // What is above of a wheel goes ahead, as the robot does.
  const first = (((rolled % tread) + tread) % tread) - length / 2;
  for (let x = first; x < length / 2 - 0.2; x += tread) {
    if (x > 0.2 - length / 2) path(pen, [[x, y - width / 2 + 0.5], [x, y + width / 2 - 0.5]], '#b9c2cb', 0.5);
  }
}

/** The two round ends of each ultrasonic sensor. @param {Pen} pen @param {Robot} robot @param {number} size */
function drawEyes(pen, robot, size) {
  for (const place of Object.values(robot.places)) {
    if (place.sees !== 'distance') continue;
    for (const across of [-1.9, 1.9]) {
      dot(pen, place.x_cm - 2.6 * size, place.y_cm + across * size, 1.7 * size, '#e9eef2');
      dot(pen, place.x_cm - 2.1 * size, place.y_cm + across * size, 0.9 * size, '#20242a');
    }
  }
}

/** Its own light, which is on where its button would start it, and those that a program turns on. @param {Pen} pen @param {Robot} robot @param {RobotState | null} state */
function drawLamps(pen, robot, state) {
  dot(pen, -7.5, 0, 0.9, state?.is_waiting ? '#ffd84d' : '#0d4f38');
  actuatorsOf(robot).forEach((device, k) => {
    if (!device.is_yes_no) return;
    const isLit = Boolean(state?.actuators[k]);
    if (isLit) dot(pen, -1.2, 0, 5, '#ffe14d77');
    dot(pen, -1.2, 0, 1.9, '#0d4f38');
    dot(pen, -1.2, 0, 1.4, isLit ? '#fff3a8' : '#7c8894');
  });
}

/** @param {Pen} pen @param {boolean} isBeeping */
function drawBuzzer(pen, isBeeping) {
  dot(pen, -4.6, 0, 1.5, '#20242a');
  dot(pen, -4.6, 0, 0.5, '#b9c2cb');
  if (!isBeeping) return;
  for (const radius of [4, 6.5, 9]) {
    for (const middle of [Math.PI / 2, -Math.PI / 2]) {
      pen.beginPath();
      pen.arc(-4.6, 0, radius, middle - 0.6, middle + 0.6);
      pen.strokeStyle = '#7a2fb8';
      pen.lineWidth = 0.9;
      pen.stroke();
    }
  }
}

/** @param {Robot} robot @param {string} actuator */
function carriesSensor(robot, actuator) {
  return Object.values(robot.places).some((place) => place.turns_with === actuator);
}

/** @param {Pen} pen @param {Robot} robot @param {number} part of how far they can open */
function drawJaws(pen, robot, part) {
  const front = Math.max(...robot.outline.map(([x = 0]) => x));
  for (const side of [-1, 1]) {
    const off = side * (1 + 4 * part);
    path(pen, [[front - 2, side * 4], [front + 2, side * 2 + off], [front + 6, off]], '#37434f', 1.4);
  }
}

/** @typedef {{x_cm: number, y_cm: number, heading: number, sees: string, turns_with: string}} Sensor where it sits */

/**
 * The sensors that have a place, each with its device and its reading.
 * @param {Robot} robot
 * @param {RobotState} state
 * @param {(place: Sensor, value: number, device: Robot['devices'][number]) => void} draw
 */
function forSensors(robot, state, draw) {
  /** @type {Record<string, Sensor | undefined>} */
  const places = robot.places;
  robot.devices.filter((device) => device.role === 'sensor').forEach((device, k) => {
    const place = places[device.text], reading = state.readings[k];
    if (place && reading) draw(place, reading.value, device);
  });
}

/** What feels the floor, or a touch. @param {Pen} pen @param {Robot} robot @param {RobotState} state */
function drawFeelers(pen, robot, state) {
  const radius = 1.4 * sizeOf(robot);
  forSensors(robot, state, ({ x_cm, y_cm, sees }, value) => {
    if (sees === 'distance' || sees === 'light') return;
    dot(pen, x_cm, y_cm, radius, '#123b2c');
    dot(pen, x_cm, y_cm, radius * 0.75, value ? '#ff6b57' : '#b9c2cb');
  });
}

/** What each sensor looks at, and how much it finds. @param {Pen} pen @param {Robot} robot @param {RobotState} state */
function drawSenses(pen, robot, state) {
  const turned = state.turned ?? {};
  forSensors(robot, state, (place, value, device) => {
    const { x_cm: x, y_cm: y } = place;
    const along = ((place.heading + (turned[place.turns_with] ?? 0)) * Math.PI) / 180;
    if (place.sees === 'distance') cone(pen, x, y, along, value, '#e0452f33');
    else if (place.sees === 'light') {
      const most = device.arguments[0]?.high || 1;
      const strength = Math.round(40 + 160 * Math.min(1, value / most));
      cone(pen, x, y, along, LOOK_CM, `#e08a1e${strength.toString(16).padStart(2, '0')}`);
    }
  });
}

/** @param {Pen} pen @param {number} x @param {number} y @param {number} along @param {number} length @param {string} color */
function cone(pen, x, y, along, length, color) {
  pen.fillStyle = color;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y, length, along - CONE, along + CONE);
  pen.fill();
}
