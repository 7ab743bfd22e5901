// What is shown on the big screen: a pupil's program, or how to come into the class.

import { correction, generate } from 'lean-qr';
import { makeButton, makeElement } from '../page/made.js';
import { makeIcon } from './icons.js';
import { element, setText } from '../page/elements.js';
import { text } from '../page/texts.js';

const QUIET_ZONE_MODULES = 4; // white modules around a QR code

/** A window over the whole page. STOP is in it, too: what is behind cannot be pressed. */
class BigWindow {
  dialog = makeElement('dialog');
  title = makeElement('h2');
  head = makeElement('header', '', this.title);
  body = makeElement('div');

  /** @param {string} id */
  constructor(id) {
    this.dialog.id = id;
    this.dialog.className = 'big';
    this.title.id = `${id}_title`;
    this.dialog.setAttribute('aria-labelledby', this.title.id);
    this.body.tabIndex = 0; // it may be scrolled
    this.body.setAttribute('role', 'group');
    this.body.setAttribute('aria-labelledby', this.title.id);
    this.dialog.append(this.head, this.body);
    document.body.append(this.dialog);
  }

  addButtons() {
    const stopButton = makeButton('class_stop_all', () => element('stop', HTMLButtonElement).click());
    stopButton.className = 'stop';
    this.head.append(makeButton('close', () => this.dialog.close()), stopButton);
  }
}

/** @typedef {{key: string, title: string, stateText: string, picture: string, text: string, history: string[], isDriving: boolean, isHandUp: boolean}} PupilView */
/** @typedef {{step: (offset: number) => void, stop: (key: string) => void, endTurn: (key: string) => void, remove: (key: string) => void, lowerHand: (key: string) => void}} PupilActions */

export class BigPupil extends BigWindow {
  key = '';
  #stateElement = makeElement('p');
  #pictureElement = makeElement('img');
  #programElement = makeElement('pre');
  #historyElement = makeElement('pre');
  #stopButton; #nextButton; #lowerButton; #removeButton;

  /** @param {PupilActions} actions */
  constructor(actions) {
    super('big_pupil');
    const makeActionButton = (/** @type {import('../page/texts.js').Key} */ textKey, /** @type {(key: string) => void} */ action) => makeButton(textKey, () => action(this.key));
    this.#lowerButton = makeActionButton('class_lower_hand', actions.lowerHand);
    this.#stopButton = makeActionButton('stop', actions.stop);
    this.#nextButton = makeActionButton('class_next', actions.endTurn);
    this.#removeButton = makeActionButton('class_remove', actions.remove);
    const makeStepButton = (/** @type {'left' | 'right'} */ name, /** @type {number} */ offset) => {
      const stepButton = makeButton('', () => actions.step(offset), makeIcon(name));
      stepButton.dataset['label'] = `class_${name}`;
      stepButton.setAttribute('aria-label', text(`class_${name}`));
      return stepButton;
    };
    this.#stateElement.setAttribute('role', 'status');
    this.#programElement.tabIndex = 0;
    this.#programElement.setAttribute('translate', 'no');
    this.title.before(makeStepButton('left', -1));
    this.head.append(makeStepButton('right', 1), this.#stateElement, this.#lowerButton, this.#stopButton, this.#nextButton, this.#removeButton);
    this.addButtons();
    this.#pictureElement.alt = '';
    const paper = makeElement('div', '', this.#pictureElement);
    paper.className = 'paper';
    this.#historyElement.tabIndex = 0;
    this.#historyElement.setAttribute('translate', 'no');
    this.body.append(paper, this.#programElement, this.#historyElement);
    this.dialog.addEventListener('keydown', ({ key, target }) => {
      if (target === this.#programElement) return;
      if (key === 'ArrowLeft') actions.step(-1);
      if (key === 'ArrowRight') actions.step(1);
    });
    this.dialog.addEventListener('close', () => {
      this.key = '';
    });
  }

  /** @param {PupilView} view */
  show({ key, title, stateText, picture, text: programText, history, isDriving, isHandUp }) {
    this.key = key;
    setText(this.title, title);
    setText(this.#stateElement, stateText);
    setText(this.#programElement, programText);
    this.#programElement.setAttribute('aria-label', text('class_program_of', { name: title }));
    this.#historyElement.hidden = !history.length;
    setText(this.#historyElement, [text('class_history'), '', ...history].join('\n'));
    this.#historyElement.setAttribute('aria-label', text('class_history'));
    const paper = /** @type {HTMLElement} */ (this.#pictureElement.parentElement);
    paper.hidden = !picture;
    if (picture && this.#pictureElement.src !== picture) this.#pictureElement.src = picture;
    this.#lowerButton.hidden = !isHandUp;
    this.#removeButton.hidden = key.startsWith('group '); // a group is left by its pupils
    this.#stopButton.hidden = this.#nextButton.hidden = !isDriving;
    if (!this.dialog.open) this.dialog.showModal();
  }
}

export class BigCode extends BigWindow {
  #codeElement = makeElement('strong');
  #addressElement = makeElement('strong', '', location.origin);
  #qrCanvas = makeElement('canvas');

  constructor() {
    super('big_code');
    this.head.append(makeElement('span'));
    this.addButtons();
    this.title.dataset['text'] = 'class_come';
    setText(this.title, text('class_come'));
    this.#qrCanvas.setAttribute('role', 'img');
    this.#qrCanvas.dataset['label'] = 'class_picture';
    this.#qrCanvas.setAttribute('aria-label', text('class_picture'));
    generate(location.origin, { minCorrectionLevel: correction.M })
      .toCanvas(this.#qrCanvas, { padX: QUIET_ZONE_MODULES, padY: QUIET_ZONE_MODULES, on: [0, 0, 0, 255], off: [255, 255, 255, 255] });
    this.body.append(this.#qrCanvas, makeElement('ol', '',
      makeElement('li', '', makeElement('span', 'class_step_wifi')),
      makeElement('li', '', makeElement('span', 'class_step_open'), this.#addressElement),
      makeElement('li', '', makeElement('span', 'class_step_code'), this.#codeElement)));
  }

  /** @param {string} code */
  show(code) {
    this.setCode(code);
    this.dialog.showModal();
  }

  /** @param {string} code */
  setCode(code) {
    setText(this.#codeElement, code);
  }
}
