// The line that a real robot runs now, or before which it is halted, where it tells that and runs the program of the page.

import { pageState } from '../page/page_state.js';
import { rangeAt } from '../writing/parts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */

const END_EVENTS = ['STARTED', 'DONE', 'FAULT', 'STOPPED', 'RESTARTED', 'LOST', 'OVER'];

export class RunningPlace {
  /** What the robot has told last. @type {RobotEvent | null} */
  #lastEvent = null;
  #isHalted = false;

  constructor() {
    pageState.checkResult.subscribe(() => {
      if (this.#lastEvent) this.#show();
    });
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (END_EVENTS.includes(event.event)) this.end();
    else if (event.event === 'PLACE' && !this.#isHalted) this.#setEvent(event);
  }

  /** It is halted there. @param {number} offset @param {string} checksum */
  halt(offset, checksum) {
    this.#isHalted = true;
    this.#setEvent({ event: 'HALTED', at: offset, program: checksum });
  }

  /** It goes on from there. */
  resume() {
    this.#isHalted = false;
    this.#show();
  }

  /** Nobody tells any more. */
  end() {
    this.#isHalted = false;
    this.#setEvent(null);
  }

  /** @param {RobotEvent | null} event */
  #setEvent(event) {
    const isSame = this.#lastEvent === event;
    this.#lastEvent = event;
    if (!isSame) this.#show();
  }

  #show() {
    const program = pageState.checkResult.value;
    const offset = Number(this.#lastEvent?.at ?? -1);
    const isOfPage = program?.image && program.program === this.#lastEvent?.program && offset >= 0 && offset < program.bytes;
    pageState.robotRun.set({ range: isOfPage ? rangeAt(program.places, offset) : null, isHeld: this.#isHalted });
  }
}
