// The words of the language and of each robot, for colors and completion. The table is
// `description.json`, which is made from the compiler's own.

import blocks from '../../made/blocks.json';
import description from '../../made/description.json';
import { pageState } from './page_state.js';
import { called, hasText, known, text } from './texts.js';

/** @typedef {{text: string, role: string, example: string}} Word */

export const ROBOTS = description.robots;
export const MOST_PARAMETERS = description.most_parameters;

/** Letters that are no words of the language. */
export const LETTERS = [...'ABCDEFGHIJKLMNOPQRSTUVWXYZ'].filter((each) => !description.words.some((word) => word.text === each));

/** @param {string} name */
export function robotOf(name) {
  return ROBOTS.find((each) => each.name === name);
}

/** What a remote control says to every robot: read as sensors are. */
export const REMOTE = description.remote;

/** @param {string} robot @param {string} role `sensor` or `actuator` */
export function devicesOf(robot, role) {
  return robotOf(robot)?.devices.filter((device) => device.role === role) ?? [];
}

export const CLASS = description.class;
export const WORLDS = /** @type {import('../world/parts.js').World[]} */ (/** @type {unknown} */ (description.worlds));
export const WORLD_LIMITS = description.world_limits;
export const LINK = description.link;

/** @type {Map<string, Map<string, Word>>} */
const WORDS = new Map(
  ROBOTS.map((robot) => [
    robot.name,
    new Map(
      [...description.words, ...REMOTE, ...robot.devices].map((word) => [word.text, /** @type {Word} */ (word)]),
    ),
  ]),
);

/** @param {string} label with a word of the text: of `{IF} if %1` the rest, or `IF %1` @returns {string} */
export function labelled(label) {
  return pageState.areWordsShown.value ? label.replace(/\{(\S+)\} (\1\b ?)?/i, '$1 ').trim() : label.replace(/\{\S+\} /, '');
}

/** @param {typeof ROBOTS[number]['devices'][number]} device @returns {string} */
export function nameOf(device) {
  return labelled(`{${device.text}} ${called(device.labels)}`);
}

/** @typedef {'number' | 'truth' | 'any'} Place what a value there is */
/** @typedef {{colour: string, words: string[], values: Place[], units: Record<string, string>, bodies: number, is_hat: boolean, gives: '' | Place, part: string, is_each_word: boolean, field: '' | 'name' | 'line' | 'sensor' | 'actuator'}} Kind */

export const KINDS = /** @type {Record<string, Kind>} */ (blocks.kinds);
/** @type {Record<string, string>} */
const SAYS = blocks.says;

const SETS = new Map(REMOTE.map(({ text: name }) => [name, name.split('_')[0] ?? '']));

/**
 * What a block is to who looks for it: its kind, and its word if each has its own. A set of keys is one; `block_kinds.py`
 * says the same.
 * @param {string} kind @param {string} word @returns {string}
 */
export function pieceOf(kind, word) {
  const name = word.split(' ')[0] ?? '';
  return KINDS[kind]?.is_each_word ? `${kind} ${SETS.get(name) ?? name}` : kind;
}

/** @param {number} count of values @returns {string} the kind of the words that have none of their own, as `block_kinds.py` calls it */
export const plainKind = (count) => (count ? `plain_${count}` : 'plain');
export const PLAIN = description.words.filter(({ text: word, arguments: values }) => KINDS[plainKind(values.length)]?.words.includes(word));

/** @param {string} name of a kind of block, or of what may be chosen @returns {string} its words; `%1` and so on are where values go */
export function onBlock(name) {
  const key = `block/${name}`;
  return labelled(hasText(key) ? text(key) : SAYS[name] ?? '');
}

/** @param {string} name of a kind of block, or of what may be chosen @returns {string[]} the words of the text that stand on it */
export function writtenOn(name) {
  const key = `block/${name}`;
  return [...(hasText(key) ? text(known(key)) : SAYS[name] ?? '').matchAll(/\{(\S+?)\}/g)].map(([, word]) => word ?? '');
}

/** @param {string} name of a kind of block @returns {string} what it does, said when a pointer rests on it, or nothing */
export function tipOf(name) {
  const key = `tip/${name}`;
  return hasText(key) ? text(key) : '';
}

/**
 * @param {string} robot
 * @returns {Map<string, Word>}
 */
export function wordsOf(robot) {
  return WORDS.get(robot) ?? new Map();
}

/**
 * @param {string} robot
 * @returns {boolean}
 */
export function isRobot(robot) {
  return WORDS.has(robot);
}
