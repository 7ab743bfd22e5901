"""A fact that was once written down in several places has one home, and stays there."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable
from functools import lru_cache

import pytest

from tests.support.casefile import ROOT
from tiniscript.link import messages
from tiniscript.syntax import operators

PACKAGE = ROOT / "compiler" / "tiniscript"
FILES = sorted(PACKAGE.rglob("*.py"))


def is_text(node: ast.AST, pattern: str) -> bool:
    """Whether it is a literal text that matches as a whole."""
    return (
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and re.fullmatch(pattern, node.value) is not None
    )


FIELDS = r"state|saved|status|fault|reset|cause"  # of messages: their numbers have names


def field_of(node: ast.expr) -> bool:
    """Whether it is `values["state"]`, `reply.status` or a variable of such a name."""
    if isinstance(node, ast.Subscript):
        return is_text(node.slice, FIELDS)
    name = node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")
    return re.fullmatch(FIELDS, name.lstrip("_")) is not None


def is_number_of_a_message(node: ast.AST) -> bool:
    """Whether a field of a message is compared with a plain number, or set to one."""
    sides: list[ast.expr] = []
    if isinstance(node, ast.Compare) and isinstance(node.ops[0], (ast.Eq, ast.NotEq, ast.In)):
        sides = [node.left, *node.comparators]
    elif isinstance(node, ast.Assign):
        sides = [*node.targets, node.value]
    elif isinstance(node, ast.AnnAssign) and node.value is not None:
        sides = [node.target, node.value]
    return any(map(field_of, sides)) and any(
        isinstance(each, ast.Constant) and type(each.value) is int for each in sides
    )


def ends_an_instruction(node: ast.AST) -> bool:
    """Whether it is a set of tokens with `;`, a line's end and the text's end."""
    parts = node.elts if isinstance(node, (ast.Tuple, ast.Set, ast.List)) else []
    names = {each.id for each in parts if isinstance(each, ast.Name)}
    return {"NEWLINE", "END"} <= names and any(is_text(each, ";") for each in parts)


# What is looked for, and its homes.
KINDS: dict[str, tuple[Callable[[ast.AST], bool], set[str]]] = {
    "the cache folder": (
        lambda node: isinstance(node, ast.Name) and node.id == "user_cache_path", {"files.py"}),
    # `values["saved"] == 3` says nothing, and stays 3 when the table changes
    "a plain number of a message": (is_number_of_a_message, set()),
    # comparisons are in the table of opcodes, others in that of operators; the lexer knows which
    # signs are one token
    "signs of comparisons": (lambda node: is_text(node, "<>|<="), {"bytecode/opcodes.py"}),
    "ends of blocks": (
        lambda node: is_text(node, "ENDIF|END_LOOP|END_WHILE|END_DEF"), {"words.py"}),
    "the end of an instruction": (ends_an_instruction, {"syntax/cursor.py"}),
    # a row of recovery says with which one it is told
    "numbers of diagnostics": (
        lambda node: is_text(node, r"TS\d{3}"), {"diagnostics/codes.py", "recovery/rows.py"}),
}  # fmt: skip


@lru_cache(maxsize=1)
def homes() -> dict[str, set[str]]:
    """Return the files in which there is each kind; all are parsed once."""
    found: dict[str, set[str]] = {name: set() for name in KINDS}
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            for name, (is_it, _) in KINDS.items():
                if is_it(node):
                    found[name].add(path.relative_to(PACKAGE).as_posix())
    return found


@pytest.mark.parametrize("name", KINDS)
def test_it_has_one_home(name: str) -> None:
    assert homes()[name] == KINDS[name][1]


def test_names_of_states_are_rows_of_their_tables() -> None:
    assert [messages.STATES[number][0] for number in (
        messages.STATE_IDLE, messages.STATE_RUNNING, messages.STATE_STOPPED,
        messages.STATE_FAULTED,
    )] == ["IDLE", "RUNNING", "STOPPED", "FAULTED"]  # fmt: skip
    assert [messages.SAVED[number][0] for number in (
        messages.SAVED_NOTHING, messages.SAVED_SAVING, messages.SAVED_STORED,
        messages.SAVED_LOW_SUPPLY,
    )] == ["NOTHING", "SAVING", "STORED", "LOW_SUPPLY"]  # fmt: skip


def test_signs_of_operators_are_those_of_their_table() -> None:
    assert {"+", "-", "*", "/", "%", "=", "<", ">", "<=", ">=", "<>"} == operators.SIGNS
    assert operators.SIGN_OF["MOD"] == "%"
