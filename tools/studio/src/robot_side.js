// What is seen beside the program: the virtual robot, a real one, or a teacher's class. All go on meanwhile.

import { element } from './elements.js';

const SIDES = [
  { button: element('side_virtual', HTMLButtonElement), section: element('driving', HTMLElement) },
  { button: element('side_real', HTMLButtonElement), section: element('link', HTMLElement) },
  { button: element('side_class', HTMLButtonElement), section: element('class', HTMLElement) },
];

export function chooseSide() {
  for (const chosen of SIDES) {
    chosen.button.addEventListener('click', () => {
      for (const { button, section } of SIDES) {
        button.setAttribute('aria-pressed', String(button === chosen.button));
        section.hidden = button !== chosen.button;
      }
    });
  }
}
