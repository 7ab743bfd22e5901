// The fields of a robot's trim.

import { element } from '../page/elements.js';
import { text } from '../page/texts.js';

/** @typedef {import('./transport.js').Trim} Trim */

const balance = element('trim_balance', HTMLInputElement);
const least = element('trim_least', HTMLInputElement);
const exchanged = element('trim_exchanged', HTMLInputElement);
const left = element('trim_left', HTMLInputElement);
const right = element('trim_right', HTMLInputElement);
const pace = element('trim_pace', HTMLElement);

/** @param {Trim} trim */
export function showTrim(trim) {
  balance.value = String(trim.balance);
  least.value = String(trim.least);
  exchanged.checked = trim.is_exchanged;
  left.checked = trim.is_left_reversed;
  right.checked = trim.is_right_reversed;
  pace.textContent = trim.pace ? told(trim.pace) : '';
}

/** @param {import('./transport.js').Pace} pace @returns {string} */
function told({ speed_40, speed_80, turn_40, turn_80 }) {
  const rows = [
    speed_80 ? text('trim_speed', { at_40: speed_40, at_80: speed_80 }) : '',
    turn_80 ? text('trim_turn', { at_40: turn_40, at_80: turn_80 }) : '',
  ].filter(Boolean);
  return rows.join(' ') || text('trim_kits_pace');
}

/** @returns {Trim} what is typed; the pace stays as it is */
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
