"""The command with a robot: a real port, and the whole firmware.

A command is a process where it is interrupted or killed.
"""

from __future__ import annotations

import json
import os
import signal
import threading
from pathlib import Path

import pytest

from tests.support.command import LONG_PROGRAM, Tsc, run_in_process
from tests.support.pty_robot import PtyRobot, on, start_endless_upload
from tests.support.simulated_port import simulate
from tiniscript import compile_text, robots
from tiniscript.library import opening
from tiniscript.link import errors, known_ports, ports, requests
from tiniscript.link.messages import MAJOR
from tiniscript.link.payloads import HelloReply
from tiniscript.link.requests import DeviceInfo
from tiniscript.link.transports import serial as serial_transport

KIT = robots.load("tinibot").kit


# -- endings ------------------------------------------------------------------------------------


def test_a_port_in_use_by_another_program_is_reported(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    import serial

    monkeypatch.setattr(opening, "STOP_BUSY_TIMEOUT_S", 0.5)
    with serial.Serial(pty_robot.port, exclusive=True):
        on(pty_robot, "stop").gives(3, "another program holds", "did not get through")
    assert pty_robot.received == b""


def test_a_robot_stops_however_its_command_ends(pty_robot: PtyRobot) -> None:
    """It stops after Ctrl-C, the robot's button, a kill, and an unplugged cable."""
    command = start_endless_upload(pty_robot)
    pressed_ms = pty_robot.robot_ms
    command.signal(signal.SIGINT)
    command.wait_for_result().gives(2, "Stopped: the robot has confirmed the stop.")
    assert pty_robot.actions[-1] == "MOTORS 0 0"
    assert int(pty_robot.timed_actions[-1].split()[0]) <= pressed_ms + 1000
    assert on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").code == 0
    command = start_endless_upload(pty_robot)
    pty_robot.push()
    command.wait_for_result().gives(3, out="with its button")
    command = start_endless_upload(pty_robot)
    command.kill()
    pty_robot.until(lambda: not pty_robot.moves, "it stops by itself")
    assert "LINK_LOST" in on(pty_robot, "doctor").out
    command = start_endless_upload(pty_robot)
    pty_robot.pull()
    command.wait_for_result().gives(3, "is gone")


def test_power_lost_in_the_middle_leaves_the_old_program(hasty: None, tmp_path: Path) -> None:
    with PtyRobot(KIT, bytes_per_ms=2) as pty_robot:
        assert on(pty_robot, "upload", "-e", "SB|F(0.1, 40)").code == 0
        pty_robot.off_after = 250
        result = run_in_process("upload", "-e", LONG_PROGRAM, "--port", pty_robot.port)
        assert result.code == 3
        assert "lost the connection to the robot" in result.err
        pty_robot.switch_on()
        assert on(pty_robot, "show", "-o", tmp_path / "new.bin").code == 0
    old_image = compile_text("SB|F(0.1, 40)", KIT).image
    assert (tmp_path / "new.bin").read_bytes() == old_image


# -- presence of a robot --------------------------------------------------------------------------


def test_a_robot_describes_itself_and_its_port_is_remembered(pty_robot: PtyRobot) -> None:
    assert run_in_process("doctor", "--identify").code == 3  # several ports are possible
    result = on(pty_robot, "doctor", "--count", "3").gives(0, out="3 round trips")
    known_fields = json.loads(run_in_process("doctor", "--json").out)["robot"]
    assert (known_fields["port"], known_fields["kit"], known_fields["robot"]) == (
        pty_robot.port, f"{KIT.fingerprint:04x}", "tinibot",
    )  # fmt: skip
    assert known_fields["program"] is None
    assert known_fields["text_level"] == "uno"
    assert "reads text, level uno" in result.out
    with simulate(pty_robot):  # otherwise late data would count as lost
        assert json.loads(run_in_process("doctor", "--json").out)["robot"]["round_trips"] == 20
        assert "10 round trips" in run_in_process("upload", "-e", "PING|check_connection").out


def test_the_text_level_is_encoded_in_two_bits(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    described = requests.device_info_of
    for features, level, expected in (
        (0, None, "no lee texto"),
        (1, "uno", "lee texto, nivel uno"),
        (0xFFFE, "mega", "lee texto, nivel mega"),  # whatever other abilities it has
        (0x3, "esp32", "lee texto, nivel esp32"),
    ):

        def with_features(values: HelloReply, features: int = features) -> DeviceInfo:
            return described(values._replace(features=features))

        monkeypatch.setattr("tiniscript.cli.commands.doctor.device_info_of", with_features)
        assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["text_level"] == level
        assert expected in on(pty_robot, "doctor", "--lang", "es").out


def test_a_board_that_has_just_been_reset_is_waited_for(pty_robot: PtyRobot) -> None:
    pty_robot.switch_off()
    timer = threading.Timer(2, pty_robot.switch_on)  # includes the start of python
    timer.start()
    on(pty_robot, "upload", "-e", "SI|F(0.1, 30)").gives(0)
    timer.join()


def test_a_name_survives_power_off(pty_robot: PtyRobot) -> None:
    result = on(pty_robot, "set", "name", "Ñandú")
    assert (result.code, result.out) == (0, f"{pty_robot.port}: the robot is now called Ñandú.\n")
    pty_robot.power_cycle()
    assert json.loads(on(pty_robot, "doctor", "--json").out)["robot"]["name"] == "Ñandú"
    for name in ("", " ", "a" * 17, "ñ" * 9, "a\nb"):
        assert on(pty_robot, "set", "name", name).code == 2
    assert "Ñandú, remembered   last used" in run_in_process("doctor", "--ports").out


def test_ports_queries_robots_only_on_request(tsc: Tsc, pty_robot: PtyRobot, hasty: None) -> None:
    known_ports.remember(pty_robot.port, "TINI")
    rows = json.loads(tsc("doctor", "--ports", "--json").out)
    row = next(row for row in rows if row["port"] == pty_robot.port)
    assert (row["remembered"], row["is_last_used"]) == ("TINI", True)
    assert pty_robot.received == b""
    assert "robot tinibot" in tsc("doctor", "--ports", "--ask", "--port", pty_robot.port).out
    pty_robot.switch_off()
    assert "nothing responds" in tsc("doctor", "--ports", "--ask", "--port", pty_robot.port).out
    assert "there is no port" in tsc("doctor", "--ports", "--ask", "--port", "/dev/no-such").out


def test_a_person_without_a_port_is_asked_for_a_port(
    tsc: Tsc, pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    listed_ports = [
        ports.ListedPort("/dev/ttyS77", "a modem"),
        ports.ListedPort(pty_robot.port, "a robot"),
    ]
    monkeypatch.setattr(ports, "list_ports", lambda: listed_ports)
    answers = iter(["7\n", "what?\n", "2\n"])
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("sys.stdin.readline", lambda: next(answers))
    monkeypatch.setattr("sys.stderr.isatty", lambda: True)
    result = tsc("doctor", "--identify").gives(0, f"  2  {pty_robot.port}   a robot\n")
    assert result.err.count("Number in the list: ") == 3
    assert tsc("doctor", "--identify").err == ""  # the port is remembered


def test_silence_other_devices_and_other_versions_are_reported(
    tsc: Tsc, pty_robot: PtyRobot, hasty: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("tiniscript.link.handshake.MAJOR", MAJOR + 1)
        tsc("doctor", "--identify", "--port", pty_robot.port).gives(
            3, f"uses version {MAJOR} of the link"
        )
    pty_robot.switch_off()
    tsc("doctor", "--identify", "--port", pty_robot.port).gives(3, "nothing responds")
    sketch = "another sketch, not the TiniScript firmware. It sends: Hello from a sketch. Put"
    for reply, answer in (
        (b"Hello from a sketch\r\n", sketch), (bytes(range(1, 256)) * 3, "not TiniScript"),
        (b"\xff" * 99, "not TiniScript. Perhaps the robot uses another baud rate"),
    ):  # fmt: skip
        timer = threading.Timer(0.3, pty_robot.say, [reply])
        timer.start()
        tsc("doctor", "--identify", "--port", pty_robot.port).gives(3, answer)
        timer.join()
    tsc("doctor", "--identify", "--port", "loop://").gives(3, "is sent to loop:// comes back")


@pytest.mark.parametrize("verb", ["doctor --identify", "stop", "start", "show", "monitor", "live"])
def test_invalid_ports_are_refused(tsc: Tsc, verb: str, tmp_path: Path) -> None:
    for language in ("en", "es"):
        for port in ("/dev/no-such-port", str(tmp_path), os.devnull, "nix://a", "socket://a",
                     "socket://127.0.0.1:1", "a" * 5000):  # fmt: skip
            result = tsc(*verb.split(), "--port", port, "--lang", language).gives(3, out="")
            assert result.err.startswith("tsc: ")
        for port in ("", "a\0b"):
            assert tsc(*verb.split(), "--port", port, "--lang", language).code == 2
        assert tsc(*verb.split(), "--lang", language).code == (2 if verb == "show" else 3)
        assert tsc(*verb.split(), "--port", "x", "--baud", "fast", "--lang", language).code == 2


def test_every_failure_has_a_message_with_a_next_step(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    from serial import SerialException

    monkeypatch.setattr("tiniscript.library.opening.BUSY_TIMEOUT_S", 0)
    for failure, word in (
        (SerialException(13, "Permission denied"), "dialout" if os.name == "posix" else "may not"),
        (SerialException(16, "Device or resource busy"), "another program"),
        (SerialException("could not open port 'COM5': PermissionError(13, 'Access')"), "another"),
        (SerialException("could not open port 'COM5': FileNotFoundError(2, '')"), "no port"),
        (SerialException("could not open port 'COM5': OSError(22, 'semaphore')"), "cannot reach"),
        (SerialException("something new"), "something new"),
        (OSError(112, "Host is down"), "cannot reach" if os.name == "posix" else "tsc: "),
    ):

        def refuse(*_: object, failure: Exception = failure) -> None:
            raise failure

        monkeypatch.setattr(serial_transport, "_make_serial", refuse)
        tsc("doctor", "--identify", "--port", "COM5").gives(3, word)


def test_a_port_that_never_opens_is_given_up(
    tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:  # fmt: skip
    hangs = threading.Event()
    monkeypatch.setattr(serial_transport, "_make_serial", lambda *_: hangs.wait(30))
    with pytest.raises(errors.PortError) as failure:
        ports.open_port("COM5", 9600, timeout_s=0.1)
    assert failure.value.reason == errors.SLOW
    hangs.set()
