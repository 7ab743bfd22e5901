// How Blockly shows the kinds of blocks: their words, places, colours and fields. The kinds and the
// order of their values are those of `studio/block_kinds.py`.

import * as Blockly from 'blockly/core';
import { ArrowField, LineField, NameField, NumberField, UnitField } from './fields.js';
import { CALL, DEF } from './own_words.js';
import { rangeOf } from './places.js';
import { labelOf } from '../page/texts.js';
import { devicesOf, KINDS, deviceName, blockLabel, pieceOf, REMOTE, tipOf } from '../page/words.js';

/** @import { ValueKind, BlockKind } from '../page/words.js' */

const CHECKS = { number: 'Number', truth: 'Boolean', any: null };
/** @type {string} */
let robot = '';

/** @param {string} name of the robot whose words are offered */
export function setRobot(name) {
  robot = name;
}

/** @type {string[]} */
let fresh = [];

/** @param {string[]} kinds of blocks that glow where they are taken from */
export function setNew(kinds) {
  fresh = kinds;
}

const FOLDED = ['compare', 'logic', 'motors', 'move_until', 'random', 'round', 'extreme'];
const LONG = 9; // letters of a move: with more it is folded, too
let isNarrow = false;

/** @param {boolean} is long blocks have their second half below the first from now on: on a phone they are not seen side by side */
export function setNarrow(is) {
  isNarrow = is;
}

/** @param {'sensor' | 'actuator'} role */
export function devices(role) {
  return devicesOf(robot, role);
}

/** Lets what a text says stand anywhere: the compiler says what does not fit. */
export class Checker extends Blockly.ConnectionChecker {
  static isLenient = false;

  /** @param {Blockly.Connection} a @param {Blockly.Connection} b */
  doTypeChecks(a, b) {
    return Checker.isLenient || super.doTypeChecks(a, b);
  }
}

/**
 * @param {Blockly.Block} block
 * @param {BlockKind} shape
 * @returns {Blockly.Field | null} what stands before its values
 */
function firstField(block, shape) {
  if (shape.words.length) return options(shape.words.map((word) => [blockLabel(word), word]));
  if (shape.field === 'name') return new NameField('X');
  if (shape.field === 'line') return new LineField('');
  if (shape.field) return new DeviceField(shape.field);
  return block.type === 'number' ? new NumberField(0) : null;
}

/** @param {string[][]} rows */
function options(rows) {
  return new Blockly.FieldDropdown(/** @type {[string, string][]} */ (rows));
}

/** A word of the robot; one that it does not have stays, too. */
class DeviceField extends Blockly.FieldDropdown {
  /** @param {'sensor' | 'actuator'} role */
  constructor(role) {
    /** @this {any} */
    super(function () {
      const rows = [...devices(role), ...(role === 'sensor' ? REMOTE : [])].map((device) => /** @type {[string, string]} */ ([deviceName(device), device.text]));
      const kept = /** @type {any} */ (this).kept;
      if (kept && !rows.some(([, name]) => name === kept)) rows.push([kept, kept]);
      return rows.length ? rows : [['?', '?']];
    });
  }

  /** @param {string} [value] */
  doClassValidation_(value) {
    if (typeof value !== 'string') return null;
    /** @type {any} */ (this).kept = value;
    return value;
  }
}

/**
 * Adds what a message says, its fields and places.
 * @param {Blockly.Block} block
 * @param {string} message
 * @param {(number: number) => Blockly.Field | string} what a field, or the name of a place
 * @param {(name: string) => ValueKind} kindOf
 * @param {boolean} [isFolded] a question begins a row, so that it is seen beside a lesson, too
 * @param {boolean} [isBroken] so does its second value
 */
function add(block, message, what, kindOf, isFolded = false, isBroken = false) {
  let label = '';
  /** @type {Blockly.Field[]} */
  let fields = [];
  const flush = () => {
    const text = label.trim();
    if (text) fields.push(new Blockly.FieldLabel(text));
    label = '';
  };
  const endRow = () => {
    if (!fields.length) return;
    const input = block.appendDummyInput();
    for (const field of fields) input.appendField(field, field.name);
    fields = [];
  };
  for (const part of message.split(/(%\d|%%)/)) {
    if (part === '%%') label += '%';
    else if (!/^%\d$/.test(part)) label += part;
    else {
      flush();
      const shape = what(Number(part[1]));
      if (typeof shape !== 'string') {
        fields.push(shape);
        continue;
      }
      if (isFolded && kindOf(shape) === 'truth') {
        endRow();
        block.appendEndRowInput();
      }
      if (isBroken && shape === 'V1') block.appendEndRowInput();
      const input = block.appendValueInput(shape).setCheck(CHECKS[kindOf(shape)]);
      for (const field of fields) input.appendField(field, field.name);
      fields = [];
    }
  }
  flush();
  endRow();
}

