// Runs a program on the virtual robot in the worker: the time, and what is shown of the robot.
//
// The robot's time goes on only by what this page asks for, so a page that sleeps stands still.

import { bugSentence } from '../page/faults.js';
import { currentLanguage } from '../page/texts.js';

/** @import { Python, Checked, RobotState } from '../python.js' */
/** @import { Held } from '../remote/held.js' */
/** @typedef {'off' | 'running' | 'paused' | 'ended'} Phase */

const MOST_MS = 400; // of the robot's time that is asked for at once: a stop waits for no more
const LOOKED_MS = 100; // of this computer's time at most for one picture
const STEP_LIMIT_MS = 60_000;
const KEPT = 5000; // lines of the trace

export class Simulator {
  #python;
  #shown;
  /** @type {Phase} */
  phase = 'off';
  /** @type {RobotState | null} */
  state = null;
  /** @type {string[]} */
  trace = [];
  speed = 1;
  /** What somebody holds of a remote control, where the program reads one. @type {Held | null} */
  held = null;
  #least = 0;
  failure = ''; // a mistake of ours
  #isAsking = false;
  isStopping = false; // it has not confirmed it yet
  #rest = 0; // of a millisecond that is not asked for yet
  #last = 0;
  #left = 0; // runs that were left
  #next = 0; // picture of the browser, for which it waits
  /** @type {Promise<void> | null} */
  #stopped = null; // when the last stop is confirmed

  /**
   * @param {Python} python
   * @param {(state?: RobotState) => void} shown what shows how it is, and its newest state
   */
  constructor(python, shown) {
    this.#python = python;
    this.#shown = shown;
  }

  /**
   * Switches the robot on at the start of its world, with the program.
   * @param {Checked} program
   * @param {string} robot
   * @param {unknown} world
   * @param {number[]} breakpoints offsets in its code
   * @param {boolean} isPaused in front of its first part
   * @param {number} least times as quick as the robot, whatever `speed` is
   * @param {boolean} plays the recorded run that was opened last
   */
  async begin(program, robot, world, breakpoints = [], isPaused = false, least = 0, plays = false) {
    if (this.#isAsking) return;
    this.#least = least;
    const bytes = program.image.match(/../g)?.map((pair) => parseInt(pair, 16)) ?? [];
    const parts = program.places.map(([offset]) => offset);
    const variables = program.variables.length;
    this.trace = [];
    this.state = null;
    this.failure = '';
    this.phase = isPaused ? 'paused' : 'running';
    this.#rest = 0;
    this.#last = performance.now();
    const request = { do: 'power_on', robot, world, language: currentLanguage(), parts, breakpoints, variables, is_held: isPaused, plays };
    await this.#ask(request, new Uint8Array(bytes));
    if (this.phase === 'running') this.#goOnWithNext();
  }

  pause() {
    if (this.phase === 'running') this.phase = 'paused';
    this.#shown();
  }

  async goOn() {
    if (this.phase !== 'paused') return;
    this.phase = 'running';
    if (this.state?.is_held) await this.#ask({ do: 'go_on' });
    if (this.phase !== 'running') return;
    this.#last = performance.now();
    this.#shown();
    this.#goOnWithNext();
  }

  /** Lets the robot go on until another part of the program is next. */
  async step() {
    if (this.phase !== 'paused' || this.#isAsking) return;
    const until_ms = (this.state?.now_ms ?? 0) + STEP_LIMIT_MS;
    do {
      await this.#drive({ do: 'step', limit_ms: MOST_MS });
    } while (
      this.phase === 'paused' &&
      this.state?.is_running &&
      !this.state.is_held &&
      this.state.now_ms < until_ms
    );
  }

  /** @param {number[]} breakpoints offsets in its code, from now on */
  async setBreakpoints(breakpoints) {
    if (this.phase === 'running' || this.phase === 'paused') await this.#ask({ do: 'breakpoints', breakpoints });
  }

  async push() {
    if (this.state) await this.#ask({ do: 'push' }); // after what is under way
  }

  /** Stops the robot over its link; it confirms. Requests that are under way come before. */
  async stop() {
    if ((this.phase === 'running' || this.phase === 'paused') && !this.isStopping) {
      this.isStopping = true;
      this.phase = 'ended';
      this.#shown();
      this.#stopped = this.#ask({ do: 'stop' });
    }
    await this.#stopped;
  }

  /** Nothing of the run is seen any more, nor what it answers later. It was stopped. */
  leave() {
    this.#left += 1;
    this.phase = 'off';
    this.state = null;
    this.trace = [];
  }

  /** There is one row of pictures, whichever run or pause has begun it. */
  #goOnWithNext() {
    cancelAnimationFrame(this.#next);
    this.#next = requestAnimationFrame((now) => this.#frame(now));
  }

  /** @param {number} now */
  async #frame(now) {
    if (this.phase !== 'running') return;
    if (!this.#isAsking) {
      this.#rest += Math.min(LOOKED_MS, now - this.#last) * Math.max(this.#least, this.speed);
      this.#last = now;
      const whole = Math.min(MOST_MS, Math.floor(this.#rest));
      if (whole > 0) {
        this.#rest = Math.min(this.#rest - whole, MOST_MS);
        await this.#drive({ do: 'go', duration_ms: whole });
      }
    }
    this.#goOnWithNext();
  }

  /** Lets the robot's time go on, for less than what is held counts. @param {Record<string, unknown>} request */
  #drive(request) {
    return this.#ask(this.held ? { ...request, held: [this.held.keys, this.held.x, this.held.y] } : request);
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {Uint8Array} [data]
   */
  async #ask(request, data) {
    const left = this.#left;
    this.#isAsking = true;
    try {
      const answer = await this.#python.ask(request, data);
      if (request['do'] === 'stop') this.isStopping = false;
      if (left !== this.#left) this.#shown();
      else if (answer.refused) this.#refuse(answer.refused);
      else this.#take(answer);
    } catch (why) {
      this.phase = 'off';
      this.isStopping = false;
      this.failure = bugSentence(why);
      this.#shown();
    } finally {
      this.#isAsking = false;
    }
  }

  /** @param {string[]} why the robot cannot be in that world */
  #refuse(why) {
    this.phase = 'off';
    this.failure = why.join(' ');
    this.#shown();
  }

  /** @param {RobotState} state */
  #take(state) {
    this.state = state;
    for (const [time, what] of state.events) {
      if (what === 'START') this.trace = [];
      else this.trace.push(`${time - (state.began_ms ?? 0)} ${what}`);
    }
    if (this.trace.length > KEPT) this.trace.splice(0, this.trace.length - KEPT);
    const goesOn = this.phase === 'running' || this.phase === 'paused';
    if (goesOn && this.#hasEnded(state)) this.phase = 'ended';
    if (this.phase === 'running' && state.is_held) this.phase = 'paused';
    this.#shown(state);
  }

  /** @param {RobotState} state */
  #hasEnded(state) {
    return state.is_over ?? (state.began_ms !== null && !state.is_running);
  }
}
