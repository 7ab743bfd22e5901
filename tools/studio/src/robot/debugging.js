// Breakpoints and steps of a program on a real robot, and the values where it is halted.

import { sentenceAtPlace } from '../blocks/said.js';
import { element, setHidden } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { showRows, variableText } from '../page/rows.js';
import { textKey, text } from '../page/texts.js';
import { LINK } from '../page/words.js';
import { StopOffsets } from '../writing/parts.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @import { RobotInfo, Answer, RobotEvent } from './transport.js' */

/**
 * @typedef {object} Page
 * @property {(request: Record<string, unknown>, onDone?: () => void, isQuiet?: boolean) => Promise<Answer | null>} ask null if nothing came of it, which was said unless it is quiet
 * @property {() => void} uploadPaused sends the program, and has it halt before its first instruction
 * @property {(key: import('../page/texts.js').Key) => void} say
 * @property {(makeSentence: () => string, name: string) => void} sayAnew a sentence that is made anew in another language or view
 * @property {() => Promise<boolean>} canGetHaltingFirmware whether there is a firmware with breakpoints for such a robot
 * @property {() => void} getHaltingFirmware
 * @property {import('./place.js').RunningPlace} place
 * @property {import('./recorder.js').Recorder} recorder
 */

const END_EVENTS = ['DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST'];
const UNKNOWN_PLACES = '?'; // no list of places: it may have none

