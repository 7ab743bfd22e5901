// Draws how values change over the robot's time. Knows numbers; what they mean, their names say.

import { drawPath } from '../page/shapes.js';

const MAX_SAMPLES = 2000; // samples; then every other one is forgotten
const MIN_ROW_PX = 54; // pixels for one value
const MARGIN_PX = 6;
const LIGHT_COLORS = { rule: '#c8d2dc', label: '#4a5663', labelBackground: 'rgb(255 255 255 / 80%)', rows: ['#0b4f9e', '#a8200f', '#0d6040', '#7a4b00', '#5b2a86', '#00616b'] };
const DARK_COLORS = { rule: '#3b4d5f', label: '#b8c5d1', labelBackground: 'rgb(27 40 54 / 80%)', rows: ['#8cc0ff', '#ff9e90', '#62d49d', '#ffc76b', '#c9a6ff', '#6fd6e0'] };

/** @typedef {{name: string, value: number | undefined}} Value */

export class Plot {
  #canvas;
  /** @type {{at_ms: number, values: Map<string, number>}[]} */
  #samples = [];
  #colors = LIGHT_COLORS;
  #keptInterval = 1; // of so many samples one is kept
  #skipCount = 0; // samples until the next one that is kept

  /** @param {HTMLCanvasElement} canvas in an element that scrolls */
  constructor(canvas) {
    this.#canvas = canvas;
  }

  clear() {
    this.#samples = [];
    this.#keptInterval = 1;
    this.#skipCount = 0;
  }

  /**
   * Takes what is to be seen at a time; later than the one before, or the same again.
   * @param {number} at_ms
   * @param {Value[]} values
   */
  add(at_ms, values) {
    const sample = { at_ms, values: new Map(values.flatMap(({ name, value }) => (value === undefined ? [] : [[name, value]]))) };
    if (this.#samples.at(-1)?.at_ms === at_ms) this.#samples.pop();
    else if (this.#skipCount > 0) {
      this.#skipCount -= 1;
      return;
    }
    this.#skipCount = this.#keptInterval - 1;
    this.#samples.push(sample);
    if (this.#samples.length <= MAX_SAMPLES) return;
    this.#samples = this.#samples.filter((_, index) => index % 2 === 0);
    this.#keptInterval *= 2;
  }

  /** @returns {string[]} names, in the order in which they came */
  get names() {
    return [...new Set(this.#samples.flatMap(({ values }) => [...values.keys()]))];
  }

  /** Draws all of it, if it is to be seen. @param {number | null} cursor_ms when the moment was at which somebody looks */
  draw(cursor_ms = null) {
    const canvas = this.#canvas;
    const container = canvas.parentElement;
    if (!container || container.hidden || !container.clientHeight) return; // what is hidden is not laid out for it
    const names = this.names;
    const rowHeight = Math.max(MIN_ROW_PX, Math.floor((container.clientHeight - 22) / Math.max(1, names.length)));
    canvas.style.height = `${Math.max(container.clientHeight, names.length * rowHeight + 20)}px`;
    const ratio = window.devicePixelRatio || 1;
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const pen = canvas.getContext('2d');
    if (!pen) return;
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = '12px system-ui, sans-serif';
    const from_ms = this.#samples[0]?.at_ms ?? 0;
    const until_ms = Math.max(this.#samples.at(-1)?.at_ms ?? 0, from_ms + 1000);
    const plotWidth = canvas.clientWidth - 2 * MARGIN_PX;
    /** @param {number} at_ms */
    const xOf = (at_ms) => MARGIN_PX + ((at_ms - from_ms) / (until_ms - from_ms)) * plotWidth;
    const step_ms = niceStep((until_ms - from_ms) / Math.max(2, plotWidth / 70));
    this.#colors = document.documentElement.hasAttribute('data-dark') ? DARK_COLORS : LIGHT_COLORS;
    pen.fillStyle = this.#colors.label;
    for (let tick_ms = Math.ceil(from_ms / step_ms) * step_ms; tick_ms <= until_ms; tick_ms += step_ms) {
      drawPath(pen, [[xOf(tick_ms), 0], [xOf(tick_ms), names.length * rowHeight]], this.#colors.rule, 1);
      const label = `${roundText(tick_ms / 1000)} s`;
      pen.fillText(label, Math.min(xOf(tick_ms) + 2, MARGIN_PX + plotWidth - pen.measureText(label).width), names.length * rowHeight + 14);
    }
    if (cursor_ms !== null) drawPath(pen, [[xOf(cursor_ms), 0], [xOf(cursor_ms), names.length * rowHeight]], this.#colors.label, 2);
    names.forEach((name, index) => this.#drawRow(pen, name, index * rowHeight, rowHeight, xOf, this.#colors.rows[index % this.#colors.rows.length] ?? ''));
  }

  /**
   * @param {CanvasRenderingContext2D} pen
   * @param {string} name
   * @param {number} top
   * @param {number} rowHeight its height
   * @param {(at_ms: number) => number} xOf
   * @param {string} color
   */
  #drawRow(pen, name, top, rowHeight, xOf, color) {
    let low = Infinity;
    let high = -Infinity;
    let lastValue = 0;
    for (const { values } of this.#samples) {
      const value = values.get(name);
      if (value === undefined) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
      lastValue = value;
    }
    const span = high - low || 1;
    const centering = high === low ? 0.5 : 0;
    /** @param {number} value */
    const yOf = (value) => top + rowHeight - 6 - ((value - low) / span + centering) * (rowHeight - 26);
    drawPath(pen, [[0, top + rowHeight - 0.5], [this.#canvas.clientWidth, top + rowHeight - 0.5]], this.#colors.rule, 1);
    pen.strokeStyle = color;
    pen.lineWidth = 1.8;
    pen.beginPath();
    let previous;
    for (const { at_ms, values } of this.#samples) {
      const value = values.get(name);
      if (value === undefined) continue;
      if (previous === undefined) pen.moveTo(xOf(at_ms), yOf(value));
      else {
        pen.lineTo(xOf(at_ms), yOf(previous)); // it was that until now
        pen.lineTo(xOf(at_ms), yOf(value));
      }
      previous = value;
    }
    pen.stroke();
    const range = low === high ? roundText(lastValue) : `${roundText(low)} – ${roundText(high)}`;
    const label = `${name}: ${roundText(lastValue)}  (${range})`;
    pen.fillStyle = this.#colors.labelBackground;
    pen.fillRect(MARGIN_PX, top + 2, pen.measureText(label).width + 6, 16);
    pen.fillStyle = color;
    pen.fillText(label, MARGIN_PX + 3, top + 14);
  }
}

/**
 * A step of 1, 2 or 5 times a power of ten, of so much at least.
 * @param {number} least_ms milliseconds
 */
function niceStep(least_ms) {
  const power = 10 ** Math.floor(Math.log10(Math.max(least_ms, 1)));
  return ([1, 2, 5].find((factor) => factor * power >= least_ms) ?? 10) * power;
}

/** @param {number} value */
function roundText(value) {
  return String(Math.round(value * 1000) / 1000);
}
