// Tones: the keys of a piano, and how many hertz each has. Knows no page.

const A4 = { hertz: 440, key: 69 }; // keys are counted as MIDI does
export const OCTAVE = 12;
export const WHITE_KEYS = [0, 2, 4, 5, 7, 9, 11]; // of an octave, from C
export const LOWEST_KEY = 36, HIGHEST_KEY = 96; // C2 and C7: what a buzzer does well, and a child still hears as a tone

/** @param {number} key @returns {number} hertz, as the block has them */
export function hertzOfKey(key) {
  return Math.round(A4.hertz * 2 ** ((key - A4.key) / OCTAVE));
}

/** @param {number} hertz @returns {number} the key that is nearest, of those that there are */
export function keyOfHertz(hertz) {
  return clampKey(Math.round(A4.key + OCTAVE * Math.log2(Math.max(1, hertz) / A4.hertz)));
}

/** @param {number} hertz @param {number} direction 1 or -1 @returns {number} the next key there */
export function nextKeyFrom(hertz, direction) {
  const key = keyOfHertz(hertz), isPast = direction * (hertzOfKey(key) - hertz) > 0;
  return clampKey(isPast ? key : key + direction);
}

/** @param {number} key @param {string[]} names of the seven notes from C on @returns {string} */
export function keyName(key, names) {
  const step = key % OCTAVE, whiteIndex = WHITE_KEYS.findLastIndex((whiteStep) => whiteStep <= step);
  return `${names[whiteIndex]}${WHITE_KEYS[whiteIndex] === step ? '' : '♯'}`;
}

/** @param {number} key */
function clampKey(key) {
  return Math.min(HIGHEST_KEY, Math.max(LOWEST_KEY, key));
}
