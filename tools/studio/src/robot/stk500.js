// Writes a firmware through a board's bootloader, reads it back and compares. Optiboot and the old
// Nano's bootloader speak the same: STK500, version 1. Knows no page and no browser.

import { Failed } from './transport.js';

/**
 * The cable. `open` opens it and `reset` restarts the board, whose bootloader then listens for a second.
 * @typedef {object} Cable
 * @property {(heard: (data: Uint8Array) => void, gone: () => void) => Promise<void>} open rejects with a Failed
 * @property {() => Promise<void>} reset
 * @property {(data: Uint8Array) => Promise<void>} write
 * @property {() => Promise<void>} close
 */

/** @typedef {{baud: number, room: number}} Bootloader bits per second, and bytes of flash before it */

/** Which a Nano has cannot be seen from outside. @type {Record<string, Bootloader[]>} */
export const BOARDS = {
  uno: [{ baud: 115_200, room: 0x7e00 }],
  nano: [{ baud: 115_200, room: 0x7e00 }, { baud: 57_600, room: 0x7800 }],
};

const SYNC = 0x30;
const ENTER = 0x50;
const LEAVE = 0x51;
const ADDRESS = 0x55;
const WRITE = 0x64;
const READ = 0x74;
const SIGNATURE = 0x75;
const FLASH = 0x46;
const END = 0x20;
const IN_SYNC = 0x14;
const OK = 0x10;

const CHIP = '1e950f'; // an ATmega328P
const PAGE = 128; // bytes
const TRIES = 8;
const SYNC_MS = 250;
const ANSWER_MS = 1000;

/**
 * Writes a firmware through the first bootloader that answers; rejects with a Failed.
 * @param {(baud: number) => Cable} cable
 * @param {Bootloader[]} bootloaders
 * @param {Uint8Array} firmware
 * @param {(part: number) => void} progress from 0 to 1
 * @param {AbortSignal} [cancelled] somebody wants it no more
 */
export async function flash(cable, bootloaders, firmware, progress, cancelled) {
  for (const [k, { baud, room }] of bootloaders.entries()) {
    const board = new Board(cable(baud), cancelled);
    try {
      await board.open();
      if (!(await board.meets())) {
        if (k + 1 < bootloaders.length) continue;
        throw new Failed('flash_nobody');
      }
      if (firmware.length > room) throw new Failed('flash_large');
      await board.write(firmware, progress);
      return;
    } finally {
      await board.close();
    }
  }
}

class Board {
  #cable;
  /** @type {number[]} */
  #came = [];
  #isGone = false;
  #isWriting = false;
  /** @type {() => void} */
  #wake = () => {};

  #cancelled;

  /** @param {Cable} cable @param {AbortSignal} [cancelled] */
  constructor(cable, cancelled) {
    this.#cable = cable;
    this.#cancelled = cancelled;
  }

  async open() {
    await this.#cable.open(
      (data) => {
        for (const byte of data) this.#came.push(byte);
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
  async meets() {
    for (let k = 0; k < TRIES; k += 1) {
      this.#came = []; // the start of a sketch, or an answer that came late
      if (!(await this.#ask([SYNC], 0, SYNC_MS))) continue;
      while (await this.#hears(1, SYNC_MS / 5)) this.#came = []; // those to earlier tries
      const signature = await this.#ask([SIGNATURE], 3, ANSWER_MS);
      if (!signature) continue;
      if (hex(signature) !== CHIP) throw new Failed('flash_other_chip');
      return true;
    }
    return false;
  }

  /** @param {Uint8Array} firmware @param {(part: number) => void} progress */
  async write(firmware, progress) {
    this.#isWriting = true;
    const whole = new Uint8Array(Math.ceil(firmware.length / PAGE) * PAGE).fill(0xff);
    whole.set(firmware);
    await this.#must([ENTER], 0);
    for (let at = 0; at < whole.length; at += PAGE) {
      await this.#goTo(at);
      await this.#must([WRITE, 0, PAGE, FLASH, ...whole.subarray(at, at + PAGE)], 0);
      progress((at + PAGE) / whole.length / 2);
    }
    for (let at = 0; at < whole.length; at += PAGE) {
      await this.#goTo(at);
      const page = await this.#must([READ, 0, PAGE, FLASH], PAGE);
      if (hex(page) !== hex(whole.subarray(at, at + PAGE))) throw new Failed('flash_differs');
      progress(0.5 + (at + PAGE) / whole.length / 2);
    }
    this.#cancelled = undefined; // it is written, whatever comes now
    await this.#ask([LEAVE], 0, ANSWER_MS);
  }

  /** @param {number} at in bytes; the bootloader counts words */
  #goTo(at) {
    return this.#must([ADDRESS, (at >> 1) & 0xff, at >> 9], 0);
  }

  /** @param {number[]} command @param {number} bytes of the answer */
  async #must(command, bytes) {
    const answer = await this.#ask(command, bytes, ANSWER_MS);
    if (!answer) throw new Failed('flash_broken_off');
    return answer;
  }

  /**
   * Returns the answer's bytes, or null where there is none in time.
   * @param {number[]} command
   * @param {number} bytes
   * @param {number} limit_ms
   * @returns {Promise<Uint8Array | null>}
   */
  async #ask(command, bytes, limit_ms) {
    this.#heed();
    try {
      await this.#cable.write(Uint8Array.of(...command, END));
    } catch (why) {
      this.#heed();
      if (why instanceof Failed && !this.#isWriting) throw why;
      this.#isGone = true;
    }
    if (!(await this.#hears(bytes + 2, limit_ms))) {
      if (this.#isGone) throw new Failed(this.#isWriting ? 'flash_broken_off' : 'port_gone');
      return null;
    }
    const reply = this.#came.splice(0, bytes + 2);
    return reply[0] === IN_SYNC && reply.at(-1) === OK ? Uint8Array.from(reply.slice(1, -1)) : null;
  }

  #heed() {
    if (this.#cancelled?.aborted) throw new Failed(this.#isWriting ? 'flash_cancelled' : 'flash_not_begun');
  }

  /** Waits until so many bytes are there. @param {number} count @param {number} limit_ms */
  async #hears(count, limit_ms) {
    const end = Date.now() + limit_ms;
    while (this.#came.length < count && !this.#isGone) {
      const left = end - Date.now();
      if (left <= 0) break;
      await new Promise((resolve) => {
        const timer = setTimeout(resolve, left);
        this.#wake = () => {
          clearTimeout(timer);
          resolve(undefined);
        };
      });
    }
    return this.#came.length >= count;
  }
}

/** @param {Uint8Array} data */
function hex(data) {
  return [...data].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}
