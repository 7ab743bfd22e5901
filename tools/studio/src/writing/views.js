// The program as blocks and as text, side by side or one at a time. The text is what is kept:
// blocks are made of it when it changes, and it is made of them when they do.

import { element } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { makeBlocksPicture, replaceOptions, makePictureOption } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { pause } from '../robot/transport.js';
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
 * @property {() => void} storeCurrentWork
 * @property {(program: string, isAsked: boolean) => Promise<void>} tryAlone on the virtual robot
 * @property {(hertz: number) => void} playTone
 */

const DEBOUNCE_MS = 200; // of silence before blocks are made of a text
const GROUP_INTERVAL_MS = 300; // between two times that a group hears which block is chosen
const BUSY_POLL_MS = 50; // until a block that is dragged is looked at again
const LEVELS = /** @type {const} */ ([['few', 'level_few'], ['usual', 'level_usual'], ['all', 'level_all']]);

export class Views {
  #page;
  /** @type {Blocks | null} */
  #blocks = null;
  /** @type {Promise<void> | null} */
  #fetchingBlocks = null;
  /** The text that the blocks show. @type {string | null} */
  #shownText = null;
  #isReady = false;
  #isAwake = false; // blocks may be fetched
  #isRefreshing = false;
  /** @type {Promise<void> | null} */
  #sendingBlocks = null;
  #isForced = false; // blocks of a text that does not parse, too
  #changeCount = 0; // of blocks that their text does not have yet
  #shownFormText = ''; // what the blocks were when they and the text were the same
  /** Where they stood then. @type {import('./editor.js').LayoutText} */
  #shownLayout = '';
  #debounceTimer = 0;
  #sendTimer = 0;
  /** @type {Finding[]} */
  #findings = [];
  /** @type {import('./editor.js').Range[]} */
  #runningRanges = [];
  #groupTimer = 0;
  /** @type {import('../class/together.js').MatePlace[]} */
  #matePlaces = [];
  /** Who edits the program, too. @type {import('../class/together.js').SharedEditor | null} */
  #sharedEditor = null;
  #blocksPane = element('blocks', HTMLElement);
  #noteElement = element('blocks_note', HTMLElement);
  #levelSelect = element('level', HTMLSelectElement);

