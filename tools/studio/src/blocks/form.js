// Blocks of the page and their form as Python knows it (`studio/block_form.py`), both ways.
//
// Goes along the blocks with lists of its own: a long program must not exhaust the stack.

import * as Blockly from 'blockly/core';
import { WAY } from './fields.js';
import { wordOf, wordOn } from './places.js';
import { Checker } from './shapes.js';
import { atOnce, slowly } from './slices.js';
import { KINDS } from '../page/words.js';

/** @typedef {[number, number, number, number]} Range line and column, from 1, and those of the end */
/** @typedef {[string, string][]} Value */
/**
 * @typedef {object} FormBlock
 * @property {string} kind
 * @property {string} word
 * @property {Value[]} values
 * @property {FormBlock[][]} bodies
 * @property {string} note
 * @property {boolean} is_apart
 * @property {Range} [place]
 */
/** @typedef {{start: string, note: string, is_one_line: boolean, body: FormBlock[], loose: {body: FormBlock[], value: Value}[]}} Form */

/** The kind of block of each part of an expression. */
const KIND_OF = new Map(Object.entries(KINDS).flatMap(([kind, { part, words }]) => [part, ...words].map((each) => [each, kind])));
const CORNER = 32; // where the program begins
const DISTANCE = 64; // between stacks: Blockly pushes what is nearer than it would join

// -- blocks to their form --------------------------------------------------------------------------

/**
 * @param {Blockly.WorkspaceSvg} workspace
 * @returns {{form: Form, ids: string[]}} `ids` of the blocks of the body, in the order of the text
 */
export function formOf(workspace) {
  /** @type {string[]} */
  const ids = [];
  const tops = workspace.getTopBlocks(true).filter((block) => !block.isInsertionMarker());
  const program = tops.find((block) => block.type === 'program');
  const kept = dataOf(program);
  const word = String(program?.getFieldValue('WORD') ?? 'SI');
  return {
    form: {
      start: kept.isUnsaid && word === 'SI' ? '' : word,
      note: program?.getCommentText() ?? '',
      is_one_line: Boolean(kept.isOneLine),
      body: bodyOf(program?.getNextBlock() ?? null, ids),
      loose: tops.filter((block) => block !== program).map(stackOf),
    },
    ids,
  };
}

/** @param {Blockly.Block} top @returns {Form['loose'][number]} */
function stackOf(top) {
  return top.outputConnection ? { body: [], value: valueOf(top) } : { body: bodyOf(top, []), value: [] };
}

/** @typedef {Map<string, Blockly.utils.Coordinate[]>} Stood where loose stacks stand, or stood last */

/**
 * Keeps where each loose stack stands, for when it is made anew.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Stood} stood
 */
export function keepPlaces(workspace, stood) {
  const tops = workspace.getTopBlocks(true).filter((top) => top.type !== 'program');
  for (const top of tops) stood.set(JSON.stringify(stackOf(top)), []);
  for (const top of tops) stood.get(JSON.stringify(stackOf(top)))?.push(top.getRelativeToSurfaceXY());
}

/** @param {Blockly.Block | undefined} block @returns {any} */
function dataOf(block) {
  try {
    return JSON.parse(block?.data ?? '{}') ?? {};
  } catch {
    return {};
  }
}

/**
 * @param {Blockly.Block | null} first
 * @param {string[]} ids
 * @returns {FormBlock[]}
 */
function bodyOf(first, ids) {
  const found = [];
  for (let block = first; block; block = block.getNextBlock()) {
    if (block.isInsertionMarker()) continue;
    ids.push(block.id);
    const kept = dataOf(block);
    found.push({
      kind: block.type,
      word: String(wordOn(block) ?? kept.word ?? wordOf(block.type)),
      values: valuesOf(block),
      bodies: block.inputList.filter((input) => /^B\d|^OTHERWISE/.test(input.name))
        .map((input) => bodyOf(input.connection?.targetBlock() ?? null, ids)),
      note: block.getCommentText() ?? '',
      is_apart: Boolean(kept.isApart),
    });
  }
  return found;
}

/** @param {Blockly.Block} block @returns {Value[]} what is in its places; of a DEF the names of its values */
function valuesOf(block) {
  if (block.type === 'def') return /** @type {any} */ (block).names().map((/** @type {string} */ name) => [['NAME', name]]);
  const places = block.inputList.filter((input) => /^V\d/.test(input.name));
  return places.map((input) => valueOf(input.connection?.targetBlock() ?? null));
}

