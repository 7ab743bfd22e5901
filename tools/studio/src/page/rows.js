// Names and their values, in rows.

import { setText } from './elements.js';
import { makeElement } from './made.js';

const SHORT_NAME_CHARACTERS = 12; // characters of a name whose value stands beside another one

/**
 * @param {HTMLElement} container
 * @param {string[][]} rows name, value, and how much of its range that is
 */
export function showRows(container, rows) {
  while (container.children.length > rows.length) container.lastElementChild?.remove();
  rows.forEach(([name = '', value = '', barWidth = ''], index) => {
    const row = /** @type {HTMLElement} */ (container.children[index] ?? container.appendChild(makeElement('div', '', makeElement('dt'), makeElement('dd'))));
    row.classList.toggle('wide', name.length > SHORT_NAME_CHARACTERS || barWidth !== '');
    row.classList.toggle('barred', barWidth !== '');
    row.style.backgroundSize = barWidth && `${barWidth} 4px, 100% 4px`; // a custom property would have the cells' style computed, too
    [name, value].forEach((cellText, column) => {
      const cell = row.children[column];
      if (cell) setText(cell, cellText);
    });
  });
}

/**
 * A variable as SHOW says it.
 * @param {number | undefined} value
 * @param {boolean} isYesNo
 */
export function variableText(value, isYesNo) {
  if (value === undefined) return '–';
  return isYesNo ? (value ? 'TRUE' : 'FALSE') : String(value);
}
