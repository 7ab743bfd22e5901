"""Nobody who works with blocks is told of a line, which is nowhere on the screen."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.node import in_node, page_data
from tests.support.texts import LANGUAGES
from tiniscript.base.languages import texts

__all__ = ["page_data"]  # a fixture
SOURCES = Path(__file__).parents[2] / "tools" / "studio" / "src"
SCRIPT = Path(__file__).with_name("places_named_in_node.mjs")
# Texts that name the line of something else than a program: of a saved run's file.
OF_FILES = {"record_unreadable", "record_cut"}
PROGRAMS = 300


def keys_of_lines() -> set[str]:
    return {
        key for key, value in texts("studio", "en").items() if "{line}" in str(value)
    } - OF_FILES


def partner_of(key: str) -> str:
    return {"shown_line": "shown_block", "repair_line": "repair_block"}.get(
        key, f"{key.removesuffix('_at') if key == 'looked_back_at' else key}_block"
    )


def test_each_sentence_about_a_line_has_one_about_a_block() -> None:
    keys = keys_of_lines()
    assert len(keys) > 5
    for key in keys - {"line"}:  # `line` is a place alone, whose partner is what the block says
        for language in LANGUAGES:
            assert "{line}" not in str(texts("studio", language)[partner_of(key)]), key


@pytest.mark.parametrize("key", sorted(keys_of_lines()))
def test_no_sentence_about_a_line_is_said_without_a_choice(key: str) -> None:
    """Where a source says it, it also says the one about a block, or asks who is told."""
    for path in SOURCES.rglob("*.js"):
        lines = path.read_text(encoding="utf-8").splitlines()
        for number, line in enumerate(lines):
            if re.search(rf"text\('{key}'|\('{key}',", line):
                nearby_lines = "\n".join(lines[max(0, number - 1) : number + 1])
                assert partner_of(key) in nearby_lines or "areBlocksNamed.value" in nearby_lines, (
                    path.name,
                    line,
                )


def test_a_place_has_a_name_without_a_line(page_data: Path) -> None:
    """Whatever is there, and whatever the text has become since."""
    (line,) = in_node(SCRIPT, str(page_data), str(PROGRAMS))
    assert int(line) > PROGRAMS
