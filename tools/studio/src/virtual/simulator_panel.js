// The part of the page with the virtual robot: its buttons, its picture and what is said about it.

import { Arena } from './arena.js';
import { BlockNames } from '../blocks/names.js';
import { labelAt, findingOnBlocks } from '../blocks/said.js';
import { element, setHidden, setText } from '../page/elements.js';
import { onEscapeKey } from '../page/escape.js';
import { faultSentence } from '../page/faults.js';
import { downloadText } from '../page/files.js';
import { rangeAt, StopOffsets } from '../writing/parts.js';
import { shownName, findShow } from '../writing/shows.js';
import { makeDialPicture, replaceOptions, makePictureOption } from '../page/pictures.js';
import { Plot } from './plot.js';
import { Simulator } from './simulator.js';
import { Sounds } from './sounds.js';
import { Stage } from './stage.js';
import { Run, Runs } from './runs.js';
import { RunsWindow } from './runs_window.js';
import { TimeLine } from './time_line.js';
import { pageState } from '../page/page_state.js';
import { readingText, parseShownValue, percentOfRange } from '../page/readings.js';
import { setStopNeeded } from '../page/stop_place.js';
import { currentLanguage, textKey, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';
import { devicesOf, deviceName } from '../page/words.js';
import { OWN_WORLD } from '../programs/work.js';
import { celebrate } from '../lesson/celebration.js';
import { storeStars, starsKeyOfWorld } from '../lesson/progress.js';
import { WorldChoice } from '../world/choice.js';
import { showRows, variableText } from '../page/rows.js';
import { boutEndText, bumpSentence, starsText, RunAnnouncer } from './where.js';
import { blocksOf, conditionsAt } from './why.js';
import { WorldDrawing } from '../world/drawing.js';

/** @typedef {import('../python.js').CheckResult} CheckResult */
/** @typedef {import('../python.js').RobotState} RobotState */

/**
 * @typedef {object} Page what this part needs of the page
 * @property {import('../python.js').Python} python
 * @property {import('../programs/work.js').Work} work
 * @property {() => Promise<CheckResult | null>} whenChecked what the compiler says of the newest text, when it is done; null if it cannot say
 * @property {() => void} storeCurrentWork
 * @property {import('../remote/pad.js').Pad} pad
 * @property {(program: {text: string, robot: string}) => void} putProgram the program of a recorded run into the editor
 */

const MAX_TRACE_LINES = 200; // lines of the trace
const READINGS_INTERVAL_MS = 100; // nobody reads what changes more often; where the program is and what is measured take turns
const SPEEDS = [0.1, 0.5, 1, 4, 20]; // times as quick as the robot
const LONGEST_REPLAY_MS = 6000; // at most for a run of a lesson, or a recorded one
const TONE_S = 0.35; // a tone that somebody chooses
const NEAR_MOMENT_MS = 60; // of a moment: nothing else of it is kept
/** What of a run is seen, by the button that shows it. */
const RUN_VIEWS = { seen_arena: 'arena', seen_plot: 'plot_place', seen_trace: 'trace_place' };

export class SimulatorPanel {
  #page;
  #startCount = 0; // one that STOP or a newer one has overtaken does nothing
  #isWaiting = false; // for the compiler
  #isPartRun = false; // what runs is a part of the program
  #onRunOver = () => {}; // the run of a lesson is over
  #simulator;
  #arena = new Arena(element('arena', HTMLCanvasElement));
  #plot = new Plot(element('plot', HTMLCanvasElement));
  #sounds = new Sounds();
  #stage;
  #announcer = new RunAnnouncer();
  #timeLine = new TimeLine(() => this.#onSeek());
  runs = new Runs();
  #runsWindow;
  /** The newest one. @type {Run | null} */
  #newestRun = null;
  #bumpCount = 0; // that were seen
  #canEarnStars = false; // stars: the run is of the whole program, in a world of its own task
  /** What each SHOW has shown last. @type {Map<string, string>} */
  #shownValues = new Map();
  /** What each had shown when somebody looks back. @type {Map<string, string>} */
  #pastShownValues = new Map();
  /** Whose run it is. @type {Run['program']} */
  #program = { places: [], shows: [], variables: [] };
  #wasStopped = false;
  /** What the run reads of a remote control; nothing of one that was judged. @type {string[]} */
  #remoteWords = [];
  #note = '';
  #traceText = ''; // of the trace
  #lastShown_ms = 0; // when more than the robot was shown last
  #areReadingsNext = false; // what is measured, not where the program is
  /** @type {CheckResult['places']} */
  #places = [];
  /** Where what runs stops; a run that is shown again stops nowhere. @type {StopOffsets | null} */
  #stopOffsets = null;
  /** @type {CheckResult['variables']} */
  #variables = [];
  #runButton = element('run', HTMLButtonElement);
  #pauseButton = element('pause', HTMLButtonElement);
  #pushButton = element('push', HTMLButtonElement);
  #whyButton = element('why', HTMLButtonElement);
  #blockNames;
  #isWhyAsked = false; // somebody, of each place at which they look
  #worldChoice;
  #worldDrawing;
  /** While a finger moves a part. @type {import('../world/parts.js').World | null} */
  #previewWorld = null;
  #restoring;

  /** @param {Page} page */
  constructor(page) {
    const { python, work, storeCurrentWork } = page;
    this.#page = page;
    this.#blockNames = new BlockNames(python, () => this.#show());
    this.#runsWindow = new RunsWindow({ python, runs: this.runs, show: (run) => this.#showRun(run), play: (openedRun, knownRun) => this.#playOpened(openedRun, knownRun) });
    this.#worldChoice = new WorldChoice(python, work, () => this.#enterWorld());
    this.#simulator = new Simulator(python, (state) => {
      if (state) this.#takeState(state);
      const isSame = document.documentElement.dataset['phase'] === 'running' && this.#simulator.phase === 'running';
      if (state && isSame) this.#showFrame(state);
      else this.#show();
    });
    this.#worldDrawing = new WorldDrawing(python, this.#arena, {
      getWorld: () => this.#shownWorld,
      worldChoice: this.#worldChoice,
      getRobotPlace: () => {
        const [x, y] = this.#simulator.state?.pose ?? [this.#shownWorld.start.x_cm, this.#shownWorld.start.y_cm];
        return [x, y];
      },
      isDriving: () => this.#isDriving,
      switchOff: () => {
        this.#switchOff();
        this.#chooseView('seen_arena');
      },
      putWorld: (world, isOther) => {
        this.#previewWorld = null;
        this.#worldChoice.putOwn(world, isOther);
        storeCurrentWork();
        this.#switchOff();
      },
      previewWorld: (world) => {
        this.#previewWorld = world;
        this.#switchOff();
      },
      refresh: () => this.#show(),
    });
    this.#runButton.addEventListener('click', () => this.#start(false));
    this.#pauseButton.addEventListener('click', (event) => {
      if (isSecondPress(event)) return; // it was pressed twice to pause
      this.#returnToNewest();
      if (this.#simulator.phase === 'paused') this.#simulator.resume();
      else this.#pauseRun();
    });
    element('step', HTMLButtonElement).addEventListener('click', () => {
      this.#returnToNewest();
      if (this.#simulator.phase === 'running') this.#pauseRun();
      else if (this.#simulator.phase === 'paused') this.#simulator.step();
      else this.#start(true);
    });
    this.#pushButton.addEventListener('click', () => {
      this.#returnToNewest();
      this.#simulator.pressButton();
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.stop());
    onEscapeKey(() => this.stop());
    const speedSelect = element('speed', HTMLSelectElement);
    replaceOptions(speedSelect, SPEEDS.map((speed, index) => makePictureOption(`× ${speed}`, String(speed), makeDialPicture(index / (SPEEDS.length - 1)))));
    speedSelect.value = '1';
    speedSelect.addEventListener('change', () => {
      this.#simulator.speed = Number(speedSelect.value);
    });
    element('save_trace', HTMLButtonElement).addEventListener('click', () => {
      downloadText(text('trace_name'), this.#simulator.trace.map((line) => `${line}\n`).join(''));
    });
    this.#whyButton.addEventListener('click', () => {
      this.#isWhyAsked = !this.#isWhyAsked;
      this.#show();
    });
    for (const viewButtonId of Object.keys(RUN_VIEWS)) element(viewButtonId, HTMLButtonElement).addEventListener('click', () => this.#chooseView(viewButtonId));
    const soundButton = element('sound', HTMLButtonElement);
    const applySound = () => {
      this.#sounds.setMuted(!work.sound);
      soundButton.setAttribute('aria-pressed', String(work.sound));
    };
    soundButton.addEventListener('click', () => {
      work.sound = !work.sound;
      applySound();
      storeCurrentWork();
    });
    applySound();
    element('erase_ways', HTMLButtonElement).addEventListener('click', () => {
      this.#arena.eraseTracks();
      this.#show();
    });
    pageState.ownRobot.subscribe(() => {
      if (pageState.language.value) this.#show();
    });
    new ResizeObserver(() => this.#showReadings()).observe(element('plot_place', HTMLElement));
    new ResizeObserver(() => {
      this.#arena.resize();
      this.#arena.draw(this.#shownState);
    }).observe(element('arena', HTMLCanvasElement));
    pageState.language.subscribe(() => this.#show());
    pageState.areWordsShown.subscribe(() => this.#show());
    pageState.areBlocksNamed.subscribe(() => {
      if (pageState.language.value) this.#show();
    });
    pageState.robotName.subscribe(() => this.reset());
    pageState.breakpoints.subscribe(() => this.#onBreakpointsChange());
    pageState.programText.subscribe(() => { // what runs is no longer what is seen
      this.#places = [];
      if (!this.#isWaiting) this.#note = ''; // which was said of the text before
      this.#show();
    });
    this.#stage = new Stage({
      setCamera: (camera) => {
        this.#arena.camera = camera;
        this.#arena.resize();
        this.#arena.draw(this.#shownState);
      },
      stop: () => this.stop(),
    });
    this.reset();
    this.#restoring = this.#restoreWorlds();
  }

  get #shownWorld() {
    return this.#previewWorld ?? this.#worldChoice.shownWorld;
  }

  /** Runs the program in a shipped world; resolves once the robot is on. @param {string} worldName */
  async run(worldName) {
    this.#worldChoice.choose(worldName);
    this.#enterWorld();
    await this.#start(false);
  }

  /**
   * Shows the run of a lesson that was judged; resolves when it is over, or another one begins.
   * @param {import('../lesson/lessons.js').JudgedRun} run
   */
  async play(run) {
    await this.#start(false, run, isMotionReduced() ? run.until_ms : run.until_ms / LONGEST_REPLAY_MS);
    if (this.#isDriving) await new Promise((resolve) => { this.#onRunOver = () => resolve(undefined); });
    this.#stage.shrink();
  }

  /**
   * Runs a part of the program alone; resolves when it is over. A run of the whole program goes on.
   * @param {string} programText
   * @param {boolean} isAsked whoever only touched a block stays at the program
   * @param {() => void} showArena has it seen
   */
  async tryAlone(programText, isAsked, showArena) {
    const isPeek = !isAsked && this.#stage.canPeek, isVisible = !this.#stage.canPeek && element('arena', HTMLCanvasElement).checkVisibility();
    if ((this.#isDriving && !this.#isPartRun) || this.#isWaiting || !(isVisible || isAsked || isPeek)) return;
    if (!isVisible && !isPeek) showArena();
    const startNumber = ++this.#startCount;
    const request = { do: 'check', robot: pageState.robotName.value, language: pageState.language.value };
    const checkResult = /** @type {CheckResult} */ (await this.#page.python.ask(request, new TextEncoder().encode(programText)));
    if (startNumber !== this.#startCount) return;
    if (!checkResult.image) {
      const mistake = checkResult.findings.find(({ severity }) => severity === 'mistake');
      pageState.note.set(text('alone_wrong', { why: mistake ? findingOnBlocks(mistake).message : '' })); // it is a block that is tried alone
      return;
    }
    const endPeek = isPeek ? this.#stage.peek() : () => {};
    await this.#start(false, null, 0, null, { text: programText, checkResult });
    if (this.#isDriving) await new Promise((resolve) => { this.#onRunOver = () => resolve(undefined); });
    endPeek();
  }

  /** @param {number} hertz of a tone that somebody chooses */
  playTone(hertz) {
    this.#sounds.begin();
    this.#sounds.beep(hertz, TONE_S);
  }

  /** Nothing comes of the compiler, for which a run may wait. */
  showWaiting() {
    if (!this.#isWaiting) return;
    this.#note = text('run_waits');
    this.#show();
  }

  /** Another program begins: with its robot at the start, on a floor without trails. */
  beginAnew() {
    this.#arena.eraseTracks();
    this.reset();
    this.#stage.shrink(); // it is written first
  }

  /** What a lesson has brought goes. */
  leaveLesson() {
    if (!this.#worldChoice.isOfLesson) return;
    this.#worldChoice.choose(this.#page.work.world);
    this.#enterWorld();
  }

  /** Another screen is seen. */
  leave() {
    this.stop();
    this.#worldDrawing.end();
  }

  /** How the robot is, or was at the moment at which somebody looks. */
  get #shownState() {
    return this.#timeLine.pastState ?? this.#simulator.state;
  }

  /** What is seen of which robot. */
  get #shownRobotName() {
    return this.#timeLine.pastState ? this.#timeLine.run.origin.robot : pageState.robotName.value;
  }

  get #shownVariables() {
    return this.#timeLine.pastState ? this.#timeLine.run.program.variables : this.#variables;
  }

  get #shownPlaces() {
    if (!this.#timeLine.pastState || this.#timeLine.run === this.#newestRun) return this.#places;
    const { origin, program } = this.#timeLine.run;
    return origin.text === pageState.programText.value ? program.places : [];
  }

  /** Plays a run that is kept, with its own program. @param {Run} run */
  async playAgain(run) {
    await this.#runsWindow.openData(new TextEncoder().encode(await this.#runsWindow.fileOf(run)), '', run);
  }

  /** Shows a run that is kept, at its end; a real robot's is played first. @param {Run} run */
  async #showRun(run) {
    if (run.moments.length < 2 || !run.world) {
      await this.playAgain(run);
      return;
    }
    if (this.#simulator.phase === 'running') this.#pauseRun();
    this.#timeLine.setRun(run);
    this.#drawTrack(run);
    this.#timeLine.seek(run.moments.last_ms);
  }

  /** @param {Run} run its world, and the way that it has taken */
  #drawTrack(run) {
    this.#arena.begin(run.world ?? this.#worldChoice.shownWorld, run.origin.robot, run === this.#newestRun ? this.#worldChoice.goals : []);
    for (const state of run.moments.states()) this.#arena.followState(state);
  }

  /** The file of the newest run that can be played again, or nothing. @returns {Promise<string>} */
  async fetchNewestRunFile() {
    const run = this.runs.newestFirst.find((candidate) => !candidate.isJudged && (candidate.fileText || candidate.rows.length));
    return run ? this.#runsWindow.fileOf(run) : '';
  }

  /** Opens the file of a run. @param {File} file */
  openRun(file) {
    return this.#runsWindow.open(file);
  }

  /** Plays a recorded run, which may be kept already. @param {import('./runs_window.js').OpenedRun} openedRun @param {Run | null} knownRun */
  async #playOpened(openedRun, knownRun) {
    await this.#simulator.stop();
    this.#page.putProgram(openedRun);
    if (typeof openedRun.world === 'string') this.#worldChoice.choose(openedRun.world);
    else if (openedRun.world && openedRun.shapes) {
      this.#worldChoice.bringWorld({ request: openedRun.world, shapes: openedRun.shapes, label: () => text('world_of_run'), goals: [] });
    }
    this.reset();
    this.#chooseView('seen_arena');
    const duration_ms = Math.max(1, openedRun.rows.at(-1)?.[0] ?? 0);
    await this.#start(false, null, duration_ms / LONGEST_REPLAY_MS, { openedRun, knownRun });
  }

  /** What runs stands still while somebody looks back. */
  #onSeek() {
    if (this.#simulator.phase === 'running') this.#pauseRun();
    this.#arena.showBubble('', 0);
    this.#pastShownValues = this.#keepShownValues(new Map(), this.#timeLine.shownEvents);
    this.#show();
  }

  /** The newest moment is seen again. */
  #returnToNewest() {
    if (!this.#timeLine.pastState) return;
    if (this.#newestRun && this.#timeLine.run !== this.#newestRun) {
      this.#timeLine.setRun(this.#newestRun);
      this.#drawTrack(this.#newestRun);
    }
    this.#timeLine.returnToNewest();
    this.#keepShownValues(this.#shownValues, this.#timeLine.shownEvents);
    this.#show();
  }

  get #isDriving() {
    const { phase } = this.#simulator;
    return phase === 'running' || phase === 'paused';
  }

  /** Shows the robot from above, or its values, or what it has done. @param {string} chosenButtonId a button */
  #chooseView(chosenButtonId) {
    for (const [viewButtonId, viewId] of Object.entries(RUN_VIEWS)) {
      element(viewButtonId, HTMLButtonElement).setAttribute('aria-pressed', String(viewButtonId === chosenButtonId));
      element(viewId, HTMLElement).hidden = viewButtonId !== chosenButtonId;
    }
    this.#show();
  }

  /** What the worker is asked for to have the world that is shown. */
  get worldRequest() {
    return this.#worldChoice.request;
  }

  /** Another world has been chosen. */
  #enterWorld() {
    this.#page.storeCurrentWork();
    this.reset();
  }

  /**
   * Shows a world of a lesson.
   * @param {number} lessonNumber
   * @param {number} seed
   * @param {() => string} label
   */
  async showLesson(lessonNumber, seed, label) {
    const { world, goals } = await this.#page.python.ask({ do: 'lesson_world', number: lessonNumber, seed });
    this.#worldChoice.bringWorld({ request: { lesson: lessonNumber, seed }, shapes: world, label, goals });
    this.reset();
    this.#chooseView('seen_arena');
  }

  /** Another robot or world: what drove there has ended. */
  reset() {
    this.#worldDrawing.cancelDrag();
    this.#previewWorld = null;
    this.#worldDrawing.reset();
    this.#switchOff();
    this.#stage?.showWorld();
  }

  #pauseRun() {
    this.#sounds.silence();
    this.#simulator.pause();
  }

  /** Stops, and switches off. */
  #switchOff() {
    this.stop();
    this.#simulator.leaveRun();
    this.#plot.clear();
    this.#timeLine.setRun();
    this.#note = '';
    this.#shownValues.clear();
    this.#variables = [];
    this.#arena.begin(this.#shownWorld, pageState.robotName.value, this.#worldChoice.goals);
    this.#show();
  }

  /** Brings the worlds back that were drawn here; none is drawn before, for it would take their place. */
  async #restoreWorlds() {
    try {
      const isNewestRestored = await this.#worldChoice.restoreOwn();
      if (this.#page.work.world !== OWN_WORLD) return;
      this.reset();
      if (isNewestRestored) return;
      this.#note = text('world_lost');
      this.#show();
    } catch {
      // the page says that there is no compiler
    } finally {
      this.#worldDrawing.enable();
    }
  }

  /** The program is to stop elsewhere. */
  #onBreakpointsChange() {
    if (!this.#stopOffsets) return;
    const offsetsBefore = this.#stopOffsets.offsets.join();
    this.#stopOffsets.update(pageState.breakpoints.value, this.#places);
    if (this.#stopOffsets.offsets.join() !== offsetsBefore) this.#simulator.setBreakpoints(this.#stopOffsets.offsets);
  }

  /**
   * @param {boolean} isPaused
   * @param {import('../lesson/lessons.js').JudgedRun | null} judgedRun
   * @param {number} leastSpeed times as quick as the robot
   * @param {{openedRun: import('./runs_window.js').OpenedRun, knownRun: Run | null} | null} replay a recorded run
   * @param {{text: string, checkResult: CheckResult} | null} partProgram a part of the program
   */
  async #start(isPaused, judgedRun = null, leastSpeed = 0, replay = null, partProgram = null) {
    this.#onRunOver();
    const startNumber = ++this.#startCount;
    this.#worldDrawing.notice = '';
    let program = partProgram?.checkResult ?? pageState.checkResult.value;
    if (!program) {
      this.#isWaiting = true;
      this.#note = text(this.#page.python.isLate ? 'run_waits' : 'still_compiling');
      this.#show();
      program = await this.#page.whenChecked();
      if (program) await this.#restoring;
      if (startNumber !== this.#startCount) return;
      this.#isWaiting = false;
    }
    this.#note = !program ? text('no_compiler') : program.image ? '' : text('first_repair');
    this.#show();
    await this.#simulator.stop(); // also before a program with mistakes: what runs is not what is seen
    if (startNumber !== this.#startCount || !program?.image) return;
    this.#sounds.begin();
    this.#wasStopped = false;
    this.#bumpCount = 0;
    this.#canEarnStars = !judgedRun && !replay && !partProgram;
    const stateBefore = this.#simulator.state;
    const pose = partProgram && stateBefore && !stateBefore.touches ? stateBefore.pose : null; // a part goes on where the robot has room
    this.#arena.begin(this.#worldChoice.shownWorld, pageState.robotName.value, this.#worldChoice.goals, pose);
    this.#plot.clear();
    this.#shownValues.clear();
    this.#program = program;
    this.#isPartRun = partProgram !== null;
    this.#places = partProgram ? [] : program.places; // which are those of another text
    this.#variables = program.variables;
    this.#stopOffsets = judgedRun || replay ? null : new StopOffsets();
    this.#stopOffsets?.update(pageState.breakpoints.value, this.#places);
    this.#remoteWords = judgedRun || replay ? [] : program.remote;
    const worldRequest = judgedRun ?? this.#worldChoice.request;
    const run = this.#newestRun = this.#makeRun(program, worldRequest, replay, partProgram?.text);
    run.isJudged = judgedRun !== null;
    this.#timeLine.setRun(run);
    const beginning = this.#simulator.begin(program, pageState.robotName.value, worldRequest, this.#stopOffsets?.offsets, isPaused, leastSpeed, replay !== null, pose);
    if (!partProgram && !(judgedRun && isMotionReduced())) this.#stage.enlarge(); // it sees nothing of the run before
    await beginning;
  }

  /**
   * The run that begins, among those that are kept.
   * @param {CheckResult} program
   * @param {unknown} worldRequest
   * @param {{openedRun: import('./runs_window.js').OpenedRun, knownRun: Run | null} | null} replay
   * @param {string} [programText] its text
   */
  #makeRun(program, worldRequest, replay, programText = pageState.programText.value) {
    const run = replay?.knownRun ?? new Run({ of: 'virtual', text: programText, robot: pageState.robotName.value, program: program.program, world: worldRequest }, program, null);
    if (replay && !replay.knownRun) {
      run.origin = { ...run.origin, of: replay.openedRun.of };
      run.fileText = replay.openedRun.fileText;
    }
    run.world = this.#worldChoice.shownWorld;
    run.program = program;
    run.restart();
    if (replay) {
      run.markKeys(replay.openedRun.rows);
      run.fileRows = replay.openedRun.rows;
    }
    if (!replay?.knownRun && !this.#isPartRun) this.runs.addRun(run);
    return run;
  }

  /** A world is solved: that is celebrated once a run, and its stars are kept. @param {number} stars */
  #earnStars(stars) {
    if (!stars || !this.#canEarnStars) return;
    this.#canEarnStars = false;
    const { request } = this.#worldChoice;
    if (typeof request === 'string') {
      if (!storeStars(starsKeyOfWorld(request), stars)) pageState.note.set(text('not_kept'));
      this.#worldChoice.showStars();
    }
    this.cheer();
    celebrate();
  }

  /** Its task is solved: it is glad, and that is heard. */
  cheer() {
    this.#arena.cheer();
    this.#sounds.cheer();
    this.#arena.draw(this.#shownState);
  }

  stop() {
    this.#startCount += 1;
    if (this.#isWaiting) {
      this.#isWaiting = false;
      this.#note = '';
      this.#show();
    }
    this.#sounds.silence();
    if (!this.#isDriving) return;
    this.#returnToNewest();
    this.#wasStopped = true;
    this.#simulator.stop();
  }

  #show() {
    const { phase } = this.#simulator;
    this.#arena.draw(this.#shownState); // first: writing on a canvas has the browser compute the style that changes made stale
    this.#showReadings();
    const { dataset } = document.documentElement, isOver = ['running', 'paused'].includes(dataset['phase'] ?? '') && phase === 'ended';
    dataset['phase'] = phase;
    setStopNeeded('run', this.#isDriving);
    if (isOver) this.#stage.onRunEnd();
    this.#offerRemote();
    if (!this.#isDriving) this.#onRunOver();
    this.#markPlaces(); // last: the editor has the page laid out, which is then done once
  }

  /** A run that reads a remote control can be driven. */
  #offerRemote() {
    const canDrive = this.#isDriving && this.#remoteWords.length > 0;
    this.#page.pad.offerRobot('driving', canDrive ? { remoteWords: this.#remoteWords, sendControls: (controls) => { this.#simulator.heldControls = controls; } } : null);
    if (!canDrive) this.#simulator.heldControls = null;
  }

  /** A picture of a run: beside the robot, one thing at a time is new. @param {import('../python.js').RobotState} state */
  #showFrame(state) {
    this.#arena.draw(state);
    if (performance.now() - this.#lastShown_ms < READINGS_INTERVAL_MS / 2) return;
    if (this.#areReadingsNext) this.#showReadings();
    else this.#markPlaces();
  }

  #showReadings() {
    const { phase, trace } = this.#simulator, state = this.#shownState;
    this.#lastShown_ms = performance.now();
    this.#areReadingsNext = false;
    this.#pauseButton.disabled = !this.#isDriving;
    setText(this.#pauseButton, text(phase === 'paused' ? 'go_on' : 'pause'));
    setHidden(this.#pushButton, !state?.is_waiting || phase !== 'running');
    setText(element('doing', HTMLElement), this.#note || this.#worldDrawing.notice || [pageState.ownRobot.value.name, this.#statusText()].filter(Boolean).join(': '));
    const traceText = trace.slice(-MAX_TRACE_LINES).join('\n');
    if (traceText !== this.#traceText) element('trace', HTMLElement).textContent = this.#traceText = traceText;
    this.#showScore(state?.score ?? null);
    this.#announcer.announce(state, phase);
    this.#showValues();
    this.#whyButton.disabled = !this.#timeLine.pastState;
    this.#whyButton.setAttribute('aria-pressed', String(this.#isWhyAsked));
    this.#plot.draw(state && this.#timeLine.pastState ? state.now_ms - (state.began_ms ?? state.now_ms) : null);
    this.#timeLine.show();
  }

  /** Marks what runs, or where it had a fault. */
  #markPlaces() {
    const state = this.#shownState;
    this.#lastShown_ms = performance.now();
    this.#areReadingsNext = true;
    const range = this.#shownRange();
    const places = this.#shownPlaces;
    const isSingleRange = !state || state.fault || state.is_held;
    const isOver = !this.#isDriving && !this.#timeLine.pastState && !state?.fault; // also of one that was stopped before its end
    const ranges = isOver ? [] : isSingleRange ? [range] : state.places.map((offset) => rangeAt(places, offset));
    pageState.virtualRun.set({ ranges: ranges.filter((range) => range !== null), isHeld: Boolean(state?.is_held) });
    pageState.fault.set({ range: state?.fault ? range : null, sentence: state?.fault ? faultSentence(state.fault) : '' });
  }

  /** What runs in the text that is seen, or what had a fault. */
  #shownRange() {
    const state = this.#shownState;
    return rangeAt(this.#shownPlaces, state?.fault ? state.fault_at : state?.at);
  }

  /** Keeps what is to be seen, and lets be heard what is. @param {import('../python.js').RobotState} state */
  #takeState(state) {
    this.#arena.followState(state);
    this.#newestRun?.add(state);
    this.runs.forgetOldest();
    if (state.bumps > this.#bumpCount) {
      this.#arena.shake();
      this.#sounds.crash();
    }
    this.#bumpCount = state.bumps;
    this.#earnStars(state.score?.stars ?? 0);
    for (const [at_ms, event] of state.events) {
      const [eventWord, hertz, duration_ms] = event.split(' ');
      if (eventWord !== 'BEEP') continue;
      this.#arena.showBeep(at_ms, at_ms + Number(duration_ms));
      this.#sounds.beep(Number(hertz), Number(duration_ms) / 1000 / this.#simulator.speed);
    }
    if (state.began_ms === null) return;
    this.#keepShownValues(this.#shownValues, state.events);
    this.#plot.add(state.now_ms - state.began_ms, [
      ...devicesOf(pageState.robotName.value, 'sensor').map((device, index) => ({ name: deviceName(device), value: parseShownValue(state.readings[index]?.text) })),
      ...this.#variables.map(({ name, is_yes_no }, index) => ({ name, value: is_yes_no ? Number(Boolean(state.variables[index])) : state.variables[index] })),
      ...[...this.#shownValues].map(([name, value]) => ({ name, value: parseShownValue(value) })),
    ]);
  }

  /**
   * Keeps what has been shown, by its name, and says the last of it.
   * @param {Map<string, string>} shownValues
   * @param {[number, string, number][]} events
   */
  #keepShownValues(shownValues, events) {
    for (const [at_ms, event, offset] of events) {
      if (!event.startsWith('SHOW ')) continue;
      const value = event.slice('SHOW '.length);
      const program = this.#timeLine.pastState ? this.#timeLine.run.program : this.#program, show = findShow(program, offset);
      shownValues.set(show ? shownName(program.shows, show, `SHOW(${show[1]})`, true) : 'SHOW', value);
      this.#arena.showBubble(value, at_ms);
    }
    return shownValues;
  }

  #statusText() {
    const { phase, state, isStopping, failure } = this.#simulator;
    if (failure) return failure;
    if (isStopping) return text('robot_stopping');
    const { parting } = this.#timeLine.run;
    const isAtParting = parting && (this.#timeLine.pastState ? parting.at_ms !== null && Math.abs(this.#timeLine.pastState.now_ms - parting.at_ms) < NEAR_MOMENT_MS : phase === 'ended');
    if (parting && isAtParting) return partingText(parting, this.#timeLine.run.origin.text);
    if (this.#timeLine.pastState) return this.#pastText(this.#timeLine.pastState);
    if (phase === 'off' || !state) return this.#taskText() || text('robot_off');
    if (state.fault) {
      const faultText = faultSentence(state.fault);
      const range = this.#shownRange();
      return range ? this.#sentenceOf('say_fault', 'say_fault_block', { line: range.line, what: faultText }, this.#partText(range)) : text('robot_fault', { what: faultText });
    }
    if (this.#wasStopped) return text('robot_stopped');
    const endText = state.score && boutEndText(state.score);
    if (endText) return endText;
    const heldRange = state.is_held && this.#shownRange();
    if (phase === 'paused' && heldRange) return this.#sentenceOf('robot_held', 'robot_held_block', { line: heldRange.line }, this.#partText(heldRange));
    if (phase === 'paused') return text('robot_paused');
    const { origin, program } = this.#timeLine.run;
    if (phase === 'ended') return text(program.places.length || origin.text !== pageState.programText.value ? 'robot_ended' : 'program_empty');
    const { speed, shownSpeed } = this.#simulator;
    if (shownSpeed > speed) return text('robot_running_fast', { times: shownSpeed.toFixed(1) }); // and not what somebody has chosen
    return text(state.is_waiting ? 'robot_waiting' : 'robot_running');
  }

  /** What ran at a moment, and the values of what it names. @param {import('../python.js').RobotState} state */
  #pastText(state) {
    const seconds = secondsOf(state), range = this.#shownRange();
    const reasons = this.#isWhyAsked ? [this.#whyText(state)] : [];
    if (!range) return [text('looked_back', { seconds }), ...reasons].join(' ');
    const part = this.#partText(range), names = new Set(part.toUpperCase().match(/\w+/g));
    const values = this.#valuesOf(state).filter(([name]) => names.has(name)).map(([name, value]) => `${this.#nameOf(name)} ${value}`);
    return [this.#sentenceOf('looked_back_at', 'looked_back_block', { seconds, line: range.line, part }, part), ...values, ...reasons].join(' · ');
  }

  /** @param {import('../writing/editor.js').Range} range of the program that is seen */
  #partText({ line, column, end_column }) {
    return (pageState.programText.value.split('\n')[line - 1] ?? '').slice(column - 1, end_column - 1).trim();
  }

  /** Code as it looks in the program. @param {string} code */
  #nameOf(code) {
    return pageState.areBlocksNamed.value ? this.#blockNames.nameOf(code.replace(/;.*/, ''), this.#shownRobotName) : code;
  }

  /**
   * Says something of an instruction: of its block, where that is seen, or else of its line.
   * @param {string} key @param {string} blockKey @param {Record<string, string | number>} values @param {string} code
   */
  #sentenceOf(key, blockKey, values, code) {
    return pageState.areBlocksNamed.value ? text(textKey(blockKey), { ...values, part: this.#nameOf(code) }) : text(textKey(key), values);
  }

  /** Why it was there: what was asked, with the values that the program had read, and whose motors they were. @param {RobotState} state */
  #whyText(state) {
    const { run } = this.#timeLine, { places, variables } = run.program;
    const offset = state.fault ? state.fault_at : state.at;
    if (offset === null) return text('why_nothing');
    const values = new Map(variables.map(({ name, is_yes_no }, index) => [name, variableText(state.variables[index], is_yes_no)]));
    const conditions = conditionsAt(run.origin.text, places, offset, (name) => run.readingAt(name, state.now_ms) ?? values.get(name));
    const listFormat = new Intl.ListFormat(currentLanguage());
    const bumpSentences = this.#arena.isDizzy(state) ? [bumpSentence(state)] : [];
    const sentences = conditions.flatMap(({ line, condition, values: conditionValues, isTrue }) => [
      this.#sentenceOf('why_asks', 'why_asks_block', { line, condition }, condition),
      conditionValues.length ? asSentence(listFormat.format(conditionValues.map(([name, value]) => text('why_value', { name: this.#nameOf(name), value })))) : '',
      isTrue === null ? '' : text(isTrue ? 'why_yes' : 'why_no'),
    ]).filter(Boolean);
    const { driver } = state, tasks = blocksOf(run.origin.text, places, /^(?:TASK|WHEN)\b/i);
    const task = driver === null ? undefined : tasks.find(({ hasOffset }) => hasOffset(driver));
    if (driver !== null && tasks.length) sentences.push(task ? this.#sentenceOf('why_task', 'why_task_block', { line: task.line }, run.origin.text.split('\n')[task.line - 1]?.replace(/^.*\|/, '') ?? '') : text('why_main'));
    return [...bumpSentences, ...sentences].join(' ') || text('why_nothing');
  }

  /** @param {import('../python.js').RobotState} state @returns {[string, string][]} the value of each sensor and variable, by its name */
  #valuesOf(state) {
    return [
      ...devicesOf(this.#shownRobotName, 'sensor').map(({ text: name }, index) => /** @type {[string, string]} */ ([name, state.readings[index]?.text ?? ''])),
      ...this.#shownVariables.map(({ name, is_yes_no }, index) => /** @type {[string, string]} */ ([name, variableText(state.variables[index], is_yes_no)])),
    ];
  }

  /** What is to be done in this world, if there is such a thing. */
  #taskText() {
    const { flags, seconds, rings, rivals } = this.#shownWorld;
    if (rings.length && rivals.length && !flags.length) return text(seconds ? 'task_sumo_in_time' : 'task_sumo', { seconds });
    if (!flags.length) return '';
    return text(seconds ? 'task_in_time' : 'task', { count: flags.length, seconds });
  }

  /** @param {import('../python.js').RobotState['score']} score */
  #showScore(score) {
    const scoreElement = element('score', HTMLElement);
    setHidden(scoreElement, !score);
    if (!score) return;
    const { taken: takenFlagCount, of: flagCount, pushed: pushedRivalCount, rivals: rivalCount, points, stars } = score;
    const parts = [flagCount && `⚑ ${takenFlagCount}/${flagCount}`, rivalCount && `⇥ ${pushedRivalCount}/${rivalCount}`].filter(Boolean).join('  ');
    setText(scoreElement, `${parts}   ${points}   ${starsText(stars)}`);
    scoreElement.classList.toggle('whole', stars > 0);
  }

  #showValues() {
    const state = this.#shownState;
    const readSensors = new Set((this.#timeLine.pastState ? this.#timeLine.run.program : this.#program).sensors);
    const sensorRows = devicesOf(this.#shownRobotName, 'sensor').map((device, index) => [deviceName(device), state ? readingText(device, state.readings[index]?.text ?? '') : '–', percentOfRange(device, state?.readings[index]?.value)]);
    const rows = [
      [text('time'), state ? `${secondsOf(state)} s` : '–'],
      [text('motors'), state ? state.motors.map((power) => `${power} %`).join('  ') : '–'],
      [text('bumps'), state ? String(state.bumps) : '–'],
      ...sensorRows.filter((_, index) => readSensors.has(index)), // first: what the program is about, where there is little room
      ...this.#shownVariables.map(({ name, is_yes_no }, index) => [name, variableText(state?.variables[index], is_yes_no)]),
      ...(this.#timeLine.pastState ? this.#pastShownValues : this.#shownValues),
      ...sensorRows.filter((_, index) => !readSensors.has(index)),
    ];
    showRows(element('values', HTMLElement), rows);
  }
}

/** Where a recorded run and the one that was played part, in words. @param {import('../python.js').Parting} parting @param {string} programText */
function partingText({ outcome: key, agreed, line, robot, virtual, sensor, began_ms }, programText) {
  /** @param {{ms: number, event: string} | null} row */
  const rowText = (row) => row ? text('record_at', { what: row.event.replace(/^SHOW /, ''), seconds: ((row.ms - began_ms) / 1000).toFixed(1) }) : text('record_nothing');
  const placeText = !line ? text('record_end') : pageState.areBlocksNamed.value ? `“${labelAt(programText, { line, column: 1 })}”` : text('line', { line });
  return text(textKey(`record_${key}`), { count: agreed, line, place: placeText, robot: rowText(robot), virtual: rowText(virtual), sensor });
}

/** Whether nothing is to move that need not: a run that was judged is seen at its end. */
function isMotionReduced() {
  return matchMedia('(prefers-reduced-motion: reduce)').matches;
}

/** @param {string} statement of which a block's words may be the first */
function asSentence(statement) {
  return `${statement.charAt(0).toLocaleUpperCase(currentLanguage())}${statement.slice(1)}.`;
}

/** How long the program has run. @param {import('../python.js').RobotState} state */
function secondsOf({ now_ms, began_ms }) {
  return ((now_ms - (began_ms ?? now_ms)) / 1000).toFixed(1);
}
