// The teacher's page of a class: the wall of its pupils, and what a teacher may do with them. The
// program and the virtual robot are behind the wall, for who wants to show something.
// Everything that pupils and robots have written is put there as text, never as markup.

import { Pictures } from '../blocks/drawn.js';
import { BigCode, BigPupil } from './big.js';
import { GivingWindow } from './giving.js';
import { HandoutWindow } from './handout.js';
import { openWork, saveWork } from './keeping.js';
import { Membership } from './member.js';
import { fetchRun } from './run.js';
import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { makeIcon } from './icons.js';
import { clockText } from './clock.js';
import { robotText, Wall } from './wall.js';
import { makeWindow } from './windows.js';
import { element, setText } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { fetchPorts, post } from '../robot/host.js';
import { asPlainText } from '../robot/plain_text.js';
import { pageState } from '../page/page_state.js';
import { textKey, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';

/** @typedef {{number: number, name: string, silent_s: number, place: number, robot: string, is_running: boolean, left_s: number, version: number, is_right: boolean, hand: number, lessons: string[], own_robot: import('../page/own_robot.js').OwnRobot}} PupilRow */
/** @typedef {{port: string, name: string, pupil: string, left_s: number}} RobotRow */
/** @typedef {{key: string, name: string, lessons: string[], given: number, alike: number[]}} KeptRow `given` and `alike` are pupils: whose page is to have it, who may be who made it */
/** @typedef {{key: string, name: string, pupils: number[], version: number}} GroupRow */
/** @typedef {{code: string, groups: GroupRow[], turn_s: number, places: number, over: string, goes_on: boolean, lessons: number, handout: {lesson: number, opened: number} | null, kept: KeptRow[], pupils: PupilRow[], robots: RobotRow[]}} ClassState */
/** @typedef {{text: string, robot: string, version: number, history: string[]}} KnownProgram what is known of a program */

const POLL_MS = 1000;
const GROUP_PREFIX = 'group '; // before the class's key of a group
const CONFIRM_MS = 5000;
const MAX_NAMED_HANDS = 4; // hands that are named above the wall

export class Teacher {
  #wall = new Wall({
    enlarge: (key) => this.#showBigPupil(key), remove: (key) => this.#removeTile(key), lowerHand: (key) => this.#requestForTile('class_hand', key), playRun: (key) => this.#playRun(key),
    visitGroup: (key) => this.#visitGroup(key),
  });
  #page;
  #blockPictures;
  #bigPupil = new BigPupil({
    step: (offset) => this.#stepTile(offset),
    stop: (key) => this.#requestForTile('class_stop', key),
    endTurn: (key) => this.#requestForTile('class_next', key),
    remove: (key) => {
      this.#removeTile(key);
      this.#bigPupil.dialog.close();
    },
    lowerHand: (key) => this.#requestForTile('class_hand', key),
  });
  #bigCode = new BigCode();
  #codeElement = makeElement('strong');
  #statusElement = makeElement('p');
  #robotChips = makeElement('ul');
  #robotList = makeElement('ul');
  #emptyNotice = makeElement('div', '', makeElement('h2', 'class_nobody'), makeElement('p', 'class_nobody_told'));
  #portSelect = makeElement('select');
  #minutesInput = makeNumberInput('1', '60');
  #placesInput = makeNumberInput('1', '60');
  #erasesInput = makeElement('input');
  #settingsWindow = makeWindow('class_window', 'class_settings');
  /** @type {HandoutWindow} */
  #handoutWindow;
  #fileInput = makeElement('input');
  #endButton = makeConfirmedButton('class_end', () => this.#request({ do: 'class_over', erases: this.#erasesInput.checked }));
  #givingWindow = new GivingWindow((key, pupilNumber) => this.#request({ do: 'class_give_back', key, pupil: pupilNumber }));
  #giveBackButton = makeButton('class_give_back', () => this.#givingWindow.dialog.showModal());
  #beginAnewButton = makeConfirmedButton('class_anew', () => this.#request({ do: 'class_anew' }));
  #leaveButton = makeButton('', () => this.#leaveGroup());
  /** @type {Membership} */
  #membership;
  #visitTextKey = ''; // of what is said of the group in which the teacher is
  /** @type {ClassState | null} */
  #classState = null;
  /** @type {Map<string, KnownProgram>} */
  #knownPrograms = new Map();
  /** @type {Map<string, number>} the version that is being fetched */
  #pendingVersions = new Map();
  #notice = ''; // of a file or a run, until the next one
  #pendingRunKey = ''; // whose run is asked for
  #pollTimer = 0;
  #requestCount = 0; // the number of the newest request, and of the newest whose answer is seen
  #lastAnsweredNumber = 0;

  /** @param {import('./classroom.js').Page} page */
  constructor(page) {
    this.#page = page;
    this.#blockPictures = new Pictures(page.python, 'class_blocks');
    this.#handoutWindow = new HandoutWindow(page, (handout) => this.#request({ do: 'class_hand_out', ...handout }));
    this.#membership = new Membership(page, {
      onStateChange: (key) => this.#showVisit(key),
      onBug: (error) => pageState.note.set(bugSentence(error)),
      onMatesChange: () => {}, // their names are beside the lines
    });
    const sideButton = element('side_class', HTMLButtonElement);
    sideButton.hidden = false;
    sideButton.addEventListener('click', () => this.#showWall(true));
    this.#statusElement.setAttribute('role', 'status');
    this.#statusElement.id = 'class_said';
    this.#robotChips.id = 'class_chips';
    this.#robotChips.tabIndex = 0; // it may be scrolled
    this.#emptyNotice.id = 'class_empty';
    this.#minutesInput.addEventListener('change', () => this.#request({ do: 'class_turn', seconds: 60 * wholeNumberOf(this.#minutesInput) }));
    this.#placesInput.addEventListener('change', () => this.#request({ do: 'class_places', places: wholeNumberOf(this.#placesInput) }));
    this.#addHeadButtons();
    this.#addSettings();
    this.#giveBackButton.hidden = this.#beginAnewButton.hidden = true;
    const settingsButton = makeButton('class_settings', () => this.#openSettings());
    settingsButton.id = 'class_settings';
    const handoutButton = makeButton('class_hand_out', () => this.#openHandoutWindow());
    const bar = makeElement('div', '', this.#statusElement, this.#robotChips, this.#giveBackButton, this.#beginAnewButton, handoutButton, settingsButton);
    bar.id = 'class_bar';
    element('class', HTMLElement).append(bar, this.#wall.element, this.#emptyNotice);
    pageState.language.subscribe(() => this.#updateLanguage());
    this.#lookForPorts();
    this.#request({ do: 'class' });
    sideButton.click();
    element('run', HTMLButtonElement).addEventListener('click', () => this.#membership.finishEdit());
    if (this.#membership.resume()) this.#showStudio();
  }

  /** Into the page's head: how pupils come in, and STOP for all, with its answer beside it. */
  #addHeadButtons() {
    const head = /** @type {HTMLElement} */ (document.querySelector('body > header'));
    const stopButton = element('stop', HTMLButtonElement);
    for (const button of [stopButton, element('programs_stop', HTMLButtonElement)]) { // which stop the same robots
      button.dataset['text'] = 'class_stop_all';
      button.textContent = text('class_stop_all');
    }
    const codeButton = makeButton('', () => this.#bigCode.show(this.#codeElement.textContent ?? ''), makeElement('span', 'class_address'), makeElement('strong', '', location.origin), makeElement('span', 'class_code'), this.#codeElement);
    codeButton.id = 'class_come';
    const studioButton = makeButton('class_studio', () => this.#showStudio());
    studioButton.id = 'class_studio';
    this.#leaveButton.id = 'class_leave';
    this.#leaveButton.hidden = true;
    stopButton.before(studioButton, this.#leaveButton, codeButton, element('stops', HTMLElement));
    head.append(stopButton);
  }

  #addSettings() {
    this.#erasesInput.type = 'checkbox';
    this.#fileInput.type = 'file';
    this.#fileInput.accept = '.json,application/json';
    this.#fileInput.hidden = true;
    this.#fileInput.addEventListener('change', () => this.#openClassWork());
    this.#settingsWindow.append(
      makeElement('section', '', makeElement('h3', 'class_robots'), this.#robotList,
        makeElement('p', '', makeLabel('link_port', this.#portSelect), makeButton('class_give', () => this.#lendPort()), makeButton('link_look', () => this.#lookForPorts())),
        makeElement('p', '', makeLabel('class_minutes', this.#minutesInput)), makeElement('p', '', makeLabel('class_places', this.#placesInput))),
      makeElement('section', '', makeElement('h3', 'class_work'), makeElement('p', 'class_work_told'),
        makeElement('p', '', makeButton('class_save', () => this.#saveClassWork()), makeButton('class_open', () => this.#fileInput.click()), this.#fileInput)),
      makeElement('section', '', makeElement('h3', 'class_code'),
        // Each button that is pressed twice has a row: its second text is longer, and stays where the first was.
        makeElement('p', '', makeButton('class_new_code', () => this.#request({ do: 'class_code' }))), makeElement('p', '', makeConfirmedButton('class_anew', () => this.#request({ do: 'class_anew' })))),
      makeElement('section', '', makeElement('h3', 'class_end'), makeElement('p', '', makeElement('span', 'class_end_told'), makeButton('class_save', () => this.#saveClassWork())),
        makeElement('p', '', makeElement('label', '', this.#erasesInput, makeElement('span', 'class_erases'))), makeElement('p', '', this.#endButton)));
  }

  #openHandoutWindow() {
    this.#handoutWindow.open(this.#classState?.lessons ?? 0).catch(() => {}); // the lessons have numbers, at least
  }

  #openSettings() {
    this.#lookForPorts();
    this.#settingsWindow.showModal();
  }

  /** @param {boolean} isShown else the program and the virtual robot */
  #showWall(isShown) {
    document.documentElement.toggleAttribute('data-wall', isShown);
    dispatchEvent(new Event('resize'));
  }

  #showStudio() {
    this.#showWall(false);
    element('side_virtual', HTMLButtonElement).click();
  }

  /** Edits with a group, which sees that. It takes no robot. @param {string} key */
  #visitGroup(key) {
    if (this.#membership.isInGroup) this.#membership.endMembership();
    this.#showStudio();
    this.#membership.join({ do: 'group_visit', group: key.slice(GROUP_PREFIX.length), name: text('class_teacher') });
  }

  #leaveGroup() {
    this.#membership.leave();
    element('side_class', HTMLButtonElement).click();
  }

  /** @param {import('../page/texts.js').Key | ''} key */
  #showVisit(key) {
    const groupName = asPlainText(pageState.groupName.value);
    this.#leaveButton.hidden = !this.#membership.isInGroup;
    setText(this.#leaveButton, text('class_leave_of', { name: groupName }));
    if (this.#visitTextKey === key) return;
    this.#visitTextKey = key;
    pageState.note.set(key ? text(key, { group: groupName }) : '');
  }

  /** Plays a pupil's newest run here. @param {string} key */
  async #playRun(key) {
    const pupilRow = this.#pupilRowOf(key);
    if (!pupilRow || this.#pendingRunKey) return;
    this.#pendingRunKey = key;
    this.#setNotice(text('class_run_asked', { name: asPlainText(pupilRow.name) }));
    const run = await fetchRun(pupilRow.number).catch(() => null);
    this.#pendingRunKey = '';
    this.#setNotice(run ? '' : text(run === null ? 'class_run_silent' : 'class_run_none', { name: asPlainText(pupilRow.name) }));
    if (!run) return;
    this.#showStudio();
    await this.#page.openRun(new File([run], `${asPlainText(pupilRow.name)}.tsr`));
  }

  /** @param {string} notice beside the count, until the next one */
  #setNotice(notice) {
    this.#notice = notice;
    if (this.#classState) this.#showState(this.#classState);
  }

  #updateLanguage() {
    this.#blockPictures.updateLanguage();
    for (const program of this.#knownPrograms.values()) program.version = -1; // the words of the pictures are others
    if (this.#classState) this.#showState(this.#classState);
  }

  /** The pupils of a tile, which are several where it is a group's. @param {string} key */
  #pupilsOfTile(key) {
    const { pupils: pupilRows = [], groups = [] } = this.#classState ?? {};
    const memberNumbers = groups.find((group) => groupTileKey(group.key) === key)?.pupils;
    return pupilRows.filter(({ number }) => (memberNumbers ? memberNumbers.includes(number) : pupilTileKey(number) === key));
  }

  /** @param {Record<string, unknown>} fields */
  async #request(fields) {
    clearTimeout(this.#pollTimer);
    this.#requestCount += 1;
    const requestNumber = this.#requestCount;
    try {
      const state = /** @type {ClassState} */ (await post(fields));
      if (requestNumber < this.#lastAnsweredNumber) return; // an older state than is seen
      this.#lastAnsweredNumber = requestNumber;
      this.#showState(state);
      if (state.over) return;
    } catch {
      if (this.#classState?.over) return; // it ends with its class
      this.#sayInBar('why_host_gone');
    }
    clearTimeout(this.#pollTimer);
    this.#pollTimer = window.setTimeout(() => this.#request({ do: 'class' }), POLL_MS);
  }

  /** @param {string} action @param {string} key */
  #requestForTile(action, key) {
    const pupilRows = this.#pupilsOfTile(key);
    for (const { number, hand, robot: robotName } of pupilRows) {
      if (pupilRows.length === 1 || (action === 'class_hand' ? hand : robotName)) this.#request({ do: action, pupil: number });
    }
  }

  /** @param {string} key */
  #removeTile(key) {
    if (this.#pupilRowOf(key)) this.#requestForTile('class_remove', key);
    else this.#request({ do: 'class_forget', key: keptWorkKey(key) });
  }

  /** @param {string} key */
  #pupilRowOf(key) {
    return this.#classState?.pupils.find(({ number }) => pupilTileKey(number) === key) ?? null;
  }

  async #lookForPorts() {
    try {
      const hostPortList = await fetchPorts();
      this.#portSelect.replaceChildren(...hostPortList.map(({ port: portId, name }) => new Option(asPlainText([name, portId].filter(Boolean).join(' · ')), portId)));
    } catch {
      this.#sayInBar('why_host_gone');
    }
  }

  #lendPort() {
    if (this.#portSelect.value) this.#request({ do: 'class_robot', port: this.#portSelect.value, gives: true });
  }

  async #saveClassWork() {
    this.#notice = await saveWork().then((count) => text('class_saved', { count }), () => text('why_host_gone'));
    this.#settingsWindow.close();
    if (this.#classState) this.#showState(this.#classState);
  }

  async #openClassWork() {
    const file = this.#fileInput.files?.[0];
    this.#fileInput.value = '';
    if (!file) return;
    const count = await openWork(file);
    this.#notice = count ? text('class_opened', { count }) : text('class_not_opened', { name: asPlainText(file.name) });
    this.#knownPrograms.forEach((program, key) => {
      if (!this.#pupilRowOf(key)) program.version = -1;
    });
    this.#settingsWindow.close();
    this.#request({ do: 'class' });
  }

  // -- what is seen -------------------------------------------------------------------------------

  /** @param {ClassState} state */
  #showState(state) {
    const { code, turn_s, places, over: overReason, goes_on, lessons, handout, kept: keptRows, pupils, robots } = this.#classState = state;
    setText(this.#codeElement, code);
    this.#bigCode.setCode(code);
    if (document.activeElement !== this.#minutesInput) this.#minutesInput.value = String(Math.round(turn_s / 60));
    if (document.activeElement !== this.#placesInput) this.#placesInput.value = String(places);
    if (overReason) {
      this.#sayInBar('class_over');
      this.#settingsWindow.close();
      this.#bigPupil.dialog.close();
      this.#givingWindow.dialog.close();
      this.#handoutWindow.dialog.close();
      element('class', HTMLElement).replaceChildren(this.#statusElement); // nobody is left to do the rest
      return;
    }
    const raisedHands = pupils.filter(({ hand }) => hand).sort((first, second) => first.hand - second.hand);
    const handNames = raisedHands.slice(0, MAX_NAMED_HANDS).map(({ name }) => asPlainText(name)).join(', ') + (raisedHands.length > MAX_NAMED_HANDS ? ` +${raisedHands.length - MAX_NAMED_HANDS}` : '');
    const count = text('class_count', { pupils: pupils.length, robots: robots.length, waiting: pupils.filter(({ place: queuePlace }) => queuePlace).length });
    setText(this.#statusElement, [count, raisedHands.length ? text('class_hands', { names: handNames }) : '', handout ? text(handout.lesson ? 'class_opened_lesson' : 'class_opened_program', { number: handout.lesson, opened: handout.opened, pupils: pupils.length }) : '', this.#notice || (goes_on ? text('class_goes_on') : '')].filter(Boolean).join(' '));
    document.documentElement.dataset['teacher'] = 'class_count';
    this.#giveBackButton.hidden = !keptRows.length || !pupils.length;
    this.#givingWindow.show(keptRows, pupils);
    this.#beginAnewButton.hidden = !goes_on;
    this.#showRobots(robots);
    const tiles = this.#makeTiles();
    this.#emptyNotice.hidden = tiles.length > 0;
    this.#wall.element.hidden = !tiles.length;
    this.#wall.show(tiles, lessons);
    for (const { key, pupil } of tiles) this.#fetchProgram(key, pupil ? pupil.version : 0);
    for (const key of [...this.#knownPrograms.keys()]) {
      if (tiles.some((tile) => tile.key === key)) continue;
      this.#knownPrograms.delete(key);
      this.#blockPictures.forget(key);
    }
    if (this.#bigPupil.key) this.#showBigPupil(this.#bigPupil.key);
  }

  /** Who is here, and the work of who is not, by name. */
  #makeTiles() {
    const { pupils = [], kept: keptRows = [], groups = [] } = this.#classState ?? {};
    const nonEmptyGroups = groups.map((group) => ({ ...group, members: this.#pupilsOfTile(groupTileKey(group.key)) })).filter(({ members }) => members.length);
    const ungroupedPupils = pupils.filter(({ number }) => !nonEmptyGroups.some(({ members }) => members.some((member) => member.number === number)));
    const tiles = ungroupedPupils.map((pupil) => ({ key: pupilTileKey(pupil.number), name: pupil.name, lessons: pupil.lessons, pupil: /** @type {PupilRow | null} */ (pupil) }));
    for (const { key, name, members, version } of nonEmptyGroups) tiles.push(makeGroupTile(groupTileKey(key), name, members, version));
    for (const { key, name, lessons } of keptRows) tiles.push({ key: `kept ${key}`, name, lessons, pupil: null });
    return tiles.sort((first, second) => first.name.localeCompare(second.name, undefined, { numeric: true }) || (first.key < second.key ? -1 : 1));
  }

  /** @param {RobotRow[]} robots */
  #showRobots(robots) {
    const rows = robots.map((robot) => ({ ...robot, title: asPlainText(robot.name || robot.port), stateText: robot.pupil ? text('class_held', { name: asPlainText(robot.pupil), time: clockText(robot.left_s) }) : text('class_free') }));
    const chipsKey = JSON.stringify(rows.map(({ title, pupil: pupilName }) => [title, Boolean(pupilName)]));
    if (this.#robotChips.dataset['seen'] !== chipsKey) {
      this.#robotChips.dataset['seen'] = chipsKey;
      this.#robotChips.replaceChildren(...rows.map(({ title, pupil: pupilName }) => {
        const chip = makeElement('li', '', makeIcon('robot', 20), makeElement('strong', '', title), makeElement('span'));
        chip.classList.toggle('held', Boolean(pupilName));
        return chip;
      }));
      this.#robotChips.hidden = !rows.length;
    }
    rows.forEach(({ stateText }, index) => setText(/** @type {HTMLElement} */ (this.#robotChips.children[index]?.lastElementChild), stateText));
    const portsKey = JSON.stringify(robots.map(({ port: portId, name }) => [portId, name]));
    if (this.#robotList.dataset['seen'] === portsKey) return;
    this.#robotList.dataset['seen'] = portsKey;
    this.#robotList.replaceChildren(...robots.map(({ port: portId, name }) => makeElement('li', '', makeElement('strong', '', asPlainText([name, portId].filter(Boolean).join(' · '))), ' ',
      makeButton('class_take', () => this.#request({ do: 'class_robot', port: portId, gives: false })))));
  }

  /** Fetches a program that is another one now, and wants its picture. @param {string} key @param {number} version */
  async #fetchProgram(key, version) {
    if (this.#knownPrograms.get(key)?.version === version || this.#pendingVersions.get(key) === version) return;
    this.#pendingVersions.set(key, version);
    try {
      const pupil = this.#pupilRowOf(key);
      const owner = pupil ? { pupil: pupil.number } : key.startsWith(GROUP_PREFIX) ? { group: key.slice(GROUP_PREFIX.length) } : { key: keptWorkKey(key) };
      const answer = await post({ do: 'class_text', ...owner });
      const program = { text: String(answer.text), robot: String(answer.robot || 'tinibot'), version: Number(answer.version), history: answer.history ?? [] };
      this.#knownPrograms.set(key, program);
      this.#blockPictures.request(key, program, (address) => {
        if (!this.#wall.setPicture(key, address)) URL.revokeObjectURL(address);
        if (this.#bigPupil.key === key) this.#showBigPupil(key);
      });
      if (this.#bigPupil.key === key) this.#showBigPupil(key);
    } catch {
      // it is asked for again, or the pupil has gone
    } finally {
      this.#pendingVersions.delete(key);
    }
  }

  /** @param {string} key */
  #showBigPupil(key) {
    const tile = this.#makeTiles().find((candidate) => candidate.key === key);
    if (!tile) {
      this.#bigPupil.dialog.close();
      return;
    }
    const { pupil } = tile;
    const program = this.#knownPrograms.get(key);
    const drivesText = robotText(pupil);
    const lessonsText = text('class_lessons', { done: tile.lessons.length, all: this.#classState?.lessons ?? 0 });
    this.#bigPupil.show({
      key, title: asPlainText(tile.name), stateText: [drivesText, lessonsText].filter(Boolean).join(', '), picture: this.#wall.pictureAddressOf(key), text: program?.text || text('class_empty'), history: program?.history ?? [],
      isDriving: Boolean(drivesText), isHandUp: Boolean(pupil?.hand),
    });
  }

  /** @param {number} offset */
  #stepTile(offset) {
    const tiles = this.#makeTiles();
    const index = tiles.findIndex(({ key }) => key === this.#bigPupil.key);
    const nextTile = tiles.at((index + offset) % tiles.length);
    if (nextTile) this.#showBigPupil(nextTile.key);
  }

  /** @param {import('../page/texts.js').Key} key */
  #sayInBar(key) {
    setText(this.#statusElement, text(key));
    document.documentElement.dataset['teacher'] = key;
  }
}

/** A button of what cannot be taken back: it acts at the second press. @param {'class_end' | 'class_anew'} key @param {() => void} onConfirm */
function makeConfirmedButton(key, onConfirm) {
  let isArmed = false, disarmTimer = 0;
  const confirmedButton = makeButton(key, (event) => {
    if (isSecondPress(event)) return; // a habit is no second thought
    if (isArmed) onConfirm();
    setArmed(!isArmed);
  });
  const setArmed = (/** @type {boolean} */ isNowArmed) => {
    isArmed = isNowArmed;
    const textKeyNow = isNowArmed ? textKey(`${key}_sure`) : key;
    confirmedButton.dataset['text'] = textKeyNow;
    confirmedButton.textContent = text(textKeyNow);
    clearTimeout(disarmTimer);
    if (isNowArmed) disarmTimer = window.setTimeout(() => setArmed(false), CONFIRM_MS);
  };
  return confirmedButton;
}

/** @param {string} key of the class */
function groupTileKey(key) {
  return `${GROUP_PREFIX}${key}`;
}

/** A tile of a group: what any of its pupils has, it has. @param {string} key @param {string} name @param {PupilRow[]} members @param {number} version */
function makeGroupTile(key, name, members, version) {
  const mainMember = /** @type {PupilRow} */ (members.find(({ robot: robotName }) => robotName) ?? members[0]);
  const lessons = [...new Set(members.flatMap((member) => member.lessons))];
  const pupil = {
    ...mainMember, version, lessons,
    silent_s: Math.min(...members.map((member) => member.silent_s)),
    is_right: members.every((member) => member.is_right),
    hand: Math.max(...members.map((member) => member.hand)),
    place: Math.max(...members.map((member) => member.place)),
    own_robot: { ...mainMember.own_robot, name: members.map((member) => member.name).join(', ') },
  };
  return { key, name, lessons, pupil: /** @type {PupilRow | null} */ (pupil) };
}

/** @param {number} pupilNumber */
function pupilTileKey(pupilNumber) {
  return `pupil ${pupilNumber}`;
}

/** @param {string} key of who is not here */
function keptWorkKey(key) {
  return key.replace(/^kept /, '');
}

/** @param {string} lowest @param {string} highest */
function makeNumberInput(lowest, highest) {
  const field = makeElement('input');
  Object.assign(field, { type: 'number', min: lowest, max: highest });
  return field;
}

/** A whole number within the field's limits. @param {HTMLInputElement} field */
function wholeNumberOf(field) {
  return Math.min(Number(field.max), Math.max(Number(field.min), Math.round(Number(field.value)) || 1));
}
