// The page as a remote control: a stick, arrows, A and B, by fingers, keys and gamepads, for the robot that is seen.
// It has what the program reads. The arrows of a keyboard move the stick of a program that reads no arrow.
//
// What is held is said at each change, and again while it is held. All is let go at a STOP, when the window or the robot
// is not seen any more, and for another robot: then a hand has to press anew.

import { element, say } from '../page/elements.js';
import { makeElement } from '../page/made.js';
import { pageState } from '../page/page_state.js';
import { labelOf, text } from '../page/texts.js';
import { LINK, REMOTE } from '../page/words.js';
import { gamepadsHeld } from './gamepads.js';
import { Holding, isSame, moved, NOTHING } from './held.js';

/** @import { Held } from './held.js' */
/**
 * @typedef {object} Driven a robot that can be driven
 * @property {string[]} reads words of a remote control that its program reads
 * @property {(held: Held) => void} tell says it to the robot
 * @property {boolean} [isDeaf] it has no remote control
 */

const KEYS = REMOTE.filter((each) => each.is_yes_no);
const ARROWS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
const TYPED = [...Object.keys(ARROWS), 'a', 'b']; // in the order of the keys
const THUMB = 0.75; // of its own size, to where the stick ends
const PRESSES = [' ', 'Enter']; // what presses a button that has the focus
/** Where arrows and letters are somebody else's. */
const TAKEN = 'input, textarea, select, dialog, [contenteditable=true], #blocks, #arena, [tabindex="0"]';

export class Pad {
  #holding = new Holding();
  /** @type {Held} */
  #said = NOTHING;
  #timer = 0;
  #looks = 0; // at the gamepads
  /** @type {number[]} */
  #gamepads = [];
  /** Those that have to let go before they are heeded. @type {Set<number>} */
  #stale = new Set();
  /** Fingers on a part, and what each does when it moves. @type {Map<number, (event: PointerEvent) => void>} */
  #fingers = new Map();
  /** By what is pressed of a keyboard: which key it is. @type {Map<string, number>} */
  #typed = new Map();
  /** @type {Map<string, Driven>} */
  #offered = new Map();
  /** @type {Driven | undefined} */
  #driven;
  #box = element('pad', HTMLElement);
  #stick = element('pad_stick', HTMLElement);
  #thumb = element('pad_thumb', HTMLElement);
  #parts;

