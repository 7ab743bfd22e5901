// The window with this person's programs: pictures of earlier ones, which are opened again, and a place
// to begin a new one. The newest is shared as a link or as a line of text, each with a picture for a
// phone's camera, unless nobody else could open it.

import { correction, generate } from 'lean-qr';
import { element } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { downloadFile } from '../page/files.js';
import { storeText, storedText } from '../page/kept.js';
import { makeButton, makeElement } from '../page/made.js';
import { linkOf, sharedIn } from './links.js';
import { isAddress, reachOf } from './reach.js';
import { isGiven } from '../start/beginnings.js';
import { showInstead } from '../start/screens.js';
import { pageState } from '../page/page_state.js';
import { labelOf, currentLanguage, text } from '../page/texts.js';
import { keepVersion, MOST_CHARACTERS, titleOf, versions } from './versions.js';
import { thumbnail } from '../start/thumbnail.js';
import { robotOf } from '../page/words.js';
import { keep } from './work.js';
import { whole } from '../writing/messages.js';

/** @typedef {import('./versions.js').Version} Version */
/** @typedef {{text: string} | {wrong: string}} Given what is shared, or why it is not */

/**
 * @typedef {object} Page what this window needs of the page
 * @property {import('../python.js').Python} python
 * @property {import('./work.js').Work} work
 * @property {(program: {text: string, robot: string, name: string}) => void} put it into the editor
 * @property {() => Promise<Blob | null>} picturing the program's blocks, as a file
 */

const PUBLIC = 'tiniscript.public'; // where others find this page, as somebody has told it
const MOST_PICTURED = 900; // bytes: a camera reads no picture with more from a screen
const MARGIN = 4; // modules that must stay white around a code

const LINK_TOLD = /** @type {const} */ ({ anywhere: 'share_link_anywhere', network: 'share_link_network', here: 'share_link_here' });

export class Programs {
  #window = element('programs', HTMLDialogElement);
  #shared = element('shared', HTMLTextAreaElement);
  #told = element('shared_told', HTMLElement);
  #picture = element('shared_picture', HTMLCanvasElement);
  #link = element('share_link', HTMLButtonElement);
  #line = element('share_line', HTMLButtonElement);
  #copy = element('copy', HTMLButtonElement);
  #name = element('program_name', HTMLInputElement);
  #public = element('public', HTMLInputElement);
  #page;
  #fold = element('share', HTMLDetailsElement);
  #asked = 0;

