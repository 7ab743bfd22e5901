"""Tests of the oracle itself: the language reference's examples and its subtle rules."""

from __future__ import annotations

import random

import pytest

from tests.oracle import interpreter
from tests.oracle.interpreter import PAPER_KIT, Kit, Mistake, run
from tests.oracle.programs import WIDE_KIT, broken, program, senses
from tests.oracle.tree import Do, If, Loop, While


def lines(text: str, *, kit: Kit = WIDE_KIT, **options: object) -> list[str]:
    """The trace, line by line."""
    return run(text, kit, **options).splitlines()  # type: ignore[arg-type]


def shown(expression: str, before: str = "") -> str:
    """What SHOW prints for an expression, or the fault."""
    return lines(f"{before};SHOW({expression})")[-2].split()[2]


def ending(text: str) -> str:
    """The last line without its time."""
    return lines(text)[-1].split(" ", 1)[1]


def tower(in_def: int, around: int) -> str:
    """A program with so many blocks in a DEF and so many around its call."""
    inner = "LOOP(1);" * in_def + "END_LOOP;" * in_def
    return f"DEF A;{inner}END_DEF;" + "IF(TRUE);" * around + "A;" + "ENDIF;" * around


def reads(text: str) -> str:
    """The sensors read, in order, by the last letters of their names."""
    return "".join(line.split()[2][-1] for line in lines(text) if "READ" in line)


# --- The paper and the examples of the language reference ---------------------------------------


def test_the_example_of_a_run() -> None:
    """Prints each thing that the robot does."""
    text = "F(1, 80); DISTANCE; BEEP(0.25, 440); GRIPPER(90); SHOW(12.5)"
    assert lines(text, sensors={"DISTANCE": [50_000, 9_000, 50_000]}) == [
        "0 MOTORS 80 80",
        "1000 MOTORS 0 0",
        "1000 READ DISTANCE 50",
        "1000 BEEP 440 250",
        "1250 SET GRIPPER 90",
        "1250 SHOW 12.5",
        "1250 DONE",
    ]


@pytest.mark.parametrize(
    ("text", "trace"),
    [
        ("SI|F(5, 80)", "0 MOTORS 80 80|5000 MOTORS 0 0|5000 DONE"),
        ("SB|R(3, 60)", "0 MOTORS 60 -60|3000 MOTORS 0 0|3000 DONE"),
        ("SI|START", "0 DONE"),
        ("", "0 DONE"),
        ("PING|check_connection", "0 DONE"),
        (
            "L(1,50); B(1,80); W(1); S;",
            "0 MOTORS -50 50|1000 MOTORS 0 0|1000 MOTORS -80 -80|2000 MOTORS 0 0|3000 MOTORS 0 0"
            "|3000 DONE",
        ),
        ("SI|IF(LIGHT_R > 100);F(4, 70);ENDIF", "0 READ LIGHT_R 0|0 DONE"),
        (
            "SI|LOOP(2);F(2, 50);END_LOOP",
            "0 MOTORS 50 50|2000 MOTORS 0 0|2000 MOTORS 50 50|4000 MOTORS 0 0|4000 DONE",
        ),
    ],
)
def test_small_programs_of_the_paper(text: str, trace: str) -> None:
    """Do what the paper says."""
    assert run(text) == trace.replace("|", "\n") + "\n"


@pytest.mark.parametrize(
    "text",
    [
        "SI|LOOP(FOREVER);\n  F(1, 80);\n  DISTANCE;\n  IF(DISTANCE < 10);\n    STOP;\n"
        "    R(1, 60);\n  ENDIF;\nEND_LOOP",
        "SI|START;LOOP(FOREVER);F(1, 80);DISTANCE;IF(DISTANCE < 10);STOP;R(1, 60);ENDIF;END_LOOP",
    ],
)
def test_the_obstacle_course(text: str) -> None:
    """Reads once per turn, and a move that would pass the end is cut."""
    trace = run(text, sensors={"DISTANCE": [50_000, 9_000]}, max_time_ms=3_500)
    assert trace.splitlines() == [
        "0 MOTORS 80 80",
        "1000 MOTORS 0 0",
        "1000 READ DISTANCE 50",
        "1000 MOTORS 80 80",
        "2000 MOTORS 0 0",
        "2000 READ DISTANCE 9",
        "2000 MOTORS 0 0",
        "2000 MOTORS 60 -60",
        "3000 MOTORS 0 0",
        "3000 MOTORS 80 80",
        "3500 LIMIT",
    ]


