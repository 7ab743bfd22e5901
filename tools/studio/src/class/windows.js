// Windows over the teacher's page. STOP is in each: what is behind cannot be pressed.

import { makeButton, makeElement } from '../page/made.js';
import { element } from '../page/elements.js';

/** @param {string} id @param {import('../page/texts.js').Key | ''} key of its title */
export function makeWindow(id, key) {
  const dialog = makeElement('dialog'), title = makeElement('h2', key);
  dialog.id = id;
  dialog.className = 'class_window';
  title.id = `${id}_title`;
  dialog.setAttribute('aria-labelledby', title.id);
  const stopButton = makeButton('class_stop_all', () => element('stop', HTMLButtonElement).click());
  stopButton.className = 'stop';
  dialog.append(makeElement('header', '', title, makeButton('close', () => dialog.close()), stopButton));
  document.body.append(dialog);
  return dialog;
}
