// What runs is in sight: the blocks are scrolled to it, and made smaller where it stands far apart. Once it has
// run, they are as large as before, and where they were. Whoever scrolls during a run has it left to them.

import * as Blockly from 'blockly/core';

const LEAST = 0.4; // how small the blocks become at most
const EDGE = 12; // units around what is seen
const ROW = 48; // units: so much of a block says what it is, however much is in it,
const WORD = 160; // and so much of a row, where there is no room for all of it
const STAYS_MS = 500; // for which nothing is scrolled again
const REST_MS = 600; // without anything that runs, until the run is over

export class Sight {
  #workspace;
  /** @type {string[]} */
  #running = [];
  /** How the blocks were seen before the run. @type {{scale: number, x: number, y: number} | null} */
  #before = null;
  #isLeft = false; // to somebody who scrolls
  #moved_ms = -Infinity;
  #resting = 0;

  /** @param {Blockly.WorkspaceSvg} workspace */
  constructor(workspace) {
    this.#workspace = workspace;
  }

  /** These blocks run now. @param {string[]} ids */
  see(ids) {
    this.#running = ids.filter(Boolean);
    if (!this.#running.length) {
      this.#resting ||= window.setTimeout(() => this.#rest(), REST_MS);
      return;
    }
    clearTimeout(this.#resting);
    this.#resting = 0;
    this.keep();
  }

  /** Somebody is at the blocks: what they see stays until the run is over. */
  leave() {
    this.#isLeft = this.#running.length > 0;
    if (this.#isLeft) this.#before = null;
  }

  /** Has all that runs be seen, or, where it stands too far apart for that, some of it. */
  keep() {
    if (this.#isLeft || this.#workspace.isDragging()) return;
    const boxes = this.#running.flatMap((id) => this.#workspace.getBlockById(id) ?? []).map((block) => {
      const { top, bottom, left, right } = block.getBoundingRectangleWithoutChildren();
      return new Blockly.utils.Rect(top, Math.min(bottom, top + ROW), Math.min(left, block.getRootBlock().getRelativeToSurfaceXY().x), right);
    });
    const view = this.#view;
    if (!boxes.length || view.getWidth() <= 0 || boxes.every((box) => isIn(box, view))) return;
    const { scale, scrollX: x, scrollY: y } = this.#workspace;
    const fitting = (/** @type {Blockly.utils.Rect} */ box) => scale * Math.min(view.getWidth() / (box.getWidth() + 2 * EDGE), view.getHeight() / (box.getHeight() + 2 * EDGE));
    const heads = boxes.map(({ top, bottom, left, right }) => new Blockly.utils.Rect(top, bottom, left, Math.min(right, left + WORD)));
    const whole = fitting(around(boxes)) < LEAST ? around(heads) : around(boxes);
    const fits = fitting(whole);
    const isFar = fits < LEAST;
    if (heads.every((box) => isIn(box, view)) && scale <= LEAST) return;
    if (isFar && (heads.some((box) => isIn(box, view)) || performance.now() - this.#moved_ms < STAYS_MS)) return;
    this.#before ??= { scale, x, y };
    this.#moved_ms = performance.now();
    if (fits < scale) this.#workspace.setScale(Math.max(LEAST, fits));
    this.#scrollTo(isFar ? heads[0] ?? whole : whole);
  }

  /** What is seen, in the units of blocks. */
  get #view() {
    const { left, top, width, height } = this.#workspace.getMetricsManager().getViewMetrics(true);
    return new Blockly.utils.Rect(top, top + height, left, left + width);
  }

  /** As little as has it seen. @param {Blockly.utils.Rect} box */
  #scrollTo(box) {
    const view = this.#view, { scale } = this.#workspace;
    const left = nearest(view.left, view.getWidth(), box.left, box.right), top = nearest(view.top, view.getHeight(), box.top, box.bottom);
    this.#workspace.scroll(-left * scale, -top * scale);
  }

  #rest() {
    this.#resting = 0;
    this.#isLeft = false;
    const before = this.#before;
    this.#before = null;
    if (!before) return;
    this.#workspace.setScale(before.scale);
    this.#workspace.scroll(before.x, before.y);
  }
}

/** @param {Blockly.utils.Rect} box @param {Blockly.utils.Rect} view */
function isIn(box, view) {
  return box.left >= view.left && box.right <= view.right && box.top >= view.top && box.bottom <= view.bottom;
}

/** @param {Blockly.utils.Rect[]} boxes */
function around(boxes) {
  return new Blockly.utils.Rect(Math.min(...boxes.map(({ top }) => top)), Math.max(...boxes.map(({ bottom }) => bottom)),
    Math.min(...boxes.map(({ left }) => left)), Math.max(...boxes.map(({ right }) => right)));
}

/**
 * Where what is seen begins, so that all from `low` to `high` is seen, or its beginning.
 * @param {number} from where it begins now @param {number} size @param {number} low @param {number} high
 */
function nearest(from, size, low, high) {
  return Math.min(Math.max(from, high + EDGE - size), low - EDGE);
}
