// Where the program in the text editor is to stop. Knows CodeMirror; a place moves with its text.

import { MapMode, RangeSet, RangeValue, StateEffect, StateField } from '@codemirror/state';
import { makeElement } from '../page/made.js';
import { Decoration, EditorView, GutterMarker, gutter, keymap } from '@codemirror/view';

/** @typedef {import('@codemirror/view').BlockInfo} BlockInfo */

class BreakpointValue extends RangeValue {
  startSide = 1; // what is written in front of its part does not belong to it
  endSide = 1;
  mapMode = MapMode.TrackAfter; // it goes with its first character
}

class DotMarker extends GutterMarker {
  toDOM() {
    return makeElement('span', '', '●');
  }
}

const DOT_MARKER = new DotMarker();
const FIRST_CHARACTER_MARK = Decoration.mark({ class: 'cm-breakpoint' });

/** @type {import('@codemirror/state').StateEffectType<{offset: number, isSet: boolean}>} */
const setBreakpointEffect = StateEffect.define();

/** @type {StateField<RangeSet<BreakpointValue>>} */
const breakpointField = StateField.define({
  create: () => RangeSet.empty,
  update(breakpointSet, transaction) {
    let newSet = breakpointSet.map(transaction.changes);
    for (const effect of transaction.effects) {
      if (!effect.is(setBreakpointEffect)) continue;
      const { offset, isSet } = effect.value;
      newSet = newSet.update({ filter: (from) => from !== offset, add: isSet ? [new BreakpointValue().range(offset)] : [] });
    }
    return newSet;
  },
  provide: (breakpointField) => EditorView.decorations.from(breakpointField, (breakpointSet) => {
    /** @type {import('@codemirror/state').Range<Decoration>[]} */
    const marks = [];
    for (let cursor = breakpointSet.iter(); cursor.value; cursor.next()) marks.push(FIRST_CHARACTER_MARK.range(cursor.from, cursor.from + 1));
    return (view) => Decoration.set(marks.filter((mark) => mark.to <= view.state.doc.length));
  }),
});

/**
 * The extension. `toggle` is asked with a place of the text, or the beginning of a line in whose
 * margin somebody has pressed.
 * @param {(offset: number, isWholeLine: boolean) => void} toggle
 * @param {() => void} onChange they, or the text they are in
 */
export function breakpointExtension(toggle, onChange) {
  return [
    breakpointField,
    gutter({
      class: 'cm-breakpoints',
      lineMarker: (view, line) => (offsetsBetween(view.state, line.from, line.to).length ? DOT_MARKER : null),
      lineMarkerChange: (update) => update.startState.field(breakpointField) !== update.state.field(breakpointField),
      domEventHandlers: { mousedown: (_, line, event) => onMarginPress(line, event, toggle) },
    }),
    keymap.of([{ key: 'F9', run: (view) => {
      toggle(view.state.selection.main.head, false);
      return true;
    } }]),
    EditorView.updateListener.of((update) => {
      if (update.docChanged || offsetsIn(update.startState).join() !== offsetsIn(update.state).join()) onChange();
    }),
  ];
}

/**
 * A press beside a line; the right button has the menu of the browser, and so has a press with Ctrl on a Mac.
 * @param {BlockInfo} line
 * @param {Event} event
 * @param {(offset: number, isWholeLine: boolean) => void} toggle
 */
export function onMarginPress(line, event, toggle) {
  if (!(event instanceof MouseEvent) || event.button !== 0 || event.ctrlKey) return false;
  toggle(line.from, true);
  return true;
}

/** @param {import('@codemirror/state').EditorState} state @returns {number[]} */
export function offsetsIn(state) {
  return offsetsBetween(state, 0, state.doc.length);
}

/**
 * Where the program is to stop; `point` stays the same while its text moves.
 * @param {import('@codemirror/state').EditorState} state
 * @returns {{offset: number, point: object}[]}
 */
export function breakpointsIn(state) {
  /** @type {{offset: number, point: object}[]} */
  const breakpoints = [];
  state.field(breakpointField).between(0, state.doc.length, (offset, _, point) => {
    breakpoints.push({ offset, point });
  });
  return breakpoints;
}

/**
 * @param {import('@codemirror/state').EditorState} state
 * @param {number} from
 * @param {number} to
 */
function offsetsBetween(state, from, to) {
  /** @type {number[]} */
  const offsets = [];
  state.field(breakpointField).between(from, to, (offset) => {
    offsets.push(offset);
  });
  return offsets;
}

/**
 * Sets and removes breakpoints.
 * @param {EditorView} view
 * @param {number[]} offsets
 * @param {boolean} isSet
 */
export function setBreakpoints(view, offsets, isSet) {
  view.dispatch({ effects: offsets.map((offset) => setBreakpointEffect.of({ offset, isSet })) });
}
