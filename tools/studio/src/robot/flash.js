// Puts a robot's firmware onto a board, over its cable. Fetched when it is first wanted.
//
// The files are beside the page, as `tsc studio` gives them, or a person opens one.

import { watchedFetch } from '../page/progress.js';
import { BadHex, readHex } from './intel_hex.js';
import { SerialPort } from './serial.js';
import { ConnectionFailure } from './transport.js';
import { BOARDS, flash } from './stk500.js';

/** @typedef {{title: string, board: string, file: string}} Firmware */
/** @typedef {{robot: string, language: string, halts: boolean}} WantedFirmware of which robot; one that halts answers no text */

const FLASH_BYTES = 0x8000; // of an Uno or a Nano
const MAX_BYTES = 0x50_0000; // of a file; a full flash of an ESP32 has 4 MB

/** @typedef {import('../page/progress.js').WatchOptions} WatchOptions */

/**
 * Returns the firmware of a robot, or that of a file; rejects with a ConnectionFailure.
 * @param {WantedFirmware | File} wantedFirmware
 * @param {string} board
 * @param {WatchOptions} watchOptions
 */
export async function loadFirmware(wantedFirmware, board, watchOptions) {
  const data = wantedFirmware instanceof File ? await wantedFirmware.slice(0, MAX_BYTES).arrayBuffer() : await fetchFirmware(wantedFirmware, board, watchOptions);
  return new Uint8Array(data);
}

/** Has what writes onto a board fetched. @param {string} board @returns {Promise<unknown>} */
export async function preloadWriter(board) {
  return BOARDS[board] ? null : import('./esp32.js');
}

/**
 * Writes a firmware; rejects with a ConnectionFailure.
 * @param {any} port of the browser
 * @param {string} board
 * @param {Uint8Array} data
 * @param {(fraction: number) => void} onProgress
 * @param {AbortSignal} cancelSignal
 */
export async function flashBoard(port, board, data, onProgress, cancelSignal) {
  if (!BOARDS[board]) {
    const { flashEsp32 } = await import('./esp32.js');
    await flashEsp32(port, board, data, onProgress, cancelSignal);
    return;
  }
  let firmware;
  try {
    firmware = readHex(new TextDecoder().decode(data), FLASH_BYTES);
  } catch (error) {
    if (error instanceof BadHex) throw new ConnectionFailure('flash_bad_file');
    throw error;
  }
  await flash((baud) => new SerialPort(port, baud), BOARDS[board] ?? [], firmware, onProgress, cancelSignal);
}

/** What there is beside this page. @param {WatchOptions} [watchOptions] @returns {Promise<Firmware[]>} */
export async function fetchFirmwareList(watchOptions) {
  return JSON.parse(new TextDecoder().decode(await fetchBytes('firmware.json', watchOptions)));
}

/** @param {string} robotName @returns {string} the title of its firmware with breakpoints */
export function haltingFirmwareTitle(robotName) {
  return `${robotName}_breakpoints`;
}

/** @param {WantedFirmware} which @param {string} board @param {WatchOptions} watchOptions */
async function fetchFirmware({ robot: robotName, language, halts }, board, watchOptions) {
  const firmwareList = await fetchFirmwareList(watchOptions);
  const titles = halts ? [haltingFirmwareTitle(robotName)] : [`${robotName}_${language}`, robotName];
  const firmware = titles.map((title) => firmwareList.find((candidate) => candidate.title === title && candidate.board === board)).find(Boolean);
  if (!firmware) throw new ConnectionFailure('flash_none');
  return fetchBytes(firmware.file, watchOptions);
}

/** @param {string} fileName @param {WatchOptions} [watchOptions] */
async function fetchBytes(fileName, watchOptions) {
  try {
    const response = await watchedFetch(`./${encodeURIComponent(fileName)}`, watchOptions);
    if (response.ok) return await response.arrayBuffer();
  } catch (error) {
    if (watchOptions?.cancelSignal?.aborted) throw new ConnectionFailure('flash_not_begun');
    if (/** @type {Error} */ (error).name === 'TimeoutError') throw new ConnectionFailure('flash_held');
    // no network, or a service worker without it
  }
  throw new ConnectionFailure('flash_none');
}
