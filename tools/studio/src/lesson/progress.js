// Which lessons are done, and the stars for each and for each world with a task, kept on this device.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { storeText, storedJson } from '../page/kept.js';

const PLACE = 'tiniscript.lessons';
const STARS_PLACE = 'tiniscript.stars';
const MOST = 100;
const MOST_STARS = 100; // of a lesson

/** @returns {Set<string>} names of lessons */
export function lessonsDone() {
  const kept = storedJson(PLACE);
  return new Set(Array.isArray(kept) ? kept.filter((name) => typeof name === 'string' && /^\w{1,60}$/.test(name)).slice(0, MOST) : []);
}

/** Keeps that a lesson is done; returns whether that was possible. @param {string} name */
export function keepDone(name) {
  return storeText(PLACE, JSON.stringify([...lessonsDone().add(name)]));
}

/** @returns {Map<string, number>} the most stars that each lesson has brought; one that is done has one at least */
export function lessonStars() {
  const found = storedJson(STARS_PLACE);
  const rows = Object.entries(found && typeof found === 'object' && !Array.isArray(found) ? found : {}).slice(0, MOST);
  const stars = new Map(rows.filter(([name, count]) => /^\w{1,60}$/.test(name) && Number.isInteger(count) && count > 0 && count <= MOST_STARS));
  for (const name of lessonsDone()) stars.set(name, stars.get(name) ?? 1);
  return stars;
}

/** Keeps the stars of a lesson, unless there were more before; returns whether that was possible. @param {string} name @param {number} count */
export function keepStars(name, count) {
  const stars = lessonStars();
  if (count <= (stars.get(name) ?? 0)) return true;
  return storeText(STARS_PLACE, JSON.stringify(Object.fromEntries(stars.set(name, count))));
}

/** @param {string} name of a shipped world @returns {string} how its stars are kept; no lesson is called so */
export function worldStars(name) {
  return `world_${name}`;
}

/** All stars of all lessons and worlds. */
export function starsInAll() {
  return [...lessonStars().values()].reduce((sum, count) => sum + count, 0);
}
