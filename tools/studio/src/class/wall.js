// The wall of a class: a tile for each pupil with a picture of the blocks, the lessons that are done, a
// hand that is up, and the robot or the place in the queue. All tiles are as large as fits the window.
// Names and robots are put there as text, never as markup.

import { say } from '../page/elements.js';
import { makeButton, makeSvg, makeElement } from '../page/made.js';
import { COLOURS } from '../page/own_robot.js';
import { sign } from './signs.js';
import { plainText } from '../robot/plain_text.js';
import { text } from '../page/texts.js';

/** @typedef {import('./teacher.js').PupilRow} PupilRow */
/**
 * @typedef {object} Seen of a tile
 * @property {string} key
 * @property {string} name
 * @property {string[]} lessons
 * @property {PupilRow | null} pupil null of who is not here
 */
/** @typedef {{see: (key: string) => void, remove: (key: string) => void, lower: (key: string) => void, play: (key: string) => void, join: (key: string) => void}} Told */
/** @typedef {{item: HTMLElement, see: HTMLButtonElement, own: SVGElement, name: HTMLElement, hand: HTMLButtonElement, out: HTMLButtonElement, play: HTMLButtonElement, join: HTMLButtonElement, picture: HTMLImageElement, empty: HTMLElement, badge: HTMLElement, pips: HTMLElement, said: HTMLElement}} Tile */

const SILENT_S = 5;
const WIDE = 1.75; // of a tile's picture: what suits most programs
const LEAST = 132; // pixels of width, below which the wall is scrolled
const LOW = 84; // and of height
const HIGHEST = 260;
const GAP = 6;

export class Wall {
  element = makeElement('ul');
  #told;
  /** @type {Map<string, Tile>} */
  #tiles = new Map();

