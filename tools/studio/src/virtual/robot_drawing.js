// Draws a robot from above: its wheels as far as they have turned, its lamps, what it senses and says.
//
// x is ahead of the middle between its wheels, y to its left. Knows no world.

import { drawDot, drawPath } from '../page/shapes.js';
import { CALM_FACE } from './moods.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {typeof import('../page/words.js').ROBOTS[number]} Robot */
/** @typedef {import('../page/shapes.js').Pen} Pen */
/**
 * @typedef {object} RobotView what a robot does that its state does not say
 * @property {[number, number]} rolled_cm how far each wheel has turned, in cm
 * @property {boolean} isBeeping
 * @property {import('./moods.js').Face} [face]
 * @property {readonly string[]} [colours] of its body and its edge
 */

const HALF_CONE = (15 * Math.PI) / 180; // of an ultrasonic sensor, to both sides
const WHEEL = { length: 8, width: 3, tread: 1.6 };
const USUAL_BACK_CM = 9; // from the middle between its wheels to its back
const RAY_CM = 14; // of a ray of light
const GREEN_COLOURS = ['#2a9d6f', '#0d4f38'];
const EYE_SIZES = { back: 4.6, apart: 3.1, radius: 2.6, pupil: 1.4, room: 1.05, stroke: 0.8, wide: 7.5 }; // in cm, of a robot that is so wide to each side

/**
 * @param {Pen} pen at the robot, turned as it is
 * @param {Robot} robot
 * @param {RobotState | null} state null of a robot that is off
 * @param {RobotView} view
 */
export function drawRobot(pen, robot, state, view) {
  if (state) drawSenses(pen, robot, state);
  actuatorsOf(robot).forEach((device, index) => {
    if (!device.is_yes_no && !carriesSensor(robot, device.text)) drawJaws(pen, robot, (state?.actuators[index] ?? 0) / (device.arguments[0]?.high || 1));
  });
  const [bodyColour = '', edgeColour = ''] = state?.fault ? ['#c8372a', '#5c130c'] : view.colours ?? GREEN_COLOURS;
  drawPath(pen, robot.outline, edgeColour, 0.8, bodyColour);
  const halfBase = robot.wheel_base_cm / 2, scale = scaleOf(robot);
  drawWheel(pen, halfBase, view.rolled_cm[0], scale);
  drawWheel(pen, -halfBase, view.rolled_cm[1], scale);
  drawFace(pen, robot, view.face ?? CALM_FACE, bodyColour, edgeColour);
  pen.save();
  pen.scale(scale, scale);
  drawPath(pen, [[4.2, 0], [0.6, 2], [0.6, -2]], '#fff', 0.4, '#fff');
  drawLamps(pen, robot, state, edgeColour);
  drawBuzzer(pen, view.isBeeping);
  pen.restore();
  if (state) drawFeelers(pen, robot, state);
}

/** How large what is on a robot is: on a short one it has less room. @param {Robot} robot */
function scaleOf(robot) {
  return Math.min(1, Math.max(...robot.outline.map(([x = 0]) => -x)) / USUAL_BACK_CM);
}

/**
 * Another body that drives, from above: its wheels at its sides, and where it looks.
 * @param {Pen} pen
 * @param {import('../world/parts.js').Rival} rival
 * @param {number[]} pose
 */
export function drawRival(pen, { length_cm, width_cm }, [x = 0, y = 0, heading = 0]) {
  const cornerRadius = Math.min(length_cm, width_cm) / 2, halfLength = length_cm / 2;
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
  pen.roundRect(-halfLength, -width_cm / 2 + 0.8, length_cm, width_cm - 1.6, Math.min(cornerRadius, width_cm / 2 - 0.8));
  pen.fillStyle = '#9a4fc0';
  pen.strokeStyle = '#5b2179';
  pen.lineWidth = 0.8;
  pen.fill();
  pen.stroke();
  for (const eyeY of [-1.7, 1.7]) {
    drawDot(pen, halfLength - 2.6, eyeY, 1.3, '#fff');
    drawDot(pen, halfLength - 2.1, eyeY, 0.6, '#20242a');
  }
  pen.restore();
}

