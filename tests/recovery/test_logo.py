"""Logo in one line is rebuilt as a whole: each number with its unit, in each place and language."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import apply_edits
from tiniscript.diagnostics.fixing import edits_of, repair_program

PLACES = (
    "{}", "SI|{}", "SB|W(1);{}", "{};S", "SI|W(1);{};S", "IF(DISTANCE < 9);{};ENDIF",
    "DEF A1;{};END_DEF;A1", "TASK;{};END_TASK",
)  # fmt: skip
# Words for a loop, forward, back, right and left.
LANGUAGES = (
    ("REPEAT", "FD", "BK", "RT", "LT"), ("repeat", "fd", "back", "right", "left"),
    ("REPITE", "AV", "ATRAS", "GD", "GI"), ("repita", "pf", "pt", "pd", "pe"),
)  # fmt: skip
LINES = (
    ("{o} 4 [{f} 30 {r} 90]", "LOOP(4);F(30 CM, {p});R(90 DEG, {p});END_LOOP"),
    ("{o} 2 [{b} 25; {l} 120]", "LOOP(2);B(25 CM, {p});L(120 DEG, {p});END_LOOP"),
    ("{f} 30 {r} 90 {f} 15", "F(30 CM, {p});R(90 DEG, {p});F(15 CM, {p})"),
    (
        "{o} 3 [{o} 4 [{f} 30 {r} 90] {l} 20]",
        "LOOP(3);LOOP(4);F(30 CM, {p});R(90 DEG, {p});END_LOOP;L(20 DEG, {p});END_LOOP",
    ),
)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("line", "right_text"), LINES)
def test_a_line_of_logo_is_converted_as_a_whole(line: str, right_text: str, place: str) -> None:
    for loop, forward, backward, to_right, left in LANGUAGES:
        words = {"o": loop, "f": forward, "b": backward, "r": to_right, "l": left}
        wrong_text = place.format(line.format(**words))
        diagnostics = check(wrong_text)
        edits = [edit for diagnostic in diagnostics for edit in edits_of(diagnostic) or []]
        assert apply_edits(wrong_text, edits) == place.format(right_text.format(p=80)), wrong_text
        assert [diagnostic.values.get("sample") for diagnostic in diagnostics] == ["80 %"], (
            wrong_text
        )
        assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize("place", PLACES)
def test_converted_logo_uses_the_programs_power(place: str) -> None:
    wrong_text = place.format("F(2, 35);REPEAT 4 [FD 30 RT 90]")
    (diagnostic,) = check(wrong_text)
    assert diagnostic.values["fix"] == "LOOP(4);F(30 CM, 35);R(90 DEG, 35);END_LOOP"
    assert "sample" not in diagnostic.values


@pytest.mark.parametrize(
    "text",
    [
        "FD 30",
        "REPEAT 4 [FD 2 RT 1]",
        "REPEAT 4 [FD 30 RT 1]",
        "FD 30 RT 1",
        "FD 2 RT 1",
        "FD 50 50",
    ],
)
def test_possible_seconds_or_a_power_are_not_read_as_logo(text: str) -> None:
    assert not any("CM" in diagnostic.values.get("fix", "") for diagnostic in check(text))


TAUGHT = (("TO SQUARE", "END"), ("para cuadrado", "fin"), ("aprenda quadrado", "fim"))


@pytest.mark.parametrize(("head", "end"), TAUGHT)
@pytest.mark.parametrize(("line", "right_text"), LINES)
def test_a_logo_procedure_becomes_a_def(line: str, right_text: str, head: str, end: str) -> None:
    words = {"o": "repeat", "f": "fd", "b": "bk", "r": "rt", "l": "lt"}
    name = head.split()[1].upper()
    wrong_text = f"{head}\n{line.format(**words)}\n{end}\n{name}"
    edits = [edit for diagnostic in check(wrong_text) for edit in edits_of(diagnostic) or []]
    assert (
        apply_edits(wrong_text, edits) == f"DEF {name}\n{right_text.format(p=80)}\nEND_DEF\n{name}"
    )


@pytest.mark.parametrize(("head", "end"), [("para todo", "fin"), ("para robot", "fin")])
def test_a_logo_procedure_without_a_body_defines_nothing(head: str, end: str) -> None:
    assert not any(
        "DEF" in diagnostic.values.get("fix", "")
        for diagnostic in check(f"F(2, 80)\n{head}\n{end}")
    )
