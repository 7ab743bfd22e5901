// Draws a world and the robot in it. Knows shapes; what a robot does, the firmware decides.

import { Moods } from './moods.js';
import { drawRival, drawRobot } from './robot_drawing.js';
import { COLOURS } from '../page/own_robot.js';
import { pageState } from '../page/page_state.js';
import { drawDot, drawPath } from '../page/shapes.js';
import { robotOf, ROBOTS, WORLDS } from '../page/words.js';
import { drawWorld, lightTile } from '../world/floor.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @import { World, Place } from '../world/parts.js' */
/** @typedef {{points: Place[], point: number, handle: Place | null}} Mark the points that can be taken, which one is, and what turns it */
/** @typedef {import('../world/floor.js').Goal} Goal */
/** @typedef {import('../page/shapes.js').Pen} Pen */

const MARGIN_CM = 4;
const LEAST_ROBOT = 72; // pixels of a robot that the camera follows,
const MOST_ROBOT = 0.4; // unless that is more of the picture's shorter side
const BEHIND = 0.78; // of the picture's height is ahead of a robot that is seen from behind
const NEARER = 1.7; // than from above: what is far is small then
/** @typedef {'whole' | 'near' | 'behind'} Camera */
const FINGER = 22; // pixels that a finger may miss
const MOST_POINTS = 5000; // of a way
const MOST_WAYS = 4; // of runs before, which are pale
const SHAKE_MS = 240;
const SAID_MS = 2500; // of the robot's time, for what it shows

