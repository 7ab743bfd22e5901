// Where in the text a hat is written: a WHEN, a TASK or a DEF with what hangs below it. Knows no Blockly.
//
// A text keeps its order until somebody moves a hat. One that is moved or new is written by its place in
// the page, top to bottom: a DEF before the program, as it stands before its calls, others after it.

/** @typedef {import('./form.js').FormBlock} FormBlock */
/** @typedef {{block: FormBlock, ids: string[]}} Item a block of the text's top level, and the ids of it and of what is in it */
/**
 * @typedef {object} HatPlace
 * @property {number} x
 * @property {number} y
 * @property {number | null} gap how many blocks of the program stand before it in the text; null where it is new or was moved
 */
/** @typedef {Item & HatPlace} Hat */

/**
 * @param {Item[]} program in its order
 * @param {Hat[]} hats those that keep their gap in the order of the text
 * @param {Set<string>} excused DEFs that the text calls too early
 * @returns {Item[]} all of them in the order of the text
 */
export function inTextOrder(program, hats, excused) {
  /** @type {Hat[][]} */
  const gaps = Array.from({ length: program.length + 1 }, () => []);
  for (const hat of hats) if (hat.gap !== null) gaps[hat.gap]?.push(hat);
  const beginning = comments(program);
  for (const hat of hats.filter(({ gap }) => gap === null).sort((a, b) => a.y - b.y || a.x - b.x)) {
    const gap = gaps[hat.block.kind === 'def' ? beginning : program.length] ?? [];
    const below = gap.findIndex((other) => other.y > hat.y);
    gap.splice(below < 0 ? gap.length : below, 0, hat);
  }
  const items = gaps.flatMap((gap, k) => [...gap, ...program.slice(k, k + 1)]);
  return withDefsBeforeCalls(items, excused);
}

/** Moves each DEF up that is called before it. @param {Item[]} items @param {Set<string>} excused @returns {Item[]} */
function withDefsBeforeCalls(items, excused) {
  const order = [...items];
  for (let rounds = order.length; rounds; rounds -= 1) { // more would be DEFs that call each other
    const early = earlyCall(order, excused);
    if (!early) break;
    const { def, call } = early;
    const [item] = order.splice(def, 1);
    const isHat = ['def', 'task', 'when'].includes(order[call]?.block.kind ?? '');
    if (item) order.splice(isHat ? call : Math.min(call, comments(order)), 0, item);
  }
  return order;
}

/** @param {Item[]} items @param {Set<string>} excused @returns {{def: number, call: number} | null} where a DEF is, and a call before it */
function earlyCall(items, excused) {
  for (const [def, { block }] of items.entries()) {
    if (block.kind !== 'def' || excused.has(block.word)) continue;
    const call = items.findIndex((item) => item.block !== block && isCalledIn(block.word, item.block));
    if (call >= 0 && call < def) return { def, call };
  }
  return null;
}

/** @param {FormBlock[]} body the top level of a text @returns {Set<string>} the DEFs that it calls too early */
export function calledEarly(body) {
  /** @type {Set<string>} */
  const found = new Set();
  const items = body.map((block) => ({ block, ids: [] }));
  for (let early = earlyCall(items, found); early; early = earlyCall(items, found)) found.add(body[early.def]?.word ?? '');
  return found;
}

/** @param {string} word @param {FormBlock} block */
function isCalledIn(word, block) {
  const waiting = [block];
  for (let next = waiting.pop(); next; next = waiting.pop()) {
    if (next.kind === 'call' && next.word === word) return true;
    for (const body of next.bodies) waiting.push(...body);
  }
  return false;
}

/** @param {Item[]} items @returns {number} how many comments they begin with */
function comments(items) {
  const first = items.findIndex(({ block }) => block.kind !== 'comment');
  return first < 0 ? items.length : first;
}
