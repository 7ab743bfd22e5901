// node flash_in_node.mjs SOURCES PTY BOARD HEX [PART]: writes a firmware as the page does, over a pty in the
// place of a cable. It is cancelled once PART of it is done, 0 to 1, or before it begins where that is
// negative. Prints how it ended: done, or the name of the failure.

import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import { pathToFileURL } from 'node:url';
import tty from 'node:tty';

const [sources, path, board, file, part = 'never'] = process.argv.slice(2);
const cancelling = new AbortController();
if (part < 0) cancelling.abort();
const of = (name) => import(pathToFileURL(`${sources}/robot/${name}`).href);
const { BOARDS, flash } = await of('stk500.js');
const { BadHex, readHex } = await of('intel_hex.js');

class Cable {
  #file = -1;
  #stream = null;

  constructor(baud) {
    this.baud = baud;
  }

  async open(onData, gone) {
    this.#file = fs.openSync(path, fs.constants.O_RDWR | fs.constants.O_NOCTTY);
    execFileSync('stty', ['raw', '-echo', String(this.baud)], { stdio: [this.#file, 'ignore', 'inherit'] });
    this.#stream = new tty.ReadStream(this.#file);
    this.#stream.on('data', onData);
    for (const name of ['end', 'error', 'close']) this.#stream.on(name, gone);
  }

  // Opening a pty restarts the simulated board.
  async reset() {
    await new Promise((resolve) => setTimeout(resolve, 300));
  }

  write(data) {
    return new Promise((resolve, reject) => {
      fs.write(this.#file, data, (error) => (error ? reject(error) : resolve()));
    });
  }

  async close() {
    this.#stream.destroy(); // it has opened the pty anew for itself
    fs.closeSync(this.#file);
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
}

try {
  const firmware = readHex(fs.readFileSync(file, 'utf8'), 0x8000);
  await flash((baud) => new Cable(baud), BOARDS[board], firmware, (done) => { if (done >= part) cancelling.abort(); }, cancelling.signal);
  console.log('done');
} catch (error) {
  console.log(error instanceof BadHex ? 'bad_file' : (error.reason ?? String(error)));
}
process.exit(0);
