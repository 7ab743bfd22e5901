// What a block says, as words: for a sentence that names a block, and for who looks for one. Knows no Blockly.

import { COLOURS } from './colours.js';
import { devicesOf, KINDS, deviceName, blockLabel, REMOTE_DEVICES } from '../page/words.js';
import { pageState } from '../page/page_state.js';
import { hasText, text } from '../page/texts.js';

/** @typedef {import('./form.js').Value} Value */
/** @typedef {{kind: string, word: string, values: Value[]}} SpokenBlock a block; of a value one without a kind */
/** @typedef {{text: string, colour: string}} Label */

const GAP = '…';
/** Words whose block has another name. @type {Record<string, string>} */
const KIND_OF_WORD = { W: 'wait', M: 'motors', S: 'stop', FOREVER: 'endless' };
/** Words that are part of a block. @type {Record<string, string>} */
const COLOUR_OF_WORD = { ELSE: 'control', ELSEIF: 'control', CM: 'move', DEG: 'move' };

/** @param {string} name of a sensor or an actuator of the page's robot @returns {string} what it is called, or nothing */
function deviceLabel(name) {
  const robotName = pageState.robotName.value;
  const device = [...devicesOf(robotName, 'sensor'), ...REMOTE_DEVICES, ...devicesOf(robotName, 'actuator')].find(({ text }) => text === name);
  return device ? deviceName(device) : '';
}

/** @param {string} label in which %1 and so on are gaps @param {string[]} fillings of them @returns {string} */
function fillLabel(label, fillings) {
  return label.replace(/%(\d|%)/g, (_, gapNumber) => (gapNumber === '%' ? '%' : fillings[Number(gapNumber) - 1] ?? GAP)).replace(/\s+/g, ' ').trim();
}

/** @param {string} kind @param {string} word @param {string[] | null} values what is in its places; null for gaps @returns {Label} */
export function labelOfKind(kind, word, values) {
  const blockKind = KINDS[kind];
  if (!blockKind) return { text: '', colour: '' };
  const [wordAlone = '', unit = ''] = word.split(' ');
  const name = blockKind.words.length ? blockLabel(wordAlone) : blockKind.field ? deviceLabel(wordAlone) || wordAlone : '';
  const placeTexts = values ?? [];
  const fillings = Object.keys(blockKind.units).length ? [name, placeTexts[0] ?? GAP, blockLabel(unit || 'seconds'), ...placeTexts.slice(1)]
    : name ? [name, ...placeTexts] : placeTexts;
  const valueList = kind === 'call' || kind === 'def' ? ` ${placeTexts.join(', ')}` : '';
  return { text: fillLabel(blockLabel(kind), fillings) + valueList.trimEnd(), colour: COLOURS[blockKind.colour] ?? '' };
}

/** @param {Value} value @returns {Label} its parts are those of a stack machine */
function labelOfValue(value) {
  /** @type {Label[]} */
  const stack = [];
  for (const [operation, operand] of value) {
    const kind = kindOf(operation);
    const count = KINDS[kind]?.values.length ?? 0;
    const innerTexts = stack.splice(stack.length - count).map(({ text }) => text);
    stack.push(operation === 'NUMBER' ? { text: operand, colour: COLOURS['numbers'] ?? '' } : labelOfKind(kind, operand || operation, innerTexts));
  }
  return stack.pop() ?? { text: GAP, colour: '' };
}

/** @param {string} word of the language, or a part of an expression @returns {string} the kind of its block, or nothing */
function kindOf(word) {
  const match = Object.entries(KINDS).find(([name, { part, words }]) => part === word || words.includes(word) || name.toUpperCase() === word);
  return KIND_OF_WORD[word] ?? match?.[0] ?? '';
}

/** @param {SpokenBlock} block @returns {Label} */
export function labelOfBlock({ kind, word, values }) {
  const placeLabels = values.map((value) => labelOfValue(value));
  if (!kind) return placeLabels[0] ?? { text: '', colour: '' };
  return labelOfKind(kind === 'set' && !deviceLabel(word) ? 'call' : kind, word, placeLabels.map(({ text }) => text));
}

/**
 * @param {string} line of a text, an instruction with its values in brackets
 * @returns {string} what its block says, with gaps for values that are no numbers; nothing where no block has it
 */
