// A pupil's text editor, in which others edit, too. The program is a tree that Python keeps in the worker
// (`studio/page_together.py`); here is what the editor has of it: when a line is finished, what the others have
// changed, and where they are. What was typed while Python was at work stays: it is never mixed with their changes
// in one line. Knows CodeMirror.

import { Annotation, ChangeSet, StateEffect, StateField, Transaction } from '@codemirror/state';
import { Decoration, EditorView, WidgetType } from '@codemirror/view';
import { makeElement } from '../page/made.js';
import { text } from '../page/texts.js';
import { NewsCursor } from './news_cursor.js';
import { post } from '../robot/host.js';
import { ConnectionFailure, pause } from '../robot/transport.js';

const REQUEST_LIMIT_MS = 12_000; // the class holds a request for 8 s
const RETRY_MS = 700; // where the class does not answer
const SLOW_RETRY_MS = 1500; // where it takes no more changes for now
const CARET_INTERVAL_MS = 300; // between two of its places that others hear
const FINISHED_EVENTS = ['undo', 'redo', 'input.repair', 'input.blocks']; // changes of lines that nobody is typing
const BUSY_LIMIT_MS = 2000; // that changes of others wait for somebody's hands
const POLL_MS = 50;
const DECISION_LIMIT_MS = 2000; // for what was done before an undo

/** @typedef {{name: string, mark: number, at: string, writes: boolean}} Mate */
/** @typedef {{line: number, color: string, label: string}} MatePlace */

/**
 * @typedef {object} PythonAnswer what Python answers
 * @property {number} version
 * @property {[number, number, string][]} changes of the text that it was asked with
 * @property {string[]} ids of the lines
 * @property {number[]} drafts lines that no other page has
 * @property {{uid: string}[]} pending
 * @property {number} since
 * @property {string} epoch
 * @property {number} told how many changes were refused
 * @property {string} why
 * @property {number} count of own changes
 * @property {string} [text] of the blocks which it was asked with
 * @property {boolean} [is_shown] whether the whole text is that
 * @property {[number, number, number, number][]} [places] of these
 * @property {{name: string}} kept
 */

/**
 * @typedef {object} TogetherListener who hears of it
 * @property {(error: unknown) => void} onBug that is a bug
 * @property {() => void} onLeft this page is not in the group any more
 * @property {(mates: Mate[]) => void} onMatesChange who is here has changed
 * @property {(why: string) => void} onRefusal a change of this page is refused
 * @property {(kept: {name: string}) => void} storePage what a page goes on with that is loaded again
 * @property {(isAnswered: boolean) => void} onRequestEnd whether the class has answered
 * @property {(places: MatePlace[]) => void} onMatesMove where the others are in the text
 * @property {(event: import('../robot/panel.js').GroupRobotEvent) => void} onRobotEvent the group's robot, which another page drives, has told this
 * @property {() => boolean} isBusy whether somebody has a block in the hand, or a field open
 */

/** A change that somebody else has made, or the layout. @type {import('@codemirror/state').AnnotationType<boolean>} */
const remoteAnnotation = Annotation.define();
/** @type {import('@codemirror/state').StateEffectType<{line: number, mate: Mate}[]>} */
const setMatesEffect = StateEffect.define();

class MateWidget extends WidgetType {
  /** @param {Mate} mate */
  constructor(mate) {
    super();
    this.mate = mate;
  }

  /** @param {MateWidget} widget */
  eq({ mate }) {
    return mate.name === this.mate.name && mate.mark === this.mate.mark && mate.writes === this.mate.writes;
  }

  toDOM() {
    const { name, mark: colorIndex, writes: isWriting } = this.mate;
    const nameElement = makeElement('span', '', isWriting ? `${name} …` : name);
    nameElement.className = `cm-mate cm-mate-${colorIndex}`;
    return nameElement;
  }
}

const matesField = StateField.define({
  create: () => Decoration.none,
  update(marks, transaction) {
    let newMarks = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setMatesEffect)) continue;
      const { doc } = transaction.state;
      const ranges = effect.value.filter(({ line }) => line <= doc.lines).flatMap(({ line, mate }) => {
        const { from, to } = doc.line(line);
        return [
          Decoration.line({ class: `cm-beside cm-mate-${mate.mark}` }).range(from),
          Decoration.widget({ widget: new MateWidget(mate), side: 1 }).range(to),
        ];
      });
      newMarks = Decoration.set(ranges, true);
    }
    return newMarks;
  },
  provide: (field) => EditorView.decorations.from(field),
});

