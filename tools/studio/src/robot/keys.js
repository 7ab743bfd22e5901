// The keys of robots that this browser keeps: the text of a file of keys, as `tsc keys` writes it.
// Who uses this browser uses them; the page gives them to no one but the robot's session.

const PLACE = 'tiniscript.link.keys';

/** @returns {string} */
export function keptKeys() {
  try {
    return localStorage.getItem(PLACE) ?? '';
  } catch {
    return ''; // no storage here
  }
}

/** @param {string} keys */
export function keepKeys(keys) {
  try {
    localStorage.setItem(PLACE, keys);
  } catch {
    // full, or forbidden: they are gone with this page
  }
}