export function labelOfLine(line) {
  const [, word = '', argumentText = ''] = /^(\w+)\s*(?:\((.*)\))?/.exec(line) ?? [];
  const wordKind = kindOf(word.toUpperCase()), isEndless = /^FOREVER$/i.test(argumentText.trim());
  const kind = wordKind === 'loop' && isEndless ? 'forever' : wordKind;
  if (!kind) return '';
  const argumentMatches = argumentText.split(',').map((part) => /^\s*(-?\d+(?:\.\d+)?)\s*(CM|DEG)?\s*$/i.exec(part));
  const unit = argumentMatches[0]?.[2]?.toUpperCase() ?? '';
  /** @type {Value[]} */
  const values = argumentMatches.map((match, index) => (match ? [['NUMBER', match[1] ?? '']] : index === 0 && /^\s*FOREVER\b/i.test(argumentText) ? [['FOREVER', '']] : []));
  return labelOfBlock({ kind, word: `${word.toUpperCase()} ${unit}`.trim(), values }).text;
}

/**
 * What somebody with blocks hears of a place in a program in place of its line, which nobody sees there.
 * @param {string} programText @param {{line: number, column: number}} place
 * @returns {string} what the block of the instruction there says; where no block has it, the instruction, and where there is none, the program
 */
export function labelAt(programText, { line, column }) {
  const lineText = programText.split('\n')[line - 1] ?? '';
  const start = Math.max(...[';', '|'].map((separator) => lineText.lastIndexOf(separator, Math.max(0, column - 2)))) + 1;
  const instruction = lineText.slice(start).replace(/;.*/, '').trim();
  return labelOfLine(instruction) || instruction || text('editor');
}

/**
 * Says something of a place in a program: of its block to who works with blocks, and else of its line.
 * @param {import('../page/texts.js').Key} lineKey @param {import('../page/texts.js').Key} blockKey
 * @param {string} programText @param {{line: number, column: number}} place @param {Record<string, string | number>} [values]
 * @returns {string}
 */
export function sentenceAtPlace(lineKey, blockKey, programText, place, values = {}) {
  return pageState.areBlocksNamed.value ? text(blockKey, { ...values, part: labelAt(programText, place) }) : text(lineKey, { ...values, line: place.line });
}

/** @param {string} word alone @returns {Label | null} what is on its block; null where it has none */
export function labelOfWord(word) {
  const device = deviceLabel(word);
  if (device) return { text: device, colour: COLOURS['sensors'] ?? '' };
  if (word === 'UNTIL') { // what a wait has more with it
    const waitUntilText = fillLabel(blockLabel('wait_until'), []), waitText = fillLabel(blockLabel('wait'), []);
    return waitUntilText.startsWith(waitText) ? { text: waitUntilText.slice(waitText.length).replace(/^[\s,]+/, ''), colour: COLOURS['time'] ?? '' } : null;
  }
  const colour = COLOUR_OF_WORD[word];
  if (colour) return { text: blockLabel(hasText(`block/${word.toLowerCase()}`) ? word.toLowerCase() : word).replace(/%1/, GAP), colour: COLOURS[colour] ?? '' };
  const kind = kindOf(word);
  if (!kind) return null;
  return KINDS[kind]?.words.includes(word) ? { text: blockLabel(word), colour: COLOURS[KINDS[kind]?.colour ?? ''] ?? '' } : labelOfKind(kind, '', null);
}

/**
 * What is on the block that a code in a sentence is.
 * @param {string} code @param {Record<string, SpokenBlock>} spokenBlocks what each code but a word alone is
 * @returns {Label | null} null where no block has it
 */
export function labelOfCode(code, spokenBlocks) {
  const spokenBlock = spokenBlocks[code];
  if (!spokenBlock) return labelOfWord(code);
  const { text: labelText, colour } = labelOfBlock(spokenBlock);
  const namesAsWritten = code.match(/[\p{Ll}_]{2,}/gu) ?? []; // those that a sentence has in small letters
  return { text: namesAsWritten.reduce((text, name) => text.replace(name.toUpperCase(), name), labelText), colour };
}

/** What the compiler says, as this person works with the program. @param {import('../python.js').Finding} finding @returns {{message: string, fix: string}} */
export function findingAsSeen(finding) {
  return pageState.areBlocksNamed.value ? findingOnBlocks(finding) : finding;
}

/**
 * What the compiler says, for who sees blocks: its code is named as its blocks are.
 * @param {import('../python.js').Finding} finding @returns {{message: string, fix: string}}
 */
export function findingOnBlocks({ on_blocks: { message, fix, spoken } }) {
  const [namedMessage = '', namedFix = ''] = [message, fix].map((sentence) => sentence.replace(/`([^`]+)`/g, (_, code) => {
    const label = labelOfCode(code, spoken);
    return label ? `“${label.text}”` : code;
  }));
  return { message: namedMessage, fix: namedFix };
}
