// Keeps the work on this device: what a tab has, and what the last tab had.
//
// What is kept may be damaged, or from somebody else on this device: all of it is checked.

import { storeText, storedText, storedJson } from '../page/kept.js';
import { languageOf } from '../page/texts.js';
import { isRobot, WORLDS } from '../page/words.js';

/** @typedef {{text: string, robot: string, world: string, language: string, name: string, view: 'blocks' | 'text', level: 'few' | 'usual' | 'all', words: boolean, sound: boolean}} Work */

const PLACE = 'tiniscript.work';
const WORLD_PLACE = 'tiniscript.world'; // the text of the newest world that was drawn here
const BEFORE_PLACE = 'tiniscript.worlds_before'; // the texts of those before it
export const OWN_WORLD = ':own'; // no name of a shipped world
export const LONGEST = 1_000_000; // characters

const MOST_OTHERS = 5;

/** The worlds of this tab that may be in the place: others there are of another tab. @type {Set<string>} */
let ownWorlds = new Set();

/** @returns {Work | null} */
export function keptWork() {
  return checked(storedJson(PLACE, 'sessionStorage')) ?? checked(storedJson(PLACE));
}

/** Returns the texts of the worlds that were drawn here; who reads them checks them. @returns {{newest: string, before: string[]}} */
export function keptWorlds() {
  const newest = storedText(WORLD_PLACE, 'sessionStorage') || storedText(WORLD_PLACE);
  const before = worldsBefore('sessionStorage') ?? worldsBefore() ?? [];
  ownWorlds = new Set([newest, ...before]);
  return { newest, before };
}

/** @param {import('../page/kept.js').StoreName} [store] @returns {string[] | null} */
function worldsBefore(store) {
  const texts = storedJson(BEFORE_PLACE, store);
  return Array.isArray(texts) ? texts.filter((each) => typeof each === 'string' && each) : null;
}

/**
 * Keeps the work; returns whether the next tab will find it.
 * @param {Work} work
 * @returns {boolean}
 */
export function keep(work) {
  return work.text.length <= LONGEST && put(PLACE, JSON.stringify(work));
}

/**
 * Keeps the texts of the worlds that were drawn: the newest, and of those before it as many as fit in.
 * The next tab finds those of other tabs, too: as they are now, after the ones before. Returns whether it does.
 * @param {string} newest
 * @param {string[]} before the last one first
 * @returns {boolean}
 */
export function keepWorlds(newest, before) {
  for (const each of [newest, ...before]) ownWorlds.add(each);
  // What lasts was put there by the tab that changed last, with the worlds of all tabs as it found them.
  const others = [...new Set(lastingWorlds())].filter((each) => !ownWorlds.has(each)).slice(0, MOST_OTHERS);
  let rest = LONGEST;
  const fitting = [...before, ...others].filter((each) => (rest -= each.length) >= 0);
  const own = fitting.filter((each) => before.includes(each));
  const areKept = put(BEFORE_PLACE, JSON.stringify(own), JSON.stringify(fitting));
  const isKept = newest ? put(WORLD_PLACE, newest) && areKept : areKept;
  if (isKept) ownWorlds = new Set([newest, ...before]);
  return isKept;
}

/** Those that the next tab would find. @returns {string[]} */
function lastingWorlds() {
  return [storedText(WORLD_PLACE), ...(worldsBefore() ?? [])].filter(Boolean);
}

/** @param {string} place @param {string} whole @param {string} [lasting] for the next tab @returns {boolean} whether that is kept, too */
function put(place, whole, lasting = whole) {
  storeText(place, whole, 'sessionStorage');
  return storeText(place, lasting);
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
    language: languageOf(typeof found.language === 'string' ? found.language : ''),
    name: typeof found.name === 'string' ? found.name.slice(0, 200) : '',
    view: found.view === 'text' ? 'text' : 'blocks',
    level: found.level === 'all' || found.level === 'usual' ? found.level : 'few',
    words: found.words === true,
    sound: found.sound !== false,
  };
}