export class Debugging {
  #page;
  /** @type {RobotInfo | null} */
  #robotInfo = null;
  /** The newest program that the robot has from here. @type {CheckResult | null} */
  #program = null;
  /** Its places; none once the text is another one. @type {CheckResult['places']} */
  #places = [];
  #stopOffsets = new StopOffsets();
  #sentPlacesKey = ''; // the places that the robot has
  #isRunning = false;
  #isStepping = false;
  #isHaltingFirst = false; // it is to halt before its first instruction
  #requestCount = 0; // starts and stops
  /** Where it is halted. @type {object | null} */
  #halt = null;
  #isHaltRead = false; // what it is like there
  /** @type {number[]} */
  #variables = [];
  /** The others. @type {[string, number][]} */
  #otherTasks = [];
  #stepButton = element('link_step', HTMLButtonElement);
  #continueButton = element('link_go_on', HTMLButtonElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#stepButton.addEventListener('click', () => this.#onStep());
    this.#continueButton.addEventListener('click', () => this.#resume(false));
    element('link_get_halting', HTMLButtonElement).addEventListener('click', () => page.getHaltingFirmware());
    pageState.breakpoints.subscribe(() => this.#onBreakpointsChange());
    pageState.programText.subscribe(() => { this.#places = []; });
    for (const observable of [pageState.language, pageState.areBlocksNamed]) observable.subscribe(() => this.#show());
  }

  /** A robot is connected, or none any more. @param {RobotInfo | null} robotInfo */
  onRobotChange(robotInfo) {
    this.#robotInfo = robotInfo;
    this.#program = null;
    this.#sentPlacesKey = '';
    this.#isRunning = robotInfo?.is_running ?? false;
    this.#endHalt();
  }

  /**
   * A program is about to be sent. Returns what gives the robot its places and then starts it; none where it can start at
   * once. A stop that was pressed meanwhile counts.
   * @param {CheckResult} program
   * @param {boolean} isPaused before its first instruction
   * @returns {((starts: boolean) => Promise<void>) | null}
   */
  onUpload(program, isPaused) {
    const requestNumber = ++this.#requestCount;
    this.#program = program;
    this.#places = program.places;
    this.#updateStopOffsets();
    this.#isHaltingFirst = isPaused;
    this.#sentPlacesKey = '';
    this.#show();
    if (!this.#canHalt || !(isPaused || this.#haltOffsets.length)) return null;
    return async (isStarted) => {
      if (requestNumber === this.#requestCount && await this.#sendPlaces() && requestNumber === this.#requestCount && isStarted) await this.#page.ask({ do: 'start' });
    };
  }

  /** What the robot has is to start: with the places, if it is the program from here. */
  async startAgain() {
    this.#isHaltingFirst = false;
    const requestNumber = ++this.#requestCount;
    if (this.#program && this.#canHalt && !await this.#sendPlaces()) return;
    if (requestNumber === this.#requestCount) await this.#page.ask({ do: 'start' }, () => this.#page.say('say_started'));
  }

  /** Somebody has pressed STOP. */
  stop() {
    this.#requestCount += 1;
  }

  /** A line is sent: it takes the robot's places away. */
  onLineSent() {
    if (this.#sentPlacesKey) this.#sentPlacesKey = UNKNOWN_PLACES;
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'HALTED' && event.is_program) this.#onHalt(Number(event.at), Number(event.task));
    else if (event.event === 'STARTED' || END_EVENTS.includes(event.event)) {
      this.#isRunning = event.event === 'STARTED';
      this.#isHaltingFirst &&= this.#isRunning;
      this.#endHalt();
    }
  }

  #endHalt() {
    this.#halt = null;
    this.#isHaltRead = false;
    this.#isStepping = false;
    this.#variables = [];
    this.#otherTasks = [];
    this.#show();
  }

  get #canHalt() {
    return this.#robotInfo?.has_breakpoints ?? false;
  }

  // -- places -------------------------------------------------------------------------------------

  #updateStopOffsets() {
    this.#stopOffsets.update(pageState.breakpoints.value, this.#places);
  }

  /** Where a robot halts that is to stop at the breakpoints: before a statement of its code. */
  get #haltOffsets() {
    const { places, halts } = this.#program ?? { places: [], halts: [] };
    const haltOffsets = this.#stopOffsets.offsets.map((offset) => halts[places.findIndex(([placeOffset]) => placeOffset === offset)] ?? offset);
    return [...new Set(haltOffsets)];
  }

  #onBreakpointsChange() {
    this.#updateStopOffsets();
    if (this.#program && this.#canHalt && !this.#isHaltingFirst) this.#sendPlaces();
    this.#show();
  }

  /** Tells the robot where to halt, if that is new. Returns whether it knows. @returns {Promise<boolean>} */
  async #sendPlaces() {
    const haltOffsets = this.#haltOffsets;
    const places = (this.#isHaltingFirst ? [0, ...haltOffsets.filter((offset) => offset !== 0)] : haltOffsets).slice(0, LINK.most_breakpoints);
    if (places.join() === this.#sentPlacesKey) return true;
    const sentPlacesKey = this.#sentPlacesKey = places.join();
    if (await this.#page.ask({ do: 'break', places }) === null) {
      if (this.#sentPlacesKey === sentPlacesKey) this.#sentPlacesKey = UNKNOWN_PLACES;
      return false;
    }
    return this.#sentPlacesKey !== UNKNOWN_PLACES || this.#sendPlaces();
  }

  // -- a halt -------------------------------------------------------------------------------------

  #onStep() {
    if (!this.#canHalt) this.#page.say('say_no_breakpoints');
    else if (this.#halt) this.#resume(true);
    else if (!this.#isRunning) this.#page.uploadPaused();
  }

  /** @param {boolean} isStep */
  #resume(isStep) {
    if (!this.#halt) return;
    this.#halt = null;
    this.#isHaltRead = false;
    this.#isStepping = isStep;
    this.#page.place.resume();
    this.#page.recorder.resume();
    this.#page.say('say_started');
    this.#show();
    this.#page.ask({ do: 'resume', is_step: isStep });
  }

  /** @param {number} offset @param {number} taskNumber */
  #onHalt(offset, taskNumber) {
    if (!this.#program) return;
    const { places, halts, program: checksum, text: programText } = this.#program;
    const place = places[halts.lastIndexOf(offset)];
    this.#page.recorder.halt();
    if (!place && (this.#isStepping || this.#isHaltingFirst)) { // within one instruction of the text
      this.#page.ask({ do: 'resume', is_step: true });
      return;
    }
    const halt = this.#halt = {};
    this.#isHaltingFirst = false;
    this.#sendPlaces();
    this.#page.place.halt(place?.[0] ?? offset, checksum);
    if (place) this.#page.sayAnew(() => this.#sentenceAt('robot_held', 'robot_held_block', programText, place), 'robot_held');
    this.#show();
    this.#readValues(halt, taskNumber);
  }

  /** @param {import('../page/texts.js').Key} lineKey @param {import('../page/texts.js').Key} blockKey @param {string} programText @param {CheckResult['places'][number]} place */
  #sentenceAt(lineKey, blockKey, programText, [, line, column]) {
    return sentenceAtPlace(lineKey, blockKey, programText, { line, column });
  }

  /** @param {object} halt @param {number} taskNumber */
  async #readValues(halt, taskNumber) {
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
    this.#otherTasks = answer.tasks.filter(([state], index) => index !== taskNumber && state !== 'ENDED');
    this.#isHaltRead = true;
    this.#show();
  }

  /** @param {boolean} lacksBreakpoints there are breakpoints, and the robot cannot halt at them */
  async #offerHaltingFirmware(lacksBreakpoints) {
    const robotInfo = this.#robotInfo;
    const isAvailable = lacksBreakpoints && await this.#page.canGetHaltingFirmware();
    if (robotInfo === this.#robotInfo) setHidden(element('link_halting', HTMLElement), !isAvailable || !pageState.breakpoints.value.length);
  }

  #show() {
    this.#stepButton.disabled = this.#isRunning && !this.#halt;
    this.#continueButton.disabled = !this.#halt;
    setHidden(this.#stepButton, !this.#canHalt && !pageState.breakpoints.value.length); // it says why the robot cannot
    setHidden(this.#continueButton, !this.#canHalt);
    const hasTooManyBreakpoints = this.#haltOffsets.length > LINK.most_breakpoints;
    const notice = element('link_breakpoints', HTMLElement);
    const lacksBreakpoints = this.#robotInfo !== null && !this.#canHalt && pageState.breakpoints.value.length > 0;
    notice.textContent = lacksBreakpoints ? text('say_no_breakpoints') : hasTooManyBreakpoints ? text('link_most_breakpoints', { most: LINK.most_breakpoints }) : '';
    setHidden(notice, !lacksBreakpoints && !hasTooManyBreakpoints);
    this.#offerHaltingFirmware(lacksBreakpoints);
    const valueList = element('link_values', HTMLElement);
    const { places = [], variables = [], text: programText = '' } = this.#program ?? {};
    const rows = this.#variables.length || this.#otherTasks.length ? [
      ...variables.map(({ name, is_yes_no }, index) => [name, variableText(this.#variables[index], is_yes_no)]),
      ...this.#otherTasks.map(([state, taskOffset]) => [
        this.#sentenceAt('task_at', 'task_at_block', programText, places.findLast(([offset]) => offset <= taskOffset) ?? [0, 1, 1, 1, 1]), text(textKey(`task_${state}`)),
      ]),
    ] : [];
    showRows(valueList, rows);
    valueList.classList.toggle('past', !this.#isHaltRead);
    setHidden(valueList, !rows.length);
    document.documentElement.dataset['halt'] = this.#isHaltRead ? 'read' : this.#halt ? 'halted' : this.#isRunning ? 'running' : 'none';
  }
}
