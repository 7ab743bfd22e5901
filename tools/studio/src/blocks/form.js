// Blocks of the page and their form as Python knows it (`studio/block_form.py`), both ways.
//
// Goes along the blocks with lists of its own: a long program must not exhaust the stack.

import * as Blockly from 'blockly/core';
import { WAY_UNIT } from './fields.js';
import { findEarlyDefs, inTextOrder } from './hats.js';
import { impliedWordOf, wordOnBlock } from './places.js';
import { LenientConnectionChecker } from './shapes.js';
import { runAtOnce, runInSlices } from './slices.js';
import { KINDS, pieceOf } from '../page/words.js';

/** @typedef {[number, number, number, number]} TextRange line and column, from 1, and those of the end */
/** @typedef {[string, string][]} Value */
/**
 * @typedef {object} FormBlock
 * @property {string} kind
 * @property {string} word
 * @property {Value[]} values
 * @property {FormBlock[][]} bodies
 * @property {string} note
 * @property {boolean} is_apart
 * @property {TextRange} [place]
 * @property {string[]} [said] what its lines were; one is empty that somebody has changed
 * @property {string} [comment] what its note was, or of a comment itself
 * @property {boolean} [is_behind] the end of a block, or an arm
 */
/** @typedef {{start: string, note: string, is_one_line: boolean, body: FormBlock[], loose: {body: FormBlock[], value: Value}[]}} Form */

/** The kind of block of each part of an expression. */
const KIND_OF_PART = new Map(Object.entries(KINDS).flatMap(([kind, { part, words }]) => [part, ...words].map((word) => [word, kind])));
const CORNER_UNITS = 32; // where the program begins
const STACK_GAP = 64; // between stacks: Blockly pushes what is nearer than it would join

/**
 * What is known of blocks since they were made of a text.
 * @typedef {object} ShownBlocks
 * @property {string[]} program ids of its blocks
 * @property {Map<string, {blockCountBefore: number, x: number, y: number, isMoved: boolean}>} hats by their ids in the order of
 *   the text: so many blocks of the program stand before it, where it was put, and whether somebody had moved it
 * @property {Set<string>} earlyDefs
 */
/** @type {WeakMap<Blockly.Workspace, ShownBlocks>} */
const SHOWN_BLOCKS = new WeakMap();

// -- blocks to their form --------------------------------------------------------------------------

/**
 * @param {Blockly.WorkspaceSvg} workspace
 * @returns {{form: Form, ids: string[]}} `ids` of the blocks of the body, in the order of the text
 */
export function formOf(workspace) {
  const topBlocks = topBlocksOf(workspace);
  const program = topBlocks.find((block) => block.type === 'program');
  const items = itemsOf(workspace);
  const data = dataOf(program);
  const word = String(program?.getFieldValue('WORD') ?? 'SI');
  return {
    form: {
      start: data.isUnsaid && word === 'SI' ? '' : word,
      note: program?.getCommentText() ?? '',
      is_one_line: Boolean(data.isOneLine),
      body: items.map(({ block }) => block),
      loose: topBlocks.filter(isLoose).map(stackOf),
    },
    ids: items.flatMap(({ ids }) => ids),
  };
}

/**
 * A program of one block and what is in it, with the words that it may use; of a value one that shows it.
 * @param {Blockly.Block} block
 * @returns {Form}
 */
export function formOfBlock(block) {
  const topBlocks = topBlocksOf(/** @type {Blockly.WorkspaceSvg} */ (block.workspace));
  const definitions = topBlocks.filter((top) => top.type === 'def' && top !== block).map((top) => blockOf(top, []));
  const showBlock = { kind: 'show', word: 'SHOW', values: [valueOf(block)], bodies: [], note: '', is_apart: false };
  const isProgramPart = block.type === 'program' || isHat(block);
  const ownBlocks = block.outputConnection ? [showBlock] : isProgramPart ? bodyOf(block.getNextBlock(), []) : [blockOf(block, [])];
  return { start: 'SI', note: '', is_one_line: false, body: [...definitions, ...ownBlocks], loose: [] };
}

/** @param {Blockly.WorkspaceSvg} workspace */
function topBlocksOf(workspace) {
  return workspace.getTopBlocks(true).filter((block) => !block.isInsertionMarker());
}

/** @param {Blockly.Block} block */
function isHat(block) {
  return Boolean(KINDS[block.type]?.is_hat);
}

