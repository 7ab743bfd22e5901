// A robot that the browser reaches by Bluetooth LE: the Nordic UART service, or an HM-10's.

import { ConnectionFailure, pause } from './transport.js';

const BLUETOOTH = /** @type {any} */ (navigator).bluetooth;
const NORDIC_SERVICE = '6e400001-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_WRITE = '6e400002-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_NOTIFY = '6e400003-b5a3-f393-e0a9-e50e24dcca9e';
const HM10_SERVICE = 0xffe0;
const HM10_CHARACTERISTIC = 0xffe1;
const MAX_WRITE_BYTES = 20; // bytes in a write

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
  lossReason = 'radio_gone';
  #device;
  #baud;
  /** @type {any} */
  #writeCharacteristic = null;
  #writePause_ms = 0; // after a write
  #lastWrite = Promise.resolve();
  #isClosing = false;

  /** @param {any} device @param {number} baud of the module's UART */
  constructor(device, baud) {
    this.#device = device;
    this.#baud = baud;
  }

  /** @param {(data: Uint8Array) => void} onData @param {() => void} onDisconnect */
  async open(onData, onDisconnect) {
    this.#device.addEventListener('gattserverdisconnected', () => {
      if (!this.#isClosing) onDisconnect();
    });
    let notifyCharacteristic;
    try {
      const server = await this.#device.gatt.connect();
      const characteristics = await this.#findCharacteristics(server);
      this.#writeCharacteristic = characteristics.in;
      notifyCharacteristic = characteristics.out;
      // An HM-10 loses bytes that come faster than its UART passes them on.
      if (characteristics.isSlow) this.#writePause_ms = Math.ceil((MAX_WRITE_BYTES * 10_000) / this.#baud);
      notifyCharacteristic.addEventListener('characteristicvaluechanged', (/** @type {any} */ event) => {
        const { value } = event.target;
        onData(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
      });
      await notifyCharacteristic.startNotifications();
    } catch (error) {
      if (error instanceof ConnectionFailure) throw error;
      throw new ConnectionFailure(/** @type {Error} */ (error).name === 'NetworkError' ? 'link_silent' : 'radio_broken');
    }
  }

  /** @param {any} server */
  async #findCharacteristics(server) {
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
    const newWrite = this.#lastWrite.then(() => this.#writeChunks(data));
    this.#lastWrite = newWrite.catch(() => {});
    return newWrite;
  }

  /** @param {Uint8Array} data */
  async #writeChunks(data) {
    for (let offset = 0; offset < data.length; offset += MAX_WRITE_BYTES) {
      const chunk = data.slice(offset, offset + MAX_WRITE_BYTES);
      if (this.#writeCharacteristic.properties.writeWithoutResponse) await this.#writeCharacteristic.writeValueWithoutResponse(chunk);
      else await this.#writeCharacteristic.writeValueWithResponse(chunk);
      if (this.#writePause_ms) await pause(this.#writePause_ms);
    }
  }

  async close() {
    this.#isClosing = true;
    await this.#lastWrite;
    this.#device.gatt.disconnect();
  }
}
