// Icons of a class: drawn with lines, in the color of what is around them.

import { makeSvg } from '../page/made.js';

/** What is drawn in 24 by 24. @type {Record<string, string>} */
const ICON_PATHS = {
  hand: 'M7 12V6.5a1.5 1.5 0 0 1 3 0V11m0-5.500V4a1.500 1.500 0 0 1 3 0v7m0-5.500a1.500 1.500 0 0 1 3 0V12m0-3.500a1.500 1.500 0 0 1 3 0V15a7 7 0 0 1-7 7c-3 0-4.500-1.200-6-3.500L3.600 14a1.600 1.600 0 0 1 2.600-1.800L7 13.500',
  robot: 'M5 9h14v8H5zM12 9V5m0 0a1 1 0 1 0 0-.01M9 13h.01M15 13h.01M7 17v2.500m10-2.500v2.500',
  queue: 'M12 7v5l3 2M12 3a9 9 0 1 0 .01 0',
  out: 'M6 6l12 12M18 6 6 18',
  left: 'm15 5-7 7 7 7',
  right: 'm9 5 7 7-7 7',
  run: 'M8 5.5v9l7-4.500zM4 20h16m-12-2v4',
  join: 'M4 20l1-4.500L16 4.500l3.500 3.500L8.500 19zM14 6.500l3.500 3.500',
  gear: 'M4 7h9m4 0h3M4 17h3m4 0h9M15 4.500v5M9 14.500v5',
};

/** @param {string} name @param {number} [size] */
export function makeIcon(name, size = 24) {
  return makeSvg('svg', { viewBox: '0 0 24 24', width: size, height: size, 'aria-hidden': 'true' },
    makeSvg('path', { d: ICON_PATHS[name] ?? '', fill: 'none', stroke: 'currentColor', 'stroke-width': 2.2, 'stroke-linecap': 'round', 'stroke-linejoin': 'round' }));
}
