// Reads a firmware file, an Intel HEX file, as avr-objcopy writes it.

const DATA = 0;
const END = 1;
const SEGMENT = 2; // and LINEAR: where the next rows go; a small chip's is always 0
const LINEAR = 4;
const STARTS = [3, 5]; // where a program begins: not for this chip

/** The file is damaged, or is none. */
export class BadHex extends Error {}

/**
 * Returns the bytes from address 0 on; gaps are 0xff, as in an empty flash. Throws BadHex.
 * @param {string} text
 * @param {number} most bytes
 * @returns {Uint8Array}
 */
export function readHex(text, most) {
  const data = new Uint8Array(most).fill(0xff);
  let bytes = 0;
  let hasEnd = false;
  for (const row of text.split(/\s+/).filter(Boolean)) {
    if (hasEnd || !/^:(?:[0-9A-Fa-f]{2}){5,260}$/.test(row)) throw new BadHex();
    const found = Uint8Array.from(row.slice(1).match(/../g) ?? [], (pair) => parseInt(pair, 16));
    const [count = 0, high = 0, low = 0, kind = 0] = found;
    const sum = found.reduce((all, byte) => (all + byte) & 0xff, 0);
    const content = found.subarray(4, -1);
    if (sum !== 0 || content.length !== count) throw new BadHex();
    const at = high * 256 + low;
    if (kind === DATA) {
      if (at + count > most) throw new BadHex();
      data.set(content, at);
      bytes = Math.max(bytes, at + count);
    } else if (kind === END) hasEnd = true;
    else if (kind === SEGMENT || kind === LINEAR) {
      if (content.some((byte) => byte !== 0)) throw new BadHex();
    } else if (!STARTS.includes(kind)) throw new BadHex();
  }
  if (!hasEnd || !bytes) throw new BadHex();
  return data.subarray(0, bytes);
}
