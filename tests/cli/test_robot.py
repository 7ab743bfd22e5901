"""The command and a robot: real processes, a real port, the whole firmware behind it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
from pathlib import Path

import pytest

from tests.machines.host_firmware import missing
from tests.support.command import FOREVER, LONG, OBSTACLE, TSC, Tsc, ended, process, running
from tests.support.pty_robot import PtyRobot, on
from tiniscript import compile_text, robots
from tiniscript.cli.robot import connect
from tiniscript.library import opening
from tiniscript.link import known_ports, ports, requests
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import DeviceInfo

pytest.importorskip("pty", reason="Windows has no pseudo-terminals of this kind")
pytestmark = pytest.mark.skipif(bool(missing()), reason=missing() or "there is a compiler")

KIT = robots.load("tinibot").kit


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody waits long for a robot that will not answer."""
    monkeypatch.setattr(opening, "ANSWER_MS", 800)
    monkeypatch.setattr(opening, "CABLE_ANSWER_MS", 800)
    monkeypatch.setattr(opening, "LONG_QUIET_S", 0.1)
    monkeypatch.setattr(connect, "PATIENCE_MS", 800)


# -- upload and start ---------------------------------------------------------------------------


def test_upload_runs_the_program_and_stays_until_it_ends(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    program = tmp_path / "drive.ts"
    program.write_text("SI|F(0.2, 80)\nSHOW(DISTANCE + 1.5); SHOW(TRUE)\n", encoding="utf-8")
    pty_robot.ask(lambda robot: robot.sense(0, 0, 42_000))
    done = on(pty_robot, "upload", program)
    assert (done.code, done.err) == (0, "")
    receipt, *rest = done.out.splitlines()
    image = compile_text(program.read_text(encoding="utf-8"), KIT).image
    assert receipt.startswith(f"{program} -> tinibot ({pty_robot.port})   {len(image)} bytes")
    assert f"checksum {int.from_bytes(image[10:14], 'little'):08x}" in receipt
    assert receipt.endswith("saving   SI: running")
    assert rest == ["SHOW 43.5", "SHOW TRUE", "Done.", "Saved in slot 0."]
    assert pty_robot.did == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


@pytest.mark.parametrize(
    ("text", "trace"),
    [
        ("SI|F(5, 80)", ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]),
        (
            "SI|LOOP(3);F(2, 50);END_LOOP",
            [*["MOTORS 50 50", "MOTORS 0 0"] * 3, "FINISHED"],
        ),
        (OBSTACLE, ["MOTORS 80 80", "MOTORS 0 0", "MOTORS 60 -60", "MOTORS 0 0", "MOTORS 80 80"]),
    ],
)
def test_the_papers_programs_arrive_and_run(
    pty_robot: PtyRobot, text: str, trace: list[str]
) -> None:
    done = on(pty_robot, "upload", "-e", text, "--detach")
    assert done.code == 0
    assert done.out.endswith("SI: running without tsc\n")
    pty_robot.ask(lambda robot: robot.wait(7000))
    assert pty_robot.did[: len(trace)] == trace


def test_a_program_that_waits_ends_with_its_receipt(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "upload", "-e", "SB|F(0.1, 80)")
    assert (done.code, pty_robot.did) == (0, [])
    assert "SB: waits for the button or tsc start\nSaved in slot" in done.out
    pty_robot.push()
    pty_robot.until(lambda: "FINISHED" in pty_robot.did, "the button starts it")
    done = on(pty_robot, "start")
    assert done.code == 0
    assert done.out.endswith("Done.\n")
    assert pty_robot.did.count("FINISHED") == 2


def test_a_longer_program_goes_in_pieces_and_comes_back(
    pty_robot: PtyRobot, tmp_path: Path
) -> None:
    ours, theirs = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    process("compile", "-e", LONG, "-o", ours)
    done = on(pty_robot, "upload", ours, "--no-run", "--no-save")
    assert (done.code, pty_robot.did) == (0, [])
    assert "in RAM only   SI: waits" in done.out
    done = on(pty_robot, "fetch", "-o", theirs)
    assert done.code == 0
    assert theirs.read_bytes() == ours.read_bytes()
    listing = on(pty_robot, "fetch").out
    assert listing.split("\n", 1)[1] == process("show", ours).out.split("\n", 1)[1]


