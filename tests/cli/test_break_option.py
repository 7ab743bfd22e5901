"""`tsc upload --break`: the halts of a program, their messages, and the keys."""

from __future__ import annotations

import json
import random
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import pytest

from tests.support.command import Tsc
from tests.support.pty_robot import PtyRobot, on
from tests.support.terminal import Terminal
from tiniscript.cli.robot import debugger
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.debugger import GO_KEYS, STEP_KEYS
from tiniscript.cli.terminal.keys import Keys, letters_of
from tiniscript.link.messages import RESUME_GO, RESUME_STEP

PROGRAM = """SI|N = 1
FAR = DISTANCE > 20
IF(FAR OR N > 5)
F(0.1, 80)
ENDIF
N = N + 4.5
SHOW(N)
"""
KEYS_LINE = "  s: step   g: continue   Ctrl-C: stop"
HALT_BEFORE_4 = ["Halted before line 4: F(0.1, 80)", "  N = 1, FAR = TRUE"]
HALT_BEFORE_6 = ["Halted before line 6: N = N + 4.5", "  N = 1, FAR = TRUE"]
HALT_BEFORE_7 = ["Halted before line 7: SHOW(N)", "  N = 5.5, FAR = TRUE"]
END_LINES = ["N 5.5", "Done."]
TASKS = """SI|TASK; W(0.5); END_TASK
TASK; F(0.5, 50); END_TASK
TASK; W(0.05); B(0.5, 60); END_TASK
W(0.1); N = 3
S
"""


@pytest.fixture
def program(tmp_path: Path, pty_robot: PtyRobot) -> Path:
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    path = tmp_path / "drive.ts"
    path.write_text(PROGRAM, encoding="utf-8")
    return path


def start_terminal(robot: PtyRobot, program: Path, *lines: int) -> Terminal:
    break_options = [word for line in lines for word in ("--break", str(line))]
    port_option = ("--port", robot.port)
    return Terminal("upload", program, "--no-save", *port_option, *break_options, size=(100, 50))


def halt_output(terminal: Terminal) -> list[str]:
    """Wait for the end; return the output about the halts and after them."""
    assert terminal.end() == 0
    lines = [line for line in terminal.whole() if line]
    halt_index = next(k for k, line in enumerate(lines) if line.startswith("Halted"))
    return lines[halt_index:]


def test_without_a_terminal_each_halt_is_reported_and_the_program_continues(
    pty_robot: PtyRobot, program: Path
) -> None:
    result = on(pty_robot, "upload", program, "--no-save", "--break", "7", "--break", "4").gives(
        0, ""
    )
    assert result.out.splitlines()[1:] == [*HALT_BEFORE_4, *HALT_BEFORE_7, *END_LINES]
    assert pty_robot.actions[-1] == "FINISHED"


def test_a_fault_after_a_halt_is_the_exit_code(pty_robot: PtyRobot) -> None:
    words = "--break", "1"
    for result in (
        on(pty_robot, "upload", "-e", "SI|X = 0;SHOW(1 / X)", *words),
        on(pty_robot, "live", "X = 0;SHOW(1 / X)", *words),
    ):
        assert "Halted before line 1" in result.gives(1).out


def test_json_has_the_values_in_their_types(pty_robot: PtyRobot, program: Path) -> None:
    result = on(pty_robot, "upload", program, "--no-save", "--json", "--break", "7").gives(0, "")
    rows = [json.loads(line) for line in result.out.splitlines()]
    [halted] = [row for row in rows if row["event"] == "HALTED"]
    assert (halted["line"], halted["tasks"]) == (7, [])
    assert halted["variables"] == {"N": 5.5, "FAR": True}
    assert isinstance(halted["variables"]["FAR"], bool)


def test_a_line_without_an_instruction_halts_before_the_next_one(
    pty_robot: PtyRobot, program: Path
) -> None:
    result = on(pty_robot, "upload", program, "--no-save", "--break", "5").gives(0)
    assert result.out.splitlines()[1:] == [*HALT_BEFORE_6, *END_LINES]


