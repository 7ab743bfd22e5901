// Lines and dots on a canvas whose unit is a centimetre.

/** @typedef {CanvasRenderingContext2D} Pen */

/**
 * @param {Pen} pen
 * @param {number[][]} points
 * @param {string} color
 * @param {number} width
 * @param {string} [fill] the colour inside of a closed one
 */
export function drawPath(pen, points, color, width, fill = '') {
  pen.beginPath();
  points.forEach(([x = 0, y = 0], index) => (index ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  if (fill) pen.closePath();
  pen.strokeStyle = color;
  pen.lineWidth = width;
  pen.stroke();
  if (!fill) return;
  pen.fillStyle = fill;
  pen.fill();
}

/**
 * @param {Pen} pen
 * @param {number} x
 * @param {number} y
 * @param {number} radius
 * @param {string} color
 */
export function drawDot(pen, x, y, radius, color) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = color;
  pen.fill();
}
