"""A fact that was once written down in several places has one home, and stays there."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.support.casefile import ROOT
from tiniscript.link import messages
from tiniscript.syntax import operators

PACKAGE = ROOT / "compiler" / "tiniscript"
FILES = sorted(PACKAGE.rglob("*.py"))


def nodes(path: Path) -> Iterator[ast.AST]:
    yield from ast.walk(ast.parse(path.read_text(encoding="utf-8")))


def homes(is_it: Callable[[ast.AST], bool]) -> set[str]:
    """Return the files in which a node is such a one."""
    return {
        path.relative_to(PACKAGE).as_posix()
        for path in FILES
        if any(is_it(node) for node in nodes(path))
    }


def is_text(node: ast.AST, pattern: str) -> bool:
    """Whether it is a literal text that matches as a whole."""
    return (
        isinstance(node, ast.Constant)
        and isinstance(node.value, str)
        and re.fullmatch(pattern, node.value) is not None
    )


def test_the_cache_folder_has_one_home() -> None:
    found = homes(lambda node: isinstance(node, ast.Name) and node.id == "user_cache_path")
    assert found == {"files.py"}


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


def test_states_and_statuses_are_named() -> None:
    """`values["saved"] == 3` says nothing, and stays 3 when the table changes."""
    assert homes(is_number_of_a_message) == set()


def test_names_of_states_are_rows_of_their_tables() -> None:
    assert [messages.STATES[number][0] for number in (
        messages.STATE_IDLE, messages.STATE_RUNNING, messages.STATE_STOPPED,
        messages.STATE_FAULTED,
    )] == ["IDLE", "RUNNING", "STOPPED", "FAULTED"]  # fmt: skip
    assert [messages.SAVED[number][0] for number in (
        messages.SAVED_NOTHING, messages.SAVED_SAVING, messages.SAVED_STORED,
        messages.SAVED_LOW_SUPPLY,
    )] == ["NOTHING", "SAVING", "STORED", "LOW_SUPPLY"]  # fmt: skip


def test_signs_of_operators_have_one_home() -> None:
    """Comparisons are in the table of opcodes, the others in that of operators.

    The lexer knows which signs are one token.
    """
    found = homes(lambda node: is_text(node, "<>|<="))
    assert found == {"bytecode/opcodes.py"}
    assert homes(lambda node: is_text(node, "%")) >= {"syntax/operators.py"}
    assert {"+", "-", "*", "/", "%", "=", "<", ">", "<=", ">=", "<>"} == operators.SIGNS
    assert operators.SIGN_OF["MOD"] == "%"


def test_ends_of_blocks_have_one_home() -> None:
    found = homes(lambda node: is_text(node, "ENDIF|END_LOOP|END_WHILE|END_DEF"))
    assert found == {"words.py"}


def test_the_end_of_an_instruction_has_one_home() -> None:
    """A set of tokens with `;`, a line's end and the text's end is `AT_END`."""

    def is_such_a_set(node: ast.AST) -> bool:
        parts = node.elts if isinstance(node, (ast.Tuple, ast.Set, ast.List)) else []
        names = {each.id for each in parts if isinstance(each, ast.Name)}
        return {"NEWLINE", "END"} <= names and any(is_text(each, ";") for each in parts)

    assert homes(is_such_a_set) == {"syntax/cursor.py"}


def test_numbers_of_diagnostics_have_one_home() -> None:
    """A row of recovery says with which one it is told."""
    found = homes(lambda node: is_text(node, r"TS\d{3}"))
    assert found == {"diagnostics/codes.py", "recovery/rows.py"}
