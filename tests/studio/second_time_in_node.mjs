// node second_time_in_node.mjs SOURCES MADE PART SEEDS: a part of the page does one thing, which ends well or badly, and
// then another one; a page that was just loaded does only that. Prints a JSON row for each seed: how the first one has
// ended, and what is seen of the other one, after the first one and by itself.

import { chanceOf, freshPage, later, learns, noting, now, passes, playsFetch, playsNavigator, settles, words } from './page_in_node.mjs';

const [part, seeds] = words;
const unhandled = [];
process.on('unhandledRejection', (why) => unhandled.push(String(why)));

class Broken extends Error {
  constructor(name = 'NetworkError') {
    super('broken');
    this.name = name;
  }
}

/** Each gives what tells a story, of a page that was just loaded; one that `isGood` loses nothing. */
const PARTS = {
  // A robot by Bluetooth: the same device each time.
  async bluetooth() {
    playsNavigator({ bluetooth: {} });
    const page = freshPage();
    const { BluetoothPort } = await page.load('robot/bluetooth.js');
    const device = new EventTarget();
    let fails = () => false;
    let sent = [];
    const step = async (value) => {
      await later(5);
      if (fails()) throw new Broken();
      return value;
    };
    const way = Object.assign(new EventTarget(), {
      properties: { writeWithoutResponse: true },
      startNotifications: () => step(),
      writeValueWithoutResponse: async (data) => { await step(); sent.push(...data); },
    });
    const service = { getCharacteristic: () => step(way) };
    device.gatt = {
      connected: false,
      connect: async () => {
        await step();
        device.gatt.connected = true;
        return { getPrimaryService: () => step(service) };
      },
      disconnect() {
        device.gatt.connected = false;
        device.dispatchEvent(new Event('gattserverdisconnected'));
      },
    };
    return async (chance, isGood) => {
      sent = [];
      const notes = [];
      fails = () => !isGood && chance() < 0.15;
      const port = new BluetoothPort(device, 9600);
      const opened = port.open(() => {}, () => notes.push('gone')).then(() => 'open', (why) => why.reason);
      await passes(100);
      const how = await opened;
      const ends = [how];
      if (how === 'open') {
        const count = 1 + chance.below(5);
        for (let k = 0; k < count; k += 1) {
          port.write(new Uint8Array(1 + chance.below(50)).fill(k + 1)).then(() => notes.push('done'), () => { notes.push('failed'); ends.push('failed'); });
          if (chance() < 0.5) await passes(chance.below(60));
        }
        await passes(500);
        fails = () => false;
        sent = isGood ? sent : [];
        port.write(new Uint8Array(4)).then(() => notes.push('stopped'), () => notes.push('not stopped'));
        await passes(100);
        notes.push(...sent);
      }
      port.close().catch(() => notes.push('not closed'));
      await passes(100);
      if (how === 'open' && !notes.includes('stopped')) throw new Error(`a write failed, and so does STOP: ${notes}`);
      return { ends: [...new Set(ends)], seen: [notes, device.gatt.connected] };
    };
  },

  // A run of the virtual robot.
  async simulator() {
    const page = freshPage();
    await learns(page);
    const { Simulator } = await page.load('virtual/simulator.js');
    let notes = [];
    let robot = null;
    const python = {
      async ask(request) {
        notes.push({ ...request });
        await later(3);
        if (robot.breaks()) throw new Broken();
        return robot.answer(request);
      },
    };
    const simulator = new Simulator(python, () => {
      const { phase, failure, isStopping, state, trace } = simulator;
      notes.push([phase, failure, isStopping, state?.now_ms, state?.fault, trace.length]);
    });
    return async (chance, isGood) => {
      notes = [];
      robot = virtualRobot(chance, isGood);
      simulator.speed = chance.of([0.1, 0.5, 1, 4]);
      simulator.begin(PROGRAM, 'tinibot', 'w', [], chance() < 0.3);
      await passes(50);
      for (let k = chance.below(8); k > 0; k -= 1) {
        chance.of([() => simulator.pause(), () => simulator.goOn(), () => simulator.step(), () => simulator.push(), () => {}])();
        await passes(chance.below(400));
      }
      const end = chance.of(['stop', 'leave', 'wait']);
      await passes(end === 'wait' ? 4000 : 0);
      simulator.stop();
      if (end === 'leave') simulator.leave();
      await passes(100);
      return { ends: [end, simulator.failure ? 'failure' : simulator.phase], seen: [notes, simulator.phase] };
    };
  },

  // A pupil in a class, and in another one, or again after a teacher has taken them out.
  async pupil() {
    const page = freshPage();
    document.documentElement.dataset['class'] = '';
    playsFetch(async () => { throw new Broken(); });
    playsNavigator({});
    await learns(page);
    const { Pupil } = await page.load('class/pupil.js');
    let room = null;
    playsFetch((_, { headers, body }) => room.asked(headers['X-TiniScript-Token'], JSON.parse(body)));
    const notes = [];
    const panel = { isFree: true, byHost: () => notes.push('to the robot') };
    const work = { text: 'F(1)', robot: 'tinibot' };
    new Pupil({ panel, work, put: (given) => notes.push(['given', given.text]), empty: () => notes.push('empty') });
    const box = page.byId('class_pupil');
    const [join, , buttons] = box.children;
    const [ask, quit] = buttons.children;
    const hand = page.byId('stop').placedBefore;
    let entries = 0;
    return async (chance, isGood) => {
      notes.length = 0;
      const began_ms = now();
      const token = `token ${(entries += 1)}`;
      let place = -1;
      let isUp = false;
      let ends = 'goes on';
      const end = isGood ? 'goes on' : 'removed';
      const told = isGood && { key: 'one', text: 'given', robot: 'tinibot', lessons: [] };
      room = {
        async asked(by, request) {
          if (request.do === 'join') return answers({ token });
          if (by !== token) { // a look of the class before
            await later(1);
            return { ok: false, status: 403 };
          }
          notes.push([now() - began_ms, { ...request }]);
          const isOut = ends === 'removed';
          await later(isGood ? 5 : 5 + chance.below(900));
          if (!isGood && chance() < 0.2) throw new Broken();
          if (isOut) return { ok: false, status: 403 };
          isUp = request.hand ?? isUp;
          if (request.wants !== undefined) place = request.wants ? 0 : -1;
          return answers({ place, waiting: 0, robots: 1, robot: '', left_s: 9, name: 'Ana', hand: isUp, ...(told && !request.took && { given: told }) });
        },
      };
      join.dispatchEvent(new Event('submit', { cancelable: true }));
      if (isGood && chance() < 0.5) hand.click(); // before the class has said how it is
      await passes(500);
      for (let k = 1 + chance.below(4); k > 0; k -= 1) {
        chance.of([() => ask.click(), () => quit.click(), () => hand.click(), () => {}])();
        await passes(chance.below(1500));
      }
      if (!isGood && chance() < 0.7) chance.of([ask, quit, hand]).click(); // whose answer may come behind the end
      ends = end;
      for (let k = chance.below(isGood ? 1 : 4); k > 0; k -= 1) chance.of([ask, quit, hand]).click();
      while (!isGood && join.hidden) await passes(50 + chance.below(50));
      return { ends: [ends], seen: [notes.map((each) => structuredClone(each)), document.documentElement.dataset['pupil'], join.hidden, hand.attributes] };
    };
  },

  // Pictures of pupils' programs.
  async pictures() {
    let story = null;
    class Blocks {
      constructor() { if (story.breaks()) throw new Broken(); }
      showWords() {}
      async pictureOf(form) {
        await later(20);
        if (story.breaks()) throw new Broken();
        return form.text;
      }
    }
    const page = freshPage({ Blocks });
    await learns(page);
    URL.createObjectURL = (text) => `picture of ${text}`;
    const { Pictures } = await page.load('class/pictures.js');
    const python = {
      get ready() { return story.breaks() ? Promise.reject(new Broken()) : Promise.resolve(); },
      async ask(request, data) {
        await later(10);
        if (story.breaks()) throw new Broken();
        return { text: new TextDecoder().decode(data) };
      },
    };
    const pictures = new Pictures(python);
    let stories = 0;
    return async (chance, isGood) => {
      story = { breaks: () => !isGood && chance() < 0.3 };
      stories += 1;
      const came = {};
      const began_ms = now();
      const ends = [];
      const count = 1 + chance.below(6);
      for (let k = 0; k < count; k += 1) {
        const owner = chance.below(4);
        const text = isGood || chance() < 0.9 ? `program ${k}` : '';
        pictures.want(`${stories} ${owner}`, { text, robot: 'tinibot' }, (address) => {
          came[owner] = [address, now() - began_ms];
          ends.push(address ? 'made' : 'none');
        });
        if (!isGood && chance() < 0.1) pictures.forget(`${stories} ${owner}`);
        await passes(chance.below(300));
      }
      await passes(8000);
      return { ends: [...new Set(ends)], seen: came };
    };
  },

  // The panel of the virtual robot; its pictures and sounds are noted.
  async panel() {
    let notes = [];
    const shapes = { start: { x_cm: 0, y_cm: 0 }, flags: [], seconds: 0, name: 'w' };
    class Choice { shapes = shapes; goals = []; request = 'w'; async restoreOwn() { return true; } }
    class Drawing { said = ''; allow() {} forget() {} letGo() {} end() {} }
    const notingClass = (name) => function made() { return noting(notes, name); };
    const beginning = (name) => function made() { // what is drawn is what came since it has begun
      let count = 0;
      return new Proxy(this, { get: (_, what) => (...given) => {
        count = what === 'begin' ? 0 : count + 1;
        notes.push([name, what, count, ...given]);
      } });
    };
    const page = freshPage({
      Arena: beginning('arena'), Plot: beginning('plot'), Where: notingClass('where'), Sounds: notingClass('sounds'),
      starsShown: String, WorldChoice: Choice, WorldDrawing: Drawing, offer() {}, pictured() {}, dialPicture() {},
    });
    await learns(page);
    const { pageState } = await page.load('page/page_state.js');
    const { SimulatorPanel } = await page.load('virtual/simulator_panel.js');
    pageState.robotName.set('tinibot');
    pageState.checked.set(PROGRAM);
    let robot = null;
    const python = {
      async ask(request) {
        notes.push(['python', { ...request }]);
        await later(0); // so that a run has the same pictures, whatever it stops
        if (robot.breaks()) throw new Broken();
        return robot.answer(request);
      },
    };
    robot = virtualRobot(chanceOf(1), true);
    new SimulatorPanel({ python, work: { world: 'w', sound: true }, whenCompiled: async () => PROGRAM, remember() {}, pad: { offer: (side, driven) => notes.push(['pad', side, driven?.reads ?? null]) } });
    await settles();
    const seen = () => [page.byId('doing').textContent, page.byId('trace').textContent, page.byId('values').children.map((row) => row.children.map((each) => each.textContent)), structuredClone(pageState.fault.value)];
    return async (chance, isGood) => {
      notes.splice(0);
      robot = virtualRobot(chance, isGood);
      page.byId('run').click();
      if (!isGood && robot.does === 'runs' && chance() < 0.2) page.byId('run').click(); // twice
      for (let k = chance.below(6); k > 0; k -= 1) {
        await passes(100 + chance.below(300));
        notes.push(seen());
        const pressed = page.byId(chance.of(['pause', 'step', 'push', 'nothing']));
        if (!pressed.hidden && !pressed.disabled) pressed.click();
      }
      const end = chance.of(['stop', 'wait', 'again', 'again']); // again: while it runs
      if (end === 'again') await passes(chance.below(40));
      if (end === 'wait' || isGood) await passes(4000);
      if (end === 'stop' || isGood) page.byId('stop').click();
      if (end !== 'again' || isGood) await passes(50);
      notes.push(seen());
      return { ends: [end === 'again' ? document.documentElement.dataset['phase'] : end, robot.does], seen: notes.slice(notes.findLastIndex(([who, what]) => who === 'sounds' && what === 'begin')) };
    };
  },

  // What is heard of runs.
  async sounds() {
    const heard = [];
    let context = null;
    const level = { setValueAtTime() {}, linearRampToValueAtTime() {}, exponentialRampToValueAtTime() {} };
    class Context {
      constructor() { context = this; }
      state = 'running';
      destination = {};
      get currentTime() { return now() / 1000; }
      resume() { this.state = 'running'; }
      suspend() { this.state = 'suspended'; }
      createGain() { return { gain: level, connect: (next) => next }; }
      createOscillator() {
        const tone = Object.assign(new EventTarget(), { frequency: { ...level }, connect: (next) => next });
        const note = { tone };
        tone.start = (at_s) => { note.begins_ms = Math.round(1000 * at_s); };
        tone.stop = (at_s = now() / 1000) => {
          note.ends_ms = Math.round(1000 * at_s);
          setTimeout(() => now() === note.ends_ms && tone.dispatchEvent(new Event('ended')), note.ends_ms - now());
        };
        heard.push(note);
        return tone;
      }
    }
    const page = freshPage();
    playsNavigator({ userActivation: { hasBeenActive: true } });
    Object.assign(window, { AudioContext: Context });
    globalThis.AudioContext = Context;
    const { Sounds } = await page.load('virtual/sounds.js');
    const sounds = new Sounds();
    return async (chance, isGood) => {
      const began_ms = now();
      for (const each of heard.splice(0)) isGood && each.ends_ms > began_ms && heard.push(each);
      sounds.begin();
      const before = heard.filter((each) => each.ends_ms > began_ms);
      heard.length = 0;
      const states = [before.length];
      for (let k = 1 + chance.below(6); k > 0; k -= 1) {
        if (chance() < 0.2) sounds.crash();
        else sounds.beep(440 + chance.below(100), chance.of([0.05, 0.3, 2, 20]));
        await passes(chance.below(400));
        states.push(context?.state);
      }
      const end = chance.of(['silence', 'mute', 'stop']); // stop: in the middle of a tone
      if (end === 'silence') sounds.silence();
      if (end === 'mute') {
        sounds.mute(true);
        sounds.beep(440, 1);
        sounds.mute(false);
      }
      if (isGood) {
        await passes(3500);
        states.push(context?.state);
      }
      return { ends: [end], seen: [heard.map((each) => [each.begins_ms - began_ms, each.ends_ms - began_ms, each.tone.frequency.value ?? 0]), states] };
    };
  },

  // What is said of a STOP.
  async stopping() {
    const page = freshPage();
    await learns(page);
    const { Stopping } = await page.load('robot/stopping.js');
    const { LINK } = await page.load('page/words.js');
    let notes = [];
    let began_ms = 0;
    const speech = { isHeld: false, say: (key) => notes.push([now() - began_ms, key, speech.isHeld]) };
    const stopping = new Stopping(speech);
    return async (chance, isGood) => {
      notes = [];
      began_ms = now();
      stopping.begin(chance() < 0.3 ? 'say_file' : '');
      await passes(chance.below(LINK.confirm_ms / 2));
      if (chance() < 0.3) stopping.begin();
      await passes(chance.below(LINK.confirm_ms));
      const end = chance.of(isGood ? ['none', 'confirm'] : ['confirm', 'over']);
      if (end === 'confirm') stopping.confirm('SEQUENCE');
      if (end === 'over') notes.push(stopping.end()());
      stopping.forget();
      if (isGood) await passes(2 * LINK.confirm_ms);
      return { ends: [end], seen: [notes, stopping.isOpen, speech.isHeld] };
    };
  },

  // A firmware onto one board after another.
  async flashing() {
    let notes = [];
    let fails = () => '';
    const failed = async (at, value) => {
      await later(10);
      if (fails(at)) throw new Broken('Error');
      return value;
    };
    const page = freshPage({
      hasSerial: true,
      chosenPort: () => failed('port', 'port'),
      firmwares: async () => [{ board: 'uno' }],
      firmwareOf: (which, board) => {
        notes.push([which.name ?? structuredClone(which), board, page.byId('flash_progress').value]);
        return failed('firmware', 'data');
      },
      flashBoard: async (port, board, data, progress, signal) => {
        progress(0.5);
        notes.push(page.byId('flash_progress').value);
        await later(50);
        if (signal.aborted) throw new Broken('AbortError');
        return failed('flash');
      },
    });
    await learns(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Flashing } = await page.load('robot/flashing.js');
    const speech = { say: (key) => notes.push(key), fail: (why) => notes.push(why.reason) };
    let isFree = true;
    new Flashing({ speech, port: () => null, isFree: () => isFree, setBusy: (isBusy) => { isFree = !isBusy; }, meet: () => failed('meet') });
    return async (chance, isGood) => {
      notes = [];
      const end = isGood ? 'good' : chance.of(['good', 'port', 'firmware', 'flash', 'meet', 'cancel']);
      fails = (at) => at === end;
      pageState.robotName.set(isGood ? 'liner' : 'tinibot');
      page.byId('flash_board').value = 'uno';
      const chooser = page.byId('flash_file');
      if (!isGood) {
        Object.assign(chooser, { value: 'C:\\own.hex', files: [{ name: 'own.hex' }] });
        chooser.dispatchEvent(new Event('change'));
      }
      page.byId('flash_write').click();
      if (chance() < 0.3) page.byId('flash_write').click();
      await passes(end === 'cancel' ? 40 : 300);
      if (end === 'cancel') page.byId('flash_cancel').click();
      await passes(200);
      return { ends: [end], seen: [notes, isFree, chooser.value, page.byId('flash_progress').hidden, page.byId('flash_cancel').hidden] };
    };
  },

  // The worker: what it fetches later, over a connection that fails.
  async worker() {
    let fails = () => false;
    const posted = [];
    const page = freshPage({
      loadPyodide: async () => ({
        FS: { mkdirTree() {} }, unpackArchive() {},
        runPython: () => (request) => JSON.stringify({ done: JSON.parse(request) }),
      }),
    });
    globalThis.postMessage = (each) => posted.push(each);
    globalThis.name = 'en';
    playsFetch(async (what) => {
      await later(20);
      if (fails()) throw new Broken();
      return fails() ? { ok: false, status: 503 } : { ok: true, body: null, headers: new Headers(), status: 200, arrayBuffer: async () => new ArrayBuffer(1) };
    });
    await page.load('worker.js');
    await passes(200);
    let number = 0;
    return async (chance, isGood) => {
      posted.splice(0);
      fails = () => !isGood && chance() < 0.4;
      const first = number;
      for (let k = 1 + chance.below(4); k > 0; k -= 1) {
        const language = chance.of(['es', 'pt', 'en']);
        const request = chance.of([{ do: 'lesson_list', language }, { do: 'learn', language }]);
        dispatchEvent(Object.assign(new Event('message'), { data: { id: (number += 1), request: JSON.stringify(request) } }));
        await passes(chance.of([5, 100]));
      }
      await passes(500);
      const told = posted.filter((each) => each.id).map((each) => ({ ...each, id: each.id - first })).sort((a, b) => a.id - b.id);
      return { ends: [told.some((each) => each.error) ? 'failed' : 'good'], seen: [told.map(({ id, error }) => [id, error ?? 'ok']), number - first] };
    };
  },
};

