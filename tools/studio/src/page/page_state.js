// The state that several parts of the page show: who changes it sets it here once, and who shows it
// subscribes. So no two parts can show something else, and none has to know another one.

/** @typedef {import('../writing/editor.js').Range} Range */
/** @typedef {{line: number, column: number, point: object}} Breakpoint */

/**
 * @typedef {object} TaughtBlocks blocks of the open lesson
 * @property {string[]} offered kinds that it speaks of, or a lesson before it
 * @property {string[]} needed kinds in its programs, or by its task
 * @property {string[]} fresh its newest, as `pieceOf` has them
 */

/** @template T */
class Observable {
  #value;
  /** @type {((value: T) => unknown)[]} */
  #subscribers = [];

  /** @param {T} value at the beginning */
  constructor(value) {
    this.#value = value;
  }

  get value() {
    return this.#value;
  }

  /** @param {T} value from now on */
  set(value) {
    this.#value = value;
    for (const subscriber of this.#subscribers) subscriber(value);
  }

  /** @param {(value: T) => unknown} subscriber whenever it is set, in the order of those who subscribed */
  subscribe(subscriber) {
    this.#subscribers.push(subscriber);
  }
}

export const pageState = {
  screen: new Observable(/** @type {'' | 'start' | 'program'} */ ('')), // that is seen
  sideId: new Observable(''), // that is seen beside the program, by its button
  language: new Observable(''),
  ownRobot: new Observable({ name: '', colour: 0 }), // what somebody has made of the virtual robot
  areWordsShown: new Observable(false), // of the text, on blocks and at readings
  robotName: new Observable(''),
  view: new Observable(/** @type {'blocks' | 'text'} */ ('blocks')), // of the program
  taughtBlocks: new Observable(/** @type {TaughtBlocks} */ ({ offered: [], needed: [], fresh: [] })),
  isRobotNamed: new Observable(false), // by the text: `// robot: liner`
  programText: new Observable(''),
  isTyped: new Observable(false), // somebody wrote the newest change of it as text, in this view
  areBlocksNamed: new Observable(true), // in sentences: whoever has just typed a line reads of its words
  groupName: new Observable(''), // of pupils who edit this program together
  /** What the compiler says of the newest text; null while it is at work. */
  checkResult: new Observable(/** @type {import('../python.js').CheckResult | null} */ (null)),
  offeredFindingIndex: new Observable(-1), // the number of one of its findings, which has a button from now on
  note: new Observable(''), // a sentence about what has just been done
  /** Where the program is to stop; a point stays the same while its text moves. */
  breakpoints: new Observable(/** @type {Breakpoint[]} */ ([])),
  /** What runs on the virtual robot, a range for each task; where it is held somebody wants to see it. */
  virtualRun: new Observable({ ranges: /** @type {Range[]} */ ([]), isHeld: false }),
  /** What runs on a real one; where it is halted somebody wants to see it. */
  robotRun: new Observable({ range: /** @type {Range | null} */ (null), isHeld: false }),
  fault: new Observable({ range: /** @type {Range | null} */ (null), sentence: '' }), // of a run
};

for (const observable of [pageState.view, pageState.isTyped]) {
  observable.subscribe(() => {
    const areBlocksNamed = pageState.view.value === 'blocks' && !pageState.isTyped.value;
    if (areBlocksNamed !== pageState.areBlocksNamed.value) pageState.areBlocksNamed.set(areBlocksNamed);
  });
}
