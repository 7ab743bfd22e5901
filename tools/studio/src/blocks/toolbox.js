// What can be dragged out: for beginners, as usual, and everything. The words of the robot are in
// it, and the names that the program has. A group is short enough to be seen at once.

import { devices } from './shapes.js';
import { known, text } from '../page/texts.js';
import { FIXED } from '../page/words.js';

/** @typedef {'few' | 'usual' | 'all'} Level */
/** @typedef {{kind: 'block', type: string, fields?: object, inputs?: object, extraState?: object}} Item */

export const LEVELS = /** @type {Level[]} */ (['few', 'usual', 'all']);

const MOST_NAMES = 6; // of a program, in a group

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

/** A question that a robot can answer, to put into an IF. */
function question() {
  const sensor = devices('sensor')[0];
  if (!sensor) return {};
  const block = { type: 'sensor', fields: { WORD: sensor.text } };
  return { V0: { block: sensor.is_yes_no ? block : { type: 'compare', fields: { WORD: 'LT' }, inputs: { V0: { block }, V1: number(20) } } } };
}

/** @param {string} type @param {object} [extraState] @returns {Item} */
function asking(type, extraState) {
  return { kind: 'block', type, inputs: question(), ...(extraState ? { extraState } : {}) };
}

/** @param {string} type @param {number[]} values @param {string} word @returns {Item} */
function until(type, values, word = '') {
  const made = item(type, values, word);
  return { ...made, inputs: { ...made.inputs, [`V${values.length}`]: /** @type {any} */ (question()).V0 } };
}

/**
 * @param {{names: string[], words: string[]}} used names of variables and of own words
 * @returns {[Level, string, [Level, Item][]][]}
 */
function groups(used) {
  const sensors = devices('sensor').map((device) => device.text);
  const actuators = devices('actuator');
  return [
    ['few', 'move', [
      ['few', item('move', [2, 80], 'F')], ['few', item('move', [2, 80], 'B')],
      ['few', item('move', [0.5, 60], 'L')], ['few', item('move', [0.5, 60], 'R')], ['few', item('stop')],
      ['usual', until('move_until', [5, 60], 'F')], ['all', item('motors', [50, 80])],
    ]],
    ['few', 'time', [
      ['few', item('wait', [1])], ['few', item('beep', [0.5, 440])], ['usual', item('show', [1])],
      ...FIXED.map((word) => /** @type {[Level, Item]} */ (['few', item('fixed', [], word.text)])),
      ['usual', until('wait_until', [5])], ['all', item('time')], ['all', item('endless')],
    ]],
    ['few', 'control', [
      ['few', item('loop', [3])], ['few', item('forever')], ['usual', asking('while')], ['usual', item('break')],
    ]],
    ['few', 'choose', [
      ['few', asking('if', { arms: 1, hasElse: false })], ['few', asking('if', { arms: 1, hasElse: true })],
    ]],
    ['few', 'sensors', [
      ...sensors.map((name) => /** @type {[Level, Item]} */ (['few', item('sensor', [], name)])),
      ...actuators.map((device) => /** @type {[Level, Item]} */ (['few', item('set', device.is_yes_no ? [] : [0], device.text)])),
      ...sensors.slice(0, 1).map((name) => /** @type {[Level, Item]} */ (['usual', item('read', [], name)])),
    ]],
    ['few', 'decide', [
      ['few', { ...item('compare', [1, 1]), fields: { WORD: 'LT' } }], ['usual', { ...item('logic'), fields: { WORD: 'AND' } }],
      ['usual', item('not')], ['usual', item('truth')],
    ]],
    ['usual', 'numbers', [
      ['usual', item('number')], ['usual', item('math', [1, 1])], ['usual', item('random', [1, 6])],
      ['all', item('round', [1, 0])], ['all', item('abs', [-1])], ['all', item('extreme', [1, 2])],
      ['all', item('negative', [1])], ['all', item('brackets', [1])],
    ]],
    ['usual', 'names', [
      ['usual', item('assign', [0], used.names[0] ?? 'X')],
      ...(used.names.length ? used.names.slice(0, MOST_NAMES) : ['X']).map((name) => /** @type {[Level, Item]} */ (['usual', item('name', [], name)])),
    ]],
    ['usual', 'words', [
      ['usual', item('def', [], 'HOP')],
      ...used.words.slice(0, MOST_NAMES).map((name) => /** @type {[Level, Item]} */ (['usual', item('call', [], name)])),
    ]],
    ['usual', 'others', [['usual', item('comment')], ['all', item('start')]]],
  ];
}

/**
 * @param {Level} level
 * @param {{names: string[], words: string[]}} used
 * @returns {any}
 */
export function toolbox(level, used) {
  const most = LEVELS.indexOf(level);
  const isShown = (/** @type {Level} */ each) => LEVELS.indexOf(each) <= most;
  return {
    kind: 'categoryToolbox',
    contents: groups(used).filter(([its]) => isShown(its)).map(([, name, items]) => ({
      kind: 'category',
      name: text(known(`group/${name}`)),
      categorystyle: name,
      cssConfig: { icon: `category ${name}` },
      contents: items.filter(([its]) => isShown(its)).map(([, each]) => ({ ...each, gap: 8 })),
    })),
  };
}
