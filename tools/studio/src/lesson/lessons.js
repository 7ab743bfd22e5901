// The lessons beside the simulator: one step at a time, and at the end a check of the program.
//
// The check is that of the command, in the worker. It goes on a little at a time, so that it can be
// ended and nothing else has to wait for it. Then the run that was judged is seen.

import { element } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { bugSentence } from '../page/faults.js';
import { labelOfBlock, labelOfWord } from '../blocks/said.js';
import { Pictures } from '../blocks/drawn.js';
import { elementOf, filled } from './page.js';
import { celebrate } from './celebration.js';
import { keepDone, keepStars, lessonsDone, starsInAll } from './progress.js';
import { replaceOptions, pictureOption, worldPicture } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';

/** @typedef {{name: string, title: string, block_title: string, robot: string, worlds: number, world: import('../world/parts.js').World}} Lesson */
/** @typedef {{text: string, robot: string, name: string}} Program */
/** @typedef {{blocks: import('./page.js').Block[], hint: string}} Step */
/** @typedef {{lesson: number, seed: number, until_ms: number}} JudgedRun */
/**
 * @typedef {object} Answer
 * @property {'' | 'passed' | 'failed' | 'mistakes'} verdict
 * @property {number} seed
 * @property {number} worlds
 * @property {string[]} said
 * @property {string[]} block_said the same for who sees blocks
 * @property {Record<string, import('../blocks/said.js').SpokenBlock>} spoken what each code in it is as a block
 * @property {{seed: number, until_ms: number} | null} run
 */
