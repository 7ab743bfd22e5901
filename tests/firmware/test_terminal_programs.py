"""Ordinary terminal programs at a robot's port: picocom, and miniterm of pyserial.

Each runs on a terminal of its own, where a person types. The robot is the firmware behind a
pseudo-terminal, or the sketch on a simulated Mega.
"""

from __future__ import annotations

import os
import shutil
import sys
import termios
import threading
import time
from collections.abc import Callable, Iterator
from itertools import groupby
from pathlib import Path

import pytest

from tests.firmware.test_mega_text import sketch
from tests.firmware.test_uno_robot import FORWARD, NAMES, states
from tests.support.casefile import Case, all_cases
from tests.support.pty_robot import PtyRobot
from tests.support.shell import Shell
from tests.support.waiting import until
from tiniscript import robots
from tools.uno import Uno

assert sketch  # a fixture

BAUD = 9600
LOCAL_FLAGS = 3  # their place in what tcgetattr returns
ENTER = "\r"  # what a terminal sends for that key, and for a line end that is pasted
FOREVER = "SI|LOOP(FOREVER);M(50,50);W(0.1);END_LOOP"
SILENT_MS = 1200  # of the robot: after a stop it hears a second of nothing
KIT = robots.load("tinibot").kit
PAPER = [case for case in all_cases() if case.path.name == "paper.md" and "robot" in case.parts]


def picocom(*options: str) -> Callable[[str], list[str]]:
    return lambda port: ["picocom", "--baud", str(BAUD), "--nolock", *options, port]


def miniterm(*options: str) -> Callable[[str], list[str]]:
    words = [sys.executable, "-m", "serial.tools.miniterm", *options]
    return lambda port: [*words, port, str(BAUD)]


# The program with its options, and what it says when it is ready.
PROGRAMS = {
    "picocom, CR": (picocom(), "Terminal ready"),
    "picocom, LF, echo": (picocom("--echo", "--omap", "crlf"), "Terminal ready"),
    "picocom, CR LF, echo": (picocom("--echo", "--omap", "crcrlf"), "Terminal ready"),
    "miniterm, CR LF": (miniterm(), "Miniterm on"),
    "miniterm, LF, echo": (miniterm("--eol", "LF", "--echo"), "Miniterm on"),
    "miniterm, CR": (miniterm("--eol", "CR"), "Miniterm on"),
}
LINE_ENDS = {"CR LF": b"\r\n", "LF": b"\n", "CR": b"\r"}
each_program = pytest.mark.parametrize("name", PROGRAMS)


class Terminal(Shell):
    """A terminal program at a port, and a person at it."""

    def __init__(self, name: str, port: str) -> None:
        command, ready = PROGRAMS[name]
        words = command(port)
        if not shutil.which(words[0]):
            pytest.skip(f"no {words[0]} on this computer")
        super().__init__(words, {**os.environ, "TERM": "xterm"})
        self.until(ready)
        until(
            lambda: not termios.tcgetattr(self._terminal)[LOCAL_FLAGS] & termios.ECHO,
            "it takes the terminal over",
        )

    def type_letters(self, text: str) -> None:
        """Type a letter, and another one when that has gone."""
        for letter in text:
            self.type(letter)
            time.sleep(0.02)

    def leave(self) -> None:
        """Leave picocom by its keys, miniterm by its one; the other's go to the robot."""
        self.type("\x01\x18\x1d")
        self.end()


@pytest.fixture
def pty_robot() -> Iterator[PtyRobot]:
    with PtyRobot(KIT, bytes_per_ms=1) as found:
        rest(found, 1000)  # a new robot saves who it is
        yield found


def rest(robot: PtyRobot, milliseconds: int = SILENT_MS) -> None:
    """Let time pass on the robot's clock."""
    end_ms = robot.robot_ms + milliseconds
    robot.until(lambda: robot.robot_ms >= end_ms, "its time passes")


@each_program
def test_a_person_types_letter_by_letter(name: str, pty_robot: PtyRobot) -> None:
    terminal = Terminal(name, pty_robot.port)
    line = "si | f(0.3, 80)"
    terminal.type_letters(line + ENTER)
    seen = terminal.until(r"// DONE\r+\n")
    assert [row for row in seen.split() if row != "//"][-2:] == ["OK", "DONE"]
    assert seen.count("//") == 2
    assert (line in seen) == ("echo" in name)  # its own echo is on the screen, once
    assert pty_robot.did == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]
    assert pty_robot.heard == line.encode() + LINE_ENDS[name.split(", ")[1]]
    terminal.leave()


