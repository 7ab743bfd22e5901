// A serial port that the browser opens: a cable, or Bluetooth with a serial port.

import { Failed, pause, within } from './transport.js';

const SERIAL = /** @type {any} */ (navigator).serial;
const LOW_MS = 250; // so long a board's reset is held
const AFTER_MS = 50;
const WRITE_MS = 3000; // the longest write takes a tenth of it
const CLOSE_MS = 2000;
const SPP = '00001101-0000-1000-8000-00805f9b34fb';

export const hasSerial = SERIAL !== undefined;

/** Returns the ports that a person has allowed before. @returns {Promise<any[]>} */
export async function knownPorts() {
  try {
    return hasSerial ? await SERIAL.getPorts() : [];
  } catch {
    return []; // forbidden here
  }
}

/** Lets a person choose a port; rejects with a Failed. */
export async function chosenPort() {
  try {
    return await SERIAL.requestPort({ allowedBluetoothServiceClassIds: [SPP] });
  } catch (why) {
    throw new Failed(/** @type {Error} */ (why).name === 'SecurityError' ? 'port_forbidden' : 'not_chosen');
  }
}

export class SerialPort {
  goneBy = 'port_gone';
  #port;
  #baud;
  /** @type {any} */
  #reader = null;
  /** @type {any} */
  #writer = null;
  #isClosing = false;
  #isStuck = false; // it takes no bytes any more
  /** @type {Promise<void>} */
  #reading = Promise.resolve();

  /** @param {any} port @param {number} baud */
  constructor(port, baud) {
    this.#port = port;
    this.#baud = baud;
  }

  get isRadio() {
    return this.#port.getInfo().bluetoothServiceClassId !== undefined;
  }

  /** @param {(data: Uint8Array) => void} heard @param {() => void} gone */
  async open(heard, gone) {
    try {
      await this.#port.open({ baudRate: this.#baud, bufferSize: 4096 });
    } catch (why) {
      const { name } = /** @type {Error} */ (why);
      throw new Failed(name === 'InvalidStateError' ? 'port_busy' : name === 'NetworkError' ? 'port_broken' : 'port_forbidden');
    }
    this.#writer = this.#port.writable.getWriter();
    this.#reading = this.#read(heard).then(() => {
      if (!this.#isClosing) gone();
    });
  }

  /** Restarts a board, as the wires of a cable can, and waits until its bootloader listens. */
  async reset() {
    await this.#wires(false);
    await pause(LOW_MS);
    await this.#wires(true);
    await pause(AFTER_MS);
  }

  /** @param {boolean} isOn */
  async #wires(isOn) {
    try {
      await this.#port.setSignals({ dataTerminalReady: isOn, requestToSend: isOn });
    } catch {
      // it has none: opening it has restarted the board, or a hand must
    }
  }

  /** Reads until the port is closed or gone. @param {(data: Uint8Array) => void} heard */
  async #read(heard) {
    while (this.#port.readable && !this.#isClosing) {
      this.#reader = this.#port.readable.getReader();
      try {
        for (;;) {
          const { value, done } = await this.#reader.read();
          if (done) break;
          heard(value);
        }
      } catch {
        // A framing error: there is a new reader after it. After the end there is none.
      } finally {
        this.#reader.releaseLock();
      }
    }
  }

  /** @param {Uint8Array} data */
  async write(data) {
    try {
      await within(WRITE_MS, this.#writer.write(data), 'port_stuck');
    } catch (why) {
      this.#isStuck ||= why instanceof Failed;
      throw why;
    }
  }

  async close() {
    this.#isClosing = true;
    try {
      await within(CLOSE_MS, Promise.all([this.#reader?.cancel(), this.#reading]), 'port_stuck');
    } catch {
      // it has gone
    }
    try {
      await within(CLOSE_MS, this.#isStuck ? this.#writer?.abort() : this.#writer?.close(), 'port_stuck');
    } catch {
      this.#writer?.releaseLock();
    }
    await within(CLOSE_MS, this.#port.close(), 'port_stuck');
  }
}