def test_a_halt_reports_where_the_other_tasks_are(pty_robot: PtyRobot) -> None:
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    result = on(pty_robot, "upload", "-e", TASKS, "--no-save", "--break", "5").gives(0)
    place_lines = result.out.splitlines()[1:6]
    assert place_lines == [
        "Halted before line 5: S",
        "  N = 3",
        "  Line 1: another task, waiting",
        "  Line 2: another task, using the motors",
        "  Line 3: another task, waiting for the motors",
    ]


def test_an_instruction_joined_to_the_previous_one_halts_there(pty_robot: PtyRobot) -> None:
    """The compiler takes a reading once: the statement has both."""
    pty_robot.ask(lambda robot: robot.set_readings(0, 0, 42_000))
    joined_text = "SI|DISTANCE\nIF(DISTANCE < 10)\nSTOP\nENDIF\nSHOW(2)\n"
    for line in (1, 2):
        result = on(
            pty_robot, "upload", "-e", joined_text, "--no-save", "--break", str(line)
        ).gives(0)
        assert result.out.splitlines()[1:2] == ["Halted before line 2: IF(DISTANCE < 10)"]


@pytest.mark.parametrize("keys", ["s", "S", " ", "\n"])
def test_a_key_steps_one_instruction_of_the_text(
    keys: str, pty_robot: PtyRobot, program: Path
) -> None:
    terminal = start_terminal(pty_robot, program, 4)
    for halted_text, *_ in (HALT_BEFORE_4, HALT_BEFORE_6, HALT_BEFORE_7):
        terminal.until(rf"(?s){halted_text.split(':')[0]}.*Ctrl-C: stop\n*$")
        terminal.type(keys)
    assert halt_output(terminal) == [
        *HALT_BEFORE_4,
        KEYS_LINE,
        *HALT_BEFORE_6,
        KEYS_LINE,
        *HALT_BEFORE_7,
        KEYS_LINE,
        *END_LINES,
    ]
    assert pty_robot.actions == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize("key", ["g", "G"])
def test_a_key_continues_to_the_next_breakpoint(
    key: str, pty_robot: PtyRobot, program: Path
) -> None:
    terminal = start_terminal(pty_robot, program, 4, 7)
    for line in (4, 7):
        terminal.until(rf"(?s)before line {line}.*Ctrl-C: stop\n*$")
        terminal.type(key)
    assert halt_output(terminal) == [
        *HALT_BEFORE_4,
        KEYS_LINE,
        *HALT_BEFORE_7,
        KEYS_LINE,
        *END_LINES,
    ]


def test_a_key_counts_once_and_other_keys_do_nothing(pty_robot: PtyRobot, program: Path) -> None:
    """Keys typed before the halt is reported do not answer it."""
    terminal = start_terminal(pty_robot, program, 4)
    terminal.until(r"(?s)before line 4.*Ctrl-C: stop\n*$")
    terminal.type("x?ssg")
    terminal.until(r"(?s)before line 6.*Ctrl-C: stop\n*$")
    terminal.type("1g")
    assert halt_output(terminal) == [
        *HALT_BEFORE_4,
        KEYS_LINE,
        *HALT_BEFORE_6,
        KEYS_LINE,
        *END_LINES,
    ]


def test_a_loop_is_stepped_one_instruction_at_a_time(pty_robot: PtyRobot, tmp_path: Path) -> None:
    path = tmp_path / "loop.ts"
    text = "SI|N = 2\nLOOP(N)\nSHOW(N * N + 1)\nN = N - 1\nEND_LOOP\n"
    path.write_text(text, encoding="utf-8")
    terminal = start_terminal(pty_robot, path, 3)
    halts = []
    for k in range(6):
        terminal.until(rf"(?s)(.*Ctrl-C: stop){{{k + 1}}}\n*$")
        halts.append([line for line in terminal.lines() if line.startswith("Halted")][-1])
        terminal.type("s")
    halt_output(terminal)
    loop = ["line 3: SHOW(N * N + 1)", "line 4: N = N - 1", "line 2: LOOP(N)"]
    assert halts == [f"Halted before {instruction}" for instruction in loop * 2]


