// A pupil's group: joins one by its name, shows who is in it, and leaves it.

import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { element, say } from '../page/elements.js';
import { onEscapeKey } from '../page/escape.js';
import { bugSentence } from '../page/faults.js';
import { pageState } from '../page/page_state.js';
import { text } from '../page/texts.js';
import { hearStops, post } from '../robot/host.js';
import { plainText } from '../robot/plain_text.js';
import { pause } from '../robot/transport.js';
import { Membership } from './member.js';
import { named } from './together.js';

const STOP_TRIES = 5;

/** @typedef {{name: string, members: string[]}} Seen */

export class Group {
  #box;
  #name = makeElement('input');
  #form = makeElement('form', '', makeLabel('group_name', this.#name), makeElement('button', 'group_join'));
  #there = makeElement('p');
  #said = makeElement('p');
  #mates = makeElement('p');
  #leave = makeButton('group_leave', () => this.leave());
  /** @type {Membership} */
  #member;
  #stops = 0; // that were pressed while somebody else drives
  /** Whether another pupil of the group has the robot. */
  isDriven = false;

  /** @param {import('./classroom.js').Page} page @param {HTMLElement} box */
  constructor(page, box) {
    this.#member = new Membership(page, {
      say: (key) => this.#show(key),
      fails: (why) => say(this.#said, bugSentence(why)),
      others: (others) => this.#mates.replaceChildren(...named(others.map((each) => ({ ...each, name: plainText(each.name) })))),
    });
    this.#box = makeElement('section', '', makeElement('h2', 'group'), this.#form, this.#there, this.#said, this.#mates, this.#leave);
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
    element('run', HTMLButtonElement).addEventListener('click', () => this.#member.finish());
    element('stop', HTMLButtonElement).addEventListener('click', () => this.#stop());
    onEscapeKey(() => this.#stop());
    this.#show('');
  }

  /** The page is in the class. */
  enter() {
    this.#box.hidden = false;
    this.#member.goOn();
  }

  /** The page is not in the class any more. */
  exit() {
    this.#box.hidden = true;
    this.#member.end();
    this.isDriven = false;
  }

  /** @param {Seen[]} groups that there are @param {string} driver who has the robot of this one */
  see(groups, driver) {
    this.isDriven = driver !== '';
    if (this.#member.isIn) return;
    const said = JSON.stringify(groups);
    if (this.#there.dataset['groups'] === said) return;
    this.#there.dataset['groups'] = said;
    this.#there.replaceChildren(...groups.map(({ name, members }) => makeButton('', () => this.#join(name), members.length ? `${plainText(name)} (${members.map((each) => plainText(each)).join(', ')})` : plainText(name))));
  }

  leave() {
    this.#member.leave();
    this.isDriven = false;
  }

  /** @param {string} name */
  #join(name) {
    this.#member.join({ do: 'group_join', name });
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
    const { isIn } = this.#member;
    this.#form.hidden = this.#there.hidden = isIn;
    this.#leave.hidden = !isIn;
    say(this.#said, key ? text(key, { group: plainText(pageState.groupName.value) }) : text('group_told'));
  }
}
