"""Lowering: the shortest instruction at the border of its operand, and jumps that just reach.

What the instructions do, the cases show; `tests/cases/blocks.md` has whole listings.
"""

from __future__ import annotations

import pytest

from tiniscript import Compiled, compile_text, robots
from tiniscript.bytecode.disassembly import rows
from tiniscript.bytecode.opcodes import CODE_BYTES

KIT = robots.load("tinibot").kit


def compiled(text: str) -> Compiled:
    found = compile_text(text, KIT)
    assert found.is_right, [problem.code.number for problem in found.problems]
    return found


def instructions(text: str) -> list[str]:
    return [row.text for row in rows(compiled(text).code)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # a listing has numbers as they are in the code: whole ones, thousandths, tenths of
        # a second.
        # A pushed number: 8 bits, 16 bits, thousandths in 16 bits, thousandths in 32 bits
        ("SHOW(127)", ["PUSH8 127", "SHOW"]),
        ("SHOW(128)", ["PUSH16 128", "SHOW"]),
        ("SHOW(-128)", ["PUSH8 -128", "SHOW"]),
        ("SHOW(-129)", ["PUSH16 -129", "SHOW"]),
        ("SHOW(32767)", ["PUSH16 32767", "SHOW"]),
        ("SHOW(32768)", ["PUSH32 32768000", "SHOW"]),
        ("SHOW(-32768)", ["PUSH16 -32768", "SHOW"]),
        ("SHOW(-32769)", ["PUSH32 -32769000", "SHOW"]),
        ("SHOW(32.767)", ["PUSH_MILLI 32767", "SHOW"]),
        ("SHOW(32.768)", ["PUSH32 32768", "SHOW"]),
        ("SHOW(-32.768)", ["PUSH_MILLI -32768", "SHOW"]),
        ("SHOW(-32.769)", ["PUSH32 -32769", "SHOW"]),
        # a variable that gets a number, and one that a number is added to
        ("X = -128; SHOW(X)", ["SET_VAR8 v0 -128", "PUSH_VAR v0", "SHOW"]),
        ("X = 128; SHOW(X)", ["PUSH16 128", "SET_VAR v0", "PUSH_VAR v0", "SHOW"]),
        ("X = 0.5; SHOW(X)", ["PUSH_MILLI 500", "SET_VAR v0", "PUSH_VAR v0", "SHOW"]),
        ("X = 1; X = X + 127", ["SET_VAR8 v0 1", "ADD_VAR8 v0 127"]),
        ("X = 1; X = 127 + X", ["SET_VAR8 v0 1", "ADD_VAR8 v0 127"]),
        ("X = 1; X = X - 128", ["SET_VAR8 v0 1", "ADD_VAR8 v0 -128"]),
        ("X = 1; X = X + 128",
         ["SET_VAR8 v0 1", "PUSH_VAR v0", "PUSH16 128", "ADD", "SET_VAR v0"]),
        ("X = 1; X = X - -128",
         ["SET_VAR8 v0 1", "PUSH_VAR v0", "PUSH8 -128", "SUB", "SET_VAR v0"]),
        ("X = 1; X = 5 - X", ["SET_VAR8 v0 1", "PUSH8 5", "PUSH_VAR v0", "SUB", "SET_VAR v0"]),
        ("X = 1; Y = 2; X = X + Y", ["SET_VAR8 v0 1", "SET_VAR8 v1 2", "ADD_VAR v0 v1"]),
        ("X = 1; Y = 2; X = Y + X", ["SET_VAR8 v0 1", "SET_VAR8 v1 2", "ADD_VAR v0 v1"]),
        ("X = 1; Y = 2; X = X - Y; SHOW(Y)",
         ["SET_VAR8 v0 1", "SET_VAR8 v1 2", "PUSH_VAR v0", "PUSH_VAR v1", "SUB", "SET_VAR v0",
          "PUSH_VAR v1", "SHOW"]),
        # a move of tenths of a second, up to 25.5 s
        ("F(25.5, 80)", ["MOVE8_F 255 80"]),
        ("F(25.6, 80)", ["PUSH_MILLI 25600", "PUSH8 80", "MOVE_F"]),
        ("F(0.15, 80)", ["PUSH_MILLI 150", "PUSH8 80", "MOVE_F"]),
        ("F(1, 49.5)", ["MOVE8_F 10 50"]),
        ("F(1, 50 + 70)", ["MOVE8_F 10 100"]),
        ("F(0 - 3, 80)", ["MOVE8_F 0 80"]),
        ("W(25.5)", ["WAIT8 255"]),
        ("W(25.6)", ["PUSH_MILLI 25600", "WAIT"]),
        ("X = 5; F(1, X)", ["SET_VAR8 v0 5", "PUSH8 1", "PUSH_VAR v0", "MOVE_F"]),
        ("M(-100, 100)", ["MOTORS8 -100 100"]),
        ("M(50 - 200, 1)", ["MOTORS8 -100 1"]),
        # a counted loop, up to 255 times
        ("LOOP(255); S; END_LOOP", ["LOOP8 255", "STOP", "NEXT -> 0002"]),
        ("LOOP(254.5); S; END_LOOP", ["LOOP8 255", "STOP", "NEXT -> 0002"]),
        ("LOOP(256); S; END_LOOP", ["PUSH16 256", "LOOP -> 0008", "STOP", "NEXT -> 0005"]),
        # a comparing branch: 0 to 255 in 8 bits, whole numbers in 16
        ("X = 1; IF(X < 255); S; ENDIF", ["SET_VAR8 v0 1", "IF_VAR8_LT v0 255 -> 0008", "STOP"]),
        ("X = 1; IF(X < 256); S; ENDIF", ["SET_VAR8 v0 1", "IF_VAR16_LT v0 256 -> 0009", "STOP"]),
        ("X = 1; IF(X < -1); S; ENDIF", ["SET_VAR8 v0 1", "IF_VAR16_LT v0 -1 -> 0009", "STOP"]),
        ("X = 1; IF(255 < X); S; ENDIF", ["SET_VAR8 v0 1", "IF_VAR8_GT v0 255 -> 0008", "STOP"]),
        ("X = 1; IF(NOT X <= 3); S; ENDIF", ["SET_VAR8 v0 1", "IF_VAR8_GT v0 3 -> 0008", "STOP"]),
        ("X = 1; IF(X < 32768); S; ENDIF",
         ["SET_VAR8 v0 1", "PUSH_VAR v0", "PUSH32 32768000", "LT", "IF -> 000e", "STOP"]),
        ("X = 1; IF(X < 0.5); S; ENDIF",
         ["SET_VAR8 v0 1", "PUSH_VAR v0", "PUSH_MILLI 500", "LT", "IF -> 000c", "STOP"]),
        # a reading that is used at once
        ("SHOW(DISTANCE)", ["PUSH_READ s2", "SHOW"]),
        ("DISTANCE; SHOW(DISTANCE)", ["PUSH_READ s2", "SHOW"]),
        ("SHOW(DISTANCE + DISTANCE)", ["PUSH_READ s2", "PUSH_SENSOR s2", "ADD", "SHOW"]),
        ("SHOW(1 - DISTANCE)", ["READ s2", "PUSH8 1", "PUSH_SENSOR s2", "SUB", "SHOW"]),
        ("IF(DISTANCE < 9); S; ENDIF", ["IF_READ8_LT s2 9 -> 0005", "STOP"]),
        ("DISTANCE; IF(LIGHT_R < 9); SHOW(DISTANCE); ENDIF",
         ["READ s2", "IF_READ8_LT s0 9 -> 0009", "PUSH_SENSOR s2", "SHOW"]),
    ],
)  # fmt: skip
def test_the_shortest_instruction(text: str, expected: list[str]) -> None:
    assert instructions(text) == expected


