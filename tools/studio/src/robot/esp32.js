// Puts a firmware onto an ESP32 through the bootloader in its ROM, by Espressif's esptool-js, and has
// the chip say what it has then. Knows no page; a port is one of the browser's.

import { ESPLoader } from 'esptool-js/lib/esploader.js';
import { Transport } from 'esptool-js/lib/webserial.js';

import { watchPromise } from '../page/progress.js';
import { md5 } from './md5.js';
import { ConnectionFailure, pause, withTimeout } from './transport.js';

/** What `esptool` calls its chip, the chip in the head of an image, and where that is in a whole firmware. */
/** @type {Record<string, {name: string, chipNumber: number, headOffset: number}>} */
export const CHIPS = {
  esp32dev: { name: 'ESP32', chipNumber: 0, headOffset: 0x1000 },
  esp32c3: { name: 'ESP32-C3', chipNumber: 5, headOffset: 0 },
};

const ROM_BAUD = 115_200; // of the ROM
const ROM_BLOCK_BYTES = 0x400; // bytes that the ROM takes at once; esptool's own program takes more
const MAGIC_BYTE = 0xe9;
const CHIP_NUMBER_OFFSET = 12; // in the head of an image
const FLASH_BYTES = 0x40_0000;
const RESET_PULSE_MS = 100;
const DETECT_TRIES = 3;
const WRITE_LIMIT_MS = 3000; // for a write, or the end of the port
const SILENT_TERMINAL = { clean() {}, writeLine() {}, write() {} };

/** Whether a file is a whole firmware of a board: from address 0, as `esptool merge_bin` writes it. @param {Uint8Array} firmware @param {string} board */
export function isWholeFirmware(firmware, board) {
  const chip = CHIPS[board];
  if (!chip || firmware.length > FLASH_BYTES) return false;
  return firmware[chip.headOffset] === MAGIC_BYTE && firmware[chip.headOffset + CHIP_NUMBER_OFFSET] === chip.chipNumber;
}

/**
 * Writes a firmware; rejects with a ConnectionFailure.
 * @param {any} port
 * @param {string} board
 * @param {Uint8Array} firmware
 * @param {(fraction: number) => void} onProgress from 0 to 1
 * @param {AbortSignal} cancelSignal somebody wants it no more
 */
export async function flashEsp32(port, board, firmware, onProgress, cancelSignal) {
  if (!isWholeFirmware(firmware, board)) throw new ConnectionFailure('flash_bad_image');
  const transport = new Transport(port);
  const unlimitedWrite = transport.write.bind(transport);
  transport.write = (data) => withTimeout(WRITE_LIMIT_MS, unlimitedWrite(data), 'port_stuck');
  const loader = new ESPLoader({ transport, baudrate: ROM_BAUD, romBaudrate: ROM_BAUD, terminal: SILENT_TERMINAL });
  let isWriting = false;
  try {
    await detectChip(loader, cancelSignal);
    if (loader.chip.CHIP_NAME !== CHIPS[board]?.name) throw new ConnectionFailure('flash_other_esp');
    loader.FLASH_WRITE_SIZE = ROM_BLOCK_BYTES;
    if (cancelSignal.aborted) throw new ConnectionFailure('flash_not_begun');
    await loader.flashSpiAttach(0);
    isWriting = true;
    const expectedChecksum = { wanted: '' };
    await loader.writeFlash({
      fileArray: [{ data: firmware, address: 0 }], flashMode: 'keep', flashFreq: 'keep', flashSize: 'keep', eraseAll: false, compress: true,
      reportProgress: (_, writtenBytes, totalBytes) => {
        if (cancelSignal.aborted) throw new ConnectionFailure('flash_cancelled');
        onProgress(writtenBytes / totalBytes);
      },
      // What the ROM answers are the letters of a sum; esptool-js shows their numbers.
      calculateMD5Hash: (image) => (expectedChecksum.wanted = hexOfLetters(md5(image))),
    });
    await restartChip(transport);
  } catch (error) {
    if (error instanceof ConnectionFailure) throw error;
    if (/MD5/.test(String(error))) throw new ConnectionFailure('flash_differs');
    throw new ConnectionFailure(isWriting ? 'flash_broken_off' : 'flash_nobody_esp');
  } finally {
    await withTimeout(WRITE_LIMIT_MS, transport.disconnect(), 'port_stuck').catch(() => {});
  }
}

/** The part of esptool-js for the chip is fetched meanwhile. @param {ESPLoader} loader @param {AbortSignal} cancelSignal */
async function detectChip(loader, cancelSignal) {
  try {
    await watchPromise(loader.detectChip('default_reset', DETECT_TRIES), { cancelSignal });
  } catch (error) {
    if (cancelSignal.aborted) throw new ConnectionFailure('flash_not_begun');
    const { name } = /** @type {Error} */ (error);
    if (name === 'TimeoutError') throw new ConnectionFailure('flash_held');
    if (name === 'InvalidStateError') throw new ConnectionFailure('port_busy');
    throw new ConnectionFailure(name === 'NetworkError' ? 'port_broken' : 'flash_nobody_esp');
  }
}

/** Lets the chip run what it has. @param {Transport} transport */
async function restartChip(transport) {
  await transport.setDTR(false);
  await transport.setRTS(true);
  await pause(RESET_PULSE_MS);
  await transport.setRTS(false);
}

/** @param {string} text @returns {string} its letters in hexadecimal */
function hexOfLetters(text) {
  return [...text].map((letter) => letter.charCodeAt(0).toString(16)).join('');
}