/**
 * @param {Blockly.Block | null} whole
 * @returns {Value} its parts in the order of a stack machine
 */
function valueOf(whole) {
  /** @type {Value} */
  const parts = [];
  const waiting = [whole];
  while (waiting.length) { // from the last part to the first
    const block = waiting.pop();
    if (!block || block.isInsertionMarker()) {
      parts.push(['NOTHING', '']);
      continue;
    }
    parts.push(partOf(block));
    for (const input of block.inputList) if (input.connection) waiting.push(input.connection.targetBlock());
  }
  return parts.reverse();
}

/** @param {Blockly.Block} block @returns {[string, string]} */
function partOf(block) {
  const field = /** @type {any} */ (block.getField('WORD'));
  const word = String(field?.written?.() ?? field?.getValue() ?? '');
  const part = KINDS[block.type]?.part;
  return part ? [part, word] : [word, ''];
}

// -- a form to blocks ------------------------------------------------------------------------------

/**
 * Replaces all blocks.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Form} form
 * @param {Stood} stood where stacks are put that are known; others are put below the program
 * @returns {string[]} the ids of the blocks of the body, in the order of the text
 */
export function showForm(workspace, form, stood) {
  /** @type {string[]} */
  const ids = [];
  quietly(() => {
    workspace.clear();
    /** @type {Blockly.BlockSvg[]} */
    const made = [];
    const make = (/** @type {string} */ kind) => {
      const block = workspace.newBlock(kind);
      made.push(block);
      return block;
    };
    const tops = atOnce(making(form, make, ids));
    for (const block of made) block.initSvg();
    for (const block of made.reverse()) block.queueRender();
    Blockly.renderManagement.triggerQueuedRenders(workspace);
    stand(tops, stood); // while they were drawn, blocks pushed each other
  });
  workspace.resizeContents();
  return ids;
}

/**
 * Replaces all blocks, to be looked at alone: the page goes on meanwhile.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Form} form
 */
export async function drawForm(workspace, form) {
  clear(workspace);
  await slowly(drawing(workspace, form), (slice) => quietly(() => {
    slice();
    leaveQueue(workspace);
  }));
}

/** @param {Blockly.WorkspaceSvg} workspace @param {Form} form @returns {Generator<void, void>} */
function* drawing(workspace, form) {
  const tops = yield* making(form, (kind) => workspace.newBlock(kind), []);
  for (const block of workspace.getAllBlocks(false).reverse()) { // what is in a block before it
    if (!block.getParent()) leaveQueue(workspace);
    block.initSvg();
    block.renderEfficiently();
    yield;
  }
  stand(tops, new Map());
}

/**
 * Blockly draws what it has queued at the next picture of the screen, all of it at once, unless the block
 * around it all is not begun: then it only takes it out of its queue.
 * @param {Blockly.WorkspaceSvg} workspace
 */
function leaveQueue(workspace) {
  Blockly.renderManagement.triggerQueuedRenders(workspace);
}

/** @param {Blockly.WorkspaceSvg} workspace */
export function clear(workspace) {
  quietly(() => workspace.clear());
}

/** Nothing is told of what is done, and nothing of it refused. @param {() => void} act */
function quietly(act) {
  Blockly.Events.disable();
  Checker.isLenient = true;
  try {
    act();
  } finally {
    Checker.isLenient = false;
    Blockly.Events.enable();
  }
}

/**
 * Makes the blocks of a form, which nobody sees yet.
 * @param {Form} form
 * @param {Make} make
 * @param {string[]} ids of the blocks of the body are added
 * @returns {Generator<void, (Blockly.BlockSvg | null)[]>} the program, and the loose ones
 */
function* making(form, make, ids) {
  const program = make('program');
  program.setFieldValue(form.start || 'SI', 'WORD');
  program.data = JSON.stringify({ isUnsaid: !form.start, isOneLine: form.is_one_line });
  if (form.note) program.setCommentText(form.note);
  yield* hang(form.body, program.nextConnection, make, ids);
  /** @type {(Blockly.BlockSvg | null)[]} */
  const tops = [program];
  for (const { body, value } of form.loose) tops.push(body.length ? yield* hang(body, null, make, []) : valueBlock(value, make));
  return tops;
}

