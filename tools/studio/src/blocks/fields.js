// Fields of blocks: numbers that fit their place, and names as the language has them.

import * as Blockly from 'blockly/core';
import { Piano } from './piano.js';
import { rangeForNumber } from './places.js';
import { hertzOfKey, keyName, keyOfHertz, nextKeyFrom } from './tones.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';
import { blockLabel } from '../page/words.js';

export const WAY_UNIT = 'way'; // not for so long, but so far

/** @type {(hertz: number) => void} */
let playTone = () => {};

/** @param {(hertz: number) => void} player sounds a tone, for who chooses one */
export function setTonePlayer(player) {
  playTone = player;
}

/**
 * Blockly does not tell that Escape has taken back what was typed.
 * @param {any} field
 * @param {() => void} onKey what a key does in it
 */
function reportRevert(field, onKey) {
  const valueBefore = field.getValue();
  onKey();
  const value = field.getValue();
  if (value !== valueBefore) Blockly.Events.fire(new Blockly.Events.BlockChange(field.getSourceBlock(), 'field', field.name ?? null, valueBefore, value));
}

const THOUSANDS = /^\s*[-+]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?\s*$/;

/** A number with at most three decimals; what a person types is made to fit, what a text says stays. */
export class NumberField extends Blockly.FieldNumber {
  /** @param {string | number} value */
  constructor(value) {
    super(value);
    this.changeNotice = '';
    this.setPrecision(0.001);
  }

  /** A comma is a decimal sign, unless it separates thousands. @param {any} value */
  doClassValidation_(value) {
    const typed = String(value ?? '');
    const validNumber = super.doClassValidation_(THOUSANDS.test(typed) ? typed : typed.replaceAll(',', '.'));
    if (validNumber === null && this.isBeingEdited_) this.changeNotice = text('no_number', { typed: typed.trim() });
    if (validNumber === null || !this.isBeingEdited_) return validNumber;
    const { low, high } = rangeForNumber(this.getSourceBlock());
    const fittingNumber = Math.min(high, Math.max(low, validNumber));
    this.changeNotice = fittingNumber === validNumber ? '' : text('number_fits', { typed: typed.trim(), low, high, fitting: fittingNumber });
    return fittingNumber;
  }

  /** Tells whoever has typed what does not fit which number took its place, or stayed. @param {any} value */
  onFinishEditing_(value) {
    super.onFinishEditing_(value);
    if (this.changeNotice) pageState.note.set(this.changeNotice);
    this.changeNotice = '';
  }

  /** A phone shows keys of digits, which lack a minus on some. */
  widgetCreate_() {
    const input = super.widgetCreate_();
    if (rangeForNumber(this.getSourceBlock()).low >= 0) input.inputMode = 'decimal';
    return input;
  }

  /** Whether it is how high a tone is. */
  get isPitch() {
    const block = this.getSourceBlock(), parent = block?.getParent();
    return parent?.type === 'beep' && parent.getInput('V1')?.connection?.targetBlock() === block;
  }

  /**
   * A tone has keys of a piano below it. A finger has no need of the keyboard that a phone would put over them.
   * @param {Event} [event]
   * @param {boolean} [isQuiet]
   */
  showEditor_(event, isQuiet = false) {
    if (!this.isPitch) {
      super.showEditor_(event, isQuiet);
      return;
    }
    super.showEditor_(event, isQuiet || matchMedia('(pointer: coarse)').matches);
    const piano = new Piano((hertz) => {
      this.choosePitch(hertz);
      /** @type {any} */ (this).htmlInput_?.setAttribute('data-untyped-default-value', String(hertz)); // Escape takes back what was typed, and no key that was pressed
    });
    piano.show(Number(this.getValue()));
    const { DropDownDiv } = Blockly;
    DropDownDiv.clearContent();
    DropDownDiv.getContentDiv().append(piano.element);
    DropDownDiv.setColour('#fff', '#c8d2dc');
    DropDownDiv.showPositionedByField(this, () => { this.piano = null; }, undefined, false);
    this.piano = piano;
  }

  /** @param {number} hertz */
  choosePitch(hertz) {
    /** @type {any} */ (this).setEditorValue_(hertz);
    this.piano?.show(hertz);
    playTone(hertz);
  }

