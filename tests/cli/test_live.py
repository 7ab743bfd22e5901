"""`tsc live`: lines that a robot executes at once, and the state that persists between them."""

from __future__ import annotations

import re

import pytest

from tests.support.command import CommandResult
from tests.support.pty_robot import PtyRobot, on
from tests.support.terminal import Terminal
from tiniscript import robots
from tiniscript.cli.robot.live_state import LiveState, LiveValue, missing_ends

KIT = robots.load("tinibot").kit


def test_a_line_runs_at_once_and_the_stored_program_stays(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "upload", "-e", "SB|W(1)").code == 0
    result = on(pty_robot, "live", "F(0.2, 80);SHOW(1.5)")
    assert (result.code, result.out) == (0, "SHOW 1.5\nDone.\n")
    assert pty_robot.actions == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]
    assert "SB" in on(pty_robot, "show").out
    assert on(pty_robot, "live", "F(2 80)").code == 1
    assert on(pty_robot, "live", "SB|F(2, 80)").code == 1
    on(pty_robot, "live", "SHOW(TIME * 1.234);" * 12).gives(1, "room for 55")
    assert on(pty_robot, "live", "X = 0;SHOW(1 / X)").code == 1


def test_variables_and_defs_persist(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 30_000))
    lines = (
        "X = DISTANCE + 0.5; READY = TRUE",
        "DEF TELL; SHOW(X); END_DEF",
        "TELL; X = X + 1; TELL",
        "SHOW(X);SHOW(READY)",
        "DEF TELL; SHOW(-X); END_DEF; TELL",
        "X = 1 / 0",
        "SHOW(9)",
    )
    result = on(pty_robot, "live", "-", data="\n".join(lines).encode())
    assert result.code == 1  # the fault ends it
    assert result.out.splitlines() == [
        "Now defined: TELL.", "X 30.5", "X 31.5", "X 31.5", "READY TRUE", "-X -31.5",
    ]  # fmt: skip
    assert "DIVIDE_BY_ZERO" in result.err


def test_the_prompt_runs_typed_lines(pty_robot: PtyRobot) -> None:
    """Types lines, makes a mistake, presses Ctrl-C while it drives, and leaves with Ctrl-D."""
    terminal = Terminal("live", "--port", pty_robot.port)

    def see(text: str, times: int = 1) -> None:
        terminal.until("(?s)" + ".*".join([re.escape(text.rstrip())] * times))

    see("tini> ")
    terminal.type("SPEED = 55\n")
    see("tini> ", 2)
    terminal.type("F(1 SPEED)\n")
    see("need a comma")
    see("tini> ", 3)
    terminal.type("LOOP(FOREVER);F(1, SPE\t);END_LOOP\n")
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    assert pty_robot.actions[-1] == "MOTORS 55 55"
    terminal.type("\x03")
    see("the robot has confirmed the stop.")
    assert not pty_robot.moves
    see("tini> ", 4)
    terminal.type("SHOW(SPEED)\n")
    see("SPEED 55")
    see("tini> ", 5)
    terminal.type("LOOP(2)\n")
    see("....> ")
    terminal.type("\x03")  # the block is dropped
    see("tini> ", 6)
    terminal.type("LOOP(2)\nSHOW(SPEED + 1)\nEND_LOOP\n")
    see("SPEED + 1 56", 2)
    see("tini> ", 7)
    terminal.screen.reset()
    terminal.type("help\n")
    see("LIGHT_R, LIGHT_L, DISTANCE")
    see("tini> ")
    terminal.type("\x04")
    assert terminal.end() == 0


# Places of a person who presses Ctrl-C: the typed text, and the expected output.
PLACES = {
    "at the prompt": ("", "tini> "),
    "in a line": ("F(1, ", "F(1, "),
    "in an open block": ("LOOP(2)\n", "....> "),
    "in a line of a block": ("LOOP(2)\nF(1,", "....> F(1,"),
    "after a mistake": ("F(1 2)\n", "need a comma"),
}


