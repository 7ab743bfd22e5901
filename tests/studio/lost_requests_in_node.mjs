// node lost_requests_in_node.mjs SOURCES SEEDS: the page's own way through `tsc studio` asks a server that
// this script plays, on its clock. Any of its requests and answers are lost, late or come twice. Prints a
// JSON row for each seed: how many times each ask has ended, what was done, and what came after the end.

import { pathToFileURL } from 'node:url';

const [sources, seeds] = process.argv.slice(2);
let now_ms = 0;
let timers = [];
let server = null;
const setLater = (callback, ms = 0) => {
  const timer = { at_ms: now_ms + ms, callback };
  timers.push(timer);
  return timer;
};
const setGlobal = (name, value) => Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
globalThis.setTimeout = setLater;
globalThis.clearTimeout = (timer) => {
  timers = timers.filter((item) => item !== timer);
};
const store = { getItem: () => 'a token', setItem() {}, removeItem() {} };
setGlobal('window', { setTimeout: setLater, sessionStorage: store, localStorage: store });
setGlobal('document', { documentElement: { dataset: {} } });
setGlobal('location', { hash: '', pathname: '/', search: '', href: 'http://127.0.0.1/' });
setGlobal('performance', { now: () => now_ms });
AbortSignal.timeout = (ms) => ({ limit_ms: ms });
setGlobal('fetch', (where, options) => server.handle(JSON.parse(options.body), options.signal?.limit_ms ?? 1e9));
const { HostRobot } = await import(pathToFileURL(`${sources}/robot/host.js`).href);

function randomFrom(seed) {
  let state = seed * 2654435761 + 1;
  return () => {
    state = (Math.imul(state ^ (state >>> 15), 0x2c1b3c6d) + 0x9e3779b9) | 0;
    return ((state ^ (state >>> 13)) >>> 0) / 2 ** 32;
  };
}

async function settle() {
  for (let k = 0; k < 40; k += 1) await Promise.resolve();
}

async function waitUntil(end_ms) {
  for (;;) {
    timers.sort((a, b) => a.at_ms - b.at_ms);
    if (!timers.length || timers[0].at_ms > end_ms) break;
    const next = timers.shift();
    now_ms = next.at_ms;
    next.callback();
    await settle();
  }
  now_ms = end_ms;
}

// As `tsc studio`: an id of a connection is done once, and news are told until the page has seen them.
class Server {
  constructor(random) {
    this.random = random;
    this.loses = () => false;
    this.late_ms = () => 1;
    this.lost_ms = () => 1; // until the page knows
    this.done = [];
    this.stops = [];
    this.connection = 0;
    this.held = []; // words of a remote control, as they arrive
    this.said = []; // and as they are sent
  }

  handle(request, limit_ms) {
    this.said.push(...(request.asked ?? []).filter((item) => item.do === 'keys').map(({ keys }) => keys));
    if (request.do === 'beat') this.countBeat();
    const answered = new Promise((resolve, reject) => {
      setLater(() => reject(new Error('timeout')), limit_ms);
      const arrive = () => {
        const answer = this.answer(request);
        if (this.loses(true)) return setLater(() => reject(new Error('lost')), this.lost_ms());
        setLater(() => resolve({ ok: true, status: 200, json: async () => answer }), this.late_ms());
      };
      if (this.loses(false)) return setLater(() => reject(new Error('lost')), this.lost_ms());
      setLater(arrive, this.late_ms());
      if (this.random() < this.again) setLater(() => this.answer(request), this.late_ms());
    });
    if (request.do === 'beat') answered.then(() => { this.isUnderWay = false; }, () => Object.assign(this, { isUnderWay: false, lost_at_ms: now_ms }));
    return answered;
  }

  /** A beat: one at a time, and no more than a class takes; after one that is lost it waits, unless there is something new. */
  countBeat() {
    const pause_ms = this.lost_at_ms > this.wanted_at_ms ? 100 : 0;
    if (this.isUnderWay || now_ms - this.beat_at_ms < 30 || now_ms - this.lost_at_ms < pause_ms) this.tooSoon += 1;
    Object.assign(this, { isUnderWay: true, beat_at_ms: now_ms });
  }

