// What is held of a remote control, by whoever holds it: fingers, keys, gamepads. All their keys count, and the stick of
// who has moved his last.

/** @typedef {{keys: number, x: number, y: number}} Held a bit for each key; to the right and up, in percent */

export const MOST_PERCENT = 100;
export const NOTHING_HELD = Object.freeze({ keys: 0, x: 0, y: 0 });

/** @param {Held} first @param {Held} second */
export function isSameHeld(first, second) {
  return first.keys === second.keys && first.x === second.x && first.y === second.y;
}

/** Where a stick is that was moved so far of what it can be. @param {number} right @param {number} up @returns {Held} */
export function heldOfStick(right, up) {
  const length = Math.max(1, Math.hypot(right, up));
  return { keys: 0, x: Math.round((MOST_PERCENT * right) / length) || 0, y: Math.round((MOST_PERCENT * up) / length) || 0 };
}

export class HeldByHolder {
  /** The newest last. @type {Map<unknown, Held>} */
  #heldByHolder = new Map();

  /** @param {unknown} holder @param {Held} held */
  hold(holder, held) {
    const heldBefore = this.#heldByHolder.get(holder);
    if (heldBefore && isSameHeld(heldBefore, held)) return; // who has not moved is not the newest
    this.#heldByHolder.delete(holder);
    if (!isSameHeld(held, NOTHING_HELD)) this.#heldByHolder.set(holder, held);
  }

  /** @param {unknown} holder */
  letGo(holder) {
    this.#heldByHolder.delete(holder);
  }

  letAllGo() {
    this.#heldByHolder.clear();
  }

  /** @returns {Held} */
  get combined() {
    let keys = 0, x = 0, y = 0;
    for (const held of this.#heldByHolder.values()) {
      keys |= held.keys;
      if (held.x || held.y) ({ x, y } = held);
    }
    return { keys, x, y };
  }
}
