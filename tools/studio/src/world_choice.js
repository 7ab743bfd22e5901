// Which world the virtual robot is in: a shipped one, one that was drawn or opened here, or one that
// another part of the page brings.

import { element } from './elements.js';
import { currentLanguage, text } from './texts.js';
import { WORLDS } from './words.js';
import { OWN_WORLD } from './work.js';

/** @typedef {import('./world_parts.js').World} World */
/**
 * @typedef {object} Brought
 * @property {unknown} request what the worker is asked for
 * @property {World} shapes
 * @property {() => string} label in the language of the page
 */

const BROUGHT = ':brought'; // no name of a shipped world

export class WorldChoice {
  #work;
  #choice = element('world', HTMLSelectElement);
  /** @type {Brought | null} */
  #brought = null;
  /** @type {World | null} */
  #own = null;

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

  /** Whether the world that is seen was drawn or opened here. */
  get isOwn() {
    return !this.#brought && this.#own !== null && this.#work.world === OWN_WORLD;
  }

  /** @returns {World} */
  get shapes() {
    const { world } = this.#work;
    if (this.isOwn && this.#own) return this.#own;
    return this.#brought?.shapes ?? WORLDS.find((each) => each.name === world) ?? /** @type {World} */ (WORLDS[0]);
  }

  /** What the worker is asked for. */
  get request() {
    if (this.isOwn) return { form: this.#own };
    return this.#brought?.request ?? this.shapes.name;
  }

  /** @param {Brought} brought is chosen, until another one is */
  bring(brought) {
    this.#brought = brought;
    this.setLanguage();
  }

  /**
   * @param {World} world is this person's own from now on
   * @param {boolean} isChosen
   */
  putOwn(world, isChosen = true) {
    this.#own = world;
    if (isChosen) {
      this.#brought = null;
      this.#work.world = OWN_WORLD;
    }
    this.setLanguage();
  }

  setLanguage() {
    const language = currentLanguage();
    const brought = this.#brought;
    const own = this.#own;
    this.#choice.replaceChildren(
      ...WORLDS.map((world) => new Option(world.labels[language], world.name)),
      ...(own ? [new Option(own.labels[language].trim() || text('world_own'), OWN_WORLD)] : []),
      ...(brought ? [new Option(brought.label(), BROUGHT)] : []),
    );
    this.#choice.value = brought ? BROUGHT : this.isOwn ? OWN_WORLD : this.shapes.name;
  }
}
