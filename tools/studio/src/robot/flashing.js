// The part of the page that puts a firmware on a board: which file, how far it is, and its end.

import { element, setHidden } from '../page/elements.js';
import { choosePort, hasSerial } from './serial.js';
import { asPlainText } from './plain_text.js';
import { ConnectionFailure } from './transport.js';
import { watchPromise } from '../page/progress.js';
import { pageState } from '../page/page_state.js';
import { currentLanguage } from '../page/texts.js';

/**
 * @typedef {object} Panel what is used of the part with a robot
 * @property {import('./speech.js').Speech} speech
 * @property {() => any} getChosenPort the known one that is chosen, if one is
 * @property {() => boolean} isFree
 * @property {(isBusy: boolean) => void} setBusy
 * @property {(port: any) => Promise<void>} connect to the robot that the board is then
 */

/** What people call the boards that can be written from here. @type {Record<string, string>} */
const BOARD_NAMES = { uno: 'Uno', nano: 'Nano', esp32dev: 'ESP32', esp32c3: 'ESP32-C3' };

export class Flashing {
  #panel;
  /** A firmware that a person has opened. @type {File | null} */
  #file = null;
  #fileInput = element('flash_file', HTMLInputElement);
  /** What there is beside the page. @type {Promise<import('./flash.js').Firmware[]> | null} */
  #firmwareList = null;
  #boardSelect = element('flash_board', HTMLSelectElement);
  #haltsInput = element('flash_halts', HTMLInputElement);
  #progressBar = element('flash_progress', HTMLProgressElement);
  #cancelButton = element('flash_cancel', HTMLButtonElement);
  #abortController = new AbortController();

  /** @param {Panel} panel */
  constructor(panel) {
    this.#panel = panel;
    element('link_teacher', HTMLDetailsElement).addEventListener('toggle', () => this.#offerBoards());
    this.#boardSelect.addEventListener('change', () => this.#offerBoards());
    pageState.robotName.subscribe(() => this.#firmwareList && this.#offerBoards());
    element('flash_write', HTMLButtonElement).addEventListener('click', () => this.#flash());
    element('flash_open', HTMLButtonElement).addEventListener('click', () => this.#fileInput.click());
    this.#cancelButton.addEventListener('click', () => this.#abortController.abort());
    this.#fileInput.addEventListener('change', () => {
      this.#file = this.#fileInput.files?.[0] ?? null;
      panel.speech.say('say_file', { name: asPlainText(this.#file?.name ?? '') });
    });
  }

  /** A page without firmware, or a browser without ports, offers nothing. */
  async #offerBoards() {
    if (!hasSerial) return;
    const firmwareList = await (this.#firmwareList ??= tryFetchFirmwareList());
    const availableBoards = new Set(firmwareList.map((firmware) => firmware.board));
    if (!this.#boardSelect.options.length) {
      this.#boardSelect.replaceChildren(...Object.entries(BOARD_NAMES).filter(([board]) => availableBoards.has(board)).map(([board, name]) => new Option(name, board)));
    }
    element('flash', HTMLElement).hidden = !this.#boardSelect.options.length;
    const canHalt = (await this.#findHaltingBoards()).includes(this.#boardSelect.value);
    setHidden(element('flash_halting', HTMLElement), !canHalt);
    this.#haltsInput.checked &&= canHalt;
  }

  /** The boards for which there is a firmware of the robot with breakpoints in the place of its reader of text. */
  async #findHaltingBoards() {
    if (!hasSerial) return [];
    const { haltingFirmwareTitle } = await import('./flash.js');
    const title = haltingFirmwareTitle(pageState.robotName.value);
    return (await (this.#firmwareList ??= tryFetchFirmwareList())).filter((firmware) => firmware.title === title).map(({ board }) => board);
  }

  /** Whether a board can get a firmware with breakpoints from here. */
  async canOfferHaltingFirmware() {
    return (await this.#findHaltingBoards()).length > 0;
  }

  /** Somebody wants that firmware: whether it is written is the next question. */
  async offerHaltingFirmware() {
    await this.#offerBoards();
    const boards = await this.#findHaltingBoards();
    if (!boards.includes(this.#boardSelect.value)) this.#boardSelect.value = boards[0] ?? '';
    this.#haltsInput.checked = true;
    element('link_teacher', HTMLDetailsElement).open = true;
    await this.#offerBoards();
    element('flash_write', HTMLButtonElement).focus();
  }

  async #flash() {
    const { speech, getChosenPort, isFree, setBusy, connect } = this.#panel;
    if (!isFree()) return;
    const wantedFirmware = this.#file ?? { robot: pageState.robotName.value, language: currentLanguage(), halts: this.#haltsInput.checked };
    const choosingPort = getChosenPort() ? Promise.resolve(getChosenPort()) : choosePort();
    this.#abortController = new AbortController();
    const board = this.#boardSelect.value;
    const { signal } = this.#abortController;
    setBusy(true);
    try {
      const port = await choosingPort;
      speech.say('say_fetching');
      this.#progressBar.value = 0;
      this.#progressBar.hidden = this.#cancelButton.hidden = false;
      const watchOptions = { onWait: () => speech.say('say_fetching_waits'), cancelSignal: signal };
      const { loadFirmware, flashBoard, preloadWriter } = await watchPromise(import('./flash.js'), watchOptions);
      const data = await loadFirmware(wantedFirmware, board, watchOptions);
      await watchPromise(preloadWriter(board), watchOptions);
      speech.say('say_flashing');
      await flashBoard(port, board, data, (fraction) => { this.#progressBar.value = fraction; }, signal);
      setBusy(false);
      this.#cancelButton.hidden = true;
      await connect(port);
    } catch (error) {
      const reason = signal.aborted ? 'flash_not_begun' : /** @type {Error} */ (error).name === 'TimeoutError' ? 'flash_held' : 'bug';
      speech.sayFailure(error instanceof ConnectionFailure ? error : new ConnectionFailure(reason, reason === 'bug' ? String(error) : ''));
    } finally {
      this.#progressBar.hidden = this.#cancelButton.hidden = true;
      this.#file = null;
      this.#fileInput.value = '';
      setBusy(false);
    }
  }
}

/** What firmware there is beside the page; a page by itself has none. */
async function tryFetchFirmwareList() {
  try {
    const { fetchFirmwareList } = await import('./flash.js');
    return await fetchFirmwareList();
  } catch {
    return [];
  }
}
