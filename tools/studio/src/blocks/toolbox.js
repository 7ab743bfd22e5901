// What can be dragged out: for beginners, as usual, and everything. The words of the robot are in
// it, the names that the program has, and for beginners what the open lesson speaks of, too. A group
// is short enough to be seen at once.

import { labelOfKind } from './said.js';
import { devicesOfRole } from './shapes.js';
import { hasText, textKey, text } from '../page/texts.js';
import { KINDS, blockLabel, pieceOf, PLAIN_WORDS, plainKind, tipOf, wordsOnBlock } from '../page/words.js';

/** @typedef {'few' | 'usual' | 'all'} Level */
/** @typedef {{names: string[], words: [string, number][]}} UsedNames names of variables, and own words with the count of their values */
/** @typedef {{kind: 'block', type: string, fields?: object, inputs?: object, extraState?: object}} ToolboxItem */

export const LEVELS = /** @type {Level[]} */ (['few', 'usual', 'all']);

const MAX_NAMES = 6; // of a program, in a group
const AHEAD_SENSOR = 'DISTANCE'; // of a robot that looks ahead
const OFFERED_REMOTE_WORDS = ['KEY_A', 'PAD_Y']; // the field of each offers the others

/** @param {number} value */
function makeNumberShadow(value) {
  return { shadow: { type: 'number', fields: { WORD: value } } };
}

/**
 * @param {string} type
 * @param {number[]} values
 * @param {string} [word]
 * @returns {ToolboxItem}
 */
function makeItem(type, values = [], word = '') {
  const inputs = Object.fromEntries(values.map((value, index) => [`V${index}`, makeNumberShadow(value)]));
  return { kind: 'block', type, inputs, ...(word ? { fields: { WORD: word } } : {}) };
}

/** @param {typeof PLAIN_WORDS[number]} word @returns {ToolboxItem} */
function makePlainWordItem({ text, arguments: values }) {
  return makeItem(plainKind(values.length), values.map(({ sample }) => Number(sample)), text);
}

/** @param {string} name of a word of one's own @param {number} count of its values @returns {ToolboxItem} */
function makeCallItem(name, count) {
  return { ...makeItem('call', Array(count).fill(1), name), ...(count ? { extraState: { count } } : {}) };
}

/** @param {UsedNames} usedNames @returns {string} a name for a new word, which the program does not have yet */
function freeWord({ names, words }) {
  const takenNames = new Set([...names, ...words.map(([name]) => name)]);
  const name = text('new_word');
  for (let number = 2, freeName = name; ; freeName = `${name}_${number}`, number += 1) if (!takenNames.has(freeName)) return freeName;
}

/** What a question asks: what is ahead of the robot, where it can tell. */
function sensorToAsk() {
  const sensors = devicesOfRole('sensor');
  return sensors.find((device) => device.text === AHEAD_SENSOR) ?? sensors[0];
}

/** A question that a robot can answer, to put into an IF. @param {string} [operator] between sensor and number */
function makeQuestionInputs(operator = 'LT') {
  const sensor = sensorToAsk();
  if (!sensor) return {};
  const block = { type: 'sensor', fields: { WORD: sensor.text } };
  return { V0: { block: sensor.is_yes_no ? block : { type: 'compare', fields: { WORD: operator }, inputs: { V0: { block }, V1: makeNumberShadow(20) } } } };
}

/** A comparison, where the robot has something to compare. */
function makeComparisonItem() {
  const { block } = /** @type {any} */ (makeQuestionInputs()).V0 ?? {};
  return block?.type === 'compare' ? { kind: /** @type {const} */ ('block'), ...block } : { ...makeItem('compare', [1, 1]), fields: { WORD: 'LT' } };
}

/** @param {string} type @param {object} [extraState] @returns {ToolboxItem} */
function makeQuestionItem(type, extraState) {
  // A WHILE goes on until something is near.
  return { kind: 'block', type, inputs: makeQuestionInputs(type === 'while' ? 'GT' : 'LT'), ...(extraState ? { extraState } : {}) };
}

/** @param {string} type @param {number[]} values @param {string} word @returns {ToolboxItem} */
function makeUntilItem(type, values, word = '') {
  const item = makeItem(type, values, word);
  return { ...item, inputs: { ...item.inputs, [`V${values.length}`]: /** @type {any} */ (makeQuestionInputs()).V0 } };
}

