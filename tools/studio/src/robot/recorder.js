// Records what a robot tells of a run of a program that it has from here: the run is kept beside those of the virtual robot.

import { element, hide } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { text as textOf } from '../page/texts.js';
import { devicesOf } from '../page/words.js';
import { Run } from '../virtual/runs.js';

/** @typedef {import('./transport.js').About} About */
/** @typedef {import('./transport.js').RobotEvent} RobotEvent */
/** @typedef {import('../python.js').Checked} Checked */

const MOST = 10_000; // events; then it is over
const MOST_MS = 600_000;
const UNREAD = 'UNREAD '; // a row that says so of a sensor
const KNOWN = 20; // programs

export class Recorder {
  #page;
  /** The programs that robots have from here, by their checksums. @type {Map<string, {checked: Checked, text: string, robot: string}>} */
  #sent = new Map();
  /** @type {Run | null} */
  #run = null;
  /** When what is recorded began; null until the first event of a run by the robot's button. @type {number | null} */
  #began = null;
  /** Since when the program is halted. @type {number | null} */
  #halted = null;
  #isOver = true;
  #isDeaf = false; // the robot does not tell what its program reads
  /** The sensors of which it could not tell all. @type {Set<string>} */
  #untold = new Set();
  #play = element('record_play', HTMLButtonElement);

  /** @param {{runs: import('../virtual/runs.js').Runs, play: (run: Run) => void}} page */
  constructor(page) {
    this.#page = page;
    this.#play.addEventListener('click', () => this.#run && page.play(this.#run));
    pageState.language.subscribe(() => this.#show());
  }

  /** A robot is connected. @param {About} about */
  meet(about) {
    this.#isDeaf = !about.has_readings;
  }

  /** A robot gets a program, or may get it from others of the group. @param {Checked} checked */
  sends(checked) {
    this.#sent.delete(checked.program);
    for (const [oldest] of this.#sent) if (this.#sent.size >= KNOWN) this.#sent.delete(oldest);
    this.#sent.set(checked.program, { checked, text: pageState.programText.value, robot: pageState.robotName.value });
  }

  /** A program waits for the robot's button: no robot tells when it begins. @param {string} program its checksum, in hexadecimal */
  wait(program) {
    this.#record(program, null);
  }

  /** The program is halted: its time stands still. */
  halt() {
    this.#halted ??= performance.now();
  }

  /** It goes on. */
  goOn() {
    if (this.#began !== null && this.#halted !== null) this.#began += performance.now() - this.#halted;
    this.#halted = null;
  }

  /** The recording is over, if there is one. @param {string} event the last one */
  end(event) {
    this.goOn();
    if (this.#isOver) return;
    const ms = Math.min(this.#ms, MOST_MS);
    this.#run?.put([ms, event]);
    if (this.#run) this.#run.end_ms = ms;
    this.#isOver = true;
    this.#page.runs.trim();
    this.#show();
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'STARTED') {
      if (event.ms !== undefined) this.#isDeaf = true; // who drives for the group passes no readings on
      if (event.is_program && event.program) this.#record(event.program, performance.now());
      else this.end('STOPPED');
    }
    if (event.event === 'READING') this.#read(event.rows ?? []);
    const row = { SHOW: `SHOW ${event.value}`, DONE: 'DONE', FAULT: `FAULT ${event.fault}`, STOPPED: 'STOPPED', RESTARTED: 'LOST', LOST: 'LOST', OVER: 'LOST', MISSED: 'MISSED' }[event.event];
    if (!row || this.#isOver || !this.#run) return;
    this.#began = Math.min(this.#began ?? Infinity, performance.now() - (event.ms ?? 0));
    if (event.event !== 'SHOW') this.end(row);
    else if (this.#run.rows.length >= MOST || this.#ms > MOST_MS) this.end('STOPPED');
    else this.#run.put([event.ms ?? this.#ms, row]);
    this.#show();
  }

  /** Rows come in the robot's own time. @param {[number, string][]} rows */
  #read(rows) {
    if (this.#isOver || !this.#run) return;
    for (const row of rows) {
      const [ms, what] = row;
      this.#began ??= performance.now() - ms;
      if (this.#run.rows.length >= MOST || ms > MOST_MS) return this.end('STOPPED');
      this.#run.put(row);
      if (what.startsWith(UNREAD)) this.#untold.add(what.slice(UNREAD.length));
    }
    this.#show();
  }

  /**
   * @param {string} program
   * @param {number | null} began
   */
  #record(program, began) {
    this.end('STOPPED');
    const sent = this.#sent.get(program);
    this.#run = null;
    this.#isOver = !sent;
    this.#untold.clear();
    this.#began = began;
    if (sent) {
      const { checked, text, robot } = sent;
      const run = this.#run = new Run({ of: 'real', text, robot, program, is_by_button: began === null }, checked, null);
      run.clock = () => Math.min(MOST_MS, run === this.#run ? this.#ms : run.rows.at(-1)?.[0] ?? 0);
      this.#page.runs.begin(run);
    }
    this.#show();
  }

  /** Whether the program names a sensor. */
  get #reads() {
    const { text = '', robot = '' } = this.#run?.of ?? {};
    return devicesOf(robot, 'sensor').some((device) => text.toUpperCase().includes(device.text));
  }

  get #ms() {
    return this.#began === null ? 0 : Math.round(performance.now() - this.#began);
  }

  #show() {
    hide(this.#play, !this.#run?.rows.length);
    const said = element('record_lacks', HTMLElement);
    const what = this.#untold.size ? 'record_untold' : this.#isDeaf && this.#reads ? 'record_no_readings' : null;
    hide(said, !this.#run || !what);
    said.textContent = this.#run && what ? textOf(what, { sensors: [...this.#untold].join(', ') }) : '';
  }
}
