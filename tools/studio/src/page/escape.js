// Escape stops the robot. In front of a window it closes that window, and nothing else.

/** @param {() => void} onEscape what the key does while no window is open */
export function onEscapeKey(onEscape) {
  addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && !document.querySelectorAll('dialog[open]').length) onEscape();
  }, { capture: true });
}
