"""Lowering: the shortest instruction at the border of its operand, and jumps that just reach.

The cases show the effects of instructions; `tests/cases/blocks.md` has whole disassemblies.
"""

from __future__ import annotations

import pytest

from tests.support.rows import each_row
from tiniscript import Compilation, compile_text, robots
from tiniscript.base.limits import CODE_BYTES
from tiniscript.bytecode.disassembly import rows

KIT = robots.load("tinibot").kit


def compile_right_text(text: str) -> Compilation:
    compilation = compile_text(text, KIT)
    assert compilation.is_right, [diagnostic.code.number for diagnostic in compilation.diagnostics]
    return compilation


def instructions(text: str) -> list[str]:
    return [row.text for row in rows(compile_right_text(text).code)]


@each_row(
    "text, expected",
    [
        # a disassembly has numbers as they are in the code: whole ones, thousandths, tenths. The
        # tests of what pushes a number are in `tests/text/test_plain.py`. a variable that gets a
        # number, and one that a number is added to
        ("X = -128; SHOW(X)", ["SET_VAR8 v0 -128", "PUSH_VAR_0", "SHOW"]),
        ("X = 100; SHOW(X)", ["PUSH_NUM_100", "SET_VAR_0", "PUSH_VAR_0", "SHOW"]),
        ("X = 128; SHOW(X)", ["PUSH8 128", "SET_VAR_0", "PUSH_VAR_0", "SHOW"]),
        ("X = 1; X = 127 + X", ["PUSH_NUM_1", "SET_VAR_0", "ADD_VAR8 v0 127"]),
        ("X = 1; X = X - 128", ["PUSH_NUM_1", "SET_VAR_0", "ADD_VAR8 v0 -128"]),
        ("X = 1; X = X + 128",
         ["PUSH_NUM_1", "SET_VAR_0", "PUSH_VAR_0", "PUSH8 128", "ADD", "SET_VAR_0"]),
        ("X = 1; X = X - -128",
         ["PUSH_NUM_1", "SET_VAR_0", "PUSH_VAR_0", "PUSH16 -128", "SUB", "SET_VAR_0"]),
        ("X = 1; X = 5 - X",
         ["PUSH_NUM_1", "SET_VAR_0", "PUSH_NUM_5", "PUSH_VAR_0", "SUB", "SET_VAR_0"]),
        ("X = 1; X = X + 1", ["PUSH_NUM_1", "SET_VAR_0", "INC_VAR v0"]),
        ("X = 1; X = X - 1", ["PUSH_NUM_1", "SET_VAR_0", "DEC_VAR v0"]),
        ("X = 11; Y = 12; X = X + Y", ["SET_VAR8 v0 11", "SET_VAR8 v1 12", "ADD_VAR v0 v1"]),
        ("X = 11; Y = 12; X = X - Y; SHOW(Y)",
         ["SET_VAR8 v0 11", "SET_VAR8 v1 12", "PUSH_VAR_0", "PUSH_VAR_1", "SUB", "SET_VAR_0",
          "PUSH_VAR_1", "SHOW"]),
        # variables 0 to 7 have instructions of one byte, the others have not
        ("V=0;V1=0;V2=0;V3=0;V4=0;V5=0;V6=0;V7=0;V8=0;SHOW(V8)",
         [*(word for v in range(8) for word in ("PUSH_NUM_0", f"SET_VAR_{v}")), "SET_VAR8 v8 0",
          "PUSH_VAR v8", "SHOW"]),
        # a move of hundredths of a second, then tenths, then whole seconds
        ("F(1.01, 80)", ["PUSH_MILLI 1010", "PUSH_NUM_80", "MOVE_F"]),
        ("F(66, 80)", ["MOVE8_F 255 80"]),
        ("F(1, 49.5)", ["MOVE8_F 100 50"]),
        ("F(1, 50 + 70)", ["MOVE8_F 100 100"]),
        ("F(0 - 3, 80)", ["MOVE8_F 0 80"]),
        ("W(25)", ["WAIT8 214"]),
        ("M(-100, 100)", ["MOTORS8 -100 100"]),
        ("M(50 - 200, 50 - 200)", ["MOTORS8 -100 -100"]),
        ("F(1, 0)", ["MOVE8_F 100 0"]),
        # a sound with constants, whose frequency has two bytes
        ("BEEP(0.1, 440)", ["BEEP8 10 440"]),
        ("BEEP(0.1, 440.5)", ["BEEP8 10 441"]),
        ("BEEP(11.5, 440)", ["PUSH_TENTHS 115", "PUSH16 440", "BEEP"]),
        # A watched move; UNTIL includes its comparison: 0 to 255 in 8 bits, otherwise in 16.
        ("F(11.5, 80) UNTIL(DISTANCE > 255)",
         ["PUSH_TENTHS 115", "PUSH_NUM_80", "WATCH_F", "PUSH_READ_2", "UNTIL8_GT 255"]),
        ("R(FOREVER, 80) UNTIL(256 >= DISTANCE)",
         ["PUSH_NUM_80", "WATCH_FOREVER_R", "PUSH_READ_2", "UNTIL16_LE 256"]),
        ("W(2) UNTIL(DISTANCE < 9.5)",
         ["PUSH_NUM_2", "WATCH_WAIT", "PUSH_READ_2", "PUSH_TENTHS 95", "LT", "UNTIL"]),
        ("W(FOREVER) UNTIL(LIGHT_L + LIGHT_R = -1)",
         ["WATCH_FOREVER_WAIT", "READ_1", "READ_0", "PUSH_SENSOR_1", "PUSH_SENSOR_0", "ADD",
          "UNTIL16_EQ -1"]),
        ("X = 11; B(FOREVER, X) UNTIL(X > 3 AND DISTANCE <> 4)",
         ["SET_VAR8 v0 11", "PUSH_VAR_0", "WATCH_FOREVER_B", "READ_2", "PUSH_VAR_0", "PUSH_NUM_3",
          "GT", "PUSH_SENSOR_2", "PUSH_NUM_4", "NE", "AND", "UNTIL"]),
        # a counted loop, up to 255 times
        ("LOOP(1); S; END_LOOP", ["LOOP8 1", "STOP", "NEXT -> 0002"]),
        ("LOOP(255); S; END_LOOP", ["LOOP8 255", "STOP", "NEXT -> 0002"]),
        ("LOOP(256); S; END_LOOP", ["PUSH16 256", "LOOP -> 0008", "STOP", "NEXT -> 0005"]),
        # a comparing branch: 0 to 255 in 8 bits, whole numbers in 16
        ("X = 11; IF(X < 255); S; ENDIF", ["SET_VAR8 v0 11", "IF_VAR8_LT v0 255 -> 0008", "STOP"]),
        ("X = 11; IF(X < 256); S; ENDIF", ["SET_VAR8 v0 11", "IF_VAR16_LT v0 256 -> 0009", "STOP"]),
        ("X = 11; IF(X < -1); S; ENDIF", ["SET_VAR8 v0 11", "IF_VAR16_LT v0 -1 -> 0009", "STOP"]),
        ("X = 11; IF(NOT X <= 3); S; ENDIF", ["SET_VAR8 v0 11", "IF_VAR8_GT v0 3 -> 0008", "STOP"]),
        ("X = 11; IF(X < 32768); S; ENDIF",
         ["SET_VAR8 v0 11", "PUSH_VAR_0", "PUSH32 32768000", "LT", "IF -> 000d", "STOP"]),
        # each side of an AND has its own branch, whatever is in it
        ("IF((TIME > 5 OR TIME < 3) AND (TIME > 4 OR TIME < 2)); S; ENDIF",
         ["TIME", "PUSH_NUM_5", "GT", "OR_ELSE -> 0008", "TIME", "PUSH_NUM_3", "LT", "IF -> 0015",
          "TIME", "PUSH_NUM_4", "GT", "OR_ELSE -> 0012", "TIME", "PUSH_NUM_2", "LT", "IF -> 0015",
          "STOP"]),
        # a reading that is used at once
        ("SHOW(1 - DISTANCE)", ["READ_2", "PUSH_NUM_1", "PUSH_SENSOR_2", "SUB", "SHOW"]),
        ("IF(DISTANCE < 9); S; ENDIF", ["PUSH_READ_2", "IF8_LT 9 -> 0005", "STOP"]),
    ],
)  # fmt: skip
def test_the_shortest_instruction_is_chosen(text: str, expected: list[str]) -> None:
    assert instructions(text) == expected


