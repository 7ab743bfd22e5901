// How Blockly shows the kinds of blocks: their words, places, colours and fields. The kinds and the
// order of their values are those of `studio/block_kinds.py`.

import * as Blockly from 'blockly/core';
import { ArrowField, LineField, NameField, NumberField, UnitField } from './fields.js';
import { CALL_METHODS, DEF_METHODS } from './own_words.js';
import { rangeOf } from './places.js';
import { labelOf } from '../page/texts.js';
import { devicesOf, KINDS, deviceName, blockLabel, pieceOf, REMOTE_DEVICES, tipOf } from '../page/words.js';

/** @import { ValueKind, BlockKind } from '../page/words.js' */

const CHECKS = { number: 'Number', truth: 'Boolean', any: null };
/** @type {string} */
let robotName = '';

/** @param {string} name of the robot whose words are offered */
export function setRobot(name) {
  robotName = name;
}

/** @type {string[]} */
let newPieces = [];

/** @param {string[]} pieces of blocks that glow where they are taken from */
export function setNewPieces(pieces) {
  newPieces = pieces;
}

const FOLDED_KINDS = ['compare', 'logic', 'motors', 'move_until', 'random', 'round', 'extreme'];
const MOVE_PX = 335; // pixels of the page's width that a move takes without its word, the groups beside it,
const LETTER_PX = 8; // and for each letter of its word: where there are fewer it is folded, too
let isNarrow = false;

/** @param {boolean} isNarrowNow long blocks have their second half below the first from now on: on a phone they are not seen side by side */
export function setNarrow(isNarrowNow) {
  isNarrow = isNarrowNow;
}

/** @param {'sensor' | 'actuator'} role */
export function devicesOfRole(role) {
  return devicesOf(robotName, role);
}

/** Lets what a text says stand anywhere: the compiler says what does not fit. */
export class LenientConnectionChecker extends Blockly.ConnectionChecker {
  static isLenient = false;

  /** @param {Blockly.Connection} a @param {Blockly.Connection} b */
  doTypeChecks(a, b) {
    return LenientConnectionChecker.isLenient || super.doTypeChecks(a, b);
  }
}

/**
 * @param {Blockly.Block} block
 * @param {BlockKind} blockKind
 * @returns {Blockly.Field | null} what stands before its values
 */
function makeFirstField(block, blockKind) {
  if (blockKind.words.length) return makeOptionsField(blockKind.words.map((word) => [blockLabel(word), word]));
  if (blockKind.field === 'name') return new NameField('X');
  if (blockKind.field === 'line') return new LineField('');
  if (blockKind.field) return new DeviceField(blockKind.field);
  return block.type === 'number' ? new NumberField(0) : null;
}

/** @param {string[][]} rows */
function makeOptionsField(rows) {
  return new Blockly.FieldDropdown(/** @type {[string, string][]} */ (rows));
}