export class Arena {
  #canvas;
  #pen;
  /** The world and the ways, which stay the same from one picture to the next. */
  #floor = document.createElement('canvas');
  #isFloorDrawn = false;
  #wayDrawn = 0; // points of the newest way that are on the floor
  #world = WORLDS[0];
  #robot = ROBOTS[0];
  /** @type {Goal[]} */
  #goals = [];
  /** What its pen has drawn, the newest run last. @type {[number, number][][]} */
  #ways = [[]];
  /** How far each wheel has turned, in cm. @type {[number, number]} */
  #rolled = [0, 0];
  #seen_ms = 0; // of the robot's time
  /** From when to when it beeps. @type {[number, number]} */
  #beep = [0, 0];
  #taken = 0; // flags
  #moods = new Moods();
  /** What it has shown last, and when. @type {[string, number]} */
  #said = ['', 0];
  /** @type {Camera} */
  #camera = 'whole';
  #scale = 1; // pixels of the canvas for a centimetre
  #place = new DOMMatrix(); // from the floor, in centimetres, to the canvas
  /** What is chosen to be changed. @type {Mark | null} */
  #mark = null;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.#canvas = canvas;
    this.#pen = penOf(canvas);
  }

  /** Takes the size that the canvas has on the page. */
  resize() {
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(this.#canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.#canvas.clientHeight * ratio));
    Object.assign(this.#canvas, { width, height });
  }

  /** @param {Camera} camera the whole floor, or the robot with what is around it: from above, or from behind */
  set camera(camera) {
    this.#camera = camera;
    this.#canvas.classList.toggle('behind', camera === 'behind');
  }

  /**
   * Begins again. What its pen has drawn in this world stays there.
   * @param {World} world
   * @param {string} robot
   * @param {Goal[]} goals where a task leads
   */
  begin(world, robot, goals) {
    if (world !== this.#world || robot !== this.#robot?.name) this.#ways = [];
    this.#world = world;
    this.#goals = goals;
    this.#robot = robotOf(robot) ?? ROBOTS[0];
    this.#ways = [...this.#ways.filter((way) => way.length > 1), []].slice(-1 - MOST_WAYS);
    this.#rolled = [0, 0];
    this.#seen_ms = 0;
    this.#beep = [0, 0];
    this.#taken = 0;
    this.#moods.begin();
    this.#said = ['', 0];
    this.#isFloorDrawn = false;
  }

  /** Its robot is glad, until the next run. */
  cheer() {
    this.#moods.cheer();
  }

  /** Takes what its pen has drawn off the floor. */
  eraseWays() {
    this.#ways = [[]];
    this.#isFloorDrawn = false;
  }

  /**
   * Goes on to a newer state.
   * @param {RobotState} state
   */
  follow(state) {
    this.#moods.follow(state);
    const [x, y] = state.pose;
    const way = this.#ways.at(-1) ?? [];
    const last = way.at(-1);
    if (!last || Math.hypot(last[0] - x, last[1] - y) > 0.5) way.push([x, y]);
    if (way.length > MOST_POINTS) {
      way.splice(0, MOST_POINTS / 2);
      this.#isFloorDrawn = false;
    }
    const passed_s = Math.max(0, state.now_ms - this.#seen_ms) / 1000;
    const full = (this.#robot?.speed_cm_s ?? 0) / 100;
    this.#seen_ms = state.now_ms;
    this.#rolled[0] += state.motors[0] * full * passed_s;
    this.#rolled[1] += state.motors[1] * full * passed_s;
  }

  /** @param {number} from_ms of the robot's time @param {number} until_ms */
  showBeep(from_ms, until_ms) {
    this.#beep = [from_ms, until_ms];
  }

  /** @param {string} what @param {number} at_ms of the robot's time */
  say(what, at_ms) {
    this.#said = [what, at_ms];
  }

  /** Shakes the picture, unless this person wants nothing to move. */
  shake() {
    if (matchMedia('(prefers-reduced-motion: reduce)').matches || this.#canvas.getAnimations().length) return;
    const ways = ['0 0', '5px 2px', '-5px -2px', '3px -1px', '0 0'];
    this.#canvas.animate(ways.map((translate) => ({ translate })), SHAKE_MS);
  }

  /** @param {Mark | null} mark */
  mark(mark) {
    if (Boolean(mark) !== Boolean(this.#mark)) this.#isFloorDrawn = false; // a grid
    this.#mark = mark;
  }

  /**
   * Returns the place on the floor under a finger, and how far it may miss.
   * @param {PointerEvent} event
   * @returns {{place: Place, reach_cm: number}}
   */
  floorAt(event) {
    const box = this.#canvas.getBoundingClientRect();
    const ratio = this.#canvas.width / box.width;
    const { x, y } = this.#place.inverse().transformPoint({ x: (event.clientX - box.left) * ratio, y: (event.clientY - box.top) * ratio });
    return { place: [x, y], reach_cm: (FINGER * ratio) / this.#scale };
  }

  /** @param {RobotState | null} state */
  draw(state) {
    const world = this.#world;
    if (!world) return;
    const { width, height } = this.#canvas;
    const { start } = world;
    const [x, y, heading] = state?.pose ?? [start.x_cm, start.y_cm, start.heading];
    this.#look(world, x, y, heading);
    const taken = state?.score?.taken ?? 0;
    if (taken !== this.#taken) this.#isFloorDrawn = false;
    this.#taken = taken;
    this.#drawFloor(world);
    const pen = this.#pen;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.setTransform(this.#place);
    pen.scale(1 / this.#scale, -1 / this.#scale);
    pen.drawImage(this.#floor, -MARGIN_CM * this.#scale, -(world.height_cm + MARGIN_CM) * this.#scale);
    pen.setTransform(this.#place);
    pen.lineCap = pen.lineJoin = 'round';
    lightTile(pen, world, x, y);
    world.rivals.forEach((rival, k) => drawRival(pen, rival, state?.rivals[k] ?? [rival.x_cm, rival.y_cm, rival.heading]));
    this.#drawBody(x, y, heading, state);
    this.#drawMark();
  }

  /**
   * Says where on the canvas the floor is. A robot that is changed by a finger is seen with all of its floor.
   * @param {World} world @param {number} x @param {number} y @param {number} heading of the robot
   */
  #look({ width_cm, height_cm }, x, y, heading) {
    const { width, height } = this.#canvas;
    const whole = [width_cm + 2 * MARGIN_CM, height_cm + 2 * MARGIN_CM];
    const fit = Math.min(width / (whole[0] ?? 1), height / (whole[1] ?? 1));
    const camera = this.#mark ? 'whole' : this.#camera;
    const long = Math.max(...(this.#robot?.outline ?? [[1]]).map(([ahead = 0]) => ahead)) - Math.min(...(this.#robot?.outline ?? [[0]]).map(([ahead = 0]) => ahead));
    const large = Math.min(LEAST_ROBOT * (window.devicePixelRatio || 1), MOST_ROBOT * Math.min(width, height));
    const scale = camera === 'whole' ? fit : Math.max(fit, (large * (camera === 'behind' ? NEARER : 1)) / long);
    if (Math.abs(scale - this.#scale) > 1e-9 || this.#floor.width !== Math.ceil((whole[0] ?? 0) * scale)) {
      this.#scale = scale;
      Object.assign(this.#floor, { width: Math.ceil((whole[0] ?? 0) * scale), height: Math.ceil((whole[1] ?? 0) * scale) });
      this.#isFloorDrawn = false;
    }
    if (camera === 'behind') {
      this.#place = new DOMMatrix().translate(width / 2, height * BEHIND).scale(scale, -scale).rotate(90 - heading).translate(-x, -y);
      return;
    }
    const margin = MARGIN_CM * scale, high = height_cm * scale + margin;
    const left = within(width / 2 - x * scale, width, width_cm * scale, margin);
    const bottom = height - within(height / 2 - y * scale, height, height_cm * scale, margin);
    // Whole pixels of the floor are on whole ones of the picture: else it would be blurred.
    this.#place = new DOMMatrix([scale, 0, 0, -scale, Math.round(left - margin) + margin, Math.round(bottom - high) + high]);
  }

  /** Draws what is new on the floor, or all of it where it has become another one. @param {World} world */
  #drawFloor(world) {
    const pen = penOf(this.#floor);
    if (!this.#isFloorDrawn) {
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.clearRect(0, 0, this.#floor.width, this.#floor.height);
      this.#measure(pen, world);
      drawWorld(pen, world, this.#goals, this.#taken, this.#mark !== null);
      for (const way of this.#ways.slice(0, -1)) drawPath(pen, way, '#bcd2ea', 1);
      this.#wayDrawn = 0;
      this.#isFloorDrawn = true;
    }
    const way = this.#ways.at(-1) ?? [];
    if (way.length > this.#wayDrawn) drawPath(pen, way.slice(Math.max(0, this.#wayDrawn - 1)), '#2f74c0', 1);
    this.#wayDrawn = way.length;
  }

  /** Centimetres from the lower left corner of the floor; y goes up. @param {Pen} pen @param {World} world */
  #measure(pen, { height_cm }) {
    const scale = this.#scale;
    pen.lineCap = pen.lineJoin = 'round';
    pen.setTransform(scale, 0, 0, -scale, MARGIN_CM * scale, (height_cm + MARGIN_CM) * scale);
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} heading
   * @param {RobotState | null} state null of a robot that is off
   */
  #drawBody(x, y, heading, state) {
    const robot = this.#robot;
    if (!robot) return;
    const pen = this.#pen;
    pen.save();
    pen.translate(x, y);
    pen.rotate((heading * Math.PI) / 180);
    const [from_ms, until_ms] = this.#beep;
    const isBeeping = state !== null && state.is_running && from_ms <= state.now_ms && state.now_ms < until_ms;
    const face = this.#moods.faceOf(state);
    const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches;
    const { name, colour } = pageState.ownRobot.value;
    drawRobot(pen, robot, state, { rolled: this.#rolled, isBeeping, face: isStill ? { ...face, isBlinking: false } : face, colours: COLOURS[colour] ?? COLOURS[0] });
    pen.restore();
    if (name && !state?.is_running) this.#drawName(x, y, name);
    if (state?.touches) this.#drawStar(...state.touches);
    const [what, at_ms] = this.#said;
    if (what && state && (!state.is_running || state.now_ms - at_ms < SAID_MS)) this.#drawSaid(x, y, what);
  }

  /** Below a robot that stands. @param {number} x @param {number} y @param {string} name */
  #drawName(x, y, name) {
    const pen = this.#pen, size = 13 * (window.devicePixelRatio || 1);
    const { x: robot_x, y: robot_y } = this.#place.transformPoint({ x, y });
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${size}px system-ui, sans-serif`;
    const width = pen.measureText(name).width;
    const from_x = Math.max(2, Math.min(robot_x - width / 2, this.#canvas.width - width - 2));
    const at_y = Math.min(robot_y + 12 * this.#scale + size, this.#canvas.height - 4);
    Object.assign(pen, { strokeStyle: '#fff', fillStyle: '#123b63', lineWidth: size / 4, lineJoin: 'round' });
    pen.strokeText(name, from_x, at_y);
    pen.fillText(name, from_x, at_y);
    pen.restore();
  }

  /** A bubble beside the robot, inside the picture. @param {number} x @param {number} y @param {string} what */
  #drawSaid(x, y, what) {
    const pen = this.#pen;
    const scale = this.#scale;
    const size = 15 * (window.devicePixelRatio || 1);
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${size}px system-ui, sans-serif`;
    const width = pen.measureText(what).width + size, height = 1.6 * size;
    const { x: robot_x, y: robot_y } = this.#place.transformPoint({ x, y });
    const from_x = Math.max(2, Math.min(robot_x + 0.5 * size, this.#canvas.width - width - 2));
    const isBelow = robot_y - 12 * scale - height < 2;
    const from_y = isBelow ? robot_y + 12 * scale : robot_y - 12 * scale - height;
    pen.beginPath();
    pen.roundRect(from_x, from_y, width, height, 0.5 * size);
    pen.fillStyle = '#fff';
    pen.strokeStyle = '#123b63';
    pen.lineWidth = size / 8;
    pen.fill();
    pen.stroke();
    pen.fillStyle = '#123b63';
    pen.fillText(what, from_x + 0.5 * size, from_y + 1.15 * size);
    pen.restore();
  }

  /** Where it touches something. @param {number} x @param {number} y */
  #drawStar(x, y) {
    const points = Array.from({ length: 16 }, (_, k) => {
      const angle = (k * Math.PI) / 8, far = k % 2 ? 2.4 : 6;
      return [x + far * Math.cos(angle), y + far * Math.sin(angle)];
    });
    drawPath(this.#pen, points, '#a8200f', 0.6, '#ffd84d');
  }

  #drawMark() {
    const mark = this.#mark;
    if (!mark) return;
    const pen = this.#pen;
    drawPath(pen, mark.points, '#b0186b', 0.6);
    const radius = (7 * (window.devicePixelRatio || 1)) / this.#scale;
    const [middle] = mark.points, { handle } = mark;
    if (handle && middle) {
      drawPath(pen, [middle, handle], '#b0186b', 0.6);
      drawDot(pen, ...handle, radius * 1.3, '#b0186b');
      pen.beginPath();
      pen.arc(...handle, radius * 0.7, 0.6, 5.4);
      pen.strokeStyle = '#fff';
      pen.lineWidth = radius / 4;
      pen.stroke();
    }
    mark.points.forEach(([x, y], k) => {
      drawDot(pen, x, y, radius, '#fff');
      drawDot(pen, x, y, radius * 0.75, mark.point < 0 || k === mark.point ? '#b0186b' : '#7c8894');
    });
  }
}

/**
 * Where the edge of a floor is, so that its robot is in the middle of the picture, unless more would be beside the floor.
 * @param {number} wanted @param {number} room @param {number} size of the floor @param {number} margin around it
 */
function within(wanted, room, size, margin) {
  if (size + 2 * margin <= room + 1e-6) return (room - size) / 2;
  return Math.min(margin, Math.max(room - size - margin, wanted));
}

/** @param {HTMLCanvasElement} canvas @returns {Pen} */
function penOf(canvas) {
  const pen = canvas.getContext('2d');
  if (!pen) throw new Error('no canvas');
  return pen;
}
