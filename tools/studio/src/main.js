// The page: puts editor, compiler, files and kept work together.

import { element } from './page/elements.js';
import { Checking } from './writing/checking.js';
import { Editor } from './writing/editor.js';
import { bugSentence } from './page/faults.js';
import { bytesOf, download, onFileChosen } from './page/files.js';
import { Lessons } from './lesson/lessons.js';
import { showMessages, showRepair, summary, whole } from './writing/messages.js';
import { registerServiceWorker } from './page/offline.js';
import { Phone } from './page/phone.js';
import { Programs } from './programs/programs.js';
import { Python } from './python.js';
import { pictureOption, robotPicture } from './page/pictures.js';
import { pageState } from './page/page_state.js';
import { showOwnRobot } from './page/own_robot.js';
import { holdsProgram } from './programs/links.js';
import { labelOf, currentLanguage, textKey, languageOf, LANGUAGES, setLanguage, text } from './page/texts.js';
import { isRunFile } from './virtual/runs_window.js';
import { SimulatorPanel } from './virtual/simulator_panel.js';
import { Pad } from './remote/pad.js';
import { Recorder } from './robot/recorder.js';
import { entryFailure } from './robot/host.js';
import { RobotPanel } from './robot/panel.js';
import { RunningPlace } from './robot/place.js';
import { listenToSideButtons } from './page/sides.js';
import { ignoreSecondPresses } from './page/twice.js';
import { FIRST_PROGRAM } from './start/beginnings.js';
import { openFirstScreen, isStart, showScreen as showScreen } from './start/screens.js';
import { OwnWindow } from './start/own_window.js';
import { Start } from './start/start.js';
import { startTheme } from './page/theme.js';
import { Views } from './writing/views.js';
import { ROBOTS } from './page/words.js';
import { storeWork, loadWork, MOST_CHARACTERS } from './programs/work.js';

/** @typedef {import('./python.js').Finding} Finding */

const UNCHECKED_MS = 400; // that what was said of a text may stay over the next one: most are checked before

const robots = element('robot', HTMLSelectElement);
const languages = element('language', HTMLSelectElement);
const words = element('words', HTMLButtonElement);
const file = element('file', HTMLInputElement);
const status = element('status', HTMLElement);
const note = element('note', HTMLElement);
const list = element('messages', HTMLElement);

startTheme();
showOwnRobot();
ignoreSecondPresses();
const kept = loadWork();
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
element('coming', HTMLElement).remove();
pageState.note.subscribe((said) => {
  note.textContent = said;
});
pageState.areWordsShown.subscribe((areShown) => {
  work.words = areShown;
  words.setAttribute('aria-pressed', String(areShown));
  remember();
});
pageState.robotName.subscribe((name) => {
  work.robot = robots.value = name;
  remember();
});
pageState.programText.subscribe((program) => {
  work.text = program;
  remember();
});
pageState.areWordsShown.set(work.words);
pageState.ownRobot.subscribe(showRobots);
showRobots();
pageState.robotName.set(work.robot);

const editor = new Editor(element('editor', HTMLElement));
const views = new Views({
  python, editor, work, remember,
  tryAlone: (program, isAsked) => driving.tryAlone(program, isAsked, () => {
    element('side_virtual', HTMLButtonElement).click();
    phone.show('robot');
  }),
  hear: (hertz) => driving.hear(hertz),
});
const pad = new Pad();
const driving = new SimulatorPanel({
  python, work, remember, pad,
  whenCompiled: () => checking.whenChecked(),
  put: ({ text: program, robot }) => {
    element('side_virtual', HTMLButtonElement).click();
    if (program !== work.text || robot !== work.robot) programs.replace({ text: program, robot, name: '' });
    phone.show('robot');
  },
});
const programs = new Programs({ python, work, put: putProgram, makePicture: () => views.picture() });

const recorder = new Recorder({ runs: driving.runs, play: (run) => driving.playAgain(run) });
const place = new RunningPlace();
const panel = new RobotPanel({
  recorder,
  place,
  pad,
  python,
  goTo: (place) => views.goTo(place),
});
const lessons = new Lessons({
  python,
  work,
  put: (program) => programs.replace(program),
  exchange: (program) => {
    programs.storeVersion();
    fill(program);
  },
  driving,
});
listenToSideButtons();
pageState.language.subscribe(() => {
  showRobots();
  pageState.note.set('');
  if (!isReady) status.textContent = text('starting');
  remember();
});
const checking = new Checking(python, (why) => {
  sayStatus(bugSentence(why), 'wrong');
});
const phone = new Phone(() => panel.run());
openFirstScreen(entryFailure !== '' || holdsProgram(location.hash), !('class' in document.documentElement.dataset));
if (kept) programs.storeVersion();
new OwnWindow();
new Start({
  putProgram: (program) => programs.replace(program),
  runInWorld: (world) => {
    phone.show('robot');
    return driving.run(world);
  },
  seeProgram: () => views.wake(),
  showSide: (id) => {
    element(id, HTMLButtonElement).click();
    phone.show(id === 'side_virtual' ? 'program' : 'robot');
  },
  leaveProgram: () => {
    element('programs', HTMLDialogElement).close();
    driving.leave();
    programs.storeVersion();
    lessons.leave();
  },
});
if ('class' in document.documentElement.dataset) {
  import('./class/classroom.js').then(({ openClass }) => openClass({
    panel, work, python, editor, views, keepProgram: () => programs.storeVersion(), clearProgram: () => editor.replace(''), putProgram: (program) => programs.replace({ ...program, name: '' }),
    newestRun: () => driving.newestRun(), openRun: (file) => driving.openRun(file),
  }));
}

