"""A percentage of a sensor: both possible numbers are shown, and neither is applied."""

from __future__ import annotations

import pytest

from tests.pupils.corpus import check
from tiniscript.base.source import Source
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.diagnostics.rendering import message

PLACES = (
    "IF({});S;ENDIF", "F(FOREVER, 60) UNTIL({})", "WHEN({});S;END_WHEN",
    "SI|W(1);WHILE({});F(1, 50);END_WHILE;S", "IF(DISTANCE < 9);S;ELSEIF({});W(1);ENDIF",
)  # fmt: skip


@pytest.mark.parametrize("percent", ["%", " %", " percent", " por ciento", " PORCIENTO"])
@pytest.mark.parametrize(
    ("comparison_text", "share"),
    [("LIGHT_L > 80", "LIGHT_L > 818"), ("DISTANCE < 50", "DISTANCE < 200")],
)
def test_a_percentage_of_a_sensor_is_converted_to_its_range(
    comparison_text: str, share: str, percent: str
) -> None:
    for place in PLACES:
        wrong_text = place.replace("{}", comparison_text + percent)
        (diagnostic,) = check(wrong_text)
        tried_text = message(diagnostic, Source(wrong_text), "en").fix
        assert f"write {share};" in tried_text and tried_text.endswith(
            f"write {comparison_text}"
        ), place
        assert repair_program(wrong_text, check).text == wrong_text


@pytest.mark.parametrize("right_text", ["IF(LIGHT_L > 80 % 7)", "IF(LIGHT_L % 2 = 0)"])
def test_a_remainder_is_not_a_percentage(right_text: str) -> None:
    assert not check(f"{right_text};S;ENDIF")
