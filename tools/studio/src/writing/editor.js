// The text editor. Knows CodeMirror; everything else of the page only knows this file.
//
// It lives in a shadow root, where a style sheet can be adopted: so the page's policy needs no
// exception for styles in elements.

import { autocompletion, completionKeymap } from '@codemirror/autocomplete';
import { defaultKeymap, history, historyKeymap, invertedEffects, isolateHistory, redo, redoDepth, undo, undoDepth } from '@codemirror/commands';
import { bracketMatching } from '@codemirror/language';
import { lintGutter, lintKeymap, setDiagnostics } from '@codemirror/lint';
import { Compartment, EditorState, Prec, StateEffect, StateField } from '@codemirror/state';
import { Decoration, EditorView, highlightActiveLine, keymap, lineNumbers } from '@codemirror/view';
import { breakpoints, placesOf, pointsOf, pressed, setBreakpoints } from './breakpoints.js';
import { colors, completionOf, languageOf } from './language.js';
import { whole } from './messages.js';
import { partAt } from './parts.js';
import { pageState } from '../page/page_state.js';
import { text, textsOf } from '../page/texts.js';

/** @import { Finding, Change } from '../python.js' */
/** @typedef {{line: number, column: number, end_line: number, end_column: number}} Range */
/** @typedef {string} Stand where blocks stand, as only they read it */

/** @type {import('@codemirror/state').StateEffectType<{from: number, to: number}[]>} */
const setRunning = StateEffect.define();
const running = StateField.define({
  create: () => Decoration.none,
  update(marks, transaction) {
    let decorations = transaction.docChanged ? Decoration.none : marks;
    for (const effect of transaction.effects) {
      if (!effect.is(setRunning)) continue;
      const marks = effect.value.filter(({ from, to }) => from < to);
      decorations = Decoration.set(marks.map(({ from, to }) => Decoration.mark({ class: 'cm-running' }).range(from, to)), true);
    }
    return decorations;
  },
  provide: (field) => EditorView.decorations.from(field),
});

/** Blocks were put elsewhere: a step of the same undo as the text's. @type {import('@codemirror/state').StateEffectType<{before: Stand, after: Stand}>} */
const setStand = StateEffect.define();
const undoneStands = invertedEffects.of(({ effects }) => effects.flatMap((each) => (
  each.is(setStand) ? [setStand.of({ before: each.value.after, after: each.value.before })] : [])));

