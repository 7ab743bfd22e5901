"""The verifier: what a machine must refuse, and the name of each reason.

One pass over the code from its first byte to its last, with bounded memory: what is open is a
few words, and a jump is right when it leads where the structure around it ends or begins. What
is accepted cannot leave the stack, the variables, the kit or the code while it runs.

Written to be written again in C++: same rules, same order, same verdict at the same offset.
"""

from __future__ import annotations

from typing import NamedTuple, NoReturn

from tiniscript.bytecode.opcodes import (
    BY_CODE,
    CALLS,
    CODE_BYTES,
    COUNTERS,
    DEFS,
    JOINS,
    NEST_WORDS,
    ROLES,
    STACK_VALUES,
    Op,
    read_operands,
)

# fmt: off
RULES = {
    # name             number, what is refused
    "CODE_LENGTH":     (20, "More than 32767 bytes of code."),
    "UNKNOWN_OPCODE":  (21, "A byte that begins no instruction."),
    "CUT_OPERAND":     (22, "The code ends inside an instruction."),
    "BAD_OPERAND":     (23, "An operand outside its range: a power, a count, a variable."),
    "NO_SUCH_DEVICE":  (24, "A sensor or an actuator that the kit does not have."),
    "STACK_UNDERFLOW": (25, "An instruction takes more values than are on the stack."),
    "STACK_OVERFLOW":  (26, "More than 16 values on the stack."),
    "STACK_NOT_EMPTY": (27, "Values are left on the stack between two instructions."),
    "BAD_TARGET":      (28, "A jump forward leads out of the block around it."),
    "MISSED_TARGET":   (29, "No instruction begins where a jump leads, or one that may not be reached so."),
    "BAD_LOOP_START":  (30, "A jump back does not lead to the beginning of its loop or check."),
    "BAD_LOOP_END":    (31, "A BREAK or a loop's head names an end that is not behind the loop."),
    "NOT_OPEN":        (32, "ELSE, AGAIN, NEXT, BREAK, UNTIL or RETURN without what it belongs to."),
    "STILL_OPEN":      (33, "A block ends while another one inside it is open."),
    "TOO_DEEP":        (34, "Blocks, counters, joins or calls deeper than a machine remembers."),
    "BAD_DEF":         (35, "A DEF that is not at the top level, or does not end with its RETURN."),
    "TOO_MANY_DEFS":   (36, "More than 16 DEFs."),
    "BAD_CALL":        (37, "A CALL that does not lead to the beginning of a DEF before it."),
    "INSIDE_CHECK":    (38, "Between WATCH and UNTIL stands more than readings and a condition."),
    "BAD_END":         (39, "END: it stands behind the code, not in it."),
}
# fmt: on


class Refused(Exception):
    """The first thing at `offset` that breaks the rule `name`."""

    def __init__(self, name: str, offset: int) -> None:
        super().__init__(f"{name} at {offset:04x}")
        self.name = name
        self.number, self.meaning = RULES[name]
        self.offset = offset


class Verdict(NamedTuple):
    """What accepted code needs: values on the stack, counters and calls open at once."""

    stack_values: int
    counters: int
    calls: int
    uses_kit: bool


def verify(code: bytes, sensors: int, actuators: int) -> Verdict:
    """Return what `code` needs on a machine with so many sensors and actuators.

    Raises Refused where a machine must not run it.
    """
    if len(code) > CODE_BYTES:
        raise Refused("CODE_LENGTH", 0)
    return _Verifier(code, sensors, actuators).run()


class _Block:
    """An open IF (until `end`), or an open loop from `start` to `end`; 0 while unknown."""

    __slots__ = ("end", "kind", "start")

    def __init__(self, kind: str, start: int, end: int) -> None:
        self.kind = kind  # "if", "repeat" or "count"
        self.start = start
        self.end = end


class _Def(NamedTuple):
    start: int
    counters: int
    calls: int