/**
 * @param {UsedNames} usedNames
 * @returns {[string, [Level, ToolboxItem][]][]} each group, and from which level on each block is in it
 */
function makeGroups(usedNames) {
  const sensors = devicesOfRole('sensor').map((device) => device.text);
  const actuators = devicesOfRole('actuator');
  const measuredSensor = sensorToAsk();
  return [
    ['move', [
      ['few', makeItem('move', [2, 80], 'F')], ['few', makeItem('move', [2, 80], 'B')],
      ['few', makeItem('move', [0.5, 60], 'L')], ['few', makeItem('move', [0.5, 60], 'R')], ['few', makeItem('stop')],
      ['usual', makeUntilItem('move_until', [5, 60], 'F')], ['all', makeItem('motors', [50, 80])],
    ]],
    ['time', [
      ['few', makeItem('wait', [1])], ['few', makeItem('beep', [0.5, 440])], ['usual', makeItem('show', [1])],
      ...PLAIN_WORDS.map((word) => /** @type {[Level, ToolboxItem]} */ (['few', makePlainWordItem(word)])),
      ['usual', makeUntilItem('wait_until', [5])], ['all', makeItem('time')], ['all', makeItem('endless')],
    ]],
    ['control', [
      ['few', makeItem('loop', [3])], ['few', makeItem('forever')], ['usual', makeQuestionItem('while')], ['usual', makeItem('break')],
    ]],
    ['choose', [
      ['few', makeQuestionItem('if', { arms: 1, hasElse: false })], ['few', makeQuestionItem('if', { arms: 1, hasElse: true })],
    ]],
    ['events', [['few', makeQuestionItem('when')], ['few', makeItem('task')]]],
    ['sensors', [
      ...sensors.map((name) => /** @type {[Level, ToolboxItem]} */ (['few', makeItem('sensor', [], name)])),
      ...actuators.map((device) => /** @type {[Level, ToolboxItem]} */ (['few', makeItem('set', device.is_yes_no ? [] : [0], device.text)])),
      ...(measuredSensor ? [/** @type {[Level, ToolboxItem]} */ (['usual', makeItem('read', [], measuredSensor.text)])] : []),
      ...OFFERED_REMOTE_WORDS.map((name) => /** @type {[Level, ToolboxItem]} */ (['usual', makeItem('sensor', [], name)])),
    ]],
    ['decide', [
      ['few', makeComparisonItem()], ['usual', { ...makeItem('logic'), fields: { WORD: 'AND' } }],
      ['usual', makeItem('not')], ['usual', makeItem('truth')],
    ]],
    ['numbers', [
      ['usual', makeItem('number')], ['usual', makeItem('math', [1, 1])], ['usual', makeItem('random', [1, 6])],
      ['all', makeItem('round', [1, 0])], ['all', makeItem('abs', [-1])], ['all', makeItem('extreme', [1, 2])],
      ['all', makeItem('negative', [1])], ['all', makeItem('brackets', [1])],
    ]],
    ['names', [
      ['usual', makeItem('assign', [0], usedNames.names[0] ?? 'X')],
      ...(usedNames.names.length ? usedNames.names.slice(0, MAX_NAMES) : ['X']).map((name) => /** @type {[Level, ToolboxItem]} */ (['usual', makeItem('name', [], name)])),
    ]],
    ['words', [
      ['usual', makeItem('def', [], freeWord(usedNames))],
      ...usedNames.words.slice(0, MAX_NAMES).map(([name, count]) => /** @type {[Level, ToolboxItem]} */ (['usual', makeCallItem(name, count)])),
    ]],
    ['others', [['usual', makeItem('comment')], ['all', makeItem('start')]]],
  ];
}

/** @param {ToolboxItem} item */
function wordOfItem(item) {
  return /** @type {{WORD?: string}} */ (item.fields ?? {}).WORD ?? '';
}

const MAX_RESULTS = 8; // are seen at once

/** @param {string} text @returns {string} in small letters without accents */
function withoutAccents(text) {
  return text.toLowerCase().normalize('NFD').replace(/[\u0300-\u036f]/g, '');
}

/** Where a word that somebody looks for may be, the best first; in no place of them a block is not found. */
const RANK_COUNT = 6;

