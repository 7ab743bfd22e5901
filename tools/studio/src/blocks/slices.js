// Work in slices: whoever presses a button meanwhile is heard.

const SLICE_MS = 8;

/**
 * Does all steps of a work; between slices of them the page does what is asked of it. Each slice is one
 * call of `runSlice`.
 * @template T
 * @param {Iterator<void, T>} steps
 * @param {(slice: () => void) => void} [runSlice]
 * @returns {Promise<T>}
 */
export async function runInSlices(steps, runSlice = (slice) => slice()) {
  for (;;) {
    /** @type {IteratorResult<void, T> | undefined} */
    let step;
    runSlice(() => {
      const deadline_ms = performance.now() + SLICE_MS;
      do step = steps.next(); while (!step.done && performance.now() < deadline_ms);
    });
    if (step?.done) return step.value;
    await waitForNextTurn();
  }
}

/** What was asked meanwhile comes first: a message is behind it. */
export function waitForNextTurn() {
  return new Promise((resolve) => { setTimeout(resolve, 0); });
}

/** Does all steps at once. @template T @param {Iterator<void, T>} steps @returns {T} */
export function runAtOnce(steps) {
  let step = steps.next();
  while (!step.done) step = steps.next();
  return step.value;
}