/** Whether a block at the top is no part of the program. @param {Blockly.Block} top */
export function isLoose(top) {
  return top.type !== 'program' && !isHat(top);
}

/** @param {Blockly.WorkspaceSvg} workspace @returns {import('./hats.js').TextItem[]} the blocks of the text's top level, in its order */
function itemsOf(workspace) {
  const topBlocks = topBlocksOf(workspace);
  const programBlocks = stackFrom(topBlocks.find((block) => block.type === 'program')?.getNextBlock() ?? null);
  const shownBlocks = SHOWN_BLOCKS.get(workspace) ?? { program: [], hats: new Map(), earlyDefs: new Set() };
  const indexOfId = new Map(shownBlocks.program.map((id, index) => [id, index]));
  const hatIds = [...shownBlocks.hats.keys()];
  const hats = topBlocks.filter(isHat).sort((a, b) => hatIds.indexOf(a.id) - hatIds.indexOf(b.id));
  return inTextOrder(programBlocks.map(itemOf), hats.map((hat) => {
    const { x, y } = hat.getRelativeToSurfaceXY();
    const blockCountBefore = isMoved(hat) ? null : shownBlocks.hats.get(hat.id)?.blockCountBefore ?? 0;
    if (blockCountBefore === null) return { ...itemOf(hat), x, y, gap: null };
    const isAtEnd = blockCountBefore === shownBlocks.program.length;
    const lastIndexBefore = programBlocks.findLastIndex(({ id }) => (indexOfId.get(id) ?? Infinity) < blockCountBefore);
    return { ...itemOf(hat), x, y, gap: isAtEnd ? programBlocks.length : lastIndexBefore + 1 };
  }), shownBlocks.earlyDefs);
}

/** Whether somebody has put a hat where it stands, since it was made. @param {Blockly.Block} hat */
function isMoved(hat) {
  const shownPlace = SHOWN_BLOCKS.get(hat.workspace)?.hats.get(hat.id);
  const { x, y } = hat.getRelativeToSurfaceXY();
  return !shownPlace || Math.abs(shownPlace.x - x) > 1 || Math.abs(shownPlace.y - y) > 1;
}

/** @param {Blockly.Block} block @returns {import('./hats.js').TextItem} */
function itemOf(block) {
  /** @type {string[]} */
  const ids = [];
  return { block: blockOf(block, ids), ids };
}

/** @param {Blockly.Block} top @returns {Form['loose'][number]} */
function stackOf(top) {
  return top.outputConnection ? { body: [], value: valueOf(top) } : { body: bodyOf(top, []), value: [] };
}

/** What a loose stack is, however it was written. @param {Blockly.Block} top */
function stackName(top) {
  return JSON.stringify(stackOf(top), ['body', 'value', 'kind', 'word', 'values', 'bodies', 'note']);
}

/** @typedef {Map<string, Blockly.utils.Coordinate[]>} StackPlaces where loose stacks stand, and hats that were moved, or stood last */

/**
 * Keeps where each loose stack stands and each hat that somebody moved, for when it is made anew.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {StackPlaces} stackPlaces
 */
export function keepPlaces(workspace, stackPlaces) {
  const topBlocks = topBlocksOf(workspace).filter(isLoose);
  for (const top of topBlocks) stackPlaces.set(stackName(top), []);
  for (const top of topBlocks) stackPlaces.get(stackName(top))?.push(top.getRelativeToSurfaceXY());
  const shownBlocks = SHOWN_BLOCKS.get(workspace);
  const hats = hatsOf(workspace);
  for (const [index, name] of hatNamesOf(hats).entries()) {
    const hat = /** @type {Blockly.Block} */ (hats[index]);
    if (isMoved(hat) || shownBlocks?.hats.get(hat.id)?.isMoved) stackPlaces.set(name, [hat.getRelativeToSurfaceXY()]);
    else stackPlaces.delete(name);
  }
}

/**
 * Those places that blocks may be put at again: what comes back, once it was gone, is put where it is seen.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {StackPlaces} stackPlaces
 * @returns {StackPlaces}
 */
