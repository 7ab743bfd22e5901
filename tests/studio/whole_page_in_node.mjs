// node whole_page_in_node.mjs SOURCES MADE FIRST COUNT: somebody presses whatever the page has, begins anew, and presses more; in a
// tab that is loaded again at that moment somebody presses the same. Prints a JSON row for each seed: what was pressed first,
// and what is seen afterwards, in the one tab and in the other.

import { readFileSync } from 'node:fs';
import { codemirror, forEachDiagnostic, playedEditor, view } from './editor_in_node.mjs';
import { chanceOf, compared, freshPage, later, made, PROGRAM, replaceFetch, replaceNavigator, settle, sources, virtualRobot, wait, words } from './page_in_node.mjs';

const [firstSeed, seedCount] = words.map(Number);
const HTML = readFileSync(`${sources}/index.html`, 'utf-8');
const unhandled = [];
process.on('unhandledRejection', (error) => unhandled.push(String(error?.stack ?? error)));
process.on('uncaughtException', (error) => unhandled.push(String(error.stack)));
Date.now = () => 0;
globalThis.innerWidth = 1366;

// -- Python

const START = { x_cm: 30, y_cm: 30, heading: 0 };
const world = (name) => ({ name, labels: { en: name }, width_cm: 200, height_cm: 100, has_border: true, ambient_percent: 50, seconds: 0, start: START, walls: [], boxes: [], lines: [], lamps: [], flags: [], rings: [], rivals: [] });
const LESSONS = [1, 2].map((k) => ({ name: `lesson${k}`, title: `L${k}`, block_title: `L${k}`, robot: ['tinibot', 'liner'][k - 1], worlds: 2, world: world(`lesson ${k}`) }));
const linesOf = (text) => text.split('\n').map((line) => line.trim()).filter(Boolean);
const textOf = ({ body }) => body.map((item) => `${item.text}\n`).join('');
const formOf = (text) => ({ body: linesOf(text).map((line) => ({ text: line, kind: 'word', bodies: [] })), loose: [], size: 1 });

/** What Python says of a program: a line with a `?` is a mistake, and so is a LIFT of another robot than a tinibot. */
function checked(text, robot) {
  const findings = text.split('\n').flatMap((line, k) => (line.includes('?') || (line.startsWith('LIFT') && robot !== 'tinibot') ? [{
    code: 'C', severity: 'mistake', line: k + 1, column: 1, end_line: k + 1, end_column: line.length + 1, message: `in ${line}`, fix: '', may_repair: line.includes('?'),
    on_blocks: { message: 'm', fix: '', spoken: {} },
  }] : []));
  const places = findings.length ? [] : linesOf(text).map((_, k) => [k, k + 1, 1, k + 1, 4]);
  const image = findings.length || !text.trim() ? '' : Buffer.from(text).toString('hex');
  return { ...PROGRAM, robot, findings, image, program: image, bytes: text.length, places, halts: [], shows: [], start: 'SI', names_robot: text.includes('// robot'), loose: 0, remote: text.includes('KEY_A') ? ['KEY_A'] : [] };
}

class Python {
  runs = 0;
  late = () => 5;
  verdict = () => 'passed';
  #robot = null;

