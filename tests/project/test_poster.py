"""The poster has every word, in both languages, as a drawing and as a PDF that viewers can read."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest

from tests.support.casefile import ROOT
from tests.support.rows import each_row
from tiniscript import check_text, robots
from tiniscript.base.languages import translated_languages
from tiniscript.base.words import WORDS
from tools.generate import paper, poster
from tools.generate.paper import MONO_FONT, Line

in_both = each_row("language", translated_languages("documents", "poster/title"))


def lines_of(language: str) -> list[Line]:
    return [line for line in poster.page(language) if isinstance(line, Line)]


@in_both
def test_every_word_of_the_table_is_on_it(language: str) -> None:
    shown_text = " ".join(line.text for line in lines_of(language) if line.font == MONO_FONT)
    for word in WORDS.values():
        is_there = re.search(rf"(?<!\w){word.text}(?!\w)", shown_text) is not None
        assert is_there == word.role.is_offered, word.text


def test_a_missing_word_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(poster, "GROUPS", poster.GROUPS[1:])
    with pytest.raises(AssertionError, match="the poster lacks"):
        poster.page("en")


def test_lines_on_the_poster_can_be_typed() -> None:
    kit = robots.load("tinibot").kit
    for line in lines_of("en"):
        if line.font != MONO_FONT or not line.text[0].isalpha() or "..." in line.text:
            continue
        for code in line.text.split("   "):
            if "(" in code and not re.search(r"\bA\b|ELSEIF", code) and "RANDOM" not in code:
                taught_text = "DEF SIDE(SIZE);F(SIZE CM, 60);END_DEF;" if code == "SIDE(30)" else ""
                compilation = check_text(taught_text + code, kit)
                assert compilation.is_right, (code, compilation.diagnostics)


@in_both
def test_the_drawing_is_complete(language: str) -> None:
    path = ROOT / "docs" / "poster" / f"poster.{language}.svg"
    tree = ElementTree.fromstring(path.read_text("utf-8"))
    texts = [element.text for element in tree.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == [line.text for line in lines_of(language)]


@in_both
def test_the_pdf_is_complete(language: str) -> None:
    """Each object is where the table at its end says, and no part leaves the page."""
    data = (ROOT / "docs" / "poster" / f"poster.{language}.pdf").read_bytes()
    assert data.startswith(b"%PDF-1.4\n") and data.endswith(b"%%EOF\n")
    start = int(data.rsplit(b"startxref\n", 1)[1].split(b"\n")[0])
    assert data[start:].startswith(b"xref\n")
    offsets = [int(row[:10]) for row in data[start:].split(b"\n")[3:] if row.endswith(b" n ")]
    for number, offset in enumerate(offsets, 1):
        assert data[offset:].startswith(b"%d 0 obj\n" % number)
    length = int(re.search(rb"/Length (\d+)", data)[1])  # type: ignore[index]
    stream_start = data.index(b"stream\n") + 7
    assert data[stream_start + length :].startswith(b"\nendstream")
    expected_texts = [paper._pdf_text(line.text) for line in lines_of(language)]
    assert (
        re.findall(r"(\(.*\)) Tj ET", data[stream_start : stream_start + length].decode())
        == expected_texts
    )


@in_both
def test_no_texts_overlap(language: str) -> None:
    for line in lines_of(language):
        letter = {MONO_FONT: 0.6}.get(line.font, 0.52) * line.size
        end = line.x + letter * len(line.text)
        assert end <= (poster.SENTENCE_X if line.font == MONO_FONT else paper.WIDTH), line.text


def test_the_poster_names_user_words_in_its_language() -> None:
    """A reader of Spanish does not use STEP and SPEED."""
    spanish = " ".join(line.text for line in lines_of("es"))
    assert re.search(r"DEF PASO .* VELOCIDAD = 50", spanish)
    assert not re.search(r"\b(STEP|SPEED)\b", spanish)
