"""A second verifier, written from the words of `bytecode_spec.md` alone.

It shares nothing with the package: what an instruction is comes from the tables of the page. Where
it disagrees with the others about a rule or an offset, the page is unclear, or one is wrong.
State goes in and out: each step returns what is remembered next, or the name of the broken rule.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from tests.oracle.spec_tables import ESCAPE, Instruction, code_at, instructions, rule_numbers

Verdict = tuple[int, int]  # the number of the rule that is broken, or 0, and the offset

STACK, JOINS, WORDS, PROCEDURES, COUNTERS, CALLS, TASKS = 16, 16, 32, 16, 16, 8, 4
MOST_BYTES = 32767
UNKNOWN = None
OF_GO = 2  # the bit of `needs`
OF_TASKS = ("TASK", "WHEN", "LOOK", "END_TASK", "END_WHEN")
ENDED_BY = {"return": "def", "end_task": "task", "end_when": "when"}


@dataclass(frozen=True)
class Block:
    """IF, REPEAT or COUNT; only a loop may end somewhere that is not known yet."""

    kind: str
    start: int
    end: int | None

    @property
    def is_loop(self) -> bool:
        """Whether it is no IF."""
        return self.kind != "IF"


@dataclass(frozen=True)
class Routine:
    """A DEF, a TASK or a WHEN: where it begins and ends, what is open in it at once at most."""

    kind: str
    start: int = 0
    end: int = 0
    counters: int = 0
    calls: int = 0


@dataclass(frozen=True)
class Known:
    """What a verifier remembers."""

    length: int
    at: int = 0
    after: int = 0
    target: int = 0
    depth: int = 0
    joins: tuple[tuple[int, int], ...] = ()
    blocks: tuple[Block, ...] = ()
    check: str = ""  # the role that will close it
    counters: int = 0
    routine: Routine | None = None
    closed: tuple[Routine, ...] = ()
    main: Routine = Routine("main")
    tasks: tuple[Routine, ...] = ()  # that have ended
    reads_inside: bool = False

    @property
    def innermost(self) -> Block | None:
        """The block that was opened last."""
        return self.blocks[-1] if self.blocks else None


Next = Known | str


def verdict(code: bytes, sensors: int, actuators: int, needs: int = 0xFF) -> Verdict:
    """Whether a machine with so many sensors and actuators may run the code.

    `needs` is what its image says.
    """
    if len(code) > MOST_BYTES:
        return rule_numbers()["CODE_LENGTH"], 0
    known = Known(len(code))
    while known.at < known.length:
        came = one_instruction(known, code, sensors, actuators, needs)
        if isinstance(came, str):
            return rule_numbers()[came], known.at
        known = replace(came, at=came.after)
    came = then(arrive(known), finish)
    return (rule_numbers()[came], known.at) if isinstance(came, str) else (0, 0)


def then(came: Next, step: Callable[[Known], Next]) -> Next:
    """Take the next step unless a rule is broken already."""
    return came if isinstance(came, str) else step(came)


def one_instruction(known: Known, code: bytes, sensors: int, actuators: int, needs: int) -> Next:
    """Steps 1 to 6."""
    came = arrive(known)
    if isinstance(came, str):
        return came
    if code[came.at] == ESCAPE and not needs & OF_GO:
        return "UNKNOWN_OPCODE"
    if code[came.at :] == bytes([ESCAPE]):
        return "CUT_OPERAND"
    row = instructions().get(code_at(code, came.at))
    if row is None or (row.name in OF_TASKS and not needs & 1):
        return "UNKNOWN_OPCODE"
    came = replace(came, after=came.at + row.size)
    if came.after > came.length:
        return "CUT_OPERAND"
    devices = {"sensor": sensors, "actuator": actuators}
    for kind, value in row.implied:
        if value >= devices.get(kind, value + 1):
            return "NO_SUCH_DEVICE"
    for operand, value in row.read(code, came.at):
        if value < operand.low or value > operand.high:
            return "BAD_OPERAND"
        if value >= devices.get(operand.kind, value + 1):
            return "NO_SUCH_DEVICE"
        if operand.is_distance:
            came = replace(came, target=row.target(code, came.at))
    if came.depth < row.takes:
        return "STACK_UNDERFLOW"
    came = replace(came, depth=came.depth - row.takes + row.leaves)
    if came.depth > STACK:
        return "STACK_OVERFLOW"
    return then(place(came, row), lambda so_far: role(so_far, row))


def arrive(known: Known) -> Next:
    """Step 1: what ends at this offset, or should have ended before."""
    joins, blocks = known.joins, known.blocks
    while joins and joins[-1][0] <= known.at:
        target, depth = joins[-1]
        if target < known.at:
            return "MISSED_TARGET"
        if depth != known.depth:
            return "STACK_NOT_EMPTY"
        joins = joins[:-1]
    while blocks and blocks[-1].kind == "IF" and (blocks[-1].end or 0) <= known.at:
        is_here = blocks[-1].end == known.at
        if not is_here or known.depth != 0 or joins or known.check:
            return "MISSED_TARGET"
        blocks = blocks[:-1]
    if known.routine is not None and known.routine.end <= known.at:
        return "BAD_DEF"
    return replace(known, joins=joins, blocks=blocks)


def place(known: Known, row: Instruction) -> Next:
    """Step 5: whether such an instruction may stand here."""
    if row.stem == "PUSH_READ" and (known.depth > 1 or known.joins):
        if known.tasks or (known.routine is not None and known.routine.kind != "def"):
            return "STACK_NOT_EMPTY"
        known = replace(known, reads_inside=True)
    if row.role in ("end", "value", "join"):
        return known
    if known.depth != 0 or known.joins:
        return "STACK_NOT_EMPTY"
    if row.role in ("task", "when") and known.reads_inside:
        return "STACK_NOT_EMPTY"
    if row.role not in ("read", "until", "look") and known.check:
        return "INSIDE_CHECK"
    return known


def finish(known: Known) -> Next:
    """The end of the code."""
    if known.depth != 0 or known.joins:
        return "STACK_NOT_EMPTY"
    if known.check:
        return "INSIDE_CHECK"
    return "STILL_OPEN" if known.blocks or known.routine is not None else known


def role(known: Known, row: Instruction) -> Next:
    """Step 6: the row of the table of roles."""
    kind = "COUNT" if row.role in ("count", "loop", "next", "drop") else "REPEAT"
    match row.role:
        case "end":
            return "BAD_END"
        case "value" | "read" | "plain":
            return known
        case "join":
            return join(known)
        case "until" | "look":
            return replace(known, check="") if known.check == row.role else "NOT_OPEN"
        case "watch":
            return replace(known, check="until")
        case "if":
            around = known.innermost
            if around and around.kind == "REPEAT" and around.end == known.target:
                return known
            return opened(known, "IF", known.target)
        case "else":
            ended = known.innermost
            if ended is None or ended.is_loop or ended.end != known.after:
                return "NOT_OPEN"
            return opened(replace(known, blocks=known.blocks[:-1]), "IF", known.target)
        case "forever" | "count":
            return opened(known, kind, UNKNOWN)
        case "while" | "loop":
            return opened(known, kind, known.target)
        case "again" | "next":
            return closed(known, kind)
        case "break" | "drop":
            return left(known, kind)
        case "def" | "task" | "when":
            return begun(known, row.role)
        case "return" | "end_task" | "end_when":
            return ended_routine(known, ENDED_BY[row.role])
        case "call":
            return called(known)
    raise AssertionError(f"the page says nothing of the role {row.role}")


def join(known: Known) -> Next:
    """AND_THEN and OR_ELSE."""
    if len(known.joins) == JOINS:
        return "TOO_DEEP"
    if known.target >= known.length or (known.joins and known.target > known.joins[-1][0]):
        return "BAD_TARGET"
    return replace(known, joins=(*known.joins, (known.target, known.depth + 1)))


def opened(known: Known, kind: str, end: int | None) -> Next:
    """**open**"""
    if end is not None and end > known.length:
        return "BAD_TARGET"
    around = known.innermost
    if around is not None and around.end is not None and end is not None:
        if end > around.end or (end == around.end and around.is_loop):
            return "BAD_TARGET"
        if end == around.end and kind == "IF":
            return known
    blocks = (*known.blocks, Block(kind, known.after, end))
    if sum(2 if block.is_loop else 1 for block in blocks) > WORDS:
        return "TOO_DEEP"
    if kind != "COUNT":
        return replace(known, blocks=blocks)
    counters = known.counters + 1
    return needs(replace(known, blocks=blocks, counters=counters), counters, 0)


def closed(known: Known, kind: str) -> Next:
    """**close**"""
    loop = known.innermost
    if loop is None:
        return "NOT_OPEN"
    if not loop.is_loop:
        return "STILL_OPEN"
    if loop.kind != kind:
        return "NOT_OPEN"
    if known.target != loop.start:
        return "BAD_LOOP_START"
    if loop.end is not None and loop.end != known.after:
        return "BAD_LOOP_END"
    counters = known.counters - (kind == "COUNT")
    return replace(known, blocks=known.blocks[:-1], counters=counters)


def left(known: Known, kind: str) -> Next:
    """**leave**"""
    place_of = max((k for k, block in enumerate(known.blocks) if block.is_loop), default=None)
    if place_of is None or known.blocks[place_of].kind != kind:
        return "NOT_OPEN"
    loop = known.blocks[place_of]
    if known.target > known.length:
        return "BAD_TARGET"
    if loop.end is not None and loop.end != known.target:
        return "BAD_LOOP_END"
    ended = replace(loop, end=known.target)
    return replace(known, blocks=(*known.blocks[:place_of], ended, *known.blocks[place_of + 1 :]))


def needs(known: Known, counters: int, calls: int) -> Next:
    """**needs**"""
    routine = known.routine or known.main
    most = replace(
        routine, counters=max(counters, routine.counters), calls=max(calls, routine.calls)
    )
    if known.routine is None:
        known, beside = replace(known, main=most), known.tasks
    else:
        known = replace(known, routine=most)
        beside = () if most.kind == "def" else (known.main, *known.tasks)
    if most.counters + sum(each.counters for each in beside) > COUNTERS:
        return "TOO_DEEP"
    return "TOO_DEEP" if most.calls + sum(each.calls for each in beside) > CALLS else known


def begun(known: Known, kind: str) -> Next:
    """DEF, TASK and WHEN"""
    if known.blocks or known.routine is not None:
        return "BAD_DEF"
    if kind == "def" and len(known.closed) == PROCEDURES:
        return "TOO_MANY_DEFS"
    if kind != "def" and len(known.tasks) == TASKS:
        return "TOO_MANY_TASKS"
    check = "look" if kind == "when" else ""
    return replace(known, routine=Routine(kind, known.after, known.target), check=check)


def ended_routine(known: Known, kind: str) -> Next:
    """RETURN, END_TASK and END_WHEN"""
    if known.routine is None or known.routine.kind != kind:
        return "NOT_OPEN"
    if known.blocks:
        return "STILL_OPEN"
    if known.routine.end != known.after:
        return "BAD_DEF"
    if kind == "def":
        return replace(known, routine=None, closed=(*known.closed, known.routine))
    return replace(known, routine=None, tasks=(*known.tasks, known.routine))


def called(known: Known) -> Next:
    """CALL"""
    for procedure in known.closed:
        if procedure.start == known.target:
            return needs(known, known.counters + procedure.counters, procedure.calls + 1)
    return "BAD_CALL"
