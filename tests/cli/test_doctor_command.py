"""`tsc doctor` with real ports: it disturbs nothing, and its report has no names."""

from __future__ import annotations

import getpass
import io
import json
import re
import signal
import socket
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support import foreign_boards as boards
from tests.support.command import FOREVER, Command, Tsc, run_in_process, run_subprocess
from tests.support.pty_end import PtyEnd
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.simulated_ends import Firmware
from tiniscript.doctor import report
from tiniscript.doctor.computer import ON, Adapter, Computer
from tiniscript.doctor.findings import sure_finding
from tiniscript.link.ports import ListedPort, open_port
from tiniscript.link.sharing import registry


def causes(done_out: str) -> list[str]:
    return [finding["cause"] for finding in json.loads(done_out)["findings"]]


# -- the whole firmware -------------------------------------------------------------------------


def test_a_healthy_robot_is_reported_as_fine(pty_robot: PtyRobot) -> None:
    bytes_before: list[bytes] = []
    pty_robot.until(lambda: pty_robot.robot_ms > 500, "a new robot has kept its id")
    pty_robot.ask(lambda robot: bytes_before.append(robot.memory()))
    result = on(pty_robot, "doctor").gives(0, "")
    finding_lines, robot, ports = (part.splitlines() for part in result.out.split("\n\n"))
    assert finding_lines == [
        f"Port {pty_robot.port}",
        "1. tinibot is fine (sure)",
        "   seen: kit tinibot, id 12345678; it answered 20 messages and did not restart",
        "   next: Nothing to do. If it restarts when it drives:  tsc doctor --watch 20",
    ]
    assert robot[0] == f"tinibot on {pty_robot.port}, id 12345678, free"
    assert "no program" in robot and robot[-1].startswith("20 round trips: ")
    assert ports[0] == "Ports on this computer:" and f"{pty_robot.port}   last used" in ports
    assert pty_robot.actions == []
    pty_robot.ask(lambda robot: bytes_before.append(robot.memory()))
    assert bytes_before[0] == bytes_before[1]


@pytest.mark.parametrize("is_others", [False, True])
def test_a_run_continues_during_an_examination(pty_robot: PtyRobot, is_others: bool) -> None:
    """Both a run left alone, and one that another tsc attends."""
    if is_others:
        command = start_endless_upload(pty_robot)
    else:
        assert on(pty_robot, "upload", "-e", FOREVER, "--detach", "--no-save").code == 0
    result = on(pty_robot, "doctor", "--json")
    expected = ["not_saved_yet", "fine"] if is_others else ["fine"]
    assert (result.code, causes(result.out)) == (0, expected)
    assert pty_robot.moves
    assert "FINISHED" not in pty_robot.actions
    if is_others:
        command.kill()


def test_the_doctor_asks_through_the_command_that_holds_the_port(
    link: Command, pty_robot: PtyRobot
) -> None:
    on(pty_robot, "doctor", "--lang", "es").gives(0, out="1. tinibot está bien (seguro)")
    assert on(pty_robot, "doctor", "--identify").code == 0


def test_faults_of_a_robot_are_reported(pty_robot: PtyRobot) -> None:
    """Another kit than that of the robot that was named, weak batteries, and a bad line."""
    on(pty_robot, "doctor", "--robot", "liner").gives(
        3, out=("(tinibot), not the kit of liner", "--robot tinibot")
    )
    pty_robot.ask(lambda robot: robot.set_supply(True))
    on(pty_robot, "upload", "-e", "SB|F(1, 50)")
    result = on(pty_robot, "doctor", "--json")
    assert (result.code, causes(result.out)) == (3, ["low_supply"])
    pty_robot.damages = 97
    result = on(pty_robot, "doctor", "--json").gives(3)
    assert "lossy" in causes(result.out)


def test_a_restart_while_driving_is_reported(pty_robot: PtyRobot) -> None:
    """Its power fails when the motors start; this chip only reports a power-on."""
    on(pty_robot, "upload", "-e", FOREVER, "--detach", "--no-save")
    command = Command("doctor", "--port", pty_robot.port, "--watch", "12", "--json")
    heard_count = len(pty_robot.received)
    pty_robot.until(lambda: len(pty_robot.received) > heard_count + 200, "it is watched")
    pty_robot.power_cycle()
    result = command.wait_for_result().gives(3)
    (finding,) = (finding for finding in json.loads(result.out)["findings"] if finding["is_wrong"])
    assert (finding["cause"], finding["is_sure"]) == ("motors_restart", False)
    assert finding["said"] == "Your robot restarted when the motors started: check the batteries"
    assert finding["values"]["reset"] == "POWER"


def test_a_stop_gets_through_while_a_robot_is_watched(pty_robot: PtyRobot) -> None:
    on(pty_robot, "upload", "-e", FOREVER, "--detach", "--no-save")
    command = Command("doctor", "--port", pty_robot.port, "--watch", "60")
    pty_robot.until(lambda: registry.find_registration(pty_robot.port) is not None, "it is watched")
    assert pty_robot.moves
    # The wait is part of the doctor's time.
    assert run_subprocess("stop", "--port", pty_robot.port).code == 0
    assert not pty_robot.moves
    command.signal(signal.SIGINT)
    command.wait_for_result().gives(2)