def test_ctrl_c_stops_a_halted_program(pty_robot: PtyRobot, program: Path) -> None:
    terminal = start_terminal(pty_robot, program, 4)
    terminal.until(r"(?s)before line 4.*Ctrl-C: stop\n*$")
    terminal.interrupt()
    assert terminal.end() == 2
    assert "the robot has confirmed the stop" in "\n".join(terminal.whole())
    assert "MOTORS 80 80" not in pty_robot.actions
    on(pty_robot, "start").gives(0)
    assert "MOTORS 80 80" in pty_robot.actions, "it has no breakpoint any more"


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (["--break", "9"], 1, "on or after line 9"),
        (["--break", "0"], 2, "--break"),
        (["--break", "one"], 2, "--break"),
        ([word for line in "12467" for word in ("--break", line)], 2, "at most 4"),
        (["--break", "4", "--detach"], 2, "--break needs a run"),
        (["--break", "4", "--no-run"], 2, "--break needs a run"),
    ],
)
def test_breakpoints_on_no_instruction_are_refused_before_anything_is_sent(
    words: list[str], code: int, message: str, pty_robot: PtyRobot, program: Path
) -> None:
    on(pty_robot, "upload", program, *words).gives(code, message)
    assert pty_robot.actions == [] and on(pty_robot, "start").code == 3, "it has no program"


