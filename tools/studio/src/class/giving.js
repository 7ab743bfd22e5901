// Work that is kept of who is not here goes to one pupil, whom the teacher chooses: anybody can write a name.

import { makeButton, makeElement } from '../page/made.js';
import { element, say } from '../page/elements.js';
import { plainText } from '../robot/plain_text.js';
import { text } from '../page/texts.js';

/** @typedef {import('./teacher.js').KeptRow} KeptRow */
/** @typedef {import('./teacher.js').PupilRow} PupilRow */
/** @typedef {{item: HTMLElement, name: HTMLElement, pupils: HTMLSelectElement, give: HTMLButtonElement, said: HTMLElement}} Row */

export class Giving {
  window = makeElement('dialog');
  #list = makeElement('ul');
  #give;
  /** @type {Map<string, Row>} */
  #rows = new Map();

  /** @param {(key: string, pupil: number) => void} give */
  constructor(give) {
    this.#give = give;
    this.window.id = 'class_giving';
    this.window.className = 'class_window';
    this.window.setAttribute('aria-labelledby', 'class_giving_title');
    const title = makeElement('h2', 'class_give_back');
    title.id = 'class_giving_title';
    const stop = makeButton('class_stop_all', () => element('stop', HTMLButtonElement).click());
    stop.className = 'stop'; // the page's own is behind this window
    this.window.append(makeElement('header', '', title, makeButton('close', () => this.window.close()), stop), makeElement('section', '', makeElement('p', 'class_give_told'), this.#list));
    document.body.append(this.window);
  }

  /** @param {KeptRow[]} kept @param {PupilRow[]} pupils */
  show(kept, pupils) {
    const old = this.#rows;
    this.#rows = new Map();
    for (const each of kept) {
      const row = old.get(each.key) ?? this.#made(each.key);
      this.#rows.set(each.key, row);
      this.#fill(row, each, pupils);
    }
    for (const [key, { item }] of old) if (!this.#rows.has(key)) item.remove();
    if (!kept.length) this.window.close();
  }

  /** @param {string} key @returns {Row} */
  #made(key) {
    const name = makeElement('strong'), pupils = makeElement('select'), said = makeElement('span');
    const give = makeButton('class_give_one', () => this.#give(key, Number(pupils.value)));
    pupils.addEventListener('change', () => {
      pupils.dataset['chosen'] = pupils.value; // by the teacher
      give.disabled = !pupils.value;
    });
    const item = makeElement('li', '', name, said, pupils, give);
    this.#list.append(item);
    return { item, name, pupils, give, said };
  }

  /** @param {Row} row @param {KeptRow} kept @param {PupilRow[]} pupils */
  #fill({ name, pupils: choice, give, said }, { name: whose, given, alike }, pupils) {
    say(name, plainText(whose));
    const getting = pupils.find(({ number }) => number === given);
    say(said, getting ? text('class_giving', { name: plainText(getting.name) }) : '');
    choice.setAttribute('aria-label', text('class_give_to', { name: plainText(whose) }));
    const seen = JSON.stringify([alike, pupils.map(({ number, name: own }) => [number, own])]);
    if (choice.dataset['seen'] === seen) return;
    choice.dataset['seen'] = seen;
    const chosen = choice.dataset['chosen'] || (alike.length === 1 ? String(alike[0]) : ''); // of two, nobody
    choice.replaceChildren(new Option('—', ''), ...pupils.map(({ number, name: own }) => new Option(plainText(own), String(number))));
    choice.value = pupils.some(({ number }) => String(number) === chosen) ? chosen : '';
    give.disabled = !choice.value;
  }
}