  answer(request, text) {
    switch (request.do) {
      case 'check': return checked(text, request.robot);
      case 'repair': return { changes: [{ line: 1 + text.split('\n').findIndex((line) => line.includes('?')), column: 1, end_line: 1 + text.split('\n').findIndex((line) => line.includes('?')), end_column: 99, text: 'W(1)' }] };
      case 'blocks': return { ...formOf(text), robot: request.robot };
      case 'text': return { text: textOf(request.form), places: [] };
      case 'line': return { text: `SI|${text}` };
      case 'rename': case 'open': return { text };
      case 'learn': return {};
      case 'lesson_titles': return { lessons: LESSONS };
      case 'lesson_steps': {
        const steps = [{ blocks: [{ kind: 'program', rows: [['F(1)']] }], hint: '' }, { blocks: [], hint: 'a hint' }];
        return { steps, block_steps: steps, offered: [], needed: [], new: [], spoken: {} };
      }
      case 'lesson_world': return { world: world(`lesson ${request.number}`), goals: [] };
      case 'lesson_check': return {};
      case 'lesson_go': {
        const verdict = this.verdict();
        return { verdict, seed: 1, worlds: 2, said: ['said'], block_said: ['said'], spoken: {}, run: verdict === 'failed' ? { seed: 1, until_ms: 900 } : null };
      }
      case 'write_world': return { text: JSON.stringify(request.form), is_blocked: false };
      case 'open_world': return { world: JSON.parse(text) };
      case 'write_run': return { file: JSON.stringify(request) };
      case 'open_run': return { end_ms: 900, shapes: null, is_by_button: false, ...JSON.parse(text) };
      default:
        if (request.do === 'power_on') {
          this.runs += 1;
          this.#robot = virtualRobot(chanceOf(this.runs), true);
        }
        return { driver: null, touches: null, rivals: [], rows: [], ...this.#robot.answer(request) };
    }
  }
}

// -- the page

const TEXTS = readFileSync(`${made}/texts.json`, 'utf-8');

/** A tab in which this is kept. */
async function openTab(stores) {
  const python = new Python();
  const seen = { arena: null, blocks: null };
  class Arena {
    camera = '';
    ways = 0; // that are on the floor
    #world = '';
    constructor() { seen.arena = this; }
    begin(of, robot, goals) { this.#world = [of.name, of.start, of.walls.length, robot, goals]; }
    followState() { this.ways += 1; }
    eraseTracks() { this.ways = 0; }
    get seen() { return [this.camera, this.ways, this.#world]; }
    draw() {} resize() {} shake() {} cheer() {} showBubble() {} showBeep() {} setMark() {}
    floorAt({ clientX, clientY }) { return { place: [clientX, clientY], reach_cm: 40 }; }
  }
  class Blocks {
    form = { body: [], loose: [] };
    layoutText = 'L0';
    isDragging = false;
    beginCount = 0; // of other programs
    has = {};
    constructor(_, __, level, page) {
      this.page = page;
      this.has.level = level;
      if (page) seen.blocks = this; // else they are drawn for a lesson
    }
    readForm() { return { form: structuredClone(this.form), ids: [] }; }
    show(form) {
      this.form = structuredClone(form);
      this.has = { robot: form.robot, level: this.has.level };
    }
    showFindings(findings) { this.has.findings = findings.map(({ line }) => line); }
    showBreakpoints(points) { this.has.points = points.map(({ line }) => line); }
    showRunning(ranges) { this.has.running = ranges.map(({ line }) => line); }
    showFault(range, sentence) { this.has.fault = sentence; }
    setLevel(level) { this.has.level = level; }
    beginProgram() { this.beginCount += 1; }
    levelOf() { return 'few'; }
    setRobot() {} setTaughtBlocks() {} setGivenBlocks() {} updateLanguage() {} resize() {} setRanges() {} showMates() {} goTo() {}
    async makePicture() { return null; }
  }
  const still = (name) => function made() { return new Proxy(this, { get: (_, property) => (property === 'then' ? undefined : () => name) }); };
  replaceNavigator({ language: 'en-US' });
  replaceFetch(async () => {
    await later(5);
    return new Response(TEXTS);
  });
  globalThis.Worker = class extends EventTarget {
    #last = Promise.resolve();
    constructor() {
      super();
      this.#say({ begun: true }, 1);
      this.#say({ id: 0 }, 20);
    }
    #say(data, ms) { setTimeout(() => this.dispatchEvent(Object.assign(new Event('message'), { data })), ms); }
    postMessage({ id, request, data }) {
      const asked = JSON.parse(request), text = new TextDecoder().decode(data);
      this.#last = this.#last.then(() => later(python.late())).then(() => {
        this.#say({ id, answer: JSON.stringify(python.answer(asked, text)) }, 0);
      });
    }
    terminate() {}
  };
  const page = freshPage({
    Arena, Blocks, Plot: still(''), RunAnnouncer: still(''), Sounds: still(''), starsText: String, boutEndText: () => '', bumpSentence: () => '', ...playedEditor,
    generate: () => ({ toCanvas() {} }), correction: {},
  }, HTML);
  for (const [name, kept] of Object.entries(stores)) for (const [key, value] of kept) window[name].setItem(key, value);
  const phone = Object.assign(new EventTarget(), { matches: false });
  globalThis.matchMedia = (query) => (query.includes('max-width: 700px') ? phone : Object.assign(new EventTarget(), { matches: false }));
  globalThis.confirm = () => true;
  let isComing = true;
  const loading = page.load('main.js').finally(() => { isComing = false; });
  while (isComing) {
    await settle();
    await wait(5);
  }
  await loading;
  await wait(500);
  const { pageState } = await page.load('page/page_state.js');
  const { virtualRun } = pageState;
  virtualRun.subscribe(({ isHeld }) => { if (!isHeld) view.sought = -1; }); // somebody scrolls away
  const { summaryOf } = await page.load('writing/messages.js');
  const versions = await page.load('programs/versions.js');
  const { isShippedProgram } = await page.load('start/beginnings.js');
  const { countAllStars } = await page.load('lesson/progress.js');
  return { page, pageState, summaryOf, versions, isShippedProgram, countAllStars, python, seen, phone };
}

// -- what somebody does

const LINES = ['F(1)', 'B(1)', 'R(1)', 'KEY_A', 'LIFT(1)', 'W(?)', 'BEEP(1)', '// robot'];
const byId = (id) => document.getElementById(id);
const press = (part, detail = 1) => part?.dispatchEvent(Object.assign(new Event('click', { bubbles: true, cancelable: true }), { detail, pointerType: 'mouse' }));
const choose = (id, value) => {
  byId(id).value = value;
  byId(id).dispatchEvent(new Event('change', { bubbles: true }));
};
const isSeen = (part) => part.checkVisibility() && !part.disabled && isOpen(part);
const BEHIND_START = ['main', '#home', '#robot_choice', '#bar_new', '#save', '#my_programs', '#other', '#run']; // as in style.css
/** Not of another screen, side, view or window. */
function isOpen(part) {
  const { screen, view } = { ...document.documentElement.dataset, view: byId('writing').dataset.view };
  const window_ = document.querySelectorAll('dialog').find(({ open }) => open);
  if (window_ && !part.closest(`#${window_.id}`)) return false;
  const behind = [...screen === 'start' ? BEHIND_START : ['#start'], ...'phone' in document.documentElement.dataset ? [] : ['#bar'], ...view === 'text' ? ['#blocks', '#blocks_note'] : ['#editor'], ...window_ ? [] : ['dialog'], 'details'];
  return !behind.some((item) => {
    const place = part.closest(item);
    return place && !(item === 'details' && place.open);
  });
}
const WORLDS = ['obstacles', 'free', 'line'];
const NOT_PRESSED = ['open', 'run_open', 'world_open', 'keys_import', 'flash_open', 'link_serial', 'link_bluetooth', 'save', 'save_trace', 'world_save', 'camera', 'share_picture', 'copy', 'public'];
const KEPT = ['runs_open', 'undo', 'redo']; // bring back what a tab has kept of before

/** Each is done, unless it cannot be: then it says so. */
const ACTS = {
  press(random, { isAnew }) {
    const buttons = document.querySelectorAll('button').filter((item) => isSeen(item) && !NOT_PRESSED.includes(item.id) && !(isAnew && KEPT.includes(item.id)));
    const button = random.of(buttons);
    press(button, random() < 0.2 ? 0 : 1);
    return button?.id || button?.textContent;
  },
  drive(random) {
    const buttons = ['run', 'run', 'step', 'pause', 'stop', 'lesson_next', 'lesson_check'].map(byId).filter(isSeen);
    if (!buttons.length) return false;
    const button = random.of(buttons);
    press(button);
    return button.id;
  },
  type(random) {
    if (document.documentElement.dataset.screen === 'start') return false;
    const text = Array.from({ length: random.below(4) }, () => `${random.of(LINES)}\n`).join('');
    view.dispatch({ changes: { from: random() < 0.5 ? 0 : view.state.doc.length, to: view.state.doc.length, insert: text } });
  },
  build(random, { seen }) {
    const { blocks } = seen;
    if (!blocks || byId('writing').dataset.view !== 'blocks' || document.documentElement.dataset.screen === 'start') return false;
    blocks.form.body.push(...formOf(random.of(LINES)).body);
    blocks.page.onChange();
  },
  learn(random) {
    const ways = [...document.querySelectorAll('button').filter(({ textContent }) => textContent === 'Add it to the program'), byId('start_lessons'), byId('side_lessons'), byId('lesson')].filter(isSeen);
    if (!ways.length) return false;
    const way = random.of(ways);
    if (way.id !== 'lesson') press(way);
    else choose('lesson', random.of(['1', '2']));
    return way.id || way.textContent;
  },
  robot(random) {
    if (!isSeen(byId('robot'))) return false;
    choose('robot', random.of(['tinibot', 'liner']));
    return 'robot';
  },
  retype(random, tab) { // while a program that names its robot gets another one
    if (!ACTS.robot(random)) return false;
    return ACTS.type(random, tab) === false ? 'robot' : 'type';
  },
  world: (random) => isSeen(byId('world')) && choose('world', random.of(WORLDS)),
  speed: (random) => isSeen(byId('speed')) && choose('speed', random.of(['0.1', '1', '4'])),
  level: (random) => isSeen(byId('level')) && choose('level', random.of(['few', 'usual', 'all'])),
  lesson: (random) => isSeen(byId('lesson')) && choose('lesson', random.of(['1', '2'])),
  points(random, { pageState }) {
    if (byId('writing').dataset.view !== 'text' || !view.state.doc.length) return false;
    const linesNow = () => pageState.breakpoints.value.map(({ line }) => line);
    const line = view.state.doc.lineAt(view.state.selection.main.head), before = linesNow();
    view.state.facet(codemirror.keymap).flat().find(({ key }) => key === 'F9').run(view);
    if (pageState.checkResult.value?.places.length) return; // those of the compiler are taken
    const wanted = !/^\s*[^\s/]/.test(line.text) ? before : before.includes(line.number) ? before.filter((item) => item !== line.number) : [...before, line.number];
    if (`${wanted.toSorted()}` !== `${linesNow().toSorted()}`) throw new Error(`in ${line.text}, which is not compiled, breakpoints are at ${linesNow()}, and not at ${wanted}`);
  },
  key(random, { isAnew }) {
    const keys = [{ key: 'Escape' }, { key: 'f' }, ...isAnew ? [] : [{ key: 'z', ctrlKey: true }, { key: 'Z', ctrlKey: true, shiftKey: true }]];
    byId('editor').dispatchEvent(Object.assign(new Event('keydown', { bubbles: true, cancelable: true }), random.of(keys)));
  },
  look(random) {
    if (!isSeen(byId('time_at'))) return false;
    byId('time_at').value = String(random.below(2000));
    byId('time_at').dispatchEvent(new Event('input', { bubbles: true }));
  },
  phone(random, { phone }) {
    phone.matches = !phone.matches;
    phone.dispatchEvent(new Event('change'));
  },
  back() {
    if (document.documentElement.dataset.screen === 'start') return false;
    location.hash = '';
    dispatchEvent(new Event('popstate'));
  },
  language: (random) => isSeen(byId('language')) && choose('language', random.of(['en', 'es'])),
  draw(random) {
    if (!isSeen(byId('arena'))) return false;
    const point = (kind) => byId('arena').dispatchEvent(Object.assign(new Event(kind, { bubbles: true, cancelable: true }), { isPrimary: true, button: 0, pointerId: 1, clientX: random.below(200), clientY: random.below(100) }));
    for (const kind of ['pointerdown', 'pointermove', 'pointermove', random.of(['pointerup', 'pointerup', 'pointercancel', 'pointermove'])]) point(kind);
  },
  rename(random) {
    if (!isSeen(byId('program_name'))) return false;
    byId('program_name').value = random.of(['', 'one', 'two']);
    byId('program_name').dispatchEvent(new Event('input', { bubbles: true }));
  },
  share() {
    if (!isSeen(byId('share'))) return false;
    byId('share').open = !byId('share').open;
    byId('share').dispatchEvent(new Event('toggle'));
  },
  hide() {
    document.hidden = true;
    document.dispatchEvent(new Event('visibilitychange'));
    document.hidden = false;
  },
  write(random) { // whoever presses in the text or the blocks
    for (const kind of ['pointerenter', 'pointerdown', 'focusin', 'pointerup']) byId('writing').dispatchEvent(Object.assign(new Event(kind, { bubbles: true }), { pointerType: random.of(['mouse', 'touch']), buttons: 0 }));
  },
  wait: () => {},
};

/** What somebody presses who wants to begin anew: `begin_anew` of `tests/support/studio.py`, and the first step of a lesson. */
async function beginAnew(tab) {
  const { phone } = tab;
  if (phone.matches) ACTS.phone(null, { phone });
  for (const item of document.querySelectorAll('dialog')) item.close();
  press(byId('view_text'), 0);
  press(byId('start_lessons'), 0);
  await wait(1000);
  for (const number of ['1', '2', '1']) {
    choose('lesson', number);
    await wait(1000);
  }
  for (const id of ['stop', 'home', 'start_write', 'view_text', 'seen_arena', 'bar_new']) press(byId(id), 0);
  for (const id of ['words', 'why']) if (byId(id).getAttribute('aria-pressed') === 'true') press(byId(id), 0);
  for (const [id, value] of [['language', 'en'], ['robot', 'tinibot'], ['world', 'obstacles'], ['speed', '1']]) if (byId(id).value !== value) choose(id, value);
  await wait(5000);
  Object.assign(tab, { isAnew: true, typedText: null, isComing: false });
}

/** Where the text editor marks what runs, by their lines. */
function runningLines() {
  return Array.from(CSS.highlights.get('running'), ({ startContainer, startOffset }) => {
    if (startContainer !== view.lines) throw new Error('a mark is of lines that have been drawn anew');
    return view.state.doc.lineAt(startOffset).number;
  });
}

function diagnosticLines() {
  const lines = [];
  forEachDiagnostic(view.state, (_, from) => lines.push(view.state.doc.lineAt(from).number));
  return lines;
}

const saidOf = (part) => (typeof part === 'string' ? part : [part.textContent, part.children.map(saidOf)].flat(9).join(''));

const keptWork = () => JSON.parse(window.sessionStorage.getItem('tiniscript.work'));

/** What changes neither the program nor how large the robot is seen; and what may change the program a while later. */
const PASSIVE = ['type', 'robot', 'language', 'speed', 'look', 'hide', 'wait', 'points', 'pause', 'stop', 'words', 'theme', 'sound', 'erase_ways', 'seen_arena', 'seen_plot', 'seen_trace', 'other', 'rename', 'share'];
const LATER = ['', 'build', 'undo', 'redo', 'start_lessons', 'side_lessons', 'lesson', 'lesson_next', 'home', 'back', 'Add it to the program'];

/** What an act changes, and what it does not. @returns what is checked once it is done, and later on */
function makeCheck(tab) {
  const { dataset } = document.documentElement;
  const before = { screen: dataset.screen, robot: keptWork().robot, full: 'full' in dataset, side: dataset.side, isLesson: keptWork().lesson !== '', text: view.state.doc.toString(), beginCount: tab.seen.blocks?.beginCount };
  return (did) => {
    const text = view.state.doc.toString();
    if (PASSIVE.includes(did) && before.full !== 'full' in dataset) throw new Error(`after ${did} the robot is small`);
    if (/^side_/.test(did) && dataset.side !== before.side && 'full' in dataset) throw new Error(`${did} is behind the robot`);
    if (['home', 'back'].includes(did) && !before.isLesson && text !== before.text) throw new Error(`after ${did} the program is another one`);
    if (['new', 'bar_new'].includes(did) && (text || keptWork().lesson || keptWork().own)) throw new Error(`${did} is of ${keptWork().lesson}`);
    if (['new', 'bar_new'].includes(did) && before.beginCount !== undefined && tab.seen.blocks.beginCount === before.beginCount) throw new Error(`after ${did} the blocks stand as those of before`);
    if (did === 'start_write' && dataset.half !== 'program') throw new Error('the program is not seen');
    if (['start_lessons', 'start_robot'].includes(did) && dataset.half !== 'robot') throw new Error('what was chosen is not seen');
    if (did === 'Add it to the program' && keptWork().lesson !== LESSONS[byId('lesson_page').dataset.lesson - 1].name) throw new Error(`a lesson's program is of ${keptWork().lesson || 'nobody'}`);
    const wasLeft = before.screen === 'program' && dataset.screen === 'start' && before.text.trim() !== '' && !tab.isShippedProgram(before.text);
    if (wasLeft && !tab.versions.loadVersions().some(tab.versions.isSameProgramAs(before))) throw new Error(`${before.text} is lost at the start screen`);
    if (['bar_new', 'new'].includes(did) && 'big' in dataset) throw new Error(`after ${did} the robot is seen as in a run`);
    if (LATER.includes(did)) tab.isComing = true;
    if (!PASSIVE.includes(did) || tab.isComing) tab.typedText = null;
    else if (did === 'type') tab.typedText = text;
    checkTypedText(tab);
  };
}

function checkTypedText({ typedText }) {
  const text = view.state.doc.toString();
  if (typeof typedText === 'string' && text !== typedText) throw new Error(`${JSON.stringify(typedText)} was typed, and is ${JSON.stringify(text)} now`);
}

/** The part where the program halts is seen. */
function checkHalt({ pageState: { virtualRun: { value: { isHeld, ranges: [range] } } } }) {
  const offset = isHeld && range ? view.state.doc.line(range.line).from + range.column - 1 : view.sought;
  if (view.sought !== offset) throw new Error(`the program halts at ${offset}, and the text is scrolled to ${view.sought}`);
}

/** What has to be said and shown of the program, whoever has done what; nothing is under way. */
function checkRest({ pageState, summaryOf, versions, countAllStars, seen }) {
  const { checkResult, virtualRun, robotName, programText, fault, breakpoints } = pageState;
  const assertSame = (actual, expected, label) => { if (JSON.stringify(actual) !== JSON.stringify(expected)) throw new Error(`${label}: ${JSON.stringify(actual)} in place of ${JSON.stringify(expected)}`); };
  const { phase, state, screen } = document.documentElement.dataset;
  assertSame(state, 'checked', 'the program');
  const lines = checkResult.value.findings.map(({ line }) => line);
  assertSame(byId('status').textContent, summaryOf(checkResult.value), 'the status');
  assertSame(checkResult.value.image, checked(view.state.doc.toString(), robotName.value).image, 'the image');
  assertSame(byId('messages').children.length, lines.length, 'the messages');
  assertSame(byId('messages').querySelectorAll('.repair').length, checkResult.value.findings.filter((item) => item.may_repair).length, 'the fixes');
  assertSame(diagnosticLines(), lines, 'what is marked as wrong');
  const running = virtualRun.value.ranges.map(({ line }) => line);
  if (phase !== 'running') assertSame(runningLines(), running, 'what is marked as running');
  assertSame(byId('robot').value, robotName.value, 'the robot');
  assertSame(byId('pause').disabled, !['running', 'paused'].includes(phase), 'Pause');
  if (screen === 'start' && (['running', 'paused'].includes(phase) || 'full' in document.documentElement.dataset || 'big' in document.documentElement.dataset || keptWork().own)) throw new Error(`behind the start screen is ${JSON.stringify([document.documentElement.dataset, keptWork()])}`);
  const earlier = versions.loadVersions();
  if (screen === 'start') {
    const titles = earlier.map((version, k) => versions.versionTitle(version, earlier.length - k));
    assertSame(byId('start_programs').querySelectorAll('strong').map(saidOf), titles.slice(0, 6), 'the programs at the start');
    assertSame([byId('start_badge').hidden, /★ (\d+)/.exec(saidOf(byId('start_badge')))?.[1]], [!countAllStars(), String(countAllStars())], 'the stars at the start');
  }
  const work = keptWork();
  assertSame([work.text, work.robot], [view.state.doc.toString(), robotName.value], 'what is kept');
  assertSame(programText.value, work.text, 'the program');
  if (byId('writing').dataset.view !== 'blocks' || screen === 'start' || phase === 'running') return;
  assertSame(textOf(seen.blocks.form), textOf(formOf(work.text)), 'the blocks');
  assertSame(seen.blocks.has, { robot: work.robot, level: byId('level').value, findings: lines, fault: fault.value.sentence, running, points: breakpoints.value.map(({ line }) => line) }, 'what is at blocks');
}

/** What is said of a program does not pass for what is said of a newer one, however long that takes. */
async function checkLate(tab) {
  if (document.documentElement.dataset.screen === 'start') return;
  tab.python.late = () => 3000;
  tab.typedText = null;
  view.dispatch({ changes: { from: view.state.doc.length, insert: '\nF(2)' } });
  await wait(2000);
  if (byId('status').textContent !== '…') throw new Error(`${byId('status').textContent} is said, and it was of the text before`);
  tab.python.late = () => 5;
  await wait(9000);
  checkRest(tab);
}

/** What was said of an edit outlasts its own text, and goes with the next edit or with a run. */
async function checkNote({ pageState: { note } }) {
  const edit = () => view.dispatch({ changes: { from: view.state.doc.length, insert: '\nF(1)' } });
  const run = () => press(byId('run'));
  for (const act of [edit, run]) {
    if (!isSeen(byId('run'))) return;
    note.set('said');
    edit();
    if (note.value === '') throw new Error('what is said of an edit goes with it');
    await wait(4000);
    act();
    if (note.value === 'said') throw new Error(`what was said of an edit stays after ${act.name}`);
  }
  press(byId('stop'));
  await wait(4000);
}

/** All that is seen. */
function seenIn({ seen }) {
  const isText = byId('writing').dataset.view === 'text';
  const parts = document.querySelectorAll('[id]').filter((item) => !item.children.length || ['messages', 'values', 'versions', 'start_programs', 'world', 'robot', 'lesson'].includes(item.id)).filter((item) => item.id !== 'link_said' && item.checkVisibility() && isOpen(item));
  const { dataset } = document.documentElement;
  return JSON.parse(JSON.stringify([
    Object.entries({ ...dataset, halt: '', link: '' }).sort(), document.querySelectorAll('dialog').filter(({ open }) => open).map(({ id }) => id), view.state.doc.toString(), diagnosticLines(), runningLines(), seen.arena.seen, !isText && seen.blocks && [seen.blocks.form, seen.blocks.has],
    ...parts.map((part) => [part.id, saidOf(part), part.value, part.disabled, part.getAttribute('aria-pressed'), { ...part.dataset }]),
  ]));
}

const MOSTLY = ['press', 'press', 'drive', 'type', 'build', 'press', 'learn', 'retype'];
function playActions(random, tab, names = random() < 0.7 ? MOSTLY : Object.keys(ACTS)) {
  for (;;) {
    const name = random.of(names);
    const check = makeCheck(tab);
    const found = ACTS[name](random, tab);
    if (found === false) continue;
    const did = typeof found === 'string' ? found : name;
    check(did);
    return did;
  }
}

async function playSeed(seed) {
  location.hash = '';
  const random = chanceOf(seed + 1);
  const tab = await openTab({});
  const delay = () => random.below(random.of([10, 10, 300]));
  tab.python.late = delay;
  tab.python.verdict = () => random.of(['', '', 'passed', 'failed', 'mistakes']);
  const ends = [];
  for (let k = 20 + random.below(40); k > 0; k -= 1) {
    ends.push(playActions(random, tab));
    await wait(random.of([0, random.below(50), random.below(800)]));
    checkTypedText(tab);
    checkHalt(tab);
    if (k % 20) continue;
    tab.python.late = () => 5;
    await wait(4000);
    checkTypedText(tab);
    checkRest(tab);
    await checkLate(tab);
    await checkNote(tab);
    tab.isComing = false;
    tab.python.late = delay;
    playActions(random, tab, ['retype', 'wait']);
    await wait(1000);
    checkTypedText(tab);
  }
  tab.python.late = () => 5;
  await wait(3000);
  await beginAnew(tab);
  const stores = Object.fromEntries(['localStorage', 'sessionStorage'].map((name) => [name, [...window[name]]]));
  await beginAnew(tab); // as the other tab
  const play = async (item) => {
    const same = chanceOf(seed + 1000);
    item.python.runs = 0;
    item.python.verdict = () => same.of(['', 'passed', 'failed', 'mistakes']);
    const all = [['begin', seenIn(item)]];
    for (let k = 8; k > 0; k -= 1) {
      const did = playActions(same, item);
      const waited_ms = same.of([300, 2000, 6000]);
      await wait(waited_ms);
      if (waited_ms > 1000) checkRest(item);
      all.push([did, seenIn(item)]);
    }
    return all;
  };
  const after = await play(tab);
  const fresh = await openTab(stores);
  await beginAnew(fresh);
  const alone = await play(fresh);
  let k = 0;
  while (k < after.length - 1 && JSON.stringify(after[k]) === JSON.stringify(alone[k])) k += 1;
  console.log(JSON.stringify({ ends, acts: after.slice(0, k + 1).map(([did]) => did), ...compared(after[k], alone[k]), unhandled: unhandled.splice(0) }));
}

try {
  for (let seed = firstSeed; seed < firstSeed + seedCount; seed += 1) await playSeed(seed);
  process.exit(0);
} catch (error) {
  console.error(error);
  process.exit(1);
}
