// What a real robot senses: as gauges, and as curves. While a program runs, these are the readings that it takes.
//
// No message of the link asks for readings, so a line runs on the robot that shows them again and again. It has no
// motor in it. It begins where nothing runs and nothing waits for the robot's button, which stops a line instead of
// starting the program; whatever else is asked of the robot comes first. A stop ends it until somebody wants it again.

import { element, setHidden } from '../page/elements.js';
import { storeText, loadText } from '../page/kept.js';
import { readingText, parseShownValue, percentOfRange } from '../page/readings.js';
import { showRows } from '../page/rows.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage } from '../page/texts.js';
import { devicesOf, deviceName, robotOf } from '../page/words.js';
import { Plot } from '../virtual/plot.js';
import { findShow } from '../writing/shows.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @import { RobotInfo, Answer, RobotEvent } from './transport.js' */

/**
 * @typedef {object} Page
 * @property {import('../python.js').Python} python
 * @property {(request: Record<string, unknown>, isQuiet: boolean) => Promise<Answer | null>} ask null if nothing came of it, which was said unless it is quiet
 * @property {(key: import('../page/texts.js').Key) => void} say
 * @property {(isOn: boolean) => void} onWatchingChange whether the readings come
 */

const STORAGE_KEY = 'tiniscript.watches'; // whether somebody has wanted it
const SHOW_BITS = 180; // of a value on the line
const LOAD_DIVISOR = 3; // a third of what the line can carry, at most
const MIN_INTERVAL_MS = 200; // between two readings: nobody reads more often
const RESTART_PAUSE_MS = 1000; // after a program, before it begins again
const EMPTY_LINE = 'W(0)'; // a line that ends at once, in the place of the other one
/** What the program before reads no more after. */
const READ_END_EVENTS = ['STARTED', 'DONE', 'STOPPED', 'FAULT', 'RESTARTED', 'LOST'];
/** What does not end by itself what runs, and needs the robot for itself. */
const INTERRUPTING_REQUESTS = ['identify', 'name', 'trim', 'claim'];