/**
 * @typedef {object} Page what the lessons need of the page
 * @property {import('../python.js').Python} python
 * @property {import('../programs/work.js').Work} work
 * @property {(program: Program) => void} put another program into the editor, which is seen then
 * @property {(program: Program) => void} exchange it, whatever is seen
 * @property {import('../virtual/simulator_panel.js').SimulatorPanel} driving
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

const MORE = 4; // pixels below that nobody misses

export class Lessons {
  #page;
  /** @type {Lesson[]} */
  #lessons = [];
  #number = 1;
  /** @type {Step[]} */
  #steps = [];
  /** The same for who sees blocks. @type {Step[]} */
  #blockSteps = [];
  #step = 0;
  #checks = 0; // the newest one goes on; others have been ended
  #asked = 0;
  #isShown = false;
  #choice = element('lesson', HTMLSelectElement);
  #check = element('lesson_check', HTMLButtonElement);
  #end = element('lesson_end', HTMLButtonElement);
  #said = element('lesson_said', HTMLElement);
  #findings = element('lesson_findings', HTMLElement);
  #next = element('lesson_next', HTMLButtonElement);
  #hint = element('lesson_hint', HTMLDetailsElement);
  #pictures;
  /** What each code in the lesson's sentences is as a block. @type {Record<string, import('../blocks/said.js').SpokenBlock>} */
  #spoken = {};
  /** What the check has found. @type {{said: string[], block_said: string[]}} */
  #found = { said: [], block_said: [] };
  #hasPassed = false;
  #isPlaying = false;
  /** This person's program, which comes back after the lesson. @type {Program | null} */
  #own = null;
  #ownName = ''; // of the lesson's program

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#pictures = new Pictures(page.python, 'lesson_blocks');
    element('side_lessons', HTMLButtonElement).addEventListener('click', () => this.#show());
    this.#choice.addEventListener('change', () => {
      this.#choose(Number(this.#choice.value)).catch((why) => this.#fail(why));
    });
    this.#check.addEventListener('click', () => this.#begin());
    this.#end.addEventListener('click', () => {
      if (this.#isPlaying) {
        this.#page.driving.stop(); // which shows the verdict
        return;
      }
      this.#forget();
      this.#said.textContent = text('lesson_ended');
      this.#check.focus();
    });
    this.#next.addEventListener('click', (event) => {
      if (isSecondPress(event)) return; // one step is seen after the other
      if (this.#step < this.#steps.length - 1) this.#go(this.#step + 1);
      else this.#choose(this.#number + 1).catch((why) => this.#fail(why));
    });
    pageState.language.subscribe(() => {
      this.#pictures.updateLanguage();
      if (this.#isShown) this.#fetch();
    });
    pageState.areWordsShown.subscribe(() => {
      this.#pictures.updateLanguage();
      this.#fill();
    });
    pageState.view.subscribe(() => {
      if (this.#lessons.length) this.#list();
      this.#fill();
    });
    pageState.robotName.subscribe(() => this.#fill());
    pageState.sideId.subscribe((side) => {
      if (side !== 'side_lessons' && !this.#page.work.text.trim()) this.leave();
    });
    pageState.programText.subscribe(() => { // what was said of the one before is not of it
      if (this.#isShown) this.#forget();
    });
    const place = element('lesson_page', HTMLElement);
    const tellMore = () => place.classList.toggle('more', place.scrollTop + place.clientHeight < place.scrollHeight - MORE);
    place.addEventListener('scroll', tellMore, { passive: true });
    const watcher = new ResizeObserver(tellMore);
    for (const each of [place, element('lesson_step', HTMLElement)]) watcher.observe(each);
    this.#setReady(false);
  }

  #show() {
    if (this.#isShown) {
      if (this.#steps.length) this.#enter().catch((why) => this.#fail(why));
      return;
    }
    this.#isShown = true;
    this.#fetch();
  }

  /** Ends a check and forgets what was said. */
  #forget() {
    this.#checks += 1;
    this.#isPlaying = this.#hasPassed = false;
    this.#end.hidden = true;
    this.#end.textContent = text('lesson_end');
    this.#lay();
    this.#find({ said: [], block_said: [] });
    delete this.#said.dataset['verdict'];
    this.#said.textContent = '';
    element('lesson_stars', HTMLElement).textContent = '';
  }

  /** @param {boolean} isReady */
  #setReady(isReady) {
    this.#choice.disabled = this.#check.disabled = this.#next.disabled = !isReady;
  }

  /** Fetches the names of the lessons and the page of the one that is chosen. */
  async #fetch() {
    const asked = ++this.#asked;
    this.#said.textContent = text('lessons_coming');
    const language = currentLanguage();
    try {
      this.#page.python.again(language);
      const { lessons } = await this.#page.python.ask({ do: 'lesson_titles', language });
      if (asked !== this.#asked) return;
      this.#lessons = lessons;
      if (!this.#steps.length) this.#number = 1 + Math.max(0, this.#lessons.findIndex(({ name }) => !lessonsDone().has(name)));
      this.#list();
      await this.#choose(this.#number);
    } catch (why) {
      this.#isShown = false;
      this.#setReady(false);
      if (document.documentElement.dataset['state'] === 'failed') this.#said.textContent = text('no_compiler');
      else if (String(why).includes(ARCHIVE)) this.#said.textContent = text('lessons_unreachable');
      else this.#fail(why);
    }
  }

  #list() {
    const done = lessonsDone();
    replaceOptions(this.#choice, this.#lessons.map((lesson, k) => {
      const mark = done.has(lesson.name) ? ` ✓ ${text('lesson_is_done')}` : '';
      return pictureOption(`${k + 1}. ${this.#titleOf(lesson)}${mark}`, String(k + 1), worldPicture(lesson.world));
    }));
    this.#choice.value = String(this.#number);
  }

  get #areBlocks() {
    return pageState.view.value === 'blocks';
  }

  /** @param {Lesson} lesson */
  #titleOf(lesson) {
    return this.#areBlocks ? lesson.block_title : lesson.title;
  }

  /** @param {number} number */
  async #choose(number) {
    const asked = ++this.#asked;
    const language = currentLanguage();
    this.#forget();
    const { steps, block_steps, offered, needed, new: fresh, spoken } = await this.#page.python.ask({ do: 'lesson_steps', number, language });
    if (asked !== this.#asked) return;
    const isOther = number !== this.#number || !this.#steps.length;
    this.#number = number; // from now on: until then the one before is seen and checked
    this.#choice.value = String(number);
    this.#steps = steps;
    this.#blockSteps = block_steps;
    this.#spoken = spoken;
    pageState.taughtBlocks.set({ offered, needed, fresh });
    this.#go(isOther ? 0 : this.#step);
    if (isOther && !element('lessons', HTMLElement).hidden) await this.#enter();
    this.#setReady(true);
  }

  /** Shows a step. @param {number} step */
  #go(step) {
    this.#step = step;
    const place = element('lesson_page', HTMLElement);
    this.#fill();
    place.dataset['lesson'] = String(this.#number);
    element('lesson_page', HTMLElement).scrollTop = 0;
    this.#hint.open = false;
    this.#hint.hidden = !this.#steps[step]?.hint;
    element('lesson_steps', HTMLElement).replaceChildren(...this.#steps.map((_, k) => {
      const isTask = k === this.#steps.length - 1;
      const tile = makeButton('', () => {
        this.#go(k);
        element('lesson_steps', HTMLElement).querySelectorAll('button')[k]?.focus();
      }, isTask ? '★' : String(k + 1));
      tile.ariaLabel = isTask ? text('lesson_task') : text('lesson_step', { number: k + 1 });
      if (k === step) tile.setAttribute('aria-current', 'step');
      return makeElement('li', '', tile);
    }));
    this.#lay();
  }

  /** Shows what the step says and what a check has found, as this person writes programs. */
  #fill() {
    const step = (this.#areBlocks ? this.#blockSteps : this.#steps)[this.#step], lesson = this.#lessons[this.#number - 1];
    if (!step || !lesson) return;
    const reader = this.#readerOf(lesson);
    element('lesson_name', HTMLElement).textContent = this.#titleOf(lesson);
    element('lesson_step', HTMLElement).replaceChildren(...step.blocks.map((block) => elementOf(block, reader)));
    element('lesson_hint_said', HTMLElement).replaceChildren(filled('span', step.hint, reader));
    this.#find(this.#found);
  }

  /** @param {{said: string[], block_said: string[]}} found */
  #find(found) {
    this.#found = found;
    const lesson = this.#lessons[this.#number - 1];
    const said = this.#areBlocks ? found.block_said : found.said;
    this.#findings.replaceChildren(...lesson ? said.map((sentence) => filled('li', sentence, this.#readerOf(lesson))) : []);
  }

  /** What is done for who reads a lesson. @param {Lesson} lesson @returns {import('./page.js').Reader} */
  #readerOf(lesson) {
    return {
      use: (program) => {
        this.#page.put(this.#lend(lesson, program));
        pageState.note.set(text('lesson_used'));
      },
      say: (code) => {
        const spoken = this.#spoken[code];
        return this.#areBlocks ? spoken ? asWritten(labelOfBlock(spoken), code) : labelOfWord(code) : null;
      },
      draw: this.#areBlocks ? (program, done) => {
        this.#pictures.request(program, { text: program, robot: pageState.robotName.value }, done);
      } : null,
    };
  }

  /** Which buttons there are. Who pressed one that goes away is at the page. */
  #lay() {
    const { activeElement } = document;
    const isTask = this.#step === this.#steps.length - 1;
    this.#check.hidden = !isTask || !this.#end.hidden;
    this.#next.hidden = isTask && !(this.#hasPassed && this.#number < this.#lessons.length);
    this.#next.textContent = text(isTask ? 'lesson_other' : 'lesson_next');
    if (activeElement instanceof HTMLElement && activeElement.hidden) element('lesson_page', HTMLElement).focus();
  }

  /** Has the lesson's robot and world seen. */
  async #enter() {
    const asked = this.#asked, lesson = /** @type {Lesson} */ (this.#lessons[this.#number - 1]);
    const isForOther = await this.#isForOther(lesson);
    if (asked !== this.#asked) return;
    if (isForOther) {
      const said = text(this.#isOfLesson ? 'lesson_before' : 'lesson_own');
      this.#page.exchange(this.#lend(lesson, ''));
      pageState.note.set(said);
    }
    await this.#seeWorld(1);
  }

  /** Whether the program in the editor is right on its robot and wrong on a lesson's. @param {Lesson} lesson */
  async #isForOther(lesson) {
    const now = pageState.programText.value, robot = pageState.robotName.value;
    if (robot === lesson.robot || pageState.isRobotNamed.value || pageState.groupName.value || !now.trim()) return false;
    const program = new TextEncoder().encode(now), language = currentLanguage();
    /** @param {string} each */
    const isRight = async (each) => Boolean((await this.#page.python.ask({ do: 'check', robot: each, language }, program)).image);
    return await isRight(robot) && !(await isRight(lesson.robot)) && now === pageState.programText.value;
  }

  /** Whether the program in the editor is a lesson's, in place of this person's own one. */
  get #isOfLesson() {
    return this.#own !== null && this.#page.work.name === this.#ownName;
  }

  /** A program of the lesson, for which this person's own one steps back. @param {Lesson} lesson @param {string} program @returns {Program} */
  #lend(lesson, program) {
    const { text: whole, robot, name } = this.#page.work;
    if (!this.#isOfLesson) this.#own = { text: whole, robot, name };
    this.#ownName = `${this.#titleOf(lesson).replace(/[\\/:*?"<>|]/g, '')}.ts`;
    return { text: program, robot: lesson.robot, name: this.#ownName };
  }

  /** The lesson is over: this person's own program comes back, unless another one has been opened since. */
  leave() {
    const own = this.#isOfLesson ? this.#own : null;
    this.#own = null;
    if (!own || pageState.groupName.value) return;
    this.#page.exchange(own);
    this.#page.driving.leaveLesson();
  }

  /** @param {number} seed */
  async #seeWorld(seed) {
    const { worlds, robot } = /** @type {Lesson} */ (this.#lessons[this.#number - 1]);
    const values = { number: this.#number, seed };
    if (robot !== pageState.robotName.value && !pageState.isRobotNamed.value) pageState.robotName.set(robot);
    await this.#page.driving.showLesson(values.number, seed,
      () => text(worlds > 1 ? 'world_of_lessons' : 'world_of_lesson', values));
  }

  async #begin() {
    this.#forget();
    const check = this.#checks;
    const number = this.#number;
    const program = new TextEncoder().encode(pageState.programText.value);
    const { worlds } = /** @type {Lesson} */ (this.#lessons[number - 1]);
    this.#end.hidden = false;
    this.#lay();
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
          if (answer.run) await this.#play(answer.run, answer.worlds);
          if (check === this.#checks) this.#tell({ ...answer, verdict: answer.verdict });
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

  /** Shows what was judged, as far as it went well. @param {{seed: number, until_ms: number}} run @param {number} worlds */
  async #play({ seed, until_ms }, worlds) {
    const check = this.#checks;
    this.#isPlaying = true;
    this.#said.textContent = text('lesson_playing', { seed, worlds });
    this.#end.textContent = text('lesson_skip');
    await this.#seeWorld(seed);
    if (check === this.#checks) await this.#page.driving.play({ lesson: this.#number, seed, until_ms });
  }

  /** @param {unknown} why */
  #fail(why) {
    this.#forget();
    this.#choice.value = String(this.#number); // so that another one can be chosen again
    this.#said.textContent = bugSentence(why);
  }

  /** @param {Answer & {verdict: keyof typeof SAID}} answer */
  #tell({ verdict, seed, worlds, said, block_said, spoken }) {
    const hadFocus = document.activeElement === this.#end;
    const lesson = /** @type {Lesson} */ (this.#lessons[this.#number - 1]);
    const stars = verdict === 'passed' ? worlds : verdict === 'failed' ? Math.max(0, seed - 1) : 0;
    const areKept = keepStars(lesson.name, stars); // first: one that is done has a star
    const isKept = (verdict !== 'passed' || keepDone(lesson.name)) && areKept;
    this.#forget();
    this.#hasPassed = verdict === 'passed';
    if (this.#hasPassed) this.#list();
    this.#lay();
    this.#said.dataset['verdict'] = verdict;
    const [alone, inWorlds] = SAID[verdict];
    const isInWorlds = worlds > 1 && (seed > 0 || verdict === 'passed');
    const found = text(isInWorlds ? inWorlds : alone, { number: this.#number, worlds, seed });
    this.#said.textContent = this.#hasPassed ? `${found} ${text('lesson_total', { count: starsInAll() })}` : found;
    if (verdict !== 'mistakes') { // one for each world where it did its task
      element('lesson_stars', HTMLElement).textContent = '★'.repeat(stars) + '☆'.repeat(worlds - stars);
    }
    this.#spoken = { ...this.#spoken, ...spoken };
    this.#find({ said, block_said });
    this.#hint.open = false;
    element('lesson_page', HTMLElement).scrollTop = 0;
    if (!isKept) pageState.note.set(text('not_kept'));
    if (this.#hasPassed) {
      this.#page.driving.cheer();
      celebrate();
    }
    if (hadFocus) (this.#next.hidden ? this.#check : this.#next).focus();
  }
}

/** Names that a sentence has in small letters. @param {import('../blocks/said.js').Label} label @param {string} code */
function asWritten({ text: said, colour }, code) {
  const names = code.match(/[\p{Ll}_]{2,}/gu) ?? [];
  return { text: names.reduce((whole, name) => whole.replace(name.toUpperCase(), name), said), colour };
}
