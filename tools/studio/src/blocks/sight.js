// What runs is in sight: the blocks are scrolled to it, and made smaller where it stands far apart. Once it has
// run, they are as large as before, and where they were. Whoever scrolls during a run has it left to them. A large
// robot leaves the blocks less room, after the run, too: what was seen before is seen there, however small.

import * as Blockly from 'blockly/core';
import { BLOCK_SELECTOR, isTouched } from '../page/pointer.js';

const MIN_SCALE = 0.4; // how small the blocks become at most
const EDGE_UNITS = 12; // units around what is seen
const ROW_UNITS = 48; // units: so much of a block says what it is, however much is in it,
const WORD_UNITS = 160; // and so much of a row, where there is no room for all of it
const SCROLL_INTERVAL_MS = 500; // for which nothing is scrolled again
const RUN_END_MS = 600; // without anything that runs, until the run is over

export class RunFollower {
  #workspace;
  /** @type {string[]} */
  #runningIds = [];
  /** How the blocks were seen before the run. @type {{scale: number, x: number, y: number} | null} */
  #viewBefore = null;
  /** How they were seen where there was more room, and how much of each stack. @type {{scale: number, x: number, y: number, width: number, visibleSizes: [string, number, number][]} | null} */
  #viewWithRoom = null;
  #isLeftAlone = false; // to somebody who scrolls
  #lastScroll_ms = -Infinity;
  #endTimer = 0;

  /** @param {Blockly.WorkspaceSvg} workspace */
  constructor(workspace) {
    this.#workspace = workspace;
  }

  /** These blocks run now. @param {string[]} ids */
  showRunning(ids) {
    this.#runningIds = ids.filter(Boolean);
    if (!this.#runningIds.length) {
      this.#endTimer ||= window.setTimeout(() => this.#restoreView(), RUN_END_MS);
      return;
    }
    clearTimeout(this.#endTimer);
    this.#endTimer = 0;
    this.keepInView();
  }

  /** Somebody is at the blocks: what they see stays until the run is over. */
  leaveAlone() {
    this.#isLeftAlone = this.#runningIds.length > 0;
    if (this.#isLeftAlone) this.#viewBefore = null;
  }

  /** Has all that runs be seen, or, where it stands too far apart for that, some of it. */
  keepInView() {
    if (this.#isLeftAlone || this.#workspace.isDragging()) return;
    const boxes = this.#runningIds.flatMap((id) => this.#workspace.getBlockById(id) ?? []).map((block) => {
      const { top, bottom, left, right } = block.getBoundingRectangleWithoutChildren();
      return new Blockly.utils.Rect(top, Math.min(bottom, top + ROW_UNITS), Math.min(left, block.getRootBlock().getRelativeToSurfaceXY().x), right);
    });
    const viewport = this.#viewport;
    if (!boxes.length || viewport.getWidth() <= 0 || boxes.every((box) => isInside(box, viewport))) return;
    const { scale, scrollX: x, scrollY: y } = this.#workspace;
    const headBoxes = boxes.map(({ top, bottom, left, right }) => new Blockly.utils.Rect(top, bottom, left, Math.min(right, left + WORD_UNITS)));
    const boundingBox = this.#fittingScaleOf(boundsOf(boxes)) < MIN_SCALE ? boundsOf(headBoxes) : boundsOf(boxes);
    const fittingScale = this.#fittingScaleOf(boundingBox);
    const isTooFar = fittingScale < MIN_SCALE;
    if (headBoxes.every((box) => isInside(box, viewport)) && scale <= MIN_SCALE) return;
    if (isTooFar && (headBoxes.some((box) => isInside(box, viewport)) || performance.now() - this.#lastScroll_ms < SCROLL_INTERVAL_MS)) return;
    this.#viewBefore ??= { scale, x, y };
    this.#lastScroll_ms = performance.now();
    if (fittingScale < scale) this.#workspace.setScale(Math.max(MIN_SCALE, fittingScale));
    this.#scrollTo(isTooFar ? headBoxes[0] ?? boundingBox : boundingBox);
  }

  /**
   * Gives the blocks another room. Where a large robot takes it, what was seen is made smaller, and is as before once
   * the room is there again.
   * @param {() => void} resize
   */
  resizeBy(resize) {
    const viewport = this.#viewport, { scale, scrollX: x, scrollY: y } = this.#workspace, { width } = this.#workspace.getMetricsManager().getViewMetrics();
    const visibleSizes = this.#visibleSizesIn(viewport);
    resize();
    const isNarrower = this.#workspace.getMetricsManager().getViewMetrics().width < (this.#viewWithRoom?.width ?? width);
    const isForRobot = 'big' in document.documentElement.dataset && !('phone' in document.documentElement.dataset);
    if (isNarrower && isForRobot) {
      this.#viewWithRoom ??= { scale, x, y, width, visibleSizes };
      this.#fitVisible();
    } else if (this.#viewWithRoom) {
      this.#applyView(this.#viewWithRoom);
      this.#viewWithRoom = null;
    }
  }

  /** How much of each stack is seen, from its corner. @param {Blockly.utils.Rect} viewport @returns {[string, number, number][]} */
  #visibleSizesIn(viewport) {
    return this.#workspace.getTopBlocks(false).flatMap((block) => {
      const { left, top, right, bottom } = block.getBoundingRectangle();
      return viewport.contains(left, top) ? [[block.id, Math.min(right, viewport.right) - left, Math.min(bottom, viewport.bottom) - top]] : [];
    });
  }

