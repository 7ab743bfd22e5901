// Reads a firmware file, an Intel HEX file, as avr-objcopy writes it.

const DATA_RECORD = 0;
const END_RECORD = 1;
const SEGMENT_RECORD = 2; // and LINEAR: where the next rows go; a small chip's is always 0
const LINEAR_RECORD = 4;
const START_RECORDS = [3, 5]; // where a program begins: not for this chip

/** The file is damaged, or is none. */
export class BadHex extends Error {}

/**
 * Returns the bytes from address 0 on; gaps are 0xff, as in an empty flash. Throws BadHex.
 * @param {string} text
 * @param {number} mostBytes bytes
 * @returns {Uint8Array}
 */
export function readHex(text, mostBytes) {
  const data = new Uint8Array(mostBytes).fill(0xff);
  let byteCount = 0;
  let hasEnd = false;
  for (const record of text.split(/\s+/).filter(Boolean)) {
    if (hasEnd || !/^:(?:[0-9A-Fa-f]{2}){5,260}$/.test(record)) throw new BadHex();
    const recordBytes = Uint8Array.from(record.slice(1).match(/../g) ?? [], (pair) => parseInt(pair, 16));
    const [count = 0, high = 0, low = 0, recordType = 0] = recordBytes;
    const checksum = recordBytes.reduce((total, byte) => (total + byte) & 0xff, 0);
    const content = recordBytes.subarray(4, -1);
    if (checksum !== 0 || content.length !== count) throw new BadHex();
    const address = high * 256 + low;
    if (recordType === DATA_RECORD) {
      if (address + count > mostBytes) throw new BadHex();
      data.set(content, address);
      byteCount = Math.max(byteCount, address + count);
    } else if (recordType === END_RECORD) hasEnd = true;
    else if (recordType === SEGMENT_RECORD || recordType === LINEAR_RECORD) {
      if (content.some((byte) => byte !== 0)) throw new BadHex();
    } else if (!START_RECORDS.includes(recordType)) throw new BadHex();
  }
  if (!hasEnd || !byteCount) throw new BadHex();
  return data.subarray(0, byteCount);
}
