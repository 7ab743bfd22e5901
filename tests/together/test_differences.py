"""From a text to operations: an instruction that a person would consider the same keeps its id."""

from __future__ import annotations

from collections import Counter
from itertools import count
from random import Random

import pytest

from tests.support.rows import each_row
from tiniscript.together.differences import find_operations
from tiniscript.together.form import Change, Delete, Insert, Move, Operation, data_of, operation_of
from tiniscript.together.layout import Unparsed, parse_tree, text_of
from tiniscript.together.operations import apply_change
from tiniscript.together.tree import FIELDS, PLACE, Tree

BASE = "SI|F(1, 80)\nR(0.5, 60)\nB(2, 40)  // back\n\n// again\nW(1)\nS\n"
SEVEN_MOVES = "F(1,1)\nF(2,2)\nF(3,3)\nF(4,4)\nF(5,5)\nF(6,6)\nF(7,7)\n"
LOOP = "LOOP(2)\nB(1,1)\nEND_LOOP\n"
# An action of a person: texts before and after, the operations (or `*`), and the number of
# unchanged instructions.
CASES = [
    ("a number", BASE, BASE.replace("80", "90"), "replace", 6),
    ("a word", BASE, BASE.replace("R(", "L("), "replace", 6),
    ("a LOOP typed around", BASE,
     BASE.replace("R(", "LOOP(3)\nR(").replace("// back", "// back\nEND_LOOP"), "wrap 2", 6),
    ("two blocks around", BASE,
     BASE.replace("R(", "LOOP(3)\nIF(X<1)\nR(").replace("// back", "// back\nENDIF\nEND_LOOP"),
     "wrap 2, wrap 2", 6),
    ("a line put in", BASE, BASE.replace("W(1)", "W(1)\nBEEP(1, 440)"), "insert 1", 6),
    ("a line taken out", BASE, BASE.replace("W(1)\n", ""), "delete 1", 5),
    ("a comment added", BASE, BASE.replace("R(", "// turn\nR("), "insert 1", 6),
    ("a comment behind", BASE, BASE.replace("W(1)", "W(1) // wait"), "replace", 6),
    ("an empty line", BASE, BASE.replace("R(", "\nR("), "replace", 6),
    ("laid out anew", BASE,
     "si | f(1,80);r( .5, 60 );b(2,40) // back\n\n\n//again\n   w(1)\ns", "", 6),
    ("cut and paste", SEVEN_MOVES, "F(1,1)\nF(5,5)\nF(6,6)\nF(7,7)\nF(2,2)\nF(3,3)\nF(4,4)\n",
     "move 3", 7),
    ("a block moved", f"F(1,1)\n{LOOP}F(2,2)\nF(3,3)\n", f"F(1,1)\nF(2,2)\nF(3,3)\n{LOOP}",
     "move 1", 5),
    ("a block moved, its head changed", f"F(1,1)\n{LOOP}F(2,2)\nF(3,3)\n",
     f"F(1,1)\nF(2,2)\nF(3,3)\n{LOOP}".replace("2)\nB", "4)\nB"), "*", 5),
    ("a block taken away", f"{LOOP}F(2,2)\n", "B(1,1)\nF(2,2)\n", "unwrap", 2),
    ("a block deleted", f"{LOOP}F(2,2)\n", "F(2,2)\n", "delete 2", 1),
    ("LOOP to WHILE", LOOP, "WHILE(X<2)\nB(1,1)\nEND_WHILE\n", "replace", 2),
    ("an ELSE typed in", "IF(X<1)\nF(1,1)\nB(1,1)\nENDIF\n",
     "IF(X<1)\nF(1,1)\nELSE\nB(1,1)\nENDIF\n", "insert 1", 3),
    ("an arm deleted", "IF(X<1)\nF(1,1)\nELSE\nB(1,1)\nENDIF\n", "IF(X<1)\nF(1,1)\nENDIF\n",
     "delete 2", 2),
    ("into a block", f"F(1,1)\n{LOOP}S\n", "LOOP(2)\nF(1,1)\nB(1,1)\nEND_LOOP\nS\n", "move 1", 4),
    ("the end further down", f"{LOOP}S\nW(1)\n", "LOOP(2)\nB(1,1)\nS\nEND_LOOP\nW(1)\n",
     "move 1", 4),
    ("inside out", "LOOP(3)\nIF(X<1)\nF(1,1)\nENDIF\nEND_LOOP\n",
     "IF(X<1)\nLOOP(3)\nF(1,1)\nEND_LOOP\nENDIF\n", "*", 3),
    ("the first of two equal lines", "F(1,1)\nF(1,1)\nS\n", "F(1,1)\nS\n", "delete 1", 2),
    ("two on one line", "F(1,1)\nS\n", "F(1,1);B(1,1)\nS\n", "insert 1", 2),
    ("a start", "F(1,1)\nS\n", "SB|F(1,1)\nS\n", "replace", 2),
    ("a start behind a comment", "// n\nF(1,1)\nS\n", "// n\nSB|F(1,1)\nS\n",
     "move 1, replace", 3),
    ("changed and put into a block", "F(1,1)\nB(2,2)\nS\n",
     "LOOP(2)\nF(1,5)\nB(2,2)\nEND_LOOP\nS\n", "wrap 2, replace", 3),
    ("a task of the rest", "F(1,1)\nB(2,2)\nS\n", "F(1,1)\nTASK\nB(2,2)\nS\nEND_TASK\n",
     "wrap 2", 3),
]  # fmt: skip
PROGRAMS = 150


