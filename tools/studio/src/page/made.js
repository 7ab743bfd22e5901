// Elements that the page makes, and drawings. A text with a key changes with the language.

import { text } from './texts.js';

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} kind
 * @param {import('./texts.js').Key | ''} key of its text
 * @param {(Node | string)[]} inside
 * @returns {HTMLElementTagNameMap[K]}
 */
export function made(kind, key = '', ...inside) {
  const element = document.createElement(kind);
  if (key) {
    element.dataset['text'] = key;
    element.textContent = text(key);
  }
  element.append(...inside);
  return element;
}

/** @param {import('./texts.js').Key | ''} key @param {(event: MouseEvent) => void} pressed @param {(Node | string)[]} inside */
export function button(key, pressed, ...inside) {
  const found = made('button', key, ...inside);
  found.type = 'button';
  found.addEventListener('click', pressed);
  return found;
}

/** @param {import('./texts.js').Key} key @param {HTMLElement} field */
export function labelled(key, field) {
  return made('label', '', made('span', key), ' ', field);
}

/** A drawing, or a part of one. @param {string} name @param {Record<string, string | number>} values @param {Node[]} inside */
export function drawn(name, values, ...inside) {
  const element = /** @type {SVGElement} */ (document.createElementNS('http://www.w3.org/2000/svg', name));
  for (const [key, value] of Object.entries(values)) element.setAttribute(key, String(value));
  element.append(...inside);
  return element;
}
