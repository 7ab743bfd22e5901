// What is held of a remote control, by whoever holds it: fingers, keys, gamepads. All their keys count, and the stick of
// who has moved his last.

/** @typedef {{keys: number, x: number, y: number}} HeldControls a bit for each key; to the right and up, in percent */

export const MAX_PERCENT = 100;
export const NOTHING_HELD = Object.freeze({ keys: 0, x: 0, y: 0 });

/** @param {HeldControls} first @param {HeldControls} second */
export function areControlsSame(first, second) {
  return first.keys === second.keys && first.x === second.x && first.y === second.y;
}

/** Where a stick is that was moved so far of what it can be. @param {number} right @param {number} up @returns {HeldControls} */
export function controlsOfStick(right, up) {
  const length = Math.max(1, Math.hypot(right, up));
  return { keys: 0, x: Math.round((MAX_PERCENT * right) / length) || 0, y: Math.round((MAX_PERCENT * up) / length) || 0 };
}

export class HeldByHolder {
  /** The newest last. @type {Map<unknown, HeldControls>} */
  #heldByHolder = new Map();

  /** @param {unknown} holder @param {HeldControls} controls */
  hold(holder, controls) {
    const heldBefore = this.#heldByHolder.get(holder);
    if (heldBefore && areControlsSame(heldBefore, controls)) return; // who has not moved is not the newest
    this.#heldByHolder.delete(holder);
    if (!areControlsSame(controls, NOTHING_HELD)) this.#heldByHolder.set(holder, controls);
  }

  /** @param {unknown} holder */
  release(holder) {
    this.#heldByHolder.delete(holder);
  }

  releaseAll() {
    this.#heldByHolder.clear();
  }

  /** @returns {HeldControls} */
  get combinedControls() {
    let keys = 0, x = 0, y = 0;
    for (const controls of this.#heldByHolder.values()) {
      keys |= controls.keys;
      if (controls.x || controls.y) ({ x, y } = controls);
    }
    return { keys, x, y };
  }
}
