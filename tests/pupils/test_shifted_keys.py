"""Signs that stand for the digit of their key, and those that may just be too much."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.rendering import message
from tiniscript.repairs.fixing import fixed
from tiniscript.repairs.shifted_keys import shifted_call
from tiniscript.source import Source


@pytest.mark.parametrize(
    ("text", "call"),
    [
        ("F(2, 8=)", "F(2, 80)"),
        ("F(!, 80)", "F(1, 80)"),
        ("F(2; (0)", "F(2, 80)"),
        ("L(=.39, 60)", "L(0.39, 60)"),
        ("L(0;39, 60)", "L(0.39, 60)"),
        ("F(2, 1==)", "F(2, 100)"),
        ("F(2, 80=)", ""),  # one too much
        ("F(2=, 80)", ""),  # 2 s or 20 s
        ("F(2, 8=", ""),  # for the bracket, or for the 0
        ("W(1=)", ""),
        ("F(2, 80)", None),
        ("F(2, =80)", None),
        ("SHOW(8=)", None),
        ("F82, 809", "F(2, 80)"),
    ],
)
def test_a_sign_is_a_digit_only_where_that_is_sure(text: str, call: str | None) -> None:
    found = shifted_call(text)
    assert (found.call if found is not None else None) == call
    done = fixed(text, check)  # no digit comes without being asked for
    assert done.text in (text, call)


@pytest.mark.parametrize(("lang", "part"), [("es", "tecla del 0"), ("en", "key of the 0")])
def test_the_key_is_named(lang: str, part: str) -> None:
    program = "SI|F(2, 8=)"
    (found,) = check(program)
    assert found.code is codes.OTHER_CALL
    assert part in message(found, Source(program), lang).message
