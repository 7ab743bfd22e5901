// Until where a page of a group has heard what its class tells. A class that has begun anew, after a crash, counts anew
// and has another key. Knows no class.

/** @typedef {import('../robot/panel.js').GroupRobotEvent} GroupRobotEvent */

export class NewsCursor {
  #key = '';
  #version = 0; // of who is here, and where: that of the newest answer, which is what the page shows
  #runNumber = 0; // of the newest event of the group's robot

  /** What the class is asked with, so that it tells what is new. @returns {{saw: number, ran: [string, number]}} */
  get position() {
    return { saw: this.#version, ran: [this.#key, this.#runNumber] };
  }

  /** Takes an answer; two may tell the same, and come in any order. @param {{saw: number, ran: [string, number], runs?: GroupRobotEvent[]}} news @returns {GroupRobotEvent[]} what the robot has told that is new */
  take({ saw: version, ran: [key, newestNumber], runs = [] }) {
    const knownNumber = key === this.#key ? this.#runNumber : 0;
    this.#key = key;
    this.#version = version;
    this.#runNumber = Math.max(knownNumber, newestNumber);
    return runs.filter(({ number }) => number > knownNumber);
  }
}
