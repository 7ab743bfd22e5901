// node draw_in_node.mjs SOURCES: draws robots as the page does, on a pen that only notes what it is told.
// Reads a JSON list of {robot, state, seen}; prints, for each, what was drawn: [how, numbers, color].

import { text } from 'node:stream/consumers';
import { pathToFileURL } from 'node:url';

const { drawRobot } = await import(pathToFileURL(`${process.argv[2]}/virtual/robot_drawing.js`).href);

class Pen {
  drawn = [];
  #numbers = [];
  fillStyle = '';
  strokeStyle = '';

  save() {}
  restore() {}
  scale() {}
  beginPath() { this.#numbers = []; }
  closePath() {}
  moveTo(...place) { this.#numbers.push(...place); }
  lineTo(...place) { this.#numbers.push(...place); }
  arc(...numbers) { this.#numbers.push(...numbers); }
  roundRect(...numbers) { this.#numbers.push(...numbers); }
  fill() { this.drawn.push(['fill', this.#numbers, this.fillStyle]); }
  stroke() { this.drawn.push(['stroke', this.#numbers, this.strokeStyle]); }
}

const pictures = JSON.parse(await text(process.stdin)).map(({ robot, state, seen }) => {
  const pen = new Pen();
  drawRobot(pen, robot, state, seen);
  return pen.drawn;
});
console.log(JSON.stringify(pictures));
