// What gamepads hold. A browser tells of no button that is pressed: who wants to know looks at each picture.

import { controlsOfStick, NOTHING_HELD } from './held.js';

/** @import { HeldControls } from './held.js' */

const DEAD_ZONE = 0.15; // of its way: so far a stick that nobody touches may be off
/** Buttons of the standard layout, in the order of the keys: a cross, and the two below. */
const BUTTON_INDEXES = [12, 13, 14, 15, 0, 1];

/** @param {Gamepad} gamepad @returns {HeldControls} */
function controlsOf({ axes, buttons }) {
  const [right = 0, down = 0] = axes;
  const keys = BUTTON_INDEXES.reduce((keys, buttonIndex, keyIndex) => keys | (buttons[buttonIndex]?.pressed ? 1 << keyIndex : 0), 0);
  return { ...(Math.hypot(right, down) > DEAD_ZONE ? controlsOfStick(right, -down) : NOTHING_HELD), keys };
}

/** What each one that is there holds now, by its number. @returns {Map<number, HeldControls>} */
export function readGamepads() {
  const gamepads = navigator.getGamepads?.() ?? [];
  return new Map(gamepads.flatMap((gamepad) => (gamepad?.connected ? [[gamepad.index, controlsOf(gamepad)]] : [])));
}
