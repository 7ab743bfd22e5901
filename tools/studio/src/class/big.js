// What is shown on the big screen: a pupil's program, or how to come into the class.

import { correction, generate } from 'lean-qr';
import { makeButton, makeElement } from '../page/made.js';
import { sign } from './signs.js';
import { element, say } from '../page/elements.js';
import { text } from '../page/texts.js';

const QUIET = 4; // white modules around a QR code

/** A window over the whole page. STOP is in it, too: what is behind cannot be pressed. */
class Big {
  window = makeElement('dialog');
  title = makeElement('h2');
  head = makeElement('header', '', this.title);
  body = makeElement('div');

  /** @param {string} id */
  constructor(id) {
    this.window.id = id;
    this.window.className = 'big';
    this.title.id = `${id}_title`;
    this.window.setAttribute('aria-labelledby', this.title.id);
    this.body.tabIndex = 0; // it may be scrolled
    this.body.setAttribute('role', 'group');
    this.body.setAttribute('aria-labelledby', this.title.id);
    this.window.append(this.head, this.body);
    document.body.append(this.window);
  }

  finish() {
    const stop = makeButton('class_stop_all', () => element('stop', HTMLButtonElement).click());
    stop.className = 'stop';
    this.head.append(makeButton('close', () => this.window.close()), stop);
  }
}

/** @typedef {{key: string, title: string, said: string, picture: string, text: string, history: string[], drives: boolean, hand: boolean}} Shown */
/** @typedef {{step: (by: number) => void, stop: (key: string) => void, next: (key: string) => void, remove: (key: string) => void, lower: (key: string) => void}} Told */

export class BigPupil extends Big {
  key = '';
  #said = makeElement('p');
  #picture = makeElement('img');
  #text = makeElement('pre');
  #history = makeElement('pre');
  #stop; #next; #lower; #remove;

  /** @param {Told} told */
  constructor(told) {
    super('big_pupil');
    const act = (/** @type {import('../page/texts.js').Key} */ key, /** @type {(key: string) => void} */ what) => makeButton(key, () => what(this.key));
    this.#lower = act('class_lower_hand', told.lower);
    this.#stop = act('stop', told.stop);
    this.#next = act('class_next', told.next);
    this.#remove = act('class_remove', told.remove);
    const step = (/** @type {'left' | 'right'} */ name, /** @type {number} */ by) => {
      const found = makeButton('', () => told.step(by), sign(name));
      found.dataset['label'] = `class_${name}`;
      found.setAttribute('aria-label', text(`class_${name}`));
      return found;
    };
    this.#said.setAttribute('role', 'status');
    this.#text.tabIndex = 0;
    this.#text.setAttribute('translate', 'no');
    this.title.before(step('left', -1));
    this.head.append(step('right', 1), this.#said, this.#lower, this.#stop, this.#next, this.#remove);
    this.finish();
    this.#picture.alt = '';
    const paper = makeElement('div', '', this.#picture);
    paper.className = 'paper';
    this.#history.tabIndex = 0;
    this.#history.setAttribute('translate', 'no');
    this.body.append(paper, this.#text, this.#history);
    this.window.addEventListener('keydown', ({ key, target }) => {
      if (target === this.#text) return;
      if (key === 'ArrowLeft') told.step(-1);
      if (key === 'ArrowRight') told.step(1);
    });
    this.window.addEventListener('close', () => {
      this.key = '';
    });
  }

  /** @param {Shown} shown */
  show({ key, title, said, picture, text: program, history, drives, hand }) {
    this.key = key;
    say(this.title, title);
    say(this.#said, said);
    say(this.#text, program);
    this.#text.setAttribute('aria-label', text('class_program_of', { name: title }));
    this.#history.hidden = !history.length;
    say(this.#history, [text('class_history'), '', ...history].join('\n'));
    this.#history.setAttribute('aria-label', text('class_history'));
    const paper = /** @type {HTMLElement} */ (this.#picture.parentElement);
    paper.hidden = !picture;
    if (picture && this.#picture.src !== picture) this.#picture.src = picture;
    this.#lower.hidden = !hand;
    this.#remove.hidden = key.startsWith('group '); // a group is left by its pupils
    this.#stop.hidden = this.#next.hidden = !drives;
    if (!this.window.open) this.window.showModal();
  }
}

export class BigCode extends Big {
  #code = makeElement('strong');
  #address = makeElement('strong', '', location.origin);
  #picture = makeElement('canvas');

  constructor() {
    super('big_code');
    this.head.append(makeElement('span'));
    this.finish();
    this.title.dataset['text'] = 'class_come';
    say(this.title, text('class_come'));
    this.#picture.setAttribute('role', 'img');
    this.#picture.dataset['label'] = 'class_picture';
    this.#picture.setAttribute('aria-label', text('class_picture'));
    generate(location.origin, { minCorrectionLevel: correction.M })
      .toCanvas(this.#picture, { padX: QUIET, padY: QUIET, on: [0, 0, 0, 255], off: [255, 255, 255, 255] });
    this.body.append(this.#picture, makeElement('ol', '',
      makeElement('li', '', makeElement('span', 'class_step_wifi')),
      makeElement('li', '', makeElement('span', 'class_step_open'), this.#address),
      makeElement('li', '', makeElement('span', 'class_step_code'), this.#code)));
  }

  /** @param {string} code */
  show(code) {
    this.change(code);
    this.window.showModal();
  }

  /** @param {string} code */
  change(code) {
    say(this.#code, code);
  }
}