def test_an_image_of_unknown_text_has_no_lines(
    pty_robot: PtyRobot, program: Path, tmp_path: Path, tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    image_file = tmp_path / "drive.bin"
    tsc("compile", program, "-o", image_file).gives(0)
    result = on(pty_robot, "upload", image_file, "--no-save", "--break", "7").gives(0)
    assert result.out.splitlines()[1:] == [*HALT_BEFORE_7, *END_LINES], "its map is in the cache"
    monkeypatch.setattr("tiniscript.library.source_map.recall", lambda checksum: None)
    on(pty_robot, "upload", image_file, "--break", "7").gives(2, "an image has no lines")


def test_nothing_is_sent_to_a_robot_that_cannot_halt(
    pty_robot: PtyRobot, program: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(debugger, "BREAKPOINTS", 0)
    on(pty_robot, "upload", program, "--break", "4").gives(3, "breakpoint")
    assert on(pty_robot, "start").code == 3, "it has no program"


# Arrows, also with Ctrl; F1 to F5, on a console, too; Delete; Alt with a letter.
SEQUENCES = ["\x1b[A", "\x1bOA", "\x1b[1;5C", *(f"\x1bO{final}" for final in "PQRS"), "\x1b[15~",
             *(f"\x1b[[{final}" for final in "ABCDE"), "\x1b[3~", "\x1bs", "\x1bg"]  # fmt: skip


@pytest.mark.parametrize("seed", range(50))
def test_no_key_of_several_characters_steps_or_continues(seed: int) -> None:
    """F4 ends with an S. Text typed between such keys counts."""
    rng = random.Random(seed)
    pressed_keys = [rng.choice([*SEQUENCES, *(STEP_KEYS + GO_KEYS)]) for _ in range(8)]
    assert letters_of("".join(pressed_keys)) == "".join(
        key for key in pressed_keys if len(key) == 1
    )


@pytest.mark.parametrize("seed", range(10))
def test_the_first_key_at_a_halt_answers_it_and_no_other_key_does_anything(
    seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At any halt, and while the program runs."""
    rng, typed_keys, commands, expected_commands = random.Random(seed), "", list[int](), list[int]()
    fake_debugger = debugger.Debugger.__new__(debugger.Debugger)
    fake_debugger.has_keys, fake_debugger.keys = True, Keys()
    fake_debugger.is_halted = fake_debugger.is_stepping = False
    session = SimpleNamespace(resume=commands.append)
    fake_debugger.connection = cast(
        Connection, SimpleNamespace(request=lambda make_request: make_request(session))
    )
    monkeypatch.setattr(fake_debugger.keys, "read_keys", lambda: typed_keys)
    is_halted = False
    for _ in range(60):
        if rng.random() < 0.3:
            fake_debugger.is_halted = is_halted = True
        typed_keys = "".join(rng.choices("sgx", k=rng.choice((0, 1, 1, 2))))
        fake_debugger.poll_keys()
        key = next((key for key in typed_keys if key in "sg"), "")
        if key and is_halted:
            expected_commands.append(RESUME_STEP if key == "s" else RESUME_GO)
            is_halted = False
        assert commands == expected_commands
        assert fake_debugger.is_stepping == (expected_commands[-1:] == [RESUME_STEP])


# -- lines of `tsc live` -------------------------------------------------------------------------

LINES = (
    "X = 4",
    "DEF TELL; SHOW(X); END_DEF",
    "LOOP(2)\nTELL\nX = X + 1\nEND_LOOP",
    "SHOW(X)",
)


def test_a_line_halts_at_its_own_breakpoints_and_at_no_earlier_ones(pty_robot: PtyRobot) -> None:
    """The lines that it needs are sent before it. Lines of the text that is typed count."""
    result = on(pty_robot, "live", "-", "--break", "3", data="\n".join(LINES).encode()).gives(0, "")
    assert result.out.splitlines() == [
        "Now defined: TELL.",
        "X 4",
        "Halted before line 3: X = X + 1",
        "  X = 4",
        "X 5",
        "Halted before line 3: X = X + 1",
        "  X = 5",
        "X 6",
    ]


@pytest.mark.parametrize("halts", ["1", "4"])
def test_lines_that_halt_do_the_same_as_without_halts(halts: str, pty_robot: PtyRobot) -> None:
    data = "\n".join(LINES).encode()
    lines_alone = on(pty_robot, "live", "-", data=data).gives(0, "").out.splitlines()
    halt_rows = (
        on(pty_robot, "live", "-", "--break", halts, data=data).gives(0, "").out.splitlines()
    )
    shown_lines = [line for line in halt_rows if not line.startswith(("Halted", "  "))]
    assert shown_lines == lines_alone and ("Halted before line 1: SHOW(X)" in halt_rows) is (
        halts == "1"
    )


def test_a_person_steps_lines_at_the_prompt(pty_robot: PtyRobot) -> None:
    """A step skips code outside of the line: variables and DEFs before it, values after it."""
    terminal = Terminal("live", "--port", pty_robot.port, "--break", "1", size=(100, 60))
    terminal.until("tini>")
    terminal.type("SPEED = 55; DEF GO; F(0.1, SPEED); END_DEF\n")
    terminal.until(r"(?s)before line 1: SPEED = 55.*Ctrl-C: stop\n*$")
    terminal.type("s")
    terminal.until("tini>\n*$")
    assert pty_robot.actions.count("MOTORS 55 55") == 0
    terminal.type("GO; SPEED = SPEED + 5\n")
    terminal.until(r"(?s)before line 1: GO\n.*SPEED = 55.*Ctrl-C: stop\n*$")
    assert "MOTORS 55 55" not in pty_robot.actions
    terminal.type("s")
    terminal.until(r"(?s)before line 1: SPEED = SPEED.*Ctrl-C: stop\n*$")
    assert "MOTORS 55 55" in pty_robot.actions
    terminal.type("g")
    terminal.until("tini>\n*$")
    terminal.type("F(9, SPEED)\n")
    terminal.until(r"(?s)before line 1: F.9, SPEED.\n.*SPEED = 60.*Ctrl-C: stop\n*$")
    terminal.interrupt()
    terminal.until("the robot has confirmed the stop")
    terminal.until("tini>\n*$")
    assert "MOTORS 60 60" not in pty_robot.actions
    terminal.type("\x04")
    assert terminal.end() == 0


def test_nothing_is_sent_for_a_missing_place_or_to_a_robot_that_cannot_halt(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    on(pty_robot, "live", "F(1, 80)", "--break", "2").gives(1, "on or after line 2")
    on(pty_robot, "live", "F(1, 80)", "--break", "0").gives(2, "--break")
    monkeypatch.setattr(debugger, "BREAKPOINTS", 0)
    on(pty_robot, "live", "F(1, 80)", "--break", "1").gives(3, "breakpoint")
    assert pty_robot.actions == []