  /** @param {Told} told */
  constructor(told) {
    this.#told = told;
    this.element.id = 'wall';
    new ResizeObserver(() => this.#fit()).observe(this.element);
  }

  /** @param {Seen[]} all in their order @param {number} lessons how many there are */
  show(all, lessons) {
    const old = this.#tiles;
    this.#tiles = new Map();
    all.forEach((each, k) => {
      const tile = old.get(each.key) ?? this.#made(each);
      this.#tiles.set(each.key, tile);
      if (this.element.children[k] !== tile.item) this.element.insertBefore(tile.item, this.element.children[k] ?? null);
      this.#fill(tile, each, lessons);
    });
    for (const [key, tile] of old) {
      if (this.#tiles.has(key)) continue;
      release(tile);
      tile.item.remove();
    }
    if (old.size !== this.#tiles.size) this.#fit();
  }

  /** @param {string} key @param {string} address of a picture, or nothing */
  picture(key, address) {
    const tile = this.#tiles.get(key);
    if (!tile) return false;
    release(tile);
    tile.picture.hidden = !address;
    tile.empty.hidden = Boolean(address);
    if (address) tile.picture.src = address;
    else tile.picture.removeAttribute('src');
    return true;
  }

  /** The address of the picture in a tile, or nothing; the one before it is no more. @param {string} key */
  pictureOf(key) {
    return this.#tiles.get(key)?.picture.getAttribute('src') ?? '';
  }

  /** @param {Seen} of @returns {Tile} */
  #made({ key }) {
    const see = makeButton('', () => this.#told.see(key));
    const hand = makeButton('', () => this.#told.lower(key), sign('hand', 26));
    const out = makeButton('', () => this.#told.remove(key), sign('out', 20));
    const play = makeButton('', () => this.#told.play(key), sign('run', 20));
    const join = makeButton('', () => this.#told.join(key), sign('join', 20));
    const name = makeElement('strong'), picture = makeElement('img'), empty = makeElement('span', 'class_empty');
    const badge = makeElement('span'), pips = makeElement('span'), said = makeElement('span');
    for (const [looks, each] of Object.entries({ see, hand, out, play, join, badge, pips, said, empty })) each.className = looks;
    picture.alt = '';
    picture.hidden = true;
    empty.hidden = true; // until its program is known
    const own = makeSvg('svg', { class: 'own_robot', viewBox: '-26 -22 54 44', 'aria-hidden': 'true' }, makeSvg('use', { href: '#drawn_robot' }));
    const item = makeElement('li', '', name, makeElement('div', '', picture, empty), makeElement('p', '', pips, said), badge, own, see, hand, play, join, out);
    return { item, see, own, name, hand, out, play, join, picture, empty, badge, pips, said };
  }

  /** @param {Tile} tile @param {Seen} seen @param {number} lessons */
  #fill(tile, { key, name, lessons: done, pupil }, lessons) {
    const isGroup = key.startsWith('group '); // whose pupils leave it
    const plain = plainText(name);
    const state = !pupil ? 'gone' : pupil.silent_s > SILENT_S ? 'away' : pupil.is_right ? 'right' : 'wrong';
    const drives = pupil?.robot ? plainText(pupil.robot) : '';
    if (tile.item.dataset['state'] !== state) tile.item.dataset['state'] = state;
    const { name: own_name = '', colour = 0 } = pupil?.own_robot ?? {};
    const [body, edge] = COLOURS[colour] ?? COLOURS[0];
    tile.own.style.setProperty('--robot', body);
    tile.own.style.setProperty('--robot-edge', edge);
    say(tile.name, [plain, plainText(own_name)].filter(Boolean).join(' · '));
    say(tile.said, state === 'right' ? '✓' : text(`class_is_${state}`));
    tile.hand.hidden = !pupil?.hand;
    tile.play.hidden = isGroup || state === 'gone' || state === 'away';
    tile.out.hidden = isGroup;
    tile.join.hidden = !isGroup;
    const badge = drives ? `${drives} ${clock(pupil?.left_s ?? 0)}` : pupil?.place ? text('class_place_short', { place: pupil.place }) : '';
    tile.badge.hidden = !badge;
    if (tile.badge.dataset['said'] !== badge) {
      tile.badge.dataset['said'] = badge;
      tile.badge.replaceChildren(sign(drives ? 'robot' : 'queue', 18), makeElement('span', '', badge));
      tile.badge.classList.toggle('drives', Boolean(drives));
    }
    const marks = Array.from({ length: lessons }, (_, k) => (done.some((each) => Number.parseInt(each, 10) === k + 1) ? '●' : '○')).join('');
    if (tile.pips.dataset['marks'] !== marks) {
      tile.pips.dataset['marks'] = marks;
      tile.pips.replaceChildren(...[...marks].map((mark) => {
        const pip = makeElement('i');
        if (mark === '●') pip.className = 'done';
        return pip;
      }));
    }
    const more = [text(`class_is_${state}`), pupil?.hand ? text('class_hand_up') : '', drives && text('class_drives', { robot: drives }),
      pupil?.place ? text('class_waits', { place: pupil.place }) : '', text('class_lessons', { done: done.length, all: lessons })];
    label(tile.see, `${text('class_see_of', { name: plain })} ${more.filter(Boolean).join(', ')}`);
    label(tile.hand, text('class_lower', { name: plain }));
    label(tile.out, text('class_remove_of', { name: plain }));
    label(tile.join, text('class_visit_of', { name: plain }));
    label(tile.play, text('class_run_of', { name: plain }));
  }

  /** Chooses the columns with which tiles are largest. */
  #fit() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const count = this.#tiles.size;
    if (!count || !width || !height) return;
    let best = { columns: 1, size: 0 };
    for (let columns = 1; columns <= count && (width + GAP) / columns - GAP >= LEAST; columns += 1) {
      const wide = (width + GAP) / columns - GAP;
      const high = Math.min(HIGHEST, (height + GAP) / Math.ceil(count / columns) - GAP);
      const size = Math.min(wide / WIDE, high);
      if (size > best.size) best = { columns, size };
    }
    if (best.size < LOW) best.columns = Math.max(1, Math.floor((width + GAP) / (LEAST + 30 + GAP)));
    const rows = Math.ceil(count / best.columns);
    const high = Math.max(LOW, Math.min(HIGHEST, Math.floor((height + GAP) / rows - GAP)));
    this.element.style.setProperty('--columns', String(best.columns));
    this.element.style.setProperty('--high', `${high}px`);
  }
}

/** Nothing is kept of the picture in a tile. @param {Tile} tile */
function release({ picture }) {
  if (picture.src.startsWith('blob:')) URL.revokeObjectURL(picture.src);
}

/** @param {number} seconds */
export function clock(seconds) {
  return `${Math.floor(seconds / 60)}:${String(seconds % 60).padStart(2, '0')}`;
}

/** @param {HTMLElement} place @param {string} said */
function label(place, said) {
  if (place.getAttribute('aria-label') !== said) place.setAttribute('aria-label', said);
}
