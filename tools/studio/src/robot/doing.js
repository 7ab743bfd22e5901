// What a real robot does, in a sentence beside its name. Nobody is told about it aloud: what is new is said beneath.

import { element, setHidden, setText } from '../page/elements.js';
import { pageState } from '../page/page_state.js';
import { textKey, text } from '../page/texts.js';

/** @typedef {import('./transport.js').RobotEvent} RobotEvent */
/** @typedef {'still' | 'own' | 'other' | 'line' | 'waits' | 'halted' | 'done' | 'fault' | 'stopped' | 'lost'} Activity */

const END_ACTIVITIES = /** @type {Record<string, Activity>} */ ({ DONE: 'done', FAULT: 'fault', STOPPED: 'stopped', RESTARTED: 'still', LOST: 'lost', HALTED: 'halted' });

export class ActivityLine {
  /** @type {Activity | ''} */
  #activity = '';
  #isWatched = false;

  constructor() {
    pageState.language.subscribe(() => this.#show());
  }

  /** A robot is connected, or none any more. @param {import('./transport.js').RobotInfo | null} robotInfo */
  onRobotChange(robotInfo) {
    this.#activity = !robotInfo ? '' : robotInfo.is_running ? 'other' : 'still';
    this.#isWatched = false;
    this.#show();
  }

  /** It has a program that begins with its button. */
  showWaiting() {
    this.#activity = 'waits';
    this.#show();
  }

  /** A halted program goes on. */
  showResumed() {
    this.#activity = 'own';
    this.#show();
  }

  /** Its sensors are read. @param {boolean} isWatched */
  showWatching(isWatched) {
    this.#isWatched = isWatched;
    if (isWatched && this.#activity) this.#activity = 'still';
    this.#show();
  }

  /** @param {RobotEvent} event @param {boolean} isTyped what begins is one that was typed @param {boolean} isOwn it is of this page */
  onEvent({ event, at: offset = -1 }, isTyped, isOwn) {
    if (event === 'PLACE' && this.#activity === 'halted') return;
    const isBeginning = event === 'STARTED' || (event === 'PLACE' && offset >= 0); // by the robot's button
    const activity = isBeginning ? (isTyped ? 'line' : isOwn ? 'own' : 'other') : END_ACTIVITIES[event];
    if (!activity || !this.#activity || (event === 'DONE' && this.#activity === 'waits')) return; // that program has replaced what ran
    this.#activity = activity;
    this.#show();
  }

  #show() {
    const line = element('link_doing', HTMLElement);
    setHidden(line, !this.#activity);
    if (!this.#activity || !pageState.language.value) return;
    const activityKey = this.#isWatched ? 'senses' : this.#activity;
    setText(line, text(textKey(`doing_${activityKey}`)));
    line.dataset['does'] = activityKey;
  }
}
