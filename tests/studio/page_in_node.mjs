// The page's modules in node, on a clock of the script, with as much of a browser as they touch.
//
// `freshPage` gives modules that share nothing with those of the page before, as a tab that is loaded again.

import { readFileSync } from 'node:fs';
import { registerHooks } from 'node:module';
import { pathToFileURL } from 'node:url';

export const [sources, made, ...words] = process.argv.slice(2);

/** Modules that a script plays, by the end of their address; each one's exports are of `globalThis.played[name]`. */
const PLAYED = {
  'virtual/arena.js': ['Arena'],
  'virtual/plot.js': ['Plot'],
  'virtual/where.js': ['RunAnnouncer', 'boutEnd', 'starsText'],
  'virtual/sounds.js': ['Sounds'],
  'world/choice.js': ['WorldChoice'],
  'world/drawing.js': ['WorldDrawing'],
  'page/pictures.js': ['replaceOptions', 'makePictureOption', 'makeBlocksPicture', 'makeDialPicture', 'makeWorldPicture', 'makeSymbolPicture'],
  'blocks/blocks.js': ['Blocks'],
  'robot/host.js': ['HostRobot', 'hasHost', 'fetchPorts', 'isPupil', 'isTeacher', 'post'],
  'robot/serial.js': ['hasSerial', 'choosePort', 'listKnownPorts', 'SerialPort'],
  'robot/flash.js': ['fetchFirmwares', 'loadFirmware', 'flashBoard'],
  pyodide: ['loadPyodide'],
  'lean-qr': ['generate', 'correction'],
};
/** What is played now; other modules are the page's own. */
let played = {};
globalThis.played = new Proxy({}, { get: (_, name) => played[name] });

registerHooks({
  resolve(specifier, context, next) {
    const query = /\?page=\d+$/.exec(context.parentURL ?? '')?.[0];
    if (!query) return next(specifier, context);
    const name = Object.keys(PLAYED).find((each) => specifier === each || specifier.endsWith(`/${each.split('/')[1]}`));
    if (name && PLAYED[name][0] in played) return { url: `played:${name}${query}`, shortCircuit: true };
    if (specifier.endsWith('/pyodide.asm.mjs')) return { url: 'data:text/javascript,', shortCircuit: true };
    if (specifier.endsWith('.json')) return { url: `made:${specifier.split('/').at(-1)}${query}`, shortCircuit: true };
    const found = next(specifier, context);
    return { ...found, url: found.url + query };
  },
  load(url, context, next) {
    const [kind, name] = url.replace(/\?page=\d+$/, '').split(/:(.*)/s);
    if (kind === 'played') {
      const source = PLAYED[name].map((each) => `export const ${each} = globalThis.played.${each};`).join('\n');
      return { format: 'module', source, shortCircuit: true };
    }
    if (kind === 'made') return { format: 'module', source: `export default ${readFileSync(`${made}/${name}`, 'utf-8')}`, shortCircuit: true };
    return next(url, context);
  },
});

// -- the clock

let now_ms = 0;
let timers = [];
let count = 0;
const setLater = (does, ms = 0, ...given) => {
  timers.push({ at_ms: now_ms + Math.max(0, ms || 0), does: () => does(...given), number: (count += 1) });
  return count;
};
const clearLater = (number) => {
  timers = timers.filter((each) => each.number !== number);
};
const every = (does, ms) => {
  const number = (count += 1);
  const plans = () => timers.push({ at_ms: now_ms + ms, does: () => { plans(); does(); }, number });
  plans();
  return number;
};
export const now = () => now_ms;
export const later = (ms, value) => new Promise((resolve) => setLater(() => resolve(value), ms));
const realImmediate = globalThis.setImmediate;

/** Lets all go on that waits for no time; what is imported waits for the real clock. */
export async function settles() {
  for (let k = 0; k < 3; k += 1) await new Promise((resolve) => realImmediate(resolve));
}

export async function passes(ms) {
  const end_ms = now_ms + ms;
  await settles();
  for (;;) {
    timers.sort((a, b) => a.at_ms - b.at_ms || a.number - b.number);
    if (!timers.length || timers[0].at_ms > end_ms) break;
    const next = timers.shift();
    now_ms = next.at_ms;
    next.does();
    await settles();
  }
  now_ms = end_ms;
}

// -- a browser

class Part extends EventTarget {
  dataset = {};
  children = [];
  files = [];
  options = [];
  textContent = '';
  value = '';
  open = false;
  hidden = false;
  disabled = false;
  attributes = {};
  classList = { toggle() {}, add() {}, remove() {} };
  style = { setProperty() {}, removeProperty() {} };

  get src() { return this.attributes['src'] ?? ''; }
  set src(address) { this.attributes['src'] = address; }
  get parentElement() { return this.parent; }
  get lastElementChild() { return this.children.at(-1); }
  append(...parts) {
    for (const each of parts) if (each instanceof Part) each.parent = this;
    this.children.push(...parts);
  }
  replaceChildren(...parts) {
    this.children = [];
    this.append(...parts);
  }
  appendChild(part) {
    this.append(part);
    return part;
  }
  before(part) { this.placedBefore = part; }
  remove() { this.parent.children = this.parent.children.filter((each) => each !== this); }
  setAttribute(name, value) { this.attributes[name] = value; }
  removeAttribute(name) { delete this.attributes[name]; }
  getAttribute(name) { return this.attributes[name] ?? null; }
  click() { this.dispatchEvent(new Event('click')); }
  focus() {}
  select() {}
  setPointerCapture() {}
  toggleAttribute() {}
  showModal() { this.open = true; }
  close() {
    if (!this.open) return;
    this.open = false;
    this.dispatchEvent(new Event('close'));
  }
  contains(part) { return part === this || this.children.some((each) => each instanceof Part && each.contains(part)); }
  insertBefore(part, next) {
    this.children = this.children.filter((each) => each !== part);
    part.parent = this;
    this.children.splice(next ? this.children.indexOf(next) : this.children.length, 0, part);
  }
}

