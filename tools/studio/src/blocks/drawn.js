// Pictures of programs as blocks, for who only looks at them: a teacher at those of pupils, a lesson's
// reader at its own. They are made of the text alone, and nothing that somebody has sent is shown but
// as text: one at a time, in slices, of the first blocks, and for each owner once a second at most.
// Whatever pupils write, STOP ALL waits for none of it.

import { ROBOTS } from '../page/words.js';

/** @typedef {{text: string, robot: string}} Program */
/** @typedef {{key: string, program: Program, done: (address: string) => void}} Wish */

const REST_MS = 80; // between two pictures
const AGAIN_MS = 1000; // between two of one pupil
const FIRST = 150; // blocks
const MOST_PIXELS = 1_200_000;
const NO_PICTURE = ''; // of a program that is empty

export class Pictures {
  #python;
  /** @type {Promise<import('./blocks.js').Blocks> | null} */
  #blocks = null;
  /** What is wanted, the oldest first; each owner wants its newest program alone. @type {Map<string, Wish>} */
  #wanted = new Map();
  /** When each owner's newest picture was begun. @type {Map<string, number>} */
  #begun = new Map();
  #isBusy = false;
  #areWordsOld = false;
  #place = document.createElement('div');

  /** @param {import('../python.js').Python} python @param {string} id of where they are made; its width is that of their room */
  constructor(python, id) {
    this.#python = python;
    Object.assign(this.#place, { id, className: 'drawn_blocks', inert: true });
    document.body.append(this.#place);
  }

  /**
   * Calls `done` with the address of a picture, or with nothing where there is none.
   * @param {string} owner @param {Program} program @param {(address: string) => void} done
   */
  want(owner, program, done) {
    this.#wanted.set(owner, { key: owner, program, done });
    this.#work();
  }

  /** @param {string} owner */
  forget(owner) {
    this.#wanted.delete(owner);
    this.#begun.delete(owner);
  }

  async #work() {
    if (this.#isBusy) return;
    this.#isBusy = true;
    while (this.#wanted.size) {
      const next = this.#next();
      if (next) {
        next.done(await this.#picture(next.program).catch(() => NO_PICTURE));
      }
      await new Promise((resolve) => setTimeout(resolve, REST_MS));
    }
    this.#isBusy = false;
  }

  /** The oldest wish of whom no picture was begun just now. */
  #next() {
    const now = performance.now();
    const next = [...this.#wanted.values()].find(({ key }) => now - (this.#begun.get(key) ?? -AGAIN_MS) >= AGAIN_MS);
    if (next) {
      this.#wanted.delete(next.key);
      this.#begun.set(next.key, now);
    }
    return next;
  }

  /** @param {Program} program */
  async #picture({ text, robot }) {
    if (!text.trim()) return NO_PICTURE;
    await this.#python.ready;
    const form = await this.#python.ask({ do: 'blocks', robot, first: FIRST }, new TextEncoder().encode(text));
    this.#blocks ??= import('./blocks.js').then(({ Blocks }) => new Blocks(this.#place, ROBOTS[0]?.name ?? '', 'few'));
    const blocks = await this.#blocks.catch((why) => {
      this.#blocks = null; // the next picture tries again
      throw why;
    });
    if (this.#areWordsOld) blocks.showWords();
    this.#areWordsOld = false;
    const file = await blocks.pictureOf(form, robot, MOST_PIXELS);
    return file ? URL.createObjectURL(file) : NO_PICTURE;
  }

  /** The next pictures' words are those of another language; one that is being made stays as it is. */
  updateLanguage() {
    this.#areWordsOld = true;
  }
}
