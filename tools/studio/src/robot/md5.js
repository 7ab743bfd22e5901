// MD5, with which the chips that `esp32.js` writes to say what is in their flash. It protects nothing.

const ROTATIONS = [[7, 12, 17, 22], [5, 9, 14, 20], [4, 11, 16, 23], [6, 10, 15, 21]];
const ROUND_CONSTANTS = Array.from({ length: 64 }, (_, k) => Math.floor(2 ** 32 * Math.abs(Math.sin(k + 1))) | 0);
/** Which word of a block a step takes, for each round. */
const WORD_INDEXES = [(/** @type {number} */ k) => k, (/** @type {number} */ k) => 5 * k + 1, (/** @type {number} */ k) => 3 * k + 5, (/** @type {number} */ k) => 7 * k];
/** @type {((b: number, c: number, d: number) => number)[]} */
const MIXERS = [(b, c, d) => (b & c) | (~b & d), (b, c, d) => (b & d) | (c & ~d), (b, c, d) => b ^ c ^ d, (b, c, d) => c ^ (b | ~d)];

/** @param {Uint8Array} data @returns {string} in hexadecimal */
export function md5(data) {
  const paddedData = new DataView(new ArrayBuffer((((data.length + 8) >> 6) + 1) * 64));
  new Uint8Array(paddedData.buffer).set(data);
  paddedData.setUint8(data.length, 0x80);
  paddedData.setUint32(paddedData.byteLength - 8, data.length * 8, true);
  paddedData.setUint32(paddedData.byteLength - 4, Math.floor(data.length / 2 ** 29), true);
  let state = [0x67452301, 0xefcdab89 | 0, 0x98badcfe | 0, 0x10325476];
  for (let blockOffset = 0; blockOffset < paddedData.byteLength; blockOffset += 64) {
    let [a = 0, b = 0, c = 0, d = 0] = state;
    for (let step = 0; step < 64; step += 1) {
      const round = step >> 4;
      const word = paddedData.getUint32(blockOffset + 4 * ((WORD_INDEXES[round]?.(step) ?? 0) % 16), true);
      const mixedWord = (a + (MIXERS[round]?.(b, c, d) ?? 0) + (ROUND_CONSTANTS[step] ?? 0) + word) | 0;
      const rotation = ROTATIONS[round]?.[step % 4] ?? 0;
      [a, b, c, d] = [d, (b + ((mixedWord << rotation) | (mixedWord >>> (32 - rotation)))) | 0, b, c];
    }
    state = [a, b, c, d].map((word, k) => (word + (state[k] ?? 0)) | 0);
  }
  const digest = new DataView(new ArrayBuffer(16));
  state.forEach((word, k) => digest.setInt32(4 * k, word, true));
  return [...new Uint8Array(digest.buffer)].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}
