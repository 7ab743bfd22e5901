// Puts a robot's firmware onto a board, over its cable. Fetched when it is first wanted.
//
// The files are beside the page, as `tsc studio` gives them, or a person opens one.

import { watchedFetch } from '../page/progress.js';
import { BadHex, readHex } from './intel_hex.js';
import { SerialPort } from './serial.js';
import { Failed } from './transport.js';
import { BOARDS, flash } from './stk500.js';

/** @typedef {{title: string, board: string, file: string}} Firmware */
/** @typedef {{robot: string, language: string, halts: boolean}} Wanted of which robot; one that halts answers no text */

const FLASH_BYTES = 0x8000; // of an Uno or a Nano
const MOST_BYTES = 0x50_0000; // of a file; a full flash of an ESP32 has 4 MB

/** @typedef {import('../page/progress.js').Watching} Watching */

/**
 * Returns the firmware of a robot, or that of a file; rejects with a Failed.
 * @param {Wanted | File} which
 * @param {string} board
 * @param {Watching} watching
 */
export async function firmwareOf(which, board, watching) {
  const data = which instanceof File ? await which.slice(0, MOST_BYTES).arrayBuffer() : await fetched(which, board, watching);
  return new Uint8Array(data);
}

/** Has what writes onto a board fetched. @param {string} board @returns {Promise<unknown>} */
export async function writerOf(board) {
  return BOARDS[board] ? null : import('./esp32.js');
}

/**
 * Writes a firmware; rejects with a Failed.
 * @param {any} port of the browser
 * @param {string} board
 * @param {Uint8Array} data
 * @param {(part: number) => void} progress
 * @param {AbortSignal} cancelled
 */
export async function flashBoard(port, board, data, progress, cancelled) {
  if (!BOARDS[board]) {
    const { flashEsp32 } = await import('./esp32.js');
    await flashEsp32(port, board, data, progress, cancelled);
    return;
  }
  let firmware;
  try {
    firmware = readHex(new TextDecoder().decode(data), FLASH_BYTES);
  } catch (why) {
    if (why instanceof BadHex) throw new Failed('flash_bad_file');
    throw why;
  }
  await flash((baud) => new SerialPort(port, baud), BOARDS[board] ?? [], firmware, progress, cancelled);
}

/** What there is beside this page. @param {Watching} [watching] @returns {Promise<Firmware[]>} */
export async function firmwares(watching) {
  return JSON.parse(new TextDecoder().decode(await fetchedBytes('firmware.json', watching)));
}

/** @param {string} robot @returns {string} the title of its firmware with breakpoints */
export function haltingTitle(robot) {
  return `${robot}_breakpoints`;
}

/** @param {Wanted} which @param {string} board @param {Watching} watching */
async function fetched({ robot, language, halts }, board, watching) {
  const list = await firmwares(watching);
  const titles = halts ? [haltingTitle(robot)] : [`${robot}_${language}`, robot];
  const firmware = titles.map((title) => list.find((each) => each.title === title && each.board === board)).find(Boolean);
  if (!firmware) throw new Failed('flash_none');
  return fetchedBytes(firmware.file, watching);
}

/** @param {string} name @param {Watching} [watching] */
async function fetchedBytes(name, watching) {
  try {
    const answer = await watchedFetch(`./${encodeURIComponent(name)}`, watching);
    if (answer.ok) return await answer.arrayBuffer();
  } catch (why) {
    if (watching?.cancelled?.aborted) throw new Failed('flash_not_begun');
    if (/** @type {Error} */ (why).name === 'TimeoutError') throw new Failed('flash_held');
    // no network, or a service worker without it
  }
  throw new Failed('flash_none');
}
