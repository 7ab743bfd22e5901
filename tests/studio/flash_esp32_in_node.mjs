// node flash_esp32_in_node.mjs SOURCES SIMULATOR: writes a firmware as the page does, onto the simulated ROM of
// an ESP32. Its input is JSON: {board, chip, firmware, cancelAt, ...}, the firmware in base64. Prints JSON: how it
// ended, whether the flash has the firmware, what was refused, and how many times the chip has started.

import crypto from 'node:crypto';
import fs from 'node:fs';
import { pathToFileURL } from 'node:url';
import zlib from 'node:zlib';

const [sources, simulator] = process.argv.slice(2);
const { board, firmware, cancelAt = 2, heldUntil = '', ...how } = JSON.parse(fs.readFileSync(0, 'utf8'));
await import(pathToFileURL(simulator).href);
const { flashEsp32 } = await import(pathToFileURL(`${sources}/robot/esp32.js`).href);
const { md5 } = await import(pathToFileURL(`${sources}/robot/md5.js`).href);
const sum = (data) => crypto.createHash('md5').update(data).digest('hex');
const wanted = new Uint8Array(Buffer.from(firmware, 'base64'));
const port = new globalThis.Esp32Rom({ ...how, sum, inflate: (data) => zlib.inflateSync(data) });
const cancelling = new AbortController();
if (cancelAt < 0) cancelling.abort();
if (heldUntil) { // the part of esptool-js for the chip never comes
  const { ESPLoader } = await import(pathToFileURL(`${sources}/../node_modules/esptool-js/lib/esploader.js`).href);
  const later = globalThis.setTimeout;
  ESPLoader.prototype.detectChip = () => {
    if (heldUntil === 'cancel') later(() => cancelling.abort(), 50);
    return new Promise(() => {});
  };
  if (heldUntil === 'end') globalThis.setTimeout = (act, ms, ...more) => later(act, ms / 400, ...more);
}
let ended = 'done';
let seen = 0;
try {
  await flashEsp32(port, board, wanted, (part) => {
    seen = part;
    if (part >= cancelAt) cancelling.abort();
  }, cancelling.signal);
} catch (error) {
  ended = error.reason ?? String(error.stack);
}
console.log(JSON.stringify({
  ended, seen, refused: port.refused, starts: port.starts, is_open: port.isOpen,
  is_there: Buffer.compare(port.flash.subarray(0, wanted.length), wanted) === 0,
  is_untouched: port.flash.every((byte) => byte === 0x5a),
  sums: [0, 1, 55, 56, 64, 1000].every((count) => md5(wanted.subarray(0, count)) === sum(wanted.subarray(0, count))),
}));
process.exit(0);
