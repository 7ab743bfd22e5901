// Readings of sensors, as people read them.

import { hasText, text } from './texts.js';
import { blockLabel } from './words.js';

/** @typedef {ReturnType<typeof import('./words.js').devicesOf>[number]} Device */

/** How much of its range a reading is, for a bar. @param {Device} device @param {number} [value] */
export function percentOfRange({ arguments: [range] }, value) {
  if (!range || value === undefined || range.high <= range.low) return '0%';
  return `${Math.round((100 * (value - range.low)) / (range.high - range.low))}%`;
}

/**
 * A reading with its unit, or with the most that it can be.
 * @param {Device} device
 * @param {string} value
 */
export function readingText({ unit, arguments: [range] }, value) {
  if (hasText(`block/${value}`)) return blockLabel(value); // TRUE or FALSE
  return unit || !range ? `${value} ${unit}` : text('of', { value, most: range.high });
}

/** @param {string | undefined} shownValue a value as SHOW says it, or nothing */
export function parseShownValue(shownValue) {
  if (!shownValue) return undefined;
  return { TRUE: 1, FALSE: 0 }[shownValue] ?? Number(shownValue);
}
