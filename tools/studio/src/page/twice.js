// Children press everything twice. The second press is not for what has come to the place of a button
// that the first one took away; STOP hears each.

const DOUBLE_PRESS_MS = 500;
const NEAR_PX = 30; // pixels

let isSecondTap = false; // of a finger, whose clicks not every browser counts

/** @param {MouseEvent} click */
export function isSecondPress({ detail }) {
  return detail > 1 || (isSecondTap && detail > 0); // keys have none
}

export function ignoreSecondPresses() {
  /** @type {Element | null} */
  let firstButton = null;
  let pressed_ms = 0, x = 0, y = 0;
  for (const kind of /** @type {const} */ (['pointerdown', 'mousedown', 'click'])) {
    addEventListener(kind, (event) => {
      const pressedButton = event.target instanceof Element ? event.target.closest('button') : null;
      let isSecond = kind !== 'pointerdown' && isSecondPress(event);
      if (kind === 'pointerdown') {
        isSecond = event.timeStamp - pressed_ms < DOUBLE_PRESS_MS && Math.hypot(event.clientX - x, event.clientY - y) < NEAR_PX;
        isSecondTap = isSecond && /** @type {PointerEvent} */ (event).pointerType === 'touch';
        if (!isSecond) ({ timeStamp: pressed_ms, clientX: x, clientY: y } = event);
      }
      if (!isSecond) firstButton = kind === 'pointerdown' ? pressedButton : firstButton;
      else if (firstButton?.checkVisibility() === false && !pressedButton?.matches('.stop')) {
        event.preventDefault();
        event.stopImmediatePropagation();
      }
    }, { capture: true });
  }
}