@each_program
def test_s_without_a_line_end_stops(name: str, pty_robot: PtyRobot) -> None:
    terminal = Terminal(name, pty_robot.port)
    terminal.type_letters(FOREVER + ENTER)
    terminal.until("// OK")
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    terminal.type("s")
    terminal.until("// STOPPED")
    assert not pty_robot.moves
    assert pty_robot.heard.endswith(b"s")
    terminal.type_letters(ENTER)
    rest(pty_robot)
    terminal.type_letters("F(9, 50)" + ENTER)
    terminal.until(r"// It was stopped. Begin with SI\|")
    terminal.type_letters("SI|F(0.1, 50)" + ENTER)
    terminal.until("// DONE")
    terminal.leave()


def motors(lines: list[str]) -> list[str]:
    """Return what the motors did, each change once."""
    words = (line[line.index("MOTORS") :] for line in lines if "MOTORS" in line)
    return [each for each, _ in groupby(words)]


@pytest.mark.parametrize("case", PAPER, ids=lambda case: case.title)
def test_a_paper_program_is_pasted_in_one_go(case: Case, pty_robot: PtyRobot) -> None:
    """What it does in its first two seconds is what `tsc run` says; S ends it."""
    readings = dict(
        row.split(" = ") for row in case.parts.get("senses", "").splitlines() if " = " in row
    )
    first = [
        round(float(readings.get(sensor.name, "50").split(",")[0]) * 1000) for sensor in KIT.sensors
    ]
    pty_robot.ask(lambda robot: robot.sense(*first))
    is_tellable = all("," not in each for each in readings.values())
    text = case.parts["tiniscript"]
    terminal = Terminal("picocom, CR", pty_robot.port)
    terminal.type(text.replace("\n", ENTER) + ENTER)
    said = terminal.until(r"//.*\r\n")
    if text.startswith("PING"):
        assert f"kit {KIT.fingerprint:04x}" in said
    elif text.startswith("SB"):
        assert "// OK. The button starts it." in said
        pty_robot.push()
        pty_robot.until(lambda: pty_robot.moves, "it drives")
    else:
        assert "// OK" in said
    rest(pty_robot, 2000)
    wanted, found = motors(case.parts["robot"].splitlines()), motors(pty_robot.did)
    known = len(found) if is_tellable else 2  # then the next reading is another one
    assert bool(found) == bool(wanted)
    assert found[:known] == wanted[: len(found)][:known]
    terminal.type_letters("S" + ENTER)
    terminal.until("// STOPPED")
    assert not pty_robot.moves
    terminal.leave()


def test_a_terminal_that_echoes_all_starts_no_conversation(pty_robot: PtyRobot) -> None:
    """What the robot says comes back to it, as from a module whose RX and TX touch."""
    port = os.open(pty_robot.port, os.O_RDWR | os.O_NOCTTY)
    said = bytearray()
    is_over = threading.Event()

    def echo() -> None:
        while not is_over.is_set():
            data = os.read(port, 4096)
            said.extend(data)
            os.write(port, data)

    thread = threading.Thread(target=echo, daemon=True)
    thread.start()
    try:
        for line in (b"FOO(1)\r\n", b"HELLO ROBOT\r\n", b"SI|F(0.1,50)\r\n"):
            before = bytes(said).count(b"\n")
            os.write(port, line)
            pty_robot.until(lambda n=before: bytes(said).count(b"\n") > n, "it answers")  # type: ignore[misc]
            rest(pty_robot)
        rest(pty_robot, 3000)
    finally:
        is_over.set()
        pty_robot.say(b"\n")  # the thread waits for a byte
        thread.join()
        os.close(port)
    answers = [row.rpartition(": ")[2] for row in bytes(said).decode().splitlines()]
    assert answers[:4] == ["Unknown word", "Unknown word", "// OK", "// DONE"]
    assert bytes(said).count(b"//") == 4


def test_picocom_drives_the_sketch_on_a_simulated_mega(sketch: Path, tmp_path: Path) -> None:
    with Uno(
        sketch, names=NAMES, board="mega", eeprom=tmp_path / "eeprom", resets_on_open=False
    ) as mega:
        mega.run_ms(300)
        mega.go()
        terminal = Terminal("picocom, CR LF, echo", mega.pty)
        terminal.type_letters("SI|R(1, 500)" + ENTER)
        terminal.until("// 500: 0 to 100")
        terminal.type_letters(FOREVER + ENTER)
        terminal.until("// OK")
        mega.wait_for(lambda event: event.what == "pin" and states(mega) == FORWARD)
        terminal.type("S")
        terminal.until("// STOPPED")
        mega.pause()
        assert states(mega)["left"] == states(mega)["right"] == "low"
        mega.go()
        terminal.leave()
