// Children press everything twice. The second press is not for what has come to the place of a button
// that the first one took away; STOP hears each.

const TWICE_MS = 500;
const NEAR = 30; // pixels

let isSecondTap = false; // of a finger, whose clicks not every browser counts

/** @param {MouseEvent} click */
export function isSecond({ detail }) {
  return detail > 1 || (isSecondTap && detail > 0); // keys have none
}

export function beginTwice() {
  /** @type {Element | null} */
  let button = null;
  let at_ms = 0, x = 0, y = 0;
  for (const kind of /** @type {const} */ (['pointerdown', 'mousedown', 'click'])) {
    addEventListener(kind, (event) => {
      const now = event.target instanceof Element ? event.target.closest('button') : null;
      let isTwice = kind !== 'pointerdown' && isSecond(event);
      if (kind === 'pointerdown') {
        isTwice = event.timeStamp - at_ms < TWICE_MS && Math.hypot(event.clientX - x, event.clientY - y) < NEAR;
        isSecondTap = isTwice && /** @type {PointerEvent} */ (event).pointerType === 'touch';
        if (!isTwice) ({ timeStamp: at_ms, clientX: x, clientY: y } = event);
      }
      if (!isTwice) button = kind === 'pointerdown' ? now : button;
      else if (button?.checkVisibility() === false && !now?.matches('.stop')) {
        event.preventDefault();
        event.stopImmediatePropagation();
      }
    }, { capture: true });
  }
}
