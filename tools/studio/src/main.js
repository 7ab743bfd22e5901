// The page: puts editor, compiler, files and kept work together.

import { element } from './page/elements.js';
import { Checker } from './writing/checking.js';
import { Editor } from './writing/editor.js';
import { bugSentence } from './page/faults.js';
import { readBytes, downloadText, onFileChosen } from './page/files.js';
import { Lessons } from './lesson/lessons.js';
import { showMessages, showRepair, summaryOf, messageWithFix } from './writing/messages.js';
import { registerServiceWorker } from './page/offline.js';
import { Phone } from './page/phone.js';
import { Programs } from './programs/programs.js';
import { Python } from './python.js';
import { listenToPictureKeys, makePictureOption, makeRobotPicture } from './page/pictures.js';
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
import { openFirstScreen, isStartShown, showScreen } from './start/screens.js';
import { OwnRobotWindow } from './start/own_window.js';
import { Start } from './start/start.js';
import { startTheme } from './page/theme.js';
import { Views } from './writing/views.js';
import { ROBOTS } from './page/words.js';
import { storeWork, loadWork, MAX_CHARACTERS } from './programs/work.js';

/** @typedef {import('./python.js').Finding} Finding */

const OWN_EDIT_MS = 1000; // within which the text of an edit comes of which something was said
const STALE_STATUS_MS = 400; // that what was said of a text may stay over the next one: most are checked before

const robotSelect = element('robot', HTMLSelectElement);
const languageSelect = element('language', HTMLSelectElement);
const wordsButton = element('words', HTMLButtonElement);
const fileInput = element('file', HTMLInputElement);
let lastNote_ms = 0;
const statusElement = element('status', HTMLElement);
const noteElement = element('note', HTMLElement);
const messageList = element('messages', HTMLElement);

startTheme();
showOwnRobot();
ignoreSecondPresses();
listenToPictureKeys();
const storedWork = loadWork();
const work = storedWork ?? {
  text: FIRST_PROGRAM,
  robot: ROBOTS[0]?.name ?? '',
  world: 'obstacles',
  language: languageOf(navigator.language),
  name: '',
  lesson: '',
  own: null,
  view: /** @type {const} */ ('blocks'),
  level: /** @type {const} */ ('few'),
  words: false,
  sound: true,
};
const python = new Python(work.language);
languageSelect.replaceChildren(...LANGUAGES.map(([code, name]) => Object.assign(new Option(name, code), { lang: code })));
languageSelect.value = work.language = await setLanguage(work.language);
element('coming', HTMLElement).remove();
pageState.note.subscribe((sentence) => {
  noteElement.textContent = sentence;
  lastNote_ms = performance.now();
});
pageState.programText.subscribe(forgetNote);
for (const id of ['run', 'step', 'link_upload']) element(id, HTMLButtonElement).addEventListener('click', forgetNote, { capture: true }); // a phone takes some of them
pageState.areWordsShown.subscribe((areShown) => {
  work.words = areShown;
  wordsButton.setAttribute('aria-pressed', String(areShown));
  storeCurrentWork();
});
pageState.robotName.subscribe((name) => {
  work.robot = robotSelect.value = name;
  storeCurrentWork();
});
pageState.programText.subscribe((programText) => {
  work.text = programText;
  storeCurrentWork();
});
pageState.areWordsShown.set(work.words);
pageState.ownRobot.subscribe(showRobots);
showRobots();
pageState.robotName.set(work.robot);

const editor = new Editor(element('editor', HTMLElement));
const views = new Views({
  python, editor, work, storeCurrentWork,
  tryAlone: (programText, isAsked) => {
    forgetNote();
    return simulatorPanel.tryAlone(programText, isAsked, () => {
      element('side_virtual', HTMLButtonElement).click();
      phone.show('robot');
    });
  },
  playTone: (hertz) => simulatorPanel.playTone(hertz),
});
const pad = new Pad();
const simulatorPanel = new SimulatorPanel({
  python, work, storeCurrentWork, pad,
  whenChecked: () => checker.whenChecked(),
  putProgram: ({ text: programText, robot: robotName }) => {
    element('side_virtual', HTMLButtonElement).click();
    if (programText !== work.text || robotName !== work.robot) programs.replaceProgram({ text: programText, robot: robotName, name: '' });
    phone.show('robot');
  },
});
const programs = new Programs({ python, work, putProgram, makePicture: () => views.makePicture() });

