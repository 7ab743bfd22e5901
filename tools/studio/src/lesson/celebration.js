// What is seen when somebody has solved a task: confetti over the page, for a moment. Nothing moves for whoever wants that.

import { makeElement } from '../page/made.js';

const DURATION_MS = 1600;
const PIECE_COUNT = 90;
const COLOURS = ['#ffd84d', '#2a9d6f', '#2f74c0', '#d0468f', '#d8741a', '#8a4fc4'];
const FALL_ACCELERATION = 1.1; // heights of the page in a second, squared

/** Lets confetti fall, in front of everything and under no finger. */
export function celebrate() {
  if (matchMedia('(prefers-reduced-motion: reduce)').matches) return;
  document.querySelector('.confetti')?.remove();
  const canvas = makeElement('canvas'), pen = canvas.getContext('2d');
  if (!pen) return;
  canvas.className = 'confetti';
  canvas.setAttribute('aria-hidden', 'true');
  Object.assign(canvas, { width: innerWidth, height: innerHeight });
  document.body.append(canvas);
  const pieces = Array.from({ length: PIECE_COUNT }, (_, index) => ({
    x: Math.random(), up: 0.5 + Math.random() * 0.7, aside: (Math.random() - 0.5) * 0.5, spin: Math.random() * 9, size: 5 + Math.random() * 7, colour: COLOURS[index % COLOURS.length] ?? '',
  }));
  const began_ms = performance.now();
  const drawFrame = () => {
    const elapsed_s = (performance.now() - began_ms) / 1000;
    if (elapsed_s * 1000 > DURATION_MS || !canvas.isConnected) {
      canvas.remove();
      return;
    }
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    for (const { x, up, aside, spin, size, colour } of pieces) {
      pen.setTransform(1, 0, 0, 1, (x + aside * elapsed_s) * canvas.width, (0.9 - up * elapsed_s + FALL_ACCELERATION * elapsed_s ** 2 / 2) * canvas.height);
      pen.rotate(spin * elapsed_s);
      pen.scale(1, Math.cos(2 * spin * elapsed_s)); // it turns in the air
      pen.fillStyle = colour;
      pen.fillRect(-size / 2, -size / 3, size, size / 1.5);
    }
    requestAnimationFrame(drawFrame);
  };
  drawFrame();
}
