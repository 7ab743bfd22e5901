// Puts a robot's firmware onto a board, over its cable. Fetched when it is first wanted.
//
// The files are beside the page, as `tsc studio` gives them, or a person opens one.

import { BadHex, readHex } from './intel_hex.js';
import { SerialPort } from './serial.js';
import { Failed } from './way.js';
import { BOARDS, flash } from './stk500.js';

/** @typedef {{title: string, board: string, file: string}} Firmware */

const FLASH_BYTES = 0x8000;
const MOST_CHARACTERS = 200_000; // of a file; a full flash has 92,000

/**
 * Writes the firmware of a robot, or that of a file; rejects with a Failed.
 * @param {any} port of the browser
 * @param {string} board
 * @param {{robot: string, language: string} | File} which
 * @param {(part: number) => void} progress
 * @param {AbortSignal} cancelled
 */
export async function flashBoard(port, board, which, progress, cancelled) {
  const text = which instanceof File ? await which.slice(0, MOST_CHARACTERS).text() : await fetched(which, board);
  let firmware;
  try {
    firmware = readHex(text, FLASH_BYTES);
  } catch (why) {
    if (why instanceof BadHex) throw new Failed('flash_bad_file');
    throw why;
  }
  await flash((baud) => new SerialPort(port, baud), BOARDS[board] ?? [], firmware, progress, cancelled);
}

/** @param {{robot: string, language: string}} which @param {string} board */
async function fetched({ robot, language }, board) {
  const list = /** @type {Firmware[]} */ (JSON.parse(await fetchedText('firmware.json')));
  const titles = [`${robot}_${language}`, robot];
  const found = titles.map((title) => list.find((each) => each.title === title && each.board === board)).find(Boolean);
  if (!found) throw new Failed('flash_none');
  return fetchedText(found.file);
}

/** @param {string} name */
async function fetchedText(name) {
  try {
    const answer = await fetch(`./${encodeURIComponent(name)}`);
    if (answer.ok) return await answer.text();
  } catch {
    // no network, or a service worker without it
  }
  throw new Failed('flash_none');
}
