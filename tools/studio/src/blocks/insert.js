// Where a block goes that somebody takes without dragging it, by a tap or a key: to what had the focus before.

import * as Blockly from 'blockly/core';
import { makeRoomFor } from './form.js';
import { KINDS } from '../page/words.js';

/** @typedef {Blockly.BlockSvg} BlockSvg */

/** @param {BlockSvg | null} block @returns {BlockSvg | null} it, or what is around it, that stands in a stack */
function stackBlockAround(block) {
  let ancestor = block;
  while (ancestor && !ancestor.nextConnection && !ancestor.previousConnection) ancestor = ancestor.getParent();
  return ancestor;
}

/** @param {Blockly.Block} block @returns {Blockly.Connection | null} what is in it begins there */
export function bodyConnectionOf(block) {
  return block.inputList.find(({ connection }) => connection?.type === Blockly.ConnectionType.NEXT_STATEMENT)?.connection ?? null;
}

/** @param {Blockly.Block} block @returns {Blockly.Connection | null} the same, where that is empty */
export function emptyConnectionIn(block) {
  const connection = bodyConnectionOf(block);
  return connection?.isConnected() ? null : connection;
}

/** @param {BlockSvg} block @param {BlockSvg} value a value @returns {Blockly.Connection | null} the first of its places that the value fits in and nobody has filled */
function freeConnectionFor(block, value) {
  const checker = block.workspace.connectionChecker;
  const input = block.inputList.find(({ connection }) => {
    const target = connection?.targetBlock();
    return connection?.type === Blockly.ConnectionType.INPUT_VALUE && (!target || target.isShadow())
      && value.outputConnection && checker.canConnect(value.outputConnection, connection, false);
  });
  return input?.connection ?? null;
}

/** @param {BlockSvg} block @returns {Blockly.Connection | null} where what comes after it goes: below it, or, as no robot comes there, to the end of what is in it */
function connectionBehind(block) {
  if (block.type !== 'forever') return block.nextConnection;
  const connection = bodyConnectionOf(block), inner = /** @type {BlockSvg | null | undefined} */ (connection?.targetBlock());
  return inner ? connectionBehind(lastOf(inner)) : connection;
}

/** @param {BlockSvg} block @returns {BlockSvg} the last one of its stack */
function lastOf(block) {
  let last = block;
  for (let next = last.getNextBlock(); next; next = next.getNextBlock()) last = next;
  return last;
}

/**
 * @param {BlockSvg} block that stands in a stack
 * @param {BlockSvg[]} stacks that it may be put to the end of, the best first
 * @param {BlockSvg | null} focusedBlock below which it is put, or into which where that is empty
 * @returns {Blockly.Connection | null} where it goes
 */
function connectionInStack(block, stacks, focusedBlock) {
  const stackBlock = stackBlockAround(focusedBlock);
  const connections = [stackBlock && (emptyConnectionIn(stackBlock) ?? connectionBehind(stackBlock)), ...stacks.map((stack) => connectionBehind(lastOf(stack)))];
  return connections.find((connection) => connection && block.workspace.connectionChecker.canConnect(connection, block.previousConnection, false)) ?? null;
}

/**
 * Puts a block of a list into the program: what stands in a stack below what had the focus, or into it where
 * that is empty, else to the end of a stack; a value into the place that had the focus, or the first free one of its block.
 * @param {BlockSvg} listBlock of the list
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {BlockSvg | null} focusedBlock that the workspace had last
 * @param {boolean} mayBeLoose what has no such place lies beside all others
 * @returns {BlockSvg | null} the new block; null where there is no such place
 */
export function insertBlock(listBlock, workspace, focusedBlock, mayBeLoose) {
  const state = Blockly.serialization.blocks.save(listBlock);
  const program = /** @type {BlockSvg | undefined} */ (workspace.getBlocksByType('program')[0]);
  if (!state || !program) return null;
  const stacks = [program, .../** @type {BlockSvg[]} */ (workspace.getTopBlocks(true))];
  const block = /** @type {BlockSvg} */ (Blockly.serialization.blocks.append(state, workspace));
  let connection = null;
  if (block.previousConnection) {
    connection = connectionInStack(block, stacks, focusedBlock);
  } else if (block.outputConnection) {
    const parent = focusedBlock?.outputConnection ? focusedBlock.getParent() : null;
    const ownConnection = parent?.inputList.find(({ connection }) => connection?.targetBlock() === focusedBlock)?.connection;
    const doesFit = ownConnection && focusedBlock?.isShadow() && workspace.connectionChecker.canConnect(block.outputConnection, ownConnection, false);
    const stackBlock = focusedBlock && stackBlockAround(focusedBlock);
    connection = doesFit ? ownConnection : (focusedBlock && freeConnectionFor(focusedBlock, block)) ?? (stackBlock && freeConnectionFor(stackBlock, block)) ?? null;
  }
  const blockConnection = block.previousConnection ?? block.outputConnection;
  if (connection && blockConnection) {
    const followingConnection = connection.targetBlock()?.previousConnection; // which no new block takes in that is put there
    followingConnection?.disconnect();
    connection.connect(blockConnection);
    if (followingConnection) block.nextConnection?.connect(followingConnection);
  } else if (!mayBeLoose && !KINDS[block.type]?.is_hat) {
    block.dispose();
    return null;
  }
  makeRoomFor(block, workspace);
  return block;
}
