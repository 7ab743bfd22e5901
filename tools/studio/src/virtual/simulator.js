// Runs a program on the virtual robot in the worker: the time, and what is shown of the robot.
//
// The robot's time goes on only by what this page asks for, so a page that sleeps stands still.

import { bugSentence } from '../page/faults.js';
import { currentLanguage } from '../page/texts.js';

/** @import { Python, CheckResult, RobotState } from '../python.js' */
/** @import { HeldControls } from '../remote/held.js' */
/** @typedef {'off' | 'running' | 'paused' | 'ended'} Phase */

const MAX_REQUEST_MS = 400; // of the robot's time that is asked for at once: a stop waits for no more
const MAX_FRAME_MS = 100; // of this computer's time at most for one picture
const STEP_LIMIT_MS = 60_000;
const MAX_TRACE_LINES = 5000; // lines of the trace

export class Simulator {
  #python;
  #onChange;
  /** @type {Phase} */
  phase = 'off';
  /** @type {RobotState | null} */
  state = null;
  /** @type {string[]} */
  trace = [];
  speed = 1;
  /** What somebody holds of a remote control, where the program reads one. @type {HeldControls | null} */
  heldControls = null;
  #leastSpeed = 0;
  failure = ''; // a mistake of ours

  /** Times as quick as the robot, as what runs is shown. */
  get shownSpeed() {
    return Math.max(this.#leastSpeed, this.speed);
  }

  #isAsking = false;
  isStopping = false; // it has not confirmed it yet
  #unasked_ms = 0; // of a millisecond that is not asked for yet
  #lastFrame_ms = 0;
  #leftRunCount = 0; // runs that were left
  #frameRequest = 0; // picture of the browser, for which it waits
  /** @type {Promise<void> | null} */
  #stopRequest = null; // when the last stop is confirmed

  /**
   * @param {Python} python
   * @param {(state?: RobotState) => void} onChange what shows how it is, and its newest state
   */
  constructor(python, onChange) {
    this.#python = python;
    this.#onChange = onChange;
  }

  /**
   * Switches the robot on at the start of its world, with the program.
   * @param {CheckResult} program
   * @param {string} robotName
   * @param {unknown} worldRequest
   * @param {number[]} breakpoints offsets in its code
   * @param {boolean} isPaused in front of its first part
   * @param {number} leastSpeed times as quick as the robot, whatever `speed` is
   * @param {boolean} isReplay the recorded run that was opened last
   * @param {RobotState['pose'] | null} pose where it begins, if it has room there
   */
  async begin(program, robotName, worldRequest, breakpoints = [], isPaused = false, leastSpeed = 0, isReplay = false, pose = null) {
    if (this.#isAsking) return;
    this.#leastSpeed = leastSpeed;
    const bytes = program.image.match(/../g)?.map((pair) => parseInt(pair, 16)) ?? [];
    const partOffsets = program.places.map(([offset]) => offset);
    const variableCount = program.variables.length;
    this.trace = [];
    this.state = null;
    this.failure = '';
    this.phase = isPaused ? 'paused' : 'running';
    this.#unasked_ms = 0;
    this.#lastFrame_ms = performance.now();
    const request = { do: 'power_on', robot: robotName, world: worldRequest, language: currentLanguage(), parts: partOffsets, breakpoints, variables: variableCount, is_held: isPaused, plays: isReplay, pose };
    await this.#ask(request, new Uint8Array(bytes));
    if (this.phase === 'running') this.#requestFrame();
  }

  pause() {
    if (this.phase === 'running') this.phase = 'paused';
    this.#onChange();
  }

  async resume() {
    if (this.phase !== 'paused') return;
    this.phase = 'running';
    if (this.state?.is_held) await this.#ask({ do: 'go_on' });
    if (this.phase !== 'running') return;
    this.#lastFrame_ms = performance.now();
    this.#onChange();
    this.#requestFrame();
  }

  /** Lets the robot go on until another part of the program is next. */
  async step() {
    if (this.phase !== 'paused' || this.#isAsking) return;
    const until_ms = (this.state?.now_ms ?? 0) + STEP_LIMIT_MS;
    do {
      await this.#advance({ do: 'step', limit_ms: MAX_REQUEST_MS });
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

  async pressButton() {
    if (this.state) await this.#ask({ do: 'push' }); // after what is under way
  }

  /** Stops the robot over its link; it confirms. Requests that are under way come before. */
  async stop() {
    if ((this.phase === 'running' || this.phase === 'paused') && !this.isStopping) {
      this.isStopping = true;
      this.phase = 'ended';
      this.#onChange();
      this.#stopRequest = this.#ask({ do: 'stop' });
    }
    await this.#stopRequest;
  }

  /** Nothing of the run is seen any more, nor what it answers later. It was stopped. */
  leaveRun() {
    this.#leftRunCount += 1;
    this.phase = 'off';
    this.state = null;
    this.trace = [];
    this.failure = '';
  }

  /** There is one row of pictures, whichever run or pause has begun it. */
  #requestFrame() {
    cancelAnimationFrame(this.#frameRequest);
    this.#frameRequest = requestAnimationFrame((now_ms) => this.#onFrame(now_ms));
  }

  /** @param {number} now_ms */
  async #onFrame(now_ms) {
    if (this.phase !== 'running') return;
    if (!this.#isAsking) {
      this.#unasked_ms += Math.min(MAX_FRAME_MS, now_ms - this.#lastFrame_ms) * this.shownSpeed;
      this.#lastFrame_ms = now_ms;
      const duration_ms = Math.min(MAX_REQUEST_MS, Math.floor(this.#unasked_ms));
      if (duration_ms > 0) {
        this.#unasked_ms = Math.min(this.#unasked_ms - duration_ms, MAX_REQUEST_MS);
        await this.#advance({ do: 'go', duration_ms });
      }
    }
    this.#requestFrame();
  }

  /** Lets the robot's time go on, for less than what is held counts. @param {Record<string, unknown>} request */
  #advance(request) {
    return this.#ask(this.heldControls ? { ...request, held: [this.heldControls.keys, this.heldControls.x, this.heldControls.y] } : request);
  }

  /**
   * @param {Record<string, unknown>} request
   * @param {Uint8Array} [data]
   */
  async #ask(request, data) {
    const leftRunCount = this.#leftRunCount;
    this.#isAsking = true;
    try {
      const answer = await this.#python.ask(request, data);
      if (request['do'] === 'stop') this.isStopping = false;
      if (leftRunCount !== this.#leftRunCount) this.#onChange();
      else if (answer.refused) this.#showRefusal(answer.refused);
      else this.#takeState(answer);
    } catch (error) {
      this.phase = 'off';
      this.isStopping = false;
      this.failure = bugSentence(error);
      this.#onChange();
    } finally {
      this.#isAsking = false;
    }
  }

  /** @param {string[]} reasons the robot cannot be in that world */
  #showRefusal(reasons) {
    this.phase = 'off';
    this.failure = reasons.join(' ');
    this.#onChange();
  }

  /** @param {RobotState} state */
  #takeState(state) {
    this.state = state;
    for (const [event_ms, event] of state.events) {
      if (event === 'START') this.trace = [];
      else this.trace.push(`${event_ms - (state.began_ms ?? 0)} ${event}`);
    }
    if (this.trace.length > MAX_TRACE_LINES) this.trace.splice(0, this.trace.length - MAX_TRACE_LINES);
    const isDriving = this.phase === 'running' || this.phase === 'paused';
    if (isDriving && this.#hasEnded(state)) this.phase = 'ended';
    if (this.phase === 'running' && state.is_held) this.phase = 'paused';
    this.#onChange(state);
  }

  /** @param {RobotState} state */
  #hasEnded(state) {
    return state.is_over ?? (state.began_ms !== null && !state.is_running);
  }
}
