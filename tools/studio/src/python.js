// Asks the Python in the worker. Knows the form of requests and answers, and no program.

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
 * @property {Change[]} [repair] what its button does, as soon as it has been tried
 */

/**
 * @typedef {object} Checked
 * @property {string} image hexadecimal; empty where there are mistakes
 * @property {string} program the image's checksum, in hexadecimal; empty where there are mistakes
 * @property {number} bytes of code
 * @property {Finding[]} findings
 * @property {[number, number, number, number, number][]} places offset, line, column and the end
 * @property {{name: string, is_yes_no: boolean}[]} variables
 * @property {string} start SI, SB or PING; empty where there are mistakes
 * @property {string} robot that it was compiled for
 * @property {boolean} names_robot whether the text names it
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
 * @property {{taken: number, of: number, points: number, stars: number} | null} score of the flags of its world
 * @property {(number | null)[]} actuators null of one that has not been set, or is released
 * @property {number | null} at where the program is, or what it does next where it is held
 * @property {number[]} places where each of its tasks is
 * @property {boolean} is_held
 * @property {number[]} variables
 * @property {number | null} fault_at
 * @property {{value: number, text: string}[]} readings
 * @property {[number, string][]} events
 */

/** @typedef {{resolve: (answer: any) => void, reject: (why: Error) => void}} Waiting */

const WORD_MS = 3000;

export class Python {
  #worker;
  /** @type {Map<number, Waiting>} */
  #waiting = new Map();
  #asked = 0;
  /** @type {(why: Error) => void} */
  #fails = () => {};
  /** Nothing has come of what Python needs for a while. */
  waits = () => {};
  /** Resolves when it answers; rejects when it cannot be had. @type {Promise<void>} */
  ready;

  /** @param {string} language to begin with */
  constructor(language) {
    this.#worker = new Worker('./worker.js', { type: 'module', name: language });
    this.ready = new Promise((resolve, reject) => {
      const word = setTimeout(() => this.waits(), WORD_MS); // the worker itself does not come
      this.#worker.addEventListener('message', ({ data }) => {
        clearTimeout(word);
        if (data.begun) return;
        if (data.waits) {
          this.waits();
          return;
        }
        if (data.id === 0) {
          if (data.error) reject(new Error(data.error));
          else resolve();
          return;
        }
        const waiting = this.#waiting.get(data.id);
        this.#waiting.delete(data.id);
        if (data.error) waiting?.reject(new Error(data.error));
        else waiting?.resolve(JSON.parse(data.answer));
      });
      this.#fails = reject;
      this.#worker.addEventListener('error', (event) => {
        const why = new Error(event.message || 'worker');
        this.#fails(why);
        for (const waiting of this.#waiting.values()) waiting.reject(why);
        this.#waiting.clear();
      });
    });
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {Uint8Array} [data]
   * @returns {Promise<any>}
   */
  ask(request, data = new Uint8Array()) {
    const id = ++this.#asked;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject });
      this.#worker.postMessage({ id, request: JSON.stringify(request), data });
    });
  }
}
