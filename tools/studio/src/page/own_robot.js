// The colour and the name that somebody has given the virtual robot, kept on this device. What is kept may be damaged, or
// somebody else's: all of it is checked.

import { storeText, loadJson } from './kept.js';
import { pageState } from './page_state.js';

/** @typedef {{name: string, colour: number}} OwnRobot `colour` is a number of COLOURS */

const STORAGE_KEY = 'tiniscript.own_robot';
export const MAX_NAME_CHARACTERS = 16;
/** Of its body and of its edge, with the text of the name of each: white is seen on all, and all on every floor. No red: that is a robot with a fault. */
export const COLOURS = /** @type {const} */ ([
  ['#2a9d6f', '#0d4f38', 'colour_green'], ['#2f74c0', '#123b63', 'colour_blue'], ['#8a4fc4', '#46217a', 'colour_purple'],
  ['#d0468f', '#7a1450', 'colour_pink'], ['#d8741a', '#7a3f00', 'colour_orange'], ['#b08c00', '#574400', 'colour_yellow'],
  ['#138a94', '#074a50', 'colour_teal'], ['#66727e', '#2c343c', 'colour_grey'],
]);

/** @param {unknown} value from elsewhere @returns {OwnRobot} what of it is one */
export function validOwnRobot(value) {
  const { name, colour } = /** @type {Partial<Record<string, unknown>>} */ (value && typeof value === 'object' ? value : {});
  return {
    name: typeof name === 'string' ? name.replace(/\p{C}/gu, '').trim().slice(0, MAX_NAME_CHARACTERS) : '',
    colour: Number.isInteger(colour) && Number(colour) >= 0 && Number(colour) < COLOURS.length ? Number(colour) : 0,
  };
}

/** Shows it in every drawing of a robot, from now on. */
export function showOwnRobot() {
  pageState.ownRobot.subscribe(({ colour }) => {
    const [bodyColour, edgeColour] = COLOURS[colour] ?? COLOURS[0];
    document.documentElement.style.setProperty('--robot', bodyColour);
    document.documentElement.style.setProperty('--robot-edge', edgeColour);
  });
  pageState.ownRobot.set(validOwnRobot(loadJson(STORAGE_KEY)));
}

/** @param {OwnRobot} ownRobot @returns {boolean} whether it could be kept */
export function storeOwnRobot(ownRobot) {
  pageState.ownRobot.set(validOwnRobot(ownRobot));
  return storeText(STORAGE_KEY, JSON.stringify(pageState.ownRobot.value));
}
