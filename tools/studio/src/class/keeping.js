// The work of a class as one file: saved by the teacher, and opened again another day. What is in a
// file is somebody else's: `tsc studio` checks all of it.

import { downloadFile } from '../page/files.js';
import { post } from '../robot/host.js';
import { text } from '../page/texts.js';
import { CLASS } from '../page/words.js';

/** @typedef {{name: string, text: string, robot: string, lessons: string[]}} PupilWork */

/** @returns {Promise<PupilWork[]>} */
export async function fetchWork() {
  return (await post({ do: 'class_work' })).pupils;
}

/** Saves the work of all; returns of how many. */
export async function saveWork() {
  const pupils = await fetchWork();
  const today = new Date();
  const day = [today.getFullYear(), today.getMonth() + 1, today.getDate()].map((part) => String(part).padStart(2, '0')).join('-');
  const fileText = JSON.stringify({ tiniscript_class: CLASS.form, day, pupils }, null, 1);
  downloadFile(`${text('class_file')}-${day}.json`, new Blob([fileText], { type: 'application/json' }));
  return pupils.length;
}

/** Opens a file; returns the work of how many was in it, or null where it is no such file. @param {File} file */
export async function openWork(file) {
  let classWork;
  try {
    if (file.size > CLASS.file_bytes) return null;
    classWork = JSON.parse(await file.text());
  } catch {
    return null;
  }
  if (classWork?.tiniscript_class !== CLASS.form || !Array.isArray(classWork.pupils)) return null;
  let count = 0;
  for (const work of classWork.pupils.slice(0, CLASS.most_works)) {
    const { name, text: program, robot, lessons } = work ?? {};
    if (![name, program, robot].every((part) => typeof part === 'string') || !Array.isArray(lessons)) continue;
    const isBrought = await post({ do: 'class_bring', name, text: program, robot, lessons }).then(() => true, () => false);
    if (isBrought) count += 1;
  }
  return count || null;
}
