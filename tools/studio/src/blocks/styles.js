// How blocks look, and how Blockly's style sheets get into a page whose policy forbids styles in
// elements: they are adopted.

import * as Blockly from 'blockly/core';
import { COLOURS } from './colours.js';

const MEDIA_URL = './';
const RENDERER = 'tiniscript';

/** @param {string} css */
function adoptCss(css) {
  const sheet = new CSSStyleSheet();
  sheet.replaceSync(css);
  document.adoptedStyleSheets = [...document.adoptedStyleSheets, sheet];
}

class Constants extends Blockly.zelos.ConstantProvider {
  /** @param {Document | ShadowRoot} _ @param {string} selector */
  injectCSS_(_, selector) {
    adoptCss(this.getCSS_(selector).join('\n'));
  }

  init() {
    super.init();
    this.FIELD_DROPDOWN_SVG_ARROW_DATAURI = `${MEDIA_URL}dropdown-arrow.svg`;
  }
}

class Renderer extends Blockly.zelos.Renderer {
  makeConstants_() {
    return new Constants();
  }
}

/** Puts Blockly's style sheet into the page. A detached tree may hold a style element. */
function adoptCommonCss() {
  const host = document.createElement('div');
  const root = host.attachShadow({ mode: 'open' });
  const container = document.createElement('div');
  root.append(container);
  Blockly.Css.inject(container, true, MEDIA_URL);
  adoptCss(root.querySelector('style')?.textContent ?? '');
}

/** @type {Blockly.BlocklyOptions | null} */
let cachedOptions = null;

/** @returns {Blockly.BlocklyOptions} */
export function getOptions() {
  cachedOptions ??= makeOptions();
  return cachedOptions;
}

/** @returns {Blockly.BlocklyOptions} */
function makeOptions() {
  Blockly.blockRendering.register(RENDERER, Renderer);
  adoptCommonCss();
  adoptCss(Object.entries(COLOURS).map(([name, colour]) => `.category.${name} { --colour: ${colour}; }`).join('\n'));
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
  return { css: false, media: MEDIA_URL, renderer: RENDERER, theme, sounds: false };
}
