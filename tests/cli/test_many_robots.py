"""Thirty robots at once, some of them with bad links; one of them never holds up the others."""

from __future__ import annotations

import json
import os
import signal
from argparse import Namespace
from collections import deque
from collections.abc import Iterator
from contextlib import closing

import pytest

from tests.support.command import FOREVER, Command, CommandResult, run_in_process
from tests.support.robot_fleet import RobotFleet, known_fleet
from tests.support.terminal import Terminal
from tiniscript import robots
from tiniscript.cli.robot.fleet import Fleet
from tiniscript.cli.robot.member import Member, Result, Target
from tiniscript.cli.terminal.fleet_table import FleetTable
from tiniscript.library import opening
from tiniscript.link import known_ports, ports
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import BY_NAME

TINIBOT_KIT, LINER_KIT = robots.load("tinibot").kit, robots.load("liner").kit
SHORT_PROGRAM = "SI|F(0.3, 80);SHOW(DISTANCE)"
ROBOT_COUNT = 30
SILENT_ROBOT, OTHER_KIT_ROBOT, DEAF_ROBOT = 3, 7, 11  # robots with which something is wrong
NOISY_ROBOTS = (5, 13, 17, 21)


@pytest.fixture
def class_() -> Iterator[RobotFleet]:
    with known_fleet([TINIBOT_KIT] * 4) as robot_fleet:
        yield robot_fleet


def results(result: CommandResult) -> dict[str, dict[str, object]]:
    rows = [json.loads(line) for line in result.out.splitlines()]
    return {row["port"]: row for row in rows if row["event"] == "RESULT"}


@pytest.mark.sampled(of="slow commands")
def test_thirty_robots_get_a_program_despite_three_faulty_ones() -> None:
    kits = [
        LINER_KIT if number == OTHER_KIT_ROBOT else TINIBOT_KIT for number in range(ROBOT_COUNT)
    ]
    with RobotFleet(kits) as room:
        pupils = room.pupils
        pupils[SILENT_ROBOT].deaf_after = 0
        pupils[DEAF_ROBOT].deaf_after = 30  # the robot fails in the middle of the program
        for number in NOISY_ROBOTS:
            pupils[number].damages = 97
        for pupil in pupils:
            known_ports.remember(pupil.port, f"R{pupil.number}", is_used=False)
        result = run_in_process("upload", "-e", SHORT_PROGRAM, "--all", "--json").gives(3)
        rows = results(result)
        bad_ports = {pupils[number].port for number in (SILENT_ROBOT, OTHER_KIT_ROBOT, DEAF_ROBOT)}
        present_rows = {port: row for port, row in rows.items() if not row["is_absent"]}
        assert set(present_rows) == {pupil.port for pupil in pupils}
        assert {port for port, row in present_rows.items() if not row["is_done"]} == bad_ports
        assert "nothing responds" in str(rows[pupils[SILENT_ROBOT].port]["said"])
        assert "--robot liner" in str(rows[pupils[OTHER_KIT_ROBOT].port]["said"])
        for pupil in pupils:
            if pupil.port not in bad_ports:
                assert pupil.actions == ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]
        events = [json.loads(line) for line in result.out.splitlines()]
        receipts = [row["port"] for row in events if row["event"] == "RECEIPT"]
        assert len(receipts) == len(set(receipts)) >= ROBOT_COUNT - 3
        showing_ports = [row["port"] for row in events if row["event"] == "SHOW"]
        noisy_ports = {
            pupils[number].port for number in NOISY_ROBOTS
        }  # the damaged event may be theirs
        assert (
            set(present_rows) - bad_ports - noisy_ports
            <= set(showing_ports)
            <= set(present_rows) - bad_ports
        )
        # the silent one is over last
        assert events[-1]["port"] in bad_ports | {
            port for port, row in rows.items() if row["is_absent"]
        }

        run_in_process("upload", "-e", FOREVER, "--all", "--detach").gives(3)
        # The program uses no device of a kit.
        assert sum(pupil.moves for pupil in pupils) == ROBOT_COUNT - 2
        result = run_in_process("stop", "--all").gives(3)
        assert not any(pupil.moves for pupil in pupils)
        assert (
            result.out.count("the robot has confirmed the stop") == ROBOT_COUNT - 2
        )  # the other kit, too


