// The words on the blocks, in English and Spanish, from the table of `studio/block_kinds.py`.

import blocks from '../made/blocks.json';
import { currentLanguage } from './texts.js';
import { labelled } from './words.js';

/** `%1` and so on are where values go. */
export const BLOCK_TEXTS = /** @type {Record<string, string[]>} */ (blocks.labels);

/** What a block does, said when a pointer rests on it. */
export const TIPS = /** @type {Record<string, string[]>} */ (blocks.tips);

/** Names of the groups in the toolbox. @type {Record<string, string[]>} */
export const GROUPS = {
  move: ['Move', 'Moverse'],
  time: ['Wait, sound', 'Tiempo, sonido'],
  control: ['Repeat', 'Repetir'],
  choose: ['Decide', 'Decidir'],
  sensors: ['Robot', 'Robot'],
  decide: ['Compare', 'Comparar'],
  numbers: ['Numbers', 'Números'],
  names: ['Variables', 'Variables'],
  words: ['My words', 'Mis palabras'],
  others: ['Notes', 'Notas'],
};

/**
 * @param {Record<string, string[]>} table
 * @param {string} key
 * @returns {string}
 */
export function said(table, key) {
  const found = table[key];
  if (!found) throw new Error(`no text ${key}`);
  return labelled(found[currentLanguage() === 'en' ? 0 : 1] ?? '');
}
