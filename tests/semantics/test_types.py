"""The checker's offers for values of the wrong type, and their range."""

from __future__ import annotations

import pytest

from tiniscript import check_text, robots
from tiniscript.diagnostics.codes import MAX_DIAGNOSTICS

KIT = robots.load("tinibot").kit


def list_offers(text: str) -> list[object]:
    """Return the offer for each mistake."""
    return [diagnostic.values.get("fix") for diagnostic in check_text(text, KIT).diagnostics]


@pytest.mark.parametrize(("length", "fix"), [(78, "X = 6"), (80, "X = 6"), (81, None), (82, None)])
def test_a_shortened_condition_is_completed_for_the_second_number(length: int, fix: object) -> None:
    digits = "1" if length % 2 else "11"
    left_side = "X = " + "1+" * ((length - 5) // 2) + digits
    assert len(left_side) == length
    assert list_offers(f"X = 1; IF({left_side} OR 6); S; ENDIF") == [fix]


def test_the_position_of_a_condition_does_not_matter() -> None:
    assert list_offers("X = 1;" + "S;" * 50 + "IF(X = 5 OR 6); S; ENDIF") == ["X = 6"]


def test_an_ambiguous_sensor_name_lists_the_sensors() -> None:
    diagnostics = check_text(";".join(["SHOW(LIGHT)"] * (MAX_DIAGNOSTICS + 3)), KIT).diagnostics
    assert len(diagnostics) == MAX_DIAGNOSTICS + 1
    assert (
        diagnostics[0].values["first"] == "LIGHT_R" and diagnostics[0].values["second"] == "LIGHT_L"
    )
    assert ["first" in diagnostic.values for diagnostic in diagnostics] == [
        True
    ] * MAX_DIAGNOSTICS + [False]
