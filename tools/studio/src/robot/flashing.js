// The part of the page that puts a firmware on a board: which file, how far it is, and its end.

import { element, hide } from '../page/elements.js';
import { chosenPort, hasSerial } from './serial.js';
import { shown } from './plain_text.js';
import { Failed } from './transport.js';
import { watched } from '../page/progress.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage } from '../page/texts.js';

/**
 * @typedef {object} Panel what is used of the part with a robot
 * @property {import('./speech.js').Speech} speech
 * @property {() => any} port the known one that is chosen, if one is
 * @property {() => boolean} isFree
 * @property {(isBusy: boolean) => void} setBusy
 * @property {(port: any) => Promise<void>} meet the robot that the board is then
 */

/** What people call the boards that can be written from here. @type {Record<string, string>} */
const NAMES = { uno: 'Uno', nano: 'Nano', esp32dev: 'ESP32', esp32c3: 'ESP32-C3' };

export class Flashing {
  #panel;
  /** A firmware that a person has opened. @type {File | null} */
  #file = null;
  #chooser = element('flash_file', HTMLInputElement);
  /** What there is beside the page. @type {Promise<import('./flash.js').Firmware[]> | null} */
  #known = null;
  #boards = element('flash_board', HTMLSelectElement);
  #halts = element('flash_halts', HTMLInputElement);
  #bar = element('flash_progress', HTMLProgressElement);
  #cancel = element('flash_cancel', HTMLButtonElement);
  #cancelling = new AbortController();

  /** @param {Panel} panel */
  constructor(panel) {
    this.#panel = panel;
    element('link_teacher', HTMLDetailsElement).addEventListener('toggle', () => this.#offer());
    this.#boards.addEventListener('change', () => this.#offer());
    pageState.robotName.subscribe(() => this.#known && this.#offer());
    element('flash_write', HTMLButtonElement).addEventListener('click', () => this.#flash());
    element('flash_open', HTMLButtonElement).addEventListener('click', () => this.#chooser.click());
    this.#cancel.addEventListener('click', () => this.#cancelling.abort());
    this.#chooser.addEventListener('change', () => {
      this.#file = this.#chooser.files?.[0] ?? null;
      panel.speech.say('say_file', { name: shown(this.#file?.name ?? '') });
    });
  }

  /** A page without firmware, or a browser without ports, offers nothing. */
  async #offer() {
    if (!hasSerial) return;
    const list = await (this.#known ??= listed());
    const there = new Set(list.map((each) => each.board));
    if (!this.#boards.options.length) {
      this.#boards.replaceChildren(...Object.entries(NAMES).filter(([board]) => there.has(board)).map(([board, name]) => new Option(name, board)));
    }
    element('flash', HTMLElement).hidden = !this.#boards.options.length;
    const canHalt = (await this.#haltingBoards()).includes(this.#boards.value);
    hide(element('flash_halting', HTMLElement), !canHalt);
    this.#halts.checked &&= canHalt;
  }

  /** The boards for which there is a firmware of the robot with breakpoints in the place of its reader of text. */
  async #haltingBoards() {
    if (!hasSerial) return [];
    const { haltingTitle } = await import('./flash.js');
    const title = haltingTitle(pageState.robotName.value);
    return (await (this.#known ??= listed())).filter((each) => each.title === title).map(({ board }) => board);
  }

  /** Whether a board can get a firmware with breakpoints from here. */
  async canHalt() {
    return (await this.#haltingBoards()).length > 0;
  }

  /** Somebody wants that firmware: whether it is written is the next question. */
  async offerHalting() {
    await this.#offer();
    const boards = await this.#haltingBoards();
    if (!boards.includes(this.#boards.value)) this.#boards.value = boards[0] ?? '';
    this.#halts.checked = true;
    element('link_teacher', HTMLDetailsElement).open = true;
    await this.#offer();
    element('flash_write', HTMLButtonElement).focus();
  }

  async #flash() {
    const { speech, port: known, isFree, setBusy, meet } = this.#panel;
    if (!isFree()) return;
    const which = this.#file ?? { robot: pageState.robotName.value, language: currentLanguage(), halts: this.#halts.checked };
    const chosen = known() ? Promise.resolve(known()) : chosenPort();
    this.#cancelling = new AbortController();
    const board = this.#boards.value;
    const { signal } = this.#cancelling;
    setBusy(true);
    try {
      const port = await chosen;
      speech.say('say_fetching');
      this.#bar.value = 0;
      this.#bar.hidden = this.#cancel.hidden = false;
      const watching = { waits: () => speech.say('say_fetching_waits'), cancelled: signal };
      const { firmwareOf, flashBoard, writerOf } = await watched(import('./flash.js'), watching);
      const data = await firmwareOf(which, board, watching);
      await watched(writerOf(board), watching);
      speech.say('say_flashing');
      await flashBoard(port, board, data, (part) => { this.#bar.value = part; }, signal);
      setBusy(false);
      this.#cancel.hidden = true;
      await meet(port);
    } catch (why) {
      const reason = signal.aborted ? 'flash_not_begun' : /** @type {Error} */ (why).name === 'TimeoutError' ? 'flash_held' : 'bug';
      speech.fail(why instanceof Failed ? why : new Failed(reason, reason === 'bug' ? String(why) : ''));
    } finally {
      this.#bar.hidden = this.#cancel.hidden = true;
      this.#file = null;
      this.#chooser.value = '';
      setBusy(false);
    }
  }
}

/** What firmware there is beside the page; a page by itself has none. */
async function listed() {
  try {
    const { firmwares } = await import('./flash.js');
    return await firmwares();
  } catch {
    return [];
  }
}