export function knownPlaces(workspace, stackPlaces) {
  const { left: viewLeft, top: viewTop, width, height } = workspace.getMetricsManager().getViewMetrics(true);
  const view = new Blockly.utils.Rect(viewTop, viewTop + height - CORNER_UNITS, viewLeft, viewLeft + width - CORNER_UNITS);
  const presentNames = new Set([...hatNamesOf(hatsOf(workspace)), ...topBlocksOf(workspace).filter(isLoose).map((top) => stackName(top))]);
  return new Map([...stackPlaces].map(([name, places]) => [name, places.filter(({ x, y }) => presentNames.has(name) || view.contains(x, y))]));
}

/** @param {Blockly.WorkspaceSvg} workspace @returns {Blockly.Block[]} in the order of the text */
function hatsOf(workspace) {
  return itemsOf(workspace).flatMap(({ ids }) => workspace.getBlockById(ids[0] ?? '') ?? []).filter(isHat);
}

/** @param {Blockly.Block[]} hats in the order of the text @returns {string[]} a name for each: of its kind and word the how manieth it is */
function hatNamesOf(hats) {
  /** @type {Map<string, number>} */
  const counts = new Map();
  return hats.map((hat) => {
    const name = `${hat.type} ${hat.type === 'def' ? hat.getFieldValue('WORD') : ''}`;
    counts.set(name, (counts.get(name) ?? 0) + 1);
    return `${name} ${counts.get(name)}`;
  });
}

/** @param {Blockly.Block | undefined} block @returns {any} */
function dataOf(block) {
  try {
    return JSON.parse(block?.data ?? '{}') ?? {};
  } catch {
    return {};
  }
}

/** @param {Blockly.Block | null} first @returns {Blockly.Block[]} it and those that hang below it */
function stackFrom(first) {
  const blocks = [];
  for (let block = first; block; block = block.getNextBlock()) if (!block.isInsertionMarker()) blocks.push(block);
  return blocks;
}

/** @param {Blockly.Block | null} first @param {string[]} ids @returns {FormBlock[]} */
function bodyOf(first, ids) {
  return stackFrom(first).map((block) => blockOf(block, ids));
}

/** @param {Blockly.Block} block @param {string[]} ids @returns {FormBlock} */
function blockOf(block, ids) {
  ids.push(block.id);
  const data = dataOf(block);
  const firstInnerBlocks = block.inputList.filter((input) => /^B\d|^OTHERWISE/.test(input.name)).map((input) => input.connection?.targetBlock() ?? null);
  const word = String(wordOnBlock(block) ?? data.word ?? impliedWordOf(block.type)), values = valuesOf(block), note = block.getCommentText() ?? '';
  const linesData = data.was ?? {};
  const isNoteSame = word === linesData.word && note === linesData.note;
  return {
    kind: block.type,
    word,
    values,
    bodies: (isHat(block) ? [block.getNextBlock()] : firstInnerBlocks).map((first) => bodyOf(first, ids)),
    note,
    is_apart: Boolean(data.isApart),
    said: word === linesData.word ? data.said.map((/** @type {string} */ line, /** @type {number} */ lineIndex) => (lineOf(block, values, lineIndex) === linesData.lines[lineIndex] ? line : '')) : [],
    comment: isNoteSame ? data.comment : '',
    is_behind: Boolean(data.isBehind),
  };
}

/** What a line of a block is made of besides its word. @param {Blockly.Block} block @param {Value[]} values @param {number} lineIndex */
function lineOf(block, values, lineIndex) {
  return JSON.stringify(block.type === 'if' ? values[lineIndex] : values) ?? '';
}

/** Keeps what the lines of a block are in the text, as long as nobody changes them. @param {Blockly.Block} block @param {FormBlock} form */
function rememberLines(block, { word, is_apart, is_behind, said: oldLines = [], comment }) {
  const values = valuesOf(block);
  block.data = JSON.stringify({
    word, isApart: is_apart, isBehind: is_behind, said: oldLines, comment,
    was: { word: String(wordOnBlock(block) ?? word), note: block.getCommentText() ?? '', lines: oldLines.map((_, k) => lineOf(block, values, k)) },
  });
}

/** @param {Blockly.Block} block @returns {Value[]} what is in its places; of a DEF the names of its values */
function valuesOf(block) {
  if (block.type === 'def') return /** @type {any} */ (block).names().map((/** @type {string} */ name) => [['NAME', name]]);
  const places = block.inputList.filter((input) => /^V\d/.test(input.name));
  return places.map((input) => valueOf(input.connection?.targetBlock() ?? null));
}

