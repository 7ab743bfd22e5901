// The teacher's page of a class: the wall of its pupils, and what a teacher may do with them. The
// program and the virtual robot are behind the wall, for who wants to show something.
// Everything that pupils and robots have written is put there as text, never as markup.

import { Pictures } from '../blocks/drawn.js';
import { BigCode, BigPupil } from './big.js';
import { Giving } from './giving.js';
import { openWork, saveWork } from './keeping.js';
import { Membership } from './member.js';
import { runOf } from './run.js';
import { makeButton, makeLabel, makeElement } from '../page/made.js';
import { sign } from './signs.js';
import { clock, Wall } from './wall.js';
import { element, say } from '../page/elements.js';
import { bugSentence } from '../page/faults.js';
import { hostPorts, post } from '../robot/host.js';
import { plainText } from '../robot/plain_text.js';
import { pageState } from '../page/page_state.js';
import { textKey, text } from '../page/texts.js';
import { isSecondPress } from '../page/twice.js';

/** @typedef {{number: number, name: string, silent_s: number, place: number, robot: string, left_s: number, version: number, is_right: boolean, hand: number, lessons: string[], own_robot: import('../page/own_robot.js').OwnRobot}} PupilRow */
/** @typedef {{port: string, name: string, pupil: string, left_s: number}} RobotRow */
/** @typedef {{key: string, name: string, lessons: string[], given: number, alike: number[]}} KeptRow `given` and `alike` are pupils: whose page is to have it, who may be who made it */
/** @typedef {{key: string, name: string, pupils: number[], version: number}} GroupRow */
/** @typedef {{code: string, groups: GroupRow[], turn_s: number, places: number, over: string, goes_on: boolean, lessons: number, kept: KeptRow[], pupils: PupilRow[], robots: RobotRow[]}} State */
/** @typedef {{text: string, robot: string, version: number, history: string[]}} Known what is known of a program */

const LOOK_MS = 1000;
const GROUP = 'group '; // before the class's key of a group
const SURE_MS = 5000;
const MOST_NAMED = 4; // hands that are named above the wall

