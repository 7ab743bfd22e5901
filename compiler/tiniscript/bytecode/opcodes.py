"""The one table of TiniScript bytecode.

Everything that must know an instruction reads it from here: `lower`, `disassembly`, `verify` and
`vm` import it; `python -m tools.generate` writes the tables of `bytecode_spec.md` from it. Codes on
the wire are promises: a code is never reused.

A short instruction has its operand in its code: `PUSH_VAR_3` is `PUSH_VAR v3` in one byte. Such
families have eight members, and the last three bits of the code are the operand. Families of
comparators are of eight too, and the last three bits are the comparator.

Knows numbers, operands, stack effects and faults. It does not know what the instructions do.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from collections.abc import Iterator
from struct import Struct
from typing import NamedTuple

from tiniscript.base.words import COMPARATORS

ISA_MAJOR = 2  # a machine runs images of its own major version
ESCAPE = 0xFF  # the first byte of the codes that have two
# Bits of an image's `needs`: features that a machine may lack.
NEEDS_TASKS, NEEDS_GO = 0x01, 0x02
SHORTS = 8  # variables, sensors and actuators that instructions of one byte name


class OperandKind(NamedTuple):
    """The encoding of an operand: `size` bytes, little-endian, from `low` to `high`."""

    name: str
    size: int
    is_signed: bool
    low: int
    high: int
    meaning: str


class Operand(NamedTuple):
    name: str
    kind: OperandKind


class ImpliedOperand(NamedTuple):
    """An operand that no byte holds: the code says it."""

    kind: OperandKind
    value: int


class Op(NamedTuple):
    """One instruction. `effect` is a Forth stack effect, top of the stack on the right.

    A `code` of two bytes begins with ESCAPE, 0xFF40; `size` counts both.
    """

    code: int
    name: str
    operands: tuple[Operand, ...]
    effect: str
    control_role: str
    meaning: str
    size: int
    pops: int
    pushes: int
    implied: ImpliedOperand | None = None
    needs: int = 0  # the bit of `needs` without which no code has it
    since_minor: int = (
        0  # the minor version that it came with: a new one, once that has been released
    )

    @property
    def opcode(self) -> bytes:
        """The byte or the two that say which instruction it is."""
        return self.code.to_bytes(1 + (self.code > 0xFF), "big")

    @property
    def family(self) -> str:
        """The name of its action: MOVE of MOVE_F, IF of IF_FAR, PUSH_VAR of PUSH_VAR_3."""
        if 0x10 <= self.code <= 0x28:
            return "CALCULATE"
        base, _, suffix = self.name.rpartition("_")
        return base if suffix in _VARIANTS or suffix.isdigit() else self.name

    @property
    def is_act(self) -> bool:
        """Return whether the instruction makes the robot act; a loop over instructions never does
        so alone.
        """
        return self.control_role in ("plain", "watch") and self.family not in _OWN_FAMILIES


# Endings after the name of a family, except for numbers.
_VARIANTS = ("FAR", "F", "B", "L", "R", "EQ", "NE", "LT", "LE", "GT", "GE")

# The instructions among others that need nothing from the robot, or are repeated if they fail.
_OWN_FAMILIES = ("SET_VAR", "SET_VAR8", "ADD_VAR8", "ADD_VAR", "INC_VAR", "DEC_VAR",
                 "SHOW", "SHOW_YES_NO")  # fmt: skip

# fmt: off
OPERAND_KINDS = {kind.name: kind for kind in (
    #           name        size signed      low    high  meaning
    OperandKind("u8",       1, False,         0,    255, "a whole number"),
    OperandKind("i8",       1, True,       -128,    127, "a whole number"),
    OperandKind("i16",      2, True,     -32768,  32767, "a whole number"),
    OperandKind("milli16",  2, True,     -32768,  32767, "thousandths"),
    OperandKind("milli32",  4, True,     -2**31, 2**31 - 1, "thousandths"),
    OperandKind("tenths",   1, True,       -128,    127, "tenths"),
    OperandKind("time8",    1, False,         0,    255, "a time: 0 to 99 are hundredths of a second, 100 to 199 are 1.0 to 10.9 s, in tenths, and 200 to 255 are 11 to 66 s"),
    OperandKind("u16",      2, False,         0,  65535, "a whole number"),
    OperandKind("power",    1, False,         0,    100, "a percentage"),
    OperandKind("percent",  1, True,       -100,    100, "a percentage; below 0 is backward"),
    OperandKind("count",    1, False,         1,    255, "how many times"),
    OperandKind("variable", 1, False,         0,     31, "the number of a variable"),
    OperandKind("sensor",   1, False,         0,     31, "the number of a sensor of the kit"),
    OperandKind("actuator", 1, False,         0,     31, "the number of an actuator of the kit"),
    OperandKind("fwd8",     1, False,         0,    255, "bytes forward from the next instruction"),
    OperandKind("fwd16",    2, False,         0,  65535, "bytes forward from the next instruction"),
    OperandKind("back8",    1, False,         0,    255, "bytes back from the next instruction"),
    OperandKind("back16",   2, False,         0,  65535, "bytes back from the next instruction"),
)}

# The part that an instruction plays in the structure of a program; `verify` has a rule for each
# role. Those from `plain` on are between expressions and checks. Those of loops come in pairs: one
# for uncounted loops, one for counted ones. Roles that open a routine come before those that close
# it.
CONTROL_ROLES = {
    "end":       "ends the program",
    "value":     "part of an expression",
    "join":      "part of an expression; if the left side decides the result, it jumps to `to`",
    "read":      "takes a reading; stands between instructions or in the check of an UNTIL or a WHEN",
    "until":     "ends the check of an UNTIL",
    "plain":     "an instruction: leaves the stack empty",
    "watch":     "begins the check of an UNTIL",
    "if":        "opens a block that ends at `to`, or leaves the loop that ends there",
    "else":      "ends the block before it and opens one that ends at `to`",
    "forever":   "opens an uncounted loop",
    "count":     "opens a counted loop",
    "while":     "opens an uncounted loop that ends at `to`",
    "loop":      "opens a counted loop that ends at `to`",
    "again":     "closes an uncounted loop",
    "next":      "closes a counted loop",
    "break":     "leaves the innermost loop, an uncounted one",
    "drop":      "leaves the innermost loop, a counted one",
    "call":      "calls a procedure that lies before it",
    "def":       "opens a procedure that ends at `to`",
    "return":    "closes a procedure",
    "task":      "opens a task that ends at `to`",
    "end_task":  "closes a task",
    "when":      "opens a WHEN that ends at `to`, and its check",
    "end_when":  "closes a WHEN",
    "look":      "ends the check of a WHEN",
}


def _op(code: int, name: str, operands: str, effect: str, role: str, meaning: str) -> Op:
    parts = []
    for text in operands.split():
        operand_name, _, kind = text.partition(":")
        parts.append(Operand(operand_name, OPERAND_KINDS[kind]))
    taken_operands, _, results_left = effect.partition("--")
    size = 1 + (code > 0xFF) + sum(operand.kind.size for operand in parts)
    return Op(code, name, tuple(parts), effect, role, meaning,
              size, len(taken_operands.split()), len(results_left.split()))


def _shorts(code: int, name: str, kind: str, effect: str, role: str, meaning: str) -> list[Op]:
    """Return the instructions of one byte that have `n` of 0 to 7 in their code."""
    assert code % SHORTS == 0
    return [_op(code + n, f"{name}_{n}", "", effect, role, meaning.format(n))
            ._replace(implied=ImpliedOperand(OPERAND_KINDS[kind], n)) for n in range(SHORTS)]


def _comparison_ops(code: int, name: str, operands: str, effect: str, role: str, meaning: str) -> list[Op]:
    """Return the six instructions that differ in the comparator, the last three bits of the code."""
    assert code % 8 == 0
    return [_op(code + i, f"{name}_{comparator}", operands, effect, role, meaning.format(sign))
            for i, (comparator, sign) in enumerate(COMPARATORS)]


_MOVES = ("F", "drive forward"), ("B", "drive backward"), ("L", "turn left"), ("R", "turn right")

# Numbers that one byte pushes: counters, and their powers.
PUSHED_NUMBERS = (*range(11), *range(20, 101, 10))

OPS = (
    #    code  name              operands               stack effect      role     meaning
    _op(0x00, "END",             "",                    "--",              "end",   "The program is finished. Code never contains it: a machine puts it after the code."),
    # values
    _op(0x01, "PUSH8",           "n:u8",                "-- n",            "value", "Push the whole number `n`."),
    _op(0x02, "PUSH16",          "n:i16",               "-- n",            "value", "Push the whole number `n`."),
    _op(0x03, "PUSH_MILLI",      "n:milli16",           "-- n",            "value", "Push `n` thousandths."),
    _op(0x04, "PUSH32",          "n:milli32",           "-- n",            "value", "Push `n` thousandths."),
    _op(0x05, "PUSH_FALSE",      "",                    "-- no",           "value", "Push FALSE."),
    _op(0x06, "PUSH_TRUE",       "",                    "-- yes",          "value", "Push TRUE."),
    _op(0x07, "PUSH_VAR",        "v:variable",          "-- value",        "value", "Push the value of variable `v`."),
    _op(0x08, "PUSH_SENSOR",     "s:sensor",            "-- reading",      "value", "Push the kept reading of sensor `s`."),
    _op(0x09, "PUSH_READ",       "s:sensor",            "-- reading",      "value", "Take a reading of sensor `s`, keep it and push it."),
    _op(0x0A, "TIME",            "",                    "-- seconds",      "value", "Push the time since the program started."),
    _op(0x0B, "RANDOM",          "",                    "low high -- n",   "value", "Push a whole number from `low` to `high`."),
    _op(0x0C, "PUSH_TENTHS",     "n:tenths",            "-- n",            "value", "Push `n` tenths."),
    _op(0x10, "ADD",             "",                    "a b -- a+b",      "value", "Add."),
    _op(0x11, "SUB",             "",                    "a b -- a-b",      "value", "Subtract."),
    _op(0x12, "MUL",             "",                    "a b -- a*b",      "value", "Multiply; round half away from zero."),
    _op(0x13, "DIV",             "",                    "a b -- a/b",      "value", "Divide; round half away from zero."),
    _op(0x14, "MOD",             "",                    "a b -- a%b",      "value", "Push the exact remainder of `a / b`, with the sign of `b`."),
    _op(0x15, "NEG",             "",                    "a -- -a",         "value", "Change the sign."),
    _op(0x16, "ABS",             "",                    "a -- |a|",        "value", "Drop the sign."),
    _op(0x17, "MIN",             "",                    "a b -- least",    "value", "Push the smaller one."),
    _op(0x18, "MAX",             "",                    "a b -- most",     "value", "Push the larger one."),
    _op(0x19, "ROUND",           "",                    "a places -- n",   "value", "Round `a` half away from zero to `places` decimals."),
    *(_op(0x20 + i, name,        "",                    f"a b -- a{sign}b", "value", f"Push TRUE if `a {sign} b`, else FALSE.")
      for i, (name, sign) in enumerate(COMPARATORS)),
    _op(0x26, "NOT",             "",                    "a -- not-a",      "value", "Push TRUE if `a` is FALSE, else FALSE."),
    _op(0x27, "AND",             "",                    "a b -- a-and-b",  "value", "Push TRUE if both are TRUE, else FALSE."),
    _op(0x28, "OR",              "",                    "a b -- a-or-b",   "value", "Push TRUE if at least one is TRUE, else FALSE."),
    _op(0x2A, "AND_THEN",        "to:fwd8",             "a --",            "join",  "If `a` is FALSE, go to `to` with `a` on the stack; else drop it."),
    _op(0x2B, "AND_THEN_FAR",    "to:fwd16",            "a --",            "join",  "The same, with a longer jump."),
    _op(0x2C, "OR_ELSE",         "to:fwd8",             "a --",            "join",  "If `a` is TRUE, go to `to` with `a` on the stack; else drop it."),
    _op(0x2D, "OR_ELSE_FAR",     "to:fwd16",            "a --",            "join",  "The same, with a longer jump."),
    # variables
    _op(0x30, "SET_VAR",         "v:variable",          "value --",        "plain", "Put the value into variable `v`."),
    _op(0x31, "SET_VAR8",        "v:variable n:i8",     "--",              "plain", "Put the whole number `n` into `v`."),
    _op(0x32, "ADD_VAR8",        "v:variable n:i8",     "--",              "plain", "Add the whole number `n` to `v`."),
    _op(0x33, "ADD_VAR",         "v:variable w:variable", "--",            "plain", "Add the value of `w` to `v`."),
    _op(0x34, "INC_VAR",         "v:variable",          "--",              "plain", "Add 1 to `v`."),
    _op(0x35, "DEC_VAR",         "v:variable",          "--",              "plain", "Subtract 1 from `v`."),
    # the robot
    _op(0x38, "READ",            "s:sensor",            "--",              "read",  "Take a reading of sensor `s` and keep it."),
    _op(0x39, "SHOW",            "",                    "number --",       "plain", "Send a number to all listeners."),
    _op(0x3A, "SHOW_YES_NO",     "",                    "yes --",          "plain", "Send TRUE or FALSE."),
    _op(0x3B, "SET",             "a:actuator",          "value --",        "plain", "Set actuator `a` to the value, rounded and limited to its range."),
    *(_op(0x40 + i, f"MOVE_{d}", "",                    "time power --",   "plain", f"{action.capitalize()} for `time`, then turn the motors off.")
      for i, (d, action) in enumerate(_MOVES)),
    *(_op(0x44 + i, f"MOVE8_{d}", "time:time8 power:power", "--",          "plain", f"{action.capitalize()} for `time`, then turn the motors off.")
      for i, (d, action) in enumerate(_MOVES)),
    *(_op(0x48 + i, f"WATCH_{d}", "",                   "time power --",   "watch", f"Prepare to {action} for `time`, or until a check is TRUE.")
      for i, (d, action) in enumerate(_MOVES)),
    *(_op(0x4C + i, f"WATCH_FOREVER_{d}", "",           "power --",        "watch", f"Prepare to {action} until a check is TRUE.")
      for i, (d, action) in enumerate(_MOVES)),
    _op(0x50, "WAIT",            "",                    "time --",         "plain", "Wait."),
    _op(0x51, "WAIT8",           "time:time8",          "--",              "plain", "Wait."),
    _op(0x52, "WATCH_WAIT",      "",                    "time --",         "watch", "Prepare to wait for `time`, or until a check is TRUE."),
    _op(0x53, "WATCH_FOREVER_WAIT", "",                 "--",              "watch", "Prepare to wait until a check is TRUE."),
    _op(0x54, "UNTIL",           "",                    "stop --",         "until", "End the move if `stop`; else continue it and check again after 20 ms."),
    _op(0x56, "BEEP8",           "time:time8 hertz:u16", "--",             "plain", "Sound the buzzer and wait until the sound is over."),
    _op(0x58, "STOP",            "",                    "--",              "plain", "Turn the motors off."),
    _op(0x59, "MOTORS",          "",                    "left right --",   "plain", "Set both motors and continue at once."),
    _op(0x5A, "MOTORS8",         "left:percent right:percent", "--",       "plain", "Set both motors and continue at once."),
    _op(0x5B, "BEEP",            "",                    "time hertz --",   "plain", "Sound the buzzer and wait until the sound is over."),
    # control
    _op(0x60, "IF",              "to:fwd8",             "yes --",          "if",    "Go to `to` if the value is FALSE."),
    _op(0x61, "IF_FAR",          "to:fwd16",            "yes --",          "if",    "The same, with a longer jump."),
    _op(0x62, "IF_NOT",          "to:fwd8",             "no --",           "if",    "Go to `to` if the value is TRUE."),
    _op(0x63, "IF_NOT_FAR",      "to:fwd16",            "no --",           "if",    "The same, with a longer jump."),
    _op(0x64, "ELSE",            "to:fwd8",             "--",              "else",  "Go to `to`."),
    _op(0x65, "ELSE_FAR",        "to:fwd16",            "--",              "else",  "The same, with a longer jump."),
    _op(0x68, "FOREVER",         "",                    "--",              "forever", "A loop begins here."),
    _op(0x69, "WHILE",           "to:fwd8",             "--",              "while", "A loop begins here; it ends at `to`, and its checks may jump there."),
    _op(0x6A, "WHILE_FAR",       "to:fwd16",            "--",              "while", "The same, with a longer jump."),
    _op(0x6B, "AGAIN",           "to:back8",            "--",              "again", "Go back to `to`, the loop's first instruction."),
    _op(0x6C, "AGAIN_FAR",       "to:back16",           "--",              "again", "The same, with a longer jump."),
    _op(0x6D, "LOOP8",           "n:count",             "--",              "count", "A loop begins here; it runs `n` times."),
    _op(0x6E, "LOOP",            "to:fwd8",             "n --",            "loop", "A loop begins here; it runs `n` times. If `n` rounds to less than 1, go to `to`, its end."),
    _op(0x6F, "LOOP_FAR",        "to:fwd16",            "n --",            "loop", "The same, with a longer jump."),
    _op(0x70, "NEXT",            "to:back8",            "--",              "next",  "Count down; go back to `to`, or drop the counter if it is 0."),
    _op(0x71, "NEXT_FAR",        "to:back16",           "--",              "next",  "The same, with a longer jump."),
    _op(0x72, "BREAK",           "to:fwd8",             "--",              "break", "Go to `to`, the end of the loop."),
    _op(0x73, "BREAK_FAR",       "to:fwd16",            "--",              "break", "The same, with a longer jump."),
    _op(0x74, "BREAK_LOOP",      "to:fwd8",             "--",              "drop",  "Drop the counter and go to `to`, the end of the loop."),
    _op(0x75, "BREAK_LOOP_FAR",  "to:fwd16",            "--",              "drop",  "The same, with a longer jump."),
    _op(0x78, "DEF",             "to:fwd8",             "--",              "def",   "A procedure begins here; go to `to`, its end."),
    _op(0x79, "DEF_FAR",         "to:fwd16",            "--",              "def",   "The same, with a longer jump."),
    _op(0x7A, "RETURN",          "",                    "--",              "return", "Go back to just after the call."),
    _op(0x7B, "CALL",            "to:back8",            "--",              "call",  "Call the procedure whose first instruction is at `to`."),
    _op(0x7C, "CALL_FAR",        "to:back16",           "--",              "call",  "The same, with a longer jump."),
    # tasks
    *(op._replace(needs=NEEDS_TASKS, since_minor=1) for op in (
        _op(0x55, "LOOK",        "",                    "yes --",          "look",  "Continue if `yes`; otherwise look again after 20 ms."),
        _op(0x76, "END_TASK",    "",                    "--",              "end_task", "The task is finished."),
        _op(0x77, "END_WHEN",    "",                    "--",              "end_when", "Look again after 20 ms."),
        _op(0x7D, "TASK",        "to:fwd16",            "--",              "task",  "A task begins here; go to `to`, its end."),
        _op(0x7E, "WHEN",        "to:fwd16",            "--",              "when",  "A WHEN begins here; go to `to`, its end."),
    )),
    # centimetres and degrees
    *(_op(0xFF40 + i, f"GO_{d}", "", "way power --", "plain", f"{action.capitalize()} by `way`, then turn the motors off.")
      ._replace(needs=NEEDS_GO, since_minor=1) for i, (d, action) in enumerate(_MOVES)),
    *(_op(0xFF48 + i, f"WATCH_GO_{d}", "", "way power --", "watch", f"Prepare to {action} by `way`, or until a check is TRUE.")
      ._replace(needs=NEEDS_GO, since_minor=1) for i, (d, action) in enumerate(_MOVES)),
    # One-byte instructions.
    *_shorts(0x80, "PUSH_VAR",    "variable", "-- value",   "value", "Push the value of variable {}."),
    *_shorts(0x88, "PUSH_SENSOR", "sensor",   "-- reading", "value", "Push the kept reading of sensor {}."),
    *_shorts(0x90, "PUSH_READ",   "sensor",   "-- reading", "value", "Take a reading of sensor {}, keep it and push it."),
    *_shorts(0x98, "READ",        "sensor",   "--",         "read",  "Take a reading of sensor {} and keep it."),
    *_shorts(0xA0, "SET_VAR",     "variable", "value --",   "plain", "Put the value into variable {}."),
    *_shorts(0xA8, "SET",         "actuator", "value --",   "plain", "Set actuator {} to the value, rounded and limited to its range."),
    *(_op(0xB0 + i, f"PUSH_NUM_{n}", "", "-- n", "value", f"Push the whole number {n}.") for i, n in enumerate(PUSHED_NUMBERS)),
    # Comparisons with a constant.
    *_comparison_ops(0xC8, "UNTIL8",   "n:u8",               "a --", "until", "Like UNTIL, with `a {} n` as `stop`."),
    *_comparison_ops(0xD0, "UNTIL16",  "n:i16",              "a --", "until", "Like UNTIL, with `a {} n` as `stop`."),
    *_comparison_ops(0xD8, "IF8",      "n:u8 to:fwd8",       "a --", "if",    "Go to `to` unless `a {} n`."),
    *_comparison_ops(0xE0, "IF16",     "n:i16 to:fwd8",      "a --", "if",    "Go to `to` unless `a {} n`."),
    *_comparison_ops(0xE8, "IF_VAR8",  "v:variable n:u8 to:fwd8",  "--", "if", "Go to `to` unless variable `v` {} `n`."),
    *_comparison_ops(0xF0, "IF_VAR16", "v:variable n:i16 to:fwd8", "--", "if", "Go to `to` unless variable `v` {} `n`."),
)

FAULTS = (
    # number, name, meaning: faults of a running program
    (1, "OVERFLOW",       "A result is outside -2147483.648 to 2147483.647."),
    (2, "DIVIDE_BY_ZERO", "A division or a remainder by 0."),
    (3, "NO_POWER",       "At its power, a move by `way` would never end."),
    (4, "STUCK",          "Neither wheel turns in a move that the robot measures."),
    (5, "STUCK_LEFT",     "In such a move, the left wheel does not turn, but the right one does."),
    (6, "STUCK_RIGHT",    "In such a move, the right wheel does not turn, but the left one does."),
    (255, "BAD_CODE",     "A check has failed that verified code always passes: memory has changed."),
)
_GO_OPS = tuple(op.name for op in OPS if op.needs == NEEDS_GO)
_UNTIL_OPS = tuple(op.name for op in OPS if op.control_role == "until")
_MEASURED_OPS = (*(f"GO_{d}" for d, _ in _MOVES), *_UNTIL_OPS)
# The instructions that can fault in verified code.
FAULTING_OPS = {
    "OVERFLOW":       ("TIME", "RANDOM", "ADD", "SUB", "MUL", "DIV", "NEG", "ABS", "ROUND", "ADD_VAR8", "ADD_VAR", "INC_VAR", "DEC_VAR", *_GO_OPS),
    "DIVIDE_BY_ZERO": ("DIV", "MOD"),
    "NO_POWER":       _GO_OPS,
    "STUCK":          _MEASURED_OPS,
    "STUCK_LEFT":     _MEASURED_OPS,
    "STUCK_RIGHT":    _MEASURED_OPS,
    "BAD_CODE":       (),
}
# fmt: on

ISA_MINOR = max(
    op.since_minor for op in OPS
)  # a machine runs images of its own and of earlier ones
# The minor version that each bit of `needs` came with.
SINCE_OF_NEED = {
    need: min(op.since_minor for op in OPS if op.needs == need) for need in (NEEDS_TASKS, NEEDS_GO)
}
UNO_OPS = tuple(op for op in OPS if not op.needs)  # an Uno has the features of every machine
BY_NAME = {op.name: op for op in OPS}
BY_CODE: list[Op | None] = [None] * 256
ESCAPED_OPS: dict[int, Op] = {}  # keyed by the second byte
for _each in OPS:
    if _each.code > 0xFF:
        assert _each.code >> 8 == ESCAPE and _each.code & 0xFF not in ESCAPED_OPS
        ESCAPED_OPS[_each.code & 0xFF] = _each
        continue
    assert BY_CODE[_each.code] is None, f"code {_each.code:02x} is used twice"
    BY_CODE[_each.code] = _each
assert len(BY_NAME) == len(OPS), "a name is used twice"
assert BY_CODE[ESCAPE] is None


def op_at(code: bytes, offset: int) -> Op | None:
    """Return the instruction that begins at an offset, or None if none does."""
    if code[offset] != ESCAPE:
        return BY_CODE[code[offset]]
    return ESCAPED_OPS.get(code[offset + 1]) if offset + 1 < len(code) else None


def ops_in(code: bytes) -> Iterator[Op]:
    """Yield the instructions of `code`, verified or not; a byte that is not one is skipped."""
    offset = 0
    while offset < len(code):
        op = op_at(code, offset)
        if op is not None:
            yield op
        offset += 1 if op is None else op.size


def time8_ms(time: int) -> int:
    """Return milliseconds of an operand of the kind `time8`."""
    if time < 100:
        return time * 10
    return (time - 90) * 100 if time < 200 else (time - 189) * 1000


_TIME8 = {time8_ms(operand): operand for operand in range(256)}


def time8(time_ms: int) -> int | None:
    """Return the operand of the kind `time8` that says a time, if one does."""
    return _TIME8.get(time_ms)


def instruction_text(op: Op, operands: tuple[int, ...], next_offset: int) -> str:
    """Return `IF_VAR8_LT v0 10 -> 0012`: an instruction as disassemblies print it."""
    words = [op.name]
    for operand, value in zip(op.operands, operands, strict=True):
        kind = operand.kind.name
        if kind.startswith("fwd"):
            words.append(f"-> {next_offset + value:04x}")
        elif kind.startswith("back"):
            words.append(f"-> {next_offset - value:04x}")
        elif kind in ("variable", "sensor", "actuator"):
            words.append(f"{kind[0]}{value}")
        else:
            words.append(str(value))
    return " ".join(words)


_FORMAT_CHARS = {(1, False): "B", (1, True): "b", (2, False): "H", (2, True): "h", (4, True): "i"}
_LAYOUTS = {
    op.code: Struct(
        "<"
        + "".join(
            _FORMAT_CHARS[operand.kind.size, operand.kind.is_signed] for operand in op.operands
        )
    )
    for op in OPS
}


def read_operands(op: Op, code: bytes, offset: int) -> tuple[int, ...]:
    """Return the operands of the instruction `op` at `offset`, all of whose bytes are there."""
    return _LAYOUTS[op.code].unpack_from(code, offset + len(op.opcode))