/** A word of the robot; one that it does not have stays, too. */
class DeviceField extends Blockly.FieldDropdown {
  /** @param {'sensor' | 'actuator'} role */
  constructor(role) {
    /** @this {any} */
    super(function () {
      const rows = [...devicesOfRole(role), ...(role === 'sensor' ? REMOTE_DEVICES : [])].map((device) => /** @type {[string, string]} */ ([deviceName(device), device.text]));
      const currentValue = /** @type {any} */ (this).kept;
      if (currentValue && !rows.some(([, name]) => name === currentValue)) rows.push([currentValue, currentValue]);
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
 * @param {(number: number) => Blockly.Field | string} makePart a field, or the name of a place
 * @param {(name: string) => ValueKind} kindOf
 * @param {boolean} [isFolded] a question begins a row, so that it is seen beside a lesson, too
 * @param {boolean} [isBroken] so does its second value
 */
function appendMessage(block, message, makePart, kindOf, isFolded = false, isBroken = false) {
  let label = '';
  /** @type {Blockly.Field[]} */
  let fields = [];
  const flushLabel = () => {
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
      flushLabel();
      const fieldOrName = makePart(Number(part[1]));
      if (typeof fieldOrName !== 'string') {
        fields.push(fieldOrName);
        continue;
      }
      if (isFolded && kindOf(fieldOrName) === 'truth') {
        endRow();
        block.appendEndRowInput();
      }
      if (isBroken && fieldOrName === 'V1') block.appendEndRowInput();
      const input = block.appendValueInput(fieldOrName).setCheck(CHECKS[kindOf(fieldOrName)]);
      for (const field of fields) input.appendField(field, field.name);
      fields = [];
    }
  }
  flushLabel();
  endRow();
}

/** @param {Blockly.Field} field @param {string} name */
function setFieldName(field, name) {
  field.name = name;
  return field;
}

/** @param {Blockly.Block} block @param {boolean} isFolded its second value stands below the first */
function setFolded(block, isFolded) {
  if (isFolded === Boolean(block.getInput('FOLD'))) return;
  if (!isFolded) block.removeInput('FOLD');
  else {
    block.appendEndRowInput('FOLD');
    block.moveInputBefore('FOLD', 'V1');
  }
}

/** @param {any} block @param {string} kind */
function markNew(block, kind) {
  if (!block.isInFlyout) return;
  queueMicrotask(() => { // once it has its word
    if (!block.isDisposed() && newPieces.includes(pieceOf(kind, String(block.getFieldValue('WORD') ?? '')))) block.addClass('fresh');
  });
}

/** @param {Blockly.Block} block @param {string} kind @param {BlockKind} blockKind */
function buildBlock(block, kind, blockKind) {
  const firstWordField = makeFirstField(block, blockKind);
  const unit = Object.keys(blockKind.units).length ? new UnitField(blockKind.units) : null;
  const arrow = unit ? new ArrowField() : null; // of a move
  if (unit) {
    firstWordField?.setValidator((word) => {
      unit.forceRerender();
      arrow?.forceRerender();
      if (kind === 'move') setFolded(block, isNarrow && innerWidth < MOVE_PX + LETTER_PX * blockLabel(word).length);
    });
  }
  if (kind === 'set') firstWordField?.setValidator((word) => fillPlaces(block, kind, blockKind.values, word));
  let valueIndex = 0;
  appendMessage(block, blockLabel(kind), (number) => {
    if (firstWordField && number === 1) return setFieldName(firstWordField, 'WORD');
    if (unit && number === 3) return setFieldName(unit, 'UNIT');
    return `V${valueIndex++}`;
  }, (name) => blockKind.values[Number(name.slice(1))] ?? 'any', !blockKind.gives, isNarrow && FOLDED_KINDS.includes(kind));
  if (arrow) block.inputList.find(({ fieldRow }) => fieldRow.includes(/** @type {Blockly.Field} */ (firstWordField)))?.insertFieldAt(0, arrow);
  for (let k = 0; k < blockKind.bodies && !blockKind.is_hat; k += 1) block.appendStatementInput(`B${k}`);
  block.setInputsInline(true);
  if (blockKind.gives) block.setOutput(true, CHECKS[blockKind.gives]);
  else {
    block.setPreviousStatement(!blockKind.is_hat);
    block.setNextStatement(true);
  }
  block.setStyle(blockKind.colour);
  if (blockKind.is_hat) block.hat = 'cap';
  fillPlaces(block, kind, blockKind.values);
}

/**
 * Gives every place a value of its kind that is there while nothing else is.
 * @param {Blockly.Block} block
 * @param {string} kind
 * @param {ValueKind[]} values
 * @param {string} [word] that is on it from now on
 */
function fillPlaces(block, kind, values, word = String(block.getFieldValue('WORD') ?? '')) {
  values.forEach((valueKind, index) => {
    const { sample } = rangeOf(kind, word, index);
    const device = kind === 'set' ? devicesOfRole('actuator').find((candidate) => candidate.text === word) : undefined;
    const value = valueKind === 'truth' || device?.is_yes_no ? makeTruthShadow() : { type: 'number', fields: { WORD: Number(sample) } };
    const connection = block.getInput(`V${index}`)?.connection;
    if (connection?.getShadowState()?.type !== value.type) connection?.setShadowState(value);
  });
}

function makeTruthShadow() {
  return { type: 'truth', fields: { WORD: 'TRUE' } };
}

const MAX_ARMS = 20;
const BUTTON_UNITS = 32; // units of a button on a block: 24 pixels at the least scale

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
      appendMessage(this, blockLabel(k ? 'elseif' : 'if'), () => `V${k}`, () => 'truth');
      this.getInput(`V${k}`).connection.setShadowState(makeTruthShadow());
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
  addArm() {
    this.changeArms(this.hasElse ? Math.min(this.arms + 1, MAX_ARMS) : this.arms, true);
  },

  /** @this {any} */
  removeArm() {
    if (this.arms > 1) this.changeArms(this.arms - 1, this.hasElse);
    else this.changeArms(1, false);
  },

  /** @this {any} @param {number} arms @param {boolean} hasElse */
  changeArms(arms, hasElse) {
    const stateBefore = JSON.stringify(this.saveExtraState());
    this.setArms(arms, hasElse);
    const stateAfter = JSON.stringify(this.saveExtraState());
    if (stateBefore !== stateAfter) {
      Blockly.Events.fire(new (Blockly.Events.get(Blockly.Events.BLOCK_CHANGE))(this, 'mutation', null, stateBefore, stateAfter));
    }
  },

  /** @this {any} */
  init() {
    this.setArms(1, false);
    const buttonInput = this.appendDummyInput('MORE');
    for (const [name, onClick] of [['more', () => this.addArm()], ['less', () => this.removeArm()]]) {
      const picture = new Blockly.FieldImage(`./${name}.svg`, BUTTON_UNITS, BUTTON_UNITS, tipOf(String(name)), /** @type {any} */ (onClick));
      picture.setTooltip(tipOf(String(name)));
      buttonInput.appendField(picture);
    }
    this.setInputsInline(true);
    this.setPreviousStatement(true);
    this.setNextStatement(true);
    this.setStyle('control');
    this.setTooltip(tipOf('if'));
    markNew(this, 'if');
  },
};

/** Makes all kinds known, in the page's language. */
export function defineBlocks() {
  Blockly.Blocks['program'] = {
    /** @this {Blockly.Block} */
    init() {
      this.appendDummyInput().appendField(makeOptionsField(['SI', 'SB', 'PING'].map((word) => [blockLabel(word), word])), 'WORD');
      this.setNextStatement(true);
      this.setDeletable(false);
      this.setMovable(false); // what is dragged is all that is seen
      this.setStyle('program');
      this.setTooltip(tipOf('program'));
    },
  };
  for (const [kind, blockKind] of Object.entries(KINDS)) {
    const extraMethods = { def: DEF_METHODS, call: CALL_METHODS }[kind] ?? {};
    Blockly.Blocks[kind] = kind === 'if' ? IF : {
      ...extraMethods,
      /** @this {Blockly.Block} */
      init() {
        buildBlock(this, kind, blockKind);
        markNew(this, kind);
        if (kind === 'def') /** @type {any} */ (this).addNames();
        this.setTooltip(tipOf(kind));
        if (blockKind.field === 'sensor' || blockKind.field === 'actuator') this.setTooltip(() => tipOfDevice(this));
      },
    };
  }
}

/** @param {Blockly.Block} block of a device */
function tipOfDevice(block) {
  const name = block.getFieldValue('WORD');
  const device = [...devicesOfRole('sensor'), ...REMOTE_DEVICES, ...devicesOfRole('actuator')].find((candidate) => candidate.text === name);
  const label = device && `${name}: ${labelOf(device.labels)}${device.unit ? ` (${device.unit})` : ''}.`;
  return [label, tipOf(block.type)].filter(Boolean).join(' ');
}
