// A robot that the browser reaches by Bluetooth LE: the Nordic UART service, or an HM-10's.

import { Failed, pause } from './transport.js';

const BLUETOOTH = /** @type {any} */ (navigator).bluetooth;
const NORDIC = '6e400001-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_IN = '6e400002-b5a3-f393-e0a9-e50e24dcca9e';
const NORDIC_OUT = '6e400003-b5a3-f393-e0a9-e50e24dcca9e';
const HM10 = 0xffe0;
const HM10_BOTH = 0xffe1;
const MOST = 20; // bytes in a write

export const hasBluetooth = BLUETOOTH !== undefined;

/** Lets a person choose a robot; rejects with a Failed. */
export async function chosenDevice() {
  try {
    return await BLUETOOTH.requestDevice({
      filters: [{ services: [NORDIC] }, { services: [HM10] }],
      optionalServices: [NORDIC, HM10],
    });
  } catch (why) {
    const { name, message } = /** @type {Error} */ (why);
    if (name === 'SecurityError') throw new Failed('port_forbidden');
    throw new Failed(/adapter|disabled|unavailable/i.test(message) ? 'radio_off' : 'not_chosen');
  }
}

export class BluetoothPort {
  isRadio = true;
  goneBy = 'radio_gone';
  #device;
  #baud;
  /** @type {any} */
  #in = null;
  #pauseMs = 0; // after a write
  #writing = Promise.resolve();
  #isClosing = false;

  /** @param {any} device @param {number} baud of the module's UART */
  constructor(device, baud) {
    this.#device = device;
    this.#baud = baud;
  }

  /** @param {(data: Uint8Array) => void} heard @param {() => void} gone */
  async open(heard, gone) {
    this.#device.addEventListener('gattserverdisconnected', () => {
      if (!this.#isClosing) gone();
    });
    let out;
    try {
      const server = await this.#device.gatt.connect();
      const service = await this.#service(server);
      this.#in = service.in;
      out = service.out;
      // An HM-10 loses bytes that come faster than its UART passes them on.
      if (service.isSlow) this.#pauseMs = Math.ceil((MOST * 10_000) / this.#baud);
      out.addEventListener('characteristicvaluechanged', (/** @type {any} */ event) => {
        const { value } = event.target;
        heard(new Uint8Array(value.buffer, value.byteOffset, value.byteLength));
      });
      await out.startNotifications();
    } catch (why) {
      if (why instanceof Failed) throw why;
      throw new Failed(/** @type {Error} */ (why).name === 'NetworkError' ? 'link_silent' : 'radio_broken');
    }
  }

  /** @param {any} server */
  async #service(server) {
    try {
      const service = await server.getPrimaryService(NORDIC);
      return {
        in: await service.getCharacteristic(NORDIC_IN),
        out: await service.getCharacteristic(NORDIC_OUT),
        isSlow: false,
      };
    } catch (why) {
      if (/** @type {Error} */ (why).name !== 'NotFoundError') throw why;
    }
    try {
      const both = await (await server.getPrimaryService(HM10)).getCharacteristic(HM10_BOTH);
      return { in: both, out: both, isSlow: true };
    } catch (why) {
      if (/** @type {Error} */ (why).name === 'NotFoundError') throw new Failed('no_robot');
      throw why;
    }
  }

  /** Writes after what is being written. @param {Uint8Array} data @returns {Promise<void>} */
  write(data) {
    const done = this.#writing.then(() => this.#write(data));
    this.#writing = done.catch(() => {});
    return done;
  }

  /** @param {Uint8Array} data */
  async #write(data) {
    for (let at = 0; at < data.length; at += MOST) {
      const piece = data.slice(at, at + MOST);
      if (this.#in.properties.writeWithoutResponse) await this.#in.writeValueWithoutResponse(piece);
      else await this.#in.writeValueWithResponse(piece);
      if (this.#pauseMs) await pause(this.#pauseMs);
    }
  }

  async close() {
    this.#isClosing = true;
    await this.#writing;
    this.#device.gatt.disconnect();
  }
}
