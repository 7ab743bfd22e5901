// The newest run of a pupil, which the teacher asks for: in parts, as a request is small. It is somebody
// else's: the page that plays it checks all of it.

import { post } from '../robot/host.js';

const PART = 60_000; // characters: each has three bytes at most
const LOOK_MS = 300;
const WAIT_MS = 15_000;

/** Gives it to the class. @param {number} asked the number of the question @param {() => Promise<string>} newest its file, or nothing */
export async function giveRun(asked, newest) {
  const file = await newest().catch(() => '');
  for (let from = 0; from === 0 || from < file.length; from += PART) {
    const part = file.slice(from, from + PART);
    await post({ do: 'run', asked, from, part, is_last: from + PART >= file.length });
  }
}

/** Asks a pupil's page for it; nothing where it has none, null where it does not answer. @param {number} pupil @returns {Promise<string | null>} */
export async function runOf(pupil) {
  const until = performance.now() + WAIT_MS;
  for (let isFirst = true; performance.now() < until; isFirst = false) {
    const { run } = await post({ do: 'class_run', pupil, asks: isFirst });
    if (typeof run === 'string') return run;
    await new Promise((resolve) => { setTimeout(resolve, LOOK_MS); });
  }
  return null;
}
