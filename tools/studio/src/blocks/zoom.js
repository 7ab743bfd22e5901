// The buttons that make blocks larger and smaller. They stand beside the blocks, over none of them.

import * as Blockly from 'blockly/core';
import { makeButton, makeSvg, makeElement } from '../page/made.js';

const LARGER_PATH = 'M5 12h14M12 5v14', SMALLER_PATH = 'M5 12h14', RESET_PATH = 'M12 3v4M12 17v4M3 12h4M17 12h4M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8z';

/** @param {Blockly.WorkspaceSvg} workspace @param {number} startScale at which it begins @returns {HTMLElement} */
export function makeZoomButtons(workspace, startScale) {
  const makeZoomButton = (/** @type {string} */ name, /** @type {string} */ path, /** @type {() => void} */ onClick) => {
    const zoomButton = makeButton('', onClick, makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' },
      makeSvg('path', { d: path, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.4, 'stroke-linecap': 'round' })));
    zoomButton.ariaLabel = zoomButton.title = String(Blockly.Msg[name]);
    return zoomButton;
  };
  const container = makeElement('div', '',
    makeZoomButton('RESET_ZOOM', RESET_PATH, () => {
      workspace.setScale(startScale);
      workspace.scrollCenter();
    }),
    makeZoomButton('ZOOM_IN', LARGER_PATH, () => workspace.zoomCenter(1)),
    makeZoomButton('ZOOM_OUT', SMALLER_PATH, () => workspace.zoomCenter(-1)));
  container.className = 'zoom';
  return container;
}