/** In the order of the state's. @param {Robot} robot */
function actuatorsOf(robot) {
  return robot.devices.filter((device) => device.role === 'actuator');
}

/** @param {Pen} pen @param {number} y @param {number} rolled_cm @param {number} scale */
function drawWheel(pen, y, rolled_cm, scale) {
  const length = WHEEL.length * scale, width = WHEEL.width * scale, { tread } = WHEEL;
  pen.fillStyle = '#20242a';
  pen.beginPath();
  pen.roundRect(-length / 2, y - width / 2, length, width, 1);
  pen.fill();
  // What is above of a wheel goes ahead, as the robot does.
  const firstTreadX = (((rolled_cm % tread) + tread) % tread) - length / 2;
  for (let x = firstTreadX; x < length / 2 - 0.2; x += tread) {
    if (x > 0.2 - length / 2) drawPath(pen, [[x, y - width / 2 + 0.5], [x, y + width / 2 - 0.5]], '#b9c2cb', 0.5);
  }
}

/** Its eyes, which are the ends of an ultrasonic sensor where it has one. @param {Pen} pen @param {Robot} robot @param {import('./moods.js').Face} face @param {string} bodyColour colour @param {string} edgeColour */
function drawFace(pen, robot, { mood, ahead, aside, isBlinking }, bodyColour, edgeColour) {
  const size = Math.max(...robot.outline.map(([, y = 0]) => y)) / EYE_SIZES.wide;
  const [back = 0, spacing = 0, radius = 0, pupil = 0, pupilTravel = 0, stroke = 0] = [EYE_SIZES.back, EYE_SIZES.apart, EYE_SIZES.radius, EYE_SIZES.pupil, EYE_SIZES.room, EYE_SIZES.stroke].map((size_cm) => size_cm * size);
  const x = Math.max(...robot.outline.map(([x = 0]) => x)) - back;
  for (const side of [-1, 1]) {
    const y = side * spacing;
    const isClosed = isBlinking && mood === 'calm';
    drawDot(pen, x, y, radius + 0.35, edgeColour);
    drawDot(pen, x, y, radius, isClosed || mood === 'glad' ? bodyColour : '#fff');
    if (isClosed) drawPath(pen, [[x, y - radius], [x, y + radius]], edgeColour, stroke);
    else if (mood === 'glad') drawArc(pen, x - radius / 2, y, radius * 0.75, -Math.PI / 2, Math.PI / 2, '#fff', 1.3 * stroke);
    else if (mood === 'dizzy') {
      for (const direction of [-1, 1]) drawPath(pen, [[x - pupil, y - pupil * direction], [x + pupil, y + pupil * direction]], '#20242a', stroke);
    } else {
      drawDot(pen, x + pupilTravel * (mood === 'tired' ? -0.5 : ahead), y + pupilTravel * aside, pupil, '#20242a');
      if (mood === 'tired') drawLid(pen, x, y, radius, bodyColour, edgeColour);
    }
  }
}

/** The half of an eye that is shut. @param {Pen} pen @param {number} x @param {number} y @param {number} radius @param {string} bodyColour @param {string} edgeColour */
function drawLid(pen, x, y, radius, bodyColour, edgeColour) {
  pen.beginPath();
  pen.arc(x, y, radius, -Math.PI / 2, Math.PI / 2);
  pen.fillStyle = bodyColour;
  pen.fill();
  drawPath(pen, [[x, y - radius], [x, y + radius]], edgeColour, 0.6);
}

/** @param {Pen} pen @param {number} x @param {number} y @param {number} radius @param {number} fromAngle @param {number} untilAngle @param {string} color @param {number} width */
function drawArc(pen, x, y, radius, fromAngle, untilAngle, color, width) {
  pen.beginPath();
  pen.arc(x, y, radius, fromAngle, untilAngle);
  pen.strokeStyle = color;
  pen.lineWidth = width;
  pen.stroke();
}

