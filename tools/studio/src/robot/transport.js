// What all transports to a robot have in common: what they say, and how they fail.

/**
 * @typedef {object} About what a robot says of itself
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
 * @property {About} [robot]
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
 * Who hears of a robot: `over` comes once, when the connection has ended.
 * @typedef {object} Heard
 * @property {(event: RobotEvent) => void} event
 * @property {(why: Failed) => void} over
 */

/**
 * @typedef {object} Transport to a connected robot
 * @property {(request: Record<string, unknown>) => Promise<Answer>} ask
 * @property {(held: import('../remote/held.js').Held) => Promise<Answer>} press
 * @property {() => void} stop
 * @property {() => void} leave
 */

/** Why there is no connection: a text `why_…`, and what somebody else says of it. */
export class Failed extends Error {
  /**
   * @param {string} reason
   * @param {string} said
   */
  constructor(reason, said = '') {
    super(reason);
    this.reason = reason;
    this.said = said;
  }
}

/** What is asked of a robot, and who waits for it; how it is sent is each way's own. */
export class Asking {
  isOver = false;
  /** What has not been sent yet. @type {Record<string, unknown>[]} */
  asked = [];
  timer = 0; // until it sends the next time
  /** @type {Map<unknown, {resolve: (answer: Answer) => void, reject: (why: Error) => void}>} */
  #waiting = new Map();
  #count = 0;
  #heard;

  /** @param {Heard} heard */
  constructor(heard) {
    this.#heard = heard;
  }

  /** @param {Record<string, unknown>} request @returns {Promise<Answer>} */
  ask(request) {
    const id = ++this.#count;
    return new Promise((resolve, reject) => {
      if (this.isOver) {
        reject(new Failed('left'));
        return;
      }
      this.#waiting.set(id, { resolve, reject });
      this.asked.push({ ...request, id });
      this.go();
    });
  }

  /**
   * Says what is held of a remote control. It takes the place of what was not sent yet, and is not sent again: that would
   * press a key that was let go.
   * @param {import('../remote/held.js').Held} held
   */
  press(held) {
    this.asked = this.withoutKeys(this.asked);
    return this.ask({ do: 'keys', ...held });
  }

  /** What is asked but for keys, whose askers hear that they were not sent. @param {Record<string, unknown>[]} asked */
  withoutKeys(asked) {
    return asked.filter((each) => {
      if (each['do'] !== 'keys') return true;
      this.#waiting.get(each['id'])?.resolve({ failure: 'replaced' });
      this.#waiting.delete(each['id']);
      return false;
    });
  }

  /** Sends what is asked. */
  async go() {}

  /** @param {any} news an event, or an answer */
  take(news) {
    if (news.event) this.#heard.event(news);
    else {
      this.#waiting.get(news.id)?.resolve(news);
      this.#waiting.delete(news.id);
    }
  }

  /** The connection has ended. @param {Failed} why */
  end(why) {
    this.isOver = true;
    clearTimeout(this.timer);
    for (const waiting of this.#waiting.values()) waiting.reject(why);
    this.#waiting.clear();
    this.#heard.over(why);
  }
}

/** @param {number} milliseconds */
export function pause(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/**
 * Waits for something at most so long; rejects with a Failed then.
 * @template T
 * @param {number} milliseconds
 * @param {Promise<T>} promise
 * @param {string} why
 * @returns {Promise<T>}
 */
export function within(milliseconds, promise, why) {
  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let timer;
  /** @type {Promise<never>} */
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Failed(why)), milliseconds);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}
