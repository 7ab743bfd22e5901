"""Lowering: expressions become instructions, and conditions become branches.

Knows the shortest push of a constant, when both sides of an AND may simply be evaluated, and which
conditions compare to a constant. In plain code (`lower`), only the push is chosen: each operator is
its instruction, and a condition is a value for IF or UNTIL.
"""

# No `from __future__ import annotations`: typing would compile each field's again, one by one.
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.source import Span
from tiniscript.bytecode.opcodes import BY_NAME, PUSHED_NUMBERS, SHORTS, Op
from tiniscript.semantics.ir import Expression, Term
from tiniscript.semantics.optimizer import is_safe

NEGATED = {"EQ": "NE", "NE": "EQ", "LT": "GE", "GE": "LT", "LE": "GT", "GT": "LE"}
_MIRRORED = {"EQ": "EQ", "NE": "NE", "LT": "GT", "GT": "LT", "LE": "GE", "GE": "LE"}
_SHORT_OPS = ("PUSH_VAR", "PUSH_SENSOR", "PUSH_READ", "READ", "SET_VAR", "SET")
_LEFT_OPS, _JOIN_OPS = ("AND_LEFT", "OR_LEFT"), ("AND", "OR")
_MAX_EAGER_TERMS = 6  # terms up to which evaluating a needless side costs less than a jump


class Item(NamedTuple):
    """An instruction that is not yet laid out; `label` stands for the last operand."""

    op: Op
    operands: tuple[int, ...]
    label: int | None
    span: Span


class Emitter:
    """Collects instructions and labels."""

    def __init__(self, is_plain: bool = False) -> None:
        self.is_plain = is_plain
        self.items: list[Item] = []
        self.labels: list[int] = []  # the index of the item after each label
        self.span = Span(0, 0)
        self._last_mark = -1

    def add(self, name: str, *operands: int, label: int | None = None) -> None:
        op, operands = _shortest_op(name, *operands)
        self.items.append(Item(op, operands, label, self.span))

    def new_label(self) -> int:
        self.labels.append(-1)
        return len(self.labels) - 1

    def mark(self, label: int) -> None:
        self.labels[label] = self._last_mark = len(self.items)

    def mark_here(self) -> int:
        label = self.new_label()
        self.mark(label)
        return label

    def take_back_read(self, sensor: int) -> bool:
        """Take back `READ sensor` if it is the last instruction and no jump ends after it."""
        if self.is_plain or not self.items or self._last_mark == len(self.items):
            return False
        last_item = self.items[-1]
        if (last_item.op, last_item.operands) != _shortest_op("READ", sensor):
            return False
        self.span = last_item.span
        del self.items[-1]
        return True

    def widen(self, indexes: set[int]) -> None:
        """Change the jumps at these indexes to their far forms."""
        items: list[Item] = []
        new_indexes = []
        for k, item in enumerate(self.items):
            new_indexes.append(len(items))
            items += _far_form(item) if k in indexes else (item,)
        new_indexes.append(len(items))
        self.labels = [new_indexes[index] for index in self.labels]
        self.items = items


def _shortest_op(name: str, *operands: int) -> tuple[Op, tuple[int, ...]]:
    """Return the instruction `name`, or the one of one byte that says the same."""
    if name in _SHORT_OPS and operands[0] < SHORTS:
        return BY_NAME[f"{name}_{operands[0]}"], ()
    return BY_NAME[name], operands


def _far_form(item: Item) -> tuple[Item, ...]:
    far_op = BY_NAME.get(item.op.name + "_FAR")
    if far_op is not None:
        return (item._replace(op=far_op),)
    *variable, number = item.operands
    ops = [
        *(_shortest_op("PUSH_VAR", number) for number in variable),
        _push(number * 1000),
        (BY_NAME[item.op.name.rpartition("_")[2]], ()),
    ]
    return (
        *(Item(*op, None, item.span) for op in ops),
        Item(BY_NAME["IF_FAR"], (), item.label, item.span),
    )


def number_of(term: Term, low: int, high: int) -> int | None:
    """Return the whole number that a term is, if it lies from `low` to `high`."""
    if term.op != "NUMBER" or term.value % 1000 or not low <= term.value // 1000 <= high:
        return None
    return term.value // 1000


def _push(value: int) -> tuple[Op, tuple[int, ...]]:
    """Return the shortest instruction that pushes `value` thousandths."""
    units, tenths = value // 1000, value // 100
    if value % 1000 == 0 and units in PUSHED_NUMBERS:
        return BY_NAME[f"PUSH_NUM_{units}"], ()
    if value % 1000 == 0 and 0 <= units <= 255:
        return BY_NAME["PUSH8"], (units,)
    if value % 100 == 0 and -128 <= tenths <= 127:
        return BY_NAME["PUSH_TENTHS"], (tenths,)
    if value % 1000 == 0 and -32768 <= units <= 32767:
        return BY_NAME["PUSH16"], (units,)
    return BY_NAME["PUSH_MILLI" if -32768 <= value <= 32767 else "PUSH32"], (value,)