const recorder = new Recorder({ runs: simulatorPanel.runs, play: (run) => simulatorPanel.playAgain(run) });
const runningPlace = new RunningPlace();
const robotPanel = new RobotPanel({
  recorder,
  place: runningPlace,
  pad,
  python,
  goTo: (range) => views.goTo(range),
});
const lessons = new Lessons({
  python,
  work,
  putProgram: (program) => programs.replaceProgram(program),
  keepProgram: () => programs.storeVersion(),
  exchangeProgram: (program) => {
    programs.storeVersion();
    openProgram(program);
  },
  simulatorPanel,
});
listenToSideButtons();
pageState.language.subscribe(() => {
  showRobots();
  pageState.note.set('');
  if (!isReady) statusElement.textContent = text('starting');
  storeCurrentWork();
});
const checker = new Checker(python, (error) => {
  showStatus(bugSentence(error), 'wrong');
});
const phone = new Phone(() => robotPanel.run());
openFirstScreen(entryFailure !== '' || holdsProgram(location.hash), !('class' in document.documentElement.dataset));
if (storedWork) programs.storeVersion();
new OwnRobotWindow();
new Start({
  putProgram: (program) => programs.replaceProgram(program),
  runInWorld: (worldName) => {
    phone.show('robot');
    return simulatorPanel.run(worldName);
  },
  onProgramShown: () => views.wake(),
  showSide: (id) => {
    element(id, HTMLButtonElement).click();
    phone.show(id === 'side_virtual' ? 'program' : 'robot');
  },
  leaveProgram: () => {
    element('programs', HTMLDialogElement).close();
    simulatorPanel.leave();
    programs.storeVersion();
    lessons.leave();
  },
});
if (!isStartShown()) lessons.reopen();
if ('class' in document.documentElement.dataset) {
  import('./class/classroom.js').then(({ openClass }) => openClass({
    panel: robotPanel, work, python, editor, views, keepProgram: () => programs.storeVersion(), openLesson: (lessonNumber) => {
      phone.show('robot');
      return lessons.open(lessonNumber);
    }, clearProgram: () => editor.replace(''), putProgram: (program) => programs.replaceProgram({ ...program, name: '' }),
    fetchNewestRunFile: () => simulatorPanel.fetchNewestRunFile(), openRun: (file) => simulatorPanel.openRun(file),
  }));
}

let isReady = false;
let staleTimer = 0; // while what is said may be of the text before

pageState.checkResult.subscribe((answer) => {
  if (!answer) {
    staleTimer ||= window.setTimeout(() => {
      if (isReady) showStatus('…', '');
    }, STALE_STATUS_MS);
    return;
  }
  editor.showFindings(answer.findings, repair);
  showFindings(answer.findings);
  showSummary(answer);
});
pageState.offeredFindingIndex.subscribe((findingIndex) => {
  const finding = pageState.checkResult.value?.findings[findingIndex];
  if (finding) showRepair(messageList, findingIndex, finding, repair);
});
for (const observable of [pageState.areBlocksNamed, pageState.areWordsShown]) observable.subscribe(() => { // which say another word for the same code
  const { findings = [] } = pageState.checkResult.value ?? {};
  showFindings(findings);
  if (pageState.checkResult.value) showSummary(pageState.checkResult.value);
  findings.forEach((finding, findingIndex) => {
    if (finding.repair?.length) showRepair(messageList, findingIndex, finding, repair);
  });
});
if (entryFailure) pageState.note.set(text(textKey(`why_${entryFailure}`)));
editor.replace(work.text);
statusElement.textContent = text('starting');
python.listen({
  onWait: () => {
    if (isReady) pageState.note.set(text('starting_waits'));
    else statusElement.textContent = text('starting_waits');
    simulatorPanel.showWaiting();
  },
  onBegin: () => {
    statusElement.textContent = text('starting');
    checker.markRetry();
  },
  onFail: () => {
    statusElement.textContent = text('no_compiler');
    checker.markFailed();
  },
});
python.ready.then(() => {
  isReady = true;
  checker.markReady();
  views.markReady();
  if (isStartShown()) views.prefetchBlocks();
});

/** @param {string} sentence of the newest text @param {string} className */
function showStatus(sentence, className) {
  clearTimeout(staleTimer);
  staleTimer = 0;
  statusElement.textContent = sentence;
  statusElement.className = className;
}

/** @param {import('./python.js').CheckResult} answer */
function showSummary(answer) {
  showStatus(summaryOf(answer), answer.image ? (answer.loose ? 'loose' : 'right') : 'wrong');
}