class _Verifier:
    def __init__(self, code: bytes, sensors: int, actuators: int) -> None:
        self.code = code
        self.devices = {"sensor": sensors, "actuator": actuators}
        self.at = 0  # where the instruction that is looked at begins
        self.after = 0  # where the next one begins
        self.depth = 0  # values on the stack
        self.blocks: list[_Block] = []
        self.words = 0  # that `blocks` take
        self.joins: list[tuple[int, int]] = []  # where, and with how many values there
        self.check = 0  # where the open check of an UNTIL begins, or 0
        self.defs: list[_Def] = []
        self.def_start = 0  # of the open DEF, or 0
        self.def_end = 0
        self.counters = 0  # counted loops open in this routine
        self.most_counters = 0  # in this routine, its calls included
        self.most_calls = 0
        # what the whole code needs
        self.stack_values = 0
        self.all_counters = 0
        self.all_calls = 0
        self.uses_kit = False

    def run(self) -> Verdict:
        code = self.code
        while self.at < len(code):
            self.arrive()
            op = BY_CODE[code[self.at]]
            if op is None:
                self.refuse("UNKNOWN_OPCODE")
            self.after = self.at + op.size
            if self.after > len(code):
                self.refuse("CUT_OPERAND")
            self.operands(op)
            self.stack(op)
            _RULES_OF[op.role](self, op)
            self.at = self.after
        self.arrive()
        self.between()
        if self.blocks or self.def_end:
            self.refuse("STILL_OPEN")
        return Verdict(self.stack_values, self.all_counters, self.all_calls, self.uses_kit)

    def refuse(self, name: str) -> NoReturn:
        raise Refused(name, self.at)

    # -- what every instruction keeps ---------------------------------------------------------

    def arrive(self) -> None:
        """Close what ends at this offset."""
        while self.joins and self.joins[-1][0] <= self.at:
            target, depth = self.joins.pop()
            if target != self.at:
                self.refuse("MISSED_TARGET")
            if self.depth != depth:
                self.refuse("STACK_NOT_EMPTY")
        while self.blocks and self.blocks[-1].kind == "if" and self.blocks[-1].end <= self.at:
            if self.blocks[-1].end != self.at or self.depth or self.check:
                self.refuse("MISSED_TARGET")
            self.blocks.pop()
            self.words -= 1
        if self.def_end and self.at >= self.def_end:
            self.refuse("BAD_DEF")

    def operands(self, op: Op) -> None:
        self.values = read_operands(op, self.code, self.at)
        for operand, value in zip(op.operands, self.values, strict=True):
            kind = operand.kind
            if not kind.low <= value <= kind.high:
                self.refuse("BAD_OPERAND")
            if kind.name in self.devices:
                if value >= self.devices[kind.name]:
                    self.refuse("NO_SUCH_DEVICE")
                self.uses_kit = True

    def stack(self, op: Op) -> None:
        if self.depth < op.pops:
            self.refuse("STACK_UNDERFLOW")
        self.depth += op.pushes - op.pops
        if self.depth > STACK_VALUES:
            self.refuse("STACK_OVERFLOW")
        self.stack_values = max(self.stack_values, self.depth)

    def between(self) -> None:
        """Instructions but those of expressions leave the stack empty and stand in no check."""
        if self.depth or self.joins:
            self.refuse("STACK_NOT_EMPTY")
        if self.check:
            self.refuse("INSIDE_CHECK")

    # -- blocks -------------------------------------------------------------------------------

    def target(self) -> int:
        """Return where the instruction jumps: its last operand tells."""
        return self.after + self.values[-1]

    def start(self) -> int:
        return self.after - self.values[-1]

    def open_if(self, target: int) -> None:
        """Open a block up to `target`, unless the block around it ends there too."""
        around = self.blocks[-1] if self.blocks else None
        if around is not None and around.end:
            if around.kind == "if" and target == around.end:
                return
            if target >= around.end:
                self.refuse("BAD_TARGET")
        if target > len(self.code):
            self.refuse("BAD_TARGET")
        self.open(_Block("if", 0, target), 1)

    def open_loop(self, kind: str, end: int) -> None:
        """Open a loop; `end` is where it must end, or 0."""
        around = self.blocks[-1] if self.blocks else None
        if end > len(self.code):
            self.refuse("BAD_TARGET")
        if around is not None and around.end and end > around.end - (around.kind != "if"):
            self.refuse("BAD_TARGET")
        self.open(_Block(kind, self.after, end), 2)
        if kind == "count":
            self.counters += 1
            self.needs(self.counters, self.most_calls)

    def open(self, block: _Block, words: int) -> None:
        self.words += words
        if self.words > NEST_WORDS:
            self.refuse("TOO_DEEP")
        self.blocks.append(block)

    def needs(self, counters: int, calls: int) -> None:
        """Note what is open at once, and refuse what is too deep."""
        if counters > COUNTERS or calls > CALLS:
            self.refuse("TOO_DEEP")
        self.most_counters = max(self.most_counters, counters)
        self.most_calls = max(self.most_calls, calls)
        self.all_counters = max(self.all_counters, counters)
        self.all_calls = max(self.all_calls, calls)

    # -- a rule for each role -----------------------------------------------------------------

    def value(self, op: Op) -> None:
        pass

    def join(self, op: Op) -> None:
        if len(self.joins) == JOINS:
            self.refuse("TOO_DEEP")
        target = self.target()
        if self.joins and target > self.joins[-1][0]:
            self.refuse("BAD_TARGET")
        if target >= len(self.code):
            self.refuse("BAD_TARGET")
        self.joins.append((target, self.depth + 1))

    def read(self, op: Op) -> None:
        if self.depth or self.joins:
            self.refuse("STACK_NOT_EMPTY")

    def plain(self, op: Op) -> None:
        self.between()

    def watch(self, op: Op) -> None:
        self.between()
        self.check = self.after

    def until(self, op: Op) -> None:
        if not self.check:
            self.refuse("NOT_OPEN")
        if self.depth or self.joins:
            self.refuse("STACK_NOT_EMPTY")
        if self.start() != self.check:
            self.refuse("BAD_LOOP_START")
        self.check = 0

    def if_(self, op: Op) -> None:
        self.between()
        around = self.blocks[-1] if self.blocks else None
        if around is not None and around.kind == "repeat" and self.target() == around.end:
            return  # it leaves the loop
        self.open_if(self.target())

    def else_(self, op: Op) -> None:
        self.between()
        if not self.blocks or self.blocks[-1].kind != "if" or self.blocks[-1].end != self.after:
            self.refuse("NOT_OPEN")
        self.blocks.pop()
        self.words -= 1
        self.open_if(self.target())

    def forever(self, op: Op) -> None:
        self.between()
        self.open_loop("repeat", 0)

    def while_(self, op: Op) -> None:
        self.between()
        self.open_loop("repeat", self.target())

    def count(self, op: Op) -> None:
        self.between()
        self.open_loop("count", 0)

    def loop(self, op: Op) -> None:
        self.between()
        self.open_loop("count", self.target())

    def again(self, op: Op) -> None:
        self.close_loop("repeat")

    def next(self, op: Op) -> None:
        self.close_loop("count")
        self.counters -= 1

    def close_loop(self, kind: str) -> None:
        self.between()
        if not self.blocks or self.blocks[-1].kind == "if":
            self.refuse("STILL_OPEN" if self.blocks else "NOT_OPEN")
        loop = self.blocks[-1]
        if loop.kind != kind:
            self.refuse("NOT_OPEN")
        if self.start() != loop.start:
            self.refuse("BAD_LOOP_START")
        if loop.end not in (0, self.after):
            self.refuse("BAD_LOOP_END")
        self.blocks.pop()
        self.words -= 2

    def break_(self, op: Op) -> None:
        self.leave("repeat")

    def drop(self, op: Op) -> None:
        self.leave("count")

    def leave(self, kind: str) -> None:
        self.between()
        loop = next((block for block in reversed(self.blocks) if block.kind != "if"), None)
        if loop is None or loop.kind != kind:
            self.refuse("NOT_OPEN")
        if self.target() > len(self.code):
            self.refuse("BAD_TARGET")
        if loop.end == 0:
            loop.end = self.target()
        if loop.end != self.target():
            self.refuse("BAD_LOOP_END")

    def def_(self, op: Op) -> None:
        self.between()
        if self.blocks or self.def_end:
            self.refuse("BAD_DEF")
        if len(self.defs) == DEFS:
            self.refuse("TOO_MANY_DEFS")
        self.def_start, self.def_end = self.after, self.target()
        self.most_counters = self.most_calls = 0

    def return_(self, op: Op) -> None:
        self.between()
        if not self.def_end:
            self.refuse("NOT_OPEN")
        if self.blocks:
            self.refuse("STILL_OPEN")
        if self.def_end != self.after:
            self.refuse("BAD_DEF")
        self.defs.append(_Def(self.def_start, self.most_counters, self.most_calls))
        self.def_end = 0

    def call(self, op: Op) -> None:
        self.between()
        called = next((each for each in self.defs if each.start == self.start()), None)
        if called is None:
            self.refuse("BAD_CALL")
        self.needs(self.counters + called.counters, called.calls + 1)

    def end(self, op: Op) -> None:
        self.refuse("BAD_END")


_RULES_OF = {
    role: getattr(_Verifier, role, None) or getattr(_Verifier, role + "_") for role in ROLES
}
