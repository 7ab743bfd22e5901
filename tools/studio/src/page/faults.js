// What is said of a fault of a program, on the virtual robot and on a real one.

import { shown } from '../robot/plain_text.js';
import { hasText, text } from './texts.js';

/** @param {unknown} fault its name @returns {string} a sentence that stands behind its line */
export function faultSaid(fault) {
  const name = shown(String(fault));
  const key = `fault_${name}`;
  return text(hasText(key) ? key : 'fault_other', { name });
}