/**
 * @param {Blockly.Block | null} outermost
 * @returns {Value} its parts in the order of a stack machine
 */
function valueOf(outermost) {
  /** @type {Value} */
  const parts = [];
  const pendingBlocks = [outermost];
  while (pendingBlocks.length) { // from the last part to the first
    const block = pendingBlocks.pop();
    if (!block || block.isInsertionMarker()) {
      parts.push(['NOTHING', '']);
      continue;
    }
    parts.push(partOfBlock(block));
    for (const input of block.inputList) if (input.connection) pendingBlocks.push(input.connection.targetBlock());
  }
  return parts.reverse();
}

/** @param {Blockly.Block} block @returns {[string, string]} */
function partOfBlock(block) {
  const field = /** @type {any} */ (block.getField('WORD'));
  const word = String(field?.textValue?.() ?? field?.getValue() ?? '');
  const part = KINDS[block.type]?.part;
  return part ? [part, word] : [word, ''];
}

/** @param {FormBlock[]} blocks @returns {string[]} they and those of their values, as `pieceOf` has them */
export function piecesIn(blocks) {
  return blocks.flatMap(({ kind, word, values }) => [pieceOf(kind, word), ...values.flatMap((value) => value.flatMap(([operation, operand]) => {
    const partKind = KIND_OF_PART.get(operation);
    return partKind ? pieceOf(partKind, operand || operation) : [];
  }))]);
}

// -- a form to blocks ------------------------------------------------------------------------------

/**
 * Replaces all blocks.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Form} form
 * @param {StackPlaces} stackPlaces where stacks are put that are known; others are put below the program
 * @returns {string[]} the ids of the blocks of the body, in the order of the text
 */
export function showForm(workspace, form, stackPlaces) {
  /** @type {string[]} */
  const ids = [];
  withoutEvents(() => {
    workspace.clear();
    /** @type {Blockly.BlockSvg[]} */
    const madeBlocks = [];
    const makeBlock = (/** @type {string} */ kind) => {
      const block = workspace.newBlock(kind);
      madeBlocks.push(block);
      return block;
    };
    const topBlocks = runAtOnce(makingSteps(form, makeBlock, ids));
    for (const block of madeBlocks) block.initSvg();
    for (const block of madeBlocks.reverse()) block.queueRender();
    Blockly.renderManagement.triggerQueuedRenders(workspace);
    placeTopBlocks(workspace, topBlocks, stackPlaces); // while they were drawn, blocks pushed each other
  });
  makeRoom(workspace);
  for (const [id, place] of SHOWN_BLOCKS.get(workspace)?.hats ?? []) {
    const { x, y } = workspace.getBlockById(id)?.getRelativeToSurfaceXY() ?? place;
    Object.assign(place, { x, y }); // nobody has moved it there
  }
  workspace.resizeContents();
  return ids;
}

/**
 * Replaces all blocks, to be looked at alone: the page goes on meanwhile.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Form} form
 */
export async function drawForm(workspace, form) {
  clearWorkspace(workspace);
  await runInSlices(drawingSteps(workspace, form), (slice) => withoutEvents(() => {
    slice();
    removeFromRenderQueue(workspace);
  }));
}

/** @param {Blockly.WorkspaceSvg} workspace @param {Form} form @returns {Generator<void, void>} */
function* drawingSteps(workspace, form) {
  const topBlocks = yield* makingSteps(form, (kind) => workspace.newBlock(kind), []);
  for (const block of workspace.getAllBlocks(false).reverse()) { // what is in a block before it
    if (!block.getParent()) removeFromRenderQueue(workspace);
    block.initSvg();
    block.renderEfficiently();
    yield;
  }
  placeTopBlocks(workspace, topBlocks, new Map());
}

/**
 * Blockly draws what it has queued at the next picture of the screen, all of it at once, unless the block
 * around it all is not begun: then it only takes it out of its queue.
 * @param {Blockly.WorkspaceSvg} workspace
 */
function removeFromRenderQueue(workspace) {
  Blockly.renderManagement.triggerQueuedRenders(workspace);
}

/** @param {Blockly.WorkspaceSvg} workspace */
export function clearWorkspace(workspace) {
  withoutEvents(() => workspace.clear());
}

/** What is done is not reported, and nothing of it is refused. @param {() => void} change */
function withoutEvents(change) {
  Blockly.Events.disable();
  LenientConnectionChecker.isLenient = true;
  try {
    change();
  } finally {
    LenientConnectionChecker.isLenient = false;
    Blockly.Events.enable();
  }
}

