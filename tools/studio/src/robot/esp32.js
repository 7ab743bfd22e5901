// Puts a firmware onto an ESP32 through the bootloader in its ROM, by Espressif's esptool-js, and has
// the chip say what it has then. Knows no page; a port is one of the browser's.

import { ESPLoader } from 'esptool-js/lib/esploader.js';
import { Transport } from 'esptool-js/lib/webserial.js';

import { watched } from '../page/progress.js';
import { md5 } from './md5.js';
import { Failed, pause, within } from './transport.js';

/** What `esptool` calls its chip, the chip in the head of an image, and where that is in a whole firmware. */
/** @type {Record<string, {name: string, number: number, head: number}>} */
export const CHIPS = {
  esp32dev: { name: 'ESP32', number: 0, head: 0x1000 },
  esp32c3: { name: 'ESP32-C3', number: 5, head: 0 },
};

const BAUD = 115_200; // of the ROM
const ROM_BLOCK = 0x400; // bytes that the ROM takes at once; esptool's own program takes more
const MAGIC = 0xe9;
const NUMBER_AT = 12; // in the head of an image
const FLASH_BYTES = 0x40_0000;
const RESET_MS = 100;
const TRIES = 3;
const STUCK_MS = 3000; // for a write, or the end of the port
const QUIET = { clean() {}, writeLine() {}, write() {} };

/** Whether a file is a whole firmware of a board: from address 0, as `esptool merge_bin` writes it. @param {Uint8Array} firmware @param {string} board */
export function isWhole(firmware, board) {
  const chip = CHIPS[board];
  if (!chip || firmware.length > FLASH_BYTES) return false;
  return firmware[chip.head] === MAGIC && firmware[chip.head + NUMBER_AT] === chip.number;
}

/**
 * Writes a firmware; rejects with a Failed.
 * @param {any} port
 * @param {string} board
 * @param {Uint8Array} firmware
 * @param {(part: number) => void} progress from 0 to 1
 * @param {AbortSignal} cancelled somebody wants it no more
 */
export async function flashEsp32(port, board, firmware, progress, cancelled) {
  if (!isWhole(firmware, board)) throw new Failed('flash_bad_image');
  const transport = new Transport(port);
  const write = transport.write.bind(transport);
  transport.write = (data) => within(STUCK_MS, write(data), 'port_stuck');
  const loader = new ESPLoader({ transport, baudrate: BAUD, romBaudrate: BAUD, terminal: QUIET });
  let isWriting = false;
  try {
    await reached(loader, cancelled);
    if (loader.chip.CHIP_NAME !== CHIPS[board]?.name) throw new Failed('flash_other_esp');
    loader.FLASH_WRITE_SIZE = ROM_BLOCK;
    if (cancelled.aborted) throw new Failed('flash_not_begun');
    await loader.flashSpiAttach(0);
    isWriting = true;
    const sum = { wanted: '' };
    await loader.writeFlash({
      fileArray: [{ data: firmware, address: 0 }], flashMode: 'keep', flashFreq: 'keep', flashSize: 'keep', eraseAll: false, compress: true,
      reportProgress: (_, written, total) => {
        if (cancelled.aborted) throw new Failed('flash_cancelled');
        progress(written / total);
      },
      // What the ROM answers are the letters of a sum; esptool-js shows their numbers.
      calculateMD5Hash: (image) => (sum.wanted = lettersOf(md5(image))),
    });
    await restart(transport);
  } catch (why) {
    if (why instanceof Failed) throw why;
    if (/MD5/.test(String(why))) throw new Failed('flash_differs');
    throw new Failed(isWriting ? 'flash_broken_off' : 'flash_nobody_esp');
  } finally {
    await within(STUCK_MS, transport.disconnect(), 'port_stuck').catch(() => {});
  }
}

/** The part of esptool-js for the chip is fetched meanwhile. @param {ESPLoader} loader @param {AbortSignal} cancelled */
async function reached(loader, cancelled) {
  try {
    await watched(loader.detectChip('default_reset', TRIES), { cancelled });
  } catch (why) {
    if (cancelled.aborted) throw new Failed('flash_not_begun');
    const { name } = /** @type {Error} */ (why);
    if (name === 'TimeoutError') throw new Failed('flash_held');
    if (name === 'InvalidStateError') throw new Failed('port_busy');
    throw new Failed(name === 'NetworkError' ? 'port_broken' : 'flash_nobody_esp');
  }
}

/** Lets the chip run what it has. @param {Transport} transport */
async function restart(transport) {
  await transport.setDTR(false);
  await transport.setRTS(true);
  await pause(RESET_MS);
  await transport.setRTS(false);
}

/** @param {string} text @returns {string} its letters in hexadecimal */
function lettersOf(text) {
  return [...text].map((each) => each.charCodeAt(0).toString(16)).join('');
}
