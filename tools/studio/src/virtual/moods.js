// How the virtual robot looks: where it drives, and how it is. It says nothing that the run does not say, and all in the
// robot's time: the same moment of a run looks the same.

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {'calm' | 'glad' | 'dizzy' | 'tired'} Mood */
/**
 * @typedef {object} Face
 * @property {Mood} mood
 * @property {number} ahead where it looks, from -1 to 1, as far as it drives there
 * @property {number} aside to its left
 * @property {boolean} isBlinking
 */

const DIZZY_MS = 1500; // of the robot's time, after a crash
const GLAD_MS = 2000; // after a flag
const TIRED_MS = 4000; // for which it has not moved
const BLINK_MS = 140;
const BLINK_INTERVAL_MS = 2900; // from one blink to the next

const MAX_TIMES = 1000; // crashes, flags and rests that are remembered, each

/** @type {Face} */
export const CALM_FACE = { mood: 'calm', ahead: 0, aside: 0, isBlinking: false };

export class Moods {
  #bumpCount = 0;
  #takenFlagCount = 0;
  /** When it bumped, and when it took a flag. @type {number[]} */
  #bumpTimes_ms = [];
  /** @type {number[]} */
  #flagTimes_ms = [];
  /** From when until when it stood. @type {{from_ms: number, until_ms: number}[]} */
  #rests = [];
  #lastState_ms = 0;
  #solved_ms = Infinity;

  reset() {
    this.#bumpCount = this.#takenFlagCount = this.#lastState_ms = 0;
    this.#bumpTimes_ms = [];
    this.#flagTimes_ms = [];
    this.#rests = [];
    this.#solved_ms = Infinity;
  }

  /** It has solved its task. */
  cheer() {
    this.#solved_ms = this.#lastState_ms;
  }

  /** Goes on to a newer state. @param {RobotState} state */
  followState({ now_ms, bumps, score, motors }) {
    const takenFlagCount = score?.taken ?? 0, lastRest = this.#rests.at(-1);
    if (bumps > this.#bumpCount) this.#bumpTimes_ms.push(now_ms);
    if (takenFlagCount > this.#takenFlagCount) this.#flagTimes_ms.push(now_ms);
    if (motors.some((power) => power !== 0)) {
      if (lastRest) lastRest.until_ms = Math.min(lastRest.until_ms, now_ms);
    } else if (!lastRest || lastRest.until_ms < Infinity) this.#rests.push({ from_ms: now_ms, until_ms: Infinity });
    for (const times of [this.#bumpTimes_ms, this.#flagTimes_ms, this.#rests]) if (times.length > MAX_TIMES) times.shift();
    this.#bumpCount = bumps;
    this.#takenFlagCount = takenFlagCount;
    this.#lastState_ms = now_ms;
  }

  /** How it looks in a state, also an earlier one; null is one that is off. @param {RobotState | null} state @returns {Face} */
  faceOf(state) {
    if (!state) return CALM_FACE;
    const { now_ms, motors: [left, right], is_running, is_waiting } = state;
    /** @param {number[]} times @param {number} duration_ms */
    const isWithin = (times, duration_ms) => times.some((ms) => now_ms >= ms && now_ms - ms < duration_ms);
    const isResting = is_running && this.#rests.some(({ from_ms, until_ms }) => now_ms - from_ms >= TIRED_MS && now_ms < until_ms);
    const mood = state.fault || state.touches || isWithin(this.#bumpTimes_ms, DIZZY_MS) ? 'dizzy'
      : now_ms >= this.#solved_ms || isWithin(this.#flagTimes_ms, GLAD_MS) ? 'glad'
        : is_waiting || isResting ? 'tired' : 'calm';
    return { mood, ahead: (left + right) / 200, aside: (right - left) / 200, isBlinking: is_running && now_ms % BLINK_INTERVAL_MS > BLINK_INTERVAL_MS - BLINK_MS };
  }
}
