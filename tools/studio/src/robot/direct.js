// A robot at a port that this browser has opened itself. The session with it is the link's own, in
// the worker; the bytes come and go here.
//
// The main thread owns the port and asks the session for every byte: when it hangs or the page
// sleeps, nothing is sent, and the robot stops by itself.

import { Asking, Failed, pause, within } from './transport.js';
import { LINK, robotOf } from '../page/words.js';

/** @import { Heard, About } from './transport.js' */

/**
 * What carries bytes. `write` keeps the order; `gone` comes once, when nothing is carried any more.
 * @typedef {object} Port
 * @property {boolean} isRadio
 * @property {string} goneBy why the connection is over when the port is
 * @property {(heard: (data: Uint8Array) => void, gone: () => void) => Promise<void>} open rejects with a Failed
 * @property {(data: Uint8Array) => Promise<void>} write
 * @property {() => Promise<void>} close
 */

const OPEN_MS = 20_000; // a radio that looks for its robot
const LOOK_MS = 100; // between two looks at the latest
const CLOSE_MS = 10_000; // for the last write and the end of a port: the next connection waits no longer
const STOP = new Uint8Array(LINK.stop_bytes); // zeros stop a robot, whatever it hears
const LOCK = 'tiniscript-robot';
/** What is said of bytes that are no robot's yet: it may answer late. */
const LATE = new Set(['link_other', 'link_foreign']);

/** The connections before, until their ports are closed. @type {Promise<unknown>} */
let parting = Promise.resolve();

export class DirectRobot extends Asking {
  #python;
  #port;
  #isOpen = false;
  #isGoing = false;
  #isAgain = false;
  #bytes = 0;
  /** @type {number[]} */
  #came = [];
  #unlock = () => {};
  /** @type {(why: Error) => void} */
  #fails = () => {};
  #keepKeys;

  /**
   * @param {import('../python.js').Python} python
   * @param {Port} port
   * @param {Heard} heard
   * @param {(keys: string) => unknown} keepKeys
   */
  constructor(python, port, heard, keepKeys) {
    super(heard);
    this.#python = python;
    this.#port = port;
    this.#keepKeys = keepKeys;
  }

  /**
   * Connects; rejects with a Failed.
   * @param {string} robot
   * @param {string} language
   * @param {string} keys
   * @returns {Promise<About>}
   */
  async connect(robot, language, keys) {
    /** @type {Promise<never>} */
    const disconnected = new Promise((_, reject) => {
      this.#fails = reject;
    });
    return Promise.race([this.#open(robot, language, keys), disconnected]);
  }

  /** @param {string} robot @param {string} language @param {string} keys */
  async #open(robot, language, keys) {
    try {
      await parting;
      await this.#lock();
      await this.#python.ask({ do: 'connect', robot, language }, new TextEncoder().encode(keys));
      if (this.isOver) throw new Failed('left'); // nothing of it is in the way of the next one
      const opening = this.#port.open(
        (data) => {
          this.#bytes += data.length;
          for (const byte of data) this.#came.push(byte);
          this.go();
        },
        () => this.end(new Failed(this.#port.goneBy)),
      );
      opening.then(async () => {
        if (this.isOver) await this.#port.close(); // it was left meanwhile
      }).catch(() => {});
      await within(OPEN_MS, opening, 'link_silent');
      this.#isOpen = true;
      return await this.#meet(robot);
    } catch (why) {
      const failed = why instanceof Failed ? why : new Failed('bug', String(why));
      this.end(failed);
      throw failed;
    }
  }

  /** Another tab that drives a robot of its own keeps it. */
  #lock() {
    if (!navigator.locks) return Promise.resolve();
    return new Promise((resolve, reject) => {
      navigator.locks.request(LOCK, { ifAvailable: true }, (lock) => {
        if (!lock || this.isOver) {
          reject(new Failed('other_tab'));
          return undefined;
        }
        resolve(undefined);
        return new Promise((release) => {
          this.#unlock = () => release(undefined);
        });
      });
    });
  }

  /** @param {string} robot @returns {Promise<About>} */
  async #meet(robot) {
    let answer;
    if (this.#port.isRadio) answer = await this.ask({ do: 'hello', limit_ms: LINK.radio_answer_ms });
    else {
      // Bytes that come too early keep a board in its bootloader.
      await pause(robotOf(robot)?.quiet_ms ?? 0);
      answer = await this.ask({ do: 'hello', limit_ms: LINK.cable_answer_ms });
      if (!answer.ok && !this.#bytes) {
        await pause(LINK.long_quiet_ms);
        answer = await this.ask({ do: 'hello', limit_ms: LINK.cable_answer_ms });
      }
      // What is heard may be a robot that answers late.
      if (LATE.has(answer.failure ?? '')) answer = await this.ask({ do: 'hello', limit_ms: LINK.radio_answer_ms });
    }
    if (!answer.robot) throw new Failed(answer.failure ?? 'bug', [answer.said, answer.advice].join(' ').trim());
    return answer.robot;
  }

  /** Stops the robot: at once, and again until it confirms. What waits is not done. */
  stop() {
    if (this.isOver) return;
    this.#port.write(STOP).catch(() => {});
    for (const { id } of this.asked.splice(0)) this.take({ id, failure: 'stopped_elsewhere' });
    this.ask({ do: 'stop' }).catch(() => {});
  }

  /** Stops the robot and closes the port. */
  leave() {
    if (this.isOver) return;
    const last = this.#port.write(STOP).catch(() => {});
    this.end(new Failed('left'), last);
  }

  async go() {
    if (this.isOver || !this.#isOpen) return;
    if (this.#isGoing) {
      this.#isAgain = true;
      return;
    }
    this.#isGoing = true;
    clearTimeout(this.timer);
    let wakes = LOOK_MS;
    try {
      do {
        this.#isAgain = false;
        const now_ms = Math.floor(performance.now());
        const data = new Uint8Array(this.#came.splice(0));
        const asked = this.asked.splice(0);
        const answer = await this.#python.ask({ do: 'link', now_ms, asked }, data);
        if (this.isOver) return;
        if (answer.send) await this.#port.write(bytesOf(answer.send));
        if (answer.keys) this.#keepKeys(answer.keys);
        for (const each of answer.news) {
          this.take(each);
          await undefined; // who has asked hears its answer before what comes next
        }
        if (answer.wakes_ms !== null) wakes = Math.max(0, Math.min(LOOK_MS, answer.wakes_ms - performance.now()));
      } while (this.#isAgain && !this.isOver);
    } catch (why) {
      this.end(why instanceof Failed ? why : new Failed(this.#port.goneBy, ''));
    } finally {
      this.#isGoing = false;
    }
    if (!this.isOver) this.timer = window.setTimeout(() => this.go(), wakes);
  }

  /** @param {Failed} why @param {Promise<unknown>} [before] */
  end(why, before = Promise.resolve()) {
    if (this.isOver) return;
    parting = Promise.all([parting, within(CLOSE_MS, before.then(() => this.#port.close()), 'port_stuck')
      .catch(() => {})
      .finally(() => this.#unlock())]);
    this.#fails(why);
    super.end(why);
  }
}

/** @param {string} digits */
function bytesOf(digits) {
  return new Uint8Array(digits.match(/../g)?.map((pair) => parseInt(pair, 16)) ?? []);
}
