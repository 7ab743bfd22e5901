// Which lessons are done, kept on this device.
//
// What is kept may be damaged, or from another tab: it is read anew each time, and all is checked.

import { keepsNothing } from '../programs/work.js';

const PLACE = 'tiniscript.lessons';
const MOST = 100;

/** @returns {Set<string>} names of lessons */
export function lessonsDone() {
  try {
    const found = JSON.parse(localStorage.getItem(PLACE) ?? '[]');
    return new Set(Array.isArray(found) ? found.filter((name) => typeof name === 'string' && /^\w{1,60}$/.test(name)).slice(0, MOST) : []);
  } catch {
    return new Set(); // no storage here, or not what we have put there
  }
}

/** Keeps that a lesson is done; returns whether that was possible. @param {string} name */
export function keepDone(name) {
  if (keepsNothing()) return true;
  try {
    localStorage.setItem(PLACE, JSON.stringify([...lessonsDone().add(name)]));
    return true;
  } catch {
    return false; // full, or forbidden
  }
}