/** Its own light, which is on where its button would start it, and those that a program turns on. @param {Pen} pen @param {Robot} robot @param {RobotState | null} state @param {string} edgeColour */
function drawLamps(pen, robot, state, edgeColour) {
  drawDot(pen, -7.5, 0, 0.9, state?.is_waiting ? '#ffd84d' : edgeColour);
  actuatorsOf(robot).forEach((device, index) => {
    if (!device.is_yes_no) return;
    const isLit = Boolean(state?.actuators[index]);
    if (isLit) drawDot(pen, -1.2, 0, 5, '#ffe14d77');
    drawDot(pen, -1.2, 0, 1.9, edgeColour);
    drawDot(pen, -1.2, 0, 1.4, isLit ? '#fff3a8' : '#7c8894');
  });
}

/** @param {Pen} pen @param {boolean} isBeeping */
function drawBuzzer(pen, isBeeping) {
  drawDot(pen, -4.6, 0, 1.5, '#20242a');
  drawDot(pen, -4.6, 0, 0.5, '#b9c2cb');
  if (!isBeeping) return;
  for (const radius of [4, 6.5, 9]) {
    for (const middleAngle of [Math.PI / 2, -Math.PI / 2]) {
      drawArc(pen, -4.6, 0, radius, middleAngle - 0.6, middleAngle + 0.6, '#7a2fb8', 0.9);
    }
  }
}

/** @param {Robot} robot @param {string} actuator */
function carriesSensor(robot, actuator) {
  return Object.values(robot.places).some((place) => place.turns_with === actuator);
}

/** @param {Pen} pen @param {Robot} robot @param {number} openShare of how far they can open */
function drawJaws(pen, robot, openShare) {
  const front = Math.max(...robot.outline.map(([x = 0]) => x));
  for (const side of [-1, 1]) {
    const openOffset = side * (1 + 4 * openShare);
    drawPath(pen, [[front - 2, side * 4], [front + 2, side * 2 + openOffset], [front + 6, openOffset]], '#37434f', 1.4);
  }
}

/** @typedef {{x_cm: number, y_cm: number, heading: number, sees: string, turns_with: string}} SensorPlace where it sits */

/**
 * The sensors that have a place, each with its device and its reading.
 * @param {Robot} robot
 * @param {RobotState} state
 * @param {(place: SensorPlace, value: number, device: Robot['devices'][number]) => void} draw
 */
function forEachSensor(robot, state, draw) {
  /** @type {Record<string, SensorPlace | undefined>} */
  const places = robot.places;
  robot.devices.filter((device) => device.role === 'sensor').forEach((device, index) => {
    const sensorPlace = places[device.text], reading = state.readings[index];
    if (sensorPlace && reading) draw(sensorPlace, reading.value, device);
  });
}

/** What feels the floor, or a touch. @param {Pen} pen @param {Robot} robot @param {RobotState} state */
function drawFeelers(pen, robot, state) {
  const radius = 1.4 * scaleOf(robot);
  forEachSensor(robot, state, ({ x_cm, y_cm, sees }, value) => {
    if (sees === 'distance' || sees === 'light') return;
    drawDot(pen, x_cm, y_cm, radius, '#123b2c');
    drawDot(pen, x_cm, y_cm, radius * 0.75, value ? '#ff6b57' : '#b9c2cb');
  });
}

/** What each sensor looks at, and how much it finds. @param {Pen} pen @param {Robot} robot @param {RobotState} state */
function drawSenses(pen, robot, state) {
  const turnedAngles = state.turned ?? {};
  forEachSensor(robot, state, (place, value, device) => {
    const { x_cm: x, y_cm: y } = place;
    const angle = ((place.heading + (turnedAngles[place.turns_with] ?? 0)) * Math.PI) / 180;
    if (place.sees === 'distance') drawCone(pen, x, y, angle, value, '#e0452f33');
    else if (place.sees === 'light') {
      const mostReading = device.arguments[0]?.high || 1;
      const strength = Math.round(40 + 160 * Math.min(1, value / mostReading));
      drawCone(pen, x, y, angle, RAY_CM, `#e08a1e${strength.toString(16).padStart(2, '0')}`);
    }
  });
}

/** @param {Pen} pen @param {number} x @param {number} y @param {number} angle @param {number} length @param {string} color */
function drawCone(pen, x, y, angle, length, color) {
  pen.fillStyle = color;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y, length, angle - HALF_CONE, angle + HALF_CONE);
  pen.fill();
}
