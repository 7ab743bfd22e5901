// A page's part in a group: the editor, the blocks and what is said of the robot are the group's until it leaves. The
// teacher's computer has the program (`together.js`); the page's own one from before stays in My programs.

import { storeText, storedJson } from '../page/kept.js';
import { pageState } from '../page/page_state.js';
import { textKey, text } from '../page/texts.js';
import { post } from '../robot/host.js';
import { Together } from './together.js';

const PLACE = 'tiniscript.group'; // what a page that is loaded again goes on with

/** @typedef {import('./together.js').Other} Other */
/** @typedef {{say: (key: import('../page/texts.js').Key | '') => void, fails: (why: unknown) => void, others: (others: Other[]) => void}} Told `say` is told of joining and leaving, too */

export class Membership {
  #page;
  #told;
  /** @type {Together | null} */
  #together = null;
  #isJoining = false;

  /** @param {import('./classroom.js').Page} page @param {Told} told */
  constructor(page, told) {
    this.#page = page;
    this.#told = told;
  }

  get isIn() { return this.#together !== null; }

  /** What is finished becomes the group's. */
  finish() {
    this.#together?.finish();
  }

  /** A page that was loaded again goes on, if it was in a group; returns whether it was. */
  goOn() {
    const before = storedJson(PLACE, 'sessionStorage');
    const wasIn = Boolean(before?.request?.do && before.page?.name);
    if (wasIn) this.join(before.request, before.page);
    return wasIn;
  }

  /** @param {Record<string, unknown>} request @param {{name: string}} [before] */
  async join(request, before) {
    if (this.#isJoining || this.#together) return;
    this.#isJoining = true;
    try {
      const { work, python, editor, views, panel } = this.#page;
      this.#page.keep();
      const answer = await post({ ...request, text: work.text, ...(before && { before: before.name }) });
      if (answer.failure) {
        storeText(PLACE, '', 'sessionStorage');
        this.#told.say(textKey(answer.failure));
        return;
      }
      const together = this.#together = new Together(python, editor, {
        left: () => {
          this.end();
          this.#told.say('group_left');
        },
        fails: (why) => {
          this.end();
          this.#told.fails(why);
        },
        others: (others) => this.#told.others(others),
        refused: () => pageState.note.set(text('group_refused')),
        places: (places) => views.showMates(places),
        runs: (event) => panel.witness(event),
        isBusy: () => views.isBusy,
        answers: (isHeard) => this.#told.say(isHeard ? 'group_in' : 'class_silent'),
        keep: (page) => storeText(PLACE, JSON.stringify({ request, page }), 'sessionStorage'),
      });
      pageState.groupName.set(String(answer.group));
      this.#told.say('group_in');
      await together.begin(answer, before ?? null).then(() => {
        views.join(together);
        document.documentElement.dataset['group'] = 'in';
      }, (why) => {
        this.leave();
        this.#told.fails(why);
      });
    } catch {
      this.#told.say('class_silent');
    } finally {
      this.#isJoining = false;
    }
  }

  leave() {
    this.end();
    post({ do: 'group_leave' }).catch(() => {}); // a page that is silent gives its place away
  }

  /** It is over here; the program stays in the page. */
  end() {
    this.#together?.end();
    this.#together = null;
    this.#page.views.join(null);
    this.#page.panel.endWitness();
    delete document.documentElement.dataset['group'];
    storeText(PLACE, '', 'sessionStorage');
    pageState.groupName.set('');
    this.#told.others([]);
    this.#told.say('');
  }
}
