// What a screen reader hears of a run: where the robot is, what it bumps into, which flags it takes.
// Knows the robot's state; shows nothing.

import { element } from '../page/elements.js';
import { text } from '../page/texts.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {import('./simulator.js').Phase} Phase */

const EVERY_MS = 5000; // of this computer's time, while it drives
const WAYS = /** @type {const} */ (['where_right', 'where_up_right', 'where_up', 'where_up_left', 'where_left', 'where_down_left', 'where_down', 'where_down_right']);
const STARS = 3;

export class Where {
  #said = element('where', HTMLElement);
  #last = 0;
  /** @type {Phase} */
  #phase = 'off';
  #bumps = 0;
  #taken = 0;

  /** @param {RobotState | null} state @param {Phase} phase */
  tell(state, phase) {
    const before = this.#phase;
    this.#phase = phase;
    if (!state || phase === 'off') {
      this.#bumps = this.#taken = 0;
      this.#last = performance.now();
      return;
    }
    const { bumps, score } = state;
    const taken = score?.taken ?? 0;
    const isNew = phase !== before && (phase === 'ended' || phase === 'paused');
    const found = [];
    if (bumps > this.#bumps && !isNew) found.push(text('where_bump'));
    if (taken > this.#taken && !isNew) found.push(text('score_flags', { taken, of: score?.of ?? 0 }));
    this.#bumps = bumps;
    this.#taken = taken;
    const isLate = phase === 'running' && performance.now() - this.#last > EVERY_MS;
    if (!found.length && !isNew && !isLate) return;
    this.#last = performance.now();
    if (isNew && bumps) found.push(text('where_bumps', { count: bumps }));
    if (isNew && score) found.push(scoreSaid(score));
    this.#said.textContent = [...found, placeSaid(state.pose)].join(' ');
  }
}

/** @param {number[]} pose */
function placeSaid([x = 0, y = 0, heading = 0]) {
  const way = WAYS.at(Math.round((heading * WAYS.length) / 360) % WAYS.length) ?? 'where_right';
  return text('where_is', { x: Math.round(x), y: Math.round(y), way: text(way) });
}

/** @param {NonNullable<RobotState['score']>} score what a run is worth, for eyes and ears */
function scoreSaid({ stars, points, taken, of }) {
  const rows = [text('score_flags', { taken, of }), text('score_points', { points })];
  if (stars) rows.push(text('score_stars', { stars, most: STARS }));
  return rows.join(' ');
}

/** @param {number} stars */
export function starsShown(stars) {
  return '★'.repeat(stars) + '☆'.repeat(STARS - stars);
}