# --- Values ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("0.1 + 0.2 = 0.3", "TRUE"),
        ("-7 % 3", "2"),
        ("7 % -3", "-2"),
        ("-0.5", "-0.5"),
        ("0.0005", "0.001"),
        ("-0.0005", "-0.001"),
        ("0.5 * 0.001", "0.001"),
        ("-0.5 * 0.001", "-0.001"),
        ("1 / 3", "0.333"),
        ("2 / -3", "-0.667"),
        ("-2147483.648", "-2147483.648"),
        ("- 1 - -1", "0"),
        ("2 + 3 * 4 % 5", "4"),
        ("10 - 2 - 3", "5"),
        ("ROUND(2.5, 0)", "3"),
        ("ROUND(-2.5, 0)", "-3"),
        ("ROUND(1250, -2)", "1300"),
        ("ROUND(2147483, -9)", "0"),
        ("ROUND(1.2345, 2.5)", "1.235"),
        ("ROUND(1.234, 1.5)", "1.23"),
        ("ABS(-3) + MIN(1, 2) + MAX(1, 2)", "6"),
        ("NOT 1 = 2", "TRUE"),
        ("NOT FALSE AND FALSE", "FALSE"),
        ("TRUE OR FALSE AND FALSE", "TRUE"),
        ("FALSE AND 1 / 0 = 1", "FALSE"),
        ("TRUE OR 1 / 0 = 1", "TRUE"),
        ("TRUE <> FALSE", "TRUE"),
        ("RANDOM(3, 3)", "3"),
        ("RANDOM(1, 6)", "4"),
        ("RANDOM(6, 1)", "4"),
        ("RANDOM(0.5, 5.5)", "4"),
    ],
)
def test_values(expression: str, value: str) -> None:
    """Are exact, and rounded half away from zero."""
    assert shown(expression) == value


def test_random_is_xorshift32() -> None:
    """Steps once for each RANDOM that is evaluated, and not for one that is skipped."""
    assert lines("SHOW(RANDOM(0, 999999))")[0] == f"0 SHOW {270_369 % 1_000_000}"
    assert shown("RANDOM(1, 6)", "X = TRUE OR RANDOM(1, 6) = 1") == "4"
    assert lines("SHOW(RANDOM(1, 6))", seed=0xFFFFFFFF)[0] == f"0 SHOW {1 + 253_983 % 6}"


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("SHOW(2147483.647 + 0.001)", "FAULT OVERFLOW"),
        ("SHOW(--2147483.648)", "FAULT OVERFLOW"),
        ("SHOW(ABS(-2147483.648))", "FAULT OVERFLOW"),
        ("SHOW(ROUND(2147483.647, 0))", "FAULT OVERFLOW"),
        ("SHOW(RANDOM(2147483.647, 2147483.647))", "FAULT OVERFLOW"),
        ("SHOW(-2147483.648 / -1)", "FAULT OVERFLOW"),
        ("SHOW(1 / 0)", "FAULT DIVIDE_BY_ZERO"),
        ("SHOW(1 % 0)", "FAULT DIVIDE_BY_ZERO"),
        ("IF(FALSE);SHOW(1 / 0);ENDIF", "DONE"),
        ("LOOP(-2147483.648);ENDLOOP;M(0, 2147483.647 + 0)", "DONE"),
    ],
)
def test_faults(text: str, fault: str) -> None:
    """Stop the program where they are reached."""
    assert ending(text) == fault


def test_limited_arguments() -> None:
    """Numbers that are computed are limited; times below 0 count as 0."""
    text = (
        "X = 0;F(X - 1, X + 100.5);M(X + 200, (-200));BEEP((-1), (5));GRIPPER(X + 12.5);LIFT((-95))"
    )
    assert lines(text) == [
        "0 MOTORS 100 100",
        "0 MOTORS 0 0",
        "0 MOTORS 100 -100",
        "0 BEEP 31 0",
        "0 SET GRIPPER 13",
        "0 SET LIFT -90",
        "0 DONE",
    ]


# --- Text -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "\ufeffsi|f(1,\n 50) // go ; )\r\nb(.5\u00a0, 0.0);;\n",
        "if(true)\nelseif(false)\nelse\nend_if\nwhile(false);endwhile;loop(0);endloop",
        "DEF go;S;ENDDEF;GO;Go",
        "X=-2147483.648;Y=X=X;IF(Y);ENDIF",
        "DEF A;X = 1;END_DEF;SHOW(X)",
        "W(FOREVER) UNTIL(TRUE)",
        "x = 1" + "+(1" * 15 + ")" * 15,
        "LOOP(1);" * 16 + "END_LOOP;" * 16,
        "DEF A;"
        + "LOOP(1);" * 8
        + "END_LOOP;" * 8
        + "END_DEF;"
        + "IF(TRUE);" * 8
        + "A;"
        + "ENDIF;" * 8,
        "DEF A0;END_DEF;" + "".join(f"DEF A{i};A{i - 1};END_DEF;" for i in range(1, 8)) + "A7",
        ";".join(f"V{i} = {i}" for i in range(32)),
        "".join(f"DEF A{i};END_DEF;" for i in range(16)),
    ],
)
def test_programs_that_are_right(text: str) -> None:
    """Run to their end."""
    assert ending(text) == "DONE"


