// The elements of `index.html`, by their ids.

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T}
 */
export function element(id, kind) {
  const node = document.getElementById(id);
  if (!(node instanceof kind)) throw new Error(`no element ${id}`);
  return node;
}

/** Says it there, unless it is said: what stays costs the browser nothing. @param {Element} target @param {string} text */
export function setText(target, text) {
  if (target.textContent === text) return;
  const { firstChild } = target;
  if (firstChild instanceof Text && firstChild === target.lastChild) firstChild.data = text; // which is laid out sooner than another node
  else target.textContent = text;
}

/** Hides it or shows it, unless it is so. @param {HTMLElement} target @param {boolean} isHidden */
export function setHidden(target, isHidden) {
  if (target.hidden !== isHidden) target.hidden = isHidden;
}
