"""Pupils' names hide no characters, and names that a teacher cannot distinguish are equal."""

from __future__ import annotations

import unicodedata

import pytest

from tiniscript.studio import names
from tiniscript.studio.names import are_alike, free_name, plain_name


@pytest.mark.parametrize(
    ("name", "other_name"),
    [("José", "José"), ("Ana", "Аnа"), ("Ana", "Αna"), ("Ana", "𝐀𝐧𝐚"), ("Ana", "Ａｎａ"),
     ("Ana", "ana"), ("Luis", "LUIS"), ("Luis", "Iuis"), ("Inés", "1nés"), ("mia", "rnia"),
     ("Ola", "0la"), ("Ana", "A\ufe00na"), ("Ana", "An\u034fa"), ("Ana (2)", "Ana (２)"),
     ("O’Neil", "O'Neil"), ("Ana-Luz", "Ana‑Luz"), ("Maße", "MASSE")],
)  # fmt: skip
def test_names_that_look_alike_are_one_name(name: str, other_name: str) -> None:
    assert are_alike(name, other_name) and are_alike(other_name, name)


@pytest.mark.parametrize(
    ("name", "other_name"),
    [("Ana", "Anna"), ("José", "Jose"), ("Ana", "Ana 2"), ("Núria", "Nuria"), ("Luz", "Lua"),
     ("张伟", "王伟"), ("Ана", "Яна"), ("p1", "p2"), ("🤖", "🐈")],
)  # fmt: skip
def test_dissimilar_names_are_different(name: str, other_name: str) -> None:
    assert not are_alike(name, other_name)


@pytest.mark.parametrize(
    "blank", ["\u3164", "\u115f", "\u1160", "\uffa0", "\u2800", "\u00a0", "\u200b", "\u2066",
              "\u0301", "\ufe0f", "\U000e0020", "\U0001d159"]
)  # fmt: skip
def test_invisible_characters_are_not_a_name_nor_part_of_one(blank: str) -> None:
    assert plain_name(blank * 3) == plain_name(f" {blank} {blank}") == ""
    assert plain_name(f"Ana{blank}") != ""
    shown_text = plain_name(f"Ana{blank}").rstrip("?")  # a control character is replaced
    assert are_alike(unicodedata.normalize("NFD", shown_text).rstrip("\u0301"), "Ana")


def test_a_duplicate_name_gets_a_number() -> None:
    assert free_name("Ana", []) == "Ana"
    assert free_name("Ana", ["Luz", "Аna", "ANA (2)"]) == "Ana (3)"
    used_names: list[str] = []
    for k in range(5):
        used_names.append(free_name("ana" if k % 2 else "Ana", used_names))
    assert used_names == ["Ana", "ana (2)", "Ana (3)", "ana (4)", "Ana (5)"]


def test_the_table_matches_unicode() -> None:
    """Each row's sign folds to its look-alike, and the look-alike to itself."""
    table = names._table()
    assert len(table) > 2500
    for sign, folded_sign in table.items():
        assert names._case_folded(chr(sign)) == names._case_folded(folded_sign), hex(sign)
