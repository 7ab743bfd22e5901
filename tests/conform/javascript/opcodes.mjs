// The instructions, as bytecode_spec.md lists them: code, name, operands, what each takes from the
// stack and leaves there, and its role for the verifier. It knows no state.

const ROWS = `
00 END - 0 0 end
01 PUSH8 u8 0 1 value
02 PUSH16 i16 0 1 value
03 PUSH_MILLI milli16 0 1 value
04 PUSH32 milli32 0 1 value
05 PUSH_FALSE - 0 1 value
06 PUSH_TRUE - 0 1 value
07 PUSH_VAR variable 0 1 value
08 PUSH_SENSOR sensor 0 1 value
09 PUSH_READ sensor 0 1 value
0a TIME - 0 1 value
0b RANDOM - 2 1 value
0c PUSH_TENTHS tenths 0 1 value
10 ADD - 2 1 value
11 SUB - 2 1 value
12 MUL - 2 1 value
13 DIV - 2 1 value
14 MOD - 2 1 value
15 NEG - 1 1 value
16 ABS - 1 1 value
17 MIN - 2 1 value
18 MAX - 2 1 value
19 ROUND - 2 1 value
20 EQ - 2 1 value
21 NE - 2 1 value
22 LT - 2 1 value
23 LE - 2 1 value
24 GT - 2 1 value
25 GE - 2 1 value
26 NOT - 1 1 value
27 AND - 2 1 value
28 OR - 2 1 value
2a AND_THEN fwd8 1 0 join
2b AND_THEN fwd16 1 0 join
2c OR_ELSE fwd8 1 0 join
2d OR_ELSE fwd16 1 0 join
30 SET_VAR variable 1 0 plain
31 SET_VAR8 variable,i8 0 0 plain
32 ADD_VAR8 variable,i8 0 0 plain
33 ADD_VAR variable,variable 0 0 plain
34 INC_VAR variable 0 0 plain
35 DEC_VAR variable 0 0 plain
38 READ sensor 0 0 read
39 SHOW - 1 0 plain
3a SHOW_YES_NO - 1 0 plain
3b SET actuator 1 0 plain
50 WAIT - 1 0 plain
51 WAIT8 time8 0 0 plain
52 WATCH_WAIT - 1 0 watch
53 WATCH_FOREVER_WAIT - 0 0 watch
54 UNTIL - 1 0 until
56 BEEP8 time8,u16 0 0 plain
58 STOP - 0 0 plain
59 MOTORS - 2 0 plain
5a MOTORS8 percent,percent 0 0 plain
5b BEEP - 2 0 plain
60 IF fwd8 1 0 if
61 IF fwd16 1 0 if
62 IF_NOT fwd8 1 0 if
63 IF_NOT fwd16 1 0 if
64 ELSE fwd8 0 0 else
65 ELSE fwd16 0 0 else
68 FOREVER - 0 0 forever
69 WHILE fwd8 0 0 while
6a WHILE fwd16 0 0 while
6b AGAIN back8 0 0 again
6c AGAIN back16 0 0 again
6d LOOP8 count 0 0 count
6e LOOP fwd8 1 0 loop
6f LOOP fwd16 1 0 loop
70 NEXT back8 0 0 next
71 NEXT back16 0 0 next
72 BREAK fwd8 0 0 break
73 BREAK fwd16 0 0 break
74 BREAK_LOOP fwd8 0 0 drop
75 BREAK_LOOP fwd16 0 0 drop
78 DEF fwd8 0 0 def
79 DEF fwd16 0 0 def
7a RETURN - 0 0 return
7b CALL back8 0 0 call
7c CALL back16 0 0 call
`;

/** Bytes of each operand, its least and greatest value. */
export const OPERANDS = {
  u8: [1, 0, 255],
  i8: [1, -128, 127],
  i16: [2, -32768, 32767],
  milli16: [2, -32768, 32767],
  milli32: [4, -2147483648, 2147483647],
  tenths: [1, -128, 127],
  time8: [1, 0, 255],
  u16: [2, 0, 65535],
  power: [1, 0, 100],
  percent: [1, -100, 100],
  count: [1, 1, 255],
  variable: [1, 0, 31],
  sensor: [1, 0, 31],
  actuator: [1, 0, 31],
  fwd8: [1, 0, 255],
  fwd16: [2, 0, 65535],
  back8: [1, 0, 255],
  back16: [2, 0, 65535],
};

