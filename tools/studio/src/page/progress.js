// Watches what is fetched: what still comes goes on. Where nothing comes, somebody is told after a while, and it ends
// later. Knows no page: the worker has it, too.

const WAITS_MS = 3000;
const HELD_MS = 20_000;

/** @typedef {{waits?: (() => void) | undefined, cancelled?: AbortSignal | undefined}} Watching `waits`: nothing has come for a while, told once */

class Progress {
  #end = new AbortController();
  #waits;
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
    this.end();
    this.#timers = [
      setTimeout(() => {
        this.#waits();
        this.#waits = () => {};
      }, WAITS_MS),
      setTimeout(() => this.#end.abort(new DOMException('nothing comes', 'TimeoutError')), HELD_MS),
    ];
  }

  end() {
    for (const each of this.#timers) clearTimeout(each);
  }
}

/**
 * Fetches, and rejects with a TimeoutError when nothing comes any more.
 * @param {RequestInfo | URL} what
 * @param {RequestInit & Watching} options
 * @param {typeof fetch} by
 */
export async function watchedFetch(what, { waits, cancelled, ...options } = {}, by = fetch) {
  const progress = new Progress({ waits, cancelled });
  progress.signal.addEventListener('abort', () => progress.end());
  try {
    const answer = await by(what, { ...options, signal: progress.signal });
    if (!answer.ok || !answer.body) {
      progress.end();
      return answer;
    }
    const body = answer.body.pipeThrough(new TransformStream({
      transform(part, to) {
        progress.came();
        to.enqueue(part);
      },
      flush: () => progress.end(),
    }));
    return new Response(body, { status: answer.status, headers: answer.headers });
  } catch (why) {
    progress.end();
    throw why;
  }
}

/**
 * Waits for what tells of no progress, as a module that is fetched.
 * @template T
 * @param {Promise<T>} promise
 * @param {Watching} watching
 * @returns {Promise<T>}
 */
export function watched(promise, watching) {
  const progress = new Progress(watching);
  /** @type {Promise<never>} */
  const ended = new Promise((_, reject) => {
    const end = () => reject(progress.signal.reason);
    if (progress.signal.aborted) end();
    progress.signal.addEventListener('abort', end);
  });
  return Promise.race([promise, ended]).finally(() => progress.end());
}