let isReady = false;
let unchecked = 0; // while what is said may be of the text before

pageState.checkResult.subscribe((answer) => {
  if (!answer) {
    unchecked ||= window.setTimeout(() => {
      if (isReady) sayStatus('…', '');
    }, UNCHECKED_MS);
    return;
  }
  editor.showFindings(answer.findings, repair);
  showMessages(list, answer.findings, (finding) => views.goTo(finding));
  sayStatus(summary(answer), answer.image ? (answer.loose ? 'loose' : 'right') : 'wrong');
});
pageState.offeredFindingIndex.subscribe((which) => {
  const finding = pageState.checkResult.value?.findings[which];
  if (finding) showRepair(list, which, finding, repair);
});
if (entryFailure) pageState.note.set(text(textKey(`why_${entryFailure}`)));
editor.replace(work.text);
status.textContent = text('starting');
python.heed({
  waits: () => {
    if (isReady) pageState.note.set(text('starting_waits'));
    else status.textContent = text('starting_waits');
    driving.showWaiting();
  },
  begins: () => {
    status.textContent = text('starting');
    checking.begins();
  },
  fails: () => {
    status.textContent = text('no_compiler');
    checking.failed();
  },
});
python.ready.then(() => {
  isReady = true;
  checking.ready();
  views.ready();
  if (isStart()) views.fetchAhead();
});

/** @param {string} said of the newest text @param {string} look */
function sayStatus(said, look) {
  clearTimeout(unchecked);
  unchecked = 0;
  status.textContent = said;
  status.className = look;
}

/** @param {Finding} finding */
function repair(finding) {
  if (pageState.checkResult.value && finding.repair) editor.change(finding.repair); // else its places are those of another text
}

function showRobots() {
  robots.replaceChildren(
    ...ROBOTS.map((robot) => pictureOption(labelOf(robot.labels), robot.name, robotPicture(robot))),
  );
  robots.value = work.robot;
}

function remember() {
  if (!storeWork(work)) pageState.note.set(text(work.text.length > MOST_CHARACTERS ? 'kept_too_long' : 'not_kept'));
}

robots.addEventListener('change', async () => {
  const robot = robots.value;
  if (pageState.isRobotNamed.value) { // then the text changes its mind, too
    const now = pageState.programText.value;
    const answer = await python.ask({ do: 'rename', robot }, new TextEncoder().encode(now));
    if (pageState.programText.value === now) editor.replace(answer.text);
  }
  pageState.robotName.set(robot);
});

/** @param {{text: string, robot: string, name: string}} program */
function putProgram(program) {
  showScreen('program');
  phone.show('program');
  fill(program);
}

/** @param {{text: string, robot: string, name: string}} program begins anew, whatever is seen */
function fill(program) {
  pageState.note.set('');
  if (program.robot !== work.robot) pageState.robotName.set(program.robot);
  work.name = program.name;
  views.begin();
  editor.replace(program.text);
  driving.beginAnew();
  remember();
}

languages.addEventListener('change', async () => {
  const isLearnt = python.ask({ do: 'learn', language: languages.value }).catch(() => null);
  languages.value = work.language = await setLanguage(languages.value);
  await isLearnt;
  checking.again(); // what was said meanwhile is in English
});

words.addEventListener('click', () => pageState.areWordsShown.set(!work.words));

element('open', HTMLButtonElement).addEventListener('click', () => file.click());

onFileChosen('file', async (chosen) => {
  if (isRunFile(chosen.name)) {
    driving.openRun(chosen);
    return;
  }
  let answer;
  try {
    const data = await bytesOf(chosen);
    answer = await python.ask({ do: 'open', robot: work.robot, language: currentLanguage() }, data);
  } catch {
    pageState.note.set(text('not_opened', { name: chosen.name, why: text('unreadable') }));
    return;
  }
  if (answer.text === undefined) {
    pageState.note.set(text('not_opened', { name: chosen.name, why: whole(answer) }));
    return;
  }
  programs.replace({ text: answer.text, robot: work.robot, name: chosen.name });
  pageState.note.set(text('opened', { name: chosen.name }));
});

element('save', HTMLButtonElement).addEventListener('click', () => {
  const name = work.name || text('file_name');
  download(name, editor.text);
  pageState.note.set(text('saved', { name }));
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

registerServiceWorker();
programs.openLink();