def test_noise_on_the_line_costs_time_and_nothing_else(pty_robot: PtyRobot, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    process("compile", "-e", LONG, "-o", ours)
    pty_robot.damages = 211
    assert on(pty_robot, "upload", ours, "--no-run", "--no-save").code == 0
    assert on(pty_robot, "fetch", "-o", theirs).code == 0
    assert theirs.read_bytes() == ours.read_bytes()
    assert json.loads(on(pty_robot, "info", "--json").out)["damaged"] > 0


def test_the_receipt_is_data_too(pty_robot: PtyRobot) -> None:
    done = on(
        pty_robot, "upload", "-e", "SI|SHOW(0.5);SHOW(2);SHOW(FALSE);X = 0;SHOW(1 / X)", "--json"
    )
    assert done.code == 1
    lines = [json.loads(line) for line in done.out.splitlines()]
    assert [line["event"] for line in lines] == [
        "RECEIPT",
        "SHOW",
        "SHOW",
        "SHOW",
        "FAULT",
        "SAVED",
    ]
    assert [line["value"] for line in lines[1:4]] == [0.5, 2, False]
    assert (lines[0]["start"], lines[0]["is_running"], lines[0]["saved"]) == ("SI", True, "SAVING")
    assert lines[0]["is_pushed"] is False
    assert (lines[4]["fault"], lines[4]["line"]) == ("DIVIDE_BY_ZERO", 1)


def test_a_fault_names_its_line(pty_robot: PtyRobot, tmp_path: Path) -> None:
    program = tmp_path / "divide.ts"
    program.write_text("SI|F(0.1, 50)\nX = 0\nSHOW(1 / X)\n", encoding="utf-8")
    done = on(pty_robot, "upload", program, "--lang", "es")
    assert done.code == 1
    assert "falla DIVIDE_BY_ZERO" in done.err
    assert "línea 3:  SHOW(1 / X)" in done.err
    assert not pty_robot.moves
    done = on(pty_robot, "info")  # the text is in the cache
    assert "divide.ts, line 3:  SHOW(1 / X)" in done.out
    assert on(pty_robot, "start").code == 1


def test_mistakes_keep_the_program_off_the_robot(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "upload", "-e", "F(2 80)")
    assert done.code == 1
    assert "TS017" in done.err
    assert pty_robot.heard == b""


def test_what_does_not_fit_is_said_with_numbers(pty_robot: PtyRobot, tmp_path: Path) -> None:
    target = tmp_path / "a.bin"
    process("compile", "-e", "SHOW(TIME * 1.234);" * 90, "-o", target, "--robot", "grabber")
    done = on(pty_robot, "upload", target)
    assert done.code == 1
    assert "540 bytes of code, 151 more than the robot has room for (389)" in done.err
    done = on(pty_robot, "upload", "-e", "SHOW(LINE_L)", "--robot", "liner")
    assert done.code == 3
    assert "--robot tinibot" in done.err
    done = on(pty_robot, "start")
    assert done.code == 3
    assert "tsc upload" in done.err


def test_a_long_way_has_a_bar_that_is_gone_at_the_end() -> None:
    pty, pyte = pytest.importorskip("pty"), pytest.importorskip("pyte")
    with PtyRobot(KIT, bytes_per_ms=1) as pty_robot:
        ours, theirs = pty.openpty()
        command = subprocess.Popen(
            [*TSC, "upload", "-e", LONG, "--no-run", "--no-save", "--port", pty_robot.port],
            stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs,
        )  # fmt: skip
        os.close(theirs)
        written = b""
        while part := _rest(ours):
            written += part
        os.close(ours)
        assert command.wait(30) == 0
    assert b"sending [" in written
    screen = pyte.Screen(200, 5)
    pyte.ByteStream(screen).feed(written)
    assert screen.display[0].startswith("-e -> tinibot")
    assert "sending" not in "".join(screen.display)


# -- endings ------------------------------------------------------------------------------------


def test_a_port_that_another_program_uses_is_said(pty_robot: PtyRobot) -> None:
    import serial

    with serial.Serial(pty_robot.port, exclusive=True):
        done = on(pty_robot, "stop")
        assert done.code == 3
        assert "another program is using the port" in done.err
    assert pty_robot.heard == b""


def test_ctrl_c_stops_the_robot(pty_robot: PtyRobot) -> None:
    command = running("upload", "-e", FOREVER, "--port", pty_robot.port)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    pressed_ms = pty_robot.robot_ms
    command.send_signal(signal.SIGINT)
    done = ended(command)
    assert done.code == 2
    assert "Stopped: the robot has confirmed it." in done.err
    assert pty_robot.did[-1] == "MOTORS 0 0"
    assert int(pty_robot.timed[-1].split()[0]) <= pressed_ms + 1000
    assert on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").code == 0


def test_stop_stops_what_runs_alone(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "upload", "-e", FOREVER, "--detach").code == 0
    assert pty_robot.moves
    done = on(pty_robot, "stop")
    assert done.code == 0
    assert "has confirmed it" in done.out
    assert not pty_robot.moves


def test_the_button_ends_it_for_the_command_too(pty_robot: PtyRobot) -> None:
    command = running("upload", "-e", FOREVER, "--port", pty_robot.port)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    pty_robot.push()
    done = ended(command)
    assert done.code == 3
    assert "with its button" in done.out


def test_a_command_that_is_killed_leaves_a_robot_that_stops(pty_robot: PtyRobot) -> None:
    command = running("upload", "-e", FOREVER, "--port", pty_robot.port)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    command.kill()
    command.communicate()
    pty_robot.until(lambda: not pty_robot.moves, "it stops by itself")
    assert "LINK_LOST" in on(pty_robot, "info").out


def test_a_cable_that_is_pulled_is_said(pty_robot: PtyRobot) -> None:
    command = running("upload", "-e", FOREVER, "--port", pty_robot.port)
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    pty_robot.pull()
    done = ended(command)
    assert done.code == 3
    assert "is gone" in done.err


def test_power_lost_in_the_middle_leaves_the_old_program(
    tsc: Tsc, hasty: None, tmp_path: Path
) -> None:
    with PtyRobot(KIT, bytes_per_ms=2) as pty_robot:
        old = tmp_path / "old.bin"
        process("compile", "-e", "SB|F(0.1, 40)", "-o", old)
        assert on(pty_robot, "upload", old).code == 0
        pty_robot.off_after = 250
        done = tsc("upload", "-e", LONG, "--port", pty_robot.port)
        assert done.code == 3
        assert "lost the connection to the robot" in done.err
        pty_robot.switch_on()
        assert on(pty_robot, "fetch", "-o", tmp_path / "new.bin").code == 0
        assert (tmp_path / "new.bin").read_bytes() == old.read_bytes()


# -- who is there -------------------------------------------------------------------------------


def test_a_robot_describes_itself_and_its_port_is_remembered(pty_robot: PtyRobot) -> None:
    assert process("info").code == 3  # which port?
    done = on(pty_robot, "ping", "--count", "3")
    assert done.code == 0
    assert "3 round trips" in done.out
    known = json.loads(process("info", "--json").out)
    assert (known["port"], known["kit"], known["robot"]) == (
        pty_robot.port, f"{KIT.fingerprint:04x}", "tinibot",
    )  # fmt: skip
    assert known["program"] is None
    assert known["text_level"] == "uno"
    assert "reads text, level uno" in done.out
    assert json.loads(process("ping", "--json").out)["round_trips"] == 10
    assert "10 round trips" in process("upload", "-e", "PING|check_connection").out


@pytest.mark.parametrize(("features", "level", "said"), [
    (0, None, "no lee texto"),
    (1, "uno", "lee texto, nivel uno"),
    (0xFFFE, "mega", "lee texto, nivel mega"),  # whatever else it is able to do
    (0x3, "esp32", "lee texto, nivel esp32"),
])  # fmt: skip
def test_the_level_of_text_is_that_of_two_bits(
    pty_robot: PtyRobot, tsc: Tsc, monkeypatch: pytest.MonkeyPatch,
    features: int, level: str | None, said: str,
) -> None:  # fmt: skip
    described = requests.described

    def with_features(values: HelloReply) -> DeviceInfo:
        return described(values._replace(features=features))

    monkeypatch.setattr(requests, "described", with_features)
    found = tsc("info", "--port", pty_robot.port, "--json")
    assert json.loads(found.out)["text_level"] == level
    assert said in tsc("info", "--port", pty_robot.port, "--lang", "es").out


def test_a_board_that_has_just_been_reset_is_waited_for(pty_robot: PtyRobot) -> None:
    pty_robot.switch_off()
    timer = threading.Timer(2, pty_robot.switch_on)  # python has to start, too
    timer.start()
    done = on(pty_robot, "upload", "-e", "SI|F(0.1, 30)")
    assert done.code == 0
    timer.join()


def test_a_name_survives_power_off(pty_robot: PtyRobot) -> None:
    done = on(pty_robot, "name", "Ñandú")
    assert (done.code, done.out) == (0, f"{pty_robot.port}: the robot is called Ñandú now.\n")
    pty_robot.switch_off()
    pty_robot.switch_on()
    assert json.loads(on(pty_robot, "info", "--json").out)["name"] == "Ñandú"
    for name in ("", " ", "a" * 17, "ñ" * 9, "a\nb"):
        assert on(pty_robot, "name", name).code == 2
    assert "Ñandú, remembered   last used" in process("ports").out


def test_ports_asks_only_when_it_is_told_to(tsc: Tsc, pty_robot: PtyRobot, hasty: None) -> None:
    known_ports.remember(pty_robot.port, "TINI")
    rows = json.loads(tsc("ports", "--json").out)
    row = next(row for row in rows if row["port"] == pty_robot.port)
    assert (row["remembered"], row["is_last_used"]) == ("TINI", True)
    assert pty_robot.heard == b""
    assert "robot tinibot" in tsc("ports", "--ask", "--port", pty_robot.port).out
    pty_robot.switch_off()
    assert "nothing answers" in tsc("ports", "--ask", "--port", pty_robot.port).out
    assert "there is no port" in tsc("ports", "--ask", "--port", "/dev/no-such").out


def test_a_person_without_a_port_is_asked_for_one(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = [ports.Found("/dev/ttyS77", "a modem"), ports.Found(pty_robot.port, "a robot")]
    monkeypatch.setattr(ports, "listed", lambda: found)
    answers = iter(["7\n", "what?\n", "2\n"])
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("sys.stdin.readline", lambda: next(answers))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    done = tsc("ping")
    assert done.code == 0
    assert f"  2  {pty_robot.port}   a robot\n" in done.err
    assert done.err.count("1 to 2: ") == 3
    assert tsc("info").err == ""  # it is remembered


def test_nobody_something_else_and_another_version(
    tsc: Tsc, pty_robot: PtyRobot, hasty: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as newer:
        newer.setattr("tiniscript.link.handshake.MAJOR", 2)
        done = tsc("ping", "--port", pty_robot.port)
        assert done.code == 3
        assert "speaks version 1 of the link" in done.err
    pty_robot.switch_off()
    done = tsc("ping", "--port", pty_robot.port)
    assert done.code == 3
    assert "nothing answers" in done.err
    for said in (b"Hello from another sketch\r\n", bytes(range(1, 256)) * 3, b"\xff" * 99):
        timer = threading.Timer(0.3, pty_robot.say, [said])
        timer.start()
        done = tsc("ping", "--port", pty_robot.port)
        assert done.code == 3
        assert "not TiniScript" in done.err
        timer.join()
    done = tsc("ping", "--port", "loop://")
    assert done.code == 3
    assert "is sent to loop:// comes back" in done.err


@pytest.mark.parametrize("verb", ["ping", "stop", "start", "info", "fetch", "monitor", "live"])
def test_ports_that_are_none(tsc: Tsc, verb: str, tmp_path: Path) -> None:
    for language in ("en", "es"):
        for port in ("/dev/no-such-port", str(tmp_path), os.devnull, "nix://a", "socket://a",
                     "socket://127.0.0.1:1", "a" * 5000):  # fmt: skip
            done = tsc(verb, "--port", port, "--lang", language)
            assert (done.code, done.out) == (3, "")
            assert done.err.startswith("tsc: ")
        for port in ("", "a\0b"):
            assert tsc(verb, "--port", port, "--lang", language).code == 2
        assert tsc(verb, "--lang", language).code == 3
        assert tsc(verb, "--port", "x", "--baud", "fast", "--lang", language).code == 2


def test_every_reason_has_a_sentence_with_a_next_step(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    from serial import SerialException

    monkeypatch.setattr("tiniscript.library.opening.BUSY_S", 0)
    for failure, word in (
        (SerialException(13, "Permission denied"), "dialout" if os.name == "posix" else "may not"),
        (SerialException(16, "Device or resource busy"), "another program"),
        (SerialException("could not open port 'COM5': PermissionError(13, 'Access')"), "another"),
        (SerialException("could not open port 'COM5': FileNotFoundError(2, '')"), "no port"),
        (SerialException("could not open port 'COM5': OSError(22, 'semaphore')"), "cannot reach"),
        (SerialException("something new"), "something new"),
        (OSError(112, "Host is down"), "cannot reach" if os.name == "posix" else ""),
    ):

        def refuse(*_: object, failure: Exception = failure, **__: object) -> None:
            raise failure

        monkeypatch.setattr("serial.serial_for_url", refuse)
        done = tsc("ping", "--port", "COM5")
        assert done.code == 3
        assert word in done.err


def test_a_port_that_never_opens_is_given_up(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    hangs = threading.Event()
    monkeypatch.setattr("serial.serial_for_url", lambda *_, **__: hangs.wait(30))
    with pytest.raises(ports.PortError) as failure:
        ports.opened("COM5", 9600, limit_s=0.1)
    assert failure.value.reason == ports.SLOW
    hangs.set()


# -- monitor ------------------------------------------------------------------------------------


def test_monitor_writes_what_the_robot_shows(pty_robot: PtyRobot, tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    assert (
        on(pty_robot, "upload", "-e", "SB|SHOW(1.5);W(0.1);SHOW(TRUE);X = 0;SHOW(1 / X)").code == 0
    )
    command = running("monitor", "--port", pty_robot.port, "--csv", str(rows), "--json")
    assert command.stderr
    command.stderr.readline()  # it watches
    pty_robot.push()
    pty_robot.until(
        lambda: "FAULT" in rows.read_text(encoding="utf-8"), "the fault is written down"
    )
    command.send_signal(signal.SIGINT)
    done = ended(command)
    assert done.code == 0
    events = [json.loads(line) for line in done.out.splitlines()]
    assert [event["event"] for event in events] == ["SHOW", "SHOW", "FAULT"]
    assert [row.split(",")[1:] for row in rows.read_text(encoding="utf-8").splitlines()] == [
        ["event", "value"], ["SHOW", "1.5"], ["SHOW", "TRUE"], ["FAULT", "DIVIDE_BY_ZERO"],
    ]  # fmt: skip


def test_monitor_keeps_the_last_rows_where_no_robot_answers(tmp_path: Path) -> None:
    rows = tmp_path / "rows.csv"
    rows.write_text("ms,event,value\n1,SHOW,5\n", encoding="utf-8")
    done = process("monitor", "--port", tmp_path / "no-port", "--csv", rows, "--max-time", "1")
    assert done.code == 3
    assert rows.read_text(encoding="utf-8") == "ms,event,value\n1,SHOW,5\n"


def test_monitor_draws_a_curve(pty_robot: PtyRobot) -> None:
    pty = pytest.importorskip("pty")
    assert on(pty_robot, "upload", "-e", "SB|SHOW(-2.5);W(0.3);SHOW(7);W(0.3);SHOW(TRUE)").code == 0
    ours, theirs = pty.openpty()
    environ = {**os.environ, "TERM": "xterm", "COLUMNS": "80", "LINES": "24"}
    command = subprocess.Popen(
        [*TSC, "monitor", "--port", pty_robot.port, "--plot"],
        stdin=subprocess.DEVNULL, stdout=theirs, stderr=theirs, env=environ,
    )  # fmt: skip
    os.close(theirs)
    written = b""
    while "── SHOW".encode() not in written:
        written += os.read(ours, 65536)
    pty_robot.push()
    while b"Done." not in written or "── SHOW 1 ".encode() not in written:
        written += os.read(ours, 65536)
    command.send_signal(signal.SIGINT)
    while part := _rest(ours):
        written += part
    assert command.wait(30) == 0
    os.close(ours)
    seen = written.decode()
    assert "SHOW -2.5" in seen and "SHOW TRUE" in seen
    assert any("⠀" < letter <= "⣿" for letter in seen)
    assert seen.endswith("\n")


def _rest(terminal: int) -> bytes:
    try:
        return os.read(terminal, 65536)
    except OSError:  # Linux: the other end is closed
        return b""


@pytest.mark.parametrize("values", [[], [(0, 5)], [(0, -5), (900, 7000), (20_000, 7000)]])
def test_every_curve_fits_its_terminal(values: list[tuple[int, int]]) -> None:
    from tiniscript.cli.terminal.plot import Plot

    plot = Plot()
    for time_ms, value in values:
        plot.take(time_ms, value, is_yes_no=False)
    for now_ms in (20_000, 45_000, 90_000):
        for width in (1, 2, 5, 8, 20, 80, 200):
            for height in (1, 2, 3, 8, 50):
                lines = plot.lines(width, height, now_ms)
                assert 1 <= len(lines) <= height
                assert all(line.cell_len <= width for line in lines)


def test_monitor_and_a_full_disk(pty_robot: PtyRobot, tmp_path: Path) -> None:
    files = [Path("/dev/full"), tmp_path, tmp_path / "no" / "such"]
    for file in files if files[0].exists() else files[1:]:
        done = on(pty_robot, "monitor", "--csv", file, "--max-time", "1")
        assert (done.code, done.out) == (2, "")
        assert "--csv" in done.err
    assert on(pty_robot, "monitor", "--max-time", "1").code == 0
