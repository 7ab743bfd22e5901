// What a block says, as words: for a sentence that names a block, and for who looks for one. Knows no Blockly.

import { COLOURS } from './colours.js';
import { devicesOf, KINDS, deviceName, blockLabel, REMOTE } from '../page/words.js';
import { pageState } from '../page/page_state.js';
import { hasText } from '../page/texts.js';

/** @typedef {import('./form.js').Value} Value */
/** @typedef {{kind: string, word: string, values: Value[]}} Spoken a block; of a value one without a kind */
/** @typedef {{said: string, colour: string}} Label */

const GAP = '…';
/** Words whose block has another name. @type {Record<string, string>} */
const KIND_OF_WORD = { W: 'wait', M: 'motors', S: 'stop', FOREVER: 'endless' };
/** Words that are part of a block. @type {Record<string, string>} */
const COLOUR_OF_WORD = { ELSE: 'control', ELSEIF: 'control', CM: 'move', DEG: 'move' };

/** @param {string} name of a sensor or an actuator of the page's robot @returns {string} what it is called, or nothing */
function deviceCalled(name) {
  const robot = pageState.robotName.value;
  const device = [...devicesOf(robot, 'sensor'), ...REMOTE, ...devicesOf(robot, 'actuator')].find(({ text }) => text === name);
  return device ? deviceName(device) : '';
}

/** @param {string} label in which %1 and so on are gaps @param {string[]} fillings of them @returns {string} */
function filled(label, fillings) {
  return label.replace(/%(\d|%)/g, (_, which) => (which === '%' ? '%' : fillings[Number(which) - 1] ?? GAP)).replace(/\s+/g, ' ').trim();
}

/** @param {string} kind @param {string} word @param {string[] | null} values what is in its places; null for gaps @returns {Label} */
export function labelOf(kind, word, values) {
  const shape = KINDS[kind];
  if (!shape) return { said: '', colour: '' };
  const [plain = '', unit = ''] = word.split(' ');
  const name = shape.words.length ? blockLabel(plain) : shape.field ? deviceCalled(plain) || plain : '';
  const places = values ?? [];
  const fillings = Object.keys(shape.units).length ? [name, places[0] ?? GAP, blockLabel(unit || 'seconds'), ...places.slice(1)]
    : name ? [name, ...places] : places;
  const more = kind === 'call' || kind === 'def' ? ` ${places.join(', ')}` : '';
  return { said: filled(blockLabel(kind), fillings) + more.trimEnd(), colour: COLOURS[shape.colour] ?? '' };
}

/** @param {Value} value @returns {Label} its parts are those of a stack machine */
function labelOfValue(value) {
  /** @type {Label[]} */
  const stack = [];
  for (const [op, text] of value) {
    const kind = kindOf(op);
    const count = KINDS[kind]?.values.length ?? 0;
    const inner = stack.splice(stack.length - count).map(({ said }) => said);
    stack.push(op === 'NUMBER' ? { said: text, colour: COLOURS['numbers'] ?? '' } : labelOf(kind, text || op, inner));
  }
  return stack.pop() ?? { said: GAP, colour: '' };
}

/** @param {string} word of the language, or a part of an expression @returns {string} the kind of its block, or nothing */
function kindOf(word) {
  const found = Object.entries(KINDS).find(([name, { part, words }]) => part === word || words.includes(word) || name.toUpperCase() === word);
  return KIND_OF_WORD[word] ?? found?.[0] ?? '';
}

/** @param {Spoken} block @returns {Label} */
export function labelOfBlock({ kind, word, values }) {
  const places = values.map((value) => labelOfValue(value));
  if (!kind) return places[0] ?? { said: '', colour: '' };
  return labelOf(kind === 'set' && !deviceCalled(word) ? 'call' : kind, word, places.map(({ said }) => said));
}

/**
 * @param {string} line of a text, an instruction with its values in brackets
 * @returns {string} what its block says, with gaps for values that are no numbers; nothing where no block has it
 */
export function labelOfLine(line) {
  const [, word = '', inside = ''] = /^(\w+)\s*(?:\((.*)\))?/.exec(line) ?? [];
  const found = kindOf(word.toUpperCase()), isEndless = /^FOREVER$/i.test(inside.trim());
  const kind = found === 'loop' && isEndless ? 'forever' : found;
  if (!kind) return '';
  const parts = inside.split(',').map((part) => /^\s*(-?\d+(?:\.\d+)?)\s*(CM|DEG)?\s*$/i.exec(part));
  const unit = parts[0]?.[2]?.toUpperCase() ?? '';
  /** @type {Value[]} */
  const values = parts.map((part, k) => (part ? [['NUMBER', part[1] ?? '']] : k === 0 && /^\s*FOREVER\b/i.test(inside) ? [['FOREVER', '']] : []));
  return labelOfBlock({ kind, word: `${word.toUpperCase()} ${unit}`.trim(), values }).said;
}

/** @param {string} word alone @returns {Label | null} what is on its block; null where it has none */
export function labelOfWord(word) {
  const device = deviceCalled(word);
  if (device) return { said: device, colour: COLOURS['sensors'] ?? '' };
  if (word === 'UNTIL') { // what a wait has more with it
    const whole = filled(blockLabel('wait_until'), []), alone = filled(blockLabel('wait'), []);
    return whole.startsWith(alone) ? { said: whole.slice(alone.length).replace(/^[\s,]+/, ''), colour: COLOURS['time'] ?? '' } : null;
  }
  const colour = COLOUR_OF_WORD[word];
  if (colour) return { said: blockLabel(hasText(`block/${word.toLowerCase()}`) ? word.toLowerCase() : word).replace(/%1/, GAP), colour: COLOURS[colour] ?? '' };
  const kind = kindOf(word);
  if (!kind) return null;
  return KINDS[kind]?.words.includes(word) ? { said: blockLabel(word), colour: COLOURS[KINDS[kind]?.colour ?? ''] ?? '' } : labelOf(kind, '', null);
}
