// A page's part in a group: the editor, the blocks and what is said of the robot are the group's until it leaves. The
// teacher's computer has the program (`together.js`); the page's own one from before stays in My programs.

import { storeText, loadJson } from '../page/kept.js';
import { pageState } from '../page/page_state.js';
import { textKey, text } from '../page/texts.js';
import { post } from '../robot/host.js';
import { SharedEditor } from './together.js';

const STORAGE_KEY = 'tiniscript.group'; // what a page that is loaded again goes on with

/** @typedef {import('./together.js').Mate} Mate */
/** @typedef {{onStateChange: (key: import('../page/texts.js').Key | '') => void, onBug: (error: unknown) => void, onMatesChange: (mates: Mate[]) => void}} MembershipListener `onStateChange` is told of joining and leaving, too */

export class Membership {
  #page;
  #listener;
  /** @type {SharedEditor | null} */
  #sharedEditor = null;
  isJoining = false; // until the group's program is on the screen

  /** @param {import('./classroom.js').Page} page @param {MembershipListener} listener */
  constructor(page, listener) {
    this.#page = page;
    this.#listener = listener;
  }

  get isInGroup() { return this.#sharedEditor !== null; }

  /** What is finished becomes the group's. */
  finishEdit() {
    this.#sharedEditor?.finishEdit();
  }

  /** A page that was loaded again goes on, if it was in a group; returns whether it was. */
  resume() {
    const storedMembership = loadJson(STORAGE_KEY, 'sessionStorage');
    const wasInGroup = Boolean(storedMembership?.request?.do && storedMembership.page?.name);
    if (wasInGroup) this.join(storedMembership.request, storedMembership.page);
    return wasInGroup;
  }

  /** @param {Record<string, unknown>} request @param {{name: string}} [storedPage] */
  async join(request, storedPage) {
    if (this.isJoining || this.#sharedEditor) return;
    this.isJoining = true;
    try {
      const { work, python, editor, views, panel } = this.#page;
      this.#page.keepProgram();
      const answer = await post({ ...request, text: work.text, ...(storedPage && { before: storedPage.name }) });
      if (answer.failure) {
        storeText(STORAGE_KEY, '', 'sessionStorage');
        this.#listener.onStateChange(textKey(answer.failure));
        return;
      }
      const sharedEditor = this.#sharedEditor = new SharedEditor(python, editor, {
        onLeft: () => {
          this.endMembership();
          this.#listener.onStateChange('group_left');
        },
        onBug: (error) => {
          this.endMembership();
          this.#listener.onBug(error);
        },
        onMatesChange: (mates) => this.#listener.onMatesChange(mates),
        onRefusal: () => pageState.note.set(text('group_refused')),
        onMatesMove: (places) => views.showMates(places),
        onRobotEvent: (event) => panel.onGroupEvent(event),
        isBusy: () => views.isBusy,
        onRequestEnd: (isAnswered) => this.#listener.onStateChange(isAnswered ? 'group_in' : 'class_silent'),
        storePage: (page) => storeText(STORAGE_KEY, JSON.stringify({ request, page }), 'sessionStorage'),
      });
      pageState.groupName.set(String(answer.group));
      this.#listener.onStateChange('group_in');
      await sharedEditor.showProgram(answer, storedPage ?? null).then(() => {
        if (sharedEditor !== this.#sharedEditor) return; // it was left meanwhile
        views.join(sharedEditor);
        document.documentElement.dataset['group'] = 'in';
      }, (error) => {
        this.leave();
        this.#listener.onBug(error);
      });
    } catch {
      this.#listener.onStateChange('class_silent');
    } finally {
      this.isJoining = false;
    }
  }

  leave() {
    this.endMembership();
    post({ do: 'group_leave' }).catch(() => {}); // a page that is silent gives its place away
  }

  /** It is over here; the program stays in the page. */
  endMembership() {
    this.#sharedEditor?.end();
    this.#sharedEditor = null;
    this.#page.views.join(null);
    this.#page.panel.endWitness();
    delete document.documentElement.dataset['group'];
    storeText(STORAGE_KEY, '', 'sessionStorage');
    pageState.groupName.set('');
    this.#listener.onMatesChange([]);
    this.#listener.onStateChange('');
  }
}
