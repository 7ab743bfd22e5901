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
  'virtual/where.js': ['RunAnnouncer', 'boutEndText', 'bumpSentence', 'starsText'],
  'virtual/sounds.js': ['Sounds'],
  'world/choice.js': ['WorldChoice'],
  'world/drawing.js': ['WorldDrawing'],
  'page/pictures.js': ['replaceOptions', 'makePictureOption', 'makeBlocksPicture', 'makeDialPicture', 'makeWorldPicture', 'makeSymbolPicture'],
  'blocks/blocks.js': ['Blocks'],
  'robot/host.js': ['HostRobot', 'hasHost', 'fetchPorts', 'isPupil', 'isTeacher', 'post'],
  'robot/serial.js': ['hasSerial', 'choosePort', 'listKnownPorts', 'SerialPort'],
  'robot/flash.js': ['fetchFirmwareList', 'loadFirmware', 'flashBoard'],
  '@codemirror/view': ['Decoration', 'EditorView', 'GutterMarker', 'WidgetType', 'gutter', 'highlightActiveLine', 'keymap', 'lineNumbers'],
  pyodide: ['loadPyodide'],
  'lean-qr': ['generate', 'correction'],
  'blockly/core': ['blockly'], // all that it has
};
/** What is played now; other modules are the page's own. */
let played = {};
globalThis.played = new Proxy({}, { get: (_, name) => played[name] });

