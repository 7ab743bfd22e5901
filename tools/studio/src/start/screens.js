// Which screen is seen: the start, or the program and its robot. The address of the latter ends with
// `#editor`: a reload stays there, Back leads to the start, and a page can be opened there at once.

import { pageState } from '../page/page_state.js';

/** @typedef {'start' | 'program'} Screen */

const EDITOR_HASH = '#editor';
const root = document.documentElement;

/** Whether the address is that of a screen, and of nothing else. */
function isScreenAddress() {
  return location.hash === '' || location.hash === EDITOR_HASH;
}

/** @param {Screen} screen */
function setScreen(screen) {
  if (pageState.screen.value === screen) return;
  root.dataset['screen'] = screen;
  pageState.screen.set(screen);
}

/** @returns {boolean} */
export function isStartShown() {
  return pageState.screen.value === 'start';
}

/** @param {Screen} screen */
export function showScreen(screen) {
  if (pageState.screen.value === screen) return;
  history.pushState(null, '', location.pathname + location.search + (screen === 'start' ? '' : EDITOR_HASH));
  setScreen(screen);
}

/** Shows the program in place of what the address has brought, which is taken out of it. */
export function showProgramInstead() {
  history.replaceState(null, '', location.pathname + location.search + EDITOR_HASH);
  setScreen('program');
}

/**
 * Begins with what the address says.
 * @param {boolean} isProgramWanted the program is to be seen, whatever it says
 * @param {boolean} hasStart a class has none
 */
export function openFirstScreen(isProgramWanted, hasStart) {
  setScreen(isProgramWanted || !hasStart || location.hash === EDITOR_HASH ? 'program' : 'start');
  addEventListener('popstate', () => {
    if (hasStart && isScreenAddress()) setScreen(location.hash === EDITOR_HASH ? 'program' : 'start');
  });
}
