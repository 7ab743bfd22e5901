// A sentence with code in it: named as its block is, or as it is written.

import { makeElement } from './made.js';

/**
 * An element with a line of a page, in which `**` is around what is bold, and a back quote around code.
 * @param {'p' | 'span' | 'li'} tag
 * @param {string} line
 * @param {{labelOfCode: (code: string) => import('../blocks/said.js').Label | null}} reader
 */
export function makeTextElement(tag, line, { labelOfCode }) {
  return makeElement(tag, '', ...line.split(/(\*\*.+?\*\*|`[^`]+`)/).map((segment) => {
    const markLength = segment.startsWith('**') ? 2 : segment.startsWith('`') ? 1 : 0;
    if (!markLength || segment.length <= 2 * markLength) return segment;
    const content = segment.slice(markLength, -markLength), label = markLength === 1 ? labelOfCode(content) : null;
    const partElement = makeElement(markLength === 2 ? 'strong' : label ? 'span' : 'code', '', label?.text ?? content);
    if (label) {
      partElement.className = 'on_block';
      partElement.style.setProperty('--colour', label.colour);
    }
    return partElement;
  }));
}
