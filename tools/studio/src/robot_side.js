// Which robot is seen beside the program: the virtual one or a real one. Both go on meanwhile.

import { element } from './elements.js';

const SIDES = [
  { button: element('side_virtual', HTMLButtonElement), section: element('driving', HTMLElement) },
  { button: element('side_real', HTMLButtonElement), section: element('link', HTMLElement) },
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