  /** @param {Page} page */
  constructor(page) {
    const { editor, work, storeCurrentWork } = page;
    this.#page = page;
    for (const view of /** @type {const} */ (['blocks', 'text'])) {
      element(`view_${view}`, HTMLButtonElement).addEventListener('click', () => this.#chooseView(view));
    }
    this.#levelSelect.addEventListener('change', () => {
      work.level = LEVELS.find(([level]) => level === this.#levelSelect.value)?.[0] ?? 'few';
      storeCurrentWork();
      this.#setLevel(work.level);
    });
    element('undo', HTMLButtonElement).addEventListener('click', () => this.#undoOrRedo(() => editor.undo()));
    element('redo', HTMLButtonElement).addEventListener('click', () => this.#undoOrRedo(() => editor.redo()));
    // A block that is touched while the text is ahead of it must not take the text back.
    for (const eventName of ['pointerdown', 'focusin']) {
      this.#blocksPane.addEventListener(eventName, (event) => {
        pageState.isTyped.set(false); // whoever touches blocks reads of blocks
        if (!this.#isStale() || (this.#sharedEditor && this.#shownText !== null)) return; // a group has changes by their blocks
        if (eventName === 'pointerdown') event.stopPropagation();
        this.#refreshBlocks(true);
      }, { capture: true });
    }
    editor.onLayoutChange((layout) => {
      if (!this.#blocks) return;
      this.#blocks.layoutText = layout;
      this.#shownText = null; // also where the text is the same
      if (this.#isBlockView) this.#refreshBlocks(true);
    });
    new ResizeObserver(() => this.#blocks?.resize()).observe(this.#blocksPane);
    new MutationObserver(() => this.#blocks?.resize()).observe(document.documentElement, { attributeFilter: ['data-big'] }); // its groups are narrower then
    pageState.language.subscribe(() => this.#updateLanguage());
    pageState.areWordsShown.subscribe(() => this.#updateLanguage());
    pageState.robotName.subscribe(() => this.#setRobot());
    pageState.taughtBlocks.subscribe(() => this.#offerTaught());
    pageState.programText.subscribe(() => this.#onTextChange());
    pageState.checkResult.subscribe((answer) => {
      if (answer) this.#showFindings(answer.findings);
    });
    pageState.breakpoints.subscribe(() => this.#showBreakpoints());
    pageState.virtualRun.subscribe(() => this.#markRunning());
    pageState.robotRun.subscribe(() => this.#markRunning());
    pageState.sideId.subscribe(() => this.#markRunning());
    pageState.fault.subscribe(({ range, sentence }) => {
      if (!range || !this.#isStale()) this.#blocks?.showFault(range, sentence);
    });
    this.#updateLanguage();
    this.#showView();
  }

  get #isBlockView() {
    return this.#page.work.view === 'blocks';
  }

  /** Python answers from now on. */
  markReady() {
    this.#isReady = true;
    if (this.#isBlockView) this.#refreshBlocks(true);
  }

  /** The program is seen from now on. */
  wake() {
    this.#isAwake = true;
    this.#showView();
  }

  /** Has the file of the blocks fetched before they are seen. */
  prefetchBlocks() {
    if (this.#isBlockView) import('../blocks/blocks.js');
  }

  /** Offers what lessons have spoken of. The level rises to what the open one needs, and stays there: none takes blocks away. */
  #offerTaught() {
    const taughtBlocks = pageState.taughtBlocks.value;
    this.#blocks?.setTaughtBlocks(taughtBlocks);
    const levelOrder = LEVELS.map(([level]) => level);
    const leastLevel = this.#blocks?.levelOf(taughtBlocks.needed) ?? 'few';
    if (levelOrder.indexOf(leastLevel) > levelOrder.indexOf(this.#page.work.level)) {
      this.#page.work.level = leastLevel;
      this.#page.storeCurrentWork();
    }
    this.#setLevel(this.#page.work.level);
  }

  /** @param {'few' | 'usual' | 'all'} level */
  #setLevel(level) {
    this.#levelSelect.value = level;
    this.#blocks?.setLevel(level);
  }

  #updateLanguage() {
    const { value } = this.#levelSelect;
    replaceOptions(this.#levelSelect, LEVELS.map(([level, levelKey], index) => makePictureOption(text(levelKey), level, makeBlocksPicture(index + 1))));
    this.#levelSelect.value = value || this.#page.work.level;
    this.#blocks?.updateLanguage();
    if (!this.#isStale()) this.#decorateBlocks();
    if (this.#blocks) this.#refreshBlocks(true);
  }

  #setRobot() {
    this.#blocks?.setRobot(pageState.robotName.value);
    this.#shownText = null;
    if (this.#isBlockView) this.#refreshBlocks(true);
  }

  /** Another program comes. */
  beginProgram() {
    this.#blocks?.beginProgram();
  }

  /** The text has changed, by whoever did it. */
  #onTextChange() {
    this.#findings = []; // those are of the text before
    if (!this.#blocks) return;
    if (!this.#isStale()) {
      this.#markBlocks(); // it has come back
      if (!this.isBusy && this.#isTouched) this.#onBlocksChange(); // a change of theirs had failed to become text
      return;
    }
    this.#showState();
    clearTimeout(this.#debounceTimer);
    this.#debounceTimer = window.setTimeout(() => this.#refreshBlocks(!this.#page.editor.hasFocus), DEBOUNCE_MS);
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
  #markRunning() {
    const { ranges, isHeld } = pageState.virtualRun.value;
    const robotRun = pageState.robotRun.value;
    const isRobotShown = robotRun.range && (!ranges.length || pageState.sideId.value === 'side_real');
    this.#runningRanges = isRobotShown && robotRun.range ? [robotRun.range] : ranges;
    this.#page.editor.showRunning(this.#runningRanges, isRobotShown ? robotRun.isHeld : isHeld);
    if (!this.#isStale()) this.#blocks?.showRunning(this.#runningRanges);
  }

  /** @param {import('./editor.js').Range} finding */
  goTo(finding) {
    if (this.#isBlockView && this.#blocks && !this.#isStale()) this.#blocks.goTo(finding);
    else this.#page.editor.goTo(finding);
  }

  /**
   * Returns a picture of the program's blocks, which are made if only the text is seen.
   * @returns {Promise<Blob | null>} null where there are none
   */
  async makePicture() {
    const { view } = this.#page.work;
    if (view !== 'blocks') this.#chooseView('blocks');
    try {
      await this.#fetchingBlocks;
      await this.#sendBlocks();
      this.#refreshBlocks(true);
      while (this.#isRefreshing) await pause(BUSY_POLL_MS);
      return this.#blocks && !this.#isStale() ? await this.#blocks.makePicture() : null;
    } finally {
      if (view !== 'blocks') this.#chooseView(view);
    }
  }

  /** @param {'blocks' | 'text'} view */
  #chooseView(view) {
    this.#page.work.view = view;
    this.#page.storeCurrentWork();
    this.#showView();
    this.#blocks?.resize();
    if (view === 'blocks') this.#refreshBlocks(true);
  }

  #showView() {
    const { view } = this.#page.work;
    element('writing', HTMLElement).dataset['view'] = view;
    for (const viewName of ['blocks', 'text']) {
      element(`view_${viewName}`, HTMLButtonElement).setAttribute('aria-pressed', String(viewName === view));
    }
    this.#levelSelect.hidden = view !== 'blocks';
    if (pageState.view.value !== view) {
      pageState.isTyped.set(false); // whoever chooses blocks reads of blocks
      pageState.view.set(view);
    }
    if (view === 'blocks' && this.#isAwake) this.#fetchingBlocks ??= this.#fetchBlocks();
  }

  async #fetchBlocks() {
    const { Blocks: BlocksClass } = await import('../blocks/blocks.js');
    this.#blocks = new BlocksClass(this.#blocksPane, pageState.robotName.value, this.#page.work.level, {
      onChange: () => this.#onBlocksChange(),
      toggleBreakpoint: (place) => {
        if (!this.#isStale()) this.#page.editor.toggleBreakpoint(place);
      },
      tryAlone: async (form, isAsked) => {
        try {
          const { text: program } = await this.#page.python.ask({ do: 'text', form });
          await this.#page.tryAlone(program, isAsked);
        } catch (error) {
          this.#showFailure(error);
        }
      },
      playTone: this.#page.playTone,
    });
    this.#offerTaught();
    this.#blocksPane.dataset['state'] = 'empty';
    if (this.#isReady) this.#refreshBlocks(true);
  }

  /** Others edit the program, too: what is done to blocks is theirs, by the blocks. @param {import('../class/together.js').SharedEditor | null} sharedEditor */
  join(sharedEditor) {
    if (sharedEditor === this.#sharedEditor) return;
    this.#sharedEditor = sharedEditor;
    clearInterval(this.#groupTimer);
    if (sharedEditor) this.#groupTimer = window.setInterval(() => sharedEditor.chooseLine(this.#blocks?.focusedLine ?? 0, this.isBusy), GROUP_INTERVAL_MS);
    this.#shownText = null;
    if (this.#isBlockView) this.#refreshBlocks(true);
  }

  /** @param {import('../class/together.js').MatePlace[]} places where the others of a group are */
  showMates(places) {
    this.#matePlaces = places;
    if (!this.#isStale()) this.#blocks?.showMates(places);
  }

  /** Whether a block is in somebody's hand, or one of its fields is open. */
  get isBusy() {
    return Boolean(this.#blocks?.isDragging || (this.#sharedEditor && this.#blocks?.isFieldOpen));
  }

  #isStale() {
    return this.#shownText !== this.#page.editor.text;
  }

  /** Undo and redo once what the blocks are has become text; not while one is dragged. @param {() => void} change */
  async #undoOrRedo(change) {
    if (this.isBusy) return;
    await this.#sendBlocks();
    if (this.isBusy) return; // the next block has been taken meanwhile
    change();
    if (this.#isBlockView) this.#refreshBlocks(true);
  }

  #onBlocksChange() {
    this.#changeCount += 1;
    if (this.#shownText === null) return; // those are not the text's
    this.#blocksPane.dataset['state'] = 'changed';
    clearTimeout(this.#sendTimer);
    this.#sendTimer = window.setTimeout(() => this.#sendBlocks(), 0);
  }

  /** Makes the text of the blocks, unless somebody has changed the text meanwhile. Who comes while it is made waits for that. */
  #sendBlocks() {
    this.#sendingBlocks ??= this.#makeText().finally(() => {
      this.#sendingBlocks = null;
    });
    return this.#sendingBlocks;
  }

  async #makeText() {
    await this.#waitUntilIdle();
    if (!this.#blocks || this.#shownText === null || !this.#changeCount) return;
    try {
      if (this.#sharedEditor) await this.#writeToGroup(this.#sharedEditor);
      else while (this.#changeCount && !this.#isStale()) {
        this.#changeCount = 0;
        const textBefore = this.#page.editor.text;
        const { form, ids } = this.#blocks.readForm();
        const formText = JSON.stringify(form);
        const layouts = { before: this.#shownLayout, after: this.#blocks.layoutText };
        if (formText === this.#shownFormText) { // a block was only moved about
          this.#shownLayout = layouts.after;
          this.#page.editor.replaceByBlocks(textBefore, layouts);
          break;
        }
        const answer = await this.#page.python.ask({ do: 'text', form });
        if (this.#changeCount || this.#page.editor.text !== textBefore) {
          await this.#waitUntilIdle();
          continue;
        }
        if (this.#shownText !== null) this.#shownText = answer.text; // else other blocks are made of it
        this.#shownFormText = formText;
        this.#shownLayout = layouts.after;
        this.#blocks.setRanges(ids, answer.places);
        this.#page.editor.replaceByBlocks(answer.text, layouts);
      }
    } catch (error) {
      this.#showFailure(error);
      this.#changeCount ||= 1; // whatever comes next tries again
      return;
    }
    this.#changeCount = 0;
    if (this.#isStale()) this.#refreshBlocks(!this.#page.editor.hasFocus);
    else this.#showState();
  }

  /** Has a group take what was done to blocks since they were shown. @param {import('../class/together.js').SharedEditor} sharedEditor */
  async #writeToGroup(sharedEditor) {
    while (this.#blocks && sharedEditor === this.#sharedEditor) {
      this.#changeCount = 0;
      const { form, ids } = this.#blocks.readForm();
      const formText = JSON.stringify(form);
      const layouts = { before: this.#shownLayout, after: this.#blocks.layoutText };
      this.#shownLayout = layouts.after;
      if (formText === this.#shownFormText) { // which is no change of the group's
        this.#page.editor.replaceByBlocks(this.#page.editor.text, layouts);
        return;
      }
      this.#shownFormText = formText;
      const answer = await sharedEditor.writeBlocks(form, ids);
      if (!answer) return;
      this.#shownText = answer.is_shown ? this.#page.editor.text : answer.text ?? null; // blocks with what was refused are stale, also where the text is as before
      if (!answer.is_shown) return;
      this.#blocks.setRanges(ids, answer.places ?? []);
      this.#markBlocks();
      await this.#waitUntilIdle();
    }
  }

  async #waitUntilIdle() {
    while (this.isBusy) await pause(BUSY_POLL_MS);
  }

  /**
   * Makes the blocks of the text. While somebody types a text that does not parse, the blocks stay
   * as they are, unless `isForced`.
   * @param {boolean} isForced
   */
  async #refreshBlocks(isForced) {
    this.#isForced ||= isForced;
    if (!this.#blocks || !this.#isReady || this.#isRefreshing || !this.#isBlockView) return;
    this.#isRefreshing = true;
    try {
      while (this.#isStale()) {
        const sharedEditor = this.#sharedEditor;
        if (sharedEditor) {
          await this.#settle();
          if (!this.#isStale()) break;
        }
        const newText = this.#page.editor.text, robotName = pageState.robotName.value;
        /** @type {Form & {size: number}} */
        const form = await this.#page.python.ask({ do: 'blocks', robot: robotName }, new TextEncoder().encode(newText));
        await this.#waitUntilIdle();
        if (newText !== this.#page.editor.text || robotName !== pageState.robotName.value || sharedEditor !== this.#sharedEditor || (sharedEditor && (this.#sendingBlocks || this.#isTouched))) continue;
        const areBlocksKept = !this.#isForced && this.#page.editor.hasFocus && this.#shownText !== null && hasGreyBlock(form);
        if (!form.body || areBlocksKept) {
          this.#showState(form.body ? text('blocks_wait') : text('blocks_many'));
          return;
        }
        this.#shownText = newText;
        this.#isForced = false; // whoever types on sees no grey blocks
        this.#changeCount = 0;
        this.#blocks.setGivenBlocks(isShippedProgram(newText) ? form : null);
        this.#blocks.show(form);
        this.#shownFormText = JSON.stringify(this.#blocks.readForm().form);
        this.#shownLayout = this.#blocks.layoutText;
        if (sharedEditor && !(await sharedEditor.reportBlocks(this.#blocks.lines)).is_known) this.#shownText = null;
      }
      this.#decorateBlocks();
      if (!this.#changeCount) this.#showState();
    } catch (error) {
      this.#showFailure(error);
    } finally {
      this.#isRefreshing = false;
      this.#isForced = false;
    }
  }

  /** Whether blocks are others than they were shown. */
  get #isTouched() {
    return this.#shownText !== null && JSON.stringify(this.#blocks?.readForm().form) !== this.#shownFormText;
  }

  /** In a group: what was done to blocks is in the text before others are made of it, and Python has that text. */
  async #settle() {
    do {
      await this.#waitUntilIdle();
      await this.#sendingBlocks;
    } while (this.isBusy);
    if (this.#isTouched) {
      this.#changeCount ||= 1; // Blockly reports it a moment later
      await this.#sendBlocks();
    }
    await this.#sharedEditor?.settle();
  }

  /** Blocks that are new have nothing at them yet. */
  #decorateBlocks() {
    this.#blocks?.showFindings(this.#findings);
    this.#markBlocks();
  }

  /** What came while they were not those of the text. */
  #markBlocks() {
    this.#blocks?.showFault(pageState.fault.value.range, pageState.fault.value.sentence);
    this.#blocks?.showRunning(this.#runningRanges);
    this.#blocks?.showMates(this.#matePlaces);
    this.#showBreakpoints();
  }

  /** @param {unknown} error */
  #showFailure(error) {
    this.#noteElement.textContent = bugSentence(error);
  }

  /** @param {string} notice */
  #showState(notice = '') {
    this.#noteElement.textContent = notice;
    this.#blocksPane.dataset['state'] = this.#isStale() ? 'stale' : 'shown';
  }
}

/** @param {Form} form */
function hasGreyBlock(form) {
  const pendingBlocks = [...(form.body ?? [])];
  for (let block = pendingBlocks.pop(); block; block = pendingBlocks.pop()) {
    if (block.kind === 'grey') return true;
    pendingBlocks.push(...block.bodies.flat());
  }
  return false;
}
