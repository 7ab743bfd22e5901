// A pupil's part in a class: joins with the code, asks for a robot, waits, and drives the robot of
// the own turn as any robot of `tsc studio`.
//
// Pupils of a group (`group.js`) have one turn: who drives is in the answer, and each may take the robot over.
//
// The page asks once a second for its place. That keeps no robot going: only a page that drives does.

import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { element, setHidden, setText } from '../page/elements.js';
import { setToken, noteStopCount, post } from '../robot/host.js';
import { storeDoneLesson, loadDoneLessons } from '../lesson/progress.js';
import { asPlainText } from '../robot/plain_text.js';
import { ConnectionFailure } from '../robot/transport.js';
import { Group } from './group.js';
import { giveRun } from './run.js';
import { makeIcon } from './icons.js';
import { clockText } from './clock.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';
import { CLASS, isRobot } from '../page/words.js';
import { isShippedProgram } from '../start/beginnings.js';
import { storeVersion } from '../programs/versions.js';
import { forgetAll, storeText, loadText } from '../page/kept.js';

const TOKEN_KEY = 'tiniscript.pupil';
const LAST_TOKEN_KEY = 'tiniscript.pupil_before'; // the token of the last page here: work belongs to it
const OPENED_HANDOUT_KEY = 'tiniscript.opened'; // the key of what the teacher gave to all and this pupil opened last
const POLL_MS = 1000;
const QUICK_POLL_MS = 300; // while the next turn may be one's own

/** @typedef {{key: string, text: string, robot: string, lessons: string[]}} GivenWork */
/** @typedef {{key: string, lesson: number, text: string, robot: string}} Handout what the teacher gives to all: a lesson by its number, or a program */
/** @typedef {{handout?: Handout, place: number, waiting: number, robots: number, robot: string, left_s: number, name: string, hand: boolean, given?: GivenWork, over?: string, groups?: import('./group.js').GroupRow[], driver?: string, run?: number, stops?: number}} PupilState */

function makeStayState() {
  return {
    wantsRobot: /** @type {boolean | null} */ (null), // a robot, told at the next look
    isHandWanted: /** @type {boolean | null} */ (null), // help, told at the next look
    sentFields: /** @type {Record<string, string>} */ ({}), // what the teacher's page knows
    handout: /** @type {Handout | null} */ (null), // what is still to be opened
    takenWork: /** @type {GivenWork | null} */ (null), // the work that was given last
    runNumber: 0, // the newest question for a run
    isTakenUnconfirmed: false, // the class has yet to hear that this is here
    isPolling: false,
    queuePlace: -1,
  };
}

