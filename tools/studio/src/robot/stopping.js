// What the page says of a STOP: that it is on its way, and then that the robot has confirmed it or has not. It says
// each once. Until then nobody else says anything: it may be from before, or speak of a stop as if it were done.

import { textKey, text } from '../page/texts.js';
import { LINK } from '../page/words.js';

export class StopNotice {
  #speech;
  #confirmTimer = 0;
  /** @type {'none' | 'under way' | 'unconfirmed' | 'confirmed'} */
  #state = 'none';
  /** What is said once it is confirmed, or nothing for why the robot has stopped. */
  #confirmedKey = '';

  /** @param {import('./speech.js').Speech} speech */
  constructor(speech) {
    this.#speech = speech;
  }

  /** Whether a stop has not been confirmed. */
  get isOpen() { return this.#state === 'under way' || this.#state === 'unconfirmed'; }

  /** @param {string} [confirmedKey] a text */
  begin(confirmedKey = '') {
    if (confirmedKey || !this.isOpen) this.#confirmedKey = confirmedKey;
    if (this.#state === 'under way') return;
    this.#speech.say('say_stopping');
    this.#setState('under way');
    this.#confirmTimer = window.setTimeout(() => this.showUnconfirmed(), LINK.confirm_ms);
  }

  /** The robot has confirmed a stop, of this page or of somebody else. @param {string} cause of it */
  confirm(cause) {
    if (this.#state === 'confirmed') return; // who presses twice hears of it once
    const isLate = this.#state === 'unconfirmed', confirmedKey = this.isOpen ? this.#confirmedKey : '';
    this.#setState('confirmed');
    this.#speech.say(isLate ? 'say_confirmed_late' : textKey(confirmedKey || `stopped_${cause}`));
  }

  /** Nothing confirms it any more, though the connection goes on. */
  showUnconfirmed() {
    if (this.#state !== 'under way') return;
    this.#setState('unconfirmed');
    this.#speech.say('say_not_confirmed');
  }

  /** Something has been started since. */
  forget() {
    if (this.#state !== 'under way') this.#setState('none');
  }

  /** The connection is over. @returns {() => string} what its end leaves to be said of the stop */
  end() {
    const { isOpen } = this;
    this.#setState('none');
    return () => (isOpen ? text('say_not_confirmed') : '');
  }

  /** @param {'none' | 'under way' | 'unconfirmed' | 'confirmed'} state */
  #setState(state) {
    this.#state = state;
    this.#speech.isHeldByStop = state === 'under way';
    clearTimeout(this.#confirmTimer);
  }
}
