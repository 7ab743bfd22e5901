// A pupil's part in a class: joins with the code, asks for a robot, waits, and drives the robot of
// the own turn as any robot of `tsc studio`.
//
// Pupils of a group (`group.js`) have one turn: who drives is in the answer, and each may take the robot over.
//
// The page asks once a second for its place. That keeps no robot going: only a page that drives does.

import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { element, say } from '../page/elements.js';
import { askAs, hearStops, post } from '../robot/host.js';
import { keepDone, lessonsDone } from '../lesson/progress.js';
import { plainText } from '../robot/plain_text.js';
import { ConnectionFailure } from '../robot/transport.js';
import { Group } from './group.js';
import { giveRun } from './run.js';
import { sign } from './signs.js';
import { clock } from './wall.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';
import { CLASS, isRobot } from '../page/words.js';
import { forgetAll, storeText, storedText } from '../page/kept.js';

const PLACE = 'tiniscript.pupil';
const BEFORE = 'tiniscript.pupil_before'; // the token of the last page here: work belongs to it
const LOOK_MS = 1000;
const SOON_MS = 300; // while the next turn may be one's own

/** @typedef {{key: string, text: string, robot: string, lessons: string[]}} Given */
/** @typedef {{place: number, waiting: number, robots: number, robot: string, left_s: number, name: string, hand: boolean, given?: Given, over?: string, groups?: import('./group.js').Seen[], driver?: string, run?: number, stops?: number}} Here */

function newStay() {
  return {
    wants: /** @type {boolean | null} */ (null), // a robot, told at the next look
    hand: /** @type {boolean | null} */ (null), // help, told at the next look
    told: /** @type {Record<string, string>} */ ({}), // what the teacher's page knows
    taken: /** @type {Given | null} */ (null), // the work that was given last
    refused: '', // the key of work that is not to replace the program of the group
    run: 0, // the newest question for a run
    isNews: false, // the class has yet to hear that this is here
    place: -1,
  };
}

