// What is heard of the virtual robot: its buzzer, and a collision. A browser without sound is silent.

const VOLUME = 0.06;
const EDGE_S = 0.005; // in which a tone begins and ends: without it, it clicks
const LATE_S = 0.5; // a tone that would come later is left out: the robot runs faster than it plays
const CLOSE_DELAY_MS = 3000; // after a sound, until the computer's sound is closed: the page has to wait for it
const CHEER_HZ = [523, 659, 784, 1047]; // C E G C
const CHEER_S = 0.12;
const LOWEST_HZ = 20;
const HIGHEST_HZ = 16_000;

export class Sounds {
  isMuted = false;
  /** @type {AudioContext | null} */
  #context = null;
  #lastEnd_s = 0; // when the last tone has ended
  /** What sounds, or is going to. @type {Set<OscillatorNode>} */
  #playingTones = new Set();
  #closeTimer = 0;

  /** Makes the computer's sound ready before a run, whose picture would wait for it; nothing of the one before sounds any more. */
  begin() {
    this.silence();
    const context = this.#openContext();
    if (context) this.#closeLater(context);
  }

  /** @param {number} hertz @param {number} duration_s of this computer's time */
  beep(hertz, duration_s) {
    const context = this.#openContext();
    if (!context) return;
    const begin_s = Math.max(context.currentTime, this.#lastEnd_s);
    if (begin_s - context.currentTime > LATE_S) return;
    this.#lastEnd_s = begin_s + duration_s;
    const tone = this.#startTone(context, 'square', begin_s, duration_s, VOLUME);
    tone.frequency.value = Math.max(LOWEST_HZ, Math.min(HIGHEST_HZ, hertz));
  }

  crash() {
    const context = this.#openContext();
    if (!context) return;
    const tone = this.#startTone(context, 'triangle', context.currentTime, 0.18, 4 * VOLUME);
    tone.frequency.setValueAtTime(170, context.currentTime);
    tone.frequency.exponentialRampToValueAtTime(45, context.currentTime + 0.18);
  }

  /** A task is solved. */
  cheer() {
    this.silence();
    for (const hertz of CHEER_HZ) this.beep(hertz, CHEER_S);
  }

  silence() {
    for (const tone of this.#playingTones) tone.stop();
    this.#playingTones.clear();
    this.#lastEnd_s = 0;
  }

  /** @param {boolean} isMuted */
  setMuted(isMuted) {
    this.isMuted = isMuted;
    if (isMuted) this.silence();
  }

  /** Browsers let a page sound once somebody has touched it, and say so of one that tries before. */
  #openContext() {
    if (this.isMuted || !('AudioContext' in window) || navigator.userActivation?.hasBeenActive === false) return null;
    clearTimeout(this.#closeTimer);
    try {
      this.#context ??= new AudioContext();
    } catch {
      return null; // no device
    }
    this.#context.resume(); // also of one that is about to rest
    return this.#context;
  }

  /**
   * @param {AudioContext} context
   * @param {OscillatorType} type
   * @param {number} begin_s
   * @param {number} duration_s
   * @param {number} volume
   */
  #startTone(context, type, begin_s, duration_s, volume) {
    const tone = context.createOscillator(), gain = context.createGain();
    const end_s = begin_s + Math.max(duration_s, 2 * EDGE_S);
    tone.type = type;
    gain.gain.setValueAtTime(0, begin_s);
    gain.gain.linearRampToValueAtTime(volume, begin_s + EDGE_S);
    gain.gain.setValueAtTime(volume, end_s - EDGE_S);
    gain.gain.linearRampToValueAtTime(0, end_s);
    tone.connect(gain).connect(context.destination);
    tone.start(begin_s);
    tone.stop(end_s);
    this.#playingTones.add(tone);
    tone.addEventListener('ended', () => {
      this.#playingTones.delete(tone);
      this.#closeLater(context);
    });
    return tone;
  }

  /** Closes it after a while: an open one works without a sound, too. @param {AudioContext} context */
  #closeLater(context) {
    clearTimeout(this.#closeTimer);
    if (!this.#playingTones.size) this.#closeTimer = window.setTimeout(() => context.suspend(), CLOSE_DELAY_MS);
  }
}
