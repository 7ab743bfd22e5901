// What a robot or a host has said, as a person may read it: as text alone, and with what to try.

import { hasText, text } from '../page/texts.js';

/** @typedef {import('./transport.js').Answer} Answer */

const SHOWN_CHARACTERS = 200; // of a name or a text

/** @param {Answer} answer */
export function refusal({ failure = '', said = '', advice = '' }) {
  const own = `try_${failure}`;
  return [said, hasText(own) ? text(own) : advice].join(' ').trim();
}

/** What somebody else has written, without what moves or hides text. @param {string} found */
export function shown(found, most = SHOWN_CHARACTERS) {
  const plain = found.replace(/[\p{C}\p{Zl}\p{Zp}]/gu, '?');
  return plain.length > most ? `${plain.slice(0, most)}…` : plain;
}
