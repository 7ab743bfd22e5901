// A picture of blocks as a file. What they look like is written into a copy of them, since a picture
// knows no style sheets; letters are those of this device.

import { drawn } from '../page/made.js';

const MARGIN = 16;
const SHARP = 2; // pixels of the picture for one of the screen at its usual size
const MOST_SIDE = 8000; // pixels
const MOST_PIXELS = 24_000_000;
const LOOKS = ['fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-opacity', 'opacity', 'font-family', 'font-size', 'font-weight', 'font-style', 'text-anchor', 'dominant-baseline'];
const LEFT_OUT = '.blocklyIconGroup, .blocklyPathSelected, .blocklyInsertionMarker';
const ARROW = 'M1 4 6 9 11 4z'; // of a field that offers a list; its own is a file

/**
 * Returns a picture as a PNG file, or null where there are no blocks.
 * @param {SVGElement} canvas what holds the blocks
 * @param {{left: number, right: number, top: number, bottom: number}} box where they are in it
 * @returns {Promise<Blob | null>}
 */
export async function pictureOf(canvas, { left, right, top, bottom }) {
  const width = right - left + 2 * MARGIN, height = bottom - top + 2 * MARGIN;
  if (!(right > left && bottom > top)) return null;
  const scale = Math.min(SHARP, MOST_SIDE / width, MOST_SIDE / height, Math.sqrt(MOST_PIXELS / (width * height)));
  const viewBox = [left - MARGIN, top - MARGIN, width, height].join(' ');
  const svg = drawn('svg', { viewBox, width: Math.ceil(width * scale), height: Math.ceil(height * scale) }, copyOf(canvas));
  const whole = new XMLSerializer().serializeToString(svg);
  const address = URL.createObjectURL(new Blob([whole], { type: 'image/svg+xml' }));
  try {
    const image = new Image();
    image.src = address;
    await image.decode();
    const sheet = document.createElement('canvas');
    Object.assign(sheet, { width: image.width, height: image.height });
    const pen = sheet.getContext('2d');
    if (!pen) return null;
    pen.fillStyle = '#fff';
    pen.fillRect(0, 0, sheet.width, sheet.height);
    pen.drawImage(image, 0, 0);
    return await new Promise((resolve) => sheet.toBlob(resolve, 'image/png'));
  } finally {
    URL.revokeObjectURL(address);
  }
}

/** @param {Element} image */
function hrefOf(image) {
  return image.getAttribute('href') ?? image.getAttributeNS('http://www.w3.org/1999/xlink', 'href') ?? '';
}

/** @param {SVGElement} canvas @returns {Element} a copy that looks the same anywhere */
function copyOf(canvas) {
  const copy = /** @type {Element} */ (canvas.cloneNode(true));
  copy.removeAttribute('transform');
  const originals = canvas.querySelectorAll('*');
  const gone = [];
  for (const [k, each] of [...copy.querySelectorAll('*')].entries()) {
    const original = /** @type {Element} */ (originals[k]);
    const look = getComputedStyle(original);
    if (look.display === 'none' || look.visibility === 'hidden' || each.matches(LEFT_OUT)) gone.push(each);
    for (const name of LOOKS) each.setAttribute(name, look.getPropertyValue(name));
    for (const name of ['class', 'style', 'filter', 'id']) each.removeAttribute(name);
    if (each.localName !== 'image') continue;
    gone.push(each);
    if (hrefOf(original).endsWith('dropdown-arrow.svg') && look.display !== 'none') {
      each.before(drawn('path', { d: ARROW, fill: '#fff', transform: original.getAttribute('transform') ?? '' }));
    }
  }
  for (const each of gone) each.remove();
  return copy;
}
