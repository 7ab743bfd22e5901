// A robot that the browser reaches by Bluetooth LE: the Nordic UART service, or an HM-10's.

import { ConnectionFailure, pause } from './transport.js';

const BLUETOOTH = /** @type {any} */ (navigator).bluetooth;
const NORDIC_SERVICE = '6e400001-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_WRITE = '6e400002-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_NOTIFY = '6e400003-b5a3-f393-e0a9-e50e24dcca9e';
const HM10_SERVICE = 0xffe0;
const HM10_CHARACTERISTIC = 0xffe1;
const MOST_WRITE_BYTES = 20; // bytes in a write

export const hasBluetooth = BLUETOOTH !== undefined;

/** Lets a person choose a robot; rejects with a ConnectionFailure. */
export async function chooseDevice() {
  try {
    return await BLUETOOTH.requestDevice({
      filters: [{ services: [NORDIC_SERVICE] }, { services: [HM10_SERVICE] }],
      optionalServices: [NORDIC_SERVICE, HM10_SERVICE],
    });
  } catch (error) {
    const { name, message } = /** @type {Error} */ (error);
    if (name === 'SecurityError') throw new ConnectionFailure('port_forbidden');
    throw new ConnectionFailure(/adapter|disabled|unavailable/i.test(message) ? 'radio_off' : 'not_chosen');
  }
}

export class BluetoothPort {
  isRadio = true;
  goneBy = 'radio_gone';
  #device;
  #baud;
  /** @type {any} */
  #input = null;
  #pause_ms = 0; // after a write
  #lastWrite = Promise.resolve();
  #isClosing = false;

  /** @param {any} device @param {number} baud of the module's UART */
  constructor(device, baud) {
    this.#device = device;
    this.#baud = baud;
  }

  /** @param {(data: Uint8Array) => void} onData @param {() => void} onGone */
  async open(onData, onGone) {
    this.#device.addEventListener('gattserverdisconnected', () => {
      if (!this.#isClosing) onGone();
    });
    let notifier;
    try {
      const server = await this.#device.gatt.connect();
      const service = await this.#findService(server);
      this.#input = service.in;
      notifier = service.out;
      // An HM-10 loses bytes that come faster than its UART passes them on.
      if (service.isSlow) this.#pause_ms = Math.ceil((MOST_WRITE_BYTES * 10_000) / this.#baud);
      notifier.addEventListener('characteristicvaluechanged', (/** @type {any} */ event) => {
        const { value } = event.target;
        onData(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
      });
      await notifier.startNotifications();
    } catch (error) {
      if (error instanceof ConnectionFailure) throw error;
      throw new ConnectionFailure(/** @type {Error} */ (error).name === 'NetworkError' ? 'link_silent' : 'radio_broken');
    }
  }

  /** @param {any} server */
  async #findService(server) {
    try {
      const service = await server.getPrimaryService(NORDIC_SERVICE);
      return {
        in: await service.getCharacteristic(NORDIC_WRITE),
        out: await service.getCharacteristic(NORDIC_NOTIFY),
        isSlow: false,
      };
    } catch (error) {
      if (/** @type {Error} */ (error).name !== 'NotFoundError') throw error;
    }
    try {
      const characteristic = await (await server.getPrimaryService(HM10_SERVICE)).getCharacteristic(HM10_CHARACTERISTIC);
      return { in: characteristic, out: characteristic, isSlow: true };
    } catch (error) {
      if (/** @type {Error} */ (error).name === 'NotFoundError') throw new ConnectionFailure('no_robot');
      throw error;
    }
  }

  /** Writes after what is being written. @param {Uint8Array} data @returns {Promise<void>} */
  write(data) {
    const write = this.#lastWrite.then(() => this.#write(data));
    this.#lastWrite = write.catch(() => {});
    return write;
  }

  /** @param {Uint8Array} data */
  async #write(data) {
    for (let offset = 0; offset < data.length; offset += MOST_WRITE_BYTES) {
      const chunk = data.slice(offset, offset + MOST_WRITE_BYTES);
      if (this.#input.properties.writeWithoutResponse) await this.#input.writeValueWithoutResponse(chunk);
      else await this.#input.writeValueWithResponse(chunk);
      if (this.#pause_ms) await pause(this.#pause_ms);
    }
  }

  async close() {
    this.#isClosing = true;
    await this.#lastWrite;
    this.#device.gatt.disconnect();
  }
}
