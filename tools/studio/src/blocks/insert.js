// Where a block goes that somebody takes with the keyboard: to what had the focus before.

import * as Blockly from 'blockly/core';
import { KINDS } from '../page/words.js';

/** @typedef {Blockly.BlockSvg} Block */

/** @param {Block | null} block @returns {Block | null} it, or what is around it, that stands in a stack */
function inStack(block) {
  let found = block;
  while (found && !found.nextConnection && !found.previousConnection) found = found.getParent();
  return found;
}

/** @param {Block} block @returns {Blockly.Connection | null} what is in it, where that is empty */
function emptyInside(block) {
  const input = block.inputList.find(({ connection }) => connection?.type === Blockly.ConnectionType.NEXT_STATEMENT);
  return input?.connection && !input.connection.isConnected() ? input.connection : null;
}

/** @param {Block} block @param {Block} whole a value @returns {Blockly.Connection | null} the first of its places that the value fits in and nobody has filled */
function freePlace(block, whole) {
  const checker = block.workspace.connectionChecker;
  const input = block.inputList.find(({ connection }) => {
    const inside = connection?.targetBlock();
    return connection?.type === Blockly.ConnectionType.INPUT_VALUE && (!inside || inside.isShadow())
      && whole.outputConnection && checker.canConnect(whole.outputConnection, connection, false);
  });
  return input?.connection ?? null;
}

/**
 * Puts a block of a list into the program: what stands in a stack below what had the focus, or into it where
 * that is empty; a value into the place that had the focus, or the first free one of its block.
 * @param {Block} taken of the list
 * @param {Blockly.WorkspaceSvg} workspace
 * @param {Block | null} focus that the workspace had last
 * @returns {Block | null} the new block; null where there is no such place
 */
export function insert(taken, workspace, focus) {
  const state = Blockly.serialization.blocks.save(taken);
  const program = /** @type {Block | undefined} */ (workspace.getBlocksByType('program')[0]);
  if (!state || !program) return null;
  const block = /** @type {Block} */ (Blockly.serialization.blocks.append(state, workspace));
  if (KINDS[block.type]?.is_hat) return block;
  let place = null;
  if (block.previousConnection) {
    const last = program.lastConnectionInStack(true);
    const around = inStack(focus);
    place = around ? emptyInside(around) ?? around.nextConnection : last;
  } else {
    const around = focus?.outputConnection ? focus.getParent() : null;
    const own = around?.inputList.find(({ connection }) => connection?.targetBlock() === focus)?.connection;
    const fits = own && focus?.isShadow() && block.outputConnection && workspace.connectionChecker.canConnect(block.outputConnection, own, false);
    const inside = focus && inStack(focus);
    place = fits ? own : (focus && freePlace(focus, block)) ?? (inside && freePlace(inside, block)) ?? null;
  }
  const end = block.previousConnection ?? block.outputConnection;
  if (!place || !end) {
    block.dispose();
    return null;
  }
  place.connect(end);
  return block;
}
