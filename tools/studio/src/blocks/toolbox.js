// What can be dragged out: for beginners, as usual, and everything. The words of the robot are in
// it, the names that the program has, and for beginners what the open lesson speaks of, too. A group
// is short enough to be seen at once.

import { labelOf } from './said.js';
import { devices } from './shapes.js';
import { hasText, textKey, text } from '../page/texts.js';
import { KINDS, blockLabel, pieceOf, PLAIN_WORDS, plainKind, tipOf, wordsOnBlock } from '../page/words.js';

/** @typedef {'few' | 'usual' | 'all'} Level */
/** @typedef {{names: string[], words: [string, number][]}} Used names of variables, and own words with the count of their values */
/** @typedef {{kind: 'block', type: string, fields?: object, inputs?: object, extraState?: object}} Item */

export const LEVELS = /** @type {Level[]} */ (['few', 'usual', 'all']);

const MOST_NAMES = 6; // of a program, in a group
const AHEAD = 'DISTANCE'; // of a robot that looks ahead
const ASKED_REMOTE = ['KEY_A', 'PAD_Y']; // the field of each offers the others

/** @param {number} value */
function number(value) {
  return { shadow: { type: 'number', fields: { WORD: value } } };
}

/**
 * @param {string} type
 * @param {number[]} values
 * @param {string} [word]
 * @returns {Item}
 */
function item(type, values = [], word = '') {
  const inputs = Object.fromEntries(values.map((value, k) => [`V${k}`, number(value)]));
  return { kind: 'block', type, inputs, ...(word ? { fields: { WORD: word } } : {}) };
}

/** @param {typeof PLAIN_WORDS[number]} word @returns {Item} */
function plain({ text, arguments: values }) {
  return item(plainKind(values.length), values.map(({ sample }) => Number(sample)), text);
}

/** @param {string} name of a word of one's own @param {number} count of its values @returns {Item} */
function call(name, count) {
  return { ...item('call', Array(count).fill(1), name), ...(count ? { extraState: { count } } : {}) };
}

/** What a question asks: what is ahead of the robot, where it can tell. */
function asked() {
  const sensors = devices('sensor');
  return sensors.find((device) => device.text === AHEAD) ?? sensors[0];
}

/** A question that a robot can answer, to put into an IF. @param {string} [sign] between sensor and number */
function question(sign = 'LT') {
  const sensor = asked();
  if (!sensor) return {};
  const block = { type: 'sensor', fields: { WORD: sensor.text } };
  return { V0: { block: sensor.is_yes_no ? block : { type: 'compare', fields: { WORD: sign }, inputs: { V0: { block }, V1: number(20) } } } };
}

/** A comparison, where the robot has something to compare. */
function comparison() {
  const { block } = /** @type {any} */ (question()).V0 ?? {};
  return block?.type === 'compare' ? { kind: /** @type {const} */ ('block'), ...block } : { ...item('compare', [1, 1]), fields: { WORD: 'LT' } };
}

/** @param {string} type @param {object} [extraState] @returns {Item} */
function asking(type, extraState) {
  // A WHILE goes on until something is near.
  return { kind: 'block', type, inputs: question(type === 'while' ? 'GT' : 'LT'), ...(extraState ? { extraState } : {}) };
}

/** @param {string} type @param {number[]} values @param {string} word @returns {Item} */
function until(type, values, word = '') {
  const made = item(type, values, word);
  return { ...made, inputs: { ...made.inputs, [`V${values.length}`]: /** @type {any} */ (question()).V0 } };
}

/**
 * @param {Used} used
 * @returns {[string, [Level, Item][]][]} each group, and from which level on each block is in it
 */
function groups(used) {
  const sensors = devices('sensor').map((device) => device.text);
  const actuators = devices('actuator');
  const measured = asked();
  return [
    ['move', [
      ['few', item('move', [2, 80], 'F')], ['few', item('move', [2, 80], 'B')],
      ['few', item('move', [0.5, 60], 'L')], ['few', item('move', [0.5, 60], 'R')], ['few', item('stop')],
      ['usual', until('move_until', [5, 60], 'F')], ['all', item('motors', [50, 80])],
    ]],
    ['time', [
      ['few', item('wait', [1])], ['few', item('beep', [0.5, 440])], ['usual', item('show', [1])],
      ...PLAIN_WORDS.map((word) => /** @type {[Level, Item]} */ (['few', plain(word)])),
      ['usual', until('wait_until', [5])], ['all', item('time')], ['all', item('endless')],
    ]],
    ['control', [
      ['few', item('loop', [3])], ['few', item('forever')], ['usual', asking('while')], ['usual', item('break')],
    ]],
    ['choose', [
      ['few', asking('if', { arms: 1, hasElse: false })], ['few', asking('if', { arms: 1, hasElse: true })],
    ]],
    ['events', [['few', asking('when')], ['few', item('task')]]],
    ['sensors', [
      ...sensors.map((name) => /** @type {[Level, Item]} */ (['few', item('sensor', [], name)])),
      ...actuators.map((device) => /** @type {[Level, Item]} */ (['few', item('set', device.is_yes_no ? [] : [0], device.text)])),
      ...(measured ? [/** @type {[Level, Item]} */ (['usual', item('read', [], measured.text)])] : []),
      ...ASKED_REMOTE.map((name) => /** @type {[Level, Item]} */ (['usual', item('sensor', [], name)])),
    ]],
    ['decide', [
      ['few', comparison()], ['usual', { ...item('logic'), fields: { WORD: 'AND' } }],
      ['usual', item('not')], ['usual', item('truth')],
    ]],
    ['numbers', [
      ['usual', item('number')], ['usual', item('math', [1, 1])], ['usual', item('random', [1, 6])],
      ['all', item('round', [1, 0])], ['all', item('abs', [-1])], ['all', item('extreme', [1, 2])],
      ['all', item('negative', [1])], ['all', item('brackets', [1])],
    ]],
    ['names', [
      ['usual', item('assign', [0], used.names[0] ?? 'X')],
      ...(used.names.length ? used.names.slice(0, MOST_NAMES) : ['X']).map((name) => /** @type {[Level, Item]} */ (['usual', item('name', [], name)])),
    ]],
    ['words', [
      ['usual', item('def', [], 'HOP')],
      ...used.words.slice(0, MOST_NAMES).map(([name, count]) => /** @type {[Level, Item]} */ (['usual', call(name, count)])),
    ]],
    ['others', [['usual', item('comment')], ['all', item('start')]]],
  ];
}