export class Teacher {
  #wall = new Wall({
    see: (key) => this.#showBig(key), remove: (key) => this.#remove(key), lower: (key) => this.#ofPupil('class_hand', key), play: (key) => this.#play(key),
    join: (key) => this.#visit(key),
  });
  #page;
  #pictures;
  #big = new BigPupil({
    step: (by) => this.#step(by),
    stop: (key) => this.#ofPupil('class_stop', key),
    next: (key) => this.#ofPupil('class_next', key),
    remove: (key) => {
      this.#remove(key);
      this.#big.window.close();
    },
    lower: (key) => this.#ofPupil('class_hand', key),
  });
  #bigCode = new BigCode();
  #code = makeElement('strong');
  #said = makeElement('p');
  #chips = makeElement('ul');
  #robots = makeElement('ul');
  #empty = makeElement('div', '', makeElement('h2', 'class_nobody'), makeElement('p', 'class_nobody_told'));
  #ports = makeElement('select');
  #minutes = number('1', '60');
  #places = number('1', '60');
  #erases = makeElement('input');
  #settings = makeElement('dialog');
  #file = makeElement('input');
  #end = pressedTwice('class_end', () => this.#ask({ do: 'class_over', erases: this.#erases.checked }));
  #giving = new Giving((key, pupil) => this.#ask({ do: 'class_give_back', key, pupil }));
  #giveBack = makeButton('class_give_back', () => this.#giving.window.showModal());
  #anew = pressedTwice('class_anew', () => this.#ask({ do: 'class_anew' }));
  #leave = makeButton('', () => this.#leaveGroup());
  /** @type {Membership} */
  #member;
  #visitSaid = ''; // of the group in which the teacher is
  /** @type {State | null} */
  #state = null;
  /** @type {Map<string, Known>} */
  #known = new Map();
  /** @type {Map<string, number>} the version that is being fetched */
  #fetching = new Map();
  #told = ''; // of a file or a run, until the next one
  #playing = ''; // whose run is asked for
  #timer = 0;
  #asked = 0; // the number of the newest request, and of the newest whose answer is seen
  #answered = 0;

  /** @param {import('./classroom.js').Page} page */
  constructor(page) {
    this.#page = page;
    this.#pictures = new Pictures(page.python, 'class_blocks');
    this.#member = new Membership(page, {
      say: (key) => this.#showVisit(key),
      fails: (why) => pageState.note.set(bugSentence(why)),
      others: () => {}, // their names are beside the lines
    });
    const side = element('side_class', HTMLButtonElement);
    side.hidden = false;
    side.addEventListener('click', () => this.#showWall(true));
    this.#said.setAttribute('role', 'status');
    this.#said.id = 'class_said';
    this.#chips.id = 'class_chips';
    this.#chips.tabIndex = 0; // it may be scrolled
    this.#empty.id = 'class_empty';
    this.#minutes.addEventListener('change', () => this.#ask({ do: 'class_turn', seconds: 60 * whole(this.#minutes) }));
    this.#places.addEventListener('change', () => this.#ask({ do: 'class_places', places: whole(this.#places) }));
    this.#putTop();
    this.#putSettings();
    this.#giveBack.hidden = this.#anew.hidden = true;
    const gear = makeButton('class_settings', () => this.#openSettings());
    gear.id = 'class_settings';
    const bar = makeElement('div', '', this.#said, this.#chips, this.#giveBack, this.#anew, gear);
    bar.id = 'class_bar';
    element('class', HTMLElement).append(bar, this.#wall.element, this.#empty);
    pageState.language.subscribe(() => this.#showWords());
    this.#lookForPorts();
    this.#ask({ do: 'class' });
    side.click();
    element('run', HTMLButtonElement).addEventListener('click', () => this.#member.finish());
    if (this.#member.goOn()) this.#showStudio();
  }

  /** Into the page's head: how pupils come in, and STOP for all, with its answer beside it. */
  #putTop() {
    const head = /** @type {HTMLElement} */ (document.querySelector('body > header'));
    const stop = element('stop', HTMLButtonElement);
    stop.dataset['text'] = 'class_stop_all';
    stop.textContent = text('class_stop_all');
    const come = makeButton('', () => this.#bigCode.show(this.#code.textContent ?? ''), makeElement('span', 'class_address'), makeElement('strong', '', location.origin), makeElement('span', 'class_code'), this.#code);
    come.id = 'class_come';
    const studio = makeButton('class_studio', () => this.#showStudio());
    studio.id = 'class_studio';
    this.#leave.id = 'class_leave';
    this.#leave.hidden = true;
    stop.before(studio, this.#leave, come, element('stops', HTMLElement));
    head.append(stop);
  }

  #putSettings() {
    const close = makeButton('close', () => this.#settings.close());
    const stop = makeButton('class_stop_all', () => element('stop', HTMLButtonElement).click());
    stop.className = 'stop';
    this.#settings.id = this.#settings.className = 'class_window';
    this.#settings.setAttribute('aria-labelledby', 'class_window_title');
    const title = makeElement('h2', 'class_settings');
    title.id = 'class_window_title';
    this.#erases.type = 'checkbox';
    this.#file.type = 'file';
    this.#file.accept = '.json,application/json';
    this.#file.hidden = true;
    this.#file.addEventListener('change', () => this.#open());
    this.#settings.append(makeElement('header', '', title, close, stop),
      makeElement('section', '', makeElement('h3', 'class_robots'), this.#robots,
        makeElement('p', '', makeLabel('link_port', this.#ports), makeButton('class_give', () => this.#give()), makeButton('link_look', () => this.#lookForPorts())),
        makeElement('p', '', makeLabel('class_minutes', this.#minutes)), makeElement('p', '', makeLabel('class_places', this.#places))),
      makeElement('section', '', makeElement('h3', 'class_work'), makeElement('p', 'class_work_told'),
        makeElement('p', '', makeButton('class_save', () => this.#save()), makeButton('class_open', () => this.#file.click()), this.#file)),
      makeElement('section', '', makeElement('h3', 'class_code'),
        makeElement('p', '', makeButton('class_new_code', () => this.#ask({ do: 'class_code' })), pressedTwice('class_anew', () => this.#ask({ do: 'class_anew' })))),
      makeElement('section', '', makeElement('h3', 'class_end'), makeElement('p', '', makeElement('label', '', this.#erases, makeElement('span', 'class_erases')), this.#end)));
    document.body.append(this.#settings);
  }

  #openSettings() {
    this.#lookForPorts();
    this.#settings.showModal();
  }

  /** @param {boolean} isWall else the program and the virtual robot */
  #showWall(isWall) {
    document.documentElement.toggleAttribute('data-wall', isWall);
    dispatchEvent(new Event('resize'));
  }

  #showStudio() {
    this.#showWall(false);
    element('side_virtual', HTMLButtonElement).click();
  }

  /** Edits with a group, which sees that. It takes no robot. @param {string} key */
  #visit(key) {
    if (this.#member.isIn) this.#member.end();
    this.#showStudio();
    this.#member.join({ do: 'group_visit', group: key.slice(GROUP.length), name: text('class_teacher') });
  }

  #leaveGroup() {
    this.#member.leave();
    element('side_class', HTMLButtonElement).click();
  }

  /** @param {import('../page/texts.js').Key | ''} key */
  #showVisit(key) {
    const group = plainText(pageState.groupName.value);
    this.#leave.hidden = !this.#member.isIn;
    say(this.#leave, text('class_leave_of', { name: group }));
    if (this.#visitSaid === key) return;
    this.#visitSaid = key;
    pageState.note.set(key ? text(key, { group }) : '');
  }

  /** Plays a pupil's newest run here. @param {string} key */
  async #play(key) {
    const pupil = this.#pupil(key);
    if (!pupil || this.#playing) return;
    this.#playing = key;
    this.#tell(text('class_run_asked', { name: plainText(pupil.name) }));
    const run = await runOf(pupil.number).catch(() => null);
    this.#playing = '';
    this.#tell(run ? '' : text(run === null ? 'class_run_silent' : 'class_run_none', { name: plainText(pupil.name) }));
    if (!run) return;
    this.#showStudio();
    await this.#page.openRun(new File([run], `${plainText(pupil.name)}.tsr`));
  }

  /** @param {string} said beside the count, until the next one */
  #tell(said) {
    this.#told = said;
    if (this.#state) this.#show(this.#state);
  }

  #showWords() {
    this.#pictures.showWords();
    for (const known of this.#known.values()) known.version = -1; // the words of the pictures are others
    if (this.#state) this.#show(this.#state);
  }

  /** The pupils of a tile, which are several where it is a group's. @param {string} key */
  #pupils(key) {
    const { pupils = [], groups = [] } = this.#state ?? {};
    const numbers = groups.find((each) => groupKey(each.key) === key)?.pupils;
    return pupils.filter(({ number }) => (numbers ? numbers.includes(number) : keyOf(number) === key));
  }

  /** @param {Record<string, unknown>} request */
  async #ask(request) {
    clearTimeout(this.#timer);
    this.#asked += 1;
    const number = this.#asked;
    try {
      const state = /** @type {State} */ (await post(request));
      if (number < this.#answered) return; // an older state than is seen
      this.#answered = number;
      this.#show(state);
      if (state.over) return;
    } catch {
      if (this.#state?.over) return; // it ends with its class
      this.#say('why_host_gone');
    }
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => this.#ask({ do: 'class' }), LOOK_MS);
  }

  /** @param {string} what @param {string} key */
  #ofPupil(what, key) {
    const all = this.#pupils(key);
    for (const { number, hand, robot } of all) {
      if (all.length === 1 || (what === 'class_hand' ? hand : robot)) this.#ask({ do: what, pupil: number });
    }
  }

  /** @param {string} key */
  #remove(key) {
    if (this.#pupil(key)) this.#ofPupil('class_remove', key);
    else this.#ask({ do: 'class_forget', key: keptOf(key) });
  }

  /** @param {string} key */
  #pupil(key) {
    return this.#state?.pupils.find(({ number }) => keyOf(number) === key) ?? null;
  }

  async #lookForPorts() {
    try {
      const found = await hostPorts();
      this.#ports.replaceChildren(...found.map(({ port, name }) => new Option(plainText([name, port].filter(Boolean).join(' · ')), port)));
    } catch {
      this.#say('why_host_gone');
    }
  }

  #give() {
    if (this.#ports.value) this.#ask({ do: 'class_robot', port: this.#ports.value, gives: true });
  }

  async #save() {
    this.#told = await saveWork().then((count) => text('class_saved', { count }), () => text('why_host_gone'));
    this.#settings.close();
    if (this.#state) this.#show(this.#state);
  }

  async #open() {
    const file = this.#file.files?.[0];
    this.#file.value = '';
    if (!file) return;
    const count = await openWork(file);
    this.#told = count ? text('class_opened', { count }) : text('class_not_opened', { name: plainText(file.name) });
    this.#known.forEach((known, key) => {
      if (!this.#pupil(key)) known.version = -1;
    });
    this.#settings.close();
    this.#ask({ do: 'class' });
  }

  // -- what is seen -------------------------------------------------------------------------------

  /** @param {State} state */
  #show(state) {
    const { code, turn_s, places, over, goes_on, lessons, kept, pupils, robots } = this.#state = state;
    say(this.#code, code);
    this.#bigCode.change(code);
    if (document.activeElement !== this.#minutes) this.#minutes.value = String(Math.round(turn_s / 60));
    if (document.activeElement !== this.#places) this.#places.value = String(places);
    if (over) {
      this.#say('class_over');
      this.#settings.close();
      this.#big.window.close();
      this.#giving.window.close();
      element('class', HTMLElement).replaceChildren(this.#said); // nobody is left to do the rest
      return;
    }
    const hands = pupils.filter(({ hand }) => hand).sort((one, other) => one.hand - other.hand);
    const named = hands.slice(0, MOST_NAMED).map(({ name }) => plainText(name)).join(', ') + (hands.length > MOST_NAMED ? ` +${hands.length - MOST_NAMED}` : '');
    const count = text('class_count', { pupils: pupils.length, robots: robots.length, waiting: pupils.filter(({ place }) => place).length });
    say(this.#said, [count, hands.length ? text('class_hands', { names: named }) : '', this.#told || (goes_on ? text('class_goes_on') : '')].filter(Boolean).join(' '));
    document.documentElement.dataset['teacher'] = 'class_count';
    this.#giveBack.hidden = !kept.length || !pupils.length;
    this.#giving.show(kept, pupils);
    this.#anew.hidden = !goes_on;
    this.#showRobots(robots);
    const tiles = this.#tiles();
    this.#empty.hidden = tiles.length > 0;
    this.#wall.element.hidden = !tiles.length;
    this.#wall.show(tiles, lessons);
    for (const { key, pupil } of tiles) this.#look(key, pupil ? pupil.version : 0);
    for (const key of [...this.#known.keys()]) {
      if (tiles.some((each) => each.key === key)) continue;
      this.#known.delete(key);
      this.#pictures.forget(key);
    }
    if (this.#big.key) this.#showBig(this.#big.key);
  }

  /** Who is here, and the work of who is not, by name. */
  #tiles() {
    const { pupils = [], kept = [], groups = [] } = this.#state ?? {};
    const together = groups.map((group) => ({ ...group, members: this.#pupils(groupKey(group.key)) })).filter(({ members }) => members.length);
    const alone = pupils.filter(({ number }) => !together.some(({ members }) => members.some((each) => each.number === number)));
    const tiles = alone.map((pupil) => ({ key: keyOf(pupil.number), name: pupil.name, lessons: pupil.lessons, pupil: /** @type {PupilRow | null} */ (pupil) }));
    for (const { key, name, members, version } of together) tiles.push(tileOf(groupKey(key), name, members, version));
    for (const { key, name, lessons } of kept) tiles.push({ key: `kept ${key}`, name, lessons, pupil: null });
    return tiles.sort((one, other) => one.name.localeCompare(other.name, undefined, { numeric: true }) || (one.key < other.key ? -1 : 1));
  }

  /** @param {RobotRow[]} robots */
  #showRobots(robots) {
    const rows = robots.map((each) => ({ ...each, title: plainText(each.name || each.port), said: each.pupil ? text('class_held', { name: plainText(each.pupil), time: clock(each.left_s) }) : text('class_free') }));
    const seen = JSON.stringify(rows.map(({ title, pupil }) => [title, Boolean(pupil)]));
    if (this.#chips.dataset['seen'] !== seen) {
      this.#chips.dataset['seen'] = seen;
      this.#chips.replaceChildren(...rows.map(({ title, pupil }) => {
        const chip = makeElement('li', '', sign('robot', 20), makeElement('strong', '', title), makeElement('span'));
        chip.classList.toggle('held', Boolean(pupil));
        return chip;
      }));
      this.#chips.hidden = !rows.length;
    }
    rows.forEach(({ said }, k) => say(/** @type {HTMLElement} */ (this.#chips.children[k]?.lastElementChild), said));
    const ports = JSON.stringify(robots.map(({ port, name }) => [port, name]));
    if (this.#robots.dataset['seen'] === ports) return;
    this.#robots.dataset['seen'] = ports;
    this.#robots.replaceChildren(...robots.map(({ port, name }) => makeElement('li', '', makeElement('strong', '', plainText([name, port].filter(Boolean).join(' · '))), ' ',
      makeButton('class_take', () => this.#ask({ do: 'class_robot', port, gives: false })))));
  }

  /** Fetches a program that is another one now, and wants its picture. @param {string} key @param {number} version */
  async #look(key, version) {
    if (this.#known.get(key)?.version === version || this.#fetching.get(key) === version) return;
    this.#fetching.set(key, version);
    try {
      const pupil = this.#pupil(key);
      const which = pupil ? { pupil: pupil.number } : key.startsWith(GROUP) ? { group: key.slice(GROUP.length) } : { key: keptOf(key) };
      const found = await post({ do: 'class_text', ...which });
      const known = { text: String(found.text), robot: String(found.robot || 'tinibot'), version: Number(found.version), history: found.history ?? [] };
      this.#known.set(key, known);
      this.#pictures.want(key, known, (address) => {
        if (!this.#wall.picture(key, address)) URL.revokeObjectURL(address);
        if (this.#big.key === key) this.#showBig(key);
      });
      if (this.#big.key === key) this.#showBig(key);
    } catch {
      // it is asked for again, or the pupil has gone
    } finally {
      this.#fetching.delete(key);
    }
  }

  /** @param {string} key */
  #showBig(key) {
    const tile = this.#tiles().find((each) => each.key === key);
    if (!tile) {
      this.#big.window.close();
      return;
    }
    const { pupil } = tile;
    const known = this.#known.get(key);
    const drives = pupil?.robot ? text('class_drives', { robot: plainText(pupil.robot) }) : '';
    const done = text('class_lessons', { done: tile.lessons.length, all: this.#state?.lessons ?? 0 });
    this.#big.show({
      key, title: plainText(tile.name), said: [drives, done].filter(Boolean).join(', '), picture: this.#wall.pictureOf(key), text: known?.text || text('class_empty'), history: known?.history ?? [],
      drives: Boolean(drives), hand: Boolean(pupil?.hand),
    });
  }

  /** @param {number} by */
  #step(by) {
    const tiles = this.#tiles();
    const at = tiles.findIndex(({ key }) => key === this.#big.key);
    const next = tiles.at((at + by) % tiles.length);
    if (next) this.#showBig(next.key);
  }

  /** @param {import('../page/texts.js').Key} key */
  #say(key) {
    say(this.#said, text(key));
    document.documentElement.dataset['teacher'] = key;
  }
}

/** A button of what cannot be taken back: it acts at the second press. @param {'class_end' | 'class_anew'} key @param {() => void} act */
function pressedTwice(key, act) {
  let isSure = false, timer = 0;
  const found = makeButton(key, (event) => {
    if (isSecondPress(event)) return; // a habit is no second thought
    if (isSure) act();
    sure(!isSure);
  });
  const sure = (/** @type {boolean} */ now) => {
    isSure = now;
    const said = now ? textKey(`${key}_sure`) : key;
    found.dataset['text'] = said;
    found.textContent = text(said);
    clearTimeout(timer);
    if (now) timer = window.setTimeout(() => sure(false), SURE_MS);
  };
  return found;
}

/** @param {string} key of the class */
function groupKey(key) {
  return `${GROUP}${key}`;
}

/** A tile of a group: what any of its pupils has, it has. @param {string} key @param {string} name @param {PupilRow[]} members @param {number} version */
function tileOf(key, name, members, version) {
  const first = /** @type {PupilRow} */ (members.find(({ robot }) => robot) ?? members[0]);
  const lessons = [...new Set(members.flatMap((each) => each.lessons))];
  const pupil = {
    ...first, version, lessons,
    silent_s: Math.min(...members.map((each) => each.silent_s)),
    is_right: members.every((each) => each.is_right),
    hand: Math.max(...members.map((each) => each.hand)),
    place: Math.max(...members.map((each) => each.place)),
    own_robot: { ...first.own_robot, name: members.map((each) => each.name).join(', ') },
  };
  return { key, name, lessons, pupil: /** @type {PupilRow | null} */ (pupil) };
}

/** @param {number} pupil */
function keyOf(pupil) {
  return `pupil ${pupil}`;
}

/** @param {string} key of who is not here */
function keptOf(key) {
  return key.replace(/^kept /, '');
}

/** @param {string} least @param {string} most */
function number(least, most) {
  const field = makeElement('input');
  Object.assign(field, { type: 'number', min: least, max: most });
  return field;
}

/** A whole number within the field's limits. @param {HTMLInputElement} field */
function whole(field) {
  return Math.min(Number(field.max), Math.max(Number(field.min), Math.round(Number(field.value)) || 1));
}