export class SensorWatch {
  #page;
  /** @type {RobotInfo | null} */
  #robotInfo = null;
  #isWanted = false; // until this person, a stop or the robot's button ends it
  #isFree = false; // nothing else runs, or was asked for, or has stopped the robot
  #isBusy = false; // something else runs
  #isOn = false;
  /** With which it begins. @type {RobotInfo | null} */
  #startingRobot = null;
  #isOwnLine = false; // what runs, or ran last
  #isProgramWaiting = false; // the robot's program, for its button
  #startTimer = 0;
  #frameRequest = 0;
  /** The lines of this part of the page, by their checksums. @type {Map<string, CheckResult>} */
  #ownLines = new Map();
  /** By the name of the sensor, as the robot has told them. @type {Map<string, string>} */
  #readings = new Map();
  /** Sensors that the program which runs has read. @type {Set<string>} */
  #sensorsRead = new Set();
  #began_ms = 0;
  #plot = new Plot(element('senses_plot', HTMLCanvasElement));
  #watchButton = element('link_watch', HTMLButtonElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#watchButton.addEventListener('click', () => this.#toggle());
    pageState.sideId.subscribe(() => this.#followSide());
    pageState.language.subscribe(() => this.#show());
    pageState.areWordsShown.subscribe(() => this.#show());
    new ResizeObserver(() => this.#show()).observe(element('senses', HTMLElement));
  }

  /** A robot is connected, or none any more. @param {RobotInfo | null} robotInfo */
  onRobotChange(robotInfo) {
    this.#robotInfo = robotInfo;
    this.#isFree = robotInfo?.is_idle ?? false;
    this.#isBusy = robotInfo?.is_running ?? false;
    this.#isWanted = loadText(STORAGE_KEY) !== '' && robotInfo?.owner !== 'other';
    this.#isProgramWaiting = this.#isOwnLine = false;
    this.#readings.clear();
    this.#sensorsRead.clear();
    this.#plot.clear();
    this.#began_ms = performance.now();
    this.#stopWatching();
    this.#followSide();
  }

  /** Something is about to be asked of the robot; what is returned is waited for. @param {Record<string, unknown>} request */
  pauseFor(request) {
    const { do: action } = request;
    if (action === 'upload' || action === 'live' || action === 'start') {
      if (action === 'upload') this.#isProgramWaiting = true; // until it begins
      this.#isFree = false;
      this.#stopWatching();
      return null;
    }
    if (!INTERRUPTING_REQUESTS.includes(String(action)) || !this.#isOn) return null;
    return this.#giveWay();
  }

  /** That was answered. @param {Record<string, unknown>} request */
  resumeAfter(request) {
    if (INTERRUPTING_REQUESTS.includes(String(request['do']))) this.#startLater();
  }

  /** Somebody has pressed STOP. */
  stop() {
    if (this.#isOn || this.#isStarting) this.#isWanted = false;
    this.#isFree = false;
    this.#stopWatching();
  }

  /** @param {RobotEvent} event @param {boolean} isTyped it reports a line that somebody has typed @returns {boolean} whether nobody else is to hear of it */
  onEvent({ event, program: checksum = '', value = '', at: offset = -1, cause, rows = [] }, isTyped) {
    if (event === 'READING') this.#applyReadRows(rows);
    else if (READ_END_EVENTS.includes(event)) this.#sensorsRead.clear();
    const isOwn = this.#ownLines.has(checksum);
    if (event === 'STARTED') this.#isOwnLine = isOwn;
    if (event === 'SHOW') {
      if (isOwn) this.#applyReading(checksum, offset, value);
      return isOwn || (!checksum && this.#isOwnLine);
    }
    if (event === 'STARTED' || event === 'PLACE') {
      if (isOwn) return true;
      if (event === 'PLACE' && offset < 0) return false;
      if (!isTyped) this.#isProgramWaiting = false; // by the robot's button, too, of which nothing tells but where the program is
      this.#isFree = this.#isOwnLine = false;
      this.#isBusy = true;
      this.#stopWatching();
    } else if (event === 'DONE') {
      const wasOwn = this.#isOwnLine;
      this.#isOwnLine = this.#isBusy = false;
      this.#stopWatching();
      if (wasOwn) return true;
      this.#isFree = true;
      this.#startLater();
    } else if (['STOPPED', 'FAULT', 'RESTARTED', 'LOST'].includes(event)) {
      if (this.#isOn && cause === 'BUTTON') queueMicrotask(() => this.#page.say('say_watch_button')); // after what is said of the stop
      if (this.#isOn) this.#isWanted = false;
      this.#isFree = this.#isBusy = this.#isOwnLine = false;
      this.#stopWatching();
    }
    return false;
  }

  // -- its line -----------------------------------------------------------------------------------

  #toggle() {
    const wasOn = this.#isOn || this.#isStarting;
    this.#isWanted = !wasOn;
    storeText(STORAGE_KEY, wasOn ? '' : 'on');
    if (wasOn) this.#giveWay();
    else if (this.#isBusy) this.#page.say('say_watch_later');
    else {
      this.#isFree = true; // also of one that stands since a stop
      this.#isProgramWaiting = false;
      this.#startWatching(false);
    }
    this.#show();
  }

  /** It is seen only beside the program, and goes on only while it is. */
  #followSide() {
    if (pageState.sideId.value === 'side_real') this.#startWatching();
    else if (this.#isOn) this.#giveWay();
  }

  #startLater() {
    clearTimeout(this.#startTimer);
    this.#startTimer = window.setTimeout(() => this.#startWatching(), RESTART_PAUSE_MS);
  }

  get #isStarting() {
    return this.#robotInfo !== null && this.#startingRobot === this.#robotInfo;
  }

  get #canStart() {
    return this.#robotInfo !== null && this.#isWanted && this.#isFree && !this.#isProgramWaiting && pageState.sideId.value === 'side_real';
  }

  async #startWatching(isQuiet = true) {
    const robotInfo = this.#robotInfo;
    if (!this.#canStart || this.#isOn || this.#isStarting) return;
    this.#startingRobot = robotInfo;
    try {
      const line = await this.#checkLine(this.#lineText);
      if (!line.image || !this.#canStart || robotInfo !== this.#robotInfo) return;
      const answer = await this.#page.ask({ do: 'live', image: line.image, robot: this.#robotName }, isQuiet);
      if (robotInfo !== this.#robotInfo) return;
      if (answer) this.#isOwnLine = true;
      else this.#isWanted = false; // it is not asked again and again
      this.#isOn = answer !== null && this.#canStart;
      if (this.#isOn) this.#page.onWatchingChange(true);
      else if (answer && this.#isFree) await this.#giveWay(); // nobody wants it any more
    } finally {
      if (this.#startingRobot === robotInfo) this.#startingRobot = null;
      this.#show();
    }
  }

  /** Its line makes room. */
  async #giveWay() {
    this.#stopWatching();
    const robotInfo = this.#robotInfo, line = await this.#checkLine(EMPTY_LINE);
    if (this.#isOwnLine && robotInfo === this.#robotInfo) await this.#page.ask({ do: 'live', image: line.image, robot: this.#robotName }, true);
  }

  #stopWatching() {
    clearTimeout(this.#startTimer);
    if (this.#isOn) this.#page.onWatchingChange(false);
    this.#isOn = false;
    this.#show();
  }

  get #robotName() {
    return this.#robotInfo?.robot ?? '';
  }

  get #sensors() {
    return devicesOf(this.#robotName, 'sensor');
  }

  get #lineText() {
    const statements = this.#sensors.map((device) => `SHOW(${device.text});`);
    const interval_ms = Math.max(MIN_INTERVAL_MS, (LOAD_DIVISOR * SHOW_BITS * statements.length * 1000) / (robotOf(this.#robotName)?.baud ?? 9600));
    return `LOOP(FOREVER);${statements.join('')}W(${Math.ceil(interval_ms / 50) / 20});END_LOOP`;
  }

  /** @param {string} line @returns {Promise<CheckResult>} */
  async #checkLine(line) {
    const checkResult = await this.#page.python.ask({ do: 'check', robot: this.#robotName, language: currentLanguage() }, new TextEncoder().encode(`SI|${line}`));
    this.#ownLines.set(checkResult.program, checkResult);
    return checkResult;
  }

  // -- what it tells ------------------------------------------------------------------------------

  /** @param {string} checksum @param {number} offset @param {string} value */
  #applyReading(checksum, offset, value) {
    const line = this.#ownLines.get(checksum);
    const show = line && findShow(line, offset);
    if (!show) return;
    this.#readings.set(show[1], value);
    this.#drawReadings();
  }

  /** @param {[number, string][]} rows what a program has read, for who has watched the sensors before */
  #applyReadRows(rows) {
    if (!this.#readings.size) return;
    for (const [, rowText] of rows) {
      const [kind, name = '', value = ''] = rowText.split(' ');
      if (kind !== 'READ') continue;
      this.#sensorsRead.add(name);
      this.#readings.set(name, value);
    }
    if (this.#sensorsRead.size) this.#drawReadings();
  }

  #drawReadings() {
    this.#plot.add(performance.now() - this.#began_ms, this.#sensors.map((device) => ({ name: deviceName(device), value: parseShownValue(this.#valueOf(device.text)) })));
    this.#frameRequest ||= requestAnimationFrame(() => this.#show());
  }

  /** What is known now: of a program that runs, what it reads. @param {string} name */
  #valueOf(name) {
    return !this.#sensorsRead.size || this.#sensorsRead.has(name) ? this.#readings.get(name) : undefined;
  }

  #show() {
    cancelAnimationFrame(this.#frameRequest);
    this.#frameRequest = 0;
    if (!pageState.language.value) return;
    const container = element('senses', HTMLElement);
    setHidden(this.#watchButton, !this.#sensors.length);
    setHidden(container, !this.#readings.size);
    this.#watchButton.setAttribute('aria-pressed', String(this.#isOn || this.#isStarting));
    container.classList.toggle('past', !this.#isOn && !this.#sensorsRead.size);
    if (container.hidden) return;
    showRows(element('gauges', HTMLElement), this.#sensors.map((device) => {
      const reading = this.#valueOf(device.text) ?? '';
      return [deviceName(device), reading && readingText(device, reading), percentOfRange(device, parseShownValue(reading))];
    }));
    this.#plot.draw();
  }
}
