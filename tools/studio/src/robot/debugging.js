// Breakpoints and steps of a program on a real robot, and the values where it is halted.

import { element, hide } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { showRows, written } from '../page/rows.js';
import { known, text } from '../page/texts.js';
import { LINK } from '../page/words.js';
import { Stops } from '../writing/parts.js';

/** @typedef {import('../python.js').Checked} Checked */
/** @import { About, Answer, RobotEvent } from './transport.js' */

/**
 * @typedef {object} Page
 * @property {(request: Record<string, unknown>, done?: () => void, isQuiet?: boolean) => Promise<Answer | null>} ask null if nothing came of it, which was said unless it is quiet
 * @property {() => void} uploadPaused sends the program, and has it halt before its first instruction
 * @property {(key: import('../page/texts.js').Key, values?: Record<string, number>) => void} say
 * @property {() => Promise<boolean>} canGetHalting whether there is a firmware with breakpoints for such a robot
 * @property {() => void} getHalting
 * @property {import('./place.js').RobotPlace} place
 * @property {import('./recorder.js').Recorder} recorder
 */

const ENDS = ['DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST'];

export class Debugging {
  #page;
  /** @type {About | null} */
  #about = null;
  /** The newest program that the robot has from here. @type {Checked | null} */
  #program = null;
  /** Its places; none once the text is another one. @type {Checked['places']} */
  #places = [];
  #stops = new Stops();
  #put = ''; // the places that the robot has
  #isRunning = false;
  #isStepping = false;
  #isFirst = false; // it is to halt before its first instruction
  #asked = 0; // starts and stops
  /** Where it is halted. @type {object | null} */
  #halt = null;
  #isRead = false; // what it is like there
  /** @type {number[]} */
  #variables = [];
  /** The others. @type {[string, number][]} */
  #tasks = [];
  #step = element('link_step', HTMLButtonElement);
  #goOn = element('link_go_on', HTMLButtonElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#step.addEventListener('click', () => this.#onStep());
    this.#goOn.addEventListener('click', () => this.#resume(false));
    element('link_get_halting', HTMLButtonElement).addEventListener('click', () => page.getHalting());
    pageState.breakpoints.subscribe(() => this.#breakpointsChanged());
    pageState.programText.subscribe(() => { this.#places = []; });
    pageState.language.subscribe(() => this.#show());
  }

  /** A robot is connected, or none any more. @param {About | null} about */
  meet(about) {
    this.#about = about;
    this.#program = null;
    this.#put = '';
    this.#isRunning = about?.is_running ?? false;
    this.#end();
  }

  /**
   * A program is about to be sent. Returns what gives the robot its places and then starts it; none where it can start at
   * once. A stop that was pressed meanwhile counts.
   * @param {Checked} program
   * @param {boolean} isPaused before its first instruction
   * @returns {((starts: boolean) => Promise<void>) | null}
   */
  sends(program, isPaused) {
    const asked = ++this.#asked;
    this.#program = program;
    this.#places = program.places;
    this.#find();
    this.#isFirst = isPaused;
    this.#put = '';
    this.#show();
    if (!this.#can || !(isPaused || this.#wanted.length)) return null;
    return async (starts) => {
      if (asked === this.#asked && await this.#send() && asked === this.#asked && starts) await this.#page.ask({ do: 'start' });
    };
  }

  /** What the robot has is to start: with the places, if it is the program from here. */
  async startAgain() {
    this.#isFirst = false;
    if (this.#put) this.#put = '?'; // a line that ran meanwhile may have taken them away
    const asked = ++this.#asked;
    if (this.#program && this.#can && !await this.#send()) return;
    if (asked === this.#asked) await this.#page.ask({ do: 'start' }, () => this.#page.say('say_started'));
  }

  /** Somebody has pressed STOP. */
  stop() {
    this.#asked += 1;
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'HALTED' && event.is_program) this.#onHalt(Number(event.at), Number(event.task));
    else if (event.event === 'STARTED' || ENDS.includes(event.event)) {
      this.#isRunning = event.event === 'STARTED';
      this.#isFirst &&= this.#isRunning;
      this.#end();
    }
  }

  #end() {
    this.#halt = null;
    this.#isRead = false;
    this.#isStepping = false;
    this.#variables = [];
    this.#tasks = [];
    this.#show();
  }

  get #can() {
    return this.#about?.has_breakpoints ?? false;
  }

  // -- places -------------------------------------------------------------------------------------

  #find() {
    this.#stops.find(pageState.breakpoints.value, this.#places);
  }

  /** Where a robot halts that is to stop at the breakpoints: before a statement of its code. */
  get #wanted() {
    const { places, halts } = this.#program ?? { places: [], halts: [] };
    const found = this.#stops.offsets.map((offset) => halts[places.findIndex(([at]) => at === offset)] ?? offset);
    return [...new Set(found)];
  }

  #breakpointsChanged() {
    this.#find();
    if (this.#program && this.#can && !this.#isFirst) this.#send();
    this.#show();
  }

  /** Tells the robot where to halt, if that is new. Returns whether it knows. */
  async #send() {
    const wanted = this.#wanted;
    const places = (this.#isFirst ? [0, ...wanted.filter((at) => at !== 0)] : wanted).slice(0, LINK.most_breakpoints);
    if (places.join() === this.#put) return true;
    this.#put = places.join();
    return await this.#page.ask({ do: 'break', places }) !== null;
  }

  // -- a halt -------------------------------------------------------------------------------------

  #onStep() {
    if (!this.#can) this.#page.say('say_no_breakpoints');
    else if (this.#halt) this.#resume(true);
    else if (!this.#isRunning) this.#page.uploadPaused();
  }

  /** @param {boolean} isStep */
  #resume(isStep) {
    if (!this.#halt) return;
    this.#halt = null;
    this.#isRead = false;
    this.#isStepping = isStep;
    this.#page.place.goOn();
    this.#page.recorder.goOn();
    this.#page.say('say_started');
    this.#show();
    this.#page.ask({ do: 'resume', is_step: isStep });
  }

  /** @param {number} at @param {number} task */
  #onHalt(at, task) {
    if (!this.#program) return;
    const { places, halts, program } = this.#program;
    const place = places[halts.lastIndexOf(at)];
    this.#page.recorder.halt();
    if (!place && (this.#isStepping || this.#isFirst)) { // within one instruction of the text
      this.#page.ask({ do: 'resume', is_step: true });
      return;
    }
    const halt = this.#halt = {};
    this.#isFirst = false;
    this.#send();
    this.#page.place.hold(place?.[0] ?? at, program);
    if (place) this.#page.say('robot_held', { line: place[1] });
    this.#show();
    this.#read(halt, task);
  }

  /** @param {object} halt @param {number} task */
  async #read(halt, task) {
    /** @type {number[]} */
    const variables = [];
    while (variables.length < (this.#program?.variables.length ?? 0)) {
      const answer = await this.#page.ask({ do: 'variables', first: variables.length }, undefined, true);
      if (halt !== this.#halt || !answer?.variables?.length) return;
      variables.push(...answer.variables);
    }
    const answer = await this.#page.ask({ do: 'tasks' }, undefined, true);
    if (halt !== this.#halt || !answer?.tasks) return;
    this.#variables = variables;
    this.#tasks = answer.tasks.filter(([state], k) => k !== task && state !== 'ENDED');
    this.#isRead = true;
    this.#show();
  }

  /** @param {boolean} isDeaf there are breakpoints, and the robot cannot halt at them */
  async #offerHalting(isDeaf) {
    const about = this.#about;
    const can = isDeaf && await this.#page.canGetHalting();
    if (about === this.#about) hide(element('link_halting', HTMLElement), !can || !pageState.breakpoints.value.length);
  }

  #show() {
    this.#step.disabled = this.#isRunning && !this.#halt;
    this.#goOn.disabled = !this.#halt;
    hide(this.#step, !this.#can && !pageState.breakpoints.value.length); // it says why the robot cannot
    hide(this.#goOn, !this.#can);
    const many = this.#wanted.length > LINK.most_breakpoints;
    const said = element('link_breakpoints', HTMLElement);
    const isDeaf = this.#about !== null && !this.#can && pageState.breakpoints.value.length > 0;
    said.textContent = isDeaf ? text('say_no_breakpoints') : many ? text('link_most_breakpoints', { most: LINK.most_breakpoints }) : '';
    hide(said, !isDeaf && !many);
    this.#offerHalting(isDeaf);
    const place = element('link_values', HTMLElement);
    const { places = [], variables = [] } = this.#program ?? {};
    const rows = this.#variables.length || this.#tasks.length ? [
      ...variables.map(({ name, is_yes_no }, k) => [name, written(this.#variables[k], is_yes_no)]),
      ...this.#tasks.map(([state, at]) => [
        text('task_at', { line: places.findLast(([offset]) => offset <= at)?.[1] ?? 0 }), text(known(`task_${state}`)),
      ]),
    ] : [];
    showRows(place, rows);
    place.classList.toggle('past', !this.#isRead);
    hide(place, !rows.length);
    document.documentElement.dataset['halt'] = this.#isRead ? 'read' : this.#halt ? 'halted' : this.#isRunning ? 'running' : 'none';
  }
}
