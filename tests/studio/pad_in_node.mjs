// node pad_in_node.mjs SOURCES MADE STORY: plays what hands do at the page's remote control, on a clock of the script.
// Prints as JSON what each robot was told: when, its side, and what is held.

import { freshPage, loadTexts, now, replaceNavigator, wait, words } from './page_in_node.mjs';

const story = JSON.parse(words[0]);
let gamepads = [];
replaceNavigator({ getGamepads: () => gamepads });
const page = freshPage();
const Part = globalThis.HTMLElement;
Object.defineProperty(globalThis, 'Element', { value: Part, configurable: true });
Part.prototype.setPointerCapture = () => {};
Part.prototype.getBoundingClientRect = () => ({ left: 0, top: 0, width: 120, height: 120 });
Part.prototype.after = function after(part) { this.placedAfter = part; };
Part.prototype.closest = function closest() { return this.isTaken ? this : null; };
const heard = new EventTarget();
document.addEventListener = heard.addEventListener.bind(heard);
document.visibilityState = 'visible';
await loadTexts(page);
const { pageState } = await page.load('page/page_state.js');
const { Pad } = await page.load('remote/pad.js');
const pad = new Pad();
const box = Object.assign(page.byId('pad'), { hidden: true });
const parts = [...page.byId('pad_arrows').children, ...page.byId('pad_letters').children];
const part = (name) => (name === 'stick' ? page.byId('pad_stick') : parts.find((item) => item.dataset.key === name));
const taken = Object.assign(new Part(), { isTaken: true });

const told = [];
const point = (kind, name, pointerId, clientX = 60, clientY = 60) => part(name).dispatchEvent(Object.assign(new Event(kind), { pointerId, clientX, clientY, button: 0 }));
const key = (kind, name, more = {}) => {
  const event = Object.assign(new Event(kind, { cancelable: true }), { key: name, code: name, ...more });
  Object.defineProperty(event, 'target', { value: more.on === 'field' ? taken : part(more.on) ?? new Part() });
  dispatchEvent(event);
};
const steps = {
  offer: (side, driven) => pad.offerRobot(side, driven && { ...driven, sendControls: ({ keys, x, y }) => told.push([now(), side, keys, x, y]) }),
  down: (...args) => point('pointerdown', ...args),
  move: (...args) => point('pointermove', ...args),
  up: (...args) => point('pointerup', ...args),
  cancel: (...args) => point('pointercancel', ...args),
  keydown: (...args) => key('keydown', ...args),
  keyup: (...args) => key('keyup', ...args),
  gamepads: (...gamepadStates) => { gamepads = gamepadStates.map(([axes, pressed], index) => ({ index, connected: true, axes, buttons: Array.from({ length: 16 }, (_, k) => ({ pressed: pressed.includes(k) })) })); },
  event: (name) => dispatchEvent(new Event(name)),
  hide: () => { document.visibilityState = 'hidden'; heard.dispatchEvent(new Event('visibilitychange')); },
  see: () => { document.visibilityState = 'visible'; heard.dispatchEvent(new Event('visibilitychange')); },
  side: (id) => pageState.sideId.set(id),
  stop: () => page.byId('stop').click(),
  wait,
};
for (const [what, ...args] of story) await steps[what](...args);
const shown = [...parts, page.byId('pad_stick')].filter((item) => !item.hidden).map((item) => item.dataset.key ?? 'stick');
console.log(JSON.stringify({ told, shown: box.hidden ? [] : shown, said: page.byId('pad_said').textContent }));
process.exit(0);
