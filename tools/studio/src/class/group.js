// A pupil's group: joins one by its name, shows who is in it, and leaves it. The teacher's computer has the
// program of the group (`together.js`); each pupil's own one from before stays in My programs.

import { button, labelled, made } from '../page/made.js';
import { element, say } from '../page/elements.js';
import { bugSaid } from '../page/faults.js';
import { keepAt, keptForm } from '../page/kept.js';
import { pageState } from '../page/page_state.js';
import { known, text } from '../page/texts.js';
import { hearStops, post } from '../robot/host.js';
import { shown } from '../robot/plain_text.js';
import { pause } from '../robot/transport.js';
import { named, Together } from './together.js';

const PLACE = 'tiniscript.group'; // what a page that is loaded again goes on with
const STOP_TRIES = 5;

/** @typedef {{name: string, members: string[]}} Seen */

export class Group {
  #page;
  #box;
  #name = made('input');
  #form = made('form', '', labelled('group_name', this.#name), made('button', 'group_join'));
  #there = made('p');
  #said = made('p');
  #mates = made('p');
  #leave = button('group_leave', () => this.leave());
  /** @type {Together | null} */
  #together = null;
  #isJoining = false;
  #stops = 0; // that were pressed while somebody else drives
  /** Whether another pupil of the group has the robot. */
  isDriven = false;

  /** @param {import('./classroom.js').Page} page @param {HTMLElement} box */
  constructor(page, box) {
    this.#page = page;
    this.#box = made('section', '', made('h2', 'group'), this.#form, this.#there, this.#said, this.#mates, this.#leave);
    this.#box.id = 'class_group';
    this.#box.hidden = true;
    this.#name.maxLength = 24;
    this.#name.autocomplete = 'off';
    this.#name.required = true;
    this.#said.setAttribute('role', 'status');
    this.#mates.id = 'class_mates';
    this.#form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#join(this.#name.value);
    });
    box.append(this.#box);
    element('run', HTMLButtonElement).addEventListener('click', () => this.#together?.finish());
    element('stop', HTMLButtonElement).addEventListener('click', () => this.#stop());
    addEventListener('keydown', (event) => {
      if (event.key === 'Escape') this.#stop();
    }, { capture: true });
    this.#show('');
  }

  /** The page is in the class. */
  enter() {
    this.#box.hidden = false;
    const before = keptForm(PLACE, 'sessionStorage');
    if (before?.group && before.page?.name) this.#join(String(before.group), before.page);
  }

  /** The page is not in the class any more. */
  exit() {
    this.#box.hidden = true;
    this.#end();
  }

  /** @param {Seen[]} groups that there are @param {string} driver who has the robot of this one */
  see(groups, driver) {
    this.isDriven = driver !== '';
    if (this.#together) return;
    const said = JSON.stringify(groups);
    if (this.#there.dataset['groups'] === said) return;
    this.#there.dataset['groups'] = said;
    this.#there.replaceChildren(...groups.map(({ name, members }) => button('', () => this.#join(name), members.length ? `${shown(name)} (${members.map((each) => shown(each)).join(', ')})` : shown(name))));
  }

  leave() {
    this.#end();
    post({ do: 'group_leave' }).catch(() => {}); // a page that is silent gives its place away
  }

  /** @param {string} name @param {{name: string}} [before] */
  async #join(name, before) {
    if (this.#isJoining || this.#together) return;
    this.#isJoining = true;
    try {
      const { work, python, editor } = this.#page;
      this.#page.keep();
      const answer = await post({ do: 'group_join', name, text: work.text, ...(before && { before: before.name }) });
      if (answer.failure) {
        keepAt(PLACE, '', 'sessionStorage');
        this.#show(known(answer.failure));
        return;
      }
      const group = String(answer.group);
      const together = this.#together = new Together(python, editor, {
        left: () => {
          this.#end();
          this.#show('group_left');
        },
        fails: (why) => {
          this.#end();
          say(this.#said, bugSaid(why));
        },
        others: (others) => this.#mates.replaceChildren(...named(others.map((each) => ({ ...each, name: shown(each.name) })))),
        refused: () => pageState.note.set(text('group_refused')),
        places: (places) => this.#page.views.showMates(places),
        isBusy: () => this.#page.views.isBusy,
        answers: (isHeard) => this.#show(isHeard ? 'group_in' : 'class_silent'),
        keep: (page) => keepAt(PLACE, JSON.stringify({ group, page }), 'sessionStorage'),
      });
      pageState.group.set(group);
      this.#show('group_in');
      await together.begin(answer, before ?? null).then(() => {
        this.#page.views.join(together);
        document.documentElement.dataset['group'] = 'in';
      }, (why) => {
        this.leave();
        say(this.#said, bugSaid(why));
      });
    } catch {
      this.#show('class_silent');
    } finally {
      this.#isJoining = false;
    }
  }

  #end() {
    this.#together?.end();
    this.#together = null;
    this.#page.views.join(null);
    this.isDriven = false;
    delete document.documentElement.dataset['group'];
    keepAt(PLACE, '', 'sessionStorage');
    pageState.group.set('');
    this.#mates.replaceChildren();
    this.#show('');
  }

  /** Stops the robot of the group where another pupil drives it; where this page does, that page's own STOP does. */
  async #stop() {
    if (!this.isDriven) return;
    const group_stops = ++this.#stops;
    for (let tries = 0; tries < STOP_TRIES; tries += 1) {
      try {
        hearStops((await post({ do: 'stop', page: 'group', group_stops }, { keepalive: true })).stops ?? 0);
        return;
      } catch {
        await pause(100);
      }
    }
  }

  /** @param {import('../page/texts.js').Key | ''} key */
  #show(key) {
    const isIn = this.#together !== null;
    this.#form.hidden = this.#there.hidden = isIn;
    this.#leave.hidden = !isIn;
    say(this.#said, key ? text(key, { group: shown(pageState.group.value) }) : text('group_told'));
  }
}