/** @typedef {{program: Blockly.BlockSvg, hats: [Blockly.BlockSvg, number][], loose: (Blockly.BlockSvg | null)[]}} TopBlocks each hat with how many blocks of the program stand before it in the text */

/**
 * Makes the blocks of a form, which nobody sees yet.
 * @param {Form} form
 * @param {MakeBlock} makeBlock
 * @param {string[]} ids of the blocks of the body are added
 * @returns {Generator<void, TopBlocks>}
 */
function* makingSteps(form, makeBlock, ids) {
  const program = makeBlock('program');
  program.setFieldValue(form.start || 'SI', 'WORD');
  program.data = JSON.stringify({ isUnsaid: !form.start, isOneLine: form.is_one_line });
  if (form.note) program.setCommentText(form.note);
  /** @type {TopBlocks['hats']} */
  const hats = [];
  /** @type {string[]} */
  const programIds = [];
  let aboveConnection = program.nextConnection;
  for (const formBlock of form.body) {
    const isInProgram = !KINDS[formBlock.kind]?.is_hat;
    const block = yield* hangingSteps([formBlock], isInProgram ? aboveConnection : null, makeBlock, ids);
    if (!block) continue;
    if (isInProgram) {
      programIds.push(block.id);
      aboveConnection = block.nextConnection;
    } else hats.push([block, programIds.length]);
  }
  const looseBlocks = [];
  for (const { body, value } of form.loose) looseBlocks.push(body.length ? yield* hangingSteps(body, null, makeBlock, []) : makeValueBlock(value, makeBlock));
  SHOWN_BLOCKS.set(program.workspace, { program: programIds, hats: new Map(), earlyDefs: findEarlyDefs(form.body) });
  return { program, hats, loose: looseBlocks };
}

/**
 * Puts the program into the corner, hats beside it, and loose stacks below it; what is known to have stood somewhere, there.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {TopBlocks} tops
 * @param {StackPlaces} stackPlaces
 */
function placeTopBlocks(workspace, { program, hats, loose }, stackPlaces) {
  const placesLeft = new Map([...stackPlaces].map(([name, places]) => [name, [...places]]));
  const shownBlocks = SHOWN_BLOCKS.get(workspace);
  program.moveTo(new Blockly.utils.Coordinate(CORNER_UNITS, CORNER_UNITS));
  for (const [index, name] of hatNamesOf(hats.map(([hat]) => hat)).entries()) {
    const [hat, blockCountBefore] = /** @type {TopBlocks['hats'][number]} */ (hats[index]);
    const knownPlace = placesLeft.get(name)?.shift();
    if (knownPlace) hat.moveTo(knownPlace);
    const { x, y } = hat.getRelativeToSurfaceXY();
    shownBlocks?.hats.set(hat.id, { blockCountBefore, x, y, isMoved: Boolean(knownPlace) });
  }
  lineUp(workspace, program, hats.map(([hat]) => hat).filter((hat) => !shownBlocks?.hats.get(hat.id)?.isMoved));
  const boxes = [program, ...hats.map(([hat]) => hat)].map((block) => block.getBoundingRectangle()).filter((box) => box.left < CORNER_UNITS + STACK_GAP);
  let y = Math.max(...boxes.map(({ bottom }) => bottom)) + STACK_GAP;
  for (const block of loose) {
    if (!block) continue;
    const knownPlace = placesLeft.get(stackName(block))?.shift();
    block.moveTo(knownPlace ?? new Blockly.utils.Coordinate(CORNER_UNITS, y));
    if (!knownPlace) y += block.getHeightWidth().height + STACK_GAP;
  }
}

/**
 * Whether hats are seen beside the program.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Blockly.BlockSvg} program
 * @param {Blockly.BlockSvg[]} hats
 */
function hasRoomBeside(workspace, program, hats) {
  const mostWidth = Math.max(...hats.map((hat) => hat.getHeightWidth().width));
  return program.getBoundingRectangle().right + STACK_GAP + mostWidth <= workspace.getMetricsManager().getViewMetrics(true).width;
}

/**
 * Puts hats one below the other, beside the program where they are seen there, else below it.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Blockly.BlockSvg} program
 * @param {Blockly.BlockSvg[]} hats
 */
