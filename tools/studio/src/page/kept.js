// What this page keeps on this device, for a tab or for all of them. What is kept may be missing, damaged, or
// of another tab: who reads it checks it.

/** @typedef {'localStorage' | 'sessionStorage'} Store of all tabs, or of this one */

const OURS = 'tiniscript.'; // all places of this page begin with it

let isForgotten = false;

/** What is kept at a place; empty for nothing. @param {string} place @param {Store} [store] @returns {string} */
export function kept(place, store = 'localStorage') {
  try {
    return window[store].getItem(place) ?? '';
  } catch {
    return ''; // no storage here
  }
}

/** What is kept at a place as JSON; null for nothing. @param {string} place @param {Store} [store] @returns {any} */
export function keptForm(place, store) {
  try {
    return JSON.parse(kept(place, store) || 'null');
  } catch {
    return null; // not what we have put there
  }
}

/** Keeps it at a place; returns whether that was possible. @param {string} place @param {string} whole @param {Store} [store] */
export function keepAt(place, whole, store = 'localStorage') {
  if (isForgotten) return true;
  try {
    window[store].setItem(place, whole);
    return true;
  } catch {
    return false; // full, or forbidden
  }
}

/** Deletes all that this page has kept on this device; it keeps nothing from then on. */
export function forgetAll() {
  isForgotten = true;
  for (const store of /** @type {const} */ (['sessionStorage', 'localStorage'])) {
    try {
      for (const place of Object.keys(window[store])) if (place.startsWith(OURS)) window[store].removeItem(place);
    } catch {
      // no storage here
    }
  }
}
