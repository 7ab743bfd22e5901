// Tones: the keys of a piano, and how many hertz each has. Knows no page.

const A4 = { hertz: 440, key: 69 }; // keys are counted as MIDI does
export const OCTAVE = 12;
export const WHITE = [0, 2, 4, 5, 7, 9, 11]; // of an octave, from C
export const LOWEST = 36, HIGHEST = 96; // C2 and C7: what a buzzer does well, and a child still hears as a tone

/** @param {number} key @returns {number} hertz, as the block has them */
export function noteAt(key) {
  return Math.round(A4.hertz * 2 ** ((key - A4.key) / OCTAVE));
}

/** @param {number} hertz @returns {number} the key that is nearest, of those that there are */
export function keyAt(hertz) {
  return within(Math.round(A4.key + OCTAVE * Math.log2(Math.max(1, hertz) / A4.hertz)));
}

/** @param {number} hertz @param {number} way 1 or -1 @returns {number} the next key there */
export function stepFrom(hertz, way) {
  const key = keyAt(hertz), isPast = way * (noteAt(key) - hertz) > 0;
  return within(isPast ? key : key + way);
}

/** @param {number} key @param {string[]} names of the seven notes from C on @returns {string} */
export function nameOf(key, names) {
  const step = key % OCTAVE, white = WHITE.findLastIndex((each) => each <= step);
  return `${names[white]}${WHITE[white] === step ? '' : '♯'}`;
}

/** @param {number} key */
function within(key) {
  return Math.min(HIGHEST, Math.max(LOWEST, key));
}
