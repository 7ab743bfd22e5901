// Draws a world and the robot in it. Knows shapes; what a robot does, the firmware decides.

import { Moods } from './moods.js';
import { drawRival, drawRobot } from './robot_drawing.js';
import { COLOURS } from '../page/own_robot.js';
import { pageState } from '../page/page_state.js';
import { drawDot, drawPath } from '../page/shapes.js';
import { robotOf, ROBOTS, WORLDS } from '../page/words.js';
import { drawLitTile, drawSolids, drawWorld } from '../world/floor.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @import { World, Point } from '../world/parts.js' */
/** @typedef {{points: Point[], pointIndex: number, handle: Point | null}} FloorMark the points that can be taken, which one is, and what turns it */
/** @typedef {import('../world/floor.js').Goal} Goal */
/** @typedef {import('../page/shapes.js').Pen} Pen */

const REDUCED_MOTION_QUERY = matchMedia('(prefers-reduced-motion: reduce)');
const MARGIN_CM = 4;
const MIN_ROBOT_PX = 72; // pixels of a robot that the camera follows,
const MAX_ROBOT_SHARE = 0.4; // unless that is more of the picture's shorter side
const BEHIND_HEIGHT_SHARE = 0.78; // of the picture's height is ahead of a robot that is seen from behind
const BEHIND_ZOOM = 1.7; // than from above: what is far is small then
/** @typedef {'whole' | 'near' | 'behind'} Camera */
const FINGER_PX = 22; // pixels that a finger may miss
const MAX_TRACK_POINTS = 5000; // of a way
const MAX_OLD_TRACKS = 4; // of runs before, which are pale
const SHAKE_MS = 240;
const BUBBLE_MS = 2500; // of the robot's time, for what it shows

