"""`tsc` and a robot with an ESP32 on its cable and in a network at once."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.support.claimed_robots import become_another_computer, claim_with_button
from tests.support.command import FOREVER, LONG_PROGRAM, Command, run_in_process, run_subprocess
from tests.support.esp32_announced import AnnouncedNames
from tests.support.esp32_near import (
    DRIVE_ACTIONS,
    DRIVE_PROGRAM,
    NETWORK,
    PASSWORD,
    files_with,
    list_motor_changes,
    put_network_in_reach,
)
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.esp32_radio import port_of, radios
from tests.support.network import BadNetwork
from tests.support.pty_robot import on


@pytest.fixture
def robot() -> Iterator[Esp32PtyRobot]:
    esp32_pty_robot = Esp32PtyRobot("tinibot32")
    with esp32_pty_robot:
        yield esp32_pty_robot


def ask_radios(robot: Esp32PtyRobot, property_name: str) -> str:
    """Return the settings of the robot's radios, or the address where it listens."""
    questions: list[str] = []

    def ask(host_firmware: HostFirmware) -> None:
        assert isinstance(host_firmware, Esp32Robot)
        questions.append(
            str(
                port_of(host_firmware)
                if property_name == "port"
                else getattr(radios(host_firmware), property_name)
            )
        )

    robot.ask(ask)
    return questions[0]


@pytest.fixture
def robot_in_network(robot: Esp32PtyRobot) -> Esp32PtyRobot:
    """A robot with an owner, in a network."""
    put_network_in_reach(robot)
    assert claim_with_button(robot).code == 0
    result = on(robot, "set", "wifi", NETWORK, data=PASSWORD + b"\n")
    assert result.code == 0, result.err
    assert f"on the network {NETWORK}" in result.out and "tcp://tini-5678.local" in result.out
    return robot


def start_endless_upload(robot: Esp32PtyRobot, place: str) -> Command:
    """A command that stays and has the robot drive, over its network."""
    command = Command("upload", "-e", FOREVER, "--port", place)
    command.until("running")
    robot.until(lambda: robot.moves, "it drives")
    return command


def test_a_robot_without_an_owner_names_the_first_step(robot: Esp32PtyRobot) -> None:
    for words in (("set", "wifi", NETWORK), ("set", "wifi"), ("set", "wifi", "--forget")):
        on(robot, *words, data=PASSWORD + b"\n").gives(3, "tsc set owner", out="")
    assert "Primero hazlo tuyo" in on(robot, "set", "wifi", NETWORK, "--lang", "es").err
    assert ask_radios(robot, "joins") == "0"


def test_a_network_is_set_shown_and_forgotten(
    robot_in_network: Esp32PtyRobot, tmp_path: Path
) -> None:
    assert ask_radios(robot_in_network, "password").encode() == PASSWORD
    result = on(robot_in_network, "set", "wifi")
    assert (
        result.code == 0
        and NETWORK in result.out
        and PASSWORD.decode() not in result.out + result.err
    )
    assert files_with(tmp_path, PASSWORD) == []
    put_network_in_reach(robot_in_network, b"another password")
    robot_in_network.until(
        lambda: "password may be" in on(robot_in_network, "set", "wifi").out, "it is refused"
    )
    assert "la contraseña es otra" in on(robot_in_network, "set", "wifi", "--lang", "es").out
    assert on(robot_in_network, "set", "wifi", "--forget").code == 0
    assert "does not use WiFi" in on(robot_in_network, "set", "wifi").out
    assert ask_radios(robot_in_network, "network") == ""


def test_an_access_point_is_reported_as_unreliable_next_to_bluetooth(
    robot: Esp32PtyRobot,
) -> None:
    """According to Espressif's table of coexistence; Bluetooth is always on."""
    assert claim_with_button(robot).code == 0
    result = on(robot, "set", "wifi", "Tini", "--access-point", data=PASSWORD + b"\n")
    assert result.code == 0 and "192.168.4.1" in result.out and "unreliable" in result.out
    assert "inestable" in on(robot, "set", "wifi", "--lang", "es").out
    assert "instável" in on(robot, "set", "wifi", "--lang", "pt").out
    assert on(robot, "set", "wifi", "--forget").code == 0
    assert "unreliable" not in on(robot, "set", "wifi").out


