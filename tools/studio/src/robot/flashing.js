// The part of the page that puts a firmware on a board: which file, how far it is, and its end.

import { element } from '../page/elements.js';
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
  #bar = element('flash_progress', HTMLProgressElement);
  #cancel = element('flash_cancel', HTMLButtonElement);
  #cancelling = new AbortController();

  /** @param {Panel} panel */
  constructor(panel) {
    this.#panel = panel;
    element('link_teacher', HTMLDetailsElement).addEventListener('toggle', () => this.#offer());
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
    const place = element('flash', HTMLElement), boards = element('flash_board', HTMLSelectElement);
    if (!hasSerial || boards.options.length) return;
    try {
      const { firmwares } = await import('./flash.js');
      const there = new Set((await firmwares()).map((each) => each.board));
      boards.replaceChildren(...Object.entries(NAMES).filter(([board]) => there.has(board)).map(([board, name]) => new Option(name, board)));
    } catch {
      // no list of firmware: a page by itself
    }
    place.hidden = !boards.options.length;
  }

  async #flash() {
    const { speech, port: known, isFree, setBusy, meet } = this.#panel;
    if (!isFree()) return;
    const which = this.#file ?? { robot: pageState.robotName.value, language: currentLanguage() };
    const chosen = known() ? Promise.resolve(known()) : chosenPort();
    this.#cancelling = new AbortController();
    const board = element('flash_board', HTMLSelectElement).value;
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
