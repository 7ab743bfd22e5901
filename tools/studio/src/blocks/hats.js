// Where in the text a hat is written: a WHEN, a TASK or a DEF with what hangs below it. Knows no Blockly.
//
// A text keeps its order until somebody moves a hat. One that is moved or new is written by its place in
// the page, top to bottom: a DEF before the program, as it stands before its calls, others after it.

/** @typedef {import('./form.js').FormBlock} FormBlock */
/** @typedef {{block: FormBlock, ids: string[]}} TextItem a block of the text's top level, and the ids of it and of what is in it */
/**
 * @typedef {object} HatPlace
 * @property {number} x
 * @property {number} y
 * @property {number | null} gap how many blocks of the program stand before it in the text; null where it is new or was moved
 */
/** @typedef {TextItem & HatPlace} Hat */

/**
 * @param {TextItem[]} program in its order
 * @param {Hat[]} hats those that keep their gap in the order of the text
 * @param {Set<string>} earlyDefs DEFs that the text calls too early
 * @returns {TextItem[]} all of them in the order of the text
 */
export function inTextOrder(program, hats, earlyDefs) {
  /** @type {Hat[][]} */
  const hatsByGap = Array.from({ length: program.length + 1 }, () => []);
  for (const hat of hats) if (hat.gap !== null) hatsByGap[hat.gap]?.push(hat);
  const commentCount = countComments(program);
  for (const hat of hats.filter(({ gap }) => gap === null).sort((a, b) => a.y - b.y || a.x - b.x)) {
    const hatsInGap = hatsByGap[hat.block.kind === 'def' ? commentCount : program.length] ?? [];
    const indexBelow = hatsInGap.findIndex((other) => other.y > hat.y);
    hatsInGap.splice(indexBelow < 0 ? hatsInGap.length : indexBelow, 0, hat);
  }
  const items = hatsByGap.flatMap((hatsInGap, index) => [...hatsInGap, ...program.slice(index, index + 1)]);
  return withDefsBeforeCalls(items, earlyDefs);
}

/** Moves each DEF up that is called before it. @param {TextItem[]} items @param {Set<string>} earlyDefs @returns {TextItem[]} */
function withDefsBeforeCalls(items, earlyDefs) {
  const orderedItems = [...items];
  for (let roundsLeft = orderedItems.length; roundsLeft; roundsLeft -= 1) { // more would be DEFs that call each other
    const earlyCall = findEarlyCall(orderedItems, earlyDefs);
    if (!earlyCall) break;
    const { defIndex, callIndex } = earlyCall;
    const [item] = orderedItems.splice(defIndex, 1);
    const isHat = ['def', 'task', 'when'].includes(orderedItems[callIndex]?.block.kind ?? '');
    if (item) orderedItems.splice(isHat ? callIndex : Math.min(callIndex, countComments(orderedItems)), 0, item);
  }
  return orderedItems;
}

/** @param {TextItem[]} items @param {Set<string>} earlyDefs @returns {{defIndex: number, callIndex: number} | null} where a DEF is, and a call before it */
function findEarlyCall(items, earlyDefs) {
  for (const [defIndex, { block }] of items.entries()) {
    if (block.kind !== 'def' || earlyDefs.has(block.word)) continue;
    const callIndex = items.findIndex((item) => item.block !== block && isCalledIn(block.word, item.block));
    if (callIndex >= 0 && callIndex < defIndex) return { defIndex, callIndex };
  }
  return null;
}

/** @param {FormBlock[]} body the top level of a text @returns {Set<string>} the DEFs that it calls too early */
export function findEarlyDefs(body) {
  /** @type {Set<string>} */
  const earlyDefs = new Set();
  const items = body.map((block) => ({ block, ids: [] }));
  for (let earlyCall = findEarlyCall(items, earlyDefs); earlyCall; earlyCall = findEarlyCall(items, earlyDefs)) earlyDefs.add(body[earlyCall.defIndex]?.word ?? '');
  return earlyDefs;
}

/** @param {string} word @param {FormBlock} block */
function isCalledIn(word, block) {
  const pendingBlocks = [block];
  for (let nextBlock = pendingBlocks.pop(); nextBlock; nextBlock = pendingBlocks.pop()) {
    if (nextBlock.kind === 'call' && nextBlock.word === word) return true;
    for (const body of nextBlock.bodies) pendingBlocks.push(...body);
  }
  return false;
}

/** @param {TextItem[]} items @returns {number} how many comments they begin with */
function countComments(items) {
  const firstOtherIndex = items.findIndex(({ block }) => block.kind !== 'comment');
  return firstOtherIndex < 0 ? items.length : firstOtherIndex;
}