def push_bytes(value: int) -> int:
    """Return the bytes of the instruction that pushes `value` thousandths."""
    return _push(value)[0].size


def pushes_in_one_byte(term: Term, variable: int) -> bool:
    """Return whether to push a number and to set a variable takes a byte each."""
    return variable < SHORTS and _push(term.value)[0].size == 1


def push(emitter: Emitter, term: Term) -> None:
    """Add the instruction for a term that is not a binary operator."""
    op, value = term
    if op == "NUMBER":
        instruction, operands = _push(value)
        emitter.items.append(Item(instruction, operands, None, emitter.span))
    elif op == "YES_NO":
        emitter.add("PUSH_TRUE" if value else "PUSH_FALSE")
    elif op == "VARIABLE":
        emitter.add("PUSH_VAR", value)
    elif op == "SENSOR":
        span = emitter.span
        emitter.add("PUSH_READ" if emitter.take_back_read(value) else "PUSH_SENSOR", value)
        emitter.span = span
    else:
        emitter.add(op)


def add_value(emitter: Emitter, expression: Expression) -> None:
    """Add instructions that leave the value of `expression` on the stack."""
    joins: list[int | None] = []
    for k, term in enumerate(expression):
        if term.op in _LEFT_OPS:
            end = _matching_index(expression, range(k + 1, len(expression)), _LEFT_OPS, _JOIN_OPS)
            right = expression[k + 1 : end]
            if not emitter.is_plain and is_safe(right) and len(right) <= _MAX_EAGER_TERMS:
                joins.append(None)
            else:
                joins.append(emitter.new_label())
                emitter.add("AND_THEN" if term.op == "AND_LEFT" else "OR_ELSE", label=joins[-1])
        elif term.op in _JOIN_OPS:
            join = joins.pop()
            if join is None:
                emitter.add(term.op)
            else:
                emitter.mark(join)
        else:
            push(emitter, term)


def emit_unless(emitter: Emitter, condition: Expression, target: int) -> None:
    """Add branches to the label `target` that are taken where `condition` is FALSE."""
    if emitter.is_plain:
        add_value(emitter, condition)
        emitter.add("IF", label=target)
        return
    # Start and end of each part, and whether it branches when TRUE.
    pending_branches = [(0, len(condition), False)]
    while pending_branches:
        start, end, wanted_answer = pending_branches.pop()
        operator = condition[end - 1].op
        if operator == "NOT":
            pending_branches.append((start, end - 1, not wanted_answer))
        elif operator == ("OR" if wanted_answer else "AND"):
            split_index = _matching_index(condition, range(end - 2, -1, -1), _JOIN_OPS, _LEFT_OPS)
            pending_branches.append((split_index + 1, end - 1, wanted_answer))
            pending_branches.append((start, split_index, wanted_answer))
        else:
            _emit_branch(emitter, condition[start:end], wanted_answer, target)


def emit_until(emitter: Emitter, condition: Expression) -> None:
    """Add instructions that end a watched move where `condition` is TRUE."""
    comparison = None if emitter.is_plain else _comparison_to_constant(condition)
    if comparison is None:
        add_value(emitter, condition)
        emitter.add("UNTIL")
    else:
        add_value(emitter, comparison.value)
        emitter.add(f"UNTIL{comparison.bit_count}_{comparison.comparator}", comparison.number)


def _emit_branch(emitter: Emitter, expression: Expression, wanted_answer: bool, label: int) -> None:
    comparison = _comparison_to_constant(expression)
    if comparison is None:
        add_value(emitter, expression)
        emitter.add("IF_NOT" if wanted_answer else "IF", label=label)
        return
    value, bit_count, comparator, number = comparison
    if wanted_answer:
        comparator = NEGATED[comparator]
    if len(value) == 1 and value[0].op == "VARIABLE":
        emitter.add(f"IF_VAR{bit_count}_{comparator}", value[0].value, number, label=label)
    else:
        add_value(emitter, value)
        emitter.add(f"IF{bit_count}_{comparator}", number, label=label)


class _Comparison(NamedTuple):
    """`value` is compared to a whole number of so many bits."""

    value: Expression
    bit_count: int
    comparator: str
    number: int


def _comparison_to_constant(expression: Expression) -> _Comparison | None:
    """Return the comparison to a whole number that an expression is, if it is one."""
    comparator = expression[-1].op
    if comparator not in NEGATED:
        return None
    value, right = expression[:-2], expression[-2]
    if len(expression) == 3 and expression[0].op == "NUMBER":
        value, right, comparator = (right,), expression[0], _MIRRORED[comparator]
    number = number_of(right, -32768, 32767)
    if number is None:
        return None
    return _Comparison(value, 8 if 0 <= number <= 255 else 16, comparator, number)


def _matching_index(
    expression: Expression, indexes: range, openers: Sequence[str], closers: Sequence[str]
) -> int:
    """Return the first of `indexes` with one of `closers` that has no opening one of `openers`
    there."""
    depth = 0
    for k in indexes:
        op = expression[k].op
        if op in closers and not depth:
            return k
        depth += (op in openers) - (op in closers)
    raise AssertionError("an AND or its left side alone")
