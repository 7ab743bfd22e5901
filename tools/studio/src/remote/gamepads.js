// What gamepads hold. A browser tells of no button that is pressed: who wants to know looks at each picture.

import { moved, NOTHING } from './held.js';

/** @import { Held } from './held.js' */

const DEAD = 0.15; // of its way: so far a stick that nobody touches may be off
/** Buttons of the standard layout, in the order of the keys: a cross, and the two below. */
const BUTTONS = [12, 13, 14, 15, 0, 1];

/** @param {Gamepad} gamepad @returns {Held} */
function heldBy({ axes, buttons }) {
  const [right = 0, down = 0] = axes;
  const keys = BUTTONS.reduce((found, button, k) => found | (buttons[button]?.pressed ? 1 << k : 0), 0);
  return { ...(Math.hypot(right, down) > DEAD ? moved(right, -down) : NOTHING), keys };
}

/** What each one that is there holds now, by its number. @returns {Map<number, Held>} */
export function gamepadsHeld() {
  const there = navigator.getGamepads?.() ?? [];
  return new Map(there.flatMap((each) => (each?.connected ? [[each.index, heldBy(each)]] : [])));
}
