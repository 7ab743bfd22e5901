// The worker: Python, and in it the compiler of this project itself.

import { loadPyodide } from 'pyodide';
// Nothing is installed: all modules are in the archives.
import lock from '../made/lock.json';

/** @param {string} name */
async function fetched(name) {
  const found = await fetch(`./${name}`).catch((why) => {
    throw new Error(`${name}: ${why}`);
  });
  if (!found.ok) throw new Error(`${name}: ${found.status}`);
  return found.arrayBuffer();
}

async function begin() {
  const archive = fetched('tiniscript.zip');
  const python = await loadPyodide({
    indexURL: new URL('./', self.location.href).href,
    stdLibURL: new URL('./python.zip', self.location.href).href,
    lockFileContents: /** @type {any} */ (lock),
    packageBaseUrl: new URL('./', self.location.href).href,
  });
  python.FS.mkdirTree('/studio');
  /** @param {ArrayBuffer} data */
  const unpack = (data) => python.unpackArchive(data, 'zip', { extractDir: '/studio' });
  unpack(await archive);
  const ask = python.runPython(`
import sys
sys.path.insert(0, "/studio")
from tiniscript.studio.worker import answer
lambda request, data: answer(request, data.to_bytes())
`);
  return { ask, unpack };
}

addEventListener('unhandledrejection', ({ reason }) => postMessage({ id: 0, error: String(reason) }));

const python = begin();
python.then(
  () => postMessage({ id: 0 }),
  (why) => postMessage({ id: 0, error: String(why) }),
);

/** @type {Promise<void> | null} */
let lessons = null;

/** Fetches the lessons, once that was possible. */
function needLessons() {
  lessons ??= Promise.all([python, fetched('lessons.zip')]).then(([{ unpack }, data]) => unpack(data));
  lessons.catch(() => {
    lessons = null;
  });
  return lessons;
}

addEventListener('message', async ({ data: { id, request, data } }) => {
  try {
    const { ask } = await python;
    if (request.startsWith('{"do":"lesson_')) await needLessons();
    postMessage({ id, answer: ask(request, data) });
  } catch (why) {
    postMessage({ id, error: String(why) });
  }
});
