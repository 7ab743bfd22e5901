// Fields of blocks: numbers that fit their place, and names as the language has them.

import * as Blockly from 'blockly/core';
import { rangeAt } from './places.js';
import { onBlock } from '../page/words.js';

export const WAY = 'way'; // not for so long, but so far

/** A number with at most three decimals; what a person types is made to fit, what a text says stays. */
export class NumberField extends Blockly.FieldNumber {
  /** @param {string | number} value */
  constructor(value) {
    super(value);
    this.setPrecision(0.001);
  }

  /** @param {any} value */
  doClassValidation_(value) {
    const found = super.doClassValidation_(value);
    if (found === null || !this.isBeingEdited_) return found;
    const { low, high } = rangeAt(this.getSourceBlock());
    return Math.min(high, Math.max(low, found));
  }

  /** Without an exponent, which the language does not know. @returns {string} */
  written() {
    return Number(this.getValue()).toFixed(3).replace(/\.?0+$/, '');
  }
}

/** A name: capitals, digits and `_`, without accents. */
export class NameField extends Blockly.FieldTextInput {
  /** @param {any} value */
  doClassValidation_(value) {
    const text = String(value ?? '').normalize('NFC').replace(/ñ/gi, 'NI').normalize('NFD').replace(/[\u0300-\u036f]/g, '');
    const plain = text.toUpperCase().trim().replace(/\W+/g, '_').replace(/^[^A-Z]+/, '');
    return plain || null;
  }
}

/** Seconds, or the unit of the word that is chosen. */
export class UnitField extends Blockly.FieldDropdown {
  /** @param {Record<string, string>} units of each word */
  constructor(units) {
    /** @this {any} */
    super(function () {
      return [[onBlock('seconds'), 'seconds'], [onBlock(/** @type {any} */ (this).unit?.() ?? ''), WAY]];
    });
    this.units = units;
  }

  unit() {
    return this.units?.[String(this.getSourceBlock()?.getFieldValue('WORD'))] ?? '';
  }

  /** @returns {string} the unit as the text has it: none for seconds */
  written() {
    return this.getValue() === WAY ? this.unit() : '';
  }

  getText_() {
    return onBlock(this.written() || 'seconds');
  }
}

/** A line of text: a comment, or what the compiler does not understand. */
export class LineField extends Blockly.FieldTextInput {
  /** @param {any} value */
  doClassValidation_(value) {
    return String(value ?? '').replace(/[\r\n\0]+/g, ' ');
  }
}
