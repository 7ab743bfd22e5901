// The program as blocks and as text, side by side or one at a time. The text is what is kept:
// blocks are made of it when it changes, and it is made of them when they do.

import { element } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { blocksPicture, replaceOptions, pictureOption } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';
import { isShippedProgram } from '../start/beginnings.js';

/** @typedef {import('../blocks/blocks.js').Blocks} Blocks */
/** @typedef {import('../blocks/form.js').Form} Form */
/** @typedef {import('../python.js').Finding} Finding */

/**
 * @typedef {object} Page what the views need of the page
 * @property {import('../python.js').Python} python
 * @property {import('./editor.js').Editor} editor
 * @property {import('../programs/work.js').Work} work
 * @property {() => void} remember
 * @property {(program: string, isAsked: boolean) => Promise<void>} tryAlone on the virtual robot
 * @property {(hertz: number) => void} hear
 */

const TYPING_MS = 200; // of silence before blocks are made of a text
const TELL_MS = 300; // between two times that a group hears which block is chosen
const BUSY_MS = 50; // until a block that is dragged is looked at again
const LEVELS = /** @type {const} */ ([['few', 'level_few'], ['usual', 'level_usual'], ['all', 'level_all']]);

export class Views {
  #page;
  /** @type {Blocks | null} */
  #blocks = null;
  /** @type {Promise<void> | null} */
  #fetching = null;
  /** The text that the blocks show. @type {string | null} */
  #shown = null;
  #isReady = false;
  #isAwake = false; // blocks may be fetched
  #isRefreshing = false;
  #isSending = false;
  #isWanted = false; // blocks of a text that does not parse, too
  #changes = 0; // of blocks that their text does not have yet
  #form = ''; // what the blocks were when they and the text were the same
  /** Where they stood then. @type {import('./editor.js').Stand} */
  #stand = '';
  #typing = 0;
  #sending = 0;
  /** @type {Finding[]} */
  #findings = [];
  /** @type {import('./editor.js').Range[]} */
  #running = [];
  #telling = 0;
  /** @type {import('../class/together.js').MatePlace[]} */
  #mates = [];
  /** Who edits the program, too. @type {import('../class/together.js').SharedEditor | null} */
  #group = null;
  #pane = element('blocks', HTMLElement);
  #note = element('blocks_note', HTMLElement);
  #level = element('level', HTMLSelectElement);

