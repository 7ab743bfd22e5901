// Elements that the class's parts of the page make, with texts that change with the language.

import { text } from '../page/texts.js';

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} kind
 * @param {import('../page/texts.js').Key | ''} key of its text
 * @param {(Node | string)[]} inside
 * @returns {HTMLElementTagNameMap[K]}
 */
export function made(kind, key = '', ...inside) {
  const found = document.createElement(kind);
  if (key) {
    found.dataset['text'] = key;
    found.textContent = text(key);
  }
  found.append(...inside);
  return found;
}

/** @param {import('../page/texts.js').Key} key @param {(event: MouseEvent) => void} pressed */
export function button(key, pressed) {
  const found = made('button', key);
  found.type = 'button';
  found.addEventListener('click', pressed);
  return found;
}

/** @param {import('../page/texts.js').Key} key @param {HTMLElement} field */
export function labelled(key, field) {
  return made('label', '', made('span', key), ' ', field);
}
