// The numbers of a part of a world, as inputs for whoever wants them exactly.

import { makeLabel, makeElement } from '../page/made.js';
import { textKey, text } from '../page/texts.js';
import { CHOICES, NUMBERS, valueOf, withChoice, withNumber } from './parts.js';

/** @import { World, Part } from './parts.js' */

/**
 * Puts the inputs of a part into a place; the one that has the focus keeps it.
 * @param {HTMLElement} place
 * @param {World} world
 * @param {Part} part
 * @param {(world: World) => void} change
 */
export function showNumbers(place, world, part, change) {
  const value = valueOf(world, part);
  const rows = NUMBERS[part.kind].map(([key, low, high]) => {
    const input = makeElement('input');
    Object.assign(input, { type: 'number', min: String(low), max: String(high), step: 'any', value: String(value[key]), id: `world_${key}` });
    input.addEventListener('change', () => {
      const changed = withNumber(world, part, key, input.valueAsNumber);
      input.value = String(valueOf(changed, part)[key]); // what it was, where it was no number
      change(changed);
    });
    return makeLabel(textKey(`world_${key}`), input);
  });
  const choice = CHOICES[part.kind];
  if (choice) {
    const input = makeElement('input');
    Object.assign(input, { type: 'checkbox', checked: value[choice], id: `world_${choice}` });
    input.addEventListener('change', () => change(withChoice(world, part, choice, input.checked)));
    rows.push(makeLabel(textKey(`world_${choice}`), input));
  }
  const focused = place.contains(document.activeElement) ? document.activeElement?.id : '';
  place.replaceChildren(...rows);
  if (focused) document.getElementById(focused)?.focus();
}

/** @param {Part} part what a person calls it */
export function nameOf({ kind, index }) {
  const name = text(`world_${kind}`);
  return kind === 'floor' || kind === 'start' ? name : `${name} ${index + 1}`;
}
