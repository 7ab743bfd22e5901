// A block with room in it that is dropped into the middle of a stack takes in what follows, and is shown so before it is
// dropped, as in Scratch. Blockly would hang what follows below it.

import * as Blockly from 'blockly/core';
import { bodyConnectionOf, emptyConnectionIn } from './insert.js';

const { Connection } = Blockly;
const defaultConnectionFor = Connection.getConnectionForOrphanedConnection.bind(Connection);

/**
 * Where what followed goes: into the new block, unless it brings something with it that is in it or below it.
 * @param {Blockly.Block} newBlock
 * @param {Blockly.Connection} orphanConnection
 */
Connection.getConnectionForOrphanedConnection = (newBlock, orphanConnection) => {
  const isInStack = orphanConnection.type === Blockly.ConnectionType.PREVIOUS_STATEMENT;
  const innerConnection = isInStack && !newBlock.getNextBlock() ? emptyConnectionIn(newBlock) : null;
  return innerConnection && orphanConnection.getConnectionChecker().canConnect(orphanConnection, innerConnection, false) ? innerConnection : defaultConnectionFor(newBlock, orphanConnection);
};

/** Its markers give back what they have taken in: Blockly would delete that with them. */
export class Previewer extends Blockly.InsertionMarkerPreviewer {
  #workspace;

  /** @param {Blockly.BlockSvg} draggedBlock */
  constructor(draggedBlock) {
    super(draggedBlock);
    this.#workspace = draggedBlock.workspace;
  }

  hidePreview() {
    Blockly.Events.disable();
    try {
      for (const block of this.#workspace.getTopBlocks(false).flatMap((top) => top.getDescendants(false))) {
        const wrappedBlock = block.isInsertionMarker() && block.getParent() ? bodyConnectionOf(block)?.targetBlock() : null;
        if (!wrappedBlock?.previousConnection || block.getNextBlock()) continue;
        wrappedBlock.previousConnection.disconnect();
        block.nextConnection?.connect(wrappedBlock.previousConnection);
      }
    } finally {
      Blockly.Events.enable();
    }
    super.hidePreview();
  }
}
