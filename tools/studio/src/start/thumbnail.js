// A program as a small picture: a bar for each instruction, in the colour of its block. Made of the
// text alone, so that it costs nothing and shows nothing that somebody else has written.

import { COLOURS } from '../blocks/colours.js';
import { makeSvg } from '../page/made.js';
import { KINDS, wordsOf } from '../page/words.js';

const MOST = 7; // bars
const ROW = 9, HIGH = 7, STEP = 7, WIDEST = 60;
const OPENS = /^(LOOP|REPEAT|WHILE|IF|DEF|TASK|WHEN)\b/i, TURNS = /^ELSE/i, CLOSES = /^END/i;

/**
 * @param {string} program
 * @param {string} robot
 * @returns {SVGElement}
 */
export function thumbnail(program, robot) {
  const words = wordsOf(robot);
  /** @type {SVGElement[]} */
  const bars = [];
  let depth = 0;
  for (const part of program.replace(/\/\/.*$/gm, '').replace(/^\s*\w+\s*\|/, '').split(/[;\n]/)) {
    const line = part.trim();
    if (!line) continue;
    if (CLOSES.test(line) || TURNS.test(line)) depth = Math.max(0, depth - 1);
    if (!CLOSES.test(line)) {
      const role = words.get(/^\w*/.exec(line)?.[0].toUpperCase() ?? '')?.role ?? '';
      const colour = OPENS.test(line) || TURNS.test(line) ? COLOURS['control'] : COLOURS[KINDS[role === 'actuator' ? 'set' : role]?.colour ?? 'names'];
      const width = Math.min(WIDEST, 14 + 3 * line.length);
      bars.push(makeSvg('rect', { x: 3 + depth * STEP, y: 3 + bars.length * ROW, width, height: HIGH, rx: 2, fill: colour ?? '' }));
    }
    if (OPENS.test(line) || TURNS.test(line)) depth = Math.min(3, depth + 1);
    if (bars.length === MOST) break;
  }
  return makeSvg('svg', { viewBox: `0 0 96 ${MOST * ROW + 3}`, 'aria-hidden': 'true' }, ...bars);
}
