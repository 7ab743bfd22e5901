// A class: the page of a pupil, or of the teacher. Fetched only where `tsc studio --class` gives the page.

import { Pupil } from './pupil.js';
import { Teacher } from './teacher.js';
import { isTeacher } from '../robot/host.js';

/**
 * @param {import('../robot/panel.js').RobotPanel} panel
 * @param {import('../work.js').Work} work
 * @param {() => void} empty takes the program off the page
 */
export function beginClass(panel, work, empty) {
  if (isTeacher) new Teacher();
  else new Pupil(panel, work, empty);
}
