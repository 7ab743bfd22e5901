// Runs verified code as bytecode_spec.md says and tells a robot what it does. It has no clock: each
// call of `turn` is given the time.

import { COMPARATORS, decode } from "./opcodes.mjs";

export class Fault extends Error {}

const LEAST = -(2 ** 31);
const GREATEST = 2 ** 31 - 1;
const DIRECTIONS = { F: [1, 1], B: [-1, -1], L: [-1, 1], R: [1, -1] };

const COMPARE = {
  EQ: (a, b) => a === b,
  NE: (a, b) => a !== b,
  LT: (a, b) => a < b,
  LE: (a, b) => a <= b,
  GT: (a, b) => a > b,
  GE: (a, b) => a >= b,
};

/** a / b to the nearest integer, half away from zero. */
function rounded(a, b) {
  const size = (2n * abs(a) + abs(b)) / (2n * abs(b));
  return a < 0n === b < 0n ? size : -size;
}

const abs = (a) => (a < 0n ? -a : a);
const whole = (a) => Number(rounded(BigInt(a), 1000n));
const limited = (n, low, high) => Math.min(Math.max(n, low), high);

function inRange(value) {
  if (value < LEAST || value > GREATEST) throw new Fault("OVERFLOW");
  return Number(value);
}

const CALCULATE = {
  ADD: (a, b) => inRange(a + b),
  SUB: (a, b) => inRange(a - b),
  MUL: (a, b) => inRange(rounded(BigInt(a) * BigInt(b), 1000n)),
  DIV: (a, b) => inRange(rounded(BigInt(a) * 1000n, BigInt(divisor(b)))),
  MOD: (a, b) => {
    const rest = a % divisor(b);
    return rest !== 0 && rest < 0 !== b < 0 ? rest + b : rest;
  },
  NEG: (a) => inRange(0 - a),
  ABS: (a) => inRange(Math.abs(a)),
  MIN: (a, b) => Math.min(a, b),
  MAX: (a, b) => Math.max(a, b),
  ROUND: (a, places) => {
    const p = whole(places);
    if (p >= 3) return a;
    if (p < -7) return 0; // half of 10^11 is more than any value
    const unit = 10n ** BigInt(3 - p);
    return inRange(rounded(BigInt(a), unit) * unit);
  },
  NOT: (a) => +(a === 0),
  AND: (a, b) => +(a !== 0 && b !== 0),
  OR: (a, b) => +(a !== 0 || b !== 0),
};
for (const name of COMPARATORS) CALCULATE[name] = (a, b) => +COMPARE[name](a, b);

function divisor(b) {
  if (b === 0) throw new Fault("DIVIDE_BY_ZERO");
  return b;
}

function timeOf8(t) {
  if (t < 100) return 10 * t;
  return t < 200 ? 1000 + 100 * (t - 100) : 11000 + 1000 * (t - 200);
}

export class Machine {
  /** `robot` has read(sensor), motors(left, right), set(actuator, value), show(text value), beep(hertz, ms). */
  constructor(code, robot, seed, started) {
    this.code = code;
    this.robot = robot;
    this.pc = 0;
    this.stack = [];
    this.variables = new Array(32).fill(0);
    this.readings = new Array(256).fill(0);
    this.counters = [];
    this.calls = [];
    this.started = started;
    this.clock = started;
    this.wait = null; // null, "wait" or "move"
    this.watched = null; // {powers, time, check, begun, beginning}
    this.late = false;
    this.random = seed >>> 0;
    this.ended = false;
  }

  /** Calls the machine at `now`: it goes on until it waits or ends; throws Fault. */
  turn(now) {
    this.now = now >>> 0;
    if (this.since(this.started) >= 2 ** 31) this.late = true;
    if (this.wait !== null) {
      if (this.since(this.clock) >= 2 ** 31) return;
      if (this.wait === "move") this.robot.motors(0, 0);
      this.wait = null;
    }
    while (this.wait === null && !this.ended) {
      if (this.pc === this.code.length) this.ended = true;
      else this.step();
    }
  }

  since(time) {
    return (this.now - time) >>> 0;
  }

  /** The clock from which a move, a wait or a beep counts. */
  begin() {
    if (this.since(this.clock) > 20) this.clock = this.now;
  }

  pause(ms, kind) {
    this.begin();
    this.clock = (this.clock + ms) >>> 0;
    this.wait = kind;
  }

  move(way, ms, power) {
    this.robot.motors(...powersOf(way, power));
    this.pause(ms, "move");
  }

  beep(ms, hertz) {
    this.robot.beep(limited(hertz, 31, 20000), ms);
    this.pause(ms, "wait");
  }

  read(sensor) {
    this.readings[sensor] = this.robot.read(sensor);
    return this.readings[sensor];
  }

  add(variable, value) {
    this.variables[variable] = inRange(this.variables[variable] + value);
  }

  watch(powers, time, check) {
    this.watched = { powers, time, check, begun: false, beginning: 0 };
  }

  until(stop) {
    const watched = this.watched;
    if (stop) {
      if (!watched.begun) return;
      this.clock = this.now;
      if (watched.powers !== null) this.robot.motors(0, 0);
      return;
    }
    if (!watched.begun) {
      this.begin();
      watched.beginning = this.clock;
      watched.begun = true;
      if (watched.powers !== null) this.robot.motors(...watched.powers);
    }
    const next = (Math.floor(this.since(watched.beginning) / 20) + 1) * 20;
    if (watched.time <= next) {
      this.clock = (watched.beginning + watched.time) >>> 0;
      this.wait = watched.powers === null ? "wait" : "move";
    } else {
      this.clock = (watched.beginning + next) >>> 0;
      this.wait = "wait";
      this.pc = watched.check;
    }
  }

