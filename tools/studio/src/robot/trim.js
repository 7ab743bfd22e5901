// The fields of a robot's trim.

import { element } from '../elements.js';

/** @typedef {import('./way.js').Trim} Trim */

const balance = element('trim_balance', HTMLInputElement);
const least = element('trim_least', HTMLInputElement);
const exchanged = element('trim_exchanged', HTMLInputElement);
const left = element('trim_left', HTMLInputElement);
const right = element('trim_right', HTMLInputElement);

/** @param {Trim} trim */
export function showTrim(trim) {
  balance.value = String(trim.balance);
  least.value = String(trim.least);
  exchanged.checked = trim.is_exchanged;
  left.checked = trim.is_left_reversed;
  right.checked = trim.is_right_reversed;
}

/** @returns {Trim} */
export function readTrim() {
  return {
    is_exchanged: exchanged.checked,
    is_left_reversed: left.checked,
    is_right_reversed: right.checked,
    balance: within(balance),
    least: within(least),
  };
}

/** A whole number between the field's limits. @param {HTMLInputElement} field */
function within(field) {
  const number = Math.round(Number(field.value)) || 0;
  return Math.min(Number(field.max), Math.max(Number(field.min), number));
}