def test_a_reading_before_a_label_stays_where_it_is() -> None:
    """A jump that comes to the SHOW has not passed the READ: it shows the kept reading."""
    text = "X = TRUE; DISTANCE; IF(X); DISTANCE; ENDIF; SHOW(DISTANCE)"
    assert instructions(text)[-4:] == ["IF -> 000b", "READ s2", "PUSH_SENSOR s2", "SHOW"]


# -- AND and OR -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("right", "has_jump"),
    [
        ("Y > 2", False),
        ("Y > 2 AND Y < 5", True),  # eight terms with its AND_LEFT: a jump costs less
        ("MIN(Y, MAX(1, 3)) < Z", False),
        ("Y + 1 > 2", True),  # may overflow
        ("Y / Z > 2", True),
        ("RANDOM(1, 6) > 2", True),  # the next dice would fall otherwise
        ("TIME > 2", True),
    ],
)
def test_the_right_side_of_an_and_is_skipped_where_it_matters(right: str, has_jump: bool) -> None:
    text = f"X = TRUE; Y = 1; Z = 2; SHOW(X AND ({right})); SHOW(Y + Z)"
    found = instructions(text)
    assert any(each.startswith("AND_THEN") for each in found) == has_jump
    assert ("AND" in found) != has_jump or right.count("AND") == 1


# -- relaxing branches ----------------------------------------------------------------------------

# A text with a row of one-byte instructions, the most of them with which a jump over them is short,
# and that jump: forward to the byte behind what it skips, backward from behind itself.
JUMPS = [
    ("X = TRUE; IF(X); {} ENDIF", 255, "IF"),
    ("X = TRUE; IF(X); {} ELSE; S; ENDIF", 253, "IF"),  # over the ELSE as well
    ("X = TRUE; IF(X); S; ELSE; {} ENDIF", 255, "ELSE"),
    ("X = TRUE; IF(NOT X); {} ENDIF", 255, "IF_NOT"),
    ("LOOP(3); {} END_LOOP", 253, "NEXT"),
    ("X = 3; LOOP(X); {} END_LOOP", 253, "LOOP"),
    ("LOOP(FOREVER); {} END_LOOP", 253, "AGAIN"),
    ("X = TRUE; WHILE(X); {} END_WHILE", 249, "WHILE"),
    ("X = TRUE; WHILE(X); {} END_WHILE", 252, "IF"),  # the AGAIN behind it has become far before
    ("X = TRUE; LOOP(FOREVER); IF(X); BREAK; ENDIF; {} END_LOOP", 252, "BREAK"),
    ("X = TRUE; LOOP(3); IF(X); BREAK; ENDIF; {} END_LOOP", 252, "BREAK_LOOP"),
    ("DEF A; {} END_DEF; A", 252, "CALL"),
    ("DEF A; {} END_DEF; A", 254, "DEF"),
]


