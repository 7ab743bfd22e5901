// The buttons that make blocks larger and smaller. They stand beside the blocks, over none of them.

import * as Blockly from 'blockly/core';
import { makeButton, makeSvg, makeElement } from '../page/made.js';

const LARGER = 'M5 12h14M12 5v14', SMALLER = 'M5 12h14', WHOLE = 'M12 3v4M12 17v4M3 12h4M17 12h4M12 8a4 4 0 1 0 0 8 4 4 0 0 0 0-8z';

/** @param {Blockly.WorkspaceSvg} workspace @param {number} scale at which it begins @returns {HTMLElement} */
export function zoomOf(workspace, scale) {
  const press = (/** @type {string} */ name, /** @type {string} */ path, /** @type {() => void} */ act) => {
    const found = makeButton('', act, makeSvg('svg', { viewBox: '0 0 24 24', width: 24, height: 24, 'aria-hidden': 'true' },
      makeSvg('path', { d: path, fill: 'none', stroke: 'currentColor', 'stroke-width': 2.4, 'stroke-linecap': 'round' })));
    found.ariaLabel = found.title = String(Blockly.Msg[name]);
    return found;
  };
  const place = makeElement('div', '',
    press('RESET_ZOOM', WHOLE, () => {
      workspace.setScale(scale);
      workspace.scrollCenter();
    }),
    press('ZOOM_IN', LARGER, () => workspace.zoomCenter(1)),
    press('ZOOM_OUT', SMALLER, () => workspace.zoomCenter(-1)));
  place.className = 'zoom';
  return place;
}
