// A picture of blocks as a file. Each of their shapes is painted as the page shows it, one after the
// other: as one drawing, a browser would work on all of it at once.

import { slowly } from './slices.js';

const MARGIN = 16;
const SHARP = 2; // pixels of the picture for one of the screen at its usual size
const MOST_SIDE = 8000; // pixels
const MOST_PIXELS = 24_000_000;
const LEFT_OUT = '.blocklyIconGroup, .blocklyPathSelected, .blocklyInsertionMarker';
const ARROW = 'M1 4 6 9 11 4z'; // of a field that offers a list; its own is a file, in white
const PLAIN = { fill: 'none', fillOpacity: '1', stroke: 'none', strokeOpacity: '1', strokeWidth: '0' };
/** @type {Record<string, CanvasTextBaseline>} */
const BASELINES = { central: 'middle', middle: 'middle', hanging: 'hanging' };
/** @type {Record<string, CanvasTextAlign>} */
const ALIGNED = { start: 'left', middle: 'center', end: 'right' };

/**
 * Returns a picture as a PNG file, or null where there are no blocks. The page goes on meanwhile: the
 * blocks must stay as they are.
 * @param {SVGElement} canvas what holds the blocks
 * @param {{left: number, right: number, top: number, bottom: number}} box where they are in it
 * @param {number} [most] pixels
 * @returns {Promise<Blob | null>}
 */
export async function pictureOf(canvas, { left, right, top, bottom }, most = MOST_PIXELS) {
  const width = right - left + 2 * MARGIN, height = bottom - top + 2 * MARGIN;
  if (!(right > left && bottom > top)) return null;
  const scale = Math.min(SHARP, MOST_SIDE / width, MOST_SIDE / height, Math.sqrt(most / (width * height)));
  const sheet = document.createElement('canvas');
  Object.assign(sheet, { width: Math.ceil(width * scale), height: Math.ceil(height * scale) });
  const pen = sheet.getContext('2d');
  if (!pen) return null;
  pen.fillStyle = '#fff';
  pen.fillRect(0, 0, sheet.width, sheet.height);
  pen.setTransform(scale, 0, 0, scale, (MARGIN - left) * scale, (MARGIN - top) * scale);
  await slowly(painting(canvas, pen));
  return new Promise((resolve) => sheet.toBlob(resolve, 'image/png'));
}

/**
 * Paints what is in an element that is seen. Blocks hang in each other, so this goes along them with a list.
 * @param {Element} whole @param {CanvasRenderingContext2D} pen @returns {Generator<void, void>}
 */
function* painting(whole, pen) {
  const begin = { place: pen.getTransform(), opacity: 1 };
  const waiting = [...whole.children].reverse().map((element) => ({ element, ...begin }));
  for (let next = waiting.pop(); next; next = waiting.pop()) {
    const { element } = next;
    const look = getComputedStyle(element);
    if (!(element instanceof SVGGraphicsElement) || look.display === 'none' || look.visibility === 'hidden' || element.matches(LEFT_OUT)) continue;
    const place = placeOf(element, next.place);
    const opacity = next.opacity * Number(look.opacity);
    pen.setTransform(place);
    if (element instanceof SVGTextElement) write(element, look, opacity, pen);
    else if (element instanceof SVGGElement) for (const inner of [...element.children].reverse()) waiting.push({ element: inner, place, opacity });
    else paint(pathOf(element), element instanceof SVGImageElement ? { ...PLAIN, fill: '#fff' } : look, opacity, pen);
    yield;
  }
}

/** @param {SVGGraphicsElement} element @param {DOMMatrix} around @returns {DOMMatrix} */
function placeOf(element, around) {
  const moves = element.transform.baseVal;
  return Array.from({ length: moves.numberOfItems }, (_, k) => moves.getItem(k).matrix)
    .reduce((place, { a, b, c, d, e, f }) => place.multiply(new DOMMatrix([a, b, c, d, e, f])), around);
}

/** @param {SVGGraphicsElement} element @returns {Path2D | null} */
function pathOf(element) {
  const number = (/** @type {string} */ name) => Number(element.getAttribute(name) ?? 0);
  if (element instanceof SVGPathElement) return new Path2D(element.getAttribute('d') ?? '');
  const path = new Path2D();
  if (element instanceof SVGRectElement) path.roundRect(number('x'), number('y'), number('width'), number('height'), number('rx'));
  else if (element instanceof SVGCircleElement) path.arc(number('cx'), number('cy'), number('r'), 0, 2 * Math.PI);
  else return element instanceof SVGImageElement && hrefOf(element).endsWith('dropdown-arrow.svg') ? new Path2D(ARROW) : null;
  return path;
}

/** @param {Path2D | null} path @param {typeof PLAIN} look @param {number} opacity @param {CanvasRenderingContext2D} pen */
function paint(path, look, opacity, pen) {
  if (!path) return;
  pen.globalAlpha = opacity * Number(look.fillOpacity);
  pen.fillStyle = look.fill;
  if (look.fill !== 'none') pen.fill(path);
  pen.globalAlpha = opacity * Number(look.strokeOpacity);
  pen.strokeStyle = look.stroke;
  pen.lineWidth = parseFloat(look.strokeWidth);
  if (look.stroke !== 'none' && pen.lineWidth) pen.stroke(path);
}

/** @param {SVGTextElement} element @param {CSSStyleDeclaration} look @param {number} opacity @param {CanvasRenderingContext2D} pen */
function write(element, look, opacity, pen) {
  pen.globalAlpha = opacity * Number(look.fillOpacity);
  pen.fillStyle = look.fill;
  pen.font = `${look.fontStyle} ${look.fontWeight} ${look.fontSize} ${look.fontFamily}`;
  pen.textAlign = ALIGNED[look.textAnchor] ?? 'left';
  pen.textBaseline = BASELINES[look.dominantBaseline] ?? 'alphabetic';
  pen.fillText(element.textContent ?? '', Number(element.getAttribute('x') ?? 0), Number(element.getAttribute('y') ?? 0));
}

/** @param {Element} image */
function hrefOf(image) {
  return image.getAttribute('href') ?? image.getAttributeNS('http://www.w3.org/1999/xlink', 'href') ?? '';
}
