// The lessons beside the simulator: one step at a time, and at the end a check of the program.
//
// The check is that of the command, in the worker. It goes on a little at a time, so that it can be
// ended and nothing else has to wait for it. Then the run that was judged is seen.

import { element } from '../page/elements.js';
import { makeButton, makeElement } from '../page/made.js';
import { bugSentence } from '../page/faults.js';
import { labelOfCode } from '../blocks/said.js';
import { Pictures } from '../blocks/drawn.js';
import { makeBlockElement } from './page.js';
import { celebrate } from './celebration.js';
import { forgetProgram, storeDoneLesson, storeProgram, storeStars, loadPlace, storePlace, loadDoneLessons, loadStars, loadProgram, countAllStars } from './progress.js';
import { replaceOptions, makePictureOption, makeWorldPicture } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { makeTextElement } from '../page/sentences.js';
import { currentLanguage, labelOf, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';
import { robotOf } from '../page/words.js';

/** @typedef {{name: string, title: string, block_title: string, robot: string, worlds: number, world: import('../world/parts.js').World}} Lesson */
/** @typedef {import('../programs/work.js').Program & {lesson?: string}} Program `lesson` whose it is */
/** @typedef {{blocks: import('./page.js').StepBlock[], hint: string}} Step */
/** @typedef {{lesson: number, seed: number, until_ms: number}} JudgedRun */
/**
 * @typedef {object} CheckAnswer
 * @property {'' | 'passed' | 'failed' | 'mistakes'} verdict
 * @property {number} seed
 * @property {number} worlds
 * @property {string[]} said
 * @property {string[]} block_said the same for who sees blocks
 * @property {Record<string, import('../blocks/said.js').SpokenBlock>} spoken what each code in it is as a block
 * @property {{seed: number, until_ms: number} | null} run
 */
/** @typedef {{programText: string, verdict: keyof typeof VERDICT_KEYS, sentence: string, stars: string, sentences: string[], blockSentences: string[]}} Judgement */
/**
 * @typedef {object} Page what the lessons need of the page
 * @property {import('../python.js').Python} python
 * @property {import('../programs/work.js').Work} work
 * @property {(program: Program) => void} putProgram another program into the editor, which is seen then
 * @property {(program: Program) => void} exchangeProgram the same, whatever is seen
 * @property {() => boolean} keepProgram among the earlier programs; whether nothing of it would be lost
 * @property {import('../virtual/simulator_panel.js').SimulatorPanel} simulatorPanel
 */

/** What is said of each verdict, where a lesson has one world, and where it has several. */
const VERDICT_KEYS = /** @type {const} */ ({
  passed: ['lesson_passed', 'lesson_passed_worlds'],
  failed: ['lesson_failed', 'lesson_failed_world'],
  mistakes: ['lesson_mistakes', 'lesson_mistakes'],
});
const ARCHIVE_NAME = 'lessons.zip'; // named where it cannot be fetched
const PART_MS = 40; // of the worker's time for a part of a check
const MIN_ROBOT_MS = 20; // of the robot's time in a part, and the most
const MAX_ROBOT_MS = 2000;

const SCROLL_TOLERANCE_PX = 4; // pixels below that nobody misses

export class Lessons {
  #page;
  /** @type {Lesson[]} */
  #lessons = [];
  #lessonNumber = 1;
  /** @type {Step[]} */
  #steps = [];
  /** The same for who sees blocks. @type {Step[]} */
  #blockSteps = [];
  /** Where this tab was before the page was loaded. */
  #storedPlace = loadPlace();
  #stepIndex = this.#storedPlace.step;
  #checkCount = 0; // the newest one goes on; others have been ended
  #requestCount = 0;
  #isShown = false;
  #wantedLessonNumber = 0; // of the lesson that is to be opened once the lessons are known
  #lessonSelect = element('lesson', HTMLSelectElement);
  #checkButton = element('lesson_check', HTMLButtonElement);
  #endButton = element('lesson_end', HTMLButtonElement);
  #verdictElement = element('lesson_said', HTMLElement);
  #beginAnewButton = element('lesson_anew', HTMLButtonElement);
  #findingsElement = element('lesson_findings', HTMLElement);
  #nextButton = element('lesson_next', HTMLButtonElement);
  #hintElement = element('lesson_hint', HTMLDetailsElement);
  /** Where the step is above the program, on a phone. */
  #unfoldButton = element('lesson_unfold', HTMLButtonElement);
  #pictures;
  /** What each code in the lesson's sentences is as a block. @type {Record<string, import('../blocks/said.js').SpokenBlock>} */
  #spokenBlocks = {};
  /** What the newest check has said of a program. @type {Judgement | null} */
  #judgement = null;
  #isPlaying = false;

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    this.#pictures = new Pictures(page.python, 'lesson_blocks');
    element('side_lessons', HTMLButtonElement).addEventListener('click', () => this.#showLessons());
    this.#lessonSelect.addEventListener('change', () => {
      this.#chooseLesson(Number(this.#lessonSelect.value)).catch((error) => this.#showFailure(error));
    });
    this.#checkButton.addEventListener('click', () => this.#startCheck());
    this.#endButton.addEventListener('click', () => {
      if (this.#isPlaying) {
        this.#page.simulatorPanel.stop(); // which shows the verdict
        return;
      }
      this.#forgetCheck();
      this.#verdictElement.textContent = text('lesson_ended');
      this.#checkButton.focus();
    });
    this.#beginAnewButton.addEventListener('click', () => this.#beginAnew());
    this.#nextButton.addEventListener('click', (event) => {
      if (isSecondPress(event)) return; // one step is seen after the other
      if (this.#stepIndex < this.#steps.length - 1) this.#goToStep(this.#stepIndex + 1);
      else this.#chooseLesson(this.#lessonNumber + 1).catch((error) => this.#showFailure(error));
    });
    pageState.language.subscribe(() => {
      this.#pictures.updateLanguage();
      if (this.#isShown) this.#fetchLessons();
    });
    pageState.areWordsShown.subscribe(() => {
      this.#pictures.updateLanguage();
      this.#fillStep();
    });
    pageState.view.subscribe(() => {
      if (this.#lessons.length) this.#listLessons();
      this.#fillStep();
    });
    pageState.robotName.subscribe(() => this.#fillStep());
    pageState.sideId.subscribe((sideId) => {
      this.#storeCurrentPlace();
      if (sideId === 'side_lessons') return;
      const { text: programText, lesson: lessonName, own: ownProgram } = this.#page.work;
      if (!programText.trim()) this.leave();
      else if (lessonName && ownProgram?.text.trim()) pageState.note.set(text('lesson_stays'));
    });
    pageState.programText.subscribe(() => {
      if (!this.#endButton.hidden || !this.#judgement) {
        if (this.#isShown) this.#forgetCheck();
      } else this.#showJudgement();
      this.#storeCurrentProgram();
    });
    this.#unfoldButton.addEventListener('click', () => this.#setUnfolded(this.#unfoldButton.getAttribute('aria-expanded') === 'false'));
    const lessonPage = element('lesson_page', HTMLElement);
    const markMore = () => lessonPage.classList.toggle('more', lessonPage.scrollTop + lessonPage.clientHeight < lessonPage.scrollHeight - SCROLL_TOLERANCE_PX);
    lessonPage.addEventListener('scroll', markMore, { passive: true });
    const resizeObserver = new ResizeObserver(markMore);
    for (const observedElement of [lessonPage, element('lesson_step', HTMLElement)]) resizeObserver.observe(observedElement);
    this.#setReady(false);
  }

  /** A page that is loaded again comes back to the lesson that was seen. */
  reopen() {
    if (this.#storedPlace.isOpen) element('side_lessons', HTMLButtonElement).click();
  }

  #storeCurrentPlace() {
    const currentLesson = this.#steps.length ? this.#lessons[this.#lessonNumber - 1] : null;
    const place = currentLesson ? { lesson: currentLesson.name, step: this.#stepIndex } : this.#storedPlace;
    storePlace({ ...place, isOpen: pageState.sideId.value === 'side_lessons' });
  }

  #showLessons() {
    if (this.#isShown) {
      if (this.#steps.length) this.#enterLesson().catch((error) => this.#showFailure(error));
      return;
    }
    this.#isShown = true;
    this.#fetchLessons();
  }

  /** Opens a lesson, whichever is open. @param {number} lessonNumber */
  open(lessonNumber) {
    this.#wantedLessonNumber = lessonNumber;
    if (this.#lessons.length) this.#chooseLesson(lessonNumber).catch((error) => this.#showFailure(error));
    element('side_lessons', HTMLButtonElement).click();
  }

  /** Ends a check and forgets what was said. */
  #forgetCheck() {
    this.#checkCount += 1;
    this.#isPlaying = false;
    this.#judgement = null;
    this.#endButton.hidden = true;
    this.#endButton.textContent = text('lesson_end');
    this.#showJudgement();
  }

  /** @param {boolean} isReady */
  #setReady(isReady) {
    this.#lessonSelect.disabled = this.#checkButton.disabled = this.#nextButton.disabled = !isReady;
  }

  /** Fetches the names of the lessons and the page of the one that is chosen. */
  async #fetchLessons() {
    const requestNumber = ++this.#requestCount, wasChecking = !this.#endButton.hidden;
    if (wasChecking) this.#page.simulatorPanel.stop();
    this.#verdictElement.textContent = text('lessons_coming');
    const language = currentLanguage();
    try {
      this.#page.python.tryAgain(language);
      const { lessons } = await this.#page.python.ask({ do: 'lesson_titles', language });
      if (requestNumber !== this.#requestCount) return;
      this.#lessons = lessons;
      if (!this.#steps.length) {
        const doneLessons = loadDoneLessons(), lesson = this.#storedPlace.lesson || this.#page.work.lesson;
        this.#lessonNumber = this.#wantedLessonNumber || 1 + Math.max(0, this.#lessons.findIndex(({ name }) => (lesson ? name === lesson : !doneLessons.has(name))));
      }
      this.#listLessons();
      await this.#chooseLesson(this.#lessonNumber);
      if (wasChecking) this.#verdictElement.textContent = text('lesson_ended');
    } catch (error) {
      this.#isShown = false;
      this.#setReady(false);
      if (document.documentElement.dataset['state'] === 'failed') this.#verdictElement.textContent = text('no_compiler');
      else if (String(error).includes(ARCHIVE_NAME)) this.#verdictElement.textContent = text('lessons_unreachable');
      else this.#showFailure(error);
    }
  }

  #listLessons() {
    const doneLessons = loadDoneLessons(), stars = loadStars();
    replaceOptions(this.#lessonSelect, this.#lessons.map((lesson, index) => {
      const starMark = stars.has(lesson.name) ? ` ★ ${stars.get(lesson.name)}/${lesson.worlds}` : '';
      const doneMark = doneLessons.has(lesson.name) ? ` ✓ ${text('lesson_is_done')}` : '';
      return makePictureOption(`${index + 1}. ${this.#titleOf(lesson)}${starMark}${doneMark}`, String(index + 1), makeWorldPicture(lesson.world));
    }));
    this.#lessonSelect.value = String(this.#lessonNumber);
  }

  get #isBlockView() {
    return pageState.view.value === 'blocks';
  }

  /** @param {Lesson} lesson */
  #titleOf(lesson) {
    return this.#isBlockView ? lesson.block_title : lesson.title;
  }

  /** @param {number} lessonNumber */
  async #chooseLesson(lessonNumber) {
    const requestNumber = ++this.#requestCount;
    const language = currentLanguage();
    this.#forgetCheck();
    const { steps, block_steps, offered: offeredKinds, needed: neededKinds, new: newPieces, spoken } = await this.#page.python.ask({ do: 'lesson_steps', number: lessonNumber, language });
    if (requestNumber !== this.#requestCount) return;
    const isFirst = !this.#steps.length, isOther = lessonNumber !== this.#lessonNumber || isFirst;
    this.#lessonNumber = lessonNumber; // from now on: until then the one before is seen and checked
    this.#lessonSelect.value = String(lessonNumber);
    this.#steps = steps;
    this.#blockSteps = block_steps;
    this.#spokenBlocks = spoken;
    pageState.taughtBlocks.set({ offered: offeredKinds, needed: neededKinds, fresh: newPieces });
    this.#goToStep(isOther && !isFirst ? 0 : Math.min(this.#stepIndex, steps.length - 1));
    if (isOther && !element('lessons', HTMLElement).hidden) await this.#enterLesson();
    this.#setReady(true);
  }

  /** @param {boolean} isUnfolded the step lies over the blocks, where it is two lines above them otherwise */
  #setUnfolded(isUnfolded) {
    this.#unfoldButton.setAttribute('aria-expanded', String(isUnfolded));
    element('lesson_page', HTMLElement).scrollTop = 0;
  }

  /** Shows a step. @param {number} stepIndex */
  #goToStep(stepIndex) {
    this.#stepIndex = stepIndex;
    this.#storeCurrentPlace();
    if ([text('lesson_used'), text('lesson_used_again'), text('lesson_again')].includes(pageState.note.value)) pageState.note.set(''); // it was said of the step before
    const lessonPage = element('lesson_page', HTMLElement);
    this.#fillStep();
    lessonPage.dataset['lesson'] = String(this.#lessonNumber);
    this.#setUnfolded(false);
    this.#hintElement.open = false;
    this.#hintElement.hidden = !this.#steps[stepIndex]?.hint;
    element('lesson_steps', HTMLElement).replaceChildren(...this.#steps.map((_, index) => {
      const isTask = index === this.#steps.length - 1;
      const stepButton = makeButton('', () => {
        this.#goToStep(index);
        element('lesson_steps', HTMLElement).querySelectorAll('button')[index]?.focus();
      }, isTask ? '★' : String(index + 1));
      stepButton.ariaLabel = isTask ? text('lesson_task') : text('lesson_step', { number: index + 1 });
      if (index === stepIndex) stepButton.setAttribute('aria-current', 'step');
      return makeElement('li', '', stepButton);
    }));
    this.#showButtons();
  }

  /** Shows what the step says and what a check has found, as this person writes programs. */
  #fillStep() {
    const shownStep = (this.#isBlockView ? this.#blockSteps : this.#steps)[this.#stepIndex], lesson = this.#lessons[this.#lessonNumber - 1];
    if (!shownStep || !lesson) return;
    const reader = this.#makeReader(lesson);
    element('lesson_name', HTMLElement).textContent = this.#titleOf(lesson);
    element('lesson_step', HTMLElement).replaceChildren(...shownStep.blocks.map((block) => makeBlockElement(block, reader)));
    element('lesson_hint_said', HTMLElement).replaceChildren(makeTextElement('span', shownStep.hint, reader));
    this.#showFindings();
  }

  /** Whether the newest check was of the program as it is now. */
  get #isJudged() {
    return this.#judgement?.programText === pageState.programText.value;
  }

  get #hasPassed() {
    return this.#isJudged && this.#judgement?.verdict === 'passed';
  }

  /** Shows what the newest check has said. It stays while the program is repaired, and says that the program has changed. */
  #showJudgement() {
    const judgement = this.#judgement, { dataset } = this.#verdictElement;
    if (judgement) dataset['verdict'] = this.#isJudged ? judgement.verdict : 'before';
    else delete dataset['verdict'];
    this.#verdictElement.textContent = !judgement ? '' : this.#isJudged ? judgement.sentence : text('lesson_changed');
    element('lesson_stars', HTMLElement).textContent = this.#isJudged ? judgement?.stars ?? '' : '';
    this.#showFindings();
    this.#showButtons();
  }

  #showFindings() {
    const lesson = this.#lessons[this.#lessonNumber - 1];
    const sentences = (this.#isBlockView ? this.#judgement?.blockSentences : this.#judgement?.sentences) ?? [];
    this.#findingsElement.replaceChildren(...lesson ? sentences.map((sentence) => makeTextElement('li', sentence, this.#makeReader(lesson))) : []);
  }

  /** What is done for who reads a lesson. @param {Lesson} lesson @returns {import('./page.js').Reader} */
  #makeReader(lesson) {
    return {
      useProgram: (programText) => {
        const isOwnReplaced = !this.#page.work.lesson;
        this.#page.putProgram(this.#lendProgram(lesson, programText));
        pageState.note.set(text(isOwnReplaced ? 'lesson_used' : 'lesson_used_again'));
      },
      labelOfCode: (code) => (this.#isBlockView ? labelOfCode(code, this.#spokenBlocks) : null),
      drawProgram: this.#isBlockView ? (programText, onDone) => {
        this.#pictures.request(programText, { text: programText, robot: pageState.robotName.value }, onDone);
      } : null,
    };
  }

  /** Which buttons there are. Who pressed one that goes away is at the page. */
  #showButtons() {
    const { activeElement } = document;
    const isTask = this.#stepIndex === this.#steps.length - 1;
    this.#checkButton.hidden = !isTask || !this.#endButton.hidden;
    this.#nextButton.hidden = isTask && !(this.#hasPassed && this.#lessonNumber < this.#lessons.length);
    this.#nextButton.textContent = text(isTask ? 'lesson_other' : 'lesson_next');
    this.#beginAnewButton.hidden = !this.#canBeginAnew;
    if (activeElement instanceof HTMLElement && activeElement.hidden) element('lesson_page', HTMLElement).focus();
  }

  /** Whether the lesson has been solved, and there is a program in it. A group has one of its own. */
  get #canBeginAnew() {
    const lesson = this.#lessons[this.#lessonNumber - 1];
    return Boolean(lesson && pageState.programText.value.trim()) && !pageState.groupName.value && loadDoneLessons().has(lesson?.name ?? '');
  }

  /** The lesson is as it was at first: the program is among the earlier ones, and the stars stay. */
  #beginAnew() {
    const lesson = this.#lessons[this.#lessonNumber - 1];
    if (!lesson || !this.#canBeginAnew || !this.#page.keepProgram()) return;
    this.#forgetCheck();
    this.#page.exchangeProgram(this.#lendProgram(lesson, ''));
    forgetProgram(lesson.name);
    this.#goToStep(0);
    pageState.note.set(text('lesson_begun_anew'));
    this.#showWorld(1).catch((error) => this.#showFailure(error));
  }

  /** Has the lesson's robot and world seen. */
  async #enterLesson() {
    const lesson = /** @type {Lesson} */ (this.#lessons[this.#lessonNumber - 1]);
    const keptText = loadProgram(lesson.name);
    if (keptText && this.#page.work.lesson !== lesson.name && !pageState.groupName.value) {
      if (keptText !== pageState.programText.value) {
        this.#page.exchangeProgram(this.#lendProgram(lesson, keptText));
        pageState.note.set(text('lesson_again'));
      }
      await this.#showWorld(1);
      return;
    }
    const isForOtherRobot = await this.#isForOtherRobot(lesson);
    if (lesson.name !== this.#lessons[this.#lessonNumber - 1]?.name) return; // another one is seen now
    if (isForOtherRobot) {
      const notice = text(this.#page.work.lesson ? 'lesson_before' : 'lesson_own');
      this.#page.exchangeProgram(this.#lendProgram(lesson, ''));
      pageState.note.set(notice);
    }
    await this.#showWorld(1);
  }

  /** Whether the program in the editor is right on its robot and wrong on a lesson's. @param {Lesson} lesson */
  async #isForOtherRobot(lesson) {
    for (;;) {
      const programText = pageState.programText.value, robotName = pageState.robotName.value;
      if (robotName === lesson.robot || pageState.isRobotNamed.value || pageState.groupName.value || !programText.trim()) return false;
      const programBytes = new TextEncoder().encode(programText), language = currentLanguage();
      /** @param {string} robotName */
      const isRightOn = async (robotName) => Boolean((await this.#page.python.ask({ do: 'check', robot: robotName, language }, programBytes)).image);
      const isForOther = await isRightOn(robotName) && !(await isRightOn(lesson.robot));
      if (programText === pageState.programText.value && robotName === pageState.robotName.value) return isForOther && !pageState.groupName.value; // else that was another one
    }
  }

  /** Keeps a lesson's program; one that is changed beside another lesson is that one's from then on. */
  #storeCurrentProgram() {
    const { work } = this.#page, currentLesson = this.#lessons[this.#lessonNumber - 1];
    if (pageState.groupName.value) [work.lesson, work.own] = ['', null]; // it is the group's
    if (!work.lesson) return;
    if (currentLesson && pageState.sideId.value === 'side_lessons') work.lesson = currentLesson.name;
    storeProgram(work.lesson, pageState.programText.value);
  }

  /** A program of the lesson, for which this person's own one steps back. @param {Lesson} lesson @param {string} programText @returns {Program} */
  #lendProgram(lesson, programText) {
    const { work } = this.#page;
    if (!work.lesson) work.own = { text: work.text, robot: work.robot, name: work.name };
    return { text: programText, robot: lesson.robot, name: `${this.#titleOf(lesson).replace(/[\\/:*?"<>|]/g, '')}.ts`, lesson: lesson.name };
  }

  /** The lesson is over, and its check: this person's own program comes back, unless another one has been opened since. */
  leave() {
    this.#forgetCheck();
    const { own: ownProgram } = this.#page.work;
    if (!ownProgram || pageState.groupName.value) return;
    this.#page.exchangeProgram(ownProgram);
    this.#page.simulatorPanel.leaveLesson();
  }

  /** @param {number} seed */
  async #showWorld(seed) {
    const { worlds, robot: robotName } = /** @type {Lesson} */ (this.#lessons[this.#lessonNumber - 1]);
    const values = { number: this.#lessonNumber, seed };
    if (robotName !== pageState.robotName.value && !pageState.isRobotNamed.value) {
      pageState.robotName.set(robotName);
      pageState.note.set(text('lesson_robot', { robot: labelOf(robotOf(robotName)?.labels ?? {}) || robotName }));
    }
    await this.#page.simulatorPanel.showLesson(values.number, seed,
      () => text(worlds > 1 ? 'world_of_lessons' : 'world_of_lesson', values));
  }

  async #startCheck() {
    this.#forgetCheck();
    const checkNumber = this.#checkCount;
    const lessonNumber = this.#lessonNumber;
    const programBytes = new TextEncoder().encode(pageState.programText.value);
    const { worlds } = /** @type {Lesson} */ (this.#lessons[lessonNumber - 1]);
    this.#endButton.hidden = false;
    this.#showButtons();
    this.#endButton.focus();
    this.#verdictElement.textContent = text('lesson_checking', { seed: 1, worlds });
    let most_ms = MIN_ROBOT_MS;
    try {
      await this.#page.python.ask({ do: 'lesson_check', number: lessonNumber, language: currentLanguage() }, programBytes);
      while (checkNumber === this.#checkCount) {
        const began_ms = performance.now();
        /** @type {CheckAnswer} */
        const answer = await this.#page.python.ask({ do: 'lesson_go', most_ms });
        if (checkNumber !== this.#checkCount) return;
        if (answer.verdict) {
          if (answer.run) await this.#playRun(answer.run, answer.worlds);
          if (checkNumber === this.#checkCount) this.#showVerdict({ ...answer, verdict: answer.verdict });
          return;
        }
        this.#verdictElement.textContent = text('lesson_checking', { seed: answer.seed, worlds });
        const factor = PART_MS / Math.max(1, performance.now() - began_ms);
        most_ms = Math.round(Math.min(MAX_ROBOT_MS, Math.max(MIN_ROBOT_MS, most_ms * Math.min(4, factor))));
      }
    } catch (error) {
      if (checkNumber !== this.#checkCount) return;
      this.#showFailure(error);
    }
  }

  /** Shows what was judged, as far as it went well. @param {{seed: number, until_ms: number}} run @param {number} worlds */
  async #playRun({ seed, until_ms }, worlds) {
    const checkNumber = this.#checkCount;
    this.#isPlaying = true;
    this.#verdictElement.textContent = text('lesson_playing', { seed, worlds });
    this.#endButton.textContent = text('lesson_skip');
    await this.#showWorld(seed);
    if (checkNumber === this.#checkCount) await this.#page.simulatorPanel.play({ lesson: this.#lessonNumber, seed, until_ms });
  }

  /** @param {unknown} error */
  #showFailure(error) {
    this.#forgetCheck();
    this.#lessonSelect.value = String(this.#lessonNumber); // so that another one can be chosen again
    this.#verdictElement.textContent = bugSentence(error);
  }

  /** @param {CheckAnswer & {verdict: keyof typeof VERDICT_KEYS}} answer */
  #showVerdict({ verdict, seed, worlds, said: sentences, block_said, spoken }) {
    const hadFocus = document.activeElement === this.#endButton;
    const lesson = /** @type {Lesson} */ (this.#lessons[this.#lessonNumber - 1]);
    const stars = verdict === 'passed' ? worlds : verdict === 'failed' ? Math.max(0, seed - 1) : 0;
    const areStarsStored = storeStars(lesson.name, stars); // first: one that is done has a star
    const isStored = (verdict !== 'passed' || storeDoneLesson(lesson.name)) && areStarsStored;
    this.#forgetCheck();
    const hasPassed = verdict === 'passed', wasDone = !hasPassed && loadDoneLessons().has(lesson.name);
    this.#listLessons();
    const [singleWorldKey, severalWorldsKey] = VERDICT_KEYS[verdict];
    const isInWorlds = worlds > 1 && (seed > 0 || hasPassed);
    const sentence = text(isInWorlds ? severalWorldsKey : singleWorldKey, { number: this.#lessonNumber, worlds, seed });
    this.#spokenBlocks = { ...this.#spokenBlocks, ...spoken };
    this.#judgement = {
      programText: pageState.programText.value,
      verdict,
      sentence: hasPassed ? `${sentence} ${text('lesson_total', { count: countAllStars() })}` : wasDone ? `${sentence} ${text('lesson_was_done')}` : sentence,
      stars: verdict === 'mistakes' ? '' : '★'.repeat(stars) + '☆'.repeat(worlds - stars), // one for each world where it did its task
      sentences,
      blockSentences: block_said,
    };
    this.#showJudgement();
    this.#hintElement.open = false;
    element('lesson_page', HTMLElement).scrollTop = 0;
    if (!isStored) pageState.note.set(text('not_kept'));
    if (hasPassed) {
      this.#page.simulatorPanel.cheer();
      celebrate();
    }
    if (hadFocus) (this.#nextButton.hidden ? this.#checkButton : this.#nextButton).focus();
  }
}