# -- other things -------------------------------------------------------------------------------


def test_a_port_locked_by_another_program_is_reported() -> None:
    with PtyEnd(Firmware()) as end:
        holder = open_port(end.port, 9600)
        result = run_in_process("doctor", "--port", end.port)
        holder.close()
        assert result.code == 3
        assert "1. Another program is using this port (sure)" in result.out
        assert "does not say by which program" in result.out
        assert run_in_process("doctor", "--port", end.port).code == 0


def test_other_devices_and_foreign_firmware_are_recognized(tsc: Tsc) -> None:
    """Uses a real port; each cause by itself is in `tests/doctor/`."""
    with PtyEnd(Firmware(57_600)) as pty_end:
        result = tsc("doctor", "--port", pty_end.port, "--json")
    assert (result.code, causes(result.out)) == (3, ["wrong_baud"])
    with PtyEnd(Firmware(name=b"\x1b[2J\nANA")) as pty_end:
        result = tsc("doctor", "--port", pty_end.port)
    assert result.code == 0
    assert "\x1b" not in result.out, "it cannot move the cursor"
    assert len(result.out.split("\n\n")[0].splitlines()) == 4


SEVEN_BOARDS = [
    (boards.FirmataBoard(57_600), "firmata", "The board runs Firmata", "StandardFirmata.ino 2.5"),
    (boards.MbotBoard(115_200), "mbot", "The board has the firmware of an mBot", "06.01.009"),
    (boards.LineEchoSketch(9600), "echo_sketch", "a sketch that sends back", "came back"),
    (boards.SnekBoard(115_200), "snek", "The board runs Snek", ">"),
    (boards.PythonBoard(115_200), "micropython", "The board runs MicroPython", "CTRL-B"),
    (boards.BrownoutBoard(115_200), "esp32_brownout", "The ESP32's voltage drops",
     "Brownout detector was triggered"),
    (boards.AtBoard(115_200), "at_firmware", "Espressif's AT firmware", "AT version:2.2.0.0"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("end", "cause", "board_name", "heard_text"), SEVEN_BOARDS, ids=[row[1] for row in SEVEN_BOARDS]
)
def test_a_foreign_board_at_a_real_port_is_reported(
    tsc: Tsc, end: boards.Board, cause: str, board_name: str, heard_text: str
) -> None:
    """The speed is that of a robot with an HC-05, which most boards do not have."""
    with PtyEnd(end) as pty_end:
        result = tsc("doctor", "--port", pty_end.port, "--json").gives(3)
    (finding,) = json.loads(result.out)["findings"]
    assert (finding["cause"], finding["is_sure"]) == (cause, True)
    assert board_name in finding["said"] and heard_text in finding["seen"] and finding["next"]


@pytest.mark.parametrize(("board", "sentence"), [
    (boards.BrownoutBoard, "voltage drops, and it restarts"),
    (boards.MbotBoard, "the firmware of an mBot"),
    (boards.SnekBoard, "The board runs Snek"),
    (boards.Esp32Board, "An ESP32 is starting up here"),
])  # fmt: skip
def test_an_upload_names_the_device_that_is_there_instead_of_a_robot(
    tsc: Tsc, hasty: None, board: type[boards.Board], sentence: str
) -> None:
    """It sends only HELLO, and reads a board's start message."""
    with PtyEnd(board(9600)) as pty_end:
        words = ("upload", "-e", "SI|F(1, 50)", "--port", pty_end.port)
        result = tsc(*words).gives(3, f"no TiniScript robot responds on {pty_end.port}", sentence)
        assert "speed" not in result.err
    with PtyEnd(board(9600)) as pty_end:
        rows = json.loads(tsc("doctor", "--ports", "--ask", "--port", pty_end.port, "--json").out)
        assert sentence in rows[0]["said"]


def test_wrong_use_and_a_missing_port_are_reported(tsc: Tsc) -> None:
    for words in (
        ("--watch", "601"), ("--watch", "-1"), ("--baud", "x"), ("--robot", "nobody"),
        ("--port", ""),
    ):  # fmt: skip
        assert tsc("doctor", "--port", "/dev/not-there", *words).code == 2, words
    for port in ("/dev/not-there", "a\u202eb", "x" * 5000, "socket://127.0.0.1:1", "foo://x"):
        result = tsc("doctor", "--port", port)
        assert result.code in (2, 3)
        assert "next:" in result.out or result.code == 2


@pytest.fixture
def cable(monkeypatch: pytest.MonkeyPatch) -> Iterator[PtyEnd]:
    """A pseudo-terminal is no cable: its name does not show that here."""
    monkeypatch.setattr("tiniscript.doctor.diagnosis.PSEUDO_TERMINALS", ())
    monkeypatch.setattr("tiniscript.doctor.linux._using_programs", lambda system, port: [])
    with PtyEnd(Firmware()) as pty_end:
        yield pty_end


def test_a_cable_is_opened_only_after_consent(tsc: Tsc, cable: PtyEnd) -> None:
    result = tsc("doctor", "--port", cable.port)
    assert (result.code, cable.received) == (3, b"")
    assert "tsc doctor --yes" in result.out
    tsc("doctor", "--port", cable.port, "--yes").gives(0)
    assert cable.received


@pytest.mark.parametrize(
    ("answer", "code"), [("1\n", 0), ("yes\n", 0), ("sí\n", 0), ("2\n", 3), ("\n", 3), ("", 3)]
)
def test_the_doctor_asks_before_it_opens_a_cable(
    tsc: Tsc, cable: PtyEnd, monkeypatch: pytest.MonkeyPatch, answer: str, code: int
) -> None:
    keys = io.StringIO(answer)
    keys.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr("sys.stdin", keys)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    result = tsc("doctor", "--port", cable.port)
    assert (result.code, bool(cable.received)) == (code, code == 0)
    assert f"open {cable.port}. If the board is connected by a cable" in result.err


# -- the report ---------------------------------------------------------------------------------


def test_a_report_has_the_findings_and_no_names(tsc: Tsc, tmp_path: Path) -> None:
    file = tmp_path / "report.txt"
    private_words = (getpass.getuser(), socket.gethostname(), str(Path.home()), str(Path.cwd()))
    with PtyEnd(Firmware(name=b"ANA 6B", kit=0x1234)) as pty_end:
        tsc("doctor", "--port", pty_end.port, "--report", file).gives(3, out=str(file))
        text = file.read_text(encoding="utf-8")
        assert text.startswith(report.REPORT_MARK + "\n")
        assert "unknown_kit sure" in text and "next: Name its profile once" in text
        assert f"port: {pty_end.port}" in text
        for word in (
            "ANA",
            "6B",
            "12347f3a",
            str(tmp_path),
            *(x for x in private_words if len(x) > 2),
        ):
            assert not re.search(rf"\b{re.escape(word)}\b", text), word
        # A name of its own replaces the option.
        tsc("doctor", "--port", "/dev/not-there", "--report", file)
        assert "unknown_kit" not in file.read_text(encoding="utf-8")


def test_a_foreign_file_is_not_overwritten_by_a_report(tsc: Tsc, tmp_path: Path) -> None:
    file = tmp_path / "drive.ts"
    for text in ("SI|F(2, 80)\n", report.REPORT_MARK + " of mine\n", "x" * 100_000):
        file.write_text(text, encoding="utf-8")
        result = tsc("doctor", "--port", "/dev/not-there", "--report", file)
        assert result.code == 2, text[:50]
        assert "tsc did not write it." in result.err
        assert file.read_text(encoding="utf-8") == text
    for place in (tmp_path, tmp_path / "no" / "report.txt", Path("/dev/full")):
        tsc("doctor", "--port", "/dev/not-there", "--report", place).gives(2, "cannot be written")


@pytest.mark.parametrize(
    ("port", "shown_text"),
    [
        ("/dev/ttyUSB0", "/dev/ttyUSB0"),
        ("COM5", "COM5"),
        ("/dev/rfcomm0", "/dev/rfcomm0"),
        ("/dev/cu.usbserial-A50285BI", "/dev/cu.usbserial…"),
        ("/dev/tty.usbmodem14201", "/dev/tty.usbmodem…"),
        ("/dev/serial/by-id/usb-FTDI_A50285BI", "…"),
        ("/dev/tty.HC-05-Ana", "Bluetooth …"),
        ("socket://ana.school.example:7000", "socket://…"),
        ("/home/ana/port", "…"),
    ],
)
def test_a_report_lists_the_ports(port: str, shown_text: str) -> None:
    assert report.redacted_port(port) == shown_text


def test_a_report_contains_no_values_of_other_programs() -> None:
    finding = sure_finding("busy", by="ModemManager, secret-tool")
    assert report.values_of(finding) == {"by": "ModemManager, …"}
    finding = sure_finding("fine", name="ANA", kit="tinibot", id="12347f3a", n="20")
    assert report.values_of(finding) == {"name": "…", "kit": "tinibot", "id": "…", "n": "20"}
    finding = sure_finding("port_broken", why="could not open /home/ana/x")
    assert report.values_of(finding) == {"why": "…"}
    finding = sure_finding("port_missing", ports="COM3, /dev/cu.usbserial-A50285BI")
    assert report.values_of(finding) == {"ports": "COM3, /dev/cu.usbserial…"}
    computer = Computer(
        "darwin", (ListedPort("/dev/cu.usbserial-A50285BI", "FT232 of ANA"),),
        (Adapter("FT232", "", "", True),), ON, ("Telephone of ANA", "HC-05"),
    )  # fmt: skip
    rows = dict(report.facts(computer))
    assert (rows["modules"], rows["ports"]) == ("1", "/dev/cu.usbserial…")
    assert "ANA" not in str(rows) and "A50285BI" not in str(rows)
