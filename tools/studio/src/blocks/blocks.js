// The program as blocks. Knows Blockly; the page fetches this file when blocks are first looked at.
//
// The text is what is kept: a change of the blocks is told to the page, which asks for their text.

import * as Blockly from 'blockly/core';
import { clearWorkspace, drawForm, formOf, isLoose, formOfBlock, keepPlaces, knownPlaces, makeRoom, piecesIn, showForm } from './form.js';
import { updateCalls, labelCalls } from './own_words.js';
import { setActuators } from './places.js';
import { LenientConnectionChecker, defineBlocks, setNarrow, setNewPieces, setRobot } from './shapes.js';
import { setTonePlayer } from './fields.js';
import { insertBlock } from './insert.js';
import { renderPicture } from './picture.js';
import { findingAsSeen } from './said.js';
import { Search } from './search.js';
import { getOptions } from './styles.js';
import { findItems, levelOf, makeToolbox } from './toolbox.js';
import { RunFollower } from './sight.js';
import { Previewer } from './wrapping.js';
import { makeZoomButtons } from './zoom.js';
import { text, textsOf } from '../page/texts.js';

/** @import { Form, TextRange } from './form.js' */
/** @typedef {import('./toolbox.js').Level} Level */
/** @typedef {import('../python.js').Finding} Finding */
/** @typedef {import('../page/page_state.js').TaughtBlocks} TaughtBlocks */
/**
 * @typedef {object} BlocksListener who is told about what is done to blocks
 * @property {() => void} onChange
 * @property {(place: {line: number, column: number}) => void} toggleBreakpoint
 * @property {(form: Form, isAsked: boolean) => Promise<void>} tryAlone a part of the program, until it has run; whoever only touched it wants nothing else to end for it
 * @property {(hertz: number) => void} playTone
 */

const NARROW_PX = 700; // pixels of width, below which questions are folded
const START_SCALE = 0.75; // at which letters are 12 pixels high, and what is pressed is 24
const MAX_TIP_CHARACTERS = 36; // so many characters are in a line of a message at a block,
const MAX_NARROW_TIP_CHARACTERS = 28; // and so many on a phone
const SNAP_RADIUS = 48; // units of a workspace: how far off a block may be dropped
const STAY_RADIUS = 68; // the same while it is shown where it would go
const NOTCH_HEIGHT = 8; // of a block, in the one below it
const BUBBLE_GAP_BESIDE = 24; // units between a block and its message
const BUBBLE_GAP_BELOW = 12; // the same, where it stands below
const MIN_HEIGHT_PX = 240; // pixels of height: in less, a message is seen when somebody asks
const MAX_KNOWN_STACKS = 200; // stacks whose places are known

export class Blocks {
  #container;
  #listener;
  #options = getOptions();
  /** @type {Blockly.WorkspaceSvg} */
  #workspace;
  /** @type {Level} */
  #level = 'few';
  /** @type {import('./toolbox.js').UsedNames} */
  #usedNames = { names: [], words: [] };
  /** @type {string[]} */
  #taughtBlocks = [];
  /** Blocks that are the newest of the open lesson. @type {string[]} */
  #newBlocks = [];
  /** Blocks that somebody has used. @type {Set<string>} */
  #triedBlocks = new Set();
  /** Those of the program that the page has brought. @type {string[]} */
  #givenBlocks = [];
  /** Ids of the blocks, and where each is in the text. @type {[string, TextRange][]} */
  #places = [];
  #isTouched = false; // by somebody, who may have scrolled
  /** @type {import('./form.js').StackPlaces} */
  #stackPlaces = new Map();
  /** Where the next blocks stand, whatever is known of those before. @type {import('./form.js').StackPlaces | null} */
  #nextStackPlaces = null;
  /** @type {Blockly.icons.WarningIcon | null} */
  #openingBadge = null;
  #closedMessage = ''; // the message that somebody has put away
  /** The ids of the blocks with each look. @type {Record<string, Set<string>>} */
  #markedIds = {};
  #shownFault = { id: '', message: '' };
  #tryCount = 0; // of blocks that were tried: the look is that of the newest one
  /** @type {Search | null} */
  #search = null;
  /** @type {HTMLElement | null} */
  #zoomButtons = null;
  /** @type {Finding[]} */
  #findings = [];
  /** @type {SVGElement[]} */
  #mateMarks = [];
  /** Has what runs be seen. @type {RunFollower | null} */
  #runFollower = null;

