// How large the virtual robot is seen, and from where: the whole page, and a camera that follows it.

import { makeButton, makeSvg } from '../page/made.js';
import { element } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { BLOCK_SELECTOR, isMouseOver, isTouched } from '../page/pointer.js';
import { text } from '../page/texts.js';

/** @typedef {import('./arena.js').Camera} Camera */

const CAMERAS = /** @type {Camera[]} */ (['whole', 'near', 'behind']);
const CAMERA_PATHS = { // of a button
  whole: 'M3 5h18v14H3zM10 12a2 2 0 1 0 4 0 2 2 0 1 0-4 0z',
  near: 'M3 5h18v14H3zM7 12a5 5 0 1 0 10 0 5 5 0 1 0-10 0z',
  behind: 'M8 5h8l5 14H3zM9 15a3 3 0 1 0 6 0 3 3 0 1 0-6 0z',
};
const FULL_PATH = 'M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5';
const TYPING_SELECTOR = 'input, textarea, select, [contenteditable=true], dialog';
const PEEK_MS = 1500; // for which a phone shows where the robot has come to
const MOUSE_REST_MS = 200; // after which a mouse rests
const { documentElement: root } = document;

export class Stage {
  #page;
  /** What somebody has chosen; before that, a run that has room is followed. @type {Camera | ''} */
  #chosenCamera = '';
  #isWorldWhole = false; // until a run begins
  #restTimer = 0;
  #peekCount = 0;
  #isScreenFilled = false; // the browser has filled the screen, too
  #cameraPath = makeSvg('path', { fill: 'none', stroke: 'currentColor', 'stroke-width': 2.2, 'stroke-linejoin': 'round' });
  #cameraButton = makeButton('', () => this.#turnCamera(), makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' }, this.#cameraPath));
  #fullButton = makeButton('', () => this.#setFull(!this.isFull), makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' },
    makeSvg('path', { d: FULL_PATH, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.6, 'stroke-linecap': 'round', 'stroke-linejoin': 'round' })));

  /** @param {{setCamera: (camera: Camera) => void, stop: () => void}} page shows the robot from there; stops it */
  constructor(page) {
    this.#page = page;
    this.#cameraButton.id = 'camera';
    this.#fullButton.id = 'full';
    element('runs_open', HTMLButtonElement).before(this.#cameraButton, this.#fullButton);
    addEventListener('keydown', (event) => {
      const isTyped = event.composedPath().some((target) => target instanceof Element && target.matches(TYPING_SELECTOR));
      if (event.key.toLowerCase() !== 'f' || event.ctrlKey || event.metaKey || event.altKey || isTyped) return;
      if (this.isFull || this.#fullButton.checkVisibility()) this.#setFull(!this.isFull);
    });
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.#setFull(false);
    });
    document.addEventListener('fullscreenchange', () => {
      const isFilled = document.fullscreenElement !== null, wasFilled = this.#isScreenFilled;
      this.#isScreenFilled = isFilled;
      if (isFilled && !this.isFull) document.exitFullscreen().catch(() => {}); // it came late
      if (isFilled || !wasFilled || !this.isFull) return;
      this.#setFull(false); // by Escape, of which the page hears nothing else
      page.stop();
    });
    // Whoever goes on writing has the room for it again: by keys at once, by a press once it is over, and by a mouse that rests.
    const writingElement = element('writing', HTMLElement);
    let isPressed = false;
    writingElement.addEventListener('pointermove', () => this.#awaitRest());
    writingElement.addEventListener('pointerdown', () => {
      isPressed = true;
    }, { capture: true });
    writingElement.addEventListener('focusin', () => {
      if (!isPressed) this.shrink();
    });
    for (const kind of ['pointerup', 'pointercancel']) addEventListener(kind, () => {
      if (isPressed) setTimeout(() => this.shrink()); // after what it did to a block
      isPressed = false;
    }, { capture: true });
    // Whoever is at a lesson reads on: once a button has been pressed, which else would go from under the finger.
    const lessonsElement = element('lessons', HTMLElement);
    lessonsElement.addEventListener('click', () => this.shrink(true));
    lessonsElement.addEventListener('focusin', ({ target }) => {
      if (target instanceof Element && target.matches(':focus-visible')) this.shrink();
    });
    pageState.screen.subscribe((screen) => {
      if (screen !== 'start') return;
      this.#setFull(false);
      this.shrink(true); // whoever leaves a run ends it
    });
    let shownSideId = pageState.sideId.value;
    pageState.sideId.subscribe((sideId) => {
      if (sideId !== shownSideId) this.#setFull(false); // a phone's Run shows the side that is seen
      shownSideId = sideId;
    });
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  get isFull() {
    return 'full' in root.dataset;
  }

  /** A run of the whole program begins: it has a third of a large page, and is followed. */
  enlarge() {
    root.dataset['big'] = '';
    this.#isWorldWhole = false;
    this.#show();
  }

  /** Whether a phone shows the program, beside which a virtual robot can be seen. */
  get canPeek() {
    return 'phone' in root.dataset && root.dataset['half'] === 'program' && root.dataset['side'] !== 'side_real';
  }

  /** Shows the robot in a corner of the program. @returns {() => void} what ends that, a moment later */
  peek() {
    const peekNumber = ++this.#peekCount;
    root.dataset['peek'] = '';
    this.#show();
    return () => setTimeout(() => {
      if (peekNumber !== this.#peekCount) return; // another block is tried
      delete root.dataset['peek'];
      this.#show();
    }, PEEK_MS);
  }

  /** Another robot or world is seen whole, where the one before was: no button moves. */
  showWorld() {
    this.#isWorldWhole = true;
    if (pageState.sideId.value === 'side_lessons') this.shrink(); // its task is read
    this.#show();
  }

  /** A run is over: whoever is at a lesson reads on, and whoever has the mouse over the program goes on with it. */
  onRunEnd() {
    if (pageState.sideId.value === 'side_lessons') this.shrink();
    else this.#awaitRest();
  }

  /** A mouse on its way to a block finds it where it was, and so does one that is over it. */
  #awaitRest() {
    clearTimeout(this.#restTimer);
    this.#restTimer = window.setTimeout(() => {
      if (isMouseOver('#writing') && !isTouched(BLOCK_SELECTOR)) this.shrink();
    }, MOUSE_REST_MS);
  }

  /** The program and what is said of it have their room again. @param {boolean} isAsked also while something runs */
  shrink(isAsked = false) {
    if (!('big' in root.dataset) || (!isAsked && ['running', 'paused'].includes(root.dataset['phase'] ?? ''))) return;
    delete root.dataset['big'];
    this.#show();
  }

  /** @param {boolean} isFull */
  #setFull(isFull) {
    if (isFull === this.isFull) return;
    if (isFull) {
      root.dataset['full'] = '';
      this.#isScreenFilled = false;
      root.requestFullscreen?.().catch(() => {}); // the page alone is filled, then
    } else {
      delete root.dataset['full'];
      if (document.fullscreenElement) document.exitFullscreen().catch(() => {});
    }
    this.#show();
  }

  #turnCamera() {
    this.#chosenCamera = CAMERAS[(CAMERAS.indexOf(this.#currentCamera) + 1) % CAMERAS.length] ?? 'whole';
    this.#show();
  }

  /** @returns {Camera} */
  get #currentCamera() {
    return this.#chosenCamera || (!this.#isWorldWhole && (this.isFull || 'big' in root.dataset || 'peek' in root.dataset) ? 'near' : 'whole');
  }

  #show() {
    if (!pageState.language.value) return;
    const camera = this.#currentCamera;
    this.#cameraPath.setAttribute('d', CAMERA_PATHS[camera]);
    this.#cameraButton.title = this.#cameraButton.ariaLabel = text(`camera_${camera}`);
    this.#fullButton.title = this.#fullButton.ariaLabel = `${text('full')} (F)`;
    this.#fullButton.setAttribute('aria-pressed', String(this.isFull));
    this.#page.setCamera(camera);
  }
}
