// Which lessons are done, kept on this device.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { keepAt, keptForm } from '../page/kept.js';

const PLACE = 'tiniscript.lessons';
const MOST = 100;

/** @returns {Set<string>} names of lessons */
export function lessonsDone() {
  const kept = keptForm(PLACE);
  return new Set(Array.isArray(kept) ? kept.filter((name) => typeof name === 'string' && /^\w{1,60}$/.test(name)).slice(0, MOST) : []);
}

/** Keeps that a lesson is done; returns whether that was possible. @param {string} name */
export function keepDone(name) {
  return keepAt(PLACE, JSON.stringify([...lessonsDone().add(name)]));
}
