// Verifies code in one pass, step by step as "What must be refused" of bytecode_spec.md lists them.
// It knows how many devices a kit has, and runs nothing.

import { decode, OPERANDS } from "./opcodes.mjs";

class Broken extends Error {}

const LOOPS = { forever: "REPEAT", while: "REPEAT", count: "COUNT", loop: "COUNT" };
const CLOSES = { again: "REPEAT", next: "COUNT" };
const LEAVES = { break: "REPEAT", drop: "COUNT" };

/** The first broken rule and its offset, or null: {rule, at}. */
export function verify(code, sensors, actuators) {
  const verifier = new Verifier(code, { sensor: sensors, actuator: actuators });
  try {
    verifier.run();
    return null;
  } catch (error) {
    if (error instanceof Broken) return { rule: error.message, at: verifier.at };
    throw error;
  }
}

class Verifier {
  constructor(code, devices) {
    this.code = code;
    this.devices = devices;
    this.at = 0;
    this.depth = 0;
    this.joins = []; // {target, depth}
    this.blocks = []; // {kind, start, end}; the end of a loop may be null
    this.check = false;
    this.counters = 0;
    this.routine = null; // {start, end, counters, calls}
    this.closed = [];
  }

  refuseIf(broken, rule) {
    if (broken) throw new Broken(rule);
  }

  run() {
    this.refuseIf(this.code.length > 32767, "CODE_LENGTH");
    while (this.at < this.code.length) {
      this.arrive();
      const op = decode(this.code, this.at);
      this.refuseIf(op === null, "UNKNOWN_OPCODE");
      this.refuseIf(op.after > this.code.length, "CUT_OPERAND");
      this.operands(op);
      this.refuseIf(this.depth < op.takes, "STACK_UNDERFLOW");
      this.depth += op.leaves - op.takes;
      this.refuseIf(this.depth > 16, "STACK_OVERFLOW");
      this.place(op.role);
      this.role(op);
      this.at = op.after;
    }
    this.arrive();
    this.refuseIf(this.depth !== 0 || this.joins.length > 0, "STACK_NOT_EMPTY");
    this.refuseIf(this.check, "INSIDE_CHECK");
    this.refuseIf(this.blocks.length > 0 || this.routine !== null, "STILL_OPEN");
  }

  arrive() {
    while (this.joins.length > 0 && this.joins.at(-1).target <= this.at) {
      const join = this.joins.at(-1);
      this.refuseIf(join.target < this.at, "MISSED_TARGET");
      this.refuseIf(this.depth !== join.depth, "STACK_NOT_EMPTY");
      this.joins.pop();
    }
    while (this.innermost?.kind === "IF" && this.innermost.end <= this.at) {
      const wrong = this.innermost.end < this.at || this.depth !== 0 || this.joins.length > 0 || this.check;
      this.refuseIf(wrong, "MISSED_TARGET");
      this.blocks.pop();
    }
    this.refuseIf(this.routine !== null && this.routine.end <= this.at, "BAD_DEF");
  }

  operands(op) {
    for (const { kind, value } of op.operands) {
      const [, least, greatest] = OPERANDS[kind];
      this.refuseIf(value < least || value > greatest, "BAD_OPERAND");
      this.refuseIf(kind in this.devices && value >= this.devices[kind], "NO_SUCH_DEVICE");
    }
  }

  place(role) {
    if (["end", "value", "join"].includes(role)) return;
    this.refuseIf(this.depth !== 0 || this.joins.length > 0, "STACK_NOT_EMPTY");
    if (["read", "until"].includes(role)) return;
    this.refuseIf(this.check, "INSIDE_CHECK");
  }

  role({ role, target, after }) {
    if (role === "end") this.refuseIf(true, "BAD_END");
    else if (role === "join") this.join(target);
    else if (role === "until") {
      this.refuseIf(!this.check, "NOT_OPEN");
      this.check = false;
    } else if (role === "watch") this.check = true;
    else if (role === "if") {
      const leavesLoop = this.innermost?.kind === "REPEAT" && this.innermost.end === target;
      if (!leavesLoop) this.open("IF", target, after);
    } else if (role === "else") {
      this.refuseIf(this.innermost?.kind !== "IF" || this.innermost.end !== after, "NOT_OPEN");
      this.blocks.pop();
      this.open("IF", target, after);
    } else if (role in LOOPS) this.open(LOOPS[role], target, after);
    else if (role in CLOSES) this.close(CLOSES[role], target, after);
    else if (role in LEAVES) this.leave(LEAVES[role], target);
    else if (role === "def") {
      this.refuseIf(this.blocks.length > 0 || this.routine !== null, "BAD_DEF");
      this.refuseIf(this.closed.length === 16, "TOO_MANY_DEFS");
      this.routine = { start: after, end: target, counters: 0, calls: 0 };
    } else if (role === "return") {
      this.refuseIf(this.routine === null, "NOT_OPEN");
      this.refuseIf(this.blocks.length > 0, "STILL_OPEN");
      this.refuseIf(this.routine.end !== after, "BAD_DEF");
      this.closed.push(this.routine);
      this.routine = null;
    } else if (role === "call") {
      const called = this.closed.find(({ start }) => start === target);
      this.refuseIf(called === undefined, "BAD_CALL");
      this.needs(this.counters + called.counters, called.calls + 1);
    }
  }

  get innermost() {
    return this.blocks.at(-1);
  }

  join(target) {
    this.refuseIf(this.joins.length === 16, "TOO_DEEP");
    const wrong = target >= this.code.length || (this.joins.length > 0 && target > this.joins.at(-1).target);
    this.refuseIf(wrong, "BAD_TARGET");
    this.joins.push({ target, depth: this.depth + 1 });
  }

  open(kind, end, start) {
    if (end !== null) {
      this.refuseIf(end > this.code.length, "BAD_TARGET");
      const around = this.innermost;
      if (around !== undefined && around.end !== null) {
        const same = end === around.end;
        this.refuseIf(end > around.end || (same && around.kind !== "IF"), "BAD_TARGET");
        if (same && kind === "IF") return;
      }
    }
    this.blocks.push({ kind, start, end });
    const words = this.blocks.reduce((sum, block) => sum + (block.kind === "IF" ? 1 : 2), 0);
    this.refuseIf(words > 32, "TOO_DEEP");
    if (kind === "COUNT") {
      this.counters += 1;
      this.needs(this.counters, 0);
    }
  }

  close(kind, target, after) {
    const loop = this.innermost;
    this.refuseIf(loop === undefined, "NOT_OPEN");
    this.refuseIf(loop.kind === "IF", "STILL_OPEN");
    this.refuseIf(loop.kind !== kind, "NOT_OPEN");
    this.refuseIf(target !== loop.start, "BAD_LOOP_START");
    this.refuseIf(loop.end !== null && loop.end !== after, "BAD_LOOP_END");
    this.blocks.pop();
    if (kind === "COUNT") this.counters -= 1;
  }

  leave(kind, target) {
    const loop = this.blocks.findLast((block) => block.kind !== "IF");
    this.refuseIf(loop?.kind !== kind, "NOT_OPEN");
    this.refuseIf(target > this.code.length, "BAD_TARGET");
    this.refuseIf(loop.end !== null && loop.end !== target, "BAD_LOOP_END");
    loop.end = target;
  }

  needs(counters, calls) {
    this.refuseIf(counters > 16 || calls > 8, "TOO_DEEP");
    if (this.routine === null) return;
    this.routine.counters = Math.max(this.routine.counters, counters);
    this.routine.calls = Math.max(this.routine.calls, calls);
  }
}