  stepRandom() {
    let x = this.random;
    x ^= x << 13;
    x ^= x >>> 17;
    x ^= x << 5;
    this.random = x >>> 0;
  }

  drawn(low, high) {
    this.stepRandom();
    const [l, h] = [whole(low), whole(high)].sort((a, b) => a - b);
    return inRange(1000 * (l + (this.random % (h - l + 1))));
  }

  /** Runs the instruction at `pc`. */
  step() {
    const { name, operands, after, target, takes } = decode(this.code, this.pc);
    const [x, y] = operands.map(({ value }) => value);
    const taken = takes === 0 ? [] : this.stack.splice(-takes);
    const [a, b] = taken;
    const push = (value) => this.stack.push(value);
    const family = name.split("_");
    const way = family.at(-1);
    this.pc = after;
    if (name in CALCULATE) push(CALCULATE[name](a, b));
    else if (name.startsWith("MOVE8_")) this.move(way, timeOf8(x), y);
    else if (name.startsWith("MOVE_")) this.move(way, Math.max(a, 0), whole(b));
    else if (name === "WATCH_WAIT") this.watch(null, Math.max(a, 0), after);
    else if (name === "WATCH_FOREVER_WAIT") this.watch(null, Infinity, after);
    else if (name.startsWith("WATCH_FOREVER_")) this.watch(powersOf(way, whole(a)), Infinity, after);
    else if (name.startsWith("WATCH_")) this.watch(powersOf(way, whole(b)), Math.max(a, 0), after);
    else if (/^UNTIL(8|16)_/.test(name)) this.until(COMPARE[way](a, 1000 * x));
    else if (/^IF(8|16)_/.test(name)) this.jumpUnless(COMPARE[way](a, 1000 * x), target);
    else if (/^IF_VAR(8|16)_/.test(name)) this.jumpUnless(COMPARE[way](this.variables[x], 1000 * y), target);
    else this.other(name, x, y, a, b, push, target, after);
  }

  jumpUnless(condition, target) {
    if (!condition) this.pc = target;
  }

  other(name, x, y, a, b, push, target, after) {
    switch (name) {
      case "PUSH8": case "PUSH16": push(1000 * x); break;
      case "PUSH_MILLI": case "PUSH32": push(x); break;
      case "PUSH_TENTHS": push(100 * x); break;
      case "PUSH_FALSE": push(0); break;
      case "PUSH_TRUE": push(1); break;
      case "PUSH_VAR": push(this.variables[x]); break;
      case "PUSH_SENSOR": push(this.readings[x]); break;
      case "PUSH_READ": push(this.read(x)); break;
      case "TIME":
        if (this.late) throw new Fault("OVERFLOW");
        push(this.since(this.started));
        break;
      case "RANDOM": push(this.drawn(a, b)); break;
      case "AND_THEN":
        if (a === 0) push(a), (this.pc = target);
        break;
      case "OR_ELSE":
        if (a !== 0) push(a), (this.pc = target);
        break;
      case "SET_VAR": this.variables[x] = a; break;
      case "SET_VAR8": this.variables[x] = 1000 * y; break;
      case "ADD_VAR8": this.add(x, 1000 * y); break;
      case "ADD_VAR": this.add(x, this.variables[y]); break;
      case "INC_VAR": this.add(x, 1000); break;
      case "DEC_VAR": this.add(x, -1000); break;
      case "READ": this.read(x); break;
      case "SHOW": this.robot.showNumber(a); break;
      case "SHOW_YES_NO": this.robot.showYesNo(a); break;
      case "SET": this.robot.set(x, a, 1000 * whole(a)); break;
      case "WAIT": this.pause(Math.max(a, 0), "wait"); break;
      case "WAIT8": this.pause(timeOf8(x), "wait"); break;
      case "UNTIL": this.until(a !== 0); break;
      case "BEEP8": this.beep(timeOf8(x), y); break;
      case "BEEP": this.beep(Math.max(a, 0), whole(b)); break;
      case "STOP": this.robot.motors(0, 0); break;
      case "MOTORS": this.robot.motors(limited(whole(a), -100, 100), limited(whole(b), -100, 100)); break;
      case "MOTORS8": this.robot.motors(x, y); break;
      case "IF": this.jumpUnless(a !== 0, target); break;
      case "IF_NOT": this.jumpUnless(a === 0, target); break;
      case "ELSE": case "AGAIN": case "BREAK": case "DEF": this.pc = target; break;
      case "LOOP":
        if (whole(a) < 1) this.pc = target;
        else this.counters.push(whole(a));
        break;
      case "LOOP8": this.counters.push(x); break;
      case "NEXT":
        if (this.counters[this.counters.length - 1] > 1) {
          this.counters[this.counters.length - 1] -= 1;
          this.pc = target;
        } else this.counters.pop();
        break;
      case "BREAK_LOOP": this.counters.pop(); this.pc = target; break;
      case "CALL": this.calls.push(after); this.pc = target; break;
      case "RETURN": this.pc = this.calls.pop(); break;
    }
  }
}

function powersOf(way, power) {
  const [left, right] = DIRECTIONS[way];
  const size = limited(power, 0, 100);
  return [left * size, right * size];
}