def test_a_reading_before_a_label_is_not_moved() -> None:
    """A jump that comes to the SHOW has not passed the READ: it shows the kept reading."""
    text = "X = TRUE; DISTANCE; IF(X); DISTANCE; ENDIF; SHOW(DISTANCE)"
    assert instructions(text)[-4:] == ["IF -> 0007", "READ_2", "PUSH_SENSOR_2", "SHOW"]


# -- AND and OR -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("right_operand", "has_jump"),
    [
        ("Y > 2", False),
        ("Y > 2 AND Y < 5", True),  # eight terms with its AND_LEFT: a jump costs less
        ("MIN(Y, MAX(1, 3)) < Z", False),
        ("NOT (MIN(Y, 3) < Z)", False),  # six terms
        ("MIN(Y, MAX(Z, 3)) < Z", True),  # seven
        ("Y + 1 > 2", True),  # may overflow
        ("Y / Z > 2", True),
        ("RANDOM(1, 6) > 2", True),  # the next dice would fall otherwise
        ("TIME > 2", True),
    ],
)
def test_the_right_operand_of_and_is_skipped_if_it_matters(
    right_operand: str, has_jump: bool
) -> None:
    text = f"X = TRUE; Y = 1; Z = 2; SHOW(X AND ({right_operand})); SHOW(Y + Z)"
    rows = instructions(text)
    assert any(line.startswith("AND_THEN") for line in rows) == has_jump
    assert ("AND" in rows) != has_jump or right_operand.count("AND") == 1


