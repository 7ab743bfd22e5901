// Which lessons are done, the stars for each and for each world with a task, and the newest program of each,
// kept on this device.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { storeText, loadJson } from '../page/kept.js';
import { STARS } from '../page/words.js';

const STORAGE_KEY = 'tiniscript.lessons';
const STARS_KEY = 'tiniscript.stars';
const PROGRAMS_KEY = 'tiniscript.lesson_programs';
const PLACE_KEY = 'tiniscript.lesson_place';
const MAX_LESSONS = 100;
const MAX_STARS = 100; // of a lesson
const MAX_CHARACTERS = 20_000; // of a lesson's program

/** @returns {Set<string>} names of lessons */
export function loadDoneLessons() {
  const stored = loadJson(STORAGE_KEY);
  return new Set(Array.isArray(stored) ? stored.filter((name) => typeof name === 'string' && /^\w{1,60}$/.test(name)).slice(0, MAX_LESSONS) : []);
}

/** Keeps that a lesson is done; returns whether that was possible. @param {string} name */
export function storeDoneLesson(name) {
  return storeText(STORAGE_KEY, JSON.stringify([...loadDoneLessons().add(name)]));
}

/** @returns {Map<string, number>} the most stars that each lesson has brought; one that is done has one at least */
export function loadStars() {
  const stored = loadJson(STARS_KEY);
  const rows = Object.entries(stored && typeof stored === 'object' && !Array.isArray(stored) ? stored : {}).slice(0, MAX_LESSONS);
  const stars = new Map(rows.filter(([name, count]) => /^\w{1,60}$/.test(name) && Number.isInteger(count) && count > 0 && count <= MAX_STARS));
  for (const name of loadDoneLessons()) stars.set(name, stars.get(name) ?? 1);
  return stars;
}

/** Keeps the stars of a lesson, unless there were more before; returns whether that was possible. @param {string} name @param {number} count */
export function storeStars(name, count) {
  const stars = loadStars();
  if (count <= (stars.get(name) ?? 0)) return true;
  return storeText(STARS_KEY, JSON.stringify(Object.fromEntries(stars.set(name, count))));
}

/** @param {string} name of a shipped world @returns {string} how its stars are kept; no lesson is called so */
export function starsKeyOfWorld(name) {
  return `world_${name}`;
}

/** The most stars that each lesson and each world of this page brings, as they are kept. @type {Map<string, number>} */
const MAX_STARS_BY_NAME = new Map([...Object.entries(STARS.lessons), ...Object.entries(STARS.worlds).map(([name, most]) => /** @type {[string, number]} */ ([starsKeyOfWorld(name), most]))]);

/** All stars of all lessons and worlds of this page: what is kept may be of another one. */
export function countAllStars() {
  const stars = loadStars();
  return [...MAX_STARS_BY_NAME].reduce((sum, [name, most]) => sum + Math.min(most, stars.get(name) ?? 0), 0);
}

/** What there is to be done, and what of it is done. @returns {{done: number, lessons: number, stars: number, most: number}} */
export function loadProgress() {
  const lessonNames = Object.keys(STARS.lessons), doneLessons = loadDoneLessons();
  return {
    done: lessonNames.filter((name) => doneLessons.has(name)).length,
    lessons: lessonNames.length,
    stars: countAllStars(),
    most: [...MAX_STARS_BY_NAME.values()].reduce((sum, most) => sum + most),
  };
}

/** @returns {{lesson: string, step: number, isOpen: boolean}} where this tab was in which lesson, and whether that was seen; an empty name for nowhere */
export function loadPlace() {
  const { lesson, step, isOpen } = loadJson(PLACE_KEY, 'sessionStorage') ?? {};
  return { lesson: typeof lesson === 'string' && /^\w{1,60}$/.test(lesson) ? lesson : '', step: Number.isInteger(step) && step > 0 ? step : 0, isOpen: isOpen === true };
}

/** @param {{lesson: string, step: number, isOpen: boolean}} place */
export function storePlace(place) {
  storeText(PLACE_KEY, JSON.stringify(place), 'sessionStorage');
}

/** @returns {Map<string, string>} the newest program of each lesson for which there was one */
function loadPrograms() {
  const stored = loadJson(PROGRAMS_KEY);
  const rows = Object.entries(stored && typeof stored === 'object' && !Array.isArray(stored) ? stored : {}).slice(0, MAX_LESSONS);
  return new Map(rows.filter(([name, text]) => /^\w{1,60}$/.test(name) && typeof text === 'string' && text.trim() && text.length <= MAX_CHARACTERS));
}

/** @param {string} name of a lesson @returns {string} its newest program; empty for none */
export function loadProgram(name) {
  return loadPrograms().get(name) ?? '';
}

/** A lesson has no program any more. @param {string} name */
export function forgetProgram(name) {
  const programs = loadPrograms();
  if (programs.delete(name)) storeText(PROGRAMS_KEY, JSON.stringify(Object.fromEntries(programs)));
}

/** Keeps the newest program of a lesson. @param {string} name @param {string} text */
export function storeProgram(name, text) {
  if (text.trim() && text.length <= MAX_CHARACTERS) storeText(PROGRAMS_KEY, JSON.stringify(Object.fromEntries(loadPrograms().set(name, text))));
}
