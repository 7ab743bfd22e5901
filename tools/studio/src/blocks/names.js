// What code of a program is called by who sees it as blocks. Which block it is, Python knows, a moment later.

import { labelOfCode } from './said.js';

export class BlockNames {
  #python;
  #onKnown;
  /** What each code of a robot is as a block; nothing until Python has answered. @type {Map<string, Record<string, import('./said.js').SpokenBlock>>} */
  #spokenBlocks = new Map();

  /** @param {import('../python.js').Python} python @param {() => void} onKnown what was asked for has a name */
  constructor(python, onKnown) {
    this.#python = python;
    this.#onKnown = onKnown;
  }

  /** @param {string} code an instruction, a value or a word @param {string} robotName @returns {string} the words on its block, or else the code */
  nameOf(code, robotName) {
    const key = `${robotName} ${code}`;
    if (!this.#spokenBlocks.has(key)) this.#fetchSpokenBlocks(key, code, robotName);
    return labelOfCode(code, this.#spokenBlocks.get(key) ?? {})?.text || code;
  }

  /** @param {string} key @param {string} code @param {string} robotName */
  async #fetchSpokenBlocks(key, code, robotName) {
    this.#spokenBlocks.set(key, {});
    if (/^\w+$/.test(code)) return; // what a word is called, the page knows
    const spokenBlocks = await this.#python.ask({ do: 'speak', robot: robotName, code }).catch(() => null);
    if (!spokenBlocks) this.#spokenBlocks.delete(key); // and is asked again
    else if (code in spokenBlocks) {
      this.#spokenBlocks.set(key, spokenBlocks);
      this.#onKnown();
    }
  }
}
