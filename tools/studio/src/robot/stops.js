// STOP for all robots of a `tsc studio`: how many have confirmed it, and in red which have not.

import { element } from '../page/elements.js';
import { made } from '../page/made.js';
import { isTeacher, post } from './host.js';
import { shown } from './plain_text.js';
import { pause } from './transport.js';
import { text } from '../page/texts.js';
import { LINK } from '../page/words.js';

/** @typedef {{name: string, stop: 'asked' | 'confirmed' | 'silent'}} Stop */

const LOOK_MS = 200;
const LATE_MS = 1000; // after which a robot that has not confirmed is red
const WORD_MS = 3000; // after which it is said that nobody has heard it

let newest = 0;

/** Stops all robots, and tells of it until each has confirmed or the time is over. */
export async function stopAll() {
  const own = ++newest;
  const began = performance.now();
  /** @type {Stop[] | null} */
  let robots = null;
  const word = setTimeout(() => own === newest && show(null, false), WORD_MS);
  while (own === newest && !robots && performance.now() - began < LINK.confirm_ms) {
    robots = await asked('stop_all');
    if (!robots) await pause(LOOK_MS);
  }
  clearTimeout(word);
  while (own === newest && robots) {
    const passed = performance.now() - began;
    const isOver = passed > 2 * LINK.confirm_ms || robots.every(({ stop }) => stop !== 'asked');
    show(robots, isOver || passed > LATE_MS);
    if (isOver) return;
    await pause(LOOK_MS);
    robots = (await asked('stops')) ?? robots;
  }
}

/** @param {string} what @returns {Promise<Stop[] | null>} */
async function asked(what) {
  try {
    return (await post({ do: what }, { keepalive: true })).robots;
  } catch {
    return null;
  }
}

/** @param {Stop[] | null} robots @param {boolean} isLate */
function show(robots, isLate) {
  const place = element('stops', HTMLElement);
  const late = robots?.filter(({ stop }) => stop === 'silent' || (isLate && stop === 'asked')) ?? [];
  const confirmed = robots?.filter(({ stop }) => stop === 'confirmed').length ?? 0;
  const silent = robots ? late.length && text('stops_silent', { names: late.map(({ name }) => shown(name)).join(', ') }) : text('stops_gone');
  const isNone = robots?.length === 0;
  place.hidden = isNone && !isTeacher;
  place.dataset['confirmed'] = `${confirmed}`;
  const red = made('span');
  red.className = 'wrong';
  red.textContent = silent || '';
  const sentence = isNone ? text('stops_none') : robots ? text('stops_confirmed', { confirmed, count: robots.length }) : '';
  if (place.textContent === sentence + (silent ? ` ${silent}` : '')) return; // who hears the page hears each thing once
  place.replaceChildren(sentence, ...(silent ? [' ', red] : []));
}
