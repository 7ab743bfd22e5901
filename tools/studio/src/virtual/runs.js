// The runs that the page keeps while it is open: how each was, moment by moment, and what its file has.

import { isAction, Moments } from './moments.js';
import { blocksOf } from './why.js';

/** @typedef {import('../python.js').RobotState} RobotState */
/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @typedef {[number, string] | [number, string, number]} Row when, what, and of a SHOW where */
/**
 * @typedef {object} RunOrigin whose run it is
 * @property {'virtual' | 'real'} of
 * @property {string} text of the program
 * @property {string} robot
 * @property {string} program the checksum of its image
 * @property {unknown} [world] what the worker is asked for
 * @property {boolean} [is_by_button] a real robot's, whose program waits for its button
 */

const MAX_RUNS = 10;
const MAX_CHARACTERS = 2_000_000; // characters of all of them
const MAX_MOMENT_CHARACTERS = 1_200_000; // of one
const MAX_MARKS = 10_000;
const MARK_WORDS = new Set(['BEEP', 'SHOW', 'FAULT']);

export class Run {
  /** @type {RunOrigin} */
  origin;
  number = 0;
  moments = new Moments(MAX_MOMENT_CHARACTERS);
  /** @type {{at_ms: number, kind: string}[]} */
  marks = [];
  /** @type {Row[]} */
  rows = [];
  /** Where what is recorded ends, by the robot's clock. @type {number | null} */
  end_ms = null;
  /** What it says of the program. @type {Pick<CheckResult, 'places' | 'shows' | 'variables'> & Partial<Pick<CheckResult, 'sensors'>>} */
  program;
  /** The world as it is drawn. @type {import('../world/parts.js').World | null} */
  world;
  /** What the file of the run has, of one that was opened. @type {Row[]} */
  fileRows = [];
  /** It cannot be played again: somebody else has driven it. */
  isJudged = false;
  /** The file that it was opened from; nothing of one that was recorded here. */
  fileText = '';
  /** When it is now, for a run that is still recorded. @type {(() => number) | null} */
  readClock = null;
  /** Where it and the recorded one part, once it was played again. @type {import('../python.js').Parting | null} */
  parting = null;
  #characterCount = 0;
  #bumpCount = 0;
  /** @type {import('./why.js').CodeBlock[] | null} */
  #whenBlocks = null;
  /** Those in which a task was. @type {import('./why.js').CodeBlock[]} */
  #begunBlocks = [];

  /**
   * @param {RunOrigin} origin
   * @param {Pick<CheckResult, 'places' | 'shows' | 'variables'> & Partial<Pick<CheckResult, 'sensors'>>} program
   * @param {import('../world/parts.js').World | null} world
   */
  constructor(origin, program, world) {
    this.origin = origin;
    this.program = program;
    this.world = world;
  }

  /** @returns {number} characters */
  get characterCount() {
    return this.moments.characterCount + this.#characterCount + this.fileText.length;
  }

  /** @returns {number} seconds */
  get duration_s() {
    if (this.moments.length) return (this.moments.last_ms - this.moments.first_ms) / 1000;
    return ((this.rows.at(-1)?.[0] ?? 0) - (this.rows[0]?.[0] ?? 0)) / 1000;
  }

  /** @param {RobotState} state the next one of a virtual robot's run */
  add(state) {
    for (const [at_ms, event] of state.events.filter(isAction)) {
      const [eventWord = ''] = event.split(' ');
      this.mark(at_ms, MARK_WORDS.has(eventWord) ? eventWord : '');
    }
    if (state.bumps > this.#bumpCount) this.mark(state.now_ms, 'BUMP');
    this.#bumpCount = state.bumps;
    this.#markWhens(state);
    if (this.origin.of === 'virtual' && !this.fileText) {
      this.markKeys(state.rows ?? []);
      for (const row of state.rows ?? []) this.addRow(row);
    }
    if (state.parting && !this.parting) {
      this.parting = state.parting;
      if (state.parting.at_ms !== null) this.mark(state.parting.at_ms, 'PART');
    }
    if (!state.is_full && this.origin.of === 'virtual') this.end_ms = state.now_ms;
    this.moments.add(state);
  }

  /** @param {RobotState} state in which a WHEN may have begun */
  #markWhens({ now_ms, places }) {
    const { origin: { text }, program } = this;
    this.#whenBlocks ??= blocksOf(text, program.places, /^WHEN\b/i);
    const begunBlocks = this.#whenBlocks.filter(({ hasOffset }) => places.some((offset) => hasOffset(offset, true)));
    if (begunBlocks.some((block) => !this.#begunBlocks.includes(block))) this.mark(now_ms, 'WHEN');
    this.#begunBlocks = begunBlocks;
  }

  /** It is played: what is seen of it begins anew. */
  restart() {
    this.moments.clear();
    this.marks = [];
    this.parting = null;
    this.#bumpCount = 0;
    this.#whenBlocks = null;
    this.#begunBlocks = [];
  }

  /** @param {Row[]} rows in which somebody may have pressed keys */
  markKeys(rows) {
    for (const [at_ms, event] of rows) if (/^KEYS (?!0 0 0$)/.test(event)) this.mark(at_ms, 'KEYS');
  }

  /** @param {number} at_ms @param {string} kind */
  mark(at_ms, kind) {
    this.marks.push({ at_ms, kind });
    if (this.marks.length > MAX_MARKS) this.marks.splice(0, MAX_MARKS / 2);
  }

  /** What a sensor read last until a time of the robot, as the program read it. @param {string} name @param {number} at_ms @returns {string | undefined} */
  readingAt(name, at_ms) {
    const prefix = `READ ${name} `;
    const rows = this.rows.length ? this.rows : this.fileRows;
    return rows.findLast(([event_ms, event]) => event_ms <= at_ms && event.startsWith(prefix))?.[1].slice(prefix.length);
  }

  /** @param {Row} row */
  addRow(row) {
    this.rows.push(row);
    this.#characterCount += row[1].length + 12;
  }
}

export class Runs {
  /** The newest last. @type {Run[]} */
  #runs = [];
  #runCount = 0;

  /** @returns {readonly Run[]} the newest first */
  get newestFirst() {
    return this.#runs.toReversed();
  }

  /** @returns {number} characters */
  get characterCount() {
    return this.#runs.reduce((sum, run) => sum + run.characterCount, 0);
  }

  /** @param {Run} run is the newest one from now on */
  addRun(run) {
    run.number = this.#runCount += 1;
    this.#runs = [...this.#runs.filter(({ rows, moments }) => rows.length || moments.length > 1), run];
    this.forgetOldest();
  }

  /** Forgets the oldest ones, where there are too many or they are too large. */
  forgetOldest() {
    while (this.#runs.length > 1 && (this.#runs.length > MAX_RUNS || this.characterCount > MAX_CHARACTERS)) this.#runs.shift();
  }
}
