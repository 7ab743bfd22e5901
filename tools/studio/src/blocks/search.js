// A field above the groups of blocks: what is typed there is looked for in all of them.

import * as Blockly from 'blockly/core';
import { makeSvg, makeElement } from '../page/made.js';
import { text } from '../page/texts.js';

const GLASS_PATH = 'M10.500 4a6.500 6.500 0 1 0 0 13 6.500 6.500 0 0 0 0-13zM15.500 15.500 21 21';

export class Search {
  element = makeElement('label');
  #input = makeElement('input');
  #workspace;
  #findBlocks;

  /**
   * @param {Blockly.WorkspaceSvg} workspace
   * @param {(query: string) => object[]} findBlocks what a list of blocks shows
   */
  constructor(workspace, findBlocks) {
    this.#workspace = workspace;
    this.#findBlocks = findBlocks;
    this.element.className = 'search';
    Object.assign(this.#input, { type: 'search', maxLength: 40, autocomplete: 'off', spellcheck: false, placeholder: text('search') });
    this.#input.ariaLabel = text('search_blocks');
    this.element.append(makeSvg('svg', { viewBox: '0 0 24 24', width: 20, height: 20, 'aria-hidden': 'true' },
      makeSvg('path', { d: GLASS_PATH, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.4, 'stroke-linecap': 'round' })), this.#input);
    this.#input.addEventListener('input', () => this.#showResults());
    this.#input.addEventListener('focus', () => {
      if (this.#input.value) this.#showResults();
    });
    this.#input.addEventListener('keydown', (event) => this.#onKeyDown(event));
    workspace.getInjectionDiv().addEventListener('focusin', ({ target }) => this.#onFocusElsewhere(/** @type {Element} */ (target)));
  }

  /** It is as wide as the groups below it. */
  fitWidth() {
    const width = this.#workspace.getToolbox()?.getWidth() ?? 0;
    if (width) this.element.style.setProperty('--groups', `${width}px`);
  }

  /** Nothing is looked for any more. */
  clearSearch() {
    this.#input.value = '';
  }

  /** What was found goes once somebody is at the blocks of the program, or at a group. @param {Element} target */
  #onFocusElsewhere(target) {
    if (!this.#input.value || target.closest('.blocklyFlyout')) return;
    this.clearSearch();
    if (!target.closest('.blocklyToolbox')) this.#flyout?.hide();
  }

  get #flyout() {
    return this.#workspace.getFlyout();
  }

  #showResults() {
    const query = this.#input.value.trim();
    /** @type {any} */ (this.#workspace.getToolbox())?.clearSelection();
    if (!query) {
      this.#flyout?.hide();
      return;
    }
    const matches = this.#findBlocks(query);
    this.#flyout?.show(/** @type {any} */ (matches.length ? matches : [{ kind: 'label', text: text('search_none') }]));
  }

  /** @param {KeyboardEvent} event */
  #onKeyDown(event) {
    event.stopPropagation(); // what is typed is no shortcut
    const { key } = event, flyout = this.#flyout;
    if (key === 'Escape') {
      this.clearSearch();
      flyout?.hide();
      Blockly.getFocusManager().focusTree(this.#workspace);
    } else if ((key === 'Enter' || key === 'ArrowDown') && flyout?.isVisible()) {
      event.preventDefault();
      Blockly.getFocusManager().focusTree(flyout.getWorkspace());
    }
  }
}
