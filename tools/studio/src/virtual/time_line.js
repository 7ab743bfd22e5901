// The line under the world: how a run was, at any moment of it.

import { element } from '../page/elements.js';
import { Run } from './runs.js';

/** @typedef {import('../python.js').RobotState} RobotState */

/** The color of each kind of mark, by its name in the style; what comes later is drawn over what comes before. */
const COLORS = { '': '--edge', KEYS: '--said-number', BEEP: '--said-warn', WHEN: '--said-right', SHOW: '--said-blue', BUMP: '--said-wrong', FAULT: '--said-wrong', PART: '--said-wrong' };
const NOTHING = new Run({ of: 'virtual', text: '', robot: '', program: '' }, { places: [], shows: [], variables: [] }, null);

export class TimeLine {
  /** That is seen. */
  #run = NOTHING;
  /** Of the robot's time, what is looked at; null: the newest moment. @type {number | null} */
  #looked_ms = null;
  #line = element('time_at', HTMLInputElement);
  #canvas = element('time_marks', HTMLCanvasElement);
  #changed;
  #drawn = ''; // of which marks the picture is
  #size = [0, 0]; // of the canvas, whose layout nobody waits for

  /** @param {() => void} changed another moment is looked at */
  constructor(changed) {
    this.#changed = changed;
    this.#line.addEventListener('input', () => this.look(Number(this.#line.value)));
    this.#line.addEventListener('keydown', (event) => {
      const ways = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!ways || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const { moments } = this.#run;
      this.look(moments.at(moments.beside(this.#at, ways, event.shiftKey ? moments.parts : moments.events)).now_ms);
    });
    new ResizeObserver(() => {
      this.#size = [this.#canvas.clientWidth, this.#canvas.clientHeight];
      this.#drawMarks();
    }).observe(this.#canvas);
  }

  /** The run that is seen. */
  get run() {
    return this.#run;
  }

  /** How it was at the moment that is looked at; null: nobody looks back. @returns {RobotState | null} */
  get seen() {
    return this.#looked_ms === null ? null : this.#run.moments.at(this.#at);
  }

  /** What had been shown then. */
  get shows() {
    return this.#run.moments.shows(this.#at);
  }

  get #at() {
    return this.#run.moments.until(this.#looked_ms ?? Infinity);
  }

  /** @param {Run} [run] is seen from now on, as it is at its newest moment */
  begin(run = NOTHING) {
    this.#run = run;
    this.leave();
    this.show();
  }

  /** The newest moment is seen again. */
  leave() {
    this.#looked_ms = null;
  }

  /** Draws what there is. */
  show() {
    const { length, first_ms, last_ms } = this.#run.moments;
    this.#line.disabled = length < 2;
    if (length < 2) return;
    Object.assign(this.#line, { min: String(first_ms), max: String(last_ms) });
    const { now_ms, began_ms } = this.#run.moments.at(this.#at);
    this.#line.value = String(now_ms);
    const seconds = ((now_ms - (began_ms ?? now_ms)) / 1000).toFixed(1);
    this.#line.setAttribute('aria-valuetext', `${seconds} s`);
    this.#drawMarks();
  }

  /** @param {number} at_ms of the robot's time, which is looked at from now on */
  look(at_ms) {
    if (!this.#run.moments.length) return;
    this.#looked_ms = at_ms;
    this.#changed();
  }

  #drawMarks() {
    const canvas = this.#canvas;
    const [width, height] = this.#size;
    if (!width) return; // it is hidden
    const pen = canvas.getContext('2d');
    if (!pen) return;
    const ratio = window.devicePixelRatio || 1;
    const { moments: { first_ms, last_ms }, marks } = this.#run;
    const seen = [this.#run.number, first_ms, last_ms, marks.length, width, height, ratio, document.documentElement.hasAttribute('data-dark')].join();
    if (seen === this.#drawn) return;
    this.#drawn = seen;
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const wide = (canvas.width - 2 * ratio) / Math.max(1, last_ms - first_ms);
    const style = getComputedStyle(canvas);
    for (const [kind, color] of Object.entries(COLORS)) {
      const height = kind ? canvas.height : canvas.height / 2;
      pen.fillStyle = style.getPropertyValue(color);
      const places = marks.filter((mark) => mark.kind === kind && mark.at_ms >= first_ms).map(({ at_ms }) => Math.round((at_ms - first_ms) * wide));
      for (const x of new Set(places)) pen.fillRect(x, canvas.height - height, (kind === 'PART' ? 4 : 2) * ratio, height);
    }
  }
}
