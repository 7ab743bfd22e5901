// Pictures of programs as blocks, for who only looks at them: a teacher at those of pupils, a lesson's
// reader at its own. They are made of the text alone, and nothing that somebody has sent is shown but
// as text: one at a time, in slices, of the first blocks, and for each owner once a second at most.
// Whatever pupils write, STOP ALL waits for none of it.

import { ROBOTS } from '../page/words.js';

/** @typedef {{text: string, robot: string}} Program */
/** @typedef {{owner: string, program: Program, onDone: (address: string) => void}} PictureRequest */

const PAUSE_MS = 80; // between two pictures
const OWNER_INTERVAL_MS = 1000; // between two of one pupil
const MAX_BLOCKS = 150; // blocks
const MAX_PIXELS = 1_200_000;
const NO_PICTURE = ''; // of a program that is empty

export class Pictures {
  #python;
  /** @type {Promise<import('./blocks.js').Blocks> | null} */
  #blocks = null;
  /** What is wanted, the oldest first; each owner wants its newest program alone. @type {Map<string, PictureRequest>} */
  #pendingRequests = new Map();
  /** When each owner's newest picture was begun. @type {Map<string, number>} */
  #begunTimes_ms = new Map();
  #isBusy = false;
  #isLanguageOld = false;
  #container = document.createElement('div');

  /** @param {import('../python.js').Python} python @param {string} id of where they are made; its width is that of their room */
  constructor(python, id) {
    this.#python = python;
    Object.assign(this.#container, { id, className: 'drawn_blocks', inert: true });
    document.body.append(this.#container);
  }

  /**
   * Calls `onDone` with the address of a picture, or with nothing where there is none.
   * @param {string} owner @param {Program} program @param {(address: string) => void} onDone
   */
  request(owner, program, onDone) {
    this.#pendingRequests.set(owner, { owner, program, onDone });
    this.#drawAll();
  }

  /** @param {string} owner */
  forget(owner) {
    this.#pendingRequests.delete(owner);
    this.#begunTimes_ms.delete(owner);
  }

  async #drawAll() {
    if (this.#isBusy) return;
    this.#isBusy = true;
    while (this.#pendingRequests.size) {
      const request = this.#takeNextRequest();
      if (request) {
        request.onDone(await this.#drawPicture(request.program).catch(() => NO_PICTURE));
      }
      await new Promise((resolve) => setTimeout(resolve, PAUSE_MS));
    }
    this.#isBusy = false;
  }

  /** The oldest wish of whom no picture was begun just now. */
  #takeNextRequest() {
    const now_ms = performance.now();
    const request = [...this.#pendingRequests.values()].find(({ owner: key }) => now_ms - (this.#begunTimes_ms.get(key) ?? -OWNER_INTERVAL_MS) >= OWNER_INTERVAL_MS);
    if (request) {
      this.#pendingRequests.delete(request.owner);
      this.#begunTimes_ms.set(request.owner, now_ms);
    }
    return request;
  }

  /** @param {Program} program */
  async #drawPicture({ text, robot: robotName }) {
    if (!text.trim()) return NO_PICTURE;
    await this.#python.ready;
    const form = await this.#python.ask({ do: 'blocks', robot: robotName, first: MAX_BLOCKS }, new TextEncoder().encode(text));
    this.#blocks ??= import('./blocks.js').then(({ Blocks }) => new Blocks(this.#container, ROBOTS[0]?.name ?? '', 'few'));
    const blocks = await this.#blocks.catch((error) => {
      this.#blocks = null; // the next picture tries again
      throw error;
    });
    if (this.#isLanguageOld) blocks.updateLanguage();
    this.#isLanguageOld = false;
    const file = await blocks.makeFormPicture(form, robotName, MAX_PIXELS);
    return file ? URL.createObjectURL(file) : NO_PICTURE;
  }

  /** The next pictures' words are those of another language; one that is being made stays as it is. */
  updateLanguage() {
    this.#isLanguageOld = true;
  }
}
