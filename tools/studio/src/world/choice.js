// Which world the virtual robot is in: a shipped one, one that was drawn or opened here, or one that
// another part of the page brings.

import { element } from '../page/elements.js';
import { pictureOption, worldPicture } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { labelOf, text } from '../page/texts.js';
import { WORLDS } from '../page/words.js';
import { OwnWorlds } from './own.js';
import { lessonStars, worldStars } from '../lesson/progress.js';
import { OWN_WORLD } from '../programs/work.js';

/** @typedef {import('./parts.js').World} World */
/**
 * @typedef {object} Brought
 * @property {unknown} request what the worker is asked for
 * @property {World} shapes
 * @property {() => string} label in the language of the page
 * @property {import('../virtual/arena.js').Goal[]} goals
 */
/**
 * @typedef {object} Page what the page does for who changes a world
 * @property {() => World} world that is seen
 * @property {() => import('./parts.js').Place} robot where it is seen
 * @property {() => boolean} isDriving
 * @property {WorldChoice} choice of it
 * @property {() => void} rest the robot is off, and its floor seen in place of curves
 * @property {(world: World, isOther: boolean) => void} put a changed world, or another one, takes the place of the one that is seen
 * @property {(world: World) => void} preview the same, for as long as a finger is down
 * @property {() => void} tell something is to be shown anew
 */

const BROUGHT = ':brought'; // no name of a shipped world
const BEFORE = ':before'; // nor this, with a number after it

export class WorldChoice {
  #work;
  #choice = element('world', HTMLSelectElement);
  /** @type {Brought | null} */
  #brought = null;
  #own;

  /**
   * @param {import('../python.js').Python} python
   * @param {import('../programs/work.js').Work} work
   * @param {() => void} changed
   */
  constructor(python, work, changed) {
    this.#work = work;
    this.#own = new OwnWorlds(python);
    this.#choice.addEventListener('change', () => {
      const { value } = this.#choice;
      if (value.startsWith(BEFORE)) {
        this.#own.takeBack(Number(value.slice(BEFORE.length)));
        this.keepOwn();
      }
      if (value !== BROUGHT) {
        this.choose(value.startsWith(BEFORE) ? OWN_WORLD : value);
      }
      changed();
    });
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  /** Whether the world that is seen was drawn or opened here. */
  get isOwn() {
    return !this.#brought && this.#own.newest !== null && this.#work.world === OWN_WORLD;
  }

  /** Whether a lesson has brought the world that is seen. */
  get isOfLesson() {
    return typeof this.#brought?.request === 'object' && this.#brought.request !== null && 'lesson' in this.#brought.request;
  }

  /** The stars of a world are others than before. */
  showStars() {
    this.#show();
  }

  get goals() {
    return this.#brought?.goals ?? [];
  }

  /** @returns {World} */
  get shapes() {
    const { world } = this.#work;
    if (this.isOwn && this.#own.newest) return this.#own.newest;
    return this.#brought?.shapes ?? WORLDS.find((each) => each.name === world) ?? /** @type {World} */ (WORLDS[0]);
  }

  /** What the worker is asked for. */
  get request() {
    if (this.isOwn) return { form: this.#own.newest };
    return this.#brought?.request ?? this.shapes.name;
  }

  /** @param {string} name of a shipped world, or `OWN_WORLD` */
  choose(name) {
    this.#work.world = name;
    this.#brought = null;
    this.#show();
  }

  /** @param {Brought} brought is chosen, until another one is */
  bring(brought) {
    this.#brought = brought;
    this.#show();
  }

  /**
   * @param {World} world is this person's own from now on
   * @param {boolean} isOther than the one that is seen
   */
  putOwn(world, isOther) {
    this.#own.put(world, isOther || !this.isOwn);
    this.#brought = null;
    this.#work.world = OWN_WORLD;
    this.#show();
  }

  /** @param {World} world it is written as a file has it */
  write(world) {
    return this.#own.write(world, pageState.robotName.value);
  }

  /** Keeps this person's worlds on this device. */
  keepOwn() {
    return this.#own.keep(pageState.robotName.value);
  }

  /** Brings this person's worlds back; returns whether the newest can still be read. */
  async restoreOwn() {
    const isWhole = await this.#own.restore();
    this.#show();
    return isWhole;
  }

  #show() {
    const brought = this.#brought;
    const { newest, before } = this.#own, stars = lessonStars();
    /** @param {World} world */
    const label = (world) => labelOf(world.labels).trim() || text('world_own');
    this.#choice.replaceChildren(
      ...WORLDS.map((world) => pictureOption(`${labelOf(world.labels)} ${'★'.repeat(stars.get(worldStars(world.name)) ?? 0)}`.trim(), world.name, worldPicture(world))),
      ...(newest ? [pictureOption(label(newest), OWN_WORLD, worldPicture(newest))] : []),
      ...before.map((world, k) => pictureOption(text(k ? 'world_before_more' : 'world_before', { world: label(world), number: k + 1 }), `${BEFORE}${k}`, worldPicture(world))),
      ...(brought ? [new Option(brought.label(), BROUGHT)] : []),
    );
    this.#choice.value = brought ? BROUGHT : this.isOwn ? OWN_WORLD : this.shapes.name;
  }
}