  /** Up and down go to the next tone of a piano. @param {KeyboardEvent} event */
  onHtmlInputKeyDown_(event) {
    const direction = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (!this.isPitch || !direction) {
      reportRevert(this, () => super.onHtmlInputKeyDown_(event));
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    this.choosePitch(hertzOfKey(nextKeyFrom(Number(this.getValue()), direction)));
  }

  /** With the name of its tone, where a piano has it, unless it is typed. @returns {string | null} */
  getText_() {
    const typed = super.getText_(), value = Number(this.getValue());
    if (typed !== null || !this.isPitch || hertzOfKey(keyOfHertz(value)) !== value) return typed;
    return `${keyName(keyOfHertz(value), text('notes').split(' '))} ${this.getValue()}`;
  }

  /** What hangs in another block may be a tone, or no longer be one. */
  getSize() {
    if (!this.isBeingEdited_ && this.textContent_ && this.textContent_.nodeValue !== this.getDisplayText_()) this.isDirty_ = true;
    return super.getSize();
  }

  /** Without an exponent, which the language does not know. @returns {string} */
  textValue() {
    return Number(this.getValue()).toFixed(3).replace(/\.?0+$/, '');
  }
}

/** Where each move leads, from above. @type {Record<string, string>} */
const ARROW_PATHS = {
  F: 'M9 1 16 9H11.500V17H6.500V9H2z', B: 'M9 17 2 9H6.500V1H11.500V9H16z',
  L: 'M7 1v4h3.500a5.500 5.500 0 0 1 5.500 5.500V17h-4.500v-6.500a1 1 0 0 0-1-1H7v4L.5 7.250z',
  R: 'M11 1v4H7.500A5.500 5.500 0 0 0 2 10.500V17h4.500v-6.500a1 1 0 0 1 1-1H11v4l6.500-6.250z',
};
const ARROW_PX = 18;

/** An arrow before the words of a move. */
export class ArrowField extends Blockly.FieldLabel {
  constructor() {
    super('');
    this.size_ = new Blockly.utils.Size(ARROW_PX, ARROW_PX);
  }

  initView() {
    const { dom, Svg } = Blockly.utils;
    this.arrowPath = dom.createSvgElement(Svg.PATH, { class: 'arrow', fill: '#fff', 'aria-hidden': 'true' }, this.fieldGroup_);
  }

  render_() {
    this.arrowPath?.setAttribute('d', ARROW_PATHS[String(this.getSourceBlock()?.getFieldValue('WORD'))] ?? '');
    this.size_ = new Blockly.utils.Size(ARROW_PX, ARROW_PX);
  }
}

/** A name: capitals, digits and `_`, without accents. */
export class NameField extends Blockly.FieldTextInput {
  /** @param {any} value */
  doClassValidation_(value) {
    const text = String(value ?? '').normalize('NFC').replace(/ñ/gi, 'NI').normalize('NFD').replace(/[\u0300-\u036f]/g, '');
    const name = text.toUpperCase().trim().replace(/\W+/g, '_').replace(/^[^A-Z]+/, '');
    return name || null;
  }

  /** @param {KeyboardEvent} event */
  onHtmlInputKeyDown_(event) {
    reportRevert(this, () => super.onHtmlInputKeyDown_(event));
  }
}

/** Seconds, or the unit of the word that is chosen. */
export class UnitField extends Blockly.FieldDropdown {
  /** @param {Record<string, string>} units of each word */
  constructor(units) {
    /** @this {any} */
    super(function () {
      return [[blockLabel('seconds'), 'seconds'], [blockLabel(/** @type {any} */ (this).unit?.() ?? ''), WAY_UNIT]];
    });
    this.units = units;
  }

  unit() {
    return this.units?.[String(this.getSourceBlock()?.getFieldValue('WORD'))] ?? '';
  }

  /** @returns {string} the unit as the text has it: none for seconds */
  textValue() {
    return this.getValue() === WAY_UNIT ? this.unit() : '';
  }

  getText_() {
    return blockLabel(this.textValue() || 'seconds');
  }
}

/** A line of text: a comment, or what the compiler does not understand. */
export class LineField extends Blockly.FieldTextInput {
  /** @param {any} value */
  doClassValidation_(value) {
    return String(value ?? '').replace(/[\r\n\0]+/g, ' ');
  }

  /** @param {KeyboardEvent} event */
  onHtmlInputKeyDown_(event) {
    reportRevert(this, () => super.onHtmlInputKeyDown_(event));
  }
}