function lineUp(workspace, program, hats) {
  const { right, bottom } = program.getBoundingRectangle();
  const isBeside = hasRoomBeside(workspace, program, hats);
  let y = isBeside ? CORNER_UNITS : bottom + STACK_GAP;
  for (const hat of hats) {
    hat.moveTo(new Blockly.utils.Coordinate(isBeside ? right + STACK_GAP : CORNER_UNITS, y));
    y += hat.getHeightWidth().height + STACK_GAP;
    const place = SHOWN_BLOCKS.get(workspace)?.hats.get(hat.id);
    if (place) Object.assign(place, { x: hat.getRelativeToSurfaceXY().x, y: hat.getRelativeToSurfaceXY().y });
  }
}

/**
 * Has no hat stand on the program or on another hat: those that nobody has moved are lined up anew, one that
 * somebody drops there goes below.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {boolean} [isResized] hats that were beside the program may be out of sight now
 */
export function makeRoom(workspace, isResized = false) {
  const program = /** @type {Blockly.BlockSvg | undefined} */ (workspace.getBlocksByType('program')[0]);
  const hats = workspace.getTopBlocks(true).filter(isHat);
  const [movedHats, unmovedHats] = [true, false].map((isMovedWanted) => hats.filter((hat) => isMovedWanted === Boolean(isMoved(hat) || SHOWN_BLOCKS.get(workspace)?.hats.get(hat.id)?.isMoved)));
  if (!program || !movedHats || !unmovedHats) return;
  const obstacleOf = (/** @type {Blockly.BlockSvg} */ hat) => [program, ...hats].find((other) =>
    other !== hat && other.getBoundingRectangle().intersects(hat.getBoundingRectangle()));
  const isBeside = unmovedHats[0] && unmovedHats[0].getRelativeToSurfaceXY().x > CORNER_UNITS;
  withoutEvents(() => {
    if (unmovedHats.some(obstacleOf) || (isResized && unmovedHats.length && isBeside !== hasRoomBeside(workspace, program, unmovedHats))) lineUp(workspace, program, unmovedHats);
    for (const hat of movedHats) {
      let obstacle = obstacleOf(hat);
      for (let triesLeft = hats.length + 1; triesLeft && obstacle; triesLeft -= 1, obstacle = obstacleOf(hat)) {
        hat.moveTo(new Blockly.utils.Coordinate(hat.getRelativeToSurfaceXY().x, obstacle.getBoundingRectangle().bottom + STACK_GAP));
      }
    }
  });
}

/**
 * Puts a new block that is not joined where it covers no other one; one that is joined covers no loose stack, though its own has grown.
 * @param {Blockly.BlockSvg} block
 * @param {Blockly.WorkspaceSvg} workspace
 */
export function makeRoomFor(block, workspace) {
  Blockly.renderManagement.triggerQueuedRenders(workspace); // it has no size before
  if (block.getParent()) makeRoom(workspace);
  else moveToFreePlace(block, workspace);
  const stacks = workspace.getTopBlocks(false), boxes = stacks.filter((stack) => !isLoose(stack)).map((stack) => stack.getBoundingRectangle());
  for (const stack of stacks.filter(isLoose)) if (boxes.some((box) => box.intersects(stack.getBoundingRectangle()))) moveToFreePlace(stack, workspace);
}

/** As high as it can be seen whole beside or below the others. @param {Blockly.BlockSvg} block @param {Blockly.WorkspaceSvg} workspace */
function moveToFreePlace(block, workspace) {
  const { width, height } = block.getHeightWidth(), view = workspace.getMetricsManager().getViewMetrics(true);
  const boxes = workspace.getTopBlocks(false).filter((other) => other !== block).map((other) => other.getBoundingRectangle());
  const places = boxes.flatMap(({ left, top, right, bottom }) => [{ x: right + STACK_GAP, y: top }, { x: left, y: bottom + STACK_GAP }])
    .filter(({ x, y }) => !boxes.some((box) => box.intersects(new Blockly.utils.Rect(y, y + height, x, x + width))));
  const isCut = (/** @type {{x: number}} */ { x }) => x + width > view.left + view.width;
  places.sort((a, b) => Number(isCut(a)) - Number(isCut(b)) || a.y - b.y || a.x - b.x);
  if (places[0]) block.moveTo(new Blockly.utils.Coordinate(places[0].x, places[0].y));
}

