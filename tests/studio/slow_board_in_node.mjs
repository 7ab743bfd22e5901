// node slow_board_in_node.mjs SOURCES SEEDS: the page writes firmware onto boards that a seed plays, on a
// clock of this script. Prints a JSON row for each: what the board did, how it ended, and when.

import { pathToFileURL } from 'node:url';

const [sources, seeds] = process.argv.slice(2);
let now_ms = 0;
let timers = [];
Date.now = () => now_ms;
globalThis.setTimeout = (callback, ms = 0) => {
  const timer = { at_ms: now_ms + ms, callback };
  timers.push(timer);
  return timer;
};
globalThis.clearTimeout = (timer) => {
  timers = timers.filter((item) => item !== timer);
};
const { BOARDS, flash } = await import(pathToFileURL(`${sources}/robot/stk500.js`).href);

function randomFrom(seed) {
  let state = seed * 2654435761 + 1;
  return () => {
    state = (Math.imul(state ^ (state >>> 15), 0x2c1b3c6d) + 0x9e3779b9) | 0;
    return ((state ^ (state >>> 13)) >>> 0) / 2 ** 32;
  };
}

const PAGE = 128;
const LENGTHS = { 0x55: 4, 0x64: 5 + PAGE, 0x74: 5 };

// `losses`: of the first answers, which do not come; `slow_ms`: each of the others comes so much later;
// `silent`: after so many pages nothing comes any more.
class Board {
  constructor(random, plan) {
    Object.assign(this, plan);
    this.random = random;
    this.memory = new Uint8Array(0x8000).fill(0xff);
    this.at = 0;
    this.asked = 0;
    this.written = 0;
  }

  answer(command) {
    this.asked += 1;
    let rest = [];
    if (command[0] === 0x75) rest = [0x1e, 0x95, 0x0f];
    if (command[0] === 0x55) this.at = 2 * (command[1] | (command[2] << 8));
    if (command[0] === 0x64) {
      this.memory.set(command.slice(4, 4 + PAGE), this.at);
      this.written += 1;
    }
    if (command[0] === 0x74) rest = [...this.memory.slice(this.at, this.at + PAGE)];
    if (this.asked <= this.losses || this.written > this.silent) return [];
    return [0x14, ...rest, 0x10];
  }
}

class Cable {
  constructor(board) {
    this.board = board;
  }

  async open(onData) {
    this.heard = onData;
  }

  async reset() {}

  async close() {
    this.heard = () => {};
  }

  async write(data) {
    const answer = this.board.answer([...data]);
    const late_ms = 1 + Math.floor(this.board.random() * this.board.slow_ms);
    // an answer comes in two parts
    const cut = Math.floor(this.board.random() * answer.length);
    for (const part of [answer.slice(0, cut), answer.slice(cut)]) {
      if (part.length) setTimeout(() => this.heard(Uint8Array.from(part)), late_ms);
    }
  }
}

async function settle() {
  for (let k = 0; k < 20; k += 1) await Promise.resolve();
}

for (let seed = 0; seed < seeds; seed += 1) {
  const random = randomFrom(seed);
  now_ms = 0;
  timers = [];
  const plan = {
    losses: Math.floor(random() * 10),
    slow_ms: [1, 100, 200, 900][Math.floor(random() * 4)],
    silent: random() < 0.7 ? Infinity : Math.floor(random() * 200),
  };
  const firmware = Uint8Array.from({ length: 1 + Math.floor(random() * 30_000) }, () => random() * 256);
  const board = new Board(random, plan);
  let ended = '';
  let last = 0;
  flash(() => new Cable(board), BOARDS.uno, firmware, (part) => {
    if (part < last) ended = 'it goes back';
    last = part;
  }).then(
    () => (ended ||= 'done'),
    (error) => (ended ||= error.reason ?? String(error)),
  );
  await settle();
  while (!ended && timers.length) {
    timers.sort((a, b) => a.at_ms - b.at_ms);
    const next = timers.shift();
    now_ms = next.at_ms;
    next.callback();
    await settle();
  }
  const isSame = firmware.every((byte, k) => board.memory[k] === byte);
  console.log(JSON.stringify({ ...plan, silent: plan.silent < Infinity, pages: Math.ceil(firmware.length / PAGE), ended, took_ms: now_ms, isSame, last }));
}
process.exit(0);
