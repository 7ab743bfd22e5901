"""The suggestions of messages: they are correct, and appear once per mistake."""

from __future__ import annotations

import re

from tests.support.rows import each_row
from tests.support.texts import LANGUAGES
from tiniscript import check, robots
from tiniscript.base.source import Source
from tiniscript.diagnostics.fixing import repair_program
from tiniscript.diagnostics.rendering import Message, message
from tiniscript.library.compiling import check_text, compile_source
from tiniscript.library.named_robot import robot_of

TINIBOT = robots.load(robots.DEFAULT)


def messages_of(program: str, language: str = "en") -> list[Message]:
    """Return the messages about a program for the robot that it names."""
    robot = robot_of(program.encode(), TINIBOT)
    compilation = compile_source(program.encode(), robot, "", is_strict=True)
    return [
        message(diagnostic, compilation.source, language) for diagnostic in compilation.diagnostics
    ]


@each_row("language", LANGUAGES)
@each_row("word", "FBLR")
@each_row("number", (1, 2, 19, 20, 30, 45, 60, 90, 100, 101, 180, 360))
def test_alternatives_for_one_value_are_shown_in_full(
    language: str, word: str, number: int
) -> None:
    """The message shows power, centimetres or degrees, and no gap between the brackets."""
    (message,) = messages_of(f"{word}({number})", language)
    calls = re.findall(r"\b[FBLR]\([^()]*\d[^()]*\)", message.fix)
    assert calls or number < 20, message
    for call in calls:
        assert str(number) in call and not [
            message for message in check(call) if message.code < "TS800"
        ]


@each_row(
    "program, expected_text",
    [
        ("IF(NO(DISTANCE < 10));S;END_IF", "IF(NOT(DISTANCE < 10));S;END_IF"),
        ("W(5) UNTIL(NÃO(DISTANCE > 9))", "W(5) UNTIL(NOT(DISTANCE > 9))"),
        ("WHILE(NAO (TIME > 9));F(1, 60);END_WHILE", "WHILE(NOT (TIME > 9));F(1, 60);END_WHILE"),
        ("// robot: liner\nLED(HIGH)", "// robot: liner\nLED(TRUE)"),
        ("// robot: grabber\nLED LOW", "// robot: grabber\nLED(FALSE)"),
    ],
)
def test_a_word_is_read_with_its_brackets_and_in_its_place(
    program: str, expected_text: str
) -> None:
    robot = robot_of(program.encode(), TINIBOT)
    repaired_program = repair_program(
        program, lambda to: compile_source(to.encode(), robot, "", True).diagnostics
    )
    assert repaired_program.text == expected_text and not repaired_program.diagnostics_left


@each_row(
    "program, fix",
    [
        ("// robot: grabber\nIF(BUTTON = HIGH);S;END_IF", "TRUE"),
        ("// robot: grabber\nLED = LOW", "LED(FALSE)"),
    ],
)
def test_a_pin_set_high_or_low_becomes_a_yes_no(program: str, fix: str) -> None:
    assert [message.fix for message in messages_of(program)] == [fix]


@each_row(
    "program, words",
    [
        ("IF(LINE_L);S;END_IF;IF(BUTTON);S;END_IF", [("LINE_L", "liner")]),
        ("W(1) UNTIL(BUTTON);GRIPPER(90);LED(TRUE)", [("BUTTON", "grabber")]),
        ("LED(TRUE);SHOW(LINE_L);LED(FALSE)", [("LED", "liner")]),
        ("GRIPPER(90);SHOW(LINE_L);LED(TRUE)", [("GRIPPER", "grabber"), ("LINE_L", "liner")]),
        ("// robot: liner\nW(1) UNTIL(BUTTON);GRIPPER(90)", [("GRIPPER", "grabber")]),
        ("W(1) UNTIL(BUTTON)", []),
    ],
)
def test_words_of_another_kit_are_one_mistake(program: str, words: list[tuple[str, str]]) -> None:
    """The suggested line makes all of them known."""
    messages = messages_of(program)
    source = Source(program)
    word_pairs = []
    for shown_message in messages:
        if shown_message.code == "TS119":
            rows = source.text.split("\n")
            word = rows[shown_message.line - 1][
                shown_message.column - 1 : shown_message.end_column - 1
            ]
            word_pairs.append((word, shown_message.fix.rpartition(" ")[2]))
    assert word_pairs == words and len(messages) == max(1, len(words))
    if len(words) == 1:
        changed_text = f"// robot: {words[0][1]}\n{program.rpartition(chr(10))[2]}"
        assert not [
            message for message in messages_of(changed_text) if message.severity == "mistake"
        ]


