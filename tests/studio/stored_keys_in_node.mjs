// node stored_keys_in_node.mjs SOURCES MADE SEEDS: a robot at a port of this tab, whose session gets new keys now and then, and
// other tabs that store keys of their own at any moment. Prints as JSON, for each seed, how many keys were stored by others or
// given to the robot, those that are not stored at the end, and those that the robot was given before they were.

import { chanceOf, freshPage, later, loadTexts, replaceNavigator, wait, words } from './page_in_node.mjs';

replaceNavigator({});
const page = freshPage();
await loadTexts(page);
const { DirectRobot } = await page.load('robot/direct.js');
for (let seed = 0; seed < Number(words[0]); seed += 1) {
  const random = chanceOf(seed + 1);
  const all = new Set();
  const early = [];
  let stored = [];
  let count = 10;
  const ring = new Set();
  const python = {
    async ask({ do: action, kept }, data) {
      const text = action === 'connect' ? new TextDecoder().decode(data) : kept;
      const before = ring.size;
      for (const key of text?.split(',') ?? []) if (key) ring.add(key);
      let isNew = ring.size > before && action === 'link';
      let send = '';
      if (action === 'link' && random() < 0.1) {
        isNew = true;
        send = String(count += 1);
        ring.add(send);
      }
      const keys = isNew ? [...ring].join() : undefined;
      await later(random.below(60));
      return { send, keys, news: [], wakes_ms: null };
    },
  };
  const port = {
    isRadio: true, lossReason: 'port_gone', async open() {}, async close() {},
    async write(data) {
      if (data.length === 1) { // no zeros, which stop it
        const key = data[0].toString(16);
        all.add(key);
        if (!stored.includes(key)) early.push(key);
      }
      await later(1);
      if (random() < 0.02) throw new Error('it is gone');
    },
  };
  const keyStore = { load: () => stored.join(), store(keys) { stored = keys.split(','); } };
  const robot = new DirectRobot(python, port, { onEvent() {}, onEnd() {} }, keyStore);
  robot.connect('tinibot', 'en').catch(() => {});
  for (let k = 0; k < 40; k += 1) {
    await wait(random.below(300));
    if (random() < 0.3) {
      const key = String(count += 1);
      all.add(key);
      stored = [...stored, key];
    }
  }
  robot.leave();
  await wait(500);
  console.log(JSON.stringify({ count: all.size, lost: [...all].filter((key) => !stored.includes(key)), early }));
}
