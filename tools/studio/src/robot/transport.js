// What all transports to a robot have in common: what they say, and how they fail.

/**
 * @typedef {object} RobotInfo what a robot says of itself
 * @property {string} name
 * @property {string} id
 * @property {string | null} robot the name of its shipped profile
 * @property {'free' | 'yours' | 'other'} owner
 * @property {number} room
 * @property {boolean} is_running
 * @property {boolean} is_idle nothing runs, and no fault has ended it
 * @property {boolean} has_remote its programs can read a remote control
 * @property {boolean} has_breakpoints its programs can halt
 * @property {boolean} has_readings it tells what its programs read
 */

/**
 * @typedef {object} Answer
 * @property {boolean} [ok]
 * @property {string} [failure]
 * @property {string} [said]
 * @property {string} [advice]
 * @property {string} [program]
 * @property {string} [saved]
 * @property {Trim} [trim]
 * @property {RobotInfo} [robot]
 * @property {number[]} [variables] from the first one on that was asked for
 * @property {[string, number][]} [tasks] state and place of each, the main one last
 */

/**
 * @typedef {object} Trim
 * @property {boolean} is_exchanged
 * @property {boolean} is_left_reversed
 * @property {boolean} is_right_reversed
 * @property {number} balance
 * @property {number} least
 * @property {Pace | null} [pace] none: the robot cannot keep one
 */

/** @typedef {{speed_40: number, speed_80: number, turn_40: number, turn_80: number}} Pace cm and degrees in a second, at 40 and 80 %; 0 is not measured */

/**
 * @typedef {object} RobotEvent
 * @property {string} event
 * @property {string} [value]
 * @property {string} [fault]
 * @property {number} [at]
 * @property {string} [program]
 * @property {boolean} [is_program] one that this page has started, and no line
 * @property {number} [task] that is halted, by its number among the tasks
 * @property {string} [cause]
 * @property {number} [count]
 * @property {string} [text]
 * @property {[number, string][]} [rows] of what the program has read, for its recording
 * @property {number} [ms] of the run, where another page of the group drives the robot
 */

/**
 * Who hears of a robot: `onEnd` comes once, when the connection has ended.
 * @typedef {object} RobotListener
 * @property {(event: RobotEvent) => void} onEvent
 * @property {(failure: ConnectionFailure) => void} onEnd
 */

/**
 * @typedef {object} Transport to a connected robot
 * @property {(request: Record<string, unknown>) => Promise<Answer>} ask
 * @property {(held: import('../remote/held.js').HeldControls) => Promise<Answer>} press
 * @property {() => void} stop
 * @property {() => void} leave
 */

/** Why there is no connection: a text `why_…`, and what somebody else says of it. */
export class ConnectionFailure extends Error {
  /**
   * @param {string} reason
   * @param {string} details
   */
  constructor(reason, details = '') {
    super(reason);
    this.reason = reason;
    this.details = details;
  }
}

/** What is asked of a robot, and who waits for it; how it is sent is each way's own. */
export class RequestQueue {
  isOver = false;
  /** What has not been sent yet. @type {Record<string, unknown>[]} */
  requests = [];
  sendTimer = 0; // until it sends the next time
  /** @type {Map<unknown, {resolve: (answer: Answer) => void, reject: (error: Error) => void}>} */
  #pendingRequests = new Map();
  #requestCount = 0;
  #listener;

  /** @param {RobotListener} listener */
  constructor(listener) {
    this.#listener = listener;
  }

  /** @param {Record<string, unknown>} request @returns {Promise<Answer>} */
  ask(request) {
    const id = ++this.#requestCount;
    return new Promise((resolve, reject) => {
      if (this.isOver) {
        reject(new ConnectionFailure('left'));
        return;
      }
      this.#pendingRequests.set(id, { resolve, reject });
      this.requests.push({ ...request, id });
      this.send();
    });
  }

  /**
   * Says what is held of a remote control. It takes the place of what was not sent yet, and is not sent again: that would
   * press a key that was let go.
   * @param {import('../remote/held.js').HeldControls} controls
   */
  press(controls) {
    this.requests = this.dropKeyRequests(this.requests);
    return this.ask({ do: 'keys', ...controls });
  }

  /** What is asked but for keys, whose askers hear that they were not sent. @param {Record<string, unknown>[]} requests */
  dropKeyRequests(requests) {
    return requests.filter((request) => {
      if (request['do'] !== 'keys') return true;
      this.#pendingRequests.get(request['id'])?.resolve({ failure: 'replaced' });
      this.#pendingRequests.delete(request['id']);
      return false;
    });
  }

  /** Sends what is asked. */
  async send() {}

  /** @param {any} news an event, or an answer */
  handleNews(news) {
    if (news.event) this.#listener.onEvent(news);
    else {
      this.#pendingRequests.get(news.id)?.resolve(news);
      this.#pendingRequests.delete(news.id);
    }
  }

  /** The connection has ended. @param {ConnectionFailure} failure */
  end(failure) {
    this.isOver = true;
    clearTimeout(this.sendTimer);
    for (const pending of this.#pendingRequests.values()) pending.reject(failure);
    this.#pendingRequests.clear();
    this.#listener.onEnd(failure);
  }
}

/** @param {number} duration_ms */
export function pause(duration_ms) {
  return new Promise((resolve) => setTimeout(resolve, duration_ms));
}

/**
 * Waits for something at most so long; rejects with a ConnectionFailure then.
 * @template T
 * @param {number} limit_ms
 * @param {Promise<T>} promise
 * @param {string} reason
 * @returns {Promise<T>}
 */
export function withTimeout(limit_ms, promise, reason) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {Promise<never>} */
  const timeout = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new ConnectionFailure(reason)), limit_ms);
  });
  return Promise.race([promise, timeout]).finally(() => clearTimeout(timer));
}
