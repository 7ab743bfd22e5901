// The words of the language and of each robot, for colors and completion. The table is
// `description.json`, which is made from the compiler's own.

import blocks from '../../made/blocks.json';
import description from '../../made/description.json';
import { pageState } from './page_state.js';
import { labelOf, hasText, textKey, text } from './texts.js';

/** @typedef {{text: string, role: string, example: string}} Word */

export const ROBOTS = description.robots;
export const MAX_PARAMETERS = description.most_parameters;

/** Letters that are no words of the language. */
export const FREE_LETTERS = [...'ABCDEFGHIJKLMNOPQRSTUVWXYZ'].filter((letter) => !description.words.some((word) => word.text === letter));

/** @param {string} name */
export function robotOf(name) {
  return ROBOTS.find((robot) => robot.name === name);
}

/** What a remote control says to every robot: read as sensors are. */
export const REMOTE_DEVICES = description.remote;

/** @param {string} robotName @param {string} role `sensor` or `actuator` */
export function devicesOf(robotName, role) {
  return robotOf(robotName)?.devices.filter((device) => device.role === role) ?? [];
}

export const CLASS = description.class;
export const WORLDS = /** @type {import('../world/parts.js').World[]} */ (/** @type {unknown} */ (description.worlds));
export const WORLD_LIMITS = description.world_limits;
export const LINK = description.link;
export const STARS = /** @type {{lessons: Record<string, number>, worlds: Record<string, number>}} */ (description.stars);

/** @type {Map<string, Map<string, Word>>} */
const WORDS = new Map(
  ROBOTS.map((robot) => [
    robot.name,
    new Map(
      [...description.words, ...REMOTE_DEVICES, ...robot.devices].map((word) => [word.text, /** @type {Word} */ (word)]),
    ),
  ]),
);

/** @param {string} label with a word of the text: of `{IF} if %1` the rest, or `IF %1` @returns {string} */
export function visibleLabel(label) {
  return pageState.areWordsShown.value ? label.replace(/\{(\S+)\} (\1\b ?)?/i, '$1 ').trim() : label.replace(/\{\S+\} /, '');
}

/** @param {typeof ROBOTS[number]['devices'][number]} device @returns {string} */
export function deviceName(device) {
  return visibleLabel(`{${device.text}} ${labelOf(device.labels)}`);
}

/** @typedef {'number' | 'truth' | 'any'} ValueKind what a value there is */
/** @typedef {{colour: string, words: string[], values: ValueKind[], units: Record<string, string>, bodies: number, is_hat: boolean, gives: '' | ValueKind, part: string, is_each_word: boolean, field: '' | 'name' | 'line' | 'sensor' | 'actuator'}} BlockKind */

export const KINDS = /** @type {Record<string, BlockKind>} */ (blocks.kinds);
/** @type {Record<string, string>} */
const CHOICE_LABELS = blocks.says;

const KEY_SETS = new Map(REMOTE_DEVICES.map(({ text: name }) => [name, name.split('_')[0] ?? '']));

/**
 * What a block is to who looks for it: its kind, and its word if each has its own. A set of keys is one; `block_kinds.py`
 * says the same.
 * @param {string} kind @param {string} word @returns {string}
 */
export function pieceOf(kind, word) {
  const name = word.split(' ')[0] ?? '';
  return KINDS[kind]?.is_each_word ? `${kind} ${KEY_SETS.get(name) ?? name}` : kind;
}

/** @param {number} count of values @returns {string} the kind of the words that have none of their own, as `block_kinds.py` calls it */
export const plainKind = (count) => (count ? `plain_${count}` : 'plain');
export const PLAIN_WORDS = description.words.filter(({ text: word, arguments: values }) => KINDS[plainKind(values.length)]?.words.includes(word));

/** @param {string} name of a kind of block, or of what may be chosen @returns {string} its words; `%1` and so on are where values go */
export function blockLabel(name) {
  const key = `block/${name}`;
  return visibleLabel(hasText(key) ? text(key) : CHOICE_LABELS[name] ?? '');
}

/** @param {string} name of a kind of block, or of what may be chosen @returns {string[]} the words of the text that stand on it */
export function wordsOnBlock(name) {
  const key = `block/${name}`;
  return [...(hasText(key) ? text(textKey(key)) : CHOICE_LABELS[name] ?? '').matchAll(/\{(\S+?)\}/g)].map(([, word]) => word ?? '');
}

/** @param {string} name of a kind of block @returns {string} what it does, said when a pointer rests on it, or nothing */
export function tipOf(name) {
  const key = `tip/${name}`;
  return hasText(key) ? text(key) : '';
}

/**
 * @param {string} robotName
 * @returns {Map<string, Word>}
 */
export function wordsOf(robotName) {
  return WORDS.get(robotName) ?? new Map();
}

/**
 * @param {string} robotName
 * @returns {boolean}
 */
export function isRobot(robotName) {
  return WORDS.has(robotName);
}
