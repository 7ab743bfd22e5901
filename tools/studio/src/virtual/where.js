// What a screen reader hears of a run: where the robot is, what it bumps into, which flags it takes,
// and how a bout ends.
// Knows the robot's state; shows nothing.

import { element } from '../page/elements.js';
import { text } from '../page/texts.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {import('./simulator.js').Phase} Phase */

const ANNOUNCE_INTERVAL_MS = 5000; // of this computer's time, while it drives
const DIRECTION_KEYS = /** @type {const} */ (['where_right', 'where_up_right', 'where_up', 'where_up_left', 'where_left', 'where_down_left', 'where_down', 'where_down_right']);
const BUMP_SIDE_KEYS = /** @type {const} */ (['where_bump_front', 'where_bump_left', 'where_bump_back', 'where_bump_right']); // of the robot, counterclockwise
const MAX_STARS = 3;

export class RunAnnouncer {
  #announcementElement = element('where', HTMLElement);
  #lastAnnounced_ms = 0;
  /** @type {Phase} */
  #lastPhase = 'off';
  #bumpCount = 0;
  #takenFlagCount = 0;
  #endText = '';

  /** @param {RobotState | null} state @param {Phase} phase */
  announce(state, phase) {
    const phaseBefore = this.#lastPhase;
    this.#lastPhase = phase;
    if (!state || phase === 'off') {
      this.#bumpCount = this.#takenFlagCount = 0;
      this.#endText = '';
      this.#lastAnnounced_ms = performance.now();
      return;
    }
    const { bumps, score } = state;
    const takenFlagCount = score?.taken ?? 0;
    const hasJustStopped = phase !== phaseBefore && (phase === 'ended' || phase === 'paused');
    const sentences = [];
    if (bumps > this.#bumpCount && !hasJustStopped) sentences.push(bumpSentence(state));
    if (takenFlagCount > this.#takenFlagCount && !hasJustStopped) sentences.push(text('score_flags', { taken: takenFlagCount, of: score?.of ?? 0 }));
    const endText = score ? boutEndText(score) : '';
    if (endText !== this.#endText && endText && !hasJustStopped) sentences.push(endText);
    this.#endText = endText;
    this.#bumpCount = bumps;
    this.#takenFlagCount = takenFlagCount;
    const isDue = phase === 'running' && performance.now() - this.#lastAnnounced_ms > ANNOUNCE_INTERVAL_MS;
    if (!sentences.length && !hasJustStopped && !isDue) return;
    this.#lastAnnounced_ms = performance.now();
    if (hasJustStopped && bumps) sentences.push(text('where_bumps', { count: bumps }));
    if (hasJustStopped && score) sentences.push(scoreSentence(score));
    this.#announcementElement.textContent = [...sentences, placeSentence(state.pose)].join(' ');
  }
}

/** @param {RobotState} state @returns {string} that the robot has bumped, and with which side, where it still touches what it has bumped into */
export function bumpSentence({ touches, pose: [x = 0, y = 0, heading = 0] }) {
  if (!touches) return text('where_bump');
  const angle = (Math.atan2(touches[1] - y, touches[0] - x) * 180) / Math.PI - heading;
  return text(BUMP_SIDE_KEYS.at(Math.round((angle * BUMP_SIDE_KEYS.length) / 360) % BUMP_SIDE_KEYS.length) ?? 'where_bump');
}

/** @param {number[]} pose */
function placeSentence([x = 0, y = 0, heading = 0]) {
  const direction = DIRECTION_KEYS.at(Math.round((heading * DIRECTION_KEYS.length) / 360) % DIRECTION_KEYS.length) ?? 'where_right';
  return text('where_is', { x: Math.round(x), y: Math.round(y), way: text(direction) });
}

/** @param {NonNullable<RobotState['score']>} score what a run is worth, for eyes and ears */
function scoreSentence(score) {
  const { stars, points, taken: takenFlagCount, of: flagCount } = score;
  const sentences = [flagCount ? text('score_flags', { taken: takenFlagCount, of: flagCount }) : '', boutEndText(score), text('score_points', { points })].filter(Boolean);
  if (stars) sentences.push(text('score_stars', { stars, most: MAX_STARS }));
  return sentences.join(' ');
}

/** @param {NonNullable<RobotState['score']>} score @returns {string} how its bout has ended, or nothing */
export function boutEndText({ pushed, rivals, has_fallen }) {
  if (has_fallen) return text('score_fallen');
  return rivals && pushed === rivals ? text('score_pushed') : '';
}

/** @param {number} stars */
export function starsText(stars) {
  return '★'.repeat(stars) + '☆'.repeat(MAX_STARS - stars);
}
