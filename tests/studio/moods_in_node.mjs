// node moods_in_node.mjs SOURCES: how a robot looks after each of its states, and when somebody looks back at all of them.
// Reads a JSON list of lists of states; prints, for each, {seen, again}: faces.

import { text } from 'node:stream/consumers';
import { pathToFileURL } from 'node:url';

const { Moods } = await import(pathToFileURL(`${process.argv[2]}/virtual/moods.js`).href);

const found = JSON.parse(await text(process.stdin)).map((states) => {
  const moods = new Moods();
  const seen = states.map((state) => {
    moods.followState(state);
    return moods.faceOf(state);
  });
  return { seen, again: states.map((state) => moods.faceOf(state)) };
});
console.log(JSON.stringify(found));
