// The text editor of a browser: CodeMirror's own states in a view that draws nothing, and what the page imports for it.

import { pathToFileURL } from 'node:url';
import { sources } from './page_in_node.mjs';

globalThis.CSS = { highlights: new Map() };
globalThis.Highlight = Set;
globalThis.StaticRange = class {
  constructor(ends) { Object.assign(this, ends); }
};

export const codemirror = await import(pathToFileURL(`${sources}/../node_modules/@codemirror/view/dist/index.js`).href);
export const { forEachDiagnostic } = await import(pathToFileURL(`${sources}/../node_modules/@codemirror/lint/dist/index.js`).href);
const { Transaction } = await import(pathToFileURL(`${sources}/../node_modules/@codemirror/state/dist/index.js`).href);
export let view = null; // the newest
export class EditorView {
  hasFocus = false;
  lines = {}; // any update may draw them anew
  sought = -1; // what it was scrolled to
  #isUpdating = false;

  constructor({ state }) {
    this.state = state;
    view = this;
  }

  dispatch = (...specs) => {
    if (this.#isUpdating) throw new Error('a change within a change');
    this.sought = [specs[0].effects ?? []].flat().find((effect) => effect.sought !== undefined)?.sought ?? this.sought;
    const startState = this.state;
    const transaction = specs[0] instanceof Transaction ? specs[0] : startState.update(...specs);
    this.state = transaction.state;
    this.lines = {};
    this.#isUpdating = true;
    const update = { view: this, state: this.state, startState, transactions: [transaction], changes: transaction.changes, docChanged: transaction.docChanged };
    for (const listener of this.state.facet(codemirror.EditorView.updateListener)) listener(update);
    this.#isUpdating = false;
  };

  domAtPos = (offset) => ({ node: this.lines, offset });

  focus() { this.hasFocus = true; }
}
for (const name of ['updateListener', 'theme', 'baseTheme', 'decorations', 'lineWrapping', 'contentAttributes']) EditorView[name] = codemirror.EditorView[name];
EditorView.scrollIntoView = (offset, options) => Object.assign(codemirror.EditorView.scrollIntoView(offset, options), { sought: offset });

/** What `freshPage` replaces. */
export const playedEditor = {
  EditorView,
  ...Object.fromEntries(['Decoration', 'GutterMarker', 'WidgetType', 'gutter', 'highlightActiveLine', 'keymap', 'lineNumbers'].map((name) => [name, codemirror[name]])),
};
