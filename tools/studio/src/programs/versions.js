// Earlier programs, kept on this device: newest first, and no more than a device has room for.
//
// No two of them are the same to a robot. The one that was kept last stays, with its text and its name, before all others;
// of two that are stored, the first.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { labelOfLine } from '../blocks/said.js';
import { pageState } from '../page/page_state.js';
import { text as textOf } from '../page/texts.js';
import { isRobot } from '../page/words.js';
import { storeText, loadJson } from '../page/kept.js';

/** @typedef {{text: string, robot: string, name: string, at_ms: number}} Version */

const STORAGE_KEY = 'tiniscript.versions';
const MAX_VERSIONS = 40;
export const MAX_CHARACTERS = 400_000; // in all; a browser keeps about five million

/** @returns {Version[]} */
export function loadVersions() {
  const stored = loadJson(STORAGE_KEY);
  if (!Array.isArray(stored)) return [];
  /** @type {Map<string, Version>} */
  const versionByKey = new Map();
  for (const version of stored.filter(isVersion)) if (!versionByKey.has(keyOf(version))) versionByKey.set(keyOf(version), version);
  return [...versionByKey.values()].slice(0, MAX_VERSIONS);
}

/**
 * Keeps a program before all others; it is there once, at the time when it was kept last. Where there
 * is no room the oldest go. Returns whether it is kept.
 * @param {{text: string, robot: string, name: string}} program
 * @param {number} [at_ms]
 * @returns {boolean}
 */
export function storeVersion({ text, robot: robotName, name }, at_ms = Date.now()) {
  if (!text.trim()) return true;
  if (text.length > MAX_CHARACTERS) return false;
  const isSame = isSameProgramAs({ text, robot: robotName });
  const otherVersions = loadVersions().filter((version) => !isSame(version));
  return storeVersions([{ text, robot: robotName, name, at_ms }, ...otherVersions]);
}

/** @param {Version} version */
export function deleteVersion(version) {
  const isSame = isSameProgramAs(version);
  storeVersions(loadVersions().filter((other) => !isSame(other)));
}

/** Keeps a program again that was deleted, where it was, unless another tab has. @param {Version} version @returns {boolean} whether it is kept */
export function restoreVersion(version) {
  const versions = loadVersions();
  if (versions.some(isSameProgramAs(version))) return true;
  const olderIndex = versions.findIndex(({ at_ms }) => at_ms < version.at_ms), index = olderIndex < 0 ? versions.length : olderIndex;
  return storeVersions([...versions.slice(0, index), version, ...versions.slice(index)], version); // the others stay where they are, whatever the clock said
}

/**
 * Keeps as many as there is room for; where not even the newest has any, all stay that were there.
 * @param {Version[]} versions the newest first
 * @param {Version} [wantedVersion] one of them
 * @returns {boolean} whether that one is kept
 */
function storeVersions(versions, wantedVersion = versions[0]) {
  const newVersions = versions.slice(0, MAX_VERSIONS);
  while (newVersions.length > 1 && newVersions.reduce((sum, version) => sum + version.text.length, 0) > MAX_CHARACTERS) newVersions.pop();
  while (!storeText(STORAGE_KEY, JSON.stringify(newVersions))) {
    newVersions.pop();
    if (!newVersions.length) return false;
  }
  return newVersions.some((version) => version === wantedVersion);
}

/**
 * Returns what says whether another program differs from this one in nothing that a robot does.
 * @param {{text: string, robot: string}} program
 * @returns {(other: {text: string, robot: string}) => boolean}
 */
export function isSameProgramAs(program) {
  const key = keyOf(program);
  return (other) => keyOf(other) === key;
}

/** What two programs share that are the same to a robot. @param {{text: string, robot: string}} program */
function keyOf({ text, robot: robotName }) {
  return `${robotName} ${essenceOf(text)}`;
}

/** A program without what changes nothing: spaces, empty lines, and what ends a line. Each step takes as long as the text is. @param {string} text */
function essenceOf(text) {
  return text.replace(/[^\S\n]+/g, ' ').replace(/ ?([^\w ]) ?/g, '$1').replace(/;+/g, ';').replace(/;?\n[;\n]*/g, '\n').replace(/^[;\n]+|[;\n]$/g, '').trim();
}

/**
 * Its name; else its first block in words for who sees blocks, and for who sees text its first lines.
 * @param {Version} version @param {number} number @returns {string}
 */
export function versionTitle({ name, text }, number) {
  const beginning = pageState.view.value === 'blocks' ? labelOfLine(firstInstruction(text)) || textOf('program_unnamed', { number }) : beginningOf(text);
  return name.replace(/\.\w+$/, '') || beginning;
}

/** Its first instruction that runs: not one of a DEF, if there is another. @param {string} text @returns {string} */
function firstInstruction(text) {
  const code = text.replace(/\/\/.*$/gm, '').replace(/^\s*(?:SI|SB|PING)\s*\|/i, '');
  const instructions = [code.replace(/\bDEF\b[^]*?\bEND_?DEF\b/gi, ''), code].flatMap((part) => part.split(/[;\n]/));
  return instructions.map((line) => line.trim()).find(Boolean) ?? '';
}

/** Its first lines as one, with no character cut in two. @param {string} text @returns {string} */
export function beginningOf(text) {
  return text.trim().split('\n', 3).join(' ').replace(/^(.{60}).+/su, '$1…');
}

/**
 * @param {any} value
 * @returns {found is Version}
 */
function isVersion(value) {
  return (
    typeof value?.text === 'string' &&
    value.text.length <= MAX_CHARACTERS &&
    isRobot(value.robot) &&
    typeof value.name === 'string' &&
    Number.isFinite(value.at_ms) &&
    Math.abs(value.at_ms) <= 8.64e15 // what a Date takes
  );
}
