"""The limits of a program: the largest allowed, and one more, with its place."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tiniscript import check_text, compile_text, robots
from tiniscript.base.limits import BLOCKS, CALLS, DEFS, STACK_VALUES, VARIABLES
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Code

KIT = robots.load("tinibot").kit


def variables(count: int) -> str:
    return ";".join(f"V{k} = 1;SHOW(V{k})" for k in range(count))


def defs(count: int) -> str:
    defs_text = ";".join(f"DEF D{k};S;END_DEF" for k in range(count))
    return defs_text + ";" + ";".join(f"D{k}" for k in range(count))


def calls(count: int) -> str:
    """Return this many nested calls; the first DEF calls none."""
    def_rows = ["DEF C0;S;END_DEF", *(f"DEF C{k};C{k - 1};END_DEF" for k in range(1, count))]
    return ";".join([*def_rows, f"C{count - 1}"])


def deep(count: int) -> str:
    """A value that needs so many places of the stack."""
    return "(TIME+" * (count - 1) + "TIME" + ")" * (count - 1)


def blocks(count: int, inside: str = "S") -> str:
    return "IF(TIME > 1);" * count + inside + ";ENDIF" * count


def blocks_around_a_call(count: int) -> str:
    return f"DEF A;{blocks(4)};END_DEF;" + blocks(count - 4, "A")


LIMITS = [
    (variables, VARIABLES, codes.TOO_MANY_VARIABLES),
    (defs, DEFS, codes.TOO_MANY_DEFS),
    (calls, CALLS, codes.CALLS_TOO_DEEP),
    (lambda n: f"SHOW({deep(n)})", STACK_VALUES, codes.VALUES_TOO_DEEP),
    (lambda n: f"X = {deep(n)};SHOW(X)", STACK_VALUES, codes.VALUES_TOO_DEEP),
    (lambda n: f"IF({deep(n)} > 1);S;ENDIF", STACK_VALUES, codes.VALUES_TOO_DEEP),
    (lambda n: f"LOOP({deep(n)});S;END_LOOP", STACK_VALUES, codes.VALUES_TOO_DEEP),
    # the first value of two lies on the stack while the second is calculated
    (lambda n: f"M(1, {deep(n - 1)})", STACK_VALUES, codes.VALUES_TOO_DEEP),
    (lambda n: f"M({deep(n)}, 1)", STACK_VALUES, codes.VALUES_TOO_DEEP),
    (blocks, BLOCKS, codes.BLOCKS_TOO_DEEP),
    (blocks_around_a_call, BLOCKS, codes.BLOCKS_TOO_DEEP),
]


@pytest.mark.parametrize(("make", "limit", "code"), LIMITS)
def test_programs_at_the_limits_compile_and_beyond_are_refused(
    make: Callable[[int], str], limit: int, code: Code
) -> None:
    fitting = compile_text(make(limit), KIT)
    assert fitting.is_right and fitting.image, [
        diagnostic.code.number for diagnostic in fitting.diagnostics
    ]
    compilation = check_text(make(limit + 1), KIT)
    assert {diagnostic.code for diagnostic in compilation.diagnostics if diagnostic.is_mistake} == {
        code
    }
    assert compilation.diagnostics[0].values.get("limit", str(limit)) == str(limit)


def test_the_second_value_of_an_argument_lies_above_the_first() -> None:
    """`5 - (…)` keeps 5 while the brackets are calculated; `(…) - 5` does not."""
    assert check_text(f"SHOW({deep(STACK_VALUES)} - 5)", KIT).is_right
    assert not check_text(f"SHOW(5 - {deep(STACK_VALUES)})", KIT).is_right
