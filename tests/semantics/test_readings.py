"""The reading that a sensor's name means: where the checker puts readings, and which are kept.

A reading is kept when it is `surely read`, on every path of the program. In the text of the IR
`Read 2` takes a reading of DISTANCE and `s2` is the reading that was taken last.
"""

from __future__ import annotations

from tests.support.ir_text import program_text
from tests.support.rows import each_row
from tiniscript import check_text, robots

KIT = robots.load("tinibot").kit
LIGHT_R, LIGHT_L, DISTANCE = range(3)  # their numbers in this kit


def meaning(text: str) -> list[str]:
    """Return the checked program, not optimised, a line for each statement, without SI."""
    compilation = check_text(text, KIT)
    assert compilation.is_right and compilation.program is not None, compilation.diagnostics
    return [line.strip() for line in program_text(compilation.program).splitlines()[1:]]


def reads_before_show(text: str) -> bool:
    """Return whether a program's last SHOW(DISTANCE) takes its own reading."""
    lines = meaning(text)
    assert lines[-1] == "Show s2"
    assert lines[-2] in ("Read 2", "Stop")
    return lines[-2] == "Read 2"


def test_a_sensor_is_read_once_before_its_instruction() -> None:
    assert meaning("SHOW(DISTANCE + LIGHT_L * DISTANCE)") == [
        "Read 2", "Read 1", "Show s2 s1 s2 MUL ADD",
    ]  # fmt: skip
    assert meaning("M(LIGHT_R, LIGHT_L + LIGHT_R)") == ["Read 0", "Read 1", "Motors s0 s1 s0 ADD"]


def test_readings_of_an_instruction_are_not_kept_for_the_next() -> None:
    assert meaning("SHOW(DISTANCE);SHOW(DISTANCE)") == ["Read 2", "Show s2"] * 2
    assert reads_before_show("X = DISTANCE;S;SHOW(DISTANCE)")


@each_row(
    "text_before",
    [
        "DISTANCE;W(1);S;X = 5;F(1, 80)",
        "IF(TIME > 1);DISTANCE;ELSE;DISTANCE;ENDIF",
        "IF(TIME > 1);DISTANCE;ELSEIF(TIME > 2);DISTANCE;ELSE;S;DISTANCE;ENDIF",
        "DISTANCE;IF(TIME > 1);S;ENDIF",
        "DISTANCE;LOOP(3);S;END_LOOP",
        "DISTANCE;WHILE(TIME < 3);W(1);END_WHILE",
        "DEF LOOK;DISTANCE;END_DEF;LOOK",
        "DEF LOOK;DISTANCE;END_DEF;DEF BOTH;LOOK;LIGHT_L;END_DEF;BOTH",
        "DEF LOOK;IF(TIME > 1);DISTANCE;ELSE;DISTANCE;ENDIF;END_DEF;LOOK",
        "DISTANCE;F(1, 80) UNTIL(DISTANCE < 5)",
    ],
)
def test_definitely_read_values_are_kept(text_before: str) -> None:
    assert not reads_before_show(f"{text_before};S;SHOW(DISTANCE)")


@each_row(
    "text_before",
    [
        "IF(TIME > 1);DISTANCE;ENDIF",
        "IF(TIME > 1);S;ELSE;DISTANCE;ENDIF",
        "IF(TIME > 1);DISTANCE;ELSEIF(TIME > 2);S;ELSE;DISTANCE;ENDIF",
        "IF(TIME > 1);DISTANCE;ELSEIF(TIME > 2);DISTANCE;ENDIF",
        "IF(DISTANCE > 1);S;ENDIF",
        "LOOP(3);DISTANCE;END_LOOP",
        "WHILE(TIME < 3);DISTANCE;END_WHILE",
        "F(1, 80) UNTIL(DISTANCE < 5)",
        "DEF LOOK;DISTANCE;END_DEF",
        "DEF LOOK;IF(TIME > 1);DISTANCE;ENDIF;END_DEF;LOOK",
        "DEF LOOK;DISTANCE;END_DEF;IF(TIME > 1);LOOK;ENDIF",
    ],
)
def test_values_not_read_on_every_branch_are_not_kept(text_before: str) -> None:
    assert reads_before_show(f"{text_before};S;SHOW(DISTANCE)")


@each_row(
    "text, reads",
    [
        ("DISTANCE;IF(TIME > 1);SHOW(DISTANCE);ENDIF", False),
        ("DISTANCE;IF(TIME > 1);S;ELSE;SHOW(DISTANCE);ENDIF", False),
        ("IF(TIME > 1);DISTANCE;ELSE;SHOW(DISTANCE);ENDIF", True),
        ("IF(DISTANCE > 1);SHOW(DISTANCE);ENDIF", True),
        # A body may run again, when earlier readings are old.
        ("DISTANCE;LOOP(2);SHOW(DISTANCE);END_LOOP", True),
        ("DISTANCE;WHILE(TIME < 3);SHOW(DISTANCE);END_WHILE", True),
        ("LOOP(2);DISTANCE;S;SHOW(DISTANCE);END_LOOP", False),
        # a DEF does not know from where it is called
        ("DISTANCE;DEF A;SHOW(DISTANCE);END_DEF;A", True),
    ],
)
def test_a_block_begins_with_the_known_readings(text: str, reads: bool) -> None:
    lines = meaning(text)
    assert (lines[lines.index("Show s2") - 1] == "Read 2") == reads


def test_a_check_takes_its_own_readings() -> None:
    assert meaning("DISTANCE;F(1, 80) UNTIL(DISTANCE + LIGHT_R < 5)") == [
        "Read 2", "Move F 1 80", f"until ({DISTANCE}, {LIGHT_R}) s2 s0 ADD 5 LT",
    ]  # fmt: skip
    assert meaning("DISTANCE;WHILE(DISTANCE > 5);S;END_WHILE") == [
        "Read 2", f"While ({DISTANCE},) s2 5 GT", "Stop",
    ]  # fmt: skip


def test_a_branch_reads_only_values_not_read_by_earlier_ones() -> None:
    text = "LIGHT_L;IF(DISTANCE < 1);S;ELSEIF(LIGHT_R + DISTANCE < 2);S;ELSEIF(LIGHT_L < 3);S;ENDIF"
    assert meaning(text) == [
        "Read 1", "Read 2", "If", "arm () s2 1 LT", "Stop",
        f"arm ({LIGHT_R},) s0 s2 ADD 2 LT", "Stop", "arm () s1 3 LT", "Stop", "else",
    ]  # fmt: skip
