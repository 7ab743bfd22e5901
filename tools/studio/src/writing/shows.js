// Which SHOW of a program's text has shown a value: its expression names the value.

import { text } from '../page/texts.js';

/** @typedef {import('../python.js').Checked} Checked */
/** @typedef {Checked['shows'][number]} Show */

/**
 * @param {Pick<Checked, 'places' | 'shows'>} program
 * @param {number | undefined} at an offset in its code
 * @returns {Show | undefined} the SHOW there, if it has a name
 */
export function showAt({ places, shows }, at = -1) {
  const begin = places.findLast(([offset]) => offset <= at)?.[0];
  return shows.find(([offset]) => offset === begin);
}

/**
 * @param {Show} show
 * @param {string} what its expression, or that in other words
 * @param {boolean} isApart it is told from others of its line, too
 */
export function nameOfShow([, , line, column, sharesText, sharesLine], what, isApart) {
  if (!sharesText) return what;
  return text('shown_line', { what, line: isApart && sharesLine ? `${line}:${column}` : line });
}
