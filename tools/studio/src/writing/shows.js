// Which SHOW of a program's text has shown a value: its expression names the value.

import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @typedef {CheckResult['shows'][number]} Show */

/**
 * @param {Pick<CheckResult, 'places' | 'shows'>} program
 * @param {number | undefined} codeOffset an offset in its code
 * @returns {Show | undefined} the SHOW there, if it has a name
 */
export function findShow({ places, shows }, codeOffset = -1) {
  const placeOffset = places.findLast(([offset]) => offset <= codeOffset)?.[0];
  return shows.find(([offset]) => offset === placeOffset);
}

/**
 * @param {Show[]} shows of the program, in their order
 * @param {Show} show one of them
 * @param {string} name its expression, or that in other words
 * @param {boolean} isApart it is told from others of its line, too
 */
export function shownName(shows, show, name, isApart) {
  const [, expression, line, column, sharesText, sharesLine] = show;
  if (!sharesText) return name;
  if (pageState.areBlocksNamed.value) return text('shown_block', { what: name, number: 1 + shows.filter((other) => other[1] === expression).indexOf(show) });
  return text('shown_line', { what: name, line: isApart && sharesLine ? `${line}:${column}` : line });
}
