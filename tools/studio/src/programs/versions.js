// Earlier programs, kept on this device: newest first, and no more than a device has room for.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { isRobot } from '../page/words.js';
import { keepAt, keptForm } from '../page/kept.js';

/** @typedef {{text: string, robot: string, name: string, at_ms: number}} Version */

const PLACE = 'tiniscript.versions';
const MOST = 40;
export const MOST_CHARACTERS = 400_000; // in all; a browser keeps about five million

/** @returns {Version[]} */
export function versions() {
  const kept = keptForm(PLACE);
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
  while (all.length && !keepAt(PLACE, JSON.stringify(all))) all.pop();
  return all.length > 0;
}

/** Its name, or else how it begins. @param {Version} version @returns {string} */
export function titleOf({ name, text }) {
  return name.replace(/\.\w+$/, '') || beginOf(text);
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
