// The page: puts editor, compiler, files and kept work together.

import { element } from './page/elements.js';
import { Editor } from './writing/editor.js';
import { bytesOf, download } from './page/files.js';
import { Lessons } from './lesson/lessons.js';
import { showMessages, summary } from './writing/messages.js';
import { whenOffline } from './page/offline.js';
import { Phone } from './page/phone.js';
import { Programs } from './programs/programs.js';
import { Python } from './python.js';
import { pictured, robotPicture } from './page/pictures.js';
import { bringsProgram } from './programs/links.js';
import { called, currentLanguage, known, languageOf, LANGUAGES, setLanguage, text } from './page/texts.js';
import { Driving } from './virtual/driving.js';
import { Recorder } from './robot/recorder.js';
import { whyOutside } from './robot/host.js';
import { RobotPanel } from './robot/panel.js';
import { RobotPlace } from './robot/place.js';
import { chooseSide } from './page/sides.js';
import { FIRST_PROGRAM } from './start/beginnings.js';
import { beginScreens, isStart, show as showScreen } from './start/screens.js';
import { Start } from './start/start.js';
import { beginTheme } from './page/theme.js';
import { Views } from './writing/views.js';
import { ROBOTS, showWords } from './page/words.js';
import { keep, keptWork, LONGEST } from './programs/work.js';

/** @typedef {import('./python.js').Checked} Checked */
/** @typedef {import('./python.js').Finding} Finding */

const TYPING_MS = 150; // of silence before a text is compiled

const robots = element('robot', HTMLSelectElement);
const languages = element('language', HTMLSelectElement);
const words = element('words', HTMLButtonElement);
const file = element('file', HTMLInputElement);
const status = element('status', HTMLElement);
const note = element('note', HTMLElement);
const list = element('messages', HTMLElement);

beginTheme();
const kept = keptWork();
const work = kept ?? {
  text: FIRST_PROGRAM,
  robot: ROBOTS[0]?.name ?? '',
  world: 'obstacles',
  language: languageOf(navigator.language),
  name: '',
  view: /** @type {const} */ ('blocks'),
  level: /** @type {const} */ ('few'),
  words: false,
  sound: true,
};
const python = new Python(work.language);
languages.replaceChildren(...LANGUAGES.map(([code, name]) => Object.assign(new Option(name, code), { lang: code })));
languages.value = work.language = await setLanguage(work.language);
showWords(work.words);
words.setAttribute('aria-pressed', String(work.words));

const editor = new Editor(element('editor', HTMLElement), work.robot, changed, () => driving.breakpointsChanged(), (line) => {
  note.textContent = text('no_breakpoint', { line });
});
const views = new Views(python, editor, work, remember);
const driving = new Driving(python, views, work, () => (isStale() ? null : newest.answer), whenCompiled, remember);
const programs = new Programs(python, work, putProgram, (said) => {
  note.textContent = said;
}, () => views.picture());

const recorder = new Recorder({ python, text: () => editor.text, robot: () => work.robot, world: () => driving.world });
const place = new RobotPlace({
  program: () => (isStale() ? null : newest.answer),
  show: (range) => views.showRunningThere(range),
});
const panel = new RobotPanel({
  recorder,
  place,
  python,
  program: () => (isStale() ? null : newest.answer),
  robot: () => work.robot,
  setRobot,
  goTo: (place) => views.goTo(place),
});
const lessons = new Lessons({
  python,
  program: () => editor.text,
  setRobot: (name) => {
    if (name !== work.robot) setRobot(name);
  },
  put: (program) => programs.replace({ ...program, name: '' }),
  showWorld: (lesson, seed, label) => driving.showLesson(lesson, seed, label),
  play: (run) => driving.play(run),
  stop: () => driving.stop(),
  tell: (said) => {
    note.textContent = said;
  },
});
chooseSide();
const phone = new Phone(() => panel.run());
beginScreens(whyOutside !== '' || bringsProgram(location.hash), !('class' in document.documentElement.dataset));
if (kept) programs.keep();
const start = new Start({
  put: (program) => programs.replace(program),
  run: (world) => {
    phone.show('robot');
    return driving.run(world);
  },
  see: () => views.wake(),
  side: (id) => {
    element(id, HTMLButtonElement).click();
    phone.show(id === 'side_virtual' ? 'program' : 'robot');
  },
  leave: () => {
    driving.stop();
    programs.keep();
  },
});
if ('class' in document.documentElement.dataset) {
  import('./class/classroom.js').then(({ beginClass }) => beginClass({
    panel, work, python, empty: () => editor.replace(''), put: (program) => programs.replace({ ...program, name: '' }),
  }));
}