// Dark enough for white letters, as beside white and beside black; the last but one is the teacher's.
const COLORS = ['#0b4f9e', '#8a3c00', '#0d6040', '#7a2fb8', '#a3145c', '#4c535e'];
const DRAFT_COLOR_INDEX = COLORS.length - 1;
const baseTheme = EditorView.baseTheme({
  '.cm-beside': { boxShadow: 'inset 4px 0 var(--mate)' },
  '.cm-mate': { marginLeft: '1ch', padding: '0 6px', borderRadius: '6px', backgroundColor: 'var(--mate)', color: '#fff', fontSize: '0.85em' },
  ...Object.fromEntries(COLORS.map((color, colorIndex) => [`.cm-mate-${colorIndex}`, { '--mate': color }])),
});

/** Mates as a list of names in their colours. @param {Mate[]} mates */
export function makeMateElements(mates) {
  return mates.map(({ name, mark: colorIndex }) => {
    const nameElement = makeElement('span', '', name);
    nameElement.className = 'mate';
    nameElement.style.setProperty('--mate', COLORS[colorIndex] ?? '');
    return nameElement;
  });
}

export class SharedEditor {
  #python;
  #editor;
  #view;
  #listener;
  #isOver = false;
  #isLineTyped = false; // a key was pressed in the line of the caret since the caret came there
  #caretLine = 0; // that of the caret, as it was last seen
  /** What was typed since Python was asked. @type {ChangeSet | null} */
  #typedChanges = null;
  /** @type {any[]} */
  #pendingNews = [];
  /** @type {Promise<unknown> | null} */
  #waitingStep = null;
  /** @type {Promise<unknown>} */
  #lastStep = Promise.resolve();
  #isSending = false;
  #newsCursor = new NewsCursor();
  /** @type {Mate[]} */
  #mates = [];
  /** @type {PythonAnswer} */
  #pythonState = { version: 0, changes: [], ids: [], drafts: [], pending: [], since: -1, epoch: '', told: 0, why: '', count: 0, kept: { name: '' } };
  /** @type {{line: number, writes: boolean} | null} */
  #blocksLine = null; // of the blocks
  #sentCaretKey = '';
  #caretTimer = 0;

  /**
   * @param {import('../python.js').Python} python
   * @param {import('../writing/editor.js').Editor} editor
   * @param {TogetherListener} listener
   */
  constructor(python, editor, listener) {
    this.#python = python;
    this.#editor = editor;
    this.#listener = listener;
    editor.setUndoHandler((direction) => this.#undoOrRedo(direction));
    this.#view = editor.extend([matesField, baseTheme, EditorView.updateListener.of((update) => this.#onUpdate(update))]);
  }

  /** Shows the program of a group. @param {any} news of the class @param {unknown} storedPage by this page, before it was loaded again */
  async showProgram(news, storedPage) {
    const beginning = this.#begin(news, storedPage);
    this.#lastStep = beginning.catch(() => {}); // before that no step knows which text it is of
    await beginning;
    this.#listenForNews();
  }

  /** @param {any} news @param {unknown} storedPage */
  async #begin(news, storedPage) {
    for (;;) {
      const { doc } = this.#view.state;
      const answer = await this.#python.ask({ do: 'group_begin', news, kept: storedPage }, new TextEncoder().encode(doc.toString()));
      if (this.#isOver) return; // it was left meanwhile
      if (doc !== this.#view.state.doc) continue; // somebody has typed meanwhile
      this.#applyAnswer(answer, doc.length, null);
      return;
    }
  }

  /** The group is left; the text stays. */
  end() {
    if (this.#isOver) return;
    this.#isOver = true;
    this.#showMates();
    this.#editor.setUndoHandler(null);
  }

  /** What is finished becomes the group's. @returns {Promise<unknown>} */
  finishEdit() {
    this.#isLineTyped = false;
    return this.#takeStep();
  }

  /** Python has what the editor has. @returns {Promise<unknown>} */
  settle() {
    return this.#takeStep();
  }

  /** The blocks show what the editor has: each is in a line. @param {[string, number][]} lines @returns {Promise<{is_known: boolean}>} */
  reportBlocks(lines) {
    return this.#python.ask({ do: 'group_blocks', version: this.#pythonState.version, lines });
  }

  /** The blocks are this now. @param {import('../blocks/form.js').Form} form @param {string[]} ids @returns {Promise<PythonAnswer | null>} null of who has left */
  writeBlocks(form, ids) {
    return this.#queueStep({ blocks: { form, ids } });
  }

  /** @param {'undo' | 'redo'} direction */
  async #undoOrRedo(direction) {
    await this.finishEdit();
    for (let waited_ms = 0; this.#pythonState.pending.length && waited_ms < DECISION_LIMIT_MS; waited_ms += POLL_MS) await pause(POLL_MS); // what is not decided yet is the newest
    await this.#queueStep({ back: direction });
  }

  /** @param {import('@codemirror/view').ViewUpdate} update */
  #onUpdate(update) {
    if (this.#isOver) return;
    const ownTransactions = update.transactions.filter((transaction) => transaction.docChanged && !transaction.annotation(remoteAnnotation));
    const line = update.state.doc.lineAt(update.state.selection.main.head).number;
    if (ownTransactions.length) {
      this.#typedChanges = this.#typedChanges?.compose(update.changes) ?? null;
      const isTyped = this.#view.hasFocus && !ownTransactions.some((transaction) => FINISHED_EVENTS.some((event) => transaction.isUserEvent(event)));
      const isOtherLine = update.startState.doc.lines !== update.state.doc.lines || (this.#isLineTyped && line !== this.#caretLine);
      this.#isLineTyped = isTyped;
      if (!isTyped || isOtherLine) this.#takeStep();
    } else if (!update.docChanged && this.#isLineTyped && line !== this.#caretLine) {
      this.finishEdit();
    }
    if (update.focusChanged && !this.#view.hasFocus && this.#isLineTyped) this.finishEdit();
    this.#caretLine = line;
    this.#sendCaret();
  }

  /** Has Python take what is in the editor, and what has come; one at a time. @returns {Promise<unknown>} */
  #takeStep() {
    this.#waitingStep ??= this.#queueStep({}, () => {
      this.#waitingStep = null;
    });
    return this.#waitingStep;
  }

  /** @param {Record<string, unknown>} fields that is done, too @param {() => void} [onBegin] @returns {Promise<PythonAnswer | null>} */
  #queueStep(fields, onBegin) {
    const step = this.#lastStep.then(async () => {
      onBegin?.();
      if (!Object.keys(fields).length) await this.#waitUntilIdle();
      let answer = null;
      while (!this.#isOver && !answer) answer = await this.#tryStep(fields);
      this.#sendChanges();
      return answer;
    }).catch((error) => {
      this.end();
      this.#listener.onBug(error);
      return null;
    });
    this.#lastStep = step;
    return step;
  }

