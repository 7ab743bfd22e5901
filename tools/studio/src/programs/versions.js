// Earlier programs, kept on this device: newest first, and no more than a device has room for.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { labelOfLine } from '../blocks/said.js';
import { pageState } from '../page/page_state.js';
import { text as said } from '../page/texts.js';
import { isRobot } from '../page/words.js';
import { storeText, storedJson } from '../page/kept.js';

/** @typedef {{text: string, robot: string, name: string, at_ms: number}} Version */

const PLACE = 'tiniscript.versions';
const MOST = 40;
export const MOST_CHARACTERS = 400_000; // in all; a browser keeps about five million

/** @returns {Version[]} */
export function versions() {
  const kept = storedJson(PLACE);
  return Array.isArray(kept) ? kept.filter(isVersion).slice(0, MOST) : [];
}

/**
 * Keeps a program before all others; it is there once, at the time when it was kept last. Where there
 * is no room the oldest go. Returns whether it is kept.
 * @param {{text: string, robot: string, name: string}} program
 * @param {number} [at_ms]
 * @returns {boolean}
 */
export function keepVersion({ text, robot, name }, at_ms = Date.now()) {
  if (!text.trim()) return true;
  if (text.length > MOST_CHARACTERS) return false;
  const others = versions().filter((each) => each.text !== text || each.robot !== robot);
  const all = [{ text, robot, name, at_ms }, ...others].slice(0, MOST);
  while (all.length > 1 && all.reduce((sum, each) => sum + each.text.length, 0) > MOST_CHARACTERS) all.pop();
  while (all.length && !storeText(PLACE, JSON.stringify(all))) all.pop();
  return all.length > 0;
}

/**
 * Its name; else its first block in words for who sees blocks, and for who sees text its first lines.
 * @param {Version} version @param {number} number @returns {string}
 */
export function titleOf({ name, text }, number) {
  const begin = pageState.view.value === 'blocks' ? labelOfLine(firstLine(text)) || said('program_unnamed', { number }) : beginOf(text);
  return name.replace(/\.\w+$/, '') || begin;
}

/** Its first instruction. @param {string} text @returns {string} */
function firstLine(text) {
  return text.replace(/\/\/.*$/gm, '').replace(/^\s*(?:SI|SB|PING)\s*\|/i, '').split(/[;\n]/).map((line) => line.trim()).find(Boolean) ?? '';
}

/** Its first lines as one, with no character cut in two. @param {string} text @returns {string} */
export function beginOf(text) {
  return text.trim().split('\n', 3).join(' ').replace(/^(.{60}).+/su, '$1…');
}

/**
 * @param {any} found
 * @returns {found is Version}
 */
function isVersion(found) {
  return (
    typeof found?.text === 'string' &&
    found.text.length <= MOST_CHARACTERS &&
    isRobot(found.robot) &&
    typeof found.name === 'string' &&
    Number.isFinite(found.at_ms) &&
    Math.abs(found.at_ms) <= 8.64e15 // what a Date takes
  );
}
