"""What a message calls the things that it names, in each language."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.base.words import lexicon
from tiniscript.diagnostics.rendering import Message, message

LANGUAGES = ("en", "es", "pt")
NUMBERS = ["TASK 1;W(1);END_TASK;S", "TASK 2\nF(1, 50)\nEND_TASK\nS"]
ENDLESS = sorted(
    word for word, said in lexicon().items()
    if any(it.kind == "FOREVER" and not it.value for it in said)
)  # fmt: skip


def messages_of(text: str, lang: str) -> list[Message]:
    return [message(diagnostic, Source(text), lang) for diagnostic in check(text)]


@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("text", NUMBERS)
def test_no_number_is_called_a_word(text: str, lang: str) -> None:
    (said, *_) = messages_of(text, lang)
    assert said.code == "TS044" and text.split("\n")[0].split(";")[0][-1] in said.message
    assert not any(word in said.message.lower() for word in ("word", "palabra", "palavra"))


@pytest.mark.sampled("around", keep=1)
@pytest.mark.parametrize(
    "around",
    ["SI|{}\nF(1, 60)\nEND_LOOP", "SI|W(1)\n{}\nF(1, 60)\nEND", "{} {{\n F(1, 60);\n}}",
     "SI|{};F(1, 60);END_LOOP"],
)  # fmt: skip
@pytest.mark.parametrize("word", ["void loop()", *ENDLESS])
def test_what_begins_a_block_is_never_called_forever_alone(word: str, around: str) -> None:
    for diagnostic in check(around.format(word)):
        if "LOOP(FOREVER)" in str(diagnostic.values):
            assert diagnostic.values.get("right") != "FOREVER"


def test_forever_is_called_so_where_it_is_a_time() -> None:
    (said,) = messages_of("SI|W(SIEMPRE) UNTIL(DISTANCE < 9)", "en")
    assert said.message == "In TiniScript, SIEMPRE is FOREVER"
    (said,) = messages_of("void loop() {\n  F(1, 60);\n}", "es")
    assert said.message.startswith("En TiniScript void loop se dice LOOP(FOREVER), y el bloque")


@pytest.mark.parametrize("lang", LANGUAGES)
@pytest.mark.parametrize("last", ["F(1, 60)", "LOOP(2);S;END_LOOP", "IF(KEY_A)\nS\nENDIF"])
def test_the_end_of_a_block_is_on_a_line_of_its_own(last: str, lang: str) -> None:
    text = f"SI|IF(DISTANCE < 9)\n{last}"
    said = messages_of(text, lang)[-1]
    assert said.code == "TS024" and "ENDIF" in said.fix and ": ENDIF" not in said.fix