/**
 * @param {string} query that somebody looks for
 * @param {UsedNames} usedNames
 * @returns {object[]} blocks whose label has them, or their word in the text, or what people call it, what is said of what they do, or their group
 */
export function findItems(query, usedNames) {
  const queryWords = withoutAccents(query).split(/\s+/).filter(Boolean);
  const rankedItems = makeGroups(usedNames).flatMap(([group, items]) => items.map(([, item]) => {
    const word = wordOfItem(item);
    const choiceLabels = word ? [] : (KINDS[item.type]?.words ?? []).map(blockLabel);
    const label = withoutAccents(` ${[labelOfKind(item.type, word, null).text, word, item.type, ...choiceLabels].join(' ')} `);
    const peopleWords = ` ${wordsOfPeople(item)}`, tipText = withoutAccents(tipOf(item.type)), groupText = ` ${withoutAccents(text(textKey(`group/${group}`)))}`;
    const ranks = queryWords.map((queryWord) => [
      label.includes(` ${queryWord} `), label.includes(` ${queryWord}`), peopleWords.includes(` ${queryWord}`), label.includes(queryWord),
      tipText.includes(queryWord), groupText.includes(` ${queryWord}`), true,
    ].indexOf(true));
    return { item, rank: Math.max(...ranks) };
  }));
  return rankedItems.filter(({ rank }) => rank < RANK_COUNT).sort((a, b) => a.rank - b.rank).slice(0, MAX_RESULTS).map(({ item }) => ({ ...item, gap: 8 }));
}

/** What people say for a block and for the words that it stands for, by the lexicon of their language. @param {ToolboxItem} item @returns {string} */
function wordsOfPeople(item) {
  const { type: kind } = item, word = wordOfItem(item), words = word ? [word] : KINDS[kind]?.words ?? [];
  const hasElse = /** @type {{hasElse?: boolean} | undefined} */ (item.extraState)?.hasElse;
  const meanings = [
    kind, kind.toUpperCase(), ...words, ...[kind, ...words].flatMap((blockName) => wordsOnBlock(blockName)), ...hasElse ? ['else', 'ELSE'] : [],
    ...words.some((blockWord) => KINDS['move']?.units[blockWord] === 'DEG') ? ['turn'] : [],
  ];
  return withoutAccents(meanings.map((meaning) => `${meaning} ${hasText(`words/${meaning}`) ? text(textKey(`words/${meaning}`)) : ''}`).join(' '));
}

/**
 * @param {string[]} kinds of blocks
 * @param {UsedNames} usedNames
 * @returns {Level} the lowest one that offers them all
 */
export function levelOf(kinds, usedNames) {
  const levelItems = makeGroups(usedNames).flatMap(([, items]) => items);
  const leastLevels = kinds.flatMap((kind) => {
    const levels = levelItems.filter(([, { type }]) => type === kind).map(([level]) => LEVELS.indexOf(level));
    return levels.length ? Math.min(...levels) : [];
  });
  return LEVELS[Math.max(0, ...leastLevels)] ?? 'few';
}

/**
 * @param {Level} level
 * @param {UsedNames} usedNames
 * @param {string[]} taughtKinds kinds of blocks that lessons have spoken of
 * @param {string[]} newPieces blocks that glow, as `pieceOf` has them
 * @returns {any}
 */
export function makeToolbox(level, usedNames, taughtKinds, newPieces) {
  const levelIndex = LEVELS.indexOf(level);
  const isShown = (/** @type {[Level, ToolboxItem]} */ [fromLevel, { type }]) => LEVELS.indexOf(fromLevel) <= levelIndex || taughtKinds.includes(type);
  const shownGroups = makeGroups(usedNames).map(([name, items]) => /** @type {const} */ ([name, items.filter(isShown)]));
  return {
    kind: 'categoryToolbox',
    contents: shownGroups.filter(([, items]) => items.length).map(([name, items]) => ({
      kind: 'category',
      name: text(textKey(`group/${name}`)),
      categorystyle: name,
      cssConfig: { icon: `category ${name}`, row: `blocklyToolboxCategory${items.some(([, item]) => newPieces.includes(pieceOf(item.type, wordOfItem(item)))) ? ' fresh' : ''}` },
      contents: items.map(([, item]) => ({ ...item, gap: 8 })),
    })),
  };
}
