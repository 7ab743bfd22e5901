// Records what a robot tells of a run, saves it, and compares it with the virtual robot.
//
// The form of a recording is that of `recordings.py`, which reads it.

import { element, hide } from '../page/elements.js';
import { bugSaid } from '../page/faults.js';
import { bytesOf, download, whenChosen } from '../page/files.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage, known, text } from '../page/texts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */
/** @typedef {{ms: number, event: string}} Recorded */

const VERSION = 1;
const MOST = 10_000; // events; then it is over
const MOST_MS = 600_000;

export class Recorder {
  #page;
  #said = () => ''; // so that it can be said in another language
  #program = '';
  /** When what is recorded began; null until the first event of a run by the robot's button. @type {number | null} */
  #began = null;
  #isOver = true;
  /** @type {Recorded[]} */
  #events = [];
  #save = element('record_save', HTMLButtonElement);
  #compare = element('record_compare', HTMLButtonElement);

  /**
   * @param {{python: import('../python.js').Python, world: () => unknown}} page
   */
  constructor(page) {
    this.#page = page;
    this.#save.addEventListener('click', () => download(text('record_name'), this.#whole()));
    this.#compare.addEventListener('click', () => this.#replay(new TextEncoder().encode(this.#whole())));
    element('record_open', HTMLButtonElement).addEventListener('click', () => element('record_file', HTMLInputElement).click());
    whenChosen('record_file', async (chosen) => {
      try {
        this.#replay(await bytesOf(chosen));
      } catch {
        this.#tell(() => text('unreadable'));
      }
    });
    pageState.language.subscribe(() => this.#say());
    pageState.checked.subscribe((program) => hide(element('record_keys', HTMLElement), !program?.remote.length));
    this.#show();
  }

  #say() {
    element('record_said', HTMLElement).textContent = this.#said();
  }

  /** @param {() => string} said */
  #tell(said) {
    this.#said = said;
    this.#say();
  }

  /** A program waits for the robot's button: no robot tells when it begins. @param {string} program its checksum, in hexadecimal */
  wait(program) {
    this.#record(program, null);
  }

  /** The recording is over, if there is one. @param {string} event the last one */
  end(event) {
    if (this.#isOver) return;
    this.#events.push({ ms: Math.min(this.#ms, MOST_MS), event });
    this.#isOver = true;
    this.#show();
  }

  /** @param {RobotEvent} event */
  onEvent(event) {
    if (event.event === 'STARTED') {
      if (event.is_program && event.program) this.#record(event.program, performance.now());
      else this.end('STOPPED');
    }
    const row = { SHOW: `SHOW ${event.value}`, DONE: 'DONE', FAULT: `FAULT ${event.fault}`, STOPPED: 'STOPPED', RESTARTED: 'LOST', LOST: 'LOST', MISSED: 'MISSED' }[event.event];
    if (!row || this.#isOver) return;
    this.#began ??= performance.now();
    if (event.event !== 'SHOW') this.end(row);
    else if (this.#events.length >= MOST || this.#ms > MOST_MS) this.end('STOPPED');
    else this.#events.push({ ms: this.#ms, event: row });
    this.#show();
  }

  /**
   * @param {string} program
   * @param {number | null} began
   */
  #record(program, began) {
    this.#program = program;
    this.#began = began;
    this.#events = [];
    this.#isOver = false;
    this.#show();
  }

  get #ms() {
    return this.#began === null ? 0 : Math.round(performance.now() - this.#began);
  }

  /** The file; of a run that goes on, what there is. */
  #whole() {
    const head = { tiniscript_recording: VERSION, program: this.#program, robot: pageState.robotName.value };
    const end = this.#isOver ? [] : [{ ms: Math.min(this.#ms, MOST_MS), event: 'STOPPED' }];
    return [head, ...this.#events, ...end].map((row) => `${JSON.stringify(row)}\n`).join('');
  }

  #show() {
    this.#save.disabled = this.#compare.disabled = !this.#events.length;
  }

  /** @param {Uint8Array} data a recording */
  async #replay(data) {
    this.#tell(() => text('record_comparing'));
    const { python, world } = this.#page;
    try {
      const request = { do: 'replay', robot: pageState.robotName.value, world: world(), text: pageState.programText.value, language: currentLanguage() };
      const answer = await python.ask(request, data);
      this.#tell(() => said(answer));
    } catch (why) {
      this.#tell(() => bugSaid(why));
    }
  }
}

/** @param {{what: string, said?: string, agreed?: number, line: number, robot?: Recorded | null, virtual?: Recorded | null}} found */
function said({ what, said = '', agreed = 0, line, robot, virtual }) {
  if (what === 'refused') return said;
  const place = line ? text('line', { line }) : text('record_end');
  return text(known(`record_${what}`), { count: agreed, line, place, robot: told(robot), virtual: told(virtual) });
}

/** @param {Recorded | null | undefined} event */
function told(event) {
  if (!event) return '';
  const seconds = (event.ms / 1000).toFixed(1);
  const what = event.event.startsWith('SHOW ') ? event.event.slice('SHOW '.length) : event.event;
  return text('record_at', { what, seconds });
}
