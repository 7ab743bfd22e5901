// On a phone, STOP lies over other buttons while something may move. It goes there once a second tap is no longer for
// them (twice.js). It stays there for a while after the end and after each press: whoever wants to stop a robot never
// presses what takes its place, however the robot has stopped.

import { element } from './elements.js';

/** @typedef {'run' | 'link'} Need why it lies there: a run of the virtual robot, or a connection with a real one */

const SHOW_DELAY_MS = 500;
const HIDE_DELAY_MS = 1500;

const { dataset } = document.documentElement;
/** @type {Set<Need>} */
const needs = new Set();
/** @type {Set<Need>} */
const shownNeeds = new Set();
/** @type {Map<Need, number>} */
const timers = new Map();

/** @param {Need} need @param {boolean} isNeeded from now on */
export function setStopNeeded(need, isNeeded) {
  if (needs.has(need) === isNeeded) return;
  if (isNeeded) needs.add(need);
  else needs.delete(need);
  scheduleChange(need);
}

/** It comes or goes, but not yet. @param {Need} need */
function scheduleChange(need) {
  clearTimeout(timers.get(need));
  const isShown = shownNeeds.has(need);
  if (isShown === needs.has(need)) return;
  timers.set(need, window.setTimeout(() => {
    if (isShown) shownNeeds.delete(need);
    else shownNeeds.add(need);
    if (shownNeeds.size) dataset['stop'] = [...shownNeeds].join(' ');
    else delete dataset['stop'];
  }, isShown ? HIDE_DELAY_MS : SHOW_DELAY_MS));
}

element('stop', HTMLButtonElement).addEventListener('pointerdown', () => shownNeeds.forEach(scheduleChange));
