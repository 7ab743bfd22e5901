// What runs is in sight: the blocks are scrolled to it, and made smaller where it stands far apart. Once it has
// run, they are as large as before, and where they were. Whoever scrolls during a run has it left to them. A large
// robot leaves the blocks less room, after the run, too: what was seen before is seen there, however small.
//
// One view is kept: the last that the page had no part in. It is shown again once nothing runs and the room is there,
// in whatever order that comes. Nothing moves while somebody holds a block.

import * as Blockly from 'blockly/core';

const LEAST_SCALE = 0.4; // how small the blocks become at most
const EDGE_UNITS = 12; // units around what is seen
const ROW_UNITS = 48; // units: so much of a block says what it is, however much is in it,
const WORD_UNITS = 160; // and so much of a row, where there is no room for all of it
const SCROLL_INTERVAL_MS = 500; // for which nothing is scrolled again
const RUN_END_MS = 600; // without anything that runs, until the run is over

/** @typedef {{scale: number, x: number, y: number}} View */
/** @typedef {View & {width: number, seenSizes: [string, number, number][]}} OwnView */

export class RunFollower {
  #workspace;
  /** @type {string[]} */
  #runningIds = [];
  /** How the blocks were seen before the page changed it, how wide, and how much of each stack. @type {OwnView | null} */
  #ownView = null;
  /** How somebody who is at the blocks found them: it is left to them. @type {View | null} */
  #foundView = null;
  #lastScroll_ms = -Infinity;
  #endTimer = 0;

  /** @param {Blockly.WorkspaceSvg} workspace */
  constructor(workspace) {
    this.#workspace = workspace;
  }

  /** The same blocks are there from now on, in another language. @param {Blockly.WorkspaceSvg} workspace */
  follow(workspace) {
    this.#workspace = workspace;
    this.#foundView = null;
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
    if (this.#runningIds.length) this.#foundView ??= this.#currentView;
  }

  /** Has all that runs be seen, or, where it stands too far apart for that, some of it. */
  keepInView() {
    if (this.#foundView || this.#isHeld) return;
    const boxes = this.#runningIds.flatMap((id) => this.#workspace.getBlockById(id) ?? []).map((block) => {
      const { top, bottom, left, right } = block.getBoundingRectangleWithoutChildren();
      return new Blockly.utils.Rect(top, Math.min(bottom, top + ROW_UNITS), Math.min(left, block.getRootBlock().getRelativeToSurfaceXY().x), right);
    });
    const view = this.#view;
    if (!boxes.length || view.getWidth() <= 0 || boxes.every((box) => contains(box, view))) return;
    const { scale } = this.#workspace;
    const headBoxes = boxes.map(({ top, bottom, left, right }) => new Blockly.utils.Rect(top, bottom, left, Math.min(right, left + WORD_UNITS)));
    const boundingBox = this.#scaleToFit(boundsOf(boxes)) < LEAST_SCALE ? boundsOf(headBoxes) : boundsOf(boxes);
    const fittingScale = this.#scaleToFit(boundingBox);
    const isTooFar = fittingScale < LEAST_SCALE;
    if (headBoxes.every((box) => contains(box, view)) && scale <= LEAST_SCALE) return;
    if (isTooFar && (headBoxes.some((box) => contains(box, view)) || performance.now() - this.#lastScroll_ms < SCROLL_INTERVAL_MS)) return;
    this.#ownView ??= this.#makeOwnView();
    this.#lastScroll_ms = performance.now();
    if (fittingScale < scale) this.#workspace.setScale(Math.max(LEAST_SCALE, fittingScale));
    this.#scrollTo(isTooFar ? headBoxes[0] ?? boundingBox : boundingBox);
  }

  /**
   * Gives the blocks another room. Where a large robot takes it, what was seen is made smaller, and is as before once
   * the room is there again.
   * @param {() => void} resize
   */
  resizeBy(resize) {
    const viewBefore = this.#makeOwnView();
    resize();
    if (!this.#ownView && this.#width < viewBefore.width && isForRobot()) this.#ownView = viewBefore;
    else if (!this.#ownView || (this.#foundView && !this.#hasRoom)) return;
    this.#showOwnView();
  }

  /** @returns {View} */
  get #currentView() {
    const { scale, scrollX: x, scrollY: y } = this.#workspace;
    return { scale, x, y };
  }

  get #width() {
    return this.#workspace.getMetricsManager().getViewMetrics().width;
  }

  /** Whether there is as much of it as in their own view. */
  get #hasRoom() {
    return !isForRobot() || this.#width >= (this.#ownView?.width ?? 0);
  }

  /** Whether what is moved now would go from under somebody's finger. */
  get #isHeld() {
    return Blockly.Gesture.inProgress() || this.#workspace.isDragging();
  }

