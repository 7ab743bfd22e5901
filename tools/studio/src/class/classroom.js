// A class: the page of a pupil, or of the teacher. Fetched only where `tsc studio --class` gives the page.

import { Pupil } from './pupil.js';
import { Teacher } from './teacher.js';
import { isTeacher } from '../robot/host.js';

/**
 * @typedef {object} Page what a class uses of the page
 * @property {import('../robot/panel.js').RobotPanel} panel
 * @property {import('../programs/work.js').Work} work
 * @property {import('../python.js').Python} python
 * @property {import('../writing/editor.js').Editor} editor
 * @property {import('../writing/views.js').Views} views
 * @property {() => void} keep the program among the earlier ones
 * @property {() => void} empty takes the program off the page
 * @property {() => Promise<string>} newestRun its file, or nothing
 * @property {(file: File) => Promise<void>} openRun plays it
 * @property {(program: {text: string, robot: string}) => boolean} put another program into the editor, unless a group is to keep its own; whether it is there
 */

/** @param {Page} page */
export async function beginClass(page) {
  const looks = document.createElement('link');
  Object.assign(looks, { rel: 'stylesheet', href: 'class.css' });
  const isThere = new Promise((resolve) => {
    looks.onload = looks.onerror = resolve;
  });
  document.head.append(looks);
  await isThere;
  if (isTeacher) new Teacher(page);
  else new Pupil(page);
}
