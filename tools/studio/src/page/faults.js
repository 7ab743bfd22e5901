// What is said of a fault of a program, on the virtual robot and on a real one, and of a mistake of ours.

import { asPlainText } from '../robot/plain_text.js';
import { hasText, text } from './texts.js';

/** @param {unknown} fault its name @returns {string} a sentence that stands after its line */
export function faultSentence(fault) {
  const name = asPlainText(String(fault));
  const key = `fault_${name}`;
  return text(hasText(key) ? key : 'fault_other', { name });
}

/** @param {unknown} error a mistake of ours: the last line of it is said */
export function bugSentence(error) {
  return text('bug', { why: String(error).split('\n').filter(Boolean).at(-1) ?? '' });
}
