// node keys_in_node.mjs SOURCES MADE WAY: a hand at a stick that moves all the time, over a way to a robot, on a clock of the
// script. Prints as JSON when each word of it was sent, and what it says.

import { freshPage, later, loadTexts, now, replaceFetch, replaceNavigator, wait, words } from './page_in_node.mjs';

const sent = [];
const keep = (asked) => sent.push(...asked.filter((item) => item.do === 'keys').map(({ y }) => [now(), y]));
const responseOf = (value) => ({ ok: true, status: 200, json: async () => value });
const heard = { onEvent() {}, onEnd() {} };
replaceNavigator({});
const page = freshPage();
await loadTexts(page);
const ways = {
  // Through `tsc studio`, which answers at once; how many times it is asked is counted.
  async host() {
    let beats = 0;
    replaceFetch(async (_, { body }) => {
      const request = JSON.parse(body);
      if (request.do === 'beat') beats += 1;
      keep(request.asked ?? []);
      await later(1);
      return responseOf({ news: request.do === 'beat' && beats === 1 ? [{ number: 1, connected: {} }] : [] });
    });
    const { HostRobot } = await page.load('robot/host.js');
    const robot = new HostRobot(heard);
    robot.connect('p', 'tinibot', 'en');
    return { robot, asked: () => beats };
  },
  // At a port of the browser's own, while Python is busy now and then.
  async direct() {
    let count = 0;
    const python = {
      async ask({ do: action, asked = [] }) {
        if (action === 'link') count += 1;
        await later(count % 20 ? 2 : 150);
        keep(asked);
        const news = asked.map(({ id }) => ({ id, ok: true, robot: {} }));
        return { send: '', news, wakes_ms: null };
      },
    };
    const port = { isRadio: true, lossReason: '', open: async () => {}, write: async () => {}, close: async () => {} };
    const { DirectRobot } = await page.load('robot/direct.js');
    const robot = new DirectRobot(python, port, heard, { load: () => '', store() {} });
    robot.connect('tinibot', 'en');
    return { robot, asked: () => count };
  },
};
const { robot, asked } = await ways[words[0]]();
await wait(1000);
sent.length = 0;
const before = asked();
let answered = 0;
for (let k = 1; k <= 1000; k += 1) {
  robot.press({ keys: 0, x: 0, y: k }).then(() => (answered += 1));
  await wait(5);
}
robot.press({ keys: 0, x: 0, y: 0 });
const released = now();
await wait(1000);
console.log(JSON.stringify({ sent, asked: asked() - before, answered, released, over: robot.isOver }));
process.exit(0);
