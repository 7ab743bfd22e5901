// A program in the address of the page, after `#program=`: no server sees that part.
//
// It is JSON with the text and the robot's name, deflated, in the letters of base64url. Whatever
// somebody else has put there is only ever shown as text.

import { isRobot } from '../page/words.js';

const HASH_PREFIX = '#program=';
const MAX_LINK_CHARACTERS = 8000; // characters of an address that any program for messages passes on
const MAX_READ_CHARACTERS = 40_000;
const MAX_BYTES = 200_000; // of what is inflated

/** @typedef {{text: string, robot: string}} SharedProgram */

/**
 * Returns the address that holds a program, or null where it is too long for one.
 * @param {SharedProgram} program
 * @param {string} pageAddress the page's address
 * @returns {Promise<string | null>}
 */
export async function makeLink({ text, robot: robotName }, pageAddress) {
  const stream = new Blob([JSON.stringify({ text, robot: robotName })]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let letters = '';
  for (const byte of bytes) letters += String.fromCharCode(byte);
  const packedText = btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  const link = pageAddress.replace(/#.*$/, '') + HASH_PREFIX + packedText;
  return link.length <= MAX_LINK_CHARACTERS ? link : null;
}

/** Whether an address brings a program. @param {string} hash the part of the address from `#` on */
export function holdsProgram(hash) {
  return hash.startsWith(HASH_PREFIX);
}

/**
 * Returns the program of an address: null if it has none. Rejects where it is no whole one.
 * @param {string} hash the part of the address from `#` on
 * @returns {Promise<SharedProgram | null>}
 */
export async function readLink(hash) {
  if (!holdsProgram(hash)) return null;
  const packedText = hash.slice(HASH_PREFIX.length);
  if (packedText.length > MAX_READ_CHARACTERS || !/^[\w-]+$/.test(packedText)) throw new Error('not a program');
  const letters = atob(packedText.replaceAll('-', '+').replaceAll('_', '/'));
  const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const program = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(await inflate(bytes)));
  if (typeof program?.text !== 'string' || !isRobot(program.robot)) throw new Error('not a program');
  return { text: program.text, robot: program.robot };
}

/**
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @returns {Promise<Uint8Array>}
 */
async function inflate(bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  const chunks = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > MAX_BYTES) {
      await reader.cancel();
      throw new Error('too long');
    }
    chunks.push(value);
  }
  return new Uint8Array(await new Blob(chunks).arrayBuffer());
}
