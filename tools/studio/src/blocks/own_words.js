// The blocks of a word of one's own: DEF has a field for the name of each value, a call a place for each value.

import * as Blockly from 'blockly/core';
import { NameField } from './fields.js';
import { FREE_LETTERS, MAX_PARAMETERS, tipOf } from '../page/words.js';

const BUTTON_UNITS = 32; // units of a button on a block

/** @param {any} block @param {() => void} change fires what has changed of its state */
function changeState(block, change) {
  const stateBefore = JSON.stringify(block.saveExtraState());
  change();
  const stateAfter = JSON.stringify(block.saveExtraState());
  if (stateBefore === stateAfter) return;
  Blockly.Events.fire(new (Blockly.Events.get(Blockly.Events.BLOCK_CHANGE))(block, 'mutation', null, stateBefore, stateAfter));
}

export const DEF_METHODS = {
  /** @this {any} @returns {string[]} the names of its values */
  names() {
    const names = [];
    for (let index = 0; this.getField(`P${index}`); index += 1) names.push(String(this.getFieldValue(`P${index}`)));
    return names;
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
    const input = this.getInput('NAMES');
    for (let index = names.length; this.getField(`P${index}`); index += 1) input.removeField(`P${index}`);
    names.forEach((name, index) => {
      if (this.getField(`P${index}`)) this.setFieldValue(name, `P${index}`);
      else input.insertFieldAt(index, new NameField(name), `P${index}`);
    });
  },

  /** @this {any} */
  addValue() {
    const names = this.names();
    if (names.length >= MAX_PARAMETERS) return;
    const takenNames = new Set([...names, ...this.workspace.getAllBlocks(false).map((/** @type {any} */ block) => block.getFieldValue('WORD'))]);
    const name = FREE_LETTERS.find((letter) => !takenNames.has(letter)) ?? `A_${names.length + 1}`;
    changeState(this, () => this.setNames([...names, name]));
  },

  /** @this {any} */
  removeValue() {
    changeState(this, () => this.setNames(this.names().slice(0, -1)));
  },

  /** @this {any} adds the fields and buttons after its own name */
  addNames() {
    const input = this.appendDummyInput('NAMES');
    for (const [name, onClick] of [['more', () => this.addValue()], ['less', () => this.removeValue()]]) {
      const tip = tipOf(`${name}_values`);
      input.appendField(new Blockly.FieldImage(`./${name}.svg`, BUTTON_UNITS, BUTTON_UNITS, tip, /** @type {any} */ (onClick))).fieldRow.at(-1).setTooltip(tip);
    }
  },
};

export const CALL_METHODS = {
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
    for (let index = 0; index < count; index += 1) {
      if (!this.getInput(`V${index}`)) this.appendValueInput(`V${index}`).connection.setShadowState({ type: 'number', fields: { WORD: 1 } });
    }
    for (let k = count; this.getInput(`V${k}`); k += 1) this.removeInput(`V${k}`);
    this.count = count;
  },
};

/** @param {Blockly.Workspace} workspace @returns {Map<string, any>} the first DEF of each name */
function definitionsOf(workspace) {
  return new Map(workspace.getBlocksByType('def').reverse().map((def) => [String(def.getFieldValue('WORD')), def]));
}

/** Says at each place of a call which value it is. @param {Blockly.Workspace} workspace */
export function labelCalls(workspace) {
  const defs = definitionsOf(workspace);
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
export function updateCalls(workspace, event) {
  const def = /** @type {any} */ (workspace.getBlockById(event.blockId ?? ''));
  if (event.type !== Blockly.Events.BLOCK_CHANGE || def?.type !== 'def') return;
  if (event.element === 'field' && /^P\d/.test(event.name ?? '')) {
    for (const block of def.getDescendants(false)) {
      const usesOldName = (block.type === 'name' || block.type === 'assign') && block.getFieldValue('WORD') === event.oldValue;
      if (usesOldName) block.setFieldValue(event.newValue, 'WORD');
    }
  } else if (event.element === 'mutation') {
    const word = def.getFieldValue('WORD');
    for (const call of /** @type {any[]} */ (workspace.getBlocksByType('call'))) {
      if (call.getFieldValue('WORD') === word) call.setCount(def.names().length);
    }
  } else return;
  labelCalls(workspace);
}