  #makeOwnView() {
    return { ...this.#currentView, width: this.#width, seenSizes: this.#sizesSeenIn(this.#view) };
  }

  /** Or, without the room, all that was seen of it. Where nothing runs and there is room, it is theirs again. */
  #showOwnView() {
    if (!this.#ownView) return;
    this.#showAs(this.#ownView);
    if (!this.#hasRoom) this.#makeFit(this.#ownView);
    else if (!this.#runningIds.length) this.#ownView = this.#foundView = null;
  }

  /** How much of each stack is seen, from its corner. @param {Blockly.utils.Rect} view @returns {[string, number, number][]} */
  #sizesSeenIn(view) {
    return this.#workspace.getTopBlocks(false).flatMap((block) => {
      const { left, top, right, bottom } = block.getBoundingRectangle();
      return view.contains(left, top) ? [[block.id, Math.min(right, view.right) - left, Math.min(bottom, view.bottom) - top]] : [];
    });
  }

  /** Has all be seen that was seen where there was more room. @param {OwnView} ownView */
  #makeFit({ scale, seenSizes }) {
    const boxes = seenSizes.flatMap(([id, width, height]) => {
      const { left, top } = this.#workspace.getBlockById(id)?.getBoundingRectangle() ?? {};
      return left === undefined || top === undefined ? [] : new Blockly.utils.Rect(top, top + height, left, left + width);
    });
    const view = this.#view;
    if (!boxes.length || view.getWidth() <= 0 || boxes.every((box) => contains(box, view))) return;
    const seenBox = boundsOf(boxes);
    this.#workspace.setScale(Math.max(LEAST_SCALE, Math.min(scale, this.#scaleToFit(seenBox))));
    this.#scrollTo(seenBox);
  }

  /** @param {Blockly.utils.Rect} box @returns {number} with which all of it is seen */
  #scaleToFit(box) {
    const view = this.#view;
    return this.#workspace.scale * Math.min(view.getWidth() / (box.getWidth() + 2 * EDGE_UNITS), view.getHeight() / (box.getHeight() + 2 * EDGE_UNITS));
  }

  /** @param {View} view */
  #showAs({ scale, x, y }) {
    const toolbox = this.#workspace.getToolbox(), openGroup = toolbox?.getSelectedItem() ?? null;
    if (scale !== this.#workspace.scale) this.#workspace.setScale(scale); // which closes what somebody has opened
    this.#workspace.scroll(x, y);
    if (openGroup && !toolbox?.getSelectedItem()) toolbox?.setSelectedItem(openGroup);
  }

  /** What is seen, in the units of blocks. */
  get #view() {
    const { left, top, width, height } = this.#workspace.getMetricsManager().getViewMetrics(true);
    return new Blockly.utils.Rect(top, top + height, left, left + width);
  }

  /** As little as has it seen. @param {Blockly.utils.Rect} box */
  #scrollTo(box) {
    const view = this.#view, { scale } = this.#workspace;
    const left = nearestStart(view.left, view.getWidth(), box.left, box.right), top = nearestStart(view.top, view.getHeight(), box.top, box.bottom);
    this.#workspace.scroll(-left * scale, -top * scale);
  }

  #restoreView() {
    this.#endTimer = this.#isHeld ? window.setTimeout(() => this.#restoreView(), RUN_END_MS) : 0;
    if (this.#endTimer) return;
    const foundView = this.#foundView, { scale, x, y } = this.#currentView;
    this.#foundView = null;
    if (!foundView || (foundView.scale === scale && foundView.x === x && foundView.y === y)) this.#showOwnView();
    else if (this.#hasRoom) this.#ownView = null; // they have made another one
  }
}

/** Whether a large robot takes room from the blocks. */
function isForRobot() {
  return 'big' in document.documentElement.dataset && !('phone' in document.documentElement.dataset);
}

/** @param {Blockly.utils.Rect} box @param {Blockly.utils.Rect} view */
function contains(box, view) {
  return box.left >= view.left && box.right <= view.right && box.top >= view.top && box.bottom <= view.bottom;
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
