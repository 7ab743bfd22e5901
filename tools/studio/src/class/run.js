// The newest run of a pupil, which the teacher asks for: in parts, as a request is small. It is somebody
// else's: the page that plays it checks all of it.

import { post } from '../robot/host.js';

const PART_CHARACTERS = 60_000; // characters: each has three bytes at most
const POLL_MS = 300;
const ANSWER_LIMIT_MS = 15_000;

/** Gives it to the class. @param {number} questionNumber the number of the question @param {() => Promise<string>} fetchNewestRunFile its file, or nothing */
export async function giveRun(questionNumber, fetchNewestRunFile) {
  const file = await fetchNewestRunFile().catch(() => '');
  for (let offset = 0; offset === 0 || offset < file.length; offset += PART_CHARACTERS) {
    const part = file.slice(offset, offset + PART_CHARACTERS);
    await post({ do: 'run', asked: questionNumber, from: offset, part, is_last: offset + PART_CHARACTERS >= file.length });
  }
}

/** Asks a pupil's page for it; nothing where it has none, null where it does not answer. @param {number} pupilNumber @returns {Promise<string | null>} */
export async function fetchRun(pupilNumber) {
  const deadline_ms = performance.now() + ANSWER_LIMIT_MS;
  for (let isFirst = true; performance.now() < deadline_ms; isFirst = false) {
    const { run } = await post({ do: 'class_run', pupil: pupilNumber, asks: isFirst });
    if (typeof run === 'string') return run;
    await new Promise((resolve) => { setTimeout(resolve, POLL_MS); });
  }
  return null;
}
