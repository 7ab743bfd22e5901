// Elements that the page makes, and drawings. A text with a key changes with the language.

import { text } from './texts.js';

/**
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {import('./texts.js').Key | ''} key of its text
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function makeElement(tag, key = '', ...children) {
  const element = document.createElement(tag);
  if (key) {
    element.dataset['text'] = key;
    element.textContent = text(key);
  }
  element.append(...children);
  return element;
}

/** @param {import('./texts.js').Key | ''} key @param {(event: MouseEvent) => void} onClick @param {(Node | string)[]} children */
export function makeButton(key, onClick, ...children) {
  const element = makeElement('button', key, ...children);
  element.type = 'button';
  element.addEventListener('click', onClick);
  return element;
}

/** @param {import('./texts.js').Key} key @param {HTMLElement} field */
export function makeLabel(key, field) {
  return makeElement('label', '', makeElement('span', key), ' ', field);
}

/** A drawing, or a part of one. @param {string} tag @param {Record<string, string | number>} attributes @param {Node[]} children */
export function makeSvg(tag, attributes, ...children) {
  const element = /** @type {SVGElement} */ (document.createElementNS('http://www.w3.org/2000/svg', tag));
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}
