// A serial port that the browser opens: a cable, or Bluetooth with a serial port.

import { ConnectionFailure, pause, withTimeout } from './transport.js';

const SERIAL = /** @type {any} */ (navigator).serial;
const RESET_PULSE_MS = 250; // so long a board's reset is held
const BOOT_PAUSE_MS = 50;
const WRITE_LIMIT_MS = 3000; // the longest write takes a tenth of it
const CLOSE_LIMIT_MS = 2000;
const SPP_UUID = '00001101-0000-1000-8000-00805f9b34fb';

export const hasSerial = SERIAL !== undefined;

/** Returns the ports that a person has allowed before. @returns {Promise<any[]>} */
export async function listKnownPorts() {
  try {
    return hasSerial ? await SERIAL.getPorts() : [];
  } catch {
    return []; // forbidden here
  }
}

/** Lets a person choose a port; rejects with a ConnectionFailure. */
export async function choosePort() {
  try {
    return await SERIAL.requestPort({ allowedBluetoothServiceClassIds: [SPP_UUID] });
  } catch (error) {
    throw new ConnectionFailure(/** @type {Error} */ (error).name === 'SecurityError' ? 'port_forbidden' : 'not_chosen');
  }
}

export class SerialPort {
  lossReason = 'port_gone';
  #port;
  #baud;
  /** @type {any} */
  #reader = null;
  /** @type {any} */
  #writer = null;
  #isClosing = false;
  #isStuck = false; // it takes no bytes any more
  /** @type {Promise<void>} */
  #readLoop = Promise.resolve();

  /** @param {any} port @param {number} baud */
  constructor(port, baud) {
    this.#port = port;
    this.#baud = baud;
  }

  get isRadio() {
    return this.#port.getInfo().bluetoothServiceClassId !== undefined;
  }

  /** @param {(data: Uint8Array) => void} onData @param {() => void} onDisconnect */
  async open(onData, onDisconnect) {
    try {
      await this.#port.open({ baudRate: this.#baud, bufferSize: 4096 });
    } catch (error) {
      const { name } = /** @type {Error} */ (error);
      throw new ConnectionFailure(name === 'InvalidStateError' ? 'port_busy' : name === 'NetworkError' ? 'port_broken' : 'port_forbidden');
    }
    this.#writer = this.#port.writable.getWriter();
    this.#readLoop = this.#readUntilClosed(onData).then(() => {
      if (!this.#isClosing) onDisconnect();
    });
  }

  /** Restarts a board, as the wires of a cable can, and waits until its bootloader listens. */
  async reset() {
    await this.#setControlLines(false);
    await pause(RESET_PULSE_MS);
    await this.#setControlLines(true);
    await pause(BOOT_PAUSE_MS);
  }

  /** @param {boolean} isOn */
  async #setControlLines(isOn) {
    try {
      await this.#port.setSignals({ dataTerminalReady: isOn, requestToSend: isOn });
    } catch {
      // it has none: opening it has restarted the board, or a hand must
    }
  }

  /** Reads until the port is closed or gone. @param {(data: Uint8Array) => void} onData */
  async #readUntilClosed(onData) {
    while (this.#port.readable && !this.#isClosing) {
      this.#reader = this.#port.readable.getReader();
      try {
        for (;;) {
          const { value, done } = await this.#reader.read();
          if (done) break;
          onData(value);
        }
      } catch {
        // A framing error: the next reader goes on after it. After the end there is none.
      } finally {
        this.#reader.releaseLock();
      }
    }
  }

  /** @param {Uint8Array} data */
  async write(data) {
    try {
      await withTimeout(WRITE_LIMIT_MS, this.#writer.write(data), 'port_stuck');
    } catch (error) {
      this.#isStuck ||= error instanceof ConnectionFailure;
      throw error;
    }
  }

  async close() {
    this.#isClosing = true;
    try {
      await withTimeout(CLOSE_LIMIT_MS, Promise.all([this.#reader?.cancel(), this.#readLoop]), 'port_stuck');
    } catch {
      // it has gone
    }
    try {
      await withTimeout(CLOSE_LIMIT_MS, this.#isStuck ? this.#writer?.abort() : this.#writer?.close(), 'port_stuck');
    } catch {
      this.#writer?.releaseLock();
    }
    await withTimeout(CLOSE_LIMIT_MS, this.#port.close(), 'port_stuck');
  }
}
