// What is held of a remote control, by whoever holds it: fingers, keys, gamepads. All their keys count, and the stick of
// who has moved his last.

/** @typedef {{keys: number, x: number, y: number}} Held a bit for each key; to the right and up, in percent */

export const MOST = 100;
export const NOTHING = Object.freeze({ keys: 0, x: 0, y: 0 });

/** @param {Held} one @param {Held} other */
export function isSame(one, other) {
  return one.keys === other.keys && one.x === other.x && one.y === other.y;
}

/** Where a stick is that was moved so far of what it can be. @param {number} right @param {number} up @returns {Held} */
export function moved(right, up) {
  const far = Math.max(1, Math.hypot(right, up));
  return { keys: 0, x: Math.round((MOST * right) / far) || 0, y: Math.round((MOST * up) / far) || 0 };
}

export class Holding {
  /** The newest last. @type {Map<unknown, Held>} */
  #held = new Map();

  /** @param {unknown} who @param {Held} held */
  hold(who, held) {
    const before = this.#held.get(who);
    if (before && isSame(before, held)) return; // who has not moved is not the newest
    this.#held.delete(who);
    if (!isSame(held, NOTHING)) this.#held.set(who, held);
  }

  /** @param {unknown} who */
  letGo(who) {
    this.#held.delete(who);
  }

  letAllGo() {
    this.#held.clear();
  }

  /** @returns {Held} */
  get all() {
    let keys = 0, x = 0, y = 0;
    for (const each of this.#held.values()) {
      keys |= each.keys;
      if (each.x || each.y) ({ x, y } = each);
    }
    return { keys, x, y };
  }
}
