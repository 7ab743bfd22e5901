// On a phone the program and the robot are a screen each, over one bar with what both need: the other
// screen, Run and STOP. What the compiler says is a sheet over the blocks, which can be put away.

import { element } from './elements.js';
import { showSide } from './sides.js';
import { pageState } from './page_state.js';
import { text } from './texts.js';

/** @typedef {'program' | 'robot'} Half */

const PHONE = matchMedia('(max-width: 700px), (max-width: 950px) and (max-height: 540px)');
const { dataset } = document.documentElement;

export class Phone {
  #run = element('run', HTMLButtonElement);
  #stop = element('stop', HTMLButtonElement);
  #sheet = element('sheet', HTMLButtonElement);
  #isAway = false; // the sheet, until the program is right again or somebody asks for it

  #runReal;

  /** @param {() => void} runReal runs the program on the real robot, or says why not */
  constructor(runReal) {
    this.#runReal = runReal;
    PHONE.addEventListener('change', () => this.#lay());
    // The teacher's wall has a place for STOP, and the teacher can leave it.
    new MutationObserver(() => this.#lay()).observe(document.documentElement, { attributeFilter: ['data-wall'] });
    element('other', HTMLButtonElement).addEventListener('click', () => this.show(dataset['half'] === 'robot' ? 'program' : 'robot'));
    this.#run.addEventListener('click', (event) => {
      if (!('phone' in dataset)) return;
      if (dataset['side'] === 'side_real' && dataset['half'] === 'robot') {
        event.stopImmediatePropagation(); // the virtual one is not seen
        this.#runReal();
        return;
      }
      const isWrong = pageState.checked.value?.image === '';
      if (isWrong) this.#putAway(false);
      else if (dataset['side'] !== 'side_lessons') showSide('side_virtual');
      this.show(isWrong ? 'program' : 'robot');
    }, { capture: true });
    this.#sheet.addEventListener('click', () => this.#putAway(!this.#isAway));
    pageState.language.subscribe(() => this.#name());
    pageState.checked.subscribe((answer) => {
      if (answer) this.#said(answer.findings.length);
    });
    this.show('program');
    this.#lay();
  }

  /** @param {Half} half */
  show(half) {
    dataset['half'] = half;
    this.#name();
  }

  #name() {
    element('other_name', HTMLElement).textContent = text(dataset['half'] === 'robot' ? 'editor' : 'half_robot');
  }

  /** @param {number} count of what the compiler says of the newest program */
  #said(count) {
    this.#sheet.hidden = !count;
    this.#putAway(count > 0 && this.#isAway);
  }

  /** @param {boolean} isAway */
  #putAway(isAway) {
    this.#isAway = isAway;
    this.#sheet.setAttribute('aria-expanded', String(!isAway));
    element('writing', HTMLElement).dataset['sheet'] = isAway ? 'away' : 'up';
  }

  /** Run and STOP are where a thumb reaches them. */
  #lay() {
    const isPhone = PHONE.matches && !('wall' in dataset);
    if (isPhone === 'phone' in dataset) return;
    const focus = document.activeElement;
    if (isPhone) {
      dataset['phone'] = '';
      element('bar', HTMLElement).append(this.#run, this.#stop);
    } else {
      delete dataset['phone'];
      element('controls', HTMLElement).prepend(this.#run);
      element('my_programs', HTMLElement).after(this.#stop);
    }
    for (const each of [this.#run, this.#stop]) if (each === focus) each.focus();
  }
}
