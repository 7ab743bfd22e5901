// The line that a real robot runs now, where it tells that and runs the program of the page.

import { rangeAt } from '../writing/parts.js';

/** @typedef {import('./way.js').RobotEvent} RobotEvent */

const ENDS = ['STARTED', 'DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST'];

export class RobotPlace {
  #page;
  /** What the robot has told last. @type {RobotEvent | null} */
  #told = null;

  /**
   * @param {{
   *   program: () => import('../python.js').Checked | null,
   *   show: (range: import('../writing/editor.js').Range | null) => void,
   * }} page `program` is what the compiler says of the newest text
   */
  constructor(page) {
    this.#page = page;
  }

  /** @param {RobotEvent} event */
  hear(event) {
    if (event.event === 'PLACE') this.#tell(event);
    else if (ENDS.includes(event.event)) this.#tell(null);
  }

  /** Nobody tells any more. */
  end() {
    this.#tell(null);
  }

  /** The text is another one, or was compiled. */
  programChanged() {
    if (this.#told) this.#show();
  }

  /** @param {RobotEvent | null} told */
  #tell(told) {
    const isSame = this.#told === told;
    this.#told = told;
    if (!isSame) this.#show();
  }

  #show() {
    const program = this.#page.program();
    const at = Number(this.#told?.at ?? -1);
    const isHere = program?.image && program.program === this.#told?.program && at >= 0 && at < program.bytes;
    this.#page.show(isHere ? rangeAt(program.places, at) : null);
  }
}
