// Has the newest program compiled, one text at a time, and says what the compiler says of it.

import { pageState } from '../page/page_state.js';

/** @typedef {import('../python.js').Checked} Checked */

const TYPING_MS = 150; // of silence before a text is compiled
const PAUSE_MS = 300; // after which it is tried what buttons do
const { dataset } = document.documentElement;

export class Checking {
  #python;
  #fail;
  /** The newest answer, and what it is about. @type {{key: string, answer: Checked | null}} */
  #newest = { key: '', answer: null };
  #isReady = false;
  #isBusy = false;
  #typing = 0;
  #pause = 0;
  #turn = 0; // of an answer: the same one may be said again
  /** Those who wait for the newest answer. @type {((answer: Checked | null) => void)[]} */
  #waiting = [];

  /**
   * @param {import('../python.js').Python} python
   * @param {(why: unknown) => void} fail the compiler cannot say it
   */
  constructor(python, fail) {
    this.#python = python;
    this.#fail = fail;
    pageState.programText.subscribe(() => {
      this.#forget();
      clearTimeout(this.#typing);
      this.#typing = window.setTimeout(() => this.#check(), TYPING_MS);
    });
    pageState.robotName.subscribe(() => {
      this.#forget();
      this.#check();
    });
    pageState.language.subscribe(() => this.#forget());
  }

  /** Python answers from now on. */
  ready() {
    this.#isReady = true;
    this.#check();
  }

  /** It is tried again to have a compiler. */
  begins() {
    dataset['state'] = 'changed';
  }

  /** There is no compiler. */
  failed() {
    dataset['state'] = 'failed';
    this.#tell(null);
  }

  /** The same text is to be compiled again: what is said of it is in another language. */
  again() {
    this.#newest.key = '';
    this.#forget();
    this.#check();
  }

  /** What the compiler says of the newest text, as soon as it can; null if it cannot. One that did not come is tried again. @returns {Promise<Checked | null>} */
  whenChecked() {
    this.#python.again(pageState.language.value);
    return new Promise((resolve) => {
      this.#waiting.push(resolve);
      this.#check();
    });
  }

  #forget() {
    if (dataset['state'] !== 'failed') dataset['state'] = 'changed';
    pageState.checkResult.set(null);
  }

  async #check() {
    if (!this.#isReady || this.#isBusy) return;
    this.#isBusy = true;
    try {
      for (let now = asked(); this.#newest.key !== JSON.stringify(now); now = asked()) {
        const request = { do: 'check', robot: now.robot, language: now.language };
        const answer = /** @type {Checked} */ (await this.#python.ask(request, new TextEncoder().encode(now.text)));
        this.#newest = { key: JSON.stringify(now), answer };
        pageState.isRobotNamed.set(answer.names_robot);
        if (answer.robot !== now.robot && pageState.robotName.value === now.robot) pageState.robotName.set(answer.robot); // and once more
      }
      const { answer } = this.#newest;
      if (answer && pageState.checkResult.value !== answer) { // also where a text has come back
        pageState.checkResult.set(answer);
        clearTimeout(this.#pause);
        this.#turn += 1;
        this.#pause = window.setTimeout(() => this.#offer(answer, this.#turn), PAUSE_MS);
      }
      dataset['state'] = 'checked';
      dataset['image'] = answer?.image ?? '';
      this.#tell(answer);
    } catch (why) {
      this.#fail(why);
      this.#tell(null);
    } finally {
      this.#isBusy = false;
    }
  }

  /**
   * Tries what the buttons do, one after the other: each is a whole check.
   * @param {Checked} answer
   * @param {number} turn
   */
  async #offer(answer, turn) {
    const isNewest = () => pageState.checkResult.value === answer && this.#turn === turn;
    try {
      for (const [which, finding] of answer.findings.entries()) {
        if (!isNewest()) return;
        if (!finding.may_repair) continue;
        const request = { do: 'repair', robot: pageState.robotName.value, which };
        finding.repair ??= (await this.#python.ask(request, new TextEncoder().encode(pageState.programText.value))).changes;
        if (isNewest() && finding.repair?.length) pageState.offeredFindingIndex.set(which);
      }
    } catch (why) {
      this.#fail(why);
    }
  }

  /** @param {Checked | null} answer */
  #tell(answer) {
    for (const each of this.#waiting.splice(0)) each(answer);
  }
}

/** What the compiler is asked about now. */
function asked() {
  return { text: pageState.programText.value, robot: pageState.robotName.value, language: pageState.language.value };
}
