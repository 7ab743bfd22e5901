// Writes a firmware through a board's bootloader, reads it back and compares. Optiboot and the old
// Nano's bootloader speak the same: STK500, version 1. Knows no page and no browser.

import { ConnectionFailure } from './transport.js';

/**
 * The cable. `open` opens it and `reset` restarts the board, whose bootloader then listens for a second.
 * @typedef {object} Cable
 * @property {(onData: (data: Uint8Array) => void, onDisconnect: () => void) => Promise<void>} open rejects with a ConnectionFailure
 * @property {() => Promise<void>} reset
 * @property {(data: Uint8Array) => Promise<void>} write
 * @property {() => Promise<void>} close
 */

/** @typedef {{baud: number, roomBytes: number}} Bootloader bits per second, and bytes of flash before it */

/** Which a Nano has cannot be seen from outside. @type {Record<string, Bootloader[]>} */
export const BOARDS = {
  uno: [{ baud: 115_200, roomBytes: 0x7e00 }],
  nano: [{ baud: 115_200, roomBytes: 0x7e00 }, { baud: 57_600, roomBytes: 0x7800 }],
};

const SYNC_COMMAND = 0x30;
const ENTER_COMMAND = 0x50;
const LEAVE_COMMAND = 0x51;
const ADDRESS_COMMAND = 0x55;
const WRITE_COMMAND = 0x64;
const READ_COMMAND = 0x74;
const SIGNATURE_COMMAND = 0x75;
const FLASH_MEMORY = 0x46;
const END_BYTE = 0x20;
const IN_SYNC_BYTE = 0x14;
const OK_BYTE = 0x10;

const CHIP_SIGNATURE = '1e950f'; // an ATmega328P
const PAGE_BYTES = 128; // bytes
const SYNC_TRIES = 8;
const SYNC_LIMIT_MS = 250;
const ANSWER_LIMIT_MS = 1000;

/**
 * Writes a firmware through the first bootloader that answers; rejects with a ConnectionFailure.
 * @param {(baud: number) => Cable} openCable
 * @param {Bootloader[]} bootloaders
 * @param {Uint8Array} firmware
 * @param {(fraction: number) => void} onProgress from 0 to 1
 * @param {AbortSignal} [cancelSignal] somebody wants it no more
 */
export async function flash(openCable, bootloaders, firmware, onProgress, cancelSignal) {
  for (const [index, { baud, roomBytes }] of bootloaders.entries()) {
    const board = new Board(openCable(baud), cancelSignal);
    try {
      await board.open();
      if (!(await board.detectBootloader())) {
        if (index + 1 < bootloaders.length) continue;
        throw new ConnectionFailure('flash_nobody');
      }
      if (firmware.length > roomBytes) throw new ConnectionFailure('flash_large');
      await board.write(firmware, onProgress);
      return;
    } finally {
      await board.close();
    }
  }
}

class Board {
  #cable;
  /** @type {number[]} */
  #receivedBytes = [];
  #isGone = false;
  #isWriting = false;
  /** @type {() => void} */
  #wake = () => {};

  #cancelSignal;

  /** @param {Cable} cable @param {AbortSignal} [cancelSignal] */
  constructor(cable, cancelSignal) {
    this.#cable = cable;
    this.#cancelSignal = cancelSignal;
  }