# -- relaxing branches ----------------------------------------------------------------------------

# A text with a row of one-byte instructions, the most of them with which a jump over them is short,
# and that jump: forward to the byte after the skipped code, backward from just after itself.
JUMPS = [
    ("X = TRUE; IF(X); {} ENDIF", 255, "IF"),
    ("X = TRUE; IF(X); {} ELSE; S; ENDIF", 253, "IF"),  # over the ELSE, too
    ("X = TRUE; IF(X); S; ELSE; {} ENDIF", 255, "ELSE"),
    ("X = TRUE; IF(NOT X); {} ENDIF", 255, "IF_NOT"),
    ("LOOP(3); {} END_LOOP", 253, "NEXT"),
    ("X = 3; LOOP(X); {} END_LOOP", 253, "LOOP"),
    ("LOOP(FOREVER); {} END_LOOP", 253, "AGAIN"),
    ("X = TRUE; WHILE(X); {} END_WHILE", 250, "WHILE"),
    ("X = TRUE; WHILE(X); {} END_WHILE", 252, "IF"),  # the AGAIN after it has become far before
    ("X = TRUE; LOOP(FOREVER); IF(X); BREAK; ENDIF; {} END_LOOP", 252, "BREAK"),
    ("X = TRUE; LOOP(3); IF(X); BREAK; ENDIF; {} END_LOOP", 252, "BREAK_LOOP"),
    ("DEF A; {} END_DEF; A", 252, "CALL"),
    ("DEF A; {} END_DEF; A", 254, "DEF"),
]


@pytest.mark.parametrize(("text", "max_count", "name"), JUMPS)
def test_a_jump_is_short_as_long_as_it_reaches(text: str, max_count: int, name: str) -> None:
    def jump(count: int) -> str:
        rows = instructions(text.format("S;" * count))
        return next(word for word in (line.split()[0] for line in rows)
                    if word in (name, name + "_FAR"))  # fmt: skip

    assert jump(max_count) == name
    assert jump(max_count + 1) == name + "_FAR"