registerHooks({
  resolve(specifier, context, next) {
    const query = /\?page=\d+$/.exec(context.parentURL ?? '')?.[0];
    if (!query) return next(specifier, context);
    const name = Object.keys(PLAYED).find((item) => specifier === item || (!item.startsWith('@') && specifier.endsWith(`/${item.split('/')[1]}`)));
    if (name && PLAYED[name][0] in played) return { url: `played:${name}${query}`, shortCircuit: true };
    if (specifier.endsWith('/pyodide.asm.mjs')) return { url: `data:text/javascript,await globalThis.played.loadModule?.()//${query}`, shortCircuit: true };
    if (specifier.endsWith('.json')) return { url: `made:${specifier.split('/').at(-1)}${query}`, shortCircuit: true };
    const found = next(specifier, context);
    return found.url.includes('/node_modules/') ? found : { ...found, url: found.url + query };
  },
  load(url, context, next) {
    const [kind, name] = url.replace(/\?page=\d+$/, '').split(/:(.*)/s);
    if (kind === 'played') {
      const [first] = PLAYED[name], whole = first === 'blockly';
      const source = (whole ? Object.keys(played.blockly) : PLAYED[name]).map((item) => `export const ${item} = globalThis.played.${whole ? 'blockly.' : ''}${item};`).join('\n');
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
const setLater = (callback, ms = 0, ...args) => {
  timers.push({ at_ms: now_ms + Math.max(0, ms || 0), callback: () => callback(...args), number: (count += 1) });
  return count;
};
const clearLater = (number) => {
  timers = timers.filter((item) => item.number !== number);
};
const setRepeating = (callback, ms) => {
  const number = (count += 1);
  const plan = () => timers.push({ at_ms: now_ms + ms, callback: () => { plan(); callback(); }, number });
  plan();
  return number;
};
export const now = () => now_ms;
export const later = (ms, value) => new Promise((resolve) => setLater(() => resolve(value), ms));
const realImmediate = globalThis.setImmediate;

/** Lets all go on that waits for no time; what is imported waits for the real clock. */
export async function settle() {
  for (let k = 0; k < 3; k += 1) await new Promise((resolve) => realImmediate(resolve));
}

export async function wait(ms) {
  const end_ms = now_ms + ms;
  await settle();
  for (;;) {
    timers.sort((a, b) => a.at_ms - b.at_ms || a.number - b.number);
    if (!timers.length || timers[0].at_ms > end_ms) break;
    const next = timers.shift();
    now_ms = next.at_ms;
    next.callback();
    await settle();
  }
  now_ms = end_ms;
}

// -- a browser

/** Who captures an event hears it first, from the window inwards; where it bubbles, the others hear it outwards. */
class Heard extends EventTarget {
  #capturing = {};

  addEventListener(kind, callback, options) {
    if (options?.capture) (this.#capturing[kind] ??= []).push(callback);
    else super.addEventListener(kind, callback, options);
  }

  dispatchEvent(event) {
    let isStopped = false;
    for (const name of ['stopPropagation', 'stopImmediatePropagation']) {
      const stop = event[name];
      event[name] = () => {
        isStopped = true;
        stop.call(event);
      };
    }
    const path = [this];
    if (event.bubbles) {
      for (let part = this.parent; part; part = part.parent) path.push(part);
      path.push(document, document.heard);
      Object.defineProperty(event, 'target', { value: this, configurable: true });
      event.composedPath = () => path;
    }
    for (const item of path.toReversed()) for (const callback of item.#capturing[event.type] ?? []) if (!isStopped) callback(event);
    for (const item of path) if (!isStopped) EventTarget.prototype.dispatchEvent.call(item, event);
    return !event.defaultPrevented;
  }
}

class Part extends Heard {
  localName = '';
  className = '';
  dataset = {};
  children = [];
  files = [];
  options = [];
  selectedIndex = 0;
  textContent = '';
  value = '';
  open = false;
  hidden = false;
  disabled = false;
  attributes = {};
  classList = {
    add: (...names) => { this.className = [...new Set([...this.className.split(' ').filter(Boolean), ...names])].join(' '); },
    remove: (...names) => { this.className = this.className.split(' ').filter((item) => !names.includes(item)).join(' '); },
    toggle: (name, isOn = !this.className.split(' ').includes(name)) => (isOn ? this.classList.add(name) : this.classList.remove(name)),
  };
  style = { setProperty() {}, removeProperty() {} };

  get src() { return this.attributes['src'] ?? ''; }
  set src(address) { this.attributes['src'] = address; }
  get parentElement() { return this.parent; }
  get lastElementChild() { return this.children.at(-1); }
  append(...parts) { this.#put(this.children.length, parts); }
  prepend(...parts) { this.#put(0, parts); }
  after(...parts) { this.parent?.#put(this.parent.children.indexOf(this) + 1, parts); }
  #put(index, parts) {
    const next = this.children.slice(index).find((item) => !parts.includes(item));
    for (const item of parts) if (item instanceof Part) {
      item.parent?.children.splice(0, Infinity, ...item.parent.children.filter((other) => other !== item));
      item.parent = this;
    }
    this.children.splice(next === undefined ? this.children.length : this.children.indexOf(next), 0, ...parts);
  }
  replaceChildren(...parts) {
    this.children = [];
    this.selectedIndex = 0; // of a select
    this.append(...parts);
  }
  appendChild(part) {
    this.append(part);
    return part;
  }
  before(...parts) {
    [this.placedBefore] = parts;
    this.parent?.#put(this.parent.children.indexOf(this), parts);
  }
  remove() { this.parent.children = this.parent.children.filter((item) => item !== this); }
  setAttribute(name, value) {
    this.attributes[name] = value;
    if (name.startsWith('data-')) this.dataset[keyOf(name)] = value;
  }
  removeAttribute(name) {
    delete this.attributes[name];
    if (name.startsWith('data-')) delete this.dataset[keyOf(name)];
  }
  getAttribute(name) { return (name.startsWith('data-') ? this.dataset[keyOf(name)] : this.attributes[name]) ?? null; }
  hasAttribute(name) { return this.getAttribute(name) !== null; }
  click() { this.dispatchEvent(new Event('click')); }
  focus() { document.activeElement = this; }
  select() {}
  setPointerCapture() {}
  getContext() { return null; }
  attachShadow() { return new Part(); }
  toggleAttribute(name, isOn) {
    if (isOn) this.setAttribute(name, '');
    else this.removeAttribute(name);
  }
  showModal() { this.open = true; }
  close() {
    if (!this.open) return;
    this.open = false;
    this.dispatchEvent(new Event('close'));
  }
  contains(part) { return part === this || this.children.some((item) => item instanceof Part && item.contains(part)); }
  /** Of a selector each of tag, #id, .class and [name=value], one of several that commas part. */
  matches(selector) {
    return selector.split(',').some((item) => {
      const match = /^([\w-]+)?(?:#([\w-]+))?(?:\.([\w-]+))?(?:\[([\w-]+)(?:="?([^\]"]*)"?)?\])?$/.exec(item.trim());
      if (!match) return false;
      const [, tag, id, className, name, value] = match;
      const had = name && (typeof this[name] === 'boolean' ? (this[name] ? '' : null) : this.getAttribute(name));
      return (!tag || tag === this.localName) && (!id || id === this.id) && (!className || this.className.split(' ').includes(className))
        && (!name || (value === undefined ? had !== null : had === value));
    });
  }
  closest(selector) { return this.matches(selector) ? this : this.parent?.closest(selector) ?? null; }
  querySelectorAll(selector) { return this.children.filter((item) => item instanceof Part).flatMap((item) => [...item.matches(selector) ? [item] : [], ...item.querySelectorAll(selector)]); }
  querySelector(selector) { return this.querySelectorAll(selector)[0] ?? null; }
  checkVisibility() { return !this.hidden && (this.parent?.checkVisibility() ?? true); }
  insertBefore(part, next) {
    this.children = this.children.filter((item) => item !== part);
    part.parent = this;
    this.children.splice(next ? this.children.indexOf(next) : this.children.length, 0, part);
  }
}

const keyOf = (name) => name.slice('data-'.length).replace(/-(\w)/g, (_, letter) => letter.toUpperCase());

class Store {
  #kept = new Map();
  room = Infinity; // characters
  constructor() {
    return new Proxy(this, { // its places are its keys
      get: (_, name) => (typeof this[name] === 'function' ? this[name].bind(this) : this[name]),
      ownKeys: () => [...this.#kept.keys()],
      getOwnPropertyDescriptor: (_, name) => (this.#kept.has(name) ? { value: this.#kept.get(name), enumerable: true, configurable: true } : undefined),
    });
  }
  getItem(key) { return this.#kept.get(key) ?? null; }
  /** How many characters there is room for at a place. */
  roomFor(key) { return this.room - [...this.#kept].reduce((sum, [item, whole]) => sum + (item === key ? 0 : whole.length), 0); }
  setItem(key, value) {
    if (value.length > this.roomFor(key)) throw new Error('QuotaExceededError');
    this.#kept.set(key, value);
  }
  removeItem(key) { this.#kept.delete(key); }
  [Symbol.iterator]() { return this.#kept[Symbol.iterator](); }
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

const setGlobal = (name, value) => Object.defineProperty(globalThis, name, { value, configurable: true, writable: true });
for (const kind of ['', 'Button', 'Canvas', 'Input', 'Select', 'Progress', 'Details', 'Form', 'Dialog', 'TextArea']) setGlobal(`HTML${kind}Element`, Part);
setGlobal('Element', Part);
setGlobal('Text', class {}); // what is said in a part is a string
setGlobal('DOMMatrix', Matrix);
setGlobal('setTimeout', setLater);
setGlobal('clearTimeout', clearLater);
setGlobal('clearInterval', clearLater);
setGlobal('performance', { now });
setGlobal('requestAnimationFrame', (callback) => setLater(() => callback(now_ms), 16));
setGlobal('cancelAnimationFrame', clearLater);
for (const name of ['ResizeObserver', 'MutationObserver']) setGlobal(name, class { observe() {} });
setGlobal('matchMedia', () => ({ matches: false }));
setGlobal('Option', Part);
setGlobal('self', globalThis);
setGlobal('location', { hash: '', pathname: '/', search: '', href: 'http://127.0.0.1/' });
const goTo = (_, __, address) => { location.hash = new URL(address, location.href).hash; };
setGlobal('history', { replaceState: goTo, pushState: goTo });
AbortSignal.timeout = () => new AbortController().signal;

/** The elements of a page that a browser makes of its HTML, from the whole of which they hang. */
function partsOf(html) {
  const whole = new Part();
  let inner = whole;
  for (const [, isEnd, tag, words, isEmpty, said] of html.matchAll(/<(\/?)([a-z]\w*)((?:\s+[\w-]+(?:="[^"]*")?)*)\s*(\/?)>|([^<>]+)/gi)) {
    if (said !== undefined) {
      if (said.trim()) inner.textContent += said;
    } else if (isEnd) inner = inner.parent;
    else {
      const part = Object.assign(new Part(), { localName: tag });
      for (const [, name, value = ''] of words.matchAll(/([\w-]+)(?:="([^"]*)")?/g)) {
        part.setAttribute(name, value);
        if (['hidden', 'disabled', 'open'].includes(name)) part[name] = true;
        if (['id', 'value', 'type', 'title'].includes(name)) part[name] = value;
        if (name === 'class') part.className = value;
      }
      inner.append(part);
      if (!isEmpty && !['meta', 'link', 'input'].includes(tag)) inner = part;
    }
  }
  return whole;
}

let pages = 0;
/** Loads the page anew; what is played is as given. @param {string} html of which it is made; else it has whatever is asked for @returns how its modules are imported, and its elements by their ids */
export function freshPage(replacements = {}, html = '') {
  const query = `?page=${(pages += 1)}`;
  const whole = partsOf(html);
  const parts = new Map(whole.querySelectorAll('[id]').map((part) => [part.id, part]));
  const byId = (id) => parts.get(id) ?? parts.set(id, new Part()).get(id);
  played = replacements;
  timers = [];
  setGlobal('window', Object.assign(new EventTarget(), { setTimeout: setLater, setInterval: setRepeating, sessionStorage: new Store(), localStorage: new Store() }));
  const heard = new Heard();
  for (const name of ['addEventListener', 'dispatchEvent']) setGlobal(name, heard[name].bind(heard));
  setGlobal('document', Object.assign(new Heard(), {
    heard,
    documentElement: whole.children[0] ?? new Part(), body: whole.querySelectorAll('body')[0] ?? new Part(), getElementById: byId, querySelectorAll: (selector) => whole.querySelectorAll(selector),
    createElement: (tag) => Object.assign(new Part(), { localName: tag }), createElementNS: (_, tag) => Object.assign(new Part(), { localName: tag }),
    visibilityState: 'visible', hidden: false, querySelector: html ? (selector) => whole.querySelectorAll(selector)[0] ?? null : byId,
  }));
  const load = (name) => import(pathToFileURL(`${sources}/${name}`).href + query);
  return { load, byId };
}

/** The texts of the page are there. */
export async function loadTexts(page) {
  const before = globalThis.fetch;
  setGlobal('fetch', async () => ({ ok: true, json: async () => JSON.parse(readFileSync(`${made}/texts.json`, 'utf-8')) }));
  await (await page.load('page/texts.js')).setLanguage('en');
  setGlobal('fetch', before);
}

/** Somebody chooses a file, which a browser tells of if it is another one than it has there. @param {Part} input @param {any} file */
export function chooseFile(input, file) {
  const hasFile = () => Boolean(input.files.length);
  Object.defineProperty(input, 'value', { get: () => (hasFile() ? `C:\\fakepath\\${input.files[0].name}` : ''), set: () => { input.files = []; }, configurable: true });
  if (hasFile() && input.files[0].name === file.name) return;
  input.files = [file];
  input.dispatchEvent(new Event('change', { bubbles: true }));
}

export const replaceFetch = (callback) => setGlobal('fetch', callback);
export const replaceNavigator = (value) => setGlobal('navigator', value);

/** What calls it, with what; of each name its answer. */
export function noting(notes, name, answers = {}) {
  return new Proxy(answers, {
    get: (_, property) => (property in answers ? answers[property] : (...args) => { notes.push([name, property, ...args]); }),
    set: (_, property, value) => { answers[property] = value; return true; },
  });
}

export function chanceOf(seed) {
  let state = seed * 2654435761 + 1;
  const random = () => {
    state = (Math.imul(state ^ (state >>> 15), 0x2c1b3c6d) + 0x9e3779b9) | 0;
    return ((state ^ (state >>> 13)) >>> 0) / 2 ** 32;
  };
  random.below = (most) => Math.floor(random() * most);
  random.of = (list) => list[random.below(list.length)];
  return random;
}

export const PROGRAM = { text: 'X = DISTANCE;', image: '00ff', places: [[0, 1, 1, 1, 9]], shows: [[0, 'X', 1, 1, false, false]], variables: [{ name: 'X', is_yes_no: false }], remote: ['KEY_A'] };

/** As the worker's: each picture of it goes on, bumps, says and ends. */
export function virtualRobot(random, isGood) {
  let now_ms = 0;
  let fault = '';
  let bumps = 0;
  const ends_ms = 300 + random.below(3000);
  let isStopped = false;
  let isHeld = false;
  const outcome = isGood ? random.of(['runs', 'runs', 'refused', 'fault']) : random.of(['runs', 'refused', 'breaks', 'fault']);
  return {
    outcome,
    breaks: () => outcome === 'breaks' && random() < 0.3,
    answer(request) {
      const events = [];
      if (request.do === 'power_on') {
        if (outcome === 'refused') return { refused: ['no place'] };
        events.push([0, 'START']);
        isStopped = false;
        isHeld = request.is_held;
      }
      if (request.do === 'go_on') isHeld = false;
      if (request.do === 'stop') {
        isStopped = true;
        events.push([now_ms, 'STOP']);
      }
      const duration_ms = isHeld || isStopped ? 0 : request.duration_ms ?? (request.do === 'step' ? 20 : 0);
      now_ms += duration_ms;
      if (duration_ms && random() < 0.3) events.push([now_ms, `SHOW ${random.below(9)}`, 0]);
      if (duration_ms && random() < 0.2) events.push([now_ms, `BEEP 440 ${random.below(900)}`]);
      if (duration_ms && random() < 0.2) bumps += 1;
      if (now_ms > ends_ms && outcome === 'fault') fault = 'STUCK';
      return {
        now_ms, began_ms: 0, pose: [0, 0, 0], motors: [0, 0], is_running: !isStopped && now_ms < ends_ms, is_waiting: false,
        is_held: isHeld, fault, fault_at: fault ? 0 : null, at: 0, places: [0], bumps, touches: null, score: null, actuators: [],
        readings: [], variables: [now_ms], events,
      };
    },
  };
}

const AROUND = 150; // characters

/** What is seen of both, from where they differ. */
export function compared(after, alone) {
  const [a, b] = [JSON.stringify(after), JSON.stringify(alone)];
  let offset = 0;
  while (offset < a.length && a[offset] === b[offset]) offset += 1;
  const from = Math.max(0, offset - AROUND);
  return { after: a.slice(from, offset + AROUND), alone: b.slice(from, offset + AROUND), isSame: a === b, length: b.length };
}
