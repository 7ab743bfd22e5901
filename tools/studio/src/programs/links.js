// A program in the address of the page, after `#program=`: no server sees that part.
//
// It is JSON with the text and the robot's name, deflated, in the letters of base64url. Whatever
// somebody else has put there is only ever shown as text.

import { isRobot } from '../page/words.js';

const MARK = '#program=';
const MOST_MADE = 8000; // characters of an address that any program for messages passes on
const MOST_READ = 40_000;
const MOST_BYTES = 200_000; // of what is inflated

/** @typedef {{text: string, robot: string}} Shared */

/**
 * Returns the address that holds a program, or null where it is too long for one.
 * @param {Shared} program
 * @param {string} page the page's address
 * @returns {Promise<string | null>}
 */
export async function linkOf({ text, robot }, page) {
  const stream = new Blob([JSON.stringify({ text, robot })]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let letters = '';
  for (const byte of bytes) letters += String.fromCharCode(byte);
  const packed = btoa(letters).replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '');
  const link = page.replace(/#.*$/, '') + MARK + packed;
  return link.length <= MOST_MADE ? link : null;
}

/** Whether an address brings a program. @param {string} hash the part of the address from `#` on */
export function bringsProgram(hash) {
  return hash.startsWith(MARK);
}

/**
 * Returns the program of an address: null if it has none. Rejects where it is no whole one.
 * @param {string} hash the part of the address from `#` on
 * @returns {Promise<Shared | null>}
 */
export async function sharedIn(hash) {
  if (!bringsProgram(hash)) return null;
  const packed = hash.slice(MARK.length);
  if (packed.length > MOST_READ || !/^[\w-]+$/.test(packed)) throw new Error('not a program');
  const letters = atob(packed.replaceAll('-', '+').replaceAll('_', '/'));
  const bytes = Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
  const shared = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(await inflated(bytes)));
  if (typeof shared?.text !== 'string' || !isRobot(shared.robot)) throw new Error('not a program');
  return { text: shared.text, robot: shared.robot };
}

/**
 * @param {Uint8Array<ArrayBuffer>} bytes
 * @returns {Promise<Uint8Array>}
 */
async function inflated(bytes) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  const whole = [];
  let length = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    length += value.length;
    if (length > MOST_BYTES) {
      await reader.cancel();
      throw new Error('too long');
    }
    whole.push(value);
  }
  return new Uint8Array(await new Blob(whole).arrayBuffer());
}
