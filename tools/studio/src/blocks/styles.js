// How blocks look, and how Blockly's style sheets get into a page whose policy forbids styles in
// elements: they are adopted.

import * as Blockly from 'blockly/core';
import { COLOURS } from './colours.js';

const MEDIA = './';
const RENDERER = 'tiniscript';

/** @param {string} css */
function adopt(css) {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(css);
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
}

class Constants extends Blockly.zelos.ConstantProvider {
  /** @param {Document | ShadowRoot} _ @param {string} selector */
  injectCSS_(_, selector) {
    adopt(this.getCSS_(selector).join('\n'));
  }

  init() {
    super.init();
    this.FIELD_DROPDOWN_SVG_ARROW_DATAURI = `${MEDIA}dropdown-arrow.svg`;
  }
}

class Renderer extends Blockly.zelos.Renderer {
  makeConstants_() {
    return new Constants();
  }
}

/** Puts Blockly's style sheet into the page. A detached tree may hold a style element. */
function adoptCommon() {
  const host = document.createElement('div');
  const root = host.attachShadow({ mode: 'open' });
  const inside = document.createElement('div');
  root.append(inside);
  Blockly.Css.inject(inside, true, MEDIA);
  adopt(root.querySelector('style')?.textContent ?? '');
}

/** @type {Blockly.BlocklyOptions | null} */
let looks = null;

/** @returns {Blockly.BlocklyOptions} */
export function look() {
  looks ??= prepared();
  return looks;
}

/** @returns {Blockly.BlocklyOptions} */
function prepared() {
  Blockly.blockRendering.register(RENDERER, Renderer);
  adoptCommon();
  adopt(Object.entries(COLOURS).map(([name, colour]) => `.category.${name} { --colour: ${colour}; }`).join('\n'));
  const styles = Object.entries(COLOURS).map(([name, colour]) => [name, { colourPrimary: colour }]);
  const theme = Blockly.Theme.defineTheme('tiniscript', {
    name: 'tiniscript',
    base: Blockly.Themes.Zelos,
    blockStyles: {
      ...Object.fromEntries(styles),
      program: { colourPrimary: '#123b63', hat: 'cap' },
    },
    categoryStyles: Object.fromEntries(Object.entries(COLOURS).map(([name, colour]) => [name, { colour }])),
    fontStyle: { family: 'system-ui, "DejaVu Sans", sans-serif', weight: '600', size: 12 },
    startHats: false,
  });
  return { css: false, media: MEDIA, renderer: RENDERER, theme, sounds: false };
}
