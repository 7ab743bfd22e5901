// Blocks of the page and their form as Python knows it (`studio/block_form.py`), both ways.
//
// Goes along the blocks with lists of its own: a long program must not exhaust the stack.

import * as Blockly from 'blockly/core';
import { WAY } from './fields.js';
import { calledEarly, inTextOrder } from './hats.js';
import { wordOf, wordOn } from './places.js';
import { Checker } from './shapes.js';
import { atOnce, slowly } from './slices.js';
import { KINDS, pieceOf } from '../page/words.js';

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
 * @property {string[]} [said] what its lines were; one is empty that somebody has changed
 * @property {string} [comment] what its note was, or of a comment itself
 * @property {boolean} [is_behind] the end of a block, or an arm
 */
/** @typedef {{start: string, note: string, is_one_line: boolean, body: FormBlock[], loose: {body: FormBlock[], value: Value}[]}} Form */

/** The kind of block of each part of an expression. */
const KIND_OF = new Map(Object.entries(KINDS).flatMap(([kind, { part, words }]) => [part, ...words].map((each) => [each, kind])));
const CORNER = 32; // where the program begins
const DISTANCE = 64; // between stacks: Blockly pushes what is nearer than it would join

/**
 * What is known of blocks since they were made of a text.
 * @typedef {object} Shown
 * @property {string[]} program ids of its blocks
 * @property {Map<string, {before: number, x: number, y: number, isOwn: boolean}>} hats by their ids in the order of
 *   the text: so many blocks of the program stand before it, where it was put, and whether somebody had moved it
 * @property {Set<string>} excused
 */
/** @type {WeakMap<Blockly.Workspace, Shown>} */
const SHOWN = new WeakMap();

// -- blocks to their form --------------------------------------------------------------------------

/**
 * @param {Blockly.WorkspaceSvg} workspace
 * @returns {{form: Form, ids: string[]}} `ids` of the blocks of the body, in the order of the text
 */
export function formOf(workspace) {
  const tops = topsOf(workspace);
  const program = tops.find((block) => block.type === 'program');
  const items = itemsOf(workspace);
  const kept = dataOf(program);
  const word = String(program?.getFieldValue('WORD') ?? 'SI');
  return {
    form: {
      start: kept.isUnsaid && word === 'SI' ? '' : word,
      note: program?.getCommentText() ?? '',
      is_one_line: Boolean(kept.isOneLine),
      body: items.map(({ block }) => block),
      loose: tops.filter(isLoose).map(stackOf),
    },
    ids: items.flatMap(({ ids }) => ids),
  };
}

/**
 * A program of one block and what is in it, with the words that it may use; of a value one that shows it.
 * @param {Blockly.Block} block
 * @returns {Form}
 */
export function formOfOne(block) {
  const tops = topsOf(/** @type {Blockly.WorkspaceSvg} */ (block.workspace));
  const words = tops.filter((top) => top.type === 'def' && top !== block).map((top) => blockOf(top, []));
  const shown = { kind: 'show', word: 'SHOW', values: [valueOf(block)], bodies: [], note: '', is_apart: false };
  const begins = block.type === 'program' || isHat(block);
  const own = block.outputConnection ? [shown] : begins ? bodyOf(block.getNextBlock(), []) : [blockOf(block, [])];
  return { start: 'SI', note: '', is_one_line: false, body: [...words, ...own], loose: [] };
}

