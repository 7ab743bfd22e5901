// A robot at a port that this browser has opened itself. The session with it is the link's own, in
// the worker; the bytes come and go here.
//
// The main thread owns the port and asks the session for every byte: when it hangs or the page
// sleeps, nothing is sent, and the robot stops by itself.

import { RequestQueue, ConnectionFailure, pause, withTimeout } from './transport.js';
import { LINK, robotOf } from '../page/words.js';

/** @import { RobotListener, RobotInfo } from './transport.js' */

/**
 * What carries bytes. `write` keeps the order; `onDisconnect` is called once, when nothing is carried any more.
 * @typedef {object} Port
 * @property {boolean} isRadio
 * @property {string} lossReason why the connection is over when the port is
 * @property {(onData: (data: Uint8Array) => void, onDisconnect: () => void) => Promise<void>} open rejects with a ConnectionFailure
 * @property {(data: Uint8Array) => Promise<void>} write
 * @property {() => Promise<void>} close
 */

/**
 * Where the keys of robots are stored, as the text of a file of keys; other tabs change it, too.
 * @typedef {object} KeyStore
 * @property {() => string} load
 * @property {(keys: string) => unknown} store
 */

const OPEN_LIMIT_MS = 20_000; // a radio that looks for its robot
const LONGEST_WAIT_MS = 100; // between two looks at the latest
const CLOSE_LIMIT_MS = 10_000; // for the last write and the end of a port: the next connection waits no longer
const STOP_BYTES = new Uint8Array(LINK.stop_bytes); // zeros stop a robot, whatever it hears
const LOCK_NAME = 'tiniscript-robot';
/** What is said of bytes that are no robot's yet: it may answer late. */
const LATE_FAILURES = new Set(['link_other', 'link_foreign']);

/** The connections before, until their ports are closed. @type {Promise<unknown>} */
let closingPorts = Promise.resolve();

export class DirectRobot extends RequestQueue {
  #python;
  #port;
  #isOpen = false;
  #isExchanging = false;
  #isExchangeDue = false;
  #byteCount = 0;
  /** @type {number[]} */
  #receivedBytes = [];
  #unlock = () => {};
  /** @type {(error: Error) => void} */
  #rejectConnect = () => {};
  #keyStore;
  /** The keys that the session knows to be stored. */
  #storedKeys = '';

  /**
   * @param {import('../python.js').Python} python
   * @param {Port} port
   * @param {RobotListener} listener
   * @param {KeyStore} keyStore
   */
  constructor(python, port, listener, keyStore) {
    super(listener);
    this.#python = python;
    this.#port = port;
    this.#keyStore = keyStore;
  }

