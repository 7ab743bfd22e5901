// A pupil's group: joins one by its name, shows who is in it, and leaves it.

import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { element, setText } from '../page/elements.js';
import { onEscapeKey } from '../page/escape.js';
import { bugSentence } from '../page/faults.js';
import { pageState } from '../page/page_state.js';
import { showSide } from '../page/sides.js';
import { text } from '../page/texts.js';
import { noteStopCount, post } from '../robot/host.js';
import { asPlainText } from '../robot/plain_text.js';
import { pause } from '../robot/transport.js';
import { Membership } from './member.js';
import { makeMateElements } from './together.js';

const STOP_TRIES = 5;

/** @typedef {{name: string, members: string[]}} GroupRow */

export class Group {
  #section;
  #sideButton = element('side_class', HTMLButtonElement);
  #nameInput = makeElement('input');
  #joinForm = makeElement('form', '', makeLabel('group_name', this.#nameInput), makeElement('button', 'group_join'));
  #groupList = makeElement('p');
  #statusElement = makeElement('p');
  #matesElement = makeElement('p');
  #leaveButton = makeButton('group_leave', () => this.leave());
  /** @type {Membership} */
  #membership;
  #stopCount = 0; // that were pressed while somebody else drives
  /** Whether another pupil of the group has the robot. */
  isDrivenByMate = false;

  /** @param {import('./classroom.js').Page} page */
  constructor(page) {
    this.#membership = new Membership(page, {
      onStateChange: (key) => this.#showState(key),
      onBug: (error) => setText(this.#statusElement, bugSentence(error)),
      onMatesChange: (mates) => this.#matesElement.replaceChildren(...makeMateElements(mates.map((mate) => ({ ...mate, name: asPlainText(mate.name) })))),
    });
    this.#section = makeElement('section', '', makeElement('h2', 'group'), this.#joinForm, this.#groupList, this.#statusElement, this.#matesElement, this.#leaveButton);
    this.#section.id = 'class_group';
    this.#sideButton.dataset['text'] = 'group';
    this.#sideButton.textContent = text('group');
    this.#nameInput.maxLength = 24;
    this.#nameInput.autocomplete = 'off';
    this.#nameInput.required = true;
    this.#statusElement.setAttribute('role', 'status');
    this.#matesElement.id = 'class_mates';
    this.#joinForm.addEventListener('submit', (event) => {
      event.preventDefault();
      this.#join(this.#nameInput.value);
    });
    element('class', HTMLElement).append(this.#section);
    element('run', HTMLButtonElement).addEventListener('click', () => this.#membership.finishEdit());
    element('stop', HTMLButtonElement).addEventListener('click', () => this.#stop());
    onEscapeKey(() => this.#stop());
    this.#showState('');
  }

  get isJoining() { return this.#membership.isJoining; }

  /** The page is in the class. */
  enter() {
    this.#sideButton.hidden = false;
    this.#membership.resume();
  }

  /** The page is not in the class any more. */
  exit() {
    if (pageState.sideId.value === this.#sideButton.id) showSide('side_real'); // where one comes in again
    this.#sideButton.hidden = true;
    this.#membership.endMembership();
    this.isDrivenByMate = false;
  }

  /** @param {GroupRow[]} groups that there are @param {string} driverName who has the robot of this one */
  showGroups(groups, driverName) {
    this.isDrivenByMate = driverName !== '';
    if (this.#membership.isInGroup) return;
    const groupsKey = JSON.stringify(groups);
    if (this.#groupList.dataset['groups'] === groupsKey) return;
    this.#groupList.dataset['groups'] = groupsKey;
    this.#groupList.replaceChildren(...groups.map(({ name, members }) => makeButton('', () => this.#join(name), members.length ? `${asPlainText(name)} (${members.map((member) => asPlainText(member)).join(', ')})` : asPlainText(name))));
  }

  leave() {
    this.#membership.leave();
    this.isDrivenByMate = false;
  }

  /** @param {string} name */
  #join(name) {
    this.#membership.join({ do: 'group_join', name });
  }

  /** Stops the robot of the group where another pupil drives it; where this page does, that page's own STOP does. */
  async #stop() {
    if (!this.isDrivenByMate) return;
    const group_stops = ++this.#stopCount;
    for (let tryNumber = 0; tryNumber < STOP_TRIES; tryNumber += 1) {
      try {
        noteStopCount((await post({ do: 'stop', page: 'group', group_stops }, { keepalive: true })).stops ?? 0);
        return;
      } catch {
        await pause(100);
      }
    }
  }

  /** @param {import('../page/texts.js').Key | ''} key */
  #showState(key) {
    const { isInGroup } = this.#membership;
    this.#joinForm.hidden = this.#groupList.hidden = isInGroup;
    this.#leaveButton.hidden = !isInGroup;
    setText(this.#statusElement, key ? text(key, { group: asPlainText(pageState.groupName.value) }) : text('group_told'));
  }
}
