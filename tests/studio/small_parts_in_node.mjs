// node small_parts_in_node.mjs SOURCES MADE FIRST SEEDS: each small part of the page through random histories of what somebody
// does, on a clock of the script; after each step a plain model says what has to be seen and told. Prints for each part
// what its histories have done.

import { readFileSync } from 'node:fs';
import { playedEditor, view } from './editor_in_node.mjs';
import { chanceOf, chooseFile, freshPage, later, loadTexts, made, now, replaceFetch, replaceNavigator, settle, sources, wait, words } from './page_in_node.mjs';

const HTML = readFileSync(`${sources}/index.html`, 'utf-8');
const [first, seeds] = words.map(Number);
Date.now = () => 1_700_000_000_000 + now();
const unhandled = [];
for (const kind of ['unhandledRejection', 'uncaughtException']) process.on(kind, (error) => unhandled.push(String(error)));

let resizeCallbacks = [];
globalThis.ResizeObserver = class {
  constructor(callback) { resizeCallbacks.push(callback); }
  observe() {}
};
globalThis.getComputedStyle = () => ({ getPropertyValue: (name) => name });
globalThis.alert = () => {};

class Failure extends Error {}
const assertSame = (found, expected, what) => {
  if (JSON.stringify(found) !== JSON.stringify(expected)) throw new Failure(`${what}: ${JSON.stringify(found)} in place of ${JSON.stringify(expected)}`);
};
const saidOf = (part) => (typeof part === 'string' ? part : [part.textContent, ...part.children.map(saidOf)].join(''));
const press = (part) => part.dispatchEvent(new Event('click', { bubbles: true, cancelable: true }));
const change = (part, values, kind = 'change') => {
  Object.assign(part, values);
  part.dispatchEvent(new Event(kind, { bubbles: true }));
};
const LANGUAGES = ['en', 'es', 'pt'];
const TEXTS = JSON.parse(readFileSync(`${made}/texts.json`, 'utf-8'));

/** Another language, whose sentences end with its name. */
async function changeLanguage(page, language) {
  const withLanguage = (text) => (typeof text === 'string' ? `${text} ${language}` : Array.isArray(text) && typeof text[0] === 'string' ? text.map(withLanguage) : text);
  replaceFetch(async () => ({ ok: true, json: async () => Object.fromEntries(Object.entries(TEXTS).map(([key, text]) => [key, key ? withLanguage(text) : text])) }));
  const { setLanguage } = await page.load('page/texts.js');
  await setLanguage(language);
}

