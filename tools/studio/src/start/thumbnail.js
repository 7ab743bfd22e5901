// A program as a small picture: a bar for each instruction, in the colour of its block. Made of the
// text alone, so that it costs nothing and shows nothing that somebody else has written.

import { COLOURS } from '../blocks/colours.js';
import { makeSvg } from '../page/made.js';
import { KINDS, wordsOf } from '../page/words.js';

const MAX_BARS = 7; // bars
const ROW_HEIGHT = 9, BAR_HEIGHT = 7, INDENT = 7, MAX_BAR_WIDTH = 60;
const OPENING_WORD = /^(LOOP|REPEAT|WHILE|IF|DEF|TASK|WHEN)\b/i, ARM_WORD = /^ELSE/i, CLOSING_WORD = /^END/i;

/**
 * @param {string} programText
 * @param {string} robotName
 * @returns {SVGElement}
 */
export function makeThumbnail(programText, robotName) {
  const words = wordsOf(robotName);
  /** @type {SVGElement[]} */
  const bars = [];
  let depth = 0;
  for (const rawLine of programText.replace(/\/\/.*$/gm, '').replace(/^\s*\w+\s*\|/, '').split(/[;\n]/)) {
    const line = rawLine.trim();
    if (!line) continue;
    if (CLOSING_WORD.test(line) || ARM_WORD.test(line)) depth = Math.max(0, depth - 1);
    if (!CLOSING_WORD.test(line)) {
      const role = words.get(/^\w*/.exec(line)?.[0].toUpperCase() ?? '')?.role ?? '';
      const colour = OPENING_WORD.test(line) || ARM_WORD.test(line) ? COLOURS['control'] : COLOURS[KINDS[role === 'actuator' ? 'set' : role]?.colour ?? 'names'];
      const width = Math.min(MAX_BAR_WIDTH, 14 + 3 * line.length);
      bars.push(makeSvg('rect', { x: 3 + depth * INDENT, y: 3 + bars.length * ROW_HEIGHT, width, height: BAR_HEIGHT, rx: 2, fill: colour ?? '' }));
    }
    if (OPENING_WORD.test(line) || ARM_WORD.test(line)) depth = Math.min(3, depth + 1);
    if (bars.length === MAX_BARS) break;
  }
  return makeSvg('svg', { viewBox: `0 0 96 ${MAX_BARS * ROW_HEIGHT + 3}`, 'aria-hidden': 'true' }, ...bars);
}
