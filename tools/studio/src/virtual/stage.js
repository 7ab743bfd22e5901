// How large the virtual robot is seen, and from where: the whole page, and a camera that follows it.

import { makeButton, makeSvg } from '../page/made.js';
import { element } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';

/** @typedef {import('./arena.js').Camera} Camera */

const CAMERAS = /** @type {Camera[]} */ (['whole', 'near', 'behind']);
const LOOKS = { // of a button
  whole: 'M3 5h18v14H3zM10 12a2 2 0 1 0 4 0 2 2 0 1 0-4 0z',
  near: 'M3 5h18v14H3zM7 12a5 5 0 1 0 10 0 5 5 0 1 0-10 0z',
  behind: 'M8 5h8l5 14H3zM9 15a3 3 0 1 0 6 0 3 3 0 1 0-6 0z',
};
const FULL = 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5';
const TYPED = 'input, textarea, select, [contenteditable=true], dialog';
const { documentElement: root } = document;

export class Stage {
  #page;
  /** What somebody has chosen; before that, a run that has room is followed. @type {Camera | ''} */
  #chosen = '';
  #isReal = false; // the browser has filled the screen, too
  #path = makeSvg('path', { fill: 'none', stroke: 'currentColor', 'stroke-width': 2.2, 'stroke-linejoin': 'round' });
  #camera = makeButton('', () => this.#turn(), makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' }, this.#path));
  #full = makeButton('', () => this.#fill(!this.isFull), makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' },
    makeSvg('path', { d: FULL, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.6, 'stroke-linecap': 'round', 'stroke-linejoin': 'round' })));

  /** @param {{look: (camera: Camera) => void, stop: () => void}} page shows the robot from there; stops it */
  constructor(page) {
    this.#page = page;
    this.#camera.id = 'camera';
    this.#full.id = 'full';
    element('runs_open', HTMLButtonElement).before(this.#camera, this.#full);
    addEventListener('keydown', (event) => {
      const isTyped = event.composedPath().some((each) => each instanceof Element && each.matches(TYPED));
      if (event.key.toLowerCase() !== 'f' || event.ctrlKey || event.metaKey || event.altKey || isTyped) return;
      if (this.isFull || this.#full.checkVisibility()) this.#fill(!this.isFull);
    });
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.#fill(false);
    });
    document.addEventListener('fullscreenchange', () => {
      const isReal = document.fullscreenElement !== null, wasReal = this.#isReal;
      this.#isReal = isReal;
      if (isReal && !this.isFull) document.exitFullscreen().catch(() => {}); // it came late
      if (isReal || !wasReal || !this.isFull) return;
      this.#fill(false); // by Escape, of which the page hears nothing else
      page.stop();
    });
    // Whoever goes on writing has the room for it again.
    for (const kind of ['pointerenter', 'focusin']) element('writing', HTMLElement).addEventListener(kind, () => this.#shrink());
    // Whoever is at a lesson reads on: once a button has been pressed, which else would go from under the finger.
    const lessons = element('lessons', HTMLElement);
    lessons.addEventListener('click', () => this.#shrink(true));
    lessons.addEventListener('focusin', ({ target }) => {
      if (target instanceof Element && target.matches(':focus-visible')) this.#shrink();
    });
    pageState.screen.subscribe((screen) => {
      if (screen !== 'start') return;
      this.#fill(false);
      this.#shrink();
    });
    let seen = pageState.sideId.value;
    pageState.sideId.subscribe((side) => {
      if (side !== seen) this.#fill(false); // a phone's Run shows the side that is seen
      seen = side;
    });
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  get isFull() {
    return 'full' in root.dataset;
  }

  /** A run of the whole program begins: it has a third of a large page, and is followed. */
  begin() {
    root.dataset['big'] = '';
    this.#show();
  }

  /** What stood there before a run of another robot or world is seen whole, as somebody first sees it. */
  rest() {
    this.#shrink();
  }

  /** @param {boolean} isAsked also while something runs */
  #shrink(isAsked = false) {
    if (!('big' in root.dataset) || (!isAsked && ['running', 'paused'].includes(root.dataset['phase'] ?? ''))) return;
    delete root.dataset['big'];
    this.#show();
  }

  /** @param {boolean} isFull */
  #fill(isFull) {
    if (isFull === this.isFull) return;
    if (isFull) {
      root.dataset['full'] = '';
      this.#isReal = false;
      root.requestFullscreen?.().catch(() => {}); // the page alone is filled, then
    } else {
      delete root.dataset['full'];
      if (document.fullscreenElement) document.exitFullscreen().catch(() => {});
    }
    this.#show();
  }

  #turn() {
    this.#chosen = CAMERAS[(CAMERAS.indexOf(this.#now) + 1) % CAMERAS.length] ?? 'whole';
    this.#show();
  }

  /** @returns {Camera} */
  get #now() {
    return this.#chosen || (this.isFull || 'big' in root.dataset ? 'near' : 'whole');
  }

  #show() {
    if (!pageState.language.value) return;
    const camera = this.#now;
    this.#path.setAttribute('d', LOOKS[camera]);
    this.#camera.title = this.#camera.ariaLabel = text(`camera_${camera}`);
    this.#full.title = this.#full.ariaLabel = `${text('full')} (F)`;
    this.#full.setAttribute('aria-pressed', String(this.isFull));
    this.#page.look(camera);
  }
}