/** @param {Finding[]} findings */
function showFindings(findings) {
  showMessages(messageList, findings, (finding) => views.goTo(finding));
}

/** @param {Finding} finding */
function repair(finding) {
  if (pageState.checkResult.value && finding.repair) editor.applyChanges(finding.repair); // else its places are those of another text
}

/** What was said of an edit goes with the next one or with a run. */
function forgetNote() {
  if (pageState.note.value && performance.now() - lastNote_ms > OWN_EDIT_MS) pageState.note.set('');
}

function showRobots() {
  robotSelect.replaceChildren(
    ...ROBOTS.map((robot) => makePictureOption(labelOf(robot.labels), robot.name, makeRobotPicture(robot))),
  );
  robotSelect.value = work.robot;
}

function storeCurrentWork() {
  if (!storeWork(work)) pageState.note.set(text(work.text.length > MAX_CHARACTERS ? 'kept_too_long' : 'not_kept'));
}

robotSelect.addEventListener('change', async () => {
  const robotName = robotSelect.value;
  if (pageState.isRobotNamed.value) { // then the text changes its mind, too
    const programText = pageState.programText.value;
    const answer = await python.ask({ do: 'rename', robot: robotName }, new TextEncoder().encode(programText));
    if (pageState.programText.value === programText) editor.replace(answer.text);
  }
  pageState.robotName.set(robotName);
});

/** @param {{text: string, robot: string, name: string, lesson?: string}} program */
function putProgram(program) {
  showScreen('program');
  phone.show('program');
  openProgram(program);
}

/** @param {{text: string, robot: string, name: string, lesson?: string}} program begins anew, whatever is seen; `lesson` whose it is */
function openProgram(program) {
  pageState.note.set('');
  if (program.robot !== work.robot) pageState.robotName.set(program.robot);
  work.name = program.name;
  work.lesson = program.lesson ?? '';
  if (!work.lesson) work.own = null;
  views.beginProgram();
  editor.replace(program.text);
  simulatorPanel.beginAnew();
  storeCurrentWork();
}

languageSelect.addEventListener('change', async () => {
  const learning = python.ask({ do: 'learn', language: languageSelect.value }).catch(() => null);
  languageSelect.value = work.language = await setLanguage(languageSelect.value);
  await learning;
  checker.checkAgain(); // what was said meanwhile is in English
});

wordsButton.addEventListener('click', () => pageState.areWordsShown.set(!work.words));

element('open', HTMLButtonElement).addEventListener('click', () => fileInput.click());

onFileChosen('file', async (file) => {
  if (isRunFile(file.name)) {
    simulatorPanel.openRun(file);
    return;
  }
  let answer;
  try {
    const data = await readBytes(file);
    answer = await python.ask({ do: 'open', robot: work.robot, language: currentLanguage() }, data);
  } catch {
    pageState.note.set(text('not_opened', { name: file.name, why: text('unreadable') }));
    return;
  }
  if (answer.text === undefined) {
    pageState.note.set(text('not_opened', { name: file.name, why: messageWithFix(answer) }));
    return;
  }
  programs.replaceProgram({ text: answer.text, robot: work.robot, name: file.name });
  pageState.note.set(text('opened', { name: file.name }));
});

element('save', HTMLButtonElement).addEventListener('click', () => {
  const name = work.name || text('file_name');
  downloadText(name, editor.text);
  pageState.note.set(text('saved', { name }));
});

addEventListener('keydown', (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
  if (event.key === 's') {
    event.preventDefault();
    element('save', HTMLButtonElement).click();
  } else if (event.key === 'o') {
    event.preventDefault();
    fileInput.click();
  } else if ('zZyY'.includes(event.key) && !event.defaultPrevented && !hasOwnUndo(event.composedPath()[0])) {
    event.preventDefault();
    const isRedo = event.shiftKey || event.key === 'y';
    const idPrefix = 'drawing' in document.documentElement.dataset ? 'world_' : '';
    element(`${idPrefix}${isRedo ? 'redo' : 'undo'}`, HTMLButtonElement).click();
  }
});

/** Whether a key was pressed in a field of text, or in front of the page. @param {EventTarget | undefined} target */
function hasOwnUndo(target) {
  return target instanceof Element && target.closest('input:not([type=checkbox]), textarea, [contenteditable=true], dialog') !== null;
}

registerServiceWorker();
programs.openAddressProgram();
