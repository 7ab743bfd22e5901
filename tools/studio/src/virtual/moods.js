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
const BLINKS_MS = 2900; // from one blink to the next

const MOST = 1000; // crashes, flags and rests that are remembered, each

/** @type {Face} */
export const CALM = { mood: 'calm', ahead: 0, aside: 0, isBlinking: false };

export class Moods {
  #bumps = 0;
  #taken = 0;
  /** When it bumped, and when it took a flag. @type {number[]} */
  #bumped = [];
  /** @type {number[]} */
  #took = [];
  /** From when until when it stood. @type {{from_ms: number, until_ms: number}[]} */
  #rests = [];
  #last_ms = 0;
  #cheered_ms = Infinity;

  begin() {
    this.#bumps = this.#taken = this.#last_ms = 0;
    this.#bumped = [];
    this.#took = [];
    this.#rests = [];
    this.#cheered_ms = Infinity;
  }

  /** It has solved its task. */
  cheer() {
    this.#cheered_ms = this.#last_ms;
  }

  /** Goes on to a newer state. @param {RobotState} state */
  follow({ now_ms, bumps, score, motors }) {
    const taken = score?.taken ?? 0, rest = this.#rests.at(-1);
    if (bumps > this.#bumps) this.#bumped.push(now_ms);
    if (taken > this.#taken) this.#took.push(now_ms);
    if (motors.some((power) => power !== 0)) {
      if (rest) rest.until_ms = Math.min(rest.until_ms, now_ms);
    } else if (!rest || rest.until_ms < Infinity) this.#rests.push({ from_ms: now_ms, until_ms: Infinity });
    for (const list of [this.#bumped, this.#took, this.#rests]) if (list.length > MOST) list.shift();
    this.#bumps = bumps;
    this.#taken = taken;
    this.#last_ms = now_ms;
  }

  /** How it looks in a state, also an earlier one; null is one that is off. @param {RobotState | null} state @returns {Face} */
  faceOf(state) {
    if (!state) return CALM;
    const { now_ms, motors: [left, right], is_running, is_waiting } = state;
    /** @param {number[]} times @param {number} most */
    const isSince = (times, most) => times.some((ms) => now_ms >= ms && now_ms - ms < most);
    const isStill = is_running && this.#rests.some(({ from_ms, until_ms }) => now_ms - from_ms >= TIRED_MS && now_ms < until_ms);
    const mood = state.fault || state.touches || isSince(this.#bumped, DIZZY_MS) ? 'dizzy'
      : now_ms >= this.#cheered_ms || isSince(this.#took, GLAD_MS) ? 'glad'
        : is_waiting || isStill ? 'tired' : 'calm';
    return { mood, ahead: (left + right) / 200, aside: (right - left) / 200, isBlinking: is_running && now_ms % BLINKS_MS > BLINKS_MS - BLINK_MS };
  }
}
