// A pupil's text editor, in which others edit, too. The program is a tree that Python keeps in the worker
// (`studio/page_together.py`); here is what the editor has of it: when a line is finished, what the others have
// changed, and where they are. What was typed while Python was at work stays: it is never mixed with their changes
// in one line. Knows CodeMirror.

import { Annotation, ChangeSet, StateEffect, StateField, Transaction } from '@codemirror/state';
import { Decoration, EditorView, WidgetType } from '@codemirror/view';
import { makeElement } from '../page/made.js';
import { post } from '../robot/host.js';
import { ConnectionFailure, pause } from '../robot/transport.js';

const HELD_MS = 12_000; // the class holds a request for 8 s
const AGAIN_MS = 700; // where the class does not answer
const SLOW_MS = 1500; // where it takes no more changes for now
const CARET_MS = 300; // between two of its places that others hear
const FINISHED = ['undo', 'redo', 'input.repair', 'input.blocks']; // changes of lines that nobody is typing
const BUSY_MS = 2000; // that changes of others wait for somebody's hands
const SOON_MS = 50;
const DECIDED_MS = 2000; // for what was done before an undo

/** @typedef {{name: string, mark: number, at: string, writes: boolean}} Other */
/** @typedef {{line: number, color: string, said: string}} Place */

/**
 * @typedef {object} Shown what Python answers
 * @property {number} version
 * @property {[number, number, string][]} changes of the text that it was asked with
 * @property {string[]} ids of the lines
 * @property {{uid: string}[]} pending
 * @property {number} since
 * @property {string} epoch
 * @property {number} told how many changes were refused
 * @property {string} why
 * @property {number} count of own changes
 * @property {boolean} [is_shown] whether the text is that of the blocks which it was asked with
 * @property {[number, number, number, number][]} [places] of these
 * @property {{name: string}} kept
 */

/**
 * @typedef {object} Heard who hears of it
 * @property {(why: unknown) => void} fails that is a bug
 * @property {() => void} left this page is not in the group any more
 * @property {(others: Other[]) => void} others who is here has changed
 * @property {(why: string) => void} refused a change of this page was
 * @property {(kept: {name: string}) => void} keep what a page goes on with that is loaded again
 * @property {(isHeard: boolean) => void} answers whether the class answers
 * @property {(places: Place[]) => void} places where the others are in the text
 * @property {(event: import('../robot/panel.js').GroupRobotEvent) => void} runs the group's robot, which another page drives, has told this
 * @property {() => boolean} isBusy whether somebody has a block in the hand, or a field open
 */

/** A change that somebody else has made, or the layout. @type {import('@codemirror/state').AnnotationType<boolean>} */
const brought = Annotation.define();
/** @type {import('@codemirror/state').StateEffectType<{line: number, other: Other}[]>} */
const setOthers = StateEffect.define();

class Name extends WidgetType {
  /** @param {Other} other */
  constructor(other) {
    super();
    this.other = other;
  }

  /** @param {Name} widget */
  eq({ other }) {
    return other.name === this.other.name && other.mark === this.other.mark && other.writes === this.other.writes;
  }

  toDOM() {
    const { name, mark, writes } = this.other;
    const found = makeElement('span', '', writes ? `${name} …` : name);
    found.className = `cm-mate cm-mate-${mark}`;
    return found;
  }
}

const others = StateField.define({
  create: () => Decoration.none,
  update(marks, transaction) {
    let found = marks.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setOthers)) continue;
      const { doc } = transaction.state;
      const ranges = effect.value.filter(({ line }) => line <= doc.lines).flatMap(({ line, other }) => {
        const { from, to } = doc.line(line);
        return [
          Decoration.line({ class: `cm-beside cm-mate-${other.mark}` }).range(from),
          Decoration.widget({ widget: new Name(other), side: 1 }).range(to),
        ];
      });
      found = Decoration.set(ranges, true);
    }
    return found;
  },
  provide: (field) => EditorView.decorations.from(field),
});

