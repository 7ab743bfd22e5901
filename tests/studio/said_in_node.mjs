// node said_in_node.mjs SOURCES MADE: reads rows of JSON on its standard input, each with a robot, a sentence, and what each
// code in it is as a block. Prints for each the sentence's parts, and whether a part is what the page shows on a block.

import { readFileSync } from 'node:fs';
import { freshPage, loadTexts } from './page_in_node.mjs';

const page = freshPage();
await loadTexts(page);
const { pageState } = await page.load('page/page_state.js');
const { labelOfCode } = await page.load('blocks/said.js');
for (const line of readFileSync(0, 'utf-8').split('\n').filter(Boolean)) {
  const { robot, sentence, spoken } = JSON.parse(line);
  pageState.robotName.set(robot);
  console.log(JSON.stringify(sentence.split(/(`[^`]+`)/).filter(Boolean).map((part) => {
    if (!part.startsWith('`')) return [false, part];
    const code = part.slice(1, -1), label = labelOfCode(code, spoken);
    return [label !== null, label?.text ?? code];
  })));
}