@pytest.mark.parametrize(("text", "most", "name"), JUMPS)
def test_a_jump_is_short_as_long_as_it_reaches(text: str, most: int, name: str) -> None:
    def jump(count: int) -> str:
        found = instructions(text.format("S;" * count))
        return next(word for word in (each.split()[0] for each in found)
                    if word in (name, name + "_FAR"))  # fmt: skip

    assert jump(most) == name
    assert jump(most + 1) == name + "_FAR"


@pytest.mark.parametrize("count", [0, 249, 250, 252, 253, 254, 255, 256, 300, 5000])
@pytest.mark.parametrize("text", sorted({text for text, _, _ in JUMPS}))
def test_jumps_go_to_the_beginning_of_an_instruction(text: str, count: int) -> None:
    """Whatever has become longer in between; and each far jump is one that had to be."""
    code = compiled(text.format("S;" * count)).code
    listed = rows(code)
    starts = {row.offset for row in listed} | {len(code)}
    for row in listed:
        assert row.op is not None
        if "->" in row.text:
            target = int(row.text.rpartition("-> ")[2], 16)
            assert target in starts, row
            distance = abs(target - row.offset - row.op.size)
            assert (distance > 255) == row.op.name.endswith("_FAR"), (row, distance)


@pytest.mark.parametrize(
    ("condition", "short", "far"),
    [
        ("X = 5", "IF_VAR8_EQ", ["PUSH_VAR v0", "PUSH8 5", "EQ", "IF_FAR"]),
        ("X <> 300", "IF_VAR16_NE", ["PUSH_VAR v0", "PUSH16 300", "NE", "IF_FAR"]),
        ("DISTANCE < 9", "IF_READ8_LT", ["PUSH_READ s2", "PUSH8 9", "LT", "IF_FAR"]),
        ("LIGHT_R >= 300", "IF_SENSOR16_GE", ["PUSH_SENSOR s0", "PUSH16 300", "GE", "IF_FAR"]),
    ],
)
def test_a_comparing_branch_has_no_far_form(condition: str, short: str, far: list[str]) -> None:
    """Where it does not reach it becomes what it stands for, and takes the same reading."""
    text = f"X = 3; LIGHT_R; LIGHT_L; IF({condition}); {{}} ENDIF; SHOW(X)"
    near = instructions(text.format("S;" * 255))
    assert [each for each in near if each.startswith(short)]
    code = compiled(text.format("S;" * 256)).code
    found = [row.text for row in rows(code)]
    at = next(k for k, each in enumerate(found) if each.startswith("IF_FAR"))
    assert [found[at].split()[0], *found[at - 3 : at]] == [far[3], *far[:3]]
    assert found[at].endswith(f"-> {rows(code)[-2].offset:04x}")  # to PUSH_VAR v0 of SHOW(X)
    assert found.count("READ s0") == near.count("READ s0")


def test_one_jump_that_gets_longer_makes_others_longer() -> None:
    """Of nested IFs the outermost gets its far form first, and each that does moves the others."""
    opened, closed = "IF(X);" * 8, "ENDIF;" * 8
    border = 255 - 7 * 4  # seven IFs with their PUSH_VAR lie in the outermost one, 4 bytes each
    for count in range(border - 3, 255 + 3):
        found = instructions(f"X = TRUE; {opened} {'S;' * count} {closed}")
        bytes_of = {"IF": 4, "IF_FAR": 5}
        sizes = [bytes_of[each.split()[0]] for each in found if each.startswith("IF")]
        over = [count + sum(sizes[k + 1 :]) for k in range(8)]  # what each IF jumps over
        assert [size == 5 for size in sizes] == [skipped > 255 for skipped in over]


def test_code_that_no_machine_takes_is_refused_and_not_laid_out_for_ever() -> None:
    most = compile_text("S;" * CODE_BYTES, KIT)
    assert most.is_right and len(most.code) == CODE_BYTES
    over = compile_text("S;" * (CODE_BYTES + 1), KIT)
    assert [problem.code.number for problem in over.problems] == ["TS306"]
    assert over.problems[0].values["over"] == "1"
    nested = "X = TRUE;" + "IF(X);" + "S;" * 3 * CODE_BYTES + "ENDIF"
    assert not compile_text(nested, KIT).is_right
