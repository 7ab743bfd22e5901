// What is seen beside the program: the virtual robot, also with the lessons above it, a real one, or a
// class. All go on meanwhile.

import { element } from './elements.js';
import { pageState } from './page_state.js';

const SIDES = [
  { button: element('side_virtual', HTMLButtonElement), section: null },
  { button: element('side_real', HTMLButtonElement), section: element('link', HTMLElement) },
  { button: element('side_class', HTMLButtonElement), section: element('class', HTMLElement) },
  { button: element('side_lessons', HTMLButtonElement), section: element('lessons', HTMLElement) },
];

export function listenToSideButtons() {
  for (const { button } of SIDES) button.addEventListener('click', () => showSide(button.id));
}

/** @param {string} id of its button */
export function showSide(id) {
  for (const { button, section } of SIDES) {
    button.setAttribute('aria-pressed', String(button.id === id));
    if (section) section.hidden = button.id !== id;
  }
  element('driving', HTMLElement).hidden = id !== 'side_virtual' && id !== 'side_lessons';
  document.documentElement.dataset['side'] = id;
  pageState.sideId.set(id);
}
