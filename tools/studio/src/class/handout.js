// What the teacher gives to every pupil: the program in the studio, one of My programs, or a lesson.

import { makeWindow } from './windows.js';
import { makeButton, makeElement } from '../page/made.js';
import { setText } from '../page/elements.js';
import { loadVersions, isSameProgramAs, versionTitle } from '../programs/versions.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, text } from '../page/texts.js';
import { CLASS } from '../page/words.js';

/** @typedef {{lesson: number} | {text: string, robot: string}} Handout */

export class HandoutWindow {
  dialog;
  #page;
  #lessonCount = 0;
  #choiceSelect = makeElement('select');
  /** @type {Handout[]} in the order of the choices */
  #handouts = [];
  #statusElement = makeElement('p');

  /** @param {import('./classroom.js').Page} page @param {(handout: Handout) => void} giveToAll */
  constructor(page, giveToAll) {
    this.#page = page;
    this.dialog = makeWindow('class_handout_window', 'class_hand_out');
    this.#statusElement.setAttribute('role', 'status');
    const giveButton = makeButton('class_hand_out', () => {
      const handout = this.#handouts[this.#choiceSelect.selectedIndex];
      if (!handout) return;
      if ('text' in handout && (!handout.text.trim() || handout.text.length > CLASS.text_characters)) {
        setText(this.#statusElement, text(handout.text.trim() ? 'class_handout_long' : 'class_handout_empty'));
        return;
      }
      this.dialog.close();
      giveToAll(handout);
    });
    this.#choiceSelect.dataset['label'] = 'class_handout_what';
    this.dialog.append(makeElement('section', '', makeElement('p', 'class_handout_told'), makeElement('p', '', this.#choiceSelect, giveButton), this.#statusElement));
  }

  /** @param {number} lessonCount how many lessons there are */
  async open(lessonCount) {
    this.#lessonCount = lessonCount;
    setText(this.#statusElement, '');
    this.#showChoices([]);
    this.dialog.showModal();
    const { lessons } = await this.#page.python.ask({ do: 'lesson_titles', language: currentLanguage() });
    this.#showChoices(lessons.map((/** @type {{title: string, block_title: string}} */ lesson) => (pageState.view.value === 'blocks' ? lesson.block_title : lesson.title)));
  }

  /** @param {string[]} titles of the lessons, once they are known */
  #showChoices(titles) {
    const { text: programText, robot } = this.#page.work, isOpenProgram = isSameProgramAs({ text: programText, robot });
    const versions = loadVersions().filter((version) => !isOpenProgram(version));
    const chosenIndex = Math.max(0, this.#choiceSelect.selectedIndex);
    const lessonNumbers = Array.from({ length: this.#lessonCount }, (_, index) => index + 1);
    this.#handouts = [{ text: programText, robot }, ...versions, ...lessonNumbers.map((number) => ({ lesson: number }))];
    this.#choiceSelect.setAttribute('aria-label', text('class_handout_what'));
    this.#choiceSelect.replaceChildren(
      new Option(text('class_handout_this')),
      makeOptionGroup(text('my_programs'), versions.map((version, index) => versionTitle(version, index + 1))),
      makeOptionGroup(text('lessons'), lessonNumbers.map((number) => `${number}. ${titles[number - 1] ?? ''}`)),
    );
    this.#choiceSelect.selectedIndex = chosenIndex;
  }
}

/** @param {string} label @param {string[]} titles */
function makeOptionGroup(label, titles) {
  const group = makeElement('optgroup');
  group.label = label;
  group.append(...titles.map((title) => new Option(title)));
  return group;
}
