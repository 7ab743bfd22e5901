// Draws how values change over the robot's time. Knows numbers; what they mean, their names say.

import { drawPath } from '../page/shapes.js';

const MOST = 2000; // samples; then every other one is forgotten
const LEAST_ROW = 54; // pixels for one value
const LEFT = 6;
const LIGHT = { rule: '#c8d2dc', said: '#4a5663', behind: 'rgb(255 255 255 / 80%)', rows: ['#0b4f9e', '#a8200f', '#0d6040', '#7a4b00', '#5b2a86', '#00616b'] };
const DARK = { rule: '#3b4d5f', said: '#b8c5d1', behind: 'rgb(27 40 54 / 80%)', rows: ['#8cc0ff', '#ff9e90', '#62d49d', '#ffc76b', '#c9a6ff', '#6fd6e0'] };

/** @typedef {{name: string, value: number | undefined}} Value */

export class Plot {
  #canvas;
  /** @type {{at_ms: number, values: Map<string, number>}[]} */
  #samples = [];
  #colors = LIGHT;
  #every = 1; // of so many samples one is kept
  #left = 0; // samples until the next one that is kept

  /** @param {HTMLCanvasElement} canvas in an element that scrolls */
  constructor(canvas) {
    this.#canvas = canvas;
  }

  begin() {
    this.#samples = [];
    this.#every = 1;
    this.#left = 0;
  }

  /**
   * Takes what is to be seen at a time; later than the one before, or the same again.
   * @param {number} at_ms
   * @param {Value[]} values
   */
  add(at_ms, values) {
    const sample = { at_ms, values: new Map(values.flatMap(({ name, value }) => (value === undefined ? [] : [[name, value]]))) };
    if (this.#samples.at(-1)?.at_ms === at_ms) this.#samples.pop();
    else if (this.#left > 0) {
      this.#left -= 1;
      return;
    }
    this.#left = this.#every - 1;
    this.#samples.push(sample);
    if (this.#samples.length <= MOST) return;
    this.#samples = this.#samples.filter((_, k) => k % 2 === 0);
    this.#every *= 2;
  }

  /** @returns {string[]} names, in the order in which they came */
  get names() {
    return [...new Set(this.#samples.flatMap(({ values }) => [...values.keys()]))];
  }

  /** Draws all of it, if it is to be seen. @param {number | null} seen_ms when the moment was at which somebody looks */
  draw(seen_ms = null) {
    const canvas = this.#canvas;
    const place = canvas.parentElement;
    if (!place || place.hidden || !place.clientHeight) return; // what is hidden is not laid out for it
    const names = this.names;
    const row = Math.max(LEAST_ROW, Math.floor((place.clientHeight - 22) / Math.max(1, names.length)));
    canvas.style.height = `${Math.max(place.clientHeight, names.length * row + 20)}px`;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const pen = canvas.getContext('2d');
    if (!pen) return;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = '12px system-ui, sans-serif';
    const from = this.#samples[0]?.at_ms ?? 0;
    const until = Math.max(this.#samples.at(-1)?.at_ms ?? 0, from + 1000);
    const wide = canvas.clientWidth - 2 * LEFT;
    /** @param {number} at_ms */
    const x = (at_ms) => LEFT + ((at_ms - from) / (until - from)) * wide;
    const step = niceStep((until - from) / Math.max(2, wide / 70));
    this.#colors = document.documentElement.hasAttribute('data-dark') ? DARK : LIGHT;
    pen.fillStyle = this.#colors.said;
    for (let at = Math.ceil(from / step) * step; at <= until; at += step) {
      drawPath(pen, [[x(at), 0], [x(at), names.length * row]], this.#colors.rule, 1);
      const label = `${rounded(at / 1000)} s`;
      pen.fillText(label, Math.min(x(at) + 2, LEFT + wide - pen.measureText(label).width), names.length * row + 14);
    }
    if (seen_ms !== null) drawPath(pen, [[x(seen_ms), 0], [x(seen_ms), names.length * row]], this.#colors.said, 2);
    names.forEach((name, k) => this.#drawRow(pen, name, k * row, row, x, this.#colors.rows[k % this.#colors.rows.length] ?? ''));
  }

  /**
   * @param {CanvasRenderingContext2D} pen
   * @param {string} name
   * @param {number} top
   * @param {number} row its height
   * @param {(at_ms: number) => number} x
   * @param {string} color
   */
  #drawRow(pen, name, top, row, x, color) {
    let low = Infinity;
    let high = -Infinity;
    let last = 0;
    for (const { values } of this.#samples) {
      const value = values.get(name);
      if (value === undefined) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
      last = value;
    }
    const span = high - low || 1;
    const middle = high === low ? 0.5 : 0;
    /** @param {number} value */
    const y = (value) => top + row - 6 - ((value - low) / span + middle) * (row - 26);
    drawPath(pen, [[0, top + row - 0.5], [this.#canvas.clientWidth, top + row - 0.5]], this.#colors.rule, 1);
    pen.strokeStyle = color;
    pen.lineWidth = 1.8;
    pen.beginPath();
    let before;
    for (const { at_ms, values } of this.#samples) {
      const value = values.get(name);
      if (value === undefined) continue;
      if (before === undefined) pen.moveTo(x(at_ms), y(value));
      else {
        pen.lineTo(x(at_ms), y(before)); // it was that until now
        pen.lineTo(x(at_ms), y(value));
      }
      before = value;
    }
    pen.stroke();
    const range = low === high ? rounded(last) : `${rounded(low)} – ${rounded(high)}`;
    const label = `${name}: ${rounded(last)}  (${range})`;
    pen.fillStyle = this.#colors.behind;
    pen.fillRect(LEFT, top + 2, pen.measureText(label).width + 6, 16);
    pen.fillStyle = color;
    pen.fillText(label, LEFT + 3, top + 14);
  }
}

/**
 * A step of 1, 2 or 5 times a power of ten, of so much at least.
 * @param {number} least milliseconds
 */
function niceStep(least) {
  const power = 10 ** Math.floor(Math.log10(Math.max(least, 1)));
  return ([1, 2, 5].find((each) => each * power >= least) ?? 10) * power;
}

/** @param {number} value */
function rounded(value) {
  return String(Math.round(value * 1000) / 1000);
}
