// A pupil's part in a class: joins with the code, asks for a robot, waits, and drives the robot of
// the own turn as any robot of `tsc studio`.
//
// The page asks once a second for its place. That keeps no robot going: only a page that drives does.

import { button, labelled, made } from './made.js';
import { element } from '../elements.js';
import { askAs, post } from '../robot/host.js';
import { shown } from '../robot/said.js';
import { Failed } from '../robot/way.js';
import { text } from '../texts.js';
import { forgetAll } from '../work.js';

const PLACE = 'tiniscript.pupil';
const LOOK_MS = 1000;
const TEXT_CHARACTERS = 20_000; // what the teacher sees of a program

/** @typedef {{place: number, waiting: number, robots: number, robot: string, left_s: number, name: string, over?: string}} Here */

export class Pupil {
  #panel;
  #work;
  #empty;
  #box = element('class_pupil', HTMLElement);
  #code = made('input');
  #name = made('input');
  #join = made('form', '', labelled('class_code', this.#code), labelled('class_name', this.#name), made('button', 'class_join'));
  #said = made('p');
  #ask = button('class_ask', () => this.#want(true));
  #quit = button('class_quit', () => this.#want(false));
  /** What is told at the next look. @type {boolean | null} */
  #wants = null;
  #told = '';
  #place = -1;
  #timer = 0;

  /**
   * @param {import('../robot/panel.js').RobotPanel} panel
   * @param {import('../work.js').Work} work
   * @param {() => void} empty
   */
  constructor(panel, work, empty) {
    this.#panel = panel;
    this.#work = work;
    this.#empty = empty;
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
    this.#box.append(this.#join, this.#said, made('p', '', this.#ask, this.#quit));
    this.#box.hidden = false;
    const kept = keptToken();
    if (kept) this.#begin(kept);
    else this.#leave('class_welcome');
  }

  async #enter() {
    try {
      const answer = await post({ do: 'join', code: this.#code.value, name: this.#name.value });
      if (answer.failure) this.#say(answer.failure);
      else this.#begin(answer.token);
    } catch {
      this.#say('class_silent');
    }
  }

  /** @param {string} token */
  #begin(token) {
    askAs(token);
    keepToken(token);
    this.#told = '';
    this.#join.hidden = true;
    this.#look();
  }

  /** @param {string} why */
  #leave(why) {
    clearTimeout(this.#timer);
    askAs('');
    keepToken('');
    this.#join.hidden = false;
    this.#ask.hidden = this.#quit.hidden = true;
    this.#say(why);
  }

  /** @param {boolean} wants */
  #want(wants) {
    this.#wants = wants;
    this.#look();
  }

  async #look() {
    clearTimeout(this.#timer);
    const wants = this.#wants;
    const program = this.#work.text.slice(0, TEXT_CHARACTERS);
    /** @type {Record<string, unknown>} */
    const request = { do: 'here' };
    if (wants !== null) request['wants'] = wants;
    if (program !== this.#told) request['text'] = program;
    try {
      const answer = /** @type {Here} */ (await post(request));
      if (this.#wants === wants) this.#wants = null;
      this.#told = program;
      if (answer.over) {
        this.#end(answer.over === 'erased');
        return;
      }
      this.#show(answer);
    } catch (why) {
      if (why instanceof Failed && why.reason === 'host_other') {
        this.#leave('class_gone');
        return;
      }
      this.#say('class_silent');
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#look(), LOOK_MS);
  }

  /** @param {Here} here */
  #show({ place, waiting, robots, robot, left_s, name }) {
    const isNew = place === 0 && this.#place !== 0;
    this.#place = place;
    this.#ask.hidden = place >= 0;
    this.#quit.hidden = place <= 0;
    const time = `${Math.floor(left_s / 60)}:${String(left_s % 60).padStart(2, '0')}`;
    const key = place > 0 ? 'class_place' : place < 0 ? 'class_in' : waiting ? 'class_turn' : 'class_turn_alone';
    this.#say(key, { place, waiting, robots, time, name: shown(name), robot: shown(robot) });
    if (isNew && this.#panel.isFree) {
      element('side_real', HTMLButtonElement).click();
      this.#panel.byHost();
    }
  }

  /** The class is over. @param {boolean} isErased */
  #end(isErased) {
    this.#leave(isErased ? 'class_erased' : 'class_kept');
    this.#join.hidden = true;
    if (!isErased) return;
    forgetAll();
    this.#empty();
  }

  /** @param {string} key @param {Record<string, string | number>} values */
  #say(key, values = {}) {
    const said = text(key, values);
    if (this.#said.textContent !== said) this.#said.textContent = said;
    document.documentElement.dataset['pupil'] = key;
  }
}

function keptToken() {
  try {
    return sessionStorage.getItem(PLACE) ?? '';
  } catch {
    return '';
  }
}

/** @param {string} token */
function keepToken(token) {
  try {
    if (token) sessionStorage.setItem(PLACE, token);
    else sessionStorage.removeItem(PLACE);
  } catch {
    // no storage here: a reload joins anew
  }
}
