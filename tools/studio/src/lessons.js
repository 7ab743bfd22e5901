// The lessons beside the program: one is chosen, its page is read, and the program is checked by it.
//
// The check is that of the command, in the worker. It goes on a little at a time, so that it can be
// ended and nothing else has to wait for it.

import { element } from './elements.js';
import { pageOf } from './lesson_page.js';
import { keepDone, lessonsDone } from './progress.js';
import { currentLanguage, text } from './texts.js';

/** @typedef {{name: string, title: string, robot: string, worlds: number}} Lesson */
/** @typedef {{verdict: '' | 'passed' | 'failed' | 'mistakes', seed: number, worlds: number, said: string[]}} Answer */
/**
 * @typedef {object} Page what the lessons need of the page
 * @property {import('./python.js').Python} python
 * @property {() => string} program
 * @property {(robot: string) => void} setRobot
 * @property {(program: {text: string, robot: string}) => void} put another program into the editor
 * @property {(lesson: number, seed: number, label: () => string) => Promise<void>} showWorld
 * @property {(note: string) => void} tell
 */

/** What is said of each verdict, where a lesson has one world, and where it has several. */
const SAID = /** @type {const} */ ({
  passed: ['lesson_passed', 'lesson_passed_worlds'],
  failed: ['lesson_failed', 'lesson_failed_world'],
  mistakes: ['lesson_mistakes', 'lesson_mistakes'],
});
const ARCHIVE = 'lessons.zip'; // named where it cannot be fetched
const BUSY_MS = 40; // of the worker's time for a part of a check
const LEAST_MS = 20; // of the robot's time in a part, and the most
const MOST_MS = 2000;

