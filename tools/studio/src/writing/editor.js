// The text editor. Knows CodeMirror; everything else of the page only knows this file.
//
// It lives in a shadow root, where a style sheet can be adopted: so the page's policy needs no
// exception for styles in elements.

import { autocompletion, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, invertedEffects, isolateHistory, redo, redoDepth, undo, undoDepth } from '@codemirror/commands';
import { bracketMatching } from '@codemirror/language';
import { lintGutter, lintKeymap, setDiagnostics } from '@codemirror/lint';
import { Compartment, EditorState, Prec, StateEffect } from '@codemirror/state';
import { EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';
import { breakpointExtension, offsetsIn, breakpointsIn, onMarginPress, setBreakpoints } from './breakpoints.js';
import { highlighting, completionsForRobot, languageOfRobot } from './language.js';
import { messageWithFix } from './messages.js';
import { partAt } from './parts.js';
import { sentenceAtPlace } from '../blocks/said.js';
import { pageState } from '../page/page_state.js';
import { text, textsOf } from '../page/texts.js';

/** @import { Finding, Change } from '../python.js' */
/** @typedef {{line: number, column: number, end_line: number, end_column: number}} Range */
/** @typedef {string} LayoutText where blocks stand, as only they read it */

/** Blocks were put elsewhere: a step of the same undo as the text's. @type {import('@codemirror/state').StateEffectType<{before: LayoutText, after: LayoutText}>} */
const setLayoutEffect = StateEffect.define();
const layoutInversion = invertedEffects.of(({ effects }) => effects.flatMap((effect) => (
  effect.is(setLayoutEffect) ? [setLayoutEffect.of({ before: effect.value.after, after: effect.value.before })] : [])));

const theme = EditorView.theme({
  '&': { height: '100%', fontSize: '1rem', backgroundColor: 'var(--card)', color: 'var(--ink)' },
  '&.cm-focused': { outline: '3px solid var(--said-blue)', outlineOffset: '-3px' },
  '.cm-scroller': { fontFamily: 'ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace', lineHeight: '1.5' },
  '.cm-gutters': { backgroundColor: 'var(--pale)', color: 'var(--soft)', border: 'none' },
  '.cm-content': { caretColor: 'var(--ink)' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'var(--line)' },
  '.cm-line::highlight(running), .cm-line *::highlight(running)': { backgroundColor: '#ffd84d', color: '#1b2733' },
  '@media (forced-colors: active)': { '.cm-line::highlight(running), .cm-line *::highlight(running)': { backgroundColor: 'Highlight', color: 'HighlightText' } },
  '.cm-breakpoint': { boxShadow: 'inset 3px 0 #a8200f' },
  '.cm-breakpoints': { width: '1.3em', color: '#a8200f', cursor: 'pointer', textAlign: 'center' },
  '.cm-lineNumbers': { cursor: 'pointer' },
  // CodeMirror draws these with pictures in its style sheet, which the page's policy forbids.
  '.cm-lintRange': { backgroundImage: 'none', textDecorationLine: 'underline', textDecorationStyle: 'wavy', textUnderlineOffset: '3px' },
  '.cm-lintRange-error': { backgroundImage: 'none', textDecorationColor: '#a8200f' },
  '.cm-lintRange-warning': { backgroundImage: 'none', textDecorationColor: '#7a4b00' },
  '.cm-lint-marker': { fontWeight: '700', textAlign: 'center', lineHeight: '1.2' },
  '.cm-lint-marker-error': { content: '"×"', color: '#a8200f' },
  '.cm-lint-marker-warning': { content: '"!"', color: '#7a4b00' },
  '.cm-diagnosticAction': { minHeight: '36px', padding: '0 12px', marginLeft: '8px', font: 'inherit', backgroundColor: '#0b4f9e', color: '#fff', borderRadius: '6px' },
  '.cm-tooltip': { maxWidth: 'min(90vw, 34rem)' },
});

export class Editor {
  #robotCompartment = new Compartment();
  #languageCompartment = new Compartment();
  #historyCompartment = new Compartment();
  #view;
  /** What takes back what is not typed in a line that is being typed: in a group. @type {((direction: 'undo' | 'redo') => void) | null} */
  #undoHandler = null;
  /** Where parts of the newest text begin; null while it is not compiled. @type {import('./parts.js').Places | null} */
  #places = null;
  #runningKey = ''; // what runs
  /** Of what runs. @type {{from: number, to: number}[]} */
  #runningOffsets = [];
  #runningHighlight = 'Highlight' in globalThis ? new Highlight() : null; // a browser of before 2025 may mark nothing
  #heldOffset = -1; // where the program is held, and the editor has been scrolled to
  /** Hears where blocks stand again. @type {(layout: LayoutText) => void} */
  #onLayout = () => {};

  /** @param {HTMLElement} parent */
  constructor(parent) {
    /** @type {(offset: number, isWholeLine: boolean) => void} */
    const toggle = (offset, isWholeLine) => this.#toggleAt(offset, isWholeLine);
    if (this.#runningHighlight) CSS.highlights.set('running', this.#runningHighlight);
    const root = parent.attachShadow({ mode: 'open' });
    const container = document.createElement('div');
    container.style.cssText = 'position: absolute; inset: 0; overflow: hidden'; // laid out without the rest of the page
    root.append(container);
    this.#view = new EditorView({
      parent: container,
      root,
      state: EditorState.create({
        extensions: [
          EditorView.updateListener.of((update) => { // before breakpoints are told: they are of another text
            if (update.docChanged) {
              this.#places = null;
              this.#runningKey = '';
              this.#runningOffsets = [];
              const changes = update.transactions.filter(({ docChanged }) => docChanged);
              if (!changes.every((transaction) => ['undo', 'redo', 'input.repair'].some((event) => transaction.isUserEvent(event)))) {
                pageState.isTyped.set(changes.some((transaction) => ['input', 'delete', 'move'].some((event) => transaction.isUserEvent(event)) && !transaction.isUserEvent('input.blocks')));
              }
              pageState.programText.set(this.text);
            }
            this.#markRunning(); // in lines that were drawn anew
            for (const transaction of update.transactions.filter((transaction) => transaction.isUserEvent('undo') || transaction.isUserEvent('redo'))) {
              for (const effect of transaction.effects) if (effect.is(setLayoutEffect)) this.#onLayout(effect.value.after);
            }
          }),
          layoutInversion,
          breakpointExtension(toggle, () => pageState.breakpoints.set(this.#breakpoints)),
          lineNumbers({ domEventHandlers: { mousedown: (_, line, event) => onMarginPress(line, event, toggle) } }),
          this.#historyCompartment.of(history()),
          Prec.high(keymap.of([
            { key: 'Mod-z', run: () => this.#undoOrRedo('undo'), shift: () => this.#undoOrRedo('redo') },
            { key: 'Mod-y', run: () => this.#undoOrRedo('redo') },
          ])),
          // Tab leaves the editor: who has no mouse must get out.
          keymap.of([...completionKeymap, ...lintKeymap, ...defaultKeymap, ...historyKeymap]),
          bracketMatching(),
          highlightActiveLine(),
          lintGutter(),
          highlighting,
          theme,
          EditorView.lineWrapping,
          this.#robotCompartment.of(robotExtensions()),
          this.#languageCompartment.of(this.#languageExtensions()),
        ],
      }),
    });
    pageState.robotName.subscribe(() => this.#view.dispatch({ effects: this.#robotCompartment.reconfigure(robotExtensions()) }));
    pageState.language.subscribe(() => this.#view.dispatch({ effects: this.#languageCompartment.reconfigure(this.#languageExtensions()) }));
    pageState.checkResult.subscribe((answer) => {
      if (answer) this.#places = answer.places.length ? answer.places : null;
    });
  }

  get text() {
    return this.#view.state.doc.toString();
  }

  /** Replaces the text; undo brings the one before back. @param {string} newText */
  replace(newText) {
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: newText }, annotations: isolateHistory.of('full') });
  }

  get hasFocus() {
    return this.#view.hasFocus;
  }

  /** Has more from now on; who brings it works with the view itself. @param {import('@codemirror/state').Extension} extension */
  extend(extension) {
    this.#view.dispatch({ effects: StateEffect.appendConfig.of(extension) });
    return this.#view;
  }

  undo() {
    this.#undoOrRedo('undo');
  }

  redo() {
    this.#undoOrRedo('redo');
  }

  /** @param {'undo' | 'redo'} direction */
  #undoOrRedo(direction) {
    const { state } = this.#view;
    if (!this.#undoHandler || (direction === 'undo' ? undoDepth(state) : redoDepth(state))) (direction === 'undo' ? undo : redo)(this.#view);
    else this.#undoHandler(direction);
    return true;
  }

  /** From now on somebody else has what was done before; null: nobody has. @param {((direction: 'undo' | 'redo') => void) | null} undoHandler */
  setUndoHandler(undoHandler) {
    this.#undoHandler = undoHandler;
    this.#view.dispatch({ effects: this.#historyCompartment.reconfigure([]) });
    this.#view.dispatch({ effects: this.#historyCompartment.reconfigure(history()) });
  }

  /** @param {(layout: LayoutText) => void} onLayout is done where an undo or a redo has blocks stand elsewhere */
  onLayoutChange(onLayout) {
    this.#onLayout = onLayout;
  }

  /**
   * Puts in the text of changed blocks and where they stand, as one step of undo.
   * @param {string} newText
   * @param {{before: LayoutText, after: LayoutText}} layouts
   */
  replaceByBlocks(newText, layouts) {
    const oldText = this.text;
    const effects = layouts.before === layouts.after ? [] : [setLayoutEffect.of(layouts)];
    if (newText === oldText) {
      if (effects.length) this.#view.dispatch({ effects, annotations: isolateHistory.of('full'), userEvent: 'move.blocks' });
      return;
    }
    let commonPrefixLength = 0;
    while (commonPrefixLength < Math.min(oldText.length, newText.length) && oldText[commonPrefixLength] === newText[commonPrefixLength]) commonPrefixLength += 1;
    let commonSuffixLength = 0;
    while (commonSuffixLength < Math.min(oldText.length, newText.length) - commonPrefixLength && oldText.at(-1 - commonSuffixLength) === newText.at(-1 - commonSuffixLength)) commonSuffixLength += 1;
    this.#view.dispatch({ selection: { anchor: commonPrefixLength } }); // where an undo goes back to
    this.#view.dispatch({
      scrollIntoView: true,
      changes: { from: commonPrefixLength, to: oldText.length - commonSuffixLength, insert: newText.slice(commonPrefixLength, newText.length - commonSuffixLength) },
      effects,
      annotations: isolateHistory.of('full'),
      userEvent: 'input.blocks',
    });
  }

  /**
   * @param {Finding[]} findings
   * @param {(finding: Finding) => void} repair
   */
  showFindings(findings, repair) {
    const diagnostics = findings.map((finding) => ({
      ...this.#offsetsOfRange(finding),
      /** @type {'error' | 'warning'} */
      severity: finding.severity === 'mistake' ? 'error' : 'warning',
      message: messageWithFix(finding),
      get actions() { // read whenever it is shown
        return finding.repair?.length ? [{ name: text('repair'), apply: () => repair(finding) }] : [];
      },
    }));
    this.#view.dispatch(setDiagnostics(this.#view.state, diagnostics));
  }

  get #breakpoints() {
    return breakpointsIn(this.#view.state).map(({ offset, point }) => ({ ...this.#positionAt(offset), point }));
  }

  /** @param {{line: number, column: number}} position the beginning of a part, or of a block */
  toggleBreakpoint(position) {
    this.#toggleAt(this.#offsetOf(position.line, position.column), false);
  }

  /**
   * @param {number} offset
   * @param {boolean} isWholeLine
   */
  #toggleAt(offset, isWholeLine) {
    const line = this.#view.state.doc.lineAt(offset);
    const offsetsInLine = offsetsIn(this.#view.state).filter((offset) => offset >= line.from && offset <= line.to);
    if (isWholeLine && offsetsInLine.length) {
      setBreakpoints(this.#view, offsetsInLine, false);
      return;
    }
    const partOffset = this.#partOffsetAt(offset, isWholeLine);
    if (partOffset === null) pageState.note.set(sentenceAtPlace('no_breakpoint', 'no_breakpoint_block', this.text, this.#positionAt(offset)));
    else setBreakpoints(this.#view, [partOffset], !offsetsIn(this.#view.state).includes(partOffset));
  }

  /** @param {number} offset @param {boolean} isWholeLine @returns {number | null} */
  #partOffsetAt(offset, isWholeLine) {
    if (this.#places) {
      const part = partAt(this.#places, this.#positionAt(offset), isWholeLine);
      return part && this.#offsetOf(part.line, part.column);
    }
    const line = this.#view.state.doc.lineAt(offset); // of a text with mistakes: what there is
    const firstColumn = line.text.search(/\S/);
    return firstColumn < 0 || line.text.startsWith('//', firstColumn) ? null : line.from + firstColumn;
  }

  /** @param {number} offset */
  #positionAt(offset) {
    const line = this.#view.state.doc.lineAt(offset);
    return { line: line.number, column: [...line.text.slice(0, offset - line.from)].length + 1 };
  }

  /** @param {Change[]} changes */
  applyChanges(changes) {
    this.#view.dispatch({
      changes: changes.map((change) => ({ ...this.#offsetsOfRange(change), insert: change.text })),
      userEvent: 'input.repair',
    });
    this.#view.focus();
  }

  /** @param {Range} range */
  goTo(range) {
    this.#view.dispatch({ selection: { anchor: this.#offsetsOfRange(range).from }, scrollIntoView: true });
    this.#view.focus();
  }

  /**
   * Marks what runs now, in each task.
   * @param {Range[]} ranges
   * @param {boolean} isHeld at the first of them: it is scrolled to
   */
  showRunning(ranges, isHeld = false) {
    const allOffsets = ranges.map((range) => this.#offsetsOfRange(range));
    const [offsets] = allOffsets;
    const needsScroll = offsets && isHeld && offsets.from !== this.#heldOffset;
    this.#heldOffset = offsets && isHeld ? offsets.from : -1; // also where a changed text has no marks any more
    const runningKey = allOffsets.length ? JSON.stringify([allOffsets, isHeld]) : '';
    if (runningKey === this.#runningKey) return;
    this.#runningKey = runningKey;
    this.#runningOffsets = allOffsets.filter(({ from, to }) => from < to);
    this.#markRunning();
    if (needsScroll) this.#view.dispatch({ effects: EditorView.scrollIntoView(offsets.from, { y: 'nearest', yMargin: 24 }) });
  }

  /** Marks what runs where it is drawn. A decoration of CodeMirror would have the page laid out anew. */
  #markRunning() {
    this.#runningHighlight?.clear();
    for (const { from, to } of this.#runningOffsets) {
      const start = this.#view.domAtPos(from), end = this.#view.domAtPos(to);
      this.#runningHighlight?.add(new StaticRange({ startContainer: start.node, startOffset: start.offset, endContainer: end.node, endOffset: end.offset }));
    }
  }

  /**
   * Lines and columns count from 1, columns in characters; the editor counts in halves of UTF-16.
   * @param {Range} range
   */
  #offsetsOfRange(range) {
    const from = this.#offsetOf(range.line, range.column);
    return { from, to: Math.max(from, this.#offsetOf(range.end_line, range.end_column)) };
  }

  /**
   * @param {number} line
   * @param {number} column
   */
  #offsetOf(line, column) {
    const { doc } = this.#view.state;
    if (line > doc.lines) return doc.length;
    const documentLine = doc.line(line);
    const offsetInLine = [...documentLine.text].slice(0, column - 1).join('').length;
    return documentLine.from + offsetInLine;
  }

  #languageExtensions() {
    return [
      EditorState.phrases.of(textsOf('editor')),
      EditorView.contentAttributes.of({
        'aria-label': text('editor'),
        tabindex: '0',
        autocapitalize: 'off',
        autocorrect: 'off',
        spellcheck: 'false',
        translate: 'no',
      }),
    ];
  }
}

function robotExtensions() {
  const robotName = pageState.robotName.value;
  return [languageOfRobot(robotName), autocompletion({ override: [completionsForRobot(robotName)], icons: false })];
}
