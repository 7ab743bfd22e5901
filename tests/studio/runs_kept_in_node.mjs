// node runs_kept_in_node.mjs SOURCES: keeps runs as the page does. Reads a JSON list of lists of [rows, characters of
// each row, characters of a file, pictures]; prints, for each run of a list, the numbers of those that are kept as it begins and when it
// has ended, their size, its own, and that of its pictures.

import { text } from 'node:stream/consumers';
import { pathToFileURL } from 'node:url';

const { Run, Runs } = await import(pathToFileURL(`${process.argv[2]}/virtual/runs.js`).href);

for (const story of JSON.parse(await text(process.stdin))) {
  const runs = new Runs();
  const kept = story.map(([count, length, file, pictures]) => {
    const run = new Run({ of: 'real', text: '', robot: 'tinibot', program: '' }, { places: [], shows: [], variables: [] }, null);
    runs.addRun(run);
    const atStart = runs.newestFirst.map(({ number }) => number);
    for (let k = 0; k < count; k += 1) run.addRow([k, 'x'.repeat(length)]);
    for (let k = 0; k < pictures; k += 1) run.moments.add({ now_ms: k, events: [] });
    run.fileText = 'x'.repeat(file);
    runs.forgetOldest(); // at its end
    return [atStart, runs.newestFirst.map(({ number }) => number), runs.characterCount, run.characterCount, run.moments.characterCount];
  });
  console.log(JSON.stringify(kept));
}
