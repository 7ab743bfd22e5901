// What is seen beside the program: the virtual robot, a real one, a class, or the lessons. All go on
// meanwhile.

import { element } from './elements.js';

const SIDES = [
  { button: element('side_virtual', HTMLButtonElement), section: element('driving', HTMLElement) },
  { button: element('side_real', HTMLButtonElement), section: element('link', HTMLElement) },
  { button: element('side_class', HTMLButtonElement), section: element('class', HTMLElement) },
  { button: element('side_lessons', HTMLButtonElement), section: element('lessons', HTMLElement) },
];

export function chooseSide() {
  for (const { button } of SIDES) button.addEventListener('click', () => showSide(button.id));
}

/** @param {string} id of its button */
export function showSide(id) {
  for (const { button, section } of SIDES) {
    button.setAttribute('aria-pressed', String(button.id === id));
    section.hidden = button.id !== id;
  }
}
