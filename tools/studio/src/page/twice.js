// Children press everything twice. The second press is not for what has come to the place of a button
// that the first one took away; STOP hears each.

const TWICE_MS = 500;
const NEAR = 30; // pixels

export function beginTwice() {
  /** @type {Element | null} */
  let button = null;
  let at_ms = 0, x = 0, y = 0;
  for (const kind of /** @type {const} */ (['pointerdown', 'mousedown', 'click'])) {
    addEventListener(kind, (event) => {
      const isDown = kind === 'pointerdown'; // which counts no presses
      const isTwice = isDown
        ? event.timeStamp - at_ms < TWICE_MS && Math.hypot(event.clientX - x, event.clientY - y) < NEAR
        : event.detail > 1;
      const now = event.target instanceof Element ? event.target.closest('button') : null;
      if (isDown) ({ timeStamp: at_ms, clientX: x, clientY: y } = event);
      if (!isTwice) button = isDown ? now : button;
      else if (button?.checkVisibility() === false && !now?.matches('.stop')) {
        event.preventDefault();
        event.stopImmediatePropagation();
      }
    }, { capture: true });
  }
}
