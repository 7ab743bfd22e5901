"""A name of a block replaces the words for its effect, so that nothing is repeated."""

from __future__ import annotations

import json
import re
import unicodedata
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support.node import in_node, page_data
from tests.support.text_only_words import CAPITAL_WORDS
from tests.support.texts import LANGUAGES
from tiniscript.base.languages import texts
from tiniscript.base.words import WORDS
from tiniscript.diagnostics.codes import CODES
from tiniscript.lessons import catalogue
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.forms import BLOCKS, TEXT
from tiniscript.lessons.sentences import EXAMPLES, sentence
from tiniscript.studio import block_speech, page_lessons, worker
from tiniscript.studio.checking import profile_of
from tools.builds.page_texts import page_texts

SCRIPT = Path(__file__).with_name("said_in_node.mjs")
CODE_PATTERN = re.compile("`([^`]+)`")
WORD = re.compile(r"[^\W\d_]+|\d+")
NEARBY_WORD_COUNT = 2  # words next to a block
STEM_LETTERS = 4  # letters that the forms of a word share
REPEATED_WORD = re.compile(r"\b(\w+)[ (%]{1,3}\1\b", re.IGNORECASE)

__all__ = ["page_data"]

Parts = list[tuple[bool, str]]


def words(text: str) -> list[str]:
    decomposed_text = unicodedata.normalize("NFD", text.lower())
    return WORD.findall(
        "".join(character for character in decomposed_text if not unicodedata.combining(character))
    )


def stem(word: str) -> str:
    return word[:STEM_LETTERS]


def list_repetitions(parts: Parts) -> list[str]:
    """Return immediate repetitions: a word after itself, or after a block that shows it."""
    text = "".join(part for _, part in parts)
    repeated_words = [
        repeated
        for repeated in re.findall(r"\b(\w+)[ (%]{1,3}\1\b", text, re.I)
        if not repeated.isdigit()
    ]
    for k, (is_block, label) in enumerate(parts):
        if not is_block:
            continue
        label_stems = {stem(word) for word in words(label) if len(word) >= STEM_LETTERS}
        text_before, text_after = (
            parts[k + step][1] if 0 <= k + step < len(parts) else "" for step in (-1, 1)
        )
        nearby_words = words(re.split(r"[.?!:;]", text_before)[-1])[-NEARBY_WORD_COUNT:]
        nearby_words += words(re.split(r"[.?!:;]", text_after)[0])[:NEARBY_WORD_COUNT]
        repeated_words += [word for word in nearby_words if stem(word) in label_stems]
    return repeated_words


def sentences_of(number: int, language: str, form: str) -> list[str]:
    steps = page_lessons.steps(number, language, form)
    parts = [block for step in steps for block in step["blocks"] if block["kind"] != "program"]
    return [*(row[0] for block in parts for row in block["rows"] if row),
            *(step["hint"] for step in steps)]  # fmt: skip


def found_sentences(language: str) -> Iterator[str]:
    """Each sentence that a check says, with the words and the examples that it may have."""
    names = re.findall(r"{(\w+)}", str(texts("lessons", language)))
    values = {**dict.fromkeys(names, "3"), "truth": "✓", "name": "HOP", "what": "DISTANCE"}
    for key in texts("lessons", language):
        if not key.startswith("said/"):
            continue
        for word in ("KEY_UP",) if "obeys" in key else EXAMPLES if "uses" in key else ("UNTIL",):
            question_values = {"word": word, "question": "DISTANCE < 15"}
            yield sentence(
                Finding(
                    "", key.removeprefix("said/"), {**values, **question_values}, {language: "X"}
                ),
                language,
                BLOCKS,
            )


def shown_parts(page_data: Path, language: str, rows: list[dict[str, Any]]) -> list[Parts]:
    """Return the parts of sentences as a page in a language shows them."""
    (page_data / "texts.json").write_text(json.dumps(page_texts(language)), encoding="utf-8")
    input_rows = "\n".join(json.dumps(row) for row in rows)
    lines = in_node(SCRIPT, str(page_data), input_text=input_rows)
    assert len(lines) == len(rows)
    return [[(bool(is_block), text) for is_block, text in json.loads(line)] for line in lines]


