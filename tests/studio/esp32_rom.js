// The bootloader in the ROM of an ESP32 behind a serial port of a browser, as
// https://docs.espressif.com/projects/esptool/en/latest/esp32/advanced-topics/serial-protocol.html
// has it: it answers only where the wires of the port have started it, and refuses what the ROM refuses.
// `inflate` is that of zlib, `sum` MD5 in hexadecimal; either may be late. A classic script: a page can have it, too.

const INVALID = 5, FAILED = 6, BAD_SUM = 7, BAD_FLASH = 8, BAD_DEFLATE = 0x0b; // errors of the ROM
const OP = { begin: 2, data: 3, end: 4, sync: 8, write: 9, read: 0x0a, attach: 0x0d, defl: 0x10, deflData: 0x11, deflEnd: 0x12, md5: 0x13, security: 0x14 };
const MAGIC_AT = 0x40001000;
const ROM_BLOCK = 0x400, SECTOR = 0x1000;

globalThis.Esp32Rom = class {
  flash = new Uint8Array(0x400000).fill(0x5a); // what was there before
  refused = [];
  starts = 0; // of what is in its flash
  isOpen = false;
  readable = null;
  writable = null;
  #isLoader = false;
  #signals = { dataTerminalReady: false, requestToSend: false };
  #came = [];
  #isIn = false;
  #isEscaped = false;
  #isAttached = false;
  #job = null; // what is written: {at, size, blocks, next, packed}
  #reading = null;

  /** @param {{chip?: string, inflate: any, sum: any, breaksAt?: number, isDeaf?: boolean, spoils?: boolean}} how */
  constructor(how) {
    this.how = { chip: 'esp32', ...how };
  }

  getInfo() {
    return { usbVendorId: 0x10c4, usbProductId: 0xea60 };
  }

  async open({ baudRate }) {
    if (this.isOpen) throw Object.assign(new Error('open'), { name: 'InvalidStateError' });
    this.isOpen = true;
    this.baud = baudRate;
    this.readable = new ReadableStream({ start: (reading) => { this.#reading = reading; }, cancel: () => { this.#reading = null; } });
    this.writable = new WritableStream({ write: (data) => { for (const byte of data) this.#onByte(byte); } });
  }

  async close() {
    if (this.readable?.locked || this.writable?.locked) throw new Error('locked');
    this.isOpen = false;
    this.readable = this.writable = null;
  }

  /** EN is low while RTS is on and DTR off, and GPIO0 is low while DTR is on and RTS off. */
  async setSignals(signals) {
    const before = this.#signals;
    this.#signals = { ...before, ...signals };
    const { dataTerminalReady: dtr, requestToSend: rts } = this.#signals;
    if (!(before.requestToSend && !before.dataTerminalReady) || (rts && !dtr)) return;
    this.#isLoader = dtr && !rts;
    this.#isAttached = false;
    this.#job = null;
    if (this.#isLoader) this.#say([...new TextEncoder().encode('rst:0x1 (POWERON_RESET),boot:0x3 (DOWNLOAD_BOOT)\r\nwaiting for download\r\n')]);
    else this.starts += 1;
  }

  #say(bytes) {
    this.#reading?.enqueue(Uint8Array.from(bytes));
  }

  /** SLIP: a packet is between two 0xc0. */
  #onByte(byte) {
    if (!this.#isLoader || this.how.isDeaf || this.baud !== 115200) return;
    if (byte === 0xc0) {
      if (this.#isIn && this.#came.length) this.#take(Uint8Array.from(this.#came));
      this.#isIn = !(this.#isIn && this.#came.length);
      this.#came = [];
    } else if (!this.#isIn) return;
    else if (byte === 0xdb) this.#isEscaped = true;
    else {
      this.#came.push(this.#isEscaped ? { 0xdc: 0xc0, 0xdd: 0xdb }[byte] : byte);
      this.#isEscaped = false;
    }
  }

  #answer(op, value, data, error) {
    const body = [...data, error ? 1 : 0, error, 0, 0];
    const packet = [1, op, body.length & 255, body.length >> 8, ...[0, 8, 16, 24].map((shift) => (value >>> shift) & 255), ...body];
    this.#say([0xc0, ...packet.flatMap((byte) => (byte === 0xc0 ? [0xdb, 0xdc] : byte === 0xdb ? [0xdb, 0xdd] : [byte])), 0xc0]);
  }

  async #take(packet) {
    const view = new DataView(packet.buffer);
    const [direction, op] = packet;
    const size = view.getUint16(2, true), said = view.getUint32(4, true);
    const data = packet.subarray(8);
    if (direction !== 0 || data.length !== size) return this.#refuse(op, INVALID);
    const word = (k) => new DataView(data.buffer, data.byteOffset).getUint32(4 * k, true);
    if (op === OP.sync) {
      if (data.length !== 36 || data[0] !== 7) return this.#refuse(op, INVALID);
      for (let k = 0; k < 8; k += 1) this.#answer(op, 0x20120707, [], 0);
    } else if (op === OP.read) {
      if (size !== 4) return this.#refuse(op, INVALID);
      this.#answer(op, word(0) === MAGIC_AT ? { esp32: 0x00f01d83, esp32c3: 0x6921506f, esp8266: 0xfff0c101 }[this.how.chip] : 0, [], 0);
    } else if (op === OP.security && this.how.chip === 'esp32c3') {
      this.#answer(op, 0, [0, 0, 0, 0, 0, ...Array(7).fill(0), 5, 0, 0, 0, 0, 0, 0, 0], 0);
    } else if (op === OP.attach) {
      if (size !== 8 && size !== 4) return this.#refuse(op, INVALID);
      this.#isAttached = true;
      this.#answer(op, 0, [], 0);
    } else if (op === OP.begin || op === OP.defl) this.#begin(op, size, word);
    else if (op === OP.data || op === OP.deflData) this.#write(op, data, word, said);
    else if (op === OP.md5) {
      if (size !== 16 || !this.#isAttached || word(0) + word(1) > this.flash.length) return this.#refuse(op, FAILED);
      this.#answer(op, 0, new TextEncoder().encode(await this.how.sum(this.flash.subarray(word(0), word(0) + word(1)))), 0);
    } else if (op === OP.write) this.#answer(op, 0, [], 0);
    else for (let k = 0; k < 8; k += 1) this.#refuse(0, INVALID); // a command that it does not know
  }

  #refuse(op, error) {
    this.refused.push([op, error]);
    this.#answer(op, 0, [], error);
  }

  #begin(op, size, word) {
    const words = this.how.chip === 'esp32' ? 4 : 5;
    if (size !== 4 * words) return this.#refuse(op, INVALID);
    const [bytes, blocks, block, at] = [0, 1, 2, 3].map(word);
    if (!this.#isAttached || at % SECTOR || at + bytes > this.flash.length || block > ROM_BLOCK) return this.#refuse(op, BAD_FLASH);
    this.flash.fill(0xff, at, Math.ceil((at + bytes) / SECTOR) * SECTOR);
    this.#job = { op: op + 1, at, bytes, blocks, next: 0, packed: [] };
    this.#answer(op, 0, [], 0);
  }

  async #write(op, data, word, said) {
    const job = this.#job;
    const part = data.subarray(16);
    if (!job || job.op !== op || part.length !== word(0) || part.length > ROM_BLOCK) return this.#refuse(op, INVALID);
    if (part.reduce((sum, byte) => sum ^ byte, 0xef) !== said) return this.#refuse(op, BAD_SUM);
    if (word(1) !== job.next || job.next >= job.blocks) return this.#refuse(op, FAILED);
    if (job.next === this.how.breaksAt) {
      this.#isLoader = false; // the cable is out
      return;
    }
    job.next += 1;
    job.packed.push(...part);
    if (job.next === job.blocks) {
      let whole;
      try {
        whole = op === OP.deflData ? await this.how.inflate(Uint8Array.from(job.packed)) : job.packed;
      } catch {
        return this.#refuse(op, BAD_DEFLATE);
      }
      if (whole.length > job.bytes) return this.#refuse(op, BAD_FLASH);
      this.flash.set(whole, job.at);
      if (this.how.spoils) this.flash[job.at + 77] ^= 1;
    }
    this.#answer(op, 0, [], 0);
  }
};