/** @param {Blockly.Field} field @param {string} name */
function named(field, name) {
  field.name = name;
  return field;
}

/** @param {Blockly.Block} block @param {boolean} is its second value stands below the first */
function fold(block, is) {
  if (is === Boolean(block.getInput('FOLD'))) return;
  if (!is) block.removeInput('FOLD');
  else {
    block.appendEndRowInput('FOLD');
    block.moveInputBefore('FOLD', 'V1');
  }
}

/** @param {any} block @param {string} kind */
function glow(block, kind) {
  if (!block.isInFlyout) return;
  queueMicrotask(() => { // once it has its word
    if (!block.isDisposed() && fresh.includes(pieceOf(kind, String(block.getFieldValue('WORD') ?? '')))) block.addClass('fresh');
  });
}

/** @param {Blockly.Block} block @param {string} kind @param {BlockKind} shape */
function build(block, kind, shape) {
  const first = firstField(block, shape);
  const unit = Object.keys(shape.units).length ? new UnitField(shape.units) : null;
  const arrow = unit ? new ArrowField() : null; // of a move
  if (unit) {
    first?.setValidator((word) => {
      unit.forceRerender();
      arrow?.forceRerender();
      if (kind === 'move') fold(block, isNarrow && blockLabel(word).length > LONG);
    });
  }
  if (kind === 'set') first?.setValidator((word) => fill(block, kind, shape.values, word));
  let value = 0;
  add(block, blockLabel(kind), (number) => {
    if (first && number === 1) return named(first, 'WORD');
    if (unit && number === 3) return named(unit, 'UNIT');
    return `V${value++}`;
  }, (name) => shape.values[Number(name.slice(1))] ?? 'any', !shape.gives, isNarrow && FOLDED.includes(kind));
  if (arrow) block.inputList.find(({ fieldRow }) => fieldRow.includes(/** @type {Blockly.Field} */ (first)))?.insertFieldAt(0, arrow);
  for (let k = 0; k < shape.bodies && !shape.is_hat; k += 1) block.appendStatementInput(`B${k}`);
  block.setInputsInline(true);
  if (shape.gives) block.setOutput(true, CHECKS[shape.gives]);
  else {
    block.setPreviousStatement(!shape.is_hat);
    block.setNextStatement(true);
  }
  block.setStyle(shape.colour);
  if (shape.is_hat) block.hat = 'cap';
  fill(block, kind, shape.values);
}

/**
 * Gives every place a value of its kind that is there while nothing else is.
 * @param {Blockly.Block} block
 * @param {string} kind
 * @param {ValueKind[]} values
 * @param {string} [word] that is on it from now on
 */
function fill(block, kind, values, word = String(block.getFieldValue('WORD') ?? '')) {
  values.forEach((place, k) => {
    const { sample } = rangeOf(kind, word, k);
    const device = kind === 'set' ? devices('actuator').find((each) => each.text === word) : undefined;
    const value = place === 'truth' || device?.is_yes_no ? truth() : { type: 'number', fields: { WORD: Number(sample) } };
    const connection = block.getInput(`V${k}`)?.connection;
    if (connection?.getShadowState()?.type !== value.type) connection?.setShadowState(value);
  });
}

function truth() {
  return { type: 'truth', fields: { WORD: 'TRUE' } };
}

const MOST_ARMS = 20;
const FINGER = 32; // units of a button on a block: 24 pixels at the least scale