  /** Has all be seen that was seen where there was more room, if it does not fit in. */
  #fitVisible() {
    const boxes = (this.#viewWithRoom?.visibleSizes ?? []).flatMap(([id, width, height]) => {
      const { left, top } = this.#workspace.getBlockById(id)?.getBoundingRectangle() ?? {};
      return left === undefined || top === undefined ? [] : new Blockly.utils.Rect(top, top + height, left, left + width);
    });
    const viewport = this.#viewport;
    if (!this.#viewWithRoom || !boxes.length || viewport.getWidth() <= 0 || boxes.every((box) => isInside(box, viewport))) return;
    const visibleBox = boundsOf(boxes);
    this.#workspace.setScale(Math.max(MIN_SCALE, Math.min(this.#viewWithRoom.scale, this.#fittingScaleOf(visibleBox))));
    this.#scrollTo(visibleBox);
  }

  /** @param {Blockly.utils.Rect} box @returns {number} with which all of it is seen */
  #fittingScaleOf(box) {
    const viewport = this.#viewport;
    return this.#workspace.scale * Math.min(viewport.getWidth() / (box.getWidth() + 2 * EDGE_UNITS), viewport.getHeight() / (box.getHeight() + 2 * EDGE_UNITS));
  }

  /** @param {{scale: number, x: number, y: number}} view */
  #applyView({ scale, x, y }) {
    const toolbox = this.#workspace.getToolbox(), openGroup = toolbox?.getSelectedItem() ?? null;
    if (scale !== this.#workspace.scale) this.#workspace.setScale(scale); // which closes what somebody has opened
    this.#workspace.scroll(x, y);
    if (openGroup && !toolbox?.getSelectedItem()) toolbox?.setSelectedItem(openGroup);
  }

  /** What is seen, in the units of blocks. */
  get #viewport() {
    const { left, top, width, height } = this.#workspace.getMetricsManager().getViewMetrics(true);
    return new Blockly.utils.Rect(top, top + height, left, left + width);
  }

  /** As little as has it seen. @param {Blockly.utils.Rect} box */
  #scrollTo(box) {
    const viewport = this.#viewport, { scale } = this.#workspace;
    const left = nearestStart(viewport.left, viewport.getWidth(), box.left, box.right), top = nearestStart(viewport.top, viewport.getHeight(), box.top, box.bottom);
    this.#workspace.scroll(-left * scale, -top * scale);
  }

  #restoreView() {
    this.#endTimer = isTouched(BLOCK_SELECTOR) ? window.setTimeout(() => this.#restoreView(), RUN_END_MS) : 0;
    if (this.#endTimer) return;
    this.#isLeftAlone = false;
    const viewBefore = this.#viewBefore;
    this.#viewBefore = null;
    if (!viewBefore) return;
    this.#applyView(viewBefore);
    this.#fitVisible();
  }
}

/** @param {Blockly.utils.Rect} box @param {Blockly.utils.Rect} viewport */
function isInside(box, viewport) {
  return box.left >= viewport.left && box.right <= viewport.right && box.top >= viewport.top && box.bottom <= viewport.bottom;
}

/** @param {Blockly.utils.Rect[]} boxes */
function boundsOf(boxes) {
  return new Blockly.utils.Rect(Math.min(...boxes.map(({ top }) => top)), Math.max(...boxes.map(({ bottom }) => bottom)),
    Math.min(...boxes.map(({ left }) => left)), Math.max(...boxes.map(({ right }) => right)));
}

/**
 * Where what is seen begins, so that all from `low` to `high` is seen, or its beginning.
 * @param {number} start where it begins now @param {number} viewSize @param {number} low @param {number} high
 */
function nearestStart(start, viewSize, low, high) {
  return Math.min(Math.max(start, high + EDGE_UNITS - viewSize), low - EDGE_UNITS);
}
