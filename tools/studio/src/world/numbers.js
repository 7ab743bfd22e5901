// The numbers of a part of a world, as inputs for whoever wants them exactly.

import { makeLabel, makeElement } from '../page/made.js';
import { textKey, text } from '../page/texts.js';
import { TOGGLE_KEYS, NUMBERS, valueOf, withToggle, withNumber } from './parts.js';

/** @import { World, Part } from './parts.js' */

/**
 * Puts the inputs of a part into a place; the one that has the focus keeps it.
 * @param {HTMLElement} container
 * @param {World} world
 * @param {Part} part
 * @param {(world: World) => void} onChange
 */
export function showNumbers(container, world, part, onChange) {
  const value = valueOf(world, part);
  const rows = NUMBERS[part.kind].map(([key, low, high]) => {
    const input = makeElement('input');
    Object.assign(input, { type: 'number', min: String(low), max: String(high), step: 'any', value: String(value[key]), id: `world_${key}` });
    input.addEventListener('change', () => {
      const changedWorld = withNumber(world, part, key, input.valueAsNumber);
      input.value = String(valueOf(changedWorld, part)[key]); // what it was, where it was no number
      onChange(changedWorld);
    });
    return makeLabel(textKey(`world_${key}`), input);
  });
  const toggleKey = TOGGLE_KEYS[part.kind];
  if (toggleKey) {
    const input = makeElement('input');
    Object.assign(input, { type: 'checkbox', checked: value[toggleKey], id: `world_${toggleKey}` });
    input.addEventListener('change', () => onChange(withToggle(world, part, toggleKey, input.checked)));
    rows.push(makeLabel(textKey(`world_${toggleKey}`), input));
  }
  const focusedId = container.contains(document.activeElement) ? document.activeElement?.id : '';
  container.replaceChildren(...rows);
  if (focusedId) document.getElementById(focusedId)?.focus();
}

/** @param {Part} part what a person calls it */
export function partName({ kind, index }) {
  const name = text(`world_${kind}`);
  return kind === 'floor' || kind === 'start' ? name : `${name} ${index + 1}`;
}
