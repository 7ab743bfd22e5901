// A world is changed by hand: with a mouse, a finger or keys. Knows the page, and the form of a world
// only by `parts.js`.

import { element } from '../page/elements.js';
import { readBytes, downloadText, onFileChosen } from '../page/files.js';
import { copyAsOwn } from './own.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, textKey, text } from '../page/texts.js';
import {
  FLOOR, turnHandleOf, isSamePart, KINDS, withMovedPart, NUMBERS, clampToFloor, partAt, partsOf, pointIndexAt, pointsOf, START, withTurnedHandle, withTurnedPart,
  valueOf, withDrawnPart, withoutPart, withPoint,
} from './parts.js';
import { partName, showNumbers } from './numbers.js';

/** @import { World, Part, PartKind, Point } from './parts.js' */
/** @typedef {import('./choice.js').Page} Page */
/** @typedef {{gesture: 'move' | 'draw' | 'turn', part: Part, pointIndex: number, startPoint: Point, worldBefore: World, baseWorld: World, track: Point[]}} Drag `baseWorld`: what is moved */

const STEP_CM = 5;
const FINE_STEP_CM = 1;
const TURN_DEGREES = 15; // degrees
const MAX_SPOKEN_NUMBERS = 2; // numbers of a part; all are beside it
const MAX_UNDO_STEPS = 200; // changes that can be undone
/** @type {Record<string, Point>} */
const ARROW_DIRECTIONS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class WorldDrawing {
  #python;
  #arena;
  #page;
  #canvas = element('arena', HTMLCanvasElement);
  #drawButton = element('world_draw', HTMLButtonElement);
  #toolbar = element('world_tools', HTMLElement);
  #partSelect = element('world_part', HTMLSelectElement);
  #numberList = element('world_numbers', HTMLElement);
  isDrawing = false;
  notice = '';
  #chosenPart = FLOOR;
  #pointIndex = -1; // of a wall or line; -1 is all of it
  /** @type {PartKind | ''} */
  #drawnKind = '';
  /** @type {Drag | null} */
  #drag = null;
  /** @type {World[]} */
  #undoWorlds = [];
  /** @type {World[]} */
  #redoWorlds = [];
  #isBlocked = false;
  #writeCount = 0;

  /**
   * @param {import('../python.js').Python} python
   * @param {import('../virtual/arena.js').Arena} arena
   * @param {Page} page
   */
  constructor(python, arena, page) {
    this.#python = python;
    this.#arena = arena;
    this.#page = page;
    /** @type {[string, () => void][]} */
    const buttons = [
      ['draw', () => this.#setDrawing(true)],
      ['done', () => this.#setDrawing(false)],
      ['turn_left', () => this.#turnChosen(TURN_DEGREES)],
      ['turn_right', () => this.#turnChosen(-TURN_DEGREES)],
      ['point', () => this.#chooseNextPoint()],
      ['add_point', () => this.#addPoint()],
      ['delete', () => this.#deleteChosen()],
      ['undo', () => this.#undoOrRedo(this.#undoWorlds, this.#redoWorlds)],
      ['redo', () => this.#undoOrRedo(this.#redoWorlds, this.#undoWorlds)],
      ['open', () => element('world_file', HTMLInputElement).click()],
      ['save', () => this.#saveWorld()],
    ];
    for (const [name, onClick] of buttons) {
      element(`world_${name}`, HTMLButtonElement).addEventListener('click', () => {
        if (!this.#cancelDragAndShow() || name !== 'undo') onClick(); // by another finger, of a world that a first one changes
      });
    }
    for (const kind of KINDS) {
      element(`world_add_${kind}`, HTMLButtonElement).addEventListener('click', (event) => {
        if (event.detail === 0) this.#addPart(kind, []); // by its key: there is no finger that draws
        else this.#setDrawnKind(this.#drawnKind === kind ? '' : kind);
      });
    }
    this.#partSelect.addEventListener('change', () => {
      const part = partsOf(this.#page.getWorld())[this.#partSelect.selectedIndex];
      if (part) this.#choosePart(part);
    });
    onFileChosen('world_file', (file) => this.#openWorld(file));
    this.#canvas.addEventListener('pointerdown', (event) => this.#onPointerDown(event));
    this.#canvas.addEventListener('pointermove', (event) => this.#onPointerMove(event));
    this.#canvas.addEventListener('pointerup', () => this.#onPointerUp());
    this.#canvas.addEventListener('pointercancel', () => this.#cancelDragAndShow());
    this.#canvas.addEventListener('keydown', (event) => this.#onKeyDown(event));
    pageState.language.subscribe(() => {
      if (!this.isDrawing) return;
      this.notice = text('world_hint');
      this.#showTools();
    });
  }

  /** The kept worlds are there: from now on one can be changed. */
  enable() {
    this.#drawButton.disabled = false;
  }

  /** The seen world is another one than this has made. */
  reset() {
    this.cancelDrag();
    this.#undoWorlds = [];
    this.#redoWorlds = [];
    this.#chosenPart = FLOOR;
    this.#pointIndex = -1;
    this.#isBlocked = false;
    this.notice = this.isDrawing ? text('world_hint') : '';
    if (this.isDrawing) this.#showTools();
  }

  /** The floor is seen no more. */
  end() {
    this.#cancelDragAndShow();
    if (this.isDrawing) this.#setDrawing(false);
  }

  /** @param {boolean} isDrawing */
  #setDrawing(isDrawing) {
    this.isDrawing = isDrawing;
    this.notice = isDrawing ? text('world_hint') : '';
    this.#setDrawnKind('');
    document.documentElement.toggleAttribute('data-drawing', isDrawing);
    this.#toolbar.hidden = !isDrawing;
    this.#canvas.setAttribute('role', isDrawing ? 'application' : 'img');
    this.#canvas.setAttribute('data-label', isDrawing ? 'world_floor_label' : 'arena');
    this.#canvas.setAttribute('aria-label', text(isDrawing ? 'world_floor_label' : 'arena'));
    if (isDrawing) this.#canvas.tabIndex = 0;
    else this.#canvas.removeAttribute('tabindex');
    element(isDrawing ? 'world_part' : 'world_draw', HTMLElement).focus();
    if (isDrawing) this.#page.switchOff();
    this.#showTools();
  }

  /** @param {PartKind | ''} drawnKind what a finger draws from now on */
  #setDrawnKind(drawnKind) {
    this.#drawnKind = drawnKind;
    for (const kind of KINDS) element(`world_add_${kind}`, HTMLButtonElement).setAttribute('aria-pressed', String(kind === drawnKind));
    if (drawnKind) this.notice = text('world_hint_pen');
    this.#page.refresh();
  }

  /** @param {Part} part @param {number} [pointIndex] */
  #choosePart(part, pointIndex = -1) {
    this.#chosenPart = part;
    this.#pointIndex = pointIndex;
    this.notice = this.#isBlocked ? text('world_blocked') : this.#chosenSentence();
    this.#showTools();
  }

  /** @param {string} notice */
  #setNotice(notice) {
    this.notice = notice;
    this.#page.refresh();
  }

  #chosenSentence() {
    const value = valueOf(this.#page.getWorld(), this.#chosenPart);
    const point = value.points?.[this.#pointIndex];
    const numbers = point ? `${text('world_point')} ${this.#pointIndex + 1}: ${point.join(', ')}`
      : NUMBERS[this.#chosenPart.kind].slice(0, MAX_SPOKEN_NUMBERS).map(([key]) => `${text(textKey(`world_${key}`))} ${value[key]}`).join(', ');
    return numbers ? text('world_chosen', { part: partName(this.#chosenPart), numbers }) : partName(this.#chosenPart);
  }

  /** A change that can be undone. @param {World} world */
  #applyChange(world, worldBefore = this.#page.getWorld()) {
    if (JSON.stringify(world) === JSON.stringify(worldBefore)) return;
    const isOwn = this.#page.worldChoice.isOwn;
    this.#undoWorlds.push(isOwn ? worldBefore : copyAsOwn(worldBefore));
    if (this.#undoWorlds.length > MAX_UNDO_STEPS) this.#undoWorlds.shift();
    this.#redoWorlds = [];
    this.#putWorld(isOwn ? world : copyAsOwn(world));
  }

  /** @param {World} world */
  #putWorld(world) {
    this.#page.putWorld(world, false);
    if (!partsOf(world).some((part) => isSamePart(part, this.#chosenPart))) this.#chosenPart = FLOOR;
    if (this.#pointIndex >= pointsOf(world, this.#chosenPart).length) this.#pointIndex = -1;
    this.notice = this.#chosenSentence();
    this.#showTools();
    this.#writeWorld();
  }

  /** Keeps the world and asks whether the robot fits; returns its text, or says why it has none. @returns {Promise<string>} */
  async #writeWorld() {
    const writeNumber = ++this.#writeCount;
    const { text: worldText = '', is_blocked = false, refused: refusalReasons } = await this.#page.worldChoice.write(this.#page.getWorld());
    if (refusalReasons) this.#setNotice(refusalReasons.join(' '));
    else if (writeNumber === this.#writeCount) {
      if (is_blocked !== this.#isBlocked) {
        this.#isBlocked = is_blocked;
        this.#setNotice(is_blocked ? text('world_blocked') : this.#chosenSentence());
      }
      if (!(await this.#page.worldChoice.storeOwn())) this.#setNotice(text('world_not_kept'));
    }
    return worldText;
  }

  /** @param {World[]} sourceWorlds @param {World[]} targetWorlds */
  #undoOrRedo(sourceWorlds, targetWorlds) {
    const world = sourceWorlds.pop();
    if (!world) return;
    targetWorlds.push(this.#page.getWorld());
    this.#putWorld(world);
  }

  /** @param {number} degrees */
  #turnChosen(degrees) {
    this.#applyChange(withTurnedPart(this.#page.getWorld(), this.#chosenPart, degrees));
  }

  #deleteChosen() {
    const name = partName(this.#chosenPart);
    const world = this.#page.getWorld();
    const worldWithout = withoutPart(world, this.#chosenPart);
    if (partsOf(worldWithout).length === partsOf(world).length) return;
    this.#chosenPart = FLOOR;
    this.#applyChange(worldWithout);
    this.#setNotice(text('world_deleted', { part: name }));
  }

  /** @param {PartKind} kind @param {Point[]} track */
  #addPart(kind, track) {
    this.#setDrawnKind('');
    const world = this.#page.getWorld();
    const worldWith = withDrawnPart(world, kind, track);
    if (!worldWith) return this.#setNotice(text('world_full'));
    this.#chosenPart = { kind, index: world[kind].length };
    this.#pointIndex = -1;
    this.#applyChange(worldWith);
  }

  #chooseNextPoint() {
    const points = valueOf(this.#page.getWorld(), this.#chosenPart).points ?? [];
    this.#choosePart(this.#chosenPart, this.#pointIndex + 1 < points.length ? this.#pointIndex + 1 : -1);
  }

  #addPoint() {
    const addition = withPoint(this.#page.getWorld(), this.#chosenPart, this.#pointIndex);
    if (!addition) return;
    this.#pointIndex = addition.pointIndex;
    this.#applyChange(addition.world);
  }

  /** @param {KeyboardEvent} event */
  #onKeyDown(event) {
    if (!this.isDrawing || event.altKey) return;
    const isUndo = (event.ctrlKey || event.metaKey) && event.key === 'z';
    if (this.#drag && !isUndo) return event.preventDefault();
    if (event.ctrlKey || event.metaKey) {
      if (isUndo) this.#cancelDragAndShow() || this.#undoOrRedo(this.#undoWorlds, this.#redoWorlds);
      else if (event.key === 'y' || event.key === 'Z') this.#undoOrRedo(this.#redoWorlds, this.#undoWorlds);
      else return;
    } else if (ARROW_DIRECTIONS[event.key]) {
      const [right = 0, up = 0] = ARROW_DIRECTIONS[event.key] ?? [];
      const step = event.shiftKey ? FINE_STEP_CM : STEP_CM;
      this.#applyChange(withMovedPart(this.#page.getWorld(), this.#chosenPart, right * step, up * step, this.#pointIndex));
    } else if (event.key === 'r' || event.key === 'R') this.#turnChosen(event.shiftKey ? -TURN_DEGREES : TURN_DEGREES);
    else if (event.key === 'p') this.#chooseNextPoint();
    else if (event.key === '+') this.#addPoint();
    else if (event.key === 'Delete' || event.key === 'Backspace') this.#deleteChosen();
    else return;
    event.preventDefault();
  }

  /** @param {PointerEvent} event */
  #onPointerDown(event) {
    if (!event.isPrimary || event.button !== 0 || event.ctrlKey || this.#drag || this.#drawButton.disabled) return;
    const { place: point, reach_cm } = this.#arena.floorAt(event);
    const worldBefore = this.#page.getWorld();
    if (!this.isDrawing) {
      const [x, y] = this.#page.getRobotPlace();
      if (this.#page.isDriving() || Math.hypot(x - point[0], y - point[1]) > reach_cm) return;
      // Where the robot is taken it also begins, though it has driven away.
      const start = { ...worldBefore.start, x_cm: Math.round(x), y_cm: Math.round(y) };
      this.#beginDrag(event, { gesture: 'move', part: START, pointIndex: -1, startPoint: point, worldBefore, baseWorld: { ...worldBefore, start }, track: [] });
      return;
    }
    this.#canvas.focus();
    if (this.#drawnKind) {
      this.#beginDrag(event, { gesture: 'draw', part: FLOOR, pointIndex: -1, startPoint: point, worldBefore, baseWorld: worldBefore, track: [clampToFloor(point, worldBefore)] });
      return;
    }
    const chosenPoints = valueOf(worldBefore, this.#chosenPart).points ?? [];
    const grabbedIndex = pointIndexAt(chosenPoints, point, reach_cm / 2);
    const turnHandle = turnHandleOf(worldBefore, this.#chosenPart);
    if (turnHandle && Math.hypot(turnHandle[0] - point[0], turnHandle[1] - point[1]) < reach_cm / 2) {
      this.#beginDrag(event, { gesture: 'turn', part: this.#chosenPart, pointIndex: -1, startPoint: turnHandle, worldBefore, baseWorld: worldBefore, track: [] });
      return;
    }
    const part = grabbedIndex >= 0 ? this.#chosenPart : partAt(worldBefore, point, reach_cm);
    if (part) this.#beginDrag(event, { gesture: 'move', part, pointIndex: grabbedIndex, startPoint: point, worldBefore, baseWorld: worldBefore, track: [] });
    this.#choosePart(part ?? FLOOR, grabbedIndex);
  }

  /** @param {PointerEvent} event @param {Drag} drag */
  #beginDrag(event, drag) {
    this.#drag = drag;
    this.#canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  /** @param {PointerEvent} event */
  #onPointerMove(event) {
    const drag = this.#drag;
    if (!drag || !event.isPrimary) return;
    const { place: point } = this.#arena.floorAt(event);
    const { worldBefore, baseWorld, startPoint } = drag;
    if (drag.gesture === 'draw') {
      drag.track.push(clampToFloor(point, worldBefore));
      this.#arena.setMark({ points: drag.track, pointIndex: -1, handle: null });
      this.#page.refresh();
      return;
    }
    if (drag.gesture === 'turn') {
      this.#page.previewWorld(withTurnedHandle(baseWorld, drag.part, startPoint, point));
      this.#markChosen();
      return;
    }
    const offset = [Math.round(point[0] - startPoint[0]), Math.round(point[1] - startPoint[1])];
    if (this.#page.getWorld() === worldBefore && !offset[0] && !offset[1]) return; // not moved yet
    this.#page.previewWorld(withMovedPart(baseWorld, drag.part, offset[0] ?? 0, offset[1] ?? 0, drag.pointIndex));
    this.#markChosen();
  }

  #onPointerUp() {
    const drag = this.#drag;
    if (!drag) return;
    const world = this.#page.getWorld();
    this.#drag = null;
    if (drag.gesture === 'draw') {
      if (this.#drawnKind) this.#addPart(this.#drawnKind, drag.track);
      return;
    }
    this.#applyChange(world, drag.worldBefore);
    if (this.isDrawing) this.#showTools();
  }

  /** What a finger moves is again where it was; returns whether there was such a thing. */
  cancelDrag() {
    const drag = this.#drag;
    this.#drag = null;
    if (drag && drag.gesture !== 'draw') this.#page.previewWorld(drag.worldBefore);
    return drag !== null;
  }

  /** The same, and it is seen. */
  #cancelDragAndShow() {
    const wasDragging = this.cancelDrag();
    if (wasDragging) this.#showTools();
    return wasDragging;
  }

  /** @param {File} file */
  async #openWorld(file) {
    const { name } = file;
    let reason = text('unreadable');
    try {
      const data = await readBytes(file);
      const answer = await this.#python.ask({ do: 'open_world', name, language: currentLanguage() }, data);
      if (answer.world) {
        this.#page.putWorld(answer.world, true);
        this.reset();
        this.#writeWorld();
        this.#setNotice(text('world_opened', { name }));
        return;
      }
      reason = answer.refused.join(' ');
    } catch {
      // said below
    }
    this.#setNotice(text('world_not_opened', { name, why: reason }));
  }

  async #saveWorld() {
    const name = text('world_name');
    const worldText = await this.#writeWorld();
    if (!worldText) return;
    downloadText(name, worldText);
    this.#setNotice([text('saved', { name }), this.#isBlocked && text('world_blocked')].filter(Boolean).join(' '));
  }

  #markChosen() {
    const world = this.#page.getWorld();
    this.#arena.setMark(this.isDrawing ? { points: pointsOf(world, this.#chosenPart), pointIndex: this.#pointIndex, handle: turnHandleOf(world, this.#chosenPart) } : null);
    this.#page.refresh();
  }

  #showTools() {
    this.#markChosen();
    if (this.#drag) return; // other tools would move the floor from under the finger
    const world = this.#page.getWorld();
    const { kind } = this.#chosenPart;
    const parts = partsOf(world);
    this.#partSelect.replaceChildren(...parts.map((part) => new Option(partName(part))));
    this.#partSelect.selectedIndex = parts.findIndex((part) => isSamePart(part, this.#chosenPart));
    const hasPoints = kind === 'walls' || kind === 'lines';
    element('world_point', HTMLElement).hidden = element('world_add_point', HTMLElement).hidden = !hasPoints;
    for (const buttonId of ['world_turn_left', 'world_turn_right']) element(buttonId, HTMLButtonElement).disabled = !('heading' in valueOf(world, this.#chosenPart)) && !hasPoints;
    element('world_delete', HTMLButtonElement).disabled = kind === 'floor' || kind === 'start';
    element('world_undo', HTMLButtonElement).disabled = !this.#undoWorlds.length;
    element('world_redo', HTMLButtonElement).disabled = !this.#redoWorlds.length;
    showNumbers(this.#numberList, world, this.#chosenPart, (changedWorld) => this.#applyChange(changedWorld));
  }
}
