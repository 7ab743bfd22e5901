// The wall of a class: a tile for each pupil with a picture of the blocks, the lessons that are done, a
// hand that is up, and the robot or the place in the queue. All tiles are as large as fits the window.
// Names and robots are put there as text, never as markup.

import { setText } from '../page/elements.js';
import { makeButton, makeSvg, makeElement } from '../page/made.js';
import { COLOURS } from '../page/own_robot.js';
import { clockText } from './clock.js';
import { makeIcon } from './icons.js';
import { asPlainText } from '../robot/plain_text.js';
import { text } from '../page/texts.js';

/** @typedef {import('./teacher.js').PupilRow} PupilRow */
/**
 * @typedef {object} TileContent of a tile
 * @property {string} key
 * @property {string} name
 * @property {string[]} lessons
 * @property {PupilRow | null} pupil null of who is not here
 */
/** @typedef {{enlarge: (key: string) => void, remove: (key: string) => void, lowerHand: (key: string) => void, playRun: (key: string) => void, visitGroup: (key: string) => void}} TileActions */
/** @typedef {{item: HTMLElement, enlargeButton: HTMLButtonElement, ownRobotDrawing: SVGElement, nameElement: HTMLElement, handButton: HTMLButtonElement, outButton: HTMLButtonElement, playButton: HTMLButtonElement, joinButton: HTMLButtonElement, pictureElement: HTMLImageElement, emptyElement: HTMLElement, badgeElement: HTMLElement, pipsElement: HTMLElement, stateElement: HTMLElement}} Tile */

const SILENT_S = 5;
const PICTURE_ASPECT_RATIO = 1.75; // of a tile's picture: what suits most programs
const MIN_WIDTH_PX = 132; // pixels of width, below which the wall is scrolled
const MIN_HEIGHT_PX = 84; // and of height
const MAX_HEIGHT_PX = 260;
const GAP_PX = 6;

/** What a pupil does with which robot; nothing for one without a robot. @param {import('./teacher.js').PupilRow | null} pupil */
export function robotText(pupil) {
  return pupil?.robot ? text(pupil.is_running ? 'class_runs' : 'class_drives', { robot: asPlainText(pupil.robot) }) : '';
}

export class Wall {
  element = makeElement('ul');
  #actions;
  /** @type {Map<string, Tile>} */
  #tiles = new Map();

