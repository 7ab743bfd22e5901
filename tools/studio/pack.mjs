// node pack.mjs PACKAGE COBS TARGET: packs the page's Python, with the Python of Pyodide itself.

import fs from 'node:fs';
import { loadPyodide } from 'pyodide';

const [packageFolder, cobsFolder, target] = process.argv.slice(2);
const here = (name) => new URL(name, import.meta.url);
const pyodide = await loadPyodide();
const start = pyodide.runPython(`
import sys
sorted(name for name, module in sys.modules.items()
       if ".zip/" in (getattr(module, "__file__", None) or ""))
`);
for (const [place, folder] of [['/package', packageFolder], ['/cobs', cobsFolder], ['/target', target]]) {
  pyodide.FS.mkdirTree(place);
  pyodide.mountNodeFS(place, folder);
}
pyodide.FS.writeFile('/standard.zip', fs.readFileSync(here('node_modules/pyodide/python_stdlib.zip')));
pyodide.FS.writeFile('/home/pyodide/pack.py', fs.readFileSync(here('pack.py')));
const packer = pyodide.pyimport('pack');
console.log(packer.pack(start, '/package', '/cobs', '/standard.zip', '/target'));
