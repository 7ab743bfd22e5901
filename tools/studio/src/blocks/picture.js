// A picture of blocks as a file. Each of their shapes is painted as the page shows it, one after the
// other: as one drawing, a browser would work on all of it at once.

import { runInSlices } from './slices.js';

const MARGIN = 16;
const PIXEL_RATIO = 2; // pixels of the picture for one of the screen at its usual size
const MAX_SIDE_PX = 8000; // pixels
const MAX_PIXELS = 24_000_000;
const OMITTED_SELECTOR = '.blocklyIconGroup, .blocklyPathSelected, .blocklyInsertionMarker';
const ARROW_PATH = 'M1 4 6 9 11 4z'; // of a field that offers a list; its own is a file, in white
const PLAIN_STYLE = { fill: 'none', fillOpacity: '1', stroke: 'none', strokeOpacity: '1', strokeWidth: '0' };
/** @type {Record<string, CanvasTextBaseline>} */
const BASELINES = { central: 'middle', middle: 'middle', hanging: 'hanging' };
/** @type {Record<string, CanvasTextAlign>} */
const ALIGNMENTS = { start: 'left', middle: 'center', end: 'right' };

/**
 * Returns a picture as a PNG file, or null where there are no blocks. The page goes on meanwhile: the
 * blocks must stay as they are.
 * @param {SVGElement} canvas what holds the blocks
 * @param {{left: number, right: number, top: number, bottom: number}} box where they are in it
 * @param {number} [mostPixels] pixels
 * @returns {Promise<Blob | null>}
 */
export async function renderPicture(canvas, { left, right, top, bottom }, mostPixels = MAX_PIXELS) {
  const width = right - left + 2 * MARGIN, height = bottom - top + 2 * MARGIN;
  if (!(right > left && bottom > top)) return null;
  const scale = Math.min(PIXEL_RATIO, MAX_SIDE_PX / width, MAX_SIDE_PX / height, Math.sqrt(mostPixels / (width * height)));
  const outputCanvas = document.createElement('canvas');
  Object.assign(outputCanvas, { width: Math.ceil(width * scale), height: Math.ceil(height * scale) });
  const pen = outputCanvas.getContext('2d');
  if (!pen) return null;
  pen.fillStyle = '#fff';
  pen.fillRect(0, 0, outputCanvas.width, outputCanvas.height);
  pen.setTransform(scale, 0, 0, scale, (MARGIN - left) * scale, (MARGIN - top) * scale);
  await runInSlices(paintingSteps(canvas, pen));
  return new Promise((resolve) => outputCanvas.toBlob(resolve, 'image/png'));
}

/**
 * Paints what is in an element that is seen. Blocks hang in each other, so this goes along them with a list.
 * @param {Element} root @param {CanvasRenderingContext2D} pen @returns {Generator<void, void>}
 */
function* paintingSteps(root, pen) {
  const rootState = { matrix: pen.getTransform(), opacity: 1 };
  const pendingSteps = [...root.children].reverse().map((element) => ({ element, ...rootState }));
  for (let step = pendingSteps.pop(); step; step = pendingSteps.pop()) {
    const { element } = step;
    const style = getComputedStyle(element);
    if (!(element instanceof SVGGraphicsElement) || style.display === 'none' || style.visibility === 'hidden' || element.matches(OMITTED_SELECTOR)) continue;
    const matrix = matrixOf(element, step.matrix);
    const opacity = step.opacity * Number(style.opacity);
    pen.setTransform(matrix);
    if (element instanceof SVGTextElement) paintText(element, style, opacity, pen);
    else if (element instanceof SVGGElement) for (const child of [...element.children].reverse()) pendingSteps.push({ element: child, matrix, opacity });
    else paintPath(pathOf(element), element instanceof SVGImageElement ? { ...PLAIN_STYLE, fill: '#fff' } : style, opacity, pen);
    yield;
  }
}

/** @param {SVGGraphicsElement} element @param {DOMMatrix} outerMatrix @returns {DOMMatrix} */
function matrixOf(element, outerMatrix) {
  const transforms = element.transform.baseVal;
  return Array.from({ length: transforms.numberOfItems }, (_, k) => transforms.getItem(k).matrix)
    .reduce((matrix, { a, b, c, d, e, f }) => matrix.multiply(new DOMMatrix([a, b, c, d, e, f])), outerMatrix);
}

/** @param {SVGGraphicsElement} element @returns {Path2D | null} */
function pathOf(element) {
  const attributeNumber = (/** @type {string} */ name) => Number(element.getAttribute(name) ?? 0);
  if (element instanceof SVGPathElement) return new Path2D(element.getAttribute('d') ?? '');
  const path = new Path2D();
  if (element instanceof SVGRectElement) path.roundRect(attributeNumber('x'), attributeNumber('y'), attributeNumber('width'), attributeNumber('height'), attributeNumber('rx'));
  else if (element instanceof SVGCircleElement) path.arc(attributeNumber('cx'), attributeNumber('cy'), attributeNumber('r'), 0, 2 * Math.PI);
  else return element instanceof SVGImageElement && hrefOf(element).endsWith('dropdown-arrow.svg') ? new Path2D(ARROW_PATH) : null;
  return path;
}

/** @param {Path2D | null} path @param {typeof PLAIN_STYLE} style @param {number} opacity @param {CanvasRenderingContext2D} pen */
function paintPath(path, style, opacity, pen) {
  if (!path) return;
  pen.globalAlpha = opacity * Number(style.fillOpacity);
  pen.fillStyle = style.fill;
  if (style.fill !== 'none') pen.fill(path);
  pen.globalAlpha = opacity * Number(style.strokeOpacity);
  pen.strokeStyle = style.stroke;
  pen.lineWidth = parseFloat(style.strokeWidth);
  if (style.stroke !== 'none' && pen.lineWidth) pen.stroke(path);
}

/** @param {SVGTextElement} element @param {CSSStyleDeclaration} style @param {number} opacity @param {CanvasRenderingContext2D} pen */
function paintText(element, style, opacity, pen) {
  pen.globalAlpha = opacity * Number(style.fillOpacity);
  pen.fillStyle = style.fill;
  pen.font = `${style.fontStyle} ${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
  pen.textAlign = ALIGNMENTS[style.textAnchor] ?? 'left';
  pen.textBaseline = BASELINES[style.dominantBaseline] ?? 'alphabetic';
  pen.fillText(element.textContent ?? '', Number(element.getAttribute('x') ?? 0), Number(element.getAttribute('y') ?? 0));
}

/** @param {Element} image */
function hrefOf(image) {
  return image.getAttribute('href') ?? image.getAttributeNS('http://www.w3.org/1999/xlink', 'href') ?? '';
}