def blocks_of_code(text: str) -> dict[str, dict[str, Any]]:
    return block_speech.blocks_of(CODE_PATTERN.findall(text), profile_of("tinibot").kit)


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_lesson_repeats_the_text_of_a_block(page_data: Path, language: str) -> None:
    rows = []
    for number in range(1, len(catalogue.folders()) + 1):
        robot = catalogue.load(catalogue.folder_of(str(number))).robot
        spoken_blocks = page_lessons.spoken_blocks(number, language)
        rows += [{"robot": robot, "sentence": sentence, "spoken": spoken_blocks}
                 for sentence in sentences_of(number, language, BLOCKS)]  # fmt: skip
    rows += [{"robot": "tinibot", "sentence": sentence, "spoken": blocks_of_code(sentence)}
             for sentence in found_sentences(language)]  # fmt: skip
    parts = shown_parts(page_data, language, rows)
    assert sum(is_block for row in parts for is_block, _ in row) > 100
    repeated_by_text = {
        "".join(f"[{text}]" if is_block else text for is_block, text in row): repeated_words
        for row in parts
        if (repeated_words := list_repetitions(row))
    }
    assert repeated_by_text == {}


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_warning_names_code_like_blocks_do(page_data: Path, language: str) -> None:
    """For each code the program in its explanation: no word of the text, and no line."""
    learn = json.dumps({"do": "check", "robot": "tinibot", "language": language})
    warned = [code for code, about in CODES.items() if not about.is_mistake]
    programs = [texts("messages", "en").get(f"{code}/wrong", "") for code in warned]
    findings = [
        finding
        for program in programs
        for finding in json.loads(worker.answer(learn, str(program).encode()))["findings"]
    ]
    on_blocks = [finding["on_blocks"] for finding in findings]
    rows = [{"robot": "tinibot", "sentence": finding[part], "spoken": finding["spoken"]}
            for finding in on_blocks for part in ("message", "fix")]  # fmt: skip
    parts = shown_parts(page_data, language, rows)
    assert {finding["code"] for finding in findings} > set(warned[:5])
    assert sum(is_block for row in parts for is_block, _ in row) > len(warned)
    plain_parts = [part for row in parts for is_block, part in row if not is_block]
    assert [part for part in plain_parts if set(CAPITAL_WORDS.findall(part)) & WORDS.keys()] == []
    assert [part for part in plain_parts if re.search(r"\b[Ll](ine|ínea|inha)s? \d", part)] == []


@pytest.mark.parametrize("sentence, marked_text", [
    ("During this F (2 s)", "During this `F` (2 s)"),
    ("F(2, 80) UNTIL(DISTANCE < 5), X = X + 1.", "`F(2, 80) UNTIL(DISTANCE < 5)`, `X = X + 1`."),
    ("as in UNTIL(DISTANCE < 5)", "as in `UNTIL`(`DISTANCE < 5`)"),
    ("write f(2, 80), F(2 80 or X", "write `f(2, 80)`, `F`(2 80 or X"),
    ("A file(s) with 1 MB; the character `, F", "A file(s) with 1 MB; the character `, F"),
])  # fmt: skip
def test_code_in_a_sentence_matches_the_block_text(sentence: str, marked_text: str) -> None:
    assert block_speech.mark_code(sentence, profile_of("tinibot").kit) == marked_text


@pytest.mark.parametrize("language", LANGUAGES)
def test_no_text_has_a_word_twice(language: str) -> None:
    for number in range(1, len(catalogue.folders()) + 1):
        for text in sentences_of(number, language, TEXT):
            assert list_repetitions([(False, text.replace("`", ""))]) == [], text


@pytest.mark.parametrize("parts, repeated_texts", [
    ([(True, "repeat forever"), (False, " repeats forever. Which?")], ["repeats", "forever"]),
    ([(False, "The "), (True, "bumper"), (False, " is the bumper.")], []),
    ([(True, "motors: left left %, right 5 %")], ["left"]),
    ([(True, "yes"), (False, " (yes) or "), (True, "no"), (False, ".")], ["yes"]),
    ([(True, "gira a la izquierda"), (False, " gira.")], ["gira"]),
    ([(True, "turn left"), (False, ". Turn the key.")], []),
])  # fmt: skip
def test_repetitions_are_found(parts: Parts, repeated_texts: list[str]) -> None:
    assert list_repetitions(parts) == repeated_texts
