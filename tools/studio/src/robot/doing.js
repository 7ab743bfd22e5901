// What a real robot does, in a sentence beside its name. Nobody is told of it aloud: what is new is said beneath.

import { element, hide, say } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { known, text } from '../page/texts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */
/** @typedef {'still' | 'own' | 'other' | 'line' | 'waits' | 'halted' | 'done' | 'fault' | 'stopped' | 'lost'} Does */

const ENDS = /** @type {Record<string, Does>} */ ({ DONE: 'done', FAULT: 'fault', STOPPED: 'stopped', RESTARTED: 'still', LOST: 'lost', HALTED: 'halted' });

export class Doing {
  /** @type {Does | ''} */
  #does = '';
  #isWatched = false;

  constructor() {
    pageState.language.subscribe(() => this.#show());
  }

  /** A robot is connected, or none any more. @param {import('./transport.js').About | null} about */
  meet(about) {
    this.#does = !about ? '' : about.is_running ? 'other' : 'still';
    this.#isWatched = false;
    this.#show();
  }

  /** It has a program that begins with its button. */
  waits() {
    this.#does = 'waits';
    this.#show();
  }

  /** A halted program goes on. */
  goesOn() {
    this.#does = 'own';
    this.#show();
  }

  /** Its sensors are read. @param {boolean} isWatched */
  watch(isWatched) {
    this.#isWatched = isWatched;
    if (isWatched && this.#does) this.#does = 'still';
    this.#show();
  }

  /** @param {RobotEvent} event @param {boolean} isLine what begins is one that was typed @param {boolean} isOwn it is of this page */
  onEvent({ event, at = -1 }, isLine, isOwn) {
    if (event === 'PLACE' && this.#does === 'halted') return;
    const begins = event === 'STARTED' || (event === 'PLACE' && at >= 0); // by the robot's button
    const does = begins ? (isLine ? 'line' : isOwn ? 'own' : 'other') : ENDS[event];
    if (!does || !this.#does || (event === 'DONE' && this.#does === 'waits')) return; // that program has replaced what ran
    this.#does = does;
    this.#show();
  }

  #show() {
    const place = element('link_doing', HTMLElement);
    hide(place, !this.#does);
    if (!this.#does || !pageState.language.value) return;
    const does = this.#isWatched ? 'senses' : this.#does;
    say(place, text(known(`doing_${does}`)));
    place.dataset['does'] = does;
  }
}