@pytest.mark.parametrize("babble", [b"DISTANCE 42\r\n" * 9, b"\x03\x81\0" * 30, b"U" * 90])
def test_a_babbling_device_delays_no_robot(class_: RobotFleet, babble: bytes) -> None:
    """Another sketch that prints without an end, half frames, and the noise of a wrong speed."""
    *other_pupils, last_robot = class_.pupils
    last_robot.babble = babble
    result = run_in_process("upload", "-e", FOREVER, "--all", "--detach", "--json")
    rows = results(result)
    assert result.code == 3 and len(result.out) < 10_000
    assert {port for port, row in rows.items() if row["is_done"]} == {
        pupil.port for pupil in other_pupils
    }
    assert all(pupil.moves for pupil in other_pupils)
    result = run_in_process("stop", "--all", "--json")
    rows = results(result)
    assert {port for port, row in rows.items() if row["is_done"]} >= {
        pupil.port for pupil in other_pupils
    }
    assert not any(pupil.moves for pupil in class_.pupils)


def test_flashing_one_board_delays_no_stop_of_others(
    class_: RobotFleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Another program has its port, as avrdude does: its stop is refused, the others are not."""
    *other_pupils, last_robot = class_.pupils
    assert run_in_process("upload", "-e", FOREVER, "--all", "--detach").code == 0
    holder = ports.open_port(last_robot.port, 115_200)
    with monkeypatch.context() as patch, closing(holder):
        patch.setattr(opening, "STOP_BUSY_TIMEOUT_S", 0.5)
        for options in (("--all",), tuple(f"--port={pupil.port}" for pupil in class_.pupils)):
            result = run_in_process("stop", *options, "--json")
            rows = results(result)
            assert result.code == 3 and not rows[last_robot.port]["is_done"]
            assert all(rows[pupil.port]["is_done"] for pupil in other_pupils)
            assert not any(pupil.moves for pupil in other_pupils)
            run_in_process("start", "--port", other_pupils[0].port, "--detach")
    run_in_process("stop", "--all").gives(0)
    assert not any(pupil.moves for pupil in class_.pupils)


def test_all_robots_stop_however_the_driving_command_ends(class_: RobotFleet) -> None:
    """They stop after `stop --all` from another terminal, after Ctrl-C, and after a kill."""

    def drive_all() -> Command:
        command = Command("upload", "-e", FOREVER, "--all")
        class_.until(lambda: all(pupil.moves for pupil in class_.pupils), "all drive")
        return command

    command = drive_all()
    result = run_in_process("stop", "--all", "--json").gives(0)
    assert not any(pupil.moves for pupil in class_.pupils)
    rows = [row for row in results(result).values() if not row["is_absent"]]
    assert len(rows) == len(class_.pupils)
    result = command.wait_for_result().gives(3)
    reasons = ("The robot was stopped from a computer.", "another command stopped the robot")
    assert sum(map(result.out.count, reasons)) == len(class_.pupils)  # before or after the start
    command = drive_all()
    command.signal(signal.SIGINT)
    result = command.wait_for_result().gives(2)
    assert not any(pupil.moves for pupil in class_.pupils)
    assert result.out.count("the robot has confirmed the stop") == len(class_.pupils)
    command = drive_all()
    command.kill()
    class_.until(lambda: not any(pupil.moves for pupil in class_.pupils), "they stop")


def test_each_robot_has_a_row(class_: RobotFleet) -> None:
    """Each named port must have a robot."""
    assert run_in_process("upload", "-e", "F(2 80)", "--all").code == 1
    assert not any(pupil.received for pupil in class_.pupils)
    assert (
        run_in_process("upload", "-e", "PING|check_connection", "--all").out.count("10 round") == 4
    )
    assert run_in_process("upload", "-e", "SB|S", "--all").code == 0
    names = [pupil.port for pupil in class_.pupils]
    result = run_in_process("doctor", "--all").gives(0)
    rows = [line.split("(")[1].split(")")[0] for line in result.out.splitlines()]
    assert sorted(rows) == sorted(names)
    assert result.out.count("nothing is running") == len(names)
    ports_of = ("--port", names[0], "--port", names[2])
    robots_by_port = results(run_in_process("doctor", "--count", "3", "--json", *ports_of))
    assert set(robots_by_port) == {names[0], names[2]}
    assert all(row["round_trips"] == 3 for row in robots_by_port.values())
    result = run_in_process(
        "upload", "-e", "SI|X = DISTANCE;SHOW(1 / X)", "--all", "--no-save"
    ).gives(3)
    assert result.out.count("DIVIDE_BY_ZERO") == 4
    assert result.out.count("line 1") == 4
    result = run_in_process(
        "doctor", "--identify", "--port", names[0], "--port", "/dev/no-such", "--lang", "es"
    )
    assert result.code == 3
    assert "no existe el puerto /dev/no-such" in result.out
    assert (
        "3" in run_in_process("doctor", "--count", "3", "--port", names[0], "--port", names[0]).out
    )


@pytest.mark.sampled(of="slow commands")
def test_the_doctor_examines_each_of_many_robots_like_a_single_one(class_: RobotFleet) -> None:
    """Its causes are in the row of the robot, and each is asked as often as was said."""
    weak = class_.pupils[1]
    with weak._lock:
        weak.robot.set_supply(True)
    run_in_process("upload", "-e", "SB|S", "--port", weak.port)
    heard_count_by_port = {pupil.port: len(pupil.received) for pupil in class_.pupils}
    robots_by_port = results(run_in_process("doctor", "--all", "--count", "3", "--json").gives(3))
    single_report = json.loads(run_in_process("doctor", "--port", weak.port, "--json").gives(3).out)
    wrong_findings = [finding for finding in single_report["findings"] if finding["is_wrong"]]
    assert [finding["cause"] for finding in wrong_findings] == ["low_supply"]
    findings = robots_by_port[weak.port]["findings"]
    assert isinstance(findings, list)
    assert [finding for finding in findings if finding["is_wrong"]] == wrong_findings
    assert wrong_findings[0]["said"] in str(robots_by_port[weak.port]["said"])
    for pupil in class_.pupils:
        assert robots_by_port[pupil.port]["is_done"] == (pupil is not weak)
        assert robots_by_port[pupil.port]["round_trips"] == 3
        assert pings(pupil.received[heard_count_by_port[pupil.port] :]) == 3 + 20 * (pupil is weak)


def pings(heard_bytes: bytes) -> int:
    frames = [decode_frame(packet) for packet in heard_bytes.split(b"\0") if packet]
    return sum(frame is not None and frame.number == BY_NAME["PING"].number for frame in frames)


def test_undo_has_a_row_for_each_robot_and_continues_after_failures(class_: RobotFleet) -> None:
    first_program, second_program = "SB|F(0.1, 50)", "SB|F(0.1, 60)"
    assert run_in_process("upload", "-e", first_program, "--all").code == 0
    names = [pupil.port for pupil in class_.pupils]
    assert (
        run_in_process("upload", "-e", second_program, "--port", names[1], "--port", names[2]).code
        == 0
    )
    result = run_in_process("start", "--previous", "--all", "--json").gives(3)
    rows = results(result)
    assert {port for port in names if rows[port]["is_done"]} == {names[1], names[2]}
    assert "no earlier program" in str(rows[names[0]]["said"])
    checksums = {rows[names[1]]["checksum"], rows[names[2]]["checksum"]}
    assert len(checksums) == 1
    result = run_in_process(
        "start", "--previous", "--port", names[1], "--port", names[2], "--lang", "es"
    ).gives(0)
    assert result.out.count("vuelve a tener el programa anterior") == 2
    assert str(checksums.pop()) not in result.out


def test_a_port_that_never_had_a_robot_is_not_a_failure(
    class_: RobotFleet, monkeypatch: pytest.MonkeyPatch
) -> None:
    import pty

    pty_ends = [end for _ in range(2) for end in pty.openpty()]
    port, known_text = os.ttyname(pty_ends[1]), os.ttyname(pty_ends[3])
    monkeypatch.setattr(ports, "list_ports", lambda: [ports.ListedPort(port, "")])
    monkeypatch.setattr("tiniscript.cli.robot.fleet.STRANGER_TIMEOUT_S", 1.0)
    result = run_in_process("doctor", "--identify", "--all").gives(0)
    assert len(result.out.splitlines()) == 4
    assert result.err == f"Done: 4 of 4.\nNo robot responds on {port}.\n"
    monkeypatch.setattr(ports, "list_ports", list)
    monkeypatch.setattr(opening, "ANSWER_TIMEOUT_MS", 1000)
    known_ports.remember(known_text, "R9", is_used=False)
    run_in_process("doctor", "--identify", "--all").gives(
        3, "Done: 4 of 5.", out=f"R9 ({known_text}): nothing responds"
    )
    for end in pty_ends:
        os.close(end)


def test_robots_of_a_fleet_are_remembered_but_none_as_the_last_used(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """So a robot that is silent the next time is reported missing, and the next command drives the
    robot that this person has driven before."""
    monkeypatch.setattr(ports, "list_ports", list)
    known_ports.remember("own", "MINE")
    with RobotFleet([TINIBOT_KIT] * 2) as fleet:
        places = [pupil.port for pupil in fleet.pupils]
        words = [word for place in places for word in ("--port", place)]
        run_in_process("upload", "-e", "SI|W(0.1)", "--no-save", *words).gives(0)
    memory = known_ports.remembered_ports()
    assert {*places} < {*memory.name_by_port} and memory.last_port == "own"


def test_a_missing_fleet_and_wrong_use_are_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ports, "list_ports", list)
    for language, words in (("en", "no robot responds"), ("es", "ningún robot responde")):
        run_in_process("stop", "--all", "--lang", language).gives(3, words)
        assert run_in_process("stop", "--all", "--port", "x", "--lang", language).code == 2
        assert (
            run_in_process("doctor", "--port", "a\0b", "--port", "x", "--lang", language).code == 2
        )


def test_the_table_shows_every_robot_and_leaves_plain_rows(class_: RobotFleet) -> None:
    words = ("upload", "-e", "SI|F(1, 80);SHOW(7);F(1, 80)", "--all", "--no-save")
    terminal = Terminal(*words, size=(100, 24), types=False)
    shown_states = set()
    while terminal.take():
        text = "\n".join(terminal.lines())
        if text.count("running   SHOW 7") == 4:
            shown_states.add("values")
        if text.count("running") == 4:
            shown_states.add("running")
    assert terminal.end() == 0
    assert shown_states == {"values", "running"}
    rows = list(filter(None, terminal.lines()))
    assert "Done: 4 of 4." in rows
    assert sum(row.endswith("Done.") for row in rows) == 4
    assert not any("running" in row for row in rows)


@pytest.mark.parametrize("count", [0, 1, 2, 5, 30])
def test_every_table_fits_its_terminal(count: int) -> None:
    members = [
        Member(Target(f"/dev/ttyUSB{k}", "ÑANDÚ" * k, False, True), deque()) for k in range(count)
    ]
    for k, member in enumerate(members):
        member.result = [None, Result(True, "fine"), Result(False, "what is wrong " * 9)][k % 3]
    table = FleetTable(members, "es")
    for width in (1, 2, 20, 80, 200):
        for height in (1, 2, 3, 8, 50):
            lines = table.lines(width, height, 0)
            assert len(lines) <= height
            assert all(line.cell_len <= width for line in lines)
            if count > height > 2:
                shown_text = "".join(line.plain for line in lines[1:-1])
                assert "fine" not in shown_text or shown_text.count("\n") >= count // 3
                assert lines[-1].plain.startswith("…")


@pytest.mark.parametrize("when", ["_print_result", "_print_lines", "_news"])
def test_ctrl_c_stops_all_whatever_is_printed_meanwhile(
    when: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    options = Namespace(verb="upload", json=False, detach=False)
    targets = [Target(port, "", True, True) for port in "AB"]
    fleet = Fleet(targets, options, robots.load("tinibot"), "en")
    fleet.members[0].result = Result(True, "fine")
    pressed_keys: list[str] = []

    def press(*_: object) -> None:
        if not pressed_keys:
            pressed_keys.append(when)
            raise KeyboardInterrupt

    def interrupt() -> None:
        fleet.is_interrupted = True
        fleet.members[1].result = Result(False, "stopped")

    if when == "_news":
        monkeypatch.setattr(fleet._result_bell, "wait", press)
    else:
        monkeypatch.setattr(fleet, when, press)
    monkeypatch.setattr(fleet, "interrupt_robots", interrupt)
    fleet.print_until_done(None)
    assert fleet.is_interrupted and fleet.exit_code() == 2
