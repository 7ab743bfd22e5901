// A world is changed by hand: with a mouse, a finger or keys. Knows the page, and the form of a world
// only by `parts.js`.

import { element } from '../page/elements.js';
import { bytesOf, download, onFileChosen } from '../page/files.js';
import { ownCopy } from './own.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, textKey, text } from '../page/texts.js';
import {
  FLOOR, handleOf, isSame, KINDS, moved, NUMBERS, onFloor, partAt, partsOf, pointAt, pointsOf, START, turnedBy, turnedPart,
  valueOf, withDrawn, without, withPoint,
} from './parts.js';
import { nameOf, showNumbers } from './numbers.js';

/** @import { World, Part, Kind, Place } from './parts.js' */
/** @typedef {import('./choice.js').Page} Page */
/** @typedef {{how: 'move' | 'draw' | 'turn', part: Part, point: number, from: Place, before: World, base: World, way: Place[]}} Drag `base`: what is moved */

const STEP_CM = 5;
const FINE_CM = 1;
const TURN = 15; // degrees
const SPOKEN = 2; // numbers of a part; all are beside it
const KEPT = 200; // changes that can be undone
/** @type {Record<string, Place>} */
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

export class WorldDrawing {
  #python;
  #arena;
  #page;
  #canvas = element('arena', HTMLCanvasElement);
  #pencil = element('world_draw', HTMLButtonElement);
  #tools = element('world_tools', HTMLElement);
  #parts = element('world_part', HTMLSelectElement);
  #numbers = element('world_numbers', HTMLElement);
  isOn = false;
  said = '';
  #chosen = FLOOR;
  #point = -1; // of a wall or line; -1 is all of it
  /** @type {Kind | ''} */
  #pen = '';
  /** @type {Drag | null} */
  #drag = null;
  /** @type {World[]} */
  #before = [];
  /** @type {World[]} */
  #after = [];
  #isBlocked = false;
  #written = 0;

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
      ['draw', () => this.#turnOn(true)],
      ['done', () => this.#turnOn(false)],
      ['turn_left', () => this.#turn(TURN)],
      ['turn_right', () => this.#turn(-TURN)],
      ['point', () => this.#nextPoint()],
      ['add_point', () => this.#addPoint()],
      ['delete', () => this.#delete()],
      ['undo', () => this.#again(this.#before, this.#after)],
      ['redo', () => this.#again(this.#after, this.#before)],
      ['open', () => element('world_file', HTMLInputElement).click()],
      ['save', () => this.#save()],
    ];
    for (const [name, act] of buttons) {
      element(`world_${name}`, HTMLButtonElement).addEventListener('click', () => {
        if (!this.#giveUp() || name !== 'undo') act(); // by another finger, of a world that a first one changes
      });
    }
    for (const kind of KINDS) {
      element(`world_add_${kind}`, HTMLButtonElement).addEventListener('click', (event) => {
        if (event.detail === 0) this.#add(kind, []); // by its key: there is no finger that draws
        else this.#take(this.#pen === kind ? '' : kind);
      });
    }
    this.#parts.addEventListener('change', () => {
      const part = partsOf(this.#page.world())[this.#parts.selectedIndex];
      if (part) this.#choose(part);
    });
    onFileChosen('world_file', (file) => this.#open(file));
    this.#canvas.addEventListener('pointerdown', (event) => this.#down(event));
    this.#canvas.addEventListener('pointermove', (event) => this.#move(event));
    this.#canvas.addEventListener('pointerup', () => this.#up());
    this.#canvas.addEventListener('pointercancel', () => this.#giveUp());
    this.#canvas.addEventListener('keydown', (event) => this.#key(event));
    pageState.language.subscribe(() => {
      if (!this.isOn) return;
      this.said = text('world_hint');
      this.#show();
    });
  }

  /** The kept worlds are there: from now on one can be changed. */
  allow() {
    this.#pencil.disabled = false;
  }

  /** The seen world is another one than this has made. */
  forget() {
    this.letGo();
    this.#before = [];
    this.#after = [];
    this.#chosen = FLOOR;
    this.#point = -1;
    this.#isBlocked = false;
    if (this.isOn) this.#show();
  }

  /** The floor is seen no more. */
  end() {
    this.#giveUp();
    if (this.isOn) this.#turnOn(false);
  }

  /** @param {boolean} isOn */
  #turnOn(isOn) {
    this.isOn = isOn;
    this.said = isOn ? text('world_hint') : '';
    this.#take('');
    document.documentElement.toggleAttribute('data-drawing', isOn);
    this.#tools.hidden = !isOn;
    this.#canvas.setAttribute('role', isOn ? 'application' : 'img');
    this.#canvas.setAttribute('data-label', isOn ? 'world_floor_label' : 'arena');
    this.#canvas.setAttribute('aria-label', text(isOn ? 'world_floor_label' : 'arena'));
    if (isOn) this.#canvas.tabIndex = 0;
    else this.#canvas.removeAttribute('tabindex');
    element(isOn ? 'world_part' : 'world_draw', HTMLElement).focus();
    if (isOn) this.#page.rest();
    this.#show();
  }

  /** @param {Kind | ''} pen what a finger draws from now on */
  #take(pen) {
    this.#pen = pen;
    for (const kind of KINDS) element(`world_add_${kind}`, HTMLButtonElement).setAttribute('aria-pressed', String(kind === pen));
    if (pen) this.said = text('world_hint_pen');
    this.#page.tell();
  }

  /** @param {Part} part @param {number} [point] */
  #choose(part, point = -1) {
    this.#chosen = part;
    this.#point = point;
    this.said = this.#isBlocked ? text('world_blocked') : this.#sentence();
    this.#show();
  }

  /** @param {string} said */
  #say(said) {
    this.said = said;
    this.#page.tell();
  }

  #sentence() {
    const value = valueOf(this.#page.world(), this.#chosen);
    const place = value.points?.[this.#point];
    const numbers = place ? `${text('world_point')} ${this.#point + 1}: ${place.join(', ')}`
      : NUMBERS[this.#chosen.kind].slice(0, SPOKEN).map(([key]) => `${text(textKey(`world_${key}`))} ${value[key]}`).join(', ');
    return numbers ? text('world_chosen', { part: nameOf(this.#chosen), numbers }) : nameOf(this.#chosen);
  }

  /** A change that can be undone. @param {World} world */
  #change(world, before = this.#page.world()) {
    if (JSON.stringify(world) === JSON.stringify(before)) return;
    const isOwn = this.#page.choice.isOwn;
    this.#before.push(isOwn ? before : ownCopy(before));
    if (this.#before.length > KEPT) this.#before.shift();
    this.#after = [];
    this.#put(isOwn ? world : ownCopy(world));
  }

  /** @param {World} world */
  #put(world) {
    this.#page.put(world, false);
    if (!partsOf(world).some((part) => isSame(part, this.#chosen))) this.#chosen = FLOOR;
    if (this.#point >= pointsOf(world, this.#chosen).length) this.#point = -1;
    this.said = this.#sentence();
    this.#show();
    this.#write();
  }

  /** Keeps the world and asks whether the robot fits; returns its text, or says why it has none. @returns {Promise<string>} */
  async #write() {
    const asked = ++this.#written;
    const { text: written = '', is_blocked = false, refused } = await this.#page.choice.write(this.#page.world());
    if (refused) this.#say(refused.join(' '));
    else if (asked === this.#written) {
      if (is_blocked !== this.#isBlocked) {
        this.#isBlocked = is_blocked;
        this.#say(is_blocked ? text('world_blocked') : this.#sentence());
      }
      if (!(await this.#page.choice.keepOwn())) this.#say(text('world_not_kept'));
    }
    return written;
  }

  /** @param {World[]} from @param {World[]} to */
  #again(from, to) {
    const world = from.pop();
    if (!world) return;
    to.push(this.#page.world());
    this.#put(world);
  }

  /** @param {number} degrees */
  #turn(degrees) {
    this.#change(turnedPart(this.#page.world(), this.#chosen, degrees));
  }

  #delete() {
    const name = nameOf(this.#chosen);
    const world = this.#page.world();
    const less = without(world, this.#chosen);
    if (partsOf(less).length === partsOf(world).length) return;
    this.#chosen = FLOOR;
    this.#change(less);
    this.#say(text('world_deleted', { part: name }));
  }

  /** @param {Kind} kind @param {Place[]} way */
  #add(kind, way) {
    this.#take('');
    const world = this.#page.world();
    const more = withDrawn(world, kind, way);
    if (!more) return this.#say(text('world_full'));
    this.#chosen = { kind, index: world[kind].length };
    this.#point = -1;
    this.#change(more);
  }

  #nextPoint() {
    const points = valueOf(this.#page.world(), this.#chosen).points ?? [];
    this.#choose(this.#chosen, this.#point + 1 < points.length ? this.#point + 1 : -1);
  }

  #addPoint() {
    const more = withPoint(this.#page.world(), this.#chosen, this.#point);
    if (!more) return;
    this.#point = more.point;
    this.#change(more.world);
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (!this.isOn || event.altKey) return;
    const isUndo = (event.ctrlKey || event.metaKey) && event.key === 'z';
    if (this.#drag && !isUndo) return event.preventDefault();
    if (event.ctrlKey || event.metaKey) {
      if (isUndo) this.#giveUp() || this.#again(this.#before, this.#after);
      else if (event.key === 'y' || event.key === 'Z') this.#again(this.#after, this.#before);
      else return;
    } else if (ARROWS[event.key]) {
      const [right = 0, up = 0] = ARROWS[event.key] ?? [];
      const step = event.shiftKey ? FINE_CM : STEP_CM;
      this.#change(moved(this.#page.world(), this.#chosen, right * step, up * step, this.#point));
    } else if (event.key === 'r' || event.key === 'R') this.#turn(event.shiftKey ? -TURN : TURN);
    else if (event.key === 'p') this.#nextPoint();
    else if (event.key === '+') this.#addPoint();
    else if (event.key === 'Delete' || event.key === 'Backspace') this.#delete();
    else return;
    event.preventDefault();
  }

  /** @param {PointerEvent} event */
  #down(event) {
    if (!event.isPrimary || event.button !== 0 || event.ctrlKey || this.#drag || this.#pencil.disabled) return;
    const { place, reach_cm } = this.#arena.floorAt(event);
    const before = this.#page.world();
    if (!this.isOn) {
      const [x, y] = this.#page.robot();
      if (this.#page.isDriving() || Math.hypot(x - place[0], y - place[1]) > reach_cm) return;
      // Where the robot is taken it also begins, though it has driven away.
      const start = { ...before.start, x_cm: Math.round(x), y_cm: Math.round(y) };
      this.#begin(event, { how: 'move', part: START, point: -1, from: place, before, base: { ...before, start }, way: [] });
      return;
    }
    this.#canvas.focus();
    if (this.#pen) {
      this.#begin(event, { how: 'draw', part: FLOOR, point: -1, from: place, before, base: before, way: [onFloor(place, before)] });
      return;
    }
    const own = valueOf(before, this.#chosen).points ?? [];
    const handle = pointAt(own, place, reach_cm / 2);
    const turning = handleOf(before, this.#chosen);
    if (turning && Math.hypot(turning[0] - place[0], turning[1] - place[1]) < reach_cm / 2) {
      this.#begin(event, { how: 'turn', part: this.#chosen, point: -1, from: turning, before, base: before, way: [] });
      return;
    }
    const part = handle >= 0 ? this.#chosen : partAt(before, place, reach_cm);
    if (part) this.#begin(event, { how: 'move', part, point: handle, from: place, before, base: before, way: [] });
    this.#choose(part ?? FLOOR, handle);
  }

  /** @param {PointerEvent} event @param {Drag} drag */
  #begin(event, drag) {
    this.#drag = drag;
    this.#canvas.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const drag = this.#drag;
    if (!drag || !event.isPrimary) return;
    const { place } = this.#arena.floorAt(event);
    const { before, base, from } = drag;
    if (drag.how === 'draw') {
      drag.way.push(onFloor(place, before));
      this.#arena.setMark({ points: drag.way, pointIndex: -1, handle: null });
      this.#page.tell();
      return;
    }
    if (drag.how === 'turn') {
      this.#page.preview(turnedBy(base, drag.part, from, place));
      this.#mark();
      return;
    }
    const way = [Math.round(place[0] - from[0]), Math.round(place[1] - from[1])];
    if (this.#page.world() === before && !way[0] && !way[1]) return; // not moved yet
    this.#page.preview(moved(base, drag.part, way[0] ?? 0, way[1] ?? 0, drag.point));
    this.#mark();
  }

  #up() {
    const drag = this.#drag;
    if (!drag) return;
    const world = this.#page.world();
    this.#drag = null;
    if (drag.how === 'draw') {
      if (this.#pen) this.#add(this.#pen, drag.way);
      return;
    }
    this.#change(world, drag.before);
    if (this.isOn) this.#show();
  }

  /** What a finger moves is again where it was; returns whether there was such a thing. */
  letGo() {
    const drag = this.#drag;
    this.#drag = null;
    if (drag && drag.how !== 'draw') this.#page.preview(drag.before);
    return drag !== null;
  }

  /** The same, and it is seen. */
  #giveUp() {
    const isGivenUp = this.letGo();
    if (isGivenUp) this.#show();
    return isGivenUp;
  }

  /** @param {File} file */
  async #open(file) {
    const { name } = file;
    let why = text('unreadable');
    try {
      const data = await bytesOf(file);
      const answer = await this.#python.ask({ do: 'open_world', name, language: currentLanguage() }, data);
      if (answer.world) {
        this.#page.put(answer.world, true);
        this.forget();
        this.#write();
        this.#say(text('world_opened', { name }));
        return;
      }
      why = answer.refused.join(' ');
    } catch {
      // said below
    }
    this.#say(text('world_not_opened', { name, why }));
  }

  async #save() {
    const name = text('world_name');
    const written = await this.#write();
    if (!written) return;
    download(name, written);
    this.#say([text('saved', { name }), this.#isBlocked && text('world_blocked')].filter(Boolean).join(' '));
  }

  #mark() {
    const world = this.#page.world();
    this.#arena.setMark(this.isOn ? { points: pointsOf(world, this.#chosen), pointIndex: this.#point, handle: handleOf(world, this.#chosen) } : null);
    this.#page.tell();
  }

  #show() {
    this.#mark();
    if (this.#drag) return; // other tools would move the floor from under the finger
    const world = this.#page.world();
    const { kind } = this.#chosen;
    const parts = partsOf(world);
    this.#parts.replaceChildren(...parts.map((part) => new Option(nameOf(part))));
    this.#parts.selectedIndex = parts.findIndex((part) => isSame(part, this.#chosen));
    const hasPoints = kind === 'walls' || kind === 'lines';
    element('world_point', HTMLElement).hidden = element('world_add_point', HTMLElement).hidden = !hasPoints;
    for (const name of ['world_turn_left', 'world_turn_right']) element(name, HTMLButtonElement).disabled = !('heading' in valueOf(world, this.#chosen)) && !hasPoints;
    element('world_delete', HTMLButtonElement).disabled = kind === 'floor' || kind === 'start';
    element('world_undo', HTMLButtonElement).disabled = !this.#before.length;
    element('world_redo', HTMLButtonElement).disabled = !this.#after.length;
    showNumbers(this.#numbers, world, this.#chosen, (changed) => this.#change(changed));
  }
}
