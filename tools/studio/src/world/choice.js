// Which world the virtual robot is in: a shipped one, one that was drawn or opened here, or one that
// another part of the page brings.

import { element } from '../page/elements.js';
import { makePictureOption, makeWorldPicture } from '../page/pictures.js';
import { pageState } from '../page/page_state.js';
import { labelOf, text } from '../page/texts.js';
import { WORLDS } from '../page/words.js';
import { OwnWorlds } from './own.js';
import { loadStars, starsKeyOfWorld } from '../lesson/progress.js';
import { OWN_WORLD } from '../programs/work.js';

/** @typedef {import('./parts.js').World} World */
/**
 * @typedef {object} BroughtWorld
 * @property {unknown} request what the worker is asked for
 * @property {World} shapes
 * @property {() => string} label in the language of the page
 * @property {import('../virtual/arena.js').Goal[]} goals
 */
/**
 * @typedef {object} Page what the page does for who changes a world
 * @property {() => World} getWorld that is seen
 * @property {() => import('./parts.js').Point} getRobotPlace where it is seen
 * @property {() => boolean} isDriving
 * @property {WorldChoice} worldChoice of it
 * @property {() => void} switchOff the robot is off, and its floor seen in place of curves
 * @property {(world: World, isOther: boolean) => void} putWorld a changed world, or another one, takes the place of the one that is seen
 * @property {(world: World) => void} previewWorld the same, for as long as a finger is down
 * @property {() => void} refresh something is to be shown anew
 */

const BROUGHT_VALUE = ':brought'; // no name of a shipped world
const EARLIER_PREFIX = ':before'; // nor this, with a number after it

export class WorldChoice {
  #work;
  #worldSelect = element('world', HTMLSelectElement);
  /** @type {BroughtWorld | null} */
  #broughtWorld = null;
  #ownWorlds;

  /**
   * @param {import('../python.js').Python} python
   * @param {import('../programs/work.js').Work} work
   * @param {() => void} onChange
   */
  constructor(python, work, onChange) {
    this.#work = work;
    this.#ownWorlds = new OwnWorlds(python);
    this.#worldSelect.addEventListener('change', () => {
      const { value } = this.#worldSelect;
      if (value.startsWith(EARLIER_PREFIX)) {
        this.#ownWorlds.restoreEarlier(Number(value.slice(EARLIER_PREFIX.length)));
        this.storeOwn();
      }
      if (value !== BROUGHT_VALUE) {
        this.choose(value.startsWith(EARLIER_PREFIX) ? OWN_WORLD : value);
      }
      onChange();
    });
    pageState.language.subscribe(() => this.#show());
    this.#show();
  }

  /** Whether the world that is seen was drawn or opened here. */
  get isOwn() {
    return !this.#broughtWorld && this.#ownWorlds.newestWorld !== null && this.#work.world === OWN_WORLD;
  }

  /** Whether a lesson has brought the world that is seen. */
  get isOfLesson() {
    return typeof this.#broughtWorld?.request === 'object' && this.#broughtWorld.request !== null && 'lesson' in this.#broughtWorld.request;
  }

  /** The stars of a world are others than before. */
  showStars() {
    this.#show();
  }

  get goals() {
    return this.#broughtWorld?.goals ?? [];
  }

  /** @returns {World} */
  get shownWorld() {
    const { world: worldName } = this.#work;
    if (this.isOwn && this.#ownWorlds.newestWorld) return this.#ownWorlds.newestWorld;
    return this.#broughtWorld?.shapes ?? WORLDS.find((candidate) => candidate.name === worldName) ?? /** @type {World} */ (WORLDS[0]);
  }

  /** What the worker is asked for. */
  get request() {
    if (this.isOwn) return { form: this.#ownWorlds.newestWorld };
    return this.#broughtWorld?.request ?? this.shownWorld.name;
  }

  /** @param {string} name of a shipped world, or `OWN_WORLD` */
  choose(name) {
    this.#work.world = name;
    this.#broughtWorld = null;
    this.#show();
  }

  /** @param {BroughtWorld} broughtWorld is chosen, until another one is */
  bringWorld(broughtWorld) {
    this.#broughtWorld = broughtWorld;
    this.#show();
  }

  /**
   * @param {World} world is this person's own from now on
   * @param {boolean} isOther than the one that is seen
   */
  putOwn(world, isOther) {
    this.#ownWorlds.setNewest(world, isOther || !this.isOwn);
    this.#broughtWorld = null;
    this.#work.world = OWN_WORLD;
    this.#show();
  }

  /** @param {World} world it is written as a file has it */
  write(world) {
    return this.#ownWorlds.writeText(world, pageState.robotName.value);
  }

  /** Keeps this person's worlds on this device. */
  storeOwn() {
    return this.#ownWorlds.storeTexts(pageState.robotName.value);
  }

  /** Brings this person's worlds back; returns whether the newest can still be read. */
  async restoreOwn() {
    const isNewestRestored = await this.#ownWorlds.restore();
    this.#show();
    return isNewestRestored;
  }

  #show() {
    const broughtWorld = this.#broughtWorld;
    const { newestWorld, earlierWorlds } = this.#ownWorlds, stars = loadStars();
    /** @param {World} world */
    const labelOfWorld = (world) => labelOf(world.labels).trim() || text('world_own');
    this.#worldSelect.replaceChildren(
      ...WORLDS.map((world) => makePictureOption(`${labelOf(world.labels)} ${'★'.repeat(stars.get(starsKeyOfWorld(world.name)) ?? 0)}`.trim(), world.name, makeWorldPicture(world))),
      ...(newestWorld ? [makePictureOption(labelOfWorld(newestWorld), OWN_WORLD, makeWorldPicture(newestWorld))] : []),
      ...earlierWorlds.map((world, index) => makePictureOption(text(index ? 'world_before_more' : 'world_before', { world: labelOfWorld(world), number: index + 1 }), `${EARLIER_PREFIX}${index}`, makeWorldPicture(world))),
      ...(broughtWorld ? [new Option(broughtWorld.label(), BROUGHT_VALUE)] : []),
    );
    this.#worldSelect.value = broughtWorld ? BROUGHT_VALUE : this.isOwn ? OWN_WORLD : this.shownWorld.name;
  }
}
