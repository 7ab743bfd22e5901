// The keys of a piano, one octave of them: a tone by its name. Knows no blocks.

import { makeButton, makeElement } from '../page/made.js';
import { text } from '../page/texts.js';
import { HIGHEST, keyAt, LOWEST, nameOf, noteAt, OCTAVE, WHITE } from './tones.js';

export class Piano {
  place = makeElement('div');
  #keys = makeElement('div');
  #chosen;
  #first = LOWEST; // of the octave that is seen

  /** @param {(hertz: number) => void} chosen */
  constructor(chosen) {
    this.#chosen = chosen;
    this.place.className = 'piano';
    this.place.setAttribute('role', 'group');
    this.place.ariaLabel = text('piano');
    this.place.addEventListener('mousedown', (event) => event.preventDefault()); // what is typed into stays so
    const turns = [['lower', '◀', -OCTAVE], ['higher', '▶', OCTAVE]].map(([name, sign, by]) => {
      const turn = makeButton('', () => this.#turn(Number(by)), String(sign));
      turn.ariaLabel = text(name === 'lower' ? 'piano_lower' : 'piano_higher');
      return turn;
    });
    this.#keys.className = 'keys';
    this.place.append(.../** @type {Node[]} */ ([turns[0], this.#keys, turns[1]]));
    for (const each of turns) each.tabIndex = -1; // by keyboard, the arrow keys go from tone to tone
  }

  /** @param {number} hertz */
  show(hertz) {
    const key = keyAt(hertz);
    this.#first = Math.min(HIGHEST - OCTAVE, key - (key % OCTAVE));
    this.#draw(noteAt(key) === hertz ? key : -1);
  }

  /** @param {number} by keys */
  #turn(by) {
    this.#first = Math.min(HIGHEST - OCTAVE, Math.max(LOWEST, this.#first + by));
    this.#draw(-1);
  }

  /** @param {number} chosen */
  #draw(chosen) {
    const names = text('notes').split(' ');
    const all = Array.from({ length: OCTAVE + 1 }, (_, k) => this.#first + k);
    this.#keys.replaceChildren(...all.map((key) => {
      const isWhite = WHITE.includes(key % OCTAVE);
      const tone = makeButton('', () => this.#chosen(noteAt(key)), isWhite ? nameOf(key, names) : '');
      tone.className = isWhite ? 'white' : 'black';
      tone.tabIndex = -1;
      tone.title = tone.ariaLabel = `${nameOf(key, names)}, ${noteAt(key)} Hz`;
      tone.setAttribute('aria-pressed', String(key === chosen));
      return tone;
    }));
  }
}
