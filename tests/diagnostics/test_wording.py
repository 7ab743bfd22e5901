"""The names of things in messages, in each language."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.base.words import lexicon
from tiniscript.diagnostics.rendering import Message, message

LANGUAGES = ("en", "es", "pt")
NUMBERS = ["TASK 1;W(1);END_TASK;S", "TASK 2\nF(1, 50)\nEND_TASK\nS"]
ENDLESS = sorted(
    word for word, entries in lexicon().items()
    if any(it.kind == "FOREVER" and not it.value for it in entries)
)  # fmt: skip


def messages_of(text: str, lang: str) -> list[Message]:
    return [message(diagnostic, Source(text), lang) for diagnostic in check(text)]


@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("text", NUMBERS)
def test_no_number_is_called_a_word(text: str, lang: str) -> None:
    (message, *_) = messages_of(text, lang)
    assert message.code == "TS044" and text.split("\n")[0].split(";")[0][-1] in message.message
    assert not any(word in message.message.lower() for word in ("word", "palabra", "palavra"))


@pytest.mark.sampled("template", keep=1)
@pytest.mark.parametrize(
    "template",
    ["SI|{}\nF(1, 60)\nEND_LOOP", "SI|W(1)\n{}\nF(1, 60)\nEND", "{} {{\n F(1, 60);\n}}",
     "SI|{};F(1, 60);END_LOOP"],
)  # fmt: skip
@pytest.mark.parametrize("word", ["void loop()", *ENDLESS])
def test_the_start_of_a_block_is_never_called_just_forever(word: str, template: str) -> None:
    for diagnostic in check(template.format(word)):
        if "LOOP(FOREVER)" in str(diagnostic.values):
            assert diagnostic.values.get("right") != "FOREVER"


def test_forever_is_suggested_as_a_time() -> None:
    (message,) = messages_of("SI|W(SIEMPRE) UNTIL(DISTANCE < 9)", "en")
    assert message.message == "In TiniScript, SIEMPRE is FOREVER"
    (message,) = messages_of("void loop() {\n  F(1, 60);\n}", "es")
    assert message.message.startswith("En TiniScript void loop se dice LOOP(FOREVER), y el bloque")


@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("last_line", ["F(1, 60)", "LOOP(2);S;END_LOOP", "IF(KEY_A)\nS\nENDIF"])
def test_the_end_of_a_block_is_on_a_line_of_its_own(last_line: str, lang: str) -> None:
    text = f"SI|IF(DISTANCE < 9)\n{last_line}"
    message = messages_of(text, lang)[-1]
    assert message.code == "TS024" and "ENDIF" in message.fix and ": ENDIF" not in message.fix
