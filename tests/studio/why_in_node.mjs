// node why_in_node.mjs SOURCES CASES: prints, for each case, the conditions that are told.

const { blocksOf, conditionsAt } = await import(`${process.argv[2]}/virtual/why.js`);

for (const { text, places, at, values } of JSON.parse(process.argv[3])) {
  const conditions = conditionsAt(text, places, at, (name) => values[name]);
  const [tasks, bodies] = [false, true].map((isBody) => blocksOf(text, places, /^(?:TASK|WHEN)\b/i).filter(({ hasOffset }) => hasOffset(at, isBody)).map(({ line }) => line));
  console.log(JSON.stringify({ told: conditions.map(({ line, condition, values: as, isTrue }) => [line, condition, as, isTrue]), tasks, bodies }));
}
