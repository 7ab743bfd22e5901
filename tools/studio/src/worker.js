// The worker: Python, and in it the compiler of this project itself.

import { loadPyodide } from 'pyodide';
import { ProgressWatch, watchedFetch } from './page/progress.js';
// Nothing is installed: all modules are in the archives.
import languages from '../made/languages.json';
import lock from '../made/lock.json';

postMessage({ id: 0, begun: true });
const reportWait = () => postMessage({ id: 0, waits: true });
const nativeFetch = self.fetch.bind(self);
// Pyodide's own module. An import tells of no progress: while something else comes, the line carries it, too.
const moduleProgress = new ProgressWatch({ onWait: reportWait });
const advanceModule = () => moduleProgress.advance();
// What is held on its way ends, and the page is told before. Pyodide waits for ever for what it has not got.
const reportError = (/** @type {unknown} */ error) => postMessage({ id: 0, error: String(error) });
self.fetch = (resource, options) => watchedFetch(resource, { ...options, onWait: reportWait, onProgress: advanceModule, onFail: reportError }, nativeFetch);

const SOURCE_LANGUAGE = languages[0]?.[0] ?? ''; // the language that is always there

/** @param {string} name */
async function fetchFile(name) {
  const response = await watchedFetch(`./${name}`, { onWait: reportWait, onProgress: advanceModule }, nativeFetch).catch((error) => {
    throw new Error(`${name}: ${error}`);
  });
  if (!response.ok) throw new Error(`${name}: ${response.status}`);
  return response.arrayBuffer();
}

/** The languages that Python speaks. @type {Set<string>} */
const learntLanguages = new Set();
/** Those that are fetched: what is kept for long waits for its language. @type {Map<string, Promise<unknown>>} */
const learningLanguages = new Map();

async function startPython() {
  const importing = moduleProgress.watch(import(new URL('./pyodide.asm.mjs', self.location.href).href));
  const archiveData = fetchFile('tiniscript.zip');
  const wantedLanguages = [...new Set([SOURCE_LANGUAGE, self.name || SOURCE_LANGUAGE])];
  const messageFiles = wantedLanguages.map((language) => fetchFile(`messages.${language}.json`).catch((error) => {
    if (language === SOURCE_LANGUAGE) throw error;
    return null;
  }));
  const [python] = await Promise.all([
    loadPyodide({
      indexURL: new URL('./', self.location.href).href,
      stdLibURL: new URL('./python.zip', self.location.href).href,
      lockFileContents: /** @type {any} */ (lock),
      packageBaseUrl: new URL('./', self.location.href).href,
    }),
    importing,
  ]);
  python.FS.mkdirTree('/studio');
  /** @param {ArrayBuffer} data */
  const unpack = (data) => python.unpackArchive(data, 'zip', { extractDir: '/studio' });
  unpack(await archiveData);
  const ask = python.runPython(`
import sys
sys.path.insert(0, "/studio")
from tiniscript.studio.worker import answer
lambda request, data: answer(request, data.to_bytes())
`);
  /** @param {string} language @param {ArrayBuffer | null} data its messages */
  const learn = (language, data) => {
    if (data) ask(JSON.stringify({ do: 'learn', language }), new Uint8Array(data));
    if (data) learntLanguages.add(language);
  };
  (await Promise.all(messageFiles)).forEach((data, index) => learn(wantedLanguages[index] ?? '', data));
  return { ask, unpack, learn };
}

addEventListener('unhandledrejection', ({ reason }) => postMessage({ id: 0, error: String(reason) }));

const python = startPython();
python.then(
  () => postMessage({ id: 0 }),
  (error) => postMessage({ id: 0, error: String(error) }),
);

/** What is fetched once it is needed, until that was possible. @type {Map<string, Promise<void>>} */
const archives = new Map();

/** @param {string} name */
function fetchArchive(name) {
  const fetching = archives.get(name) ?? Promise.all([python, fetchFile(name)]).then(([{ unpack }, data]) => unpack(data));
  archives.set(name, fetching);
  fetching.catch(() => archives.delete(name));
  return fetching;
}

addEventListener('message', async ({ data: { id, request, data } }) => {
  try {
    const { ask, learn } = await python;
    const parsedRequest = JSON.parse(request);
    const { language } = parsedRequest;
    if (parsedRequest.do.startsWith('lesson_')) await Promise.all([fetchArchive('lessons.zip'), learningLanguages.get(language)?.catch(() => null)]);
    if (parsedRequest.do.startsWith('group_')) await fetchArchive('together.zip');
    if (parsedRequest.do === 'learn') {
      if (!learntLanguages.has(language)) {
        learningLanguages.set(language, fetchFile(`messages.${language}.json`).then((messages) => learn(language, messages)));
        await learningLanguages.get(language);
      }
      postMessage({ id, answer: '{}' });
      return;
    }
    if (language && !learntLanguages.has(language)) parsedRequest.language = SOURCE_LANGUAGE;
    postMessage({ id, answer: ask(JSON.stringify(parsedRequest), data) });
  } catch (error) {
    postMessage({ id, error: String(error) });
  }
});
