"""The verifier: decides which code a machine must refuse, and for which reason.

One pass over the code from its first byte to its last, with bounded memory: open structures take a
few words, and a jump is right if it leads to the beginning or the end of the structure around it.
Accepted code cannot leave the stack, the variables, the kit or the code while it runs.

`bytecode_spec.md` has the same steps in words, under "What must be refused"; `verify.cpp` has them
in C++. Same names, same order, same verdict at the same offset: change all three.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, NoReturn

from tiniscript.base.kit import Kit
from tiniscript.base.limits import (
    CALLS,
    CODE_BYTES,
    COUNTERS,
    DEFS,
    JOINS,
    NEST_WORDS,
    STACK_VALUES,
    TASKS,
)
from tiniscript.bytecode.image import ALL_NEEDS, Image, ImageRefused, unpack
from tiniscript.bytecode.opcodes import (
    CONTROL_ROLES,
    ESCAPE,
    NEEDS_GO,
    Op,
    OperandKind,
    op_at,
    read_operands,
)

# fmt: off
RULES = {
    # name             number, reason of the refusal
    "CODE_LENGTH":     (20, "More than 32767 bytes of code."),
    "UNKNOWN_OPCODE":  (21, "A byte that begins no instruction."),
    "CUT_OPERAND":     (22, "The code ends inside an instruction."),
    "BAD_OPERAND":     (23, "An operand outside its range: a power, a count, a variable, a device."),
    "NO_SUCH_DEVICE":  (24, "A sensor or an actuator that the kit does not have."),
    "STACK_UNDERFLOW": (25, "An instruction takes more values than are on the stack."),
    "STACK_OVERFLOW":  (26, "More than 16 values on the stack."),
    "STACK_NOT_EMPTY": (27, "Values are left between two instructions, or a join is reached with more or fewer than one."),
    "BAD_TARGET":      (28, "A jump forward leads out of the block around it, or out of the code."),
    "MISSED_TARGET":   (29, "A jump leads to where no instruction begins, or to one that it must not reach."),
    "BAD_LOOP_START":  (30, "A jump back does not lead to the beginning of its loop."),
    "BAD_LOOP_END":    (31, "A BREAK or a loop's head names an end that is not after the loop."),
    "NOT_OPEN":        (32, "ELSE, AGAIN, NEXT, BREAK, UNTIL, LOOK, RETURN or the end of a task, without the instruction that it belongs to."),
    "STILL_OPEN":      (33, "A loop, a procedure or the code ends while a block or a procedure in it is open."),
    "TOO_DEEP":        (34, "Blocks, counters, joins or calls are nested more deeply than a machine remembers."),
    "BAD_DEF":         (35, "A DEF or a task that is not at the top level, or does not end with its own end."),
    "TOO_MANY_DEFS":   (36, "More than 16 DEFs."),
    "BAD_CALL":        (37, "A CALL that does not lead to the beginning of a DEF before it."),
    "INSIDE_CHECK":    (38, "There is more than readings and a condition between WATCH and UNTIL, or WHEN and LOOK."),
    "BAD_END":         (39, "END in the code: its place is after the code."),
    "TOO_MANY_TASKS":  (40, "More than 4 tasks beside the main one."),
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
    """The needs of accepted code: stack values, counters and calls open at once in all tasks.

    `uses` are its sensors and actuators, "sensor" or "actuator" and the number, in its order.
    `tasks` does not count the main one; `needs` is that of its image.
    """

    stack_values: int
    counters: int
    calls: int
    uses: tuple[tuple[str, int], ...]
    tasks: int = 0
    needs: int = 0


def verify(code: bytes, sensors: int, actuators: int, needs: int = 0xFF) -> Verdict:
    """Return the needs of `code` on a machine with these numbers of sensors and actuators.

    `needs` is that of its image. Raises Refused if a machine must not run it.
    """
    if len(code) > CODE_BYTES:
        raise Refused("CODE_LENGTH", 0)
    return _Verifier(code, sensors, actuators, needs).run()


class _Join(NamedTuple):
    """The target of an AND_THEN or an OR_ELSE, and its number of stack values."""

    target: int
    depth: int


_IF, _REPEAT, _COUNT = "if", "repeat", "count"  # kinds of blocks; a REPEAT loop does not count
_NEST_WORDS = {_IF: 1, _REPEAT: 2, _COUNT: 2}


class _Block:
    """An open IF, or an open loop that begins at `start`; it ends at `end`, or 0: unknown yet."""

    __slots__ = ("end", "kind", "start")

    def __init__(self, kind: str, start: int, end: int) -> None:
        self.kind = kind
        self.start = start
        self.end = end


_DEF, _TASK, _WHEN = "def", "task", "when"  # kinds of routines
_UNTIL = "until"  # kind of an open check; the other is _WHEN


class _Routine:
    """A DEF, a task or a WHEN, with its open loops and calls.

    The main task is one that is no other's routine: the code outside of all others.
    """

    __slots__ = ("calls", "counters", "end", "kind", "start")

    def __init__(self, kind: str, start: int, end: int) -> None:
        self.kind = kind
        self.start = start
        self.end = end  # 0: the main task
        self.counters = 0
        self.calls = 0


class _Verifier:
    def __init__(self, code: bytes, sensors: int, actuators: int, needs: int) -> None:
        self.code = code
        self.allowed_needs = needs
        self.devices = {"sensor": sensors, "actuator": actuators}
        self.at = 0  # offset of the current instruction
        self.next_offset = 0  # offset of the next instruction
        self.target = 0  # target of its jump, if any
        self.depth = 0  # values on the stack
        self.joins: list[_Join] = []  # open joins, the innermost last
        self.blocks: list[_Block] = []  # open blocks, the innermost last
        self.check = ""  # kind of the open check: _UNTIL or _WHEN
        self.counters = 0  # counted loops that are open in this routine
        self.main = _Routine(_TASK, 0, 0)
        self.routine = self.main  # the current routine
        self.defs: list[_Routine] = []  # the procedures that have ended
        self.tasks: list[_Routine] = [self.main]  # all tasks begun so far
        self.reads_inside = False  # a PUSH_READ has been met with values below it, or in a join
        # Stack values that the whole code needs.
        self.stack_values = 0
        self.most_counters = 0
        self.most_calls = 0
        self.uses: list[tuple[str, int]] = []
        self.needs = 0

    def run(self) -> Verdict:
        while self.at < len(self.code):
            self.arrive()
            op = self.opcode()
            self.operands(op)
            self.stack(op)
            self.place(op)
            _STEPS[op.control_role](self)
            self.at = self.next_offset
        self.arrive()
        self.finish()
        uses, tasks = tuple(self.uses), len(self.tasks) - 1
        return Verdict(
            self.stack_values, self.most_counters, self.most_calls, uses, tasks, self.needs
        )

    def refuse(self, name: str) -> NoReturn:
        raise Refused(name, self.at)

    # -- checks of every instruction -----------------------------------------------------------

    def arrive(self) -> None:
        """Close the structures that end at this offset, and refuse those that should have ended
        before it."""
        while self.joins and self.joins[-1].target <= self.at:
            if self.joins[-1].target != self.at:
                self.refuse("MISSED_TARGET")
            if self.joins[-1].depth != self.depth:
                self.refuse("STACK_NOT_EMPTY")
            self.joins.pop()
        while self.innermost_kind == _IF and self.blocks[-1].end <= self.at:
            if self.blocks[-1].end != self.at or self.depth or self.joins or self.check:
                self.refuse("MISSED_TARGET")
            self.blocks.pop()
        if self.routine.end and self.routine.end <= self.at:
            self.refuse("BAD_DEF")

    def opcode(self) -> Op:
        op = op_at(self.code, self.at)
        if self.code[self.at] == ESCAPE and self.allowed_needs & NEEDS_GO:
            if self.at + 1 == len(self.code):
                self.refuse("CUT_OPERAND")
        if op is None or op.needs & ~self.allowed_needs:
            self.refuse("UNKNOWN_OPCODE")
        self.needs |= op.needs
        self.next_offset = self.at + op.size
        if self.next_offset > len(self.code):
            self.refuse("CUT_OPERAND")
        return op

    def operands(self, op: Op) -> None:
        if op.implied is not None:
            self.operand(*op.implied)
        for operand, value in zip(op.operands, read_operands(op, self.code, self.at), strict=True):
            self.operand(operand.kind, value)

    def operand(self, kind: OperandKind, value: int) -> None:
        if not kind.low <= value <= kind.high:
            self.refuse("BAD_OPERAND")
        if kind.name in self.devices:
            if value >= self.devices[kind.name]:
                self.refuse("NO_SUCH_DEVICE")
            self.uses.append((kind.name, value))
        if kind.name.startswith("fwd"):
            self.target = self.next_offset + value
        elif kind.name.startswith("back"):
            self.target = self.next_offset - value

    def stack(self, op: Op) -> None:
        if self.depth < op.pops:
            self.refuse("STACK_UNDERFLOW")
        self.depth += op.pushes - op.pops
        if self.depth > STACK_VALUES:
            self.refuse("STACK_OVERFLOW")
        self.stack_values = max(self.stack_values, self.depth)

    def place(self, op: Op) -> None:
        """Check that the instruction is allowed here; outside of expressions the stack must be
        empty.
        """
        if op.control_role in _EXPRESSION_ROLES:
            if op.family == "PUSH_READ" and (self.depth > 1 or self.joins):
                self.reads_inside = True
                if len(self.tasks) > 1:  # the instruction would end a turn with values on the stack
                    self.refuse("STACK_NOT_EMPTY")
            return
        if self.depth or self.joins or (op.control_role in (_TASK, _WHEN) and self.reads_inside):
            self.refuse("STACK_NOT_EMPTY")
        if self.check and op.control_role not in _CHECK_ROLES:
            self.refuse("INSIDE_CHECK")

    def finish(self) -> None:
        """The end of the code."""
        if self.depth or self.joins:
            self.refuse("STACK_NOT_EMPTY")
        if self.check:
            self.refuse("INSIDE_CHECK")
        if self.blocks or self.routine.end:
            self.refuse("STILL_OPEN")

    # -- blocks -------------------------------------------------------------------------------

    @property
    def innermost_kind(self) -> str:
        """Return the kind of the innermost open block, or ""."""
        return self.blocks[-1].kind if self.blocks else ""

    def open(self, kind: str, end: int) -> None:
        """Open a block that ends at `end`, or 0: unknown yet."""
        if end > len(self.code):
            self.refuse("BAD_TARGET")
        enclosing_block = self.blocks[-1] if self.blocks else None
        if enclosing_block is not None and enclosing_block.end:
            # the end of a loop is after its closing instruction
            if end > enclosing_block.end - (enclosing_block.kind != _IF):
                self.refuse("BAD_TARGET")
            if kind == _IF and end == enclosing_block.end:
                return  # the loop shares the block around it
        if sum(_NEST_WORDS[block.kind] for block in self.blocks) + _NEST_WORDS[kind] > NEST_WORDS:
            self.refuse("TOO_DEEP")
        self.blocks.append(_Block(kind, self.next_offset, end))
        if kind == _COUNT:
            self.counters += 1
            self.note_open(self.counters, 0)

    def close(self, kind: str) -> None:
        """Close the innermost block: a loop."""
        if self.innermost_kind == _IF:
            self.refuse("STILL_OPEN")
        if self.innermost_kind != kind:
            self.refuse("NOT_OPEN")
        loop = self.blocks[-1]
        if self.target != loop.start:
            self.refuse("BAD_LOOP_START")
        if loop.end not in (0, self.next_offset):
            self.refuse("BAD_LOOP_END")
        self.blocks.pop()
        if kind == _COUNT:
            self.counters -= 1

    def leave(self, kind: str) -> None:
        """Leave the innermost loop; the first that leaves it may say where it ends."""
        loop = next((block for block in reversed(self.blocks) if block.kind != _IF), None)
        if loop is None or loop.kind != kind:
            self.refuse("NOT_OPEN")
        if self.target > len(self.code):
            self.refuse("BAD_TARGET")
        if loop.end not in (0, self.target):
            self.refuse("BAD_LOOP_END")
        loop.end = self.target

    def note_open(self, counters: int, calls: int) -> None:
        """Note the counters and calls open at once, and refuse too many in all tasks together."""
        routine = self.routine
        routine.counters = max(routine.counters, counters)
        routine.calls = max(routine.calls, calls)
        running_routines = [routine] if routine.kind == _DEF else self.tasks
        most_counters = sum(routine.counters for routine in running_routines)
        most_calls = sum(routine.calls for routine in running_routines)
        if most_counters > COUNTERS or most_calls > CALLS:
            self.refuse("TOO_DEEP")
        self.most_counters = max(self.most_counters, most_counters)
        self.most_calls = max(self.most_calls, most_calls)

    # -- a step for each role -----------------------------------------------------------------

    def join(self) -> None:
        if len(self.joins) == JOINS:
            self.refuse("TOO_DEEP")
        if self.target >= len(self.code):
            self.refuse("BAD_TARGET")
        if self.joins and self.target > self.joins[-1].target:
            self.refuse("BAD_TARGET")
        self.joins.append(_Join(self.target, self.depth + 1))

    def watch(self) -> None:
        self.check = _UNTIL

    def end_check(self, role: str) -> None:
        if self.check != role:
            self.refuse("NOT_OPEN")
        self.check = ""

    def if_(self) -> None:
        if self.innermost_kind == _REPEAT and self.target == self.blocks[-1].end:
            return  # the jump leaves the loop
        self.open(_IF, self.target)

    def else_(self) -> None:
        if self.innermost_kind != _IF or self.blocks[-1].end != self.next_offset:
            self.refuse("NOT_OPEN")
        self.blocks.pop()
        self.open(_IF, self.target)

    def task(self, kind: str) -> None:
        self.begin(kind, len(self.tasks) > TASKS, "TOO_MANY_TASKS")
        self.tasks.append(self.routine)
        self.check = _WHEN if kind == _WHEN else ""

    def begin(self, kind: str, is_one_too_many: bool, rule: str) -> None:
        """Open a routine."""
        if self.blocks or self.routine.end:
            self.refuse("BAD_DEF")
        if is_one_too_many:
            self.refuse(rule)
        self.routine = _Routine(kind, self.next_offset, self.target)

    def close_routine(self, kind: str) -> _Routine:
        """Close the open routine, and return it."""
        routine, self.routine = self.routine, self.main
        if not routine.end or routine.kind != kind:
            self.refuse("NOT_OPEN")
        if self.blocks:
            self.refuse("STILL_OPEN")
        if routine.end != self.next_offset:
            self.refuse("BAD_DEF")
        return routine

    def call(self) -> None:
        callee = next((routine for routine in self.defs if routine.start == self.target), None)
        if callee is None:
            self.refuse("BAD_CALL")
        self.note_open(self.counters + callee.counters, callee.calls + 1)


_STEPS: dict[str, Callable[[_Verifier], object]] = {
    "end": lambda verifier: verifier.refuse("BAD_END"),
    **dict.fromkeys(("value", "read", "plain"), lambda verifier: None),
    "join": _Verifier.join,
    "until": lambda verifier: verifier.end_check(_UNTIL),
    "watch": _Verifier.watch,
    "if": _Verifier.if_,
    "else": _Verifier.else_,
    "forever": lambda verifier: verifier.open(_REPEAT, 0),
    "count": lambda verifier: verifier.open(_COUNT, 0),
    "while": lambda verifier: verifier.open(_REPEAT, verifier.target),
    "loop": lambda verifier: verifier.open(_COUNT, verifier.target),
    "again": lambda verifier: verifier.close(_REPEAT),
    "next": lambda verifier: verifier.close(_COUNT),
    "break": lambda verifier: verifier.leave(_REPEAT),
    "drop": lambda verifier: verifier.leave(_COUNT),
    "call": _Verifier.call,
    "def": lambda verifier: verifier.begin(_DEF, len(verifier.defs) == DEFS, "TOO_MANY_DEFS"),
    "return": lambda verifier: verifier.defs.append(verifier.close_routine(_DEF)),
    "task": lambda verifier: verifier.task(_TASK),
    "end_task": lambda verifier: verifier.close_routine(_TASK),
    "when": lambda verifier: verifier.task(_WHEN),
    "end_when": lambda verifier: verifier.close_routine(_WHEN),
    "look": lambda verifier: verifier.end_check(_WHEN),
}
assert _STEPS.keys() == CONTROL_ROLES.keys()
_EXPRESSION_ROLES = ("end", "value", "join")
_CHECK_ROLES = ("read", "until", "look")


def load_image(data: bytes, kit: Kit, capabilities: int = ALL_NEEDS) -> Image:
    """Return the image in `data`, for a machine that has so much of `needs`.

    Looks at its header, its code, and the devices that the code uses, as every machine does.

    Raises ImageRefused, or Refused.
    """
    image = unpack(data, capabilities)
    check(image, kit)
    return image


def check(image: Image, kit: Kit) -> Verdict:
    """Return the needs of an image's code. Raises Refused, or ImageRefused."""
    verdict = verify(image.code, len(kit.readings), len(kit.actuators), image.needs)
    own_hash = kit.hash_of_used(verdict.uses)
    if image.devices != own_hash:
        raise ImageRefused("OTHER_KIT", theirs=f"{image.devices:04x}", ours=f"{own_hash:04x}")
    return verdict
