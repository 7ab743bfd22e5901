// node tones_in_node.mjs SOURCES: prints, as one JSON row, what the page's piano is: each key with its hertz, its
// name, and the keys that the arrows lead to from it and from tones beside it.

const { HIGHEST_KEY, keyOfHertz, LOWEST_KEY, keyName, hertzOfKey, nextKeyFrom } = await import(`${process.argv[2]}/blocks/tones.js`);

const names = ['C', 'D', 'E', 'F', 'G', 'A', 'B'];
const keys = Array.from({ length: HIGHEST_KEY - LOWEST_KEY + 1 }, (_, k) => LOWEST_KEY + k);
const tones = [1, 31, 64, 66, 100, 261.5, 440, 441, 439, 1000, 5000, 20_000];
console.log(JSON.stringify({
  keys: keys.map((key) => ({ key, hertz: hertzOfKey(key), back: keyOfHertz(hertzOfKey(key)), name: keyName(key, names) })),
  steps: [...keys.map(hertzOfKey), ...tones].flatMap((hertz) => [1, -1].map((way) => ({ hertz, way, to: hertzOfKey(nextKeyFrom(hertz, way)) }))),
}));
