// On a phone the program and the robot are a screen each, over one bar with what both need: the other
// screen, Run and STOP. What the compiler says is a sheet over the blocks, which can be put away; warnings alone, which
// come and go while somebody builds with blocks, wait at their blocks until somebody asks for them, on every screen.

import { element } from './elements.js';
import { showSide } from './sides.js';
import { pageState } from './page_state.js';
import { text } from './texts.js';

/** @typedef {'program' | 'robot'} PhoneScreen */

const PHONE_QUERY = matchMedia('(max-width: 700px), (max-width: 950px) and (max-height: 540px)');
const { dataset } = document.documentElement;

export class Phone {
  #runButton = element('run', HTMLButtonElement);
  #stopButton = element('stop', HTMLButtonElement);
  #sheetButton = element('sheet', HTMLButtonElement);
  /** What somebody wants of the sheet, until the program is right again. @type {boolean | null} */
  #wantsSheetAway = null;

  #runRealRobot;

  /** @param {() => void} runRealRobot runs the program on the real robot, or says why not */
  constructor(runRealRobot) {
    this.#runRealRobot = runRealRobot;
    PHONE_QUERY.addEventListener('change', () => this.#layOut());
    // The teacher's wall has a place for STOP, and the teacher can leave it.
    new MutationObserver(() => this.#layOut()).observe(document.documentElement, { attributeFilter: ['data-wall'] });
    element('other', HTMLButtonElement).addEventListener('click', () => this.show(dataset['half'] === 'robot' ? 'program' : 'robot'));
    this.#runButton.addEventListener('click', (event) => {
      if (!('phone' in dataset)) return;
      if (dataset['side'] === 'side_real' && dataset['half'] === 'robot') {
        event.stopImmediatePropagation(); // the virtual one is not seen
        this.#runRealRobot();
        return;
      }
      const isWrong = pageState.checkResult.value?.image === '';
      if (isWrong) this.#setSheetAway(false);
      else if (dataset['side'] !== 'side_lessons') showSide('side_virtual');
      this.show(isWrong ? 'program' : 'robot');
    }, { capture: true });
    this.#sheetButton.addEventListener('click', () => this.#setSheetAway(!this.#isSheetAway));
    pageState.language.subscribe(() => this.#labelOtherButton());
    pageState.checkResult.subscribe((answer) => {
      if (!answer) return;
      this.#sheetButton.hidden = !answer.findings.length;
      this.#setSheetAway(answer.findings.length ? this.#wantsSheetAway : null);
    });
    pageState.view.subscribe(() => this.#setSheetAway(this.#wantsSheetAway));
    this.show('program');
    this.#layOut();
  }

  /** @param {PhoneScreen} screen */
  show(screen) {
    dataset['half'] = screen;
    this.#labelOtherButton();
  }

  #labelOtherButton() {
    element('other_name', HTMLElement).textContent = text(dataset['half'] === 'robot' ? 'editor' : 'half_robot');
  }

  get #isSheetAway() {
    return this.#wantsSheetAway ?? (pageState.view.value === 'blocks' && Boolean(pageState.checkResult.value?.image));
  }

  /** @param {boolean | null} isAway */
  #setSheetAway(isAway) {
    this.#wantsSheetAway = isAway;
    this.#sheetButton.setAttribute('aria-expanded', String(!this.#isSheetAway));
    element('writing', HTMLElement).dataset['sheet'] = this.#isSheetAway ? 'away' : 'up';
  }

  /** Run and STOP are where a thumb reaches them. */
  #layOut() {
    const isPhone = PHONE_QUERY.matches && !('wall' in dataset);
    if (isPhone === 'phone' in dataset) return;
    const focusedElement = document.activeElement;
    if (isPhone) {
      dataset['phone'] = '';
      element('bar', HTMLElement).append(this.#runButton, this.#stopButton);
    } else {
      delete dataset['phone'];
      element('controls', HTMLElement).prepend(this.#runButton);
      element('my_programs', HTMLElement).after(this.#stopButton);
    }
    for (const button of [this.#runButton, this.#stopButton]) if (button === focusedElement) button.focus();
  }
}
