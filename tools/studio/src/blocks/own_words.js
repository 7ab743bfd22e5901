// The blocks of a word of one's own: DEF has a field for the name of each value, a call a place for each value.

import * as Blockly from 'blockly/core';
import { NameField } from './fields.js';
import { FREE_LETTERS, MOST_PARAMETERS, tipOf } from '../page/words.js';

const FINGER = 32; // units of a button on a block

/** @param {any} block @param {() => void} act fires what has changed of its state */
function changed(block, act) {
  const before = JSON.stringify(block.saveExtraState());
  act();
  const after = JSON.stringify(block.saveExtraState());
  if (before === after) return;
  Blockly.Events.fire(new (Blockly.Events.get(Blockly.Events.BLOCK_CHANGE))(block, 'mutation', null, before, after));
}

export const DEF = {
  /** @this {any} @returns {string[]} the names of its values */
  names() {
    const found = [];
    for (let k = 0; this.getField(`P${k}`); k += 1) found.push(String(this.getFieldValue(`P${k}`)));
    return found;
  },

  /** @this {any} */
  saveExtraState() {
    const names = this.names();
    return names.length ? { names } : null;
  },

  /** @this {any} @param {{names: string[]}} state */
  loadExtraState(state) {
    this.setNames(state.names);
  },

  /** @this {any} @param {string[]} names */
  setNames(names) {
    const row = this.getInput('NAMES');
    for (let k = names.length; this.getField(`P${k}`); k += 1) row.removeField(`P${k}`);
    names.forEach((name, k) => {
      if (this.getField(`P${k}`)) this.setFieldValue(name, `P${k}`);
      else row.insertFieldAt(k, new NameField(name), `P${k}`);
    });
  },

  /** @this {any} */
  more() {
    const names = this.names();
    if (names.length >= MOST_PARAMETERS) return;
    const taken = new Set([...names, ...this.workspace.getAllBlocks(false).map((/** @type {any} */ each) => each.getFieldValue('WORD'))]);
    const name = FREE_LETTERS.find((each) => !taken.has(each)) ?? `A_${names.length + 1}`;
    changed(this, () => this.setNames([...names, name]));
  },

  /** @this {any} */
  less() {
    changed(this, () => this.setNames(this.names().slice(0, -1)));
  },

  /** @this {any} adds the fields and buttons after its own name */
  addNames() {
    const row = this.appendDummyInput('NAMES');
    for (const [name, act] of [['more', () => this.more()], ['less', () => this.less()]]) {
      const tip = tipOf(`${name}_values`);
      row.appendField(new Blockly.FieldImage(`./${name}.svg`, FINGER, FINGER, tip, /** @type {any} */ (act))).fieldRow.at(-1).setTooltip(tip);
    }
  },
};

export const CALL = {
  count: 0,

  /** @this {any} */
  saveExtraState() {
    return this.count ? { count: this.count } : null;
  },

  /** @this {any} @param {{count: number}} state */
  loadExtraState(state) {
    this.setCount(state.count);
  },

  /** @this {any} @param {number} count of its values */
  setCount(count) {
    for (let k = 0; k < count; k += 1) {
      if (!this.getInput(`V${k}`)) this.appendValueInput(`V${k}`).connection.setShadowState({ type: 'number', fields: { WORD: 1 } });
    }
    for (let k = count; this.getInput(`V${k}`); k += 1) this.removeInput(`V${k}`);
    this.count = count;
  },
};

/** @param {Blockly.Workspace} workspace @returns {Map<string, any>} the first DEF of each name */
function defsOf(workspace) {
  return new Map(workspace.getBlocksByType('def').reverse().map((def) => [String(def.getFieldValue('WORD')), def]));
}

/** Says at each place of a call which value it is. @param {Blockly.Workspace} workspace */
export function labelCalls(workspace) {
  const defs = defsOf(workspace);
  for (const call of workspace.getBlocksByType('call')) {
    const names = defs.get(String(call.getFieldValue('WORD')))?.names() ?? [];
    for (let k = 0, input; (input = call.getInput(`V${k}`)); k += 1) {
      const label = call.getField(`L${k}`);
      if (label) label.setValue(names[k] ?? '');
      else input.appendField(new Blockly.FieldLabel(names[k] ?? ''), `L${k}`);
    }
  }
}

/**
 * Has the calls and the body of a DEF follow when the names of its values change.
 * @param {Blockly.Workspace} workspace
 * @param {any} event
 */
export function follow(workspace, event) {
  const def = /** @type {any} */ (workspace.getBlockById(event.blockId ?? ''));
  if (event.type !== Blockly.Events.BLOCK_CHANGE || def?.type !== 'def') return;
  if (event.element === 'field' && /^P\d/.test(event.name ?? '')) {
    for (const block of def.getDescendants(false)) {
      const isNamed = (block.type === 'name' || block.type === 'assign') && block.getFieldValue('WORD') === event.oldValue;
      if (isNamed) block.setFieldValue(event.newValue, 'WORD');
    }
  } else if (event.element === 'mutation') {
    const word = def.getFieldValue('WORD');
    for (const call of /** @type {any[]} */ (workspace.getBlocksByType('call'))) {
      if (call.getFieldValue('WORD') === word) call.setCount(def.names().length);
    }
  } else return;
  labelCalls(workspace);
}
