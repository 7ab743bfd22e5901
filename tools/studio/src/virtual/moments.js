// Keeps how the virtual robot was, moment by moment, so that a person can look back. Knows no page.
//
// A moment is a state of the simulator, as text: what has changed since the one before, and all of it every so often.

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {RobotState & {shown: RobotState['events']}} Moment also what each SHOW has shown last, in the order in which they began to */

const KEYFRAME_INTERVAL = 16; // of so many moments one is kept whole
const MIN_MS = 40; // of the robot's time between two moments in which nothing happens
const RUN_KEYS = new Set(['rows', 'is_full', 'is_over', 'parting']); // of the run, not of a moment
const MAX_CHARACTERS = 2_000_000; // characters; then of the moments in which nothing happens every other one is forgotten

export class Moments {
  #mostCharacters;
  /** @type {string[]} */
  #stateDiffs = [];
  /** Of the robot's time, when each moment was. @type {number[]} */
  #times_ms = [];
  /** The moments in which something happens, and those in which another part of the program runs. @type {number[]} */
  #eventMoments = [];
  /** @type {number[]} */
  #partMoments = [];
  /** What each SHOW has shown last. @type {Map<number, RobotState['events'][number]>} */
  #shownEvents = new Map();
  #characterCount = 0;
  /** The newest moment, by its keys. @type {Map<string, string>} */
  #lastValues = new Map();
  /** The moment that was asked for last: a picture of it asks several times. @type {{moment: number, state: Moment} | null} */
  #cachedMoment = null;

  /** @param {number} [mostCharacters] characters */
  constructor(mostCharacters = MAX_CHARACTERS) {
    this.#mostCharacters = mostCharacters;
  }

  get length() {
    return this.#stateDiffs.length;
  }

  /** @returns {number} characters */
  get characterCount() {
    return this.#characterCount;
  }

  /** @returns {number} of the robot's time, when the first moment was */
  get first_ms() {
    return this.#times_ms[0] ?? 0;
  }

  /** @returns {number} of the robot's time, when the last moment was */
  get last_ms() {
    return this.#times_ms.at(-1) ?? 0;
  }

  /** @returns {readonly number[]} the moments in which something happens */
  get events() {
    return this.#eventMoments;
  }

  /** @returns {readonly number[]} the moments in which another part of the program begins to run */
  get parts() {
    return this.#partMoments;
  }

  clear() {
    this.#stateDiffs = [];
    this.#times_ms = [];
    this.#eventMoments = [];
    this.#partMoments = [];
    this.#shownEvents = new Map();
    this.#characterCount = 0;
    this.#lastValues = new Map();
    this.#cachedMoment = null;
  }

  /**
   * Takes the next state of a run; what happens between two of them is in its events.
   * @param {RobotState} state
   */
  add(state) {
    const values = new Map(Object.entries(state).filter(([key]) => !RUN_KEYS.has(key)).map(([key, value]) => [key, JSON.stringify(value, roundNumber)]));
    const isPart = values.get('places') !== this.#lastValues.get('places') || values.get('at') !== this.#lastValues.get('at');
    const isEvent = state.events.some(isAction) || values.get('bumps') !== this.#lastValues.get('bumps');
    if (this.length && !isPart && !isEvent && state.is_running && state.now_ms - this.last_ms < MIN_MS) return;
    const moment = this.length;
    if (isEvent) this.#eventMoments.push(moment);
    if (isPart) this.#partMoments.push(moment);
    for (const event of state.events) if (event[1].startsWith('SHOW ')) this.#shownEvents.set(event[2], event);
    values.set('shown', JSON.stringify([...this.#shownEvents.values()]));
    this.#append(values, state.now_ms);
    if (this.#characterCount > this.#mostCharacters) this.#thinOut();
  }

  /**
   * @param {Map<string, string>} values
   * @param {number} now_ms
   */
  #append(values, now_ms) {
    const isKeyframe = this.length % KEYFRAME_INTERVAL === 0;
    const changedEntries = [...values].filter(([key, value]) => isKeyframe || this.#lastValues.get(key) !== value);
    const stateDiff = `{${changedEntries.map(([key, value]) => `"${key}":${value}`).join()}}`;
    this.#lastValues = values;
    this.#cachedMoment = null;
    this.#stateDiffs.push(stateDiff);
    this.#times_ms.push(now_ms);
    this.#characterCount += stateDiff.length;
  }

  /** Forgets every other moment in which nothing happens; where none is left, the older half of all. */
  #thinOut() {
    const keptMoments = new Set([...this.#eventMoments, ...this.#partMoments]);
    const keptIndexes = Array.from(this.#stateDiffs, (_, k) => k).filter((k) => keptMoments.has(k) || k % 2 === 0);
    const firstKeptIndex = keptIndexes.length > 0.9 * this.length ? Math.floor(keptIndexes.length / 2) : 0;
    const moments = keptIndexes.slice(firstKeptIndex).map((k) => ({ k, state: this.at(k) }));
    const events = new Set(this.#eventMoments), parts = new Set(this.#partMoments);
    const shown = this.#shownEvents;
    this.clear();
    this.#shownEvents = shown;
    for (const { k, state } of moments) {
      if (events.has(k)) this.#eventMoments.push(this.length);
      if (parts.has(k)) this.#partMoments.push(this.length);
      this.#append(new Map(Object.entries(state).map(([key, value]) => [key, JSON.stringify(value)])), state.now_ms);
    }
  }

  /** @param {number} moment a moment @returns {Moment} */
  at(moment) {
    if (this.#cachedMoment?.moment === moment) return this.#cachedMoment.state;
    const state = {};
    for (let index = moment - (moment % KEYFRAME_INTERVAL); index <= moment; index += 1) Object.assign(state, JSON.parse(this.#stateDiffs[index] ?? '{}'));
    this.#cachedMoment = { moment, state: /** @type {Moment} */ (state) };
    return this.#cachedMoment.state;
  }

  /** Each moment, one after the other. @returns {Generator<RobotState>} */
  *states() {
    let state = {};
    for (const stateDiff of this.#stateDiffs) {
      state = { ...state, ...JSON.parse(stateDiff) };
      yield /** @type {RobotState} */ (state);
    }
  }

  /** @param {number} at_ms of the robot's time @returns {number} the last moment until then */
  momentAt(at_ms) {
    return Math.max(0, countUntil(this.#times_ms, at_ms) - 1);
  }

  /**
   * Returns the last event before a moment, or the first one after it; or the beginning, or the end.
   * @param {number} moment
   * @param {number} direction -1 for back, 1 for on
   * @param {readonly number[]} moments `events` or `parts`
   */
  neighbourOf(moment, direction, moments) {
    if (direction < 0) return moments[countUntil(moments, moment - 1) - 1] ?? 0;
    return moments[countUntil(moments, moment)] ?? Math.max(0, this.length - 1);
  }
}

/** Whether it is something that the robot did: a program that waits reads its sensors fifty times in a second. @param {[number, string, number]} event */
export function isAction([, event]) {
  return !event.startsWith('READ ');
}

/** How many of ascending numbers are at most so large. @param {readonly number[]} numbers @param {number} limit */
function countUntil(numbers, limit) {
  let low = 0, high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((numbers[middle] ?? 0) <= limit) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Numbers as nobody sees more of them. @param {string} _ @param {unknown} value */
function roundNumber(_, value) {
  return typeof value === 'number' ? Math.round(value * 1000) / 1000 : value;
}
