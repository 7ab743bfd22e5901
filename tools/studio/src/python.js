// Asks the Python in the worker. Knows the form of requests and answers, and no program.

import { watchPromise } from './page/progress.js';

/**
 * @typedef {object} Change
 * @property {number} line
 * @property {number} column
 * @property {number} end_line
 * @property {number} end_column
 * @property {string} text
 */

/**
 * @typedef {object} Finding
 * @property {string} code
 * @property {'mistake' | 'warning'} severity
 * @property {number} line
 * @property {number} column
 * @property {number} end_line
 * @property {number} end_column
 * @property {string} message
 * @property {string} fix
 * @property {boolean} may_repair
 * @property {{message: string, fix: string, spoken: Record<string, import('./blocks/said.js').SpokenBlock>}} on_blocks its sentences for who sees blocks, with back quotes around code, and what each code is as a block
 * @property {Change[]} [repair] what its button does, as soon as it has been tried
 */

/**
 * @typedef {object} CheckResult
 * @property {string} text that was compiled
 * @property {string} image hexadecimal; empty where there are mistakes
 * @property {string} program the image's checksum, in hexadecimal; empty where there are mistakes
 * @property {number} bytes of code
 * @property {Finding[]} findings
 * @property {[number, number, number, number, number][]} places offset, line, column and the end
 * @property {number[]} halts where a real robot halts before each of these places
 * @property {[number, string, number, number, boolean, boolean][]} shows of the places that are a SHOW with a name: offset, expression, line, column; whether another SHOW has the same expression, and whether on this line
 * @property {{name: string, is_yes_no: boolean}[]} variables
 * @property {string} start SI, SB or PING; empty where there are mistakes
 * @property {string} robot that it was compiled for
 * @property {boolean} names_robot whether the text names it
 * @property {number[]} sensors numbers of the robot's sensors that it reads
 * @property {string[]} remote words of a remote control that it reads
 * @property {number} loose instructions and values that are joined to nothing
 */

/**
 * @typedef {object} RobotState
 * @property {number} now_ms
 * @property {number | null} began_ms
 * @property {[number, number, number]} pose x and y in cm, heading in degrees
 * @property {[number, number]} motors
 * @property {boolean} is_running
 * @property {boolean} is_waiting for its button
 * @property {string} fault
 * @property {number} bumps
 * @property {[number, number] | null} touches where it touches something
 * @property {{taken: number, of: number, pushed: number, rivals: number, has_fallen: boolean, points: number, stars: number} | null} score of the flags and the rivals of its world
 * @property {[number, number, number][]} rivals where each is, and its heading
 * @property {(number | null)[]} actuators null of one that has not been set, or is released
 * @property {Record<string, number>} [turned] how far an actuator that carries a sensor has turned to the left, in degrees
 * @property {number | null} at where the program is, or what it does next where it is held
 * @property {number[]} places where each of its tasks is
 * @property {number | null} driver where the task is that has the motors; null of a program without tasks
 * @property {boolean} is_held
 * @property {number[]} variables
 * @property {number | null} fault_at
 * @property {{value: number, text: string}[]} readings
 * @property {[number, string, number][]} events when and what; of a SHOW also where it is
 * @property {import('./virtual/runs.js').Row[]} [rows] what the file of its run has of that
 * @property {boolean} [is_full] the file has no room for more
 * @property {boolean} [is_over] a recorded run that is played has ended
 * @property {Parting | null} [parting] where it and the recorded one part
 */

/**
 * @typedef {object} Parting
 * @property {string} outcome
 * @property {number} agreed
 * @property {number} line
 * @property {{ms: number, event: string} | null} robot
 * @property {{ms: number, event: string} | null} virtual
 * @property {string} sensor
 * @property {number | null} at_ms by the virtual robot's clock
 * @property {number} began_ms from when on the rows count
 */

/** @typedef {{resolve: (answer: any) => void, reject: (error: Error) => void}} PendingRequest */

/**
 * @typedef {object} PythonListener who is told about it until it is there
 * @property {() => void} onWait nothing has come of what it needs for a while
 * @property {() => void} onFail it cannot be had
 * @property {() => void} onBegin it is tried again
 */

export class Python {
  /** @type {Worker | null} */
  #worker = null;
  #isReady = false;
  /** @type {Map<number, PendingRequest>} */
  #pendingRequests = new Map();
  #requestCount = 0;
  #resolveReady = () => {};
  #isLate = false;
  /** @type {PythonListener} */
  #listener = { onWait() {}, onFail() {}, onBegin() {} };
  /** Resolves when it answers, be that at another try. @type {Promise<void>} */
  ready;

  /** @param {string} language to begin with */
  constructor(language) {
    this.ready = new Promise((resolve) => { this.#resolveReady = resolve; });
    this.#startWorker(language);
  }

  /** Whether it is not there, and nothing has come for a while. */
  get isLate() { return this.#isLate; }

  /** Tells of it from now on, and where it is. @param {PythonListener} listener */
  listen(listener) {
    this.#listener = listener;
    if (!this.#worker) listener.onFail();
    else if (this.#isLate) listener.onWait();
  }

  /** Tries once more where it could not be had. @param {string} language */
  tryAgain(language) {
    if (this.#worker) return;
    this.#startWorker(language);
    this.#listener.onBegin();
  }

  /** @param {string} language */
  #startWorker(language) {
    const worker = this.#worker = new Worker('./worker.js', { type: 'module', name: language });
    /** @type {Promise<void>} */
    const firstMessage = new Promise((resolve) => {
      worker.addEventListener('message', ({ data }) => {
        resolve();
        if (data.begun) return;
        if (data.waits) this.#reportWait(worker);
        else if (data.id === 0) this.#onReadyOrFailed(worker, data.error);
        else {
          const pending = this.#pendingRequests.get(data.id);
          this.#pendingRequests.delete(data.id);
          if (data.error) pending?.reject(new Error(data.error));
          else pending?.resolve(JSON.parse(data.answer));
        }
      });
    });
    watchPromise(firstMessage, { onWait: () => this.#reportWait(worker) }).catch((error) => this.#onReadyOrFailed(worker, String(error)));
    worker.addEventListener('error', (event) => {
      const error = event.message || 'worker';
      this.#rejectAll(error);
      this.#onReadyOrFailed(worker, error);
    });
  }

  /** @param {Worker} worker */
  #reportWait(worker) {
    if (worker !== this.#worker) return;
    this.#isLate = !this.#isReady;
    this.#listener.onWait();
  }

  /** Whether it is there is known now. @param {Worker} worker @param {string} [error] */
  #onReadyOrFailed(worker, error) {
    if (worker !== this.#worker || this.#isReady) return;
    this.#isLate = false;
    if (error) {
      worker.terminate(); // what it waits for may come later: then it is another one's
      this.#worker = null;
      this.#rejectAll(error);
      this.#listener.onFail();
    } else {
      this.#isReady = true;
      this.#resolveReady();
    }
  }

  /** @param {string} reason */
  #rejectAll(reason) {
    for (const pending of this.#pendingRequests.values()) pending.reject(new Error(reason));
    this.#pendingRequests.clear();
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {Uint8Array} [data]
   * @returns {Promise<any>}
   */
  ask(request, data = new Uint8Array()) {
    const id = ++this.#requestCount;
    return new Promise((resolve, reject) => {
      if (!this.#worker) throw new Error('no worker');
      this.#pendingRequests.set(id, { resolve, reject });
      this.#worker.postMessage({ id, request: JSON.stringify(request), data });
    });
  }
}
