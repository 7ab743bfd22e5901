// The window where somebody gives the virtual robot a colour and a name.

import { element } from '../page/elements.js';
import { makeButton, makeSvg, makeLabel, makeElement } from '../page/made.js';
import { storeOwnRobot, COLOURS, MAX_NAME_CHARACTERS } from '../page/own_robot.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';

export class OwnRobotWindow {
  #nameInput = makeElement('input');
  #colourGroup = makeElement('div');
  #dialog = makeElement('dialog');
  #nameElement = makeElement('span');

  constructor() {
    const heading = makeElement('h2', 'own_robot');
    heading.id = 'own_title';
    this.#dialog.id = 'own';
    this.#dialog.setAttribute('aria-labelledby', heading.id);
    this.#nameInput.id = 'own_name';
    this.#nameInput.maxLength = MAX_NAME_CHARACTERS;
    this.#nameInput.autocomplete = 'off';
    this.#nameInput.addEventListener('input', () => this.#changeOwnRobot({ name: this.#nameInput.value }));
    this.#colourGroup.setAttribute('role', 'radiogroup');
    this.#colourGroup.append(...COLOURS.map(([bodyColour, edgeColour, key], colourIndex) => {
      const radio = makeElement('input');
      Object.assign(radio, { type: 'radio', name: 'own_colour', value: String(colourIndex) });
      radio.dataset['label'] = key;
      radio.addEventListener('change', () => this.#changeOwnRobot({ colour: colourIndex }));
      const picture = makeSvg('svg', { viewBox: '-26 -22 54 44', 'aria-hidden': 'true' }, makeSvg('use', { href: '#drawn_robot' }));
      picture.style.setProperty('--robot', bodyColour);
      picture.style.setProperty('--robot-edge', edgeColour);
      return makeElement('label', '', radio, picture);
    }));
    this.#dialog.append(
      makeElement('header', '', heading, makeButton('close', () => this.#dialog.close())),
      makeElement('section', '', makeLabel('own_name', this.#nameInput), this.#colourGroup),
    );
    document.body.append(this.#dialog);
    this.#nameElement.className = 'own_name';
    const openButton = element('start_own', HTMLButtonElement);
    openButton.append(this.#nameElement);
    openButton.addEventListener('click', () => this.#openDialog());
    pageState.ownRobot.subscribe(() => this.#show());
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  #openDialog() {
    const { name, colour } = pageState.ownRobot.value;
    this.#nameInput.value = name;
    const radio = this.#colourGroup.querySelectorAll('input')[colour];
    if (radio) radio.checked = true;
    this.#dialog.showModal();
  }

  /** @param {Partial<import('../page/own_robot.js').OwnRobot>} changes of it that is new */
  #changeOwnRobot(changes) {
    if (!storeOwnRobot({ ...pageState.ownRobot.value, ...changes })) pageState.note.set(text('not_kept'));
  }

  #show() {
    if (!pageState.language.value) return;
    this.#colourGroup.ariaLabel = text('own_colour');
    this.#colourGroup.querySelectorAll('input').forEach((radio, index) => { radio.ariaLabel = text(COLOURS[index]?.[2] ?? 'own_colour'); });
    this.#nameElement.textContent = pageState.ownRobot.value.name;
  }
}
