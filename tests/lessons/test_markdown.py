"""Pages of lessons on a terminal, which may come from strangers."""

from __future__ import annotations

import pytest

from tiniscript.lessons.markdown import as_text, blocks


@pytest.mark.parametrize("table", ["|---|", "|---|\n", "|", "||", "|:-:|-|\n|---|", "| |"])
def test_a_table_without_rows_renders_nothing(table: str) -> None:
    assert blocks(table) == []
    assert as_text(f"# One\n\n{table}\n\ntwo") == "One\n===\n\ntwo\n"


def test_a_page_contains_no_cursor_sequences() -> None:
    """In a heading, a list, a table, a program or a paragraph."""
    evil = "a\x1b[2J\x07\x9b2Jb\u202ec"
    page = (
        f"# {evil}\r\n\r\n- {evil}\n\n| {evil} |\n|---|\n\n"
        f"```\n{evil}\n\tF(1, 80)\n```\n\n1. {evil}\v{evil}"
    )
    text = as_text(page)
    assert all(letter == "\n" or letter.isprintable() for letter in text)
    assert text.count("a?[2J??2Jb?c") == 6 and "        F(1, 80)" in text