  /** @param {TileActions} actions */
  constructor(actions) {
    this.#actions = actions;
    this.element.id = 'wall';
    new ResizeObserver(() => this.#fitTiles()).observe(this.element);
  }

  /** @param {TileContent[]} contents in their order @param {number} lessonCount how many there are */
  show(contents, lessonCount) {
    const oldTiles = this.#tiles;
    this.#tiles = new Map();
    contents.forEach((content, index) => {
      const tile = oldTiles.get(content.key) ?? this.#makeTile(content);
      this.#tiles.set(content.key, tile);
      if (this.element.children[index] !== tile.item) this.element.insertBefore(tile.item, this.element.children[index] ?? null);
      this.#fillTile(tile, content, lessonCount);
    });
    for (const [key, tile] of oldTiles) {
      if (this.#tiles.has(key)) continue;
      releasePicture(tile);
      tile.item.remove();
    }
    if (oldTiles.size !== this.#tiles.size) this.#fitTiles();
  }

  /** @param {string} key @param {string} address of a picture, or nothing */
  setPicture(key, address) {
    const tile = this.#tiles.get(key);
    if (!tile) return false;
    releasePicture(tile);
    tile.pictureElement.hidden = !address;
    tile.emptyElement.hidden = Boolean(address);
    if (address) tile.pictureElement.src = address;
    else tile.pictureElement.removeAttribute('src');
    return true;
  }

  /** The address of the picture in a tile, or nothing; the one before it is no more. @param {string} key */
  pictureAddressOf(key) {
    return this.#tiles.get(key)?.pictureElement.getAttribute('src') ?? '';
  }

  /** @param {TileContent} content @returns {Tile} */
  #makeTile({ key }) {
    const enlargeButton = makeButton('', () => this.#actions.enlarge(key));
    const handButton = makeButton('', () => this.#actions.lowerHand(key), makeIcon('hand', 26));
    const outButton = makeButton('', () => this.#actions.remove(key), makeIcon('out', 20));
    const playButton = makeButton('', () => this.#actions.playRun(key), makeIcon('run', 20));
    const joinButton = makeButton('', () => this.#actions.visitGroup(key), makeIcon('join', 20));
    const nameElement = makeElement('strong'), pictureElement = makeElement('img'), emptyElement = makeElement('span', 'class_empty');
    const badgeElement = makeElement('span'), pipsElement = makeElement('span'), stateElement = makeElement('span');
    for (const [className, element] of Object.entries({ see: enlargeButton, hand: handButton, out: outButton, play: playButton, join: joinButton, badge: badgeElement, pips: pipsElement, said: stateElement, empty: emptyElement })) element.className = className;
    pictureElement.alt = '';
    pictureElement.hidden = true;
    emptyElement.hidden = true; // until its program is known
    const ownRobotDrawing = makeSvg('svg', { class: 'own_robot', viewBox: '-26 -22 54 44', 'aria-hidden': 'true' }, makeSvg('use', { href: '#drawn_robot' }));
    const listItem = makeElement('li', '', nameElement, makeElement('div', '', pictureElement, emptyElement), makeElement('p', '', pipsElement, stateElement), badgeElement, ownRobotDrawing, enlargeButton, handButton, playButton, joinButton, outButton);
    return { item: listItem, enlargeButton, ownRobotDrawing, nameElement, handButton, outButton, playButton, joinButton, pictureElement, emptyElement, badgeElement, pipsElement, stateElement };
  }

  /** @param {Tile} tile @param {TileContent} content @param {number} lessonCount */
  #fillTile(tile, { key, name, lessons: doneLessons, pupil }, lessonCount) {
    const isGroup = key.startsWith('group '); // whose pupils leave it
    const plainName = asPlainText(name);
    const state = !pupil ? 'gone' : pupil.silent_s > SILENT_S ? 'away' : pupil.is_right ? 'right' : 'wrong';
    const drivenRobot = pupil?.robot ? asPlainText(pupil.robot) : '';
    if (tile.item.dataset['state'] !== state) tile.item.dataset['state'] = state;
    const { name: ownRobotName = '', colour = 0 } = pupil?.own_robot ?? {};
    const [bodyColour, edgeColour] = COLOURS[colour] ?? COLOURS[0];
    tile.ownRobotDrawing.style.setProperty('--robot', bodyColour);
    tile.ownRobotDrawing.style.setProperty('--robot-edge', edgeColour);
    setText(tile.nameElement, [plainName, asPlainText(ownRobotName)].filter(Boolean).join(' · '));
    setText(tile.stateElement, state === 'right' ? '✓' : text(`class_is_${state}`));
    tile.handButton.hidden = !pupil?.hand;
    tile.playButton.hidden = isGroup || state === 'gone' || state === 'away';
    tile.outButton.hidden = isGroup;
    tile.joinButton.hidden = !isGroup;
    const badge = drivenRobot ? `${pupil?.is_running ? '▶ ' : ''}${drivenRobot} ${clockText(pupil?.left_s ?? 0)}` : pupil?.place ? text('class_place_short', { place: pupil.place }) : '';
    tile.badgeElement.hidden = !badge;
    if (tile.badgeElement.dataset['said'] !== badge) {
      tile.badgeElement.dataset['said'] = badge;
      tile.badgeElement.replaceChildren(makeIcon(drivenRobot ? 'robot' : 'queue', 18), makeElement('span', '', badge));
      tile.badgeElement.classList.toggle('drives', Boolean(drivenRobot));
    }
    const marks = Array.from({ length: lessonCount }, (_, index) => (doneLessons.some((lessonName) => Number.parseInt(lessonName, 10) === index + 1) ? '●' : '○')).join('');
    if (tile.pipsElement.dataset['marks'] !== marks) {
      tile.pipsElement.dataset['marks'] = marks;
      tile.pipsElement.replaceChildren(...[...marks].map((mark) => {
        const pip = makeElement('i');
        if (mark === '●') pip.className = 'done';
        return pip;
      }));
    }
    const details = [text(`class_is_${state}`), pupil?.hand ? text('class_hand_up') : '', robotText(pupil),
      pupil?.place ? text('class_waits', { place: pupil.place }) : '', text('class_lessons', { done: doneLessons.length, all: lessonCount })];
    setLabel(tile.enlargeButton, `${text('class_see_of', { name: plainName })} ${details.filter(Boolean).join(', ')}`);
    setLabel(tile.handButton, text('class_lower', { name: plainName }));
    setLabel(tile.outButton, text('class_remove_of', { name: plainName }));
    setLabel(tile.joinButton, text('class_visit_of', { name: plainName }));
    setLabel(tile.playButton, text('class_run_of', { name: plainName }));
  }

  /** Chooses the columns with which tiles are largest. */
  #fitTiles() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const count = this.#tiles.size;
    if (!count || !width || !height) return;
    let bestLayout = { columns: 1, size: 0 };
    for (let columns = 1; columns <= count && (width + GAP_PX) / columns - GAP_PX >= MIN_WIDTH_PX; columns += 1) {
      const width_px = (width + GAP_PX) / columns - GAP_PX;
      const height_px = Math.min(MAX_HEIGHT_PX, (height + GAP_PX) / Math.ceil(count / columns) - GAP_PX);
      const pictureSize = Math.min(width_px / PICTURE_ASPECT_RATIO, height_px);
      if (pictureSize > bestLayout.size) bestLayout = { columns, size: pictureSize };
    }
    if (bestLayout.size < MIN_HEIGHT_PX) bestLayout.columns = Math.max(1, Math.floor((width + GAP_PX) / (MIN_WIDTH_PX + 30 + GAP_PX)));
    const rows = Math.ceil(count / bestLayout.columns);
    const tileHeight = Math.max(MIN_HEIGHT_PX, Math.min(MAX_HEIGHT_PX, Math.floor((height + GAP_PX) / rows - GAP_PX)));
    this.element.style.setProperty('--columns', String(bestLayout.columns));
    this.element.style.setProperty('--high', `${tileHeight}px`);
  }
}

/** Nothing is kept of the picture in a tile. @param {Tile} tile */
function releasePicture({ pictureElement: picture }) {
  if (picture.src.startsWith('blob:')) URL.revokeObjectURL(picture.src);
}

/** @param {HTMLElement} target @param {string} label */
function setLabel(target, label) {
  if (target.getAttribute('aria-label') !== label) target.setAttribute('aria-label', label);
}
