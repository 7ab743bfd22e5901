// The part of the page with the virtual robot: its buttons, its picture and what is told of it.

import { Arena } from './arena.js';
import { element, hide, say } from '../page/elements.js';
import { onEscapeKey } from '../page/escape.js';
import { faultSentence } from '../page/faults.js';
import { download } from '../page/files.js';
import { rangeAt, Stops } from '../writing/parts.js';
import { nameOfShow, showAt } from '../writing/shows.js';
import { dialPicture, replaceOptions, pictureOption } from '../page/pictures.js';
import { Plot } from './plot.js';
import { Simulator } from './simulator.js';
import { Sounds } from './sounds.js';
import { Stage } from './stage.js';
import { Run, Runs } from './runs.js';
import { RunsWindow } from './runs_window.js';
import { TimeLine } from './time_line.js';
import { pageState } from '../page/page_state.js';
import { readingText, numberOf, percentOfRange } from '../page/readings.js';
import { textKey, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';
import { devicesOf, deviceName } from '../page/words.js';
import { OWN_WORLD } from '../programs/work.js';
import { celebrate } from '../lesson/celebration.js';
import { keepStars, worldStars } from '../lesson/progress.js';
import { WorldChoice } from '../world/choice.js';
import { showRows, variableText } from '../page/rows.js';
import { howEnded, starsShown, Where } from './where.js';
import { blocksOf, conditionsAt } from './why.js';
import { WorldDrawing } from '../world/drawing.js';

/** @typedef {import('../python.js').Checked} Checked */
/** @typedef {import('../python.js').RobotState} RobotState */

/**
 * @typedef {object} Page what this part needs of the page
 * @property {import('../python.js').Python} python
 * @property {import('../programs/work.js').Work} work
 * @property {() => Promise<Checked | null>} whenCompiled what the compiler says of the newest text, when it is done; null if it cannot say
 * @property {() => void} remember
 * @property {import('../remote/pad.js').Pad} pad
 * @property {(program: {text: string, robot: string}) => void} put the program of a recorded run into the editor
 */

const SHOWN = 200; // lines of the trace
const READ_MS = 100; // nobody reads what changes more often; where the program is and what is measured take turns
const SPEEDS = [0.1, 0.5, 1, 4, 20]; // times as quick as the robot
const PLAYED_MS = 6000; // at most for a run of a lesson, or a recorded one
const HEARD_S = 0.35; // a tone that somebody chooses
const NEAR_MS = 60; // of a moment: nothing else of it is kept
/** What of a run is seen, by the button that shows it. */
const SEEN = { seen_arena: 'arena', seen_plot: 'plot_place', seen_trace: 'trace_place' };

export class SimulatorPanel {
  #page;
  #starts = 0; // one that STOP or a newer one has overtaken does nothing
  #isWaiting = false; // for the compiler
  #isAlone = false; // what runs is a part of the program
  #seenRun = () => {}; // the run of a lesson is over
  #simulator;
  #arena = new Arena(element('arena', HTMLCanvasElement));
  #plot = new Plot(element('plot', HTMLCanvasElement));
  #sounds = new Sounds();
  #stage;
  #where = new Where();
  #timeLine = new TimeLine(() => this.#lookBack());
  runs = new Runs();
  #window;
  /** The newest one. @type {Run | null} */
  #newest = null;
  #bumps = 0; // that were seen
  #canEarn = false; // stars: the run is of the whole program, in a world of its own task
  /** What each SHOW has shown last. @type {Map<string, string>} */
  #shown = new Map();
  /** What each had shown when somebody looks back. @type {Map<string, string>} */
  #seenShows = new Map();
  /** Whose run it is. @type {Pick<Checked, 'places' | 'shows' | 'variables'>} */
  #program = { places: [], shows: [], variables: [] };
  #wasStopped = false;
  /** What the run reads of a remote control; nothing of one that was judged. @type {string[]} */
  #remote = [];
  #note = '';
  #told = ''; // of the trace
  #shown_ms = 0; // when more than the robot was shown last
  #isReadingNext = false; // what is measured, not where the program is
  /** @type {Checked['places']} */
  #places = [];
  #stops = new Stops();
  /** @type {Checked['variables']} */
  #variables = [];
  #run = element('run', HTMLButtonElement);
  #pause = element('pause', HTMLButtonElement);
  #push = element('push', HTMLButtonElement);
  #why = element('why', HTMLButtonElement);
  #asksWhy = false; // somebody, of each place at which they look
  #world;
  #drawing;
  /** While a finger moves a part. @type {import('../world/parts.js').World | null} */
  #preview = null;
  #restored;

  /** @param {Page} page */
  constructor(page) {
    const { python, work, remember } = page;
    this.#page = page;
    this.#window = new RunsWindow({ python, runs: this.runs, see: (run) => this.#see(run), play: (opened, again) => this.#play(opened, again) });
    this.#world = new WorldChoice(python, work, () => this.#enter());
    this.#simulator = new Simulator(python, (state) => {
      if (state) this.#keep(state);
      const isSame = document.documentElement.dataset['phase'] === 'running' && this.#simulator.phase === 'running';
      if (state && isSame) this.#goOn(state);
      else this.#show();
    });
    this.#drawing = new WorldDrawing(python, this.#arena, {
      world: () => this.#shapes,
      choice: this.#world,
      robot: () => {
        const [x, y] = this.#simulator.state?.pose ?? [this.#shapes.start.x_cm, this.#shapes.start.y_cm];
        return [x, y];
      },
      isDriving: () => this.#isDriving,
      rest: () => {
        this.#rest();
        this.#choose('seen_arena');
      },
      put: (world, isOther) => {
        this.#preview = null;
        this.#world.putOwn(world, isOther);
        remember();
        this.#rest();
      },
      preview: (world) => {
        this.#preview = world;
        this.#rest();
      },
      tell: () => this.#show(),
    });
    this.#run.addEventListener('click', () => this.#start(false));
    this.#pause.addEventListener('click', (event) => {
      if (isSecondPress(event)) return; // it was pressed twice to pause
      this.#lookAtNow();
      if (this.#simulator.phase === 'paused') this.#simulator.goOn();
      else this.#pauseIt();
    });
    element('step', HTMLButtonElement).addEventListener('click', () => {
      this.#lookAtNow();
      if (this.#simulator.phase === 'running') this.#pauseIt();
      else if (this.#simulator.phase === 'paused') this.#simulator.step();
      else this.#start(true);
    });
    this.#push.addEventListener('click', () => {
      this.#lookAtNow();
      this.#simulator.push();
    });
    element('stop', HTMLButtonElement).addEventListener('click', () => this.stop());
    onEscapeKey(() => this.stop());
    const speed = element('speed', HTMLSelectElement);
    replaceOptions(speed, SPEEDS.map((each, k) => pictureOption(`× ${each}`, String(each), dialPicture(k / (SPEEDS.length - 1)))));
    speed.value = '1';
    speed.addEventListener('change', () => {
      this.#simulator.speed = Number(speed.value);
    });
    element('save_trace', HTMLButtonElement).addEventListener('click', () => {
      download(text('trace_name'), this.#simulator.trace.map((line) => `${line}\n`).join(''));
    });
    this.#why.addEventListener('click', () => {
      this.#asksWhy = !this.#asksWhy;
      this.#show();
    });
    for (const each of Object.keys(SEEN)) element(each, HTMLButtonElement).addEventListener('click', () => this.#choose(each));
    const sound = element('sound', HTMLButtonElement);
    const applySound = () => {
      this.#sounds.mute(!work.sound);
      sound.setAttribute('aria-pressed', String(work.sound));
    };
    sound.addEventListener('click', () => {
      work.sound = !work.sound;
      applySound();
      remember();
    });
    applySound();
    element('erase_ways', HTMLButtonElement).addEventListener('click', () => {
      this.#arena.eraseWays();
      this.#show();
    });
    pageState.ownRobot.subscribe(() => {
      if (pageState.language.value) this.#show();
    });
    new ResizeObserver(() => this.#showReadings()).observe(element('plot_place', HTMLElement));
    new ResizeObserver(() => {
      this.#arena.resize();
      this.#arena.draw(this.#state);
    }).observe(element('arena', HTMLCanvasElement));
    pageState.language.subscribe(() => this.#show());
    pageState.areWordsShown.subscribe(() => this.#show());
    pageState.robotName.subscribe(() => this.begin());
    pageState.breakpoints.subscribe(() => this.#breakpointsChanged());
    pageState.programText.subscribe(() => { // what runs is no longer what is seen
      this.#places = [];
      this.#show();
    });
    this.#stage = new Stage({
      look: (camera) => {
        this.#arena.camera = camera;
        this.#arena.resize();
        this.#arena.draw(this.#state);
      },
      stop: () => this.stop(),
    });
    this.begin();
    this.#restored = this.#restore();
  }

  get #shapes() {
    return this.#preview ?? this.#world.shapes;
  }

  /** Runs the program in a shipped world; resolves once the robot is on. @param {string} world */
  async run(world) {
    this.#world.choose(world);
    this.#enter();
    await this.#start(false);
  }

  /**
   * Shows the run of a lesson that was judged; resolves when it is over, or another one begins.
   * @param {import('../lesson/lessons.js').JudgedRun} run
   */
  async play(run) {
    const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches;
    await this.#start(false, run, isStill ? run.until_ms : run.until_ms / PLAYED_MS);
    if (this.#isDriving) await new Promise((resolve) => { this.#seenRun = () => resolve(undefined); });
  }

  /**
   * Runs a part of the program alone; resolves when it is over. A run of the whole program goes on.
   * @param {string} program
   * @param {boolean} isAsked whoever only touched a block wants the virtual robot to be seen already
   * @param {() => void} see has it seen
   */
  async tryAlone(program, isAsked, see) {
    const isSeen = element('arena', HTMLCanvasElement).checkVisibility();
    if ((this.#isDriving && !this.#isAlone) || this.#isWaiting || !(isSeen || isAsked)) return;
    if (!isSeen) see();
    const start = ++this.#starts;
    const request = { do: 'check', robot: pageState.robotName.value, language: pageState.language.value };
    const checked = /** @type {Checked} */ (await this.#page.python.ask(request, new TextEncoder().encode(program)));
    if (start !== this.#starts) return;
    if (!checked.image) {
      pageState.note.set(text('alone_wrong', { why: checked.findings.find(({ severity }) => severity === 'mistake')?.message ?? '' }));
      return;
    }
    await this.#start(false, null, 0, null, { text: program, checked });
    if (this.#isDriving) await new Promise((resolve) => { this.#seenRun = () => resolve(undefined); });
  }

  /** @param {number} hertz of a tone that somebody chooses */
  hear(hertz) {
    this.#sounds.begin();
    this.#sounds.beep(hertz, HEARD_S);
  }

  /** Nothing comes of the compiler, for which a run may wait. */
  waitOn() {
    if (!this.#isWaiting) return;
    this.#note = text('run_waits');
    this.#show();
  }

  /** Another program begins: with its robot at the start, on a floor without trails. */
  beginAnew() {
    this.#arena.eraseWays();
    this.begin();
  }

  /** What a lesson has brought goes. */
  leaveLesson() {
    if (!this.#world.isOfLesson) return;
    this.#world.choose(this.#page.work.world);
    this.#enter();
  }

  /** Another screen is seen. */
  leave() {
    this.stop();
    this.#drawing.end();
  }

  /** How the robot is, or was at the moment at which somebody looks. */
  get #state() {
    return this.#timeLine.seen ?? this.#simulator.state;
  }

  /** What is seen of which robot. */
  get #robotSeen() {
    return this.#timeLine.seen ? this.#timeLine.run.of.robot : pageState.robotName.value;
  }

  get #variablesSeen() {
    return this.#timeLine.seen ? this.#timeLine.run.program.variables : this.#variables;
  }

  get #placesSeen() {
    if (!this.#timeLine.seen || this.#timeLine.run === this.#newest) return this.#places;
    const { of, program } = this.#timeLine.run;
    return of.text === pageState.programText.value ? program.places : [];
  }

  /** Plays a run that is kept, with its own program. @param {Run} run */
  async playAgain(run) {
    await this.#window.openData(new TextEncoder().encode(await this.#window.fileOf(run)), '', run);
  }

  /** Shows a run that is kept, at its end; a real robot's is played first. @param {Run} run */
  async #see(run) {
    if (run.moments.length < 2 || !run.shapes) {
      await this.playAgain(run);
      return;
    }
    if (this.#simulator.phase === 'running') this.#pauseIt();
    this.#timeLine.begin(run);
    this.#drawWay(run);
    this.#timeLine.look(run.moments.last_ms);
  }

  /** @param {Run} run its world, and the way that it has taken */
  #drawWay(run) {
    this.#arena.begin(run.shapes ?? this.#world.shapes, run.of.robot, run === this.#newest ? this.#world.goals : []);
    for (const state of run.moments.all()) this.#arena.follow(state);
  }

  /** The file of the newest run that can be played again, or nothing. @returns {Promise<string>} */
  async newestRun() {
    const run = this.runs.all.find((each) => !each.isJudged && (each.file || each.rows.length));
    return run ? this.#window.fileOf(run) : '';
  }

  /** Opens the file of a run. @param {File} file */
  openRun(file) {
    return this.#window.open(file);
  }

  /** Plays a recorded run, which may be kept already. @param {import('./runs_window.js').Opened} opened @param {Run | null} again */
  async #play(opened, again) {
    await this.#simulator.stop();
    this.#page.put(opened);
    if (typeof opened.world === 'string') this.#world.choose(opened.world);
    else if (opened.world && opened.shapes) {
      this.#world.bring({ request: opened.world, shapes: opened.shapes, label: () => text('world_of_run'), goals: [] });
    }
    this.begin();
    this.#choose('seen_arena');
    const lasts_ms = Math.max(1, opened.rows.at(-1)?.[0] ?? 0);
    await this.#start(false, null, lasts_ms / PLAYED_MS, { opened, again });
  }

  /** What runs stands still while somebody looks back. */
  #lookBack() {
    if (this.#simulator.phase === 'running') this.#pauseIt();
    this.#arena.say('', 0);
    this.#seenShows = this.#keepShows(new Map(), this.#timeLine.shows);
    this.#show();
  }

  /** The newest moment is seen again. */
  #lookAtNow() {
    if (!this.#timeLine.seen) return;
    if (this.#newest && this.#timeLine.run !== this.#newest) {
      this.#timeLine.begin(this.#newest);
      this.#drawWay(this.#newest);
    }
    this.#timeLine.leave();
    this.#keepShows(this.#shown, this.#timeLine.shows);
    this.#show();
  }

  get #isDriving() {
    const { phase } = this.#simulator;
    return phase === 'running' || phase === 'paused';
  }

  /** Shows the robot from above, or its values, or what it has done. @param {string} chosen a button */
  #choose(chosen) {
    for (const [each, place] of Object.entries(SEEN)) {
      element(each, HTMLButtonElement).setAttribute('aria-pressed', String(each === chosen));
      element(place, HTMLElement).hidden = each !== chosen;
    }
    this.#show();
  }

  /** What the worker is asked for to have the world that is shown. */
  get world() {
    return this.#world.request;
  }

  /** Another world has been chosen. */
  #enter() {
    this.#page.remember();
    this.begin();
  }

  /**
   * Shows a world of a lesson.
   * @param {number} number
   * @param {number} seed
   * @param {() => string} label
   */
  async showLesson(number, seed, label) {
    const { world, goals } = await this.#page.python.ask({ do: 'lesson_world', number, seed });
    this.#world.bring({ request: { lesson: number, seed }, shapes: world, label, goals });
    this.begin();
    this.#choose('seen_arena');
  }

  /** Another robot or world: what drove there has ended. */
  begin() {
    this.#drawing.letGo();
    this.#preview = null;
    this.#rest();
    this.#stage?.rest();
    this.#drawing.forget();
  }

  #pauseIt() {
    this.#sounds.silence();
    this.#simulator.pause();
  }

  /** Stops, and switches off. */
  #rest() {
    this.stop();
    this.#simulator.leave();
    this.#plot.begin();
    this.#timeLine.begin();
    this.#variables = [];
    this.#arena.begin(this.#shapes, pageState.robotName.value, this.#world.goals);
    this.#show();
  }

  /** Brings the worlds back that were drawn here; none is drawn before, for it would take their place. */
  async #restore() {
    try {
      const isWhole = await this.#world.restoreOwn();
      if (this.#page.work.world !== OWN_WORLD) return;
      if (!isWhole) this.#note = text('world_lost');
      this.begin();
    } catch {
      // the page says that there is no compiler
    } finally {
      this.#drawing.allow();
    }
  }

  /** The program is to stop elsewhere. */
  #breakpointsChanged() {
    const before = this.#stops.offsets.join();
    this.#findStops();
    if (this.#stops.offsets.join() !== before) this.#simulator.setBreakpoints(this.#stops.offsets);
  }

  #findStops() {
    this.#stops.find(pageState.breakpoints.value, this.#places);
  }

  /**
   * @param {boolean} isPaused
   * @param {import('../lesson/lessons.js').JudgedRun | null} judged
   * @param {number} least times as quick as the robot
   * @param {{opened: import('./runs_window.js').Opened, again: Run | null} | null} played a recorded run
   * @param {{text: string, checked: Checked} | null} alone a part of the program
   */
  async #start(isPaused, judged = null, least = 0, played = null, alone = null) {
    this.#seenRun();
    const start = ++this.#starts;
    this.#drawing.said = '';
    let program = alone?.checked ?? pageState.checkResult.value;
    if (!program) {
      this.#isWaiting = true;
      this.#note = text(this.#page.python.isLate ? 'run_waits' : 'still_compiling');
      this.#show();
      program = await this.#page.whenCompiled();
      if (program) await this.#restored;
      if (start !== this.#starts) return;
      this.#isWaiting = false;
    }
    this.#note = !program ? text('no_compiler') : program.image ? '' : text('first_repair');
    this.#show();
    await this.#simulator.stop(); // also before a program with mistakes: what runs is not what is seen
    if (start !== this.#starts || !program?.image) return;
    this.#sounds.begin();
    this.#wasStopped = false;
    this.#bumps = 0;
    this.#canEarn = !judged && !played && !alone;
    this.#arena.begin(this.#world.shapes, pageState.robotName.value, this.#world.goals);
    this.#plot.begin();
    this.#shown.clear();
    this.#program = program;
    this.#isAlone = alone !== null;
    this.#places = alone ? [] : program.places; // which are those of another text
    this.#variables = program.variables;
    this.#findStops();
    this.#remote = judged || played ? [] : program.remote;
    const world = judged ?? this.#world.request;
    const run = this.#newest = this.#runOf(program, world, played, alone?.text);
    run.isJudged = judged !== null;
    this.#timeLine.begin(run);
    const stops = judged || played || alone ? [] : this.#stops.offsets;
    const begins = this.#simulator.begin(program, pageState.robotName.value, world, stops, isPaused, least, played !== null);
    if (!alone && !judged) this.#stage.begin(); // it sees nothing of the run before
    await begins;
  }

  /**
   * The run that begins, among those that are kept.
   * @param {Checked} program
   * @param {unknown} world
   * @param {{opened: import('./runs_window.js').Opened, again: Run | null} | null} played
   * @param {string} [whole] its text
   */
  #runOf(program, world, played, whole = pageState.programText.value) {
    const run = played?.again ?? new Run({ of: 'virtual', text: whole, robot: pageState.robotName.value, program: program.program, world }, program, null);
    if (played && !played.again) {
      run.of = { ...run.of, of: played.opened.of };
      run.file = played.opened.file;
    }
    run.shapes = this.#world.shapes;
    run.program = program;
    run.again();
    if (played) {
      run.markKeys(played.opened.rows);
      run.told = played.opened.rows;
    }
    if (!played?.again && !this.#isAlone) this.runs.begin(run);
    return run;
  }

  /** A world is solved: that is celebrated once a run, and its stars are kept. @param {number} stars */
  #earn(stars) {
    if (!stars || !this.#canEarn) return;
    this.#canEarn = false;
    const { request } = this.#world;
    if (typeof request === 'string') {
      if (!keepStars(worldStars(request), stars)) pageState.note.set(text('not_kept'));
      this.#world.showStars();
    }
    this.cheer();
    celebrate();
  }

  /** Its task is solved: it is glad, and that is heard. */
  cheer() {
    this.#arena.cheer();
    this.#sounds.cheer();
    this.#arena.draw(this.#state);
  }

  stop() {
    this.#starts += 1;
    if (this.#isWaiting) {
      this.#isWaiting = false;
      this.#note = '';
      this.#show();
    }
    this.#sounds.silence();
    if (!this.#isDriving) return;
    this.#lookAtNow();
    this.#wasStopped = true;
    this.#simulator.stop();
  }

  #show() {
    const { phase } = this.#simulator, state = this.#state;
    this.#showReadings();
    this.#arena.draw(state);
    document.documentElement.dataset['phase'] = phase;
    this.#offer();
    if (!this.#isDriving) this.#seenRun();
    this.#showPlaces(); // last: the editor has the page laid out, which is then done once
  }

  /** A run that reads a remote control can be driven. */
  #offer() {
    const canDrive = this.#isDriving && this.#remote.length > 0;
    this.#page.pad.offer('driving', canDrive ? { reads: this.#remote, tell: (held) => { this.#simulator.held = held; } } : null);
    if (!canDrive) this.#simulator.held = null;
  }

  /** A picture of a run: beside the robot, one thing at a time is new. @param {import('../python.js').RobotState} state */
  #goOn(state) {
    this.#arena.draw(state);
    if (performance.now() - this.#shown_ms < READ_MS / 2) return;
    if (this.#isReadingNext) this.#showReadings();
    else this.#showPlaces();
  }

  #showReadings() {
    const { phase, trace } = this.#simulator, state = this.#state;
    this.#shown_ms = performance.now();
    this.#isReadingNext = false;
    this.#pause.disabled = !this.#isDriving;
    say(this.#pause, text(phase === 'paused' ? 'go_on' : 'pause'));
    hide(this.#push, !state?.is_waiting || phase !== 'running');
    say(element('doing', HTMLElement), this.#note || this.#drawing.said || [pageState.ownRobot.value.name, this.#doing()].filter(Boolean).join(': '));
    const told = trace.slice(-SHOWN).join('\n');
    if (told !== this.#told) element('trace', HTMLElement).textContent = this.#told = told;
    this.#showScore(state?.score ?? null);
    this.#where.tell(state, phase);
    this.#showValues();
    hide(this.#why, !this.#timeLine.seen);
    this.#why.setAttribute('aria-pressed', String(this.#asksWhy));
    this.#plot.draw(state && this.#timeLine.seen ? state.now_ms - (state.began_ms ?? state.now_ms) : null);
    this.#timeLine.show();
  }

  /** Marks what runs, or where it had a fault. */
  #showPlaces() {
    const state = this.#state;
    this.#shown_ms = performance.now();
    this.#isReadingNext = true;
    const range = this.#place();
    const places = this.#placesSeen;
    const isAlone = !state || state.fault || state.is_held;
    const isOver = !this.#isDriving && !this.#timeLine.seen && !state?.fault; // also of one that was stopped before its end
    const ranges = isOver ? [] : isAlone ? [range] : state.places.map((at) => rangeAt(places, at));
    pageState.virtualRun.set({ ranges: ranges.filter((each) => each !== null), isHeld: Boolean(state?.is_held) });
    pageState.fault.set({ range: state?.fault ? range : null, sentence: state?.fault ? faultSentence(state.fault) : '' });
  }

  /** What runs in the text that is seen, or what had a fault. */
  #place() {
    const state = this.#state;
    return rangeAt(this.#placesSeen, state?.fault ? state.fault_at : state?.at);
  }

  /** Keeps what is to be seen, and lets be heard what is. @param {import('../python.js').RobotState} state */
  #keep(state) {
    this.#arena.follow(state);
    this.#newest?.add(state);
    this.runs.trim();
    if (state.bumps > this.#bumps) {
      this.#arena.shake();
      this.#sounds.crash();
    }
    this.#bumps = state.bumps;
    this.#earn(state.score?.stars ?? 0);
    for (const [at_ms, what] of state.events) {
      const [word, hertz, lasts_ms] = what.split(' ');
      if (word !== 'BEEP') continue;
      this.#arena.showBeep(at_ms, at_ms + Number(lasts_ms));
      this.#sounds.beep(Number(hertz), Number(lasts_ms) / 1000 / this.#simulator.speed);
    }
    if (state.began_ms === null) return;
    this.#keepShows(this.#shown, state.events);
    this.#plot.add(state.now_ms - state.began_ms, [
      ...devicesOf(pageState.robotName.value, 'sensor').map((device, k) => ({ name: deviceName(device), value: numberOf(state.readings[k]?.text) })),
      ...this.#variables.map(({ name, is_yes_no }, k) => ({ name, value: is_yes_no ? Number(Boolean(state.variables[k])) : state.variables[k] })),
      ...[...this.#shown].map(([name, value]) => ({ name, value: numberOf(value) })),
    ]);
  }

  /**
   * Keeps what has been shown, by its name, and says the last of it.
   * @param {Map<string, string>} shown
   * @param {[number, string, number][]} events
   */
  #keepShows(shown, events) {
    for (const [at_ms, what, at] of events) {
      if (!what.startsWith('SHOW ')) continue;
      const value = what.slice('SHOW '.length);
      const show = showAt(this.#timeLine.seen ? this.#timeLine.run.program : this.#program, at);
      shown.set(show ? nameOfShow(show, `SHOW(${show[1]})`, true) : 'SHOW', value);
      this.#arena.say(value, at_ms);
    }
    return shown;
  }

  #doing() {
    const { phase, state, isStopping, failure } = this.#simulator;
    if (failure) return failure;
    if (isStopping) return text('robot_stopping');
    const { parting } = this.#timeLine.run;
    const partsHere = parting && (this.#timeLine.seen ? parting.at_ms !== null && Math.abs(this.#timeLine.seen.now_ms - parting.at_ms) < NEAR_MS : phase === 'ended');
    if (parting && partsHere) return partingSaid(parting);
    if (this.#timeLine.seen) return this.#lookedBack(this.#timeLine.seen);
    if (phase === 'off' || !state) return this.#task() || text('robot_off');
    if (state.fault) {
      const what = faultSentence(state.fault);
      const line = this.#place()?.line;
      return line ? text('say_fault', { line, what }) : text('robot_fault', { what });
    }
    if (this.#wasStopped) return text('robot_stopped');
    const ended = state.score && howEnded(state.score);
    if (ended) return ended;
    const held = state.is_held && this.#place()?.line;
    if (phase === 'paused' && held) return text('robot_held', { line: held });
    if (phase === 'paused') return text('robot_paused');
    if (phase === 'ended') return text('robot_ended');
    return text(state.is_waiting ? 'robot_waiting' : 'robot_running');
  }

  /** What ran at a moment, and the values of what it names. @param {import('../python.js').RobotState} state */
  #lookedBack(state) {
    const seconds = secondsOf(state), range = this.#place();
    const why = this.#asksWhy ? [this.#whySaid(state)] : [];
    if (!range) return [text('looked_back', { seconds }), ...why].join('   ');
    const { line, column, end_column } = range;
    const part = (pageState.programText.value.split('\n')[line - 1] ?? '').slice(column - 1, end_column - 1).trim();
    const names = new Set(part.toUpperCase().match(/\w+/g));
    const values = this.#valuesOf(state).filter(([name]) => names.has(name)).map(([name, value]) => `${name} ${value}`);
    return [text('looked_back_at', { seconds, line, part }), ...values, ...why].join('   ');
  }

  /** Why it was there: what was asked, with the values that the program had read, and whose motors they were. @param {RobotState} state */
  #whySaid(state) {
    const { run } = this.#timeLine, { places, variables } = run.program;
    const at = state.fault ? state.fault_at : state.at;
    if (at === null) return text('why_nothing');
    const values = new Map(variables.map(({ name, is_yes_no }, k) => [name, variableText(state.variables[k], is_yes_no)]));
    const asked = conditionsAt(run.of.text, places, at, (name) => run.readAt(name, state.now_ms) ?? values.get(name));
    const said = asked.map(({ line, condition, values: with_values, is }) => text(is === null ? 'why_asks' : is ? 'why_yes' : 'why_no', { line, condition, values: with_values }));
    const { driver } = state, tasks = blocksOf(run.of.text, places, /^(?:TASK|WHEN)\b/i);
    const task = driver === null ? undefined : tasks.find(({ has }) => has(driver));
    if (driver !== null && tasks.length) said.push(task ? text('why_task', { line: task.line }) : text('why_main'));
    return said.join(' ') || text('why_nothing');
  }

  /** @param {import('../python.js').RobotState} state @returns {[string, string][]} the value of each sensor and variable, by its name */
  #valuesOf(state) {
    return [
      ...devicesOf(this.#robotSeen, 'sensor').map(({ text: name }, k) => /** @type {[string, string]} */ ([name, state.readings[k]?.text ?? ''])),
      ...this.#variablesSeen.map(({ name, is_yes_no }, k) => /** @type {[string, string]} */ ([name, variableText(state.variables[k], is_yes_no)])),
    ];
  }

  /** What is to be done in this world, if there is such a thing. */
  #task() {
    const { flags, seconds, rings, rivals } = this.#shapes;
    if (rings.length && rivals.length && !flags.length) return text(seconds ? 'task_sumo_in_time' : 'task_sumo', { seconds });
    if (!flags.length) return '';
    return text(seconds ? 'task_in_time' : 'task', { count: flags.length, seconds });
  }

  /** @param {import('../python.js').RobotState['score']} score */
  #showScore(score) {
    const place = element('score', HTMLElement);
    hide(place, !score);
    if (!score) return;
    const { taken, of, pushed, rivals, points, stars } = score;
    const done = [of && `⚑ ${taken}/${of}`, rivals && `⇥ ${pushed}/${rivals}`].filter(Boolean).join('  ');
    say(place, `${done}   ${points}   ${starsShown(stars)}`);
    place.classList.toggle('whole', stars > 0);
  }

  #showValues() {
    const state = this.#state;
    const rows = [
      [text('time'), state ? `${secondsOf(state)} s` : '–'],
      [text('motors'), state ? state.motors.map((power) => `${power} %`).join('  ') : '–'],
      [text('bumps'), state ? String(state.bumps) : '–'],
      ...devicesOf(this.#robotSeen, 'sensor').map((device, k) => [deviceName(device), state ? readingText(device, state.readings[k]?.text ?? '') : '–', percentOfRange(device, state?.readings[k]?.value)]),
      ...this.#variablesSeen.map(({ name, is_yes_no }, k) => [name, variableText(state?.variables[k], is_yes_no)]),
      ...(this.#timeLine.seen ? this.#seenShows : this.#shown),
    ];
    showRows(element('values', HTMLElement), rows);
  }
}

/** Where a recorded run and the one that was played part, in words. @param {import('../python.js').Parting} parting */
function partingSaid({ what, agreed, line, robot, virtual, sensor, began_ms }) {
  /** @param {{ms: number, event: string} | null} row */
  const told = (row) => row ? text('record_at', { what: row.event.replace(/^SHOW /, ''), seconds: ((row.ms - began_ms) / 1000).toFixed(1) }) : text('record_nothing');
  const place = line ? text('line', { line }) : text('record_end');
  return text(textKey(`record_${what}`), { count: agreed, line, place, robot: told(robot), virtual: told(virtual), sensor });
}

/** How long the program has run. @param {import('../python.js').RobotState} state */
function secondsOf({ now_ms, began_ms }) {
  return ((now_ms - (began_ms ?? now_ms)) / 1000).toFixed(1);
}
