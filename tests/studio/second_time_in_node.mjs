// node second_time_in_node.mjs SOURCES MADE PART SEEDS: a part of the page does one thing, which ends well or badly, and
// then another one; a page that was just loaded does only that. Prints a JSON row for each seed: how the first one has
// ended, and what is seen of the other one, after the first one and by itself.

import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { blocklyInNode } from './blockly_in_node.mjs';
import { chanceOf, chooseFile, compared, freshPage, later, loadTexts, noting, now, PROGRAM, replaceFetch, replaceNavigator, settle, sources, virtualRobot, wait, words } from './page_in_node.mjs';

const [part, seeds] = words;
const unhandled = [];
process.on('unhandledRejection', (error) => unhandled.push(String(error)));

class Broken extends Error {
  constructor(name = 'NetworkError') {
    super('broken');
    this.name = name;
  }
}

const UART_BYTE_MS = 10_000 / 9600; // ten bits

/** Each gives what tells a story, of a page that was just loaded; one that `isGood` loses nothing. */
const PARTS = {
  // A robot by Bluetooth: the same device each time. An HM-10 has room for two writes, and passes bytes on as fast as its UART.
  async bluetooth() {
    replaceNavigator({ bluetooth: {} });
    const page = freshPage();
    const { BluetoothPort } = await page.load('robot/bluetooth.js');
    const device = new EventTarget();
    let fails = () => false;
    let sent = [];
    let isHm10 = false, free_ms = 0; // its UART is free from then on
    const step = async (value) => {
      await later(5);
      if (fails()) throw new Broken();
      return value;
    };
    const way = Object.assign(new EventTarget(), {
      properties: { writeWithoutResponse: true },
      startNotifications: () => step(),
      writeValueWithoutResponse: async (data) => {
        await step();
        for (const byte of data) {
          const begin_ms = Math.max(now(), free_ms);
          if (isHm10 && begin_ms - now() > 40 * UART_BYTE_MS) continue; // no room: it is lost
          free_ms = begin_ms + UART_BYTE_MS;
          sent.push(byte);
        }
      },
    });
    const service = { getCharacteristic: () => step(way) };
    device.gatt = {
      connected: false,
      connect: async () => {
        await step();
        device.gatt.connected = true;
        return { getPrimaryService: async (name) => {
          await step();
          if (isHm10 !== (name === 0xffe0)) throw new Broken('NotFoundError');
          return service;
        } };
      },
      disconnect() {
        device.gatt.connected = false;
        device.dispatchEvent(new Event('gattserverdisconnected'));
      },
    };
    return async (random, isGood) => {
      sent = [];
      const notes = [];
      isHm10 = random() < 0.5;
      fails = () => !isGood && random() < 0.15;
      const port = new BluetoothPort(device, 9600);
      const opened = port.open(() => {}, () => notes.push('gone')).then(() => 'open', (error) => error.reason);
      await wait(100);
      const how = await opened;
      const ends = [how];
      if (how === 'open') {
        const count = 1 + random.below(5);
        const writes = [];
        for (let k = 0; k < count; k += 1) {
          writes.push(new Uint8Array(1 + random.below(50)).fill(k + 1));
          port.write(writes[k]).then(() => notes.push('done'), () => { notes.push('failed'); ends.push('failed'); });
          if (random() < 0.5) await wait(random.below(60));
        }
        await wait(500);
        if (isGood && String(sent) !== String(writes.flatMap((data) => [...data]))) throw new Error(`bytes were lost: ${sent}`);
        fails = () => false;
        sent = isGood ? sent : [];
        port.write(new Uint8Array(4)).then(() => notes.push('stopped'), () => notes.push('not stopped'));
        await wait(100);
        notes.push(...sent);
      }
      port.close().catch(() => notes.push('not closed'));
      await wait(100);
      if (how === 'open' && !notes.includes('stopped')) throw new Error(`a write failed, and so does STOP: ${notes}`);
      return { ends: [...new Set(ends)], seen: [notes, device.gatt.connected] };
    };
  },

  // A port of the browser, as the Web Serial API has it: an error of the line ends its stream, and it has a new one; a port with a
  // locked stream is not closed. Whatever was on the line, all bytes come, a port that has gone says so once, and one that was
  // closed is free.
  async serial() {
    const page = freshPage();
    replaceNavigator({ serial: {} });
    const { SerialPort } = await page.load('robot/serial.js');
    const failure = (name) => new DOMException(name, name);
    class Device {
      isOpen = false;
      isGone = false;
      isStuck = false;
      taken = [];
      signals = [];
      #stream = null;
      #controller = null;
      writable = null;
      get readable() {
        if (!this.isOpen || this.isGone) return null;
        this.#stream ??= new ReadableStream({ start: (controller) => { this.#controller = controller; }, cancel: () => { this.#stream = null; } });
        return this.#stream;
      }
      getInfo() { return {}; }
      async open() {
        await later(5);
        if (this.isOpen) throw failure('InvalidStateError');
        if (this.isGone) throw failure('NetworkError');
        this.isOpen = true;
        const end = () => { this.writable = null; };
        this.writable = new WritableStream({
          close: end,
          abort: end,
          write: async (chunk) => {
            if (this.isGone) throw failure('NetworkError');
            if (this.isStuck) await new Promise(() => {});
            this.taken.push(...chunk);
          },
        });
      }
      give(bytes) { this.#controller.enqueue(new Uint8Array(bytes)); }
      fail(name) {
        this.#stream = null;
        this.#controller.error(failure(name));
      }
      unplug() {
        this.isGone = true;
        this.#stream = null;
        this.#controller.error(failure('NetworkError'));
      }
      async setSignals(signals) {
        await later(1);
        if (!this.isOpen) throw failure('InvalidStateError');
        this.signals.push(signals);
      }
      async close() {
        await later(5);
        if (!this.isOpen) throw failure('InvalidStateError');
        if (this.#stream?.locked || this.writable?.locked) throw new TypeError('a stream is locked');
        this.isOpen = false;
      }
    }
    const device = new Device();
    return async (random, isGood) => {
      device.isGone = device.isStuck = false;
      device.taken = [];
      device.signals = [];
      const lineBytes = [], heardBytes = [], ends = [], written = [];
      let goneCount = 0, settledCount = 0;
      const port = new SerialPort(device, 9600);
      await Promise.all([port.open((bytes) => heardBytes.push(...bytes), () => { goneCount += 1; }), wait(10)]);
      for (let k = random.below(8); k > 0; k -= 1) {
        const act = random.of(isGood ? ['hears', 'writes', 'reset'] : ['hears', 'hears', 'errs', 'errs', 'writes', 'reset', 'goes', 'stuck']);
        if (act === 'hears') {
          const bytes = Array.from({ length: 1 + random.below(5) }, () => random.below(256));
          device.give(bytes);
          lineBytes.push(...bytes);
        } else if (act === 'errs') device.fail(random.of(['FramingError', 'ParityError', 'BreakError', 'BufferOverrunError']));
        else if (act === 'writes') {
          written.push(k);
          port.write(new Uint8Array([k])).catch(() => ends.push('failed')).finally(() => { settledCount += 1; });
        } else if (act === 'reset') port.reset();
        else if (act === 'stuck') device.isStuck = true;
        else device.unplug();
        ends.push(act);
        await wait(act === 'reset' ? 400 : 5);
        if (device.isGone) break;
      }
      if (`${heardBytes}` !== `${lineBytes}`) throw new Error(`${lineBytes} were on the line, and ${heardBytes} are heard`);
      if (goneCount !== Number(device.isGone)) throw new Error(`it is ${device.isGone ? '' : 'not '}gone, which is said ${goneCount} times`);
      if (!device.isStuck && !device.isGone && `${device.taken}` !== `${written}`) throw new Error(`${written} are written, and ${device.taken} taken`);
      if (ends.filter((end) => end === 'reset').length * 2 !== device.signals.length) throw new Error('a board is restarted otherwise than asked');
      const opened = new SerialPort(device, 9600).open(() => {}, () => {}).catch(({ reason }) => reason);
      await wait(4000);
      if (await opened !== 'port_busy') throw new Error(`a port that is open is ${await opened}`);
      if (settledCount !== written.length) throw new Error('a write has no end');
      let isFree = false;
      port.close().then(() => { isFree = true; }, () => {});
      await wait(10_000);
      if (!isFree || device.isOpen) throw new Error(`it was closed after ${ends}, and is not free`);
      if (goneCount !== Number(device.isGone)) throw new Error('who closes it hears that it is gone');
      return { ends, seen: [heardBytes, device.taken, device.signals] };
    };
  },

  // A run of the virtual robot.
  async simulator() {
    const page = freshPage();
    await loadTexts(page);
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
    return async (random, isGood) => {
      notes = [];
      robot = virtualRobot(random, isGood);
      simulator.speed = random.of([0.1, 0.5, 1, 4]);
      simulator.begin(PROGRAM, 'tinibot', 'w', [], random() < 0.3, isGood ? 0 : random.of([0, 20])); // also of a run of a lesson
      await wait(50);
      const setPoints = () => {
        const breakpoints = [random.below(9)], isUnderWay = ['running', 'paused'].includes(simulator.phase);
        const before = notes.length;
        simulator.setBreakpoints(breakpoints);
        if (isUnderWay) checkPoints = async () => {
          for (let k = 0; k < 50 && !simulator.failure && !notes.slice(before).some((note) => note.do === 'breakpoints'); k += 1) await wait(20);
          if (!simulator.failure && `${notes.slice(before).findLast((note) => note.do === 'breakpoints')?.breakpoints}` !== `${breakpoints}`) throw new Error('breakpoints of a run that is under way are not set');
        };
      };
      let checkPoints = async () => {};
      for (let k = random.below(8); k > 0; k -= 1) {
        random.of([() => simulator.pause(), () => simulator.resume(), () => simulator.step(), () => simulator.pressButton(), setPoints, () => {}])();
        await wait(random.below(400));
        await checkPoints();
        checkPoints = async () => {};
      }
      const end = random.of(['stop', 'leave', 'wait']);
      await wait(end === 'wait' ? 4000 : 0);
      simulator.stop();
      if (end === 'leave') simulator.leaveRun();
      await wait(100);
      if (end === 'leave' && (simulator.state || simulator.trace.length || simulator.phase !== 'off')) throw new Error('it was left, and is seen again');
      return { ends: [end, simulator.failure ? 'failure' : simulator.phase], seen: [notes, simulator.phase] };
    };
  },

  // A pupil in a class, and in another one, or again after a teacher has taken them out, until it is over. Whichever looks
  // and answers were lost, the class has the newest of each thing that the teacher sees, and what was pressed last; the page
  // goes to its robot once in a turn, takes what it is given once, and gives its newest run once each time it is asked for.
  // It sees the groups of this class, and stops its group's robot while somebody else drives it, and only then. Each pupil
  // opens what the teacher gives to all once, also the next one at the same page.
  async pupil() {
    const page = freshPage();
    document.documentElement.dataset['class'] = '';
    replaceFetch(async () => { throw new Broken(); });
    replaceNavigator({});
    await loadTexts(page);
    const { Pupil } = await page.load('class/pupil.js');
    const { loadText } = await page.load('page/kept.js');
    const { loadDoneLessons, storeDoneLesson } = await page.load('lesson/progress.js');
    const { pageState } = await page.load('page/page_state.js');
    let room = null;
    replaceFetch((_, { headers, body }) => room.answer(headers['X-TiniScript-Token'], JSON.parse(body)));
    const notes = [];
    const panel = { isFree: true, connectByHost: () => notes.push('to the robot'), endWitness() {} };
    const work = { text: 'F(1)', robot: 'tinibot' };
    let handout = null, openedTexts = []; // what the teacher gives to all, and what of it this pupil's page has opened
    const put = (given) => {
      if (given.text.startsWith('H')) openedTexts.push(given.text);
      else notes.push(['given', given.text]);
      work.text = given.text;
      return true; // nobody is asked outside a group
    };
    const views = { join: () => {}, showMates: () => {}, isBusy: false };
    new Pupil({ panel, work, views, keepProgram: () => true, putProgram: put, clearProgram: () => notes.push('empty'), fetchNewestRunFile: async () => '' });
    const box = page.byId('class_pupil');
    const [join, , buttons] = box.children;
    const [ask, quit, connect] = buttons.children;
    const hand = page.byId('stop').placedBefore, handoutBox = page.byId('class_entry').placedBefore;
    const { dataset } = document.documentElement;
    /** What the teacher sees of it; whether a program is right is not known before it is checked. */
    const shown = () => ({
      text: work.text, robot: work.robot, lessons: [...loadDoneLessons()], own_robot: pageState.ownRobot.value,
      ...(dataset['state'] === 'checked' && { is_right: Boolean(dataset['image']) }),
    });
    let entries = 0;
    return async (random, isGood) => {
      notes.length = 0;
      const began_ms = now();
      const token = `token ${(entries += 1)}`;
      panel.isFree = true;
      [work.text, work.robot, dataset['state'], dataset['image']] = ['F(1)', 'tinibot', 'stale', ''];
      pageState.ownRobot.set({ name: '', colour: 0 });
      window.localStorage.removeItem('tiniscript.lessons');
      const classState = { fields: {}, place: -1, isUp: false };
      let hasOpened = '', isOffered = !isGood;
      openedTexts = [];
      const pressedState = { place: -1, isUp: false };
      let turns = 0;
      let joins = 0;
      let over = '';
      let lateCount = 0; // asked after the class was over
      let isCalm = false; // nothing is lost
      let ends = 'goes on';
      const end = isGood ? 'goes on' : 'removed';
      const returnedWork = isGood && { key: 'one', text: 'given', robot: 'tinibot', lessons: [] };
      room = {
        async answer(by, request) {
          if (request.do === 'join') {
            joins += 1;
            await later(20);
            return responseOf({ token });
          }
          if (by !== token || !by) { // a look of the class before
            if (request.do === 'stop') strayStopCount += 1;
            await later(1);
            return { ok: false, status: 403 };
          }
          if (request.do === 'stop') {
            stops.push(request.group_stops);
            await later(random.below(300));
            if (!isCalm && random() < 0.5) throw new Broken();
            return responseOf({ stops: stops.length });
          }
          if (request.do === 'run') {
            givenRuns.push(request.asked);
            return responseOf({});
          }
          const { opened, ...asked } = request;
          notes.push([now() - began_ms, asked]);
          if (over) lateCount += 1;
          const isOut = ends === 'removed';
          const travel = () => later(isCalm ? 5 : 5 + random.below(900));
          await travel();
          const lost = !isCalm && random() < (isGood ? 0.4 : 0.2) ? random.of(['look', 'answer']) : '';
          if (lost === 'look') throw new Broken();
          if (isOut) return { ok: false, status: 403 };
          if (isOffered && opened === handout?.key) hasOpened = opened;
          const { do: _, took, wants, hand: isUp = classState.isUp, ...fields } = asked;
          Object.assign(classState.fields, fields);
          classState.isUp = isUp;
          const before = classState.place;
          if (wants !== undefined) classState.place = wants ? 0 : -1;
          if (classState.place === 0 && before !== 0) turns += 1;
          const answer = over ? { over } : { ...group, place: classState.place, waiting: 0, robots: 1, robot: '', left_s: 9, name: 'Ana', hand: classState.isUp, ...(returnedWork && !took && { given: returnedWork }), ...(isOffered && handout && hasOpened !== handout.key && { handout }) };
          await travel();
          if (lost) throw new Broken();
          if (!over) [driver, runAsked] = [answer.driver, answer.run];
          return responseOf(answer);
        },
      };
      const group = { groups: [], driver: '', run: '' }; // as the class tells of it
      let driver = '', runAsked = ''; // as the page has heard
      let strayStopCount = 0; // stops that no class has
      const stops = [], givenRuns = [];
      const pressStop = async () => {
        const before = stops.length + strayStopCount, isDriven = driver !== '' && !over && ends === 'goes on';
        page.byId('stop').click();
        await settle();
        if (stops.length + strayStopCount - before !== Number(isDriven)) throw new Error(`${stops.length + strayStopCount - before} stops are sent, and ${driver || 'nobody'} drives`);
      };
      const changes = {
        write: () => { work.text = `F(${random.below(2)})`; },
        robot: () => { work.robot = random.of(['tinibot', 'liner']); },
        lesson: () => storeDoneLesson(`lesson${random.below(9)}`),
        ownRobot: () => pageState.ownRobot.set({ name: '', colour: random.below(2) }),
        check: () => { [dataset['state'], dataset['image']] = [random.of(['stale', 'checked']), random.of(['', '00'])]; },
      };
      const handOut = () => { handout = { key: `key ${(entries += 1)}`, lesson: 0, text: `H(${entries})`, robot: 'tinibot' }; };
      const presses = {
        ...changes,
        ask: () => { pressedState.place = 0; ask.click(); },
        quit: () => { pressedState.place = -1; quit.click(); },
        hand: () => { pressedState.isUp = hand.attributes['aria-pressed'] !== 'true'; hand.click(); },
        groups: () => { group.groups = ['red', 'tan'].slice(random.below(3)).map((name) => ({ name, members: ['Luz', 'Teo'].slice(random.below(3)) })); },
        drive: () => { group.driver = random.of(['', 'Luz']); },
        run: () => { group.run = `run ${(entries += 1)}`; },
        stop: pressStop,
        ...(!isGood && {
          handOut,
          open: () => { if (!handoutBox.hidden) handoutBox.children[1].click(); },
        }),
        nothing: () => {},
      };
      for (let k = random.of([1, 2]); k > 0; k -= 1) join.dispatchEvent(new Event('submit', { cancelable: true }));
      await wait(30);
      if (joins > 1) throw new Error(`who presses twice is ${joins} pupils`);
      if (hand.hidden) throw new Error('in a class nobody can ask for help');
      if (isGood && random() < 0.5) presses.hand(); // before the class has said how it is
      await wait(500);
      for (let k = 1 + random.below(12); k > 0; k -= 1) {
        await presses[random.of(Object.keys(presses))]();
        await wait(random.of([2, random.below(1500)]));
      }
      if (!isGood && random() < 0.7) random.of([ask, quit, hand]).click(); // whose answer may come after the end
      ends = end;
      for (let k = random.below(isGood ? 1 : 4); k > 0; k -= 1) random.of([ask, quit, hand]).click();
      while (!isGood && join.hidden) await wait(50 + random.below(50));
      if (!isGood) {
        if (![hand, ask, quit, connect, handoutBox, page.byId('side_class')].every(({ hidden }) => hidden)) throw new Error('outside of a class there are its buttons');
        await pressStop();
      }
      if (new Set(openedTexts).size < openedTexts.length) throw new Error(`${openedTexts} are opened`);
      if (!isGood) return { ends: [ends], seen: [] };
      for (let k = random.below(3); k > 0; k -= 1) { // while the one before is on its way
        changes[random.of(Object.keys(changes))]();
        await wait(2);
      }
      isCalm = true;
      panel.isFree = random() < 0.5;
      await wait(6000);
      const seen = notes.map((item) => structuredClone(item));
      const countNotes = (note) => notes.filter((item) => item === note || item[0] === note).length;
      for (const [name, value] of Object.entries(shown())) {
        if (JSON.stringify(classState.fields[name]) !== JSON.stringify(value)) throw new Error(`the teacher sees ${name} ${JSON.stringify(classState.fields[name])}, and it is ${JSON.stringify(value)}`);
      }
      if (classState.place !== pressedState.place || classState.isUp !== pressedState.isUp) throw new Error(`not what was pressed last: ${JSON.stringify([classState, pressedState])}`);
      if (countNotes('to the robot') > turns || countNotes('given') > 1) throw new Error(`${countNotes('to the robot')} times to the robot in ${turns} turns, given ${countNotes('given')} times`);
      await pressStop();
      const listed = page.byId('class').children[0].children[2].children.map(({ children: [name] }) => name);
      const wantedGroups = group.groups.map(({ name, members }) => (members.length ? `${name} (${members.join(', ')})` : name));
      if (page.byId('side_class').hidden || `${listed}` !== `${wantedGroups}`) throw new Error(`the groups ${listed} are seen in place of ${wantedGroups}`);
      if (runAsked && givenRuns.filter((item) => item === runAsked).length !== 1) throw new Error(`${runAsked} is given ${givenRuns.filter((item) => item === runAsked).length} times`);
      if (stops.some((number, k) => number < stops[k - 1])) throw new Error(`stops are counted ${stops}`);
      if (connect.hidden !== (classState.place !== 0 || !panel.isFree)) throw new Error('who cannot connect may, or who can may not');
      seen.push([document.documentElement.dataset['pupil'], join.hidden, hand.attributes]);
      if (random() < 0.3 || !handout) handOut();
      isOffered = true; // also what the pupil before at this page has opened
      await wait(2500);
      if (handoutBox.hidden) throw new Error('a pupil misses what the teacher gives to all');
      isCalm = false;
      for (let k = 40; k > 0; k -= 1) { // whoever sees it presses it
        if (k > 38 || !handoutBox.hidden) handoutBox.children[1].click();
        await wait(100);
      }
      isCalm = true;
      await wait(2500);
      if (`${openedTexts}` !== handout.text || hasOpened !== handout.key || !handoutBox.hidden) throw new Error(`${openedTexts} is opened, and the class knows of ${hasOpened}`);
      over = random.of(['', 'kept', 'erased']);
      await wait(5000);
      if (over && (!join.hidden || lateCount > 1 || loadText('tiniscript.pupil', 'sessionStorage'))) throw new Error(`it is over, and goes on: ${lateCount}`);
      if (countNotes('empty') !== Number(over === 'erased') || Boolean(loadText('tiniscript.pupil_before')) !== (over !== 'erased')) throw new Error(`${over}: ${countNotes('empty')} ${loadText('tiniscript.pupil_before')}`);
      return { ends: [ends], seen: [seen, document.documentElement.dataset['pupil']] };
    };
  },

  // Work that is given back is at every moment in the teacher's list, on the pupil's screen or in My programs: whatever the
  // pupil answers, whoever writes over it, in a group or not, when looks and answers are lost, the page is loaded again or
  // the browser has no room. A page asks once; what it puts on the screen goes only when somebody takes it away; and the
  // teacher sees what is on the screen.
  async returning() {
    replaceNavigator({});
    const { EditorState } = await import(pathToFileURL(`${sources}/../node_modules/@codemirror/state/dist/index.js`).href);
    let entries = 0;
    return async (random, isGood) => {
      const ends = new Set();
      const teacherList = new Set(); // the teacher's list
      const givenTexts = []; // all that was ever given, each its text
      const knownFields = {}; // what the class knows of the page
      let screen = 'F(1)', groupText = 'G(1)';
      let isCalm = false; // nothing is lost
      let pageRequests = []; // by the page that is loaded
      let shownWork = ''; // given work that nobody has taken off the screen
      let noticeKey = ''; // what the page is to say
      let page, work, loadVersions, textOf;
      const checkLaw = (when) => {
        const places = loadVersions().map(({ text }) => text);
        for (const text of givenTexts) if (!teacherList.has(text) && screen !== text && !places.includes(text)) throw new Error(`${when}: ${text} is nowhere`);
        if (shownWork && screen !== shownWork) throw new Error(`${when}: ${shownWork} has gone off the screen by itself`);
        if (new Set(pageRequests).size !== pageRequests.length) throw new Error(`${when}: the page asks again: ${pageRequests}`);
        if (page.byId('note').textContent !== (noticeKey && textOf(noticeKey))) throw new Error(`${when}: the page says ${page.byId('note').textContent}, and not ${noticeKey}`);
      };
      const put = (text) => {
        shownWork = '';
        screen = text;
        if (document.documentElement.dataset['group']) groupText = text;
      };
      const load = async (stores) => {
        page = freshPage({ generate: () => ({ toCanvas() {} }), correction: {} });
        for (const [name, pairs] of Object.entries(stores)) for (const [key, value] of pairs) window[name].setItem(key, value);
        Object.assign(document.documentElement.dataset, { class: '', state: 'stale', image: '' });
        delete document.documentElement.dataset['group'];
        replaceFetch(async () => { throw new Broken(); });
        await loadTexts(page);
        pageRequests = [];
        shownWork = noticeKey = '';
        replaceFetch((_, { body }) => handle(JSON.parse(body)));
        const { Pupil } = await page.load('class/pupil.js');
        const { Programs } = await page.load('programs/programs.js');
        ({ loadVersions } = await page.load('programs/versions.js'));
        ({ text: textOf } = await page.load('page/texts.js'));
        work = { get text() { return screen; }, robot: 'tinibot', name: '' };
        const view = { state: EditorState.create(), dispatch() {} };
        const python = {
          async ask({ do: action }) {
            await later(random.below(400));
            if (action === 'group_begin') screen = groupText; // in place of whatever is there
            return { version: 1, changes: [], ids: [], drafts: [], pending: [], since: 0, epoch: '', told: 0, why: '', count: 0, kept: { name: 'page' } };
          },
        };
        const programs = new Programs({ python, work, putProgram: ({ text }) => { put(text); shownWork = text; noticeKey = 'class_given'; }, makePicture() {} });
        globalThis.confirm = () => {
          checkLaw('while it asks');
          pageRequests.push([...teacherList][0]);
          const isYes = random() < 0.5;
          if (!isYes && window.localStorage.room) noticeKey = 'class_given_kept';
          ends.add(isYes ? 'yes' : 'no');
          return isYes;
        };
        new Pupil({
          panel: { isFree: true, connectByHost() {}, endWitness() {}, onGroupEvent() {} }, work, python,
          editor: { setUndoHandler() {}, extend: () => view },
          views: { isBusy: false, showMates() {}, join() {} },
          keepProgram: () => programs.storeVersion(), putProgram: (program) => programs.replaceProgram({ ...program, name: '' }),
          clearProgram() {}, fetchNewestRunFile: async () => '',
        });
        const [join] = page.byId('class_pupil').children;
        for (let k = 0; !join.hidden && k < 50; k += 1) { // one may be lost
          join.dispatchEvent(new Event('submit', { cancelable: true }));
          await wait(random.below(2500));
        }
      };
      const travel = () => later(isCalm ? 5 : 5 + random.below(900));
      const handle = async (request) => {
        if (request.do === 'group') {
          await later(400);
          return responseOf({ saw: 1, ran: ['class', 1], runs: [], others: [], changes: [] });
        }
        await travel();
        const lost = !isCalm && random() < 0.25 ? random.of(['look', 'answer']) : '';
        if (lost) ends.add('lost');
        if (lost === 'look') throw new Broken();
        let answer = { token: 'token' };
        if (request.do === 'group_join') answer = { group: 'red' };
        if (request.do === 'here') {
          const { do: _, took, ...fields } = request;
          Object.assign(knownFields, fields);
          if (took && teacherList.has(took.key)) {
            teacherList.delete(took.key);
            knownFields.text = took.text;
            checkLaw('the class has forgotten it');
          }
          const [current] = teacherList;
          answer = { groups: [{ name: 'red', members: [] }], driver: '', place: -1, waiting: 0, robots: 0, robot: '', left_s: 0, name: 'Ana', hand: false, ...(current && { given: { key: current, text: current, robot: 'tinibot', lessons: [] } }) };
        }
        await travel();
        if (lost) throw new Broken();
        return responseOf(answer);
      };
      const box = () => page.byId('class').children[0];
      const actions = {
        give: () => {
          const text = `W(${(entries += 1)})`;
          givenTexts.push(text);
          teacherList.add(text);
        },
        join: () => {
          shownWork = '';
          box().children[1].dispatchEvent(new Event('submit', { cancelable: true }));
        },
        leave: () => box().children[5].click(),
        mate: () => { if (document.documentElement.dataset['group']) put(`M(${(entries += 1)})`); },
        write: () => put(`F(${(entries += 1)})`),
        full: () => { window.localStorage.room = random.of([0, Infinity]); },
        reload: () => load({ sessionStorage: [...window.sessionStorage], localStorage: [...window.localStorage] }),
      };
      await load({ sessionStorage: [], localStorage: [] });
      for (let k = isGood ? 4 : 4 + random.below(16); k > 0; k -= 1) {
        const act = random.of(['give', ...Object.keys(actions)]);
        ends.add(act);
        await actions[act]();
        checkLaw(act);
        for (let step = random.of([0, 1, 1, 3, 12]); step > 0; step -= 1) {
          await wait(random.below(300));
          checkLaw(act);
        }
      }
      isCalm = true;
      window.localStorage.room = Infinity;
      await wait(3000 + 2000 * givenTexts.length);
      checkLaw('at the end');
      if (teacherList.size) throw new Error(`${[...teacherList]} are not taken`);
      if (knownFields.text !== screen) throw new Error(`the teacher sees ${knownFields.text}, and it is ${screen}`);
      return { ends: [...ends], seen: [] };
    };
  },

  // Pictures of pupils' programs.
  async pictures() {
    let story = null;
    let drawing = 0, maxDrawing = 0; // at once
    class Blocks {
      constructor() { if (story.breaks()) throw new Broken(); }
      updateLanguage() {}
      async makeFormPicture(form) {
        maxDrawing = Math.max(maxDrawing, (drawing += 1));
        await later(20);
        drawing -= 1;
        if (story.breaks()) throw new Broken();
        return form.text;
      }
    }
    const page = freshPage({ Blocks });
    await loadTexts(page);
    URL.createObjectURL = (text) => `picture of ${text}`;
    const { Pictures } = await page.load('blocks/drawn.js');
    const python = {
      get ready() { return story.breaks() ? Promise.reject(new Broken()) : Promise.resolve(); },
      async ask(request, data) {
        await later(10);
        if (story.breaks()) throw new Broken();
        return { text: new TextDecoder().decode(data) };
      },
    };
    const pictures = new Pictures(python, 'class_blocks');
    let stories = 0;
    return async (random, isGood) => {
      story = { breaks: () => !isGood && random() < 0.3 };
      stories += 1;
      const came = {};
      const began_ms = now();
      const ends = [];
      const count = 1 + random.below(6);
      for (let k = 0; k < count; k += 1) {
        const owner = random.below(4);
        const text = isGood || random() < 0.9 ? `program ${k}` : '';
        pictures.request(`${stories} ${owner}`, { text, robot: 'tinibot' }, (address) => {
          came[owner] = [address, now() - began_ms];
          ends.push(address ? 'made' : 'none');
        });
        if (!isGood && random() < 0.1) pictures.forget(`${stories} ${owner}`);
        await wait(random.below(300));
      }
      await wait(8000);
      if (maxDrawing > 1) throw new Error(`${maxDrawing} pictures are made at once, for which a STOP waits`);
      return { ends: [...new Set(ends)], seen: came };
    };
  },

  // The panel of the virtual robot; its pictures and sounds are noted.
  async panel() {
    globalThis.getComputedStyle = () => ({ getPropertyValue: (name) => name });
    let notes = [];
    const shapes = { start: { x_cm: 0, y_cm: 0 }, flags: [], rivals: [], rings: [], seconds: 0, name: 'w' };
    class Choice { shownWorld = shapes; goals = []; request = 'w'; async restoreOwn() { return true; } }
    class Drawing { notice = ''; enable() {} reset() {} cancelDrag() {} end() {} }
    const notingClass = (name) => function made() { return noting(notes, name); };
    const beginning = (name) => function made() { // what is drawn is what came since it has begun
      let count = 0;
      return new Proxy(this, { get: (_, property) => (...args) => {
        count = property === 'begin' || property === 'clear' ? 0 : count + 1;
        notes.push([name, property, count, ...args]);
      } });
    };
    const page = freshPage({
      Arena: beginning('arena'), Plot: beginning('plot'), RunAnnouncer: notingClass('announcer'), Sounds: notingClass('sounds'),
      starsText: String, boutEndText: String, bumpSentence: String, WorldChoice: Choice, WorldDrawing: Drawing, replaceOptions() {}, makePictureOption() {}, makeDialPicture() {},
    });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { SimulatorPanel } = await page.load('virtual/simulator_panel.js');
    pageState.robotName.set('tinibot');
    pageState.checkResult.set(PROGRAM);
    let robot = null;
    let isSeen = false; // what runs is what is seen
    let offsetsOf = new Map(); // where what runs stops, by each breakpoint
    let sentBreakpoints = [];
    const stopAt = (points) => {
      offsetsOf = new Map(points.map(({ point, line }) => [point, isSeen ? (line === 1 ? [0] : []) : offsetsOf.get(point) ?? []]));
    };
    const setPoints = (points) => {
      stopAt(points);
      pageState.breakpoints.set(points);
    };
    const type = (text) => { // breakpoints go with their lines
      pageState.programText.set(text);
      isSeen = false;
      setPoints(pageState.breakpoints.value.map((item) => ({ ...item, line: item.line + 1 })));
    };
    const checkPoints = () => {
      const expected = [...new Set([...offsetsOf.values()].flat())];
      if (['running', 'paused'].includes(document.documentElement.dataset['phase']) && `${sentBreakpoints}` !== `${expected}`) throw new Error(`what runs stops at ${sentBreakpoints} in place of ${expected}`);
    };
    const python = {
      async ask(request) {
        if (request.do === 'speak') return {}; // which a page asks once
        if (request.do === 'power_on') {
          isSeen = true;
          offsetsOf = new Map();
          stopAt(pageState.breakpoints.value);
        }
        if ('breakpoints' in request) sentBreakpoints = request.breakpoints;
        notes.push(['python', { ...request }]);
        await later(0); // so that a run has the same pictures, whatever it stops
        if (robot.breaks()) throw new Broken();
        return robot.answer(request);
      },
    };
    robot = virtualRobot(chanceOf(1), true);
    new SimulatorPanel({ python, work: { world: 'w', sound: true }, whenChecked: async () => PROGRAM, storeCurrentWork() {}, pad: { offerRobot: (side, driven) => notes.push(['pad', side, driven?.remoteWords ?? null]) } });
    await settle();
    const line = page.byId('time_at');
    const marked = [];
    Object.assign(page.byId('time_marks'), { clientWidth: 200, clientHeight: 20, getContext: () => ({ fillRect: (x) => marked.push(x) }) });
    const observe = () => [line.disabled || [line.min, line.max, line.value], page.byId('doing').textContent, page.byId('trace').textContent, page.byId('values').children.map((row) => row.children.map((item) => item.textContent)), structuredClone(pageState.fault.value)];
    return async (random, isGood) => {
      notes.splice(0);
      robot = virtualRobot(random, isGood);
      type('F(9)');
      setPoints(random.of([[], [{ line: 1, column: 1, point: {} }]]));
      page.byId('run').click();
      if (!isGood && robot.outcome === 'runs' && random() < 0.2) page.byId('run').click(); // twice
      for (let k = random.below(6); k > 0; k -= 1) {
        await wait(100 + random.below(300));
        marked.length = 0;
        notes.push(observe());
        if (random() < 0.3) {
          setPoints(random.of([[], [{ line: 1, column: 1, point: {} }], [...pageState.breakpoints.value, { line: 1, column: 1, point: {} }]]));
          await wait(50);
          checkPoints();
        }
        if (random() < 0.2) {
          type(`F(${random.below(9)})`);
          await wait(200);
          checkPoints();
          if (pageState.virtualRun.value.ranges.length) throw new Error('it runs in another text');
        }
        notes.push([...marked]);
        const pressed = page.byId(random.of(['pause', 'step', 'push', 'time_at', 'nothing']));
        if (pressed === line && !line.disabled) {
          line.value = String(random.below(3000));
          line.dispatchEvent(new Event('input'));
          notes.push(observe());
        } else if (!pressed.hidden && !pressed.disabled) pressed.click();
      }
      const end = random.of(['stop', 'wait', 'again', 'again']); // again: while it runs
      if (end === 'again') await wait(random.below(40));
      if (end === 'wait' || isGood) await wait(4000);
      if (end === 'stop' || isGood) page.byId('stop').click();
      if (end !== 'again' || isGood) await wait(50);
      notes.push(observe());
      return { ends: [end === 'again' ? document.documentElement.dataset['phase'] : end, robot.outcome], seen: notes.slice(notes.findLastIndex(([name, what]) => name === 'sounds' && what === 'begin')) };
    };
  },

  // What is heard of runs: each tone after the one before, unless that is late; nothing after a silence and nothing that is
  // muted. The computer's sound is open as long as something sounds, and a while longer.
  async sounds() {
    const heard = [];
    let hasDevice = true, context = null;
    const level = { setValueAtTime() {}, linearRampToValueAtTime() {}, exponentialRampToValueAtTime() {} };
    class Context {
      constructor() {
        if (!hasDevice) throw new Broken();
        context = this;
      }
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
          if (note.hasEnded) return;
          note.ends_ms = Math.round(1000 * at_s);
          const ended_ms = note.ends_ms;
          setTimeout(() => {
            if (note.hasEnded || note.ends_ms !== ended_ms) return;
            note.hasEnded = true;
            tone.dispatchEvent(new Event('ended'));
          }, ended_ms - now());
        };
        heard.push(note);
        return tone;
      }
    }
    const page = freshPage();
    const activation = { hasBeenActive: true };
    replaceNavigator({ userActivation: activation });
    Object.assign(window, { AudioContext: Context });
    globalThis.AudioContext = Context;
    const { Sounds } = await page.load('virtual/sounds.js');
    const LATE_MS = 500, OPEN_MS = 3000, MIN_MS = 10, CRASH_MS = 180;
    return async (random) => {
      const sounds = new Sounds();
      heard.length = 0;
      [context, hasDevice] = [null, true];
      const wanted = []; // when each begins and ends, and how high it is
      let isMuted = false, last_ms = 0, open_ms = -1; // until when it is open without a tone
      const open = () => {
        if (isMuted || !activation.hasBeenActive || (!context && !hasDevice)) return false;
        open_ms = 0;
        return true;
      };
      const beep = (hertz, duration_ms) => {
        const begins_ms = Math.max(now(), last_ms);
        if (!open() || begins_ms - now() > LATE_MS) return;
        last_ms = begins_ms + duration_ms;
        wanted.push([begins_ms, begins_ms + Math.max(MIN_MS, duration_ms), Math.max(20, Math.min(16_000, hertz))]);
      };
      const silence = () => {
        for (const item of wanted) item[1] = Math.min(item[1], now());
        last_ms = 0;
      };
      const actions = {
        begin() {
          silence();
          if (open()) open_ms = now() + OPEN_MS;
          sounds.begin();
        },
        beep() {
          const hertz = random.of([5, 440, 550, 20_000]), duration_ms = random.of([1, 50, 300, 2000, 20_000]);
          beep(hertz, duration_ms);
          sounds.beep(hertz, duration_ms / 1000);
        },
        crash() {
          if (open()) wanted.push([now(), now() + CRASH_MS, 0]);
          sounds.crash();
        },
        cheer() {
          silence();
          for (const hertz of [523, 659, 784, 1047]) beep(hertz, 120);
          sounds.cheer();
        },
        silence() {
          silence();
          sounds.silence();
        },
        mute() {
          isMuted = random() < 0.6;
          if (isMuted) silence();
          sounds.setMuted(isMuted);
        },
        touch: () => { activation.hasBeenActive = random() < 0.8; },
        device: () => { hasDevice = random() < 0.7; },
        wait: () => {},
      };
      const ends = new Set();
      for (let k = 4 + random.below(16); k > 0; k -= 1) {
        const act = random.of(['beep', 'beep', ...Object.keys(actions)]);
        ends.add(act);
        actions[act]();
        const check = () => {
          const beeps = heard.map((item) => [item.begins_ms, item.ends_ms, item.tone.frequency.value ?? 0]);
          if (JSON.stringify(beeps) !== JSON.stringify(wanted)) throw new Error(`after ${act} ${JSON.stringify(beeps)} is heard in place of ${JSON.stringify(wanted)}`);
          const until_ms = Math.max(open_ms, ...wanted.map(([, end_ms]) => end_ms + OPEN_MS));
          if (context && context.state !== (until_ms > now() ? 'running' : 'suspended')) throw new Error(`after ${act} the sound is ${context.state} until ${until_ms} at ${now()}`);
        };
        check();
        await wait(random.of([0, 20, 250, 2990, 3010, 9000]) + random.below(9));
        check();
      }
      activation.hasBeenActive = true;
      return { ends: [...ends], seen: [] };
    };
  },

  // What is said of a STOP: of this page, or of somebody else, after which something is started.
  async stopping() {
    const page = freshPage();
    await loadTexts(page);
    const { StopNotice } = await page.load('robot/stopping.js');
    const { LINK } = await page.load('page/words.js');
    let notes = [];
    let began_ms = 0;
    const speech = { isHeldByStop: false, say: (key) => notes.push([now() - began_ms, key, speech.isHeldByStop]) };
    const stopping = new StopNotice(speech);
    const actions = {
      stop: () => stopping.begin(),
      hide: () => stopping.begin('say_file'),
      confirm: () => stopping.confirm('BUTTON'),
      start: () => stopping.forget(),
      nothing: () => {},
    };
    return async (random, isGood) => {
      notes = [];
      began_ms = now();
      for (let k = 1 + random.below(4); k > 0; k -= 1) {
        actions[random.of(Object.keys(actions))]();
        await wait(random.below(random.of([LINK.confirm_ms / 2, 2 * LINK.confirm_ms])));
      }
      const end = random.of(isGood ? ['none', 'confirm'] : ['confirm', 'over']);
      if (end === 'confirm') stopping.confirm('SEQUENCE');
      if (end === 'over') notes.push(stopping.end()());
      if (isGood) await wait(2 * LINK.confirm_ms);
      const seen = [notes, stopping.isOpen, speech.isHeldByStop];
      stopping.forget(); // something is started
      return { ends: [end], seen };
    };
  },

  // A firmware onto one board after another.
  async flashing() {
    let notes = [];
    let fails = () => '';
    const attempt = async (stage, value) => {
      await later(10);
      if (fails(stage)) throw new Broken('Error');
      return value;
    };
    const page = freshPage({
      hasSerial: true,
      choosePort: () => attempt('port', 'port'),
      fetchFirmwareList: async () => [{ board: 'uno' }],
      loadFirmware: (which, board) => {
        notes.push([which.name ?? structuredClone(which), board, page.byId('flash_progress').value]);
        return attempt('firmware', 'data');
      },
      flashBoard: async (port, board, data, progress, signal) => {
        progress(0.5);
        notes.push(page.byId('flash_progress').value);
        await later(50);
        if (signal.aborted) throw new Broken('AbortError');
        return attempt('flash');
      },
    });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Flashing } = await page.load('robot/flashing.js');
    const speech = { say: (key) => notes.push(key), sayFailure: (failure) => notes.push(failure.reason) };
    let isFree = true;
    new Flashing({ speech, getChosenPort: () => null, isFree: () => isFree, setBusy: (isBusy) => { isFree = !isBusy; }, connect: () => attempt('meet') });
    return async (random, isGood) => {
      notes = [];
      const end = isGood ? 'good' : random.of(['good', 'port', 'firmware', 'flash', 'meet', 'cancel']);
      fails = (stage) => stage === end;
      pageState.robotName.set(isGood ? 'liner' : 'tinibot');
      page.byId('flash_board').value = 'uno';
      const chooser = page.byId('flash_file');
      if (!isGood) {
        Object.assign(chooser, { value: 'C:\\own.hex', files: [{ name: 'own.hex' }] });
        chooser.dispatchEvent(new Event('change'));
      }
      page.byId('flash_write').click();
      if (random() < 0.3) page.byId('flash_write').click();
      await wait(end === 'cancel' ? 40 : 300);
      if (end === 'cancel') page.byId('flash_cancel').click();
      await wait(200);
      return { ends: [end], seen: [notes, isFree, chooser.value, page.byId('flash_progress').hidden, page.byId('flash_cancel').hidden] };
    };
  },

  // The worker, which gets what it needs when it is asked for it, over a connection that may fail: each ask has one answer, an
  // error only where something of it was lost meanwhile. Python is asked in the language that it has learnt, and after what
  // it needs is there; nothing that is there is fetched again.
  async worker() {
    const SOURCE = 'en', NEEDS = { lesson_list: 'lessons.zip', group_join: 'together.zip' };
    let pages = 0;
    return async (random) => {
      const number = (pages += 1);
      const loadedFiles = new Set(), learntLanguages = new Set(); // what Python has
      const fetchCounts = new Map(), losses = []; // what is fetched, how often; what was lost, and when
      const posted = new Map(), reached = new Map(), requestsById = new Map();
      let wrong = '', ready = '';
      const fail = (message) => { wrong ||= message; };
      const first = random() < 0.8 ? '' : random.of(['tiniscript.zip', 'messages.en.json', 'messages.es.json', 'pyodide']);
      let loses = (name) => name === first;
      const page = freshPage({
        loadPyodide: async () => {
          if (first === 'pyodide') throw new Broken();
          return {
            FS: { mkdirTree() {} },
            unpackArchive(data) {
              if (data.name.startsWith('not ')) fail(`${data.name} is unpacked`);
              loadedFiles.add(data.name);
            },
            runPython: () => (text) => {
              const { do: what, language, id } = JSON.parse(text);
              if (what === 'learn') return learntLanguages.add(language);
              const before = requestsById.get(id);
              if (NEEDS[what] && !loadedFiles.has(NEEDS[what])) fail(`${what} comes before ${NEEDS[what]}`);
              const isLearnt = learntLanguages.has(before.language);
              if (what.startsWith('lesson') && !isLearnt && before.isUnder && !losses.some(({ name, at }) => name === before.messages && at >= before.at)) fail(`${what} does not wait for its language`);
              if (language !== (isLearnt ? before.language : SOURCE)) fail(`${what} is asked in ${language}, and not in ${before.language}`);
              reached.set(id, true);
              return JSON.stringify({ id });
            },
          };
        },
      });
      globalThis.postMessage = ({ id, answer, error, waits, begun }) => {
        if (waits || begun) return;
        if (id === 0) {
          if (!losses.length || ready === '') ready = error ? 'failed' : 'ready';
          return;
        }
        if (posted.has(id)) fail('it is answered twice');
        posted.set(id, error ? 'error' : 'answer');
        const { what, language, at, messages } = requestsById.get(id);
        const needs = what === 'learn' ? messages : NEEDS[what];
        if (error && !losses.some((item) => item.name === needs && item.at >= at) && ready !== 'failed') fail(`${what} fails: ${error}`);
        if (!error && what !== 'learn' && (!reached.has(id) || JSON.parse(answer).id !== id)) fail(`${what} is answered, and was not done`);
        if (!error && what === 'learn' && !learntLanguages.has(language)) fail(`${language} is learnt, and is not there`);
      };
      globalThis.name = random.of(['', 'en', 'es']);
      replaceFetch(async (address) => {
        const name = String(address).replace('./', '');
        if (name.endsWith('.zip') && (loadedFiles.has(name) || fetchCounts.get(name))) fail(`${name} is fetched again`);
        if (learntLanguages.has(name.split('.')[1])) fail(`${name} is fetched again`);
        fetchCounts.set(name, (fetchCounts.get(name) ?? 0) + 1);
        const isLost = loses(name);
        await later(ready ? 5 + random.below(random.of([20, 400])) : name.endsWith('.zip') ? 10 : 20);
        fetchCounts.set(name, fetchCounts.get(name) - 1);
        if (isLost) losses.push({ name, at: now() });
        if (isLost && random() < 0.5) throw new Broken();
        return { ok: !isLost, status: isLost ? 503 : 200, body: null, arrayBuffer: async () => Object.assign(new ArrayBuffer(1), { name: isLost ? `not ${name}` : name }) };
      });
      await page.load('worker.js');
      await wait(30);
      const isBroken = first !== '' && first !== 'messages.es.json';
      if (ready !== (isBroken ? 'failed' : 'ready')) throw new Error(`without ${first} it is ${ready}`);
      loses = () => random() < 0.3;
      let count = 0;
      for (let k = 2 + random.below(8); k > 0; k -= 1) {
        const what = random.of(['check', 'learn', 'learn', 'lesson_list', ...Object.keys(NEEDS)]), language = random.of(['es', 'pt', 'en']);
        const id = (count += 1), messages = `messages.${language}.json`;
        requestsById.set(id, { what, language, messages, at: now(), isUnder: fetchCounts.get(messages) > 0 });
        dispatchEvent(Object.assign(new Event('message'), { data: { id, request: JSON.stringify({ do: what, language, id }) } }));
        await wait(random.of([0, 5, 50, 200]));
      }
      await wait(500);
      if (wrong) throw new Error(`page ${number}: ${wrong}`);
      if (posted.size !== count) throw new Error(`${count} are asked, and ${posted.size} answered`);
      return { ends: [isBroken ? 'none' : [...posted.values()].includes('error') ? 'failed' : 'good'], seen: [] };
    };
  },

  // Python comes over a slow line, and its module last: it is ready as long as something has come within the last 20 s.
  async loading() {
    const TIMEOUT_MS = 20_000, FILES = ['tiniscript.zip', 'messages.en.json', 'pyodide.asm.wasm', 'python.zip'];
    return async (random) => {
      const pieces = new Map(FILES.map((name) => [name, Array.from({ length: 1 + random.below(5) }, () => 100 + random.below(TIMEOUT_MS - 200))]));
      const lastPiece_ms = Math.max(...[...pieces.values()].map((gaps) => gaps.reduce((sum, gap) => sum + gap)));
      const module_ms = random() < 0.3 ? random.below(lastPiece_ms) : lastPiece_ms + random.below(2 * TIMEOUT_MS);
      let state = '';
      globalThis.postMessage = ({ waits, begun, error }) => {
        if (!waits && !begun) state ||= error ? 'silent' : 'ready';
      };
      globalThis.name = 'en';
      replaceFetch(async (address) => new Response(new ReadableStream({
        async start(controller) {
          for (const gap of pieces.get(String(address).split('/').at(-1))) {
            await later(gap);
            controller.enqueue(new Uint8Array(1));
          }
          controller.close();
        },
      })));
      const page = freshPage({
        loadModule: () => later(module_ms),
        loadPyodide: async () => {
          for (const response of await Promise.all(['./pyodide.asm.wasm', './python.zip'].map((name) => globalThis.fetch(name)))) await response.arrayBuffer();
          return { FS: { mkdirTree() {} }, unpackArchive() {}, runPython: () => () => '{}' };
        },
      });
      await page.load('worker.js');
      await wait(lastPiece_ms + 4 * TIMEOUT_MS);
      const wanted = module_ms < lastPiece_ms + TIMEOUT_MS ? 'ready' : 'silent';
      if (state !== wanted) throw new Error(`${state || 'nothing'} in place of ${wanted}: ${JSON.stringify([[...pieces], module_ms])}`);
      return { ends: [wanted], seen: [] };
    };
  },

  // What is fetched: each piece is told, that nothing comes is told once, and that not all will come to whom it concerns. It
  // ends 20 s after the last piece, or sooner, and then nothing is told of it any more.
  async fetching() {
    const page = freshPage();
    const { watchedFetch } = await page.load('page/progress.js');
    const NOTICE_MS = 3000, TIMEOUT_MS = 20_000;
    return async (random) => {
      const began_ms = now(), reports = [];
      const tell = (what) => reports.push([Math.round(now() - began_ms), what]);
      const cancelling = new AbortController();
      const gap = () => 7 * (random.of([1, 1, 70, 70, 410, 440, 1000, 2700, 3000]) + random.below(12)); // neither limit at the same time
      const outcome = random.of(['whole', 'whole', 'broken', 'broken', 'refused', 'lost']);
      const answer_ms = gap(), gaps = Array.from({ length: random.below(5) }, gap), end_ms = gap();
      const cancel_ms = random() < 0.4 ? 7 * random.below(random.of([400, 6000])) + 3 : Infinity;
      if (cancel_ms < Infinity) later(cancel_ms).then(() => cancelling.abort(new Broken('cancelled')));
      const fetcher = (_, { signal }) => new Promise((resolve, reject) => {
        signal.addEventListener('abort', () => reject(signal.reason));
        later(answer_ms).then(async () => {
          if (outcome === 'lost') reject(new Broken());
          if (outcome === 'refused') resolve(new Response('why', { status: 503 }));
          let pieces;
          resolve(new Response(new ReadableStream({ start(controller) { pieces = controller; } })));
          let isOver = false;
          signal.addEventListener('abort', () => { isOver = true; pieces.error(signal.reason); });
          for (const ms of gaps) {
            await later(ms);
            if (!isOver) pieces.enqueue(new TextEncoder().encode('x'));
          }
          await later(end_ms);
          if (!isOver) outcome === 'broken' ? pieces.error(new Broken()) : pieces.close();
        });
      });
      const options = { cancelSignal: cancelling.signal, onWait: () => tell('waits'), onProgress: () => tell('comes'), onFail: () => tell('fails') };
      let receivedText = '';
      watchedFetch('x', options, fetcher).then((response) => response.text()).then((all) => { receivedText = all; }, () => { receivedText = 'nothing'; });
      await wait(300_000);
      // What has to be told.
      const expected = [];
      let last_ms = 0, at_ms = answer_ms, end = outcome, hasWaited = false;
      const steps = ['lost', 'refused'].includes(outcome) ? [] : [...gaps.map((ms) => ['comes', ms]), [outcome, end_ms]];
      const reach = (next_ms) => { // whether it gets so far
        const limit_ms = Math.min(cancel_ms, last_ms + TIMEOUT_MS);
        if (!hasWaited && last_ms + NOTICE_MS < Math.min(next_ms, limit_ms)) {
          expected.push([last_ms + NOTICE_MS, 'waits']);
          hasWaited = true;
        }
        if (next_ms < limit_ms) return true;
        end = limit_ms === cancel_ms ? 'cancelled' : 'silent';
        at_ms = limit_ms;
        return false;
      };
      if (reach(at_ms)) for (const [what, ms] of steps) {
        if (!reach(at_ms + ms)) break;
        at_ms += ms;
        if (what === 'comes') expected.push([last_ms = at_ms, 'comes']);
      }
      if (!['whole', 'refused'].includes(end)) expected.push([at_ms, 'fails']);
      if (JSON.stringify(reports) !== JSON.stringify(expected)) throw new Error(`${JSON.stringify([outcome, answer_ms, gaps, end_ms, cancel_ms])} tells ${JSON.stringify(reports)} in place of ${JSON.stringify(expected)}`);
      if (receivedText !== ({ whole: 'x'.repeat(gaps.length), refused: 'why' }[end] ?? 'nothing')) throw new Error(`${end} has given ${receivedText}`);
      return { ends: [end], seen: [] };
    };
  },

  // Messages while somebody types.
  async checking() {
    const page = freshPage();
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Checker } = await page.load('writing/checking.js');
    let breaks = () => false;
    let notes = [];
    const python = {
      tryAgain() {},
      async ask(request, data) {
        await later(breaks() ? 400 : 30);
        if (breaks()) throw new Broken();
        return { robot: request.robot, findings: [], image: `of ${new TextDecoder().decode(data)}`, names_robot: false };
      },
    };
    const checking = new Checker(python, (error) => notes.push(String(error)));
    pageState.checkResult.subscribe((answer) => {
      if (answer && answer.image !== `of ${pageState.programText.value}`) throw new Error('it is said of another text');
      notes.push(answer?.image);
    });
    checking.markReady();
    let open = 0;
    return async (random, isGood) => {
      breaks = () => !isGood && random() < 0.3;
      const ends = [];
      for (let k = 1 + random.below(5); k > 0; k -= 1) {
        const text = isGood ? `${random.of(['F', 'B'])}(${k})` : random.of(['F(1)', 'B(2)', 'R(3)']);
        if (isGood) pageState.programText.set('');
        notes = [];
        pageState.programText.set(text);
        if (pageState.checkResult.value) throw new Error('what is said is of the text before');
        notes.push(document.documentElement.dataset['state']);
        if (!isGood && random() < 0.3) {
          open += 1;
          checking.whenChecked().then(() => { open -= 1; });
        }
        await wait(isGood ? 1000 : random.below(400));
        ends.push(document.documentElement.dataset['state']);
        if (!isGood && random() < 0.1) {
          checking.markFailed();
          await settle();
          if (open) throw new Error('they wait for a compiler that cannot be had');
          checking.markRetry();
        }
      }
      if (!isGood) await wait(1000); // a try that fails ends, too
      if (open) throw new Error(`${open} wait for ever`);
      return { ends: [...new Set(ends)], seen: [notes, document.documentElement.dataset['image']] };
    };
  },

  // A run of a robot, a real one or one of a file, that is kept, and played again: what is marked of it, what its file has and
  // where it parts are as a model has them of what has come since it began.
  async again() {
    const page = freshPage();
    const { Run } = await page.load('virtual/runs.js');
    const MAX_MARKS = 10_000;
    // Line by line: F, a WHEN with a B, another with an L.
    const text = 'F(1)\nWHEN(KEY_A)\nB(1)\nEND_WHEN\nWHEN(KEY_B)\nL(1)\nEND_WHEN';
    const places = [[0, 1, 1, 1, 5], [2, 2, 1, 4, 9], [4, 3, 1, 3, 5], [6, 5, 1, 7, 9], [8, 6, 1, 6, 5]];
    const inWhen = { 4: 'first', 8: 'other' }; // by the offset of what it does
    let run = null;
    return async (random, isGood) => {
      const [of, file] = isGood ? ['virtual', 'a run'] : random.of([['virtual', 'a run'], ['virtual', 'a run'], ['virtual', ''], ['real', ''], ['real', 'a run']]);
      if (isGood && run?.origin.of === of && run.fileText) run.restart(); // it is played again
      else run = new Run({ of, text, robot: 'tinibot', program: '1' }, { ...PROGRAM, places }, null);
      run.fileText = file;
      run.fileRows = file ? [[5, 'READ DISTANCE 1'], [500, 'READ DISTANCE 2']] : [];
      const isKept = run.origin.of === 'virtual' && !run.fileText; // what comes is what its file has
      const marks = [], rows = [];
      let now_ms = random.below(100), bumps = 0, parting = null, begun = [], end_ms = run.end_ms;
      const mark = (at_ms, kind) => {
        marks.push({ at_ms, kind });
        if (marks.length > MAX_MARKS) marks.splice(0, MAX_MARKS / 2);
      };
      const add = (count) => {
        now_ms += 1 + random.below(90);
        const events = Array.from({ length: count }, () => [now_ms, random.of(['SHOW 1', 'MOTORS 1 2', 'READ DISTANCE 5', 'FAULT 1', 'BEEP 97 100']), 0]);
        for (const [at_ms, event] of events) if (!event.startsWith('READ')) mark(at_ms, ['SHOW', 'FAULT', 'BEEP'].find((word) => event.startsWith(word)) ?? '');
        if (random() < 0.1) {
          bumps += 1;
          mark(now_ms, 'BUMP');
        }
        const at = [0, ...random() < 0.7 ? [random.of([2, 4, 4, 6, 8, 8])] : []], active = at.map((item) => inWhen[item]).filter(Boolean);
        if (active.some((item) => !begun.includes(item))) mark(now_ms, 'WHEN');
        begun = active;
        const more = random() < 0.3 ? [[now_ms, random.of(['KEYS 0 0 0', 'KEYS 1 0 0', 'KEYS 0 50 -5', `READ DISTANCE ${random.below(9)}`])]] : [];
        if (isKept) {
          for (const [at_ms, row] of more) if (row.startsWith('KEYS') && row !== 'KEYS 0 0 0') mark(at_ms, 'KEYS');
          rows.push(...more);
        }
        const parts = random() < 0.05 ? { at_ms: random() < 0.5 ? now_ms : null } : null;
        if (parts && !parting) {
          parting = parts;
          if (parts.at_ms !== null) mark(parts.at_ms, 'PART');
        }
        const is_full = random() < 0.1;
        if (!is_full && run.origin.of === 'virtual') end_ms = now_ms;
        run.add({ now_ms, bumps, parting: parts, events, at: 0, places: at, is_running: true, is_full, rows: more });
      };
      for (let k = random.below(60); k > 0; k -= 1) add(random.below(3));
      if (!isGood && random() < 0.05) for (let k = 0; k < 5; k += 1) add(5000);
      const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual).slice(0, 400)} in place of ${JSON.stringify(expected).slice(0, 400)}`); };
      assertSame(run.marks, marks, 'marks');
      assertSame([run.rows, run.end_ms, run.parting], [rows, end_ms, parting], 'what its file has, its end, and where it parts');
      const known = rows.length ? rows : run.fileRows;
      for (const at_ms of [0, 50, 600, now_ms / 2]) assertSame(run.readingAt('DISTANCE', at_ms) ?? null, known.filter(([when, row]) => when <= at_ms && row.startsWith('READ')).at(-1)?.[1].split(' ').at(-1) ?? null, `read at ${at_ms}`);
      const { moments, duration_s } = run;
      return { ends: [parting ? 'parted' : 'whole'], seen: isGood && structuredClone([moments.length, moments.events, moments.parts, moments.at(moments.length - 1).shown, moments.last_ms, duration_s]) };
    };
  },

  // A check of a lesson, which may be ended at any time. Whichever lessons are taken, in whichever order, the own program is
  // as it was once they are left.
  async lessons() {
    const page = freshPage({ replaceOptions() {}, makePictureOption() {}, makeWorldPicture() {} });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Lessons } = await page.load('lesson/lessons.js');
    const LESSONS = ['tinibot', 'liner', 'tinibot'].map((robot, k) => ({ name: `lesson${k}`, title: 'L', block_title: 'L', robot, worlds: 2, world: {} }));
    let delay = () => 5;
    let verdict = '';
    let parts = 0;
    let checks = 0; // that have begun
    const isRightOn = (robot, text) => ['', robot].includes(/tinibot|liner|$/.exec(text)[0]);
    const python = {
      tryAgain() {},
      async ask(request, bytes) {
        if (request.do === 'lesson_check') checks += 1;
        const check = checks;
        const isLast = request.do === 'lesson_go' && (parts -= 1) < 0;
        const own = verdict;
        await later(delay());
        if (request.do === 'lesson_titles') return { lessons: LESSONS };
        if (request.do === 'lesson_steps') return { steps: [{ blocks: [{ kind: 'program', rows: [[`F(${request.number})`]] }], hint: '' }], block_steps: [], taught: [] };
        if (request.do === 'check') return { image: isRightOn(request.robot, new TextDecoder().decode(bytes)) ? '00' : '' };
        return { verdict: isLast ? own : '', seed: 1, worlds: 2, said: ['said'], block_said: ['said'], spoken: {}, run: isLast && own === 'failed' ? { seed: 1, until_ms: check } : null };
      },
    };
    let endRun = () => {};
    const driving = {
      showLesson: () => later(delay()),
      leaveLesson() {},
      stop: () => endRun(),
      play({ until_ms: check }) {
        if (page.byId('lesson_end').hidden || check !== checks) wrong ||= 'the run of a check that is over begins';
        return new Promise((resolve) => { endRun = resolve; setTimeout(resolve, 200); });
      },
    };
    const work = { text: '', robot: '', name: '', lesson: '', own: null };
    pageState.view.set('text');
    pageState.robotName.subscribe((robot) => { work.robot = robot; });
    pageState.programText.subscribe((text) => {
      work.text = text;
      if (!pageState.groupName.value) return;
      hasGroupText = true;
      ownProgram = '';
    });
    let hasGroupText = false;
    const openLesson = () => LESSONS[page.byId('lesson_page').dataset.lesson - 1];
    const open = ({ text, robot, name, lesson = '' }) => {
      pageState.robotName.set(robot);
      Object.assign(work, { name, lesson, own: lesson ? work.own : null });
      pageState.programText.set(text);
    };
    const inEditor = () => JSON.stringify([work.text, work.robot, work.name]);
    let ownProgram = ''; // the own program, which has stepped back
    const receive = (program) => {
      if (pageState.groupName.value) wrong ||= 'a lesson takes the program of a group';
      if (program.lesson && program.lesson !== openLesson().name) wrong ||= `the program of ${program.lesson} comes beside ${openLesson().name}`;
      if (program.lesson) ownProgram ||= inEditor();
      open(program);
      if (program.lesson) return;
      if (inEditor() !== ownProgram) wrong ||= `${inEditor()} comes back in place of ${ownProgram}`;
      ownProgram = '';
    };
    const exchange = (program) => {
      if (program.lesson && !program.text && (!isRightOn(work.robot, work.text) || isRightOn(program.robot, work.text))) wrong ||= `${inEditor()} goes from a ${program.robot}`;
      receive(program);
    };
    const lessons = new Lessons({ python, simulatorPanel: driving, putProgram: (program) => (pageState.groupName.value ? open(program) : receive(program)), exchangeProgram: exchange, work });
    page.byId('lessons').hidden = false;
    page.byId('side_lessons').click();
    await wait(500);
    const { text } = await page.load('page/texts.js'); // that a lesson was solved before is kept as its stars are
    const readVerdict = () => [page.byId('lesson_said').textContent.replace(` ${text('lesson_was_done')}`, ''), page.byId('lesson_said').dataset['verdict'], page.byId('lesson_stars').textContent, page.byId('lesson_end').hidden,
      page.byId('lesson_findings').children.length, page.byId('lesson_next').hidden, page.byId('lesson_end').textContent, page.byId('lesson_check').hidden];
    const actions = {
      check: () => page.byId('lesson_check').click(),
      end: () => page.byId('lesson_end').click(),
      edit: () => pageState.programText.set('F(1)'),
    };
    const kept = () => JSON.parse(window.localStorage.getItem('tiniscript.lesson_programs') ?? '{}');
    let keptBefore = {};
    let wrong = '';
    let chosen = ''; // the newest, in this language
    /** What is kept of lessons: what was written at each, and nothing of what a group writes. */
    const checkKept = () => {
      if (wrong) throw new Error(wrong);
      const isGroup = pageState.groupName.value !== '';
      if (isGroup && JSON.stringify(kept()) !== JSON.stringify(keptBefore)) throw new Error(`a group has written ${JSON.stringify(kept())}`);
      if (isGroup && hasGroupText && work.lesson) throw new Error(`a group's program is that of ${work.lesson}`);
      if (!isGroup && work.lesson && work.text && kept()[work.lesson] !== work.text) throw new Error(`of ${work.lesson} is kept ${kept()[work.lesson]}, and not ${work.text}`);
    };
    const rest = async () => {
      await wait(3000);
      if (chosen && String(1 + LESSONS.indexOf(openLesson())) !== chosen) throw new Error(`${openLesson().name} is seen, and ${chosen} was chosen`);
    };
    const written = (random) => `F(${random.below(1000)}) ${random.of(['', '// tinibot', '// liner'])}`; // and where it is right
    const goTo = (side) => {
      page.byId('lessons').hidden = side !== 'side_lessons';
      pageState.sideId.set(side);
      page.byId(side).click();
    };
    const lessonActions = { // lessons, in any order
      choose(random) {
        chosen = page.byId('lesson').value = String(1 + random.below(LESSONS.length));
        page.byId('lesson').dispatchEvent(new Event('change'));
      },
      use: () => page.byId('lesson_step').children[0].children[1].click(),
      write(random) { // a lesson's program, which is then that of the lesson that is seen
        const { lesson } = work, wanted = lesson && (pageState.groupName.value ? '' : pageState.sideId.value === 'side_lessons' ? openLesson().name : lesson);
        pageState.programText.set(written(random));
        if (work.lesson !== wanted) throw new Error(`what was written at ${wanted || 'no lesson'} is of ${work.lesson}`);
      },
      empty: () => pageState.programText.set(''),
      robot: (random) => pageState.robotName.set(random.of(['tinibot', 'liner'])),
      go: (random) => goTo(random.of(['side_lessons', 'side_virtual'])),
      check: () => actions.check(),
      leave: () => lessons.leave(),
      join(random) { // its program is nobody's own, and no lesson's
        if (pageState.groupName.value) return;
        keptBefore = kept();
        hasGroupText = false;
        pageState.groupName.set('red');
        if (random() < 0.5) pageState.programText.set(written(random)); // else it is on its way
      },
      async waver(random) { // before the lesson has said whether the program is for its robot
        goTo('side_lessons');
        lessonActions.erase();
        lessonActions[random.of(['open', 'write'])](random);
        lessonActions.choose(random);
        await wait(random.below(500));
        lessonActions[random.of(['choose', 'write', 'robot', 'join'])](random);
      },
      erase() { // whoever else uses this device
        if (pageState.groupName.value) return;
        window.localStorage.removeItem('tiniscript.lesson_programs');
        pageState.programText.set(work.text);
      },
      changeLanguage() {
        chosen = '';
        pageState.language.set('en');
      },
      quit: () => pageState.groupName.set(''),
      open(random) {
        ownProgram = '';
        open({ text: written(random), robot: random.of(['tinibot', 'liner']), name: `${random.below(9)}.ts` });
      },
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : 5 + random.below(300));
      let end = '';
      for (let k = 1 + random.below(4); k > 0; k -= 1) {
        verdict = random.of(['passed', 'failed', 'mistakes']);
        parts = random.below(4);
        end = random.of(isGood ? ['edit', 'end'] : ['check', 'check', 'end', 'edit']);
        if (end === 'end') await wait(random.below(100));
        if (isGood) actions.edit();
        actions[end]();
        if (!isGood) await wait(random.below(400));
      }
      const seen = [readVerdict()];
      if (wrong) throw new Error(wrong);
      if (!isGood) return { ends: [end], seen };
      for (let k = 0; k < 20; k += 1) {
        await wait(50);
        seen.push(readVerdict());
      }
      actions.check();
      await wait(3000);
      seen.push(readVerdict());
      delay = () => 5 + random.below(300);
      for (let k = 10 + random.below(40); k > 0; k -= 1) {
        await lessonActions[random.of(['choose', 'write', ...Object.keys(lessonActions)])](random);
        checkKept();
        await (random() < 0.15 ? rest() : wait(random.below(random.of([50, 100, 1000]))));
        checkKept();
      }
      await rest();
      lessonActions.quit();
      lessons.leave();
      if (ownProgram || work.lesson || work.own) throw new Error(`after all lessons there is ${work.lesson} ${inEditor()}, and the own program is ${ownProgram}`);
      return { ends: [end], seen };
    };
  },

  // What is asked of a robot, also of one that is gone or goes meanwhile.
  async asking() {
    const page = freshPage();
    const { RequestQueue, ConnectionFailure } = await page.load('robot/transport.js');
    return async (random, isGood) => {
      const reports = [];
      let open = 0;
      let isOver = false;
      const end = random.of(isGood ? ['stays'] : ['stays', 'goes', 'goes']);
      const asking = new RequestQueue({ onEvent: ({ event }) => reports.push(event), onEnd: (error) => reports.push(error.reason) });
      asking.send = async () => {
        const sentRequests = asking.requests.splice(0);
        await later(isGood ? 5 : random.below(300));
        for (const { id, what } of sentRequests) if (!isOver) asking.handleNews({ id, ok: what });
      };
      for (let k = 0; k < 6; k += 1) {
        open += 1;
        asking.ask({ what: k }).then(({ ok }) => reports.push(ok), (error) => reports.push(error.reason)).finally(() => { open -= 1; });
        await wait(random.below(100));
        if (end === 'goes' && !isOver && random() < 0.4) {
          isOver = true;
          asking.end(new ConnectionFailure('gone'));
        }
      }
      await wait(1000);
      if (open) throw new Error(`${open} never end: ${reports}`);
      return { ends: [end], seen: reports };
    };
  },

  // Python in its worker, which may be tried again until it is there.
  async python() {
    const page = freshPage();
    const workers = [];
    globalThis.Worker = class extends EventTarget {
      hasSpoken = false;
      isEnded = false;
      asked = [];
      constructor() {
        super();
        this.began_ms = now();
        workers.push(this);
      }
      say(data) {
        this.hasSpoken = true;
        this.dispatchEvent(Object.assign(new Event('message'), { data }));
      }
      terminate() { this.isEnded = true; }
      postMessage({ id, request }) { this.asked.push({ id, number: JSON.parse(request).number }); }
    };
    const { Python } = await page.load('python.js');
    const NOTICE_MS = 3000, TIMEOUT_MS = 20_000;
    return async (random, isGood) => {
      workers.length = 0;
      const reports = [], expected = [];
      const makeListeners = () => ({ onWait: () => reports.push('waits'), onFail: () => reports.push('fails'), onBegin: () => reports.push('begins') });
      const ends = new Set();
      let isReady = false, isLate = false, isThere = true, isAnswering = false, askCount = 0;
      const openNumbers = new Set(), endings = [], expectedEndings = [];
      const python = new Python('en');
      python.listen(makeListeners());
      python.ready.then(() => { isAnswering = true; });
      const newest = () => workers.at(-1);
      const rejectAll = () => {
        for (const number of openNumbers) expectedEndings.push([number, 'rejected']);
        openNumbers.clear();
        newest().asked = [];
      };
      const fail = (end) => {
        ends.add(end);
        rejectAll();
        if (isReady) return;
        [isThere, isLate] = [false, false];
        expected.push('fails');
      };
      const actions = {
        ask() {
          const number = (askCount += 1);
          if (isThere) openNumbers.add(number);
          else expectedEndings.push([number, 'rejected']);
          python.ask({ number }).then((answer) => endings.push([number, answer]), () => endings.push([number, 'rejected']));
        },
        answer() {
          const [request] = newest().asked.splice(0, 1);
          if (!isThere || !request) return;
          openNumbers.delete(request.number);
          const isError = random() < 0.3;
          expectedEndings.push([request.number, isError ? 'rejected' : request.number]);
          newest().say(isError ? { id: request.id, error: 'no' } : { id: request.id, answer: JSON.stringify(request.number) });
        },
        begin: () => isThere && newest().say({ begun: true }),
        wait() {
          if (!isThere) return;
          expected.push('waits');
          isLate = !isReady; // what a lesson needs may be late when it is there
          newest().say({ waits: true });
        },
        becomeReady() {
          if (!isThere) return;
          [isReady, isLate] = [true, false];
          newest().say({ id: 0 });
        },
        'not fetched'() {
          if (!isThere || isReady) return;
          fail('not fetched');
          newest().say({ id: 0, error: 'not fetched' });
        },
        error() {
          if (!isThere) return;
          fail('error');
          newest().dispatchEvent(Object.assign(new Event('error'), { message: 'broken' }));
        },
        tryAgain() {
          if (!isThere) expected.push('begins');
          isThere = true;
          python.tryAgain('en');
        },
        listen() {
          if (!isThere) expected.push('fails');
          else if (isLate) expected.push('waits');
          python.listen(makeListeners());
        },
      };
      const goOn = async (ms) => { // nobody waits for a worker that says nothing
        for (const [limit_ms, callback] of [[NOTICE_MS, () => { isLate = true; expected.push('waits'); }], [TIMEOUT_MS, () => fail('silent')]]) {
          const worker = newest(), left_ms = worker.began_ms + limit_ms - now();
          if (isThere && !worker.hasSpoken && left_ms > 0 && left_ms <= ms) callback();
        }
        await wait(ms);
      };
      for (let k = 6 + random.below(20); k > 0; k -= 1) {
        const act = random.of(['ask', 'ask', 'answer', 'wait', 'tryAgain', 'tryAgain', 'listen', random.of(isGood ? ['begin', 'becomeReady'] : Object.keys(actions))]);
        actions[act]();
        await goOn(random.of([0, 10, 2000, 19_000, 25_000]));
        const assertSame = (actual, right, label) => { if (JSON.stringify(actual) !== JSON.stringify(right)) throw new Error(`after ${act} ${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(right)}`); };
        assertSame(reports, expected, 'it is told');
        assertSame(endings, expectedEndings, 'asks end');
        assertSame([python.isLate, isAnswering], [isLate, isReady], 'late and ready');
        assertSame(workers.map(({ isEnded }) => isEnded), workers.map((worker) => !isThere || worker !== newest()), 'those that have ended');
      }
      return { ends: [...ends], seen: [] };
    };
  },

  // A file with a class's work is opened. Some works get lost, and the class takes no others: how many it has is said.
  async keeping() {
    const page = freshPage();
    await loadTexts(page);
    const { openWork } = await page.load('class/keeping.js');
    const { CLASS } = await page.load('page/words.js');
    let chanceNow = () => 1;
    let takenCount = 0;
    replaceFetch(async () => {
      await later(1);
      if (chanceNow() < 0.2) throw new Broken();
      if (chanceNow() < 0.2) return { ok: false, status: 413 };
      takenCount += 1;
      return responseOf({});
    });
    return async (random) => {
      chanceNow = random;
      takenCount = 0;
      const pupils = Array.from({ length: random.below(6) }, (_, k) => ({ name: `P${k}`, text: 'F(1)', robot: '', lessons: [] }));
      const opened = openWork({ size: 9, text: async () => JSON.stringify({ tiniscript_class: CLASS.form, pupils }) });
      await wait(50);
      const openedCount = await opened;
      if (openedCount !== (takenCount || null)) throw new Error(`${openedCount} works are said to be open, and the class has ${takenCount}`);
      return { ends: [takenCount ? 'some' : 'none'], seen: [] };
    };
  },

  // The teacher's page, over a network that loses some: its bar and its tiles tell of the class as it is now, never as it
  // was before what is seen, with pictures of what pupils have now, and no other picture is kept; what is seen large is as it
  // is now, or closed. What is pressed is done once, to whom it says. A run is played, though an earlier one never came. Once
  // nothing is lost, the class is asked once a second.
  async wall() {
    const page = freshPage({
      generate: () => ({ toCanvas() {} }), correction: {},
      Blocks: class {
        words = 'words';
        updateLanguage() { this.words = `words ${languages}`; }
        async makeFormPicture({ text }) { await later(20); return `${text} ${this.words}`; }
      },
    });
    let languages = 0;
    const open = new Map(); // what is in a picture, by its address
    let addresses = 0;
    URL.createObjectURL = (what) => {
      open.set(`blob:${(addresses += 1)}`, what);
      return `blob:${addresses}`;
    };
    URL.revokeObjectURL = (address) => open.delete(address);
    document.documentElement.dataset['class'] = '';
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    let room = async () => { throw new Broken(); };
    replaceFetch((_, { body }) => room(JSON.parse(body)));
    const { pageState } = await page.load('page/page_state.js');
    const { text } = await page.load('page/texts.js');
    const { Teacher } = await page.load('class/teacher.js');
    const python = { ready: Promise.resolve(), ask: async (_, data) => { await later(10); return { text: new TextDecoder().decode(data) }; } };
    let played = 0;
    new Teacher({ python, openRun: async () => { played += 1; } });
    await wait(10);
    const [bar, wall] = page.byId('class').children;
    const [status, chips, giveBack, anew] = bar.children;
    const [large, giving, settings, code] = ['big_pupil', 'class_giving', 'class_window', 'big_code'].map((id) => document.body.children.find((item) => item.id === id));
    const [robotList, lines] = [settings.children[1].children[1], settings.children[1].children];
    const [port, lendButton] = [lines[2].children[0].children.at(-1), lines[2].children[1]], [minutes, places] = [3, 4].map((k) => lines[k].children[0].children.at(-1));
    const within = (part, className) => part.children.find((item) => item.className?.split(' ').includes(className));
    const codeSeen = () => Number(code.querySelectorAll('strong').at(-1).textContent);
    let numbers = 0;
    let states = 0; // told; a class's code is the number of the newest
    /** Who is in the class, by name, and what is kept of others. */
    const present = new Map(), keptWorks = new Map(), groups = new Map(), robots = new Map();
    let room_ = { turn_s: 60, places: 2, goes_on: false };
    const groupOf = (number) => [...groups].find(([, { pupils }]) => pupils.includes(number))?.[0];
    const seenLarge = () => large.open && [large.querySelectorAll('h2')[0].textContent, large.children[1].children[1].textContent, open.get(large.children[1].children[0].children[0].src)];
    return async (random, isGood) => {
      let lost = false;
      let isClosed = !large.open; // by somebody
      let newest = 0; // of the states that were seen
      let isLate = () => !isGood;
      let requests = []; // besides what is asked again and again
      let polls = 0;
      const handlers = {
        class_hand: ({ pupil }) => { const found = [...present.values()].find(({ number }) => number === pupil); if (found) found.hand = 0; },
        class_next: ({ pupil }) => { const found = [...present.values()].find(({ number }) => number === pupil); if (found) found.robot = ''; },
        class_remove: ({ pupil }) => { for (const [name, { number }] of present) if (number === pupil) present.delete(name); },
        class_forget: ({ key }) => keptWorks.delete(key),
        class_robot: ({ port: id, gives }) => (gives ? robots.set(id, { name: '', pupil: '', left_s: 0 }) : robots.delete(id)),
        class_turn: ({ seconds }) => { room_.turn_s = seconds; },
        class_places: ({ places: count }) => { room_.places = count; },
      };
      const REPEATED = ['class', 'class_text', 'class_run', 'ports'];
      room = async (request) => {
        if (request.do === 'class') polls += 1;
        if (!REPEATED.includes(request.do)) requests.push(request);
        const isLost = isLate() && random() < 0.5;
        if (!isLost) handlers[request.do]?.(request);
        const [pupils, works, shared, lent] = [present, keptWorks, groups, robots].map((all) => structuredClone([...all]));
        const state = { ...room_, code: String((states += 1)) };
        await later(isLate() ? random.below(300) : 5);
        if (isLost) {
          lost ||= request.do === 'class_text';
          throw new Broken();
        }
        if (request.do === 'ports') return responseOf({ ports: [{ port: 'p1', name: '' }, { port: 'p2', name: 'Bo' }] });
        if (request.do === 'class_run') return responseOf({ run: isLate() ? random.of(['', null, null]) : 'its file' });
        if (request.do === 'class_text') {
          const [, found] = [...pupils, ...works, ...shared].find(([name, { number }]) => (request.pupil ? number === request.pupil : name === (request.key ?? request.group))) ?? [];
          return responseOf({ text: found?.text ?? '', robot: 'tinibot', version: found?.version ?? 0, history: found?.pupils ? [`made ${found.text}`] : [] });
        }
        const keptRows = works.map(([name]) => ({ key: name, name, lessons: [], given: 0, alike: [] }));
        return responseOf({
          ...state, over: '', lessons: 2, kept: keptRows, pupils: pupils.map(([name, row]) => ({ name, ...row })),
          groups: shared.map(([key, { pupils: members, version }]) => ({ key, name: key, pupils: members, version })), robots: lent.map(([id, row]) => ({ port: id, ...row })),
        });
      };
      const name = () => random.of(['Ana', 'Luz', 'Teo', 'Eva']);
      const pupil = () => present.get(name());
      const makeChange = (fields) => () => { const found = pupil(); if (found) Object.assign(found, fields()); };
      const press = (part, isExpected) => {
        if (!part || part.hidden || part.disabled) return;
        const before = requests.length;
        part.click();
        const [request, ...more] = requests.slice(before);
        if (more.length || !request || !isExpected(request)) throw new Error(`${JSON.stringify([request, ...more])} is asked by ${part.className || part.dataset['text']}`);
      };
      const tileOf = () => random.of([...wall.children, null]);
      const numberOf = (tile) => present.get(tile?.children[0].textContent.split(' · ')[0])?.number;
      const makeTilePress = (className, what) => () => {
        const tile = tileOf(), number = numberOf(tile);
        if (number) press(within(tile, className), (request) => request.do === what && request.pupil === number);
      };
      const actions = {
        come: () => { const who = name(); if (!present.has(who)) present.set(who, { number: (numbers += 1), text: '', version: 0, silent_s: 0, place: 0, robot: '', is_running: false, left_s: 0, is_right: true, hand: 0, lessons: [], own_robot: { name: '', colour: 0 } }); },
        write: makeChange(() => ({ text: random() < 0.2 ? '' : `W(${numbers})`, version: (numbers += 1) })),
        wave: makeChange(() => ({ hand: random.below(3), place: random.below(3), silent_s: random.of([0, 9]), is_right: random() < 0.5 })),
        drive: makeChange(() => ({ robot: random.of(['', 'Bo']), is_running: random() < 0.5, left_s: random.below(99) })),
        learn: makeChange(() => ({ lessons: ['1 one', '2 two'].slice(random.below(3)), own_robot: { name: random.of(['', 'Zip']), colour: 0 } })),
        go: () => { present.delete(name()); },
        kept: () => { const key = `old ${name()}`; if (!keptWorks.delete(key)) keptWorks.set(key, { text: `S(${numbers})`, version: 0 }); },
        join: () => {
          const found = pupil();
          for (const group of groups.values()) group.pupils = group.pupils.filter((number) => number !== found?.number);
          if (found && random() < 0.7) groups.set(random.of(['red', 'tan']), { text: `G(${numbers})`, version: (numbers += 1), pupils: [found.number] });
        },
        robots: () => robots.set(random.of(['p1', 'p2']), { name: random.of(['', 'Bo']), pupil: random.of(['', 'Ana']), left_s: random.below(99) }),
        rules: () => { room_ = { turn_s: 60 * (1 + random.below(9)), places: 1 + random.below(9), goes_on: random() < 0.5 }; },
        changeLanguage: () => { languages += 1; pageState.language.set('en'); },
        look() {
          const tile = tileOf();
          if (!tile) return;
          within(tile, 'see').click();
          if (!large.open) throw new Error('nobody is seen large');
          isClosed = false;
        },
        play: () => tileOf()?.children.find(({ className }) => className === 'play').click(),
        close() {
          large.close();
          isClosed = true;
        },
        step: () => large.open && random.of([large.children[0].children[0], large.children[0].children[2]]).click(),
        give: () => giving.showModal(),
        lower: makeTilePress('hand', 'class_hand'),
        remove: makeTilePress('out', 'class_remove'),
        forget() {
          const tile = tileOf(), key = tile?.children[0].textContent;
          if (keptWorks.has(key)) press(within(tile, 'out'), (request) => request.do === 'class_forget' && request.key === key);
        },
        pressLarge() { // of who is seen large
          const number = present.get(seenLarge()[0])?.number;
          const [what, buttonIndex] = random.of(Object.entries({ class_hand: 4, class_stop: 5, class_next: 6, class_remove: 7 }));
          if (!number) return;
          press(large.children[0].children[buttonIndex], (request) => request.do === what && request.pupil === number);
          if (what === 'class_remove' && large.open) throw new Error('who is removed is seen large');
          isClosed ||= what === 'class_remove';
        },
        take: () => press(random.of([...robotList.children, null])?.children[2], (request) => request.do === 'class_robot' && !request.gives),
        lend() {
          port.value = random.of(['', 'p1', 'p2']);
          const before = requests.length;
          lendButton.click();
          if (requests.length - before !== Number(port.value !== '')) throw new Error(`${JSON.stringify(requests.slice(before))} is asked for ${port.value}`);
        },
        set() {
          [minutes.value, places.value] = [String(1 + random.below(9)), String(1 + random.below(9))];
          const before = requests.length;
          for (const field of [minutes, places]) field.dispatchEvent(new Event('change'));
          if (`${requests.slice(before).map(({ seconds, places: count }) => seconds / 60 || count)}` !== `${[minutes, places].map(({ value }) => value)}`) throw new Error('what is set is not asked for');
        },
        wait: () => {},
      };
      for (let k = 5 + random.below(25); k > 0; k -= 1) {
        const act = random.of([...Object.keys(actions), 'come', 'come', 'come', 'write', 'write', 'look']);
        actions[act]();
        if (act === 'look' && random() < 0.5) actions.pressLarge();
        await wait(random.of([20, 1050, random.below(1500)]));
        if (large.open && isClosed) throw new Error('what was closed is seen large again');
        if (codeSeen() < newest) throw new Error('the class of before is seen');
        newest = codeSeen();
      }
      if (!isGood) return { ends: [lost ? 'lost' : 'came'], seen: false };
      isLate = () => false;
      await wait(16_000); // also what nobody answers is over
      polls = 0;
      await wait(10_000);
      if (polls < 9 || polls > 10) throw new Error(`${polls} times in 10 s the class is asked`);
      const clock = (seconds) => `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, '0')}`;
      const members = [...groups].map(([key, group]) => [key, { ...group, all: [...present].filter(([, { number }]) => group.pupils.includes(number)) }]).filter(([, { all }]) => all.length);
      const joined = members.map(([key, { text: program, all }]) => [key, {
        text: program, isGroup: true, own_robot: { name: all.map(([name]) => name).join(', ') }, lessons: all.flatMap(([, { lessons }]) => lessons),
        silent_s: Math.min(...all.map(([, row]) => row.silent_s)), is_right: all.every(([, row]) => row.is_right),
        hand: Math.max(...all.map(([, row]) => row.hand)), place: Math.max(...all.map(([, row]) => row.place)), ...(({ robot, is_running, left_s }) => ({ robot, is_running, left_s }))((all.find(([, { robot }]) => robot) ?? all[0])[1]),
      }]);
      const all = [...[...present].filter(([, { number }]) => !members.some(([, { pupils }]) => pupils.includes(number))), ...joined, ...keptWorks].sort(([one], [other]) => one.localeCompare(other));
      const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
      const wordsIn = (part) => (typeof part === 'string' ? part : part.textContent + part.children.map(wordsIn).join(''));
      assertSame(wall.children.map((tile) => [tile.children[0].textContent, tile.dataset['state'], tile.children[2].children[1].textContent, !within(tile, 'badge').hidden && wordsIn(within(tile, 'badge')), tile.children[2].children[0].children.filter(({ className }) => className).length, ...['hand', 'play', 'out', 'join'].map((item) => !within(tile, item).hidden)]),
        all.map(([name, { own_robot, silent_s, is_right, robot, is_running, left_s, place, lessons = [], hand, isGroup = false }]) => {
          const state = !own_robot ? 'gone' : silent_s ? 'away' : is_right ? 'right' : 'wrong';
          return [[name, own_robot?.name].filter(Boolean).join(' · '), state, state === 'right' ? '✓' : text(`class_is_${state}`), robot ? `${is_running ? '▶ ' : ''}${robot} ${clock(left_s)}` : place ? text('class_place_short', { place }) : false, new Set(lessons).size, Boolean(hand), !isGroup && ['right', 'wrong'].includes(state), !isGroup, isGroup];
        }), 'the tiles');
      const hands = [...present].filter(([, { hand }]) => hand).sort(([, one], [, other]) => one.hand - other.hand).map(([name]) => name).join(', ');
      const expectedText = [text('class_count', { pupils: present.size, robots: robots.size, waiting: [...present.values()].filter(({ place }) => place).length }), hands && text('class_hands', { names: hands })].filter(Boolean).join(' ');
      if (!status.textContent.startsWith(expectedText) || (room_.goes_on && expectedText === status.textContent)) throw new Error(`${status.textContent} in place of ${expectedText}`);
      assertSame([giveBack.hidden, anew.hidden, wall.hidden, minutes.value, places.value], [!keptWorks.size || !present.size, !room_.goes_on, !all.length, String(room_.turn_s / 60), String(room_.places)], 'the bar');
      assertSame([chips.hidden, chips.children.map((chip) => [...chip.children.slice(1).map(wordsIn), chip.className])], [!robots.size, [...robots].map(([id, row]) => [row.name || id, row.pupil ? text('class_held', { name: row.pupil, time: clock(row.left_s) }) : text('class_free'), row.pupil ? 'held' : ''])], 'the robots');
      assertSame(robotList.children.map((row) => wordsIn(row.children[0])), [...robots].map(([id, row]) => [row.name, id].filter(Boolean).join(' · ')), 'the list of robots');
      const tiles = wall.children.map(({ children }) => [children[0].textContent.split(' · ')[0], open.get(children[1].children[0].src), children[1].children[0].src]);
      const expected = all.map(([name, { text: program }]) => [name, program && (languages ? `${program} words ${languages}` : `${program} words`)]);
      assertSame(tiles.map(([name, picture = '']) => [name, picture]), expected, 'the pictures');
      if (tiles.some(([, picture, address]) => address && !picture)) throw new Error('a picture that is kept no more is in a tile');
      const shownAddresses = new Set(tiles.map(([, , address]) => address).filter(Boolean));
      if (shownAddresses.size !== open.size) throw new Error(`${open.size} pictures are kept, and ${shownAddresses.size} are seen`);
      if (large.open && isClosed) throw new Error('what was closed is seen large again');
      const largeView = seenLarge();
      const ownEntry = largeView && all.find(([name]) => name === largeView[0]);
      if (largeView && !ownEntry) throw new Error(`${largeView[0]} is seen large, and is not here`);
      if (ownEntry) {
        const { text: program, robot = '', is_running = false, hand = 0, isGroup, own_robot } = ownEntry[1], [, , , said_, lower, stop, next, remove] = large.children[0].children;
        if (program) assertSame(largeView.slice(1), [program, expected[all.indexOf(ownEntry)][1]], 'what is seen large');
        assertSame([said_.textContent.startsWith(text(is_running ? 'class_runs' : 'class_drives', { robot })), lower.hidden, stop.hidden, next.hidden, remove.hidden, large.children[1].children[2].hidden, large.children[1].children[0].hidden], [Boolean(robot), !hand, !robot, !robot, Boolean(isGroup), !isGroup, !program], `beside ${ownEntry[0]}, who is seen large ${Boolean(own_robot)}`);
      }
      if (giving.open && !keptWorks.size) throw new Error('there is nothing to give');
      const tile = wall.children.find((item) => numberOf(item) && !within(item, 'play').hidden), before = played;
      tile?.children.find(({ className }) => className === 'play').click();
      await wait(500);
      if (tile && played === before) throw new Error('a run is not played');
      for (const item of [present, keptWorks, groups, robots]) item.clear();
      large.close();
      giving.close();
      await wait(5000);
      if (wall.children.length || open.size) throw new Error(`${wall.children.length} tiles and ${open.size} pictures of nobody`);
      return { ends: ['good'], seen: [] };
    };
  },

  // One connection to a robot after another; what is late of one before is not of the next.
  async link() {
    const notes = [];
    let delay = () => 5;
    let failure = '';
    let ways = [];
    const page = freshPage({
      ...REAL_SIDE,
      HostRobot: class {
        constructor(heard) {
          this.heard = heard;
          ways.push(this);
        }
        async connect() {
          await later(delay());
          if (failure || this.isOver) {
            this.isOver = true;
            throw new ConnectionFailure(failure || 'left');
          }
          return { name: `A${ways.length}`, id: '1', robot: 'tinibot', owner: 'free', room: 300, is_running: false, has_remote: true };
        }
        async ask({ do: action }) {
          await later(delay());
          if (this.isOver) throw new ConnectionFailure('left');
          return { ok: true, program: 'ff', trim: action === 'trim' ? null : undefined };
        }
        stop() { notes.push('stop'); }
        tell(event) { if (!this.isOver) this.heard.onEvent(event); }
        end(error) {
          this.isOver = true;
          this.heard.onEnd(new ConnectionFailure(error));
        }
        leave() { this.end('left'); }
      },
    });
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    const { ConnectionFailure } = await page.load('robot/transport.js');
    const { pageState } = await page.load('page/page_state.js');
    const { RunningPlace } = await page.load('robot/place.js');
    const { RobotPanel } = await page.load('robot/panel.js');
    pageState.robotName.set('tinibot');
    pageState.checkResult.set({ ...PROGRAM, program: 'ff', bytes: 9 });
    const { text } = await page.load('page/texts.js');
    const panel = new RobotPanel({ python: { tryAgain() {} }, goTo() {}, recorder: noting(notes, 'recorder'), place: new RunningPlace(), pad: noting(notes, 'pad') });
    await wait(10);
    const EVENTS = [{ event: 'STARTED', program: 'ff', is_program: true }, { event: 'PLACE', program: 'ff', at: 0 }, { event: 'SHOW', value: '1' }, { event: 'DONE' }, { event: 'LOST' }, { event: 'STOPPED', cause: 'MESSAGE' }, { event: 'FAULT', fault: 'STUCK', program: 'ff', at: 0 }];
    const readMessage = () => page.byId('link_said').textContent;
    const observe = () => [readMessage(), page.byId('link_shown').textContent, page.byId('link_name').textContent, page.byId('link_rename_to').value, document.documentElement.dataset['robot'], structuredClone(pageState.robotRun.value)];
    const isNoted = (...what) => notes.some((item) => `${item}` === `${what}`);
    return async (random, isGood) => {
      const before = ways;
      ways = [];
      notes.length = 0;
      delay = () => (isGood ? 5 : 5 + random.below(300));
      failure = isGood || random() < 0.7 ? '' : 'link_silent';
      panel.connectByHost('p');
      const observations = [structuredClone(pageState.robotRun.value), document.documentElement.dataset['robot']];
      await wait(isGood ? 50 : random.below(600));
      const isMet = () => document.documentElement.dataset['robot'] === 'connected';
      let stop = ''; // pressed, or done, since the newest start
      const actions = {
        tell() {
          const event = random.of([...EVENTS, EVENTS[0], EVENTS[0], EVENTS[5], EVENTS[5]]); // a run that starts after a stop, and stops
          notes.length = 0;
          if (event.event === 'STOPPED' && stop === '') page.byId('link_said').textContent = '';
          ways[0]?.tell(event);
          if (!ways[0] || ways[0].isOver) return;
          const isOpen = stop === 'pressed';
          if (event.event === 'STARTED' && stop === 'done') stop = '';
          if (event.event !== 'STOPPED') return;
          if (!isNoted('pad', 'releaseAll')) throw new Error('what is held is held on after a stop');
          if (!isOpen && stop === '' && readMessage() !== text('stopped_MESSAGE')) throw new Error(`of a stop after a start it says ${readMessage()}`);
          stop = 'done';
        },
        stop() {
          notes.length = 0;
          panel.stop();
          if (!ways[0] || ways[0].isOver) return;
          if (!isNoted('stop')) throw new Error('nobody stops');
          stop = 'pressed';
        },
        upload() {
          if (!isMet()) return;
          page.byId('link_upload').click();
          if (page.byId('link_shown').textContent) throw new Error('what the program before has shown is there still');
        },
        breakProgram() {
          if (!isMet()) return;
          pageState.checkResult.set({ ...PROGRAM, image: '', program: '' });
          notes.length = 0;
          page.byId('link_upload').click();
          if (!isNoted('stop')) throw new Error('what runs is not what is seen');
          stop = 'pressed';
          pageState.checkResult.set({ ...PROGRAM, program: 'ff', bytes: 9 });
        },
        async rename() {
          if (!isMet()) return;
          page.byId('link_rename_to').value = 'Bo';
          page.byId('link_rename').click();
          await wait(400);
          if (isMet() && page.byId('link_name').textContent !== 'Bo') throw new Error('it has its name of before');
        },
      };
      for (let k = 1 + random.below(8); k > 0; k -= 1) {
        if (isGood && before.length) before[0].end('unheard'); // once more, and late
        await actions[random.of(['tell', 'tell', 'tell', ...Object.keys(actions)])]();
        observations.push(observe());
        await wait(random.below(300));
      }
      const end = failure || (isGood ? 'stays' : random.of(['left', 'unheard']));
      const wasMet = isMet();
      const isUnsaid = stop === 'pressed' && !failure;
      notes.length = 0;
      if (end === 'left') ways[0].leave();
      if (end === 'unheard') ways[0].end('unheard');
      if (!isGood) await wait(1000);
      if (!isGood && wasMet && !isNoted('recorder', 'end', 'LOST')) throw new Error('the recording of who is gone goes on');
      if (!isGood && wasMet && isUnsaid && !readMessage().includes(text('say_not_confirmed'))) throw new Error(`nobody says that the stop is not confirmed: ${readMessage()}`);
      return { ends: [end], seen: [observations, [...notes]] };
    };
  },

  // Sensors of a real robot that are watched, and then another robot: what is seen is what it has told itself.
  async watching() {
    const page = freshPage({ Plot: class { clear() {} add() {} draw() {} } });
    replaceNavigator({});
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { SensorWatch } = await page.load('robot/watching.js');
    const { devicesOf } = await page.load('page/words.js');
    pageState.sideId.set('side_real');
    let delay = () => 5;
    let wasWanted = false; // which the page keeps
    let robot = null, line = '', toldValues = new Map();
    const python = {
      async ask({ robot: name }, bytes) {
        const text = new TextDecoder().decode(bytes);
        await later(delay());
        const shows = [...text.matchAll(/SHOW\((\w+)\)/g)].map(([, sensor], k) => [k, sensor, 1, 1, false, false]);
        return { image: text, program: `${name} ${text}`, places: shows.map(([offset]) => [offset]), shows };
      },
    };
    const watch = new SensorWatch({
      python,
      async ask({ image, robot: name }) {
        await later(delay());
        if (name !== robot) return null;
        line = `${name} ${image}`;
        return { ok: true };
      },
      say() {},
      onWatchingChange() {},
    });
    const observe = () => page.byId('senses').hidden || page.byId('gauges').children.map((row) => row.children[1].textContent);
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(200));
      robot = random.of(['tinibot', 'liner']);
      toldValues = new Map();
      line = '';
      watch.onRobotChange({ robot, owner: 'free', is_idle: true, is_running: false });
      if (!wasWanted) page.byId('link_watch').click();
      wasWanted = true;
      const observations = [observe()];
      for (let k = 1 + random.below(6); k > 0; k -= 1) {
        await wait(random.below(400));
        const sensors = devicesOf(robot, 'sensor').map(({ text }) => text), at = random.below(sensors.length);
        if (line.includes('SHOW')) {
          watch.onEvent({ event: 'SHOW', program: line, at, value: String(k) }, false);
          toldValues.set(sensors[at], String(k));
        }
        await wait(50);
        observations.push(observe());
        const shownCount = page.byId('senses').hidden ? 0 : page.byId('gauges').children.filter((row) => row.children[1].textContent).length;
        if (shownCount !== toldValues.size) throw new Error(`${shownCount} sensors are seen, and ${toldValues.size} were told`);
      }
      const end = toldValues.size ? 'told' : 'silent';
      robot = null;
      watch.onRobotChange(null);
      await wait(500);
      return { ends: [end], seen: [observations, line] };
    };
  },

  // A page in one group after another, which it may leave, or be left by, or never get into: in each it is in that one alone,
  // and outside of all nothing of them is left.
  async member() {
    const page = freshPage();
    document.documentElement.dataset['class'] = '';
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    const { EditorState } = await import(pathToFileURL(`${sources}/../node_modules/@codemirror/state/dist/index.js`).href);
    const { Membership } = await page.load('class/member.js');
    const { pageState } = await page.load('page/page_state.js');
    const { loadText } = await page.load('page/kept.js');
    let undo = null;
    let group = null; // of the blocks
    let others = [];
    let isWitness = false;
    const view = {
      state: EditorState.create(), hasFocus: false, composing: false,
      dispatch(change) { this.state = this.state.update(change).state; },
    };
    let delay = () => 5;
    let fails = () => false;
    const answer = { version: 1, changes: [], ids: [], drafts: [], pending: [], since: 0, epoch: '', told: 0, why: '', count: 0, kept: { name: 'page' } };
    const python = {
      async ask() {
        await later(delay());
        if (fails()) throw new Broken();
        return answer;
      },
    };
    const member = new Membership({
      python, work: { text: '' }, keepProgram() {},
      editor: { setUndoHandler: (callback) => { undo = callback; }, extend: () => view },
      views: { isBusy: false, showMates() {}, join: (shared) => { group = shared; } },
      panel: { onGroupEvent: () => { isWitness = true; }, endWitness: () => { isWitness = false; } },
    }, { onStateChange() {}, onBug() {}, onMatesChange: (all) => { others = all; } });
    let requests = []; // of the class, since the newest join or leave
    let isGone = () => false;
    replaceFetch(async (_, { body }) => {
      const request = JSON.parse(body);
      requests.push(request.do);
      await later(delay());
      if (fails()) throw new Broken();
      if (request.do === 'group_join') return responseOf(fails() ? { failure: 'group_full' } : { group: request.name });
      if (request.do === 'group_leave') return responseOf({});
      await later(400);
      if (isGone()) return responseOf({ left: true });
      return responseOf({ saw: 1, ran: ['class', 1], runs: [{ number: 1, event: 'DONE' }], others: [{ name: 'Luz', mark: 0, at: '', writes: false }], changes: [] });
    });
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(200));
      fails = () => !isGood && random() < 0.15;
      isGone = () => !isGood && random() < 0.2;
      let end = '';
      const actions = {
        join: () => member.join({ do: 'group_join', name: random.of(['one', 'other']) }),
        leave: () => member.isInGroup && member.leave(),
        end: () => member.isInGroup && member.endMembership(),
        edit: () => member.finishEdit(),
      };
      const isOutside = () => !member.isInGroup && pageState.groupName.value === '' && !document.documentElement.dataset['group'] && !others.length && !isWitness && undo === null && group === null && !loadText('tiniscript.group', 'sessionStorage');
      for (let k = isGood ? 0 : 2 + random.below(8); k > 0; k -= 1) {
        end = random.of(['join', ...Object.keys(actions)]);
        actions[end]();
        await wait(random.below(900));
      }
      [fails, isGone] = [() => false, () => false];
      await wait(4000);
      if (member.isInGroup) member.leave();
      await wait(isGood ? 0 : 50);
      if (!isOutside()) throw new Error(`something is left of a group: ${JSON.stringify([member.isInGroup, pageState.groupName.value, document.documentElement.dataset['group'], others, isWitness, undo, group, loadText('tiniscript.group', 'sessionStorage')])}`);
      await wait(1500);
      requests = [];
      await wait(5000);
      if (requests.length) throw new Error(`outside of all groups it asks ${requests}`);
      member.join({ do: 'group_join', name: 'third' });
      await wait(3000);
      const seen = [member.isInGroup, pageState.groupName.value, document.documentElement.dataset['group'], others.length, isWitness, group !== null, requests.length];
      if (!member.isInGroup || pageState.groupName.value !== 'third' || !others.length) throw new Error(`it is not in the group: ${seen}`);
      member.leave();
      await wait(1500);
      if (!isOutside()) throw new Error('something is left of the last group');
      return { ends: [end], seen: isGood && seen };
    };
  },

  // The editor of one group after another, while others write, too, and requests are lost, late or refused: what was
  // written is there once, for all; the class knows where the page is, and the page where the others are; one request
  // waits for news and one brings changes, at a time; who has left asks and hears nothing more.
  async together() {
    const page = freshPage();
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    const cm = (name) => import(pathToFileURL(`${sources}/../node_modules/@codemirror/${name}/dist/index.js`).href);
    const [{ EditorState, StateEffect, Transaction }, { EditorView }] = [await cm('state'), await cm('view')];
    const { SharedEditor } = await page.load('class/together.js');
    const { text: textFor } = await page.load('page/texts.js');
    const view = {
      state: EditorState.create(), hasFocus: true, composing: false,
      dispatch(...specs) {
        const startState = this.state, transaction = startState.update(...specs);
        this.state = transaction.state;
        this.tell({ startState, transactions: [transaction], changes: transaction.changes, docChanged: transaction.docChanged, focusChanged: false });
      },
      tell(fields) {
        const update = { view: this, state: this.state, startState: this.state, transactions: [], docChanged: false, ...fields };
        for (const listener of this.state.facet(EditorView.updateListener)) listener(update);
      },
      setFocus(hasFocus) {
        const focusChanged = this.hasFocus !== hasFocus;
        this.hasFocus = hasFocus;
        this.tell({ focusChanged });
      },
    };
    let undo = null;
    const editor = {
      setUndoHandler: (callback) => { undo = callback; },
      extend(extension) {
        view.state = view.state.update({ effects: StateEffect.appendConfig.of(extension) }).state;
        return view;
      },
    };
    let count = 0; // of lines that somebody has written
    const linesIn = (text) => (text === '' ? [] : text.split('\n'));
    return async (random, isGood) => {
      const key = `class ${(count += 1)}`;
      const room = { lines: [], log: [], version: 0, others: [], caret: null, told: 0, refusals: 0, open: { waits: 0, changes: 0 }, isGone: false };
      const textOf = (lines) => lines.map(({ text }) => text).join('\n');
      const apply = (lines, { kind, id, after, text }) => {
        const index = lines.findIndex((item) => item.id === id);
        if (kind === 'delete') { if (index >= 0) lines.splice(index, 1); } else if (index < 0) lines.splice(lines.findIndex((item) => item.id === after) + 1, 0, { id, text });
      };
      let delay = () => random.below(isGood ? 30 : 300), isLost = () => !isGood && random() < 0.2;
      let afterwards = 0; // asked once it has left
      let isOver = false, isCalm = false, isBroken = false, asked = 0, wrong = '';
      replaceFetch(async (_, { body }) => {
        const { changes, waits, at, writes, since, ran: [known, heard] } = JSON.parse(body);
        if (isOver) afterwards += 1;
        asked += 1;
        const what = waits ? 'waits' : changes ? 'changes' : '';
        if (what && (room.open[what] += 1) > 1) wrong = `${room.open[what]} requests at once`;
        try {
          await later(delay());
          const lost = isLost() ? random.of(['look', 'answer']) : '';
          if (lost === 'look') throw new Broken();
          let slow = false;
          if (changes && !lost && (slow = !isCalm && random() < 0.1)) room.slow_ms = now();
          else if (changes && now() - room.slow_ms < 1500) wrong = 'it does not wait until it may';
          else {
            for (const change of changes ?? []) {
              if (room.log.some(({ uid }) => uid === change.uid)) continue; // it has come before
              room.log.push(change);
              apply(room.lines, change);
            }
          }
          if (at !== undefined) room.caret = { at, writes };
          if (waits) for (let k = 0; k < 8 && room.log.length === since; k += 1) await later(50);
          if (lost) throw new Broken();
          const runs = Array.from({ length: room.told }, (__, k) => ({ number: k + 1 })).filter(({ number }) => known !== key || number > heard);
          return responseOf({ saw: 1, ran: [key, room.told], runs, others: structuredClone(room.others), changes: room.log.slice(since), since: room.log.length, left: room.isGone, slow });
        } finally {
          if (what) room.open[what] -= 1;
        }
      });
      // As much of the worker as knows lines: what was changed is sent until the class has it.
      const known = { decided: [], lines: [], pending: [], since: 0, ids: 0, drafts: [] };
      let stepped = 0;
      const versions = new Map([[0, { shown: [], has: structuredClone(known) }]]); // what each answer has shown, and what was known then
      let worker = Promise.resolve(); // it does one thing after the other
      const python = {
        async ask({ do: action, from: version, news, caret, hot, back, kept: stored }, bytes) {
          if (isOver) afterwards += 1;
          const text = new TextDecoder().decode(bytes);
          await (worker = worker.then(() => later(delay())));
          if (isBroken) throw new Broken();
          if (action === 'group_begin') news = [];
          else {
            const { shown, has } = versions.get(version);
            Object.assign(known, structuredClone(has), { ids: known.ids }); // of an answer that was not used nothing stays
            const written = linesIn(text), had = shown.map((item) => item.text); // what this page has made its text of
            let from = 0, to = 0;
            while (from < Math.min(written.length, had.length) && written[from] === had[from]) from += 1;
            while (to < Math.min(written.length, had.length) - from && written.at(-1 - to) === had.at(-1 - to)) to += 1;
            const isTyped = hot && caret >= from && caret < written.length - to;
            if (back && isCalm && (known.pending.length || isTyped)) wrong = 'what comes before an undo is not decided';
            if (!isTyped) {
              const changes = shown.slice(from, shown.length - to).map(({ id }) => ({ kind: 'delete', id }));
              let after = shown[from - 1]?.id;
              for (const line of written.slice(from, written.length - to)) {
                changes.push({ kind: 'insert', id: `${key} ${(known.ids += 1)}`, after, text: line });
                after = changes.at(-1).id;
              }
              for (const change of changes) {
                change.uid = `${key} ${(known.ids += 1)}`;
                known.pending.push(change);
                apply(known.lines, change);
              }
            } else news = []; // they come once the line is finished
          }
          for (const { changes, since } of news) {
            if (since <= known.since) continue;
            for (const change of changes.slice(changes.length - (since - known.since))) {
              apply(known.decided, change);
              known.pending = known.pending.filter(({ uid }) => uid !== change.uid);
            }
            known.since = since;
          }
          known.lines = structuredClone(known.decided);
          for (const change of known.pending) apply(known.lines, change);
          const isHeld = action !== 'group_begin' && textOf(known.lines) !== text && hot && news.length === 0;
          const next = isHeld ? text : textOf(known.lines);
          let [from, end] = [0, 0];
          while (from < Math.min(next.length, text.length) && next[from] === text[from]) from += 1;
          while (end < Math.min(next.length, text.length) - from && next.at(-1 - end) === text.at(-1 - end)) end += 1;
          const changes = next === text ? [] : [[from, text.length - end, next.slice(from, next.length - end)]];
          versions.set((stepped += 1), { shown: isHeld ? versions.get(version).shown : structuredClone(known.lines), has: structuredClone(known) });
          known.drafts = linesIn(next).map((_, k) => k + 1).filter((k) => (k + stepped) % 4 === 0);
          return { version: stepped, changes, ids: linesIn(next).map((line, k) => known.lines[k]?.id ?? ''), drafts: known.drafts, pending: structuredClone(known.pending), since: known.since, epoch: key, told: room.refusals, why: 'why', count: 0, kept: { name: `page ${stored ?? ''}${stepped}` } };
        },
      };
      const place = { line: 0, writes: false }; // in the blocks
      const heard = { isAnswering: null, places: [], others: [], refused: 0, left: 0, failures: 0, runs: 0, kept: null };
      const { doc: { length } } = view.state;
      view.dispatch({ changes: { from: 0, to: length }, annotations: Transaction.addToHistory.of(false) });
      const shared = new SharedEditor(python, editor, {
        onBug: (error) => { if (isBroken) heard.failures += 1; else wrong = `it fails: ${error?.stack}`; }, onLeft: () => { heard.left += 1; }, onMatesChange: (others) => { heard.others = others; }, onRefusal: () => { heard.refused += 1; }, storePage: (kept) => { heard.kept = kept; },
        onRequestEnd: (is) => { heard.isAnswering = is; }, onMatesMove: (places) => { heard.places = places; }, onRobotEvent: () => { heard.runs += 1; }, isBusy: () => false,
      });
      let hasBegun = false;
      shared.showProgram({}, null).then(() => { hasBegun = true; });
      await wait(random.below(60));
      const ownActs = [], otherActs = [];
      const marks = () => { // lines that somebody else is in
        const found = [];
        for (const item of view.state.facet(EditorView.decorations)) if (typeof item !== 'function') item.between(0, view.state.doc.length, (from, _, { spec }) => { if (/cm-beside/.test(spec.class)) found.push(view.state.doc.lineAt(from).number); });
        return found;
      };
      const write = (text, at) => view.dispatch({ changes: { from: at, insert: text }, selection: { anchor: at + text.length }, userEvent: 'input.type' });
      for (let k = random.below(4); k > 0; k -= 1) { // which the group's program replaces
        view.dispatch({ changes: { from: 0, insert: 'w' }, userEvent: random.of(['input.type', 'input.blocks']) });
        await wait(random.below(60));
      }
      for (let k = 0; !hasBegun && k < 100; k += 1) await wait(50);
      const actions = {
        type() { // a line, sign by sign
          const name = `m${(count += 1)}`;
          ownActs.push(name);
          const { length: end } = view.state.doc;
          if (end) write('\n', end);
          for (const sign of name) write(sign, view.state.doc.length);
        },
        add() { // by a block, or a repair
          const name = `b${(count += 1)}`;
          ownActs.push(name);
          view.dispatch({ changes: { from: 0, insert: view.state.doc.length ? `${name}\n` : name }, userEvent: 'input.blocks' });
        },
        move: () => view.dispatch({ selection: { anchor: random.below(view.state.doc.length + 1) } }),
        blur: () => view.setFocus(!view.hasFocus),
        finish() { shared.finishEdit(); },
        async undo() {
          isCalm = isGood;
          undo('undo');
          await wait(2500);
          isCalm = false;
        },
        others() {
          const name = `t${(count += 1)}`;
          otherActs.push(name);
          room.log.push({ uid: name, kind: 'insert', id: name, after: random.of(room.lines)?.id, text: name });
          apply(room.lines, room.log.at(-1));
        },
        stand() { room.others = ['Luz', 'Teo'].slice(random.below(3)).map((name, mark) => ({ name, mark, at: random.of(room.lines)?.id ?? '', writes: random() < 0.5 })); },
        drive() { room.told += 1; },
        refuse() {
          room.refusals += 1;
          actions.add();
        },
        blocks: () => shared.chooseLine(place.line = random.below(view.state.doc.lines + 1), place.writes = random() < 0.5),
        wait: () => {},
      };
      for (let k = 4 + random.below(14); k > 0; k -= 1) {
        await actions[random.of(['type', 'type', 'others', ...Object.keys(actions)])]();
        await wait(random.of([0, random.below(100), random.below(1500)]));
        if (wrong) throw new Error(wrong);
      }
      if (random() < 0.3) { // the class is silent for a while
        isLost = () => true;
        [asked, heard.isAnswering] = [0, true];
        await wait(7000);
        if (asked > 50 || heard.isAnswering) throw new Error(`a class that is silent is asked ${asked} times, and answers: ${heard.isAnswering}`);
      }
      isLost = () => false;
      delay = () => 5;
      random.of([() => { shared.finishEdit(); }, () => view.setFocus(!view.hasFocus), () => view.dispatch({ selection: { anchor: 0 } })])();
      if (view.state.doc.lineAt(view.state.selection.main.head).number === view.state.doc.lines) view.setFocus(false);
      await wait(9000);
      if (random() < 0.5) shared.chooseLine(place.line = 1, place.writes = true);
      await wait(5000);
      if (wrong) throw new Error(wrong);
      const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
      const lines = linesIn(view.state.doc.toString());
      assertSame(lines, room.lines.map(({ text }) => text), 'the program');
      for (const name of [...ownActs, ...otherActs]) if (lines.filter((line) => line === name).length !== 1) throw new Error(`${name} is ${lines.filter((line) => line === name).length} times in ${lines}`);
      const mates = room.others.map(({ at, name, writes: isWriting }) => [room.lines.findIndex(({ id }) => id === at) + 1, isWriting ? `${name} …` : name]).filter(([line]) => line);
      assertSame(heard.places.map(({ line, label }) => [line, label]), [...mates, ...known.drafts.map((item) => [item, textFor('group_draft')])], 'where the others are, and what no other page has');
      assertSame(heard.others, room.others, 'who is here');
      const line = place.line || view.state.doc.lineAt(view.state.selection.main.head).number;
      if (room.lines[line - 1]) assertSame(room.caret, { at: room.lines[line - 1].id, writes: place.line ? place.writes : false }, 'where this page is');
      assertSame(marks(), [...heard.places.map(({ line: item }) => item)].sort((a, b) => a - b), 'what is marked in the text');
      assertSame([heard.isAnswering, heard.runs, heard.left, heard.refused > 0 || !room.refusals], [true, room.told, 0, true], 'what was heard');
      const before = view.state.doc.toString(), end = random.of(['left', 'gone', 'fails']);
      if (end === 'left') shared.end();
      room.isGone = end === 'gone';
      isBroken = end === 'fails';
      if (isBroken) shared.finishEdit();
      isOver = end === 'left';
      await wait(1500);
      assertSame([heard.left, heard.failures, undo, heard.places.length, marks().length], [Number(end === 'gone'), Number(end === 'fails'), null, 0, 0], 'once it is over');
      isOver = true;
      actions.others();
      view.dispatch({ changes: { from: 0, insert: 'x' }, userEvent: 'input.type' });
      actions.move();
      await wait(5000);
      if (afterwards) throw new Error(`${afterwards} times something is asked outside of the group`);
      assertSame(view.state.doc.toString(), `x${before}`, 'the text of who has left');
      return { ends: [end], seen: [] };
    };
  },

  // What a page of a group hears from its class, which has begun anew: each event of the robot once, in its order, whatever
  // answers are lost or late; who else is here is as the class has it; and who has heard all says so, or the class would
  // answer at once, again and again.
  async news() {
    const page = freshPage();
    const { NewsCursor } = await page.load('class/news_cursor.js');
    const heard = new NewsCursor();
    let classes = 0;
    return async (random, isGood) => {
      const key = `class ${(classes += 1)}`;
      const runs = [];
      const takenRuns = [];
      let version = 0;
      let others = 0; // as of this version
      let isLost = () => random() < 0.3;
      const ask = async () => {
        const [known, number] = heard.position.ran;
        const answer = { saw: version, ran: [key, runs.length], runs: runs.filter((item) => known !== key || item > number).map((item) => ({ number: item })) };
        await later(random.below(200));
        if (isLost()) return;
        others = answer.saw;
        takenRuns.push(...heard.take(answer).map((item) => item.number));
      };
      const actions = { ask, tell: () => runs.push(runs.length + 1), move: () => { version += 1; } };
      let end = '';
      for (let k = 2 + random.below(30); k > 0; k -= 1) {
        end = random.of(['ask', ...Object.keys(actions)]);
        actions[end]();
        await wait(random.below(100));
      }
      await wait(200); // a class that has ended answers no more
      if (!isGood) return { ends: [end], seen: false };
      isLost = () => false;
      const hasHeard = () => JSON.stringify(heard.position) === JSON.stringify({ saw: version, ran: [key, runs.length] });
      for (let k = 0; k < 2 && !hasHeard(); k += 1) { // else its request is held
        actions.ask();
        await wait(200);
      }
      if (!hasHeard()) throw new Error(`it has heard ${JSON.stringify(heard.position)} of ${version}, ${runs.length}`);
      if (`${takenRuns}` !== `${runs}` || others !== version) throw new Error(`it takes ${takenRuns}, ${others} of ${runs}, ${version}`);
      return { ends: [end], seen: takenRuns };
    };
  },

  // What is pressed for a real robot, with breakpoints and without: after STOP the page starts nothing before somebody presses
  // anew, however late its answers come, and what is pressed then starts.
  async orders() {
    let delay = () => 5;
    let wantedAction = ''; // what was pressed since the newest STOP
    let stops = 0;
    let wrong = '';
    let started = 0;
    let robot = null;
    const page = freshPage({
      ...REAL_SIDE,
      HostRobot: class {
        constructor(heard) {
          this.heard = heard;
          robot = this;
        }
        async connect() {
          return { name: 'A', id: '1', robot: 'tinibot', owner: 'free', room: 300, is_running: false, has_remote: true, has_breakpoints: true };
        }
        async ask({ do: action, runs }) {
          const isStart = action === 'start' || action === 'live' || (action === 'upload' && runs);
          if (isStart && !wantedAction) wrong = action;
          const before = stops;
          await later(delay()); // what is asked before a stop and comes after it is void
          if (before !== stops) return { failure: 'stopped_elsewhere' };
          if (isStart) {
            started += 1;
            this.heard.onEvent({ event: 'STARTED', program: 'ff', is_program: action !== 'live' });
          }
          await later(delay());
          return { ok: true, program: 'ff' };
        }
        stop() { stops += 1; }
        leave() {}
      },
    });
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { RunningPlace } = await page.load('robot/place.js');
    const { RobotPanel } = await page.load('robot/panel.js');
    pageState.robotName.set('tinibot');
    const whole = { ...PROGRAM, program: 'ff', bytes: 9, halts: [0], findings: [], start: 'SI' };
    pageState.checkResult.set(whole);
    const python = { tryAgain() {}, ask: () => later(delay(), { ...whole, program: 'ee', image: 'ee' }) };
    const panel = new RobotPanel({ python, goTo() {}, recorder: noting([], 'recorder'), place: new RunningPlace(), pad: noting([], 'pad') });
    await wait(10);
    panel.connectByHost('p');
    await wait(100);
    const presses = {
      run: () => page.byId('link_upload').click(),
      start: () => page.byId('link_start').click(),
      step: () => page.byId('link_step').disabled || page.byId('link_step').click(),
      line() {
        page.byId('link_line').value = 'F(1, 80)';
        page.byId('link_live').dispatchEvent(Object.assign(new Event('submit'), { preventDefault() {} }));
      },
    };
    const others = {
      send: () => page.byId('link_send').click(),
      points: (random) => pageState.breakpoints.set(random() < 0.5 ? [] : [{ line: 1, column: 1, point: {} }]),
      halt: () => robot.heard.onEvent({ event: 'HALTED', at: 0, task: 0, program: 'ff', is_program: true }),
      end: (random) => robot.heard.onEvent(random.of([{ event: 'DONE' }, { event: 'STOPPED', cause: 'BUTTON' }])),
    };
    const stop = (random) => {
      wantedAction = '';
      if (random() < 0.5) page.byId('stop').click();
      else dispatchEvent(Object.assign(new Event('keydown'), { key: 'Escape' }));
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(150));
      let end = '';
      for (let k = 3 + random.below(8); k > 0; k -= 1) {
        end = random.of(['stop', 'stop', ...Object.keys(presses), ...Object.keys(presses), ...Object.keys(others)]);
        if (end === 'stop') stop(random);
        else if (presses[end]) {
          wantedAction = end;
          presses[end]();
        } else others[end](random);
        await wait(random() < 0.7 ? random.below(60) : random.below(900));
        if (wrong) throw new Error(`${wrong} after a STOP`);
      }
      stop(random);
      await wait(1500);
      others.end(random);
      const before = started;
      wantedAction = random.of(['run', 'start', 'line']);
      presses[wantedAction]();
      await wait(1500);
      if (wrong) throw new Error(`${wrong} after a STOP`);
      if (started !== before + 1) throw new Error(`${wantedAction} starts ${started - before} times`);
      stop(random);
      await wait(1500);
      return { ends: [end], seen: [] };
    };
  },

  // One robot after another, with all that each can tell and be asked: what is seen of the next one is what is seen of a
  // first one. What starts halts where it is to, values are those of the newest halt, the sensors come back after a program
  // and not after a STOP, and that it waits is said only while it does.
  async robots() {
    let robot = null;
    let info = {};
    let delay = () => 5;
    let plotted = [];
    let wrong = '';
    const own = { program: 'ff', is_program: true };
    const page = freshPage({
      ...REAL_SIDE,
      Plot: class {
        clear() { plotted = []; }
        add(at_ms, values) { plotted.push([Math.round(at_ms), ...values.map(({ value }) => value)]); }
        draw() {}
      },
      HostRobot: class {
        constructor(heard) {
          this.heard = heard;
          this.ended = new Promise((_, reject) => { this.reject = reject; });
          this.ended.catch(() => {});
          this.way = this.ended; // one thing after the other
          this.open = new Set(); // when each that has no answer was asked
          this.halts = this.stops = 0;
          robot = this;
        }
        async connect() {
          await Promise.race([later(delay()), this.ended]);
          this.isMet = true;
          this.isBusy = info.is_running; // as far as the page has heard
          return { name: 'A', id: '1', robot: 'tinibot', owner: 'free', room: 300, has_remote: true, ...info };
        }
        async ask(request) {
          if (request.do === 'upload') [this.hasText, this.wanted] = [true, pageState.breakpoints.value.length ? '3' : ''];
          if (this.isBusy && /FOREVER/.test(request.image)) wrong = 'sensors are watched in the place of a program';
          this.isBusy ||= request.do === 'upload' || request.do === 'start';
          const sentRequest = { at_ms: now(), request };
          const { wanted, stops } = this;
          this.open.add(sentRequest);
          const before = this.way;
          this.way = (async () => {
            await Promise.race([before === this.ended ? null : before, this.ended]);
            await Promise.race([later(delay()), this.ended]);
            const answer = stops === this.stops ? this.obey(request, wanted) : { failure: 'stopped_elsewhere' };
            await Promise.race([later(delay()), this.ended]);
            return answer;
          })();
          this.way.catch(() => {});
          try {
            return await this.way;
          } finally {
            this.open.delete(sentRequest);
          }
        }
        obey({ do: action, image, places, runs }, wanted) {
          if (action === 'upload' || action === 'live') this.points = '';
          if (action === 'upload') this.isOurs = true;
          if (['upload', 'live', 'start', 'resume'].includes(action)) this.isHalted = false;
          if (['upload', 'live', 'start'].includes(action)) this.isWatching = /FOREVER/.test(image);
          if (action === 'break') this.points = places.filter((offset) => offset).join();
          if ((action === 'start' || runs) && this.isOurs && info.has_breakpoints && this.points !== wanted) wrong = `it is to halt at '${wanted}', and halts at '${this.points}'`;
          if (action === 'start' || runs) this.tell(this.isOurs ? { event: 'STARTED', ...own } : { event: 'STARTED', program: 'dd', is_program: false });
          if (action === 'live') {
            this.line = image;
            this.tell({ event: 'STARTED', program: image, is_program: false });
          }
          if (action === 'variables') return { ok: true, variables: [this.halts] };
          if (action === 'tasks') return { ok: true, tasks: [['ENDED', 0], ['WAITING', 3]] };
          return { ok: true, program: 'ff', saved: 'MEMORY' };
        }
        stop() {
          this.stops += 1;
          this.isWatching = this.isBusy = false;
        }
        tell(event) {
          const isOther = !['SHOW', 'READING'].includes(event.event) && event.program !== this.line; // than a line that is on its way
          if (!this.isMet || this.isOver || (isOther && [...this.open].some(({ request }) => request.do === 'live'))) return;
          if (event.event === 'HALTED') {
            if (this.isHalted) return;
            this.isHalted = true;
            this.halts += 1;
          } else if (event.event === 'PLACE') this.isWatching = false; // it was begun by its button
          else if (!['SHOW', 'READING'].includes(event.event)) {
            this.isHalted = false;
            this.isWatching &&= event.program === this.line;
            this.isBusy = event.event === 'STARTED' && event.program !== this.line;
          }
          this.heard.onEvent(event);
        }
        end(error) {
          if (this.isOver) return;
          this.isOver = true;
          this.reject(new ConnectionFailure(error));
          this.heard.onEnd(new ConnectionFailure(error));
        }
        leave() { this.end('left'); }
      },
    });
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    const { ConnectionFailure } = await page.load('robot/transport.js');
    const { pageState } = await page.load('page/page_state.js');
    const { text } = await page.load('page/texts.js');
    const { RunningPlace } = await page.load('robot/place.js');
    const { Recorder } = await page.load('robot/recorder.js');
    const { Runs } = await page.load('virtual/runs.js');
    const { RobotPanel } = await page.load('robot/panel.js');
    let message = '';
    Object.defineProperty(page.byId('link_said'), 'textContent', { get: () => message, set(sentence) {
      message = sentence;
      if (sentence === text('say_waits') && ![...robot?.open ?? []].some(({ at_ms }) => now() - at_ms >= 2000)) throw new Error('it says that it waits, and does not');
    } });
    pageState.robotName.set('tinibot');
    pageState.sideId.set('side_real');
    pageState.programText.set('X = DISTANCE;\nSHOW(X)');
    let moved = 0; // lines, by what was written before them
    const type = (lines) => {
      moved = lines;
      pageState.checkResult.set(null);
      pageState.programText.set(`${'\n'.repeat(moved)}X = DISTANCE;\nSHOW(X)`);
      pageState.breakpoints.set(pageState.breakpoints.value.map((item) => ({ ...item, line: 2 + moved })));
      pageState.checkResult.set({ ...PROGRAM, program: 'ff', bytes: 9, places: [[0, 1 + moved, 1, 1 + moved, 13], [3, 2 + moved, 1, 2 + moved, 8]], halts: [0, 3], findings: [], start: 'SI' });
    };
    type(0);
    const check = async (_, bytes) => {
      const image = new TextDecoder().decode(bytes);
      await later(delay());
      const shows = [...image.matchAll(/SHOW\((\w+)\)/g)].map(([, sensor], k) => [k, sensor, 1, 1, false, false]);
      return { image, program: image, places: shows.map(([offset]) => [offset]), shows, findings: [], variables: [], remote: [] };
    };
    const runs = new Runs();
    const panel = new RobotPanel({ python: { tryAgain() {}, ask: check }, goTo() {}, recorder: new Recorder({ runs, play() {} }), place: new RunningPlace(), pad: noting([], 'pad') });
    await wait(10);
    page.byId('senses').hidden = page.byId('link_doing').hidden = true; // as in index.html
    const press = (id) => page.byId(id).disabled || page.byId(id).hidden || page.byId(id).click();
    const actions = {
      begin: () => { robot.isOwn ||= robot.isOurs; robot.tell({ event: 'STARTED', ...own }); },
      others: () => robot.tell({ event: 'STARTED', program: 'dd', is_program: false }),
      place: (random) => robot.tell({ event: 'PLACE', at: random.of([0, 3]), program: 'ff' }),
      halt: (random) => robot.tell({ event: 'HALTED', at: random.of([0, 3, 1]), task: 0, ...own }),
      show: (random) => robot.tell({ event: 'SHOW', at: random.below(3), value: String(random.below(9)), program: random() < 0.7 ? robot.line ?? 'ff' : 'ff' }),
      read: (random) => robot.tell({ event: 'READING', rows: [[random.below(99), random.of(['READ DISTANCE 5', 'READ DISTANCE 7', 'UNREAD DISTANCE'])]] }),
      end: (random) => robot.tell({ event: random.of(['DONE', 'STOPPED', 'FAULT', 'RESTARTED', 'LOST']), cause: random.of(['BUTTON', 'MESSAGE']), fault: 'STUCK', at: 3, program: 'ff' }),
      upload: () => press('link_upload'),
      start: () => press('link_start'),
      step: () => press('link_step'),
      goOn: () => press('link_go_on'),
      identify: () => press('link_identify'),
      watch: () => robot.open.size || press('link_watch'),
      stop: () => page.byId('stop').click(),
      points(random) {
        const breakpoints = random() < 0.4 ? [] : [{ line: 2 + moved, column: 1, point: {} }];
        robot.wanted = breakpoints.length && robot.hasText ? '3' : '';
        pageState.breakpoints.set(breakpoints);
      },
      type(random) { // the robot has its breakpoints where they were
        type(1 + random.below(3));
        robot.hasText = false;
      },
      async line() {
        if (robot.open.size) return;
        page.byId('link_line').value = 'F(1, 80)';
        page.byId('link_live').dispatchEvent(Object.assign(new Event('submit'), { preventDefault() {} }));
        await wait(delay());
      },
      async twice(random) {
        if (robot.open.size) return;
        press('link_watch');
        await wait(random.below(20));
        press('link_watch');
      },
      async startAgain(random) { // after a line, which takes the breakpoints away; perhaps before it is sent
        const awaitAnswers = async () => { for (let k = 0; robot.open.size && k < 90; k += 1) await wait(100); };
        await awaitAnswers();
        if (isWatched()) actions.watch();
        await awaitAnswers();
        actions.upload();
        await awaitAnswers();
        actions.points(random);
        await awaitAnswers();
        await actions.line();
        if (random() < 0.5) await awaitAnswers();
        if (random() < 0.5) actions.type(random);
        robot.tell({ event: 'DONE' });
        actions.start();
        await awaitAnswers();
      },
      again(random) { // it halts, ends and halts, and nobody had time to look
        actions.halt(random);
        robot.tell({ event: 'DONE' });
        actions.begin();
        actions.halt(random);
      },
      sense() {
        robot.tell({ event: 'SHOW', at: 0, value: '9', program: robot.line });
        actions.begin();
        robot.tell({ event: 'READING', rows: [[5, 'READ DISTANCE 5']] });
      },
      wait: () => wait(2500),
    };
    const isWatched = () => page.byId('link_watch').attributes['aria-pressed'] === 'true';
    const gauges = () => page.byId('senses').hidden || page.byId('gauges').children.map((row) => row.children[1].textContent);
    const values = () => page.byId('link_values').hidden || page.byId('link_values').children.map((row) => row.children[1].textContent);
    const observe = () => [
      message, page.byId('link_doing').hidden || page.byId('link_doing').textContent, document.documentElement.dataset['halt'], structuredClone(pageState.robotRun.value),
      values(), ['link_step', 'link_go_on', 'link_breakpoints'].map((id) => [page.byId(id).hidden, page.byId(id).disabled]),
      gauges(), isWatched(), [...plotted], robot?.isOwn && [page.byId('record_lacks').hidden || page.byId('record_lacks').textContent, runs.newestFirst[0]?.rows],
    ];
    /** The sensors are watched, and a program comes first, whatever was before. */
    const checkWatching = async (byHand) => {
      const assertWatched = (isOn, when) => { if (isWatched() !== isOn) throw new Error(`${isOn ? 'nothing is' : 'something is still'} watched ${when}`); };
      robot.tell({ event: 'DONE' });
      await wait(100);
      if (!isWatched()) actions.watch();
      await wait(1500);
      assertWatched(true, 'where somebody wants it');
      actions.identify();
      await wait(1500);
      assertWatched(true, 'after something else was asked');
      actions.upload();
      actions.begin();
      assertWatched(false, 'beside a program');
      await wait(1500);
      assertWatched(false, 'beside a program');
      robot.tell({ event: 'DONE' });
      await wait(1500);
      assertWatched(true, 'after a program');
      robot.tell({ event: 'SHOW', at: 0, value: '4', program: robot.line });
      await wait(50);
      if (gauges()[0][0] !== '4') throw new Error(`the gauges say ${gauges()} and not what is watched`);
      if (byHand) actions.stop();
      robot.tell({ event: 'STOPPED', cause: byHand ? 'SEQUENCE' : 'BUTTON' });
      await wait(3000);
      assertWatched(false, 'after a STOP');
      actions.upload();
      actions.begin();
      await wait(100);
      robot.tell({ event: 'DONE' });
      await wait(3000);
      assertWatched(false, 'since a STOP');
    };
    return async (random, isGood) => {
      const slow = () => (random() < 0.1 ? 2500 : random.below(300));
      delay = isGood ? () => 5 : slow;
      robot = null;
      window.localStorage.removeItem('tiniscript.watches');
      if (random() < 0.4) window.localStorage.setItem('tiniscript.watches', 'on');
      pageState.breakpoints.set([]);
      type(0);
      info = { has_breakpoints: random() < 0.8, has_readings: random() < 0.5, ...random.of([{ is_running: true, is_idle: false }, { is_running: false, is_idle: true }, { is_running: false, is_idle: false }]) };
      panel.connectByHost('p');
      const observations = [observe()];
      await settle();
      robot.points = robot.wanted = '';
      const ends = new Set();
      await wait(isGood ? 50 : random.below(400));
      if (random() < 0.6) actions.upload();
      for (let k = 4 + random.below(12); k > 0; k -= 1) {
        const end = random.of(['begin', 'halt', 'show', 'show', ...Object.keys(actions)]);
        ends.add(end);
        await actions[end](random);
        observations.push([observe(), page.byId('link_shown').textContent]);
        await wait(random.below(random.of([50, 400])));
        const { halt } = document.documentElement.dataset;
        if (wrong) throw new Error(wrong);
        if (halt === 'read' && values()[0] !== String(robot.halts)) throw new Error(`its values are ${values()} at halt ${robot.halts}`);
        if (pageState.robotRun.value.isHeld && halt !== 'read' && halt !== 'halted') throw new Error('it is seen as halted, and goes on');
      }
      await wait(8000);
      if (wrong) throw new Error(wrong);
      if (robot.isWatching && !isWatched()) throw new Error('its sensors are read, and nobody watches them');
      observations.push(observe());
      if (isGood) await checkWatching(random() < 0.5);
      else { // it is gone before the answer
        robot.tell({ event: 'DONE' });
        if (!isWatched() && random() < 0.7) actions.watch();
        await wait(6000);
        await actions[random.of(['watch', 'line', 'step', 'identify', 'identify', 'sense', 'sense'])](random);
      }
      robot.end(random.of(['left', 'unheard']));
      await wait(isGood ? 50 : random.below(200));
      return { ends: [...ends], seen: observations };
    };
  },

  // STOP for all robots, pressed again and again.
  async stops() {
    const page = freshPage();
    let room = null;
    replaceNavigator({});
    replaceFetch((_, { body }) => room(JSON.parse(body)));
    await loadTexts(page);
    replaceFetch((_, { body }) => room(JSON.parse(body)));
    const { stopAll } = await page.load('robot/stops.js');
    const { text } = await page.load('page/texts.js');
    const place = page.byId('stops');
    const observe = () => [place.hidden, place.dataset['confirmed'], place.children.map((item) => item.textContent ?? item)];
    return async (random, isGood) => {
      const late_ms = isGood ? 5 : 5 + random.below(700);
      const robots = ['A', 'B'].map((name) => ({ name, late_ms: random.of([100, 900, 1500, 1e9]) }));
      const lossRate = isGood ? 0 : random.of([0.2, 0.2, 0.6, 1]);
      let began_ms = now();
      room = async (request) => {
        await later(late_ms);
        if (random() < lossRate) throw new Broken();
        if (request.do === 'stop_all') began_ms = now();
        isAnswered = true;
        return responseOf({ robots: robots.map((item) => ({ name: item.name, stop: now() - began_ms < item.late_ms ? 'asked' : 'confirmed' })) });
      };
      let isAnswered = false;
      stopAll();
      const seen = [];
      for (let k = isGood ? 60 : random.below(20); k > 0; k -= 1) {
        await wait(100);
        if (k < 55) seen.push(observe()); // the answer is there
        if (isAnswered && isGood && JSON.stringify(observe()).includes(text('stops_gone'))) throw new Error('it says that nobody has heard it, and all have');
      }
      if (!isGood && random() < 0.5) { // whatever gets lost, each that confirms is counted; where all is, that is said
        await wait(12_000);
        const hasNotice = JSON.stringify(observe()).includes(text('stops_gone'));
        if (isAnswered === hasNotice) throw new Error(`it is ${isAnswered ? 'heard' : 'lost'}, and it says ${observe()}`);
        if (!isAnswered && lossRate < 0.5) throw new Error('it is not asked again');
        if (!isAnswered) return { ends: ['unheard'], seen };
        const confirmedCount = robots.filter((item) => item.late_ms < 1e6).length;
        if (place.dataset['confirmed'] !== `${confirmedCount}`) throw new Error(`${confirmedCount} have confirmed, and it says ${place.dataset['confirmed']}`);
        await wait(20_000); // a robot that has not confirmed may drive; that all stood says nothing of now
        if (place.hidden === confirmedCount < robots.length) throw new Error(`${confirmedCount} have confirmed, and later it is ${place.hidden ? 'hidden' : `said: ${observe()}`}`);
      } else if (!isGood) await wait(random.below(14_000)); // what it says of this stop hides nothing of the next one
      return { ends: [isGood ? 'over' : robots.some((item) => item.late_ms > 1e6) ? 'silent' : 'confirmed'], seen };
    };
  },

  // The worlds that were drawn or opened, in a tab that is loaded again: the newest and those before it are there as they were
  // when they were last kept, but those that no file can say, and those that nobody can read.
  async worlds() {
    const MAX_EARLIER = 5;
    return async (random) => {
      const page = freshPage();
      await loadTexts(page);
      const { OwnWorlds } = await page.load('world/own.js');
      const { loadWorldTexts } = await page.load('programs/work.js');
      const unreadable = new Set();
      let madeCount = 0, delay = () => 5, askCount = 0, isReady = true, wrong = '';
      const textOf = ({ id = 0 }) => (id % 7 ? `text of ${id}\n# no name` : '');
      const python = () => ({
        ready: later(isReady ? 0 : 200).then(() => { isReady = true; }),
        async ask({ do: action, form, name }, data) {
          if (!isReady) wrong = 'it is asked before it is there';
          askCount += 1;
          await later(delay());
          if (action === 'write_world') return textOf(form) ? { text: textOf(form) } : { refused: ['no'] };
          const text = new TextDecoder().decode(data), id = Number(/^text of (\d+)\n# no name$/.exec(text)?.[1]);
          return id && !unreadable.has(id) ? { world: { name, id } } : {};
        },
      });
      let own = new OwnWorlds(python());
      let worlds = [null]; // the newest first
      let keptWorlds = [null];
      let newest = 0; // of the times that they were kept
      const readWorlds = () => [own.newestWorld, ...own.earlierWorlds].map((world) => world && [world.id, world.name]);
      const rowOf = (list) => list.map((world) => world && [world.id, world.name]);
      const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
      const setRoom = (hasRoom) => { window.localStorage.room = window.sessionStorage.room = hasRoom ? Infinity : 0; };
      const setNewest = (world, isOther) => {
        const [before, ...earlier] = worlds;
        worlds = [world, ...isOther && before ? [before] : [], ...earlier].slice(0, 1 + MAX_EARLIER);
      };
      const actions = {
        draw() {
          const world = { id: (madeCount += 1), name: random.of(['', 'n', '# n']) }, isOther = random() < 0.6;
          setNewest(world, isOther);
          own.setNewest(world, isOther);
        },
        earlier() {
          const index = random.below(MAX_EARLIER), [, ...earlier] = worlds, world = earlier[index];
          own.restoreEarlier(index);
          if (!world) return;
          worlds = [worlds[0], ...earlier.filter((item) => item !== world)];
          setNewest(world, true);
        },
        keep() {
          const number = (newest += 1), worldsBefore = worlds, hasRoom = random() < 0.8;
          setRoom(hasRoom);
          own.storeTexts('tinibot').then((isKept) => {
            if (number !== newest) return assertSame(isKept, true, 'what a newer one says');
            assertSame(isKept, window.localStorage.room > 0, 'whether it is kept');
            if (isKept) keptWorlds = [textOf(worldsBefore[0] ?? {}) ? worldsBefore[0] : keptWorlds[0], ...worldsBefore.slice(1)]; // one that nobody can write takes no other's place
          }).catch((error) => { wrong = String(error); });
        },
        async reload() {
          await wait(3000);
          setRoom(true);
          for (const world of keptWorlds) if (world && random() < 0.15) unreadable.add(world.id);
          isReady = random() < 0.5;
          own = new OwnWorlds(python());
          const isThere = ([world]) => Boolean(world && textOf(world) && !unreadable.has(world.id));
          const [before, ...earlier] = keptWorlds, hadText = before && textOf(before);
          let isWhole = null;
          own.restore().then((found) => { isWhole = found; });
          await wait(3000);
          assertSame(isWhole, !hadText || isThere([before]), 'whether it is whole');
          worlds = [isThere([before]) ? before : null, ...earlier.filter((world) => isThere([world]))];
        },
        async rest() { // then nobody has to write them once more
          actions.keep();
          await wait(3000);
          askCount = 0;
          actions.keep();
          await wait(3000);
          assertSame(askCount, 0, 'how often they are written');
        },
        wait: () => {},
      };
      const ends = new Set();
      for (let k = 5 + random.below(20); k > 0; k -= 1) {
        const act = random.of(['draw', 'draw', 'keep', ...Object.keys(actions)]);
        delay = () => 5 + random.below(random.of([5, 600]));
        ends.add(act);
        await actions[act]();
        await wait(random.of([0, 100, 2000]));
        assertSame(readWorlds(), rowOf(worlds), `after ${act}`);
        if (wrong) throw new Error(wrong);
      }
      await wait(3000);
      const [newestText, ...texts] = keptWorlds.map((world) => (world && textOf(world) ? `${world.name && `# ${world.name}\n`}${textOf(world)}` : ''));
      assertSame(loadWorldTexts(), { newest: newestText, before: texts.filter(Boolean) }, 'what is kept');
      return { ends: [...ends], seen: [] };
    };
  },

  // What is drawn in one world after another is undone and done again in that world alone, change by change.
  async drawing() {
    const page = freshPage();
    await loadTexts(page);
    const { WorldDrawing } = await page.load('world/drawing.js');
    const empty = (name) => ({
      name, labels: { en: name }, width_cm: 200, height_cm: 100, has_border: true, ambient_percent: 50, seconds: 0,
      start: { x_cm: 30, y_cm: 30, heading: 0 }, walls: [], boxes: [], lines: [], lamps: [], flags: [], rings: [], rivals: [],
    });
    let world = empty('w0');
    const choice = { isOwn: false, write: async () => ({ text: 'w' }), storeOwn: async () => true };
    const drawing = new WorldDrawing({ ask: async () => ({ world: empty('opened') }) }, noting([], 'arena'), {
      getWorld: () => world, worldChoice: choice, getRobotPlace: () => [0, 0], isDriving: () => false, switchOff() {}, previewWorld() {}, refresh() {},
      putWorld(changed) {
        world = changed;
        choice.isOwn = true;
      },
    });
    drawing.enable();
    page.byId('world_draw').click();
    const press = (id, detail = 1) => page.byId(`world_${id}`).dispatchEvent(Object.assign(new Event('click'), { detail }));
    const type = (key) => page.byId('arena').dispatchEvent(Object.assign(new Event('keydown'), { key, preventDefault() {} }));
    const KINDS = ['walls', 'boxes', 'lines', 'lamps', 'flags', 'rings', 'rivals'];
    let worlds = 0;
    const actions = {
      add: (random) => press(`add_${random.of(KINDS)}`, 0),
      turn: (random) => press(random.of(['turn_left', 'turn_right'])),
      move: (random) => type(random.of(['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown'])),
      delete: () => press('delete'),
      undo: () => press('undo'),
      redo: () => press('redo'),
      leave() {
        press('done');
        press('draw');
      },
      enter() {
        world = empty(`w${(worlds += 1)}`);
        choice.isOwn = false;
        drawing.reset();
      },
      async open() {
        chooseFile(page.byId('world_file'), new File(['w'], 'w.toml'));
        await wait(50);
      },
    };
    const drawn = () => JSON.stringify({ ...world, name: '', labels: {} });
    let past = [];
    let future = [];
    return async (random) => {
      let end = '';
      for (let k = 4 + random.below(16); k > 0; k -= 1) {
        end = random.of(['add', 'add', 'move', 'undo', 'undo', 'redo', ...Object.keys(actions)]);
        const before = drawn();
        await actions[end](random);
        await wait(random.below(50));
        if (end === 'enter' || end === 'open') past = future = [];
        else if (end === 'undo' || end === 'redo') {
          const [from, to] = end === 'undo' ? [past, future] : [future, past];
          const expected = from.at(-1) ?? before;
          if (drawn() !== expected) throw new Error(`after ${end} it is ${drawn()} and not ${expected}`);
          if (from.length) [past, future] = end === 'undo' ? [past.slice(0, -1), [...to, before]] : [[...to, before], future.slice(0, -1)];
        } else if (drawn() !== before) [past, future] = [[...past, before], []];
        const enabledHistory = ['undo', 'redo'].map((id) => !page.byId(`world_${id}`).disabled);
        if (`${enabledHistory}` !== `${[past, future].map((item) => item.length > 0)}`) throw new Error(`after ${end} it can ${enabledHistory}`);
      }
      return { ends: [end], seen: [] };
    };
  },

  // The programs that were in the editor, as they are kept in a storage of any size: the newest that have room, and who loses
  // one hears of it. One that was deleted may come back.
  async programs() {
    const page = freshPage({ generate: () => ({ toCanvas() {} }), correction: {} });
    replaceNavigator({});
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Programs } = await page.load('programs/programs.js');
    const { loadWork } = await page.load('programs/work.js');
    const { MAX_CHARACTERS, loadVersions, storeVersion } = await page.load('programs/versions.js');
    const { makeLink } = await page.load('programs/links.js');
    const { text: textOf } = await page.load('page/texts.js');
    const { FIRST_PROGRAM } = await page.load('start/beginnings.js');
    const work = { text: FIRST_PROGRAM, robot: 'tinibot', world: 'obstacles', language: 'en', name: '', view: 'text', level: 'few', words: false, sound: true };
    const lineOf = (text) => `line ${text.length} ${text.slice(0, 9)}`;
    let delay = () => 0;
    const ask = async (_, bytes) => {
      await later(delay());
      return { text: lineOf(new TextDecoder().decode(bytes)) };
    };
    const programs = new Programs({ python: { ask }, work, putProgram: (program) => Object.assign(work, program), makePicture() {} });
    let count = 0;
    let now_ms = 1e12;
    Date.now = () => (now_ms += 1);
    let refusal = '';
    pageState.note.subscribe((said) => { refusal ||= said; });
    const refusals = ['not_kept', 'kept_too_long'].map((key) => textOf(key));
    const list = page.byId('versions');
    list.append(document.createElement('li')); // with the button for a new one
    const inForm = (versions) => JSON.stringify(versions.map(({ text, robot, name }) => [text, robot, name]));
    const store = window.localStorage;
    /** It shows the program that is in the editor then, and nothing that was asked of another one. */
    const open = () => {
      page.byId('my_programs').click();
      const shown = [page.byId('share').open, page.byId('programs').dataset.shared, page.byId('program_name').value, page.byId('public').value];
      const expected = [false, undefined, work.name.replace(/\.ts$/, ''), store.getItem('tiniscript.public') ?? ''];
      if (JSON.stringify(shown) !== JSON.stringify(expected)) throw new Error(`the window shows ${JSON.stringify(shown)} in place of ${JSON.stringify(expected)}`);
    };
    const fits = (versions) => versions.length <= 40 && JSON.stringify(versions).length <= store.roomFor('tiniscript.versions')
      && (versions.length < 2 || versions.reduce((sum, { text }) => sum + text.length, 0) <= MAX_CHARACTERS);
    /** The newest are kept, as many as there is room for; where not even one is, all stay that were there. @returns whether this one is there */
    const checkKept = (act, before, expected, version) => {
      let fitCount = version?.text.length > MAX_CHARACTERS ? 0 : expected.length;
      while (fitCount && !fits(expected.slice(0, fitCount))) fitCount -= 1;
      const kept = fitCount || !expected.length ? expected.slice(0, fitCount) : before;
      if (inForm(loadVersions()) !== inForm(kept)) throw new Error(`${act}: ${loadVersions().length} are kept in place of ${kept.length} of ${expected.length}`);
      const isKept = !version || kept.includes(version);
      if (refusals.includes(refusal) === isKept) throw new Error(`${act}: it is ${isKept ? '' : 'not '}kept, and the page says ${refusal}`);
      return isKept;
    };
    const perform = (act) => {
      pageState.note.set('');
      refusal = '';
      return act();
    };
    return async (random, isGood) => {
      const ends = new Set();
      delay = () => random.below(random.of([1, 300]));
      const actions = {
        write: () => { work.text = `// ${(count += 1)}\n${'F(1);'.repeat(1 + random.below(random.of([20, 30_000, 90_000])))}`; },
        again: () => { work.text = random.of(loadVersions())?.text ?? work.text; },
        blank: () => { work.text = ' '; },
        run: () => page.byId('run').click(),
        open,
        new: () => page.byId('new').click(),
        publish() { // another tab does
          const { room } = store;
          store.room = Infinity;
          store.setItem('tiniscript.public', random.of([`http://there.example/${(count += 1)}/`, 'nowhere']));
          store.room = room;
        },
        close: () => page.byId('programs_close').click(),
        async share() { // what is asked last, of what is seen then
          if (!page.byId('programs').open) open();
          page.byId('share').open = true;
          page.byId('share').dispatchEvent(new Event('toggle'));
          const form = random.of(['link', 'line']);
          for (const item of [random.of(['link', 'line']), form]) {
            page.byId(`share_${item}`).click();
            if (page.byId('programs').dataset.shared !== 'asked' || !page.byId('shared').hidden) throw new Error('what was asked before is there still');
            if (random() < 0.3) await wait(random.below(100));
          }
          const address = store.getItem('tiniscript.public') ?? location.href;
          const expected = form === 'line' ? lineOf(work.text) : address === 'nowhere' ? '' : await makeLink(work, address) ?? '';
          while (page.byId('programs').dataset.shared === 'asked') await wait(1); // what is packed waits for the real clock
          await wait(500);
          const shared = page.byId('shared');
          if (shared.value !== expected || shared.hidden !== !expected || page.byId('programs').dataset.shared !== (expected ? 'done' : 'wrong')) throw new Error(`${shared.value} is shared in place of ${expected}`);
          const isLine = page.byId('share_line').attributes['aria-pressed'] === 'true', refusal = page.byId('shared_told').textContent;
          if (isLine !== (form === 'line') || refusal.startsWith(textOf('share_line_told')) !== isLine) throw new Error(`of a ${form} it says: ${refusal}`);
        },
        async ask() { // and what comes of it nobody waits for
          if (!page.byId('programs').open) return;
          page.byId('share_line').click();
          await wait(random.below(100));
        },
        lesson: () => programs.replaceProgram({ text: `S; // ${(count += 1)}`, robot: random.of(['tinibot', 'liner']), name: '' }),
        older: () => {
          open();
          random.of([...list.children, null])?.children[0]?.click();
        },
        rename: () => {
          page.byId('program_name').value = `name ${(count += 1)}`;
          page.byId('program_name').dispatchEvent(new Event('input'));
        },
        hide: () => {
          document.hidden = true;
          document.dispatchEvent(new Event('visibilitychange'));
          document.hidden = false;
        },
        leave: () => dispatchEvent(new Event('pagehide')),
        link: async () => {
          const link = await makeLink({ text: `B(${(count += 1)});`, robot: 'tinibot' }, location.href);
          location.hash = link.slice(link.indexOf('#'));
          dispatchEvent(new Event('hashchange'));
          for (let k = 0; work.text !== `B(${count});` && k < 50_000; k += 1) await settle(); // it waits for the real clock
          if (work.text !== `B(${count});`) throw new Error('the program of a link is not seen');
        },
      };
      const keeping = ['run', 'open', 'new', 'lesson', 'older', 'rename', 'hide', 'leave', 'link'];
      for (let k = random.of([0, 0, 0, 0, 0, 38]); k > 0; k -= 1) storeVersion({ text: `W(${(count += 1)});`, robot: 'tinibot', name: '' });
      for (let k = 4 + random.below(16); k > 0; k -= 1) {
        if (random() < 0.2) store.room = [...store].reduce((sum, [, whole]) => sum + whole.length, 0) + random.of([Infinity, 300_000, 100_000, 1000, 100, 0]);
        const act = random.of(Object.keys(actions));
        const before = { ...work, ...(act === 'rename' && { name: `name ${count + 1}.ts` }) };
        const kept = loadVersions();
        await perform(actions[act]);
        if (!keeping.includes(act) || !before.text.trim() || before.text === FIRST_PROGRAM) continue;
        if (act === 'rename' && store.room === Infinity && loadWork()?.name !== before.name) throw new Error(`its name is ${loadWork()?.name}`);
        const version = { text: before.text, robot: before.robot, name: before.name, at_ms: now_ms };
        const others = kept.filter(({ text, robot }) => text !== before.text || robot !== before.robot);
        ends.add(checkKept(act, kept, [version, ...others], version) ? 'kept' : 'full');
        if (act !== 'open') continue;
        const stored = loadVersions();
        const number = random.below(stored.length);
        const row = list.children[1 + number];
        if (!row?.children[1]) continue; // it is in the editor
        const deleted = stored[number];
        perform(() => row.children[1].click());
        checkKept('deletes', stored, stored.filter((item) => item !== deleted));
        if (random() < 0.5) storeVersion(random.of([{ text: `T(${(count += 1)});`.repeat(random.of([1, 10_000])), robot: 'tinibot', name: '' }, deleted])); // another tab does
        const remaining = loadVersions(), restored = remaining.find(({ text, robot }) => text === deleted.text && robot === deleted.robot);
        perform(() => row.children[0].click());
        checkKept('brings back', remaining, restored ? remaining : [...remaining, deleted].sort((first, second) => second.at_ms - first.at_ms), restored ?? deleted);
      }
      store.room = Infinity;
      return { ends: [...ends], seen: [] };
    };
  },

  // The floor, and the robot on it, as they are drawn.
  async arena() {
    const page = freshPage();
    const drawn = [];
    const pen = (name) => noting(drawn, name, { measureText: () => ({ width: 9 }), getTransform: () => ({ a: 1, e: 0, f: 0 }) });
    document.createElement = () => Object.assign(page.byId('floor'), { getContext: () => floorPen });
    const floorPen = pen('floor'), robotPen = pen('robot');
    globalThis.Path2D = class {};
    const { Arena } = await page.load('virtual/arena.js');
    const { ROBOTS, WORLDS } = await page.load('page/words.js');
    const canvas = Object.assign(page.byId('canvas'), { clientWidth: 400, clientHeight: 300, getContext: () => robotPen });
    const arena = new Arena(canvas);
    arena.resize();
    return async (random, isGood) => {
      const world = isGood ? { ...random.of(WORLDS) } : random.of(WORLDS);
      const robot = random.of(ROBOTS).name;
      const from = drawn.length;
      arena.begin(world, robot, []);
      arena.draw(null);
      let now_ms = 0;
      for (let k = isGood ? 5 : 2 + random.below(20); k > 0; k -= 1) {
        now_ms += random.below(900);
        const state = { now_ms, began_ms: 0, pose: [random.below(100), random.below(100), random.below(360)], motors: [random.below(100), 50], is_running: random() < 0.8, touches: null, rivals: world.rivals.map((item) => [item.x_cm, item.y_cm, item.heading]),
          score: { taken: isGood ? 0 : random.below(3), of: 3, points: 0, stars: 0 }, actuators: [], readings: [], fault: '' };
        arena.followState(state);
        if (!isGood && random() < 0.3) arena.showBubble(`${random.below(9)}`, now_ms);
        if (!isGood && random() < 0.3) arena.showBeep(now_ms, now_ms + 5000);
        arena.draw(state);
      }
      return { ends: [now_ms > 3000 ? 'long' : 'short'], seen: isGood && drawn.slice(from) };
    };
  },

  // The curves of a run.
  async curves() {
    const page = freshPage();
    const { Plot } = await page.load('virtual/plot.js');
    const place = Object.assign(page.byId('place'), { clientHeight: 300 });
    const canvas = Object.assign(page.byId('canvas'), { clientWidth: 400, clientHeight: 300, parent: place });
    document.documentElement.hasAttribute = () => false;
    const drawn = [];
    const pen = noting(drawn, 'pen', { measureText: () => ({ width: 9 }) });
    canvas.getContext = () => pen;
    const plot = new Plot(canvas);
    return async (random, isGood) => {
      plot.clear();
      const count = random.of([3, 100, 1999, 2001, 9000]);
      for (let k = 0; k < count; k += 1) plot.add(20 * k, [{ name: random.of(['X', 'Y']), value: random.below(100) }]);
      drawn.length = 0;
      plot.draw();
      return { ends: [count > 2000 ? 'long' : 'short'], seen: isGood && [...drawn] };
    };
  },

  // The steps of the lesson that is chosen, after others that came late or not at all.
  async steps() {
    const page = freshPage({ replaceOptions() {}, makePictureOption() {}, makeWorldPicture() {} });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Lessons } = await page.load('lesson/lessons.js');
    const LESSONS = [1, 2, 3].map((k) => ({ name: `lesson${k}`, title: `L${k}`, block_title: `L${k}`, robot: 'tinibot', worlds: 1, world: {} }));
    let delay = () => 5;
    let fails = () => false;
    let world = 0;
    let newest = { name: '' }; // that was chosen, unless it could not be had
    const python = {
      tryAgain() {},
      async ask({ do: action, number }) {
        const own = action === 'lesson_steps' ? { name: `L${number}` } : newest;
        newest = own;
        await later(delay());
        if (fails()) {
          own.name = '';
          throw new Broken();
        }
        if (action === 'lesson_titles') return { lessons: LESSONS };
        if (action !== 'lesson_steps') return { verdict: 'passed', seed: 1, worlds: 1, said: [], block_said: [], spoken: {}, run: null };
        const steps = Array.from({ length: 4 - number }, () => ({ blocks: [], hint: `of ${number}` }));
        return { steps, block_steps: steps, taught: [`of ${number}`] };
      },
    };
    let pendingLooks = 0; // see a world that follows from what was pressed
    const driving = {
      async showLesson(number) {
        pendingLooks -= 1;
        await later(delay());
        world = number;
      },
      stop() {},
    };
    page.byId('lesson_end').hidden = true;
    new Lessons({ python, simulatorPanel: driving, putProgram() {}, work: { text: '', robot: '', name: '', lesson: '', own: null } });
    page.byId('lessons').hidden = false;
    const choice = page.byId('lesson');
    const open = () => {
      pendingLooks += 1;
      page.byId('side_lessons').click();
    };
    const goOn = () => {
      const next = page.byId('lesson_next');
      if (next.disabled || next.hidden) return;
      pendingLooks += 1;
      next.click();
    };
    const solve = async () => {
      while (!choice.disabled && page.byId('lesson_check').hidden) goOn();
      if (!choice.disabled) page.byId('lesson_check').click();
      await wait(700);
      goOn();
    };
    const choose = (number) => {
      if (choice.disabled) return;
      pendingLooks = 1;
      choice.value = String(number);
      choice.dispatchEvent(new Event('change'));
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : 5 + random.below(300));
      fails = () => !isGood && random() < 0.3;
      open();
      let end = 'came';
      for (let k = random.below(isGood ? 1 : 10); k > 0; k -= 1) {
        const chooseAny = () => choose(1 + random.below(3));
        await random.of([open, goOn, solve, chooseAny, chooseAny])();
        for (let k = random.below(4); k > 0; k -= 1) {
          await wait(random.below(150));
          const [name, hint] = [page.byId('lesson_name').textContent, page.byId('lesson_hint_said').children[0]?.children ?? ['']];
          if (pendingLooks < 0) throw new Error('the world begins again');
          if (name && hint.join() !== name.replace('L', 'of ')) throw new Error(`beneath ${name} is a step ${hint}`);
        }
      }
      if (choice.disabled) end = 'failed';
      if (!isGood && random() < 0.5) await wait(500);
      await wait(isGood ? 1000 : 0);
      if (isGood && newest.name !== '' && newest.name !== page.byId('lesson_name').textContent) throw new Error(`${newest.name} is not seen`);
      if (isGood && `L${choice.value}` !== page.byId('lesson_name').textContent) throw new Error(`${choice.value} is chosen, and another one is seen`);
      if (isGood) choose(1 + random.below(3));
      await wait(isGood ? 500 : 0);
      const hint = page.byId('lesson_hint_said').children[0]?.children;
      return { ends: [end], seen: isGood && [page.byId('lesson_name').textContent, hint, page.byId('lesson_steps').children.length, pageState.taughtBlocks.value, choice.value, choice.disabled, page.byId('lesson_said').textContent, world] };
    };
  },

  // Where a real robot halts, over a link that is late and loses answers: what starts is what was pressed last, and has its
  // places; who goes on is halted; at rest the robot knows the breakpoints, and nothing of a halt before is seen.
  async places() {
    const page = freshPage();
    await loadTexts(page);
    const { Debugging } = await page.load('robot/debugging.js');
    const { pageState } = await page.load('page/page_state.js');
    const { LINK } = await page.load('page/words.js');
    const { dataset } = document.documentElement;
    const text = 'F(1)\nF(2)\nF(3)\nF(4)\nF(5)\nF(6)\nF(7)\nF(8)\nF(9)';
    const places = text.split('\n').map((_, k) => [10 * k, k + 1, 1, k + 1, 5]), halts = places.map(([offset]) => offset + 1);
    const programs = ['a', 'b'].map((program) => ({ program, text, places, halts, variables: [{ name: 'X', is_yes_no: false }] }));
    const points = places.map(() => ({}));
    pageState.programText.set(text);
    let delay = () => 5, loses = () => false, wrong = '';
    let info = null; // of the robot that is connected
    let newest = null; // what was pressed last: a stop, or a start, and what the robot has to know before
    let haltPlaces = []; // where it is to halt
    let known = '', breakRequest = null; // where it halts, and what has said so
    let isHalted = false, clock = 0; // whether its time stands
    let isPaused = false; // before its first instruction
    const fail = (message) => { wrong ||= message; };
    const all = () => `${(isPaused ? [0, ...haltPlaces] : haltPlaces).slice(0, LINK.most_breakpoints)}`;
    const debugging = new Debugging({
      async ask(request) {
        const { do: action } = request;
        if (action === 'start') {
          if (newest?.kind !== 'start') fail(`it is started after ${newest?.kind}`);
          else if (newest.hasPlaces && known !== all() && !(newest.isPaused && known.startsWith('0'))) fail(`it starts with ${known} in place of ${all()}`);
        }
        const isLost = loses();
        if (action === 'break') [known, breakRequest] = [`${request.places}`, request]; // requests arrive in their order
        if (action === 'resume') {
          if (!isHalted) fail('what is not halted goes on');
          isHalted = false;
        }
        const runInfo = info;
        await later(delay());
        if (isLost && breakRequest === request && runInfo === info) known = 'nobody knows';
        if (isLost || runInfo !== info) return null; // also of a robot that is gone
        return action === 'variables' ? { variables: [7] } : action === 'tasks' ? { tasks: [['RUNNING', 0], ['WAITING', 20]] } : { ok: true };
      },
      uploadPaused: () => actions.upload(null, true), say() {}, sayAnew() {}, canGetHaltingFirmware: async () => false, getHaltingFirmware() {},
      place: { halt: () => {}, resume: () => {} },
      recorder: { halt: () => { clock = 1; }, resume: () => { clock = 0; } },
    });
    let program = null, isRunning = false, isStepping = false;
    const tell = (event) => debugging.onEvent(event);
    const endRun = (isStarting) => {
      [isRunning, isHalted, isStepping] = [isStarting, false, false];
      if (!isStarting) isPaused = false;
      clock = 0;
    };
    const actions = {
      meet(random) {
        info = random() < 0.9 ? { has_breakpoints: random() < 0.8, is_running: random() < 0.2 } : null;
        [program, known, newest] = [null, '', null];
        endRun(info?.is_running ?? false);
        debugging.onRobotChange(info);
      },
      upload(random, paused = random() < 0.3) {
        if (!info || isRunning) return;
        program = programs[clock % 2];
        [known, isPaused] = ['', paused];
        newest = { kind: 'upload' };
        const ownRun = newest, runInfo = info, isStarting = !random || random() < 0.8;
        const proceed = debugging.onUpload(program, paused);
        if (Boolean(proceed) !== Boolean(info.has_breakpoints && (paused || haltPlaces.length))) fail('its places are not sent');
        if (!proceed) isPaused = false;
        later(delay()).then(() => {
          if (runInfo !== info) return;
          if (newest === ownRun && isStarting) newest = { kind: 'start', hasPlaces: true, isPaused: paused }; // which halts at once, and gets what is new then
          proceed?.(isStarting);
        });
      },
      startAgain() {
        if (!info || isRunning) return;
        isPaused = false;
        newest = { kind: 'start', hasPlaces: Boolean(program && info.has_breakpoints) };
        debugging.startAgain();
      },
      stop() {
        newest = { kind: 'stop' };
        debugging.stop();
      },
      line() {
        if (known) known = 'none'; // what it halts at is gone
        debugging.onLineSent();
      },
      setBreakpoints(random) {
        const lines = places.filter(() => random() < 0.3).map(([, line]) => line);
        haltPlaces = lines.map((line) => halts[line - 1]);
        pageState.breakpoints.set(lines.map((line) => ({ line, column: 1, point: points[line - 1] })));
      },
      begin() {
        if (!info || isRunning) return;
        endRun(true);
        tell({ event: 'STARTED', is_program: true });
      },
      end(random) {
        endRun(false);
        tell({ event: random.of(['DONE', 'FAULT', 'STOPPED', 'LOST']) });
      },
      halt(random) {
        if (!isRunning || isHalted || !program || !info?.has_breakpoints) return;
        const offset = random.of([halts[2], halts[4], 3]), isWithin = offset === 3;
        isHalted = true;
        const isGoingOn = isWithin && (isStepping || isPaused);
        if (!isGoingOn) isPaused = false;
        tell({ event: 'HALTED', is_program: true, at: offset, task: 0 });
        if (isHalted === isGoingOn) fail(`at ${offset} it ${isHalted ? 'stands' : 'goes on'}`);
        if (!clock) fail('the clock of the recording goes on in a halt');
      },
      goOn(random) {
        const isStep = random() < 0.5, before = isHalted;
        if (!isStep || before) {
          if (before) [isStepping, clock] = [isStep, 1];
          page.byId(isStep ? 'link_step' : 'link_go_on').click();
          if (before && (isHalted || clock)) fail('it does not go on');
        }
      },
      wait: () => {},
    };
    return async (random, isGood) => {
      wrong = '';
      actions.meet(random);
      const acted = new Set();
      for (let k = 10 + random.below(40); k > 0; k -= 1) {
        delay = () => 1 + random.below(random.of([5, 300]));
        loses = () => !isGood && random() < 0.3;
        const act = random.of([...!info || !program ? ['meet', 'upload'] : isRunning ? ['halt', 'goOn', 'halt', 'end'] : ['upload', 'setBreakpoints', 'startAgain', 'stop'], ...Object.keys(actions)]);
        actions[act](random);
        acted.add(act);
        await wait(random.of([0, 20, 500]));
        if (wrong) throw new Error(`after ${[...acted]}: ${wrong}`);
        const isShown = dataset['halt'];
        if ((isShown === 'halted' || isShown === 'read') !== isHalted) throw new Error(`after ${act} ${isShown} is seen`);
        if (!isHalted && isShown !== (isRunning ? 'running' : 'none')) throw new Error(`after ${act} ${isShown} is seen of what runs: ${isRunning}`);
      }
      return { ends: [...acted], seen: [] };
    };
  },

  // The recording of a run, before and after runs of others: each row at its time, which stands while the program is halted.
  async recording() {
    const page = freshPage();
    await loadTexts(page);
    const { Recorder } = await page.load('robot/recorder.js');
    const { Runs } = await page.load('virtual/runs.js');
    const { pageState } = await page.load('page/page_state.js');
    const { text: textOf } = await page.load('page/texts.js');
    const MAX_EVENTS = 10_000, MAX_MS = 600_000, MAX_PROGRAMS = 20;
    const runs = new Runs();
    let trims = 0;
    page.byId('record_play').hidden = true; // as in index.html
    const recorder = new Recorder({ runs: { addRun: (run) => runs.addRun(run), forgetOldest: () => { trims += 1; runs.forgetOldest(); } }, play() {} });
    let sentPrograms = []; // the programs that robots have from here, the newest last
    const send = (name, isSensing) => {
      const text = `// ${name}${isSensing ? ' DISTANCE' : ''}`;
      pageState.robotName.set('tinibot');
      pageState.programText.set(text);
      sentPrograms = [...sentPrograms.filter((item) => item.name !== name), { name, text }].slice(-MAX_PROGRAMS);
      recorder.addProgram({ program: name, places: [], shows: [], variables: [] });
    };
    let ownEvents = []; // what the newest run of ours has told, and when
    let ran = null; // its program
    let isOpen = false;
    let unread = false; // what a sensor of the newest run has read, and nobody knows
    let lacksReadings = false; // the robot tells of no readings
    let began = null; // by the clock that stands in a halt; null before the first row of a run by the button
    let halted = null, byButton = false, end_ms = null, endedCount = 0;
    const goOn = () => {
      if (halted !== null && began !== null) began += now() - halted;
      halted = null;
    };
    const elapsed = () => (began === null ? 0 : Math.round(now() - began));
    const endRun = (event) => {
      goOn();
      if (!isOpen) return;
      end_ms = Math.min(elapsed(), MAX_MS);
      ownEvents.push([end_ms, event]);
      isOpen = false;
      endedCount += 1;
    };
    const beginRun = (name, at) => {
      endRun('STOPPED');
      [ownEvents, unread, halted] = [[], false, null];
      ran = sentPrograms.find((item) => item.name === name) ?? null;
      isOpen = ran !== null;
      [began, byButton, end_ms] = [at, at === null, null];
    };
    const isFull = (at_ms) => ownEvents.length >= MAX_EVENTS || at_ms > MAX_MS;
    const reportRows = (rows) => {
      if (isOpen) for (const row of rows) {
        began ??= now() - row[0];
        if (isFull(row[0])) { endRun('STOPPED'); break; }
        ownEvents.push(row);
        unread ||= row[1].startsWith('UNREAD');
      }
      recorder.onEvent({ event: 'READING', rows });
    };
    const actions = {
      send: (random) => send(`p${random.below(30)}`, random() < 0.5),
      meet(random) {
        lacksReadings = random() < 0.5;
        recorder.onRobotChange({ has_readings: !lacksReadings });
      },
      ours(random) {
        const { name } = random.of(sentPrograms), ms = random() < 0.2 ? random.below(50) : undefined;
        if (ms !== undefined) lacksReadings = true;
        beginRun(name, now());
        recorder.onEvent({ event: 'STARTED', program: name, is_program: true, ms });
      },
      awaitButton(random) {
        const { name } = random.of(sentPrograms);
        beginRun(name, null);
        recorder.awaitButton(name);
      },
      theirs() {
        endRun('STOPPED');
        recorder.onEvent({ event: 'STARTED', program: 'bb', is_program: false });
      },
      unknown(random) { // of which this page has nothing, or nothing any more
        const name = random.of(['cc', `p${random.below(30)}`]);
        beginRun(name, now());
        recorder.onEvent({ event: 'STARTED', program: name, is_program: true });
      },
      show(random) {
        if (halted !== null) return; // it stands
        const value = String(random.below(1000)), ms = random() < 0.2 ? Math.max(0, elapsed() + 20 - random.below(60)) : undefined;
        if (isOpen) {
          began = Math.min(began ?? Infinity, now() - (ms ?? 0));
          if (isFull(elapsed())) endRun('STOPPED');
          else ownEvents.push([ms ?? elapsed(), `SHOW ${value}`]);
        }
        recorder.onEvent({ event: 'SHOW', value, ms });
      },
      read(random) { // in the robot's own time
        if (halted !== null) return;
        const at_ms = now() - (began ?? now() - 5);
        reportRows([[Math.round(at_ms), random.of(['READ DISTANCE 5', 'READ DISTANCE 7', 'UNREAD DISTANCE'])]]);
      },
      end(random) {
        const event = random.of(['DONE', 'STOPPED', 'MISSED', 'LOST', 'RESTARTED']);
        if (isOpen) began ??= now();
        endRun(event === 'RESTARTED' ? 'LOST' : event);
        recorder.onEvent({ event });
      },
      gone() {
        endRun('LOST');
        recorder.end('LOST');
      },
      halt() {
        if (!isOpen || began === null) return;
        halted ??= now();
        recorder.halt();
      },
      goOn() {
        goOn();
        recorder.resume();
      },
      wait: (random) => wait(random.of([1000, 700_000])),
    };
    return async (random) => {
      const acted = new Set();
      let end = '', isTold = true;
      send('aa', false);
      if (random() < 0.3) for (let k = 29; k >= 0; k -= 1) send(`p${k}`, false);
      const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`after ${end} ${label}: ${JSON.stringify(actual)?.slice(-300)} in place of ${JSON.stringify(expected)?.slice(-300)}`); };
      for (let k = 1 + random.below(16); k > 0; k -= 1) {
        end = random.of(['show', 'show', 'show', ...Object.keys(actions)]);
        if (k === 2 && random() < 0.08) {
          end = 'flood';
          actions.ours(random);
          reportRows(Array.from({ length: MAX_EVENTS + random.of([0, 9]) }, () => [elapsed(), 'READ DISTANCE 5']));
        } else await actions[end](random);
        acted.add(end);
        await wait(random.below(300));
        assertSame(page.byId('record_play').hidden, !ownEvents.length, 'nothing can be played');
        assertSame(trims, endedCount, 'those that have ended');
        if (!ran) continue;
        const run = runs.newestFirst[0];
        assertSame(run.rows, ownEvents, 'its rows');
        assertSame([run.origin.text, run.origin.is_by_button, run.end_ms], [ran.text, byButton, end_ms], 'of which program, and until when');
        assertSame(run.readClock(), Math.min(MAX_MS, elapsed()), 'its clock');
        const older = runs.newestFirst[1];
        if (older) assertSame(older.readClock(), Math.min(MAX_MS, older.rows.at(-1)?.[0] ?? 0), 'the clock of the one before');
        const notice = unread ? textOf('record_incomplete', { sensors: 'DISTANCE' }) : lacksReadings && ran.text.includes('DISTANCE') ? textOf('record_no_readings') : '';
        const place = page.byId('record_lacks');
        if (['meet', 'ours', 'awaitButton'].includes(end)) isTold = end !== 'meet'; // what a robot that is met tells is of the next run
        if (isTold) assertSame([place.hidden, place.textContent], [!notice, notice], 'what was not read');
      }
      return { ends: [...acted], seen: [] };
    };
  },

  // Whose work is given back to whom, while pupils come and go.
  async giving() {
    const page = freshPage();
    await loadTexts(page);
    const { GivingWindow } = await page.load('class/giving.js');
    const handouts = [];
    const giving = new GivingWindow((key, pupil) => handouts.push([key, pupil]));
    const list = giving.dialog.children[1].children[1];
    let works = 0;
    return async (random, isGood) => {
      handouts.length = 0;
      const kept = [1, 2].map((k) => ({ key: `${(works += 1)}`, name: `N${k}`, lessons: [], given: 0, alike: [] }));
      const allPupils = [1, 2, 3, 4].map((number) => ({ number, name: `P${number}` }));
      const chosenPupils = new Map();
      let presentPupils = [];
      const ends = new Set();
      for (let k = 2 + random.below(8); k > 0; k -= 1) {
        presentPupils = allPupils.filter(() => random() < 0.7);
        for (const item of kept) item.alike = random.of([[], [1], [2], [1, 2]]).filter((number) => presentPupils.some((pupil) => pupil.number === number));
        giving.show(kept, presentPupils);
        kept.forEach(({ key, alike }, row) => {
          const [, , choice, give] = list.children[row].children;
          const expected = Number(chosenPupils.get(key) ?? (alike.length === 1 ? alike[0] : 0));
          const isHere = presentPupils.some(({ number }) => number === expected);
          if (give.disabled === isHere) throw new Error(`whom nobody has chosen: ${choice.value}`);
          if (!give.disabled) {
            give.click();
            if (handouts.at(-1).join() !== `${key},${expected}`) throw new Error(`${handouts.at(-1)} in place of ${expected}`);
          }
          ends.add(chosenPupils.has(key) ? (isHere ? 'chosen' : 'gone') : isHere ? 'alike' : 'nobody');
          if (random() < 0.3 && presentPupils.length) {
            const number = String(random.of(presentPupils).number);
            choice.value = number;
            choice.dispatchEvent(new Event('change'));
            chosenPupils.set(key, number);
          }
        });
      }
      const windows = [giving.dialog.open];
      giving.show([], presentPupils);
      return { ends: [...ends], seen: isGood && [handouts.map(([, number]) => number), windows, list.children.length] };
    };
  },

  // What the teacher gives to all is what was chosen last, also before the titles of the lessons come, and when the window
  // was open before.
  async handing() {
    const page = freshPage();
    await loadTexts(page);
    const { HandoutWindow } = await page.load('class/handout.js');
    const LESSONS = [1, 2, 3].map((number) => ({ title: `L${number}`, block_title: `B${number}` }));
    let delay = () => 5, handouts = [], isEarly = true;
    const python = {
      async ask() {
        isEarly = true;
        await later(delay());
        isEarly = false;
        return { lessons: LESSONS };
      },
    };
    const handout = new HandoutWindow({ python, work: { text: 'F(1)', robot: 'tinibot' } }, (item) => handouts.push(item.lesson ?? 0));
    const [choice, give] = handout.dialog.children[1].children[1].children;
    let chosen = 0; // the program in the studio, or a lesson
    const ends = new Set();
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(400));
      handouts = [];
      for (let k = 1 + random.below(4); k > 0; k -= 1) {
        handout.open(LESSONS.length);
        await wait(random.below(300));
        ends.add(isEarly ? 'early' : 'late');
        if (isGood || random() < 0.7) chosen = choice.selectedIndex = random.below(1 + LESSONS.length);
        await wait(random.below(500));
        give.click();
        if (handouts.at(-1) !== chosen) throw new Error(`${handouts.at(-1)} is given in place of ${chosen}`);
        if (random() < 0.5) await wait(500);
      }
      await wait(500);
      return { ends: [...ends], seen: isGood && [handouts, handout.dialog.open] };
    };
  },

  // What cannot be taken back is pressed once, twice, and at any time; and the class ends.
  async sure() {
    const page = freshPage({ generate: () => ({ toCanvas() {} }), correction: {} });
    document.documentElement.dataset['class'] = '';
    replaceNavigator({});
    replaceFetch(async () => { throw new Broken(); });
    await loadTexts(page);
    let requests = [];
    let over = '';
    let isTold = false;
    const afterwards = []; // asked of a class that is known to be over
    let delay = () => 5;
    let loses = () => false;
    replaceFetch(async (_, { body }) => {
      const request = JSON.parse(body);
      if (isTold) afterwards.push(request.do);
      requests.push(request.do);
      if (request.do === 'class_over') over = 'kept';
      const state = { code: '1', turn_s: 60, places: 2, over, goes_on: true, lessons: 1, kept: [], pupils: [], robots: [] };
      await later(delay());
      if (loses(request.do)) throw new Broken();
      isTold ||= state.over !== '';
      return responseOf(state);
    });
    const { Teacher } = await page.load('class/teacher.js');
    new Teacher({ python: { get ready() { return Promise.reject(new Broken()); }, ask() {} }, openRun: async () => {} });
    await wait(100);
    const within = (part) => (part ? [part, ...(part.children ?? []).flatMap(within)] : []);
    const parts = [page.byId('class'), ...document.body.children].flatMap(within);
    const [anew, more, end] = ['class_anew', 'class_anew', 'class_end'].map((key, k) => parts.filter((item) => item.type === 'button' && item.dataset['text'] === key)[k % 2]);
    const SURE_MS = 5000;
    const armed = new Map();
    const press = (button, requestName, detail = 1) => {
      const isSure = armed.has(button) && now() - armed.get(button) < SURE_MS;
      const before = requests.filter((item) => item === requestName).length;
      button.dispatchEvent(Object.assign(new Event('click'), { detail }));
      const did = requests.filter((item) => item === requestName).length > before;
      if (did !== (isSure && detail === 1)) throw new Error(`${requestName} ${did ? 'at a first press' : 'not at the second one'}`);
      if (detail === 1 && isSure) armed.delete(button);
      else if (detail === 1) armed.set(button, now());
      return did;
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : 5 + random.below(900));
      loses = (requestName) => !isGood && random() < 0.3 && requestName !== 'class_over';
      requests = [];
      const ends = new Set();
      for (let k = isGood ? 0 : 2 + random.below(8); k > 0; k -= 1) {
        const did = press(random.of([anew, more]), 'class_anew', random() < 0.2 ? 2 : 1);
        ends.add(did ? 'sure' : 'once');
        await wait(random.of([1, 300, 3000, 4990, 5010, 8000]) + random.below(5));
      }
      if (!isGood) return { ends: [...ends], seen: false };
      loses = (requestName) => over !== '' && requestName !== 'class_over' && random() < 0.5; // `tsc studio` has ended
      delay = () => random.below(1500); // older answers come when it is known, if they come
      await wait(900 + random.below(400));
      while (!press(end, 'class_over')) await wait(100);
      await wait(3000); // what was asked before is answered
      afterwards.length = 0;
      const seen = () => [document.documentElement.dataset['teacher'], page.byId('class').children[0]?.textContent];
      const before = seen();
      await wait(20_000);
      if (`${seen()}` !== `${before}` || afterwards.length || before[0] !== 'class_over') throw new Error(`after the end: ${seen()}, ${afterwards}`);
      return { ends: ['over'], seen: before };
    };
  },

  // A robot at a cable that this browser has opened: it is left at any moment, and the port is free then.
  async cable() {
    const page = freshPage();
    let isHeld = false;
    replaceNavigator({ locks: { request(_, __, callback) {
      const own = callback(isHeld ? null : {});
      if (own) {
        isHeld = true;
        own.then(() => { isHeld = false; });
      }
      return Promise.resolve();
    } } });
    const { DirectRobot } = await page.load('robot/direct.js');
    const { ConnectionFailure } = await page.load('robot/transport.js');
    let state = 'closed';
    let delay = () => 5;
    let fails = () => false;
    let hangs = () => false;
    let hasHung = false;
    let isHeard = true;
    let disconnect = () => {};
    const python = {
      async ask({ do: action, asked = [] }) {
        await later(delay());
        if (action === 'connect') return {};
        const news = isHeard ? asked.map(({ id }) => ({ id, ok: true, robot: { name: 'TINI' } })) : [];
        return { send: '', news, wakes_ms: null };
      },
    };
    let wasLeft = false; // and opened after that
    const port = (own) => ({
      isRadio: true,
      lossReason: 'port_gone',
      async open(_, gone) {
        wasLeft ||= own.robot.isOver;
        if (state !== 'closed') throw new ConnectionFailure('port_busy');
        state = 'opening';
        await later(delay());
        if (fails()) {
          state = 'closed';
          throw new ConnectionFailure('port_broken');
        }
        state = 'open';
        disconnect = gone;
      },
      async write() {
        if (hangs()) {
          state = 'closed'; // what it went to is not there any more, and nobody says so
          hasHung = true;
          await new Promise(() => {});
        }
        await later(1);
        if (state !== 'open') throw new Broken();
      },
      async close() {
        await later(delay());
        if (state === 'opening') throw new Broken('InvalidStateError');
        state = 'closed';
      },
    });
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : 5 + random.below(300));
      fails = () => !isGood && random() < 0.2;
      hangs = () => !isGood && random() < 0.1;
      isHeard = isGood || random() < 0.8;
      const ends = [];
      const notes = [];
      for (let k = isGood ? 1 : 1 + random.below(3); k > 0; k -= 1) {
        const own = { robot: null };
        const robot = own.robot = new DirectRobot(python, port(own), { onEvent() {}, onEnd: ({ reason }) => notes.push(reason) }, NO_KEYS);
        const meetOutcome = robot.connect('tinibot', 'en').then(() => 'met', ({ reason }) => reason);
        await wait(isGood ? 1000 : random.below(random.of([20, 300, 1200])));
        if (!isGood && random() < 0.3 && state === 'open') disconnect();
        const wasOpening = state === 'opening';
        if (isGood) notes.push(isHeld, state);
        else ends.push(robot.isOver ? 'over' : state);
        robot.leave();
        await settle();
        if (!isGood && !wasOpening && !hasHung && random() < 0.5) continue; // to the next one at once
        await wait(hasHung ? 12_000 : 1000);
        hasHung = false;
        notes.push(await meetOutcome);
        if (wasLeft) throw new Error('it is opened though it was left');
        if (state !== 'closed' || isHeld) throw new Error(`the port is ${state} after it was left: ${notes}`);
      }
      return { ends, seen: notes };
    };
  },

  // What is asked of a robot at a cable, and STOP: nothing that was asked before a STOP reaches the session after it, each ask
  // ends once, in its order, and the session gets each byte once.
  async queue() {
    const page = freshPage();
    replaceNavigator({});
    const { DirectRobot } = await page.load('robot/direct.js');
    let delay = () => 5;
    let breaks = () => false;
    let sentRequests = []; // to the session
    let wrong = '';
    let bytes = [];
    const python = {
      async ask({ do: action, asked = [] }, data) {
        sentRequests.push(...asked);
        if (asked.filter((item) => item.do === 'keys').length > 1) wrong = 'what was held before is sent, too';
        if (action === 'link') bytes.push(...data);
        await later(delay());
        if (breaks()) throw new Broken();
        return action === 'connect' ? {} : { send: '', keys: '', news: asked.map(({ id }) => ({ id, ok: true, robot: { name: 'TINI' } })), wakes_ms: null };
      },
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(400));
      breaks = () => false;
      [sentRequests, bytes] = [[], []];
      let receive = () => {};
      const port = { isRadio: true, lossReason: 'port_gone', async open(onData) { receive = onData; }, async write() {}, async close() {} };
      const robot = new DirectRobot(python, port, { onEvent() {}, onEnd() {} }, NO_KEYS);
      robot.connect('tinibot', 'en').catch(() => {});
      await wait(1000);
      const came = [];
      const endedNumbers = [];
      let askCount = 0;
      let stopped = 0; // asks before the newest STOP
      let held = 0; // the newest of what was held
      breaks = () => !isGood && random() < 0.02;
      const actions = {
        ask() {
          const number = (askCount += 1);
          robot.ask({ do: 'start', number }).then(() => endedNumbers.push(number), () => endedNumbers.push(number));
        },
        press() {
          const number = (askCount += 1);
          held = number;
          robot.press({ keys: number, number }).then(() => endedNumbers.push(number), () => endedNumbers.push(number));
        },
        hear() {
          came.push(came.length % 256);
          receive(new Uint8Array(came.slice(-1)));
        },
        stop() {
          robot.stop();
          sentRequests = [];
          stopped = askCount;
        },
        wait: () => {},
      };
      let end = '';
      for (let k = 3 + random.below(20); k > 0; k -= 1) {
        end = random.of(['ask', ...Object.keys(actions)]);
        actions[end]();
        await wait(random.below(random.of([3, 300])));
        const old = sentRequests.find(({ number }) => number <= stopped);
        if (old) throw new Error(`${old.number} of ${stopped} is done after a STOP`);
        if (new Set(sentRequests).size < sentRequests.length) throw new Error('something is done twice');
        if (wrong) throw new Error(wrong);
      }
      await wait(3000);
      if ([...endedNumbers].sort((one, other) => one - other).join() !== Array.from({ length: askCount }, (_, k) => k + 1).join()) throw new Error(`${askCount} were asked, and ${endedNumbers} have ended`);
      const heardNumbers = sentRequests.filter((item) => item.do === 'keys').map(({ number }) => number);
      if (!robot.isOver && held > stopped && heardNumbers.at(-1) !== held) throw new Error(`${held} is held, and the robot hears ${heardNumbers}`);
      if (!robot.isOver && `${bytes}` !== `${came}`) throw new Error(`${bytes} of ${came}`);
      if (robot.isOver) end = 'broken';
      robot.leave();
      await wait(100);
      return { ends: [end], seen: isGood && endedNumbers };
    };
  },

  // One build of the page after another, in a browser that keeps them: without a network, the newest one that could be
  // had is there whole, and so is each language that was seen, whatever was kept there before; and no older build is.
  async builds() {
    const source = readFileSync(`${sources}/service_worker.js`, 'utf-8');
    const FILES = ['./', 'main.js'];
    const LANGUAGES = { es: ['es.json', 'es.zip'], pt: ['pt.json', 'pt.zip'] };
    /** What a browser keeps for an address, by the name of each store. @type {Map<string, Map<string, string>>} */
    let stores = new Map();
    let served = 0;
    let claimed = 0; // by which build the open pages are answered
    let loses = () => false;
    let before = new Map(); // what the browser itself has fetched, which it may give again
    const nameOf = (request) => request.name ?? request;
    const fetchFile = async (request) => {
      const name = nameOf(request);
      await later(5);
      if (loses()) throw new Broken();
      if (request.cache !== 'reload' && before.has(name)) return before.get(name);
      before.set(name, `${name} of ${served}`);
      return before.get(name);
    };
    const storeOf = (all) => ({
      match: async (request, { ignoreSearch = false } = {}) => {
        const pathOf = (name) => (ignoreSearch ? name.split('?')[0] : name);
        return [...all].find(([name]) => pathOf(name) === pathOf(nameOf(request)))?.[1];
      },
      async addAll(requests) {
        const found = await Promise.all(requests.map(async (item) => [nameOf(item), await fetchFile(item)]));
        for (const [name, content] of found) all.set(name, content);
      },
    });
    const caches = {
      async open(name) {
        if (!stores.has(name)) stores.set(name, new Map());
        return storeOf(stores.get(name));
      },
      match: async (name, { cacheName = '' } = {}) => [...stores].filter(([store]) => !cacheName || store === cacheName).map(([, all]) => all.get(name)).find(Boolean),
      delete: async (name) => stores.delete(name),
      keys: async () => [...stores.keys()],
    };
    class Request { constructor(name, { cache }) { Object.assign(this, { name, cache }); } }
    /** The worker of a build. @returns {(kind: string, more?: object) => Promise<any>} */
    const worker = (version) => {
      const handlers = new Map();
      const self = { addEventListener: (kind, callback) => handlers.set(kind, callback), clients: { claim: async () => { claimed = version; } } };
      new Function('self', 'caches', 'fetch', 'Request', 'VERSION', 'FILES', 'LANGUAGES', source)(self, caches, fetchFile, Request, `v${version}`, FILES, LANGUAGES);
      return async (kind, more = {}) => {
        let done = null;
        const take = (promise) => { done = promise; };
        handlers.get(kind)({ waitUntil: take, respondWith: take, ...more });
        return done;
      };
    };
    return async (random, isGood) => {
      stores = new Map([['of others', new Map([['./', 'theirs']])]]);
      before = new Map();
      const ends = new Set();
      let open = null; // the build that the page is of
      let version = 0;
      const languages = new Set(); // its languages
      const awaitSuccess = async (promise) => {
        let isDone = null;
        promise.then(() => { isDone = true; }, () => { isDone = false; });
        await wait(50);
        return isDone;
      };
      for (let k = 3 + random.below(8); k > 0; k -= 1) {
        loses = () => !isGood && random() < 0.15;
        const act = random.of(open ? ['builds', 'speaks', 'speaks', 'stranger'] : ['builds']);
        if (act === 'stranger') stores.set(`tiniscript-studio-v${served + 1}`, new Map(['./?', ...FILES, 'es.json'].map((name) => [name, 'a stranger has put it there'])));
        if (act === 'speaks') {
          const language = random.of(Object.keys(LANGUAGES));
          if (await awaitSuccess(open('message', { data: language }))) languages.add(language);
        }
        if (act === 'builds') {
          served += 1;
          const next = worker(served);
          const isThere = await awaitSuccess(next('install'));
          if (isThere) {
            [open, version] = [next, served];
            await awaitSuccess(open('activate'));
            if (claimed !== version) throw new Error(`the open pages are those of ${claimed}`);
            if (`${[...stores.keys()].sort()}` !== `of others,tiniscript-studio-v${version}`) throw new Error(`it keeps ${[...stores.keys()]} of ${version}`);
          }
          ends.add(isThere ? 'installed' : 'lost');
        }
        if (!open) continue;
        loses = () => false;
        let otherAnswer = '';
        open('fetch', { request: { name: 'other', method: 'GET', cache: 'reload' } }).then((found) => { otherAnswer = found; });
        await wait(20);
        if (otherAnswer !== `other of ${served}`) throw new Error(`with a network it gives ${otherAnswer}`);
        loses = () => true;
        if (await open('fetch', { request: { name: './robots', method: 'POST' } })) throw new Error('it answers for the server');
        for (const name of ['./?', ...FILES, ...[...languages].flatMap((language) => LANGUAGES[language])]) {
          let answer = '';
          open('fetch', { request: { name, method: 'GET' } }).then((found) => { answer = found; }, () => {});
          await wait(20);
          if (answer.startsWith('a stranger')) throw new Error(`${name} is what a stranger has left`);
          if (!(name === './?' ? [`./ of ${version}`] : FILES.includes(name) ? [`${name} of ${version}`] : Array.from({ length: served }, (_, n) => `${name} of ${n + 1}`)).includes(answer)) throw new Error(`without a network ${name} of ${version} is ${answer}`);
        }
      }
      return { ends: [...ends], seen: [] };
    };
  },

  // What this page keeps on a device, until it forgets all: what was put at a place last is there, for the tab and for all
  // of them; then nothing of it is on the device, what others keep is, and the page goes on with what it puts there.
  async kept() {
    const page = freshPage();
    const { forgetAll, loadText, storeText } = await page.load('page/kept.js');
    const expected = new Map();
    return async (random, isGood) => {
      const stores = ['localStorage', 'sessionStorage'];
      const places = ['tiniscript.a', 'tiniscript.b'];
      if (!isGood) for (const store of stores) window[store].setItem('theirs', store);
      const put = (count) => {
        for (let k = count; k > 0; k -= 1) {
          const [store, place, value] = [random.of(stores), random.of(places), random.of(['', 'x', 'y'])];
          if (storeText(place, value, store)) expected.set(store + place, value);
          for (const item of stores) for (const other of places) if (loadText(other, item) !== (expected.get(item + other) ?? '')) throw new Error(`${loadText(other, item)} is at ${item} ${other}`);
        }
      };
      put(random.below(8));
      if (isGood) return { ends: ['goes on'], seen: [] };
      forgetAll();
      expected.clear();
      put(random.below(8));
      const left = stores.flatMap((store) => [...window[store]].map(([place]) => place));
      if (`${left}` !== 'theirs,theirs') throw new Error(`${left} is on the device`);
      put(random.below(8));
      return { ends: ['forgets'], seen: [] };
    };
  },

  // One language after another is chosen, over a connection that may fail: the last one is seen, or what was seen before it.
  async languages() {
    const page = freshPage();
    replaceNavigator({});
    await loadTexts(page);
    const { setLanguage, text } = await page.load('page/texts.js');
    const { pageState } = await page.load('page/page_state.js');
    let delay = () => 5;
    let fails = () => false;
    replaceFetch(async (where) => {
      await later(delay());
      if (fails()) throw new Broken();
      return { ok: true, json: async () => ({ stop: where }) };
    });
    return async (random, isGood) => {
      delay = () => 5 + random.below(isGood ? 10 : 900);
      fails = () => !isGood && random() < 0.3;
      let chosen = '';
      const kept = [];
      for (let k = 1 + random.below(5); k > 0; k -= 1) {
        chosen = random.of(['en', 'es', 'pt']);
        const own = setLanguage(chosen);
        own.then((language) => kept.push(language));
        await wait(random.below(random.of([50, 1200])));
      }
      await wait(1000);
      const seen = pageState.language.value;
      if (text('stop').startsWith('./') && text('stop') !== `./texts.${seen}.json`) throw new Error(`it says ${text('stop')} in ${seen}`);
      if (kept.at(-1) !== seen) throw new Error(`${kept.at(-1)} is chosen, and ${seen} seen`);
      if (isGood && seen !== chosen) throw new Error(`${chosen} is chosen, and ${seen} seen`);
      return { ends: [seen], seen: isGood && [seen, document.documentElement.lang, text('stop')] };
    };
  },

  // One program after another as blocks and as text, by whoever changes which of both and whenever Python answers: what is
  // done to blocks becomes text unless somebody has typed since they were made, what is typed stays, and in a group all of
  // it does but what is refused; undo comes after what was done before it; and when nobody does anything, both are the same program.
  async writing() {
    let blocks = null;
    let wrong = '';
    const fail = (sentence) => { wrong ||= sentence; };
    const linesOf = (text) => text.split('\n').map((line) => line.trim()).filter(Boolean);
    const formOf = (text) => ({ body: linesOf(text).map((line) => ({ text: line, kind: line.includes('?') ? 'grey' : 'word', bodies: [] })) });
    const textOf = ({ body }) => body.map((item) => item.text).join('\n');
    const page = freshPage({
      replaceOptions() {}, makePictureOption() {}, makeDialPicture() {}, makeBlocksPicture() {},
      Blocks: class {
        isDragging = false;
        focusedLine = 1;
        has = {};
        position = 'L0';
        next = null; // where those stand that are shown next
        form = { body: [] };
        constructor(_, __, ___, page) {
          Object.assign(this, { page });
          blocks = this;
        }
        get layoutText() { return this.position; }
        set layoutText(layout) { this.next = layout; }
        get lines() { return this.form.body.map((_, line) => [`${line}`, line]); }
        readForm() {
          if (this.isDragging) fail('blocks are read while one is in a hand');
          return { form: structuredClone(this.form), ids: [] };
        }
        show(form) {
          if (this.isDragging) fail('a block is taken out of a hand');
          if (textOf(form) !== textOf(formOf(editor.text))) fail('blocks are made of an older text');
          if (form.body.some(({ kind }) => kind === 'grey') && editor.hasFocus && now() - asked_ms > 2500) fail('blocks are made of what somebody is typing');
          this.form = structuredClone(form);
          this.shown = textOf(form);
          this.setRanges();
          isTyped = hasTouched = false;
          this.position = this.next ?? this.position;
          this.next = null;
          stood = this.position;
          this.has = {};
        }
        levelOf() { return 'few'; }
        showFindings(findings) {
          if (findings.some((item) => item.of !== editor.text)) fail('what is said at blocks is said of another text');
          this.see('findings', findings);
        }
        showBreakpoints(points) { this.see('points', points); }
        showRunning(ranges) { this.see('running', ranges); }
        showMates(places) { this.see('mates', places); }
        see(what, value) {
          if (!group && this.shown !== textOf(formOf(editor.text))) fail(`blocks of another text have ${what}`);
          this.has[what] = JSON.stringify(value);
        }
        async makePicture() { return textOf(this.form); }
        setRanges() {
          this.ranged = textOf(this.form);
          if (group) this.shown = textOf(formOf(editor.text));
        }
        showFault(range, sentence) { this.has.fault = JSON.stringify([range, sentence]); }
        setLevel() {} setRobot() {} setTaughtBlocks() {} setGivenBlocks() {} updateLanguage() {} resize() {} beginProgram() {}
      },
    });
    let isTyped = false; // since blocks were shown
    let hasTouched = false; // blocks, since then
    let asked_ms = 0; // for blocks of a text that is wrong, too
    let stood = 'L0'; // where blocks stood then
    let undone = null; // where an undo has them stand, until they are moved
    let places = []; // of others
    let past = [];
    let layout = () => {};
    const editor = {
      text: '', hasFocus: false,
      put(text) {
        if (text === editor.text) return;
        editor.text = text;
        pageState.checkResult.set(null);
        pageState.programText.set(text);
      },
      replaceByBlocks(text, { before, after }) {
        if (text !== editor.text && isTyped && !group) fail('what was typed is lost');
        if (text !== editor.text && text !== textOf(blocks.form)) fail(`blocks of before become text: ${text}`);
        if (before !== stood || after !== blocks.layoutText) fail(`blocks go from ${before} to ${after}, and not from ${stood}`);
        stood = after;
        past.push([editor.text, before, after]);
        if (text !== editor.text) {
          hasTouched = false;
          blocks.shown = text;
        }
        editor.put(text);
      },
      undo() {
        if (blocks.isDragging) fail('undo comes while a block is in a hand');
        if (hasTouched && !isTyped && !hasFailed) fail('undo comes before what was done to blocks');
        const [text, before, after] = past.pop() ?? [editor.text, '', ''];
        editor.put(text);
        if (text === blocks.shown) isTyped = false; // it is taken back
        if (before === after) return;
        layout(before);
        undone = before;
      },
      redo() {},
      onLayoutChange: (callback) => { layout = callback; },
      toggleBreakpoint: () => { if (textOf(formOf(editor.text)) !== blocks.shown) fail('a breakpoint is set in another text'); },
      showRunning() {}, goTo() {},
    };
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Views } = await page.load('writing/views.js');
    let delay = () => 5;
    let breaks = () => false;
    let hasFailed = false;
    let worker = Promise.resolve(); // it does one thing after the other
    const python = {
      ask({ do: action, form }, bytes) {
        const text = bytes && new TextDecoder().decode(bytes);
        worker = worker.catch(() => {}).then(() => later(delay())).then(() => {
          if (!breaks()) return action === 'text' ? { text: textOf(form), places: [] } : formOf(text);
          hasFailed = true;
          throw new Broken();
        });
        return worker;
      },
    };
    const work = { view: 'blocks', level: 'few' };
    let group = null;
    let isRefused = false; // what is done to blocks next
    /** Others of it write, too. */
    const makeGroup = () => ({
      base: [],
      async reportBlocks() {
        this.base = linesOf(textOf(blocks.form));
        await later(delay());
        return { is_known: true };
      },
      async writeBlocks(form) {
        const formLines = form.body.map((item) => item.text);
        stood = blocks.layoutText;
        await later(delay());
        if (group !== this) return null;
        const { base } = this;
        this.base = formLines;
        if (isRefused) { // somebody else was first, and the text is as it was
          isRefused = false;
          ownLines = ownLines.filter((line) => base.includes(line) || !formLines.includes(line));
          return { is_shown: editor.text === textOf(form), text: textOf(form), places: [] };
        }
        editor.put([...linesOf(editor.text).filter((line) => formLines.includes(line) || !base.includes(line)), ...formLines.filter((line) => !base.includes(line))].join('\n'));
        return { is_shown: editor.text === textOf(form), text: textOf(form), places: [] };
      },
      settle: () => later(delay()),
      chooseLine() { if (group !== this) fail('a group that was left hears where somebody is'); },
    });
    const views = new Views({ python, editor, work, storeCurrentWork() {}, tryAlone() {}, playTone() {} });
    const pane = page.byId('blocks');
    views.markReady();
    views.wake();
    for (let k = 0; !blocks && k < 500; k += 1) await settle();
    const press = (id) => page.byId(id).click();
    let count = 0;
    let ownLines = []; // that have to stay in a group
    const actions = {
      type(random) {
        editor.hasFocus = random() < 0.6;
        const line = `t${(count += 1)}${random() < 0.3 ? '?' : ''}`;
        isTyped = true;
        ownLines.push(line);
        editor.put(group || random() < 0.7 ? `${editor.text}\n${line}` : line);
        if (pane.dataset['state'] !== 'stale') fail('blocks pass for those of a text that was typed since');
      },
      async build(random) {
        if (work.view !== 'blocks') return;
        const pressed = Object.assign(new Event('pointerdown'), { stopPropagation() { this.isStopped = true; } });
        editor.hasFocus = false;
        pane.dispatchEvent(pressed);
        if (pressed.isStopped) return; // it is a moment too early
        for (let more = true; more; more = random() < 0.3) { // and takes the next one at once
          blocks.isDragging = true;
          if (!group && random() < 0.2) press('undo');
          await wait(random.below(random.of([2, 120])));
          blocks.isDragging = false;
          const isNew = random() < 0.7, line = isNew ? `b${(count += 1)}` : blocks.form.body.pop()?.text;
          hasFailed = false;
          if (!isNew) ownLines = ownLines.filter((item) => item !== line);
          else {
            ownLines.push(line);
            blocks.form.body.push({ text: line, kind: 'word', bodies: [] });
          }
          hasTouched = textOf(blocks.form) !== blocks.shown;
          blocks.page.onChange();
        }
      },
      move() {
        if (work.view !== 'blocks') return;
        blocks.position = `L${(count += 1)}`;
        undone = null;
        blocks.page.onChange();
      },
      async undo() {
        if (group) return;
        hasFailed = false; // it is tried again
        press('undo');
      },
      views: (random) => press(random.of(['view_blocks', 'view_text'])),
      robot() { // blocks of its own are made
        [ownLines, hasTouched] = [[], false];
        pageState.robotName.set('tinibot');
      },
      changeLanguage: () => pageState.language.set('en'),
      check: () => pageState.checkResult.set({ findings: [{ of: editor.text }] }),
      points: () => {
        pageState.breakpoints.set([{ line: (count += 1), column: 1 }]);
        blocks.page.toggleBreakpoint({});
      },
      run() {
        pageState.virtualRun.set({ ranges: [{ line: (count += 1) }], isHeld: false });
        pageState.fault.set(count % 2 ? { range: { line: count }, sentence: `f${count}` } : { range: null, sentence: '' });
      },
      mates() {
        places = [{ line: (count += 1) }];
        views.showMates(places);
      },
      async pictures() {
        const { view } = work;
        let picture;
        views.makePicture().then((made) => { picture = made; }, fail);
        for (let k = 0; picture === undefined && k < 100; k += 1) await wait(100);
        if (picture === undefined) fail('a picture never comes');
        if (work.view !== view) fail(`a picture leaves ${view}`);
        if (picture === null && !hasFailed) fail('there is no picture');
        if (picture !== null && picture !== textOf(formOf(editor.text)) && !hasTouched) fail(`a picture of ${picture}`);
      },
      join() {
        if (group) return;
        [group, ownLines, hasTouched] = [makeGroup(), [], false];
        views.join(group);
      },
      refuse: () => { isRefused = true; },
      leave() {
        if (group) [group, ownLines, hasTouched] = [null, [], false];
        views.join(null);
      },
      wait: () => {},
    };
    const rest = async () => {
      actions.check();
      await wait(4000);
      if (wrong) throw new Error(wrong);
      const text = textOf(formOf(editor.text));
      if (work.view !== 'blocks' || (editor.hasFocus && text.includes('?'))) return;
      if (hasFailed) { // who goes on has it right again
        if (textOf(blocks.form) !== text && !page.byId('blocks_note').textContent) throw new Error('nobody says that blocks and text differ');
        hasFailed = false;
        asked_ms = now();
        actions.undo();
        await rest();
        return;
      }
      if (textOf(blocks.form) !== text) throw new Error(`${textOf(blocks.form)} are the blocks of ${text}`);
      if (pane.dataset['state'] !== 'shown' || page.byId('blocks_note').textContent) throw new Error(`it says ${pane.dataset['state']} ${page.byId('blocks_note').textContent}`);
      if (pageState.checkResult.value && blocks.has.findings !== JSON.stringify(pageState.checkResult.value.findings)) throw new Error(`${blocks.has.findings} is said at blocks`);
      if (blocks.has.points !== JSON.stringify(pageState.breakpoints.value)) throw new Error('breakpoints are not at blocks');
      if (!group && blocks.ranged !== text) throw new Error(`their places are those of ${blocks.ranged}`);
      if (blocks.has.mates !== JSON.stringify(places)) throw new Error('others of the group are not at blocks');
      if (undone !== null && blocks.position !== undone) throw new Error(`blocks stand at ${blocks.position}, and an undo has put them at ${undone}`);
      const { range, sentence } = pageState.fault.value;
      if (blocks.has.fault !== JSON.stringify([range, sentence])) throw new Error(`${blocks.has.fault} is the fault at blocks`);
      if (blocks.has.running !== JSON.stringify(pageState.virtualRun.value.ranges)) throw new Error('what runs is not marked at blocks');
      if (group) for (const line of ownLines) if (!linesOf(editor.text).includes(line)) throw new Error(`${line} is lost`);
    };
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(random.of([10, 400])));
      breaks = () => !isGood && !group && random() < 0.2;
      const ends = new Set();
      if (isGood) {
        actions.leave();
        press('view_blocks');
        editor.hasFocus = false;
        isTyped = true;
        hasFailed = false;
        [blocks.position, blocks.next, undone] = ['L0', null, null];
        editor.put('first\nsecond');
        pageState.breakpoints.set([]);
        pageState.fault.set({ range: null, sentence: '' });
        pageState.virtualRun.set({ ranges: [], isHeld: false });
        await rest();
        past = [];
        ownLines = [];
        count = 0;
        isRefused = false;
      }
      const all = [];
      asked_ms = now();
      if (random() < 0.4) actions.join();
      for (let k = 5 + random.below(15); k > 0; k -= 1) {
        const act = random.of(['type', 'build', 'build', 'undo', ...Object.keys(actions)]);
        if (act === 'leave' && random() < 0.7) continue;
        if (!['type', 'check', 'points', 'run', 'mates', 'wait'].includes(act)) asked_ms = now();
        await actions[act](random);
        ends.add(act);
        if (!isGood && random() < 0.15) await rest();
        await wait(random.of([0, random.below(40), random.below(600)]));
        if (wrong) throw new Error(wrong);
        all.push([editor.text, textOf(blocks.form), pane.dataset['state']]);
      }
      breaks = () => false;
      if (hasFailed) ends.add('failed');
      await rest();
      return { ends: [...ends], seen: isGood && [all, past] };
    };
  },

  // Blocks of one program after another: each has the looks, the messages, the marks and the list that belong to what is
  // seen now, stands where it was put, and keeps the focus; what the page shows is no change, and what somebody does is. What
  // runs is in view, and a run leaves the view as it was, or as somebody has scrolled it meanwhile.
  async blocks() {
    globalThis.innerWidth = 1366;
    const { blockly, seen } = blocklyInNode();
    const page = freshPage({ blockly });
    replaceNavigator({});
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    pageState.robotName.set('tinibot');
    globalThis.CSSStyleSheet = class { replaceSync() {} };
    document.adoptedStyleSheets = [];
    const { Blocks } = await page.load('blocks/blocks.js');
    const { formOf } = await page.load('blocks/form.js');
    const container = page.byId('blocks');
    Object.assign(container, { clientWidth: 600, clientHeight: 400 });
    let hearers = 0; // of what is done in the pane, and in the whole page
    for (const item of [container, document, window, globalThis]) {
      const { addEventListener: add, removeEventListener: remove = () => {} } = item;
      Object.assign(item, {
        addEventListener(...args) { hearers += 1; return add.apply(item, args); },
        removeEventListener(...args) { hearers -= 1; return remove.apply(item, args); },
      });
    }
    let changes = 0;
    let tried = null;
    const toggled = [];
    const blocks = new Blocks(container, 'tinibot', 'few', {
      onChange: () => { changes += 1; },
      toggleBreakpoint: (place) => toggled.push(place.line),
      tryAlone: () => new Promise((resolve) => { tried = resolve; }),
      playTone() {},
    });
    const workspace = () => seen.workspaces.at(-1);
    const firstHearers = hearers;
    await wait(100);
    const all = () => workspace().getAllBlocks(true).filter((block) => !block.isShadow());
    return async (random, isGood) => {
      const number = () => [['NUMBER', String(1 + random.below(9))]];
      const plain = () => random.of([
        () => ({ kind: 'move', word: random.of(['F', 'B']), values: [number(), number()] }),
        () => ({ kind: 'wait', word: 'W', values: [number()] }),
        () => ({ kind: 'assign', word: random.of(['X', 'Y']), values: [number()] }),
        () => ({ kind: 'call', word: 'D', values: [number()] }),
      ])();
      const block = (depth = 0) => {
        const made = depth < 2 && random() < 0.3 ? { kind: 'loop', word: 'LOOP', values: [number()], bodies: [body(depth + 1)] } : plain();
        return { bodies: [], note: '', is_apart: false, ...made };
      };
      const body = (depth = 0) => Array.from({ length: random.below(4) }, () => block(depth));
      /** A program, whose blocks each have a line. */
      const makeForm = () => {
        const form = { start: 'SI', note: '', is_one_line: false, body: body(), loose: random() < 0.3 ? [{ body: [block(2)], value: [] }] : [] };
        if (random() < 0.5) form.body.push({ kind: 'def', word: 'D', values: [[['NAME', 'A']]], bodies: [body(1)], note: '', is_apart: false });
        let line = 0;
        const places = (item) => {
          item.place = [(line += 1), 1, 0, 9];
          item.bodies.forEach((inner) => inner.forEach(places));
          item.place[2] = line;
        };
        form.body.forEach(places);
        return form;
      };
      const flat = (list) => list.flatMap((item) => [item, ...item.bodies.flatMap(flat)]);
      const essence = (form) => JSON.stringify([form.body, form.loose.map((item) => item.body)], ['kind', 'word', 'values', 'bodies', 'body', '0', '1', '2', '3', '4', '5']);
      let form = makeForm();
      const shownState = { robot: 'tinibot', level: 'few', findings: [], running: [], fault: null, points: [], mates: [] };
      let isAlone = ''; // which block is tried alone
      let closed = ''; // the message that somebody has put away
      const line = () => 1 + random.below(Math.max(1, flat(form.body).length));
      const at = (count) => Array.from({ length: random.below(count + 1) }, () => ({ line: line(), column: 1 }));
      const say = {
        findings: () => blocks.showFindings(shownState.findings),
        running: () => blocks.showRunning(shownState.running),
        fault: () => blocks.showFault(shownState.fault, shownState.fault ? `why ${shownState.fault.line}` : ''),
        points: () => blocks.showBreakpoints(shownState.points),
        mates: () => blocks.showMates(shownState.mates),
      };
      const actions = {
        show() {
          if (random() < 0.5) form = makeForm();
          blocks.show(form);
          isAlone = '';
          for (const name of Object.keys(say)) say[name](); // as views.js does
        },
        findings() {
          shownState.findings = at(2).map((place) => ({ ...place, severity: random.of(['mistake', 'warning']), message: 'm', on_blocks: { message: `at ${place.line}`, fix: '', spoken: {} } }));
          say.findings();
        },
        running() { shownState.running = at(2); say.running(); },
        fault() { [shownState.fault = null] = at(1); say.fault(); },
        points() { shownState.points = at(2); say.points(); },
        mates() { shownState.mates = at(2).map((place) => ({ ...place, color: '#000', said: 'Luz' })); say.mates(); },
        level() { blocks.setLevel(shownState.level = random.of(['few', 'usual', 'all'])); },
        robot() { blocks.setRobot(shownState.robot = random.of(['tinibot', 'liner'])); },
        changeLanguage() {
          blocks.updateLanguage();
          isAlone = '';
          for (const name of Object.keys(say)) say[name]();
        },
        search() { // what is typed is looked for until somebody is at the blocks, at a group, or has given up
          const input = container.querySelectorAll('.search')[0].children[1];
          const list = workspace().getFlyout();
          const focusAt = (className) => {
            const target = Object.assign(document.createElement('g'), { className });
            const event = new Event('focusin');
            Object.defineProperty(event, 'target', { value: target });
            workspace().getInjectionDiv().dispatchEvent(event);
          };
          const key = (name) => {
            const event = Object.assign(new Event('keydown', { cancelable: true }), { key: name });
            let isShortcut = true;
            event.stopPropagation = () => { isShortcut = false; };
            input.dispatchEvent(event);
            if (isShortcut) throw new Error('what is typed is a shortcut');
          };
          list.hide();
          seen.focused = null;
          let typed = '', searchText = '';
          for (let k = 4 + random.below(20); k > 0; k -= 1) {
            const did = random.of(['types', 'types', 'comes back', 'blocks', 'group', 'list', 'Escape', 'Enter', 'x']);
            const clear = () => { [typed, searchText] = ['', '']; };
            if (did === 'types') {
              input.value = typed = random.of(['', ' ', 'wait', 'qqqq']);
              seen.group = 'a group';
              input.dispatchEvent(new Event('input'));
              searchText = typed.trim();
              if (seen.group) throw new Error('a group stays chosen');
            } else if (did === 'comes back') {
              input.dispatchEvent(new Event('focus'));
              if (typed) searchText = typed.trim();
            } else if (did === 'list') focusAt('blocklyFlyout');
            else if (did === 'blocks') {
              focusAt('blocklyBlock');
              if (typed) clear();
            } else if (did === 'group') {
              focusAt('blocklyToolbox');
              typed = '';
              if (searchText && !list.shown) throw new Error('the blocks of a group are hidden');
              list.hide(); // Blockly shows those of the group
              searchText = '';
            } else if (did === 'Escape') {
              key(did);
              clear();
              if (seen.focused !== workspace()) throw new Error('the focus is not at the blocks');
              seen.focused = null;
            } else {
              key(did);
              if (Boolean(seen.focused) !== (did === 'Enter' && searchText !== '')) throw new Error(`with ${searchText} the focus is ${seen.focused ? '' : 'not '}at what was found`);
              seen.focused = null;
            }
            if (input.value !== typed) throw new Error(`after ${did} ${input.value} is looked for in place of ${typed}`);
            const foundKinds = list.shown?.map(({ kind }) => kind);
            if (!searchText !== !foundKinds || (searchText && (foundKinds.includes('label') !== (searchText === 'qqqq') || !foundKinds.length))) throw new Error(`after ${did} ${foundKinds} is found of ${searchText}`);
          }
          input.value = '';
          list.hide();
        },
        resize: () => blocks.resize(),
        begin: () => blocks.beginProgram(),
        scroll() {
          container.dispatchEvent(new Event('wheel'));
          workspace().scroll(-random.below(300), -random.below(300));
        },
        keepView() { // what is seen, whatever is shown anew
          actions.scroll();
          const before = viewOf();
          blocks.show(form);
          isAlone = '';
          for (const name of Object.keys(say)) if (name !== 'running') say[name]();
          shownState.running = [];
          if (`${viewOf()}` !== `${before}`) throw new Error(`the view is ${viewOf()}, and was ${before}`);
          actions.changeLanguage();
          if (`${viewOf()}` !== `${before}`) throw new Error(`in another language the view is ${viewOf()}, and was ${before}`);
        },
        focus() { // which stays at its block
          const { lines } = blocks;
          if (!lines.length) return;
          const number = random.below(lines.length);
          document.activeElement = container;
          seen.focused = workspace().getBlockById(lines[number][0]);
          blockly.ShortcutRegistry.registry.getRegistry()['breakpoint'].callback();
          if (toggled.at(-1) !== lines[number][1] || blocks.focusedLine !== lines[number][1]) throw new Error(`a breakpoint is set at ${toggled.at(-1)}, and the focus is at ${lines[number][1]}`);
          blocks.show(form);
          isAlone = '';
          for (const name of Object.keys(say)) say[name]();
          if (blocks.focusedLine !== lines[number][1]) throw new Error(`the focus goes to ${blocks.focusedLine} from ${lines[number][1]}`);
          document.activeElement = document.body;
        },
        put() { // what hangs on nothing stays where it was put
          const loose = workspace().getTopBlocks(false).find(({ type }) => !['program', 'def'].includes(type));
          if (!loose) return;
          const place = { x: random.below(300), y: random.below(200) };
          loose.moveTo(place);
          blocks.readForm();
          const before = blocks.layoutText;
          if (random() < 0.5) { // and undo brings it back
            loose.moveTo({ x: 400, y: 400 });
            blocks.readForm();
            blocks.layoutText = before;
          }
          blocks.show(form);
          isAlone = '';
          for (const name of Object.keys(say)) say[name]();
          if (blocks.layoutText !== before) throw new Error(`blocks stand at ${blocks.layoutText} in place of ${before}`);
        },
        async nameValues() { // of the values of one's own word
          const def = workspace().getBlocksByType('def')[0];
          if (!def) return;
          const before = changes;
          random.of([() => def.addValue(), () => def.removeValue(), () => def.names().length && def.setFieldValue(`Z${random.below(99)}`, 'P0')])();
          await wait(100);
          const calls = workspace().getBlocksByType('call');
          for (const call of calls) {
            const labels = def.names().map((_, k) => call.getFieldValue(`L${k}`));
            if (changes > before && (call.count !== def.names().length || `${labels}` !== `${def.names()}`)) throw new Error(`a call has ${call.count}, ${labels} of ${def.names()}`);
          }
          takeBlocks();
        },
        async run() {
          shownState.running = [];
          say.running();
          await wait(3000);
          if (random() < 0.5) actions.scroll();
          let before = viewOf(), isLeft = false;
          for (let k = random.below(6); k > 0; k -= 1) {
            shownState.running = [{ line: line(), column: 1 }];
            say.running();
            const box = workspace().getBlockById(blocks.lines[innermost(shownState.running[0])]?.[0])?.getBoundingRectangleWithoutChildren();
            const checkSeen = () => {
              const { left, top, width, height } = workspace().getMetricsManager().getViewMetrics(true);
              if (box && !isLeft && (box.left < left || box.right > left + width || box.top < top || box.bottom > top + height)) throw new Error(`what runs is at ${box.left} ${box.top}, and ${[left, top, width, height]} is seen`);
            };
            checkSeen();
            if (box && random() < 0.2) {
              actions.scroll();
              [before, isLeft] = [viewOf(), true];
            }
            await wait(random.below(1500));
            checkSeen();
            if (random() < 0.5) continue;
            blocks.showRunning([]); // for a moment
            await wait(random.below(500));
          }
          shownState.running = [];
          say.running();
          await wait(3000);
          if (`${viewOf()}` !== `${before}`) throw new Error(`after a run the view is ${viewOf()}, and was ${before}`);
        },
        async grow() { // the robot, and is small again
          shownState.running = [];
          say.running();
          await wait(3000);
          actions.scroll();
          const before = viewOf(), { room } = workspace();
          const seenNow = (slack) => workspace().getTopBlocks(false).filter((top) => viewRect(slack).contains(...(({ left, top: y }) => [left, y])(top.getBoundingRectangle()))).length;
          const count = seenNow(0);
          document.documentElement.dataset['big'] = '';
          workspace().nextRoom = { width: 300, height: 400 };
          blocks.resize();
          if (workspace().scale > 0.4 && seenNow(1) < count) throw new Error(`${seenNow(1)} of ${count} stacks are seen beside a large robot ${viewOf()} ${workspace().getTopBlocks(false).map((top) => [top.type, ...Object.values(top.getBoundingRectangle())])}`);
          delete document.documentElement.dataset['big'];
          workspace().nextRoom = room;
          blocks.resize();
          if (`${viewOf()}` !== `${before}`) throw new Error(`beside a small robot the view is ${viewOf()}, and was ${before}`);
        },
        async close() { // a message, which is said again only where the mistake is made again
          const wrong = () => all().find((item) => item.classes?.has('wrong'));
          const openOf = (item) => Boolean(item?.getIcon(blockly.icons.WarningIcon.TYPE)?.getBubble());
          const tell = async (findings) => {
            shownState.findings = findings;
            say.findings();
            await wait(10);
          };
          shownState.fault = null;
          say.fault();
          await tell([]);
          const mistake = [{ line: 1, column: 1, severity: 'mistake', message: 'm', on_blocks: { message: `${random()}`, fix: '', spoken: {} } }];
          workspace().scroll(0, 0);
          for (let k = 2; k > 0; k -= 1) {
            await tell(mistake);
            if (!wrong() || wrong().type === 'program') return;
            if (!openOf(wrong())) throw new Error('nobody says what is wrong');
            await wrong().getIcon(blockly.icons.WarningIcon.TYPE).setBubbleVisible(false);
            workspace().fireChangeListener(Object.assign(Object.create(blockly.Events.BubbleOpen.prototype), { type: 'bubble_open', isUiEvent: true, isOpen: false, blockId: wrong().id }));
            await tell(mistake);
            if (openOf(wrong())) throw new Error('what was put away is said again');
            await tell([]);
          }
        },
        async edit() {
          const moves = all().filter(({ type }) => type === 'move');
          if (!moves.length) return;
          const before = changes;
          const move = random.of(moves);
          move.setFieldValue(move.getFieldValue('WORD') === 'L' ? 'R' : 'L', 'WORD');
          await wait(100);
          if (changes === before) throw new Error('nobody hears of a change of the blocks');
          takeBlocks();
        },
        tryAlone() {
          const [first] = all().filter(({ type }) => type !== 'program');
          if (!first) return;
          tried?.();
          workspace().fireChangeListener?.(Object.assign(Object.create(blockly.Events.Click.prototype), { type: 'click', isUiEvent: true, targetType: 'block', blockId: first.id }));
          isAlone = first.id;
        },
        async end() {
          tried?.();
          await settle();
          isAlone = '';
        },
        goTo: () => blocks.goTo({ line: line(), column: 1 }),
        wait: () => wait(1500),
      };
      const viewOf = () => [workspace().scale, workspace().scrollX, workspace().scrollY].map((item) => Math.round(100 * item) / 100);
      const viewRect = (slack) => (({ left, top, width, height }) => new blockly.utils.Rect(top - slack, top + height + slack, left - slack, left + width + slack))(workspace().getMetricsManager().getViewMetrics(true));
      /** What somebody has done is the program now. */
      const takeBlocks = () => {
        const foundKinds = blocks.readForm();
        form = foundKinds.form;
        blocks.setRanges(foundKinds.ids, flat(form.body).map((item, k) => (item.place = [k + 1, 1, k + 1, 9])));
        for (const name of ['running', 'fault', 'points', 'findings', 'mates']) {
          shownState[name] = name === 'fault' ? null : [];
          say[name]();
        }
      };
      const wordsOf = (item) => [...item.classes ?? []].sort().join(' ');
      const innermost = (place) => {
        const bodies = flat(form.body), foundKinds = bodies.findLastIndex(({ place: [first, , last] }) => place.line >= first && place.line <= last);
        return foundKinds;
      };
      const check = (act) => {
        const { ids } = blocks.readForm(), list = flat(form.body);
        const idAt = (place) => ids[innermost(place)];
        const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`after ${act} ${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
        assertSame(essence(formOf(workspace()).form), essence(form), 'the blocks');
        assertSame(blocks.lines.length, list.length, 'their lines');
        assertSame(hearers, firstHearers, 'who hears of what is done there');
        const wanted = new Map();
        const wantLook = (id, look) => id && wanted.set(id, [...new Set([...wanted.get(id) ?? [], look])]);
        for (const place of shownState.running) wantLook(idAt(place), 'running');
        for (const place of shownState.points) wantLook(idAt(place), 'breakpoint');
        if (shownState.fault) wantLook(idAt(shownState.fault), 'fault');
        for (const item of shownState.findings) if (item.severity === 'mistake') wantLook(idAt(item), 'wrong');
        if (isAlone) wantLook(isAlone, 'alone');
        for (const top of workspace().getTopBlocks(false)) if (!['program', 'def'].includes(top.type)) wantLook(top.id, 'loose');
        for (const item of all()) {
          if (item.type === 'program') continue;
          const inBody = flat(list.filter((_, k) => ids[k] === item.id)).length, count = item.type === 'def' ? 1 : inBody;
          if (inBody || item.outputConnection) assertSame(blockly.ContextMenuRegistry.registry.getItem('blockDelete').displayText({ block: item }), count > 1 ? `Delete ${count} Blocks` : 'Delete Block', `the menu of ${item.type}`);
          assertSame(wordsOf(item), (wanted.get(item.id) ?? []).sort().join(' '), `the looks of ${item.type}`);
          const expectedWarnings = [...shownState.fault && idAt(shownState.fault) === item.id ? [`why ${shownState.fault.line}`] : [], ...shownState.findings.filter((foundKinds) => idAt(foundKinds) === item.id).map((foundKinds) => foundKinds.on_blocks.message)].join('\n\n');
          assertSame(item.getIcon(blockly.icons.WarningIcon.TYPE)?.getText() ?? '', expectedWarnings, `what is said at ${item.type}`);
        }
        const count = all().filter((item) => item.type !== 'program' && !item.outputConnection).length;
        assertSame(blockly.ContextMenuRegistry.registry.getItem('workspaceDelete').displayText({ workspace: workspace() }), count > 1 ? `Delete ${count} Blocks` : 'Delete Block', 'the menu of all');
        if (!blockly.Msg.DELETE_ALL_BLOCKS.includes(` ${count} `)) throw new Error(`${blockly.Msg.DELETE_ALL_BLOCKS} is asked before ${count} are deleted`);
        assertSame(all().flatMap((item) => item.getSvgRoot().children.filter(({ attributes }) => attributes?.class === 'mate_mark').map(() => item.id)).sort(), shownState.mates.flatMap(({ line: wantedLine }) => ids[list.findIndex(({ place }) => place[0] === wantedLine)] ?? []).sort(), 'whoever else is here');
        const used = JSON.stringify(workspace().list).includes('"Y"');
        if (shownState.level !== 'few' && used !== flat([...form.body, ...form.loose.flatMap((item) => item.body)]).some(({ kind, word }) => kind === 'assign' && word === 'Y')) throw new Error(`the list ${used ? 'has' : 'lacks'} a name of the program`);
        if (!container.querySelectorAll('.search').length || container.querySelectorAll('.search').length > 1) throw new Error('the search is not there once');
      };
      const ends = new Set();
      if (isGood) {
        tried?.();
        await wait(3000);
        blocks.beginProgram();
        actions.level();
        actions.robot();
        actions.show();
        for (const name of ['running', 'fault', 'points', 'findings', 'mates']) actions[name]();
        await wait(3000);
      } else actions.show();
      const noted = [];
      for (let k = 4 + random.below(10); k > 0; k -= 1) {
        const act = random.of([...Object.keys(actions), 'show', 'running', 'running']);
        ends.add(act);
        const before = changes;
        await actions[act]();
        await wait(random.of([0, random.below(900)]));
        if (!['edit', 'nameValues', 'put'].includes(act) && changes !== before) throw new Error(`${act} is told as a change`);
        check(act);
        noted.push([act, workspace().scale, workspace().scrollX, workspace().scrollY, JSON.parse(blocks.layoutText).length, structuredClone(workspace().list)]);
      }
      shownState.running = [];
      say.running();
      await wait(3000);
      return { ends: [...ends], seen: isGood && noted };
    };
  },

  // How large the robot is seen, and from where, as a model has it: whoever writes, presses, reads or leaves gets the room
  // back that a run has taken, and no sooner; the browser fills its screen as long as the page does.
  async stage() {
    const page = freshPage();
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { Stage } = await page.load('virtual/stage.js');
    const root = document.documentElement;
    let delay = () => 5;
    document.fullscreenElement = null;
    const fillScreen = async (part) => {
      await later(delay());
      if (document.fullscreenElement === part) return;
      document.fullscreenElement = part;
      document.dispatchEvent(new Event('fullscreenchange'));
    };
    root.requestFullscreen = () => fillScreen(root);
    document.exitFullscreen = () => fillScreen(null);
    let camera = '', stops = 0, isOver = false; // the mouse the program
    document.querySelector = (selector) => (isOver && selector === '#writing:hover' ? writing : null);
    page.byId('runs_open').parent = new (page.byId('runs_open').constructor)();
    const stage = new Stage({ setCamera: (from) => { camera = from; }, stop: () => { stops += 1; } });
    const [cameraButton, fullButton] = page.byId('runs_open').parent.children;
    const [writing, lessons] = ['writing', 'lessons'].map(page.byId);
    const viewState = { full: false, big: false, held: false, whole: false, turns: 0 };
    const shrink = () => { viewState.big &&= ['running', 'paused'].includes(root.dataset['phase']); };
    const key = (name, isTyped = false) => dispatchEvent(Object.assign(new Event('keydown'), { key: name, composedPath: () => (isTyped ? [Object.assign(document.createElement('textarea'))] : []) }));
    const move = () => dispatchEvent(Object.assign(new Event('pointermove'), { pointerType: 'mouse', buttons: 0 }));
    let sides = 0;
    return async (random) => {
      delay = () => random.below(30);
      const actions = {
        run() { root.dataset['phase'] = 'running'; stage.enlarge(); viewState.big = true; viewState.whole = false; },
        pause() { if (root.dataset['phase'] === 'running') root.dataset['phase'] = 'paused'; },
        async end() {
          root.dataset['phase'] = 'ended';
          isOver = random() < 0.5;
          move();
          stage.onRunEnd();
          await wait(250);
          if (isOver || pageState.sideId.value === 'side_lessons') viewState.big = false; // its text is read again
          isOver = false;
        },
        async rest() { // a mouse
          isOver = true;
          for (const ms of [10, 150, 150]) {
            move();
            writing.dispatchEvent(new Event('pointermove'));
            await wait(ms);
            if (('big' in root.dataset) !== viewState.big) throw new Error('the room changes under a mouse that moves');
          }
          await wait(100);
          shrink();
          isOver = false;
        },
        screens: () => pageState.screen.set(random.of(['studio', 'other'])),
        type() { writing.dispatchEvent(new Event('focusin')); if (!viewState.held) shrink(); },
        hold() { writing.dispatchEvent(new Event('pointerdown')); viewState.held = true; },
        async letGo() {
          dispatchEvent(new Event(random.of(['pointerup', 'pointercancel'])));
          if (viewState.held && root.dataset['big'] !== undefined && !viewState.big) throw new Error('it is small before a press is over');
          await wait(1);
          if (viewState.held) shrink();
          viewState.held = false;
        },
        read() { lessons.dispatchEvent(new Event('click')); viewState.big = false; },
        worlds() {
          stage.showWorld();
          viewState.whole = true;
          if (pageState.sideId.value === 'side_lessons') shrink();
        },
        judge() { stage.shrink(); shrink(); },
        home() {
          pageState.screen.set('start');
          pageState.screen.set('studio');
          viewState.full = viewState.big = false;
        },
        same: () => pageState.sideId.set(pageState.sideId.value),
        other() {
          pageState.sideId.set(pageState.sideId.value !== 'side_lessons' && random() < 0.5 ? 'side_lessons' : `side ${(sides += 1)}`);
          viewState.full = false;
        },
        fill() { if (random() < 0.5) fullButton.click(); else key('f'); viewState.full = !viewState.full; },
        letter: () => key('f', true),
        escape() { key('Escape'); viewState.full = false; },
        async leave() { // the browser's Escape, of which the page hears nothing else
          await wait(100);
          const before = stops, wasFilled = document.fullscreenElement !== null;
          fillScreen(null);
          await wait(100);
          if (stops - before !== Number(wasFilled && viewState.full)) throw new Error(`${stops - before} stops are pressed by leaving`);
          if (wasFilled) viewState.full = false;
        },
        turn() { const before = camera; cameraButton.click(); viewState.turns += 1; if (camera === before) throw new Error('the camera stays'); },
        async peek() {
          const endPeek = stage.peek();
          if (random() < 0.5) endPeek();
          await wait(random.below(2000));
          const endNewest = stage.peek();
          await wait(1600);
          if (!('peek' in root.dataset)) throw new Error('the robot is not in its corner');
          endPeek();
          endNewest();
        },
        wait: () => wait(300),
      };
      const ends = new Set();
      for (let k = 10 + random.below(30); k > 0; k -= 1) {
        const act = random.of(Object.keys(actions));
        ends.add(act);
        await actions[act]();
        if (stage.isFull !== viewState.full || ('big' in root.dataset) !== viewState.big) throw new Error(`after ${act} it is ${Object.keys(root.dataset)} in place of ${JSON.stringify(viewState)}`);
        if (!viewState.turns && camera !== (!viewState.whole && (viewState.full || viewState.big || 'peek' in root.dataset) ? 'near' : 'whole')) throw new Error(`after ${act} it is seen from ${camera}`);
        await wait(random.below(60));
        if (random() < 0.7) continue;
        await wait(200);
        if (Boolean(document.fullscreenElement) !== viewState.full) throw new Error(`after ${act} the screen is filled`);
      }
      await actions.letGo();
      await wait(9000);
      if ('peek' in root.dataset) throw new Error('the robot stays in its corner');
      return { ends: [...ends], seen: [] };
    };
  },

  // A phone: what somebody wants of the sheet with mistakes holds until the program is right, and no longer. Run leads to what
  // is to be seen, and runs the robot that is seen.
  async phone() {
    const page = freshPage();
    const phone = Object.assign(new EventTarget(), { matches: false });
    globalThis.matchMedia = () => phone;
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { showSide } = await page.load('page/sides.js');
    const { Phone } = await page.load('page/phone.js');
    let real = 0, virtual = 0; // runs
    new Phone(() => { real += 1; });
    page.byId('run').addEventListener('click', () => { virtual += 1; });
    const root = document.documentElement;
    const pageInputs = { image: '00', count: 0, isAway: null };
    const say = (image, count) => {
      Object.assign(pageInputs, { image, count }, !count && { isAway: null });
      pageState.checkResult.set({ image, findings: Array(count).fill({}) });
    };
    const isAway = () => pageInputs.isAway ?? (pageState.view.value === 'blocks' && pageInputs.image !== '' && pageState.checkResult.value !== null);
    const turn = (isPhone) => {
      phone.matches = isPhone;
      phone.dispatchEvent(new Event('change'));
    };
    const seen = () => [page.byId('writing').dataset.sheet, page.byId('sheet').hidden, page.byId('sheet').attributes['aria-expanded'], root.dataset.half, page.byId('other_name').textContent, 'phone' in root.dataset, page.byId('bar').children.length, real, virtual];
    const actions = {
      wrong: () => say('', 1),
      warned: () => say('00', 1),
      right: () => say('00', 0),
      check: () => pageState.checkResult.set(null),
      sheet() {
        if (page.byId('sheet').hidden) return;
        pageInputs.isAway = !isAway();
        page.byId('sheet').click();
      },
      run() {
        const { half, side } = root.dataset, isReal = phone.matches && side === 'side_real' && half === 'robot';
        const isWrong = pageState.checkResult.value?.image === '', before = [real, virtual];
        if (phone.matches && !isReal && isWrong) pageInputs.isAway = false;
        page.byId('run').click();
        if (`${[real, virtual]}` !== `${[before[0] + Number(isReal), before[1] + Number(!isReal)]}`) throw new Error('another robot runs');
        const expected = !phone.matches || isReal ? [half, side] : isWrong ? ['program', side] : ['robot', side === 'side_lessons' ? side : 'side_virtual'];
        if (`${[root.dataset.half, root.dataset.side]}` !== `${expected}`) throw new Error(`${[root.dataset.half, root.dataset.side]} is seen in place of ${expected}`);
      },
      other: () => page.byId('other').click(),
      changeLanguage: () => pageState.language.set('en'),
      view: (random) => pageState.view.set(random.of(['blocks', 'text'])),
      side: (random) => showSide(random.of(['side_virtual', 'side_lessons', 'side_real'])),
      turn: (random) => turn(random() < 0.7),
    };
    say('00', 0);
    return async (random, isGood) => {
      if (isGood) {
        turn(true);
        for (const part of [page.byId('controls'), page.byId('bar')]) part.children = [];
        say('00', 0);
        pageState.view.set('blocks');
        showSide('side_virtual');
        if (root.dataset.half !== 'program') page.byId('other').click();
        [real, virtual] = [0, 0];
      }
      const ends = new Set(), all = [];
      for (let k = 4 + random.below(12); k > 0; k -= 1) {
        const act = random.of(['wrong', 'sheet', ...Object.keys(actions)]);
        ends.add(act);
        actions[act](random);
        all.push([act, seen()]);
        if (act !== 'check' && pageState.checkResult.value && (page.byId('writing').dataset.sheet === 'away') !== isAway()) throw new Error(`after ${act} the sheet is ${page.byId('writing').dataset.sheet}`);
        if (page.byId('sheet').hidden !== !pageInputs.count) throw new Error('there is no way to what is said, or one to nothing');
        if ('phone' in root.dataset !== phone.matches || (phone.matches && page.byId('run').parent !== page.byId('bar'))) throw new Error('Run is out of reach');
      }
      return { ends: [...ends], seen: all };
    };
  },

  // A tab is loaded again and again, by an address with a code or without one, while other users' workers may read what it
  // asks, answers are lost and nothing can be kept: it asks with the token of its newest code, or says why it has none.
  async entering() {
    let storedItems = [], isFull = false;
    return async (random, isGood) => {
      let ends = '', reloadedCode = ''; // the address of a page that loads itself again
      if (isGood) [storedItems, isFull] = [[], false];
      for (let k = 1 + random.below(5); k > 0; k -= 1) {
        const page = freshPage();
        const store = window.sessionStorage;
        for (const [key, value] of storedItems) store.setItem(key, value);
        if (isFull) store.room = 0;
        const code = reloadedCode || (random() < 0.6 ? Array.from({ length: 32 }, () => random.of([...'0123456789abcdef'])).join('') : '');
        const isAgain = code !== '' && store.getItem('tiniscript.loaded') === code;
        location.hash = code ? `#code=${code}` : random.of(['', '#code=12', '#other']);
        const { hash } = location, before = store.getItem('tiniscript.token') ?? '';
        let reloads = 0;
        location.reload = () => { reloads += 1; };
        const scriptURL = 'http://127.0.0.1/service_worker.js';
        /** What a browser has registered here: the page's own, or one of somebody else. */
        let registrations = Array.from({ length: random.below(3) }, () => {
          const kind = random.of(['own', 'own', 'first', 'address', 'kept', 'newer', 'lost', 'waits']);
          const isOwn = kind === 'own' || kind === 'first', worker = { scriptURL: kind === 'address' ? 'http://127.0.0.1/other.js' : scriptURL };
          const item = {
            isOwn,
            ...kind === 'first' ? { active: null, installing: worker } : { active: worker, waiting: kind === 'waits' ? { scriptURL } : null },
            updateViaCache: kind === 'kept' ? 'all' : 'imports',
            async update() {
              await later(3);
              if (kind === 'lost') throw new Broken();
              if (kind === 'newer') item.installing = { scriptURL };
            },
            unregister: async () => { registrations = registrations.filter((other) => other !== item); },
          };
          return item;
        });
        const ownCount = registrations.filter(({ isOwn }) => isOwn).length, isForeign = registrations.length > ownCount;
        replaceNavigator({ serviceWorker: { getRegistrations: async () => registrations } });
        const cached = new Set(['theirs', 'ours']);
        globalThis.caches = { keys: async () => [...cached], delete: async (name) => cached.delete(name) };
        ends = random.of(['given', 'given', 'used', 'lost']);
        let entryCount = 0;
        const tokens = [];
        replaceFetch(async (path, { headers, body }) => {
          tokens.push(headers['X-TiniScript-Token']);
          if (path !== './enter') return responseOf({ ports: [] });
          entryCount += 1;
          if (JSON.parse(body).code !== code || headers['X-TiniScript-Token']) throw new Error('another code is told');
          await later(5);
          if (ends === 'lost') throw new Broken();
          return responseOf(ends === 'used' ? { failure: 'host_used' } : { token: `token ${code}` });
        });
        let host = null;
        page.load('robot/host.js').then((found) => { host = found; });
        const isEntryRefused = isForeign && code !== '';
        for (let tries = 0; !host && !reloads && tries < 200; tries += 1) {
          await settle();
          await wait(1);
        }
        const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
        reloadedCode = reloads && random() < 0.8 ? code : '';
        assertSame([registrations.filter(({ isOwn }) => isOwn).length, registrations.length, cached.size], [ownCount, isEntryRefused || !isForeign ? ownCount : registrations.length, isEntryRefused ? 0 : 2], 'what is registered, and kept');
        if (isEntryRefused && !isFull && !isAgain) assertSame([reloads, entryCount, location.hash], [1, 0, hash], 'beside a worker of somebody else');
        else {
          const token = isEntryRefused ? before : !code ? before : ends === 'given' ? `token ${code}` : '';
          assertSame([host.entryFailure, host.hasHost, entryCount], [isEntryRefused ? 'host_worker' : !code || ends === 'given' ? '' : ends === 'used' ? 'host_used' : 'host_gone', token !== '', Number(code !== '' && !isEntryRefused)], `by ${hash}`);
          if (code && !isEntryRefused) assertSame(location.hash, '', 'the address');
          await Promise.all([host.fetchPorts(), settle()]);
          assertSame(tokens.at(-1), token, 'the token');
          if (!isFull && code && !isEntryRefused && ends === 'given') assertSame(store.getItem('tiniscript.token'), token, 'what is kept');
        }
        store.room = Infinity;
        storedItems = [...store];
        isFull = !isGood && random() < 0.3;
      }
      return { ends: [ends], seen: [] };
    };
  },

  // Run and STOP are pressed at any time: the last one counts.
  async presses() {
    const shapes = { start: { x_cm: 0, y_cm: 0 }, flags: [], rivals: [], rings: [], seconds: 0, name: 'w' };
    class Choice { shownWorld = shapes; goals = []; request = 'w'; async restoreOwn() { return true; } }
    class Drawing { notice = ''; enable() {} reset() {} cancelDrag() {} end() {} }
    const notingClass = (name) => function made() { return noting([], name); };
    const page = freshPage({
      Arena: notingClass('arena'), Plot: notingClass('plot'), RunAnnouncer: notingClass('announcer'), Sounds: notingClass('sounds'),
      starsText: String, boutEndText: String, bumpSentence: String, WorldChoice: Choice, WorldDrawing: Drawing, replaceOptions() {}, makePictureOption() {}, makeDialPicture() {},
    });
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { SimulatorPanel } = await page.load('virtual/simulator_panel.js');
    pageState.robotName.set('tinibot');
    let delay = () => 5;
    let robot = null;
    let wantsRun = false; // a run
    let startsAfterStop = false;
    let begun = 0;
    let worker = Promise.resolve(); // it does one thing after the other
    const program = { ...PROGRAM, places: [[0, 1, 1, 1, 9], [3, 2, 1, 2, 9]] };
    let sentBreakpoints = []; // where what runs stops
    const python = {
      ask(request) {
        sentBreakpoints = request.breakpoints ?? sentBreakpoints;
        if (request.do === 'power_on') {
          startsAfterStop ||= !wantsRun;
          begun += 1;
        }
        const askedRobot = robot;
        worker = worker.then(() => later(delay())).then(() => (request.do === 'check' ? program : askedRobot.answer(request)));
        return worker;
      },
    };
    const whenChecked = async () => {
      await later(delay());
      pageState.checkResult.set(program);
      return program;
    };
    robot = virtualRobot(chanceOf(1), true);
    page.byId('arena').checkVisibility = () => true;
    const panel = new SimulatorPanel({ python, work: { world: 'w', sound: true }, whenChecked, storeCurrentWork() {}, pad: { offerRobot() {} } });
    await settle();
    const { dataset } = document.documentElement;
    let lastPlace = '', driven_ms = 0; // the place of STOP stays for a while, however a run has ended
    window.setInterval(() => {
      const { phase, stop: place = '' } = dataset;
      if (lastPlace && !place && now() - driven_ms < 1400) throw new Error('something else takes the place of STOP');
      if (phase === 'running' || phase === 'paused') driven_ms = now();
      lastPlace = place;
    }, 50);
    return async (random, isGood) => {
      delay = () => (isGood ? 5 : random.below(150));
      robot = runningRobot(random);
      const ways = {
        run: () => page.byId('run').click(),
        step: () => page.byId('step').click(),
        pause: () => page.byId('pause').disabled || page.byId('pause').click(),
        stop: () => page.byId('stop').click(),
        escape: () => dispatchEvent(Object.assign(new Event('keydown'), { key: 'Escape' })),
        edit: () => pageState.checkResult.set(null),
        points: () => pageState.breakpoints.set([1, 2].map((line) => ({ line, column: 1, point: {} }))),
      };
      let end = '';
      for (let k = 3 + random.below(8); k > 0; k -= 1) {
        const way = random.of(Object.keys(ways));
        if (way === 'run' || (way === 'step' && !['running', 'paused'].includes(dataset['phase']))) wantsRun = true;
        if (way === 'stop' || way === 'escape') wantsRun = false;
        end = way;
        const before = begun;
        ways[way]();
        await wait(random() < 0.5 ? random.below(30) : random.below(600));
        if (way !== 'run' || k > 1) continue;
        await wait(1500);
        if (begun === before) throw new Error('it does not start');
      }
      ways.stop();
      wantsRun = false;
      await wait(1500);
      if (startsAfterStop) throw new Error('it starts after a STOP');
      if (dataset['phase'] === 'running' || dataset['phase'] === 'paused') throw new Error('it goes on');
      let open = 0;
      const tryBlock = async (isToRun) => {
        const before = begun;
        open += 1;
        panel.tryAlone('F(1)', true, () => {}).then(() => { open -= 1; });
        await wait(600);
        pageState.breakpoints.set(pageState.breakpoints.value.slice(1));
        await wait(900);
        if (isToRun && (sentBreakpoints.length || pageState.virtualRun.value.ranges.length)) throw new Error(`a block that is tried stops at ${sentBreakpoints}, or is seen in the text`);
        if ((begun > before) !== isToRun) throw new Error(isToRun ? 'a block that is tried does not run' : 'it runs in the place of the whole program');
      };
      wantsRun = true;
      await tryBlock(true);
      panel.play({ lesson: 1, seed: 1, until_ms: 900 });
      await wait(600);
      ways.points();
      await wait(600);
      if (sentBreakpoints.length) throw new Error(`a run that is shown stops at ${sentBreakpoints}`);
      ways.stop();
      await wait(1500);
      if (open) throw new Error('a block that was tried never ends');
      ways.edit();
      ways.run();
      await wait(8000); // until its end
      await tryBlock(true);
      await wait(8000);
      robot = runningRobot(random);
      ways.run();
      await wait(500);
      if (dataset['phase'] === 'running') await tryBlock(false);
      ways.stop();
      wantsRun = false;
      await wait(1500);
      return { ends: [end], seen: [] };
    };
  },
};

/** A browser in which nobody has the key of a robot. */
const NO_KEYS = { load: () => '', store() {} };

/** What the side with a real robot imports, where a part plays the robot. */
const REAL_SIDE = {
  replaceOptions() {}, makePictureOption() {}, makeSymbolPicture() {}, hasSerial: false, choosePort() {}, listKnownPorts: async () => [], hasHost: true, isPupil: false, isTeacher: false, post: async () => ({ robots: [] }),
  fetchPorts: async () => [],
};

const responseOf = (found) => ({ ok: true, status: 200, json: async () => found });

/** @returns one that runs */
function runningRobot(random) {
  for (;;) {
    const robot = virtualRobot(random, false);
    if (robot.outcome === 'runs') return robot;
  }
}

for (let seed = 0; seed < Number(seeds); seed += 1) {
  const used = await PARTS[part]();
  const first = await used(chanceOf(seed + 1), false);
  await settle();
  const after = await used(chanceOf(seed + 1000), true);
  const alone = await (await PARTS[part]())(chanceOf(seed + 1000), true);
  const found = compared(after.seen, alone.seen);
  console.log(JSON.stringify({ ends: first.ends, ...found, unhandled: unhandled.splice(0) }));
}
