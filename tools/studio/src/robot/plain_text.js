// What a robot or a host has said, as a person may read it: as text alone, and with what to try.

import { hasText, text } from '../page/texts.js';

/** @typedef {import('./transport.js').Answer} Answer */

const MAX_CHARACTERS = 200; // of a name or a text

/** @param {Answer} answer */
export function refusalText({ failure = '', said: sentence = '', advice = '' }) {
  const adviceKey = `try_${failure}`;
  return [sentence, hasText(adviceKey) ? text(adviceKey) : advice].join(' ').trim();
}

/** What somebody else has written, without what moves or hides text. @param {string} text */
export function asPlainText(text, mostCharacters = MAX_CHARACTERS) {
  const plain = text.replace(/[\p{C}\p{Zl}\p{Zp}]/gu, '?');
  return plain.length > mostCharacters ? `${plain.slice(0, mostCharacters)}…` : plain;
}