  /** What others have changed waits while a sign is composed, a block is dragged or a field is open. */
  async #waitUntilIdle() {
    for (let waited_ms = 0; waited_ms < BUSY_LIMIT_MS && (this.#view.composing || this.#listener.isBusy()); waited_ms += POLL_MS) await pause(POLL_MS);
  }

  /** @param {Record<string, unknown>} fields @returns {Promise<PythonAnswer | null>} what is shown now; null where somebody has typed what others have changed */
  async #tryStep(fields) {
    const { doc, selection } = this.#view.state;
    const news = this.#pendingNews.slice();
    this.#typedChanges = ChangeSet.empty(doc.length);
    const caret = doc.lineAt(selection.main.head).number - 1;
    /** @type {PythonAnswer} */
    const answer = await this.#python.ask({ do: 'group_step', from: this.#pythonState.version, caret, hot: this.#isLineTyped, news, ...fields }, new TextEncoder().encode(doc.toString()));
    const typedChanges = this.#typedChanges;
    this.#typedChanges = null;
    if (this.#isOver || doOverlap(doc, typedChanges, answer.changes)) return null;
    this.#pendingNews.splice(0, news.length);
    this.#applyAnswer(answer, doc.length, typedChanges);
    return answer;
  }

  /** @param {PythonAnswer} answer @param {number} length of the text that it was made of @param {ChangeSet | null} typedChanges since */
  #applyAnswer(answer, length, typedChanges) {
    const { told: refusedCountBefore, count: changeCountBefore } = this.#pythonState;
    this.#pythonState = answer;
    const changes = ChangeSet.of(answer.changes.map(([from, to, insert]) => ({ from, to, insert })), length);
    const mappedChanges = typedChanges && !typedChanges.empty ? changes.map(typedChanges) : changes;
    const { selection, doc } = this.#view.state;
    const isAtLineStart = doc.lineAt(selection.main.head).from === selection.main.head; // what is put in there is before its line
    this.#view.dispatch({
      changes: mappedChanges,
      ...(isAtLineStart && { selection: selection.map(mappedChanges, 1) }), // else it is mapped so anyway; saying it would end a composition
      annotations: [remoteAnnotation.of(true), Transaction.addToHistory.of(false)],
    });
    if (answer.count > changeCountBefore) this.#editor.setUndoHandler((direction) => this.#undoOrRedo(direction));
    this.#showMates();
    this.#listener.storePage(answer.kept);
    if (answer.told > refusedCountBefore && this.#pythonState.version > 1) this.#listener.onRefusal(answer.why);
  }

  /** Shows where the others are, and what no other page has. */
  #showMates() {
    const { ids, drafts } = this.#pythonState;
    const mates = this.#mates.map((mate) => ({ line: ids.indexOf(mate.at) + 1, mate })).filter(({ line }) => line > 0);
    const draft = { name: text('group_draft'), mark: DRAFT_COLOR_INDEX, at: '', writes: false };
    const places = this.#isOver ? [] : [...mates, ...drafts.map((line) => ({ line, mate: draft }))];
    const { doc, selection } = this.#view.state, typedLine = this.#isLineTyped ? doc.lineAt(selection.main.head).number : 0;
    this.#view.dispatch({ effects: setMatesEffect.of(places.filter(({ line, mate }) => mate !== draft || line !== typedLine)) });
    this.#listener.onMatesMove(places.map(({ line, mate: { name, mark: colorIndex, writes } }) => ({ line, color: COLORS[colorIndex] ?? '', label: writes ? `${name} …` : name })));
  }

  /** The blocks have the focus in this line, or nowhere. @param {number} line @param {boolean} writes */
  chooseLine(line, writes) {
    this.#blocksLine = line ? { line, writes } : null;
    this.#sendCaret();
  }

  // -- the class --

  #makeRequest() {
    const { since, epoch, kept: storedPage } = this.#pythonState;
    return { do: 'group', page: storedPage.name, since, epoch, ...this.#newsCursor.position };
  }

  /** Hears what is new, for as long as this page is in the group. */
  async #listenForNews() {
    while (!this.#isOver) {
      await this.#postRequest({ waits: true }, { signal: AbortSignal.timeout(REQUEST_LIMIT_MS) });
    }
  }

  /** Sends changes until all of them are decided. */
  async #sendChanges() {
    if (this.#isSending) return;
    this.#isSending = true;
    while (!this.#isOver && this.#pythonState.pending.length) {
      const answer = await this.#postRequest({ changes: this.#pythonState.pending });
      if (answer?.slow) await pause(SLOW_RETRY_MS);
    }
    this.#isSending = false;
  }

  /** @param {Record<string, unknown>} fields @param {RequestInit} [options] @returns {Promise<any>} */
  async #postRequest(fields, options) {
    let answer;
    try {
      answer = await post({ ...this.#makeRequest(), ...fields }, options);
    } catch (error) {
      if (this.#isOver) return null;
      this.#listener.onRequestEnd(false);
      await pause(error instanceof ConnectionFailure ? SLOW_RETRY_MS : RETRY_MS);
      return null;
    }
    if (this.#isOver) return null;
    if (answer.left) {
      this.end();
      this.#listener.onLeft();
      return null;
    }
    this.#listener.onRequestEnd(true);
    await this.#handleNews(answer);
    return answer;
  }

  /** @param {any} news */
  async #handleNews(news) {
    const haveMatesChanged = JSON.stringify(news.others) !== JSON.stringify(this.#mates);
    this.#mates = news.others;
    for (const event of this.#newsCursor.take(news)) this.#listener.onRobotEvent(event);
    if (haveMatesChanged) {
      this.#showMates();
      this.#listener.onMatesChange(news.others);
    }
    if (!news.whole && !news.changes.length && !this.#pythonState.pending.length) return;
    this.#pendingNews.push(news);
    await this.#takeStep();
  }

  /** Tells the others where the caret is, now and then. */
  #sendCaret() {
    const { line, writes } = this.#blocksLine ?? { line: this.#caretLine, writes: this.#isLineTyped };
    const lineId = this.#pythonState.ids[line - 1] ?? '';
    const caretKey = JSON.stringify([lineId, writes]);
    if (caretKey === this.#sentCaretKey || !this.#pythonState.kept.name) return;
    this.#sentCaretKey = caretKey;
    clearTimeout(this.#caretTimer);
    this.#caretTimer = window.setTimeout(async () => {
      if (this.#isOver || await this.#postRequest({ at: lineId, writes }) || this.#isOver || caretKey !== this.#sentCaretKey) return;
      this.#sentCaretKey = ''; // it is lost
      this.#sendCaret();
    }, CARET_INTERVAL_MS);
  }
}

/** Whether something was typed in a line that is changed. @param {import('@codemirror/state').Text} doc @param {ChangeSet} typedChanges @param {[number, number, string][]} changes */
function doOverlap(doc, typedChanges, changes) {
  const lines = new Set();
  typedChanges.iterChangedRanges((from, to) => {
    for (let lineNumber = doc.lineAt(from).number; lineNumber <= doc.lineAt(to).number; lineNumber += 1) lines.add(lineNumber);
  });
  return changes.some(([from, to]) => {
    for (let lineNumber = doc.lineAt(from).number; lineNumber <= doc.lineAt(to).number; lineNumber += 1) if (lines.has(lineNumber)) return true;
    return false;
  });
}
