// Draws a world and the robot in it. Knows shapes; what a robot does, the firmware decides.

import { drawRobot } from './robot_drawing.js';
import { dot, path } from './shapes.js';
import { ROBOTS, WORLDS } from './words.js';
import { cornersOf } from './world_parts.js';

/** @typedef {import('./python.js').RobotState} RobotState */
/** @typedef {import('./world_parts.js').World} World */
/** @typedef {import('./world_parts.js').Place} Place */
/** @typedef {{points: Place[], point: number, handle: Place | null}} Mark the points that can be taken, which one is, and what turns it */
/** @typedef {{x_cm: number, y_cm: number, is_flag: boolean, radius_cm?: number, around?: Place[]}} Goal */

const MARGIN_CM = 4;
const GRID_CM = 10; // while a world is changed
const FINGER = 22; // pixels that a finger may miss
const MOST_POINTS = 5000; // of a way
const MOST_WAYS = 4; // of runs before, which are pale
const SHAKE_MS = 240;
const SAID_MS = 2500; // of the robot's time, for what it shows

export class Arena {
  #canvas;
  #context;
  #world = WORLDS[0];
  #robot = ROBOTS[0];
  /** @type {Goal[]} */
  #goals = [];
  /** What its pen has drawn, the newest run last. @type {[number, number][][]} */
  #ways = [[]];
  /** How far each wheel has turned, in cm. @type {[number, number]} */
  #rolled = [0, 0];
  #seen_ms = 0; // of the robot's time
  #beeps_until_ms = 0;
  #taken = 0; // flags
  /** What it has shown last, and when. @type {[string, number]} */
  #said = ['', 0];
  #scale = 1; // pixels of the canvas for a centimetre
  /** What is chosen to be changed. @type {Mark | null} */
  #mark = null;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.#canvas = canvas;
    const context = canvas.getContext('2d');
    if (!context) throw new Error('no canvas');
    this.#context = context;
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
    this.#robot = ROBOTS.find((each) => each.name === robot) ?? ROBOTS[0];
    this.#ways = [...this.#ways.filter((way) => way.length > 1), []].slice(-1 - MOST_WAYS);
    this.#rolled = [0, 0];
    this.#seen_ms = this.#beeps_until_ms = 0;
    this.#taken = 0;
    this.#said = ['', 0];
  }

  /** Takes what its pen has drawn off the floor. */
  eraseWays() {
    this.#ways = [[]];
  }

  /**
   * Goes on to a newer state.
   * @param {RobotState} state
   */
  follow(state) {
    const [x, y] = state.pose;
    const way = this.#ways.at(-1) ?? [];
    const last = way.at(-1);
    if (!last || Math.hypot(last[0] - x, last[1] - y) > 0.5) way.push([x, y]);
    if (way.length > MOST_POINTS) way.splice(0, MOST_POINTS / 2);
    const passed_s = Math.max(0, state.now_ms - this.#seen_ms) / 1000;
    const full = (this.#robot?.speed_cm_s ?? 0) / 100;
    this.#seen_ms = state.now_ms;
    this.#taken = state.score?.taken ?? 0;
    this.#rolled[0] += state.motors[0] * full * passed_s;
    this.#rolled[1] += state.motors[1] * full * passed_s;
  }

  /** @param {number} until_ms of the robot's time */
  showBeep(until_ms) {
    this.#beeps_until_ms = until_ms;
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
    this.#mark = mark;
  }

  /**
   * Returns the place on the floor under a finger, and how far it may miss.
   * @param {PointerEvent} event
   * @returns {{place: Place, reach_cm: number}}
   */
  floorAt(event) {
    const box = this.#canvas.getBoundingClientRect();
    const scale = this.#scale / (window.devicePixelRatio || 1);
    const { width_cm, height_cm } = this.#world ?? { width_cm: 0, height_cm: 0 };
    return {
      place: [(event.clientX - box.left - box.width / 2) / scale + width_cm / 2, (box.top + box.height / 2 - event.clientY) / scale + height_cm / 2],
      reach_cm: FINGER / scale,
    };
  }

  /** @param {RobotState | null} state */
  draw(state) {
    const world = this.#world;
    if (!world) return;
    const canvas = this.#canvas;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const scale = Math.min(
      width / (world.width_cm + 2 * MARGIN_CM),
      height / (world.height_cm + 2 * MARGIN_CM),
    );
    this.#scale = scale;
    const pen = this.#context;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    // Centimetres from the lower left corner of the floor; y goes up.
    pen.setTransform(
      scale, 0, 0, -scale,
      (width - world.width_cm * scale) / 2,
      (height + world.height_cm * scale) / 2,
    );
    this.#drawWorld(world);
    this.#ways.forEach((way, k) => {
      path(pen, way, k === this.#ways.length - 1 ? '#2f74c0' : '#bcd2ea', 1);
    });
    const { start } = world;
    const [x, y, heading] = state?.pose ?? [start.x_cm, start.y_cm, start.heading];
    this.#drawBody(x, y, heading, state);
    this.#drawMark();
  }

  /** @param {World} world */
  #drawWorld(world) {
    const pen = this.#context;
    pen.fillStyle = '#fffdf6';
    pen.fillRect(0, 0, world.width_cm, world.height_cm);
    pen.lineCap = pen.lineJoin = 'round';
    if (this.#mark) this.#drawGrid(world);
    for (const goal of this.#goals) this.#drawGoal(goal);
    world.flags.forEach((flag, k) => this.#drawFlag(flag, k));
    for (const line of world.lines) path(pen, line.points, '#20242a', line.width_cm);
    for (const { x_cm: x, y_cm: y } of world.lamps) {
      dot(pen, x, y, 9, '#ffe9a3');
      dot(pen, x, y, 3, '#e08a1e');
    }
    for (const box of world.boxes) {
      path(pen, cornersOf(box), '#6b4a2f', 1, true);
      pen.fillStyle = '#c79a6b';
      pen.fill();
    }
    for (const wall of world.walls) path(pen, wall.points, '#6b4a2f', 2);
    if (world.has_border) {
      pen.strokeStyle = '#6b4a2f';
      pen.lineWidth = 2;
      pen.strokeRect(0, 0, world.width_cm, world.height_cm);
    }
  }

  /** @param {World} world */
  #drawGrid({ width_cm, height_cm }) {
    const pen = this.#context;
    for (let at = GRID_CM; at < Math.max(width_cm, height_cm); at += GRID_CM) {
      const color = at % (5 * GRID_CM) ? '#eee8d8' : '#d9cfb4';
      if (at < width_cm) path(pen, [[at, 0], [at, height_cm]], color, 0.4);
      if (at < height_cm) path(pen, [[0, at], [width_cm, at]], color, 0.4);
    }
  }

  /** @param {Goal} goal */
  #drawGoal({ x_cm: x, y_cm: y, is_flag, radius_cm, around }) {
    const pen = this.#context;
    pen.setLineDash([4, 2.5]);
    if (around) path(pen, around, '#0d6040', 0.8, true);
    else {
      dot(pen, x, y, radius_cm ?? 0, '#2a9d6f22');
      pen.strokeStyle = '#0d6040';
      pen.lineWidth = 0.8;
      pen.stroke();
    }
    pen.setLineDash([]);
    if (is_flag) this.#drawCloth(x, y, '#ffd84d');
  }

  /** A flag of the world: taken, the next one, or one of those behind it. @param {import('./world_parts.js').Flag} flag @param {number} k */
  #drawFlag({ x_cm: x, y_cm: y, reach_cm, rests }, k) {
    const pen = this.#context;
    const isTaken = k < this.#taken, isNext = k === this.#taken;
    dot(pen, x, y, reach_cm, isTaken ? '#2a9d6f44' : isNext ? '#ffd84d77' : '#c8d2dc66');
    if (!isTaken) pen.setLineDash(rests ? [] : [4, 2.5]);
    pen.strokeStyle = isTaken || isNext ? '#0d6040' : '#66727e';
    pen.lineWidth = rests ? 1.4 : 0.8;
    pen.stroke();
    pen.setLineDash([]);
    if (isTaken) path(pen, [[x - 5, y], [x - 1.5, y - 4], [x + 6, y + 5]], '#0d6040', 2.4);
    else {
      this.#drawCloth(x, y, isNext ? '#ffd84d' : '#fff');
      this.#drawNumber(x + 3.6, y + 9.6, String(k + 1));
    }
  }

  /** @param {number} x @param {number} y of its foot @param {string} color */
  #drawCloth(x, y, color) {
    path(this.#context, [[x, y], [x, y + 14], [x + 11, y + 10], [x, y + 6]], '#0d6040', 1);
    this.#context.fillStyle = color;
    this.#context.fill();
  }

  /** @param {number} x @param {number} y its middle @param {string} number */
  #drawNumber(x, y, number) {
    const pen = this.#context;
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

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} heading
   * @param {RobotState | null} state null of a robot that is off
   */
  #drawBody(x, y, heading, state) {
    const robot = this.#robot;
    if (!robot) return;
    const pen = this.#context;
    pen.save();
    pen.translate(x, y);
    pen.rotate((heading * Math.PI) / 180);
    const isBeeping = state !== null && state.is_running && state.now_ms < this.#beeps_until_ms;
    drawRobot(pen, robot, state, { rolled: this.#rolled, isBeeping });
    pen.restore();
    if (state?.touches) this.#drawStar(...state.touches);
    const [what, at_ms] = this.#said;
    if (what && state && (!state.is_running || state.now_ms - at_ms < SAID_MS)) this.#drawSaid(x, y, what);
  }

  /** A bubble beside the robot, inside the picture. @param {number} x @param {number} y @param {string} what */
  #drawSaid(x, y, what) {
    const pen = this.#context;
    const { a: scale, e: left, f: bottom } = pen.getTransform();
    const size = 15 * (window.devicePixelRatio || 1);
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${size}px system-ui, sans-serif`;
    const width = pen.measureText(what).width + size, height = 1.6 * size;
    const [robot_x, robot_y] = [left + x * scale, bottom - y * scale];
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
    path(this.#context, points, '#a8200f', 0.6, true);
    this.#context.fillStyle = '#ffd84d';
    this.#context.fill();
  }

  #drawMark() {
    const mark = this.#mark;
    if (!mark) return;
    const pen = this.#context;
    path(pen, mark.points, '#b0186b', 0.6);
    const radius = (7 * (window.devicePixelRatio || 1)) / this.#scale;
    const [middle] = mark.points, { handle } = mark;
    if (handle && middle) {
      path(pen, [middle, handle], '#b0186b', 0.6);
      dot(pen, ...handle, radius * 1.3, '#b0186b');
      pen.beginPath();
      pen.arc(...handle, radius * 0.7, 0.6, 5.4);
      pen.strokeStyle = '#fff';
      pen.lineWidth = radius / 4;
      pen.stroke();
    }
    mark.points.forEach(([x, y], k) => {
      dot(pen, x, y, radius, '#fff');
      dot(pen, x, y, radius * 0.75, mark.point < 0 || k === mark.point ? '#b0186b' : '#7c8894');
    });
  }
}
