// What a real robot senses while it runs no program: as gauges, and as curves.
//
// No message of the link asks for readings, so a line runs on the robot that shows them again and again. It has no
// motor in it. It begins where nothing runs and nothing waits for the robot's button, which stops a line instead of
// starting the program; whatever else is asked of the robot comes first. A stop ends it until somebody wants it again.

import { element, hide } from '../page/elements.js';
import { keepAt, kept } from '../page/kept.js';
import { measured, numberOf, partOf } from '../page/readings.js';
import { showRows } from '../page/rows.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage } from '../page/texts.js';
import { devicesOf, nameOf, robotOf } from '../page/words.js';
import { Plot } from '../virtual/plot.js';
import { showAt } from '../writing/shows.js';

/** @typedef {import('../python.js').Checked} Checked */
/** @import { About, Answer, RobotEvent } from './transport.js' */

/**
 * @typedef {object} Page
 * @property {import('../python.js').Python} python
 * @property {(request: Record<string, unknown>, isQuiet: boolean) => Promise<Answer | null>} ask null if nothing came of it, which was said unless it is quiet
 * @property {(key: import('../page/texts.js').Key) => void} say
 * @property {(isOn: boolean) => void} tell whether the readings come
 */

const PLACE = 'tiniscript.watches'; // whether somebody has wanted it
const SHOW_BITS = 180; // of a value on the line
const LINE_SHARE = 3; // a third of what the line can carry, at most
const LEAST_MS = 200; // between two readings: nobody reads more often
const REST_MS = 1000; // after a program, before it begins again
const REST = 'W(0)'; // a line that ends at once, in the place of the other one
/** What does not end by itself what runs, and needs the robot for itself. */
const ASIDE = ['identify', 'name', 'trim', 'claim'];

