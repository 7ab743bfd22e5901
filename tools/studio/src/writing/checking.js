// Has the newest program compiled, one text at a time, and says what the compiler says of it.

import { so } from '../page/so.js';

/** @typedef {import('../python.js').Checked} Checked */

const TYPING_MS = 150; // of silence before a text is compiled
const { dataset } = document.documentElement;

export class Checking {
  #python;
  #fail;
  /** The newest answer, and what it is about. @type {{key: string, answer: Checked | null}} */
  #newest = { key: '', answer: null };
  #isReady = false;
  #isBusy = false;
  #typing = 0;
  /** Those who wait for the newest answer. @type {((answer: Checked | null) => void)[]} */
  #waiting = [];

  /**
   * @param {import('../python.js').Python} python
   * @param {(why: unknown) => void} fail the compiler cannot say it
   */
  constructor(python, fail) {
    this.#python = python;
    this.#fail = fail;
    so.text.watch(() => {
      this.#forget();
      clearTimeout(this.#typing);
      this.#typing = window.setTimeout(() => this.#check(), TYPING_MS);
    });
    so.robot.watch(() => {
      this.#forget();
      this.#check();
    });
    so.language.watch(() => this.#forget());
  }

  /** Python answers from now on. */
  ready() {
    this.#isReady = true;
    this.#check();
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

  /** What the compiler says of the newest text, as soon as it can; null if it cannot. @returns {Promise<Checked | null>} */
  whenChecked() {
    if (dataset['state'] === 'failed') return Promise.resolve(null);
    return new Promise((resolve) => {
      this.#waiting.push(resolve);
      this.#check();
    });
  }

  #forget() {
    if (dataset['state'] !== 'failed') dataset['state'] = 'changed';
    so.checked.say(null);
  }

  async #check() {
    if (!this.#isReady || this.#isBusy) return;
    this.#isBusy = true;
    try {
      for (let now = asked(); this.#newest.key !== JSON.stringify(now); now = asked()) {
        const request = { do: 'check', robot: now.robot, language: now.language };
        const answer = /** @type {Checked} */ (await this.#python.ask(request, new TextEncoder().encode(now.text)));
        this.#newest = { key: JSON.stringify(now), answer };
        so.isRobotNamed.say(answer.names_robot);
        if (answer.robot !== now.robot && so.robot.value === now.robot) so.robot.say(answer.robot); // and once more
      }
      const { answer } = this.#newest;
      if (answer && so.checked.value !== answer) so.checked.say(answer); // also where a text has come back
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

  /** @param {Checked | null} answer */
  #tell(answer) {
    for (const each of this.#waiting.splice(0)) each(answer);
  }
}

/** What the compiler is asked about now. */
function asked() {
  return { text: so.text.value, robot: so.robot.value, language: so.language.value };
}
