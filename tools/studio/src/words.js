// The words of the language and of each robot, for colors and completion. The table is
// `description.json`, which is made from the compiler's own.

import description from '../made/description.json';

/** @typedef {{text: string, role: string, usage?: string, example: string}} Word */

/** Words that stand for an instruction with its values. */
export const FIXED = description.words.filter((word) => word.role === 'fixed');
export const ROBOTS = description.robots;
export const WORLDS = /** @type {import('./world_parts.js').World[]} */ (description.worlds);
export const WORLD_LIMITS = description.world_limits;
export const LINK = description.link;

/** @type {Map<string, Map<string, Word>>} */
const WORDS = new Map(
  ROBOTS.map((robot) => [
    robot.name,
    new Map(
      [...description.words, ...robot.devices].map((word) => [word.text, /** @type {Word} */ (word)]),
    ),
  ]),
);

/**
 * @param {string} robot
 * @returns {Map<string, Word>}
 */
export function wordsOf(robot) {
  return WORDS.get(robot) ?? new Map();
}

/**
 * @param {string} robot
 * @returns {boolean}
 */
export function isRobot(robot) {
  return WORDS.has(robot);
}
