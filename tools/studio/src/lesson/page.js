// A step of a lesson: its paragraphs and programs become elements. Knows no lesson.

import { makeButton, makeElement } from '../page/made.js';
import { makeTextElement } from '../page/sentences.js';

const PICTURE_RATIO = 2.6; // of a picture of blocks, for one of the page

/** @typedef {{kind: string, rows: string[][]}} StepBlock */

/**
 * @typedef {object} Reader what is done for who reads a step
 * @property {(program: string) => void} useProgram what is done with a program of the page
 * @property {(code: string) => import('../blocks/said.js').Label | null} labelOfCode the words on a block that is named in a sentence; null for its text
 * @property {((program: string, done: (address: string) => void) => void) | null} drawProgram a program as blocks; null for its text
 */

/**
 * @param {StepBlock} block
 * @param {Reader} reader
 * @returns {HTMLElement}
 */
export function makeBlockElement({ kind, rows }, reader) {
  const lines = rows.map(([line = '']) => line).join('\n');
  if (kind === 'program') return makeProgramElement(lines, reader);
  const paragraph = makeTextElement('p', lines, reader);
  paragraph.className = kind;
  return paragraph;
}

/**
 * @param {string} programText
 * @param {Reader} reader
 */
function makeProgramElement(programText, { useProgram, drawProgram }) {
  const programElement = makeElement('pre', '', programText);
  const container = makeElement('div', '', programElement, makeButton('lesson_use', () => useProgram(`${programText}\n`)));
  container.className = 'program';
  drawProgram?.(programText, (address) => {
    if (!address) return;
    const picture = makeElement('img');
    picture.alt = ''; // its text is read
    picture.addEventListener('load', () => {
      picture.width = picture.naturalWidth / PICTURE_RATIO;
      programElement.className = 'heard';
    });
    picture.src = address;
    programElement.after(picture);
  });
  return container;
}
