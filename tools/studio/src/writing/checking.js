// Has the newest program compiled, one text at a time, and says what the compiler says of it.

import { pageState } from '../page/page_state.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */

const DEBOUNCE_MS = 150; // of silence before a text is compiled
const REPAIR_DELAY_MS = 300; // after which it is tried what buttons do
const { dataset } = document.documentElement;

export class Checker {
  #python;
  #onFail;
  /** The newest answer, and what it is about. @type {{key: string, answer: CheckResult | null}} */
  #newestCheck = { key: '', answer: null };
  #isReady = false;
  #isBusy = false;
  #debounceTimer = 0;
  #repairTimer = 0;
  #answerCount = 0; // of an answer: the same one may be said again
  /** Those who wait for the newest answer. @type {((answer: CheckResult | null) => void)[]} */
  #waitingResolvers = [];

  /**
   * @param {import('../python.js').Python} python
   * @param {(error: unknown) => void} onFail the compiler cannot say it
   */
  constructor(python, onFail) {
    this.#python = python;
    this.#onFail = onFail;
    pageState.programText.subscribe(() => {
      this.#forgetAnswer();
      clearTimeout(this.#debounceTimer);
      this.#debounceTimer = window.setTimeout(() => this.#check(), DEBOUNCE_MS);
    });
    pageState.robotName.subscribe(() => {
      this.#forgetAnswer();
      this.#check();
    });
    pageState.language.subscribe(() => this.#forgetAnswer());
  }

  /** Python answers from now on. */
  markReady() {
    this.#isReady = true;
    this.#check();
  }

  /** It is tried again to have a compiler. */
  markRetry() {
    dataset['state'] = 'changed';
  }

  /** There is no compiler. */
  markFailed() {
    dataset['state'] = 'failed';
    this.#resolveWaiting(null);
  }

  /** The same text is to be compiled again: what is said of it is in another language. */
  checkAgain() {
    this.#newestCheck.key = '';
    this.#forgetAnswer();
    this.#check();
  }

  /** What the compiler says of the newest text, as soon as it can; null if it cannot. One that did not come is tried again. @returns {Promise<CheckResult | null>} */
  whenChecked() {
    this.#python.tryAgain(pageState.language.value);
    return new Promise((resolve) => {
      this.#waitingResolvers.push(resolve);
      this.#check();
    });
  }

  #forgetAnswer() {
    if (dataset['state'] !== 'failed') dataset['state'] = 'changed';
    pageState.checkResult.set(null);
  }

  async #check() {
    if (!this.#isReady || this.#isBusy) return;
    this.#isBusy = true;
    try {
      for (let source = currentSource(); this.#newestCheck.key !== JSON.stringify(source); source = currentSource()) {
        const request = { do: 'check', robot: source.robot, language: source.language };
        const answer = /** @type {CheckResult} */ ({ ...await this.#python.ask(request, new TextEncoder().encode(source.text)), text: source.text });
        this.#newestCheck = { key: JSON.stringify(source), answer };
        pageState.isRobotNamed.set(answer.names_robot);
        if (answer.robot !== source.robot && pageState.robotName.value === source.robot) pageState.robotName.set(answer.robot); // and once more
      }
      const { answer } = this.#newestCheck;
      if (answer && pageState.checkResult.value !== answer) { // also where a text has come back
        pageState.checkResult.set(answer);
        clearTimeout(this.#repairTimer);
        this.#answerCount += 1;
        this.#repairTimer = window.setTimeout(() => this.#tryRepairs(answer, this.#answerCount), REPAIR_DELAY_MS);
      }
      dataset['state'] = 'checked';
      dataset['image'] = answer?.image ?? '';
      this.#resolveWaiting(answer);
    } catch (error) {
      this.#onFail(error);
      this.#resolveWaiting(null);
    } finally {
      this.#isBusy = false;
    }
  }

  /**
   * Tries what the buttons do, one after the other: each is a whole check.
   * @param {CheckResult} answer
   * @param {number} answerNumber
   */
  async #tryRepairs(answer, answerNumber) {
    const isNewest = () => pageState.checkResult.value === answer && this.#answerCount === answerNumber;
    try {
      for (const [findingIndex, finding] of answer.findings.entries()) {
        if (!isNewest()) return;
        if (!finding.may_repair) continue;
        const request = { do: 'repair', robot: pageState.robotName.value, which: findingIndex };
        finding.repair ??= (await this.#python.ask(request, new TextEncoder().encode(pageState.programText.value))).changes;
        if (isNewest() && finding.repair?.length) pageState.offeredFindingIndex.set(findingIndex);
      }
    } catch (error) {
      this.#onFail(error);
    }
  }

  /** @param {CheckResult | null} answer */
  #resolveWaiting(answer) {
    for (const resolve of this.#waitingResolvers.splice(0)) resolve(answer);
  }
}

/** What the compiler is asked about now. */
function currentSource() {
  return { text: pageState.programText.value, robot: pageState.robotName.value, language: pageState.language.value };
}
