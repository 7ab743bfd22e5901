// The worlds that were drawn or opened here: the newest, and those it took the place of.
//
// Knows how they are kept on this device, in the form of their files; shows nothing.

import { currentLanguage } from '../page/texts.js';
import { storeWorldTexts, loadWorldTexts } from '../programs/work.js';

/** @typedef {import('./parts.js').World} World */

const MAX_EARLIER = 5;
const NAME_COMMENT = /^# (.*)\n/; // by the name of a file

export class OwnWorlds {
  #python;
  /** @type {World | null} */
  newestWorld = null;
  /** The last one first. @type {World[]} */
  earlierWorlds = [];
  /** @type {WeakMap<World, string>} */
  #texts = new WeakMap();
  #storeCount = 0;

  /** @param {import('../python.js').Python} python */
  constructor(python) {
    this.#python = python;
  }

  /**
   * @param {World} world is the newest from now on
   * @param {boolean} isOther than the newest one, which is not lost
   */
  setNewest(world, isOther) {
    if (isOther && this.newestWorld) this.earlierWorlds = [this.newestWorld, ...this.earlierWorlds].slice(0, MAX_EARLIER);
    this.newestWorld = world;
  }

  /** A world before is the newest from now on. @param {number} index of it */
  restoreEarlier(index) {
    const [world] = this.earlierWorlds.splice(index, 1);
    if (world) this.setNewest(world, true);
  }

  /**
   * Writes a world as a file has it, or says why it is none.
   * @param {World} world
   * @param {string} robotName that is in it
   * @returns {Promise<{text?: string, is_blocked?: boolean, refused?: string[]}>}
   */
  async writeText(world, robotName) {
    const answer = await this.#python.ask({ do: 'write_world', form: world, robot: robotName, language: currentLanguage() });
    this.#texts.set(world, answer.text ?? '');
    return answer;
  }

  /** Keeps them on this device; returns whether that was possible. @param {string} robotName that is in them @returns {Promise<boolean>} */
  async storeTexts(robotName) {
    const storeNumber = ++this.#storeCount;
    const { newestWorld, earlierWorlds } = this;
    const texts = await Promise.all([newestWorld, ...earlierWorlds].map((world) => this.#textOf(world, robotName)));
    if (storeNumber !== this.#storeCount) return true; // a newer one says it
    const [text, ...earlierTexts] = texts;
    return storeWorldTexts(text ?? '', earlierTexts.filter(Boolean));
  }

  /** @param {World | null} world @param {string} robotName @returns {Promise<string>} empty where there is none */
  async #textOf(world, robotName) {
    if (!world) return '';
    const worldText = this.#texts.get(world) ?? (await this.writeText(world, robotName)).text ?? '';
    return worldText && world.name ? `# ${world.name}\n${worldText}` : worldText;
  }

  /** Brings back what was kept; returns whether the newest can still be read. @returns {Promise<boolean>} */
  async restore() {
    const { newest: newestText, before: earlierTexts } = loadWorldTexts();
    if (!newestText && !earlierTexts.length) return true;
    await this.#python.ready;
    const worlds = await Promise.all([newestText, ...earlierTexts].map((text) => this.#readWorld(text)));
    this.newestWorld = worlds[0] ?? null;
    this.earlierWorlds = worlds.slice(1).filter((world) => world !== null).slice(0, MAX_EARLIER);
    return !newestText || this.newestWorld !== null;
  }

  /** @param {string} storedText @returns {Promise<World | null>} */
  async #readWorld(storedText) {
    if (!storedText) return null;
    const [nameLine, name] = storedText.match(NAME_COMMENT) ?? ['', ''];
    const text = storedText.slice(nameLine.length);
    const request = { do: 'open_world', name, language: currentLanguage() };
    const { world = null } = await this.#python.ask(request, new TextEncoder().encode(text));
    if (world) this.#texts.set(world, text);
    return world;
  }
}

/** A shipped world that is changed is nobody's but this person's. @param {World} world @returns {World} */
export function copyAsOwn(world) {
  return { ...world, name: '', labels: {} };
}
