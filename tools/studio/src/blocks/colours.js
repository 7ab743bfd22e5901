// The colour of each group of blocks.

// White letters have at least 4.5 times their contrast.
/** @type {Record<string, string>} */
export const COLOURS = {
  move: '#0b4f9e',
  time: '#00607a',
  control: '#8a3c00',
  choose: '#8a3c00',
  events: '#6f5b00',
  tasks: '#5d4037',
  sensors: '#0d6040',
  decide: '#3f5c12',
  numbers: '#6226b0',
  names: '#93185a',
  words: '#7a2e6e',
  others: '#57606a',
  stop: '#a8200f',
  grey: '#6b7078',
};
