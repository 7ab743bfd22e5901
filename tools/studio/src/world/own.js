// The worlds that were drawn or opened here: the newest, and those it took the place of.
//
// Knows how they are kept on this device, in the form of their files; shows nothing.

import { currentLanguage } from '../page/texts.js';
import { keepWorlds, keptWorlds } from '../programs/work.js';

/** @typedef {import('./parts.js').World} World */

const MOST_BEFORE = 5;
const NAMED = /^# (.*)\n/; // by the name of a file

export class OwnWorlds {
  #python;
  /** @type {World | null} */
  newest = null;
  /** The last one first. @type {World[]} */
  before = [];
  /** @type {WeakMap<World, string>} */
  #texts = new WeakMap();
  #asked = 0;

  /** @param {import('../python.js').Python} python */
  constructor(python) {
    this.#python = python;
  }

  /**
   * @param {World} world is the newest from now on
   * @param {boolean} isOther than the newest one, which is not lost
   */
  put(world, isOther) {
    if (isOther && this.newest) this.before = [this.newest, ...this.before].slice(0, MOST_BEFORE);
    this.newest = world;
  }

  /** A world before is the newest from now on. @param {number} index of it */
  takeBack(index) {
    const [world] = this.before.splice(index, 1);
    if (world) this.put(world, true);
  }

  /**
   * Writes a world as a file has it, or says why it is none.
   * @param {World} world
   * @param {string} robot that is in it
   * @returns {Promise<{text?: string, is_blocked?: boolean, refused?: string[]}>}
   */
  async write(world, robot) {
    const answer = await this.#python.ask({ do: 'write_world', form: world, robot, language: currentLanguage() });
    this.#texts.set(world, answer.text ?? '');
    return answer;
  }

  /** Keeps them on this device; returns whether that was possible. @param {string} robot that is in them @returns {Promise<boolean>} */
  async keep(robot) {
    const asked = ++this.#asked;
    const { newest, before } = this;
    const texts = await Promise.all([newest, ...before].map((world) => this.#textOf(world, robot)));
    if (asked !== this.#asked) return true; // a newer one says it
    const [text, ...others] = texts;
    return keepWorlds(text ?? '', others.filter(Boolean));
  }

  /** @param {World | null} world @param {string} robot @returns {Promise<string>} empty where there is none */
  async #textOf(world, robot) {
    if (!world) return '';
    const written = this.#texts.get(world) ?? (await this.write(world, robot)).text ?? '';
    return written && world.name ? `# ${world.name}\n${written}` : written;
  }

  /** Brings back what was kept; returns whether the newest can still be read. @returns {Promise<boolean>} */
  async restore() {
    const { newest, before } = keptWorlds();
    if (!newest && !before.length) return true;
    await this.#python.ready;
    const worlds = await Promise.all([newest, ...before].map((text) => this.#read(text)));
    this.newest = worlds[0] ?? null;
    this.before = worlds.slice(1).filter((world) => world !== null).slice(0, MOST_BEFORE);
    return !newest || this.newest !== null;
  }

  /** @param {string} kept @returns {Promise<World | null>} */
  async #read(kept) {
    if (!kept) return null;
    const [first, name] = kept.match(NAMED) ?? ['', ''];
    const text = kept.slice(first.length);
    const request = { do: 'open_world', name, language: currentLanguage() };
    const { world = null } = await this.#python.ask(request, new TextEncoder().encode(text));
    if (world) this.#texts.set(world, text);
    return world;
  }
}

/** A shipped world that is changed is nobody's but this person's. @param {World} world @returns {World} */
export function ownCopy(world) {
  return { ...world, name: '', labels: {} };
}
