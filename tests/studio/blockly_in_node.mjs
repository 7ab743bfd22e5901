// Blockly in node: its own blocks, fields and connections in a workspace that draws nothing. A block is as large as its rows.

import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';
import { sources } from './page_in_node.mjs';

const ROW = 40; // units
const WIDTH = 160;

/** @returns Blockly for a page that was just loaded, and what is seen of it */
export function blocklyInNode() {
  const Blockly = createRequire(pathToFileURL(`${sources}/index.js`))('../node_modules/blockly/blockly_compressed.js');
  const { Block, Workspace, icons, utils: { Coordinate, Rect } } = Blockly;
  const seen = { focused: null, workspaces: [], isOpen: false };
  const badges = new WeakMap();
  Blockly.utils.xml.injectDependencies({ document: { createElementNS: () => document.createElement('xml'), createTextNode: (text) => text }, DOMParser: class {}, XMLSerializer: class {} });
  const getIcon = (Block.prototype.iconOfBlockly ??= Block.prototype.getIcon);

  class Bubble {
    constructor(badge) { this.badge = badge; }
    getBoundingRectangle() { return new Rect(0, ROW, 0, WIDTH); }
    setAnchorLocation() {}
    moveDuringDrag(place) { this.place = place; }
    dispose() { this.badge.bubble = null; }
  }
  class Badge {
    bubble = null;
    constructor(block, text) { Object.assign(this, { block, text }); }
    getText() { return this.text; }
    getBubble() { return this.bubble; }
    async setBubbleVisible(isVisible) {
      if (Boolean(this.bubble) === isVisible) return;
      await undefined;
      this.bubble = isVisible ? new Bubble(this) : null;
    }
  }
  const rowsOf = (block) => 1 + block.inputList.reduce((sum, { connection, type }) => sum + (type === Blockly.inputs.inputTypes.STATEMENT ? heightOf(connection?.targetBlock()) : 0), 0);
  const heightOf = (block) => { let rows = 0; for (; block; block = block.getNextBlock()) rows += rowsOf(block); return rows; };
  /** Where it is below the block at the top. */
  const rowOf = (block) => { let row = 0; for (const item of block.getRootBlock().getDescendants(true)) { if (item === block) break; if (!item.outputConnection) row += 1; } return row; };
  Object.assign(Block.prototype, {
    initSvg() {}, queueRender() {}, renderEfficiently() {},
    addClass(name) { (this.classes ??= new Set()).add(name); },
    removeClass(name) { this.classes?.delete(name); },
    moveTo({ x, y }) { this.xy = new Coordinate(x, y); },
    getRelativeToSurfaceXY() { return this.xy ?? new Coordinate(0, 0); },
    getHeightWidth() { return { height: ROW * heightOf(this), width: WIDTH }; },
    getBoundingRectangle() { const { x, y } = this.getRootBlock().getRelativeToSurfaceXY(); return new Rect(y, y + ROW * heightOf(this.getRootBlock()), x, x + WIDTH); },
    getBoundingRectangleWithoutChildren() { const { x, y } = this.getRootBlock().getRelativeToSurfaceXY(), top = y + ROW * rowOf(this); return new Rect(top, top + ROW, x, x + WIDTH); },
    getSvgRoot() { return this.svgRoot ??= document.createElement('g'); },
    setWarningText(text) {
      if (!text) badges.delete(this);
      else if (badges.get(this)?.text !== text) badges.set(this, new Badge(this, text));
    },
    getIcon(type) { return type === icons.WarningIcon.TYPE ? badges.get(this) ?? null : getIcon.call(this, type); },
  });

  class WorkspaceInNode extends Workspace {
    scrollX = 0;
    scrollY = 0;
    canvas = document.createElement('g');
    room = { width: 600, height: 400 };
    nextRoom = this.room; // once it is resized
    isInHand = false;
    constructor(container, options) {
      super(new Blockly.Options(options));
      Object.assign(this, { container, list: options.toolbox });
      this.scale = options.zoom.startScale;
      seen.workspaces.push(this);
    }
    updateToolbox(list) { this.list = list; }
    getToolbox() { return { getWidth: () => 90, clearSelection() { seen.group = null; }, getSelectedItem: () => null, setSelectedItem() {} }; }
    getFlyout() { return this.flyout ??= { shown: null, show(items) { this.shown = items; }, hide() { this.shown = null; }, isVisible() { return this.shown !== null; }, getWorkspace: () => ({ getCanvas: () => undefined }) }; }
    getCanvas() { return this.canvas; }
    getInjectionDiv() { return this.injectionDiv ??= document.createElement('div'); }
    isDragging() { return this.isInHand; }
    setScale(scale) { this.scale = Math.min(1.6, Math.max(0.4, scale)); }
    scroll(x, y) { [this.scrollX, this.scrollY] = [x, y]; }
    centerOnBlock(id) {
      const { left, top } = this.getBlockById(id).getBoundingRectangleWithoutChildren();
      this.scroll(-left * this.scale, -top * this.scale);
    }
    getMetricsManager() {
      const { scale, scrollX, scrollY, room } = this;
      return { getViewMetrics: (isInUnits) => (isInUnits ? { left: -scrollX / scale, top: -scrollY / scale, width: room.width / scale, height: room.height / scale } : { left: -scrollX, top: -scrollY, ...room }) };
    }
    getBlocksBoundingBox() { return new Rect(0, 0, 0, 0); }
    hideChaff() {} resizeContents() {} zoomCenter() {} scrollCenter() {}
    dispose() {
      this.isGone = true;
      super.dispose();
    }
  }
  for (const name of ['breakpoint', 'try']) {
    if (Blockly.ContextMenuRegistry.registry.getItem(name)) Blockly.ContextMenuRegistry.registry.unregister(name);
    if (Blockly.ShortcutRegistry.registry.getRegistry()[name]) Blockly.ShortcutRegistry.registry.unregister(name);
  }
  return {
    seen,
    blockly: {
      ...Blockly, BlockSvg: Block, inject: (container, options) => new WorkspaceInNode(container, options),
      Css: { inject() {} }, blockRendering: { ...Blockly.blockRendering, register() {} },
      hideChaff() { seen.isOpen = false; }, svgResize(workspace) { workspace.room = workspace.nextRoom; }, WidgetDiv: { isVisible: () => seen.isOpen }, DropDownDiv: { isVisible: () => false },
      getFocusManager: () => ({ getFocusedNode: () => seen.focused, focusNode: (node) => { seen.focused = node; }, focusTree: (tree) => { seen.focused = tree; } }),
    },
  };
}
