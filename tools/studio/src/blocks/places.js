// Which plain numbers may stand in which place of a block. The ranges are those of the compiler's
// table of words, and of the robot.

import description from '../../made/description.json';
import { devicesOf } from '../page/words.js';

/** @typedef {{low: number, high: number, sample: string}} NumberRange */

const ANY_RANGE = { low: -2147483.648, high: 2147483.647, sample: '1' };
/** @type {Map<string, NumberRange[]>} */
const ARGUMENT_RANGES = new Map(description.words.map((word) => [word.text, word.arguments]));
/** Of each role of an instruction its first word: a kind of block is named like it. @type {Map<string, string>} */
const FIRST_WORDS = new Map(description.words
  .filter((word) => word.arguments.length || ['stop', 'start'].includes(word.role))
  .map((word) => /** @type {[string, string]} */ ([word.role, word.text])).reverse());
/** @type {Map<string, NumberRange>} */
let actuatorRanges = new Map();

/** @param {string} robotName */
export function setActuators(robotName) {
  actuatorRanges = new Map(devicesOf(robotName, 'actuator').map((device) => [device.text, /** @type {NumberRange} */ (device.arguments[0])]));
}

/**
 * @param {string} kind
 * @returns {string} the word of a block that does not say it
 */
export function impliedWordOf(kind) {
  return FIRST_WORDS.get(kind.replace(/_until$/, '')) ?? '';
}

/**
 * @param {import('blockly/core').Block} block
 * @returns {string | undefined} the word on it, with its unit unless that is seconds: `F CM`
 */
export function wordOnBlock(block) {
  const word = block.getFieldValue('WORD') ?? undefined;
  const unit = /** @type {import('./fields.js').UnitField | null} */ (block.getField('UNIT'))?.textValue();
  return unit ? `${word} ${unit}` : word;
}

/**
 * @param {string} kind
 * @param {string} word
 * @param {number} index of the place
 * @returns {NumberRange}
 */
export function rangeOf(kind, word, index) {
  if (kind === 'set') return actuatorRanges.get(word) ?? ANY_RANGE;
  const range = ARGUMENT_RANGES.get(word || impliedWordOf(kind) || kind.toUpperCase())?.[index] ?? ANY_RANGE;
  return Number.isFinite(Number(range.sample)) ? range : { ...range, sample: '1' };
}

/**
 * @param {import('blockly/core').Block | null} block a number in a place of another block
 * @returns {NumberRange}
 */
export function rangeForNumber(block) {
  const parent = block?.getParent();
  const input = parent?.inputList.find((candidate) => candidate.connection?.targetBlock() === block);
  if (!parent || !input) return ANY_RANGE;
  const index = Number(input.name.slice(1));
  return rangeOf(parent.type, wordOnBlock(parent) ?? '', index);
}