export class Watching {
  #page;
  /** @type {About | null} */
  #about = null;
  #isWanted = false; // until this person, a stop or the robot's button ends it
  #isFree = false; // nothing else runs, or was asked for, or has stopped the robot
  #isBusy = false; // something else runs
  #isOn = false;
  #isBeginning = false;
  #isOurs = false; // what runs, or ran last
  #waits = false; // the robot's program, for its button
  #timer = 0;
  #picture = 0;
  /** The lines of this part of the page, by their checksums. @type {Map<string, Checked>} */
  #lines = new Map();
  /** By the name of the sensor, as the robot has told them. @type {Map<string, string>} */
  #readings = new Map();
  #began_ms = 0;
  #plot = new Plot(element('senses_plot', HTMLCanvasElement));
  #button = element('link_watch', HTMLButtonElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#button.addEventListener('click', () => this.#press());
    pageState.side.subscribe(() => this.#look());
    pageState.language.subscribe(() => this.#show());
    pageState.areWordsShown.subscribe(() => this.#show());
    new ResizeObserver(() => this.#show()).observe(element('senses', HTMLElement));
  }

  /** A robot is connected, or none any more. @param {About | null} about */
  meet(about) {
    this.#about = about;
    this.#isFree = about?.is_idle ?? false;
    this.#isBusy = about?.is_running ?? false;
    this.#isWanted = kept(PLACE) !== '' && about?.owner !== 'other';
    this.#waits = this.#isOurs = false;
    this.#readings.clear();
    this.#plot.begin();
    this.#began_ms = performance.now();
    this.#end();
    this.#look();
  }

  /** Something is about to be asked of the robot; what is returned is waited for. @param {Record<string, unknown>} request */
  before(request) {
    const { do: what } = request;
    if (what === 'upload' || what === 'live' || what === 'start') {
      if (what === 'upload') this.#waits = true; // until it begins
      this.#isFree = false;
      this.#end();
      return null;
    }
    if (!ASIDE.includes(String(what)) || !this.#isOn) return null;
    return this.#rest();
  }

  /** That was answered. @param {Record<string, unknown>} request */
  after(request) {
    if (ASIDE.includes(String(request['do']))) this.#later();
  }

  /** Somebody has pressed STOP. */
  stop() {
    if (this.#isOn || this.#isBeginning) this.#isWanted = false;
    this.#isFree = false;
    this.#end();
  }

  /** @param {RobotEvent} event @param {boolean} isTyped it tells of a line that somebody has typed @returns {boolean} whether nobody else is to hear of it */
  onEvent({ event, program = '', value = '', at = -1, cause }, isTyped) {
    const isOurs = this.#lines.has(program);
    if (event === 'STARTED') this.#isOurs = isOurs;
    if (event === 'SHOW') {
      if (isOurs) this.#take(program, at, value);
      return isOurs || (!program && this.#isOurs);
    }
    if (event === 'STARTED' || event === 'PLACE') {
      if (isOurs) return true;
      if (event === 'PLACE' && at < 0) return false;
      if (!isTyped) this.#waits = false; // by the robot's button, too, of which nothing tells but where the program is
      this.#isFree = this.#isOurs = false;
      this.#isBusy = true;
      this.#end();
    } else if (event === 'DONE') {
      const wasOurs = this.#isOurs;
      this.#isOurs = this.#isBusy = false;
      this.#end();
      if (wasOurs) return true;
      this.#isFree = true;
      this.#later();
    } else if (['STOPPED', 'FAULT', 'RESTARTED', 'LOST'].includes(event)) {
      if (this.#isOn && cause === 'BUTTON') queueMicrotask(() => this.#page.say('say_watch_button')); // after what is said of the stop
      if (this.#isOn) this.#isWanted = false;
      this.#isFree = this.#isBusy = this.#isOurs = false;
      this.#end();
    }
    return false;
  }

  // -- its line -----------------------------------------------------------------------------------

  #press() {
    const wasOn = this.#isOn || this.#isBeginning;
    this.#isWanted = !wasOn;
    keepAt(PLACE, wasOn ? '' : 'on');
    if (wasOn) this.#rest();
    else if (this.#isBusy) this.#page.say('say_watch_later');
    else {
      this.#isFree = true; // also of one that stands since a stop
      this.#waits = false;
      this.#begin(false);
    }
    this.#show();
  }

  /** It is seen only beside the program, and goes on only while it is. */
  #look() {
    if (pageState.side.value === 'side_real') this.#begin();
    else if (this.#isOn) this.#rest();
  }

  #later() {
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#begin(), REST_MS);
  }

  get #can() {
    return this.#about !== null && this.#isWanted && this.#isFree && !this.#waits && pageState.side.value === 'side_real';
  }

  async #begin(isQuiet = true) {
    const about = this.#about;
    if (!this.#can || this.#isOn || this.#isBeginning) return;
    this.#isBeginning = true;
    try {
      const line = await this.#line(this.#text);
      if (!line.image || !this.#can || about !== this.#about) return;
      const answer = await this.#page.ask({ do: 'live', image: line.image, robot: this.#robot }, isQuiet);
      if (about !== this.#about) return;
      if (answer) this.#isOurs = true;
      else this.#isWanted = false; // it is not asked again and again
      this.#isOn = answer !== null && this.#can;
      if (this.#isOn) this.#page.tell(true);
      else if (answer && this.#isFree) await this.#rest(); // nobody wants it any more
    } finally {
      this.#isBeginning = false;
      this.#show();
    }
  }

  /** Its line makes room. */
  async #rest() {
    this.#end();
    const line = await this.#line(REST);
    if (this.#isOurs) await this.#page.ask({ do: 'live', image: line.image, robot: this.#robot }, true);
  }

  #end() {
    clearTimeout(this.#timer);
    if (this.#isOn) this.#page.tell(false);
    this.#isOn = false;
    this.#show();
  }

  get #robot() {
    return this.#about?.robot ?? '';
  }

  get #sensors() {
    return devicesOf(this.#robot, 'sensor');
  }

  get #text() {
    const shows = this.#sensors.map((device) => `SHOW(${device.text});`);
    const every_ms = Math.max(LEAST_MS, (LINE_SHARE * SHOW_BITS * shows.length * 1000) / (robotOf(this.#robot)?.baud ?? 9600));
    return `LOOP(FOREVER);${shows.join('')}W(${Math.ceil(every_ms / 50) / 20});END_LOOP`;
  }

  /** @param {string} line @returns {Promise<Checked>} */
  async #line(line) {
    const found = await this.#page.python.ask({ do: 'check', robot: this.#robot, language: currentLanguage() }, new TextEncoder().encode(`SI|${line}`));
    this.#lines.set(found.program, found);
    return found;
  }

  // -- what it tells ------------------------------------------------------------------------------

  /** @param {string} program @param {number} at @param {string} value */
  #take(program, at, value) {
    const line = this.#lines.get(program);
    const show = line && showAt(line, at);
    if (!show) return;
    this.#readings.set(show[1], value);
    this.#plot.add(performance.now() - this.#began_ms, this.#sensors.map((device) => ({ name: nameOf(device), value: numberOf(this.#readings.get(device.text)) })));
    this.#picture ||= requestAnimationFrame(() => this.#show());
  }

  #show() {
    cancelAnimationFrame(this.#picture);
    this.#picture = 0;
    if (!pageState.language.value) return;
    const place = element('senses', HTMLElement);
    hide(this.#button, !this.#sensors.length);
    hide(place, !this.#readings.size);
    this.#button.setAttribute('aria-pressed', String(this.#isOn || this.#isBeginning));
    place.classList.toggle('past', !this.#isOn);
    if (place.hidden) return;
    showRows(element('gauges', HTMLElement), this.#sensors.map((device) => {
      const said = this.#readings.get(device.text) ?? '';
      return [nameOf(device), said && measured(device, said), partOf(device, numberOf(said))];
    }));
    this.#plot.draw();
  }
}