/** The newest answer, and what it is about. @type {{key: string, answer: Checked | null}} */
let newest = { key: '', answer: null };
let isReady = false;
let isChecking = false;
let timer = 0;
/** Those who wait for the newest answer. @type {((answer: Checked | null) => void)[]} */
const waiting = [];

showRobots();
if (whyOutside) note.textContent = text(known(`why_${whyOutside}`));
editor.replace(work.text);
status.textContent = text('starting');
python.ready.then(
  () => {
    isReady = true;
    check();
    views.ready();
    if (isStart()) views.fetchAhead();
  },
  () => {
    status.textContent = text('no_compiler');
    document.documentElement.dataset['state'] = 'failed';
    tell(null);
  },
);

function changed() {
  document.documentElement.dataset['state'] = 'changed';
  work.text = editor.text;
  driving.forgetPlaces();
  place.programChanged();
  views.textChanged();
  lessons.textChanged();
  remember();
  clearTimeout(timer);
  timer = window.setTimeout(check, TYPING_MS);
}

/** Compiles what is in the editor, one text at a time, until the newest has been compiled. */
async function check() {
  document.documentElement.dataset['state'] = 'changed';
  if (!isReady || isChecking) return;
  isChecking = true;
  try {
    while (isStale()) {
      const now = { text: editor.text, robot: work.robot, language: currentLanguage() };
      const request = { do: 'check', robot: now.robot, language: now.language };
      const answer = /** @type {Checked} */ (await python.ask(request, new TextEncoder().encode(now.text)));
      newest = { key: keyOf(now), answer };
    }
    if (newest.answer) show(newest.answer); // also where a text has come back
    tell(newest.answer);
  } catch (why) {
    status.textContent = text('bug', { why: String(why).split('\n').filter(Boolean).at(-1) ?? '' });
    tell(null);
  } finally {
    isChecking = false;
  }
}

/** What the compiler says of the newest text, as soon as it can; null if it cannot. @returns {Promise<Checked | null>} */
function whenCompiled() {
  if (document.documentElement.dataset['state'] === 'failed') return Promise.resolve(null);
  return new Promise((resolve) => {
    waiting.push(resolve);
    check();
  });
}

/** @param {Checked | null} answer */
function tell(answer) {
  for (const each of waiting.splice(0)) each(answer);
}

/** @param {{text: string, robot: string, language: string}} what */
function keyOf(what) {
  return JSON.stringify([what.text, what.robot, what.language]);
}

function isStale() {
  return newest.key !== keyOf({ text: editor.text, robot: work.robot, language: currentLanguage() });
}

/** @param {Checked} answer */
function show(answer) {
  editor.showFindings(answer.findings, repair);
  editor.setPlaces(answer.places);
  place.programChanged();
  views.showFindings(answer.findings);
  phone.said(answer.findings.length);
  showMessages(list, answer.findings, (finding) => views.goTo(finding), repair);
  status.textContent = summary(answer);
  status.className = answer.image ? (answer.loose ? 'loose' : 'right') : 'wrong';
  document.documentElement.dataset['state'] = 'checked';
  document.documentElement.dataset['image'] = answer.image;
}

