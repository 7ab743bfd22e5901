// Keeps the work on this device: what a tab has, and what the last tab had. A program that is a lesson's
// has the lesson's name; `own` is the one of this person, which comes back after the lesson.
//
// What is kept may be damaged, or from somebody else on this device: all of it is checked.

import { storeText, loadText, loadJson } from '../page/kept.js';
import { languageOf } from '../page/texts.js';
import { isRobot, WORLDS } from '../page/words.js';

/** @typedef {{text: string, robot: string, name: string}} Program */
/** @typedef {{text: string, robot: string, lesson: string, own: Program | null, world: string, language: string, name: string, view: 'blocks' | 'text', level: 'few' | 'usual' | 'all', words: boolean, sound: boolean}} Work */

const STORAGE_KEY = 'tiniscript.work';
const WORLD_KEY = 'tiniscript.world'; // the text of the newest world that was drawn here
const EARLIER_WORLDS_KEY = 'tiniscript.worlds_before'; // the texts of those before it
export const OWN_WORLD = ':own'; // no name of a shipped world
export const MAX_CHARACTERS = 1_000_000; // characters

const MAX_OTHER_TEXTS = 5;

/** This tab's worlds that may be in storage; others there are another tab's. @type {Set<string>} */
let tabWorldTexts = new Set();

/** @returns {Work | null} */
export function loadWork() {
  return validWork(loadJson(STORAGE_KEY, 'sessionStorage')) ?? validWork(loadJson(STORAGE_KEY));
}

/** Returns the texts of the worlds that were drawn here; who reads them checks them. @returns {{newest: string, before: string[]}} */
export function loadWorldTexts() {
  const newestText = loadText(WORLD_KEY, 'sessionStorage') || loadText(WORLD_KEY);
  const earlierTexts = loadEarlierTexts('sessionStorage') ?? loadEarlierTexts() ?? [];
  tabWorldTexts = new Set([newestText, ...earlierTexts]);
  return { newest: newestText, before: earlierTexts };
}

/** @param {import('../page/kept.js').StoreName} [storeName] @returns {string[] | null} */
function loadEarlierTexts(storeName) {
  const texts = loadJson(EARLIER_WORLDS_KEY, storeName);
  return Array.isArray(texts) ? texts.filter((worldText) => typeof worldText === 'string' && worldText) : null;
}

/**
 * Keeps the work; returns whether the next tab will find it.
 * @param {Work} work
 * @returns {boolean}
 */
export function storeWork(work) {
  return work.text.length <= MAX_CHARACTERS && storeInBothStorages(STORAGE_KEY, JSON.stringify(work));
}

/**
 * Keeps the texts of the worlds that were drawn: the newest, and of those before it as many as fit in.
 * The next tab finds those of other tabs, too: as they are now, after the ones before. Returns whether it does.
 * @param {string} newestText
 * @param {string[]} earlierTexts the last one first
 * @returns {boolean}
 */
export function storeWorldTexts(newestText, earlierTexts) {
  for (const worldText of [newestText, ...earlierTexts]) tabWorldTexts.add(worldText);
  // What lasts was put there by the tab that changed last, with the worlds of all tabs as it found them.
  const otherTexts = [...new Set(loadLastingTexts())].filter((worldText) => !tabWorldTexts.has(worldText)).slice(0, MAX_OTHER_TEXTS);
  let charactersLeft = MAX_CHARACTERS;
  const fittingTexts = [...earlierTexts, ...otherTexts].filter((worldText) => (charactersLeft -= worldText.length) >= 0);
  const ownEarlierTexts = fittingTexts.filter((worldText) => earlierTexts.includes(worldText));
  const areEarlierStored = storeInBothStorages(EARLIER_WORLDS_KEY, JSON.stringify(ownEarlierTexts), JSON.stringify(fittingTexts));
  const isStored = newestText ? storeInBothStorages(WORLD_KEY, newestText) && areEarlierStored : areEarlierStored;
  if (isStored) tabWorldTexts = new Set([newestText, ...earlierTexts]);
  return isStored;
}

/** Those that the next tab would find. @returns {string[]} */
function loadLastingTexts() {
  return [loadText(WORLD_KEY), ...(loadEarlierTexts() ?? [])].filter(Boolean);
}

/** @param {string} key @param {string} content @param {string} [lastingContent] for the next tab @returns {boolean} whether that is kept, too */
function storeInBothStorages(key, content, lastingContent = content) {
  storeText(key, content, 'sessionStorage');
  return storeText(key, lastingContent);
}

/**
 * @param {any} value
 * @returns {Work | null}
 */
function validWork(value) {
  if (typeof value?.text !== 'string' || value.text.length > MAX_CHARACTERS) return null;
  return {
    text: value.text,
    robot: isRobot(value.robot) ? value.robot : 'tinibot',
    lesson: typeof value.lesson === 'string' ? value.lesson.slice(0, 60) : '',
    own: validProgram(value.own),
    world: value.world === OWN_WORLD || WORLDS.some((world) => world.name === value.world) ? value.world : 'obstacles',
    language: languageOf(typeof value.language === 'string' ? value.language : ''),
    name: typeof value.name === 'string' ? value.name.slice(0, 200) : '',
    view: value.view === 'text' ? 'text' : 'blocks',
    level: value.level === 'all' || value.level === 'usual' ? value.level : 'few',
    words: value.words === true,
    sound: value.sound !== false,
  };
}

/** @param {any} value @returns {Program | null} */
function validProgram(value) {
  if (typeof value?.text !== 'string' || value.text.length > MAX_CHARACTERS || !isRobot(value.robot)) return null;
  return { text: value.text, robot: value.robot, name: typeof value.name === 'string' ? value.name.slice(0, 200) : '' };
}