/** @param {Item} each */
function wordOf(each) {
  return /** @type {{WORD?: string}} */ (each.fields ?? {}).WORD ?? '';
}

const MOST_FOUND = 8; // are seen at once

/** @param {string} said @returns {string} in small letters without accents */
function plainly(said) {
  return said.toLowerCase().normalize('NFD').replace(/[\u0300-\u036f]/g, '');
}

/** Where a word that somebody looks for may be, the best first; in no place of them a block is not found. */
const PLACES = 5;

/**
 * @param {string} words that somebody looks for
 * @param {Used} used
 * @returns {object[]} blocks whose label has them, or their word in the text, or what people call it, what is said of what they do, or their group
 */
export function found(words, used) {
  const wanted = plainly(words).split(/\s+/).filter(Boolean);
  const rows = groups(used).flatMap(([group, items]) => items.map(([, each]) => {
    const word = wordOf(each);
    const choices = word ? [] : (KINDS[each.type]?.words ?? []).map(blockLabel);
    const label = plainly([labelOf(each.type, word, null).said, word, each.type, ...choices].join(' '));
    const called = ` ${peopleSay(each.type, word)}`, tip = plainly(tipOf(each.type)), over = ` ${plainly(text(textKey(`group/${group}`)))}`;
    const ranks = wanted.map((part) => [label.startsWith(part), label.includes(part), called.includes(` ${part}`), tip.includes(part), over.includes(` ${part}`), true].indexOf(true));
    return { each, rank: Math.max(...ranks) };
  }));
  return rows.filter(({ rank }) => rank < PLACES).sort((a, b) => a.rank - b.rank).slice(0, MOST_FOUND).map(({ each }) => ({ ...each, gap: 8 }));
}

/** What people say for the words that a block stands for, by the lexicon of their language. @param {string} kind @param {string} word @returns {string} */
function peopleSay(kind, word) {
  const words = word ? [word] : KINDS[kind]?.words ?? [];
  const meant = [...words, ...[kind, ...words].flatMap((each) => wordsOnBlock(each)), ...words.some((each) => KINDS['move']?.units[each] === 'DEG') ? ['turn'] : []];
  return plainly(meant.map((each) => (hasText(`words/${each}`) ? text(textKey(`words/${each}`)) : '')).join(' '));
}

/**
 * @param {string[]} kinds of blocks
 * @param {Used} used
 * @returns {Level} the lowest one that offers them all
 */
export function levelOf(kinds, used) {
  const rows = groups(used).flatMap(([, items]) => items);
  const least = kinds.flatMap((kind) => {
    const levels = rows.filter(([, { type }]) => type === kind).map(([level]) => LEVELS.indexOf(level));
    return levels.length ? Math.min(...levels) : [];
  });
  return LEVELS[Math.max(0, ...least)] ?? 'few';
}

/**
 * @param {Level} level
 * @param {Used} used
 * @param {string[]} taught kinds of blocks that lessons have spoken of
 * @param {string[]} fresh blocks that glow, as `pieceOf` has them
 * @returns {any}
 */
export function toolbox(level, used, taught, fresh) {
  const most = LEVELS.indexOf(level);
  const isShown = (/** @type {[Level, Item]} */ [from, { type }]) => LEVELS.indexOf(from) <= most || taught.includes(type);
  const shown = groups(used).map(([name, items]) => /** @type {const} */ ([name, items.filter(isShown)]));
  return {
    kind: 'categoryToolbox',
    contents: shown.filter(([, items]) => items.length).map(([name, items]) => ({
      kind: 'category',
      name: text(textKey(`group/${name}`)),
      categorystyle: name,
      cssConfig: { icon: `category ${name}`, row: `blocklyToolboxCategory${items.some(([, each]) => fresh.includes(pieceOf(each.type, wordOf(each)))) ? ' fresh' : ''}` },
      contents: items.map(([, each]) => ({ ...each, gap: 8 })),
    })),
  };
}
