// Work that is kept of who is not here goes to one pupil, whom the teacher chooses: anybody can write a name.

import { makeButton, makeElement } from '../page/made.js';
import { makeWindow } from './windows.js';
import { setText } from '../page/elements.js';
import { asPlainText } from '../robot/plain_text.js';
import { text } from '../page/texts.js';

/** @typedef {import('./teacher.js').KeptRow} KeptRow */
/** @typedef {import('./teacher.js').PupilRow} PupilRow */
/** @typedef {{item: HTMLElement, nameElement: HTMLElement, pupilSelect: HTMLSelectElement, giveButton: HTMLButtonElement, stateElement: HTMLElement}} KeptRowElements */

export class GivingWindow {
  dialog = makeWindow('class_giving', 'class_give_back');
  #listElement = makeElement('ul');
  #giveWork;
  /** @type {Map<string, KeptRowElements>} */
  #rowElements = new Map();

  /** @param {(key: string, pupil: number) => void} giveWork */
  constructor(giveWork) {
    this.#giveWork = giveWork;
    this.dialog.append(makeElement('section', '', makeElement('p', 'class_give_told'), this.#listElement));
  }

  /** @param {KeptRow[]} keptRows @param {PupilRow[]} pupils */
  show(keptRows, pupils) {
    const oldRows = this.#rowElements;
    this.#rowElements = new Map();
    for (const keptRow of keptRows) {
      const elements = oldRows.get(keptRow.key) ?? this.#addRow(keptRow.key);
      this.#rowElements.set(keptRow.key, elements);
      this.#fillRow(elements, keptRow, pupils);
    }
    for (const [key, { item }] of oldRows) if (!this.#rowElements.has(key)) item.remove();
    if (!keptRows.length) this.dialog.close();
  }

  /** @param {string} key @returns {KeptRowElements} */
  #addRow(key) {
    const nameElement = makeElement('strong'), pupilSelect = makeElement('select'), stateElement = makeElement('span');
    const giveButton = makeButton('class_give_one', () => this.#giveWork(key, Number(pupilSelect.value)));
    pupilSelect.addEventListener('change', () => {
      pupilSelect.dataset['chosen'] = pupilSelect.value; // by the teacher
      giveButton.disabled = !pupilSelect.value;
    });
    const item = makeElement('li', '', nameElement, stateElement, pupilSelect, giveButton);
    this.#listElement.append(item);
    return { item, nameElement, pupilSelect, giveButton, stateElement };
  }

  /** @param {KeptRowElements} row @param {KeptRow} kept @param {PupilRow[]} pupils */
  #fillRow({ nameElement, pupilSelect, giveButton, stateElement }, { name: makerName, given: receiverNumber, alike: alikeNumbers }, pupils) {
    setText(nameElement, asPlainText(makerName));
    const receiver = pupils.find(({ number }) => number === receiverNumber);
    setText(stateElement, receiver ? text('class_giving', { name: asPlainText(receiver.name) }) : '');
    pupilSelect.setAttribute('aria-label', text('class_give_to', { name: asPlainText(makerName) }));
    const optionsKey = JSON.stringify([alikeNumbers, pupils.map(({ number, name: pupilName }) => [number, pupilName])]);
    if (pupilSelect.dataset['seen'] === optionsKey) return;
    pupilSelect.dataset['seen'] = optionsKey;
    const chosenNumber = pupilSelect.dataset['chosen'] || (alikeNumbers.length === 1 ? String(alikeNumbers[0]) : ''); // of two, nobody
    pupilSelect.replaceChildren(new Option('—', ''), ...pupils.map(({ number, name: pupilName }) => new Option(asPlainText(pupilName), String(number))));
    pupilSelect.value = pupils.some(({ number }) => String(number) === chosenNumber) ? chosenNumber : '';
    giveButton.disabled = !pupilSelect.value;
  }
}
