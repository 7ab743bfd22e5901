// node insert_in_node.mjs SOURCES MADE SEEDS: programs of a few blocks, one of which somebody has touched, and a tap on a block
// of the lists. Prints for each tap the kind of the block, where it went, and the first law that does not hold.

import { blocklyInNode } from './blockly_in_node.mjs';
import { chanceOf, freshPage, loadTexts, replaceNavigator, wait, words } from './page_in_node.mjs';

globalThis.innerWidth = 390;
const { blockly, seen } = blocklyInNode();
const page = freshPage({ blockly });
replaceNavigator({});
await loadTexts(page);
(await page.load('page/page_state.js')).pageState.robotName.set('tinibot');
globalThis.CSSStyleSheet = class { replaceSync() {} };
document.adoptedStyleSheets = [];
const { Blocks } = await page.load('blocks/blocks.js');
const { bodyConnectionOf } = await page.load('blocks/insert.js');
const { isLoose } = await page.load('blocks/form.js');
const container = Object.assign(page.byId('blocks'), { clientWidth: 390, clientHeight: 600 });
const blocks = new Blocks(container, 'tinibot', 'all', { onChange() {}, toggleBreakpoint() {}, async tryAlone() {}, playTone() {} });
const [workspace] = seen.workspaces, list = new blockly.Workspace();
const items = workspace.list.contents.flatMap(({ contents }) => contents);
const { append } = blockly.serialization.blocks;

function row(seed) {
  const random = chanceOf(seed);
  const block = (depth = 0) => random.of([
    () => ({ kind: 'move', word: 'F', values: [[['NUMBER', '1']], [['NUMBER', '80']]], bodies: [] }),
    () => ({ kind: 'beep', word: 'BEEP', values: [[['DISTANCE', '']], [['NUMBER', '440']]], bodies: [] }),
    () => ({ kind: random.of(['loop', 'forever']), word: 'LOOP', values: [], bodies: [depth < 2 ? body(depth + 1) : []] }),
  ])();
  const full = (item) => ({ note: '', is_apart: false, ...item, values: item.kind === 'loop' ? [[['NUMBER', '3']]] : item.values });
  const body = (depth = 0) => Array.from({ length: random.below(4) }, () => full(block(depth)));
  const hat = () => full({ kind: random.of(['task', 'def']), word: 'D', values: [], bodies: [body(1)] });
  blocks.show({ start: 'SI', note: '', is_one_line: false, body: [...body(), ...Array.from({ length: random.below(3) }, hat)], loose: random() < 0.4 ? [{ body: [full(block(2))], value: [] }] : [] });
  const before = workspace.getAllBlocks(true), isThere = new Set(before.map(({ id }) => id));
  const touched = random() < 0.7 ? random.of(before) : null;
  const target = { closest: () => touched && { getAttribute: () => touched.id } };
  container.dispatchEvent(Object.defineProperty(new Event('focusin'), 'target', { value: target }));
  /** The blocks of each stack in their order, without new ones. */
  const stacks = () => JSON.stringify(workspace.getTopBlocks(false).map((root) => root.getDescendants(true).map(({ id }) => id).filter((id) => isThere.has(id))).filter(({ length }) => length).sort());
  const stacksBefore = stacks();
  const item = random.of(items), tapped = append(item, list);
  blockly.Gesture.prototype.doBlockClick.call({ flyout: {}, targetBlock: tapped });
  list.clear();
  const made = seen.focused, roots = workspace.getTopBlocks(false);
  const wrong = [];
  const check = (isRight, message) => isRight || wrong.push(message);
  check(made && !isThere.has(made.id) && made.type === item.type, 'the new block does not have the focus');
  check(stacks() === stacksBefore, 'another block is lost, or elsewhere');
  const where = made.getParent() ? 'joined' : 'loose';
  check((where === 'joined') === Boolean(made.previousConnection), `what ${made.previousConnection ? 'stands in a stack' : 'does not'} is ${where}`);
  for (const loose of roots.filter((root) => root === made || isLoose(root))) {
    const box = loose.getBoundingRectangle();
    check(!roots.some((other) => other !== loose && other.getBoundingRectangle().intersects(box)), 'a block covers another one');
  }
  if (where === 'joined') {
    let above = touched; // in which stack somebody touched
    while (above && !above.nextConnection) above = above.getParent();
    if (above) check([above, above.getNextBlock(), bodyConnectionOf(above)?.targetBlock()].includes(made) || above.type === 'forever', 'it is not behind what was touched');
    else check(made.getRootBlock().type === 'program', 'it is not in the program');
    const connection = made.previousConnection.targetConnection, outer = connection.getSourceBlock();
    check(outer.type !== 'forever' || connection !== outer.nextConnection, 'no robot comes there');
  }
  return { kind: item.type, where, wrong: wrong[0] ?? '' };
}

await wait(100);
for (let seed = 1; seed <= Number(words[0]); seed += 1) console.log(JSON.stringify(row(seed)));
process.exit(0);