/** Each begins a page and gives its acts, what the acts are followed by, and which there are. */
const PARTS = {
  // Which screen is seen, and what the start shows: pictures that begin, earlier programs, stars.
  async start(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { text } = await page.load('page/texts.js');
    const screens = await page.load('start/screens.js');
    const { Start } = await page.load('start/start.js');
    const { BEGINNINGS } = await page.load('start/beginnings.js');
    const versions = await page.load('programs/versions.js');
    const progress = await page.load('lesson/progress.js');
    const { STARS } = await page.load('page/words.js');
    const hasStart = random() < 0.8, isProgram = random() < 0.2;
    location.hash = random.of(['', '', '#editor', '#p=given']);
    let entries = 0;
    const push = history.pushState;
    history.pushState = (...given) => {
      entries += 1;
      push(...given);
    };
    let screen = isProgram || !hasStart || location.hash === '#editor' ? 'program' : 'start';
    screens.openFirstScreen(isProgram, hasStart);
    let reports = [], beginning = null, isRefused = false;
    const tell = (...what) => { reports.push(what); };
    new Start({
      putProgram: ({ text, robot, name }) => tell('put', text, robot, name),
      async runInWorld(world) {
        tell('run', world);
        await beginning.run;
      },
      onProgramShown: () => tell('see'), showSide: (id) => tell('side', id), leaveProgram: () => tell('leave'),
    });
    assertSame(reports.splice(0), screen === 'program' ? [['see']] : [], 'told at first');
    const go = (to) => {
      if (screen === to) return [];
      screen = to;
      focus = to === 'start' ? 'start' : 'home';
      return to === 'start' ? [['leave']] : beginning ? [] : [['see']];
    };
    let focus = '', expected = [], pushed = 0;
    const show = (to) => {
      if (screen !== to) pushed += 1;
      return go(to);
    };
    const actions = {
      home() {
        press(page.byId('home'));
        expected = show('start');
      },
      way() {
        const [way, side, place] = random.of([['write', 'side_virtual', 'writing'], ['lessons', 'side_lessons', 'lesson_page'], ['robot', 'side_real', 'side_real']]);
        press(page.byId(`start_${way}`));
        expected = [...show('program'), ['side', side]];
        focus = place;
      },
      begin() {
        if (beginning) return;
        const name = random.of(Object.keys(BEGINNINGS)), { text: program, robot, world } = BEGINNINGS[name];
        let settlers;
        beginning = { run: new Promise((good, bad) => { settlers = { good, bad }; }), settlers: () => settlers };
        press(document.querySelectorAll(`[data-begin=${name}]`)[0]);
        expected = [['put', program, robot, `${text(`begin_${name}`).toLowerCase()}.ts`], ['side', 'side_virtual'], ['run', world]];
        focus = 'stop';
      },
      runSeen() { // the run shows itself
        screens.showScreen('program');
        expected = show('program');
      },
      async end() {
        if (!beginning) return;
        const { good, bad } = beginning.settlers();
        isRefused = random() < 0.3;
        if (isRefused) bad(new Error('refused'));
        else good();
        beginning = null;
        await settle();
        unhandled.splice(0);
        expected = [['see']];
      },
      instead() {
        screens.showProgramInstead();
        expected = go('program');
        assertSame(location.hash, '#editor', 'the address');
      },
      back() {
        location.hash = random.of(['', '#editor', '#p=given']);
        const isScreen = location.hash !== '#p=given';
        dispatchEvent(new Event('popstate'));
        expected = hasStart && isScreen ? go(location.hash ? 'program' : 'start') : [];
      },
      keep() {
        for (let k = random.of([1, 8]); k > 0; k -= 1) versions.storeVersion({ text: `F(${random.below(20)});\nB(1)`, robot: 'tinibot', name: random.of(['', 'one.ts']) });
        pageState.view.set(pageState.view.value);
      },
      stars() {
        const names = [...Object.keys(STARS.lessons).slice(-3), 'gone']; // a lesson that is no more counts nothing
        if (random() < 0.5) progress.storeDoneLesson(random.of(names));
        else progress.storeStars(random.of([...names, ...Object.keys(STARS.worlds).map(progress.starsKeyOfWorld)]), 1 + random.below(9));
        pageState.language.set(pageState.language.value);
      },
      forget() {
        window.localStorage.removeItem(random.of(['tiniscript.versions', 'tiniscript.stars', 'tiniscript.lessons']));
        pageState.view.set(pageState.view.value);
      },
      changeLanguage: () => changeLanguage(page, random.of(LANGUAGES)),
      views: () => pageState.view.set(random.of(['blocks', 'text'])),
      open() {
        const rows = page.byId('start_programs').children;
        if (screen !== 'start' || !rows.length) return;
        const index = random.below(rows.length), { text: program, robot, name } = versions.loadVersions()[index];
        press(rows[index].querySelector('button'));
        expected = [['put', program, robot, name]];
      },
    };
    const check = () => {
      assertSame(reports, expected, 'told');
      assertSame([pageState.screen.value, document.documentElement.dataset.screen, entries], [screen, screen, pushed], 'the screen');
      if (focus) assertSame(document.activeElement?.id, focus, 'what has the focus');
      [reports, expected] = [[], []];
      if (screen !== 'start') return;
      const earlier = versions.loadVersions();
      const times = new Intl.DateTimeFormat(pageState.language.value, { dateStyle: 'short', timeStyle: 'short' });
      assertSame(page.byId('start_programs').children.map((row) => [saidOf(row.querySelector('strong')), saidOf(row.querySelector('time'))]),
        earlier.map((version, k) => [versions.versionTitle(version, earlier.length - k), times.format(new Date(version.at_ms))]).slice(0, 6), 'the programs');
      assertSame(page.byId('start_programs_title').hidden, !earlier.length, 'no title');
      const badge = page.byId('start_badge'), doneLessons = progress.loadDoneLessons(), earned = progress.loadStars();
      const most = [...Object.entries(STARS.lessons), ...Object.entries(STARS.worlds).map(([name, count]) => [progress.starsKeyOfWorld(name), count])];
      const [stars, all] = [most.map(([name, count]) => Math.min(count, earned.get(name) ?? 0)), most.map(([, count]) => count)].map((counts) => counts.reduce((sum, count) => sum + count, 0));
      const lessons = Object.keys(STARS.lessons).length, done = Object.keys(STARS.lessons).filter((name) => doneLessons.has(name)).length;
      assertSame([badge.hidden, ...badge.children.map(saidOf)], [!stars, `✓ ${done}/${lessons}  ★ ${stars}/${all}`, text('lesson_progress', { done, lessons, stars, most: all })], 'the stars');
    };
    return { acts: actions, check };
  },

  // Earlier programs, of two tabs and of a storage that may bring anything: each is there once.
  async versions(random) {
    const page = freshPage();
    await loadTexts(page);
    const { deleteVersion, loadVersions, restoreVersion, isSameProgramAs, storeVersion } = await page.load('programs/versions.js');
    const KEY = 'tiniscript.versions';
    let model = [], at_ms = 1e12, deleted = [];
    const same = (one, other) => one.robot === other.robot && one.text.replace(/\s/g, '') === other.text.replace(/\s/g, '');
    const some = () => ({ text: random.of(['F(1);', 'F( 1 );', 'F(2);', 'F(1);B(2);', 'S;']), robot: random.of(['tinibot', 'liner']), name: random.of(['', 'one.ts', 'two.ts']) });
    const actions = {
      keep() {
        const program = some();
        at_ms += random.of([1, 1, 1000, -5000]); // a clock may be set back
        assertSame(storeVersion(program, at_ms), true, 'whether it is kept');
        model = [{ ...program, at_ms }, ...model.filter((other) => !same(other, program))];
      },
      delete() {
        if (!model.length) return;
        const version = random.of(model);
        deleteVersion(version);
        deleted.push(version);
        model = model.filter((other) => other !== version);
      },
      restore() {
        if (!deleted.length) return;
        const version = random.of(deleted);
        assertSame(restoreVersion(version), true, 'whether it is back');
        if (model.some((other) => same(other, version))) return;
        const older = model.findIndex((other) => other.at_ms < version.at_ms);
        model.splice(older < 0 ? model.length : older, 0, version);
      },
      openWindow: () => { deleted = []; },
      store() { // another tab, or an older page, which knew no such law
        const versions = Array.from({ length: random.below(9) }, () => ({ ...some(), at_ms: at_ms + random.below(9) }));
        window.localStorage.setItem(KEY, JSON.stringify(versions));
        model = versions.filter((version, k) => !versions.slice(0, k).some((other) => same(other, version)));
      },
    };
    const check = () => {
      const versions = loadVersions();
      assertSame(versions, model, 'the programs');
      for (const [k, version] of versions.entries()) if (versions.slice(k + 1).some(isSameProgramAs(version))) throw new Failure(`${version.text} is there twice`);
    };
    return { acts: actions, check };
  },

  // The window with a robot's name and colour.
  async own(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { text } = await page.load('page/texts.js');
    const { showOwnRobot, validOwnRobot, COLOURS } = await page.load('page/own_robot.js');
    const { OwnRobotWindow } = await page.load('start/own_window.js');
    showOwnRobot();
    new OwnRobotWindow();
    const dialog = document.querySelectorAll('dialog').find(({ id }) => id === 'own');
    const nameInput = dialog.querySelectorAll('input').find(({ type }) => type !== 'radio');
    const radios = dialog.querySelectorAll('input').filter(({ type }) => type === 'radio');
    let own = { name: '', colour: 0 }, kept = true, isKept = true;
    const store = (changed) => {
      own = validOwnRobot({ ...own, ...changed });
      isKept = window.localStorage.room > 0;
      if (!isKept) assertSame(pageState.note.value, text('not_kept'), 'said of what is not kept');
      else kept = JSON.stringify(own);
      pageState.note.set('');
    };
    const actions = {
      open() {
        for (const radio of radios) radio.checked = false;
        press(page.byId('start_own'));
        assertSame([dialog.open, nameInput.value, radios.findIndex(({ checked }) => checked)], [true, own.name, own.colour], 'the window');
      },
      close: () => dialog.querySelectorAll('button').find(({ dataset }) => dataset.text === 'close').click(),
      name() {
        const name = random.of(['', ' Robbi ', 'R2', 'a name that is too long for it']);
        change(nameInput, { value: name }, 'input');
        store({ name });
      },
      paint() {
        const colour = random.below(COLOURS.length);
        change(radios[colour], { checked: true });
        store({ colour });
      },
      others() { // another one comes, of a class
        own = { name: random.of(['', 'Pia']), colour: random.below(COLOURS.length) };
        pageState.ownRobot.set(own);
      },
      changeLanguage: () => changeLanguage(page, random.of(LANGUAGES)),
      fill: () => { window.localStorage.room = random.of([0, Infinity]); },
    };
    const check = () => {
      assertSame(pageState.ownRobot.value, own, 'the robot');
      assertSame(saidOf(page.byId('start_own')).endsWith(own.name) && page.byId('start_own').lastElementChild.textContent, own.name, 'its name');
      assertSame(window.localStorage.getItem('tiniscript.own_robot') ?? true, kept, 'what is kept');
      assertSame(radios.map(({ ariaLabel }) => ariaLabel), COLOURS.map(([, , key]) => text(key)), 'the colours');
    };
    return { acts: actions, check };
  },

  // Children press everything twice: what they hear a second time is not for what has come to its place.
  async twice(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    const { ignoreSecondPresses, isSecondPress } = await page.load('page/twice.js');
    ignoreSecondPresses();
    const buttons = ['one', 'two', 'stop'].map((name) => Object.assign(document.createElement('button'), { id: name, className: name === 'stop' ? 'stop' : '' }));
    document.body.append(...buttons);
    const inner = document.createElement('span');
    buttons[0].append(inner);
    let heard = [];
    for (const button of buttons) for (const kind of ['pointerdown', 'mousedown', 'click']) button.addEventListener(kind, (event) => heard.push([kind, event.type === 'click' && isSecondPress(event)]));
    const elsewhere = document.createElement('p');
    document.body.append(elsewhere);
    let first = { ms: -1e9, x: 0, y: 0, button: null }, last = { ms: -1e9, x: 0, y: 0 }, count = 0, tappedTwice = false;
    const at = (kind, target, more) => {
      const event = Object.assign(new Event(kind, { bubbles: true, cancelable: true }), more);
      Object.defineProperty(event, 'timeStamp', { value: now() + 10_000 });
      target.dispatchEvent(event);
      return event.defaultPrevented;
    };
    const actions = {
      press() {
        const visible = buttons.filter((item) => item.checkVisibility());
        const target = random() < 0.15 || !visible.length ? elsewhere : random.of(visible);
        const place = random.of([{ clientX: last.x, clientY: last.y }, { clientX: last.x, clientY: last.y + 5 }, { clientX: last.x + 20, clientY: last.y }, { clientX: random.below(300), clientY: 50 }]);
        const pointerType = random.of(['mouse', 'touch']);
        const near = (other) => Math.hypot(place.clientX - other.x, place.clientY - other.y) < 30;
        // A mouse's clicks are counted from the last one, a finger's are not.
        count = pointerType === 'mouse' && now() - last.ms < 500 && near(last) ? count + 1 : 1;
        last = { ms: now(), x: place.clientX, y: place.clientY };
        const isSecond = now() - first.ms < 500 && near(first);
        tappedTwice = isSecond && pointerType === 'touch';
        const isSecondClick = count > 1 || tappedTwice;
        if (!isSecond) first = { ms: now(), x: place.clientX, y: place.clientY, button: target === elsewhere ? null : target };
        const isHidden = first.button && !first.button.checkVisibility();
        const isTaken = (second) => Boolean(second && isHidden && target.id !== 'stop');
        heard = [];
        const aim = target.id === 'one' && random() < 0.5 ? inner : target;
        const prevented = [at('pointerdown', aim, { ...place, pointerType, detail: 0 }), at('mousedown', aim, { ...place, detail: count }), at('click', aim, { ...place, detail: count })];
        assertSame(prevented, [isTaken(isSecond), isTaken(isSecondClick), isTaken(isSecondClick)], 'what is taken');
        if (target !== elsewhere) assertSame(heard, [...isTaken(isSecond) ? [] : [['pointerdown', false]], ...isTaken(isSecondClick) ? [] : [['mousedown', false], ['click', isSecondClick]]], 'heard');
        if (random() < 0.3) buttons[random.below(3)].hidden = true; // by what was pressed
      },
      keys() {
        const target = random.of(buttons.filter((item) => item.checkVisibility()).concat(elsewhere));
        heard = [];
        assertSame(at('click', target, { clientX: 0, clientY: 0, detail: 0 }), false, 'a key is taken');
        if (target !== elsewhere) assertSame(heard, [['click', false]], 'heard of a key');
      },
      hide: () => { random.of(buttons).hidden = random() < 0.6; },
    };
    return { acts: { ...actions, pressMore: actions.press, pressAgain: actions.press, pressThen: actions.press }, check() {}, pauses_ms: [0, 100, 200, 450, 600] };
  },

  // The place of STOP: nothing else is there until a while after what moved has ended, or after a press.
  async stop(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    const { setStopNeeded } = await page.load('page/stop_place.js');
    const COMES_MS = 500, STAYS_MS = 1500;
    const needs = Object.fromEntries(['run', 'link'].map((name) => [name, { isNeeded: false, isThere: false, since_ms: 0 }]));
    const look = () => {
      for (const need of Object.values(needs)) {
        if (need.isThere !== need.isNeeded && now() - need.since_ms >= (need.isThere ? STAYS_MS : COMES_MS)) need.isThere = need.isNeeded;
      }
    };
    const set = (name, isNeeded) => {
      if (isNeeded !== needs[name].isNeeded) Object.assign(needs[name], { isNeeded, since_ms: now() });
      setStopNeeded(name, isNeeded);
    };
    const actions = {
      begin: () => set('run', true),
      end: () => set('run', false),
      connect: () => set('link', true),
      leave: () => set('link', false),
      press() {
        for (const need of Object.values(needs)) if (need.isThere && !need.isNeeded) need.since_ms = now();
        page.byId('stop').dispatchEvent(new Event('pointerdown', { bubbles: true }));
      },
    };
    const check = () => {
      look();
      const { stop = '' } = document.documentElement.dataset;
      assertSame(stop.split(' ').filter(Boolean).sort(), Object.keys(needs).filter((name) => needs[name].isThere).sort(), 'why STOP lies there');
    };
    const acts = Object.fromEntries(Object.entries(actions).map(([name, act]) => [name, () => {
      check();
      act();
    }]));
    return { acts: { ...acts, endAgain: acts.end, pressAgain: acts.press, wait: check }, check, pauses_ms: [0, 200, 450, 499, 700, 1400, 1500] };
  },

  // The line under the world, of one run after another.
  async timeLine(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    const { TimeLine } = await page.load('virtual/time_line.js');
    const { Run } = await page.load('virtual/runs.js');
    resizeCallbacks = [];
    const slider = page.byId('time_at'), canvas = page.byId('time_marks');
    let drawn = [];
    const pen = { fillStyle: '', fillRect: (...given) => drawn.push([pen.fillStyle, ...given]) };
    canvas.getContext = () => pen;
    Object.defineProperty(canvas, 'width', { set() {
      drawn = [];
      paintings += 1;
    }, get: () => size[0] * ratio, configurable: true });
    Object.defineProperty(canvas, 'height', { set() {}, get: () => size[1] * ratio, configurable: true });
    let size = [0, 0], ratio = 1, lookCount = 0, wantedLookCount = 0, paintings = 0;
    const line = new TimeLine(() => { lookCount += 1; });
    let run = null, at_ms = null, isShown = false, isDrawn = false, count = 0, bumps = 0, now_ms = 0;
    const EMPTY = new Run({ of: 'virtual', text: '', robot: '', program: '' }, { places: [], shows: [], variables: [] }, null);
    const seen = () => run ?? EMPTY;
    const momentOf = () => seen().moments.momentAt(at_ms ?? Infinity);
    const add = (isQuiet) => {
      now_ms += 1 + random.below(300);
      bumps += !isQuiet && random() < 0.2 ? 1 : 0;
      const events = isQuiet ? [] : [[now_ms, random.of([`SHOW ${random.below(9)}`, 'BEEP 440 100', 'MOTORS 1 2']), random.below(3)]];
      run.add({ now_ms, began_ms: run.beganAt, pose: [0, 0, 0], bumps, at: random.below(3), places: [random.below(3)], is_running: true, variables: [], events, rows: random() < 0.2 ? [[now_ms, 'KEYS 1 0 0']] : [] });
    };
    const lookAt = (ms) => {
      if (!seen().moments.length) return;
      at_ms = ms;
      wantedLookCount += 1;
    };
    const actions = {
      begin() {
        if (random() < 0.2) run = null;
        else {
          run = new Run({ of: 'virtual', text: '', robot: 'tinibot', program: '' }, { places: [], shows: [], variables: [] }, null);
          Object.assign(run, { number: count += 1, beganAt: random.of([0, null, 40]) });
          bumps = 0;
          now_ms = random.below(500);
          if (random() < 0.3) { // as long as another one, with other marks
            now_ms = 100;
            for (const ms of [100, 1000, 2000]) run.add({ now_ms: ms, began_ms: 0, pose: [0, 0, 0], bumps, at: 0, places: [ms], is_running: true, variables: [], events: [[ms < 200 ? random.below(90) + 10 : ms - random.below(900), 'BEEP 440 100', 0]], rows: [] });
            now_ms = 2000;
          } else for (let k = random.of([0, 1, 2, 30, 30, 30]); k > 0; k -= 1) add(random() < 0.5);
        }
        at_ms = null;
        if (run) line.setRun(run);
        else line.setRun();
        isShown = true;
        isDrawn = seen().moments.length > 1 && size[0] > 0;
      },
      goOn() {
        if (!run) return;
        for (let k = 1 + random.below(4); k > 0; k -= 1) add(random() < 0.5);
        isShown = isDrawn = false;
      },
      show() {
        line.show();
        isShown = true;
        isDrawn = seen().moments.length > 1 && size[0] > 0;
        const before = paintings;
        line.show();
        assertSame(paintings, before, 'what is drawn anew and is the same');
      },
      leave() {
        at_ms = null;
        line.returnToNewest();
        isShown = false;
      },
      move() {
        const ms = random.below(4000);
        change(slider, { value: String(ms) }, 'input');
        lookAt(ms);
        isShown = false;
      },
      keys() {
        const key = random.of(['ArrowLeft', 'ArrowRight', 'ArrowUp', 'ArrowDown', 'Home']);
        const more = { [random.of(['shiftKey', 'shiftKey', 'altKey', 'none'])]: true };
        const event = Object.assign(new Event('keydown', { cancelable: true }), { key, ...more });
        const { moments } = seen();
        const isOurs = key !== 'Home' && !more.altKey;
        const moment = isOurs && moments.neighbourOf(momentOf(), ['ArrowLeft', 'ArrowDown'].includes(key) ? -1 : 1, more.shiftKey ? moments.parts : moments.events);
        slider.dispatchEvent(event);
        assertSame(event.defaultPrevented, isOurs, 'the browser moves it, too');
        if (isOurs) lookAt(moments.at(moment).now_ms);
        isShown = false;
      },
      resize() {
        size = random.of([[0, 0], [100, 20], [300, 20]]);
        [canvas.clientWidth, canvas.clientHeight] = size;
        for (const callback of resizeCallbacks) callback();
        isDrawn = size[0] > 0;
      },
      darken() {
        window.devicePixelRatio = ratio = random.of([1, 2]);
        document.documentElement.toggleAttribute('data-dark', random() < 0.5);
        isDrawn = false;
      },
    };
    const check = () => {
      assertSame(lookCount, wantedLookCount, 'times that somebody looked back');
      assertSame(line.run === seen() || !run, true, 'the run that is seen');
      const { moments, marks } = seen();
      assertSame(line.pastState, at_ms === null ? null : moments.at(momentOf()), 'the state');
      const { shown = [] } = moments.at(momentOf());
      assertSame([...new Map(line.shownEvents.map((event) => [event[2], event])).values()].map(([ms]) => ms).sort(), shown.map(([ms]) => ms).sort(), 'what is shown');
      if (line.shownEvents.length) assertSame(line.shownEvents.at(-1)[0], Math.max(...shown.map(([ms]) => ms)), 'the newest of what is shown');
      if (isShown) {
        const last = moments.at(momentOf());
        assertSame([slider.disabled, slider.min, slider.max, slider.value], moments.length < 2 ? [true, '0', '0', '0'] : [false, String(moments.first_ms), String(moments.last_ms), String(last.now_ms)], 'the line');
        if (moments.length > 1) assertSame(slider.getAttribute('aria-valuetext'), `${((last.now_ms - (last.began_ms ?? last.now_ms)) / 1000).toFixed(1)} s`, 'what is said of it');
      }
      if (!isDrawn) return;
      const pixels = (size[0] * ratio - 2 * ratio) / Math.max(1, moments.last_ms - moments.first_ms);
      const places = new Set(marks.filter((mark) => mark.at_ms >= moments.first_ms).map((mark) => Math.round((mark.at_ms - moments.first_ms) * pixels)));
      assertSame([...new Set(drawn.map(([, x]) => x))].sort((a, b) => a - b), [...places].sort((a, b) => a - b), 'what is drawn');
      assertSame(drawn.every(([, , y, , height]) => y + height === size[1] * ratio), true, 'where it is drawn');
    };
    return { acts: { ...actions, moveMore: actions.move, grow: actions.goOn, showAgain: actions.show }, check };
  },

  // The window of the last runs.
  async runs(random) {
    replaceNavigator({});
    const page = freshPage({}, HTML);
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { text } = await page.load('page/texts.js');
    const { bugSentence } = await page.load('page/faults.js');
    const { Run, Runs } = await page.load('virtual/runs.js');
    const { RunsWindow } = await page.load('virtual/runs_window.js');
    const runs = new Runs(), dialog = page.byId('runs'), list = page.byId('runs_list'), said = page.byId('runs_said');
    let answer = () => ({}), reports = [], asked = [], saved = [];
    const python = {
      async ask(request, data) {
        asked.push([request.do, request.end_ms, request.text, data && new TextDecoder().decode(data)]);
        await later(5);
        return answer(request);
      },
    };
    URL.createObjectURL = (blob) => blob.text().then((content) => saved.push(content)) && 'blob:';
    URL.revokeObjectURL = () => {};
    const runsWindow = new RunsWindow({ python, runs, show: (run) => reports.push(['show', run.number]), play: (opened, known) => reports.push(['play', opened.fileText, opened.text, known?.number]) });
    let notice = '', note = '', kept = [];
    const REFUSALS = Object.keys(TEXTS).filter((key) => key.startsWith('record_'));
    const refuse = (name, error) => {
      if (dialog.open) notice = error;
      else note = text('not_opened', { name, why: error });
    };
    const titleOf = (run) => text(run.origin.of === 'real' ? 'run_real' : 'run_virtual', { number: run.number, seconds: run.duration_s.toFixed(1) });
    const fileOf = (content, isReadable = true) => ({ name: random.of(['a.tsr', 'B.TSR']), slice: () => ({ arrayBuffer: async () => {
      if (!isReadable) throw new Error('gone');
      return new TextEncoder().encode(content).buffer;
    } }) });
    const open = async (give) => {
      const content = `file ${random.below(100)}`, isReadable = random() < 0.8, error = random() < 0.4 ? random.of(REFUSALS).slice('record_'.length) : '';
      answer = () => (error ? { what: error, line: 7 } : { text: 'T', rows: [] });
      const wasOpen = dialog.open;
      const file = fileOf(content, isReadable);
      const given = give(file);
      if (given === false) return;
      await wait(50);
      if (!isReadable) refuse(file.name, text('unreadable'));
      else if (error) refuse(file.name, text(`record_${error}`, { line: 7 }));
      else {
        assertSame(reports.splice(0), [['play', content, 'T', null]], 'what is played');
        assertSame(dialog.open, false, 'the window stays');
        if (wasOpen) isOpen = false;
      }
    };
    let isOpen = false;
    const actions = {
      ran() {
        const run = new Run({ of: random.of(['virtual', 'real']), text: random.of(['F(1);\n B(1)', 'x'.repeat(90)]), robot: 'tinibot', program: 'p' }, { places: [], shows: [], variables: [] }, null);
        runs.addRun(run);
        for (let k = random.below(4); k > 0; k -= 1) run.addRow([1000 * k, 'BUTTON 1']);
        run.isJudged = random() < 0.2;
        if (random() < 0.2) run.fileText = `opened ${run.number}`;
        run.end_ms = random.of([null, 3000]);
        run.readClock = random.of([null, () => 4000]);
      },
      open() {
        press(page.byId('runs_open'));
        isOpen = true;
        kept = runs.newestFirst;
        notice = kept.length ? '' : text('runs_none');
      },
      close() {
        press(page.byId('runs_close'));
        isOpen = false;
      },
      see() {
        if (!isOpen || !kept.length) return;
        const index = random.below(kept.length);
        press(list.children[index].querySelectorAll('button')[0]);
        assertSame(reports.splice(0), [['show', kept[index].number]], 'the run that is seen');
        isOpen = false;
      },
      async save() {
        if (!isOpen || !kept.length) return;
        const index = random.below(kept.length), run = kept[index];
        const button = list.children[index].querySelectorAll('button')[1];
        if (button.disabled) return;
        const isBroken = random() < 0.3, error = new Error('broken');
        answer = () => {
          if (isBroken) throw error;
          return { file: `file of ${run.number}` };
        };
        press(button);
        await wait(50);
        if (run.fileText) assertSame([asked, saved], [[], [run.fileText]], 'what is saved of one that was opened');
        else {
          assertSame(asked, [['write_run', run.end_ms ?? run.readClock?.() ?? run.rows.at(-1)?.[0] ?? 0, run.origin.text, undefined]], 'what is asked for');
          assertSame(saved, isBroken ? [] : [`file of ${run.number}`], 'what is saved');
          if (isBroken) notice = bugSentence(error);
        }
      },
      choose: () => open((file) => chooseFile(page.byId('run_file'), file)),
      async drop() {
        await open((file) => {
          if (random() < 0.2) file.name = 'picture.png';
          const event = Object.assign(new Event('drop', { cancelable: true }), { dataTransfer: { files: [file], types: ['Files'] } });
          dispatchEvent(event);
          assertSame(event.defaultPrevented, true, 'the page is left for the file');
          if (file.name !== 'picture.png') return true;
          note = text('not_opened', { name: file.name, why: text('run_not') });
          return false;
        });
      },
      dropNothing() {
        const event = Object.assign(new Event('drop', { cancelable: true }), { dataTransfer: { files: [], types: ['text'] } });
        dispatchEvent(event);
        assertSame(event.defaultPrevented, false, 'a dropped text is taken');
      },
      async play() {
        const known = random.of([null, ...runs.newestFirst]);
        answer = () => ({ text: 'O', rows: [] });
        runsWindow.openData(new TextEncoder().encode('data'), 'n', known);
        await wait(50);
        assertSame(reports.splice(0), [['play', 'data', 'O', known?.number]], 'what is played');
        isOpen = false;
      },
    };
    const check = () => {
      assertSame(reports, [], 'what nobody asked for');
      assertSame(dialog.open, isOpen, 'whether the window is open');
      if (isOpen) {
        assertSame(said.textContent, notice, 'what is said');
        assertSame(list.children.map((row) => [saidOf(row.querySelectorAll('button')[0]), row.querySelectorAll('button')[1].disabled]), kept.map((run) => [titleOf(run), run.isJudged || !(run.fileText || run.rows.length)]), 'the list');
      }
      assertSame(pageState.note.value, note, 'the note');
      pageState.note.set('');
      note = '';
      [asked, saved] = [[], []];
    };
    return { acts: { ...actions, saveMore: actions.save, saveAgain: actions.save, openAgain: actions.open, ranMore: actions.ran }, check };
  },

  // What runs is marked in the text, which is scrolled to where the program halts: once for each halt.
  async editor(random) {
    replaceNavigator({});
    const page = freshPage(playedEditor);
    await loadTexts(page);
    const { Editor } = await page.load('writing/editor.js');
    const editor = new Editor(page.byId('editor'));
    let haltedLine = 0, scrolled = -1, marked = [];
    const rangeOf = (line) => ({ line, column: 1, end_line: line, end_column: 5 });
    const show = (lines, isHeld) => {
      view.sought = -1;
      editor.showRunning(lines.map(rangeOf), isHeld);
      const halted = isHeld ? lines[0] ?? 0 : 0;
      const isNew = halted && halted !== haltedLine;
      haltedLine = halted;
      marked = lines;
      scrolled = isNew ? view.state.doc.line(halted).from : -1;
    };
    const someLines = () => Array.from({ length: 1 + random.below(2) }, () => 1 + random.below(3));
    editor.replace('F(1)\nF(2)\nF(3)');
    const actions = {
      halt: () => show(someLines(), true),
      run: () => show(someLines(), false),
      end: () => show([], false),
      type() { // what runs is of another text then
        editor.replace(Array.from({ length: 3 }, () => `F(${random.below(9)})`).join('\n'));
        show([], random() < 0.5 && haltedLine > 0);
      },
      drawAnew: () => view.dispatch({ selection: { anchor: random.below(9) } }),
    };
    const check = () => {
      assertSame(view.sought, scrolled, 'what it is scrolled to');
      assertSame(Array.from(CSS.highlights.get('running'), ({ startContainer, startOffset }) => [startContainer === view.lines, view.state.doc.lineAt(startOffset).number]), marked.map((line) => [true, line]), 'what is marked');
    };
    return { acts: { ...actions, haltAgain: actions.halt }, check, pauses_ms: [0] };
  },

  // The keys of robots, from one file after another, while other tabs store some: no key is lost, whatever a file has, and
  // what is said is so.
  async keys(random) {
    const KEYS = 'tiniscript.link.keys';
    replaceNavigator({});
    const page = freshPage({
      replaceOptions() {}, makePictureOption() {}, makeSymbolPicture() {}, hasSerial: false, choosePort() {}, listKnownPorts: async () => [],
      HostRobot: class {}, hasHost: false, isPupil: false, isTeacher: false, post: async () => ({}), fetchPorts: async () => [],
    });
    await loadTexts(page);
    const { text } = await page.load('page/texts.js');
    const { loadText, storeText } = await page.load('page/kept.js');
    const { RobotPanel } = await page.load('robot/panel.js');
    const { RunningPlace } = await page.load('robot/place.js');
    const { Recorder } = await page.load('robot/recorder.js');
    const { Runs } = await page.load('virtual/runs.js');
    const listOf = (list) => list.split(',').filter(Boolean);
    const python = {
      async ask({ kept }, data) {
        const content = new TextDecoder().decode(data);
        await later(random.below(60));
        if (content === 'broken') throw new Error('broken');
        if (!content.startsWith('keys:')) return { count: null };
        const keys = listOf(content.slice('keys:'.length));
        return { count: keys.length, keys: [...new Set([...listOf(kept), ...keys])].join() };
      },
    };
    new RobotPanel({ python, goTo() {}, recorder: new Recorder({ runs: new Runs(), play() {} }), place: new RunningPlace(), pad: { releaseAll() {}, offerRobot() {} } });
    await wait(50);
    const wanted = new Set();
    let count = 0;
    const put = () => {
      const key = `k${(count += 1)}`;
      wanted.add(key);
      storeText(KEYS, [...listOf(loadText(KEYS)), key].join());
    };
    const actions = {
      async open() {
        const keys = Array.from({ length: random.below(3) }, () => `f${random.below(9)}`);
        const kind = random.of(['keys', 'keys', 'wrong', 'broken', 'gone']);
        chooseFile(page.byId('keys_file'), { name: random.of(['a.json', 'b.json']), slice: () => ({ arrayBuffer: async () => {
          if (kind === 'gone') throw new Error('gone');
          return new TextEncoder().encode(kind === 'keys' ? `keys:${keys}` : kind).buffer;
        } }) });
        await wait(random.below(80));
        if (random() < 0.4) put();
        await wait(500);
        if (kind === 'keys') for (const key of keys) wanted.add(key);
        assertSame(page.byId('link_said').textContent, kind === 'keys' && keys.length ? text('say_keys', { count: keys.length }) : text('say_no_keys'), `what is said of a file that is ${kind}`);
      },
      put,
    };
    return { acts: { ...actions, openAgain: actions.open }, check: () => assertSame(listOf(loadText(KEYS)).toSorted(), [...wanted].toSorted(), 'the keys'), pauses_ms: [0] };
  },

  // What several tabs of a browser keep: a tab that is loaded again has what it had, a new one what the last tab had, or what
  // can be read of both.
  async tabs(random) {
    freshPage();
    const { localStorage } = window;
    const PLACES = { work: 'tiniscript.work', newest: 'tiniscript.world', before: 'tiniscript.worlds_before' };
    const tabs = [];
    let lasting = { work: null, newest: '', before: [] }, count = 0;
    const load = async (tab) => {
      tab.modules = freshPage();
      tab.has = { ...tab.has };
      Object.assign(window, { localStorage, sessionStorage: tab.store ?? window.sessionStorage });
      tab.store = window.sessionStorage;
      tab.work = await tab.modules.load('programs/work.js');
      assertSame(tab.work.loadWork(), tab.has.work ?? lasting.work, 'the work');
      const { newest, before } = tab.work.loadWorldTexts();
      assertSame([newest, before.slice(0, (tab.has.before ?? lasting.before).length)], [tab.has.newest || lasting.newest, tab.has.before ?? lasting.before], 'the worlds');
    };
    const switchTo = (tab) => {
      window.sessionStorage = tab.store;
      return tab;
    };
    const open = async (has = {}, kept = []) => {
      const tab = { has };
      freshPage();
      tab.store = window.sessionStorage;
      for (const [key, value] of kept) tab.store.setItem(key, value);
      tabs.push(tab);
      await load(tab);
    };
    await open();
    const actions = {
      open: () => open(),
      copy() { // with what it keeps
        const { has, store } = random.of(tabs);
        return open(has, store);
      },
      reload: () => load(random.of(tabs)),
      work() {
        const tab = switchTo(random.of(tabs)), own = random.of([null, { text: 'own', robot: 'tinibot', name: 'o' }]), name = `n${(count += 1)}`;
        const work = { text: `F(${count})`, robot: random.of(['tinibot', 'liner']), lesson: own ? 'l' : '', own, world: 'obstacles', language: 'en', name, view: random.of(['blocks', 'text']), level: 'usual', words: random() < 0.5, sound: random() < 0.5 };
        localStorage.room = random() < 0.2 ? 0 : Infinity;
        assertSame(tab.work.storeWork(work), localStorage.room > 0, 'whether the next tab finds it');
        tab.has.work = work;
        if (localStorage.room) lasting.work = work;
        localStorage.room = Infinity;
      },
      draw() {
        const tab = switchTo(random.of(tabs)), { newest, before } = tab.work.loadWorldTexts();
        tab.has = { ...tab.has, newest: `w${(count += 1)}`, before: [newest, ...before].filter(Boolean).slice(0, 5) };
        assertSame(tab.work.storeWorldTexts(tab.has.newest, tab.has.before), true, 'whether the next tab finds them');
        Object.assign(lasting, { newest: tab.has.newest, before: tab.has.before });
      },
      damage() { // what a tab keeps, or what all have
        const place = random.of(['work', 'before']), tab = random.of([null, ...tabs]);
        (tab?.store ?? localStorage).setItem(PLACES[place], random.of(['{', '7', 'null']));
        if (tab) delete tab.has[place];
        else lasting[place] = place === 'work' ? null : [];
      },
    };
    return { acts: { ...actions, workMore: actions.work, reloadMore: actions.reload }, check() {}, pauses_ms: [0] };
  },

  // Where the camera looks that follows the robot: nearer to where a task leads, and always with the robot.
  async camera(random) {
    const matches = { matches: false };
    globalThis.matchMedia = () => matches;
    const { viewCenterOf } = await freshPage({}, HTML).load('virtual/arena.js');
    const isSeen = (place, middle, size) => Math.abs(place - middle) <= size / 2 + 1e-9;
    const actions = {
      look() {
        const size = 20 + random.below(200), robotLength = 1 + random.below(size / 3), robot = random.below(300), goal = random.below(300);
        const middle = viewCenterOf(robot, [goal], size, robotLength);
        assertSame(isSeen(robot, middle, size - 2 * robotLength), true, 'the robot is seen whole');
        if (Math.abs(goal - robot) <= size - 2 * robotLength) assertSame(isSeen(goal, middle, size), true, 'where its task leads is seen');
        assertSame(Math.abs(goal - middle) <= Math.abs(goal - robot), true, 'the goal is no farther from the middle than from the robot');
      },
      wander() {
        const robot = random.below(300);
        assertSame(viewCenterOf(robot, [], 100, 10), robot, 'without a task the robot is in the middle');
      },
    };
    return { acts: actions, check() {} };
  },

  // The words of devices and blocks: in the language of the page, and those of the text for who wants them.
  /** Which side of the robot has bumped into something, wherever it stands and looks. */
  async bumps(random) {
    replaceNavigator({});
    const page = freshPage();
    await loadTexts(page);
    const { bumpSentence } = await page.load('virtual/where.js');
    const pose = [0, 0, 0];
    const touchesAt = (degrees, distance) => {
      const angle = ((pose[2] + degrees) * Math.PI) / 180;
      return [pose[0] + distance * Math.cos(angle), pose[1] + distance * Math.sin(angle)];
    };
    const makeBumpCheck = (key, degrees) => () => assertSame(bumpSentence({ pose, touches: degrees === null ? null : touchesAt(degrees + random.below(81) - 40, 1 + random.below(12)) }), TEXTS[key], `the side at ${degrees}° of ${pose}`);
    const actions = {
      drive: () => pose.splice(0, 3, random.below(200), random.below(150), random.below(1080) - 540),
      front: makeBumpCheck('where_bump_front', 0), left: makeBumpCheck('where_bump_left', 90), back: makeBumpCheck('where_bump_back', 180), right: makeBumpCheck('where_bump_right', 270), free: makeBumpCheck('where_bump', null),
    };
    return { acts: actions, check: () => {} };
  },

  async words(random) {
    replaceNavigator({});
    const page = freshPage();
    await loadTexts(page);
    const { pageState } = await page.load('page/page_state.js');
    const { ROBOTS, KINDS, devicesOf, deviceName, blockLabel, wordsOnBlock, tipOf, wordsOf, isRobot } = await page.load('page/words.js');
    let language = 'en', isSourceText = true, areShown = false;
    const actions = {
      show: () => pageState.areWordsShown.set(areShown = random() < 0.5),
      async changeLanguage() {
        isSourceText = false;
        await changeLanguage(page, language = random.of(LANGUAGES));
      },
    };
    const textOf = (key) => (key in TEXTS ? TEXTS[key] + (isSourceText ? '' : ` ${language}`) : '');
    const check = () => {
      const robot = random.of(ROBOTS), role = random.of(['sensor', 'actuator']);
      assertSame(devicesOf(robot.name, role).map(({ text }) => text), robot.devices.filter((device) => device.role === role).map(({ text }) => text), `what ${robot.name} has of ${role}`);
      assertSame([devicesOf('nobody', role), wordsOf('nobody').size, isRobot('nobody'), isRobot(robot.name)], [[], 0, false, true], 'what nobody has');
      assertSame(robot.devices.every(({ text }) => wordsOf(robot.name).get(text)?.text === text), true, 'the words of its devices');
      for (const device of robot.devices) {
        const label = device.labels[language] ?? device.labels.en;
        assertSame(areShown ? deviceName(device).startsWith(device.text) : deviceName(device), areShown || label, 'the name of a device');
        if (areShown && !label.toUpperCase().startsWith(device.text)) assertSame(deviceName(device), `${device.text} ${label}`, 'the name of a device with its word');
      }
      const kind = random.of(Object.keys(KINDS).filter((name) => `block/${name}` in TEXTS)), sentence = textOf(`block/${kind}`);
      const [, word] = /\{(\S+)\}/.exec(sentence) ?? [];
      if (word) assertSame(areShown ? blockLabel(kind).includes(word) : blockLabel(kind), areShown || sentence.replace(`{${word}} `, ''), 'the label of a block');
      assertSame(wordsOnBlock(kind), [...sentence.matchAll(/\{(\S+?)\}/g)].map(([, item]) => item), 'its words');
      assertSame(tipOf(kind), textOf(`tip/${kind}`), 'what is said of it');
    };
    return { acts: actions, check };
  },

  // The fields of blocks: numbers that fit their place, tones, names, units; what is typed, chosen and taken back.
  async fields(random) {
    replaceNavigator({});
    const { blocklyInNode } = await import('./blockly_in_node.mjs');
    const { blockly } = blocklyInNode();
    const fired = [], drop = { content: [], close: () => {} };
    blockly.Events = { ...blockly.Events, fire: (event) => fired.push(event), BlockChange: class { constructor(...given) { Object.assign(this, { given: given.slice(1) }); } } };
    blockly.DropDownDiv = { clearContent: () => { drop.content = []; }, getContentDiv: () => ({ append: (part) => drop.content.push(part) }), setColour() {}, showPositionedByField: (_, close) => { drop.close = close; }, isVisible: () => false };
    const shared = Object.getPrototypeOf(blockly.FieldTextInput.prototype);
    let takeBack = () => {}, quiet = null;
    shared.onHtmlInputKeyDown_ = function key() { takeBack(this); };
    shared.showEditor_ = (_, isQuiet) => { quiet = isQuiet; };
    blockly.Field.prototype.getSize = () => null; // draws
    shared.widgetCreate_ = () => ({ inputMode: '' });
    const page = freshPage({ blockly });
    await loadTexts(page);
    const { text } = await page.load('page/texts.js');
    const { blockLabel } = await page.load('page/words.js');
    const { pageState } = await page.load('page/page_state.js');
    const { rangeOf } = await page.load('blocks/places.js');
    const { keyOfHertz, hertzOfKey, keyName, nextKeyFrom } = await page.load('blocks/tones.js');
    const { NumberField, NameField, LineField, UnitField, ArrowField, setTonePlayer, WAY_UNIT } = await page.load('blocks/fields.js');
    let played = [], isCoarse = false;
    setTonePlayer((hertz) => played.push(hertz));
    globalThis.matchMedia = () => ({ matches: isCoarse });
    const at = (type, index, word) => { // a number in a place of another block
      const block = { id: 'b', workspace: { id: 'w' } }, parent = { type, getFieldValue: () => word, getField: () => null };
      parent.inputList = [0, 1].map((k) => ({ name: `V${k}`, connection: { targetBlock: () => (k === index ? block : null) } }));
      parent.getInput = (name) => parent.inputList.find((item) => item.name === name);
      block.getParent = () => parent;
      return block;
    };
    const in_ = (field, block) => Object.assign(field, { getSourceBlock: () => block, name: 'N', forceRerender() {} });
    const number = in_(new NumberField(1), at('move', 0, 'F')), pitch = in_(new NumberField(440), at('beep', 1, 'BEEP'));
    for (const item of [number, pitch]) item.setEditorValue_ = (value) => item.setValue(value);
    const fields = [number, pitch, in_(new NameField('A'), at('move', 0, 'F')), in_(new LineField('x'), at('move', 0, 'F'))];
    const units = { F: 'CM', R: 'DEGREES' };
    let word = 'F';
    const unit = in_(new UnitField(units), { getFieldValue: () => word });
    const arrow = in_(new ArrowField(), { getFieldValue: () => word });
    arrow.arrowPath = document.createElement('path');
    const paths = new Map();
    let hertz = 440;
    const assertTone = (value) => {
      assertSame([pitch.getValue(), played, fired.splice(0).length], [value, [value], 0], 'the tone that is chosen');
      if (pitch.piano) assertSame(pitch.piano.element.querySelectorAll('[aria-pressed=true]').map(({ title }) => title), [`${keyName(keyOfHertz(value), text('notes').split(' '))}, ${value} Hz`], 'the key that is pressed');
      played = [];
      hertz = value;
    };
    const actions = {
      type() {
        const value = random.of([random() * 10 ** random.below(12) * random.of([1, -1]), 0, 1e-7, 3.5]), place = random.of([['move', 'F'], ['compare', '']]), { low, high } = rangeOf(...place, 0);
        in_(number, at(place[0], 0, place[1]));
        number.isBeingEdited_ = random() < 0.5;
        number.setValue(value);
        const rounded = Math.round(value * 1000) / 1000;
        const wanted = number.isBeingEdited_ ? Math.min(high, Math.max(low, rounded)) : rounded;
        assertSame(Math.abs(number.getValue() - wanted) <= Math.abs(wanted) * 1e-9, true, `${value} is ${number.getValue()}, and not ${wanted}`);
        number.isBeingEdited_ = false;
        assertSame([/^-?\d+(\.\d*[1-9])?$/.test(number.textValue()), Math.abs(Number(number.textValue()) - number.getValue()) < 0.001], [true, true], `its text ${number.textValue()}`);
        assertSame(number.widgetCreate_().inputMode, low < 0 ? '' : 'decimal', 'the keys of a phone');
      },
      typeWords() {
        const before = number.getValue(), typed = random.of(['sin fin', 'X', '1.2.3']);
        Object.assign(number, { isBeingEdited_: true, valueWhenEditorWasOpened_: before });
        number.setValue(` ${typed} `);
        number.isBeingEdited_ = false;
        number.onFinishEditing_(before);
        assertSame([number.getValue(), pageState.note.value], [before, text('no_number', { typed })], 'what is said of a word in place of a number');
        pageState.note.set('');
      },
      takeBack() {
        const field = random.of(fields), before = field.getValue(), changesIt = random() < 0.6;
        takeBack = (item) => changesIt && item.setValue(field instanceof NumberField ? before + 1 : `${before}B`);
        field.onHtmlInputKeyDown_({ key: 'Escape' });
        assertSame(fired.splice(0).map(({ given }) => given), field.getValue() === before ? [] : [['field', 'N', before, field.getValue()]], 'what others hear of it');
        if (field === pitch) hertz = field.getValue();
      },
      open() {
        isCoarse = random() < 0.5;
        const isQuiet = random() < 0.3;
        pitch.showEditor_(null, isQuiet);
        assertSame([drop.content.length, drop.content[0] === pitch.piano.element, quiet], [1, true, isQuiet || isCoarse], 'the piano');
        assertSame(pitch.piano.element.querySelectorAll('[aria-pressed=true]').length, hertzOfKey(keyOfHertz(hertz)) === hertz ? 1 : 0, 'the key that is pressed');
        number.showEditor_(null, isQuiet);
        assertSame([drop.content.length, quiet, number.piano ?? null], [1, isQuiet, null], 'a number has a piano');
      },
      close() {
        drop.close();
        assertSame(pitch.piano ?? null, null, 'a piano that is closed');
      },
      playKey() {
        const keys = pitch.piano?.element.querySelectorAll('button').filter(({ title }) => title) ?? [];
        if (!keys.length) return;
        const key = random.of(keys), wanted = Number(/(\d+) Hz/.exec(key.title)[1]);
        press(key);
        assertTone(wanted);
      },
      step() {
        const key = random.of(['ArrowUp', 'ArrowDown']);
        const event = Object.assign(new Event('keydown', { cancelable: true }), { key, stopPropagation: () => { event.isStopped = true; } });
        pitch.onHtmlInputKeyDown_(event);
        assertSame([event.defaultPrevented, event.isStopped], [true, true], 'what else the key does');
        assertTone(hertzOfKey(nextKeyFrom(hertz, key === 'ArrowUp' ? 1 : -1)));
        takeBack = () => {};
        const other = Object.assign(new Event('keydown', { cancelable: true }), { key });
        number.onHtmlInputKeyDown_(other);
        assertSame([other.defaultPrevented, played], [false, []], 'a number is no tone');
      },
      look() { // what is being typed is seen as it is, and what hangs elsewhere may be no tone any more
        Object.assign(pitch, { isBeingEdited_: true, htmlInput_: { value: '12' } });
        assertSame(pitch.getText_(), '12', 'what is typed');
        Object.assign(pitch, { isBeingEdited_: false, htmlInput_: null });
        Object.assign(pitch, { isDirty_: false, textContent_: { nodeValue: random() < 0.5 ? pitch.getDisplayText_() : 'before' } });
        pitch.getSize();
        assertSame(pitch.isDirty_, pitch.textContent_.nodeValue === 'before', 'whether it is drawn anew');
        pitch.textContent_ = null;
      },
      tune() {
        hertz = random.of([440, 441, 100, 262, 30000]);
        pitch.setValue(hertz);
      },
      name() {
        const name = fields[2], before = name.getValue(), given = random.of(['año', 'Straße 2', '  zählen x', '1a', '', '¿?', 'a\u0301', 'x-y z', 'Ñ_ñ']);
        name.setValue(given);
        const plain = [...given.normalize('NFC')].map((letter) => (/ñ/i.test(letter) ? 'NI' : letter.normalize('NFD')[0] ?? '')).join('').toUpperCase().trim();
        const wanted = plain.replace(/[^A-Z0-9_]+/g, '_').replace(/^[^A-Z]+/, '');
        assertSame(name.getValue(), wanted || before, `the name ${given}`);
      },
      lines() {
        const given = random.of(['a\nb', 'a\r\nb', 'a\0b', 'plain']);
        fields[3].setValue(given);
        assertSame(fields[3].getValue(), given === 'plain' ? given : 'a b', 'a line');
      },
      words: () => { word = random.of(['F', 'R', 'S']); },
      measure: () => unit.setValue(random.of(['seconds', WAY_UNIT])),
    };
    const check = () => {
      const wanted = unit.getValue() === WAY_UNIT ? units[word] ?? '' : '';
      assertSame([unit.textValue(), unit.getText_()], [wanted, blockLabel(wanted || 'seconds')], 'the unit');
      arrow.render_();
      const path = arrow.arrowPath.getAttribute('d');
      if (!paths.has(word)) paths.set(word, path);
      assertSame([path, new Set(paths.values()).size], [paths.get(word), paths.size], 'the arrow');
      assertSame(pitch.getText_() ?? String(pitch.getValue()), hertzOfKey(keyOfHertz(hertz)) === hertz ? `${keyName(keyOfHertz(hertz), text('notes').split(' '))} ${hertz}` : String(hertz), 'what is seen of a tone');
      assertSame([number.isPitch, number.getText_(), fired, played], [false, null, [], []], 'what nobody asked for');
    };
    return { acts: actions, check, pauses_ms: [0] };
  },

  // Which world it is: shipped, own, one of before, or a lesson's; and those that are kept come back.
  async world(random) {
    replaceNavigator({});
    const makePage = () => freshPage({ makePictureOption: (label, value) => Object.assign(document.createElement('option'), { textContent: label, value }), makeWorldPicture() {}, makeBlocksPicture() {}, makeDialPicture() {}, makeSymbolPicture() {}, replaceOptions() {} });
    let page = makePage();
    let changed = 0;
    const python = {
      ready: Promise.resolve(),
      async ask({ do: what, form, name }, data) {
        await later(random.below(30));
        if (what === 'write_world') return { text: JSON.stringify(form) };
        const text = new TextDecoder().decode(data);
        try {
          return { world: { ...JSON.parse(text), name } };
        } catch {
          return {};
        }
      },
    };
    const OWN = ':own';
    let work = { world: random.of(['free', OWN, 'nobody knows it']) }, choice, pageState, words_, text, progress;
    const open = async (isWhole = true) => {
      await loadTexts(page);
      ({ pageState } = await page.load('page/page_state.js'));
      words_ = await page.load('page/words.js');
      ({ text } = await page.load('page/texts.js'));
      progress = await page.load('lesson/progress.js');
      const { WorldChoice } = await page.load('world/choice.js');
      choice = new WorldChoice(python, work, () => { changed += 1; });
      assertSame(await choice.restoreOwn(), isWhole, 'whether all can be read');
    };
    const opening = open();
    await wait(500);
    await opening;
    let newest = null, before = [], brought = null, isKept = true, isDamaged = false, count = 0;
    const select = () => page.byId('world');
    const makeWorld = () => ({ ...structuredClone(words_.WORLDS[0]), name: random.of(['', 'mine']), labels: {}, ambient_percent: count += 1 });
    const isOwn = () => !brought && newest !== null && work.world === OWN;
    const choose = (name) => {
      work.world = name;
      brought = null;
    };
    const actions = {
      choose() {
        const options = select().children.filter((item) => item.localName === 'option' || item.value);
        const { value } = random.of(options);
        changed = 0;
        change(select(), { value });
        assertSame(changed, 1, 'who shows it hears of it');
        if (value === ':brought') return;
        const index = /^:before(\d)$/.exec(value)?.[1];
        if (index === undefined) return choose(value);
        const [world] = before.splice(Number(index), 1);
        if (newest) before = [newest, ...before].slice(0, 5);
        newest = world;
        isKept = true;
        isDamaged = false;
        choose(OWN);
      },
      bring() {
        const request = random.of([{ lesson: 'one' }, { form: 1 }, 'free', null]);
        brought = { request, shapes: makeWorld(), label: () => `of ${pageState.language.value}`, goals: [count] };
        choice.bringWorld(brought);
      },
      put() {
        const world = makeWorld(), isOther = random() < 0.5;
        if ((isOther || !isOwn()) && newest) before = [newest, ...before].slice(0, 5);
        newest = world;
        choice.putOwn(world, isOther);
        isKept = false;
        choose(OWN);
      },
      keep() {
        choice.storeOwn();
        isKept = true;
        if (newest) isDamaged = false; // else what is damaged stays
      },
      async write() {
        if (!newest) return;
        const written = choice.write(newest);
        await wait(50);
        assertSame((await written).text, JSON.stringify(newest), 'what is written');
      },
      async reload() {
        if (!isKept) return;
        await wait(200);
        const stores = ['localStorage', 'sessionStorage'].map((name) => [name, [...window[name]]]);
        page = makePage();
        for (const [name, all] of stores) for (const [key, value] of all) window[name].setItem(key, value);
        work = { ...work };
        brought = null;
        if (newest && random() < 0.2) {
          isDamaged = true;
          for (const name of ['localStorage', 'sessionStorage']) window[name].setItem('tiniscript.world', 'damaged');
          newest = null;
        }
        const again = open(!isDamaged);
        await wait(500);
        await again;
      },
      changeLanguage: () => changeLanguage(page, random.of(LANGUAGES)),
      stars() {
        progress.storeStars(progress.starsKeyOfWorld(random.of(words_.WORLDS).name), 1 + random.below(3));
        choice.showStars();
      },
    };
    const check = () => {
      const shipped = words_.WORLDS.find(({ name }) => name === work.world) ?? words_.WORLDS[0];
      const shown = isOwn() ? newest : brought?.shapes ?? shipped;
      assertSame(choice.shownWorld, shown, 'the world');
      assertSame([choice.isOwn, choice.isOfLesson, choice.goals], [isOwn(), Boolean(brought?.request?.lesson), brought?.goals ?? []], 'whose it is');
      assertSame(choice.request, isOwn() ? { form: newest } : brought?.request ?? shown.name, 'what the worker is asked for');
      const label = ({ labels }) => (labels[pageState.language.value] ?? labels.en ?? '').trim() || text('world_own');
      const stars = progress.loadStars();
      assertSame(select().children.map(({ value, textContent }) => [value, textContent]).filter(([value]) => value && value !== ':brought'), [
        ...words_.WORLDS.map((world) => [world.name, `${world.labels[pageState.language.value] ?? world.labels.en} ${'★'.repeat(stars.get(`world_${world.name}`) ?? 0)}`.trim()]),
        ...newest ? [[OWN, label(newest)]] : [],
        ...before.map((world, k) => [`:before${k}`, text(k ? 'world_before_more' : 'world_before', { world: label(world), number: k + 1 })]),
      ], 'the worlds');
      assertSame(select().children.length, words_.WORLDS.length + (newest ? 1 : 0) + before.length + (brought ? 1 : 0), 'how many there are');
      assertSame(select().value, brought ? ':brought' : isOwn() ? OWN : shipped.name, 'the one that is chosen');
    };
    return { acts: actions, check };
  },
};

for (const [part, begin] of Object.entries(PARTS)) {
  if (words[2] && words[2] !== part) continue;
  const done = new Set();
  for (let seed = first; seed < first + seeds; seed += 1) {
    const random = chanceOf(seed + 1), acted = [];
    try {
      const { acts: actions, check, pauses_ms = [0, 0, 20, 300] } = await begin(random);
      for (let k = 0; k < 60; k += 1) {
        const act = random.of(Object.keys(actions));
        acted.push(act);
        done.add(act);
        await actions[act]();
        await settle();
        check();
        await wait(random.of(pauses_ms));
      }
      if (unhandled.length) throw new Failure(`unhandled ${unhandled}`);
    } catch (error) {
      console.error(`Error: ${part}, seed ${seed}, after ${acted.slice(-10).join(', ')}:`, error);
      process.exit(1);
    }
  }
  console.log(JSON.stringify([part, ...done]));
}
process.exit(0);
