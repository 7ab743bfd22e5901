// Blocks of the page and their form as Python knows it (`studio/block_form.py`), both ways.
//
// Goes along the blocks with lists of its own: a long program must not exhaust the stack.

import * as Blockly from 'blockly/core';
import { WAY } from './fields.js';
import { wordOf, wordOn } from './places.js';
import { Checker } from './shapes.js';
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
      values: block.inputList.filter((input) => /^V\d/.test(input.name)).map((input) => valueOf(input.connection?.targetBlock() ?? null)),
      bodies: block.inputList.filter((input) => /^B\d|^OTHERWISE/.test(input.name))
        .map((input) => bodyOf(input.connection?.targetBlock() ?? null, ids)),
      note: block.getCommentText() ?? '',
      is_apart: Boolean(kept.isApart),
    });
  }
  return found;
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
  /** @type {Blockly.BlockSvg[]} */
  const made = [];
  Blockly.Events.disable();
  Checker.isLenient = true;
  try {
    workspace.clear();
    const make = (/** @type {string} */ kind) => {
      const block = workspace.newBlock(kind);
      made.push(block);
      return block;
    };
    const program = make('program');
    program.setFieldValue(form.start || 'SI', 'WORD');
    program.data = JSON.stringify({ isUnsaid: !form.start, isOneLine: form.is_one_line });
    if (form.note) program.setCommentText(form.note);
    hang(form.body, program.nextConnection, make, ids);
    const loose = form.loose.map((stack) => (stack.body.length ? hang(stack.body, null, make, []) : valueBlock(stack.value, make)));
    for (const block of made) block.initSvg();
    for (const block of made.reverse()) block.queueRender();
    Blockly.renderManagement.triggerQueuedRenders(workspace);
    const left = new Map([...stood].map(([name, places]) => [name, [...places]]));
    const { Coordinate } = Blockly.utils; // while they were drawn, blocks pushed each other
    program.moveTo(new Coordinate(CORNER, CORNER));
    let y = CORNER + program.getHeightWidth().height + DISTANCE;
    for (const block of loose) {
      if (!block) continue;
      const known = left.get(JSON.stringify(stackOf(block)))?.shift();
      block.moveTo(known ?? new Coordinate(CORNER, y));
      if (!known) y += block.getHeightWidth().height + DISTANCE;
    }
  } finally {
    Checker.isLenient = false;
    Blockly.Events.enable();
  }
  workspace.resizeContents();
  return ids;
}

/** @typedef {(kind: string) => Blockly.BlockSvg} Make */

/**
 * Hangs blocks one below the other.
 * @param {FormBlock[]} blocks
 * @param {Blockly.Connection | null} place
 * @param {Make} make
 * @param {string[]} ids
 * @returns {Blockly.BlockSvg | null} the first
 */
function hang(blocks, place, make, ids) {
  let first = null;
  let above = place;
  for (const each of blocks) {
    const block = make(each.kind);
    first ??= block;
    ids.push(block.id);
    if (each.kind === 'if') {
      /** @type {any} */ (block).setArms(each.values.length, each.bodies.length > each.values.length);
    }
    const [word, unit] = block.getField('UNIT') ? each.word.split(' ') : [each.word];
    if (block.getField('WORD')) block.setFieldValue(word, 'WORD');
    if (unit) block.setFieldValue(WAY, 'UNIT');
    block.data = JSON.stringify({ word: each.word, isApart: each.is_apart });
    if (each.note) block.setCommentText(each.note);
    each.values.forEach((value, k) => put(value, block.getInput(`V${k}`)?.connection ?? null, make));
    each.bodies.forEach((body, k) => {
      const input = block.getInput(`B${k}`) ?? block.getInput('OTHERWISE');
      hang(body, input?.connection ?? null, make, ids);
    });
    if (block.previousConnection) above?.connect(block.previousConnection);
    above = block.nextConnection;
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
