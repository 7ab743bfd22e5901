"""A robot over Bluetooth LE: real connections, bleak as it ships, a BlueZ of the test's own."""

from __future__ import annotations

import json
import signal
from pathlib import Path

import pytest

import tiniscript
from tests.support.ble_robot import (
    ADDRESS,
    ADDRESS_PORT,
    DRIVE_ACTIONS,
    DRIVE_PROGRAM,
    HM10,
    LAMP_SERVICE,
    NAME,
    NORDIC,
    BleRobot,
    Echo,
    Peripheral,
    start_endless_upload,
)
from tests.support.command import LONG_PROGRAM, Command, run_in_process
from tests.support.fake_bluez import ADVERTISING_INTERVAL_S, FakeBluez
from tests.support.interrupted import interrupted_bell
from tests.support.pty_robot import PtyRobot
from tests.support.waiting import until
from tiniscript.link import known_ports
from tiniscript.link.transports import event_loop

OTHER_ADDRESS = "AA:BB:CC:DD:EE:02"
LARGEST = 65  # bytes of a frame on the wire


@pytest.fixture(autouse=True)
def without_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Skip the waits for cables and the network; modules announce their names more often."""
    monkeypatch.setattr("tiniscript.link.ports.list_ports", list)
    monkeypatch.setattr("tiniscript.link.ports.find_announced_robots", list)
    monkeypatch.setattr(
        "tiniscript.link.transports.bluetooth_search.LINGER_S", 16 * ADVERTISING_INTERVAL_S
    )
    monkeypatch.setattr(
        "tiniscript.link.transports.bluetooth_search.LIST_S", 30 * ADVERTISING_INTERVAL_S
    )


# -- requests -----------------------------------------------------------------------------------


def test_a_program_is_uploaded_and_lines_run_at_once(ble: BleRobot) -> None:
    for count, port in enumerate((NAME, ADDRESS_PORT, "BLE://tini 1", ADDRESS_PORT.lower()), 1):
        result = run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", port)
        assert (result.code, result.err) == (0, ""), port
        assert result.out.splitlines()[-2:] == ["Done.", "Saved. The button starts it."]
        assert (ble.robot.actions, ble.connections) == (DRIVE_ACTIONS * count, 2 * count - 1)
        assert run_in_process("set", "trim", "--show").code == 0  # the port is remembered
    assert {kind for kind, _ in ble.writes} == {"command"}  # an HM-10 answers no write
    assert max(len(data) for _, data in ble.writes) == 20
    run_in_process("live", "-", "--port", ADDRESS_PORT, data=b"F(0.1, 50)\nR(0.1, 40)\n").gives(
        0, ""
    )
    assert ble.robot.actions[-6::3] == ["MOTORS 50 50", "MOTORS 40 -40"]


@pytest.mark.sampled("service", "mtu", "late_s", keep=3)
@pytest.mark.parametrize(("service", "mtu", "late_s"), [
    (HM10, 23, 0.0), (HM10, 185, 0.0), (HM10, 23, 0.15),
    (NORDIC, 23, 0.0), (NORDIC, 64, 0.0), (NORDIC, 185, 0.0), (NORDIC, 23, 0.15),
])  # fmt: skip
def test_a_long_program_arrives_complete(
    bluez: FakeBluez, pty_robot: PtyRobot, tmp_path: Path, service: str, mtu: int, late_s: float
) -> None:
    """This holds for any negotiated size, and for late notifications."""
    ble = BleRobot(pty_robot, service=service, mtu=mtu, late_s=late_s)
    bluez.add(ble)
    compiled_file, robot_file = tmp_path / "ours.bin", tmp_path / "theirs.bin"
    run_in_process("compile", "-e", LONG_PROGRAM, "-o", compiled_file)
    assert run_in_process("upload", compiled_file, "--no-run", "--port", ADDRESS_PORT).code == 0
    assert run_in_process("show", "-o", robot_file, "--port", ADDRESS_PORT).code == 0
    assert robot_file.read_bytes() == compiled_file.read_bytes()
    longest_bytes = max(len(data) for _, data in ble.writes)
    assert longest_bytes == (20 if service == HM10 else min(mtu - 3, LARGEST))
    assert max(map(len, ble.sent_packets)) <= mtu - 3


def test_write_responses_of_a_module_are_waited_for(bluez: FakeBluez, pty_robot: PtyRobot) -> None:
    ble = BleRobot(pty_robot)
    ble.characteristics = [(ble.characteristics[0][0], ["write", "notify"])]
    bluez.add(ble)
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", ADDRESS_PORT).code == 0
    assert {kind for kind, _ in ble.writes} == {"request"}
    assert pty_robot.actions == DRIVE_ACTIONS


# -- holders of the port -------------------------------------------------------------------------


@pytest.mark.parametrize("port", [NAME, ADDRESS_PORT, ""])
def test_commands_share_a_connection_under_any_name(ble: BleRobot, port: str) -> None:
    command = start_endless_upload(ble, NAME)
    rows = [
        row
        for row in json.loads(run_in_process("doctor", "--ports", "--json").out)
        if row["held_by"]
    ]
    assert [row["port"] for row in rows] == [NAME]
    result = run_in_process("stop", *(("--port", port) if port else ()))
    assert (result.code, result.out.count("Stopped")) == (0, 1)
    assert not ble.robot.moves
    assert command.wait_for_result().code == 3
    assert ble.connections == 1


def test_two_simultaneous_commands_take_turns(ble: BleRobot) -> None:
    commands = [Command("doctor", "--identify", "--port", port) for port in (NAME, ADDRESS_PORT)]
    results = [command.wait_for_result() for command in commands]
    assert 0 in [result.code for result in results]
    for result in results:
        assert (
            result.code == 0 or "another program is using" in result.err or "in range" in result.err
        )


def test_ctrl_c_stops_the_robot_and_releases_it(ble: BleRobot, bluez: FakeBluez) -> None:
    command = start_endless_upload(ble)
    command.signal(signal.SIGINT)
    assert command.wait_for_result().code == 2
    assert not ble.robot.moves
    ble.robot.until(lambda: not bluez.devices[ADDRESS].is_connected, "BlueZ has heard it")
    assert run_in_process("doctor", "--identify", "--port", NAME).code == 0


def test_ctrl_c_ends_a_search(bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch) -> None:
    bell = interrupted_bell(lambda: until(lambda: bluez.adapter.is_scanning, "it searches"))
    with monkeypatch.context() as patch:
        patch.setattr(event_loop, "Bell", bell)
        assert run_in_process("doctor", "--identify", "--port", "ble://nobody").code == 2
    until(lambda: not bluez.adapter.is_scanning, "BlueZ has heard it")


def test_after_a_killed_command_the_robot_stops_and_is_reachable(
    ble: BleRobot, bluez: FakeBluez
) -> None:
    """BlueZ keeps its connection, and a robot that is connected is seen by no scan."""
    command = start_endless_upload(ble)
    command.kill()
    ble.robot.until(lambda: not ble.robot.moves, "the dead-man timer stops it")
    assert bluez.devices[ADDRESS].is_connected
    for port in (NAME, ADDRESS_PORT):
        assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", port).code == 0
    assert ble.robot.actions[-3:] == DRIVE_ACTIONS


# -- which robot --------------------------------------------------------------------------------


@pytest.mark.parametrize("late_rounds", [0, 4])
def test_two_robots_with_one_name_are_not_chosen(
    ble: BleRobot, bluez: FakeBluez, late_rounds: int
) -> None:
    """Also where one says its name later."""
    twin = Peripheral("TINI 1", OTHER_ADDRESS)
    twin.late_rounds = late_rounds
    bluez.add(twin)
    run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", NAME).gives(
        3, f"several robots are called {NAME}", f"{ADDRESS_PORT}, ble://{OTHER_ADDRESS}"
    )
    assert ble.connections == 0
    assert run_in_process("upload", "-e", DRIVE_PROGRAM, "--port", ADDRESS_PORT).code == 0


@pytest.mark.parametrize(("name", "typed_name"), [
    ("Ñandú 7", "ñandú 7"),
    ("Mi robot", "mi robot"),
    ("a/b?c%20://d", "a/b?c%20://d"),
    ("Straße", "STRASSE"),
    ("  spaced  ", "spaced"),
    ("Cafe\u0301", "Caf\u00e9"),
])  # fmt: skip
def test_names_with_special_characters_are_text(
    bluez: FakeBluez, pty_robot: PtyRobot, name: str, typed_name: str
) -> None:
    bluez.add(BleRobot(pty_robot, name))
    assert run_in_process("doctor", "--identify", "--port", f"ble://{typed_name}").code == 0


def test_a_name_that_looks_like_an_address_is_not_a_name(bluez: FakeBluez, ble: BleRobot) -> None:
    fake = Peripheral(ADDRESS, OTHER_ADDRESS)
    bluez.add(fake)
    assert run_in_process("doctor", "--identify", "--port", ADDRESS_PORT).code == 0
    assert (ble.connections, fake.connections) == (1, 0)


def test_all_robots_in_reach_are_listed_and_queried(ble: BleRobot, bluez: FakeBluez) -> None:
    hostile = "\x1b[31mNo\r\ntsc: \u202ename"
    bluez.add(Echo(hostile, OTHER_ADDRESS))
    bluez.add(Peripheral("lamp", "AA:BB:CC:DD:EE:03", LAMP_SERVICE))
    result = run_in_process("doctor", "--ports", "--ask").gives(0)
    rows = {line.split("   ")[0]: line.split("   ")[1:] for line in result.out.splitlines()}
    assert rows[ADDRESS_PORT] == ["Tini 1, Bluetooth LE", "robot tinibot (free)"]
    assert [port for port in rows if port.startswith("ble")] == [
        f"ble://{OTHER_ADDRESS}",
        ADDRESS_PORT,
    ]
    assert not any(sign in result.out for sign in "\x1b\r\u202e")
    # from now on it has this name
    assert run_in_process("doctor", "--identify", "--port", NAME).code == 0
    known_ports.remember("ble://yesterday", "Yesterday")
    names = {
        row["port"]: row["said"]
        for row in json.loads(run_in_process("doctor", "--ports", "--ask", "--json").out)
    }
    assert (names[NAME], names["ble://yesterday"]) == ("robot tinibot (free)", "out of range now")
    assert ADDRESS_PORT not in names


def test_several_robots_are_used_at_once(ble: BleRobot, bluez: FakeBluez) -> None:
    with PtyRobot(ble.robot.kit) as second_robot:
        bluez.add(BleRobot(second_robot, "Tini 2", OTHER_ADDRESS, NORDIC))
        ports = ("--port", NAME, "--port", "ble://tini 2")
        for words in (("upload", "-e", DRIVE_PROGRAM), ("stop",)):
            run_in_process(*words, *ports).gives(0, "Done: 2 of 2.")
        assert (ble.robot.actions[:3], second_robot.actions[:3]) == (DRIVE_ACTIONS, DRIVE_ACTIONS)


def test_all_includes_known_robots(ble: BleRobot) -> None:
    assert run_in_process("doctor", "--identify", "--port", NAME).code == 0
    for words in (("stop",), ("upload", "-e", DRIVE_PROGRAM)):
        run_in_process(*words, "--all").gives(0, "Done: 1 of 1.")


def test_a_device_that_is_not_a_robot_is_reported(
    bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("tiniscript.library.opening.ANSWER_TIMEOUT_MS", 1500)
    bluez.add(Peripheral("lamp", OTHER_ADDRESS, LAMP_SERVICE))
    run_in_process("doctor", "--identify", "--port", "ble://lamp").gives(
        3, "does not offer a robot's"
    )
    bluez.add(Echo("echo", ADDRESS))
    run_in_process("doctor", "--identify", "--port", "ble://echo").gives(3, "comes back")


def test_an_empty_scan_is_reported(ble: BleRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tiniscript.link.transports.bluetooth_search.SEARCH_S", 3.0)
    run_in_process("doctor", "--identify", "--port", "ble://nobody").gives(
        3, "ble://nobody is not in range", "In range: Tini 1"
    )
    ble.is_on = False
    run_in_process("doctor", "--identify", "--port", NAME, "--lang", "es").gives(
        3, "ni otro robot con Bluetooth LE"
    )


def test_a_closed_connection_is_free_while_its_process_runs(
    ble: BleRobot, bluez: FakeBluez
) -> None:
    for count in (1, 2):
        with tiniscript.connect(ADDRESS_PORT) as robot:
            robot.upload(DRIVE_PROGRAM)
            robot.wait()
            assert bluez.devices[ADDRESS].is_connected
        assert not bluez.devices[ADDRESS].is_connected
        assert (ble.connections, ble.robot.actions) == (count, DRIVE_ACTIONS * count)
