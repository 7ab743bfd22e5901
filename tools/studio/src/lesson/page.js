// A step of a lesson: its paragraphs and programs become elements. Knows no lesson.

import { button, made } from '../page/made.js';

/** @typedef {{kind: string, rows: string[][]}} Block */

/**
 * @param {Block} block
 * @param {(program: string) => void} use what is done with a program of the page
 * @returns {HTMLElement}
 */
export function elementOf({ kind, rows }, use) {
  const lines = rows.map(([line = '']) => line).join('\n');
  return kind === 'program' ? programOf(lines, use) : filled('p', lines);
}

/**
 * @param {string} program
 * @param {(program: string) => void} use
 */
function programOf(program, use) {
  const place = made('div', '', made('pre', '', program), button('lesson_use', () => use(`${program}\n`)));
  place.className = 'program';
  return place;
}

/**
 * An element with a line of a page, in which `**` is around what is bold, and a back quote around code.
 * @param {'p' | 'span'} kind
 * @param {string} line
 */
export function filled(kind, line) {
  return made(kind, '', ...line.split(/(\*\*.+?\*\*|`[^`]+`)/).map((part) => {
    const mark = part.startsWith('**') ? 2 : part.startsWith('`') ? 1 : 0;
    if (!mark || part.length <= 2 * mark) return part;
    return made(mark === 2 ? 'strong' : 'code', '', part.slice(mark, -mark));
  }));
}
