"""Real `tsc` processes and the firmware on a simulated Uno, in real time, over its pty."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.firmware.test_uno_robot import BAUD, FORWARD, NAMES, OFF, sketch, states  # noqa: F401
from tests.machines.uno import needed
from tests.support.casefile import ROOT
from tests.support.command import FOREVER, LONG, Done, process, running
from tests.support.platformio import changed
from tests.support.waiting import HANGS_S, until
from tools.uno import CYCLES_PER_MS, Uno

# The same promises are kept by the whole firmware on this computer, on every commit.
pytestmark = pytest.mark.sampled(of="programs, texts and UNDO on a simulated Uno", keep=14)

DRIVES = "SI|F(0.3, 80)"
TETHER_MS = 1050
# The last mark of the first slot for faults, written 230 ms after the fault.
FIRST_FAULT = {"address": 69, "value": 0xA5}


@pytest.fixture
def uno(sketch: Path, tmp_path: Path) -> Iterator[Uno]:  # noqa: F811
    with at_work(sketch, tmp_path / "eeprom") as found:
        yield found


def at_work(elf: Path, memory: Path) -> Uno:
    uno = Uno(elf, names=NAMES, eeprom=memory, baud=BAUD, tells_sleep=False)
    uno.go()
    return uno


def on(uno: Uno, *arguments: str) -> Done:
    return process(*arguments, "--port", uno.pty)


def drives(uno: Uno) -> int:
    """Return how often the left motor has begun to turn."""
    return sum(change.state == "pwm" for change in uno.pins.history("left"))


def has_written(uno: Uno, byte: dict[str, int]) -> bool:
    return any(event.what == "eeprom" and event.rest == byte for event in uno.events)


def test_upload_shows_and_finds_the_line_of_a_fault(uno: Uno, tmp_path: Path) -> None:
    done = on(uno, "upload", "-e", DRIVES)
    assert (done.code, drives(uno)) == (0, 1), done.err
    program = tmp_path / "fault.ts"
    program.write_text("SI|X = 2\nSHOW(X)\nM(50, 50)\nX = 1 / (X - 2)\n", encoding="utf-8")
    done = on(uno, "upload", str(program))
    assert done.code == 1
    assert "SHOW 2" in done.out
    assert re.search(r"line 4:\s+X = 1 / \(X - 2\)", done.err), done.err
    assert states(uno) == OFF
    until(lambda: has_written(uno, FIRST_FAULT), "the fault is kept")  # the next command resets it
    assert "DIVIDE_BY_ZERO" in on(uno, "info").out


def test_the_papers_obstacle_program_drives_around_an_obstacle(uno: Uno) -> None:
    uno.sonar("trigger", "echo", 50)
    command = running("upload", "--port", uno.pty, str(ROOT / "examples" / "obstacle.ts"))
    until(lambda: drives(uno) >= 2, "it drives on where nothing is in the way")
    assert states(uno) == FORWARD
    uno.sonar("trigger", "echo", 6)
    until(lambda: uno.pins["right backward"].state == "high", "it turns right")
    command.send_signal(signal.SIGINT)
    _, err = command.communicate(timeout=HANGS_S)
    assert command.returncode == 2, err
    assert states(uno) == OFF


def test_live_lines_and_a_stop_from_another_terminal(uno: Uno) -> None:
    assert on(uno, "live", "L(0.2, 50)").code == 0
    assert any(change.state == "high" for change in uno.pins.history("left backward"))
    command = running("upload", "--port", uno.pty, "-e", FOREVER)
    until(lambda: states(uno) == FORWARD, "it drives")
    resets = sum(event.what == "reset" for event in uno.events)
    stopped = on(uno, "stop")
    assert stopped.code == 0, stopped.err
    _, err = command.communicate(timeout=HANGS_S)
    assert command.returncode == 3, err
    assert states(uno) == OFF
    assert sum(event.what == "reset" for event in uno.events) == resets  # the port was open


def test_a_command_that_is_killed_takes_the_motors_with_it(uno: Uno) -> None:
    command = running("upload", "--port", uno.pty, "-e", FOREVER)
    until(lambda: states(uno) == FORWARD, "it drives")
    command.kill()
    command.communicate()
    until(lambda: states(uno) == OFF, "the motors are off")
    last = max(byte.cycle for byte in uno.received)
    off = max(uno.pins[name].cycle for name in ("left", "right"))
    assert off - last <= TETHER_MS * CYCLES_PER_MS


def test_what_is_saved_waits_for_the_button_after_a_power_cut(
    sketch: Path, tmp_path: Path  # noqa: F811
) -> None:  # fmt: skip
    memory = tmp_path / "eeprom"
    with at_work(sketch, memory) as uno:
        done = on(uno, "upload", "-e", "SB|F(0.3, 80)")
        assert done.code == 0, done.err
        assert "slot" in on(uno, "info").out
        assert drives(uno) == 0
        uno.kill()
    with at_work(sketch, memory) as uno:
        until(lambda: uno.pins["light"].state == "high", "the light says that it waits")
        assert drives(uno) == 0
        uno.press("button", 60, at=500 * CYCLES_PER_MS)  # a button that bounces is none
        until(lambda: drives(uno) == 1 and states(uno) == OFF, "it has driven")
        fetched = on(uno, "fetch")
        assert (fetched.code, "MOVE8_F 30 80" in fetched.out) == (0, True), fetched.out
        assert on(uno, "start").code == 0
        assert drives(uno) == 2


def test_what_does_not_fit_leaves_the_program_that_is_there(uno: Uno) -> None:
    assert on(uno, "upload", "-e", DRIVES, "--no-run").code == 0
    large = on(uno, "upload", "-e", ";".join([LONG] * 3))
    assert large.code == 1 and "389" in large.err
    other = on(uno, "upload", "-e", "IF(LINE_L); F(1, 80); ENDIF", "--robot", "liner")
    assert other.code == 3 and "--robot tinibot" in other.err
    assert drives(uno) == 0
    assert on(uno, "start").code == 0
    assert drives(uno) == 1


def test_noise_on_the_line_costs_time_and_nothing_else(uno: Uno) -> None:
    command = running("monitor", "--port", uno.pty)
    until(lambda: len(uno.received) > 10, "they talk")
    uno.send(b"OK+LOST\r\n" + bytes(range(1, 64)) * 2)
    done = on(uno, "upload", "-e", DRIVES)
    assert done.code == 0, done.err
    assert drives(uno) == 1
    command.send_signal(signal.SIGINT)
    command.communicate(timeout=HANGS_S)


def test_a_robot_of_another_version_is_named(tmp_path: Path) -> None:
    """Its firmware speaks version 2 of the link: HELLO of all versions says so."""
    needed()
    elf = changed(tmp_path, "link/messages.h", "kLinkMajor = 1;", "kLinkMajor = 2;")
    with at_work(elf, tmp_path / "eeprom") as uno:
        done = on(uno, "upload", "-e", DRIVES)
        assert done.code == 3
        assert "speaks version 2 of the link" in done.err, done.err
        assert drives(uno) == 0
