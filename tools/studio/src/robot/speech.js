// What the panel of a real robot says, and what the robot shows: as text, never as markup.

import { element } from '../page/elements.js';
import { asPlainText } from './plain_text.js';
import { pageState } from '../page/page_state.js';
import { hasText, textKey, text } from '../page/texts.js';

/** @typedef {import('./transport.js').ConnectionFailure} ConnectionFailure */

const MAX_SHOWN_LINES = 200; // lines of what the robot shows
const MAX_SENTENCE_CHARACTERS = 1000;

export class Speech {
  /** What is said, so that it can be said in another language or view. @type {() => string} */
  #makeSentence = () => '';
  #sentenceName = ''; // of it
  isHeldByStop = false; // by a stop, which alone says what becomes of it
  /** @type {string[]} */
  #shownLines = [];
  #sentenceElement = element('link_said', HTMLElement);
  #shownElement = element('link_shown', HTMLElement);

  constructor() {
    for (const observable of [pageState.language, pageState.areBlocksNamed]) observable.subscribe(() => this.#showSentence());
  }

  #showSentence() {
    this.#sentenceElement.textContent = this.#makeSentence();
  }

  /** @param {ConnectionFailure} failure @param {() => string} [makeAddition] that is said with it */
  sayFailure(failure, makeAddition = () => '') {
    const key = `why_${failure.reason}`;
    const sentence = asPlainText(failure.details, MAX_SENTENCE_CHARACTERS);
    const isKnown = hasText(key) && (!sentence || failure.reason.startsWith('link_'));
    this.sayAnew(() => `${isKnown ? text(key) : sentence || text('why_bug')} ${makeAddition()}`.trim(), failure.reason);
  }

  /**
   * @param {import('../page/texts.js').Key} key
   * @param {Record<string, string | number>} values
   * @param {string} [storagePlaceKey]
   */
  say(key, values = {}, storagePlaceKey = '') {
    this.sayAnew(() => text(key, storagePlaceKey ? { ...values, saved: text(textKey(storagePlaceKey)) } : values), key);
  }

  /** @param {string} sentence */
  saySentence(sentence) {
    if (this.isHeldByStop) return;
    this.#sentenceName = '';
    this.#makeSentence = () => sentence;
    this.#showSentence();
  }

  /** Says a sentence that is made anew in another language or view. @param {() => string} makeSentence @param {string} name for tests */
  sayAnew(makeSentence, name) {
    if (this.isHeldByStop) return;
    // A robot is lost once, whether a request says so or an event.
    if (name.endsWith('link_lost') && this.#sentenceName.endsWith('link_lost') && makeSentence() === this.#makeSentence()) return;
    this.#sentenceName = name;
    this.#makeSentence = makeSentence;
    this.#showSentence();
    document.documentElement.dataset['link'] = name;
  }

  /** @param {string} line */
  addLine(line) {
    this.#shownLines.push(line);
    if (this.#shownLines.length > MAX_SHOWN_LINES) this.#shownLines.splice(0, this.#shownLines.length - MAX_SHOWN_LINES);
    this.#shownElement.textContent = this.#shownLines.join('\n');
    this.#shownElement.scrollTop = this.#shownElement.scrollHeight;
  }

  clear() {
    this.#shownLines = [];
    this.#shownElement.textContent = '';
  }

  /** Something new begins: what was shown before is gone. @param {import('../page/texts.js').Key} key */
  begin(key) {
    this.clear();
    this.say(key);
  }
}
