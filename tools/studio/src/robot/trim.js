// The fields of a robot's trim.

import { element } from '../page/elements.js';
import { text } from '../page/texts.js';

/** @typedef {import('./transport.js').Trim} Trim */

const balanceInput = element('trim_balance', HTMLInputElement);
const leastInput = element('trim_least', HTMLInputElement);
const exchangedInput = element('trim_exchanged', HTMLInputElement);
const leftInput = element('trim_left', HTMLInputElement);
const rightInput = element('trim_right', HTMLInputElement);
const paceElement = element('trim_pace', HTMLElement);

/** @param {Trim} trim */
export function showTrim(trim) {
  balanceInput.value = String(trim.balance);
  leastInput.value = String(trim.least);
  exchangedInput.checked = trim.is_exchanged;
  leftInput.checked = trim.is_left_reversed;
  rightInput.checked = trim.is_right_reversed;
  paceElement.textContent = trim.pace ? paceText(trim.pace) : '';
}

/** @param {import('./transport.js').Pace} pace @returns {string} */
function paceText({ speed_40, speed_80, turn_40, turn_80 }) {
  const sentences = [
    speed_80 ? text('trim_speed', { at_40: speed_40, at_80: speed_80 }) : '',
    turn_80 ? text('trim_turn', { at_40: turn_40, at_80: turn_80 }) : '',
  ].filter(Boolean);
  return sentences.join(' ') || text('trim_kits_pace');
}

/** @returns {Trim} what is typed; the pace stays as it is */
export function readTrim() {
  return {
    is_exchanged: exchangedInput.checked,
    is_left_reversed: leftInput.checked,
    is_right_reversed: rightInput.checked,
    balance: clampToField(balanceInput),
    least: clampToField(leastInput),
  };
}

/** A whole number between the field's limits. @param {HTMLInputElement} field */
function clampToField(field) {
  const rounded = Math.round(Number(field.value)) || 0;
  return Math.min(Number(field.max), Math.max(Number(field.min), rounded));
}
