// What a screen reader hears of a run: where the robot is, what it bumps into, which flags it takes,
// and how a bout ends.
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
  #ended = '';

  /** @param {RobotState | null} state @param {Phase} phase */
  tell(state, phase) {
    const before = this.#phase;
    this.#phase = phase;
    if (!state || phase === 'off') {
      this.#bumps = this.#taken = 0;
      this.#ended = '';
      this.#last = performance.now();
      return;
    }
    const { bumps, score } = state;
    const taken = score?.taken ?? 0;
    const isNew = phase !== before && (phase === 'ended' || phase === 'paused');
    const found = [];
    if (bumps > this.#bumps && !isNew) found.push(text('where_bump'));
    if (taken > this.#taken && !isNew) found.push(text('score_flags', { taken, of: score?.of ?? 0 }));
    const ended = score ? howEnded(score) : '';
    if (ended !== this.#ended && ended && !isNew) found.push(ended);
    this.#ended = ended;
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
function scoreSaid(score) {
  const { stars, points, taken, of } = score;
  const rows = [of ? text('score_flags', { taken, of }) : '', howEnded(score), text('score_points', { points })].filter(Boolean);
  if (stars) rows.push(text('score_stars', { stars, most: STARS }));
  return rows.join(' ');
}

/** @param {NonNullable<RobotState['score']>} score @returns {string} how its bout has ended, or nothing */
export function howEnded({ pushed, rivals, has_fallen }) {
  if (has_fallen) return text('score_fallen');
  return rivals && pushed === rivals ? text('score_pushed') : '';
}

/** @param {number} stars */
export function starsShown(stars) {
  return '★'.repeat(stars) + '☆'.repeat(STARS - stars);
}
