// Which screen is seen: the start, or the program and its robot. The address of the latter ends with
// `#editor`: a reload stays there, Back leads to the start, and a page can be opened there at once.

import { pageState } from '../page/page_state.js';

/** @typedef {'start' | 'program'} Screen */

const EDITOR = '#editor';
const root = document.documentElement;

/** Whether the address is that of a screen, and of nothing else. */
function isScreen() {
  return location.hash === '' || location.hash === EDITOR;
}

/** @param {Screen} screen */
function put(screen) {
  if (pageState.screen.value === screen) return;
  root.dataset['screen'] = screen;
  pageState.screen.set(screen);
}

/** @returns {boolean} */
export function isStart() {
  return pageState.screen.value === 'start';
}

/** @param {Screen} screen */
export function show(screen) {
  if (pageState.screen.value === screen) return;
  history.pushState(null, '', location.pathname + location.search + (screen === 'start' ? '' : EDITOR));
  put(screen);
}

/** Shows the program in place of what the address has brought, which is taken out of it. */
export function showInstead() {
  history.replaceState(null, '', location.pathname + location.search + EDITOR);
  put('program');
}

/**
 * Begins with what the address says.
 * @param {boolean} isProgram the program is to be seen, whatever it says
 * @param {boolean} hasStart a class has none
 */
export function beginScreens(isProgram, hasStart) {
  put(isProgram || !hasStart || location.hash === EDITOR ? 'program' : 'start');
  addEventListener('popstate', () => {
    if (hasStart && isScreen()) put(location.hash === EDITOR ? 'program' : 'start');
  });
}
