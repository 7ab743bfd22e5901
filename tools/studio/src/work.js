// Keeps the work on this device: what a tab has, and what the last tab had.
//
// What is kept may be damaged, or from somebody else on this device: all of it is checked.

import { isRobot, WORLDS } from './words.js';

/** @typedef {{text: string, robot: string, world: string, language: 'en' | 'es', name: string, view: 'blocks' | 'text', level: 'few' | 'usual' | 'all'}} Work */

const PLACE = 'tiniscript.work';
const WORLD_PLACE = 'tiniscript.world'; // the text of the newest world that was drawn here
const BEFORE_PLACE = 'tiniscript.worlds_before'; // the texts of those before it
export const OWN_WORLD = ':own'; // no name of a shipped world
const OURS = 'tiniscript.'; // all places of this page
const LONGEST = 1_000_000; // characters

let isForgotten = false;

/** Deletes all that this page has kept on this device; it keeps nothing from then on. */
export function forgetAll() {
  isForgotten = true;
  for (const name of ['sessionStorage', 'localStorage']) {
    try {
      const storage = /** @type {any} */ (window)[name];
      for (const place of Object.keys(storage)) if (place.startsWith(OURS)) storage.removeItem(place);
    } catch {
      // no storage here
    }
  }
}

export function keepsNothing() {
  return isForgotten;
}

/** @returns {Work | null} */
export function keptWork() {
  return kept(PLACE, (found) => checked(JSON.parse(found)));
}

/** Returns the texts of the worlds that were drawn here; who reads them checks them. @returns {{newest: string, before: string[]}} */
export function keptWorlds() {
  return {
    newest: kept(WORLD_PLACE, (found) => found) ?? '',
    before: kept(BEFORE_PLACE, (found) => {
      const texts = JSON.parse(found);
      return Array.isArray(texts) ? texts.filter((each) => typeof each === 'string' && each) : null;
    }) ?? [],
  };
}

/**
 * @template T
 * @param {string} place
 * @param {(found: string) => T | null} read
 * @returns {T | null}
 */
function kept(place, read) {
  for (const storage of ['sessionStorage', 'localStorage']) {
    try {
      const found = /** @type {any} */ (window)[storage].getItem(place);
      const whole = found && read(found);
      if (whole) return whole;
    } catch {
      // no storage here, or not what we have put there
    }
  }
  return null;
}

/**
 * Keeps the work; returns whether that was possible.
 * @param {Work} work
 * @returns {boolean}
 */
export function keep(work) {
  return put(PLACE, JSON.stringify(work));
}

/**
 * Keeps the texts of the worlds that were drawn: the newest, and of those before it as many as fit in.
 * @param {string} newest
 * @param {string[]} before the last one first
 */
export function keepWorlds(newest, before) {
  let rest = LONGEST;
  const fitting = before.filter((each) => (rest -= each.length) >= 0);
  put(BEFORE_PLACE, JSON.stringify(fitting));
  if (newest) put(WORLD_PLACE, newest);
}

/** @param {string} place @param {string} whole @returns {boolean} */
function put(place, whole) {
  if (isForgotten) return true;
  let isKept = false;
  for (const storage of ['sessionStorage', 'localStorage']) {
    try {
      /** @type {any} */ (window)[storage].setItem(place, whole);
      isKept = true;
    } catch {
      // full, or forbidden
    }
  }
  return isKept;
}

/**
 * @param {any} found
 * @returns {Work | null}
 */
function checked(found) {
  if (typeof found?.text !== 'string' || found.text.length > LONGEST) return null;
  return {
    text: found.text,
    robot: isRobot(found.robot) ? found.robot : 'tinibot',
    world: found.world === OWN_WORLD || WORLDS.some((world) => world.name === found.world) ? found.world : 'obstacles',
    language: found.language === 'en' ? 'en' : 'es',
    name: typeof found.name === 'string' ? found.name.slice(0, 200) : '',
    view: found.view === 'text' ? 'text' : 'blocks',
    level: found.level === 'all' || found.level === 'usual' ? found.level : 'few',
  };
}
