// MD5, with which the chips that `esp32.js` writes to say what is in their flash. It protects nothing.

const TURNS = [[7, 12, 17, 22], [5, 9, 14, 20], [4, 11, 16, 23], [6, 10, 15, 21]];
const ADDED = Array.from({ length: 64 }, (_, k) => Math.floor(2 ** 32 * Math.abs(Math.sin(k + 1))) | 0);
/** Which word of a block a step takes, for each round. */
const TAKEN = [(/** @type {number} */ k) => k, (/** @type {number} */ k) => 5 * k + 1, (/** @type {number} */ k) => 3 * k + 5, (/** @type {number} */ k) => 7 * k];
/** @type {((b: number, c: number, d: number) => number)[]} */
const MIXED = [(b, c, d) => (b & c) | (~b & d), (b, c, d) => (b & d) | (c & ~d), (b, c, d) => b ^ c ^ d, (b, c, d) => c ^ (b | ~d)];

/** @param {Uint8Array} data @returns {string} in hexadecimal */
export function md5(data) {
  const whole = new DataView(new ArrayBuffer((((data.length + 8) >> 6) + 1) * 64));
  new Uint8Array(whole.buffer).set(data);
  whole.setUint8(data.length, 0x80);
  whole.setUint32(whole.byteLength - 8, data.length * 8, true);
  whole.setUint32(whole.byteLength - 4, Math.floor(data.length / 2 ** 29), true);
  let sum = [0x67452301, 0xefcdab89 | 0, 0x98badcfe | 0, 0x10325476];
  for (let at = 0; at < whole.byteLength; at += 64) {
    let [a = 0, b = 0, c = 0, d = 0] = sum;
    for (let k = 0; k < 64; k += 1) {
      const round = k >> 4;
      const word = whole.getUint32(at + 4 * ((TAKEN[round]?.(k) ?? 0) % 16), true);
      const mixed = (a + (MIXED[round]?.(b, c, d) ?? 0) + (ADDED[k] ?? 0) + word) | 0;
      const turn = TURNS[round]?.[k % 4] ?? 0;
      [a, b, c, d] = [d, (b + ((mixed << turn) | (mixed >>> (32 - turn)))) | 0, b, c];
    }
    sum = [a, b, c, d].map((each, k) => (each + (sum[k] ?? 0)) | 0);
  }
  const digest = new DataView(new ArrayBuffer(16));
  sum.forEach((each, k) => digest.setInt32(4 * k, each, true));
  return [...new Uint8Array(digest.buffer)].map((each) => each.toString(16).padStart(2, '0')).join('');
}
