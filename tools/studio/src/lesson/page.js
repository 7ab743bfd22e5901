// A step of a lesson: its paragraphs and programs become elements. Knows no lesson.

import { text } from '../page/texts.js';

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
  const place = document.createElement('div');
  const lines = document.createElement('pre');
  const button = document.createElement('button');
  place.className = 'program';
  lines.textContent = program;
  button.type = 'button';
  button.textContent = text('lesson_use');
  button.addEventListener('click', () => use(`${program}\n`));
  place.append(lines, button);
  return place;
}

/**
 * An element with a line of a page, in which `**` is around what is bold, and a back quote around code.
 * @param {string} kind
 * @param {string} line
 */
export function filled(kind, line) {
  const found = document.createElement(kind);
  for (const part of line.split(/(\*\*.+?\*\*|`[^`]+`)/)) {
    const mark = part.startsWith('**') ? 2 : part.startsWith('`') ? 1 : 0;
    if (!mark || part.length <= 2 * mark) {
      found.append(part);
      continue;
    }
    const inner = document.createElement(mark === 2 ? 'strong' : 'code');
    inner.textContent = part.slice(mark, -mark);
    found.append(inner);
  }
  return found;
}
