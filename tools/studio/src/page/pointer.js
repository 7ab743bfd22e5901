// What the mouse is over, and whether anything is pressed with it or a finger: that must not go from under it.

export const BLOCK_SELECTOR = '#blocks .blocklyBlock';

let isMouse = false; // a browser has what a finger has left as hovered still
let isDown = false;

for (const kind of /** @type {const} */ (['pointermove', 'pointerdown'])) {
  addEventListener(kind, ({ pointerType, buttons }) => {
    isMouse = pointerType !== 'touch';
    isDown = buttons > 0;
  }, { capture: true, passive: true });
}
for (const kind of ['pointerup', 'pointercancel']) addEventListener(kind, () => { isDown = false; }, { capture: true });

/** @param {string} selector */
export function isMouseOver(selector) {
  return isMouse && document.querySelector(`${selector}:hover`) !== null;
}

/** Whether somebody holds what this selects, or is about to. @param {string} selector */
export function isTouched(selector) {
  return isDown || isMouseOver(selector);
}
