// What is waited for, on a clock of the test: node progress_in_node.mjs SOURCES; prints what became of each.

import { mock } from 'node:test';

const { ProgressWatch, watchPromise } = await import(`${process.argv[2]}/page/progress.js`);

mock.timers.enable({ apis: ['setTimeout'] });
const settle = () => new Promise((resolve) => setImmediate(resolve));

async function wait(milliseconds) {
  await settle();
  mock.timers.tick(milliseconds);
  await settle();
}

const told = [];
let waitCount = 0;
const never = watchPromise(new Promise(() => {}), { onWait: () => { waitCount += 1; } }).catch((error) => error.name);
await wait(3001);
await wait(17_000);
told.push(`${await never} ${waitCount}`);
const cancelSignal = AbortSignal.abort();
told.push(await watchPromise(new Promise(() => {}), { cancelSignal }).catch((error) => error.name));
told.push(await watchPromise(Promise.resolve('there'), {}));
const over = new ProgressWatch({ onWait: () => { waitCount += 1; } });
waitCount = 0;
over.end();
over.advance(); // of somebody who does not know that it is over
await wait(25_000);
told.push(`${waitCount} ${over.signal.aborted}`);
console.log(JSON.stringify(told));