  /** @param {Page} page */
  constructor(page) {
    this.#page = page;
    element('my_programs', HTMLButtonElement).addEventListener('click', () => this.#open());
    element('programs_close', HTMLButtonElement).addEventListener('click', () => this.#window.close());
    // The page's own is behind this window.
    element('programs_stop', HTMLButtonElement).addEventListener('click', () => element('stop', HTMLButtonElement).click());
    for (const id of ['new', 'bar_new']) element(id, HTMLButtonElement).addEventListener('click', () => {
      this.replace({ text: '', robot: page.work.robot, name: '' });
      this.#window.close();
    });
    this.#fold.addEventListener('toggle', () => {
      if (this.#fold.open) this.#share('link');
    });
    this.#link.addEventListener('click', () => this.#share('link'));
    this.#line.addEventListener('click', () => this.#share('line'));
    element('share_picture', HTMLButtonElement).addEventListener('click', () => this.#savePicture());
    this.#name.addEventListener('input', () => this.#rename());
    this.#public.addEventListener('change', () => {
      storeText(PUBLIC, this.#public.value.trim());
      this.#share('link');
    });
    this.#copy.addEventListener('click', () => this.#copyIt());
    element('run', HTMLButtonElement).addEventListener('click', () => this.keep());
    addEventListener('pagehide', () => this.keep());
    document.addEventListener('visibilitychange', () => { // a phone ends a page without a word
      if (document.hidden) this.keep();
    });
    addEventListener('hashchange', () => this.openLink());
  }

  /** Keeps what is in the editor among the earlier programs, unless the page has brought it. */
  keep() {
    if (isGiven(this.#page.work.text)) return;
    if (!keepVersion(this.#page.work)) pageState.note.set(text(this.#page.work.text.length > MOST_CHARACTERS ? 'kept_too_long' : 'not_kept'));
  }

  /**
   * Puts another program into the editor; where others edit it, too, only if that is wanted for all. The one before is
   * kept, and undo brings it back, too.
   * @param {{text: string, robot: string, name: string}} program
   * @returns {boolean} whether it is there
   */
  replace(program) {
    if (pageState.groupName.value && !confirm(text('group_replace'))) return false;
    this.keep();
    this.#page.put(program);
    return true;
  }

  /** Opens the program of the page's address, if there is one; it does not run. */
  async openLink() {
    let found;
    try {
      found = await sharedIn(location.hash);
    } catch {
      pageState.note.set(text('link_wrong'));
    }
    if (found === null) return;
    showInstead();
    if (!found) return;
    this.replace({ ...found, name: '' });
    pageState.note.set(text('link_opened'));
  }

  #open() {
    this.keep();
    this.#showVersions();
    this.#name.value = this.#page.work.name.replace(/\.\w+$/, '');
    this.#public.value = publicAddress();
    this.#fold.open = false;
    delete this.#window.dataset['shared'];
    this.#window.showModal();
  }

  /** Gives the program another name; its file gets it, too. */
  #rename() {
    const name = this.#name.value.replace(/[\\/:*?"<>|\u0000-\u001f]|^[ .]+|\.ts$/g, '').trim();
    this.#page.work.name = name && `${name}.ts`;
    keep(this.#page.work);
    this.keep();
    this.#showVersions();
  }

  /** @param {'link' | 'line'} how */
  async #share(how) {
    const asked = ++this.#asked; // only what was asked last is shown
    this.#link.setAttribute('aria-pressed', String(how === 'link'));
    this.#line.setAttribute('aria-pressed', String(how === 'line'));
    this.#show({ text: '' }, '');
    let given;
    try {
      given = how === 'link' ? await this.#asLink() : await this.#asLine();
    } catch (why) {
      given = { wrong: bugSentence(why) };
    }
    const told = how === 'line' ? 'share_line_told' : LINK_TOLD[reachOf(this.#address)];
    const isForOthers = how === 'line' || reachOf(this.#address) !== 'here';
    if (asked === this.#asked) this.#show(given, text(told), isForOthers);
  }

  /** Where others find the page. */
  get #address() {
    return isAddress(publicAddress()) ? publicAddress() : location.href;
  }

  /** @returns {Promise<Given>} */
  async #asLink() {
    if (publicAddress() && !isAddress(publicAddress())) return { wrong: text('public_wrong') };
    const link = await linkOf(this.#page.work, this.#address);
    return link === null ? { wrong: text('link_too_long') } : { text: link };
  }

  /** @returns {Promise<Given>} */
  async #asLine() {
    const request = { do: 'line', robot: this.#page.work.robot, language: currentLanguage() };
    const answer = await this.#page.python.ask(request, new TextEncoder().encode(this.#page.work.text));
    if (answer.text !== undefined) return { text: answer.text };
    return { wrong: whole(answer) };
  }

  /**
   * @param {Given} given
   * @param {string} told
   * @param {boolean} isForOthers a phone could open what its camera reads
   */
  #show(given, told, isForOthers = true) {
    const shared = 'text' in given ? given.text : '';
    const isPictured = shared !== '' && new TextEncoder().encode(shared).length <= MOST_PICTURED;
    this.#shared.value = shared;
    this.#shared.hidden = shared === '';
    this.#copy.hidden = shared === '' || !navigator.clipboard; // which plain http has not
    this.#told.textContent = 'wrong' in given ? given.wrong
      : shared && isForOthers && !isPictured ? `${told} ${text('no_picture')}` : told;
    this.#picture.hidden = !isPictured || !isForOthers;
    if (!this.#picture.hidden) {
      generate(shared, { minCorrectionLevel: correction.L })
        .toCanvas(this.#picture, { padX: MARGIN, padY: MARGIN, on: [0, 0, 0, 255], off: [255, 255, 255, 255] });
    }
    this.#window.dataset['shared'] = 'wrong' in given ? 'wrong' : shared ? 'done' : 'asked';
  }

  async #savePicture() {
    const name = (this.#page.work.name || text('file_name')).replace(/\.\w+$/, '') + '.png';
    let file = null;
    try {
      file = await this.#page.picturing();
    } catch {
      // said below
    }
    if (file) downloadFile(name, file);
    this.#told.textContent = file ? text('saved', { name }) : text('share_picture_not');
  }

  async #copyIt() {
    this.#shared.focus();
    this.#shared.select();
    try {
      await navigator.clipboard.writeText(this.#shared.value);
      this.#told.textContent = text('copied');
    } catch {
      this.#told.textContent = text('copy_by_hand'); // it is selected
    }
  }

  #showVersions() {
    const language = currentLanguage();
    const time = new Intl.DateTimeFormat(language, { dateStyle: 'short', timeStyle: 'short' });
    const rows = versions().map((version, k, all) => {
      const at = new Date(version.at_ms);
      const said = time.format(at);
      const when = makeElement('time', '', said);
      when.dateTime = at.toISOString();
      const title = titleOf(version, all.length - k), robot = labelOf(robotOf(version.robot)?.labels ?? {}) || version.robot;
      const open = makeButton('', () => {
        this.replace(version);
        this.#window.close();
        pageState.note.set(text('opened_again', { time: said }));
      }, thumbnail(version.text, version.robot), makeElement('strong', '', title), when);
      open.title = `${title}, ${robot}`;
      return makeElement('li', '', open);
    });
    const place = element('versions', HTMLElement);
    place.replaceChildren(...[...place.children].slice(0, 1), ...rows);
  }
}

/** Where others find this page, as somebody has told it; empty for nothing. */
function publicAddress() {
  return storedText(PUBLIC).slice(0, 200);
}
