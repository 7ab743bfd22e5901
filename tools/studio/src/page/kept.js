// What this page keeps on this device, for a tab or for all of them. What is kept may be missing, damaged, or
// of another tab: who reads it checks it.

/** @typedef {'localStorage' | 'sessionStorage'} StoreName of all tabs, or of this one */

const KEY_PREFIX = 'tiniscript.'; // all places of this page begin with it

let isMemoryOnly = false;
/** @type {Map<string, string>} what is kept from then on, until the page is closed */
const memoryStore = new Map();

/** What is kept at a place; empty for nothing. @param {string} key @param {StoreName} [storeName] @returns {string} */
export function loadText(key, storeName = 'localStorage') {
  if (isMemoryOnly) return memoryStore.get(storeName + key) ?? '';
  try {
    return window[storeName].getItem(key) ?? '';
  } catch {
    return ''; // no storage here
  }
}

/** What is kept at a place as JSON; null for nothing. @param {string} key @param {StoreName} [storeName] @returns {any} */
export function loadJson(key, storeName) {
  try {
    return JSON.parse(loadText(key, storeName) || 'null');
  } catch {
    return null; // not what we have put there
  }
}

/** Keeps it at a place, empty for nothing; returns whether that was possible. @param {string} key @param {string} text @param {StoreName} [storeName] */
export function storeText(key, text, storeName = 'localStorage') {
  if (isMemoryOnly) return Boolean(memoryStore.set(storeName + key, text));
  try {
    if (text) window[storeName].setItem(key, text);
    else window[storeName].removeItem(key);
    return true;
  } catch {
    return false; // full, or forbidden
  }
}

/** Deletes all that this page has kept on this device; it keeps nothing there from then on. */
export function forgetAll() {
  isMemoryOnly = true;
  for (const storeName of /** @type {const} */ (['sessionStorage', 'localStorage'])) {
    try {
      for (const key of Object.keys(window[storeName])) if (key.startsWith(KEY_PREFIX)) window[storeName].removeItem(key);
    } catch {
      // no storage here
    }
  }
}