  /**
   * Connects; rejects with a ConnectionFailure.
   * @param {string} robotName
   * @param {string} language
   * @returns {Promise<RobotInfo>}
   */
  async connect(robotName, language) {
    /** @type {Promise<never>} */
    const disconnection = new Promise((_, reject) => {
      this.#rejectConnect = reject;
    });
    return Promise.race([this.#open(robotName, language), disconnection]);
  }

  /** @param {string} robotName @param {string} language */
  async #open(robotName, language) {
    try {
      await closingPorts;
      await this.#acquireLock();
      this.#storedKeys = this.#keyStore.load();
      await this.#python.ask({ do: 'connect', robot: robotName, language }, new TextEncoder().encode(this.#storedKeys));
      if (this.isOver) throw new ConnectionFailure('left'); // nothing of it is in the way of the next one
      const opening = this.#port.open(
        (data) => {
          this.#byteCount += data.length;
          for (const byte of data) this.#receivedBytes.push(byte);
          this.send();
        },
        () => this.end(new ConnectionFailure(this.#port.lossReason)),
      );
      opening.then(async () => {
        if (this.isOver) await this.#port.close(); // it was left meanwhile
      }).catch(() => {});
      await withTimeout(OPEN_LIMIT_MS, opening, 'link_silent');
      this.#isOpen = true;
      return await this.#sayHello(robotName);
    } catch (error) {
      const failure = error instanceof ConnectionFailure ? error : new ConnectionFailure('bug', String(error));
      this.end(failure);
      throw failure;
    }
  }

  /** Another tab that drives a robot of its own keeps it. */
  #acquireLock() {
    if (!navigator.locks) return Promise.resolve();
    return new Promise((resolve, reject) => {
      navigator.locks.request(LOCK_NAME, { ifAvailable: true }, (lock) => {
        if (!lock || this.isOver) {
          reject(new ConnectionFailure('other_tab'));
          return undefined;
        }
        resolve(undefined);
        return new Promise((release) => {
          this.#unlock = () => release(undefined);
        });
      });
    });
  }

  /** @param {string} robotName @returns {Promise<RobotInfo>} */
  async #sayHello(robotName) {
    let answer;
    if (this.#port.isRadio) answer = await this.ask({ do: 'hello', limit_ms: LINK.radio_answer_ms });
    else {
      // Bytes that come too early keep a board in its bootloader.
      await pause(robotOf(robotName)?.quiet_ms ?? 0);
      answer = await this.ask({ do: 'hello', limit_ms: LINK.cable_answer_ms });
      if (!answer.ok && !this.#byteCount) {
        await pause(LINK.long_quiet_ms);
        answer = await this.ask({ do: 'hello', limit_ms: LINK.cable_answer_ms });
      }
      // What is heard may be a robot that answers late.
      if (LATE_FAILURES.has(answer.failure ?? '')) answer = await this.ask({ do: 'hello', limit_ms: LINK.radio_answer_ms });
    }
    if (!answer.robot) throw new ConnectionFailure(answer.failure ?? 'bug', [answer.said, answer.advice].join(' ').trim());
    return answer.robot;
  }

  /** Stops the robot: at once, and again until it confirms. What waits is not done. */
  stop() {
    if (this.isOver) return;
    this.#port.write(STOP_BYTES).catch(() => {});
    for (const { id } of this.requests.splice(0)) this.handleNews({ id, failure: 'stopped_elsewhere' });
    this.ask({ do: 'stop' }).catch(() => {});
  }

  /** Stops the robot and closes the port. */
  leave() {
    if (this.isOver) return;
    const lastWrite = this.#port.write(STOP_BYTES).catch(() => {});
    this.end(new ConnectionFailure('left'), lastWrite);
  }

  async send() {
    if (this.isOver || !this.#isOpen) return;
    if (this.#isExchanging) {
      this.#isExchangeDue = true;
      return;
    }
    this.#isExchanging = true;
    clearTimeout(this.sendTimer);
    let wait_ms = LONGEST_WAIT_MS;
    try {
      do {
        this.#isExchangeDue = false;
        const now_ms = Math.floor(performance.now());
        const data = new Uint8Array(this.#receivedBytes.splice(0));
        const requests = this.requests.splice(0);
        const answer = await this.#python.ask({ do: 'link', now_ms, asked: requests, ...this.#takeChangedKeys() }, data);
        const areKeysStored = !answer.keys || this.#storeKeys(answer.keys); // before the robot gets one
        if (this.isOver) return;
        if (!areKeysStored) this.#isExchangeDue = true; // the session repeats what it has sent
        else if (answer.send) await this.#port.write(bytesOf(answer.send));
        for (const news of answer.news) {
          this.handleNews(news);
          await undefined; // who has asked hears its answer before what comes next
        }
        if (answer.wakes_ms !== null) wait_ms = Math.max(0, Math.min(LONGEST_WAIT_MS, answer.wakes_ms - performance.now()));
      } while (this.#isExchangeDue && !this.isOver);
    } catch (error) {
      this.end(error instanceof ConnectionFailure ? error : new ConnectionFailure(this.#port.lossReason, ''));
    } finally {
      this.#isExchanging = false;
    }
    if (!this.isOver) this.sendTimer = window.setTimeout(() => this.send(), wait_ms);
  }

  /** The stored keys, if somebody else has changed them, such as another tab. */
  #takeChangedKeys() {
    const kept = this.#keyStore.load();
    if (kept === this.#storedKeys) return {};
    this.#storedKeys = kept;
    return { kept };
  }

  /** Stores the session's keys if it knows those that are stored; returns whether it does. @param {string} keys */
  #storeKeys(keys) {
    if (this.#keyStore.load() !== this.#storedKeys) return false;
    this.#storedKeys = keys;
    this.#keyStore.store(keys);
    return true;
  }

  /** @param {ConnectionFailure} failure @param {Promise<unknown>} [lastWrite] */
  end(failure, lastWrite = Promise.resolve()) {
    if (this.isOver) return;
    closingPorts = Promise.all([closingPorts, withTimeout(CLOSE_LIMIT_MS, lastWrite.then(() => this.#port.close()), 'port_stuck')
      .catch(() => {})
      .finally(() => this.#unlock())]);
    this.#rejectConnect(failure);
    super.end(failure);
  }
}

/** @param {string} hexDigits */
function bytesOf(hexDigits) {
  return new Uint8Array(hexDigits.match(/../g)?.map((pair) => parseInt(pair, 16)) ?? []);
}