  answer(request) {
    if (request.do === 'connect') {
      if (request.connection > this.connection) {
        Object.assign(this, { connection: request.connection, news: [], count: 0, last: 0, pressed: 0 });
        this.tell({ connected: { name: 'TINI' } });
      }
      return {};
    }
    if (request.connection !== this.connection) return { news: [{ number: 1e6, over: 'left' }] };
    if (request.stops > this.pressed) {
      this.pressed = request.stops;
      this.stops.push(request.stops);
      this.tell({ event: 'STOPPED', cause: 'sequence' });
    }
    if (request.do === 'leave') this.tell({ over: 'left' });
    for (const item of request.asked ?? []) {
      if (item.id <= this.last) continue;
      this.last = item.id;
      if (item.do === 'keys') this.held.push(item.keys);
      else this.done.push(item.what);
      setLater(() => this.tell({ id: item.id, ok: true, what: item.what }), this.takes_ms());
    }
    this.news = this.news.filter(({ number }) => number > request.seen);
    return { news: this.news };
  }

  tell(news) {
    this.news.push({ number: (this.count += 1), ...news });
  }
}

// One connection of the page: asks, presses and an end; returns what is seen of it. Where the server `dies`, it has been met.
async function story(random, bad, isWild = false, dies = false) {
  const ends = [];
  const heardItems = [];
  let over = 0;
  server.takes_ms = () => (random() < 0.5 ? 1 : Math.floor(random() * 800));
  Object.assign(server, { tooSoon: 0, isUnderWay: false, beat_at_ms: -1e9, lost_at_ms: -1e9, wanted_at_ms: -1e9 });
  let metCount = 0;
  let wasMet = false;
  let lost = 0;
  server.loses = (isAnswer) => {
    const isLost = random() < (dies && !wasMet ? 0 : bad) && (isWild || lost < 2);
    if (isLost) lost += 1;
    else if (isAnswer) lost = 0;
    return isLost;
  };
  server.late_ms = () => (bad && random() < 0.2 ? Math.floor(random() * (isWild ? 2500 : 400)) : 1);
  server.lost_ms = () => (bad && random() < 0.5 ? Math.floor(random() * 600) : 1);
  server.again = bad ? 0.1 : 0;
  const robot = new HostRobot({ onEvent: (event) => heardItems.push(event.event), onEnd: () => (over += 1) });
  robot.connect('p', 'tinibot', 'en').then(() => (wasMet = true)).catch(() => {}).finally(() => (metCount += 1));
  await waitUntil(now_ms + 3000);
  const askCount = 1 + Math.floor(random() * 12);
  let pressCount = 0;
  const words = []; // how many times each has ended
  for (let k = 0; k < askCount; k += 1) {
    ends.push(0);
    server.wanted_at_ms = now_ms;
    const countEnd = () => (ends[k] += 1);
    robot.ask({ what: `${server.name} ${k}` }).then((answer) => {
      countEnd();
      if (answer.what !== `${server.name} ${k}`) heardItems.push(`another's answer: ${answer.what}`);
    }, countEnd);
    for (let wordCount = Math.floor(random() * 3); wordCount > 0; wordCount -= 1) {
      words.push(0);
      const at = words.length - 1;
      const countWord = () => (words[at] += 1);
      robot.press({ keys: (server.keys = (server.keys ?? 0) + 1), x: 0, y: 0 }).then(countWord, countWord);
    }
    if (random() < 0.1) {
      robot.stop();
      pressCount += robot.isOver ? 0 : 1;
    }
    if (random() < 0.7) await waitUntil(now_ms + Math.floor(random() * 300)); // or at once
  }
  await waitUntil(now_ms + (bad === 1 ? 8000 : 30_000));
  const isThere = wasMet && !robot.isOver;
  const isGone = bad < 1 || robot.isOver; // nothing arrives, and that is known
  robot.leave();
  await settle();
  const before = JSON.stringify([ends, heardItems, over]);
  await waitUntil(now_ms + 10_000);
  const isQuiet = JSON.stringify([ends, heardItems, over]) === before;
  return { words, met: metCount, wasMet, isThere, isGone, over, ends, presses: pressCount, heard: heardItems, isQuiet, timers: timers.length, tooSoon: server.tooSoon };
}

for (let seed = 0; seed < seeds; seed += 1) {
  const [bad, isWild] = [[0.2, false], [0.5, false], [0.5, true], [1, true]][seed % 4];
  server = new Server(randomFrom(seed + 1));
  server.name = 'first';
  const first = await story(randomFrom(seed + 7), bad, isWild, seed % 8 === 7);
  const made = server.done;
  const [held, said] = [[...server.held], [...server.said]];
  server.keys = 0;
  server.done = [];
  server.stops = [];
  server.name = 'second';
  const second = await story(randomFrom(seed + 99), 0);
  const secondDone = server.done;
  server = new Server(randomFrom(seed + 1));
  server.name = 'second';
  const fresh = await story(randomFrom(seed + 99), 0);
  console.log(JSON.stringify({ isWild, first, made, held, said, second, secondDone, fresh, freshDone: server.done }));
}
process.exit(0);