def test_ctrl_c_stops_the_robot_from_any_prompt(pty_robot: PtyRobot) -> None:
    """This includes a program that its button has started."""
    assert on(pty_robot, "upload", "-e", "SB|F(60, 80)").code == 0
    terminal = Terminal("live", "--port", pty_robot.port)
    terminal.until("tini>")
    for place, (typed_text, word_on_screen) in PLACES.items():
        pty_robot.push()
        pty_robot.until(lambda: pty_robot.moves, "it drives")
        terminal.screen.reset()
        terminal.type(typed_text)
        if typed_text:
            terminal.until(re.escape(word_on_screen.rstrip()))
        terminal.type("\x03")
        terminal.until(re.escape("the robot has confirmed the stop."))
        assert not pty_robot.moves, place
        terminal.until("tini>\n*$")
    terminal.type("\x04")
    assert terminal.end() == 0


def test_a_block_may_span_lines(pty_robot: PtyRobot) -> None:
    """Up to its end, or to the first line with a mistake."""

    def run_live(lines: str) -> CommandResult:
        return on(pty_robot, "live", "-", data=lines.encode())

    result = run_live(
        "DEF TELL\n  SHOW(1)\nEND_DEF\nLOOP(2)\n\n  TELL // twice\nEND_LOOP\nSHOW(3)\n"
    )
    assert (result.code, result.err) == (0, "")
    assert result.out == "Now defined: TELL.\nSHOW 1\nSHOW 1\nSHOW 3\n"
    result = run_live("LOOP(2)\nF(2 80)\nEND_LOOP\nSHOW(4)\n").gives(1, out="")
    assert (
        result.err.startswith("line 2:") and "comma" in result.err and "END_LOOP" not in result.err
    )
    run_live("IF(TRUE)\nSHOW(5)\n").gives(1, "ENDIF", out="")


@pytest.mark.parametrize(("text", "missing_text"), [
    ("F(1, 80)", ""),
    ("LOOP(2)", "END_LOOP"),
    ("si|if(TRUE); F(1, 50)\nELSE", "ENDIF"),
    ("DEF A; LOOP(2)\nWHILE(TRUE)", "END_WHILE; END_LOOP; END_DEF"),
    ("DEF A; LOOP(2)\nENDLOOP", "END_DEF"),
    ("LOOP(2); F(1, 50); END_LOOP", ""),
    ("LOOP(2); ENDIF", ""),
    ("END_LOOP; LOOP(2)", ""),
    ("// LOOP(2)", ""),
])  # fmt: skip
def test_missing_block_ends_are_found(text: str, missing_text: str) -> None:
    assert missing_ends(text) == missing_text


def test_a_line_is_sent_with_its_dependencies_only() -> None:
    known_state = LiveState(KIT)
    known_state.value_by_name = {
        "X": LiveValue(5000, False),
        "Y": LiveValue(1, True),
        "Z": LiveValue(-1500, False),
    }
    known_state.text_by_def = {
        "HOP": "DEF HOP; F(1, Z); SKIP; END_DEF",
        "SKIP": "DEF SKIP; W(X); END_DEF",
    }
    known_state.text_by_def = dict(
        sorted(known_state.text_by_def.items(), reverse=True)
    )  # called DEFs come first
    line = known_state.compile_line("HOP", 55)
    assert line.compilation.is_right
    assert line.compilation.program is not None
    assert line.compilation.program.variables == ("X", "Z")
    assert line.shown_variables == ()
    line = known_state.compile_line("SI|Y = NOT Y", 55)
    assert line.shown_variables == ("Y",)
    assert line.compilation.source.text.strip() == "Y = NOT Y"
    assert known_state.compile_line("Y = NOT Y", 5).loses_values


def test_mistakes_and_warnings_concern_only_the_line() -> None:
    known_state = LiveState(KIT)
    known_state.value_by_name = {"X": LiveValue(5000, False)}
    line = known_state.compile_line("X = X + 1; F(X 2)", 55)
    (diagnostic,) = line.compilation.diagnostics
    assert diagnostic.code.number == "TS017"
    assert line.compilation.source.text[: diagnostic.span.start].endswith("F(X")
    assert line.compilation.source.position(diagnostic.span.start)[0] == 1
    assert known_state.compile_line("A = 5", 55).compilation.diagnostics == []
    assert known_state.compile_line("DEF A; S; END_DEF", 55).compilation.diagnostics == []
    (warning,) = known_state.compile_line(
        "LOOP(FOREVER); X = 1; END_LOOP", 55
    ).compilation.diagnostics
    assert warning.code.number == "TS804"
    assert [
        diagnostic.code.number
        for diagnostic in known_state.compile_line("SHOW(NEW)", 55).compilation.diagnostics
    ] == ["TS103"]
