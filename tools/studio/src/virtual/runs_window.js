// The window with the last runs: one is seen again, saved as a file, and a file is opened.

import { element } from '../page/elements.js';
import { readBytes, downloadText, onFileChosen } from '../page/files.js';
import { makeButton, makeElement } from '../page/made.js';
import { pageState } from '../page/page_state.js';
import { bugSentence } from '../page/faults.js';
import { textKey, text } from '../page/texts.js';

/** @typedef {import('./runs.js').Run} Run */
/** @typedef {import('./runs.js').Row} Row */
/** @typedef {{text: string, robot: string, of: 'virtual' | 'real', world: unknown, end_ms: number, shapes: import('../world/parts.js').World | null, rows: Row[], is_by_button: boolean, fileText: string}} OpenedRun */

const FILE_EXTENSION = '.tsr';

export class RunsWindow {
  #dialog = element('runs', HTMLDialogElement);
  #page;

  /**
   * @param {object} page
   * @param {import('../python.js').Python} page.python
   * @param {import('./runs.js').Runs} page.runs
   * @param {(run: Run) => void} page.show one of them
   * @param {(opened: OpenedRun, known: Run | null) => void} page.play the run of a file, which may be kept already
   */
  constructor(page) {
    this.#page = page;
    element('runs_open', HTMLButtonElement).addEventListener('click', () => {
      this.#showNotice('');
      this.#show();
      this.#dialog.showModal();
    });
    element('runs_close', HTMLButtonElement).addEventListener('click', () => this.#dialog.close());
    element('run_open', HTMLButtonElement).addEventListener('click', () => element('run_file', HTMLInputElement).click());
    onFileChosen('run_file', (file) => this.open(file));
    addEventListener('dragover', (event) => {
      if (event.dataTransfer?.types.includes('Files')) event.preventDefault();
    });
    addEventListener('drop', (event) => {
      const file = event.dataTransfer?.files[0];
      if (!file) return;
      event.preventDefault(); // a browser would leave the page for it
      if (isRunFile(file.name)) this.open(file);
      else pageState.note.set(text('not_opened', { name: file.name, why: text('run_not') }));
    });
  }

  /** @param {File} file of a run: it is played, or why it cannot be is told */
  async open(file) {
    try {
      await this.openData(await readBytes(file), file.name);
    } catch {
      this.#showRefusal(file.name, text('unreadable'));
    }
  }

  /** @param {Uint8Array} data @param {string} [name] @param {Run | null} [knownRun] that is kept already */
  async openData(data, name = '', knownRun = null) {
    const answer = await this.#page.python.ask({ do: 'open_run' }, data);
    if (answer.what) {
      this.#showRefusal(name, text(textKey(`record_${answer.what}`), { line: answer.line }));
      return;
    }
    this.#dialog.close();
    this.#page.play({ ...answer, fileText: new TextDecoder().decode(data) }, knownRun);
  }

  /** @param {Run} run @returns {Promise<string>} its file */
  async fileOf(run) {
    if (run.fileText) return run.fileText;
    const { origin, rows, end_ms } = run;
    const answer = await this.#page.python.ask({ do: 'write_run', ...origin, rows, end_ms: end_ms ?? run.readClock?.() ?? rows.at(-1)?.[0] ?? 0 });
    return answer.file;
  }

  /** @param {string} name @param {string} reason */
  #showRefusal(name, reason) {
    if (this.#dialog.open) this.#showNotice(reason);
    else pageState.note.set(text('not_opened', { name, why: reason }));
  }

  /** @param {string} notice */
  #showNotice(notice) {
    element('runs_said', HTMLElement).textContent = notice;
  }

  #show() {
    const rows = this.#page.runs.newestFirst.map((run) => {
      const title = text(run.origin.of === 'real' ? 'run_real' : 'run_virtual', { number: run.number, seconds: run.duration_s.toFixed(1) });
      const showButton = makeButton('', () => {
        this.#dialog.close();
        this.#page.show(run);
      }, title);
      const saveButton = makeButton('run_save', () => this.#saveRun(run));
      saveButton.disabled = run.isJudged || !(run.fileText || run.rows.length);
      return makeElement('li', '', showButton, makeElement('code', '', beginningOf(run.origin.text)), saveButton);
    });
    element('runs_list', HTMLElement).replaceChildren(...rows);
    if (!rows.length) this.#showNotice(text('runs_none'));
  }

  /** @param {Run} run */
  async #saveRun(run) {
    try {
      downloadText(`${text('run_name')}${FILE_EXTENSION}`, await this.fileOf(run));
    } catch (error) {
      this.#showNotice(bugSentence(error));
    }
  }
}

/** @param {string} name of a file */
export function isRunFile(name) {
  return name.toLowerCase().endsWith(FILE_EXTENSION);
}

/** @param {string} programText */
function beginningOf(programText) {
  const line = programText.split('\n').map((line) => line.trim()).filter(Boolean).join(' ');
  return line.length > 60 ? `${line.slice(0, 60)}…` : line;
}
