// Watches what is fetched: what still comes goes on. Where nothing comes, somebody is told after a while, and it ends
// later. Knows no page: the worker has it, too.

const WAITS_MS = 3000;
const HELD_MS = 20_000;

/** @typedef {{waits?: (() => void) | undefined, cancelled?: AbortSignal | undefined, came?: (() => void) | undefined, fails?: ((why: unknown) => void) | undefined}} Watching `waits`: nothing has come for a while, told once; `came`: something has; `fails`: not all will come */

export class Progress {
  #end = new AbortController();
  #waits;
  #isOver = false;
  /** @type {ReturnType<typeof setTimeout>[]} */
  #timers = [];

  /** @param {Watching} watching */
  constructor({ waits = () => {}, cancelled }) {
    this.#waits = waits;
    if (cancelled?.aborted) this.#end.abort();
    cancelled?.addEventListener('abort', () => this.#end.abort(), { signal: this.#end.signal });
    this.came();
  }

  /** Aborted when it is cancelled, or by a TimeoutError. */
  get signal() { return this.#end.signal; }

  came() {
    this.#clear();
    if (this.#isOver) return;
    this.#timers = [
      setTimeout(() => {
        this.#waits();
        this.#waits = () => {};
      }, WAITS_MS),
      setTimeout(() => this.#end.abort(new DOMException('nothing comes', 'TimeoutError')), HELD_MS),
    ];
  }

  end() {
    this.#isOver = true;
    this.#clear();
  }

  #clear() {
    for (const each of this.#timers) clearTimeout(each);
  }

  /**
   * Waits for what tells of no progress itself, as a module that is fetched.
   * @template T
   * @param {Promise<T>} promise
   * @returns {Promise<T>}
   */
  until(promise) {
    /** @type {Promise<never>} */
    const ended = new Promise((_, reject) => {
      const end = () => reject(this.signal.reason);
      if (this.signal.aborted) end();
      this.signal.addEventListener('abort', end);
    });
    return Promise.race([promise, ended]).finally(() => this.end());
  }
}

/**
 * Fetches, and rejects with a TimeoutError when nothing comes any more.
 * @param {RequestInfo | URL} what
 * @param {RequestInit & Watching} options
 * @param {typeof fetch} by
 */
export async function watchedFetch(what, { waits, cancelled, came = () => {}, fails = () => {}, ...options } = {}, by = fetch) {
  const progress = new Progress({ waits, cancelled });
  progress.signal.addEventListener('abort', () => progress.end());
  try {
    const answer = await by(what, { ...options, signal: progress.signal });
    if (!answer.ok || !answer.body) {
      progress.end();
      return answer;
    }
    const { readable, writable } = new TransformStream({
      transform(part, to) {
        progress.came();
        came();
        to.enqueue(part);
      },
      flush: () => progress.end(),
    });
    answer.body.pipeTo(writable).catch(fails);
    return new Response(readable, { status: answer.status, headers: answer.headers });
  } catch (why) {
    progress.end();
    fails(why);
    throw why;
  }
}

/**
 * Waits for what tells of no progress at all.
 * @template T
 * @param {Promise<T>} promise
 * @param {Watching} watching
 * @returns {Promise<T>}
 */
export function watched(promise, watching) {
  return new Progress(watching).until(promise);
}
