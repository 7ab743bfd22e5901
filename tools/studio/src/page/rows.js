// Names and their values, in rows.

import { say } from './elements.js';
import { made } from './made.js';

const SHORT = 12; // characters of a name whose value stands beside another one

/**
 * @param {HTMLElement} place
 * @param {string[][]} rows name, value, and how much of its range that is
 */
export function showRows(place, rows) {
  while (place.children.length > rows.length) place.lastElementChild?.remove();
  rows.forEach(([name = '', value = '', part = ''], k) => {
    const row = /** @type {HTMLElement} */ (place.children[k] ?? place.appendChild(made('div', '', made('dt'), made('dd'))));
    row.classList.toggle('wide', name.length > SHORT || part !== '');
    if (part) row.style.setProperty('--part', part);
    else row.removeAttribute('style');
    [name, value].forEach((said, at) => {
      const cell = row.children[at];
      if (cell) say(cell, said);
    });
  });
}

/**
 * A variable as SHOW says it.
 * @param {number | undefined} value
 * @param {boolean} isYesNo
 */
export function written(value, isYesNo) {
  if (value === undefined) return '–';
  return isYesNo ? (value ? 'TRUE' : 'FALSE') : String(value);
}
