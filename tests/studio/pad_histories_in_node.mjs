// node pad_histories_in_node.mjs SOURCES MADE FIRST SEEDS: whatever hands do at the page's remote control, while robots come and
// go: all that is held, and nothing else, is told to the robot that is driven. A plain model says what is held. Prints what
// each seed has done.

import { chanceOf, freshPage, loadTexts, now, replaceNavigator, wait, words } from './page_in_node.mjs';

const NOTHING = { keys: 0, x: 0, y: 0 };
const SIDES = { side_virtual: 'driving', side_real: 'link', side_lesson: 'driving' };
const ARROWS = { ArrowUp: [0, 1], ArrowDown: [0, -1], ArrowLeft: [-1, 0], ArrowRight: [1, 0] };
const KEYBOARD = [...Object.keys(ARROWS), 'a', 'b'];
const OWNERS = ['input', 'textarea', 'select', 'dialog', '#blocks', '#arena', '[contenteditable=true]', '[tabindex="0"]'];
const GAMEPAD_KEYS = [12, 13, 14, 15, 0, 1];
const REPEAT_MS = 200;
const FRAME_MS = 16;
const SIZE = 120;
const ACTS = 100;

const stickAt = (right, up) => {
  const length = Math.max(1, Math.hypot(right, up));
  return { x: Math.round(100 * right / length) || 0, y: Math.round(100 * up / length) || 0 };
};
const sameAs = (a) => (b) => a.keys === b.keys && a.x === b.x && a.y === b.y;
const isNothing = sameAs(NOTHING);

/** What hands hold: each holder's keys and stick, the newest that has moved last. */
class Held {
  #holders = [];

  hold(name, controls) {
    const before = this.#holders.find((item) => item.name === name);
    if (sameAs(controls)(before?.controls ?? NOTHING)) return;
    this.#holders = [...this.#holders.filter((item) => item !== before), { name, controls }];
  }

  letGo(test) {
    this.#holders = this.#holders.filter(({ name }) => !test(name));
  }

