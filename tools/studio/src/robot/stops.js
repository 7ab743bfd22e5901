// STOP for all robots of a `tsc studio`: how many have confirmed it, and in red which have not.

import { element } from '../page/elements.js';
import { makeElement } from '../page/made.js';
import { isTeacher, post } from './host.js';
import { asPlainText } from './plain_text.js';
import { pause } from './transport.js';
import { text } from '../page/texts.js';
import { LINK } from '../page/words.js';

/** @typedef {{name: string, stop: 'asked' | 'confirmed' | 'silent'}} RobotStop */

const POLL_MS = 200;
const LATE_MS = 1000; // after which a robot that has not confirmed is red
const NOTICE_MS = 3000; // after which it is said that nobody has heard it
const CONFIRMED_SHOWN_MS = 15_000; // for which it is seen that all have confirmed: later it says nothing of what drives now

let newestStopNumber = 0;

/** Stops all robots, and reports it until each has confirmed or the time is over. */
export async function stopAll() {
  const stopNumber = ++newestStopNumber;
  const began_ms = performance.now();
  /** @type {RobotStop[] | null} */
  let robots = null;
  const noticeTimer = setTimeout(() => stopNumber === newestStopNumber && showStops(null, false), NOTICE_MS);
  while (stopNumber === newestStopNumber && !robots && performance.now() - began_ms < LINK.confirm_ms) {
    robots = await requestStops('stop_all');
    if (!robots) await pause(POLL_MS);
  }
  clearTimeout(noticeTimer);
  while (stopNumber === newestStopNumber && robots) {
    const elapsed_ms = performance.now() - began_ms;
    const isOver = elapsed_ms > 2 * LINK.confirm_ms || robots.every(({ stop }) => stop !== 'asked');
    showStops(robots, isOver || elapsed_ms > LATE_MS);
    if (isOver && robots.every(({ stop }) => stop === 'confirmed')) setTimeout(() => stopNumber === newestStopNumber && hideStops(), CONFIRMED_SHOWN_MS);
    if (isOver) return;
    await pause(POLL_MS);
    robots = (await requestStops('stops')) ?? robots;
  }
}

/** @param {string} action @returns {Promise<RobotStop[] | null>} */
async function requestStops(action) {
  try {
    return (await post({ do: action }, { keepalive: true })).robots;
  } catch {
    return null;
  }
}

function hideStops() {
  const target = element('stops', HTMLElement);
  target.hidden = true;
  target.replaceChildren();
  delete target.dataset['confirmed'];
}

/** @param {RobotStop[] | null} robots @param {boolean} isLate */
function showStops(robots, isLate) {
  const target = element('stops', HTMLElement);
  const lateRobots = robots?.filter(({ stop }) => stop === 'silent' || (isLate && stop === 'asked')) ?? [];
  const confirmedCount = robots?.filter(({ stop }) => stop === 'confirmed').length ?? 0;
  const silentSentence = robots ? lateRobots.length && text('stops_silent', { names: lateRobots.map(({ name }) => asPlainText(name)).join(', ') }) : text('stops_gone');
  const hasNoRobots = robots?.length === 0;
  target.hidden = hasNoRobots && !isTeacher;
  target.dataset['confirmed'] = `${confirmedCount}`;
  const redPart = makeElement('span');
  redPart.className = 'wrong';
  redPart.textContent = silentSentence || '';
  const sentence = hasNoRobots ? text('stops_none') : robots ? text('stops_confirmed', { confirmed: confirmedCount, count: robots.length }) : '';
  if (target.textContent === sentence + (silentSentence ? ` ${silentSentence}` : '')) return; // who hears the page hears each thing once
  target.replaceChildren(sentence, ...(silentSentence ? [' ', redPart] : []));
}
