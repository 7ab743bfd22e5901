// Where the program in the text editor is to stop. Knows CodeMirror; a place moves with its text.

import { MapMode, RangeSet, RangeValue, StateEffect, StateField } from '@codemirror/state';
import { makeElement } from '../page/made.js';
import { Decoration, EditorView, GutterMarker, gutter, keymap } from '@codemirror/view';

/** @typedef {import('@codemirror/view').BlockInfo} BlockInfo */

class Breakpoint extends RangeValue {
  startSide = 1; // what is written in front of its part does not belong to it
  endSide = 1;
  mapMode = MapMode.TrackAfter; // it goes with its first character
}

class Dot extends GutterMarker {
  toDOM() {
    return makeElement('span', '', '●');
  }
}

const DOT = new Dot();
const FIRST = Decoration.mark({ class: 'cm-breakpoint' });

/** @type {import('@codemirror/state').StateEffectType<{at: number, isSet: boolean}>} */
const change = StateEffect.define();

/** @type {StateField<RangeSet<Breakpoint>>} */
const field = StateField.define({
  create: () => RangeSet.empty,
  update(points, transaction) {
    let found = points.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(change)) continue;
      const { at, isSet } = effect.value;
      found = found.update({ filter: (from) => from !== at, add: isSet ? [new Breakpoint().range(at)] : [] });
    }
    return found;
  },
  provide: (points) => EditorView.decorations.from(points, (set) => {
    /** @type {import('@codemirror/state').Range<Decoration>[]} */
    const marks = [];
    for (let each = set.iter(); each.value; each.next()) marks.push(FIRST.range(each.from, each.from + 1));
    return (view) => Decoration.set(marks.filter((mark) => mark.to <= view.state.doc.length));
  }),
});

/**
 * The extension. `toggle` is asked with a place of the text, or the beginning of a line in whose
 * margin somebody has pressed.
 * @param {(at: number, isLine: boolean) => void} toggle
 * @param {() => void} changed they, or the text they are in
 */
export function breakpoints(toggle, changed) {
  return [
    field,
    gutter({
      class: 'cm-breakpoints',
      lineMarker: (view, line) => (within(view.state, line.from, line.to).length ? DOT : null),
      lineMarkerChange: (update) => update.startState.field(field) !== update.state.field(field),
      domEventHandlers: { mousedown: (_, line, event) => pressed(line, event, toggle) },
    }),
    keymap.of([{ key: 'F9', run: (view) => {
      toggle(view.state.selection.main.head, false);
      return true;
    } }]),
    EditorView.updateListener.of((update) => {
      if (update.docChanged || placesOf(update.startState).join() !== placesOf(update.state).join()) changed();
    }),
  ];
}

/**
 * A press beside a line; the right button has the menu of the browser, and so has a press with Ctrl on a Mac.
 * @param {BlockInfo} line
 * @param {Event} event
 * @param {(at: number, isLine: boolean) => void} toggle
 */
export function pressed(line, event, toggle) {
  if (!(event instanceof MouseEvent) || event.button !== 0 || event.ctrlKey) return false;
  toggle(line.from, true);
  return true;
}

/** @param {import('@codemirror/state').EditorState} state @returns {number[]} */
export function placesOf(state) {
  return within(state, 0, state.doc.length);
}

/**
 * Where the program is to stop; `point` stays the same while its text moves.
 * @param {import('@codemirror/state').EditorState} state
 * @returns {{at: number, point: object}[]}
 */
export function pointsOf(state) {
  /** @type {{at: number, point: object}[]} */
  const found = [];
  state.field(field).between(0, state.doc.length, (at, _, point) => {
    found.push({ at, point });
  });
  return found;
}

/**
 * @param {import('@codemirror/state').EditorState} state
 * @param {number} from
 * @param {number} to
 */
function within(state, from, to) {
  /** @type {number[]} */
  const found = [];
  state.field(field).between(from, to, (at) => {
    found.push(at);
  });
  return found;
}

/**
 * Sets and removes breakpoints.
 * @param {EditorView} view
 * @param {number[]} places
 * @param {boolean} isSet
 */
export function setBreakpoints(view, places, isSet) {
  view.dispatch({ effects: places.map((at) => change.of({ at, isSet })) });
}