  async open() {
    await this.#cable.open(
      (data) => {
        for (const byte of data) this.#receivedBytes.push(byte);
        this.#wake();
      },
      () => {
        this.#isGone = true;
        this.#wake();
      },
    );
    await this.#cable.reset();
  }

  async close() {
    await this.#cable.close().catch(() => {}); // it has gone
  }

  /** Returns whether a bootloader answers; rejects if it is that of another chip. */
  async detectBootloader() {
    for (let tryNumber = 0; tryNumber < SYNC_TRIES; tryNumber += 1) {
      this.#receivedBytes = []; // the start of a sketch, or an answer that came late
      if (!(await this.#ask([SYNC_COMMAND], 0, SYNC_LIMIT_MS))) continue;
      while (await this.#waitForBytes(1, SYNC_LIMIT_MS / 5)) this.#receivedBytes = []; // those to earlier tries
      const signature = await this.#ask([SIGNATURE_COMMAND], 3, ANSWER_LIMIT_MS);
      if (!signature) continue;
      if (hexOf(signature) !== CHIP_SIGNATURE) throw new ConnectionFailure('flash_other_chip');
      return true;
    }
    return false;
  }

  /** @param {Uint8Array} firmware @param {(fraction: number) => void} onProgress */
  async write(firmware, onProgress) {
    this.#isWriting = true;
    const paddedFirmware = new Uint8Array(Math.ceil(firmware.length / PAGE_BYTES) * PAGE_BYTES).fill(0xff);
    paddedFirmware.set(firmware);
    await this.#request([ENTER_COMMAND], 0);
    for (let address = 0; address < paddedFirmware.length; address += PAGE_BYTES) {
      await this.#setAddress(address);
      await this.#request([WRITE_COMMAND, 0, PAGE_BYTES, FLASH_MEMORY, ...paddedFirmware.subarray(address, address + PAGE_BYTES)], 0);
      onProgress((address + PAGE_BYTES) / paddedFirmware.length / 2);
    }
    for (let address = 0; address < paddedFirmware.length; address += PAGE_BYTES) {
      await this.#setAddress(address);
      const page = await this.#request([READ_COMMAND, 0, PAGE_BYTES, FLASH_MEMORY], PAGE_BYTES);
      if (hexOf(page) !== hexOf(paddedFirmware.subarray(address, address + PAGE_BYTES))) throw new ConnectionFailure('flash_differs');
      onProgress(0.5 + (address + PAGE_BYTES) / paddedFirmware.length / 2);
    }
    this.#cancelSignal = undefined; // it is written, whatever comes now
    await this.#ask([LEAVE_COMMAND], 0, ANSWER_LIMIT_MS);
  }

  /** @param {number} address in bytes; the bootloader counts words */
  #setAddress(address) {
    return this.#request([ADDRESS_COMMAND, (address >> 1) & 0xff, address >> 9], 0);
  }

  /** @param {number[]} command @param {number} byteCount of the answer */
  async #request(command, byteCount) {
    const answer = await this.#ask(command, byteCount, ANSWER_LIMIT_MS);
    if (!answer) throw new ConnectionFailure('flash_broken_off');
    return answer;
  }

  /**
   * Returns the answer's bytes, or null where there is none in time.
   * @param {number[]} command
   * @param {number} byteCount
   * @param {number} limit_ms
   * @returns {Promise<Uint8Array | null>}
   */
  async #ask(command, byteCount, limit_ms) {
    this.#throwIfCancelled();
    try {
      await this.#cable.write(Uint8Array.of(...command, END_BYTE));
    } catch (error) {
      this.#throwIfCancelled();
      if (error instanceof ConnectionFailure && !this.#isWriting) throw error;
      this.#isGone = true;
    }
    if (!(await this.#waitForBytes(byteCount + 2, limit_ms))) {
      if (this.#isGone) throw new ConnectionFailure(this.#isWriting ? 'flash_broken_off' : 'port_gone');
      return null;
    }
    const reply = this.#receivedBytes.splice(0, byteCount + 2);
    return reply[0] === IN_SYNC_BYTE && reply.at(-1) === OK_BYTE ? Uint8Array.from(reply.slice(1, -1)) : null;
  }

  #throwIfCancelled() {
    if (this.#cancelSignal?.aborted) throw new ConnectionFailure(this.#isWriting ? 'flash_cancelled' : 'flash_not_begun');
  }

  /** Waits until so many bytes are there. @param {number} count @param {number} limit_ms */
  async #waitForBytes(count, limit_ms) {
    const deadline_ms = Date.now() + limit_ms;
    while (this.#receivedBytes.length < count && !this.#isGone) {
      const left_ms = deadline_ms - Date.now();
      if (left_ms <= 0) break;
      await new Promise((resolve) => {
        const timer = setTimeout(resolve, left_ms);
        this.#wake = () => {
          clearTimeout(timer);
          resolve(undefined);
        };
      });
    }
    return this.#receivedBytes.length >= count;
  }
}

/** @param {Uint8Array} data */
function hexOf(data) {
  return [...data].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}