/** Puts the program into the corner, and loose stacks where they stood, or below it. @param {(Blockly.BlockSvg | null)[]} tops @param {Stood} stood */
function stand([program, ...loose], stood) {
  const left = new Map([...stood].map(([name, places]) => [name, [...places]]));
  const { Coordinate } = Blockly.utils;
  program?.moveTo(new Coordinate(CORNER, CORNER));
  let y = CORNER + (program?.getHeightWidth().height ?? 0) + DISTANCE;
  for (const block of loose) {
    if (!block) continue;
    const known = left.get(JSON.stringify(stackOf(block)))?.shift();
    block.moveTo(known ?? new Coordinate(CORNER, y));
    if (!known) y += block.getHeightWidth().height + DISTANCE;
  }
}

/** @typedef {(kind: string) => Blockly.BlockSvg} Make */

/**
 * Hangs blocks one below the other.
 * @param {FormBlock[]} blocks
 * @param {Blockly.Connection | null} place
 * @param {Make} make
 * @param {string[]} ids
 * @returns {Generator<void, Blockly.BlockSvg | null>} the first
 */
function* hang(blocks, place, make, ids) {
  let first = null;
  let above = place;
  for (const each of blocks) {
    const block = make(each.kind);
    first ??= block;
    ids.push(block.id);
    if (each.kind === 'if') {
      /** @type {any} */ (block).setArms(each.values.length, each.bodies.length > each.values.length);
    }
    if (each.kind === 'def') /** @type {any} */ (block).setNames(each.values.map((value) => value[0]?.[1] ?? ''));
    if (each.kind === 'call') /** @type {any} */ (block).setCount(each.values.length);
    const [word, unit] = block.getField('UNIT') ? each.word.split(' ') : [each.word];
    if (block.getField('WORD')) block.setFieldValue(word, 'WORD');
    if (unit) block.setFieldValue(WAY, 'UNIT');
    block.data = JSON.stringify({ word: each.word, isApart: each.is_apart });
    if (each.note) block.setCommentText(each.note);
    each.values.forEach((value, k) => put(value, block.getInput(`V${k}`)?.connection ?? null, make));
    for (const [k, body] of each.bodies.entries()) {
      const input = block.getInput(`B${k}`) ?? block.getInput('OTHERWISE');
      yield* hang(body, input?.connection ?? null, make, ids);
    }
    if (block.previousConnection) above?.connect(block.previousConnection);
    above = block.nextConnection;
    yield;
  }
  return first;
}

/**
 * Puts a value into its place: a plain number or a yes or no is the one that is there anyway.
 * @param {Value} value
 * @param {Blockly.Connection | null} place
 * @param {Make} make
 */
function put(value, place, make) {
  if (!place) return;
  const [op = 'NOTHING', text = ''] = value[0] ?? [];
  if (value.length === 1 && op === 'NUMBER') {
    place.setShadowState({ type: 'number', fields: { WORD: Number(text) } });
  } else if (value.length === 1 && (op === 'TRUE' || op === 'FALSE')) {
    place.setShadowState({ type: 'truth', fields: { WORD: op } });
  } else {
    const block = valueBlock(value, make);
    if (block?.outputConnection) place.connect(block.outputConnection);
  }
}

/**
 * @param {Value} value
 * @param {Make} make
 * @returns {Blockly.BlockSvg | null}
 */
function valueBlock(value, make) {
  /** @type {Value[]} */
  const plain = []; // beside the blocks: what a plain value is, to be put as such
  /** @type {(Blockly.BlockSvg | null)[]} */
  const stack = [];
  value.forEach((part, k) => {
    const [op, text] = part;
    const kind = KIND_OF.get(op);
    if (!kind) {
      stack.push(null);
      plain.push([]);
      return;
    }
    const isPlain = (op === 'NUMBER' || op === 'TRUE' || op === 'FALSE') && k < value.length - 1;
    if (isPlain) {
      stack.push(null);
      plain.push([part]);
      return;
    }
    const block = make(kind);
    if (block.getField('WORD')) block.setFieldValue(text || op, 'WORD');
    const count = KINDS[kind]?.values.length ?? 0;
    for (let index = count - 1; index >= 0; index -= 1) {
      const inner = stack.pop() ?? null;
      const itself = plain.pop() ?? [];
      const place = block.getInput(`V${index}`)?.connection ?? null;
      if (inner?.outputConnection) place?.connect(inner.outputConnection);
      else if (itself.length) put(itself, place, make);
    }
    stack.push(block);
    plain.push([]);
  });
  return stack.pop() ?? null;
}
