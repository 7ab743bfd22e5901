// The line under the world: how a run was, at any moment of it.

import { element } from '../page/elements.js';
import { Run } from './runs.js';

/** @typedef {import('../python.js').RobotState} RobotState */

/** The color of each kind of mark, by its name in the style; what comes later is drawn over what comes before. */
const MARK_COLORS = { '': '--edge', KEYS: '--said-number', BEEP: '--said-warn', WHEN: '--said-right', SHOW: '--said-blue', BUMP: '--said-wrong', FAULT: '--said-wrong', PART: '--said-wrong' };
const EMPTY_RUN = new Run({ of: 'virtual', text: '', robot: '', program: '' }, { places: [], shows: [], variables: [] }, null);

export class TimeLine {
  /** That is seen. */
  #run = EMPTY_RUN;
  /** Of the robot's time, what is looked at; null: the newest moment. @type {number | null} */
  #cursor_ms = null;
  #slider = element('time_at', HTMLInputElement);
  #marksCanvas = element('time_marks', HTMLCanvasElement);
  #onSeek;
  #drawnMarksKey = ''; // of which marks the picture is
  #canvasSize = [0, 0]; // of the canvas, whose layout nobody waits for

  /** @param {() => void} onSeek another moment is looked at */
  constructor(onSeek) {
    this.#onSeek = onSeek;
    this.#slider.addEventListener('input', () => this.seek(Number(this.#slider.value)));
    this.#slider.addEventListener('keydown', (event) => {
      const direction = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
      if (!direction || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const { moments } = this.#run;
      this.seek(moments.at(moments.neighbourOf(this.#cursorMoment, direction, event.shiftKey ? moments.parts : moments.events)).now_ms);
    });
    new ResizeObserver(() => {
      this.#canvasSize = [this.#marksCanvas.clientWidth, this.#marksCanvas.clientHeight];
      this.#drawMarks();
    }).observe(this.#marksCanvas);
  }

  /** The run that is seen. */
  get run() {
    return this.#run;
  }

  /** How it was at the moment that is looked at; null: nobody looks back. @returns {RobotState | null} */
  get pastState() {
    return this.#cursor_ms === null ? null : this.#run.moments.at(this.#cursorMoment);
  }

  /** What each SHOW had shown last at the moment that is looked at, or has by now; the newest is the last. @returns {RobotState['events']} */
  get shownEvents() {
    const { shown = [] } = this.#run.moments.at(this.#cursorMoment);
    return [...shown, ...shown.toSorted(([a_ms], [b_ms]) => a_ms - b_ms)]; // a name keeps the place where it was first
  }

  get #cursorMoment() {
    return this.#run.moments.momentAt(this.#cursor_ms ?? Infinity);
  }

  /** @param {Run} [run] is seen from now on, as it is at its newest moment */
  setRun(run = EMPTY_RUN) {
    this.#run = run;
    this.returnToNewest();
    this.show();
  }

  /** The newest moment is seen again. */
  returnToNewest() {
    this.#cursor_ms = null;
  }

  /** Draws what there is. */
  show() {
    const { length, first_ms, last_ms } = this.#run.moments;
    this.#slider.disabled = length < 2;
    if (length < 2) {
      Object.assign(this.#slider, { min: '0', max: '0', value: '0' }); // it has no moment of the run before
      return;
    }
    if (this.#slider.min !== String(first_ms)) this.#slider.min = String(first_ms);
    if (this.#slider.max !== String(last_ms)) this.#slider.max = String(last_ms);
    const { now_ms, began_ms } = this.#run.moments.at(this.#cursorMoment);
    this.#slider.value = String(now_ms);
    const seconds = ((now_ms - (began_ms ?? now_ms)) / 1000).toFixed(1);
    this.#slider.setAttribute('aria-valuetext', `${seconds} s`);
    this.#drawMarks();
  }

  /** @param {number} at_ms of the robot's time, which is looked at from now on */
  seek(at_ms) {
    if (!this.#run.moments.length) return;
    this.#cursor_ms = at_ms;
    this.#onSeek();
  }

  #drawMarks() {
    const canvas = this.#marksCanvas;
    const [width, height] = this.#canvasSize;
    if (!width) return; // it is hidden
    const pen = canvas.getContext('2d');
    if (!pen) return;
    const ratio = window.devicePixelRatio || 1;
    const { moments: { first_ms, last_ms }, marks } = this.#run;
    const marksKey = [this.#run.number, first_ms, last_ms, marks.length, width, height, ratio, document.documentElement.hasAttribute('data-dark')].join();
    if (marksKey === this.#drawnMarksKey) return;
    this.#drawnMarksKey = marksKey;
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const pixelsPerMs = (canvas.width - 2 * ratio) / Math.max(1, last_ms - first_ms);
    const style = getComputedStyle(canvas);
    for (const [kind, color] of Object.entries(MARK_COLORS)) {
      const markHeight = kind ? canvas.height : canvas.height / 2;
      pen.fillStyle = style.getPropertyValue(color);
      const xPositions = marks.filter((mark) => mark.kind === kind && mark.at_ms >= first_ms).map(({ at_ms }) => Math.round((at_ms - first_ms) * pixelsPerMs));
      for (const x of new Set(xPositions)) pen.fillRect(x, canvas.height - markHeight, (kind === 'PART' ? 4 : 2) * ratio, markHeight);
    }
  }
}
