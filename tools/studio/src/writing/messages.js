// The list of messages beneath the editor. Everything of a program is put there as text, never
// as markup. A screen reader hears the first one.

import { labelAt, labelOfCode, findingAsSeen, sentenceAtPlace } from '../blocks/said.js';
import { element, setText } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { pageState } from '../page/page_state.js';
import { makeTextElement } from '../page/sentences.js';
import { text } from '../page/texts.js';

/** @import { CheckResult, Finding } from '../python.js' */

const MAX_MESSAGES = 50; // messages that are shown at once

/** What is said, and what to try, as one line. @param {{message?: string, fix?: string}} said @returns {string} */
export function messageWithFix({ message = '', fix = '' }) {
  const separator = /[.!?:]$/.test(message) ? ' ' : ' – ';
  return [message, fix && `${text('try')} ${fix}`].filter(Boolean).join(separator);
}

/** A finding on the page: code is shown as it looks in the program. @param {Finding} finding @returns {Node | string} */
function makeSentence(finding) {
  const { spoken, ...sentences } = finding.on_blocks;
  return pageState.areBlocksNamed.value
    ? makeTextElement('span', messageWithFix(sentences), { labelOfCode: (code) => labelOfCode(code, spoken) }) : messageWithFix(finding);
}

/**
 * @param {HTMLElement} list
 * @param {Finding[]} findings
 * @param {(finding: Finding) => void} goTo
 */
export function showMessages(list, findings, goTo) {
  let firstMessage = '';
  const rows = findings.slice(0, MAX_MESSAGES).map((finding) => {
    const programText = pageState.programText.value, placeText = pageState.areBlocksNamed.value ? labelAt(programText, finding) : text('line', { line: finding.line });
    const placeButton = makeButton('', () => goTo(finding), placeText);
    placeButton.className = 'place';
    placeButton.ariaLabel = sentenceAtPlace('say_fault', 'say_fault_block', programText, finding, { what: messageWithFix(findingAsSeen(finding)) });
    firstMessage ||= placeButton.ariaLabel;
    const row = makeElement('li', '', placeButton, ' ', makeSentence(finding));
    row.className = finding.severity;
    return row;
  });
  if (findings.length > MAX_MESSAGES) rows.push(makeElement('li', '', text('more', { count: findings.length - MAX_MESSAGES })));
  list.replaceChildren(...rows);
  setText(element('first_message', HTMLElement), firstMessage);
}

/**
 * Gives a message the button of its repair.
 * @param {HTMLElement} list that shows it
 * @param {number} findingIndex
 * @param {Finding} finding
 * @param {(finding: Finding) => void} repair
 */
export function showRepair(list, findingIndex, finding, repair) {
  const repairButton = makeButton('repair', () => repair(finding));
  repairButton.className = 'repair';
  const { fix } = findingAsSeen(finding);
  repairButton.setAttribute('aria-label', sentenceAtPlace('repair_line', 'repair_block', pageState.programText.value, finding, { fix }));
  if (findingIndex < MAX_MESSAGES) list.children[findingIndex]?.append(' ', repairButton);
}

/** @param {CheckResult} checked @returns {string} */
export function summaryOf({ findings, bytes, places, loose: looseCount }) {
  const mistakeCount = findings.filter((finding) => finding.severity === 'mistake').length;
  const warningCount = findings.length - mistakeCount;
  const parts = [];
  if (mistakeCount) parts.push(text('mistakes', { count: mistakeCount }));
  else if (!looseCount) parts.push(!places.length ? text('program_empty') : pageState.areBlocksNamed.value ? text('right_blocks') : text('right', { bytes }));
  if (looseCount) parts.push(text('loose', { count: looseCount }));
  if (warningCount) parts.push(text('warnings', { count: warningCount }));
  return parts.join(mistakeCount || looseCount ? ', ' : ' ');
}
