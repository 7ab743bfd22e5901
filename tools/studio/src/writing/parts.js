// The parts of a program in front of which it can stop, as the compiler tells them.

/** @typedef {import('../python.js').CheckResult['places']} Places */
/** @typedef {{line: number, column: number}} Place */

/** @param {Places[number]} place */
const startOf = ([, line, column]) => ({ line, column });

/**
 * What is marked of the text while a program is at a place: of a block its head.
 * @param {Places} places
 * @param {number | null | undefined} codeOffset an offset in the code
 * @returns {import('./editor.js').Range | null}
 */
export function rangeAt(places, codeOffset) {
  const place = codeOffset == null ? undefined : places.findLast(([offset]) => offset <= codeOffset);
  if (!place) return null;
  const [, line, column, end_line, end_column] = place;
  return { line, column, ...(end_line > line ? { end_line: line, end_column: Infinity } : { end_line, end_column }) };
}

/**
 * Where a program stops that is to stop at a place: at the last part that begins there or before
 * in the same line, or else at the next one.
 * @param {Places} places
 * @param {Place} position
 * @param {boolean} isWholeLine the part that begins first in this line
 * @returns {Place | null} the beginning of the part; null after the last line with one
 */
export function partAt(places, position, isWholeLine) {
  const starts = places.map(startOf).sort((first, second) => first.line - second.line || first.column - second.column);
  const partInLine = isWholeLine ? undefined : starts.findLast((start) => start.line === position.line && start.column <= position.column);
  return partInLine ?? starts.find((start) => start.line >= position.line) ?? null;
}

/**
 * The offsets in the code at which a program stops.
 * @param {Places} places
 * @param {Place[]} breakpoints
 * @returns {number[]}
 */
export function offsetsOf(places, breakpoints) {
  const startKeys = new Set();
  for (const breakpoint of breakpoints) {
    const part = partAt(places, breakpoint, false);
    if (part) startKeys.add(`${part.line}:${part.column}`);
  }
  return places.filter(([, line, column]) => startKeys.has(`${line}:${column}`)).map(([offset]) => offset);
}

/** Where a program that runs stops, for each breakpoint of the page. */
export class StopOffsets {
  /** @type {Map<object, number[]>} */
  #offsetsByPoint = new Map();

  /**
   * After a change of the text those remain whose breakpoints are still there.
   * @param {(Place & {point: object})[]} breakpoints
   * @param {Places} places of the text; none: it is another one than what runs
   */
  update(breakpoints, places) {
    this.#offsetsByPoint = new Map(breakpoints.map((breakpoint) => [
      breakpoint.point, places.length ? offsetsOf(places, [breakpoint]) : this.#offsetsByPoint.get(breakpoint.point) ?? [],
    ]));
  }

  get offsets() {
    return [...new Set([...this.#offsetsByPoint.values()].flat())];
  }
}