@pytest.mark.parametrize(
    "text",
    [
        "SI|SB|S",
        "PING|S",
        "PING|check_connection;S",
        "S = 5",
        "TASK = 1",
        "DISTANCE = 1",
        "año = 1",
        "F(1;50)",
        "F(1,5, 80)",
        "F(1, 50) S",
        "IF(TRUE) S;ENDIF",
        "F(1, 50)\nUNTIL(TRUE)",
        "F(FOREVER, 50)",
        "M(1, 1) UNTIL(TRUE)",
        "BEEP(1, 440) UNTIL(TRUE)",
        "X = 1\n + 2",
        "X = 5.",
        "X = 2147483.648",
        "X = Y",
        "X = X",
        "SHOW(X);X = 1",
        "X = 1;X = TRUE",
        "IF(1);ENDIF",
        "SHOW(1 + TRUE)",
        "SHOW(1 < 2 < 3)",
        "SHOW(TRUE < FALSE)",
        "SHOW(1 = TRUE)",
        "SHOW(-TRUE)",
        "LED(1)",
        "GRIPPER(TRUE)",
        "GRIPPER(180.001)",
        "LIFT(-90.001)",
        "F(1, 100.4)",
        "F(-1, 50)",
        "M(-100.1, 0)",
        "BEEP(1, 30)",
        "BREAK",
        "LOOP(1);DEF A;END_DEF;END_LOOP",
        "A;DEF A;END_DEF",
        "DEF A;A;END_DEF",
        "DEF A;END_DEF;A = 1",
        "A = 1;DEF A;END_DEF",
        "LOOP(1);DEF A;BREAK;END_DEF;END_LOOP",
        "IF(TRUE);ELSE;ELSE;ENDIF",
        "LOOP(1)",
        "ENDIF",
        "LOOP(1);ENDIF",
        "X = 1" + "+(1" * 16 + ")" * 16,
        "LOOP(1);" * 17 + "END_LOOP;" * 17,
        "DEF A;"
        + "LOOP(1);" * 9
        + "END_LOOP;" * 9
        + "END_DEF;"
        + "IF(TRUE);" * 8
        + "A;"
        + "ENDIF;" * 8,
        "DEF A0;END_DEF;" + "".join(f"DEF A{i};A{i - 1};END_DEF;" for i in range(1, 9)) + "A8",
        ";".join(f"V{i} = {i}" for i in range(33)),
        "".join(f"DEF A{i};END_DEF;" for i in range(17)),
    ],
)
def test_programs_that_are_wrong(text: str) -> None:
    """Are refused."""
    with pytest.raises(Mistake):
        run(text, WIDE_KIT)


# --- Readings -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "letters"),
    [
        # LIGHT_R, LIGHT_L, DISTANCE and TOUCH appear as R, L, E and H.
        ("DISTANCE;SHOW(DISTANCE)", "E"),
        ("SHOW(DISTANCE);SHOW(DISTANCE)", "EE"),
        ("SHOW(LIGHT_L + LIGHT_R + LIGHT_L)", "LR"),
        ("SHOW(FALSE AND TOUCH)", "H"),
        ("IF(DISTANCE > 5);ELSEIF(DISTANCE > LIGHT_L);ENDIF;SHOW(DISTANCE)", "ELE"),
        ("IF(DISTANCE = 0);SHOW(DISTANCE);ENDIF", "EE"),
        ("IF(TRUE);DISTANCE;ENDIF;SHOW(DISTANCE)", "EE"),
        ("IF(TRUE);DISTANCE;ELSE;DISTANCE;ENDIF;SHOW(DISTANCE)", "E"),
        ("LOOP(1);DISTANCE;BREAK;END_LOOP;SHOW(DISTANCE)", "EE"),
        ("DISTANCE;LOOP(1 + DISTANCE);SHOW(DISTANCE);END_LOOP;SHOW(DISTANCE)", "EE"),
        ("DISTANCE;WHILE(DISTANCE > 5);END_WHILE;SHOW(DISTANCE)", "EE"),
        ("DEF A;DISTANCE;END_DEF;A;SHOW(DISTANCE)", "E"),
        ("DEF A;SHOW(DISTANCE);END_DEF;DISTANCE;A;SHOW(DISTANCE)", "EE"),
        ("DEF A;DISTANCE;END_DEF;SHOW(DISTANCE)", "E"),
        ("LIGHT_L;F(DISTANCE, LIGHT_L) UNTIL(LIGHT_L = 0 AND DISTANCE = 0)", "LELE"),
    ],
)
def test_surely_taken_readings(text: str, letters: str) -> None:
    """Are not taken again; all others are, just before the instruction."""
    assert reads(text) == letters


