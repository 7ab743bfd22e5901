// The program as blocks. Knows Blockly; the page fetches this file when blocks are first looked at.
//
// The text is what is kept: a change of the blocks is told to the page, which asks for their text.

import * as Blockly from 'blockly/core';
import { clear, drawForm, formOf, isLoose, formOfOne, keepPlaces, knownPlaces, makeRoom, piecesIn, showForm } from './form.js';
import { follow, labelCalls } from './own_words.js';
import { setActuators } from './places.js';
import { Checker, defineBlocks, setNarrow, setNew, setRobot } from './shapes.js';
import { letHear } from './fields.js';
import { insert } from './insert.js';
import { pictureOf } from './picture.js';
import { Search } from './search.js';
import { look } from './styles.js';
import { found, levelOf, toolbox } from './toolbox.js';
import { Sight } from './sight.js';
import { zoomOf } from './zoom.js';
import { text, textsOf } from '../page/texts.js';

/** @import { Form, Range } from './form.js' */
/** @typedef {import('./toolbox.js').Level} Level */
/** @typedef {import('../python.js').Finding} Finding */
/** @typedef {import('../page/page_state.js').TaughtBlocks} Taught */
/**
 * @typedef {object} Told who is told of what is done to blocks
 * @property {() => void} changed
 * @property {(place: {line: number, column: number}) => void} toggle
 * @property {(form: Form, isAsked: boolean) => Promise<void>} tryAlone a part of the program, until it has run; whoever only touched it wants nothing else to end for it
 * @property {(hertz: number) => void} hear
 */

const NARROW = 700; // pixels of width, below which questions are folded
const SCALE = 0.75; // at which letters are 12 pixels high, and what is pressed is 24
const LONGEST_TIP = 30; // about so many characters are in a line of a message at a block
const SNAPS = 48; // units of a workspace: how far off a block may be dropped
const STAYS = 68; // the same while it is shown where it would go
const NOTCH = 8; // of a block, in the one below it
const BESIDE = 24; // units between a block and its message
const BELOW = 12; // the same, where it stands below
const LOW = 240; // pixels of height: in less, a message is seen when somebody asks
const MOST_STOOD = 200; // stacks whose places are known

export class Blocks {
  #place;
  #told;
  #looks = look();
  /** @type {Blockly.WorkspaceSvg} */
  #workspace;
  /** @type {Level} */
  #level = 'few';
  /** @type {import('./toolbox.js').Used} */
  #used = { names: [], words: [] };
  /** @type {string[]} */
  #taught = [];
  /** Blocks that are the newest of the open lesson. @type {string[]} */
  #new = [];
  /** Blocks that somebody has used. @type {Set<string>} */
  #tried = new Set();
  /** Those of the program that the page has brought. @type {string[]} */
  #given = [];
  /** Ids of the blocks, and where each is in the text. @type {[string, Range][]} */
  #places = [];
  #isTouched = false; // by somebody, who may have scrolled
  /** @type {import('./form.js').Stood} */
  #stood = new Map();
  /** Where the next blocks stand, whatever is known of those before. @type {import('./form.js').Stood | null} */
  #next = null;
  /** @type {Blockly.icons.WarningIcon | null} */
  #opening = null;
  #closed = ''; // the message that somebody has put away
  /** The ids of the blocks with each look. @type {Record<string, Set<string>>} */
  #marked = {};
  #fault = { id: '', said: '' };
  /** @type {Search | null} */
  #search = null;
  /** @type {HTMLElement | null} */
  #zoom = null;
  /** @type {Finding[]} */
  #findings = [];
  /** @type {SVGElement[]} */
  #mates = [];
  /** Has what runs be seen. @type {Sight | null} */
  #sight = null;