@each_row(
    "program, fixes",
    [
        ("STOP UNTIL(DISTANCE > 20)", ["STOP;W(FOREVER) UNTIL(DISTANCE > 20)"]),
        ("S UNTIL(DISTANCE > 20)", ["S;W(FOREVER) UNTIL(DISTANCE > 20)"]),
        ("// robot: grabber\nLED(TRUE) UNTIL(DISTANCE > 9)",
         ["LED(TRUE);W(FOREVER) UNTIL(DISTANCE > 9)"]),
        ("F(FOREVER, 60) WHILE(DISTANCE > 10)", ["F(FOREVER, 60) UNTIL(DISTANCE <= 10)"]),
        ("F(FOREVER, 60);F(2, 60) WHILE(DISTANCE > 10)",
         ["F(FOREVER, 60) UNTIL(DISTANCE < 10)", "F(2, 60) UNTIL(DISTANCE <= 10)"]),
        ("F(RANDOM(1,3) SEC, 50)", ["F(RANDOM(1,3), 50)"]),
        ("W(ABS(TIME - 9) seconds)", ["W(ABS(TIME - 9))"]),
        ("F(RANDOM(1,3) ms, 50)", ["Write the result as one number, without a unit."]),
    ],
)  # fmt: skip
def test_suggested_programs_keep_the_written_meaning(program: str, fixes: list[str]) -> None:
    """A robot at rest stays at rest, and one condition is reported once."""
    assert [message.fix for message in messages_of(program)] == fixes


@each_row(
    "program, expected_text",
    [
        ("AL MISMO TIEMPO\nBEEP(1, 440)\nFIN\nF(2, 60)", "TASK\nBEEP(1, 440)\nEND_TASK\nF(2, 60)"),
        ("AO MESMO TEMPO\nBEEP(1, 440)\nFIM\nF(2, 60)", "TASK\nBEEP(1, 440)\nEND_TASK\nF(2, 60)"),
        ("MEANWHILE\nBEEP(1, 440)\nEND\nF(2, 60)", "TASK\nBEEP(1, 440)\nEND_TASK\nF(2, 60)"),
        ("SEMPRE QUE DISTANCE < 9\nB(1, 60)\nFIM", "WHEN(DISTANCE < 9)\nB(1, 60)\nEND_WHEN"),
        ("WHENEVER DISTANCE < 9\nB(1, 60)\nEND", "WHEN(DISTANCE < 9)\nB(1, 60)\nEND_WHEN"),
    ],
)
def test_parallel_work_becomes_a_task(program: str, expected_text: str) -> None:
    repaired_program = repair_program(
        program, lambda to: list(compile_source(to.encode(), TINIBOT, "", True).diagnostics)
    )
    assert (repaired_program.text, repaired_program.diagnostics_left) == (expected_text, [])


def test_spanish_phrases_for_when_are_suggested() -> None:
    """SIEMPRE QUE may also mean WHILE: the repair is shown, but not applied."""
    (message,) = messages_of("SIEMPRE QUE DISTANCE < 9\nB(1, 60)\nFIN", "es")
    assert message.fix == "WHEN(DISTANCE < 9); B(1, 60); END_WHEN"


@each_row(
    "program, lines",
    [
        ("PAN(90)\nPAN(10)", [1]),
        ("SQUARE(1)\nF(1, 60)\nSQUARE(2)", [1]),
        ("HOP\nHOP\nHIP", [1, 3]),
        ("DEF DANCE;F(1, 60);END_DEF\nDANSE\nDANSE", [2, 3]),  # each has its own repair
    ],
)
def test_an_unknown_word_is_one_mistake(program: str, lines: list[int]) -> None:
    assert [message.line for message in messages_of(program)] == lines


@each_row(
    "program, repaired_text",
    [
        ("SI|IF(DISTANCE < 9)\nS\nENDIF\nELSE\nW(1)\nENDIF",
         "SI|IF(DISTANCE < 9)\nS\nELSE\nW(1)\nENDIF"),
        ("SI|SET X TO 60; F(2, X)", "SI|X = 60; F(2, X)"),
        ("SI| SET X TO 60; F(2, X)", "SI| X = 60; F(2, X)"),
        ("W(1)\n  let X = 60\nF(2, X)", "W(1)\n  X = 60\nF(2, X)"),
        ("W(1); let X = 60 // note\nF(2, X)", "W(1); X = 60 // note\nF(2, X)"),
        ("import robot\nF(2, 80)", "F(2, 80)"),
    ],
)  # fmt: skip
def test_a_removed_part_leaves_no_line_and_no_blank(program: str, repaired_text: str) -> None:
    assert (
        repair_program(program, lambda to: check_text(to, TINIBOT.kit).diagnostics).text
        == repaired_text
    )
