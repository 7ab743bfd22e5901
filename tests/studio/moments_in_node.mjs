// node moments_in_node.mjs SOURCES SEEDS: random runs are kept moment by moment, and looked back at. Prints a JSON row for
// each seed: how many moments were kept of how many states, and the first thing that was not as it had been.

const { Moments } = await import(`${process.argv[2]}/virtual/moments.js`);

function chanceOf(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const rounded = (value) => JSON.parse(JSON.stringify(value, (_, item) => (typeof item === 'number' ? Math.round(item * 1000) / 1000 : item)));

const hasDone = ({ events }) => events.some(([, event]) => !event.startsWith('READ '));

function play(moments, random, most) {
  const count = Math.floor(random() * 2000), quiet = random();
  const below = (limit) => Math.floor(random() * limit);
  const told = new Map(); // by its time: the state, and all that had been shown
  let now_ms = below(100), bumps = 0, place = 0, pose = [0, 0, 0];
  const shows = [];
  const wrong = [];
  const check = (isRight, message) => isRight || wrong.push(message);
  moments.at(0); // there is none yet
  for (let k = 0; k < count; k += 1) {
    now_ms += 1 + below(30);
    const isQuiet = random() < quiet;
    if (!isQuiet) place = below(4);
    if (!isQuiet && random() < 0.1) bumps += 1;
    if (random() < 0.7) pose = [random() * 100, random() * 100, random() * 360];
    const events = isQuiet || random() < 0.5 ? [] : [[now_ms, random() < 0.5 ? `SHOW ${below(9)}` : 'MOTORS 1 2', place]];
    if (random() < 0.5) events.unshift([now_ms, 'READ DISTANCE 5', place]);
    shows.push(...events.filter(([, event]) => event.startsWith('SHOW')));
    const state = { now_ms, pose, bumps, at: place, places: [place], is_running: true, variables: [below(3)], events, nothing: random() < 0.5 ? null : 'é"' };
    told.set(now_ms, [rounded(state), shows.length]);
    moments.add(state);
    check(moments.characterCount <= most + 1000, `too large: ${moments.characterCount}`);
  }
  const times = [];
  for (let k = 0; k < moments.length; k += 1) {
    const state = moments.at(k), [was, shown] = told.get(state.now_ms) ?? [];
    check(JSON.stringify(state, Object.keys(was ?? {}).sort()) === JSON.stringify(was, Object.keys(was ?? {}).sort()), `another state: ${JSON.stringify([state, was])}`);
    const isEvent = hasDone(state) || (k > 0 && state.bumps !== moments.at(k - 1).bumps);
    if (k) check(moments.events.includes(k) === isEvent, `not the events: ${k}`);
    const last = new Map(shows.slice(0, shown).map((event) => [event[2], event])); // those that began first come first
    check(JSON.stringify(state.shown) === JSON.stringify([...last.values()]), `other shows at ${k}`);
    check(moments.momentAt(state.now_ms) === k && moments.momentAt(state.now_ms + 0.5) === k, `another moment than ${k}`);
    times.push(state.now_ms);
    if (k) check(moments.parts.includes(k) === (state.at !== moments.at(k - 1).at), `not the parts: ${k}`);
  }
  check(!count || moments.parts[0] === 0 || times[0] > told.keys().next().value, 'the first part is missing');
  check(times.every((time, k) => k === 0 || time > times[k - 1]), 'not in order');
  check(!count || times.at(-1) > now_ms - 40 * 64, 'the newest is missing');
  const first = times[0] ?? 0;
  for (const [time, [was]] of told) {
    if (hasDone(was) && time >= first) check(times.includes(time), `an event is missing: ${time}`);
  }
  for (const which of [moments.events, moments.parts]) {
    let k = moments.length - 1;
    const back = [];
    while (k > 0) back.push(k = moments.neighbourOf(k, -1, which));
    for (const event of which) check(back.includes(event) || event === moments.length - 1, `${event} is passed on the way back`);
    for (const event of back.reverse()) {
      check(k <= event, 'on goes back');
      k = moments.neighbourOf(event, 1, which);
      check(k > event || event === moments.length - 1, 'stands still on the way on');
    }
  }
  return { kept: moments.length, states: count, wrong: wrong.slice(0, 1) };
}

for (let seed = 1; seed <= Number(process.argv[3]); seed += 1) {
  const random = chanceOf(seed * 7919);
  const most = [3000, 20_000, 2_000_000][seed % 3];
  const moments = new Moments(most);
  play(moments, random, most);
  moments.clear(); // the second run knows nothing of the first one
  console.log(JSON.stringify(play(moments, random, most)));
}