// Dark enough for white letters, as beside white and beside black; the last one is the teacher's.
const COLORS = ['#0b4f9e', '#8a3c00', '#0d6040', '#7a2fb8', '#a3145c'];
const looks = EditorView.baseTheme({
  '.cm-beside': { boxShadow: 'inset 4px 0 var(--mate)' },
  '.cm-mate': { marginLeft: '1ch', padding: '0 6px', borderRadius: '6px', backgroundColor: 'var(--mate)', color: '#fff', fontSize: '0.85em' },
  ...Object.fromEntries(COLORS.map((color, k) => [`.cm-mate-${k}`, { '--mate': color }])),
});

/** Mates as a list of names in their colours. @param {Other[]} all */
export function named(all) {
  return all.map(({ name, mark }) => {
    const found = makeElement('span', '', name);
    found.className = 'mate';
    found.style.setProperty('--mate', COLORS[mark] ?? '');
    return found;
  });
}

export class Together {
  #python;
  #editor;
  #view;
  #heard;
  #isOver = false;
  #isHot = false; // a key was pressed in the line of the caret since the caret came there
  #line = 0; // that of the caret, as it was last seen
  /** What was typed since Python was asked. @type {ChangeSet | null} */
  #meanwhile = null;
  /** @type {any[]} */
  #news = [];
  /** @type {Promise<unknown> | null} */
  #waiting = null;
  /** @type {Promise<unknown>} */
  #steps = Promise.resolve();
  #isSending = false;
  #saw = 0;
  /** Until where it is known what the robot has told. @type {[string, number]} */
  #ran = ['', 0];
  /** @type {Other[]} */
  #others = [];
  /** @type {Shown} */
  #shown = { version: 0, changes: [], ids: [], pending: [], since: -1, epoch: '', told: 0, why: '', count: 0, kept: { name: '' } };
  /** @type {{line: number, writes: boolean} | null} */
  #chosen = null; // of the blocks
  #at = '';
  #caret = 0;

  /**
   * @param {import('../python.js').Python} python
   * @param {import('../writing/editor.js').Editor} editor
   * @param {Heard} heard
   */
  constructor(python, editor, heard) {
    this.#python = python;
    this.#editor = editor;
    this.#heard = heard;
    editor.handUndo((how) => this.#takeBack(how));
    this.#view = editor.extend([others, looks, EditorView.updateListener.of((update) => this.#updated(update))]);
  }

  /** Shows the program of a group. @param {any} news of the class @param {unknown} kept by this page, before it was loaded again */
  async begin(news, kept) {
    for (;;) {
      const { doc } = this.#view.state;
      const shown = await this.#python.ask({ do: 'group_begin', news, kept }, new TextEncoder().encode(doc.toString()));
      if (doc !== this.#view.state.doc) continue; // somebody has typed meanwhile
      this.#take(shown, doc.length, null);
      break;
    }
    this.#listen();
  }

  /** The group is left; the text stays. */
  end() {
    if (this.#isOver) return;
    this.#isOver = true;
    this.#others = [];
    this.#mark();
    this.#editor.handUndo(null);
  }

  /** What is finished becomes the group's. @returns {Promise<unknown>} */
  finish() {
    this.#isHot = false;
    return this.#step();
  }

  /** Python has what the editor has. @returns {Promise<unknown>} */
  meet() {
    return this.#step();
  }

  /** The blocks show what the editor has: each is in a line. @param {[string, number][]} lines @returns {Promise<{is_known: boolean}>} */
  blocksShown(lines) {
    return this.#python.ask({ do: 'group_blocks', version: this.#shown.version, lines });
  }

  /** The blocks are this now. @param {import('../blocks/form.js').Form} form @param {string[]} ids @returns {Promise<Shown | null>} null of who has left */
  write(form, ids) {
    return this.#do({ blocks: { form, ids } });
  }

  /** @param {'undo' | 'redo'} how */
  async #takeBack(how) {
    await this.finish();
    for (let waited = 0; this.#shown.pending.length && waited < DECIDED_MS; waited += SOON_MS) await pause(SOON_MS); // what is not decided yet is the newest
    await this.#do({ back: how });
  }

  /** @param {import('@codemirror/view').ViewUpdate} update */
  #updated(update) {
    if (this.#isOver) return;
    const own = update.transactions.filter((each) => each.docChanged && !each.annotation(brought));
    const line = update.state.doc.lineAt(update.state.selection.main.head).number;
    if (own.length) {
      this.#meanwhile = this.#meanwhile?.compose(update.changes) ?? null;
      const isTyped = this.#view.hasFocus && !own.some((each) => FINISHED.some((event) => each.isUserEvent(event)));
      const isOtherLine = update.startState.doc.lines !== update.state.doc.lines || (this.#isHot && line !== this.#line);
      this.#isHot = isTyped;
      if (!isTyped || isOtherLine) this.#step();
    } else if (!update.docChanged && this.#isHot && line !== this.#line) {
      this.finish();
    }
    if (update.focusChanged && !this.#view.hasFocus && this.#isHot) this.finish();
    this.#line = line;
    this.#tellCaret();
  }

  /** Has Python take what is in the editor, and what has come; one at a time. @returns {Promise<unknown>} */
  #step() {
    this.#waiting ??= this.#do({}, () => {
      this.#waiting = null;
    });
    return this.#waiting;
  }

  /** @param {Record<string, unknown>} more that is done, too @param {() => void} [begins] @returns {Promise<Shown | null>} */
  #do(more, begins) {
    const done = this.#steps.then(async () => {
      begins?.();
      if (!Object.keys(more).length) await this.#waitForHands();
      let shown = null;
      while (!this.#isOver && !shown) shown = await this.#try(more);
      this.#send();
      return shown;
    }).catch((why) => {
      this.end();
      this.#heard.fails(why);
      return null;
    });
    this.#steps = done;
    return done;
  }