def describe(operations: list[Operation]) -> str:
    rows = []
    for operation in operations:
        size = (
            len(operation.nodes)
            if isinstance(operation, Insert)
            else len(getattr(operation, "ids", ()))
        )
        rows.append(f"{data_of(operation)['do']}{f' {size}' if size else ''}")
    return ", ".join(rows)


@each_row("what, before, after, expected_operations, kept_count", CASES)
def test_equal_parts_are_kept(
    what: str, before: str, after: str, expected_operations: str, kept_count: int
) -> None:
    numbers, new_numbers = count(1), count(1)
    old_tree = parse_tree(before, lambda: f"o.{next(numbers)}")
    operations = find_operations(old_tree, after, lambda: f"n.{next(new_numbers)}")
    new_tree = apply_change(old_tree, Change("n:1", tuple(operations))).tree
    assert new_tree.shape() == parse_tree(after).shape()
    assert expected_operations in ("*", describe(operations))
    assert sum(id.startswith("o.") for id in new_tree.subtree_ids()) == kept_count


def program(rng: Random, size: int, depth: int = 0) -> list[str]:
    rows: list[str] = []
    for _ in range(size):
        kind, k = rng.random(), rng.randint(2, 9)
        inner = [] if depth > 3 else program(rng, rng.randint(0, 3), depth + 1)
        if kind < 0.55 or depth > 3:
            rows.append(f"{rng.choice('FBLR')}({k}, {rng.randint(1, 9)}0)")
        elif kind < 0.65:
            rows.append(f"// {rng.choice(('a', 'b', 'go on', 'turn'))}")
        elif kind < 0.75:
            rows.append(rng.choice(("S", f"X = {k}")))
        elif kind < 0.85:
            rows += [f"LOOP({k})", *inner, "END_LOOP"]
        elif kind < 0.95:
            rows += [f"IF(X < {k})", *inner]
            if rng.random() < 0.4:
                rows += [f"ELSEIF(X > {k})", *program(rng, 1, depth + 1)]
            if rng.random() < 0.5:
                rows += ["ELSE", *program(rng, 1, depth + 1)]
            rows.append("ENDIF")
        elif depth == 0:
            rows += ["TASK", *inner, "END_TASK"]
        if rng.random() < 0.1:
            rows.append("")
    return rows


def edit_rows(rng: Random, rows: list[str]) -> list[str]:
    new_rows = rows[:]
    for _ in range(rng.randint(1, 4)):
        kind, i = rng.random(), rng.randrange(len(new_rows) + 1)
        if kind < 0.3:
            new_rows[i:i] = program(rng, rng.randint(1, 2), 1)
        elif kind < 0.5:
            del new_rows[i : i + rng.randint(1, 4)]
        elif kind < 0.7:
            cut_rows = new_rows[i : i + rng.randint(1, 6)]
            del new_rows[i : i + len(cut_rows)]
            k = rng.randrange(len(new_rows) + 1)
            new_rows[k:k] = cut_rows
        elif kind < 0.85:
            new_rows.insert(min(len(new_rows), i + rng.randint(0, 5)), "END_LOOP")
            new_rows.insert(i, "LOOP(7)")
        elif i < len(new_rows):
            new_rows[i] = new_rows[i].replace("(", "(1", 1)
    return new_rows


def marks_of(tree: Tree) -> list[list[str]]:
    """Return the last change of each part of a node, and of its place."""
    return [[tree[id].mark(name) for name in (*FIELDS, PLACE)] for id in tree.subtree_ids()]


@pytest.mark.parametrize("seed", range(4))
def test_operations_produce_the_new_program_and_are_undone(seed: int) -> None:
    rng, tried = Random(seed), Counter[str]()
    while sum(tried.values()) < PROGRAMS:
        tree_before = program(rng, rng.randint(0, 20))
        new_rows = edit_rows(rng, tree_before) if rng.random() < 0.8 else program(rng, 12)
        numbers, new_numbers = count(1), count(1)
        try:
            old_tree = parse_tree("\n".join(tree_before), lambda: f"o.{next(numbers)}")  # noqa: B023
            new_tree = parse_tree("\n".join(new_rows))
        except Unparsed:
            continue
        for node in old_tree.node_by_id.values():  # others have worked on it
            node.creator_uid = "o:1"
            node.marks = {name: "o:2" for name in (*FIELDS, PLACE) if rng.random() < 0.5}
        operations = find_operations(
            old_tree,
            "\n".join(new_rows),
            lambda: f"n.{next(new_numbers)}",  # noqa: B023
        )
        assert [operation_of(data_of(operation)) for operation in operations] == operations
        outcome = apply_change(old_tree, Change("n:1", tuple(operations)))
        assert outcome.tree.shape() == new_tree.shape()
        assert text_of(outcome.tree) == text_of(new_tree)
        restored = apply_change(outcome.tree, Change("n:2", outcome.inverse)).tree
        assert text_of(restored) == text_of(old_tree)
        assert restored.subtree_ids() == old_tree.subtree_ids()
        assert marks_of(restored) == marks_of(old_tree)  # so an earlier change can be undone, too
        tried.update(type(operation).__name__ for operation in operations or [Delete(())])
    assert {Insert.__name__, Move.__name__, "Wrap", "Unwrap", "Replace"} <= set(tried)
