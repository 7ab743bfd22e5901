// The keys of a piano, one octave of them: a tone by its name. Knows no blocks.

import { makeButton, makeElement } from '../page/made.js';
import { text } from '../page/texts.js';
import { HIGHEST_KEY, keyOfHertz, LOWEST_KEY, keyName, hertzOfKey, OCTAVE, WHITE_KEYS } from './tones.js';

export class Piano {
  element = makeElement('div');
  #keysElement = makeElement('div');
  #onChoose;
  #firstKey = LOWEST_KEY; // of the octave that is seen

  /** @param {(hertz: number) => void} onChoose */
  constructor(onChoose) {
    this.#onChoose = onChoose;
    this.element.className = 'piano';
    this.element.setAttribute('role', 'group');
    this.element.ariaLabel = text('piano');
    this.element.addEventListener('mousedown', (event) => event.preventDefault()); // what is typed into stays so
    const octaveButtons = [['lower', '◀', -OCTAVE], ['higher', '▶', OCTAVE]].map(([name, sign, offset]) => {
      const octaveButton = makeButton('', () => this.#shiftKeys(Number(offset)), String(sign));
      octaveButton.ariaLabel = text(name === 'lower' ? 'piano_lower' : 'piano_higher');
      return octaveButton;
    });
    this.#keysElement.className = 'keys';
    this.element.append(.../** @type {Node[]} */ ([octaveButtons[0], this.#keysElement, octaveButtons[1]]));
    for (const octaveButton of octaveButtons) octaveButton.tabIndex = -1; // by keyboard, the arrow keys go from tone to tone
  }

  /** @param {number} hertz */
  show(hertz) {
    const key = keyOfHertz(hertz);
    this.#firstKey = Math.min(HIGHEST_KEY - OCTAVE, key - (key % OCTAVE));
    this.#drawKeys(hertzOfKey(key) === hertz ? key : -1);
  }

  /** @param {number} offset keys */
  #shiftKeys(offset) {
    this.#firstKey = Math.min(HIGHEST_KEY - OCTAVE, Math.max(LOWEST_KEY, this.#firstKey + offset));
    this.#drawKeys(-1);
  }

  /** @param {number} chosenKey */
  #drawKeys(chosenKey) {
    const names = text('notes').split(' ');
    const keys = Array.from({ length: OCTAVE + 1 }, (_, offset) => this.#firstKey + offset);
    this.#keysElement.replaceChildren(...keys.map((key) => {
      const isWhite = WHITE_KEYS.includes(key % OCTAVE);
      const keyButton = makeButton('', () => this.#onChoose(hertzOfKey(key)), isWhite ? keyName(key, names) : '');
      keyButton.className = isWhite ? 'white' : 'black';
      keyButton.tabIndex = -1;
      keyButton.title = keyButton.ariaLabel = `${keyName(key, names)}, ${hertzOfKey(key)} Hz`;
      keyButton.setAttribute('aria-pressed', String(key === chosenKey));
      return keyButton;
    }));
  }
}
