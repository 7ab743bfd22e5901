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
@pytest.mark.parametrize(("line", "right"), LINES)
def test_a_line_of_logo_is_rebuilt_as_a_whole(line: str, right: str, place: str) -> None:
    for loop, forward, back, to_right, left in LANGUAGES:
        words = {"o": loop, "f": forward, "b": back, "r": to_right, "l": left}
        wrong = place.format(line.format(**words))
        told = check(wrong)
        edits = [edit for each in told for edit in edits_of(each) or []]
        assert apply_edits(wrong, edits) == place.format(right.format(p=80)), wrong
        assert [each.values.get("sample") for each in told] == ["80 %"], wrong
        assert repair_program(wrong, check).text == wrong


@pytest.mark.parametrize("place", PLACES)
def test_the_power_is_the_one_of_the_program(place: str) -> None:
    wrong = place.format("F(2, 35);REPEAT 4 [FD 30 RT 90]")
    (told,) = check(wrong)
    assert told.values["fix"] == "LOOP(4);F(30 CM, 35);R(90 DEG, 35);END_LOOP"
    assert "sample" not in told.values


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
def test_what_may_be_seconds_or_a_power_is_no_logo(text: str) -> None:
    assert not any("CM" in each.values.get("fix", "") for each in check(text))