def test_readings_repeat_the_last_one() -> None:
    """And yes/no readings are words."""
    text = "LOOP(3);TOUCH;END_LOOP"
    trace = lines(text, sensors={"TOUCH": [0, 1]})
    assert [line.split()[-1] for line in trace] == ["FALSE", "TRUE", "TRUE", "DONE"]


# --- Time -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "trace"),
    [
        ("F(0, 50)", "0 MOTORS 50 50|0 MOTORS 0 0|0 DONE"),
        ("F(1, 50) UNTIL(TRUE)", "0 DONE"),
        ("F(1, 50) UNTIL(TIME > 0.03)", "0 MOTORS 50 50|40 MOTORS 0 0|40 DONE"),
        ("F(0.03, 50) UNTIL(TIME >= 0.03)", "0 MOTORS 50 50|30 MOTORS 0 0|30 DONE"),
        ("W(0.04) UNTIL(TOUCH)", "0 READ TOUCH FALSE|20 READ TOUCH FALSE|40 DONE"),
        ("W(FOREVER) UNTIL(1 / (0.02 - TIME) < 0)", "20 FAULT DIVIDE_BY_ZERO"),
        ("W(60);SHOW(TIME)", "60000 SHOW 60|60000 DONE"),
        ("W(60.001);S", "60000 LIMIT"),
        ("W(59.99);F(FOREVER, 5) UNTIL(FALSE)", "59990 MOTORS 5 5|60000 LIMIT"),
        ("LOOP(1000);W(0.01);END_LOOP", "10000 DONE"),
        ("M(0.5, -0.5);STOP", "0 MOTORS 1 -1|0 MOTORS 0 0|0 DONE"),
    ],
)
def test_time(text: str, trace: str) -> None:
    """Passes only in moves, waits and beeps."""
    assert lines(text) == trace.split("|")


def test_arguments_come_before_until() -> None:
    """Evaluates the arguments, and faults in them, before UNTIL reads."""
    assert lines("F(1 / 0, 50) UNTIL(TOUCH)") == ["0 FAULT DIVIDE_BY_ZERO"]


def test_max_steps() -> None:
    """Ends a loop that takes no time."""
    assert lines("LOOP(FOREVER);END_LOOP", max_steps=100) == ["0 LIMIT"]
    with pytest.raises(ValueError):
        run("S", sensors={"DISTANCE": [400_001]})


# --- Random programs --------------------------------------------------------------------------


def test_random_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Are valid, and together do every instruction and end in every way."""
    seen: set[str] = set()
    robot = interpreter.Robot
    do, choose, repeat = robot.do, robot.choose, robot.repeat

    def watched_do(self: interpreter.Robot, statement: Do) -> None:
        seen.add(statement.word + (" UNTIL" if statement.until else ""))
        do(self, statement)

    def watched_choose(self: interpreter.Robot, statement: If) -> None:
        seen.add("IF")
        choose(self, statement)

    def watched_repeat(self: interpreter.Robot, statement: Loop | While) -> None:
        seen.add("WHILE" if isinstance(statement, While) else "LOOP")
        repeat(self, statement)

    monkeypatch.setattr(robot, "do", watched_do)
    monkeypatch.setattr(robot, "choose", watched_choose)
    monkeypatch.setattr(robot, "repeat", watched_repeat)
    for number in range(2000):
        rng = random.Random(number)
        kit = WIDE_KIT if number % 2 else PAPER_KIT
        text = program(rng, kit)
        trace = run(text, kit, senses(rng, kit), 20_000, 20_000, rng.randint(1, 2**32 - 1))
        seen.add(trace.splitlines()[-1].split(" ", 1)[1])
    words = [
        "F",
        "B",
        "L",
        "R",
        "W",
        "M",
        "S",
        "BEEP",
        "SHOW",
        "=",
        "READ",
        "SET",
        "CALL",
        "BREAK",
        "IF",
        "LOOP",
        "WHILE",
        "DONE",
        "LIMIT",
    ]
    untils = {f"{word} UNTIL" for word in "FBLRW"}
    assert seen == {*words, *untils, "FAULT OVERFLOW", "FAULT DIVIDE_BY_ZERO"}


def test_broken_programs() -> None:
    """Are refused with a Mistake or run, and nothing else happens."""
    refused = 0
    for number in range(500):
        rng = random.Random(number)
        try:
            run(broken(rng, program(rng, WIDE_KIT)), WIDE_KIT, {}, 2_000, 2_000)
        except Mistake:
            refused += 1
    assert 250 < refused < 500
