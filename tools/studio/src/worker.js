// The worker: Python, and in it the compiler of this project itself.

import { loadPyodide } from 'pyodide';
// Nothing is installed: all modules are in the two archives.
import lock from '../made/lock.json';

async function begin() {
  const archive = fetch('./tiniscript.zip').then((found) => {
    if (!found.ok) throw new Error(`tiniscript.zip: ${found.status}`);
    return found.arrayBuffer();
  });
  const python = await loadPyodide({
    indexURL: new URL('./', self.location.href).href,
    stdLibURL: new URL('./python.zip', self.location.href).href,
    lockFileContents: /** @type {any} */ (lock),
    packageBaseUrl: new URL('./', self.location.href).href,
  });
  python.FS.mkdirTree('/studio');
  python.unpackArchive(await archive, 'zip', { extractDir: '/studio' });
  return python.runPython(`
import sys
sys.path.insert(0, "/studio")
from tiniscript.studio.worker import answer
lambda request, data: answer(request, data.to_bytes())
`);
}

addEventListener('unhandledrejection', ({ reason }) => postMessage({ id: 0, error: String(reason) }));

const answer = begin();
answer.then(
  () => postMessage({ id: 0 }),
  (why) => postMessage({ id: 0, error: String(why) }),
);

addEventListener('message', async ({ data: { id, request, data } }) => {
  try {
    const ask = await answer;
    postMessage({ id, answer: ask(request, data) });
  } catch (why) {
    postMessage({ id, error: String(why) });
  }
});