  /**
   * @param {HTMLElement} container
   * @param {string} robotName
   * @param {Level} level
   * @param {BlocksListener | null} listener null of blocks that are only drawn
   */
  constructor(container, robotName, level, listener = null) {
    this.#container = container;
    this.#listener = listener;
    this.#level = level;
    Blockly.registry.register(Blockly.registry.Type.CONNECTION_CHECKER, 'tiniscript', LenientConnectionChecker, true);
    Blockly.registry.register(Blockly.registry.Type.CONNECTION_PREVIEWER, 'tiniscript', Previewer, true);
    Object.assign(Blockly.config, { snapRadius: SNAP_RADIUS, connectingSnapRadius: STAY_RADIUS });
    this.#removeBlocklyActions();
    this.#countBlocksInStacks();
    if (listener) {
      setTonePlayer(listener.playTone);
      this.#offerBreakpoints(listener);
      this.#offerTrying(listener);
    }
    setRobot(robotName);
    setActuators(robotName);
    this.#workspace = this.#makeWorkspace();
    if (listener) this.#insertWithoutDragging();
    for (const eventName of ['pointerdown', 'wheel', 'keydown']) {
      container.addEventListener(eventName, () => {
        this.#isTouched = true;
        this.#runFollower?.leaveAlone();
      }, { capture: true, passive: true });
    }
  }