export class Arena {
  #canvas;
  #pen;
  /** The world and the ways, which stay the same from one picture to the next. */
  #floorCanvas = document.createElement('canvas');
  #isFloorDrawn = false;
  #drawnPointCount = 0; // points of the newest way that are on the floor
  #world = WORLDS[0];
  #robot = ROBOTS[0];
  /** @type {Goal[]} */
  #goals = [];
  /** Where it stands until it says so. @type {RobotState['pose'] | null} */
  #pose = null;
  /** What its pen has drawn, the newest run last. @type {[number, number][][]} */
  #tracks = [[]];
  /** How far each wheel has turned, in cm. @type {[number, number]} */
  #rolled_cm = [0, 0];
  #lastState_ms = 0; // of the robot's time
  /** From when to when it beeps. @type {[number, number]} */
  #beepTimes_ms = [0, 0];
  #takenFlagCount = 0;
  #moods = new Moods();
  /** What it has shown last, and when. @type {[string, number]} */
  #bubble = ['', 0];
  /** @type {Camera} */
  #camera = 'whole';
  #scale = 1; // pixels of the canvas for a centimetre
  #floorToCanvas = new DOMMatrix(); // from the floor, in centimetres, to the canvas
  /** What is chosen to be changed. @type {FloorMark | null} */
  #floorMark = null;

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
   * @param {string} robotName
   * @param {Goal[]} goals where a task leads
   * @param {RobotState['pose'] | null} pose where it stands, if not at the start
   */
  begin(world, robotName, goals, pose = null) {
    if (world !== this.#world || robotName !== this.#robot?.name) this.#tracks = [];
    this.#world = world;
    this.#goals = goals;
    this.#pose = pose;
    this.#robot = robotOf(robotName) ?? ROBOTS[0];
    this.#tracks = [...this.#tracks.filter((track) => track.length > 1), []].slice(-1 - MAX_OLD_TRACKS);
    this.#rolled_cm = [0, 0];
    this.#lastState_ms = 0;
    this.#beepTimes_ms = [0, 0];
    this.#takenFlagCount = 0;
    this.#moods.reset();
    this.#bubble = ['', 0];
    this.#isFloorDrawn = false;
  }

  /** Its robot is glad, until the next run. */
  cheer() {
    this.#moods.cheer();
  }

  /** Whether it shows that its robot has just bumped into something. @param {RobotState} state */
  isDizzy(state) {
    return !state.fault && this.#moods.faceOf(state).mood === 'dizzy';
  }

  /** Takes what its pen has drawn off the floor. */
  eraseTracks() {
    this.#tracks = [[]];
    this.#isFloorDrawn = false;
  }

  /**
   * Goes on to a newer state.
   * @param {RobotState} state
   */
  followState(state) {
    this.#moods.followState(state);
    const [x, y] = state.pose;
    const track = this.#tracks.at(-1) ?? [];
    const lastPoint = track.at(-1);
    if (!lastPoint || Math.hypot(lastPoint[0] - x, lastPoint[1] - y) > 0.5) track.push([x, y]);
    if (track.length > MAX_TRACK_POINTS) {
      track.splice(0, MAX_TRACK_POINTS / 2);
      this.#isFloorDrawn = false;
    }
    const elapsed_s = Math.max(0, state.now_ms - this.#lastState_ms) / 1000;
    const percentSpeed = (this.#robot?.speed_cm_s ?? 0) / 100;
    this.#lastState_ms = state.now_ms;
    this.#rolled_cm[0] += state.motors[0] * percentSpeed * elapsed_s;
    this.#rolled_cm[1] += state.motors[1] * percentSpeed * elapsed_s;
  }

  /** @param {number} from_ms of the robot's time @param {number} until_ms */
  showBeep(from_ms, until_ms) {
    this.#beepTimes_ms = [from_ms, until_ms];
  }

  /** @param {string} text @param {number} at_ms of the robot's time */
  showBubble(text, at_ms) {
    this.#bubble = [text, at_ms];
  }

  /** Shakes the picture, unless this person wants nothing to move. */
  shake() {
    if (REDUCED_MOTION_QUERY.matches || this.#canvas.getAnimations().length) return;
    const offsets = ['0 0', '5px 2px', '-5px -2px', '3px -1px', '0 0'];
    this.#canvas.animate(offsets.map((translate) => ({ translate })), SHAKE_MS);
  }

  /** @param {FloorMark | null} floorMark */
  setMark(floorMark) {
    if (Boolean(floorMark) !== Boolean(this.#floorMark)) this.#isFloorDrawn = false; // a grid
    this.#floorMark = floorMark;
  }

  /**
   * Returns the place on the floor under a finger, and how far it may miss.
   * @param {PointerEvent} event
   * @returns {{place: Point, reach_cm: number}}
   */
  floorAt(event) {
    const bounds = this.#canvas.getBoundingClientRect();
    const ratio = this.#canvas.width / bounds.width;
    const { x, y } = this.#floorToCanvas.inverse().transformPoint({ x: (event.clientX - bounds.left) * ratio, y: (event.clientY - bounds.top) * ratio });
    return { place: [x, y], reach_cm: (FINGER_PX * ratio) / this.#scale };
  }

  /** @param {RobotState | null} state */
  draw(state) {
    const world = this.#world;
    if (!world) return;
    const { width, height } = this.#canvas;
    const { start } = world;
    const [x, y, heading] = state?.pose ?? this.#pose ?? [start.x_cm, start.y_cm, start.heading];
    this.#placeCamera(world, x, y, heading);
    const takenFlagCount = state?.score?.taken ?? 0;
    if (takenFlagCount !== this.#takenFlagCount) this.#isFloorDrawn = false;
    this.#takenFlagCount = takenFlagCount;
    this.#drawFloor(world);
    const pen = this.#pen;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.setTransform(this.#floorToCanvas);
    pen.scale(1 / this.#scale, -1 / this.#scale);
    pen.drawImage(this.#floorCanvas, -MARGIN_CM * this.#scale, -(world.height_cm + MARGIN_CM) * this.#scale);
    pen.setTransform(this.#floorToCanvas);
    pen.lineCap = pen.lineJoin = 'round';
    drawLitTile(pen, world, x, y);
    if (this.#isFromBehind) {
      pen.setTransform(1, 0, 0, 1, 0, 0);
      drawSolids(pen, world, this.#floorToCanvas, this.#scale);
      pen.setTransform(this.#floorToCanvas);
    }
    world.rivals.forEach((rival, index) => drawRival(pen, rival, state?.rivals[index] ?? [rival.x_cm, rival.y_cm, rival.heading]));
    this.#drawBody(x, y, heading, state);
    this.#drawMark();
  }

  get #isFromBehind() {
    return this.#camera === 'behind' && !this.#floorMark;
  }

  /**
   * Says where on the canvas the floor is. A robot that is changed by a finger is seen with all of its floor.
   * @param {World} world @param {number} x @param {number} y @param {number} heading of the robot
   */
  #placeCamera({ width_cm, height_cm, flags }, x, y, heading) {
    const { width, height } = this.#canvas;
    const wholeSize = [width_cm + 2 * MARGIN_CM, height_cm + 2 * MARGIN_CM];
    const wholeScale = Math.min(width / (wholeSize[0] ?? 1), height / (wholeSize[1] ?? 1));
    const camera = this.#floorMark ? 'whole' : this.#camera;
    const robotLength = Math.max(...(this.#robot?.outline ?? [[1]]).map(([ahead = 0]) => ahead)) - Math.min(...(this.#robot?.outline ?? [[0]]).map(([ahead = 0]) => ahead));
    const robotSize_px = Math.min(MIN_ROBOT_PX * (window.devicePixelRatio || 1), MAX_ROBOT_SHARE * Math.min(width, height));
    const scale = camera === 'whole' ? wholeScale : Math.max(wholeScale, (robotSize_px * (camera === 'behind' ? BEHIND_ZOOM : 1)) / robotLength);
    if (Math.abs(scale - this.#scale) > 1e-9 || this.#floorCanvas.width !== Math.ceil((wholeSize[0] ?? 0) * scale)) {
      this.#scale = scale;
      Object.assign(this.#floorCanvas, { width: Math.ceil((wholeSize[0] ?? 0) * scale), height: Math.ceil((wholeSize[1] ?? 0) * scale) });
      this.#isFloorDrawn = false;
    }
    if (camera === 'behind') {
      this.#floorToCanvas = new DOMMatrix().translate(width / 2, height * BEHIND_HEIGHT_SHARE).scale(scale, -scale).rotate(90 - heading).translate(-x, -y);
      return;
    }
    const margin = MARGIN_CM * scale, floorHeight = height_cm * scale + margin;
    const places = [...this.#goals, ...flags].map((place) => /** @type {Point} */ ([place.x_cm, place.y_cm]));
    const middleX = viewCenterOf(x, places.map(([placeX]) => placeX), width / scale, robotLength), middleY = viewCenterOf(y, places.map(([, placeY]) => placeY), height / scale, robotLength);
    const left = edgeOf(width / 2 - middleX * scale, width, width_cm * scale, margin);
    const bottom = height - edgeOf(height / 2 - middleY * scale, height, height_cm * scale, margin);
    // Whole pixels of the floor are on whole ones of the picture: else it would be blurred.
    this.#floorToCanvas = new DOMMatrix([scale, 0, 0, -scale, Math.round(left - margin) + margin, Math.round(bottom - floorHeight) + floorHeight]);
  }

  /** Draws what is new on the floor, or all of it where it has become another one. @param {World} world */
  #drawFloor(world) {
    const pen = penOf(this.#floorCanvas);
    if (!this.#isFloorDrawn) {
      pen.setTransform(1, 0, 0, 1, 0, 0);
      pen.clearRect(0, 0, this.#floorCanvas.width, this.#floorCanvas.height);
      this.#useFloorUnits(pen, world);
      drawWorld(pen, world, this.#goals, this.#takenFlagCount, this.#floorMark !== null);
      for (const oldTrack of this.#tracks.slice(0, -1)) drawPath(pen, oldTrack, '#bcd2ea', 1);
      this.#drawnPointCount = 0;
      this.#isFloorDrawn = true;
    }
    const track = this.#tracks.at(-1) ?? [];
    if (track.length > this.#drawnPointCount) drawPath(pen, track.slice(Math.max(0, this.#drawnPointCount - 1)), '#2f74c0', 1);
    this.#drawnPointCount = track.length;
  }

  /** Centimetres from the lower left corner of the floor; y goes up. @param {Pen} pen @param {World} world */
  #useFloorUnits(pen, { height_cm }) {
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
    const [from_ms, until_ms] = this.#beepTimes_ms;
    const isBeeping = state !== null && state.is_running && from_ms <= state.now_ms && state.now_ms < until_ms;
    const face = this.#moods.faceOf(state);
    const isMotionReduced = REDUCED_MOTION_QUERY.matches;
    const { name, colour } = pageState.ownRobot.value;
    drawRobot(pen, robot, state, { rolled_cm: this.#rolled_cm, isBeeping, face: isMotionReduced ? { ...face, isBlinking: false } : face, colours: COLOURS[colour] ?? COLOURS[0] });
    pen.restore();
    if (name && !state?.is_running) this.#drawName(x, y, name);
    if (state?.touches) this.#drawStar(...state.touches);
    const [bubbleText, at_ms] = this.#bubble;
    if (bubbleText && state && (!state.is_running || state.now_ms - at_ms < BUBBLE_MS)) this.#drawBubble(x, y, bubbleText);
  }

  /** Below a robot that stands. @param {number} x @param {number} y @param {string} name */
  #drawName(x, y, name) {
    const pen = this.#pen, fontSize_px = 13 * (window.devicePixelRatio || 1);
    const { x: robotX, y: robotY } = this.#floorToCanvas.transformPoint({ x, y });
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${fontSize_px}px system-ui, sans-serif`;
    const width = pen.measureText(name).width;
    const textX = Math.max(2, Math.min(robotX - width / 2, this.#canvas.width - width - 2));
    const textY = Math.min(robotY + 12 * this.#scale + fontSize_px, this.#canvas.height - 4);
    Object.assign(pen, { strokeStyle: '#fff', fillStyle: '#123b63', lineWidth: fontSize_px / 4, lineJoin: 'round' });
    pen.strokeText(name, textX, textY);
    pen.fillText(name, textX, textY);
    pen.restore();
  }

  /** A bubble beside the robot, inside the picture. @param {number} x @param {number} y @param {string} text */
  #drawBubble(x, y, text) {
    const pen = this.#pen;
    const scale = this.#scale;
    const fontSize_px = 15 * (window.devicePixelRatio || 1);
    pen.save();
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.font = `600 ${fontSize_px}px system-ui, sans-serif`;
    const width = pen.measureText(text).width + fontSize_px, height = 1.6 * fontSize_px;
    const { x: robotX, y: robotY } = this.#floorToCanvas.transformPoint({ x, y });
    const bubbleX = Math.max(2, Math.min(robotX + 0.5 * fontSize_px, this.#canvas.width - width - 2));
    const isBelow = robotY - 12 * scale - height < 2;
    const bubbleY = isBelow ? robotY + 12 * scale : robotY - 12 * scale - height;
    pen.beginPath();
    pen.roundRect(bubbleX, bubbleY, width, height, 0.5 * fontSize_px);
    pen.fillStyle = '#fff';
    pen.strokeStyle = '#123b63';
    pen.lineWidth = fontSize_px / 8;
    pen.fill();
    pen.stroke();
    pen.fillStyle = '#123b63';
    pen.fillText(text, bubbleX + 0.5 * fontSize_px, bubbleY + 1.15 * fontSize_px);
    pen.restore();
  }

  /** Where it touches something. @param {number} x @param {number} y */
  #drawStar(x, y) {
    const points = Array.from({ length: 16 }, (_, index) => {
      const angle = (index * Math.PI) / 8, radius = index % 2 ? 2.4 : 6;
      return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
    });
    drawPath(this.#pen, points, '#a8200f', 0.6, '#ffd84d');
  }

  #drawMark() {
    const floorMark = this.#floorMark;
    if (!floorMark) return;
    const pen = this.#pen;
    drawPath(pen, floorMark.points, '#b0186b', 0.6);
    const radius = (7 * (window.devicePixelRatio || 1)) / this.#scale;
    const [center] = floorMark.points, { handle } = floorMark;
    if (handle && center) {
      drawPath(pen, [center, handle], '#b0186b', 0.6);
      drawDot(pen, ...handle, radius * 1.3, '#b0186b');
      pen.beginPath();
      pen.arc(...handle, radius * 0.7, 0.6, 5.4);
      pen.strokeStyle = '#fff';
      pen.lineWidth = radius / 4;
      pen.stroke();
    }
    floorMark.points.forEach(([x, y], index) => {
      drawDot(pen, x, y, radius, '#fff');
      drawDot(pen, x, y, radius * 0.75, floorMark.pointIndex < 0 || index === floorMark.pointIndex ? '#b0186b' : '#7c8894');
    });
  }
}

/**
 * What is in the middle of a picture: halfway to where a task leads, as long as the robot is seen whole.
 * @param {number} robotPlace along one side @param {number[]} places where the task leads @param {number} size of the picture @param {number} robotLength
 */
export function viewCenterOf(robotPlace, places, size, robotLength) {
  if (!places.length) return robotPlace;
  const mostOffset = Math.max(0, size / 2 - robotLength), offset = (places.reduce((sum, place) => sum + place, 0) / places.length - robotPlace) / 2;
  return robotPlace + Math.max(-mostOffset, Math.min(mostOffset, offset));
}

/**
 * Where the edge of a floor is, so that its robot is in the middle of the picture, unless more would be beside the floor.
 * @param {number} wantedEdge @param {number} availableSize @param {number} size of the floor @param {number} margin around it
 */
function edgeOf(wantedEdge, availableSize, size, margin) {
  if (size + 2 * margin <= availableSize + 1e-6) return (availableSize - size) / 2;
  return Math.min(margin, Math.max(availableSize - size - margin, wantedEdge));
}

/** @param {HTMLCanvasElement} canvas @returns {Pen} */
function penOf(canvas) {
  const pen = canvas.getContext('2d');
  if (!pen) throw new Error('no canvas');
  return pen;
}
