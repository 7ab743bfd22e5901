// A step of a lesson: its paragraphs and programs become elements. Knows no lesson.

import { makeButton, makeElement } from '../page/made.js';

const PIXELS = 2.6; // of a picture of blocks, for one of the page

/** @typedef {{kind: string, rows: string[][]}} Block */

/**
 * @typedef {object} Reader what is done for who reads a step
 * @property {(program: string) => void} use what is done with a program of the page
 * @property {(code: string) => import('../blocks/said.js').Label | null} say the words on a block that is named in a sentence; null for its text
 * @property {((program: string, done: (address: string) => void) => void) | null} draw a program as blocks; null for its text
 */

/**
 * @param {Block} block
 * @param {Reader} reader
 * @returns {HTMLElement}
 */
export function elementOf({ kind, rows }, reader) {
  const lines = rows.map(([line = '']) => line).join('\n');
  return kind === 'program' ? programOf(lines, reader) : filled('p', lines, reader);
}

/**
 * @param {string} program
 * @param {Reader} reader
 */
function programOf(program, { use, draw }) {
  const written = makeElement('pre', '', program);
  const place = makeElement('div', '', written, makeButton('lesson_use', () => use(`${program}\n`)));
  place.className = 'program';
  draw?.(program, (address) => {
    if (!address) return;
    const picture = makeElement('img');
    picture.alt = ''; // its text is read
    picture.addEventListener('load', () => {
      picture.width = picture.naturalWidth / PIXELS;
      written.className = 'heard';
    });
    picture.src = address;
    written.after(picture);
  });
  return place;
}

/**
 * An element with a line of a page, in which `**` is around what is bold, and a back quote around code.
 * @param {'p' | 'span' | 'li'} kind
 * @param {string} line
 * @param {Reader} reader
 */
export function filled(kind, line, { say }) {
  return makeElement(kind, '', ...line.split(/(\*\*.+?\*\*|`[^`]+`)/).map((part) => {
    const mark = part.startsWith('**') ? 2 : part.startsWith('`') ? 1 : 0;
    if (!mark || part.length <= 2 * mark) return part;
    const inside = part.slice(mark, -mark), label = mark === 1 ? say(inside) : null;
    const place = makeElement(mark === 2 ? 'strong' : label ? 'span' : 'code', '', label?.text ?? inside);
    if (label) {
      place.className = 'on_block';
      place.style.setProperty('--colour', label.colour);
    }
    return place;
  }));
}