  /** Undo and redo are those of the text, which is what changes: the page has their keys. */
  #removeBlocklyActions() {
    for (const name of ['undoWorkspace', 'redoWorkspace', 'blockDisable', 'blockInline', 'blockCollapseExpand', 'collapseWorkspace', 'expandWorkspace', 'blockHelp']) {
      if (Blockly.ContextMenuRegistry.registry.getItem(name)) Blockly.ContextMenuRegistry.registry.unregister(name);
    }
    const { registry } = Blockly.ShortcutRegistry;
    for (const name of ['undo', 'redo']) if (registry.getRegistry()[name]) registry.unregister(name);
  }

  /** Menus count the blocks that stand in stacks: a value is a part of its block. */
  #countBlocksInStacks() {
    const { registry } = Blockly.ContextMenuRegistry;
    for (const id of ['blockDelete', 'workspaceDelete']) /** @type {any} */ (registry.getItem(id)).displayText = (/** @type {Blockly.ContextMenuRegistry.Scope} */ { block, workspace }) => {
      const blocksAfter = new Set(block?.getNextBlock()?.getDescendants(false));
      const blocks = block?.getDescendants(false) ?? workspace?.getAllBlocks(false).filter((each) => each.isDeletable()) ?? [];
      const count = blocks.filter((each) => !each.outputConnection && !blocksAfter.has(each)).length;
      if (workspace) Blockly.Msg['DELETE_ALL_BLOCKS'] = text('blockly/DELETE_ALL_BLOCKS').replace('%1', String(count)); // what Blockly asks then
      return count > 1 ? text('blockly/DELETE_X_BLOCKS').replace('%1', String(count)) : text('blockly/DELETE_BLOCK');
    };
  }

  /** In the menu of a block, and by F9. */
  #offerBreakpoints(/** @type {BlocksListener} */ listener) {
    const toggle = (/** @type {any} */ block) => {
      const range = block && this.#places.find(([id]) => id === block.id)?.[1];
      if (range?.[0]) listener.toggleBreakpoint({ line: range[0], column: range[1] });
      return Boolean(range?.[0]);
    };
    if (Blockly.ContextMenuRegistry.registry.getItem('breakpoint')) return; // a page has its blocks once
    Blockly.ContextMenuRegistry.registry.register({
      id: 'breakpoint',
      weight: 0,
      scopeType: Blockly.ContextMenuRegistry.ScopeType.BLOCK,
      displayText: () => text('breakpoint'),
      preconditionFn: ({ block }) => (this.#places.some(([id]) => id === block?.id) ? 'enabled' : 'hidden'),
      callback: ({ block }) => toggle(block),
    });
    Blockly.ShortcutRegistry.registry.register({
      name: 'breakpoint',
      keyCodes: [Blockly.utils.KeyCodes.F9],
      callback: () => toggle(this.#focusedBlock()),
    });
  }

  /** In the menu of a block, by Shift and Enter, and by a click. @param {BlocksListener} listener */
  #offerTrying(listener) {
    const tryBlock = (/** @type {any} */ block) => {
      if (block) this.#tryAlone(listener, block, true);
      return Boolean(block);
    };
    if (Blockly.ContextMenuRegistry.registry.getItem('try')) return;
    Blockly.ContextMenuRegistry.registry.register({
      id: 'try',
      weight: -1,
      scopeType: Blockly.ContextMenuRegistry.ScopeType.BLOCK,
      displayText: () => text('try_block'),
      preconditionFn: ({ block }) => (block && !block.isInFlyout ? 'enabled' : 'hidden'),
      callback: ({ block }) => tryBlock(block),
    });
    const { SHIFT, ENTER } = Blockly.utils.KeyCodes;
    Blockly.ShortcutRegistry.registry.register({
      name: 'try',
      keyCodes: [Blockly.ShortcutRegistry.registry.createSerializedKey(ENTER, [SHIFT])],
      callback: () => tryBlock(this.#focusedBlock()),
    });
  }

  /** @param {BlocksListener} listener @param {Blockly.Block} block @param {boolean} isAsked and not only touched */
  async #tryAlone(listener, block, isAsked) {
    let triedBlock = block;
    while (triedBlock.isShadow()) triedBlock = triedBlock.getParent() ?? triedBlock;
    const tryNumber = ++this.#tryCount;
    this.#setMarked('alone', [triedBlock.id]);
    try {
      await listener.tryAlone(formOfBlock(triedBlock), isAsked);
    } finally {
      if (tryNumber === this.#tryCount) this.#setMarked('alone', []);
    }
  }

  /** Whoever chooses a block of a list by a key or a tap has it where the focus was. */
  #insertWithoutDragging() {
    /** @type {Blockly.BlockSvg | null} */
    let lastFocused = null; // that had the focus of the program
    const takeBlock = (/** @type {Blockly.BlockSvg} */ listBlock, /** @type {boolean} */ isByKey) => {
      const workspace = this.#workspace;
      const focusedBlock = lastFocused && workspace.getBlockById(lastFocused.id) === lastFocused ? lastFocused : null;
      const isForStack = listBlock.previousConnection !== null; // a tap fills no place of a value: that may be meant to stay as it is
      const block = insertBlock(listBlock, workspace, isByKey || isForStack ? focusedBlock : null, !isByKey);
      if (!block) return false;
      this.#search?.clearSearch();
      workspace.hideChaff();
      workspace.getFlyout()?.hide();
      Blockly.getFocusManager().focusNode(block);
      return true;
    };
    this.#container.addEventListener('focusin', ({ target }) => {
      const blockElement = /** @type {Element} */ (target).closest('.blocklyBlock');
      lastFocused = this.#workspace.getBlockById(blockElement?.getAttribute('data-id') ?? '') ?? lastFocused;
    });
    this.#container.addEventListener('keydown', (event) => {
      const listBlock = Blockly.getFocusManager().getFocusedNode();
      const isInList = listBlock instanceof Blockly.BlockSvg && listBlock.isInFlyout && this.#workspace === listBlock.workspace.targetWorkspace;
      if (!isInList || !['Enter', ' '].includes(event.key) || event.shiftKey || event.ctrlKey || event.metaKey) return;
      if (!takeBlock(/** @type {Blockly.BlockSvg} */ (listBlock.getRootBlock()), true)) return; // Blockly lets it be moved to a place
      event.preventDefault();
      event.stopPropagation();
    }, { capture: true });
    const gesture = /** @type {any} */ (Blockly.Gesture.prototype), clickBlock = gesture.doBlockClick;
    gesture.doBlockClick = function () { // Blockly would put it where the list was
      if (!this.flyout || !takeBlock(this.targetBlock.getRootBlock(), false)) clickBlock.call(this);
    };
  }

  #makeWorkspace() {
    const { common } = Blockly, mainWorkspace = this.#listener ? null : common.getMainWorkspace(); // keys are those of the blocks that are seen
    Blockly.setLocale(textsOf('blockly'));
    const isNarrow = innerWidth < NARROW_PX;
    setNarrow(isNarrow && this.#listener !== null);
    defineBlocks();
    const workspace = withoutSound(() => Blockly.inject(this.#container, {
      ...this.#options,
      plugins: { connectionChecker: 'tiniscript', connectionPreviewer: 'tiniscript' },
      ...(this.#listener ? { toolbox: this.#makeToolbox() } : {}),
      trashcan: Boolean(this.#listener) && !isNarrow,
      comments: false,
      collapse: false,
      disable: false,
      move: { scrollbars: true, drag: true, wheel: true },
      zoom: { controls: false, wheel: Boolean(this.#listener), pinch: true, startScale: START_SCALE, minScale: 0.4, maxScale: 1.6 },
    }));
    if (mainWorkspace) common.setMainWorkspace(mainWorkspace);
    if (this.#listener) {
      this.#search?.element.remove();
      this.#search = new Search(workspace, (query) => findItems(query, this.#usedNames));
      this.#container.prepend(this.#search.element);
      this.#search.fitWidth();
      this.#zoomButtons?.remove();
      this.#zoomButtons = makeZoomButtons(workspace, START_SCALE);
      this.#container.append(this.#zoomButtons);
      this.#runFollower = new RunFollower(workspace);
    }
    workspace.MAX_UNDO = 0;
    hideTextMeasure();
    hideConnectionsFromReaders(workspace.getFlyout()?.getWorkspace().getCanvas());
    workspace.addChangeListener((event) => {
      if (this.#listener && event instanceof Blockly.Events.Click && event.targetType === 'block') {
        const block = workspace.getBlockById(event.blockId ?? '');
        if (block) this.#tryAlone(this.#listener, block, false);
      }
      if (event.type === Blockly.Events.SELECTED || event.type === Blockly.Events.CLICK || event.type === Blockly.Events.BLOCK_DRAG) keepSmallStacksVisible(workspace);
      if (event instanceof Blockly.Events.BubbleOpen && !event.isOpen) this.#closedMessage = this.#messageAt(event.blockId);
      if (event.isUiEvent || event.type === Blockly.Events.FINISHED_LOADING) return;
      updateCalls(workspace, event);
      this.#listener?.onChange();
    });
    return workspace;
  }

  /** Whether a block is being dragged. */
  get isDragging() {
    return this.#workspace.isDragging();
  }

  /** Whether a field of a block is open. */
  get isFieldOpen() {
    return Blockly.WidgetDiv.isVisible() || Blockly.DropDownDiv.isVisible();
  }

  /** The line of the text whose block has the focus, or 0. */
  get focusedLine() {
    const id = this.hasFocus || this.isFieldOpen || this.isDragging ? this.#focusedBlock()?.id : '';
    return this.#places.find(([blockId]) => blockId === id)?.[1][0] ?? 0;
  }

  /** Names whoever else is at a block, in their colour. @param {import('../class/together.js').MatePlace[]} matePlaces */
  showMates(matePlaces) {
    const { createSvgElement } = Blockly.utils.dom;
    for (const mark of this.#mateMarks) mark.remove();
    this.#mateMarks = matePlaces.flatMap(({ line, color, label }) => {
      const block = this.#workspace.getBlockById(this.#places.find(([, [firstLine]]) => firstLine === line)?.[0] ?? '');
      if (!block) return [];
      const { width, height } = block.getHeightWidth();
      const bounds = block.getBoundingRectangleWithoutChildren();
      const mark = createSvgElement('g', { class: 'mate_mark' }, block.getSvgRoot());
      mark.style.setProperty('--mate', color);
      createSvgElement('rect', { x: -5, y: 0, width: 5, height: bounds.getHeight() || height }, mark);
      createSvgElement('text', { x: width + 8, y: 18 }, mark).textContent = label;
      return [mark];
    });
  }

  /** In which line of the text each block is. @returns {[string, number][]} */
  get lines() {
    return this.#places.map(([id, [line]]) => [id, line]);
  }

  get hasFocus() {
    return this.#container.contains(document.activeElement);
  }

  /** The words on blocks are others: of another language, or of the text, too. */
  updateLanguage() {
    const { form } = formOf(this.#workspace);
    const places = this.#places.map(([, place]) => place);
    const { scrollX, scrollY, scale } = this.#workspace;
    const knownStacks = knownPlaces(this.#workspace, this.#stackPlaces);
    this.#workspace.dispose();
    this.#workspace = this.#makeWorkspace();
    this.#workspace.setScale(scale);
    this.show(form, knownStacks);
    if (this.#isTouched) this.#workspace.scroll(scrollX, scrollY);
    this.setRanges(this.#places.map(([id]) => id), places);
  }

  /** @param {string} robotName */
  setRobot(robotName) {
    setRobot(robotName);
    setActuators(robotName);
    this.#updateToolbox();
  }

  /** @param {Level} level */
  setLevel(level) {
    this.#level = level;
    this.#updateToolbox();
  }

  /** No lesson takes away what another one has offered. @param {TaughtBlocks} taught what the open lesson speaks of */
  setTaughtBlocks({ offered: offeredKinds, fresh: newPieces }) {
    this.#taughtBlocks = [...new Set([...this.#taughtBlocks, ...offeredKinds])];
    this.#newBlocks = newPieces;
    this.#updateToolbox();
  }

  /** @param {string[]} kinds @returns {Level} the lowest one that offers them all */
  levelOf(kinds) {
    return levelOf(kinds, this.#usedNames);
  }

  #makeToolbox() {
    const untriedBlocks = this.#newBlocks.filter((piece) => !this.#triedBlocks.has(piece));
    setNewPieces(untriedBlocks);
    this.#container.style.setProperty('--new', JSON.stringify(text('block_new')));
    return makeToolbox(this.#level, this.#usedNames, this.#taughtBlocks, untriedBlocks);
  }

  #updateToolbox() {
    if (!this.#listener) return;
    this.#workspace.updateToolbox(this.#makeToolbox());
    this.#search?.fitWidth();
  }

  /** Other blocks as a PNG file, made in slices: nobody sees them here. @param {Form} form @param {string} robotName @param {number} mostPixels pixels */
  async makeFormPicture(form, robotName, mostPixels) {
    setRobot(robotName);
    setActuators(robotName);
    await drawForm(this.#workspace, form);
    const picture = await renderPicture(this.#workspace.getCanvas(), this.#workspace.getBlocksBoundingBox(), mostPixels);
    clearWorkspace(this.#workspace);
    return picture;
  }

  /** The blocks as a PNG file; null without any. @returns {Promise<Blob | null>} */
  makePicture() {
    return renderPicture(this.#workspace.getCanvas(), this.#workspace.getBlocksBoundingBox());
  }

  resize() {
    if (!this.#container.clientWidth) return; // hidden: Blockly would forget what was seen
    const resize = () => {
      Blockly.svgResize(this.#workspace);
      this.#search?.fitWidth();
      if (!this.isDragging) makeRoom(this.#workspace, true);
      this.#scrollToBeginning();
    };
    if (this.#runFollower) this.#runFollower.resizeBy(resize);
    else resize();
    this.#runFollower?.keepInView();
    for (const [id] of this.#places) if (!this.#placeBubble(id)) this.#badgeOf(id)?.setBubbleVisible(false);
  }

  /** Until somebody scrolls: Blockly keeps the place of its scrollbars, not that of the blocks. */
  #scrollToBeginning() {
    if (!this.#isTouched) this.#workspace.scroll(0, 0);
  }

  /** What is shown next has been brought by the page, so nobody has used its blocks. @param {Form | null} form null where somebody made it */
  setGivenBlocks(form) {
    this.#givenBlocks = form ? piecesIn(blocksOf(form)) : [];
  }

  /** The next blocks are of another program, which is seen from its beginning. */
  beginProgram() {
    this.#isTouched = false;
    this.#stackPlaces.clear();
    this.#nextStackPlaces = null;
  }

  /**
   * Replaces the blocks: what stays the same stays in its place, and the focus, too.
   * @param {Form} form
   * @param {import('./form.js').StackPlaces} knownStacks
   */
  show(form, knownStacks = this.#nextStackPlaces ?? knownPlaces(this.#workspace, this.#stackPlaces)) {
    this.#nextStackPlaces = null;
    const workspace = this.#workspace;
    const { scrollX, scrollY } = workspace;
    const focusIndex = this.hasFocus ? this.#places.findIndex(([id]) => id === this.#focusedBlock()?.id) : null;
    if (focusIndex !== null) Blockly.getFocusManager().focusNode(workspace); // else a block that goes gives it to a neighbour, later
    Blockly.hideChaff();
    this.#markedIds = {};
    this.#shownFault = { id: '', message: '' };
    const ids = showForm(this.#workspace, form, knownStacks);
    labelCalls(this.#workspace);
    this.setRanges(ids, flatten(form.body).map((block) => block.place ?? [0, 0, 0, 0]));
    this.#updateUsedNames(form);
    this.#markLoose();
    const block = focusIndex === null ? null : this.#workspace.getBlockById(ids[Math.min(focusIndex, ids.length - 1)] ?? '');
    if (block) Blockly.getFocusManager().focusNode(block);
    else if (focusIndex !== null) Blockly.getFocusManager().focusTree(workspace);
    const scrollBack = () => {
      if (workspace !== this.#workspace) return;
      workspace.scroll(scrollX, scrollY);
      this.#scrollToBeginning();
    };
    scrollBack();
    if (focusIndex !== null) Blockly.renderManagement.finishQueuedRenders().then(scrollBack); // Blockly scrolls to what gets the focus
  }

  /** @returns {Blockly.Block | null} the block of the text that has the focus, or is around what has it */
  #focusedBlock() {
    let node = Blockly.getFocusManager().getFocusedNode();
    while (node && !(node instanceof Blockly.BlockSvg)) node = /** @type {any} */ (node).getSourceBlock?.() ?? null;
    let block = /** @type {Blockly.BlockSvg | null} */ (node);
    while (block && !this.#places.some(([id]) => id === block?.id)) block = block.getParent();
    return block;
  }

  /** @returns {{form: Form, ids: string[]}} */
  readForm() {
    makeRoom(this.#workspace);
    const formWithIds = formOf(this.#workspace);
    this.#updateUsedNames(formWithIds.form);
    this.#markLoose();
    return formWithIds;
  }

  /** Where each hat that somebody has put somewhere stands, and each loose stack. @returns {import('../writing/editor.js').LayoutText} */
  get layoutText() {
    /** @type {import('./form.js').StackPlaces} */
    const stackPlaces = new Map();
    keepPlaces(this.#workspace, stackPlaces);
    return JSON.stringify([...stackPlaces].sort(([a], [b]) => (a < b ? -1 : 1)));
  }

  /** Has the next blocks stand there again. @param {import('../writing/editor.js').LayoutText} layoutText */
  set layoutText(layoutText) {
    /** @type {[string, {x: number, y: number}[]][]} */
    const stackPlaces = JSON.parse(layoutText);
    this.#nextStackPlaces = new Map(stackPlaces.map(([name, places]) => [name, places.map(({ x, y }) => new Blockly.utils.Coordinate(x, y))]));
  }

  /** What is not joined to the program looks it, and is found where it is now. */
  #markLoose() {
    this.#setMarked('loose', this.#workspace.getTopBlocks(false).filter(isLoose).map(({ id }) => id));
    if (this.#stackPlaces.size > MAX_KNOWN_STACKS) this.#stackPlaces.clear();
    keepPlaces(this.#workspace, this.#stackPlaces);
  }

  /**
   * @param {string[]} ids
   * @param {TextRange[]} places
   */
  setRanges(ids, places) {
    this.#places = ids.map((id, index) => [id, places[index] ?? [0, 0, 0, 0]]);
  }

  /** Offers the names that the program has. @param {Form} form */
  #updateUsedNames(form) {
    const blocks = blocksOf(form);
    const wordsOfKind = (/** @type {string} */ kind) => [...new Set(blocks.filter((block) => block.kind === kind).map((block) => block.word))].sort();
    const valueCounts = new Map(blocks.filter((block) => block.kind === 'def').map((block) => [block.word, block.values.length]));
    const namesInUse = { names: wordsOfKind('assign'), words: [...valueCounts].sort() };
    const pieces = piecesIn(blocks);
    const newlyTriedPieces = [...new Set(pieces)].filter((piece) => !this.#triedBlocks.has(piece) && countOf(pieces, piece) > countOf(this.#givenBlocks, piece));
    for (const piece of newlyTriedPieces) this.#triedBlocks.add(piece);
    const isNewTried = newlyTriedPieces.some((piece) => this.#newBlocks.includes(piece));
    if (!isNewTried && JSON.stringify(namesInUse) === JSON.stringify(this.#usedNames)) return;
    this.#usedNames = namesInUse;
    if (!this.#workspace.isDragging()) this.#updateToolbox();
  }

  /** Says at each block what the compiler says of it. @param {Finding[]} findings */
  showFindings(findings) {
    this.#findings = findings;
    /** @type {Map<string, string[]>} */
    const messages = new Map();
    /** @type {Set<string>} */
    const wrongIds = new Set();
    if (this.#shownFault.id) messages.set(this.#shownFault.id, [this.#shownFault.message]);
    for (const finding of findings) {
      const id = this.#blockAt(finding.line, finding.column) ?? '';
      const { message, fix } = findingAsSeen(finding), messageText = [message, fix && `${text('try')} ${fix}`].filter(Boolean).join('\n');
      messages.set(id, [...(messages.get(id) ?? []), messageText]);
      if (finding.severity === 'mistake') wrongIds.add(id);
    }
    Blockly.Events.disable();
    try {
      for (const block of this.#workspace.getAllBlocks(false)) {
        if (block.isShadow()) continue;
        const id = block.type === 'program' ? '' : block.id;
        block.setWarningText(messages.get(id)?.map(wrapLines).join('\n\n') ?? null);
        if (wrongIds.has(id)) block.addClass('wrong');
        else block.removeClass('wrong');
      }
    } finally {
      Blockly.Events.enable();
    }
    const [firstWrongId] = wrongIds;
    if (!firstWrongId) this.#closedMessage = ''; // whoever makes the mistake again is told again
    else if (this.#messageAt(firstWrongId) !== this.#closedMessage) this.#openMessage(firstWrongId);
  }

  /** @param {string | undefined} id @returns {Blockly.icons.WarningIcon | null} */
  #badgeOf(id) {
    return this.#workspace.getBlockById(id ?? '')?.getIcon(Blockly.icons.WarningIcon.TYPE) ?? null;
  }

  /** @param {string | undefined} id @returns {string} */
  #messageAt(id) {
    return this.#badgeOf(id)?.getText() ?? '';
  }

  /** Shows the message of a block, where there is room. @param {string} id */
  async #openMessage(id) {
    const badge = this.#badgeOf(id);
    if (!badge || badge === this.#openingBadge || this.#container.clientHeight < MIN_HEIGHT_PX) return;
    this.#openingBadge = badge; // asked twice, Blockly would show it twice
    await badge.setBubbleVisible(true);
    this.#openingBadge = null;
    if (badge !== this.#badgeOf(id)) badge.getBubble()?.dispose(); // that block is gone
    else if (!this.#placeBubble(id)) badge.setBubbleVisible(false); // the list below has it
  }

  /**
   * Has an open message beside its block, as near as it stands on no other one: level with it, or higher or lower; else below
   * all blocks. A line leads to the block. @param {string} id @returns {boolean} whether there is room
   */
  #placeBubble(id) {
    const block = this.#workspace.getBlockById(id);
    const bubble = this.#badgeOf(id)?.getBubble();
    if (!block || !bubble) return true;
    const blockBounds = block.getBoundingRectangleWithoutChildren();
    const view = this.#workspace.getMetricsManager().getViewMetrics(true);
    const bubbleBounds = bubble.getBoundingRectangle();
    const stackBounds = block.getRootBlock().getBoundingRectangle();
    const otherBounds = this.#workspace.getAllBlocks(false).map((other) => other.getBoundingRectangleWithoutChildren());
    const { Coordinate } = Blockly.utils;
    const places = [blockBounds.top, blockBounds.bottom - bubbleBounds.getHeight(), (blockBounds.top + blockBounds.bottom - bubbleBounds.getHeight()) / 2]
      .filter((top) => top >= view.top && top + bubbleBounds.getHeight() <= view.top + view.height)
      .map((top) => {
        const obstacles = otherBounds.filter((other) => other.top < top + bubbleBounds.getHeight() && other.bottom - NOTCH_HEIGHT > top && other.right > blockBounds.left);
        return { top, edge: Math.max(blockBounds.right, ...obstacles.map((other) => other.right)) };
      })
      .filter(({ edge }) => edge + BUBBLE_GAP_BESIDE + bubbleBounds.getWidth() <= view.left + view.width)
      .sort((a, b) => a.edge - b.edge);
    const isBelow = stackBounds.bottom + BUBBLE_GAP_BELOW + bubbleBounds.getHeight() <= view.top + view.height;
    const fitsBeside = blockBounds.right + BUBBLE_GAP_BESIDE + bubbleBounds.getWidth() <= view.left + view.width;
    const [firstPlace] = places.length || isBelow || !fitsBeside ? places : [{ top: blockBounds.top, edge: blockBounds.right }];
    /** @type {any} */ (bubble).setAnchorLocation(new Coordinate(blockBounds.right, (blockBounds.top + blockBounds.bottom) / 2)); // else its line would go across the block
    if (firstPlace) bubble.moveDuringDrag(new Coordinate(firstPlace.edge + BUBBLE_GAP_BESIDE, firstPlace.top));
    else if (isBelow) bubble.moveDuringDrag(new Coordinate(Math.max(view.left, Math.min(stackBounds.left, view.left + view.width - bubbleBounds.getWidth())), stackBounds.bottom + BUBBLE_GAP_BELOW));
    return Boolean(firstPlace) || isBelow;
  }

  /** Marks the blocks that run now, one in each task. @param {{line: number, column: number}[]} ranges */
  showRunning(ranges) {
    const ids = ranges.map(({ line, column }) => this.#blockAt(line, column) ?? '');
    this.#setMarked('running', ids);
    this.#runFollower?.showRunning(ids);
  }

  /** Gives a look to these blocks, and to no others. @param {string} className @param {string[]} ids */
  #setMarked(className, ids) {
    const idsBefore = this.#markedIds[className] ?? new Set(), idsNow = new Set(ids);
    for (const id of idsBefore) if (!idsNow.has(id)) this.#workspace.getBlockById(id)?.removeClass(className);
    for (const id of idsNow) if (!idsBefore.has(id)) this.#workspace.getBlockById(id)?.addClass(className);
    this.#markedIds[className] = idsNow;
  }

  /** @param {{line: number, column: number}[]} breakpoints */
  showBreakpoints(breakpoints) {
    this.#setMarked('breakpoint', breakpoints.map(({ line, column }) => this.#blockAt(line, column) ?? ''));
  }

  /**
   * Says at a block which fault it had, or that there is none.
   * @param {{line: number, column: number} | null} range
   * @param {string} message
   */
  showFault(range, message) {
    const id = range ? this.#blockAt(range.line, range.column) ?? '' : '';
    if (id === this.#shownFault.id && message === this.#shownFault.message) return;
    this.#setMarked('fault', [id]);
    this.#shownFault = { id, message };
    this.showFindings(this.#findings);
  }

  /** @param {{line: number, column: number}} position */
  goTo(position) {
    const block = this.#workspace.getBlockById(this.#blockAt(position.line, position.column) ?? '');
    if (!block) return;
    this.#isTouched = true;
    this.#workspace.centerOnBlock(block.id);
    Blockly.getFocusManager().focusNode(block);
    this.#openMessage(block.id);
  }

  /**
   * @param {number} line
   * @param {number} column
   * @returns {string | undefined} the innermost block there
   */
  #blockAt(line, column) {
    const innermost = this.#places.findLast(([, [firstLine, firstColumn, lastLine, endColumn]]) =>
      (line > firstLine || (line === firstLine && column >= firstColumn)) && (line < lastLine || (line === lastLine && column < endColumn)));
    return (innermost ?? this.#places.findLast(([, [first]]) => first === line))?.[0];
  }
}

/** @param {import('./form.js').FormBlock[]} blocks @returns {import('./form.js').FormBlock[]} */
function flatten(blocks) {
  return blocks.flatMap((block) => [block, ...block.bodies.flatMap(flatten)]);
}

/** Blockly brings what is touched to the front: smaller piles that it would hide stay before it. @param {Blockly.WorkspaceSvg} workspace */
function keepSmallStacksVisible(workspace) {
  const focusedNode = Blockly.getFocusManager().getFocusedNode();
  const stack = focusedNode instanceof Blockly.BlockSvg && focusedNode.workspace === workspace && !workspace.isDragging() ? focusedNode.getRootBlock() : null;
  if (!stack) return;
  const stackRect = stack.getBoundingRectangle(), areaOf = (/** @type {Blockly.utils.Rect} */ rect) => rect.getWidth() * rect.getHeight();
  for (const other of workspace.getTopBlocks(false)) {
    const rect = other.getBoundingRectangle();
    if (other !== stack && areaOf(rect) < areaOf(stackRect) && rect.intersects(stackRect)) workspace.getCanvas().append(other.getSvgRoot());
  }
}

/** Fills each line: Blockly makes all about equal, and as long as it likes. @param {string} message */
function wrapLines(message) {
  const mostCharacters = innerWidth < NARROW_PX ? MAX_NARROW_TIP_CHARACTERS : MAX_TIP_CHARACTERS;
  return message.replace(new RegExp(`(.{1,${mostCharacters}})(?:[ \\n]+|$)`, 'g'), '$1\n').trimEnd();
}

/** In a list of blocks to take there is nothing else: where they would be joined is no part of it. @param {SVGElement | undefined} list */
function hideConnectionsFromReaders(list) {
  if (!list) return;
  new MutationObserver(() => {
    for (const path of list.querySelectorAll('.blocklyHighlightedConnectionPath')) path.setAttribute('aria-hidden', 'true');
  }).observe(list, { childList: true, subtree: true });
}

/** Hides what Blockly measures texts with, which it makes when it first needs it. */
function hideTextMeasure() {
  new MutationObserver((_, observer) => {
    const canvas = document.querySelector('.blocklyComputeCanvas');
    if (!canvas) return;
    canvas.setAttribute('aria-hidden', 'true');
    observer.disconnect();
  }).observe(document.body, { childList: true });
  document.querySelector('.blocklyComputeCanvas')?.setAttribute('aria-hidden', 'true');
}

/**
 * Blockly opens the computer's sound for each of its workspaces, and what has it open works all the time.
 * Nothing of them sounds here: while they are made, there is none.
 * @template T
 * @param {() => T} make
 */
function withoutSound(make) {
  const audioWindow = /** @type {{AudioContext: unknown}} */ (window);
  const { AudioContext } = audioWindow;
  audioWindow.AudioContext = undefined;
  try {
    return make();
  } finally {
    audioWindow.AudioContext = AudioContext;
  }
}

/** @param {Form} form @returns {import('./form.js').FormBlock[]} */
function blocksOf(form) {
  return flatten([...form.body, ...form.loose.flatMap((stack) => stack.body)]);
}

/** @param {string[]} pieces @param {string} wantedPiece */
function countOf(pieces, wantedPiece) {
  return pieces.filter((piece) => piece === wantedPiece).length;
}
