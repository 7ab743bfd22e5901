// node places_named_in_node.mjs SOURCES MADE SEEDS: places in texts of any kind, named for who sees blocks and for who sees text.
// Prints how many places were named.

import { chanceOf, freshPage, loadTexts, words } from './page_in_node.mjs';

const page = freshPage();
await loadTexts(page);
const { pageState } = await page.load('page/page_state.js');
const { text } = await page.load('page/texts.js');
const { labelAt, sentenceAtPlace } = await page.load('blocks/said.js');
const { shownName } = await page.load('writing/shows.js');
const PARTS = ['F(1, 80)', 'X = 3', 'SHOW(X)', '// a note', '', 'END_LOOP', 'LOOP(FOREVER)', '?!', 'SI|W(1)', 'TWICE(2)', ';'];
let count = 0;
for (let seed = 0; seed < Number(words[0]); seed += 1) {
  const random = chanceOf(seed + 1);
  const lines = Array.from({ length: 1 + random.below(6) }, () => Array.from({ length: 1 + random.below(3) }, () => random.of(PARTS)).join(random.of([';', '; '])));
  const place = { line: 1 + random.below(lines.length + 2), column: 1 + random.below(20) }, program = lines.join('\n');
  pageState.isTyped.set(false);
  for (const key of ['say_fault', 'robot_held', 'task_at', 'no_breakpoint', 'repair_line']) {
    const blockKey = key.replace(/_line$|$/, '_block'), values = { what: 'what', fix: 'fix' };
    pageState.view.set('blocks');
    const part = labelAt(program, place), said = sentenceAtPlace(key, blockKey, program, place, values);
    if (!part.trim()) throw new Error(`a place without a name in ${JSON.stringify(program)}`);
    if (said !== text(blockKey, { ...values, part })) throw new Error(said);
    pageState.view.set('text');
    if (sentenceAtPlace(key, blockKey, program, place, values) !== text(key, { ...values, line: place.line })) throw new Error(`${key} names no line to who sees text`);
    count += 1;
  }
}
// What the robot's panel says is said anew to whoever types, touches blocks or chooses a view.
const { Speech } = await page.load('robot/speech.js');
const speech = new Speech(), sentenceOf = () => sentenceAtPlace('robot_held', 'robot_held_block', 'SI|F(1, 80)', { line: 1, column: 4 });
speech.sayAnew(sentenceOf, 'robot_held');
for (const [view, isTyped] of [['blocks', false], ['blocks', true], ['blocks', false], ['text', false], ['blocks', true], ['text', true]]) {
  pageState.view.set(view);
  pageState.isTyped.set(isTyped);
  if (page.byId('link_said').textContent !== sentenceOf()) throw new Error(`the panel says something else in ${view}, typed: ${isTyped}`);
}
pageState.isTyped.set(false);
// Values of a SHOW that is there several times are told apart: by their lines, or as the first and the second.
for (const [view, wanted] of [['text', ['X (line 2)', 'Y', 'X (line 5)']], ['blocks', ['X (1)', 'Y', 'X (2)']]]) {
  pageState.view.set(view);
  const shows = [[0, 'X', 2, 1, true, false], [4, 'Y', 3, 1, false, false], [8, 'X', 5, 1, true, false]];
  const names = shows.map((show) => shownName(shows, show, show[1], false));
  if (JSON.stringify(names) !== JSON.stringify(wanted)) throw new Error(`${names} in place of ${wanted}`);
}
console.log(count);
