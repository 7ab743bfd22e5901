// The parts of a program in front of which it can stop, as the compiler tells them.

/** @typedef {import('../python.js').Checked['places']} Places */
/** @typedef {{line: number, column: number}} Place */

/** @param {Places[number]} place */
const startOf = ([, line, column]) => ({ line, column });

/**
 * What is marked of the text while a program is at a place: of a block its head.
 * @param {Places} places
 * @param {number | null | undefined} at an offset in the code
 * @returns {import('./editor.js').Range | null}
 */
export function rangeAt(places, at) {
  const place = at == null ? undefined : places.findLast(([offset]) => offset <= at);
  if (!place) return null;
  const [, line, column, end_line, end_column] = place;
  return { line, column, ...(end_line > line ? { end_line: line, end_column: Infinity } : { end_line, end_column }) };
}

/**
 * Where a program stops that is to stop at a place: at the last part that begins there or before
 * in the same line, or else at the next one.
 * @param {Places} places
 * @param {Place} at
 * @param {boolean} isLine the part that begins first in this line
 * @returns {Place | null} the beginning of the part; null after the last line with one
 */
export function partAt(places, at, isLine) {
  const begins = places.map(startOf).sort((one, other) => one.line - other.line || one.column - other.column);
  const here = isLine ? undefined : begins.findLast((each) => each.line === at.line && each.column <= at.column);
  return here ?? begins.find((each) => each.line >= at.line) ?? null;
}

/**
 * The offsets in the code at which a program stops.
 * @param {Places} places
 * @param {Place[]} breakpoints
 * @returns {number[]}
 */
export function offsetsOf(places, breakpoints) {
  const wanted = new Set();
  for (const each of breakpoints) {
    const part = partAt(places, each, false);
    if (part) wanted.add(`${part.line}:${part.column}`);
  }
  return places.filter(([, line, column]) => wanted.has(`${line}:${column}`)).map(([offset]) => offset);
}

/** Where a program that runs stops, for each breakpoint of the page. */
export class Stops {
  /** @type {Map<object, number[]>} */
  #of = new Map();

  /**
   * After a change of the text those remain whose breakpoints are still there.
   * @param {(Place & {point: object})[]} breakpoints
   * @param {Places} places of the text; none: it is another one than what runs
   */
  find(breakpoints, places) {
    this.#of = new Map(breakpoints.map((each) => [
      each.point, places.length ? offsetsOf(places, [each]) : this.#of.get(each.point) ?? [],
    ]));
  }

  get offsets() {
    return [...new Set([...this.#of.values()].flat())];
  }
}