export class Lessons {
  #page;
  /** @type {Lesson[]} */
  #lessons = [];
  #number = 1;
  #seed = 1; // of the world that is looked at
  #checks = 0; // the newest one goes on; others have been ended
  #asked = 0;
  #isShown = false;
  #choice = element('lesson', HTMLSelectElement);
  #check = element('lesson_check', HTMLButtonElement);
  #end = element('lesson_end', HTMLButtonElement);
  #said = element('lesson_said', HTMLElement);
  #findings = element('lesson_findings', HTMLElement);
  #world = element('lesson_world', HTMLButtonElement);

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    element('side_lessons', HTMLButtonElement).addEventListener('click', () => this.#show());
    this.#choice.addEventListener('change', () => {
      this.#choose(Number(this.#choice.value)).catch((why) => this.#fail(why));
    });
    this.#check.addEventListener('click', () => this.#begin());
    this.#end.addEventListener('click', () => {
      this.#forget();
      this.#said.textContent = text('lesson_ended');
      this.#check.focus();
    });
    this.#world.addEventListener('click', () => {
      this.#seeWorld().catch((why) => this.#fail(why));
    });
    this.#setReady(false);
  }

  setLanguage() {
    if (this.#isShown) this.#fetch();
  }

  /** The program is another one: what was said of the one before is not of it. */
  textChanged() {
    if (this.#isShown) this.#forget();
  }

  #show() {
    if (this.#isShown) return;
    this.#isShown = true;
    this.#fetch();
  }

  /** Ends a check and forgets what was said. */
  #forget() {
    this.#checks += 1;
    this.#seed = 1;
    this.#end.hidden = true;
    this.#check.hidden = false;
    this.#findings.replaceChildren();
    delete this.#said.dataset['verdict'];
    this.#said.textContent = this.#lessons.length
      ? text('lessons_done', { done: this.#done().length, all: this.#lessons.length }) : '';
  }

  #done() {
    const done = lessonsDone();
    return this.#lessons.filter(({ name }) => done.has(name));
  }

  /** @param {boolean} isReady */
  #setReady(isReady) {
    this.#choice.disabled = this.#check.disabled = this.#world.disabled = !isReady;
  }

  /** Fetches the names of the lessons and the page of the one that is chosen. */
  async #fetch() {
    const asked = ++this.#asked;
    this.#said.textContent = text('lessons_coming');
    const language = currentLanguage();
    try {
      const { lessons } = await this.#page.python.ask({ do: 'lesson_titles', language });
      if (asked !== this.#asked) return;
      this.#lessons = lessons;
      this.#list();
      await this.#choose(this.#number);
    } catch (why) {
      this.#isShown = false;
      this.#setReady(false);
      if (String(why).includes(ARCHIVE)) this.#said.textContent = text('lessons_unreachable');
      else this.#fail(why);
    }
  }

  #list() {
    const done = new Set(this.#done());
    this.#choice.replaceChildren(...this.#lessons.map((lesson, k) => {
      const mark = done.has(lesson) ? ` ✓ ${text('lesson_is_done')}` : '';
      return new Option(`${k + 1}. ${lesson.title}${mark}`, String(k + 1));
    }));
    this.#choice.value = String(this.#number);
  }

  /** @param {number} number */
  async #choose(number) {
    const asked = ++this.#asked;
    const language = currentLanguage();
    const place = element('lesson_page', HTMLElement);
    this.#number = number;
    this.#choice.value = String(number);
    this.#forget();
    const { blocks } = await this.#page.python.ask({ do: 'lesson_page', number, language });
    if (asked !== this.#asked) return;
    const { robot } = /** @type {Lesson} */ (this.#lessons[number - 1]);
    place.replaceChildren(...pageOf(blocks, (program) => {
      this.#page.put({ text: program, robot });
      this.#page.tell(text('lesson_used'));
    }));
    place.scrollTop = 0;
    this.#setReady(true);
  }

  async #seeWorld() {
    const { worlds, robot } = /** @type {Lesson} */ (this.#lessons[this.#number - 1]);
    const values = { number: this.#number, seed: this.#seed };
    this.#page.setRobot(robot);
    await this.#page.showWorld(values.number, values.seed,
      () => text(worlds > 1 ? 'world_of_lessons' : 'world_of_lesson', values));
  }

  async #begin() {
    this.#forget();
    const check = this.#checks;
    const number = this.#number;
    const program = new TextEncoder().encode(this.#page.program());
    const { worlds } = /** @type {Lesson} */ (this.#lessons[number - 1]);
    this.#check.hidden = true;
    this.#end.hidden = false;
    this.#end.focus();
    this.#said.textContent = text('lesson_checking', { seed: 1, worlds });
    let most_ms = LEAST_MS;
    try {
      await this.#page.python.ask({ do: 'lesson_check', number, language: currentLanguage() }, program);
      while (check === this.#checks) {
        const began = performance.now();
        /** @type {Answer} */
        const answer = await this.#page.python.ask({ do: 'lesson_go', most_ms });
        if (check !== this.#checks) return;
        if (answer.verdict) {
          this.#tell({ ...answer, verdict: answer.verdict });
          return;
        }
        this.#said.textContent = text('lesson_checking', { seed: answer.seed, worlds });
        const part = BUSY_MS / Math.max(1, performance.now() - began);
        most_ms = Math.round(Math.min(MOST_MS, Math.max(LEAST_MS, most_ms * Math.min(4, part))));
      }
    } catch (why) {
      if (check !== this.#checks) return;
      this.#fail(why);
    }
  }

  /** @param {unknown} why */
  #fail(why) {
    this.#forget();
    this.#said.textContent = text('bug', { why: String(why).split('\n').filter(Boolean).at(-1) ?? '' });
  }

  /** @param {Answer & {verdict: keyof typeof SAID}} answer */
  #tell({ verdict, seed, worlds, said }) {
    const hadFocus = document.activeElement === this.#end;
    const lesson = /** @type {Lesson} */ (this.#lessons[this.#number - 1]);
    const isKept = verdict !== 'passed' || keepDone(lesson.name);
    this.#forget();
    if (verdict === 'passed') this.#list();
    if (seed) this.#seed = seed;
    this.#said.dataset['verdict'] = verdict;
    const [alone, inWorlds] = SAID[verdict];
    const isInWorlds = worlds > 1 && (seed > 0 || verdict === 'passed');
    this.#said.textContent = text(isInWorlds ? inWorlds : alone, { number: this.#number, worlds, seed });
    this.#findings.replaceChildren(...said.map((sentence) => {
      const row = document.createElement('li');
      row.textContent = sentence;
      return row;
    }));
    if (!isKept) this.#page.tell(text('not_kept'));
    if (hadFocus) this.#check.focus();
  }
}