  get all() {
    const { x, y } = this.#holders.map(({ controls }) => controls).findLast((controls) => controls.x || controls.y) ?? NOTHING;
    return { keys: this.#holders.reduce((keys, { controls }) => keys | controls.keys, 0), x, y };
  }
}

async function history(seed) {
  const random = chanceOf(seed);
  let gamepads = [], lookCount = 0;
  replaceNavigator({ getGamepads: () => { lookCount += 1; return gamepads; } });
  const page = freshPage();
  const Part = globalThis.HTMLElement;
  Part.prototype.getBoundingClientRect = () => ({ left: 0, top: 0, width: SIZE, height: SIZE });
  Object.assign(page.byId('pad'), { hidden: true }); // as its HTML has it
  page.byId('link').id = 'link';
  page.byId('link').append(page.byId('link_said'), page.byId('link_rest'));
  const styles = {};
  page.byId('pad_thumb').style.setProperty = (name, value) => { styles[name] = value; };
  await loadTexts(page);
  const { pageState } = await page.load('page/page_state.js');
  const { REMOTE_DEVICES } = await page.load('page/words.js');
  const { text } = await page.load('page/texts.js');
  const { Pad } = await page.load('remote/pad.js');
  const pad = new Pad();
  pageState.sideId.set('side_virtual');
  const keyButtons = [...page.byId('pad_arrows').children, ...page.byId('pad_letters').children];
  const parts = [...keyButtons, page.byId('pad_stick')];
  const devices = REMOTE_DEVICES.filter((device) => device.is_yes_no);
  const sticks = REMOTE_DEVICES.filter((device) => !device.is_yes_no).map((device) => device.text);
  const owners = OWNERS.map((selector) => {
    const owner = selector.startsWith('#') ? page.byId(selector.slice(1)) : document.createElement(selector.startsWith('[') ? 'div' : selector);
    if (selector.startsWith('#')) owner.id = selector.slice(1);
    const [, name, value] = /^\[(\w+)="?(\w+)/.exec(selector) ?? [];
    if (name) owner.setAttribute(name, value);
    owner.addEventListener('keydown', (event) => event.key === 'Escape' && event.stopPropagation()); // as Blockly does
    const inner = document.createElement('span');
    owner.append(inner);
    return random() < 0.5 ? owner : inner;
  });
  const free = document.createElement('p');

  // The model.
  const acted = [], ends = new Set();
  const fail = (error) => { throw new Error(`seed ${seed}, after ${acted.slice(-12).join(', ')}: ${error}`); };
  const held = new Held();
  const offered = {};
  const fingers = new Map(); // those that press, each with its part, and whether it is heeded
  let pressed = new Map(), stale = new Set(), driven, count = 0, log = [];
  const isShown = (part) => {
    if (!driven || driven.lacksRemote) return false;
    return part.dataset.key ? driven.remoteWords.includes(part.dataset.key) : driven.remoteWords.some((word) => sticks.includes(word));
  };
  const there = () => gamepads.filter((item) => item?.connected);
  const heldByGamepad = ({ axes: [right, down], buttons }) => ({
    ...Math.hypot(right, down) > 0.15 ? stickAt(right, -down) : { x: 0, y: 0 },
    keys: GAMEPAD_KEYS.reduce((keys, button, index) => keys | (buttons[button].pressed ? 1 << index : 0), 0),
  });
  const readGamepads = () => {
    held.letGo((name) => typeof name === 'string' && name.startsWith('pad') && !there().some(({ index }) => name === `pad${index}`));
    if (driven) for (const gamepad of there()) {
      const controls = heldByGamepad(gamepad);
      if (isNothing(controls)) stale.delete(gamepad.index);
      if (!stale.has(gamepad.index)) held.hold(`pad${gamepad.index}`, controls);
    }
  };
  const letGo = () => {
    held.letGo(() => true);
    for (const finger of fingers.values()) finger.isHeeded = false;
    pressed = new Map();
    for (const { index } of there()) stale.add(index);
  };
  const chooseDriven = () => {
    const next = offered[SIDES[pageState.sideId.value]];
    if (next === driven) return;
    letGo();
    driven = next;
    readGamepads();
  };
  const holdKeys = () => {
    const isStickMoved = isShown(page.byId('pad_stick')) && !keyButtons.slice(0, 4).some(isShown);
    let keys = 0, right = 0, up = 0;
    for (const index of pressed.values()) {
      if (isStickMoved && index < 4) [right, up] = [right + Object.values(ARROWS)[index][0], up + Object.values(ARROWS)[index][1]];
      else keys |= 1 << index;
    }
    held.hold('keyboard', { keys, ...stickAt(right, up) });
  };
  const point = (kind, part, pointerId, [clientX, clientY] = [SIZE / 2, SIZE / 2], button = 0) => part.dispatchEvent(Object.assign(new Event(kind), { pointerId, clientX, clientY, button }));
  const somewhere = () => [random.below(SIZE), random.below(SIZE)];
  const moveFinger = (pointerId, at) => {
    const { part } = fingers.get(pointerId);
    const keyIndex = keyButtons.indexOf(part);
    held.hold(pointerId, keyIndex < 0 ? { keys: 0, ...stickAt((at[0] - SIZE / 2) / (SIZE / 3), (SIZE / 2 - at[1]) / (SIZE / 3)) } : { keys: 1 << keyIndex, x: 0, y: 0 });
  };
  const keyEvent = (kind, target, key, code, more = {}) => {
    const event = Object.assign(new Event(kind, { cancelable: true, bubbles: true }), { key, code, ...more });
    target.dispatchEvent(event);
    return event.defaultPrevented;
  };
  /** Each does something and tells the model of it. */
  const actions = {
    offer() {
      const side = random.of(['driving', 'link']);
      const remoteWords = random() < 0.3 ? [] : REMOTE_DEVICES.map((device) => device.text).filter(() => random() < 0.6);
      const lacksRemote = random() < 0.2;
      if (random() < 0.2 && offered[side]) remoteWords.splice(0, Infinity, ...offered[side].remoteWords); // as before, or as it
      const number = (count += 1);
      const robot = { number, remoteWords, lacksRemote, sendControls: (controls) => log.push({ ms: now(), number, ...controls }) };
      const before = offered[side];
      pad.offerRobot(side, robot);
      if (!before || before.lacksRemote !== lacksRemote || `${before.remoteWords}` !== `${remoteWords}`) offered[side] = robot;
      chooseDriven();
    },
    offerAgain() {
      const [side, robot] = random.of(Object.entries(offered)) ?? [];
      if (robot) pad.offerRobot(side, { ...robot, sendControls: () => fail('the one that is as before is told') });
    },
    takeAway() {
      const side = random.of(['driving', 'link']);
      pad.offerRobot(side, null);
      delete offered[side];
      chooseDriven();
    },
    switchSide() {
      const side = random.of(Object.keys(SIDES));
      pageState.sideId.set(side);
      chooseDriven();
    },
    press() {
      const pointerId = 1 + random.below(3), part = random.of(parts);
      if (fingers.has(pointerId) || !isShown(part)) return;
      const at = somewhere(), button = random() < 0.1 ? 2 : 0;
      point('pointerdown', part, pointerId, at, button);
      if (button) return;
      const isTaken = !part.dataset.key && [...fingers.values()].some((other) => other.part === part && other.isHeeded);
      fingers.set(pointerId, { part, isHeeded: !isTaken });
      if (!isTaken) moveFinger(pointerId, at);
    },
    move() {
      const [pointerId, finger] = random.of([...fingers]) ?? [];
      if (!finger) return;
      const at = somewhere();
      point('pointermove', finger.part, pointerId, at);
      if (finger.isHeeded) moveFinger(pointerId, at);
    },
    hover() { // what presses nothing
      const pointerId = 1 + random.below(3), part = random.of(parts);
      if (!fingers.has(pointerId)) point('pointermove', part, pointerId, somewhere());
    },
    release() {
      const [pointerId, finger] = random.of([...fingers]) ?? [];
      if (!finger) return;
      point(random.of(['pointerup', 'pointercancel', 'lostpointercapture']), finger.part, pointerId);
      fingers.delete(pointerId);
      held.letGo((name) => name === pointerId);
    },
    keys() {
      const place = random();
      const button = place < 0.2 ? random.of(keyButtons) : null;
      const target = button ?? (place < 0.4 ? random.of(owners) : free);
      const name = button && random() < 0.7 ? random.of([' ', 'Enter']) : random.of([...KEYBOARD, 'A', 'B', 'x', ' ']);
      const more = random() < 0.15 ? { [random.of(['ctrlKey', 'metaKey', 'altKey'])]: true } : { repeat: random() < 0.2 };
      const code = name === ' ' || name === 'Enter' ? name : name.toLowerCase();
      if (!more.repeat && pressed.has(code)) return;
      const index = button && [' ', 'Enter'].includes(name) ? keyButtons.indexOf(button) : KEYBOARD.indexOf(name.length > 1 ? name : name.toLowerCase());
      const isOurs = driven && !driven.lacksRemote && index >= 0 && !owners.includes(target) && !Object.keys(more).some((item) => item !== 'repeat');
      if (keyEvent('keydown', target, name, code, more) !== Boolean(isOurs)) fail(`the browser ${isOurs ? 'does what' : 'cannot do what'} ${name} does`);
      if (!isOurs || more.repeat) return;
      pressed.set(code, index);
      holdKeys();
    },
    liftKey() {
      const code = random.of([...pressed.keys(), 'x']);
      keyEvent('keyup', free, code, code);
      if (pressed.delete(code)) holdKeys();
    },
    gamepads() {
      const before = gamepads;
      const eventNames = [];
      gamepads = [0, 1].map((index) => {
        const was = before[index];
        if (random() < 0.5) return was;
        if (random() < 0.25) {
          if (was?.connected) eventNames.push('gamepaddisconnected');
          return random() < 0.5 && was ? { ...was, connected: false } : null;
        }
        if (!was?.connected) eventNames.push('gamepadconnected');
        const isRest = random() < 0.4;
        return {
          index, connected: true, axes: isRest ? [random.of([0, 0.1]), -0.05] : [random.of([0, 0.1, 0.5, -1]), random.of([0, -0.1, 1, -0.7])],
          buttons: Array.from({ length: 16 }, () => ({ pressed: !isRest && random() < 0.1 })),
        };
      });
      for (const item of eventNames) if (item === 'gamepadconnected' || random() < 0.5) {
        dispatchEvent(new Event(item));
        readGamepads();
      }
    },
    letGo() {
      const way = random.of(['stop', 'Escape', 'blur', 'pagehide', 'freeze', 'hidden']);
      ends.add(way);
      if (way === 'stop') page.byId('stop').click();
      else if (way === 'Escape') keyEvent('keydown', random.of([...owners, free]), 'Escape', 'Escape');
      else if (way === 'hidden') {
        document.visibilityState = 'hidden';
        document.dispatchEvent(new Event('visibilitychange'));
      } else dispatchEvent(new Event(way));
      letGo();
    },
    comeBack() {
      document.visibilityState = 'visible';
      document.dispatchEvent(new Event('visibilitychange'));
    },
    changeLanguage() {
      pageState.language.set(random.of(['en', 'es', 'pt']));
    },
  };
  const checkTold = () => {
    const last = log.findLast(({ number }) => number === driven?.number) ?? NOTHING;
    const all = driven && !driven.lacksRemote ? held.all : NOTHING;
    if (!sameAs(last)(all)) fail(`${JSON.stringify(all)} is held, and ${JSON.stringify(last)} is told`);
    if (styles.translate !== undefined && styles.translate !== `${held.all.x * 0.75}% ${-held.all.y * 0.75}%`) fail(`the stick is seen at ${styles.translate}`);
    keyButtons.forEach((part, index) => {
      if (part.className.includes('held') !== Boolean(held.all.keys & 1 << index)) fail(`${part.dataset.key} is seen otherwise`);
    });
    if (!isNothing(all)) ends.add('held');
  };
  const checkShown = () => {
    const box = page.byId('pad');
    if (box.hidden !== !driven) fail('it is seen without a robot, or is not seen');
    if (!driven) return;
    const side = page.byId(SIDES[pageState.sideId.value]);
    if (box.parent !== side || side.children.at(side.id === 'link' ? 1 : -1) !== box) fail('it is seen elsewhere, or at another robot');
    const wrong = parts.find((part) => part.hidden === isShown(part));
    if (wrong) fail(`${wrong.dataset.key ?? 'the stick'} is seen, or is not`);
    for (const [id, group] of [['pad_arrows', keyButtons.slice(0, 4)], ['pad_letters', keyButtons.slice(4)]]) if (page.byId(id).hidden === group.some(isShown)) fail(`${id} is seen, or is not`);
    if (page.byId('pad_said').textContent !== (driven.lacksRemote ? text('pad_deaf') : '')) fail(`it says ${page.byId('pad_said').textContent}`);
    const name = keyButtons.findIndex((part, index) => part.attributes['aria-label'] !== devices[index].labels[pageState.language.value]);
    if (name >= 0) fail(`a key is called ${keyButtons[name].attributes['aria-label']}`);
  };
  for (let k = 0; k < ACTS; k += 1) {
    const act = random.of([...Object.keys(actions), 'press', 'press', 'press', 'press', 'move', 'keys', 'keys', 'release', 'gamepads', 'gamepads', ...driven ? [] : Array(12).fill('offer')]);
    acted.push(act);
    ends.add(act);
    const [drivenBefore, length] = [driven, log.length];
    actions[act]();
    log.slice(length).forEach((item, index) => {
      if (item.number !== driven?.number && (index || item.number !== drivenBefore?.number || !isNothing(item))) fail(`another robot is told ${JSON.stringify(item)}`);
    });
    checkTold();
    checkShown();
    const [lookCountBefore, logged] = [lookCount, log.length];
    const waits_ms = random.of([FRAME_MS + 1, FRAME_MS + 1, 60, 250, 700]);
    const begins_ms = now();
    await wait(waits_ms);
    readGamepads();
    checkTold();
    const frames = Math.ceil(waits_ms / FRAME_MS);
    if (lookCount - lookCountBefore > (driven && there().length ? frames + 1 : 1)) fail(`in ${frames} pictures gamepads are looked at ${lookCount - lookCountBefore} times`);
    if (log.slice(logged).some((item) => item.number !== driven?.number)) fail('one that is not driven is told');
    if (now() - begins_ms !== waits_ms) fail('time');
    const isHeld = driven && !driven.lacksRemote && !isNothing(held.all);
    if (isHeld && now() - log.at(-1).ms >= REPEAT_MS + 1) fail('what is held is not said again');
  }
  log.forEach((item, index) => {
    const before = log.slice(0, index).findLast((other) => other.number === item.number);
    const since_ms = before && item.ms - before.ms;
    if (!before && isNothing(item)) fail('a robot is told first that nothing is held');
    if (before && sameAs(before)(item) && (isNothing(item) || since_ms !== REPEAT_MS)) fail(`it is said again after ${since_ms} ms`);
    if (before && !isNothing(before) && since_ms > REPEAT_MS) fail(`it was held, and not said for ${since_ms} ms`);
  });
  return [...ends];
}

const [first, seeds] = words.map(Number);
for (let seed = first; seed < first + seeds; seed += 1) console.log(JSON.stringify(await history(seed)));
process.exit(0);
