// Watches what is fetched: what still comes goes on. Where nothing comes, somebody is told after a while, and it ends
// later. Knows no page: the worker has it, too.

const NOTICE_MS = 3000;
const TIMEOUT_MS = 20_000;

/** @typedef {{onWait?: (() => void) | undefined, cancelSignal?: AbortSignal | undefined, onProgress?: (() => void) | undefined, onFail?: ((error: unknown) => void) | undefined}} WatchOptions `onWait`: nothing has come for a while, told once; `onProgress`: something has; `onFail`: not all will come */

export class ProgressWatch {
  #controller = new AbortController();
  #onWait;
  #isOver = false;
  /** @type {ReturnType<typeof setTimeout>[]} */
  #timers = [];

  /** @param {WatchOptions} watching */
  constructor({ onWait = () => {}, cancelSignal }) {
    this.#onWait = onWait;
    if (cancelSignal?.aborted) this.#controller.abort();
    cancelSignal?.addEventListener('abort', () => this.#controller.abort(), { signal: this.#controller.signal });
    this.advance();
  }

  /** Aborted when it is cancelled, or by a TimeoutError. */
  get signal() { return this.#controller.signal; }

  advance() {
    this.#clearTimers();
    if (this.#isOver) return;
    this.#timers = [
      setTimeout(() => {
        this.#onWait();
        this.#onWait = () => {};
      }, NOTICE_MS),
      setTimeout(() => this.#controller.abort(new DOMException('nothing comes', 'TimeoutError')), TIMEOUT_MS),
    ];
  }

  end() {
    this.#isOver = true;
    this.#clearTimers();
  }

  #clearTimers() {
    for (const timer of this.#timers) clearTimeout(timer);
  }

  /**
   * Waits for what tells of no progress itself, as a module that is fetched.
   * @template T
   * @param {Promise<T>} promise
   * @returns {Promise<T>}
   */
  watch(promise) {
    /** @type {Promise<never>} */
    const abortPromise = new Promise((_, reject) => {
      const rejectAborted = () => reject(this.signal.reason);
      if (this.signal.aborted) rejectAborted();
      this.signal.addEventListener('abort', rejectAborted);
    });
    return Promise.race([promise, abortPromise]).finally(() => this.end());
  }
}

/**
 * Fetches, and rejects with a TimeoutError when nothing comes any more.
 * @param {RequestInfo | URL} resource
 * @param {RequestInit & WatchOptions} options
 * @param {typeof fetch} fetcher
 */
export async function watchedFetch(resource, { onWait, cancelSignal, onProgress = () => {}, onFail = () => {}, ...options } = {}, fetcher = fetch) {
  const progress = new ProgressWatch({ onWait, cancelSignal });
  const fail = (/** @type {unknown} */ error) => {
    progress.end();
    onFail(error);
  };
  try {
    const answer = await fetcher(resource, { ...options, signal: progress.signal });
    if (!answer.ok || !answer.body) {
      progress.end();
      return answer;
    }
    const { readable, writable } = new TransformStream({
      transform(chunk, controller) {
        progress.advance();
        onProgress();
        controller.enqueue(chunk);
      },
      flush: () => progress.end(),
    });
    answer.body.pipeTo(writable).catch(fail);
    return new Response(readable, { status: answer.status, headers: answer.headers });
  } catch (error) {
    fail(error);
    throw error;
  }
}

/**
 * Waits for what tells of no progress at all.
 * @template T
 * @param {Promise<T>} promise
 * @param {WatchOptions} options
 * @returns {Promise<T>}
 */
export function watchPromise(promise, options) {
  return new ProgressWatch(options).watch(promise);
}
