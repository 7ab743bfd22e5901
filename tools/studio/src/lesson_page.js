// A page of a lesson: its blocks become elements. Knows no lesson.

import { text } from './texts.js';

/** @typedef {{kind: string, rows: string[][], first: number}} Block */

/**
 * @param {Block[]} blocks
 * @param {(program: string) => void} use what is done with a program of the page
 * @returns {HTMLElement[]}
 */
export function pageOf(blocks, use) {
  return blocks.map((block) => elementOf(block, use));
}

/**
 * @param {Block} block
 * @param {(program: string) => void} use
 */
function elementOf({ kind, rows, first }, use) {
  if (kind === 'program') return programOf(rows.map(([line = '']) => line).join('\n'), use);
  if (kind === 'table') return tableOf(rows);
  if (kind === 'heading') return filled('h2', rows[0]?.[0] ?? '');
  if (kind === 'paragraph') return filled('p', rows[0]?.[0] ?? '');
  const list = document.createElement(kind === 'steps' ? 'ol' : 'ul');
  if (list instanceof HTMLOListElement) list.start = first;
  list.append(...rows.map(([row = '']) => filled('li', row)));
  return list;
}

/** @param {string[][]} rows the first one is the head */
function tableOf(rows) {
  const table = document.createElement('table');
  rows.forEach((cells, k) => {
    const row = table.insertRow();
    row.append(...cells.map((cell) => filled(k ? 'td' : 'th', cell)));
  });
  return table;
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
function filled(kind, line) {
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