const answers = (found) => ({ ok: true, status: 200, json: async () => found });

const PROGRAM = { image: '00ff', places: [[0, 1, 1, 1, 9]], shows: [[0, 'X', 1, 1, false, false]], variables: [{ name: 'X', is_yes_no: false }], remote: ['KEY_A'] };

/** As the worker's: each picture of it goes on, bumps, says and ends. */
function virtualRobot(chance, isGood) {
  let now_ms = 0;
  let fault = '';
  let bumps = 0;
  const ends_ms = 300 + chance.below(3000);
  let isStopped = false;
  let isHeld = false;
  const does = isGood ? chance.of(['runs', 'runs', 'refused', 'fault']) : chance.of(['runs', 'refused', 'breaks', 'fault']);
  return {
    does,
    breaks: () => does === 'breaks' && chance() < 0.3,
    answer(request) {
      const events = [];
      if (request.do === 'power_on') {
        if (does === 'refused') return { refused: ['no place'] };
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
      if (duration_ms && chance() < 0.3) events.push([now_ms, `SHOW ${chance.below(9)}`, 0]);
      if (duration_ms && chance() < 0.2) events.push([now_ms, `BEEP 440 ${chance.below(900)}`]);
      if (duration_ms && chance() < 0.2) bumps += 1;
      if (now_ms > ends_ms && does === 'fault') fault = 'STUCK';
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
function compared(after, alone) {
  const [a, b] = [JSON.stringify(after), JSON.stringify(alone)];
  let at = 0;
  while (at < a.length && a[at] === b[at]) at += 1;
  const from = Math.max(0, at - AROUND);
  return { after: a.slice(from, at + AROUND), alone: b.slice(from, at + AROUND), isSame: a === b, length: b.length };
}

for (let seed = 0; seed < Number(seeds); seed += 1) {
  const used = await PARTS[part]();
  const first = await used(chanceOf(seed + 1), false);
  await settles();
  const after = await used(chanceOf(seed + 1000), true);
  const alone = await (await PARTS[part]())(chanceOf(seed + 1000), true);
  const found = compared(after.seen, alone.seen);
  console.log(JSON.stringify({ ends: first.ends, ...found, unhandled: unhandled.splice(0) }));
}
