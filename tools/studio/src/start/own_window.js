// The window where somebody gives the virtual robot a colour and a name.

import { element } from '../page/elements.js';
import { makeButton, makeSvg, makeLabel, makeElement } from '../page/made.js';
import { chooseOwnRobot, COLOURS, MOST_NAME_CHARACTERS } from '../page/own_robot.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';

export class OwnWindow {
  #name = makeElement('input');
  #colours = makeElement('div');
  #dialog = makeElement('dialog');
  #shown = makeElement('span');

  constructor() {
    const heading = makeElement('h2', 'own_robot');
    heading.id = 'own_title';
    this.#dialog.id = 'own';
    this.#dialog.setAttribute('aria-labelledby', heading.id);
    this.#name.id = 'own_name';
    this.#name.maxLength = MOST_NAME_CHARACTERS;
    this.#name.autocomplete = 'off';
    this.#name.addEventListener('input', () => this.#choose({ name: this.#name.value }));
    this.#colours.setAttribute('role', 'radiogroup');
    this.#colours.append(...COLOURS.map(([body, edge, key], colour) => {
      const choice = makeElement('input');
      Object.assign(choice, { type: 'radio', name: 'own_colour', value: String(colour) });
      choice.dataset['label'] = key;
      choice.addEventListener('change', () => this.#choose({ colour }));
      const picture = makeSvg('svg', { viewBox: '-26 -22 54 44', 'aria-hidden': 'true' }, makeSvg('use', { href: '#drawn_robot' }));
      picture.style.setProperty('--robot', body);
      picture.style.setProperty('--robot-edge', edge);
      return makeElement('label', '', choice, picture);
    }));
    this.#dialog.append(
      makeElement('header', '', heading, makeButton('close', () => this.#dialog.close())),
      makeElement('section', '', makeLabel('own_name', this.#name), this.#colours),
    );
    document.body.append(this.#dialog);
    this.#shown.className = 'own_name';
    const open = element('start_own', HTMLButtonElement);
    open.append(this.#shown);
    open.addEventListener('click', () => this.#open());
    pageState.ownRobot.subscribe(() => this.#show());
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  #open() {
    const { name, colour } = pageState.ownRobot.value;
    this.#name.value = name;
    const choice = this.#colours.querySelectorAll('input')[colour];
    if (choice) choice.checked = true;
    this.#dialog.showModal();
  }

  /** @param {Partial<import('../page/own_robot.js').OwnRobot>} part of it that is new */
  #choose(part) {
    if (!chooseOwnRobot({ ...pageState.ownRobot.value, ...part })) pageState.note.set(text('not_kept'));
  }

  #show() {
    if (!pageState.language.value) return;
    this.#colours.ariaLabel = text('own_colour');
    this.#colours.querySelectorAll('input').forEach((choice, k) => { choice.ariaLabel = text(COLOURS[k]?.[2] ?? 'own_colour'); });
    this.#shown.textContent = pageState.ownRobot.value.name;
  }
}
