// The window with this person's programs: pictures of earlier ones, which are opened again, and a place
// to begin a new one. The newest is shared as a link or as a line of text, each with a picture for a
// phone's camera, unless nobody else could open it.

import { correction, generate } from 'lean-qr';
import { element } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { downloadFile } from '../page/files.js';
import { storeText, loadText } from '../page/kept.js';
import { makeButton, makeElement } from '../page/made.js';
import { makeLink, readLink } from './links.js';
import { isAddress, reachOf } from './reach.js';
import { isShippedProgram } from '../start/beginnings.js';
import { showProgramInstead } from '../start/screens.js';
import { pageState } from '../page/page_state.js';
import { labelOf, currentLanguage, text } from '../page/texts.js';
import { deleteVersion, loadVersions, MAX_CHARACTERS, restoreVersion, isSameProgramAs, storeVersion, versionTitle } from './versions.js';
import { makeThumbnail } from '../start/thumbnail.js';
import { robotOf } from '../page/words.js';
import { storeWork } from './work.js';
import { messageWithFix } from '../writing/messages.js';

/** @typedef {import('./versions.js').Version} Version */
/** @typedef {{text: string} | {refusal: string}} ShareResult what is shared, or why it is not */

/**
 * @typedef {object} Page what this window needs of the page
 * @property {import('../python.js').Python} python
 * @property {import('./work.js').Work} work
 * @property {(program: {text: string, robot: string, name: string}) => void} putProgram into the editor
 * @property {() => Promise<Blob | null>} makePicture the program's blocks, as a file
 */

const PUBLIC_ADDRESS_KEY = 'tiniscript.public'; // where others find this page, as somebody has told it
const READER_CODES = 'TS3'; // of what a robot that reads text cannot do
const MAX_CODE_BYTES = 900; // bytes: a camera reads no picture with more from a screen
const QUIET_ZONE_MODULES = 4; // modules that must stay white around a code

const LINK_HINT_KEYS = /** @type {const} */ ({ anywhere: 'share_link_anywhere', network: 'share_link_network', here: 'share_link_here' });

export class Programs {
  #dialog = element('programs', HTMLDialogElement);
  #sharedTextArea = element('shared', HTMLTextAreaElement);
  #hintElement = element('shared_told', HTMLElement);
  #codeCanvas = element('shared_picture', HTMLCanvasElement);
  #linkButton = element('share_link', HTMLButtonElement);
  #lineButton = element('share_line', HTMLButtonElement);
  #copyButton = element('copy', HTMLButtonElement);
  #nameInput = element('program_name', HTMLInputElement);
  #publicInput = element('public', HTMLInputElement);
  #page;
  #shareDetails = element('share', HTMLDetailsElement);
  #shareCount = 0;

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    element('my_programs', HTMLButtonElement).addEventListener('click', () => this.#openWindow());
    element('programs_close', HTMLButtonElement).addEventListener('click', () => this.#dialog.close());
    // The page's own is behind this window.
    element('programs_stop', HTMLButtonElement).addEventListener('click', () => element('stop', HTMLButtonElement).click());
    for (const id of ['new', 'bar_new']) element(id, HTMLButtonElement).addEventListener('click', () => {
      this.replaceProgram({ text: '', robot: page.work.robot, name: '' });
      this.#dialog.close();
    });
    this.#shareDetails.addEventListener('toggle', () => {
      if (this.#shareDetails.open) this.#share('link');
    });
    this.#linkButton.addEventListener('click', () => this.#share('link'));
    this.#lineButton.addEventListener('click', () => this.#share('line'));
    element('share_picture', HTMLButtonElement).addEventListener('click', () => this.#savePicture());
    this.#nameInput.addEventListener('input', () => this.#rename());
    this.#publicInput.addEventListener('change', () => {
      storeText(PUBLIC_ADDRESS_KEY, this.#publicInput.value.trim());
      this.#share('link');
    });
    this.#copyButton.addEventListener('click', () => this.#copyShared());
    element('run', HTMLButtonElement).addEventListener('click', () => this.storeVersion());
    addEventListener('pagehide', () => this.storeVersion());
    document.addEventListener('visibilitychange', () => { // a phone ends a page without a word
      if (document.hidden) this.storeVersion();
    });
    addEventListener('hashchange', () => this.openAddressProgram());
  }

