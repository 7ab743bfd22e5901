// The elements of `index.html`, by their ids.

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function element(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof kind)) throw new Error(`no element ${id}`);
  return found;
}

/** Says it there, unless it is said: what stays costs the browser nothing. @param {Element} place @param {string} said */
export function say(place, said) {
  if (place.textContent !== said) place.textContent = said;
}

/** Hides it or shows it, unless it is so. @param {HTMLElement} place @param {boolean} isHidden */
export function hide(place, isHidden) {
  if (place.hidden !== isHidden) place.hidden = isHidden;
}