const theme = EditorView.theme({
  '&': { height: '100%', fontSize: '1rem', backgroundColor: 'var(--card)', color: 'var(--ink)' },
  '&.cm-focused': { outline: '3px solid var(--said-blue)', outlineOffset: '-3px' },
  '.cm-scroller': { fontFamily: 'ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace', lineHeight: '1.5' },
  '.cm-gutters': { backgroundColor: 'var(--pale)', color: 'var(--soft)', border: 'none' },
  '.cm-content': { caretColor: 'var(--ink)' },
  '.cm-activeLine, .cm-activeLineGutter': { backgroundColor: 'var(--line)' },
  '.cm-running, .cm-running *': { backgroundColor: '#ffd84d', color: '#1b2733' },
  '@media (forced-colors: active)': { '.cm-running': { outline: '2px solid Highlight' } },
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
  #robot = new Compartment();
  #words = new Compartment();
  #history = new Compartment();
  #view;
  /** What takes back what is not typed in a line that is being typed: in a group. @type {((how: 'undo' | 'redo') => void) | null} */
  #takesBack = null;
  /** Where parts of the newest text begin; null while it is not compiled. @type {import('./parts.js').Places | null} */
  #places = null;
  #marked = ''; // what runs
  #held = -1; // where the program is held, and the editor has been scrolled to
  /** Hears where blocks stand again. @type {(stand: Stand) => void} */
  #whenStood = () => {};

  /** @param {HTMLElement} parent */
  constructor(parent) {
    /** @type {(at: number, isLine: boolean) => void} */
    const toggle = (at, isLine) => this.#toggle(at, isLine);
    const root = parent.attachShadow({ mode: 'open' });
    const place = document.createElement('div');
    place.style.cssText = 'position: absolute; inset: 0; overflow: hidden'; // laid out without the rest of the page
    root.append(place);
    this.#view = new EditorView({
      parent: place,
      root,
      state: EditorState.create({
        extensions: [
          EditorView.updateListener.of((update) => { // before breakpoints are told: they are of another text
            if (update.docChanged) {
              this.#places = null;
              this.#marked = '';
              pageState.programText.set(this.text);
            }
            for (const each of update.transactions.filter((one) => one.isUserEvent('undo') || one.isUserEvent('redo'))) {
              for (const effect of each.effects) if (effect.is(setStand)) this.#whenStood(effect.value.after);
            }
          }),
          undoneStands,
          breakpoints(toggle, () => pageState.breakpoints.set(this.#breakpoints)),
          lineNumbers({ domEventHandlers: { mousedown: (_, line, event) => pressed(line, event, toggle) } }),
          this.#history.of(history()),
          Prec.high(keymap.of([
            { key: 'Mod-z', run: () => this.#back('undo'), shift: () => this.#back('redo') },
            { key: 'Mod-y', run: () => this.#back('redo') },
          ])),
          // Tab leaves the editor: who has no mouse must get out.
          keymap.of([...completionKeymap, ...lintKeymap, ...defaultKeymap, ...historyKeymap]),
          bracketMatching(),
          highlightActiveLine(),
          lintGutter(),
          running,
          colors,
          theme,
          EditorView.lineWrapping,
          this.#robot.of(forRobot()),
          this.#words.of(this.#inLanguage()),
        ],
      }),
    });
    pageState.robotName.subscribe(() => this.#view.dispatch({ effects: this.#robot.reconfigure(forRobot()) }));
    pageState.language.subscribe(() => this.#view.dispatch({ effects: this.#words.reconfigure(this.#inLanguage()) }));
    pageState.checkResult.subscribe((answer) => {
      if (answer) this.#places = answer.places.length ? answer.places : null;
    });
  }

  get text() {
    return this.#view.state.doc.toString();
  }

  /** Replaces the text; undo brings the one before back. @param {string} whole */
  replace(whole) {
    this.#view.dispatch({ changes: { from: 0, to: this.#view.state.doc.length, insert: whole }, annotations: isolateHistory.of('full') });
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
    this.#back('undo');
  }

  redo() {
    this.#back('redo');
  }

  /** @param {'undo' | 'redo'} how */
  #back(how) {
    const { state } = this.#view;
    if (!this.#takesBack || (how === 'undo' ? undoDepth(state) : redoDepth(state))) (how === 'undo' ? undo : redo)(this.#view);
    else this.#takesBack(how);
    return true;
  }

  /** From now on somebody else has what was done before; null: nobody has. @param {((how: 'undo' | 'redo') => void) | null} takesBack */
  handUndo(takesBack) {
    this.#takesBack = takesBack;
    this.#view.dispatch({ effects: this.#history.reconfigure([]) });
    this.#view.dispatch({ effects: this.#history.reconfigure(history()) });
  }

  /** @param {(stand: Stand) => void} act is done where an undo or a redo has blocks stand elsewhere */
  whenStood(act) {
    this.#whenStood = act;
  }

  /**
   * Puts in the text of changed blocks and where they stand, as one step of undo.
   * @param {string} whole
   * @param {{before: Stand, after: Stand}} stands
   */
  replaceByBlocks(whole, stands) {
    const before = this.text;
    const effects = stands.before === stands.after ? [] : [setStand.of(stands)];
    if (whole === before) {
      if (effects.length) this.#view.dispatch({ effects, annotations: isolateHistory.of('full'), userEvent: 'move.blocks' });
      return;
    }
    let from = 0;
    while (from < Math.min(before.length, whole.length) && before[from] === whole[from]) from += 1;
    let same = 0;
    while (same < Math.min(before.length, whole.length) - from && before.at(-1 - same) === whole.at(-1 - same)) same += 1;
    this.#view.dispatch({ selection: { anchor: from } }); // where an undo goes back to
    this.#view.dispatch({
      scrollIntoView: true,
      changes: { from, to: before.length - same, insert: whole.slice(from, whole.length - same) },
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
    const marks = findings.map((finding) => ({
      ...this.#offsets(finding),
      /** @type {'error' | 'warning'} */
      severity: finding.severity === 'mistake' ? 'error' : 'warning',
      message: whole(finding),
      get actions() { // read whenever it is shown
        return finding.repair?.length ? [{ name: text('repair'), apply: () => repair(finding) }] : [];
      },
    }));
    this.#view.dispatch(setDiagnostics(this.#view.state, marks));
  }

  get #breakpoints() {
    return pointsOf(this.#view.state).map(({ at, point }) => ({ ...this.#placeAt(at), point }));
  }

  /** @param {{line: number, column: number}} place the beginning of a part, or of a block */
  toggleBreakpoint(place) {
    this.#toggle(this.#offset(place.line, place.column), false);
  }

  /**
   * @param {number} at
   * @param {boolean} isLine of the whole line
   */
  #toggle(at, isLine) {
    const line = this.#view.state.doc.lineAt(at);
    const here = placesOf(this.#view.state).filter((each) => each >= line.from && each <= line.to);
    if (isLine && here.length) {
      setBreakpoints(this.#view, here, false);
      return;
    }
    const begin = this.#partAt(at, isLine);
    if (begin === null) pageState.note.set(text('no_breakpoint', { line: line.number }));
    else setBreakpoints(this.#view, [begin], !placesOf(this.#view.state).includes(begin));
  }

  /** @param {number} at @param {boolean} isLine @returns {number | null} */
  #partAt(at, isLine) {
    if (this.#places) {
      const part = partAt(this.#places, this.#placeAt(at), isLine);
      return part && this.#offset(part.line, part.column);
    }
    const line = this.#view.state.doc.lineAt(at); // of a text with mistakes: what there is
    const first = line.text.search(/\S/);
    return first < 0 || line.text.startsWith('//', first) ? null : line.from + first;
  }

  /** @param {number} at */
  #placeAt(at) {
    const line = this.#view.state.doc.lineAt(at);
    return { line: line.number, column: [...line.text.slice(0, at - line.from)].length + 1 };
  }

  /** @param {Change[]} changes */
  change(changes) {
    this.#view.dispatch({
      changes: changes.map((change) => ({ ...this.#offsets(change), insert: change.text })),
      userEvent: 'input.repair',
    });
    this.#view.focus();
  }

  /** @param {Range} range */
  goTo(range) {
    this.#view.dispatch({ selection: { anchor: this.#offsets(range).from }, scrollIntoView: true });
    this.#view.focus();
  }

  /**
   * Marks what runs now, in each task.
   * @param {Range[]} ranges
   * @param {boolean} isHeld at the first of them: it is scrolled to
   */
  showRunning(ranges, isHeld = false) {
    const all = ranges.map((each) => this.#offsets(each));
    const marked = all.length ? JSON.stringify([all, isHeld]) : '';
    if (marked === this.#marked) return;
    this.#marked = marked;
    const [offsets] = all;
    /** @type {StateEffect<unknown>[]} */
    const effects = [setRunning.of(all)];
    if (offsets && isHeld && offsets.from !== this.#held) effects.push(EditorView.scrollIntoView(offsets.from, { y: 'nearest', yMargin: 24 }));
    this.#held = offsets && isHeld ? offsets.from : -1;
    this.#view.dispatch({ effects });
  }

  /**
   * Lines and columns count from 1, columns in characters; the editor counts in halves of UTF-16.
   * @param {Range} range
   */
  #offsets(range) {
    const from = this.#offset(range.line, range.column);
    return { from, to: Math.max(from, this.#offset(range.end_line, range.end_column)) };
  }

  /**
   * @param {number} line
   * @param {number} column
   */
  #offset(line, column) {
    const { doc } = this.#view.state;
    if (line > doc.lines) return doc.length;
    const found = doc.line(line);
    const before = [...found.text].slice(0, column - 1).join('').length;
    return found.from + before;
  }

  #inLanguage() {
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

function forRobot() {
  const robot = pageState.robotName.value;
  return [languageOf(robot), autocompletion({ override: [completionOf(robot)], icons: false })];
}
