// Draws a world and the robot in it. Knows shapes; what a robot does, the firmware decides.

import { ROBOTS, WORLDS } from './words.js';
import { cornersOf } from './world_parts.js';

/** @typedef {import('./python.js').RobotState} RobotState */
/** @typedef {import('./world_parts.js').World} World */
/** @typedef {import('./world_parts.js').Place} Place */

const MARGIN_CM = 4;
const CONE = (15 * Math.PI) / 180; // of an ultrasonic sensor, to both sides
const FINGER = 22; // pixels that a finger may miss
const MOST_POINTS = 5000; // of the way

export class Arena {
  #canvas;
  #context;
  #world = WORLDS[0];
  #robot = ROBOTS[0];
  /** @type {[number, number][]} */
  #way = [];
  #scale = 1; // pixels of the canvas for a centimetre
  /** What is chosen to be changed. @type {{points: Place[], point: number} | null} */
  #mark = null;

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.#canvas = canvas;
    const context = canvas.getContext('2d');
    if (!context) throw new Error('no canvas');
    this.#context = context;
  }

  /**
   * Begins again: another world or robot, and no way yet.
   * @param {World} world
   * @param {string} robot
   */
  begin(world, robot) {
    this.#world = world;
    this.#robot = ROBOTS.find((each) => each.name === robot) ?? ROBOTS[0];
    this.#way = [];
  }

  /** @param {{points: Place[], point: number} | null} mark the points that can be taken, and which one is */
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
    if (state) this.#drawRobot(state);
    else this.#drawBody(world.start.x_cm, world.start.y_cm, world.start.heading, null);
    this.#drawMark();
  }

  /** @param {World} world */
  #drawWorld(world) {
    const pen = this.#context;
    pen.fillStyle = '#fffdf6';
    pen.fillRect(0, 0, world.width_cm, world.height_cm);
    pen.lineCap = pen.lineJoin = 'round';
    for (const line of world.lines) this.#path(line.points, '#20242a', line.width_cm);
    for (const { x_cm: x, y_cm: y } of world.lamps) {
      this.#dot(x, y, 9, '#ffe9a3');
      this.#dot(x, y, 3, '#e08a1e');
    }
    for (const box of world.boxes) {
      this.#path(cornersOf(box), '#6b4a2f', 1, true);
      pen.fillStyle = '#c79a6b';
      pen.fill();
    }
    for (const wall of world.walls) this.#path(wall.points, '#6b4a2f', 2);
    if (world.has_border) {
      pen.strokeStyle = '#6b4a2f';
      pen.lineWidth = 2;
      pen.strokeRect(0, 0, world.width_cm, world.height_cm);
    }
  }

  /** @param {RobotState} state */
  #drawRobot(state) {
    const [x, y, heading] = state.pose;
    const last = this.#way.at(-1);
    if (!last || Math.hypot(last[0] - x, last[1] - y) > 0.5) this.#way.push([x, y]);
    if (this.#way.length > MOST_POINTS) this.#way.splice(0, MOST_POINTS / 2);
    this.#path(this.#way, '#5d94d1', 0.8);
    this.#drawBody(x, y, heading, state);
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
    if (state) this.#drawRays(state);
    this.#path(robot.outline, '#0d4f38', 0.8, true);
    pen.fillStyle = state?.fault ? '#c8372a' : '#2a9d6f';
    pen.fill();
    this.#path([[6, 0], [-3, 3], [-3, -3]], '#fff', 0.4, true);
    pen.fillStyle = '#fff';
    pen.fill();
    pen.restore();
  }

  #drawMark() {
    const mark = this.#mark;
    if (!mark) return;
    this.#path(mark.points, '#b0186b', 0.6);
    const radius = (7 * (window.devicePixelRatio || 1)) / this.#scale;
    mark.points.forEach(([x, y], k) => {
      this.#dot(x, y, radius, '#fff');
      this.#dot(x, y, radius * 0.75, mark.point < 0 || k === mark.point ? '#b0186b' : '#7c8894');
    });
  }

  /** The sensors, and how far one of distance looks. @param {RobotState} state */
  #drawRays(state) {
    const robot = this.#robot;
    if (!robot) return;
    /** @type {Record<string, {x_cm: number, y_cm: number, heading: number, sees: string} | undefined>} */
    const places = robot.places;
    const sensors = robot.devices.filter((device) => device.role === 'sensor');
    sensors.forEach((device, k) => {
      const place = places[device.text];
      const reading = state.readings[k];
      if (!place || !reading) return;
      const pen = this.#context;
      const along = (place.heading * Math.PI) / 180;
      if (place.sees === 'distance') {
        pen.fillStyle = '#e0452f33';
        pen.beginPath();
        pen.moveTo(place.x_cm, place.y_cm);
        pen.arc(place.x_cm, place.y_cm, reading.value, along - CONE, along + CONE);
        pen.fill();
      } else if (place.sees === 'light') {
        this.#path([[place.x_cm, place.y_cm], [place.x_cm + 8 * Math.cos(along), place.y_cm + 8 * Math.sin(along)]], '#e08a1e', 0.8);
      } else {
        this.#dot(place.x_cm, place.y_cm, 1.4, reading.value ? '#c8372a' : '#7c8894');
      }
    });
  }

  /**
   * @param {number[][]} points
   * @param {string} color
   * @param {number} width
   * @param {boolean} [isClosed]
   */
  #path(points, color, width, isClosed = false) {
    const pen = this.#context;
    pen.beginPath();
    points.forEach(([x = 0, y = 0], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    if (isClosed) pen.closePath();
    pen.strokeStyle = color;
    pen.lineWidth = width;
    pen.stroke();
  }

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} radius
   * @param {string} color
   */
  #dot(x, y, radius, color) {
    const pen = this.#context;
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.fillStyle = color;
    pen.fill();
  }
}
