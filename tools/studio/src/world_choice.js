// Which world the virtual robot is in: a shipped one, or one that another part of the page brings.

import { element } from './elements.js';
import { currentLanguage } from './texts.js';
import { WORLDS } from './words.js';

/** @typedef {typeof WORLDS[number]} Shapes */
/**
 * @typedef {object} Brought
 * @property {unknown} request what the worker is asked for
 * @property {Shapes} shapes
 * @property {() => string} label in the language of the page
 */

const BROUGHT = ':brought'; // no name of a shipped world

export class WorldChoice {
  #work;
  #choice = element('world', HTMLSelectElement);
  /** @type {Brought | null} */
  #brought = null;

  /**
   * @param {import('./work.js').Work} work
   * @param {() => void} changed
   */
  constructor(work, changed) {
    this.#work = work;
    this.#choice.addEventListener('change', () => {
      if (this.#choice.value !== BROUGHT) {
        this.#work.world = this.#choice.value;
        this.#brought = null;
        this.setLanguage();
      }
      changed();
    });
    this.setLanguage();
  }

  /** @returns {Shapes} */
  get shapes() {
    const { world } = this.#work;
    return this.#brought?.shapes ?? WORLDS.find((each) => each.name === world) ?? /** @type {Shapes} */ (WORLDS[0]);
  }

  /** What the worker is asked for. */
  get request() {
    return this.#brought?.request ?? this.#work.world;
  }

  /** @param {Brought} brought is chosen, until another one is */
  bring(brought) {
    this.#brought = brought;
    this.setLanguage();
  }

  setLanguage() {
    const language = currentLanguage();
    const brought = this.#brought;
    this.#choice.replaceChildren(
      ...WORLDS.map((world) => new Option(/** @type {Record<string, string>} */ (world.labels)[language], world.name)),
      ...(brought ? [new Option(brought.label(), BROUGHT)] : []),
    );
    this.#choice.value = brought ? BROUGHT : this.#work.world;
  }
}
