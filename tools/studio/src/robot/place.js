// The line that a real robot runs now, where it tells that and runs the program of the page.

import { pageState } from '../page/page_state.js';
import { rangeAt } from '../writing/parts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */

const ENDS = ['STARTED', 'DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST'];

export class RobotPlace {
  /** What the robot has told last. @type {RobotEvent | null} */
  #told = null;

  constructor() {
    pageState.checked.subscribe(() => {
      if (this.#told) this.#show();
    });
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'PLACE') this.#tell(event);
    else if (ENDS.includes(event.event)) this.#tell(null);
  }

  /** Nobody tells any more. */
  end() {
    this.#tell(null);
  }

  /** @param {RobotEvent | null} told */
  #tell(told) {
    const isSame = this.#told === told;
    this.#told = told;
    if (!isSame) this.#show();
  }

  #show() {
    const program = pageState.checked.value;
    const at = Number(this.#told?.at ?? -1);
    const isHere = program?.image && program.program === this.#told?.program && at >= 0 && at < program.bytes;
    pageState.robotRun.set(isHere ? rangeAt(program.places, at) : null);
  }
}