/** The block of IF: as many arms as its state says. */
const IF = {
  arms: 1,
  hasElse: false,

  /** @this {any} */
  saveExtraState() {
    return { arms: this.arms, hasElse: this.hasElse };
  },

  /** @this {any} @param {{arms: number, hasElse: boolean}} state */
  loadExtraState(state) {
    this.setArms(state.arms, state.hasElse);
  },

  /** @this {any} @param {number} arms @param {boolean} hasElse */
  setArms(arms, hasElse) {
    this.arms = arms;
    this.hasElse = hasElse;
    for (let k = 0; k < arms; k += 1) {
      if (this.getInput(`V${k}`)) continue;
      add(this, blockLabel(k ? 'elseif' : 'if'), () => `V${k}`, () => 'truth');
      this.getInput(`V${k}`).connection.setShadowState(truth());
      this.appendStatementInput(`B${k}`);
      if (this.getInput('ELSE')) {
        for (const name of [`V${k}`, `B${k}`]) this.moveInputBefore(name, 'ELSE');
      }
    }
    for (let k = arms; this.getInput(`V${k}`); k += 1) {
      this.removeInput(`V${k}`);
      this.removeInput(`B${k}`);
    }
    if (hasElse && !this.getInput('ELSE')) {
      this.appendDummyInput('ELSE').appendField(blockLabel('else'));
      this.appendStatementInput('OTHERWISE');
    } else if (!hasElse && this.getInput('ELSE')) {
      this.removeInput('ELSE');
      this.removeInput('OTHERWISE');
    }
    if (this.getInput('MORE')) this.moveInputBefore('MORE', null);
  },

  /** @this {any} */
  more() {
    this.change(this.hasElse ? Math.min(this.arms + 1, MOST_ARMS) : this.arms, true);
  },

  /** @this {any} */
  less() {
    if (this.arms > 1) this.change(this.arms - 1, this.hasElse);
    else this.change(1, false);
  },

  /** @this {any} @param {number} arms @param {boolean} hasElse */
  change(arms, hasElse) {
    const before = JSON.stringify(this.saveExtraState());
    this.setArms(arms, hasElse);
    const after = JSON.stringify(this.saveExtraState());
    if (before !== after) {
      Blockly.Events.fire(new (Blockly.Events.get(Blockly.Events.BLOCK_CHANGE))(this, 'mutation', null, before, after));
    }
  },

  /** @this {any} */
  init() {
    this.setArms(1, false);
    const buttons = this.appendDummyInput('MORE');
    for (const [name, act] of [['more', () => this.more()], ['less', () => this.less()]]) {
      const picture = new Blockly.FieldImage(`./${name}.svg`, FINGER, FINGER, tipOf(String(name)), /** @type {any} */ (act));
      picture.setTooltip(tipOf(String(name)));
      buttons.appendField(picture);
    }
    this.setInputsInline(true);
    this.setPreviousStatement(true);
    this.setNextStatement(true);
    this.setStyle('control');
    this.setTooltip(tipOf('if'));
    glow(this, 'if');
  },
};

/** Makes all kinds known, in the page's language. */
export function defineBlocks() {
  Blockly.Blocks['program'] = {
    /** @this {Blockly.Block} */
    init() {
      this.appendDummyInput().appendField(options(['SI', 'SB', 'PING'].map((word) => [blockLabel(word), word])), 'WORD');
      this.setNextStatement(true);
      this.setDeletable(false);
      this.setMovable(false); // what is dragged is all that is seen
      this.setStyle('program');
      this.setTooltip(tipOf('program'));
    },
  };
  for (const [kind, shape] of Object.entries(KINDS)) {
    const more = { def: DEF, call: CALL }[kind] ?? {};
    Blockly.Blocks[kind] = kind === 'if' ? IF : {
      ...more,
      /** @this {Blockly.Block} */
      init() {
        build(this, kind, shape);
        glow(this, kind);
        if (kind === 'def') /** @type {any} */ (this).addNames();
        this.setTooltip(tipOf(kind));
        if (shape.field === 'sensor' || shape.field === 'actuator') this.setTooltip(() => deviceTip(this));
      },
    };
  }
}

/** @param {Blockly.Block} block of a device */
function deviceTip(block) {
  const name = block.getFieldValue('WORD');
  const device = [...devices('sensor'), ...REMOTE, ...devices('actuator')].find((each) => each.text === name);
  const label = device && `${name}: ${labelOf(device.labels)}${device.unit ? ` (${device.unit})` : ''}.`;
  return [label, tipOf(block.type)].filter(Boolean).join(' ');
}