export class Pupil {
  #panel;
  #work;
  #page;
  #boxElement = element('class_pupil', HTMLElement);
  /** Where the box is until the pupil has joined: whoever opens the class's address sees nothing before it. */
  #entryElement = element('class_entry', HTMLElement);
  #codeInput = makeElement('input');
  #nameInput = makeElement('input');
  #joinForm = makeElement('form', '', makeLabel('class_code', this.#codeInput), makeLabel('class_name', this.#nameInput), makeElement('button', 'class_join'));
  #statusElement = makeElement('p');
  /** What it says, in any language. @type {{key: import('../page/texts.js').Key, values: Record<string, string | number>}} */
  #status = { key: 'class_welcome', values: {} };
  #askButton = makeButton('class_ask', () => this.#wantRobot(true));
  #quitButton = makeButton('class_quit', () => this.#wantRobot(false));
  /** In the own turn, where the page has not come to its robot by itself. */
  #connectButton = makeButton('link_connect', () => this.#panel.connectByHost());
  /** There is no first screen in a class. */
  #ownRobotButton = makeButton('own_robot', () => element('start_own', HTMLButtonElement).click());
  #handButton = makeButton('', () => {
    this.#stayState.isHandWanted = !this.#isHandUp;
    this.#poll();
  }, makeIcon('hand', 26));
  #isHandUp = false;
  /** It waits for a press, as nothing may come between a pupil and what is being written, dragged, run or edited together. */
  #handoutButton = makeButton('class_handout_open', () => this.#openHandout());
  #handoutSentence = makeElement('span');
  #handoutBox = makeElement('p', '', this.#handoutSentence, this.#handoutButton);
  #openedHandoutKey = loadText(OPENED_HANDOUT_KEY, 'sessionStorage');
  #group;
  #isJoining = false;
  #stayState = makeStayState(); // in one class: an answer of the one before is none of the next one
  #pollTimer = 0;

  /** @param {import('./classroom.js').Page} page */
  constructor(page) {
    this.#page = page;
    this.#panel = page.panel;
    this.#work = page.work;
    this.#handButton.id = 'class_hand';
    this.#handButton.hidden = true;
    element('stop', HTMLButtonElement).before(this.#handButton);
    this.#handoutBox.id = 'class_handout';
    this.#handoutSentence.setAttribute('role', 'status');
    this.#entryElement.before(this.#handoutBox);
    this.#showHandout();
    this.#showHand(false);
    for (const field of [this.#codeInput, this.#nameInput]) {
      field.autocomplete = 'off';
      field.required = true;
      field.spellcheck = false;
    }
    this.#codeInput.maxLength = 12;
    this.#codeInput.size = 8;
    this.#codeInput.autocapitalize = 'characters';
    this.#nameInput.maxLength = 24;
    this.#statusElement.setAttribute('role', 'status');
    this.#joinForm.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#joinClass();
    });
    this.#boxElement.append(this.#joinForm, this.#statusElement, makeElement('p', '', this.#askButton, this.#quitButton, this.#connectButton, this.#ownRobotButton));
    this.#boxElement.hidden = false;
    pageState.language.subscribe(() => this.#updateStatusText());
    this.#group = new Group(page);
    const token = loadText(TOKEN_KEY, 'sessionStorage');
    if (token) this.#onJoined(token);
    else {
      this.#leaveClass('class_welcome');
      this.#codeInput.focus();
    }
  }

  async #joinClass() {
    if (this.#isJoining) return; // who presses twice is one pupil
    this.#isJoining = true;
    try {
      const answer = await post({ do: 'join', code: this.#codeInput.value, name: this.#nameInput.value, before: loadText(LAST_TOKEN_KEY) });
      if (answer.failure) this.#showStatus(answer.failure);
      else this.#onJoined(answer.token);
    } catch {
      this.#showStatus('class_silent');
    }
    this.#isJoining = false;
  }

  /** @param {string} token */
  #onJoined(token) {
    setToken(token);
    storeText(TOKEN_KEY, token, 'sessionStorage'); // without a storage, a reload joins anew
    storeText(LAST_TOKEN_KEY, token);
    this.#joinForm.hidden = this.#entryElement.hidden = true;
    element('class_place', HTMLElement).append(this.#boxElement);
    this.#handButton.hidden = false;
    this.#group.enter();
    this.#poll();
  }

  /** @param {import('../page/texts.js').Key} key */
  #leaveClass(key) {
    clearTimeout(this.#pollTimer);
    this.#stayState = makeStayState();
    this.#showHandout();
    this.#showHand(false);
    this.#group.exit();
    setToken('');
    storeText(TOKEN_KEY, '', 'sessionStorage');
    this.#setOpenedHandout('');
    this.#joinForm.hidden = this.#entryElement.hidden = element('class_entry_title', HTMLElement).hidden = false;
    this.#entryElement.append(this.#boxElement);
    this.#askButton.hidden = this.#quitButton.hidden = this.#connectButton.hidden = this.#handButton.hidden = true;
    this.#showStatus(key);
  }

  /** @param {boolean} wantsRobot */
  #wantRobot(wantsRobot) {
    this.#stayState.wantsRobot = wantsRobot;
    this.#poll();
  }

  /** One request at a time, for none is to overtake another; what is pressed meanwhile follows at once. */
  async #poll() {
    clearTimeout(this.#pollTimer);
    const stay = this.#stayState;
    if (stay.isPolling) return;
    stay.isPolling = true;
    const { wantsRobot, isHandWanted } = stay, takenWork = stay.isTakenUnconfirmed ? stay.takenWork : null;
    const fields = takenWork ? stay.sentFields : this.#currentFields(); // two programs may be too large
    /** @type {Record<string, unknown>} */
    const request = { do: 'here', opened: this.#openedHandoutKey };
    if (takenWork) request['took'] = { key: takenWork.key, text: takenWork.text };
    if (wantsRobot !== null) request['wants'] = wantsRobot;
    if (isHandWanted !== null) request['hand'] = isHandWanted;
    for (const [name, value] of Object.entries(fields)) {
      if (stay.sentFields[name] === value) continue;
      request[name] = JSON.parse(value);
      delete stay.sentFields[name]; // where the answer is lost, nobody knows what the teacher sees
    }
    let wait_ms = POLL_MS;
    try {
      const answer = /** @type {PupilState} */ (await post(request));
      if (stay !== this.#stayState) return;
      if (stay.wantsRobot === wantsRobot) stay.wantsRobot = null;
      if (stay.isHandWanted === isHandWanted) stay.isHandWanted = null;
      stay.sentFields = takenWork ? {} : fields; // the class has the taken work now, whatever was sent before
      if (answer.over) {
        this.#endClass(answer.over === 'erased');
        return;
      }
      this.#showState(answer);
      if (takenWork) stay.isTakenUnconfirmed = false;
      this.#takeGivenWork(answer.given);
      const { handout = null } = answer;
      stay.handout = handout?.key === this.#openedHandoutKey ? null : handout; // the class has yet to hear that it was opened
      this.#showHandout();
      if (answer.run && answer.run !== stay.runNumber) {
        stay.runNumber = answer.run;
        giveRun(answer.run, this.#page.fetchNewestRunFile).catch(() => {}); // the teacher asks again
      }
      if (answer.place > 0 && answer.place <= answer.robots) wait_ms = QUICK_POLL_MS;
      if (stay.wantsRobot !== null || stay.isHandWanted !== null) wait_ms = 0;
    } catch (error) {
      if (stay !== this.#stayState) return;
      if (error instanceof ConnectionFailure && error.reason === 'host_other') {
        this.#leaveClass('class_gone');
        return;
      }
      this.#showStatus('class_silent');
    }
    stay.isPolling = false;
    this.#pollTimer = window.setTimeout(() => this.#poll(), wait_ms);
  }

  /** What the teacher sees of this page, each as JSON. @returns {Record<string, string>} */
  #currentFields() {
    const { state, image } = document.documentElement.dataset;
    return {
      text: JSON.stringify(this.#work.text.slice(0, CLASS.text_characters)),
      robot: JSON.stringify(this.#work.robot),
      lessons: JSON.stringify([...loadDoneLessons()].slice(0, CLASS.most_lessons)),
      own_robot: JSON.stringify(pageState.ownRobot.value),
      ...(state === 'checked' && { is_right: JSON.stringify(Boolean(image) || !this.#work.text.trim()) }),
    };
  }

  /**
   * Takes work that the teacher gives back, once: it is given until the class has heard of that. It is in My programs before
   * the class hears it, for a group may keep its own program, and anybody in it may replace the one on the screen.
   * @param {GivenWork | undefined} work
   */
  #takeGivenWork(work) {
    if (!work || this.#group.isJoining) return; // the group's program is about to replace what is on the screen
    const stay = this.#stayState;
    const program = { text: work.text, robot: isRobot(work.robot) ? work.robot : this.#work.robot, name: '' };
    const isNew = stay.takenWork?.key !== work.key;
    const isShown = isNew && this.#page.putProgram(program);
    const isKept = stay.isTakenUnconfirmed = storeVersion(program);
    if (!isNew) return;
    stay.takenWork = work;
    for (const name of work.lessons) storeDoneLesson(name);
    if (isShown || isKept) element('note', HTMLElement).textContent = text(isShown ? 'class_given' : 'class_given_kept');
  }

  #showHandout() {
    const { handout } = this.#stayState;
    setHidden(this.#handoutBox, !handout);
    setText(this.#handoutSentence, handout ? text(handout.lesson ? 'class_handout_lesson' : 'class_handout_program', { number: handout.lesson }) : '');
  }

  /** Opens what the teacher gives to all, once. What is on the page is kept before; where it cannot be, it stays. */
  #openHandout() {
    const { handout } = this.#stayState;
    if (!handout || this.#group.isJoining || !this.#page.keepProgram()) return;
    if (handout.lesson) this.#page.openLesson(handout.lesson);
    else {
      const wasShipped = isShippedProgram(this.#work.text); // such a one is not kept
      const program = { text: handout.text, robot: isRobot(handout.robot) ? handout.robot : this.#work.robot, name: '' };
      const isShown = this.#page.putProgram(program);
      if (!isShown && !storeVersion(program)) return;
      pageState.note.set(text(!isShown ? 'class_handout_kept' : wasShipped ? 'class_handout_program' : 'class_handout_opened'));
    }
    this.#setOpenedHandout(handout.key);
    this.#stayState.handout = null;
    this.#showHandout();
    this.#poll(); // the teacher sees it
  }

  /** @param {string} key of what the teacher gave to all; nothing for the next pupil at this page */
  #setOpenedHandout(key) {
    this.#openedHandoutKey = key;
    storeText(OPENED_HANDOUT_KEY, key, 'sessionStorage');
  }

  /** @param {boolean} isHandUp */
  #showHand(isHandUp) {
    this.#isHandUp = isHandUp;
    this.#handButton.setAttribute('aria-pressed', String(isHandUp));
    const key = isHandUp ? 'class_hand_down' : 'class_hand';
    this.#handButton.dataset['label'] = key;
    this.#handButton.title = text(key);
    this.#handButton.setAttribute('aria-label', this.#handButton.title);
  }

  /** @param {PupilState} here */
  #showState({ place: queuePlace, waiting: waitingCount, robots: robotCount, robot: robotName, left_s, name, hand: isHandUp, groups = [], driver: driverName = '', stops: stopCount = 0 }) {
    noteStopCount(stopCount);
    this.#showHand(isHandUp);
    this.#group.showGroups(groups, driverName);
    const isTurnNew = queuePlace === 0 && this.#stayState.queuePlace !== 0 && !driverName;
    this.#stayState.queuePlace = queuePlace;
    this.#askButton.hidden = queuePlace >= 0;
    this.#quitButton.hidden = queuePlace <= 0;
    const timeLeftText = clockText(left_s);
    const key = queuePlace > 0 ? 'class_place' : queuePlace < 0 ? 'class_in' : driverName ? 'group_drives' : waitingCount ? 'class_turn' : 'class_turn_alone';
    this.#showStatus(key, { place: queuePlace, waiting: waitingCount, robots: robotCount, time: timeLeftText, name: asPlainText(driverName || name), robot: asPlainText(robotName) });
    if (isTurnNew && this.#panel.isFree) {
      element('side_real', HTMLButtonElement).click();
      this.#panel.connectByHost();
    }
    this.#connectButton.hidden = queuePlace !== 0 || !this.#panel.isFree;
  }

  /** The class is over. @param {boolean} isErased */
  #endClass(isErased) {
    this.#leaveClass(isErased ? 'class_erased' : 'class_kept');
    this.#joinForm.hidden = element('class_entry_title', HTMLElement).hidden = true;
    if (!isErased) return;
    forgetAll();
    this.#page.clearProgram();
  }

  /** @param {import('../page/texts.js').Key} key @param {Record<string, string | number>} values */
  #showStatus(key, values = {}) {
    this.#status = { key, values };
    this.#updateStatusText();
    document.documentElement.dataset['pupil'] = key;
  }

  #updateStatusText() {
    setText(this.#statusElement, text(this.#status.key, this.#status.values));
  }
}