  /** @param {Page} page */
  constructor(page) {
    const { editor, work, remember } = page;
    this.#page = page;
    for (const view of /** @type {const} */ (['blocks', 'text'])) {
      element(`view_${view}`, HTMLButtonElement).addEventListener('click', () => this.#choose(view));
    }
    this.#level.addEventListener('change', () => {
      work.level = LEVELS.find(([level]) => level === this.#level.value)?.[0] ?? 'few';
      remember();
      this.#offer(work.level);
    });
    element('undo', HTMLButtonElement).addEventListener('click', () => this.#again(() => editor.undo()));
    element('redo', HTMLButtonElement).addEventListener('click', () => this.#again(() => editor.redo()));
    // A block that is touched while the text is ahead of it must not take the text back.
    for (const kind of ['pointerdown', 'focusin']) {
      this.#pane.addEventListener(kind, (event) => {
        if (!this.#isStale() || (this.#group && this.#shown !== null)) return; // a group has changes by their blocks
        if (kind === 'pointerdown') event.stopPropagation();
        this.#refresh(true);
      }, { capture: true });
    }
    editor.whenStood((stand) => {
      if (!this.#blocks) return;
      this.#blocks.stand = stand;
      this.#shown = null; // also where the text is the same
      if (this.#isOn) this.#refresh(true);
    });
    new ResizeObserver(() => this.#blocks?.resize()).observe(this.#pane);
    new MutationObserver(() => this.#blocks?.resize()).observe(document.documentElement, { attributeFilter: ['data-big'] }); // its groups are narrower then
    pageState.language.subscribe(() => this.#showWords());
    pageState.areWordsShown.subscribe(() => this.#showWords());
    pageState.robotName.subscribe(() => this.#setRobot());
    pageState.taughtBlocks.subscribe(() => this.#teach());
    pageState.programText.subscribe(() => this.#textChanged());
    pageState.checkResult.subscribe((answer) => {
      if (answer) this.#showFindings(answer.findings);
    });
    pageState.breakpoints.subscribe(() => this.#showBreakpoints());
    pageState.virtualRun.subscribe(() => this.#mark());
    pageState.robotRun.subscribe(() => this.#mark());
    pageState.sideId.subscribe(() => this.#mark());
    pageState.fault.subscribe(({ range, sentence: said }) => {
      if (!range || !this.#isStale()) this.#blocks?.showFault(range, said);
    });
    this.#showWords();
    this.#lay();
  }

  get #isOn() {
    return this.#page.work.view === 'blocks';
  }

  /** Python answers from now on. */
  ready() {
    this.#isReady = true;
    if (this.#isOn) this.#refresh(true);
  }

  /** The program is seen from now on. */
  wake() {
    this.#isAwake = true;
    this.#lay();
  }

  /** Has the file of the blocks fetched before they are seen. */
  fetchAhead() {
    if (this.#isOn) import('../blocks/blocks.js');
  }

  /** Offers what lessons have spoken of. The level rises to what the open one needs, and stays there: none takes blocks away. */
  #teach() {
    const taught = pageState.taughtBlocks.value;
    this.#blocks?.setTaught(taught);
    const order = LEVELS.map(([level]) => level);
    const least = this.#blocks?.levelOf(taught.needed) ?? 'few';
    if (order.indexOf(least) > order.indexOf(this.#page.work.level)) {
      this.#page.work.level = least;
      this.#page.remember();
    }
    this.#offer(this.#page.work.level);
  }

  /** @param {'few' | 'usual' | 'all'} level */
  #offer(level) {
    this.#level.value = level;
    this.#blocks?.setLevel(level);
  }

  #showWords() {
    const { value } = this.#level;
    replaceOptions(this.#level, LEVELS.map(([level, name], k) => pictureOption(text(name), level, blocksPicture(k + 1))));
    this.#level.value = value || this.#page.work.level;
    this.#blocks?.updateLanguage();
    if (!this.#isStale()) this.#showAll();
    if (this.#blocks) this.#refresh(true);
  }

  #setRobot() {
    this.#blocks?.setRobot(pageState.robotName.value);
    this.#shown = null;
    if (this.#isOn) this.#refresh(true);
  }

  /** Another program comes. */
  begin() {
    this.#blocks?.begin();
  }

  /** The text has changed, by whoever did it. */
  #textChanged() {
    this.#findings = []; // those are of the text before
    if (!this.#blocks || !this.#isStale()) return;
    this.#showState();
    clearTimeout(this.#typing);
    this.#typing = window.setTimeout(() => this.#refresh(!this.#page.editor.hasFocus), TYPING_MS);
  }

  /** @param {Finding[]} findings of the newest text */
  #showFindings(findings) {
    this.#findings = findings;
    if (!this.#isStale()) this.#blocks?.showFindings(findings);
  }

  #showBreakpoints() {
    if (!this.#isStale()) this.#blocks?.showBreakpoints(pageState.breakpoints.value);
  }

  /** Where both robots run, that one is marked whose side is open. */
  #mark() {
    const { ranges, isHeld } = pageState.virtualRun.value;
    const there = pageState.robotRun.value;
    const isThere = there.range && (!ranges.length || pageState.sideId.value === 'side_real');
    this.#running = isThere && there.range ? [there.range] : ranges;
    this.#page.editor.showRunning(this.#running, isThere ? there.isHeld : isHeld);
    if (!this.#isStale()) this.#blocks?.showRunning(this.#running);
  }

  /** @param {import('./editor.js').Range} finding */
  goTo(finding) {
    if (this.#isOn && this.#blocks && !this.#isStale()) this.#blocks.goTo(finding);
    else this.#page.editor.goTo(finding);
  }

  /**
   * Returns a picture of the program's blocks, which are made if only the text is seen.
   * @returns {Promise<Blob | null>} null where there are none
   */
  async picture() {
    const { view } = this.#page.work;
    if (view !== 'blocks') this.#choose('blocks');
    try {
      await this.#fetching;
      await this.#send();
      this.#refresh(true);
      while (this.#isRefreshing) await new Promise((resolve) => setTimeout(resolve, BUSY_MS));
      return this.#blocks && !this.#isStale() ? await this.#blocks.picture() : null;
    } finally {
      if (view !== 'blocks') this.#choose(view);
    }
  }

  /** @param {'blocks' | 'text'} view */
  #choose(view) {
    this.#page.work.view = view;
    this.#page.remember();
    this.#lay();
    this.#blocks?.resize();
    if (view === 'blocks') this.#refresh(true);
  }

  #lay() {
    const { view } = this.#page.work;
    element('writing', HTMLElement).dataset['view'] = view;
    for (const each of ['blocks', 'text']) {
      element(`view_${each}`, HTMLButtonElement).setAttribute('aria-pressed', String(each === view));
    }
    this.#level.hidden = view !== 'blocks';
    if (pageState.view.value !== view) pageState.view.set(view);
    if (view === 'blocks' && this.#isAwake) this.#fetching ??= this.#fetch();
  }

  async #fetch() {
    const { Blocks: Kind } = await import('../blocks/blocks.js');
    this.#blocks = new Kind(this.#pane, pageState.robotName.value, this.#page.work.level, {
      onChange: () => this.#blocksChanged(),
      toggleBreakpoint: (place) => {
        if (!this.#isStale()) this.#page.editor.toggleBreakpoint(place);
      },
      tryAlone: async (form, isAsked) => {
        try {
          const { text: program } = await this.#page.python.ask({ do: 'text', form });
          await this.#page.tryAlone(program, isAsked);
        } catch (why) {
          this.#fail(why);
        }
      },
      playTone: this.#page.hear,
    });
    this.#teach();
    this.#pane.dataset['state'] = 'empty';
    if (this.#isReady) this.#refresh(true);
  }

  /** Others edit the program, too: what is done to blocks is theirs, by the blocks. @param {import('../class/together.js').SharedEditor | null} group */
  join(group) {
    if (group === this.#group) return;
    this.#group = group;
    clearInterval(this.#telling);
    if (group) this.#telling = window.setInterval(() => group.chooseLine(this.#blocks?.chosenLine ?? 0, this.isBusy), TELL_MS);
    this.#shown = null;
    if (this.#isOn) this.#refresh(true);
  }

  /** @param {import('../class/together.js').MatePlace[]} places where the others of a group are */
  showMates(places) {
    this.#mates = places;
    if (!this.#isStale()) this.#blocks?.showMates(places);
  }

  /** Whether a block is in somebody's hand, or one of its fields is open. */
  get isBusy() {
    return Boolean(this.#blocks?.isBusy || (this.#group && this.#blocks?.isOpen));
  }

  #isStale() {
    return this.#shown !== this.#page.editor.text;
  }

  /** Undo and redo once what the blocks are has become text; not while one is dragged. @param {() => void} act */
  async #again(act) {
    if (this.isBusy) return;
    await this.#send();
    act();
    if (this.#isOn) this.#refresh(true);
  }

  #blocksChanged() {
    this.#changes += 1;
    if (this.#shown === null) return; // those are not the text's
    this.#pane.dataset['state'] = 'changed';
    clearTimeout(this.#sending);
    this.#sending = window.setTimeout(() => this.#send(), 0);
  }

  /** Makes the text of the blocks, unless somebody has changed the text meanwhile. */
  async #send() {
    if (!this.#blocks || this.#shown === null || this.#isSending || !this.#changes) return;
    if (this.isBusy) {
      clearTimeout(this.#sending);
      this.#sending = window.setTimeout(() => this.#send(), BUSY_MS);
      return;
    }
    this.#isSending = true;
    const before = this.#page.editor.text;
    try {
      if (this.#group) await this.#write(this.#group);
      else while (this.#changes && this.#shown === before) {
        this.#changes = 0;
        const { form, ids } = this.#blocks.read();
        const whole = JSON.stringify(form);
        const stands = { before: this.#stand, after: this.#blocks.stand };
        if (whole === this.#form) { // a block was only moved about
          this.#stand = stands.after;
          this.#page.editor.replaceByBlocks(before, stands);
          break;
        }
        const answer = await this.#page.python.ask({ do: 'text', form });
        if (this.#changes || this.#page.editor.text !== before) continue;
        this.#shown = answer.text;
        this.#form = whole;
        this.#stand = stands.after;
        this.#blocks.setRanges(ids, answer.places);
        this.#page.editor.replaceByBlocks(answer.text, stands);
        this.#showBreakpoints();
      }
    } catch (why) {
      this.#fail(why);
    } finally {
      this.#isSending = false;
    }
    this.#changes = 0;
    if (this.#isStale()) this.#refresh(true);
    else this.#showState();
  }

  /** Has a group take what was done to blocks since they were shown. @param {import('../class/together.js').SharedEditor} group */
  async #write(group) {
    while (this.#blocks) {
      this.#changes = 0;
      const { form, ids } = this.#blocks.read();
      const whole = JSON.stringify(form);
      const stands = { before: this.#stand, after: this.#blocks.stand };
      this.#stand = stands.after;
      if (whole === this.#form) { // which is no change of the group's
        this.#page.editor.replaceByBlocks(this.#page.editor.text, stands);
        return;
      }
      this.#form = whole;
      const answer = await group.writeBlocks(form, ids);
      if (!answer?.is_shown) return;
      this.#shown = this.#page.editor.text;
      this.#blocks.setRanges(ids, answer.places ?? []);
      this.#showBreakpoints();
    }
  }

  /**
   * Makes the blocks of the text. While somebody types a text that does not parse, the blocks stay
   * as they are, unless `isWanted`.
   * @param {boolean} isWanted
   */
  async #refresh(isWanted) {
    this.#isWanted ||= isWanted;
    if (!this.#blocks || !this.#isReady || this.#isRefreshing || !this.#isOn) return;
    this.#isRefreshing = true;
    try {
      while (this.#isStale()) {
        const group = this.#group;
        if (group) {
          await this.#settle();
          if (!this.#isStale()) break;
        }
        const now = this.#page.editor.text;
        /** @type {Form & {size: number}} */
        const form = await this.#page.python.ask({ do: 'blocks', robot: pageState.robotName.value }, new TextEncoder().encode(now));
        while (this.isBusy) await new Promise((resolve) => setTimeout(resolve, BUSY_MS));
        if (now !== this.#page.editor.text || group !== this.#group || (group && this.#isTouched)) continue;
        const isKept = !this.#isWanted && this.#page.editor.hasFocus && this.#shown !== null && hasGrey(form);
        if (!form.body || isKept) {
          this.#showState(form.body ? text('blocks_wait') : text('blocks_many'));
          return;
        }
        this.#shown = now;
        this.#changes = 0;
        this.#blocks.setGiven(isShippedProgram(now) ? form : null);
        this.#blocks.show(form);
        this.#form = JSON.stringify(this.#blocks.read().form);
        this.#stand = this.#blocks.stand;
        if (group && !(await group.reportBlocks(this.#blocks.lines)).is_known) this.#shown = null;
        this.#showAll();
      }
      this.#showState();
    } catch (why) {
      this.#fail(why);
    } finally {
      this.#isRefreshing = false;
      this.#isWanted = false;
    }
  }

  /** Whether blocks are others than they were shown. */
  get #isTouched() {
    return this.#shown !== null && JSON.stringify(this.#blocks?.read().form) !== this.#form;
  }

  /** In a group: what was done to blocks is in the text before others are made of it, and Python has that text. */
  async #settle() {
    while (this.isBusy) await new Promise((resolve) => setTimeout(resolve, BUSY_MS));
    while (this.#isSending) await new Promise((resolve) => setTimeout(resolve, BUSY_MS));
    if (this.#isTouched) {
      this.#changes ||= 1; // Blockly tells of it a moment later
      await this.#send();
    }
    await this.#group?.settle();
  }

  /** Blocks that are new have nothing at them yet. */
  #showAll() {
    this.#blocks?.showFindings(this.#findings);
    this.#blocks?.showFault(pageState.fault.value.range, pageState.fault.value.sentence);
    this.#blocks?.showRunning(this.#running);
    this.#blocks?.showMates(this.#mates);
    this.#showBreakpoints();
  }

  /** @param {unknown} why */
  #fail(why) {
    this.#note.textContent = bugSentence(why);
  }

  /** @param {string} note */
  #showState(note = '') {
    this.#note.textContent = note;
    this.#pane.dataset['state'] = this.#isStale() ? 'stale' : 'shown';
  }
}

/** @param {Form} form */
function hasGrey(form) {
  const waiting = [...(form.body ?? [])];
  for (let block = waiting.pop(); block; block = waiting.pop()) {
    if (block.kind === 'grey') return true;
    waiting.push(...block.bodies.flat());
  }
  return false;
}