/** @param {Finding} finding */
function repair(finding) {
  if (!isStale()) editor.change(finding.repair); // else its places are those of another text
}

function showRobots() {
  robots.replaceChildren(
    ...ROBOTS.map((robot) => pictured(called(robot.labels), robot.name, robotPicture(robot))),
  );
  robots.value = work.robot;
}

function remember() {
  if (!keep(work)) note.textContent = text(work.text.length > LONGEST ? 'kept_too_long' : 'not_kept');
}

robots.addEventListener('change', () => setRobot(robots.value));

/** @param {string} name */
function setRobot(name) {
  work.robot = robots.value = name;
  editor.setRobot(work.robot);
  views.setRobot();
  driving.begin();
  remember();
  check();
}

/** @param {{text: string, robot: string, name: string}} program */
function putProgram(program) {
  note.textContent = '';
  showScreen('program');
  phone.show('program');
  if (program.robot !== work.robot) setRobot(program.robot);
  work.name = program.name;
  views.begin();
  editor.replace(program.text);
  remember();
}

languages.addEventListener('change', async () => {
  document.documentElement.dataset['state'] = 'changed';
  const isLearnt = python.ask({ do: 'learn', language: languages.value }).catch(() => null);
  languages.value = work.language = await setLanguage(languages.value);
  editor.setLanguage();
  views.setLanguage();
  showRobots();
  driving.setLanguage();
  panel.setLanguage();
  recorder.setLanguage();
  lessons.setLanguage();
  start.showPrograms();
  phone.setLanguage();
  note.textContent = '';
  if (!isReady) status.textContent = text('starting');
  remember();
  await isLearnt;
  newest.key = ''; // what was said meanwhile is in English
  check();
});

words.addEventListener('click', () => {
  work.words = !work.words;
  showWords(work.words);
  words.setAttribute('aria-pressed', String(work.words));
  views.setLanguage();
  driving.setLanguage();
  remember();
});

element('open', HTMLButtonElement).addEventListener('click', () => file.click());

file.addEventListener('change', async () => {
  const chosen = file.files?.[0];
  file.value = '';
  if (!chosen) return;
  let answer;
  try {
    const data = await bytesOf(chosen);
    answer = await python.ask({ do: 'open', robot: work.robot, language: currentLanguage() }, data);
  } catch {
    note.textContent = text('not_opened', { name: chosen.name, why: text('unreadable') });
    return;
  }
  if (answer.text === undefined) {
    const why = [answer.message, answer.fix && `${text('try')} ${answer.fix}`].filter(Boolean).join(' ');
    note.textContent = text('not_opened', { name: chosen.name, why });
    return;
  }
  programs.replace({ text: answer.text, robot: work.robot, name: chosen.name });
  note.textContent = text('opened', { name: chosen.name });
});

element('save', HTMLButtonElement).addEventListener('click', () => {
  const name = work.name || text('file_name');
  download(name, editor.text);
  note.textContent = text('saved', { name });
});

addEventListener('keydown', (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  if (event.key === 's') {
    event.preventDefault();
    element('save', HTMLButtonElement).click();
  } else if (event.key === 'o') {
    event.preventDefault();
    file.click();
  } else if ('zZyY'.includes(event.key) && !event.defaultPrevented && !hasItsOwnUndo(event.composedPath()[0])) {
    event.preventDefault();
    const isRedo = event.shiftKey || event.key === 'y';
    const place = 'drawing' in document.documentElement.dataset ? 'world_' : '';
    element(`${place}${isRedo ? 'redo' : 'undo'}`, HTMLButtonElement).click();
  }
});

/** Whether a key was pressed in a field of text, or in front of the page. @param {EventTarget | undefined} target */
function hasItsOwnUndo(target) {
  return target instanceof Element && target.closest('input:not([type=checkbox]), textarea, [contenteditable=true], dialog') !== null;
}

whenOffline();
programs.openLink();