def test_anything_but_a_password_changes_nothing(robot_in_network: Esp32PtyRobot) -> None:
    for data in (b"", b"\n", b"short\n", b"x" * 64 + b"\n", b"12345678\0\n",
                 b"1234567\x1b[2J\n", b"x" * 5000):  # fmt: skip
        result = on(robot_in_network, "set", "wifi", "Other", data=data)
        assert result.code == 2 and "8 to 63" in result.err and "\x1b" not in result.err, data
        assert ask_radios(robot_in_network, "network") == NETWORK


@pytest.mark.parametrize("words", [
    ("x" * 33,), ("",), ("a\tb",), ("X", "--forget"),
    ("--access-point",), ("--access-point", "--forget"),
])  # fmt: skip
def test_nonsensical_arguments_are_refused_before_any_port_is_opened(
    words: tuple[str, ...],
) -> None:
    for language in ("en", "es"):
        result = run_in_process(
            "set", "wifi", *words, "--port", "/none", "--lang", language, data=PASSWORD
        )
        assert result.code == 2 and result.err.startswith("tsc: ")


def test_two_computers_use_cable_and_network_at_once(
    robot_in_network: Esp32PtyRobot, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    place = f"socket://127.0.0.1:{ask_radios(robot_in_network, 'port')}"
    for words in (("set", "wifi", "Other"), ("set", "wifi", "--forget")):
        run_in_process(*words, "--port", place, data=PASSWORD).gives(2, "Bluetooth")
    assert NETWORK in run_in_process("set", "wifi", "--port", place).out
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", place).code == 0
    assert list_motor_changes(robot_in_network)[-2:] == DRIVE_ACTIONS
    command = start_endless_upload(robot_in_network, place)
    on(robot_in_network, "upload", "-e", DRIVE_PROGRAM).gives(3, "another connection")
    assert "otra conexión" in on(robot_in_network, "live", "F(1, 20)", "--lang", "es").err
    become_another_computer(monkeypatch, tmp_path)
    assert on(robot_in_network, "doctor").code == 0
    assert robot_in_network.moves
    assert on(robot_in_network, "stop").code == 0
    assert not robot_in_network.moves
    assert "stopped" in command.wait_for_result().out + command.wait_for_result().err
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", place).code == 3, (
        "it is another's robot"
    )


def test_a_program_runs_over_a_bad_network(robot_in_network: Esp32PtyRobot, tmp_path: Path) -> None:
    bad_network = BadNetwork(int(ask_radios(robot_in_network, "port")))
    place = f"socket://127.0.0.1:{bad_network.port}"
    for _ in range(3):
        run_in_process("upload", "-e", LONG_PROGRAM, "--no-run", "--port", place).gives(0)
    compiled_file, robot_file = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    assert run_in_process("compile", "-e", LONG_PROGRAM, "-o", compiled_file).code == 0
    assert run_in_process("show", "-o", robot_file, "--port", place).code == 0
    assert compiled_file.read_bytes() == robot_file.read_bytes()
    command = start_endless_upload(robot_in_network, place)
    assert run_subprocess("stop", "--port", place).code == 0
    assert not robot_in_network.moves
    command.wait_for_result()
    command = start_endless_upload(robot_in_network, place)
    start_ms = robot_in_network.robot_ms
    bad_network.cut()
    assert robot_in_network.standstill_after_ms(start_ms) < 2000, (
        "the connection was its dead-man timer"
    )
    assert command.wait_for_result().code == 3
    bad_network.close()


# -- by its name, with real multicast DNS ---------------------------------------------------------

PLACE = "tcp://tini-5678"


def is_listed() -> bool:
    rows = [
        row
        for row in run_in_process("doctor", "--ports", "--ask").out.split("\n")
        if row.startswith(PLACE)
    ]
    return any("announced on the network" in row and "robot tinibot (yours)" in row for row in rows)


def test_a_robot_is_found_and_driven_by_its_name(
    robot_in_network: Esp32PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("serial.tools.list_ports.comports", list)  # asking one takes ten seconds
    with AnnouncedNames(robot_in_network):
        for place in (f"{PLACE}.local", PLACE):  # the last one is remembered
            assert run_subprocess("doctor", "--identify", "--port", place).code == 0
        robot_in_network.until(is_listed, "it is listed")  # a busy computer misses data after 2 s
        command = start_endless_upload(robot_in_network, PLACE)
        assert run_subprocess("stop", "--port", PLACE).code == 0
        assert not robot_in_network.moves
        command.wait_for_result()
        assert on(robot_in_network, "set", "wifi", "--forget").code == 0
        assert ask_radios(robot_in_network, "service") == ""
        robot_in_network.until(
            lambda: (
                "announces itself" in run_in_process("doctor", "--identify", "--port", PLACE).err
            ),
            "it is silent",
        )
