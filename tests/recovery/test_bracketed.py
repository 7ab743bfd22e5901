"""Messages name the text that they remove: no value or question is dropped silently."""

from __future__ import annotations

from itertools import product

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.rendering import message

PLACES = ("SI|{}", "{}", "W(1);{}", "{}\nW(1)", "LOOP(2);{};W(1);END_LOOP", "W(1)\n{};W(2)")
BRACKET_CONTENTS = ("7", "DISTANCE < 23", "7.5, 23", "ABS(7)")


@pytest.mark.sampled("place", keep=2)
@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("word", ["S", "STOP", "BREAK", "END_LOOP", "ENDIF", "START", "DISTANCE"])
def test_contents_of_needless_brackets_are_named(word: str, place: str) -> None:
    for inside, language in product(BRACKET_CONTENTS, ("en", "es", "pt")):
        text = place.format(f"{word}({inside})")
        messages = [
            message(diagnostic, Source(text), language)
            for diagnostic in check(text)
            if diagnostic.is_mistake
        ]
        named_messages = [message for message in messages if message.code in ("TS039", "TS118")]
        number = "23" if "23" in inside else "7"
        assert named_messages or messages, text
        assert all(number in message.message + message.fix for message in named_messages), (
            text,
            named_messages,
        )


@pytest.mark.parametrize("place", PLACES)
def test_a_condition_in_needless_brackets_is_recognized(place: str) -> None:
    text = place.format("STOP(DISTANCE < 10)")
    offers = [diagnostic.values.get("fix") for diagnostic in check(text)]
    assert "IF(DISTANCE < 10);STOP;ENDIF" in offers


@pytest.mark.parametrize(("text", "lost_text"), [("TASK(1)\nS\nEND_TASK", "1"), ("SHOW1(5)", "1")])
def test_parts_removed_by_a_suggestion_are_named(text: str, lost_text: str) -> None:
    first, *_ = check(text)
    assert first.values["lost"] == lost_text