  /**
   * @param {HTMLElement} place
   * @param {string} robot
   * @param {Level} level
   * @param {Told | null} told null of blocks that are only drawn
   */
  constructor(place, robot, level, told = null) {
    this.#place = place;
    this.#told = told;
    this.#level = level;
    Blockly.registry.register(Blockly.registry.Type.CONNECTION_CHECKER, 'tiniscript', Checker, true);
    Object.assign(Blockly.config, { snapRadius: SNAPS, connectingSnapRadius: STAYS });
    this.#leaveOut();
    if (told) {
      letHear(told.hear);
      this.#offerBreakpoints(told);
      this.#offerTrying(told);
    }
    setRobot(robot);
    setActuators(robot);
    this.#workspace = this.#begin();
    for (const kind of ['pointerdown', 'wheel', 'keydown']) {
      place.addEventListener(kind, () => {
        this.#isTouched = true;
        this.#sight?.leave();
      }, { capture: true, passive: true });
    }
  }

  /** Undo and redo are those of the text, which is what changes: the page has their keys. */
  #leaveOut() {
    for (const name of ['undoWorkspace', 'redoWorkspace', 'blockDisable', 'blockInline', 'blockCollapseExpand', 'collapseWorkspace', 'expandWorkspace', 'blockHelp']) {
      if (Blockly.ContextMenuRegistry.registry.getItem(name)) Blockly.ContextMenuRegistry.registry.unregister(name);
    }
    const { registry } = Blockly.ShortcutRegistry;
    for (const name of ['undo', 'redo']) if (registry.getRegistry()[name]) registry.unregister(name);
  }

  /** In the menu of a block, and by F9. */
  #offerBreakpoints(/** @type {Told} */ told) {
    const toggle = (/** @type {any} */ block) => {
      const place = block && this.#places.find(([id]) => id === block.id)?.[1];
      if (place?.[0]) told.toggle({ line: place[0], column: place[1] });
      return Boolean(place?.[0]);
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
      callback: () => toggle(this.#focused()),
    });
  }

  /** In the menu of a block, by Shift and Enter, and by a click. @param {Told} told */
  #offerTrying(told) {
    const act = (/** @type {any} */ block) => {
      if (block) this.#try(told, block, true);
      return Boolean(block);
    };
    if (Blockly.ContextMenuRegistry.registry.getItem('try')) return;
    Blockly.ContextMenuRegistry.registry.register({
      id: 'try',
      weight: -1,
      scopeType: Blockly.ContextMenuRegistry.ScopeType.BLOCK,
      displayText: () => text('try_block'),
      preconditionFn: ({ block }) => (block && !block.isInFlyout ? 'enabled' : 'hidden'),
      callback: ({ block }) => act(block),
    });
    const { SHIFT, ENTER } = Blockly.utils.KeyCodes;
    Blockly.ShortcutRegistry.registry.register({
      name: 'try',
      keyCodes: [Blockly.ShortcutRegistry.registry.createSerializedKey(ENTER, [SHIFT])],
      callback: () => act(this.#focused()),
    });
  }

  /** @param {Told} told @param {Blockly.Block} block @param {boolean} isAsked and not only touched */
  async #try(told, block, isAsked) {
    let whole = block;
    while (whole.isShadow()) whole = whole.getParent() ?? whole;
    this.#mark('alone', [whole.id]);
    try {
      await told.tryAlone(formOfOne(whole), isAsked);
    } finally {
      if (this.#marked['alone']?.has(whole.id)) this.#mark('alone', []);
    }
  }

  /** Whoever chooses a block of a list with the keyboard has it where the focus was. @param {Blockly.WorkspaceSvg} workspace */
  #insertByKeys(workspace) {
    /** @type {Blockly.BlockSvg | null} */
    let last = null; // that had the focus of the program
    this.#place.addEventListener('focusin', ({ target }) => {
      const drawn = /** @type {Element} */ (target).closest('.blocklyBlock');
      last = workspace.getBlockById(drawn?.getAttribute('data-id') ?? '') ?? last;
    });
    this.#place.addEventListener('keydown', (event) => {
      const taken = Blockly.getFocusManager().getFocusedNode();
      const isTaken = taken instanceof Blockly.BlockSvg && taken.isInFlyout && workspace === this.#workspace && workspace === taken.workspace.targetWorkspace;
      if (!isTaken || !['Enter', ' '].includes(event.key) || event.shiftKey || event.ctrlKey || event.metaKey) return;
      const isThere = last && workspace.getBlockById(last.id) === last;
      const block = insert(/** @type {Blockly.BlockSvg} */ (taken.getRootBlock()), workspace, isThere ? last : null);
      if (!block) return; // Blockly lets it be moved to a place
      event.preventDefault();
      event.stopPropagation();
      this.#search?.clear();
      workspace.hideChaff();
      workspace.getFlyout()?.hide();
      Blockly.getFocusManager().focusNode(block);
    }, { capture: true });
  }

  #begin() {
    const { common } = Blockly, before = this.#told ? null : common.getMainWorkspace(); // keys are those of the blocks that are seen
    Blockly.setLocale(textsOf('blockly'));
    const isNarrow = innerWidth < NARROW;
    setNarrow(isNarrow && this.#told !== null);
    defineBlocks();
    const workspace = withoutSound(() => Blockly.inject(this.#place, {
      ...this.#looks,
      plugins: { connectionChecker: 'tiniscript' },
      ...(this.#told ? { toolbox: this.#offered() } : {}),
      trashcan: Boolean(this.#told) && !isNarrow,
      comments: false,
      collapse: false,
      disable: false,
      move: { scrollbars: true, drag: true, wheel: true },
      zoom: { controls: false, wheel: Boolean(this.#told), pinch: true, startScale: SCALE, minScale: 0.4, maxScale: 1.6 },
    }));
    if (before) common.setMainWorkspace(before);
    if (this.#told) {
      this.#search?.place.remove();
      this.#search = new Search(workspace, (words) => found(words, this.#used));
      this.#place.prepend(this.#search.place);
      this.#search.fit();
      this.#zoom?.remove();
      this.#zoom = zoomOf(workspace, SCALE);
      this.#place.append(this.#zoom);
      this.#sight = new Sight(workspace);
      this.#insertByKeys(workspace);
    }
    workspace.MAX_UNDO = 0;
    hideMeasure();
    hideConnections(workspace.getFlyout()?.getWorkspace().getCanvas());
    workspace.addChangeListener((event) => {
      if (this.#told && event instanceof Blockly.Events.Click && event.targetType === 'block') {
        const block = workspace.getBlockById(event.blockId ?? '');
        if (block) this.#try(this.#told, block, false);
      }
      if (event.type === Blockly.Events.SELECTED || event.type === Blockly.Events.CLICK || event.type === Blockly.Events.BLOCK_DRAG) keepSeen(workspace);
      if (event instanceof Blockly.Events.BubbleOpen && !event.isOpen) this.#closed = this.#saidAt(event.blockId);
      if (event.isUiEvent || event.type === Blockly.Events.FINISHED_LOADING) return;
      follow(workspace, event);
      this.#told?.changed();
    });
    return workspace;
  }

  /** Whether a block is being dragged or a field is being typed in. */
  get isBusy() {
    return this.#workspace.isDragging();
  }

  /** Whether a field of a block is open. */
  get isOpen() {
    return Blockly.WidgetDiv.isVisible() || Blockly.DropDownDiv.isVisible();
  }

  /** The line of the text whose block has the focus, or 0. */
  get chosenLine() {
    const id = this.hasFocus || this.isOpen || this.isBusy ? this.#focused()?.id : '';
    return this.#places.find(([each]) => each === id)?.[1][0] ?? 0;
  }

  /** Names whoever else is at a block, in their colour. @param {import('../class/together.js').MatePlace[]} places */
  showMates(places) {
    const { createSvgElement } = Blockly.utils.dom;
    for (const each of this.#mates) each.remove();
    this.#mates = places.flatMap(({ line, color, said }) => {
      const block = this.#workspace.getBlockById(this.#places.find(([, [first]]) => first === line)?.[0] ?? '');
      if (!block) return [];
      const { width, height } = block.getHeightWidth();
      const own = block.getBoundingRectangleWithoutChildren();
      const mark = createSvgElement('g', { class: 'mate_mark' }, block.getSvgRoot());
      mark.style.setProperty('--mate', color);
      createSvgElement('rect', { x: -5, y: 0, width: 5, height: own.getHeight() || height }, mark);
      createSvgElement('text', { x: width + 8, y: 18 }, mark).textContent = said;
      return [mark];
    });
  }

  /** In which line of the text each block is. @returns {[string, number][]} */
  get lines() {
    return this.#places.map(([id, [line]]) => [id, line]);
  }

  get hasFocus() {
    return this.#place.contains(document.activeElement);
  }

  /** The words on blocks are others: of another language, or of the text, too. */
  showWords() {
    const { form } = formOf(this.#workspace);
    const places = this.#places.map(([, place]) => place);
    const { scrollX, scrollY, scale } = this.#workspace;
    const known = knownPlaces(this.#workspace, this.#stood);
    this.#workspace.dispose();
    this.#workspace = this.#begin();
    this.#workspace.setScale(scale);
    this.show(form, known);
    if (this.#isTouched) this.#workspace.scroll(scrollX, scrollY);
    this.placed(this.#places.map(([id]) => id), places);
  }

  /** @param {string} robot */
  setRobot(robot) {
    setRobot(robot);
    setActuators(robot);
    this.#offer();
  }

  /** @param {Level} level */
  setLevel(level) {
    this.#level = level;
    this.#offer();
  }

  /** No lesson takes away what another one has offered. @param {Taught} taught what the open lesson speaks of */
  setTaught({ offered, fresh }) {
    this.#taught = [...new Set([...this.#taught, ...offered])];
    this.#new = fresh;
    this.#offer();
  }

  /** @param {string[]} kinds @returns {Level} the lowest one that offers them all */
  levelOf(kinds) {
    return levelOf(kinds, this.#used);
  }

  #offered() {
    const fresh = this.#new.filter((item) => !this.#tried.has(item));
    setNew(fresh);
    this.#place.style.setProperty('--new', JSON.stringify(text('block_new')));
    return toolbox(this.#level, this.#used, this.#taught, fresh);
  }

  #offer() {
    if (!this.#told) return;
    this.#workspace.updateToolbox(this.#offered());
    this.#search?.fit();
  }

  /** Other blocks as a PNG file, made in slices: nobody sees them here. @param {Form} form @param {string} robot @param {number} most pixels */
  async pictureOf(form, robot, most) {
    setRobot(robot);
    setActuators(robot);
    await drawForm(this.#workspace, form);
    const picture = await pictureOf(this.#workspace.getCanvas(), this.#workspace.getBlocksBoundingBox(), most);
    clear(this.#workspace);
    return picture;
  }

  /** The blocks as a PNG file; null without any. @returns {Promise<Blob | null>} */
  picture() {
    return pictureOf(this.#workspace.getCanvas(), this.#workspace.getBlocksBoundingBox());
  }

  resize() {
    if (!this.#place.clientWidth) return; // hidden: Blockly would forget what was seen
    Blockly.svgResize(this.#workspace);
    this.#search?.fit();
    if (!this.isBusy) makeRoom(this.#workspace, true);
    this.#seeBeginning();
    this.#sight?.keep();
    for (const [id] of this.#places) if (!this.#put(id)) this.#badgeOf(id)?.setBubbleVisible(false);
  }

  /** Until somebody scrolls: Blockly keeps the place of its scrollbars, not that of the blocks. */
  #seeBeginning() {
    if (!this.#isTouched) this.#workspace.scroll(0, 0);
  }

  /** What is shown next has been brought by the page, so nobody has used its blocks. @param {Form | null} form null where somebody made it */
  setGiven(form) {
    this.#given = form ? piecesIn(blocksOf(form)) : [];
  }

  /** The next blocks are of another program, which is seen from its beginning. */
  begin() {
    this.#isTouched = false;
    this.#stood.clear();
    this.#next = null;
  }

  /**
   * Replaces the blocks: what stays the same stays in its place, and the focus, too.
   * @param {Form} form
   * @param {import('./form.js').Stood} known
   */
  show(form, known = this.#next ?? knownPlaces(this.#workspace, this.#stood)) {
    this.#next = null;
    const workspace = this.#workspace;
    const { scrollX, scrollY } = workspace;
    const focus = this.hasFocus ? this.#places.findIndex(([id]) => id === this.#focused()?.id) : null;
    if (focus !== null) Blockly.getFocusManager().focusNode(workspace); // else a block that goes gives it to a neighbour, later
    Blockly.hideChaff();
    this.#marked = {};
    this.#fault = { id: '', said: '' };
    const ids = showForm(this.#workspace, form, known);
    labelCalls(this.#workspace);
    this.placed(ids, inOrder(form.body).map((block) => block.place ?? [0, 0, 0, 0]));
    this.#use(form);
    this.#greyLoose();
    const block = focus === null ? null : this.#workspace.getBlockById(ids[Math.min(focus, ids.length - 1)] ?? '');
    if (block) Blockly.getFocusManager().focusNode(block);
    else if (focus !== null) Blockly.getFocusManager().focusTree(workspace);
    const stay = () => {
      if (workspace !== this.#workspace) return;
      workspace.scroll(scrollX, scrollY);
      this.#seeBeginning();
    };
    stay();
    if (focus !== null) Blockly.renderManagement.finishQueuedRenders().then(stay); // Blockly scrolls to what gets the focus
  }

  /** @returns {Blockly.Block | null} the block of the text that has the focus, or is around what has it */
  #focused() {
    let node = Blockly.getFocusManager().getFocusedNode();
    while (node && !(node instanceof Blockly.BlockSvg)) node = /** @type {any} */ (node).getSourceBlock?.() ?? null;
    let block = /** @type {Blockly.BlockSvg | null} */ (node);
    while (block && !this.#places.some(([id]) => id === block?.id)) block = block.getParent();
    return block;
  }

  /** @returns {{form: Form, ids: string[]}} */
  read() {
    makeRoom(this.#workspace);
    const found = formOf(this.#workspace);
    this.#use(found.form);
    this.#greyLoose();
    return found;
  }

  /** Where each hat that somebody has put somewhere stands, and each loose stack. @returns {import('../writing/editor.js').Stand} */
  get stand() {
    /** @type {import('./form.js').Stood} */
    const stood = new Map();
    keepPlaces(this.#workspace, stood);
    return JSON.stringify([...stood].sort(([a], [b]) => (a < b ? -1 : 1)));
  }

  /** Has the next blocks stand there again. @param {import('../writing/editor.js').Stand} stand */
  set stand(stand) {
    /** @type {[string, {x: number, y: number}[]][]} */
    const stood = JSON.parse(stand);
    this.#next = new Map(stood.map(([name, places]) => [name, places.map(({ x, y }) => new Blockly.utils.Coordinate(x, y))]));
  }

  /** What is not joined to the program looks it, and is found where it is now. */
  #greyLoose() {
    this.#mark('loose', this.#workspace.getTopBlocks(false).filter(isLoose).map(({ id }) => id));
    if (this.#stood.size > MOST_STOOD) this.#stood.clear();
    keepPlaces(this.#workspace, this.#stood);
  }

  /**
   * @param {string[]} ids
   * @param {Range[]} places
   */
  placed(ids, places) {
    this.#places = ids.map((id, k) => [id, places[k] ?? [0, 0, 0, 0]]);
  }

  /** Offers the names that the program has. @param {Form} form */
  #use(form) {
    const blocks = blocksOf(form);
    const of = (/** @type {string} */ kind) => [...new Set(blocks.filter((block) => block.kind === kind).map((block) => block.word))].sort();
    const counts = new Map(blocks.filter((block) => block.kind === 'def').map((block) => [block.word, block.values.length]));
    const used = { names: of('assign'), words: [...counts].sort() };
    const items = piecesIn(blocks);
    const tried = [...new Set(items)].filter((item) => !this.#tried.has(item) && countOf(items, item) > countOf(this.#given, item));
    for (const item of tried) this.#tried.add(item);
    const isTried = tried.some((item) => this.#new.includes(item));
    if (!isTried && JSON.stringify(used) === JSON.stringify(this.#used)) return;
    this.#used = used;
    if (!this.#workspace.isDragging()) this.#offer();
  }

  /** Says at each block what the compiler says of it. @param {Finding[]} findings */
  showFindings(findings) {
    this.#findings = findings;
    /** @type {Map<string, string[]>} */
    const said = new Map();
    /** @type {Set<string>} */
    const wrong = new Set();
    if (this.#fault.id) said.set(this.#fault.id, [this.#fault.said]);
    for (const finding of findings) {
      const id = this.#blockAt(finding.line, finding.column) ?? '';
      const whole = [finding.message, finding.fix && `${text('try')} ${finding.fix}`].filter(Boolean).join('\n');
      said.set(id, [...(said.get(id) ?? []), whole]);
      if (finding.severity === 'mistake') wrong.add(id);
    }
    Blockly.Events.disable();
    try {
      for (const block of this.#workspace.getAllBlocks(false)) {
        if (block.isShadow()) continue;
        const id = block.type === 'program' ? '' : block.id;
        block.setWarningText(said.get(id)?.map(folded).join('\n\n') ?? null);
        if (wrong.has(id)) block.addClass('wrong');
        else block.removeClass('wrong');
      }
    } finally {
      Blockly.Events.enable();
    }
    const [first] = wrong;
    if (!first) this.#closed = ''; // whoever makes the mistake again is told again
    else if (this.#saidAt(first) !== this.#closed) this.#open(first);
  }

  /** @param {string | undefined} id @returns {Blockly.icons.WarningIcon | null} */
  #badgeOf(id) {
    return this.#workspace.getBlockById(id ?? '')?.getIcon(Blockly.icons.WarningIcon.TYPE) ?? null;
  }

  /** @param {string | undefined} id @returns {string} */
  #saidAt(id) {
    return this.#badgeOf(id)?.getText() ?? '';
  }

  /** Shows the message of a block, where there is room. @param {string} id */
  async #open(id) {
    const badge = this.#badgeOf(id);
    if (!badge || badge === this.#opening || this.#place.clientHeight < LOW) return;
    this.#opening = badge; // asked twice, Blockly would show it twice
    await badge.setBubbleVisible(true);
    this.#opening = null;
    if (badge !== this.#badgeOf(id)) badge.getBubble()?.dispose(); // that block is gone
    else if (!this.#put(id)) badge.setBubbleVisible(false); // the list below has it
  }

  /**
   * Has an open message beside its block, as near as it stands on no other one: level with it, or higher or lower; else below
   * all blocks. A line leads to the block. @param {string} id @returns {boolean} whether there is room
   */
  #put(id) {
    const block = this.#workspace.getBlockById(id);
    const bubble = this.#badgeOf(id)?.getBubble();
    if (!block || !bubble) return true;
    const own = block.getBoundingRectangleWithoutChildren();
    const view = this.#workspace.getMetricsManager().getViewMetrics(true);
    const size = bubble.getBoundingRectangle();
    const all = block.getRootBlock().getBoundingRectangle();
    const beside = this.#workspace.getAllBlocks(false).map((each) => each.getBoundingRectangleWithoutChildren());
    const { Coordinate } = Blockly.utils;
    const places = [own.top, own.bottom - size.getHeight(), (own.top + own.bottom - size.getHeight()) / 2]
      .filter((top) => top >= view.top && top + size.getHeight() <= view.top + view.height)
      .map((top) => {
        const inWay = beside.filter((each) => each.top < top + size.getHeight() && each.bottom - NOTCH > top && each.right > own.left);
        return { top, edge: Math.max(own.right, ...inWay.map((each) => each.right)) };
      })
      .filter(({ edge }) => edge + BESIDE + size.getWidth() <= view.left + view.width)
      .sort((a, b) => a.edge - b.edge);
    const isBelow = all.bottom + BELOW + size.getHeight() <= view.top + view.height;
    const fits = own.right + BESIDE + size.getWidth() <= view.left + view.width;
    const [place] = places.length || isBelow || !fits ? places : [{ top: own.top, edge: own.right }];
    /** @type {any} */ (bubble).setAnchorLocation(new Coordinate(own.right, (own.top + own.bottom) / 2)); // else its line would go across the block
    if (place) bubble.moveDuringDrag(new Coordinate(place.edge + BESIDE, place.top));
    else if (isBelow) bubble.moveDuringDrag(new Coordinate(all.left, all.bottom + BELOW));
    return Boolean(place) || isBelow;
  }

  /** Marks the blocks that run now, one in each task. @param {{line: number, column: number}[]} ranges */
  showRunning(ranges) {
    const ids = ranges.map(({ line, column }) => this.#blockAt(line, column) ?? '');
    this.#mark('running', ids);
    this.#sight?.see(ids);
  }

  /** Gives a look to these blocks, and to no others. @param {string} look @param {string[]} ids */
  #mark(look, ids) {
    const before = this.#marked[look] ?? new Set(), now = new Set(ids);
    for (const id of before) if (!now.has(id)) this.#workspace.getBlockById(id)?.removeClass(look);
    for (const id of now) if (!before.has(id)) this.#workspace.getBlockById(id)?.addClass(look);
    this.#marked[look] = now;
  }

  /** @param {{line: number, column: number}[]} breakpoints */
  showBreakpoints(breakpoints) {
    this.#mark('breakpoint', breakpoints.map(({ line, column }) => this.#blockAt(line, column) ?? ''));
  }

  /**
   * Says at a block which fault it had, or that there is none.
   * @param {{line: number, column: number} | null} range
   * @param {string} said
   */
  showFault(range, said) {
    const id = range ? this.#blockAt(range.line, range.column) ?? '' : '';
    if (id === this.#fault.id && said === this.#fault.said) return;
    this.#mark('fault', [id]);
    this.#fault = { id, said };
    this.showFindings(this.#findings);
  }

  /** @param {{line: number, column: number}} place */
  goTo(place) {
    const block = this.#workspace.getBlockById(this.#blockAt(place.line, place.column) ?? '');
    if (!block) return;
    this.#isTouched = true;
    this.#workspace.centerOnBlock(block.id);
    Blockly.getFocusManager().focusNode(block);
    this.#open(block.id);
  }

  /**
   * @param {number} line
   * @param {number} column
   * @returns {string | undefined} the innermost block there
   */
  #blockAt(line, column) {
    const found = this.#places.findLast(([, [first, from, last, to]]) =>
      (line > first || (line === first && column >= from)) && (line < last || (line === last && column < to)));
    return (found ?? this.#places.findLast(([, [first]]) => first === line))?.[0];
  }
}

/** @param {import('./form.js').FormBlock[]} blocks @returns {import('./form.js').FormBlock[]} */
function inOrder(blocks) {
  return blocks.flatMap((block) => [block, ...block.bodies.flatMap(inOrder)]);
}

/** Blockly brings what is touched to the front: smaller piles that it would hide stay before it. @param {Blockly.WorkspaceSvg} workspace */
function keepSeen(workspace) {
  const front = Blockly.getFocusManager().getFocusedNode();
  const pile = front instanceof Blockly.BlockSvg && front.workspace === workspace && !workspace.isDragging() ? front.getRootBlock() : null;
  if (!pile) return;
  const whole = pile.getBoundingRectangle(), size = (/** @type {Blockly.utils.Rect} */ rect) => rect.getWidth() * rect.getHeight();
  for (const other of workspace.getTopBlocks(false)) {
    const rect = other.getBoundingRectangle();
    if (other !== pile && size(rect) < size(whole) && rect.intersects(whole)) workspace.getCanvas().append(other.getSvgRoot());
  }
}

/** @param {string} message */
function folded(message) {
  return Blockly.utils.string.wrap(message, LONGEST_TIP);
}

/** In a list of blocks to take there is nothing else: where they would be joined is no part of it. @param {SVGElement | undefined} list */
function hideConnections(list) {
  if (!list) return;
  new MutationObserver(() => {
    for (const each of list.querySelectorAll('.blocklyHighlightedConnectionPath')) each.setAttribute('aria-hidden', 'true');
  }).observe(list, { childList: true, subtree: true });
}

/** Hides what Blockly measures texts with, which it makes when it first needs it. */
function hideMeasure() {
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
  const page = /** @type {{AudioContext: unknown}} */ (window);
  const { AudioContext } = page;
  page.AudioContext = undefined;
  try {
    return make();
  } finally {
    page.AudioContext = AudioContext;
  }
}

/** @param {Form} form @returns {import('./form.js').FormBlock[]} */
function blocksOf(form) {
  return inOrder([...form.body, ...form.loose.flatMap((stack) => stack.body)]);
}

/** @param {string[]} items @param {string} wanted */
function countOf(items, wanted) {
  return items.filter((item) => item === wanted).length;
}
