// What is so: who changes something says it here once, and who shows it watches. So no two parts of the
// page can show something else, and none has to know another one.

/** @typedef {import('../writing/editor.js').Range} Range */
/** @typedef {{line: number, column: number, point: object}} Breakpoint */

/** @template T */
class Fact {
  #value;
  /** @type {((value: T) => unknown)[]} */
  #watchers = [];

  /** @param {T} value at the beginning */
  constructor(value) {
    this.#value = value;
  }

  get value() {
    return this.#value;
  }

  /** @param {T} value from now on */
  say(value) {
    this.#value = value;
    for (const each of this.#watchers) each(value);
  }

  /** @param {(value: T) => unknown} act whenever it is said, in the order of those who asked */
  watch(act) {
    this.#watchers.push(act);
  }
}

export const so = {
  screen: new Fact(/** @type {'' | 'start' | 'program'} */ ('')), // that is seen
  language: new Fact(''),
  areWordsShown: new Fact(false), // of the text, on blocks and at readings
  robot: new Fact(''), // its name
  taught: new Fact(/** @type {string[]} */ ([])), // kinds of blocks that the open lesson speaks of
  isRobotNamed: new Fact(false), // by the text: `// robot: liner`
  text: new Fact(''), // of the program
  /** What the compiler says of the newest text; null while it is at work. */
  checked: new Fact(/** @type {import('../python.js').Checked | null} */ (null)),
  offered: new Fact(-1), // the number of one of its findings, which has a button from now on
  note: new Fact(''), // a sentence about what has just been done
  /** Where the program is to stop; a point stays the same while its text moves. */
  breakpoints: new Fact(/** @type {Breakpoint[]} */ ([])),
  /** What runs on the virtual robot, a range for each task; where it is held somebody wants to see it. */
  running: new Fact({ ranges: /** @type {Range[]} */ ([]), isHeld: false }),
  runningThere: new Fact(/** @type {Range | null} */ (null)), // on a real one
  fault: new Fact({ range: /** @type {Range | null} */ (null), said: '' }), // of a run
};