export const COMPARATORS = ["EQ", "NE", "LT", "LE", "GT", "GE"];
const DIRECTIONS = ["F", "B", "L", "R"];

/** code -> {name, kinds, takes, leaves, role, fixed}; `fixed` is the operand of a short form. */
export const OPCODES = new Map();

function row(code, name, kinds, takes, leaves, role, fixed = []) {
  OPCODES.set(code, { name, kinds, takes, leaves, role, fixed });
}

for (const line of ROWS.trim().split("\n")) {
  const [code, name, kinds, takes, leaves, role] = line.split(" ");
  row(parseInt(code, 16), name, kinds === "-" ? [] : kinds.split(","), +takes, +leaves, role);
}
DIRECTIONS.forEach((way, i) => {
  row(0x40 + i, `MOVE_${way}`, [], 2, 0, "plain");
  row(0x44 + i, `MOVE8_${way}`, ["time8", "power"], 0, 0, "plain");
  row(0x48 + i, `WATCH_${way}`, [], 2, 0, "watch");
  row(0x4c + i, `WATCH_FOREVER_${way}`, [], 1, 0, "watch");
});
for (let n = 0; n < 8; n++) {
  row(0x80 + n, "PUSH_VAR", [], 0, 1, "value", [["variable", n]]);
  row(0x88 + n, "PUSH_SENSOR", [], 0, 1, "value", [["sensor", n]]);
  row(0x90 + n, "PUSH_READ", [], 0, 1, "value", [["sensor", n]]);
  row(0x98 + n, "READ", [], 0, 0, "read", [["sensor", n]]);
  row(0xa0 + n, "SET_VAR", [], 1, 0, "plain", [["variable", n]]);
  row(0xa8 + n, "SET", [], 1, 0, "plain", [["actuator", n]]);
}
[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 20, 30, 40, 50, 60, 70, 80, 90, 100].forEach((n, i) => {
  row(0xb0 + i, "PUSH8", [], 0, 1, "value", [["u8", n]]);
});
COMPARATORS.forEach((comparator, i) => {
  row(0xc8 + i, `UNTIL8_${comparator}`, ["u8"], 1, 0, "until");
  row(0xd0 + i, `UNTIL16_${comparator}`, ["i16"], 1, 0, "until");
  row(0xd8 + i, `IF8_${comparator}`, ["u8", "fwd8"], 1, 0, "if");
  row(0xe0 + i, `IF16_${comparator}`, ["i16", "fwd8"], 1, 0, "if");
  row(0xe8 + i, `IF_VAR8_${comparator}`, ["variable", "u8", "fwd8"], 0, 0, "if");
  row(0xf0 + i, `IF_VAR16_${comparator}`, ["variable", "i16", "fwd8"], 0, 0, "if");
});

/** The instruction at `at`: its row, its operands and where the next one begins; null if there is none. */
export function decode(code, at) {
  const op = OPCODES.get(code[at]);
  if (op === undefined) return null;
  const operands = op.fixed.map(([kind, value]) => ({ kind, value }));
  let after = at + 1;
  for (const kind of op.kinds) {
    const [size, least] = OPERANDS[kind];
    let value = 0;
    for (let i = 0; i < size; i++) value += (code[after + i] ?? 0) * 2 ** (8 * i);
    if (least < 0 && value >= 2 ** (8 * size - 1)) value -= 2 ** (8 * size);
    after += size;
    operands.push({ kind, value });
  }
  const jump = operands.find(({ kind }) => kind.startsWith("fwd") || kind.startsWith("back"));
  let target = null;
  if (jump !== undefined) target = jump.kind.startsWith("fwd") ? after + jump.value : after - jump.value;
  return { ...op, operands, after, target };
}
