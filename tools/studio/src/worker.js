// The worker: Python, and in it the compiler of this project itself.

import { loadPyodide } from 'pyodide';
import { Progress, watchedFetch } from './page/progress.js';
// Nothing is installed: all modules are in the archives.
import languages from '../made/languages.json';
import lock from '../made/lock.json';

postMessage({ id: 0, begun: true });
const waits = () => postMessage({ id: 0, waits: true });
const plainFetch = self.fetch.bind(self);
// Pyodide's own module. An import tells of no progress: while something else comes, the line carries it, too.
const module = new Progress({ onWait: waits });
const came = () => module.advance();
// What is held on its way ends, and the page is told before. Pyodide waits for ever for what it has not got.
const fails = (/** @type {unknown} */ why) => postMessage({ id: 0, error: String(why) });
self.fetch = (what, options) => watchedFetch(what, { ...options, onWait: waits, onProgress: came, onFail: fails }, plainFetch);

const SOURCE = languages[0]?.[0] ?? ''; // the language that is always there

/** @param {string} name */
async function fetched(name) {
  const found = await watchedFetch(`./${name}`, { onWait: waits, onProgress: came }, plainFetch).catch((why) => {
    throw new Error(`${name}: ${why}`);
  });
  if (!found.ok) throw new Error(`${name}: ${found.status}`);
  return found.arrayBuffer();
}

/** The languages that Python speaks. @type {Set<string>} */
const learnt = new Set();
/** Those that are fetched: what is kept for long waits for its language. @type {Map<string, Promise<unknown>>} */
const coming = new Map();

async function begin() {
  const imported = module.watch(import(new URL('./pyodide.asm.mjs', self.location.href).href));
  const archive = fetched('tiniscript.zip');
  const wanted = [...new Set([SOURCE, self.name || SOURCE])];
  const messages = wanted.map((language) => fetched(`messages.${language}.json`).catch((why) => {
    if (language === SOURCE) throw why;
    return null;
  }));
  const [python] = await Promise.all([
    loadPyodide({
      indexURL: new URL('./', self.location.href).href,
      stdLibURL: new URL('./python.zip', self.location.href).href,
      lockFileContents: /** @type {any} */ (lock),
      packageBaseUrl: new URL('./', self.location.href).href,
    }),
    imported,
  ]);
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
  /** @param {string} language @param {ArrayBuffer | null} data its messages */
  const learn = (language, data) => {
    if (data) ask(JSON.stringify({ do: 'learn', language }), new Uint8Array(data));
    if (data) learnt.add(language);
  };
  (await Promise.all(messages)).forEach((data, k) => learn(wanted[k] ?? '', data));
  return { ask, unpack, learn };
}

addEventListener('unhandledrejection', ({ reason }) => postMessage({ id: 0, error: String(reason) }));

const python = begin();
python.then(
  () => postMessage({ id: 0 }),
  (why) => postMessage({ id: 0, error: String(why) }),
);

/** What is fetched once it is needed, until that was possible. @type {Map<string, Promise<void>>} */
const archives = new Map();

/** @param {string} name */
function need(name) {
  const coming = archives.get(name) ?? Promise.all([python, fetched(name)]).then(([{ unpack }, data]) => unpack(data));
  archives.set(name, coming);
  coming.catch(() => archives.delete(name));
  return coming;
}

addEventListener('message', async ({ data: { id, request, data } }) => {
  try {
    const { ask, learn } = await python;
    const asked = JSON.parse(request);
    const { language } = asked;
    if (asked.do.startsWith('lesson_')) await Promise.all([need('lessons.zip'), coming.get(language)?.catch(() => null)]);
    if (asked.do.startsWith('group_')) await need('together.zip');
    if (asked.do === 'learn') {
      if (!learnt.has(language)) {
        coming.set(language, fetched(`messages.${language}.json`).then((found) => learn(language, found)));
        await coming.get(language);
      }
      postMessage({ id, answer: '{}' });
      return;
    }
    if (language && !learnt.has(language)) asked.language = SOURCE;
    postMessage({ id, answer: ask(JSON.stringify(asked), data) });
  } catch (why) {
    postMessage({ id, error: String(why) });
  }
});