/** @param {Blockly.WorkspaceSvg} workspace */
function topsOf(workspace) {
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

/** @param {Blockly.WorkspaceSvg} workspace @returns {import('./hats.js').Item[]} the blocks of the text's top level, in its order */
function itemsOf(workspace) {
  const tops = topsOf(workspace);
  const program = stackFrom(tops.find((block) => block.type === 'program')?.getNextBlock() ?? null);
  const shown = SHOWN.get(workspace) ?? { program: [], hats: new Map(), excused: new Set() };
  const numbers = new Map(shown.program.map((id, k) => [id, k]));
  const order = [...shown.hats.keys()];
  const hats = tops.filter(isHat).sort((a, b) => order.indexOf(a.id) - order.indexOf(b.id));
  return inTextOrder(program.map(itemOf), hats.map((hat) => {
    const { x, y } = hat.getRelativeToSurfaceXY();
    const before = isMoved(hat) ? null : shown.hats.get(hat.id)?.before ?? 0;
    if (before === null) return { ...itemOf(hat), x, y, gap: null };
    const isLast = before === shown.program.length;
    const above = program.findLastIndex(({ id }) => (numbers.get(id) ?? Infinity) < before);
    return { ...itemOf(hat), x, y, gap: isLast ? program.length : above + 1 };
  }), shown.excused);
}

/** Whether somebody has put a hat where it stands, since it was made. @param {Blockly.Block} hat */
function isMoved(hat) {
  const put = SHOWN.get(hat.workspace)?.hats.get(hat.id);
  const { x, y } = hat.getRelativeToSurfaceXY();
  return !put || Math.abs(put.x - x) > 1 || Math.abs(put.y - y) > 1;
}

/** @param {Blockly.Block} block @returns {import('./hats.js').Item} */
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
function namedAs(top) {
  return JSON.stringify(stackOf(top), ['body', 'value', 'kind', 'word', 'values', 'bodies', 'note']);
}

/** @typedef {Map<string, Blockly.utils.Coordinate[]>} Stood where loose stacks stand, and hats that were moved, or stood last */

/**
 * Keeps where each loose stack stands and each hat that somebody moved, for when it is made anew.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Stood} stood
 */
export function keepPlaces(workspace, stood) {
  const tops = topsOf(workspace).filter(isLoose);
  for (const top of tops) stood.set(namedAs(top), []);
  for (const top of tops) stood.get(namedAs(top))?.push(top.getRelativeToSurfaceXY());
  const shown = SHOWN.get(workspace);
  const hats = hatsOf(workspace);
  for (const [k, name] of namesOf(hats).entries()) {
    const hat = /** @type {Blockly.Block} */ (hats[k]);
    if (isMoved(hat) || shown?.hats.get(hat.id)?.isOwn) stood.set(name, [hat.getRelativeToSurfaceXY()]);
    else stood.delete(name);
  }
}

/**
 * Those places that blocks may be put at again: what comes back, once it was gone, is put where it is seen.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Stood} stood
 * @returns {Stood}
 */
export function knownPlaces(workspace, stood) {
  const { left, top, width, height } = workspace.getMetricsManager().getViewMetrics(true);
  const view = new Blockly.utils.Rect(top, top + height - CORNER, left, left + width - CORNER);
  const here = new Set([...namesOf(hatsOf(workspace)), ...topsOf(workspace).filter(isLoose).map((each) => namedAs(each))]);
  return new Map([...stood].map(([name, places]) => [name, places.filter(({ x, y }) => here.has(name) || view.contains(x, y))]));
}

/** @param {Blockly.WorkspaceSvg} workspace @returns {Blockly.Block[]} in the order of the text */
function hatsOf(workspace) {
  return itemsOf(workspace).flatMap(({ ids }) => workspace.getBlockById(ids[0] ?? '') ?? []).filter(isHat);
}

/** @param {Blockly.Block[]} hats in the order of the text @returns {string[]} a name for each: of its kind and word the how manieth it is */
function namesOf(hats) {
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
  const found = [];
  for (let block = first; block; block = block.getNextBlock()) if (!block.isInsertionMarker()) found.push(block);
  return found;
}

/** @param {Blockly.Block | null} first @param {string[]} ids @returns {FormBlock[]} */
function bodyOf(first, ids) {
  return stackFrom(first).map((block) => blockOf(block, ids));
}

/** @param {Blockly.Block} block @param {string[]} ids @returns {FormBlock} */
function blockOf(block, ids) {
  ids.push(block.id);
  const kept = dataOf(block);
  const inside = block.inputList.filter((input) => /^B\d|^OTHERWISE/.test(input.name)).map((input) => input.connection?.targetBlock() ?? null);
  const word = String(wordOn(block) ?? kept.word ?? wordOf(block.type)), values = valuesOf(block), note = block.getCommentText() ?? '';
  const was = kept.was ?? {};
  const isNoteSame = word === was.word && note === was.note;
  return {
    kind: block.type,
    word,
    values,
    bodies: (isHat(block) ? [block.getNextBlock()] : inside).map((first) => bodyOf(first, ids)),
    note,
    is_apart: Boolean(kept.isApart),
    said: word === was.word ? kept.said.map((/** @type {string} */ line, /** @type {number} */ k) => (lineOf(block, values, k) === was.lines[k] ? line : '')) : [],
    comment: isNoteSame ? kept.comment : '',
    is_behind: Boolean(kept.isBehind),
  };
}

/** What a line of a block is made of besides its word. @param {Blockly.Block} block @param {Value[]} values @param {number} k */
function lineOf(block, values, k) {
  return JSON.stringify(block.type === 'if' ? values[k] : values) ?? '';
}

/** Keeps what the lines of a block are in the text, as long as nobody changes them. @param {Blockly.Block} block @param {FormBlock} form */
function remember(block, { word, is_apart, is_behind, said = [], comment }) {
  const values = valuesOf(block);
  block.data = JSON.stringify({
    word, isApart: is_apart, isBehind: is_behind, said, comment,
    was: { word: String(wordOn(block) ?? word), note: block.getCommentText() ?? '', lines: said.map((_, k) => lineOf(block, values, k)) },
  });
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

/** @param {FormBlock[]} blocks @returns {string[]} they and those of their values, as `pieceOf` has them */
export function piecesIn(blocks) {
  return blocks.flatMap(({ kind, word, values }) => [pieceOf(kind, word), ...values.flatMap((value) => value.flatMap(([op, name]) => {
    const inside = KIND_OF.get(op);
    return inside ? pieceOf(inside, name || op) : [];
  }))]);
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
    stand(workspace, tops, stood); // while they were drawn, blocks pushed each other
  });
  makeRoom(workspace);
  for (const [id, put] of SHOWN.get(workspace)?.hats ?? []) {
    const { x, y } = workspace.getBlockById(id)?.getRelativeToSurfaceXY() ?? put;
    Object.assign(put, { x, y }); // nobody has moved it there
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
  stand(workspace, tops, new Map());
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

/** @typedef {{program: Blockly.BlockSvg, hats: [Blockly.BlockSvg, number][], loose: (Blockly.BlockSvg | null)[]}} Tops each hat with how many blocks of the program stand before it in the text */

/**
 * Makes the blocks of a form, which nobody sees yet.
 * @param {Form} form
 * @param {Make} make
 * @param {string[]} ids of the blocks of the body are added
 * @returns {Generator<void, Tops>}
 */
function* making(form, make, ids) {
  const program = make('program');
  program.setFieldValue(form.start || 'SI', 'WORD');
  program.data = JSON.stringify({ isUnsaid: !form.start, isOneLine: form.is_one_line });
  if (form.note) program.setCommentText(form.note);
  /** @type {Tops['hats']} */
  const hats = [];
  /** @type {string[]} */
  const own = [];
  let above = program.nextConnection;
  for (const each of form.body) {
    const isHung = !KINDS[each.kind]?.is_hat;
    const block = yield* hang([each], isHung ? above : null, make, ids);
    if (!block) continue;
    if (isHung) {
      own.push(block.id);
      above = block.nextConnection;
    } else hats.push([block, own.length]);
  }
  const loose = [];
  for (const { body, value } of form.loose) loose.push(body.length ? yield* hang(body, null, make, []) : valueBlock(value, make));
  SHOWN.set(program.workspace, { program: own, hats: new Map(), excused: calledEarly(form.body) });
  return { program, hats, loose };
}

/**
 * Puts the program into the corner, hats beside it, and loose stacks below it; what is known to have stood somewhere, there.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Tops} tops
 * @param {Stood} stood
 */
function stand(workspace, { program, hats, loose }, stood) {
  const left = new Map([...stood].map(([name, places]) => [name, [...places]]));
  const shown = SHOWN.get(workspace);
  program.moveTo(new Blockly.utils.Coordinate(CORNER, CORNER));
  for (const [k, name] of namesOf(hats.map(([hat]) => hat)).entries()) {
    const [hat, before] = /** @type {Tops['hats'][number]} */ (hats[k]);
    const known = left.get(name)?.shift();
    if (known) hat.moveTo(known);
    const { x, y } = hat.getRelativeToSurfaceXY();
    shown?.hats.set(hat.id, { before, x, y, isOwn: Boolean(known) });
  }
  lineUp(workspace, program, hats.map(([hat]) => hat).filter((hat) => !shown?.hats.get(hat.id)?.isOwn));
  const inColumn = [program, ...hats.map(([hat]) => hat)].map((block) => block.getBoundingRectangle()).filter((box) => box.left < CORNER + DISTANCE);
  let y = Math.max(...inColumn.map(({ bottom }) => bottom)) + DISTANCE;
  for (const block of loose) {
    if (!block) continue;
    const known = left.get(namedAs(block))?.shift();
    block.moveTo(known ?? new Blockly.utils.Coordinate(CORNER, y));
    if (!known) y += block.getHeightWidth().height + DISTANCE;
  }
}

/**
 * Whether hats are seen beside the program.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Blockly.BlockSvg} program
 * @param {Blockly.BlockSvg[]} hats
 */
function isRoomBeside(workspace, program, hats) {
  const widest = Math.max(...hats.map((hat) => hat.getHeightWidth().width));
  return program.getBoundingRectangle().right + DISTANCE + widest <= workspace.getMetricsManager().getViewMetrics(true).width;
}

/**
 * Puts hats one below the other, beside the program where they are seen there, else below it.
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Blockly.BlockSvg} program
 * @param {Blockly.BlockSvg[]} hats
 */
function lineUp(workspace, program, hats) {
  const { right, bottom } = program.getBoundingRectangle();
  const isBeside = isRoomBeside(workspace, program, hats);
  let y = isBeside ? CORNER : bottom + DISTANCE;
  for (const hat of hats) {
    hat.moveTo(new Blockly.utils.Coordinate(isBeside ? right + DISTANCE : CORNER, y));
    y += hat.getHeightWidth().height + DISTANCE;
    const put = SHOWN.get(workspace)?.hats.get(hat.id);
    if (put) Object.assign(put, { x: hat.getRelativeToSurfaceXY().x, y: hat.getRelativeToSurfaceXY().y });
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
  const [moved, still] = [true, false].map((is) => hats.filter((hat) => is === Boolean(isMoved(hat) || SHOWN.get(workspace)?.hats.get(hat.id)?.isOwn)));
  if (!program || !moved || !still) return;
  const under = (/** @type {Blockly.BlockSvg} */ hat) => [program, ...hats].find((other) =>
    other !== hat && other.getBoundingRectangle().intersects(hat.getBoundingRectangle()));
  const isBeside = still[0] && still[0].getRelativeToSurfaceXY().x > CORNER;
  quietly(() => {
    if (still.some(under) || (isResized && still.length && isBeside !== isRoomBeside(workspace, program, still))) lineUp(workspace, program, still);
    for (const hat of moved) {
      let other = under(hat);
      for (let tries = hats.length + 1; tries && other; tries -= 1, other = under(hat)) {
        hat.moveTo(new Blockly.utils.Coordinate(hat.getRelativeToSurfaceXY().x, other.getBoundingRectangle().bottom + DISTANCE));
      }
    }
  });
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
    if (each.note) block.setCommentText(each.note);
    each.values.forEach((value, k) => put(value, block.getInput(`V${k}`)?.connection ?? null, make));
    for (const [k, body] of each.bodies.entries()) {
      const input = block.getInput(`B${k}`) ?? block.getInput('OTHERWISE');
      yield* hang(body, isHat(block) ? block.nextConnection : input?.connection ?? null, make, ids);
    }
    remember(block, each);
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