/** @typedef {(kind: string) => Blockly.BlockSvg} MakeBlock */

/**
 * Hangs blocks one below the other.
 * @param {FormBlock[]} blocks
 * @param {Blockly.Connection | null} connection
 * @param {MakeBlock} makeBlock
 * @param {string[]} ids
 * @returns {Generator<void, Blockly.BlockSvg | null>} the first
 */
function* hangingSteps(blocks, connection, makeBlock, ids) {
  let firstBlock = null;
  let connectionAbove = connection;
  for (const formBlock of blocks) {
    const block = makeBlock(formBlock.kind);
    firstBlock ??= block;
    ids.push(block.id);
    if (formBlock.kind === 'if') {
      /** @type {any} */ (block).setArms(formBlock.values.length, formBlock.bodies.length > formBlock.values.length);
    }
    if (formBlock.kind === 'def') /** @type {any} */ (block).setNames(formBlock.values.map((value) => value[0]?.[1] ?? ''));
    if (formBlock.kind === 'call') /** @type {any} */ (block).setCount(formBlock.values.length);
    const [word, unit] = block.getField('UNIT') ? formBlock.word.split(' ') : [formBlock.word];
    if (block.getField('WORD')) block.setFieldValue(word, 'WORD');
    if (unit) block.setFieldValue(WAY_UNIT, 'UNIT');
    if (formBlock.note) block.setCommentText(formBlock.note);
    formBlock.values.forEach((value, index) => putValue(value, block.getInput(`V${index}`)?.connection ?? null, makeBlock));
    for (const [index, body] of formBlock.bodies.entries()) {
      const input = block.getInput(`B${index}`) ?? block.getInput('OTHERWISE');
      yield* hangingSteps(body, isHat(block) ? block.nextConnection : input?.connection ?? null, makeBlock, ids);
    }
    rememberLines(block, formBlock);
    if (block.previousConnection) connectionAbove?.connect(block.previousConnection);
    connectionAbove = block.nextConnection;
    yield;
  }
  return firstBlock;
}

/**
 * Puts a value into its place: a plain number or a yes or no is the one that is there anyway.
 * @param {Value} value
 * @param {Blockly.Connection | null} connection
 * @param {MakeBlock} makeBlock
 */
function putValue(value, connection, makeBlock) {
  if (!connection) return;
  const [operation = 'NOTHING', text = ''] = value[0] ?? [];
  if (value.length === 1 && operation === 'NUMBER') {
    connection.setShadowState({ type: 'number', fields: { WORD: Number(text) } });
  } else if (value.length === 1 && (operation === 'TRUE' || operation === 'FALSE')) {
    connection.setShadowState({ type: 'truth', fields: { WORD: operation } });
  } else {
    const block = makeValueBlock(value, makeBlock);
    if (block?.outputConnection) connection.connect(block.outputConnection);
  }
}

/**
 * @param {Value} value
 * @param {MakeBlock} makeBlock
 * @returns {Blockly.BlockSvg | null}
 */
function makeValueBlock(value, makeBlock) {
  /** @type {Value[]} */
  const plainValues = []; // beside the blocks: what a plain value is, to be put as such
  /** @type {(Blockly.BlockSvg | null)[]} */
  const blockStack = [];
  value.forEach((part, index) => {
    const [operation, text] = part;
    const kind = KIND_OF_PART.get(operation);
    if (!kind) {
      blockStack.push(null);
      plainValues.push([]);
      return;
    }
    const isPlain = (operation === 'NUMBER' || operation === 'TRUE' || operation === 'FALSE') && index < value.length - 1;
    if (isPlain) {
      blockStack.push(null);
      plainValues.push([part]);
      return;
    }
    const block = makeBlock(kind);
    if (block.getField('WORD')) block.setFieldValue(text || operation, 'WORD');
    const valueCount = KINDS[kind]?.values.length ?? 0;
    for (let index = valueCount - 1; index >= 0; index -= 1) {
      const innerBlock = blockStack.pop() ?? null;
      const plainValue = plainValues.pop() ?? [];
      const connection = block.getInput(`V${index}`)?.connection ?? null;
      if (innerBlock?.outputConnection) connection?.connect(innerBlock.outputConnection);
      else if (plainValue.length) putValue(plainValue, connection, makeBlock);
    }
    blockStack.push(block);
    plainValues.push([]);
  });
  return blockStack.pop() ?? null;
}
