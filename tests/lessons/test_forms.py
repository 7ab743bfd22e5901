"""Users of blocks read about blocks, and not about things that only text has."""

from __future__ import annotations

import re

import pytest

from tests.support.text_only_words import CODE_PATTERN, END_WORD, has_line_on_floor, text_only_words
from tests.support.texts import LANGUAGES
from tiniscript.base.languages import texts
from tiniscript.lessons import catalogue
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.forms import BLOCKS, TEXT, sentences_in_form
from tiniscript.lessons.sentences import EXAMPLES, sentence
from tiniscript.studio import block_speech, page_lessons
from tiniscript.studio.checking import profile_of

LESSONS = range(1, len(catalogue.folders()) + 1)


def is_on_a_block(code: str, spoken_blocks: dict[str, dict[str, object]]) -> bool:
    """Return whether code is a word without a block's start or end, a name, or a whole block."""
    return code in spoken_blocks if not code.isidentifier() else END_WORD.match(code) is None


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", LESSONS)
def test_a_lesson_mentions_blocks_to_block_users(number: int, language: str) -> None:
    title = page_lessons.titles(language)[number - 1]["block_title"]
    steps = page_lessons.steps(number, language, BLOCKS)
    parts = [block for step in steps for block in step["blocks"] if block["kind"] != "program"]
    sentences = [title, *(row[0] for block in parts for row in block["rows"] if row)]
    sentences += [step["hint"] for step in steps]
    spoken_blocks = page_lessons.spoken_blocks(number, language)
    is_line_on_floor = has_line_on_floor(number)
    for step_sentence in sentences:
        assert text_only_words(step_sentence, language, is_line_on_floor=is_line_on_floor) == [], (
            step_sentence
        )
        for code in CODE_PATTERN.findall(step_sentence):
            assert is_on_a_block(code, spoken_blocks), (code, step_sentence)


# The place of a block among others; the order of blocks is not that of the text.
PLACES_OF_BLOCKS = {
    "en": r"\b(first|last|next|top|bottom|upper|lower)\b( \w+)? blocks?\b"
    r"|\bblocks? (above|below)\b",
    "es": r"\b(primer|últim|siguiente)\w*( \w+)? bloques?\b"
    r"|\bbloques? (de (arriba|abajo)|últim|siguiente)",
    "pt": r"\b(primeir|últim|seguinte|próxim)\w*( \w+)? blocos?\b"
    r"|\bblocos? (de (cima|baixo)|últim|seguinte)",
}


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", LESSONS)
def test_a_lesson_calls_blocks_by_name_and_not_by_place(number: int, language: str) -> None:
    for step in page_lessons.steps(number, language, BLOCKS):
        parts = [block for block in step["blocks"] if block["kind"] != "program"]
        for text in [*(row[0] for block in parts for row in block["rows"] if row), step["hint"]]:
            places = re.search(PLACES_OF_BLOCKS[language], text, re.IGNORECASE)
            is_first_one = number == 1  # "your first block" of all
            assert not places or is_first_one, text


# A question, or an instruction for a pupil.
INSTRUCTION_PATTERNS = {
    "en": r"\?|\b(Build|Change|Find|Follow|Guess|Invent|Press|Put|Read|Say|Think|Try|Write)\b",
    "es": r"\?|\b(Arma|Busca|Cambia|Di|Dilo|Escribe|Inventa|Junta|Lee|Piensa|Pon|Prueba|Pruébalo"
    r"|Pulsa|Sigue)\b",
    "pt": r"\?|\b(Ache|Aperte|Diga|Escreva|Invente|Junte|Leia|Monte|Mude|Pense|Ponha|Siga|Teste)\b",
}


@pytest.mark.parametrize("form", [TEXT, BLOCKS])
@pytest.mark.parametrize("language", LANGUAGES)
def test_each_step_has_something_to_do(language: str, form: str) -> None:
    for number in LESSONS:
        for k, step in enumerate(page_lessons.steps(number, language, form)[:-1], 1):
            text = " ".join(
                row[0] for block in step["blocks"] if block["kind"] != "program"
                for row in block["rows"]
            )  # fmt: skip
            assert re.search(INSTRUCTION_PATTERNS[language], text, re.IGNORECASE), (number, k, text)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", LESSONS)
def test_both_forms_have_the_same_programs_and_hints(number: int, language: str) -> None:
    both_forms = [page_lessons.steps(number, language, form) for form in (TEXT, BLOCKS)]
    kinds = [
        [([block for block in step["blocks"] if block["kind"] == "program"], bool(step["hint"]))
         for step in steps]
        for steps in both_forms
    ]  # fmt: skip
    assert kinds[0] == kinds[1]


@pytest.mark.parametrize("language", LANGUAGES)
def test_block_users_get_findings_about_blocks(language: str) -> None:
    """This holds for every sentence and every word; in a terminal, none has back quotes."""
    values = {"cm": "3", "seconds": "1.0", "least": "1", "found": "1", "times": "2", "name": "HOP"}
    rest = dict.fromkeys(("within", "limit", "low", "high", "number", "all", "degrees", "truth"))
    rest |= dict.fromkeys(("different", "pitches", "value", "wanted", "most", "fault"))
    values |= {**dict.fromkeys(rest, "1"), "truth": "TRUE"}
    kit = profile_of("tinibot").kit
    for key in (key for key in texts("lessons", language) if key.startswith("said/")):
        words = ("KEY_UP",) if "obeys" in key else EXAMPLES if "uses" in key else ("UNTIL",)
        for word in words:
            own_values = {"word": word, "question": "DISTANCE < 15", "what": "DISTANCE"}
            finding = Finding("", key.removeprefix("said/"), {**values, **own_values}, {})
            terminal, on_blocks = (sentence(finding, language, form) for form in (TEXT, BLOCKS))
            assert not re.search(r"`|\[\[|\]\]", terminal)
            is_line_on_floor = "follows" in key
            assert text_only_words(on_blocks, language, is_line_on_floor=is_line_on_floor) == [], (
                on_blocks
            )
            spoken_blocks = block_speech.blocks_of(CODE_PATTERN.findall(on_blocks), kit)
            for code in CODE_PATTERN.findall(on_blocks):
                assert is_on_a_block(code, spoken_blocks), (code, on_blocks)


def test_an_alternative_is_shown_in_one_form_only() -> None:
    both_forms = "Write [[a line|a block]] here[[ and there|]], `A`."
    assert sentences_in_form(both_forms, TEXT) == "Write a line here and there, `A`."
    assert sentences_in_form(both_forms, BLOCKS) == "Write a block here, `A`."
