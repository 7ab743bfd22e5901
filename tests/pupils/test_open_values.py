"""A call in which only the pupil knows a value is shown so that its copy is no program."""

from __future__ import annotations

import re

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.rendering import message


@pytest.mark.parametrize("language", ["en", "es"])
@pytest.mark.parametrize(
    "program",
    ["F(80)", "gira", "da una vuelta a la derecha", "F(20 pasos, 80)"],
)
def test_a_copied_call_is_never_taken_for_another_program(program: str, language: str) -> None:
    """In English `time` is the sensor TIME: F(time, 80) would be read."""
    text = f"SI|{program}"
    first, *_ = check(text)
    calls = re.findall(r"[FBLR]\([^()]*\)", message(first, Source(text), language).fix)
    assert calls
    for call in calls:
        assert any(each.is_mistake for each in check(f"SI|{call}")), call


@pytest.mark.parametrize("program", ["F(1, 80) forever", "M(50, 50) sin parar", "W(1) sin parar"])
def test_what_goes_on_without_end_is_a_program(program: str) -> None:
    [found] = check(f"SI|{program}")
    assert not any(each.is_mistake for each in check(f"SI|{found.values['endless']}"))