export class Pupil {
  #panel;
  #work;
  #page;
  #box = element('class_pupil', HTMLElement);
  /** Where the box is until the pupil has joined: whoever opens the class's address sees nothing before it. */
  #entry = element('class_entry', HTMLElement);
  #code = makeElement('input');
  #name = makeElement('input');
  #join = makeElement('form', '', makeLabel('class_code', this.#code), makeLabel('class_name', this.#name), makeElement('button', 'class_join'));
  #said = makeElement('p');
  #ask = makeButton('class_ask', () => this.#want(true));
  #quit = makeButton('class_quit', () => this.#want(false));
  /** In the own turn, where the page has not come to its robot by itself. */
  #connect = makeButton('link_connect', () => this.#panel.connectByHost());
  /** There is no first screen in a class. */
  #own = makeButton('own_robot', () => element('start_own', HTMLButtonElement).click());
  #hands = makeButton('', () => {
    this.#stay.hand = !this.#isUp;
    this.#look();
  }, sign('hand', 26));
  #isUp = false;
  #group;
  #isEntering = false;
  #stay = newStay(); // in one class: an answer of the one before is none of the next one
  #timer = 0;

  /** @param {import('./classroom.js').Page} page */
  constructor(page) {
    this.#page = page;
    this.#panel = page.panel;
    this.#work = page.work;
    this.#hands.id = 'class_hand';
    this.#hands.hidden = true;
    element('stop', HTMLButtonElement).before(this.#hands);
    this.#showHand(false);
    for (const field of [this.#code, this.#name]) {
      field.autocomplete = 'off';
      field.required = true;
      field.spellcheck = false;
    }
    this.#code.maxLength = 12;
    this.#code.size = 8;
    this.#code.autocapitalize = 'characters';
    this.#name.maxLength = 24;
    this.#said.setAttribute('role', 'status');
    this.#join.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#enter();
    });
    this.#box.append(this.#join, this.#said, makeElement('p', '', this.#ask, this.#quit, this.#connect, this.#own));
    this.#box.hidden = false;
    this.#group = new Group(page, this.#box);
    const token = storedText(PLACE, 'sessionStorage');
    if (token) this.#begin(token);
    else {
      this.#leave('class_welcome');
      this.#code.focus();
    }
  }

  async #enter() {
    if (this.#isEntering) return; // who presses twice is one pupil
    this.#isEntering = true;
    try {
      const answer = await post({ do: 'join', code: this.#code.value, name: this.#name.value, before: storedText(BEFORE) });
      if (answer.failure) this.#say(answer.failure);
      else this.#begin(answer.token);
    } catch {
      this.#say('class_silent');
    }
    this.#isEntering = false;
  }

  /** @param {string} token */
  #begin(token) {
    askAs(token);
    storeText(PLACE, token, 'sessionStorage'); // without a storage, a reload joins anew
    storeText(BEFORE, token);
    this.#join.hidden = this.#entry.hidden = true;
    element('class_place', HTMLElement).append(this.#box);
    this.#hands.hidden = false;
    this.#group.enter();
    this.#look();
  }

  /** @param {import('../page/texts.js').Key} why */
  #leave(why) {
    clearTimeout(this.#timer);
    this.#stay = newStay();
    this.#showHand(false);
    this.#group.exit();
    askAs('');
    storeText(PLACE, '', 'sessionStorage');
    this.#join.hidden = this.#entry.hidden = element('class_entry_title', HTMLElement).hidden = false;
    this.#entry.append(this.#box);
    this.#ask.hidden = this.#quit.hidden = this.#connect.hidden = this.#hands.hidden = true;
    this.#say(why);
  }

  /** @param {boolean} wants */
  #want(wants) {
    this.#stay.wants = wants;
    this.#look();
  }

  async #look() {
    clearTimeout(this.#timer);
    const stay = this.#stay;
    const { wants, hand } = stay, taken = stay.isNews ? stay.taken : null;
    const now = taken ? stay.told : this.#now(); // two programs may be too large
    /** @type {Record<string, unknown>} */
    const request = { do: 'here' };
    if (taken) request['took'] = { key: taken.key, text: taken.text };
    if (wants !== null) request['wants'] = wants;
    if (hand !== null) request['hand'] = hand;
    for (const [name, value] of Object.entries(now)) if (stay.told[name] !== value) request[name] = JSON.parse(value);
    let wait_ms = LOOK_MS;
    try {
      const answer = /** @type {Here} */ (await post(request));
      if (stay !== this.#stay) return;
      if (stay.wants === wants) stay.wants = null;
      if (stay.hand === hand) stay.hand = null;
      stay.told = now;
      if (answer.over) {
        this.#end(answer.over === 'erased');
        return;
      }
      this.#show(answer);
      if (taken) stay.isNews = false;
      this.#take(answer.given);
      if (answer.run && answer.run !== stay.run) {
        stay.run = answer.run;
        giveRun(answer.run, this.#page.newestRun).catch(() => {}); // the teacher asks again
      }
      if (answer.place > 0 && answer.place <= answer.robots) wait_ms = SOON_MS;
    } catch (why) {
      if (stay !== this.#stay) return;
      if (why instanceof ConnectionFailure && why.reason === 'host_other') {
        this.#leave('class_gone');
        return;
      }
      this.#say('class_silent');
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#look(), wait_ms);
  }

  /** What the teacher sees of this page, each as JSON. @returns {Record<string, string>} */
  #now() {
    const { state, image } = document.documentElement.dataset;
    return {
      text: JSON.stringify(this.#work.text.slice(0, CLASS.text_characters)),
      robot: JSON.stringify(this.#work.robot),
      lessons: JSON.stringify([...lessonsDone()].slice(0, CLASS.most_lessons)),
      own_robot: JSON.stringify(pageState.ownRobot.value),
      ...(state === 'checked' && { is_right: JSON.stringify(Boolean(image) || !this.#work.text.trim()) }),
    };
  }

  /**
   * Takes work that the teacher gives back, once: it is given until the class has heard of that. A pupil who does not want
   * it in place of the group's program gets it when the page is in no group.
   * @param {Given | undefined} given
   */
  #take(given) {
    if (!given) return;
    const stay = this.#stay;
    if (stay.taken?.key !== given.key) {
      if (stay.refused === given.key && pageState.groupName.value) return;
      if (!this.#page.put({ text: given.text, robot: isRobot(given.robot) ? given.robot : this.#work.robot })) {
        stay.refused = given.key;
        return;
      }
      stay.taken = given;
      for (const name of given.lessons) keepDone(name);
      element('note', HTMLElement).textContent = text('class_given');
    }
    stay.isNews = true;
  }

  /** @param {boolean} isUp */
  #showHand(isUp) {
    this.#isUp = isUp;
    this.#hands.setAttribute('aria-pressed', String(isUp));
    const key = isUp ? 'class_hand_down' : 'class_hand';
    this.#hands.dataset['label'] = key;
    this.#hands.title = text(key);
    this.#hands.setAttribute('aria-label', this.#hands.title);
  }

  /** @param {Here} here */
  #show({ place, waiting, robots, robot, left_s, name, hand, groups = [], driver = '', stops = 0 }) {
    hearStops(stops);
    this.#showHand(hand);
    this.#group.see(groups, driver);
    const isNew = place === 0 && this.#stay.place !== 0 && !driver;
    this.#stay.place = place;
    this.#ask.hidden = place >= 0;
    this.#quit.hidden = place <= 0;
    const time = clock(left_s);
    const key = place > 0 ? 'class_place' : place < 0 ? 'class_in' : driver ? 'group_drives' : waiting ? 'class_turn' : 'class_turn_alone';
    this.#say(key, { place, waiting, robots, time, name: plainText(driver || name), robot: plainText(robot) });
    if (isNew && this.#panel.isFree) {
      element('side_real', HTMLButtonElement).click();
      this.#panel.connectByHost();
    }
    this.#connect.hidden = place !== 0 || !this.#panel.isFree;
  }

  /** The class is over. @param {boolean} isErased */
  #end(isErased) {
    this.#leave(isErased ? 'class_erased' : 'class_kept');
    this.#join.hidden = element('class_entry_title', HTMLElement).hidden = true;
    if (!isErased) return;
    forgetAll();
    this.#page.empty();
  }

  /** @param {import('../page/texts.js').Key} key @param {Record<string, string | number>} values */
  #say(key, values = {}) {
    say(this.#said, text(key, values));
    document.documentElement.dataset['pupil'] = key;
  }
}
