// The page as a remote control: a stick, arrows, A and B, by fingers, keys and gamepads, for the robot that is seen.
// It has what the program reads. The arrows of a keyboard move the stick of a program that reads no arrow.
//
// What is held is said at each change, and again while it is held. All is let go at a STOP, when the window or the robot
// is not seen any more, and for another robot: then a hand has to press anew.

import { element, setText } from '../page/elements.js';
import { makeElement } from '../page/made.js';
import { pageState } from '../page/page_state.js';
import { labelOf, text } from '../page/texts.js';
import { LINK, REMOTE_DEVICES } from '../page/words.js';
import { readGamepads } from './gamepads.js';
import { HeldByHolder, areControlsSame, controlsOfStick, NOTHING_HELD } from './held.js';

/** @import { HeldControls } from './held.js' */
/**
 * @typedef {object} DrivenRobot a robot that can be driven
 * @property {string[]} remoteWords words of a remote control that its program reads
 * @property {(held: HeldControls) => void} sendControls says them to the robot
 * @property {boolean} [lacksRemote] it has no remote control
 */

const KEY_DEVICES = REMOTE_DEVICES.filter((device) => device.is_yes_no);
const ARROW_DIRECTIONS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
const KEYBOARD_KEYS = [...Object.keys(ARROW_DIRECTIONS), 'a', 'b']; // in the order of the keys
const THUMB_SHARE = 0.75; // of its own size, to where the stick ends
const PRESSING_KEYS = [' ', 'Enter']; // what presses a button that has the focus
/** Where arrows and letters are somebody else's. */
const KEY_OWNER_SELECTOR = 'input, textarea, select, dialog, [contenteditable=true], #blocks, #arena, [tabindex="0"]';

export class Pad {
  #heldByHolder = new HeldByHolder();
  /** @type {HeldControls} */
  #heldControls = NOTHING_HELD;
  #repeatTimer = 0;
  #frameRequest = 0; // at the gamepads
  /** @type {number[]} */
  #gamepadNumbers = [];
  /** Those that have to let go before they are heeded. @type {Set<number>} */
  #staleGamepads = new Set();
  /** Fingers on a part, and what each does when it moves. @type {Map<number, (event: PointerEvent) => void>} */
  #moveHandlers = new Map();
  /** By what is pressed of a keyboard: which key it is. @type {Map<string, number>} */
  #pressedKeys = new Map();
  /** @type {Map<string, DrivenRobot>} */
  #offeredRobots = new Map();
  /** @type {DrivenRobot | undefined} */
  #drivenRobot;
  #padElement = element('pad', HTMLElement);
  #stickElement = element('pad_stick', HTMLElement);
  #thumbElement = element('pad_thumb', HTMLElement);
  #keyButtons;