  /** Keeps what is in the editor among the earlier programs, unless the page has brought it. Returns whether nothing of it would be lost. */
  storeVersion() {
    const isSafe = isShippedProgram(this.#page.work.text) || storeVersion(this.#page.work);
    if (!isSafe) pageState.note.set(text(this.#page.work.text.length > MAX_CHARACTERS ? 'kept_too_long' : 'not_kept'));
    return isSafe;
  }

  /**
   * Puts another program into the editor; where others edit it, too, only if that is wanted for all. The one before is
   * kept, and undo brings it back, too.
   * @param {{text: string, robot: string, name: string}} program
   * @returns {boolean} whether it is there
   */
  replaceProgram(program) {
    if (pageState.groupName.value && !confirm(text('group_replace'))) return false;
    this.storeVersion();
    this.#page.putProgram(program);
    return true;
  }

  /** Opens the program of the page's address, if there is one; it does not run. */
  async openAddressProgram() {
    let program;
    try {
      program = await readLink(location.hash);
    } catch {
      pageState.note.set(text('link_wrong'));
    }
    if (program === null) return;
    showProgramInstead();
    if (!program) return;
    this.replaceProgram({ ...program, name: '' });
    pageState.note.set(text('link_opened'));
  }

  #openWindow() {
    this.storeVersion();
    this.#showVersions();
    this.#nameInput.value = this.#page.work.name.replace(/\.\w+$/, '');
    this.#publicInput.value = loadPublicAddress();
    this.#shareDetails.open = false;
    delete this.#dialog.dataset['shared'];
    this.#dialog.showModal();
  }

  /** Gives the program another name; its file gets it, too. */
  #rename() {
    const name = this.#nameInput.value.replace(/[\\/:*?"<>|\u0000-\u001f]|^[ .]+|\.ts$/g, '').trim();
    this.#page.work.name = name && `${name}.ts`;
    storeWork(this.#page.work);
    this.storeVersion();
    this.#showVersions();
  }

  /** @param {'link' | 'line'} form */
  async #share(form) {
    const shareNumber = ++this.#shareCount; // only what was asked last is shown
    this.#linkButton.setAttribute('aria-pressed', String(form === 'link'));
    this.#lineButton.setAttribute('aria-pressed', String(form === 'line'));
    this.#showShared({ text: '' }, '');
    let result;
    try {
      result = form === 'link' ? await this.#makeLink() : await this.#makeLine();
    } catch (error) {
      result = { refusal: bugSentence(error) };
    }
    const hintKey = form === 'line' ? 'share_line_told' : LINK_HINT_KEYS[reachOf(this.#pageAddress)];
    const isForOthers = form === 'line' || reachOf(this.#pageAddress) !== 'here';
    if (shareNumber === this.#shareCount) this.#showShared(result, text(hintKey), isForOthers);
  }

  /** Where others find the page. */
  get #pageAddress() {
    return isAddress(loadPublicAddress()) ? loadPublicAddress() : location.href;
  }

  /** @returns {Promise<ShareResult>} */
  async #makeLink() {
    if (loadPublicAddress() && !isAddress(loadPublicAddress())) return { refusal: text('public_wrong') };
    const link = await makeLink(this.#page.work, this.#pageAddress);
    return link === null ? { refusal: text('link_too_long') } : { text: link };
  }

  /** @returns {Promise<ShareResult>} */
  async #makeLine() {
    const request = { do: 'line', robot: this.#page.work.robot, language: currentLanguage() };
    const answer = await this.#page.python.ask(request, new TextEncoder().encode(this.#page.work.text));
    if (answer.text !== undefined) return { text: answer.text };
    const isBeyondReader = answer.code.startsWith(READER_CODES); // its own fix names a command of the terminal
    return { refusal: messageWithFix({ ...answer, ...isBeyondReader && { fix: text('share_line_else') } }) };
  }

  /**
   * @param {ShareResult} result
   * @param {string} hint
   * @param {boolean} isForOthers a phone could open what its camera reads
   */
  #showShared(result, hint, isForOthers = true) {
    const sharedText = 'text' in result ? result.text : '';
    const fitsCode = sharedText !== '' && new TextEncoder().encode(sharedText).length <= MAX_CODE_BYTES;
    this.#sharedTextArea.value = sharedText;
    this.#sharedTextArea.hidden = sharedText === '';
    this.#copyButton.hidden = sharedText === '' || !navigator.clipboard; // which plain http has not
    this.#hintElement.textContent = 'refusal' in result ? result.refusal
      : sharedText && isForOthers && !fitsCode ? `${hint} ${text('no_picture')}` : hint;
    this.#codeCanvas.hidden = !fitsCode || !isForOthers;
    if (!this.#codeCanvas.hidden) {
      generate(sharedText, { minCorrectionLevel: correction.L })
        .toCanvas(this.#codeCanvas, { padX: QUIET_ZONE_MODULES, padY: QUIET_ZONE_MODULES, on: [0, 0, 0, 255], off: [255, 255, 255, 255] });
    }
    this.#dialog.dataset['shared'] = 'refusal' in result ? 'wrong' : sharedText ? 'done' : 'asked';
  }

  async #savePicture() {
    const name = (this.#page.work.name || text('file_name')).replace(/\.\w+$/, '') + '.png';
    let file = null;
    try {
      file = await this.#page.makePicture();
    } catch {
      // said below
    }
    if (file) downloadFile(name, file);
    this.#hintElement.textContent = file ? text('saved', { name }) : text('share_picture_not');
  }

  async #copyShared() {
    this.#sharedTextArea.focus();
    this.#sharedTextArea.select();
    try {
      await navigator.clipboard.writeText(this.#sharedTextArea.value);
      this.#hintElement.textContent = text('copied');
    } catch {
      this.#hintElement.textContent = text('copy_by_hand'); // it is selected
    }
  }

  /** A program goes, and can be brought back until the window is opened again. @param {Version} version @param {HTMLElement} row its place */
  #deleteVersion(version, row) {
    deleteVersion(version);
    const undoButton = makeButton('undo', () => {
      if (!restoreVersion(version)) pageState.note.set(text('not_kept'));
      this.#showVersions();
    });
    row.replaceChildren(undoButton);
    undoButton.focus();
  }

  #showVersions() {
    const language = currentLanguage(), isOpenProgram = isSameProgramAs(this.#page.work);
    const timeFormat = new Intl.DateTimeFormat(language, { dateStyle: 'short', timeStyle: 'short' });
    const versions = loadVersions();
    const titles = versions.map((version, index) => versionTitle(version, versions.length - index));
    const rows = versions.map((version, index) => {
      const storedAt = new Date(version.at_ms);
      const timeText = timeFormat.format(storedAt);
      const timeElement = makeElement('time', '', timeText);
      timeElement.dateTime = storedAt.toISOString();
      const ownTitle = String(titles[index]), isShared = titles.indexOf(ownTitle) !== titles.lastIndexOf(ownTitle);
      const title = isShared ? `${ownTitle} (${versions.length - index})` : ownTitle, robotLabel = labelOf(robotOf(version.robot)?.labels ?? {}) || version.robot;
      const openButton = makeButton('', () => {
        this.replaceProgram(version);
        this.#dialog.close();
        pageState.note.set(text('opened', { name: title }));
      }, makeThumbnail(version.text, version.robot), makeElement('strong', '', title), timeElement);
      openButton.title = `${title}, ${robotLabel}`;
      const row = makeElement('li', '', openButton);
      if (isOpenProgram(version)) return row; // it is in the editor, and would be kept again
      const deleteButton = makeButton('', () => this.#deleteVersion(version, row), '×');
      deleteButton.className = 'delete';
      deleteButton.title = deleteButton.ariaLabel = text('program_delete', { name: title });
      row.append(deleteButton);
      return row;
    });
    const versionList = element('versions', HTMLElement);
    versionList.replaceChildren(...[...versionList.children].slice(0, 1), ...rows);
  }
}

/** Where others find this page, as somebody has told it; empty for nothing. */
function loadPublicAddress() {
  return loadText(PUBLIC_ADDRESS_KEY).slice(0, 200);
}
