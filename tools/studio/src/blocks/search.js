// A field above the groups of blocks: what is typed there is looked for in all of them.

import * as Blockly from 'blockly/core';
import { makeSvg, makeElement } from '../page/made.js';
import { text } from '../page/texts.js';

const GLASS = 'M10.500 4a6.500 6.500 0 1 0 0 13 6.500 6.500 0 0 0 0-13zM15.500 15.500 21 21';

export class Search {
  place = makeElement('label');
  #field = makeElement('input');
  #workspace;
  #find;

  /**
   * @param {Blockly.WorkspaceSvg} workspace
   * @param {(words: string) => object[]} find what a list of blocks shows
   */
  constructor(workspace, find) {
    this.#workspace = workspace;
    this.#find = find;
    this.place.className = 'search';
    Object.assign(this.#field, { type: 'search', maxLength: 40, autocomplete: 'off', spellcheck: false, placeholder: text('search') });
    this.#field.ariaLabel = text('search_blocks');
    this.place.append(makeSvg('svg', { viewBox: '0 0 24 24', width: 20, height: 20, 'aria-hidden': 'true' },
      makeSvg('path', { d: GLASS, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.4, 'stroke-linecap': 'round' })), this.#field);
    this.#field.addEventListener('input', () => this.#show());
    this.#field.addEventListener('focus', () => {
      if (this.#field.value) this.#show();
    });
    this.#field.addEventListener('keydown', (event) => this.#press(event));
    workspace.getInjectionDiv().addEventListener('focusin', ({ target }) => this.#leave(/** @type {Element} */ (target)));
  }

  /** It is as wide as the groups below it. */
  fit() {
    const width = this.#workspace.getToolbox()?.getWidth() ?? 0;
    if (width) this.place.style.setProperty('--groups', `${width}px`);
  }

  /** Nothing is looked for any more. */
  clear() {
    this.#field.value = '';
  }

  /** What was found goes once somebody is at the blocks of the program, or at a group. @param {Element} target */
  #leave(target) {
    if (!this.#field.value || target.closest('.blocklyFlyout')) return;
    this.clear();
    if (!target.closest('.blocklyToolbox')) this.#flyout?.hide();
  }

  get #flyout() {
    return this.#workspace.getFlyout();
  }

  #show() {
    const words = this.#field.value.trim();
    /** @type {any} */ (this.#workspace.getToolbox())?.clearSelection();
    if (!words) {
      this.#flyout?.hide();
      return;
    }
    const found = this.#find(words);
    this.#flyout?.show(/** @type {any} */ (found.length ? found : [{ kind: 'label', text: text('search_none') }]));
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    event.stopPropagation(); // what is typed is no shortcut
    const { key } = event, flyout = this.#flyout;
    if (key === 'Escape') {
      this.clear();
      flyout?.hide();
      Blockly.getFocusManager().focusTree(this.#workspace);
    } else if ((key === 'Enter' || key === 'ArrowDown') && flyout?.isVisible()) {
      event.preventDefault();
      Blockly.getFocusManager().focusTree(flyout.getWorkspace());
    }
  }
}