  constructor() {
    this.#keyButtons = KEY_DEVICES.map((device, keyIndex) => {
      const keyButton = makeElement('button', '', device.labels.en.split(' ').at(-1) ?? '');
      keyButton.type = 'button';
      keyButton.dataset['key'] = device.text;
      this.#listenToFingers(keyButton, () => ({ ...NOTHING_HELD, keys: 1 << keyIndex }));
      return keyButton;
    });
    element('pad_arrows', HTMLElement).append(...this.#keyButtons.slice(0, 4));
    element('pad_letters', HTMLElement).append(...this.#keyButtons.slice(4));
    this.#listenToFingers(this.#stickElement, (event) => this.#controlsAt(event), true);
    this.#padElement.addEventListener('contextmenu', (event) => event.preventDefault()); // of a finger that stays
    addEventListener('keydown', (event) => this.#onKeyDown(event));
    addEventListener('keyup', (event) => this.#onKeyUp(event));
    for (const name of ['gamepadconnected', 'gamepaddisconnected']) addEventListener(name, () => this.#pollGamepads());
    for (const name of ['blur', 'pagehide', 'freeze']) addEventListener(name, () => this.releaseAll());
    document.addEventListener('visibilitychange', () => {
      if (document.visibilityState === 'hidden') this.releaseAll();
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.releaseAll());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.releaseAll();
    }, { capture: true });
    pageState.sideId.subscribe(() => this.#chooseRobot());
    pageState.language.subscribe(() => this.#updateNames());
  }

  /** A robot can be driven on a side of the page, or none can any more. @param {'driving' | 'link'} side @param {DrivenRobot | null} robot */
  offerRobot(side, robot) {
    const robotBefore = this.#offeredRobots.get(side);
    if (robot && robotBefore && robotBefore.lacksRemote === robot.lacksRemote && `${robotBefore.remoteWords}` === `${robot.remoteWords}`) return;
    if (robot) this.#offeredRobots.set(side, robot);
    else this.#offeredRobots.delete(side);
    this.#chooseRobot();
  }

  /** Nobody holds anything before he presses anew. */
  releaseAll() {
    this.#heldByHolder.releaseAll();
    this.#moveHandlers.clear();
    this.#pressedKeys.clear();
    for (const gamepadNumber of readGamepads().keys()) this.#staleGamepads.add(gamepadNumber);
    this.#updateControls();
  }

  /** Which robot is driven follows from what is seen. */
  #chooseRobot() {
    const side = pageState.sideId.value === 'side_real' ? 'link' : 'driving';
    const robot = this.#offeredRobots.get(side);
    if (robot === this.#drivenRobot) return;
    this.releaseAll(); // it goes to the robot before
    this.#drivenRobot = robot;
    this.#padElement.hidden = !robot;
    if (!robot) return;
    const { remoteWords, lacksRemote } = robot;
    if (side === 'link') element('link_said', HTMLElement).after(this.#padElement);
    else element(side, HTMLElement).append(this.#padElement);
    KEY_DEVICES.forEach((device, index) => {
      const keyButton = this.#keyButtons[index];
      if (keyButton) keyButton.hidden = lacksRemote || !remoteWords.includes(device.text);
    });
    this.#stickElement.hidden = lacksRemote || !remoteWords.some((word) => REMOTE_DEVICES.some((device) => device.text === word && !device.is_yes_no));
    for (const groupId of ['pad_arrows', 'pad_letters']) {
      const keyGroup = element(groupId, HTMLElement);
      keyGroup.hidden = [...keyGroup.children].every((keyButton) => keyButton instanceof HTMLElement && keyButton.hidden);
    }
    this.#updateNames();
    this.#pollGamepads();
  }

  #updateNames() {
    this.#keyButtons.forEach((keyButton, index) => keyButton.setAttribute('aria-label', labelOf(KEY_DEVICES[index]?.labels ?? {})));
    if (this.#drivenRobot) setText(element('pad_said', HTMLElement), this.#drivenRobot.lacksRemote ? text('pad_deaf') : '');
  }

  // -- who holds ----------------------------------------------------------------------------------

  /** A part is held by fingers; of one that `isSingleFinger`, by the first. @param {HTMLElement} part @param {(event: PointerEvent) => HeldControls} controlsAt @param {boolean} [isSingleFinger] */
  #listenToFingers(part, controlsAt, isSingleFinger) {
    const onMove = (/** @type {PointerEvent} */ move) => this.#hold(move.pointerId, controlsAt(move));
    part.addEventListener('pointerdown', (event) => {
      if (event.button || (isSingleFinger && [...this.#moveHandlers.values()].includes(onMove))) return;
      part.setPointerCapture(event.pointerId);
      this.#moveHandlers.set(event.pointerId, onMove);
      onMove(event);
    });
    part.addEventListener('pointermove', (event) => this.#moveHandlers.get(event.pointerId)?.(event));
    for (const name of /** @type {const} */ (['pointerup', 'pointercancel', 'lostpointercapture'])) {
      part.addEventListener(name, ({ pointerId }) => {
        this.#moveHandlers.delete(pointerId);
        this.#release(pointerId);
      });
    }
  }

  /** Where a finger has the stick. @param {PointerEvent} event */
  #controlsAt({ clientX, clientY }) {
    const { left, top, width, height } = this.#stickElement.getBoundingClientRect();
    const reach_px = width / 3;
    return controlsOfStick((clientX - left - width / 2) / reach_px, (top + height / 2 - clientY) / reach_px);
  }

  /** @param {KeyboardEvent} event */
  #onKeyDown(event) {
    if (!this.#drivenRobot || this.#drivenRobot.lacksRemote || event.ctrlKey || event.metaKey || event.altKey) return;
    const { target } = event;
    if (!(target instanceof Element)) return;
    const buttonIndex = PRESSING_KEYS.includes(event.key) ? this.#keyButtons.findIndex((button) => button === target) : -1;
    const keyIndex = buttonIndex < 0 ? KEYBOARD_KEYS.indexOf(event.key.length > 1 ? event.key : event.key.toLowerCase()) : buttonIndex;
    if (keyIndex < 0 || target.closest(KEY_OWNER_SELECTOR)) return;
    event.preventDefault(); // an arrow scrolls
    if (event.repeat) return;
    this.#pressedKeys.set(event.code, keyIndex);
    this.#holdPressedKeys();
  }

  /** @param {KeyboardEvent} event */
  #onKeyUp({ code }) {
    if (this.#pressedKeys.delete(code)) this.#holdPressedKeys();
  }

  #holdPressedKeys() {
    const doArrowsMoveStick = !this.#stickElement.hidden && this.#keyButtons.slice(0, 4).every((part) => part.hidden);
    let keys = 0, right = 0, up = 0;
    for (const keyIndex of this.#pressedKeys.values()) {
      const direction = Object.values(ARROW_DIRECTIONS)[keyIndex];
      if (doArrowsMoveStick && direction) [right, up] = [right + (direction[0] ?? 0), up + (direction[1] ?? 0)];
      else keys |= 1 << keyIndex;
    }
    this.#hold('keyboard', { ...controlsOfStick(right, up), keys });
  }

  /** Looks what gamepads hold, as long as there is one and a robot is driven. */
  #pollGamepads() {
    cancelAnimationFrame(this.#frameRequest);
    const heldByGamepad = readGamepads();
    for (const gamepadNumber of this.#gamepadNumbers) if (!heldByGamepad.has(gamepadNumber)) this.#release(gamepadHolder(gamepadNumber));
    this.#gamepadNumbers = [...heldByGamepad.keys()];
    if (!this.#drivenRobot || !heldByGamepad.size) return;
    for (const [gamepadNumber, controls] of heldByGamepad) {
      if (areControlsSame(controls, NOTHING_HELD)) this.#staleGamepads.delete(gamepadNumber);
      if (!this.#staleGamepads.has(gamepadNumber)) this.#hold(gamepadHolder(gamepadNumber), controls);
    }
    this.#frameRequest = requestAnimationFrame(() => this.#pollGamepads());
  }

  // -- what is held -------------------------------------------------------------------------------

  /** @param {unknown} holder @param {HeldControls} controls */
  #hold(holder, controls) {
    this.#heldByHolder.hold(holder, controls);
    this.#updateControls();
  }

  /** @param {unknown} holder */
  #release(holder) {
    this.#heldByHolder.release(holder);
    this.#updateControls();
  }

  #updateControls() {
    const controls = this.#heldByHolder.combinedControls;
    if (areControlsSame(controls, this.#heldControls)) return;
    this.#heldControls = controls;
    this.#thumbElement.style.setProperty('translate', `${controls.x * THUMB_SHARE}% ${-controls.y * THUMB_SHARE}%`);
    this.#keyButtons.forEach((part, keyIndex) => part.classList.toggle('held', Boolean(controls.keys & (1 << keyIndex))));
    this.#sendControls();
  }

  #sendControls() {
    clearTimeout(this.#repeatTimer);
    if (!this.#drivenRobot || this.#drivenRobot.lacksRemote) return;
    this.#drivenRobot.sendControls(this.#heldControls);
    if (!areControlsSame(this.#heldControls, NOTHING_HELD)) this.#repeatTimer = window.setTimeout(() => this.#sendControls(), LINK.keys_every_ms);
  }
}

/** @param {number} gamepadNumber */
function gamepadHolder(gamepadNumber) {
  return `gamepad ${gamepadNumber}`;
}
