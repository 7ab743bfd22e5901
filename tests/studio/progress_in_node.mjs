// What is fetched, on a clock of the test: node progress_in_node.mjs SOURCES; prints what became of each.

import { mock } from 'node:test';

const { Progress, watchPromise, watchedFetch } = await import(`${process.argv[2]}/page/progress.js`);

mock.timers.enable({ apis: ['setTimeout'] });
const settle = () => new Promise((resolve) => setImmediate(resolve));

/** @param {(put: ReadableStreamDefaultController, watching: AbortController) => Promise<void>} act */
async function fetched(act) {
  let put, waits = 0;
  const cancelling = new AbortController();
  const by = async (_, { signal }) => new Response(new ReadableStream({
    start(controller) {
      put = controller;
      signal.addEventListener('abort', () => controller.error(signal.reason));
    },
  }));
  const found = watchedFetch('x', { onWait: () => { waits += 1; }, cancelSignal: cancelling.signal }, by)
    .then((answer) => answer.text()).catch((why) => why.name);
  await settle();
  await act(put, cancelling);
  return `${await found} ${waits}`;
}

async function passes(milliseconds) {
  await settle();
  mock.timers.tick(milliseconds);
  await settle();
}

const told = [];
told.push(await fetched(async (put) => {
  for (const part of 'slow') {
    await passes(19_000);
    put.enqueue(new TextEncoder().encode(part));
  }
  await settle();
  put.close();
}));
told.push(await fetched(async (put) => {
  for (const part of 'quick') {
    await passes(2900);
    put.enqueue(new TextEncoder().encode(part));
  }
  await settle();
  put.close();
}));
told.push(await fetched(async (put) => {
  put.enqueue(new TextEncoder().encode('half'));
  await passes(19_999);
  await passes(2);
}));
told.push(await fetched(async (_, cancelling) => cancelling.abort()));
let waits = 0;
const never = watchPromise(new Promise(() => {}), { onWait: () => { waits += 1; } }).catch((why) => why.name);
await passes(3001);
await passes(17_000);
told.push(`${await never} ${waits}`);
const cancelSignal = AbortSignal.abort();
told.push(await watchPromise(new Promise(() => {}), { cancelSignal }).catch((why) => why.name));
told.push(await watchPromise(Promise.resolve('there'), {}));
const over = new Progress({ onWait: () => { waits += 1; } });
waits = 0;
over.end();
over.advance(); // of somebody who does not know that it is over
await passes(25_000);
told.push(`${waits} ${over.signal.aborted}`);
console.log(JSON.stringify(told));
