// The list of messages beneath the editor. Everything of a program is put there as text, never
// as markup. A screen reader hears the first one.

import { element, say } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { text } from '../page/texts.js';

/** @import { Checked, Finding } from '../python.js' */

const MOST = 50; // messages that are shown at once

/** What is said, and what to try, as one line. @param {{message?: string, fix?: string}} said @returns {string} */
export function whole({ message = '', fix = '' }) {
  const gap = /[.!?:]$/.test(message) ? ' ' : ' – ';
  return [message, fix && `${text('try')} ${fix}`].filter(Boolean).join(gap);
}

/**
 * @param {HTMLElement} list
 * @param {Finding[]} findings
 * @param {(finding: Finding) => void} goTo
 */
export function showMessages(list, findings, goTo) {
  let first = '';
  const rows = findings.slice(0, MOST).map((finding) => {
    const place = makeButton('', () => goTo(finding), text('line', { line: finding.line }));
    place.className = 'place';
    place.ariaLabel = text('say_fault', { line: finding.line, what: whole(finding) });
    first ||= place.ariaLabel;
    const row = makeElement('li', '', place, ' ', whole(finding));
    row.className = finding.severity;
    return row;
  });
  if (findings.length > MOST) rows.push(makeElement('li', '', text('more', { count: findings.length - MOST })));
  list.replaceChildren(...rows);
  say(element('first_message', HTMLElement), first);
}

/**
 * Gives a message the button of its repair.
 * @param {HTMLElement} list that shows it
 * @param {number} which
 * @param {Finding} finding
 * @param {(finding: Finding) => void} repair
 */
export function showRepair(list, which, finding, repair) {
  const does = makeButton('repair', () => repair(finding));
  does.className = 'repair';
  does.setAttribute('aria-label', text('repair_line', { line: finding.line, fix: finding.fix }));
  if (which < MOST) list.children[which]?.append(' ', does);
}

/** @param {Checked} checked @returns {string} */
export function summary({ findings, bytes, loose }) {
  const mistakes = findings.filter((each) => each.severity === 'mistake').length;
  const warnings = findings.length - mistakes;
  const parts = [];
  if (mistakes) parts.push(text('mistakes', { count: mistakes }));
  else if (!loose) parts.push(text('right', { bytes }));
  if (loose) parts.push(text('loose', { count: loose }));
  if (warnings) parts.push(text('warnings', { count: warnings }));
  return parts.join(mistakes || loose ? ', ' : ' ');
}
