// The line that a real robot runs now, or before which it is halted, where it tells that and runs the program of the page.

import { pageState } from '../page/page_state.js';
import { rangeAt } from '../writing/parts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */

const ENDS = ['STARTED', 'DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST', 'OVER'];

export class RobotPlace {
  /** What the robot has told last. @type {RobotEvent | null} */
  #told = null;
  #isHeld = false;

  constructor() {
    pageState.checked.subscribe(() => {
      if (this.#told) this.#show();
    });
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (ENDS.includes(event.event)) this.end();
    else if (event.event === 'PLACE' && !this.#isHeld) this.#tell(event);
  }

  /** It is halted there. @param {number} at @param {string} program */
  hold(at, program) {
    this.#isHeld = true;
    this.#tell({ event: 'HALTED', at, program });
  }

  /** It goes on from there. */
  goOn() {
    this.#isHeld = false;
    this.#show();
  }

  /** Nobody tells any more. */
  end() {
    this.#isHeld = false;
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
    pageState.robotRun.set({ range: isHere ? rangeAt(program.places, at) : null, isHeld: this.#isHeld });
  }
}
