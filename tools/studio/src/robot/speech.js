// What the panel of a real robot says, and what the robot shows: as text, never as markup.

import { element } from '../page/elements.js';
import { shown } from './plain_text.js';
import { pageState } from '../page/page_state.js';
import { hasText, known, text } from '../page/texts.js';

/** @typedef {import('./transport.js').Failed} Failed */

const SHOWN = 200; // lines of what the robot shows
const SAID_CHARACTERS = 1000;

export class Speech {
  /** What is said, so that it can be said in another language. @type {() => string} */
  #said = () => '';
  #name = ''; // of it
  isHeld = false; // by a stop, which alone says what becomes of it
  /** @type {string[]} */
  #shown = [];
  #line = element('link_said', HTMLElement);
  #list = element('link_shown', HTMLElement);

  constructor() {
    pageState.language.subscribe(() => this.#say());
  }

  #say() {
    this.#line.textContent = this.#said();
  }

  /** @param {Failed} why @param {() => string} [more] that is said with it */
  fail(why, more = () => '') {
    const key = `why_${why.reason}`;
    const sentence = shown(why.said, SAID_CHARACTERS);
    const isOurs = hasText(key) && (!sentence || why.reason.startsWith('link_'));
    this.#put(() => `${isOurs ? text(key) : sentence || text('why_bug')} ${more()}`.trim(), why.reason);
  }

  /**
   * @param {import('../page/texts.js').Key} key
   * @param {Record<string, string | number>} values
   * @param {string} [saved]
   */
  say(key, values = {}, saved = '') {
    this.#put(() => text(key, saved ? { ...values, saved: text(known(saved)) } : values), key);
  }

  /** @param {string} said */
  tell(said) {
    if (this.isHeld) return;
    this.#name = '';
    this.#said = () => said;
    this.#say();
  }

  /** @param {() => string} said @param {string} name for tests */
  #put(said, name) {
    if (this.isHeld) return;
    // A robot is lost once, whether a request says so or an event.
    if (name.endsWith('link_lost') && this.#name.endsWith('link_lost') && said() === this.#said()) return;
    this.#name = name;
    this.#said = said;
    this.#say();
    document.documentElement.dataset['link'] = name;
  }

  /** @param {string} line */
  add(line) {
    this.#shown.push(line);
    if (this.#shown.length > SHOWN) this.#shown.splice(0, this.#shown.length - SHOWN);
    this.#list.textContent = this.#shown.join('\n');
    this.#list.scrollTop = this.#list.scrollHeight;
  }

  clear() {
    this.#shown = [];
    this.#list.textContent = '';
  }

  /** Something new begins: what was shown before is gone. @param {import('../page/texts.js').Key} key */
  begin(key) {
    this.clear();
    this.say(key);
  }
}
