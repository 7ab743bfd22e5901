// What this page keeps on this device, for a tab or for all of them. What is kept may be missing, damaged, or
// of another tab: who reads it checks it.

/** @typedef {'localStorage' | 'sessionStorage'} Store of all tabs, or of this one */

const OURS = 'tiniscript.'; // all places of this page begin with it

let isForgotten = false;
/** @type {Map<string, string>} what is kept from then on, until the page is closed */
const remembered = new Map();

/** What is kept at a place; empty for nothing. @param {string} place @param {Store} [store] @returns {string} */
export function kept(place, store = 'localStorage') {
  if (isForgotten) return remembered.get(store + place) ?? '';
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

/** Keeps it at a place, empty for nothing; returns whether that was possible. @param {string} place @param {string} whole @param {Store} [store] */
export function keepAt(place, whole, store = 'localStorage') {
  if (isForgotten) return Boolean(remembered.set(store + place, whole));
  try {
    if (whole) window[store].setItem(place, whole);
    else window[store].removeItem(place);
    return true;
  } catch {
    return false; // full, or forbidden
  }
}

/** Deletes all that this page has kept on this device; it keeps nothing there from then on. */
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