  constructor() {
    this.#parts = KEYS.map((device, key) => {
      const part = makeElement('button', '', device.labels.en.split(' ').at(-1) ?? '');
      part.type = 'button';
      part.dataset['key'] = device.text;
      this.#heed(part, () => ({ ...NOTHING, keys: 1 << key }));
      return part;
    });
    element('pad_arrows', HTMLElement).append(...this.#parts.slice(0, 4));
    element('pad_letters', HTMLElement).append(...this.#parts.slice(4));
    this.#heed(this.#stick, (event) => this.#at(event), true);
    this.#box.addEventListener('contextmenu', (event) => event.preventDefault()); // of a finger that stays
    addEventListener('keydown', (event) => this.#type(event));
    addEventListener('keyup', (event) => this.#untype(event));
    for (const name of ['gamepadconnected', 'gamepaddisconnected']) addEventListener(name, () => this.#look());
    for (const name of ['blur', 'pagehide', 'freeze']) addEventListener(name, () => this.letGo());
    document.addEventListener('visibilitychange', () => {
      if (document.visibilityState === 'hidden') this.letGo();
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.letGo());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.letGo();
    }, { capture: true });
    pageState.sideId.subscribe(() => this.#choose());
    pageState.language.subscribe(() => this.#name());
  }

  /** A robot can be driven on a side of the page, or none can any more. @param {'driving' | 'link'} side @param {Driven | null} driven */
  offer(side, driven) {
    const before = this.#offered.get(side);
    if (driven && before && before.isDeaf === driven.isDeaf && `${before.reads}` === `${driven.reads}`) return;
    if (driven) this.#offered.set(side, driven);
    else this.#offered.delete(side);
    this.#choose();
  }

  /** Nobody holds anything before he presses anew. */
  letGo() {
    this.#holding.letAllGo();
    this.#fingers.clear();
    this.#typed.clear();
    for (const number of gamepadsHeld().keys()) this.#stale.add(number);
    this.#change();
  }

  /** Which robot is driven follows from what is seen. */
  #choose() {
    const side = pageState.sideId.value === 'side_real' ? 'link' : 'driving';
    const driven = this.#offered.get(side);
    if (driven === this.#driven) return;
    this.letGo(); // it goes to the robot before
    this.#driven = driven;
    this.#box.hidden = !driven;
    if (!driven) return;
    const { reads, isDeaf } = driven;
    if (side === 'link') element('link_said', HTMLElement).after(this.#box);
    else element(side, HTMLElement).append(this.#box);
    KEYS.forEach((device, k) => {
      const part = this.#parts[k];
      if (part) part.hidden = isDeaf || !reads.includes(device.text);
    });
    this.#stick.hidden = isDeaf || !reads.some((word) => REMOTE.some((each) => each.text === word && !each.is_yes_no));
    for (const id of ['pad_arrows', 'pad_letters']) {
      const group = element(id, HTMLElement);
      group.hidden = [...group.children].every((each) => each instanceof HTMLElement && each.hidden);
    }
    this.#name();
    this.#look();
  }

  #name() {
    this.#parts.forEach((part, k) => part.setAttribute('aria-label', labelOf(KEYS[k]?.labels ?? {})));
    if (this.#driven) say(element('pad_said', HTMLElement), this.#driven.isDeaf ? text('pad_deaf') : '');
  }

  // -- who holds ----------------------------------------------------------------------------------

  /** A part is held by fingers; of one that `isOne`, by the first. @param {HTMLElement} part @param {(event: PointerEvent) => Held} held @param {boolean} [isOne] */
  #heed(part, held, isOne) {
    let owner = -1;
    part.addEventListener('pointerdown', (event) => {
      if (event.button || (isOne && this.#fingers.has(owner))) return;
      owner = event.pointerId;
      part.setPointerCapture(event.pointerId);
      const holds = (/** @type {PointerEvent} */ each) => this.#hold(each.pointerId, held(each));
      this.#fingers.set(event.pointerId, holds);
      holds(event);
    });
    part.addEventListener('pointermove', (event) => this.#fingers.get(event.pointerId)?.(event));
    for (const name of /** @type {const} */ (['pointerup', 'pointercancel', 'lostpointercapture'])) {
      part.addEventListener(name, ({ pointerId }) => {
        this.#fingers.delete(pointerId);
        this.#letGo(pointerId);
      });
    }
  }

  /** Where a finger has the stick. @param {PointerEvent} event */
  #at({ clientX, clientY }) {
    const { left, top, width, height } = this.#stick.getBoundingClientRect();
    const reach = width / 3;
    return moved((clientX - left - width / 2) / reach, (top + height / 2 - clientY) / reach);
  }

  /** @param {KeyboardEvent} event */
  #type(event) {
    if (!this.#driven || this.#driven.isDeaf || event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (!(target instanceof Element)) return;
    const part = PRESSES.includes(event.key) ? this.#parts.findIndex((each) => each === target) : -1;
    const key = part < 0 ? TYPED.indexOf(event.key.length > 1 ? event.key : event.key.toLowerCase()) : part;
    if (key < 0 || target.closest(TAKEN)) return;
    event.preventDefault(); // an arrow scrolls
    if (event.repeat) return;
    this.#typed.set(event.code, key);
    this.#showTyped();
  }

  /** @param {KeyboardEvent} event */
  #untype({ code }) {
    if (this.#typed.delete(code)) this.#showTyped();
  }

  #showTyped() {
    const isStick = !this.#stick.hidden && this.#parts.slice(0, 4).every((part) => part.hidden);
    let keys = 0, right = 0, up = 0;
    for (const key of this.#typed.values()) {
      const way = Object.values(ARROWS)[key];
      if (isStick && way) [right, up] = [right + (way[0] ?? 0), up + (way[1] ?? 0)];
      else keys |= 1 << key;
    }
    this.#hold('keyboard', { ...moved(right, up), keys });
  }

  /** Looks what gamepads hold, as long as there is one and a robot is driven. */
  #look() {
    cancelAnimationFrame(this.#looks);
    const there = gamepadsHeld();
    for (const number of this.#gamepads) if (!there.has(number)) this.#letGo(gamepad(number));
    this.#gamepads = [...there.keys()];
    if (!this.#driven || !there.size) return;
    for (const [number, held] of there) {
      if (isSame(held, NOTHING)) this.#stale.delete(number);
      if (!this.#stale.has(number)) this.#hold(gamepad(number), held);
    }
    this.#looks = requestAnimationFrame(() => this.#look());
  }

  // -- what is held -------------------------------------------------------------------------------

  /** @param {unknown} who @param {Held} held */
  #hold(who, held) {
    this.#holding.hold(who, held);
    this.#change();
  }

  /** @param {unknown} who */
  #letGo(who) {
    this.#holding.letGo(who);
    this.#change();
  }

  #change() {
    const held = this.#holding.all;
    if (isSame(held, this.#said)) return;
    this.#said = held;
    this.#thumb.style.setProperty('translate', `${held.x * THUMB}% ${-held.y * THUMB}%`);
    this.#parts.forEach((part, k) => part.classList.toggle('held', Boolean(held.keys & (1 << k))));
    this.#say();
  }

  #say() {
    clearTimeout(this.#timer);
    if (!this.#driven || this.#driven.isDeaf) return;
    this.#driven.tell(this.#said);
    if (!isSame(this.#said, NOTHING)) this.#timer = window.setTimeout(() => this.#say(), LINK.keys_every_ms);
  }
}

/** @param {number} number */
function gamepad(number) {
  return `gamepad ${number}`;
}
