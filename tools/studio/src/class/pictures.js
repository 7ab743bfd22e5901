// Pictures of pupils' programs as blocks, made here of their text alone: nothing that a pupil has sent
// is shown but as text. One is made at a time; a teacher's old computer has other things to do, too.

/** @typedef {{text: string, robot: string}} Program */
/** @typedef {{key: string, program: Program, done: (address: string) => void}} Wish */

const REST_MS = 80; // between two pictures
const NO_PICTURE = ''; // of a program that is empty, or too long

export class Pictures {
  #python;
  /** @type {Promise<import('../blocks/blocks.js').Blocks> | null} */
  #blocks = null;
  #robot = '';
  /** What is wanted, the oldest first; each owner wants its newest program alone. @type {Map<string, Wish>} */
  #wanted = new Map();
  #isBusy = false;
  #place = document.createElement('div');

  /** @param {import('../python.js').Python} python */
  constructor(python) {
    this.#python = python;
    this.#place.id = 'class_blocks';
    this.#place.inert = true;
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
  }

  async #work() {
    if (this.#isBusy) return;
    this.#isBusy = true;
    for (let next = this.#next(); next; next = this.#next()) {
      next.done(await this.#picture(next.program).catch(() => NO_PICTURE));
      await new Promise((resolve) => setTimeout(resolve, REST_MS));
    }
    this.#isBusy = false;
  }

  #next() {
    const [first] = this.#wanted.values();
    if (first) this.#wanted.delete(first.key);
    return first;
  }

  /** @param {Program} program */
  async #picture({ text, robot }) {
    if (!text.trim()) return NO_PICTURE;
    await this.#python.ready;
    const form = await this.#python.ask({ do: 'blocks', robot }, new TextEncoder().encode(text));
    if (!form.body) return NO_PICTURE;
    this.#blocks ??= import('../blocks/blocks.js').then(({ Blocks }) => new Blocks(this.#place, robot, 'few', { changed() {}, toggle() {} }));
    const blocks = await this.#blocks;
    if (this.#robot !== robot) blocks.setRobot(robot);
    this.#robot = robot;
    blocks.begin();
    blocks.show(form);
    const file = await blocks.picture();
    return file ? URL.createObjectURL(file) : NO_PICTURE;
  }

  /** The pictures' words are those of another language from now on. */
  async showWords() {
    (await this.#blocks)?.showWords();
  }
}
