// The start screen: pictures that begin with a robot that moves, earlier programs, and ways onward.

import { element } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { loadProgress } from '../lesson/progress.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, textKey, text } from '../page/texts.js';
import { versionTitle, loadVersions } from '../programs/versions.js';
import { BEGINNINGS } from './beginnings.js';
import { isStartShown, showScreen } from './screens.js';
import { makeThumbnail } from './thumbnail.js';

/**
 * @typedef {object} Page what the start needs of the page
 * @property {(program: {text: string, robot: string, name: string}) => void} putProgram another program into the editor
 * @property {(world: string) => Promise<void>} runInWorld the program in a world
 * @property {() => void} onProgramShown the program is seen from now on
 * @property {(button: string) => void} showSide shows what its button does
 * @property {() => void} leaveProgram the program
 */

const MAX_PROGRAMS = 6; // earlier programs; all are in their window

export class Start {
  #page;
  #isBeginning = false; // a robot is to move before anything else

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    for (const beginButton of document.querySelectorAll('[data-begin]')) {
      beginButton.addEventListener('click', () => this.#beginWith(String(beginButton.getAttribute('data-begin'))));
    }
    element('home', HTMLButtonElement).addEventListener('click', () => showScreen('start'));
    for (const [wayName, sideId, focusId] of /** @type {const} */ ([
      ['write', 'side_virtual', 'writing'], ['lessons', 'side_lessons', 'lesson_page'], ['robot', 'side_real', 'side_real'],
    ])) {
      element(`start_${wayName}`, HTMLButtonElement).addEventListener('click', () => {
        showScreen('program');
        this.#page.showSide(sideId);
        element(focusId, HTMLElement).focus({ preventScroll: true });
      });
    }
    pageState.screen.subscribe((screen) => {
      if (screen === 'start') this.#page.leaveProgram();
      else if (!this.#isBeginning) this.#page.onProgramShown();
      this.#showPrograms();
      element(screen === 'start' ? 'start' : 'home', HTMLElement).focus({ preventScroll: true });
    });
    for (const observable of [pageState.language, pageState.view]) observable.subscribe(() => this.#showPrograms());
    if (isStartShown()) this.#showPrograms();
    else page.onProgramShown();
  }

  /** @param {string} name */
  async #beginWith(name) {
    const { text: programText, robot: robotName, world: worldName } = BEGINNINGS[name] ?? { text: '', robot: '', world: '' };
    this.#isBeginning = true;
    this.#page.putProgram({ text: programText, robot: robotName, name: `${text(textKey(`begin_${name}`)).toLowerCase()}.ts` });
    this.#page.showSide('side_virtual');
    element('stop', HTMLButtonElement).focus();
    try {
      await this.#page.runInWorld(worldName);
    } finally {
      this.#isBeginning = false;
      this.#page.onProgramShown();
    }
  }

  /** Shows beside the lessons what they have brought. */
  #showProgress() {
    const badge = element('start_badge', HTMLElement), progress = loadProgress(), { done, lessons, stars, most } = progress;
    badge.hidden = !stars;
    const shownProgress = makeElement('span', '', `✓ ${done}/${lessons}  ★ ${stars}/${most}`), spokenProgress = makeElement('span', '', text('lesson_progress', progress));
    shownProgress.ariaHidden = 'true';
    spokenProgress.className = 'heard';
    badge.replaceChildren(shownProgress, spokenProgress);
  }

  /** Shows the earlier programs as they are now, in the page's language. */
  #showPrograms() {
    if (!isStartShown()) return;
    this.#showProgress();
    const timeFormat = new Intl.DateTimeFormat(currentLanguage(), { dateStyle: 'short', timeStyle: 'short' });
    const rows = loadVersions().map((version, index, versions) => /** @type {const} */ ([version, versions.length - index])).slice(0, MAX_PROGRAMS).map(([version, number]) => {
      const titleElement = makeElement('strong', '', versionTitle(version, number)), timeElement = makeElement('time', '', timeFormat.format(new Date(version.at_ms)));
      return makeElement('li', '', makeButton('', () => this.#page.putProgram(version), makeThumbnail(version.text, version.robot), titleElement, timeElement));
    });
    element('start_programs_title', HTMLElement).hidden = !rows.length;
    element('start_programs', HTMLElement).replaceChildren(...rows);
  }
}
