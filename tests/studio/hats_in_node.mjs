// node hats_in_node.mjs SOURCES SEEDS: random programs with hats, some of which are moved or new. Prints a JSON row
// for each seed: how many DEFs had to move up, and the first law that does not hold of the order in the text.

const { findEarlyDefs, inTextOrder } = await import(`${process.argv[2]}/blocks/hats.js`);

function chanceOf(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const isHat = ({ block }) => ['def', 'task', 'when'].includes(block.kind);
const calls = (block, word) => (block.kind === 'call' && block.word === word) || block.bodies.some((body) => body.some((item) => calls(item, word)));

function row(seed) {
  const random = chanceOf(seed);
  const below = (limit) => Math.floor(random() * limit);
  let count = 0;
  const item = (kind, word = '', bodies = []) => ({ block: { kind, word, values: [], bodies, note: '', is_apart: false }, ids: [`${count++}`] });
  const plain = (depth = 0) => {
    const what = below(5);
    if (what < 2) return item('call', `D${below(4)}`).block;
    return what === 2 && depth < 3 ? item('loop', '', [Array.from({ length: below(3) }, () => plain(depth + 1))]).block : item('move').block;
  };
  const body = () => Array.from({ length: below(4) }, () => plain());
  const text = Array.from({ length: below(4) }, () => item('comment'));
  for (let k = below(12); k; k -= 1) {
    const what = below(6);
    if (what === 0) text.push(item('def', `D${below(4)}`, [body()]));
    else if (what < 3) text.push(item(what === 1 ? 'when' : 'task', '', [body()]));
    else text.push(random() < 0.1 ? item('comment') : { ...item('move'), block: plain() });
  }
  const program = text.filter((item) => !isHat(item));
  const placed = text.filter(isHat).map((hat) => ({ ...hat, x: below(5), y: below(500),
    gap: text.slice(0, text.indexOf(hat)).filter((item) => !isHat(item)).length }));
  const excused = findEarlyDefs(text.map(({ block }) => block));
  const ids = (items) => items.map((item) => item.ids[0]);
  const wrong = [];
  const check = (isRight, message) => isRight || wrong.push(message);
  check(`${ids(inTextOrder(program, placed, excused))}` === `${ids(text)}`, 'looking at a text changes it');

  const hats = placed.map((hat) => ({ ...hat, gap: random() < 0.4 ? null : hat.gap }));
  const order = inTextOrder(program, hats, excused);
  check(`${ids(order).sort()}` === `${ids(text).sort()}`, 'something is lost or doubled');
  check(`${ids(order.filter((item) => !isHat(item)))}` === `${ids(program)}`, 'the program has another order');
  const indexOf = (hat) => order.findIndex((item) => item.ids[0] === hat.ids[0]);
  const moved = hats.filter(({ gap }) => gap === null), events = moved.filter(({ block }) => block.kind !== 'def');
  const last = order.findLastIndex((item) => !isHat(item)), first = order.findIndex((item) => !isHat(item) && item.block.kind !== 'comment');
  for (const hat of events) check(indexOf(hat) > last, 'a moved event stands before the end of the program');
  for (const hat of moved) if (hat.block.kind === 'def' && first >= 0) check(indexOf(hat) < first, 'a moved DEF stands after the program began');
  for (const one of events) for (const other of events) check(!(one.y < other.y) || indexOf(one) < indexOf(other), 'events are not top to bottom');
  const words = order.filter(({ block }) => block.kind === 'def').map(({ block }) => block.word);
  const callsOf = (word) => words.filter((other) => order.some(({ block }) => block.kind === 'def' && block.word === word && calls(block, other)));
  const isRound = (word, seen = [word]) => callsOf(word).some((next) => next === seen[0] || (!seen.includes(next) && isRound(next, [...seen, next])));
  if (!words.some((word) => isRound(word)) && new Set(words).size === words.length) {
    const early = findEarlyDefs(order.map(({ block }) => block));
    for (const word of early) check(excused.has(word), `${word} is called before it`);
  }
  return { hats: hats.length, moved: moved.length, excused: excused.size, wrong: wrong[0] ?? '' };
}

for (let seed = 1; seed <= Number(process.argv[3]); seed += 1) console.log(JSON.stringify(row(seed)));
