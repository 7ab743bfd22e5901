// A class: the page of a pupil, or of the teacher. Fetched only where `tsc studio --class` gives the page.

import { Pupil } from './pupil.js';
import { isTeacher } from '../robot/host.js';

/**
 * @typedef {object} Page what a class uses of the page
 * @property {import('../robot/panel.js').RobotPanel} panel
 * @property {import('../programs/work.js').Work} work
 * @property {import('../python.js').Python} python
 * @property {import('../writing/editor.js').Editor} editor
 * @property {import('../writing/views.js').Views} views
 * @property {() => boolean} keepProgram the program among the earlier ones; whether nothing of it would be lost
 * @property {(lessonNumber: number) => void} openLesson
 * @property {() => void} clearProgram takes the program off the page
 * @property {() => Promise<string>} fetchNewestRunFile its file, or nothing
 * @property {(file: File) => Promise<void>} openRun plays it
 * @property {(program: {text: string, robot: string}) => boolean} putProgram another program into the editor, unless a group is to keep its own; whether it is there
 */

/** @param {Page} page */
export async function openClass(page) {
  const stylesheet = document.createElement('link');
  Object.assign(stylesheet, { rel: 'stylesheet', href: 'class.css' });
  const loading = new Promise((resolve) => {
    stylesheet.onload = stylesheet.onerror = resolve;
  });
  document.head.append(stylesheet);
  await loading;
  if (isTeacher) {
    const { Teacher } = await import('./teacher.js'); // no pupil's page fetches it
    new Teacher(page);
  } else new Pupil(page);
}