class Store {
  #kept = new Map();
  room = Infinity; // characters
  getItem(key) { return this.#kept.get(key) ?? null; }
  /** How many characters there is room for at a place. */
  roomFor(key) { return this.room - [...this.#kept].reduce((sum, [each, whole]) => sum + (each === key ? 0 : whole.length), 0); }
  setItem(key, value) {
    if (value.length > this.roomFor(key)) throw new Error('QuotaExceededError');
    this.#kept.set(key, value);
  }
  removeItem(key) { this.#kept.delete(key); }
}

/** A matrix of the plane, with what the page asks of one. */
class Matrix {
  constructor([a, b, c, d, e, f] = [1, 0, 0, 1, 0, 0]) { Object.assign(this, { a, b, c, d, e, f }); }
  multiply({ a, b, c, d, e, f }) {
    return new Matrix([
      this.a * a + this.c * b, this.b * a + this.d * b, this.a * c + this.c * d, this.b * c + this.d * d,
      this.a * e + this.c * f + this.e, this.b * e + this.d * f + this.f,
    ]);
  }
  translate(x, y) { return this.multiply(new Matrix([1, 0, 0, 1, x, y])); }
  scale(x, y) { return this.multiply(new Matrix([x, 0, 0, y, 0, 0])); }
  rotate(degrees) {
    const [sin, cos] = [Math.sin, Math.cos].map((of) => of(degrees * Math.PI / 180));
    return this.multiply(new Matrix([cos, sin, -sin, cos, 0, 0]));
  }
  inverse() {
    const { a, b, c, d, e, f } = this, all = a * d - b * c;
    return new Matrix([d / all, -b / all, -c / all, a / all, (c * f - d * e) / all, (b * e - a * f) / all]);
  }
  transformPoint({ x, y }) { return { x: this.a * x + this.c * y + this.e, y: this.b * x + this.d * y + this.f }; }
}

const stands = (name, value) => Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
for (const kind of ['', 'Button', 'Canvas', 'Input', 'Select', 'Progress', 'Details', 'Form', 'Dialog', 'TextArea']) stands(`HTML${kind}Element`, Part);
stands('DOMMatrix', Matrix);
stands('setTimeout', setLater);
stands('clearTimeout', clearLater);
stands('clearInterval', clearLater);
stands('performance', { now });
stands('requestAnimationFrame', (does) => setLater(() => does(now_ms), 16));
stands('cancelAnimationFrame', clearLater);
for (const name of ['ResizeObserver', 'MutationObserver']) stands(name, class { observe() {} });
stands('matchMedia', () => ({ matches: false }));
stands('Option', Part);
stands('self', globalThis);
stands('location', { hash: '', pathname: '/', search: '', href: 'http://127.0.0.1/' });
const goesTo = (_, __, address) => { location.hash = new URL(address, location.href).hash; };
stands('history', { replaceState: goesTo, pushState: goesTo });
AbortSignal.timeout = () => new AbortController().signal;

let pages = 0;
/** Loads the page anew; what is played is as given. @returns how its modules are imported, and its elements by their ids */
export function freshPage(given = {}) {
  const query = `?page=${(pages += 1)}`;
  const parts = new Map();
  const byId = (id) => parts.get(id) ?? parts.set(id, new Part()).get(id);
  played = given;
  timers = [];
  stands('window', Object.assign(new EventTarget(), { setTimeout: setLater, setInterval: every, sessionStorage: new Store(), localStorage: new Store() }));
  const heard = new EventTarget();
  for (const name of ['addEventListener', 'dispatchEvent']) stands(name, heard[name].bind(heard));
  stands('document', Object.assign(new EventTarget(), {
    documentElement: new Part(), body: new Part(), getElementById: byId, querySelectorAll: () => [],
    createElement: () => new Part(), createElementNS: () => new Part(),
    visibilityState: 'visible', hidden: false, querySelector: byId,
  }));
  const load = (name) => import(pathToFileURL(`${sources}/${name}`).href + query);
  return { load, byId };
}

/** The texts of the page are there. */
export async function learns(page) {
  const before = globalThis.fetch;
  stands('fetch', async () => ({ ok: true, json: async () => JSON.parse(readFileSync(`${made}/texts.json`, 'utf-8')) }));
  await (await page.load('page/texts.js')).setLanguage('en');
  stands('fetch', before);
}

export const playsFetch = (does) => stands('fetch', does);
export const playsNavigator = (value) => stands('navigator', value);

/** What calls it, with what; of each name its answer. */
export function noting(notes, name, answers = {}) {
  return new Proxy(answers, {
    get: (_, what) => (what in answers ? answers[what] : (...given) => { notes.push([name, what, ...given]); }),
    set: (_, what, value) => { answers[what] = value; return true; },
  });
}

export function chanceOf(seed) {
  let state = seed * 2654435761 + 1;
  const chance = () => {
    state = (Math.imul(state ^ (state >>> 15), 0x2c1b3c6d) + 0x9e3779b9) | 0;
    return ((state ^ (state >>> 13)) >>> 0) / 2 ** 32;
  };
  chance.below = (most) => Math.floor(chance() * most);
  chance.of = (list) => list[chance.below(list.length)];
  return chance;
}
