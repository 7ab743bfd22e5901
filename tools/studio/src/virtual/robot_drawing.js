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
  const side = robot.wheel_base_cm / 2;
  drawWheel(pen, side, seen.rolled[0]);
  drawWheel(pen, -side, seen.rolled[1]);
  drawEyes(pen, robot);
  path(pen, [[6, 0], [1.5, 2.6], [1.5, -2.6]], '#fff', 0.4, '#fff');
  drawLamps(pen, robot, state);
  drawBuzzer(pen, seen.isBeeping);
}

/** In the order of the state's. @param {Robot} robot */
function actuatorsOf(robot) {
  return robot.devices.filter((each) => each.role === 'actuator');
}

/** @param {Pen} pen @param {number} y @param {number} rolled */
function drawWheel(pen, y, rolled) {
  const { length, width, tread } = WHEEL;
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

/** The two round ends of each ultrasonic sensor. @param {Pen} pen @param {Robot} robot */
function drawEyes(pen, robot) {
  for (const place of Object.values(robot.places)) {
    if (place.sees !== 'distance') continue;
    for (const across of [-1.9, 1.9]) {
      dot(pen, place.x_cm - 2.6, place.y_cm + across, 1.7, '#e9eef2');
      dot(pen, place.x_cm - 2.1, place.y_cm + across, 0.9, '#20242a');
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

/** What each sensor looks at, and how much it finds. @param {Pen} pen @param {Robot} robot @param {RobotState} state */
function drawSenses(pen, robot, state) {
  /** @type {Record<string, {x_cm: number, y_cm: number, heading: number, sees: string, turns_with: string} | undefined>} */
  const places = robot.places;
  const turned = state.turned ?? {};
  robot.devices.filter((device) => device.role === 'sensor').forEach((device, k) => {
    const place = places[device.text];
    const reading = state.readings[k];
    if (!place || !reading) return;
    const { x_cm: x, y_cm: y } = place;
    const along = ((place.heading + (turned[place.turns_with] ?? 0)) * Math.PI) / 180;
    if (place.sees === 'distance') {
      cone(pen, x, y, along, reading.value, '#e0452f33');
    } else if (place.sees === 'light') {
      const most = device.arguments[0]?.high || 1;
      const strength = Math.round(40 + 160 * Math.min(1, reading.value / most));
      cone(pen, x, y, along, LOOK_CM, `#e08a1e${strength.toString(16).padStart(2, '0')}`);
    } else {
      dot(pen, x, y, 1.4, reading.value ? '#c8372a' : '#7c8894');
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