@pytest.mark.parametrize("count", [0, 249, 250, 252, 253, 254, 255, 256, 300, 700])
@each_row("text", sorted({text for text, _, _ in JUMPS}))
def test_jumps_go_to_the_beginning_of_an_instruction(text: str, count: int) -> None:
    """This holds whatever has become longer in between; and each far jump is necessary."""
    code = compile_right_text(text.format("S;" * count)).code
    listed_rows = rows(code)
    starts = {row.offset for row in listed_rows} | {len(code)}
    for row in listed_rows:
        assert row.op is not None
        if "->" in row.text:
            target = int(row.text.rpartition("-> ")[2], 16)
            assert target in starts, row
            distance = abs(target - row.offset - row.op.size)
            assert (distance > 255) == row.op.name.endswith("_FAR"), (row, distance)


@pytest.mark.parametrize(
    ("condition", "short_name", "far_rows"),
    [
        ("X = 5", "IF_VAR8_EQ", ["PUSH_VAR_0", "PUSH_NUM_5", "EQ", "IF_FAR"]),
        ("X <> 300", "IF_VAR16_NE", ["PUSH_VAR_0", "PUSH16 300", "NE", "IF_FAR"]),
        ("DISTANCE < 9", "IF8_LT", ["PUSH_READ_2", "PUSH_NUM_9", "LT", "IF_FAR"]),
        ("LIGHT_R >= 300", "IF16_GE", ["PUSH_SENSOR_0", "PUSH16 300", "GE", "IF_FAR"]),
    ],
)
def test_a_comparing_branch_has_no_far_form(
    condition: str, short_name: str, far_rows: list[str]
) -> None:
    """If its target is too far, it becomes the longer form, with the same reading."""
    text = f"X = 3; LIGHT_R; LIGHT_L; IF({condition}); {{}} ENDIF; SHOW(X)"
    near_rows = instructions(text.format("S;" * 255))
    assert [line for line in near_rows if line.startswith(short_name)]
    code = compile_right_text(text.format("S;" * 256)).code
    row_texts = [row.text for row in rows(code)]
    far_index = next(k for k, line in enumerate(row_texts) if line.startswith("IF_FAR"))
    assert [row_texts[far_index].split()[0], *row_texts[far_index - 3 : far_index]] == [
        far_rows[3],
        *far_rows[:3],
    ]
    assert row_texts[far_index].endswith(
        f"-> {rows(code)[-2].offset:04x}"
    )  # at the PUSH_VAR_0 of SHOW(X)
    assert row_texts.count("READ_0") == near_rows.count("READ_0")


def test_lengthening_one_jump_lengthens_others() -> None:
    """The outermost of nested IFs gets its far form first, which moves the others."""
    opened_text, closed_text = "IF(X);" * 8, "ENDIF;" * 8
    border = 255 - 7 * 3  # seven IFs with their PUSH_VAR lie in the outermost one, 3 bytes each
    for count in range(border - 3, 255 + 3):
        rows = instructions(f"X = TRUE; {opened_text} {'S;' * count} {closed_text}")
        bytes_of = {"IF": 3, "IF_FAR": 4}
        sizes = [bytes_of[line.split()[0]] for line in rows if line.startswith("IF")]
        skipped_bytes = [
            count + sum(sizes[k + 1 :]) for k in range(8)
        ]  # bytes that each IF jumps over
        assert [size == 4 for size in sizes] == [skipped > 255 for skipped in skipped_bytes]


def test_code_beyond_every_machine_is_refused_without_endless_layout() -> None:
    longest_count = compile_text("S;" * CODE_BYTES, KIT)
    assert longest_count.is_right and len(longest_count.code) == CODE_BYTES
    overlong = compile_text("S;" * (CODE_BYTES + 1), KIT)
    assert [diagnostic.code.number for diagnostic in overlong.diagnostics] == ["TS306"]
    assert overlong.diagnostics[0].values["over"] == "1"
    nested_text = "X = TRUE;" + "IF(X);" + "S;" * 3 * CODE_BYTES + "ENDIF"
    assert not compile_text(nested_text, KIT).is_right
