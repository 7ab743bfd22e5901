// Records what a robot says about a run of a program that it has from here: the run is kept beside those of the virtual robot.

import { element, setHidden } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { text as textOf } from '../page/texts.js';
import { devicesOf } from '../page/words.js';
import { Run } from '../virtual/runs.js';

/** @typedef {import('./transport.js').RobotInfo} RobotInfo */
/** @typedef {import('./transport.js').RobotEvent} RobotEvent */
/** @typedef {import('../python.js').CheckResult} CheckResult */

const MAX_EVENTS = 10_000; // events; then it is over
const MAX_MS = 600_000;
const UNREAD_PREFIX = 'UNREAD '; // a row that says so of a sensor
const MAX_PROGRAMS = 20; // programs

export class Recorder {
  #page;
  /** The programs that robots have from here, by their checksums. @type {Map<string, {checkResult: CheckResult, text: string, robot: string}>} */
  #sentPrograms = new Map();
  /** @type {Run | null} */
  #run = null;
  /** When what is recorded began; null until the first event of a run by the robot's button. @type {number | null} */
  #began_ms = null;
  /** Since when the program is halted. @type {number | null} */
  #halted_ms = null;
  #isOver = true;
  #lacksReadings = false; // the robot does not tell what its program reads
  /** The sensors of which it could not tell all. @type {Set<string>} */
  #incompleteSensors = new Set();
  #playButton = element('record_play', HTMLButtonElement);

  /** @param {{runs: import('../virtual/runs.js').Runs, play: (run: Run) => void}} page */
  constructor(page) {
    this.#page = page;
    this.#playButton.addEventListener('click', () => this.#run && page.play(this.#run));
    pageState.language.subscribe(() => this.#show());
  }

  /** A robot is connected. @param {RobotInfo} robotInfo */
  onRobotChange(robotInfo) {
    this.#lacksReadings = !robotInfo.has_readings;
  }

  /** A robot gets a program, or may get it from others of the group. @param {CheckResult} checkResult */
  addProgram(checkResult) {
    this.#sentPrograms.delete(checkResult.program);
    for (const [oldestChecksum] of this.#sentPrograms) if (this.#sentPrograms.size >= MAX_PROGRAMS) this.#sentPrograms.delete(oldestChecksum);
    this.#sentPrograms.set(checkResult.program, { checkResult, text: pageState.programText.value, robot: pageState.robotName.value });
  }

  /** A program waits for the robot's button: no robot tells when it begins. @param {string} checksum its checksum, in hexadecimal */
  awaitButton(checksum) {
    this.#beginRecording(checksum, null);
  }

  /** The program is halted: its time stands still. */
  halt() {
    this.#halted_ms ??= performance.now();
  }

  /** It goes on. */
  resume() {
    if (this.#began_ms !== null && this.#halted_ms !== null) this.#began_ms += performance.now() - this.#halted_ms;
    this.#halted_ms = null;
  }

  /** The recording is over, if there is one. @param {string} event the last one */
  end(event) {
    this.resume();
    if (this.#isOver) return;
    const duration_ms = Math.min(this.#elapsed_ms, MAX_MS);
    this.#run?.addRow([duration_ms, event]);
    if (this.#run) this.#run.end_ms = duration_ms;
    this.#isOver = true;
    this.#page.runs.forgetOldest();
    this.#show();
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'STARTED') {
      if (event.ms !== undefined) this.#lacksReadings = true; // who drives for the group passes no readings on
      if (event.is_program && event.program) this.#beginRecording(event.program, performance.now());
      else this.end('STOPPED');
    }
    if (event.event === 'READING') this.#addReadings(event.rows ?? []);
    const rowText = { SHOW: `SHOW ${event.value}`, DONE: 'DONE', FAULT: `FAULT ${event.fault}`, STOPPED: 'STOPPED', RESTARTED: 'LOST', LOST: 'LOST', OVER: 'LOST', MISSED: 'MISSED' }[event.event];
    if (!rowText || this.#isOver || !this.#run) return;
    this.#began_ms = Math.min(this.#began_ms ?? Infinity, performance.now() - (event.ms ?? 0));
    if (event.event !== 'SHOW') this.end(rowText);
    else if (this.#run.rows.length >= MAX_EVENTS || this.#elapsed_ms > MAX_MS) this.end('STOPPED');
    else this.#run.addRow([event.ms ?? this.#elapsed_ms, rowText]);
    this.#show();
  }

  /** Rows come in the robot's own time. @param {[number, string][]} rows */
  #addReadings(rows) {
    if (this.#isOver || !this.#run) return;
    for (const row of rows) {
      const [event_ms, text] = row;
      this.#began_ms ??= performance.now() - event_ms;
      if (this.#run.rows.length >= MAX_EVENTS || event_ms > MAX_MS) return this.end('STOPPED');
      this.#run.addRow(row);
      if (text.startsWith(UNREAD_PREFIX)) this.#incompleteSensors.add(text.slice(UNREAD_PREFIX.length));
    }
    this.#show();
  }

  /**
   * @param {string} checksum
   * @param {number | null} began_ms
   */
  #beginRecording(checksum, began_ms) {
    this.end('STOPPED');
    const sentProgram = this.#sentPrograms.get(checksum);
    this.#run = null;
    this.#isOver = !sentProgram;
    this.#incompleteSensors.clear();
    this.#began_ms = began_ms;
    if (sentProgram) {
      const { checkResult, text, robot: robotName } = sentProgram;
      const run = this.#run = new Run({ of: 'real', text, robot: robotName, program: checksum, is_by_button: began_ms === null }, checkResult, null);
      run.readClock = () => Math.min(MAX_MS, run === this.#run ? this.#elapsed_ms : run.rows.at(-1)?.[0] ?? 0);
      this.#page.runs.addRun(run);
    }
    this.#show();
  }

  /** Whether the program names a sensor. */
  get #readsSensor() {
    const { text = '', robot: robotName = '' } = this.#run?.origin ?? {};
    return devicesOf(robotName, 'sensor').some((device) => text.toUpperCase().includes(device.text));
  }

  get #elapsed_ms() {
    return this.#began_ms === null ? 0 : Math.round(performance.now() - this.#began_ms);
  }

  #show() {
    setHidden(this.#playButton, !this.#run?.rows.length);
    const notice = element('record_lacks', HTMLElement);
    const noticeKey = this.#incompleteSensors.size ? 'record_incomplete' : this.#lacksReadings && this.#readsSensor ? 'record_no_readings' : null;
    setHidden(notice, !this.#run || !noticeKey);
    notice.textContent = this.#run && noticeKey ? textOf(noticeKey, { sensors: [...this.#incompleteSensors].join(', ') }) : '';
  }
}
