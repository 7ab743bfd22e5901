// node search_in_node.mjs SOURCES MADE TEXTS: reads words of JSON on its standard input, in the language of the texts. Prints
// for each the blocks that a search finds; then for each block of the lists what it is called, with what that finds.

import { readFileSync } from 'node:fs';
import { blocklyInNode } from './blockly_in_node.mjs';
import { freshPage, replaceFetch, words } from './page_in_node.mjs';

const page = freshPage({ blockly: blocklyInNode().blockly });
replaceFetch(async () => ({ ok: true, json: async () => JSON.parse(readFileSync(words[0], 'utf-8')) }));
await (await page.load('page/texts.js')).setLanguage('en');
(await page.load('page/page_state.js')).pageState.robotName.set('tinibot');
(await page.load('blocks/shapes.js')).setRobot('tinibot');
const { findItems, makeToolbox } = await page.load('blocks/toolbox.js');
const { labelOfKind } = await page.load('blocks/said.js');
const { KINDS, wordsOnBlock } = await page.load('page/words.js');
const USED = { names: ['SPEED'], words: [['DANCE', 1]] };
const wordOf = ({ fields = {} }) => fields.WORD ?? '';
const nameOf = (item) => `${item.type} ${wordOf(item)}`.trim();
for (const line of readFileSync(0, 'utf-8').split('\n').filter(Boolean)) {
  console.log(JSON.stringify(findItems(JSON.parse(line), USED).map(nameOf)));
}
for (const item of makeToolbox('all', USED, [], []).contents.flatMap(({ contents }) => contents)) {
  const word = wordOf(item), { text } = labelOfKind(item.type, word, null);
  const names = [text.replace(/[…%,.?¿()]+/g, ' ').trim(), ...KINDS[item.type].words.length ? [word] : [], ...wordsOnBlock(item.type)].filter(Boolean);
  for (const name of names) console.log(JSON.stringify([nameOf(item), name, findItems(name, USED).map(nameOf)]));
}