  /** What others have changed waits while a sign is composed, a block is dragged or a field is open. */
  async #waitForHands() {
    for (let waited = 0; waited < BUSY_MS && (this.#view.composing || this.#heard.isBusy()); waited += SOON_MS) await pause(SOON_MS);
  }

  /** @param {Record<string, unknown>} more @returns {Promise<Shown | null>} what is shown now; null where somebody has typed what others have changed */
  async #try(more) {
    const { doc, selection } = this.#view.state;
    const news = this.#news.slice();
    this.#meanwhile = ChangeSet.empty(doc.length);
    const caret = doc.lineAt(selection.main.head).number - 1;
    /** @type {Shown} */
    const shown = await this.#python.ask({ do: 'group_step', from: this.#shown.version, caret, hot: this.#isHot, news, ...more }, new TextEncoder().encode(doc.toString()));
    const typed = this.#meanwhile;
    this.#meanwhile = null;
    if (this.#isOver || meet(doc, typed, shown.changes)) return null;
    this.#news.splice(0, news.length);
    this.#take(shown, doc.length, typed);
    return shown;
  }

  /** @param {Shown} shown @param {number} length of the text that it was made of @param {ChangeSet | null} typed since */
  #take(shown, length, typed) {
    const { told, count } = this.#shown;
    this.#shown = shown;
    const changes = ChangeSet.of(shown.changes.map(([from, to, insert]) => ({ from, to, insert })), length);
    const after = typed && !typed.empty ? changes.map(typed) : changes;
    const { selection, doc } = this.#view.state;
    const isFirst = doc.lineAt(selection.main.head).from === selection.main.head; // what is put in there is before its line
    this.#view.dispatch({
      changes: after,
      ...(isFirst && { selection: selection.map(after, 1) }), // else it is mapped so anyway; saying it would end a composition
      annotations: [brought.of(true), Transaction.addToHistory.of(false)],
    });
    if (shown.count > count) this.#editor.handUndo((how) => this.#takeBack(how));
    this.#mark();
    this.#heard.keep(shown.kept);
    if (shown.told > told && this.#shown.version > 1) this.#heard.refused(shown.why);
  }

  #mark() {
    const places = this.#others.map((other) => ({ line: this.#shown.ids.indexOf(other.at) + 1, other })).filter(({ line }) => line > 0);
    this.#view.dispatch({ effects: setOthers.of(places) });
    this.#heard.places(places.map(({ line, other: { name, mark, writes } }) => ({ line, color: COLORS[mark] ?? '', said: writes ? `${name} …` : name })));
  }

  /** The blocks have the focus in this line, or nowhere. @param {number} line @param {boolean} writes */
  chose(line, writes) {
    this.#chosen = line ? { line, writes } : null;
    this.#tellCaret();
  }

  // -- the class --

  #request() {
    const { since, epoch, kept } = this.#shown;
    return { do: 'group', page: kept.name, since, epoch, saw: this.#saw, ran: this.#ran };
  }

  /** Hears what is new, for as long as this page is in the group. */
  async #listen() {
    while (!this.#isOver) {
      await this.#ask({ waits: true }, { signal: AbortSignal.timeout(HELD_MS) });
    }
  }

  /** Sends changes until all of them are decided. */
  async #send() {
    if (this.#isSending) return;
    this.#isSending = true;
    while (!this.#isOver && this.#shown.pending.length) {
      const answer = await this.#ask({ changes: this.#shown.pending });
      if (answer?.slow) await pause(SLOW_MS);
    }
    this.#isSending = false;
  }

  /** @param {Record<string, unknown>} more @param {RequestInit} [options] @returns {Promise<any>} */
  async #ask(more, options) {
    let answer;
    try {
      answer = await post({ ...this.#request(), ...more }, options);
    } catch (why) {
      if (this.#isOver) return null;
      this.#heard.answers(false);
      await pause(why instanceof ConnectionFailure ? SLOW_MS : AGAIN_MS);
      return null;
    }
    if (this.#isOver) return null;
    if (answer.left) {
      this.end();
      this.#heard.left();
      return null;
    }
    this.#heard.answers(true);
    await this.#hear(answer);
    return answer;
  }

  /** @param {any} news */
  async #hear(news) {
    const isOther = JSON.stringify(news.others) !== JSON.stringify(this.#others);
    this.#saw = Math.max(this.#saw, news.saw);
    this.#others = news.others;
    this.#hearRuns(news);
    if (isOther) {
      this.#mark();
      this.#heard.others(news.others);
    }
    if (!news.whole && !news.changes.length && !this.#shown.pending.length) return;
    this.#news.push(news);
    await this.#step();
  }

  /** Two answers may tell the same. @param {{ran: [string, number], runs?: import('../robot/panel.js').GroupRobotEvent[]}} news */
  #hearRuns({ ran: [key, newest], runs = [] }) {
    const known = key === this.#ran[0] ? this.#ran[1] : 0;
    this.#ran = [key, Math.max(known, newest)];
    for (const event of runs) if (event.number > known) this.#heard.runs(event);
  }

  /** Tells the others where the caret is, now and then. */
  #tellCaret() {
    const { line, writes } = this.#chosen ?? { line: this.#line, writes: this.#isHot };
    const at = this.#shown.ids[line - 1] ?? '';
    const told = JSON.stringify([at, writes]);
    if (told === this.#at || !this.#shown.kept.name) return;
    this.#at = told;
    clearTimeout(this.#caret);
    this.#caret = window.setTimeout(() => {
      if (!this.#isOver) this.#ask({ at, writes });
    }, CARET_MS);
  }
}

/** Whether something was typed in a line that is changed. @param {import('@codemirror/state').Text} doc @param {ChangeSet} typed @param {[number, number, string][]} changes */
function meet(doc, typed, changes) {
  const lines = new Set();
  typed.iterChangedRanges((from, to) => {
    for (let k = doc.lineAt(from).number; k <= doc.lineAt(to).number; k += 1) lines.add(k);
  });
  return changes.some(([from, to]) => {
    for (let k = doc.lineAt(from).number; k <= doc.lineAt(to).number; k += 1) if (lines.has(k)) return true;
    return false;
  });
}
