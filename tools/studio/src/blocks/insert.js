// Where a block goes that somebody takes with the keyboard: to what had the focus before.

import * as Blockly from 'blockly/core';
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

/**
 * Puts a block of a list into the program: what stands in a stack below what had the focus, or into it where
 * that is empty; a value into the place that had the focus, or the first free one of its block.
 * @param {BlockSvg} listBlock of the list
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {BlockSvg | null} focusedBlock that the workspace had last
 * @returns {BlockSvg | null} the new block; null where there is no such place
 */
export function insert(listBlock, workspace, focusedBlock) {
  const state = Blockly.serialization.blocks.save(listBlock);
  const program = /** @type {BlockSvg | undefined} */ (workspace.getBlocksByType('program')[0]);
  if (!state || !program) return null;
  const block = /** @type {BlockSvg} */ (Blockly.serialization.blocks.append(state, workspace));
  if (KINDS[block.type]?.is_hat) return block;
  let connection = null;
  if (block.previousConnection) {
    const lastConnection = program.lastConnectionInStack(true);
    const stackBlock = stackBlockAround(focusedBlock);
    connection = stackBlock ? emptyConnectionIn(stackBlock) ?? stackBlock.nextConnection : lastConnection;
  } else {
    const parent = focusedBlock?.outputConnection ? focusedBlock.getParent() : null;
    const ownConnection = parent?.inputList.find(({ connection }) => connection?.targetBlock() === focusedBlock)?.connection;
    const doesFit = ownConnection && focusedBlock?.isShadow() && block.outputConnection && workspace.connectionChecker.canConnect(block.outputConnection, ownConnection, false);
    const stackBlock = focusedBlock && stackBlockAround(focusedBlock);
    connection = doesFit ? ownConnection : (focusedBlock && freeConnectionFor(focusedBlock, block)) ?? (stackBlock && freeConnectionFor(stackBlock, block)) ?? null;
  }
  const blockConnection = block.previousConnection ?? block.outputConnection;
  if (!connection || !blockConnection) {
    block.dispose();
    return null;
  }
  const followingConnection = connection.targetBlock()?.previousConnection; // which no new block takes in that keys put there
  followingConnection?.disconnect();
  connection.connect(blockConnection);
  if (followingConnection) block.nextConnection?.connect(followingConnection);
  return block;
}
