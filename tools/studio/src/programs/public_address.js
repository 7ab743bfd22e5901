// Where others find this page, as somebody has told it, kept on this device.

import { keepsNothing } from './work.js';

const PLACE = 'tiniscript.public';

/** @param {string} address */
export function isAddress(address) {
  return URL.canParse(address) && /^https?:$/.test(new URL(address).protocol);
}

/** What somebody has told; empty for nothing. @returns {string} */
export function publicAddress() {
  try {
    return (localStorage.getItem(PLACE) ?? '').slice(0, 200);
  } catch {
    return ''; // no storage here
  }
}

/** @param {string} address */
export function keepPublic(address) {
  if (keepsNothing()) return;
  try {
    localStorage.setItem(PLACE, address);
  } catch {
    // full, or forbidden: the link is as before
  }
}
