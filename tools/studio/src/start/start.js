// The start screen: pictures that begin with a robot that moves, earlier programs, and ways onward.

import { element } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { lessonsDone, starsInAll } from '../lesson/progress.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, textKey, text } from '../page/texts.js';
import { titleOf, versions } from '../programs/versions.js';
import { BEGINNINGS } from './beginnings.js';
import { isStart, show } from './screens.js';
import { thumbnail } from './thumbnail.js';

/**
 * @typedef {object} Page what the start needs of the page
 * @property {(program: {text: string, robot: string, name: string}) => void} put another program into the editor
 * @property {(world: string) => Promise<void>} run the program in a world
 * @property {() => void} see the program, which is seen from now on
 * @property {(button: string) => void} side shows what its button does
 * @property {() => void} leave the program
 */

const MOST = 6; // earlier programs; all are in their window

export class Start {
  #page;
  #isBeginning = false; // a robot is to move before anything else

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    for (const button of document.querySelectorAll('[data-begin]')) {
      button.addEventListener('click', () => this.#begin(String(button.getAttribute('data-begin'))));
    }
    element('home', HTMLButtonElement).addEventListener('click', () => show('start'));
    for (const [way, side, place] of /** @type {const} */ ([
      ['write', 'side_virtual', 'writing'], ['lessons', 'side_lessons', 'lesson_page'], ['robot', 'side_real', 'side_real'],
    ])) {
      element(`start_${way}`, HTMLButtonElement).addEventListener('click', () => {
        show('program');
        this.#page.side(side);
        element(place, HTMLElement).focus({ preventScroll: true });
      });
    }
    pageState.screen.subscribe((screen) => {
      if (screen === 'start') this.#page.leave();
      else if (!this.#isBeginning) this.#page.see();
      this.#showPrograms();
      element(screen === 'start' ? 'start' : 'home', HTMLElement).focus({ preventScroll: true });
    });
    for (const each of [pageState.language, pageState.view]) each.subscribe(() => this.#showPrograms());
    if (isStart()) this.#showPrograms();
    else page.see();
  }

  /** @param {string} name */
  async #begin(name) {
    const { text: program, robot, world } = BEGINNINGS[name] ?? { text: '', robot: '', world: '' };
    this.#isBeginning = true;
    this.#page.put({ text: program, robot, name: `${text(textKey(`begin_${name}`)).toLowerCase()}.ts` });
    this.#page.side('side_virtual');
    element('stop', HTMLButtonElement).focus();
    try {
      await this.#page.run(world);
    } finally {
      this.#isBeginning = false;
      this.#page.see();
    }
  }

  /** Shows beside the lessons what they have brought. */
  #showProgress() {
    const badge = element('start_badge', HTMLElement), done = lessonsDone().size, stars = starsInAll();
    badge.hidden = !stars;
    const seen = makeElement('span', '', `${done ? `✓ ${done}  ` : ''}★ ${stars}`), heard = makeElement('span', '', text('lesson_progress', { done, stars }));
    seen.ariaHidden = 'true';
    heard.className = 'heard';
    badge.replaceChildren(seen, heard);
  }

  /** Shows the earlier programs as they are now, in the page's language. */
  #showPrograms() {
    if (!isStart()) return;
    this.#showProgress();
    const time = new Intl.DateTimeFormat(currentLanguage(), { dateStyle: 'short', timeStyle: 'short' });
    const rows = versions().map((version, k, all) => /** @type {const} */ ([version, all.length - k])).slice(0, MOST).map(([version, number]) => {
      const title = makeElement('strong', '', titleOf(version, number)), when = makeElement('time', '', time.format(new Date(version.at_ms)));
      return makeElement('li', '', makeButton('', () => this.#page.put(version), thumbnail(version.text, version.robot), title, when));
    });
    element('start_programs_title', HTMLElement).hidden = !rows.length;
    element('start_programs', HTMLElement).replaceChildren(...rows);
  }
}
