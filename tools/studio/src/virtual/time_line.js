// The line under the world: how the run was, at any moment of it.

import { element } from '../page/elements.js';
import { Moments } from './moments.js';

/** @typedef {import('../python.js').RobotState} RobotState */

/** The color of each kind of mark; what comes later is drawn over what comes before. */
const COLORS = { '': '#8593a0', BEEP: '#8a5a00', SHOW: '#0b66c2', BUMP: '#c0281a', FAULT: '#c0281a' };
const MOST_MARKS = 10_000;

export class TimeLine {
  #moments = new Moments();
  /** Of the robot's time, what is looked at; null: the newest moment. @type {number | null} */
  #looked_ms = null;
  /** @type {{at_ms: number, kind: string}[]} */
  #marks = [];
  #bumps = 0;
  #line = element('time_at', HTMLInputElement);
  #canvas = element('time_marks', HTMLCanvasElement);
  #changed;

  /** @param {() => void} changed another moment is looked at */
  constructor(changed) {
    this.#changed = changed;
    this.#line.addEventListener('input', () => this.#look(Number(this.#line.value)));
    this.#line.addEventListener('keydown', (event) => {
      const ways = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!ways || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const which = event.shiftKey ? this.#moments.parts : this.#moments.events;
      this.#look(this.#moments.at(this.#moments.beside(this.#at, ways, which)).now_ms);
    });
    new ResizeObserver(() => this.#drawMarks()).observe(this.#canvas);
  }

  /** How it was at the moment that is looked at; null: nobody looks back. @returns {RobotState | null} */
  get seen() {
    return this.#looked_ms === null ? null : this.#moments.at(this.#at);
  }

  /** What had been shown then. */
  get shows() {
    return this.#moments.shows(this.#at);
  }

  get #at() {
    return this.#moments.until(this.#looked_ms ?? Infinity);
  }

  begin() {
    this.#moments.begin();
    this.#marks = [];
    this.#bumps = 0;
    this.leave();
    this.show();
  }

  /** @param {RobotState} state the next one of the run */
  add(state) {
    for (const [at_ms, what] of state.events) {
      const [word = ''] = what.split(' ');
      this.#marks.push({ at_ms, kind: word in COLORS ? word : '' });
    }
    if (state.bumps > this.#bumps) this.#marks.push({ at_ms: state.now_ms, kind: 'BUMP' });
    this.#bumps = state.bumps;
    if (this.#marks.length > MOST_MARKS) this.#marks.splice(0, MOST_MARKS / 2);
    this.#moments.add(state);
  }

  /** The newest moment is seen again. */
  leave() {
    this.#looked_ms = null;
  }

  /** Draws what there is. */
  show() {
    const { length, first_ms, last_ms } = this.#moments;
    this.#line.disabled = length < 2;
    if (length < 2) return;
    Object.assign(this.#line, { min: String(first_ms), max: String(last_ms) });
    const { now_ms, began_ms } = this.#moments.at(this.#at);
    this.#line.value = String(now_ms);
    const seconds = ((now_ms - (began_ms ?? now_ms)) / 1000).toFixed(1);
    this.#line.setAttribute('aria-valuetext', `${seconds} s`);
    this.#drawMarks();
  }

  /** @param {number} at_ms */
  #look(at_ms) {
    if (!this.#moments.length) return;
    this.#looked_ms = at_ms;
    this.#changed();
  }

  #drawMarks() {
    const canvas = this.#canvas;
    if (!canvas.clientWidth) return; // it is hidden
    const pen = canvas.getContext('2d');
    if (!pen) return;
    const ratio = window.devicePixelRatio || 1;
    Object.assign(canvas, { width: Math.round(canvas.clientWidth * ratio), height: Math.round(canvas.clientHeight * ratio) });
    const { first_ms, last_ms } = this.#moments;
    const wide = (canvas.width - 2 * ratio) / Math.max(1, last_ms - first_ms);
    for (const [kind, color] of Object.entries(COLORS)) {
      const height = kind ? canvas.height : canvas.height / 2;
      pen.fillStyle = color;
      const places = this.#marks.filter((mark) => mark.kind === kind && mark.at_ms >= first_ms).map(({ at_ms }) => Math.round((at_ms - first_ms) * wide));
      for (const x of new Set(places)) pen.fillRect(x, canvas.height - height, 2 * ratio, height);
    }
  }
}
