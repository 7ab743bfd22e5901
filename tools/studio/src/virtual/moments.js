// Keeps how the virtual robot was, moment by moment, so that a person can look back. Knows no page.
//
// A moment is a state of the simulator, as text: what has changed since the one before, and all of it every so often.

/** @typedef {import('../python.js').RobotState} RobotState */

const WHOLE = 16; // of so many moments one is kept whole
const LEAST_MS = 40; // of the robot's time between two moments in which nothing happens
const NOT_KEPT = new Set(['rows', 'is_full', 'is_over', 'parting']); // of the run, not of a moment
const MOST = 2_000_000; // characters; then of the moments in which nothing happens every other one is forgotten

export class Moments {
  #most;
  /** @type {string[]} */
  #rows = [];
  /** Of the robot's time, when each moment was. @type {number[]} */
  #times = [];
  /** The moments in which something happens, and those in which another part of the program runs. @type {number[]} */
  #events = [];
  /** @type {number[]} */
  #parts = [];
  /** What has been shown, with its moment. @type {[number, [number, string, number]][]} */
  #shows = [];
  #size = 0;
  /** The newest moment, by its keys. @type {Map<string, string>} */
  #last = new Map();
  /** The moment that was asked for last: a picture of it asks several times. @type {{k: number, state: RobotState} | null} */
  #asked = null;

  /** @param {number} [most] characters */
  constructor(most = MOST) {
    this.#most = most;
  }

  get length() {
    return this.#rows.length;
  }

  /** @returns {number} characters */
  get size() {
    return this.#size;
  }

  /** @returns {number} of the robot's time, when the first moment was */
  get first_ms() {
    return this.#times[0] ?? 0;
  }

  /** @returns {number} of the robot's time, when the last moment was */
  get last_ms() {
    return this.#times.at(-1) ?? 0;
  }

  /** @returns {readonly number[]} the moments in which something happens */
  get events() {
    return this.#events;
  }

  /** @returns {readonly number[]} the moments in which another part of the program begins to run */
  get parts() {
    return this.#parts;
  }

  begin() {
    this.#rows = [];
    this.#times = [];
    this.#events = [];
    this.#parts = [];
    this.#shows = [];
    this.#size = 0;
    this.#last = new Map();
    this.#asked = null;
  }

  /**
   * Takes the next state of a run; what happens between two of them is in its events.
   * @param {RobotState} state
   */
  add(state) {
    const keys = new Map(Object.entries(state).filter(([key]) => !NOT_KEPT.has(key)).map(([key, value]) => [key, JSON.stringify(value, rounded)]));
    const isPart = keys.get('places') !== this.#last.get('places') || keys.get('at') !== this.#last.get('at');
    const isEvent = state.events.some(isSeen) || keys.get('bumps') !== this.#last.get('bumps');
    if (this.length && !isPart && !isEvent && state.is_running && state.now_ms - this.last_ms < LEAST_MS) return;
    const k = this.length;
    if (isEvent) this.#events.push(k);
    if (isPart) this.#parts.push(k);
    this.#put(keys, state);
    if (this.#size > this.#most) this.#thin();
  }

  /**
   * @param {Map<string, string>} keys
   * @param {RobotState} state
   */
  #put(keys, { now_ms, events }) {
    for (const event of events) if (event[1].startsWith('SHOW ')) this.#shows.push([this.length, event]);
    const isWhole = this.length % WHOLE === 0;
    const changed = [...keys].filter(([key, value]) => isWhole || this.#last.get(key) !== value);
    const row = `{${changed.map(([key, value]) => `"${key}":${value}`).join()}}`;
    this.#last = keys;
    this.#asked = null;
    this.#rows.push(row);
    this.#times.push(now_ms);
    this.#size += row.length;
  }

  /** Forgets every other moment in which nothing happens; where none is left, the older half of all. */
  #thin() {
    const isKept = new Set([...this.#events, ...this.#parts]);
    const kept = Array.from(this.#rows, (_, k) => k).filter((k) => isKept.has(k) || k % 2 === 0);
    const from = kept.length > 0.9 * this.length ? Math.floor(kept.length / 2) : 0;
    const moments = kept.slice(from).map((k) => ({ k, state: this.at(k) }));
    const events = new Set(this.#events), parts = new Set(this.#parts);
    this.begin();
    for (const { k, state } of moments) {
      if (events.has(k)) this.#events.push(this.length);
      if (parts.has(k)) this.#parts.push(this.length);
      this.#put(new Map(Object.entries(state).map(([key, value]) => [key, JSON.stringify(value)])), state);
    }
  }

  /** @param {number} k a moment @returns {RobotState} */
  at(k) {
    if (this.#asked?.k === k) return this.#asked.state;
    const state = {};
    for (let row = k - (k % WHOLE); row <= k; row += 1) Object.assign(state, JSON.parse(this.#rows[row] ?? '{}'));
    this.#asked = { k, state: /** @type {RobotState} */ (state) };
    return this.#asked.state;
  }

  /** Each moment, one after the other. @returns {Generator<RobotState>} */
  *all() {
    let state = {};
    for (const row of this.#rows) {
      state = { ...state, ...JSON.parse(row) };
      yield /** @type {RobotState} */ (state);
    }
  }

  /** @param {number} at_ms of the robot's time @returns {number} the last moment until then */
  until(at_ms) {
    return Math.max(0, countUntil(this.#times, at_ms) - 1);
  }

  /**
   * Returns the last event before a moment, or the first one after it; or the beginning, or the end.
   * @param {number} k
   * @param {number} ways -1 for back, 1 for on
   * @param {readonly number[]} which `events` or `parts`
   */
  beside(k, ways, which) {
    if (ways < 0) return which[countUntil(which, k - 1) - 1] ?? 0;
    return which[countUntil(which, k)] ?? Math.max(0, this.length - 1);
  }

  /** @param {number} k @returns {[number, string, number][]} what has been shown until a moment */
  shows(k) {
    return this.#shows.slice(0, countUntil(this.#shows.map(([moment]) => moment), k)).map(([, event]) => event);
  }
}

/** Whether it is something that the robot did: a program that waits reads its sensors fifty times in a second. @param {[number, string, number]} event */
export function isSeen([, what]) {
  return !what.startsWith('READ ');
}

/** How many of ascending numbers are at most so large. @param {readonly number[]} numbers @param {number} most */
function countUntil(numbers, most) {
  let low = 0, high = numbers.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((numbers[middle] ?? 0) <= most) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Numbers as nobody sees more of them. @param {string} _ @param {unknown} value */
function rounded(_, value) {
  return typeof value === 'number' ? Math.round(value * 1000) / 1000 : value;
}
