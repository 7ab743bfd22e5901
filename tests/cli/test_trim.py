"""`tsc set trim`: what a robot keeps of its motors, asked of a person or set at once."""

from __future__ import annotations

import json
import signal
from collections.abc import Callable
from itertools import permutations
from types import SimpleNamespace
from typing import cast

import pytest

from tests.machines.host_firmware import EMPTY_EEPROM, HostFirmware
from tests.support import pty_robot as pty_robots
from tests.support.command import Command, CommandResult, run_in_process
from tests.support.pty_robot import PtyRobot
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import trim_wizard
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.description import trim_in_words
from tiniscript.cli.texts import causes
from tiniscript.doctor.findings import Finding
from tiniscript.link.connection import STATUS, reason_of
from tiniscript.link.messages import STATUSES
from tiniscript.link.names import fault_name
from tiniscript.link.outcomes import CANCELLED, DETAIL_MIDWAY
from tiniscript.link.payloads import TrimReply
from tiniscript.link.requests import OK, Reply
from tiniscript.link.session import Session
from tiniscript.link.trim import Pace, Trim, trim_from_reply

KIT = robots.load("tinibot").kit


def run_trim(pty_robot: PtyRobot, *arguments: str, data: str = "") -> CommandResult:
    return pty_robots.on(pty_robot, "set", "trim", *arguments, data=data.encode())


def stored_trim(pty_robot: PtyRobot) -> Trim:
    """Return the trim stored by the robot."""
    result = run_trim(pty_robot, "--show", "--json").gives(0)
    fields = json.loads(result.out)
    pace = fields["pace"]
    trim = Trim(*(fields[name] for name in Trim._fields))
    return trim._replace(pace=pace and Pace(**pace))


def switched_on(memory: bytes = EMPTY_EEPROM) -> HostFirmware:
    robot = HostFirmware(KIT, memory)
    robot.wait(200)
    return robot


def computer(nonce: int = 1) -> Session:
    return Session(nonce, 9600, KIT.fingerprint)


def drive_and_record(robot: HostFirmware, session: Session, left: int, right: int) -> list[str]:
    """Return the driver's outputs for these powers in percent."""
    count_before = len(robot.did)
    assert robot.until(session, session.live(bytes((0x5A, left & 0xFF, right & 0xFF)))) == OK
    robot.talk(session, 20)
    return [line.split(" ", 2)[2] for line in robot.did[count_before:] if "MOTORS" in line]


# -- the robot ------------------------------------------------------------------------------------


def test_motor_powers_follow_the_trim() -> None:
    robot, session = switched_on(), computer()
    for trim, power, powers in (
        (Trim(), (80, 40), "80 40"),
        (Trim(is_exchanged=True), (80, 40), "40 80"),
        (Trim(is_left_reversed=True), (80, 40), "-80 40"),
        (Trim(is_right_reversed=True), (80, 40), "80 -40"),
        (Trim(is_exchanged=True, is_left_reversed=True), (80, 40), "40 -80"),
        (Trim(balance=25), (80, 40), "60 40"),
        (Trim(balance=-25), (80, 40), "80 30"),
        (Trim(least=20), (80, 40), "84 52"),  # 20, and 80 % of the requested power
        (Trim(balance=40, least=40), (80, 40), "56 64"),
        (Trim(balance=10, least=30), (1, -1), "30 -30"),
        (Trim(balance=10, least=30), (100, -100), "90 -100"),
    ):
        assert robot.until(session, session.trim(trim.data())) == OK
        assert drive_and_record(robot, session, *power) == [powers, "0 0"], trim
    assert drive_and_record(robot, session, 0, 0) == []


def test_a_trim_that_makes_no_sense_is_refused() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(Trim(balance=3).data())) == OK
    for data in (b"\x08\0\0", b"\0\x29\0", b"\0\xd7\0", b"\0\x80\0", b"\0\0\x29", b"\0\0", b"\0"):
        expected = "BAD_VALUE" if len(data) == 3 else "BAD_LENGTH"
        assert robot.until(session, session.trim(data)) == STATUSES[expected], data
    assert trim_from_reply(robot.complete(session, session.trim())) == Trim(balance=3, pace=Pace())


# -- the command ----------------------------------------------------------------------------------


def test_numbers_are_set_one_by_one_and_reset_at_once(pty_robot: PtyRobot) -> None:
    assert run_trim(pty_robot, "--balance", "-5", "--least", "12").out.startswith("tinibot (")
    result = run_trim(pty_robot, "--exchange", "yes", "--reverse-right", "yes")
    assert result.out.endswith(
        "has saved: motors swapped, right wheel reversed, right motor with 5 % less power, "
        "the wheels begin to turn at 12 %, uses its kit's speeds for CM and DEG\n"
    )
    assert stored_trim(pty_robot) == Trim(True, False, True, -5, 12, Pace())
    assert run_trim(pty_robot, "--exchange", "no", "--balance", "0").code == 0
    assert stored_trim(pty_robot) == Trim(False, False, True, 0, 12, Pace())
    assert "as they are wired, both motors equally strong" in run_trim(pty_robot, "--reset").out
    assert stored_trim(pty_robot) == Trim(pace=Pace())


def test_invalid_settings_are_refused_without_a_robot() -> None:
    for option, value in (
        ("--balance", "41"), ("--least", "-1"), ("--exchange", "maybe"), ("--least", "x"),
        ("--speed-80", "-1"), ("--turn-80", "656"), ("--turn-40", "fast"),
    ):  # fmt: skip
        result = run_in_process("set", "trim", option, value, "--port", "/nowhere")
        assert result.code == 2 and option in result.err, option


# Enter; the left output turns the right wheel, backward; the right one the left wheel, forward;
# 5 and 10 % do not move both, 15 do; on the floor at 40 % it goes to its left, its right, then
# straight, and so at 80 %
ANSWERS = "\n4\n1\n2\n2\n1\n\n2\n9\n3\n1\n1\n"


def test_a_person_is_guided_to_a_robot_that_drives_straight(pty_robot: PtyRobot) -> None:
    assert pty_robots.on(pty_robot, "live", "W(0)").code == 0
    result = run_trim(pty_robot, data=ANSWERS + "2\n").gives(0)
    assert stored_trim(pty_robot) == Trim(True, False, True, -8, 15, Pace())
    assert "a number from 1 to 4" in result.err
    assert result.err.index("One motor turned") < result.err.index("The other motor turned")
    moves = [
        line for line in pty_robot.actions if line.startswith("MOTORS") and line != "MOTORS 0 0"
    ]
    assert moves == [
        "MOTORS 60 0", "MOTORS 0 60",  # the motors as wired
        "MOTORS -5 5", "MOTORS -10 10", "MOTORS -15 15",
        "MOTORS -49 49", "MOTORS -42 49", "MOTORS -45 49",  # powers at 40 %
        "MOTORS -76 83",  # powers at 80 %
    ]  # fmt: skip


def text_of_cause(cause: str, part: str, **values: str) -> str:
    """Return the text of a cause in the doctor's table, as this verb prints it."""
    finding = Finding(cause, True, values, part)
    sentences = causes.sentences_of(finding, "en")
    return (
        f"tsc: {causes.label(finding, 'en')}: {sentences.finding}. The robot keeps its old trim. "
        f"Try:  {sentences.advice}"
    )


def test_a_robot_that_cannot_be_trimmed_keeps_its_trim(pty_robot: PtyRobot) -> None:
    assert run_trim(pty_robot, "--balance", "7", "--least", "3").code == 0
    for answers, expected in (
        ("\n1\n2\n", text_of_cause("same_wheel", "motors")),
        ("\n5\n", text_of_cause("still", "left")),
        ("\n1\n3\n" + "2\n" * 8, text_of_cause("too_weak", "motors", n="40")),
        ("\n1\n3\n1\n\n" + "2\n" * 3, text_of_cause("too_uneven", "motors", n="40")),
        ("\n1\n", "the input ended"),
    ):
        run_trim(pty_robot, data=answers).gives(3, expected)
        assert stored_trim(pty_robot) == Trim(balance=7, least=3, pace=Pace()), expected
        assert not pty_robot.moves


def test_a_stop_from_elsewhere_during_trimming_keeps_the_previous_trim(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Another terminal stops the robot in the moment in which it is given a trim to try.

    Whatever a robot that answers has answered to the trial or to the former trim."""
    sent_trims: list[bytes] = []
    stops: list[str] = []

    class Asked:
        def trim(self, data: bytes) -> None:
            sent_trims.append(data)

    class Connected:
        def request(self, make_request: Callable[[Asked], None], taken: object) -> None:
            if stops:
                raise CommandError(3, stops.pop())
            make_request(Asked())

    def refuse_step(wizard: trim_wizard.TrimWizard, trim_before: Trim) -> Trim:
        raise CommandError(3, key)

    monkeypatch.setattr(trim_wizard.TrimWizard, "ask_trim", refuse_step)
    monkeypatch.setattr(trim_wizard.TrimWizard, "__init__", lambda wizard, connection: None)
    connection = cast("Connection", SimpleNamespace(connection=SimpleNamespace(robot=object())))
    replies: list[Reply[object]] = [
        *map(Reply, STATUSES.values()),
        Reply(CANCELLED),
        Reply(CANCELLED, DETAIL_MIDWAY),
    ]
    reasons = {reason_of(connection.connection, reply) for reply in replies}
    keys = {"plain" if reason == STATUS else reason for reason in reasons}
    for key, *stale_keys in permutations(keys, 3):  # the robot runs on, so the others are stale
        stops[:] = stale_keys
        with pytest.raises(CommandError, match=key):
            trim_wizard.guide(cast("Connection", Connected()), Trim(balance=7))
        assert sent_trims.pop() == Trim(balance=7).data() and not sent_trims


def test_ctrl_c_stops_the_robot_and_keeps_its_trim(pty_robot: PtyRobot) -> None:
    assert run_trim(pty_robot, "--balance", "7").code == 0
    command = Command("set", "trim", "--port", pty_robot.port, data=b"\n")
    pty_robot.until(lambda: pty_robot.moves, "a motor turns")
    command.signal(signal.SIGINT)
    assert command.wait_for_result().code == 2
    assert not pty_robot.moves
    assert stored_trim(pty_robot) == Trim(balance=7, pace=Pace())


# -- how fast it is -------------------------------------------------------------------------------

TRIM_PACE = Pace(16.5, 33.25, 144, 288)
LIFTED_ANSWERS = "\n1\n3\n1\n\n1\n1\n"  # answers: wired correctly, straight at both powers


def moves_in(robot: HostFirmware, session: Session, line: str) -> list[int]:
    """Return the duration of each move of a live line, in milliseconds."""
    count_before = len(robot.did)
    code = unpack(compile_text(f"SI|{line}", KIT).image).code
    assert robot.until(session, session.live(code)) == OK
    robot.talk(session, 9000)
    times_ms = [int(row.split()[0]) for row in robot.did[count_before:] if "MOTORS" in row]
    return [end - start for start, end in zip(times_ms[::2], times_ms[1::2], strict=True)]


def test_a_measured_robot_goes_by_the_line_through_two_points() -> None:
    robot, session = switched_on(), computer()
    line = "F(20 CM, 60); R(90 DEG, 60); F(20 CM, 100); F(20 CM, 10)"
    assert moves_in(robot, session, line) == [741, 417, 444, 4444]
    assert robot.until(session, session.trim(Trim(pace=TRIM_PACE).data())) == OK
    # 24.875 cm and 216 degrees in a second at 60 %, 41.625 at 100, 3.9375 at 10
    assert moves_in(robot, session, line) == [804, 417, 480, 5079]


def test_a_measured_robot_may_not_move_at_all_with_little_power() -> None:
    robot, session = switched_on(), computer()
    pace = Pace(0, 40, 100, 300)
    assert robot.until(session, session.trim(Trim(pace=pace).data())) == OK
    code = unpack(compile_text("F(20 CM, 40)", KIT).image).code
    assert robot.until(session, session.live(code)) == OK
    robot.talk(session, 100)
    status = session.status()
    assert robot.until(session, status) == OK
    assert status.outcome is not None
    assert fault_name(status.outcome.values.fault) == "NO_POWER"


def test_a_pace_that_does_not_rise_is_refused_entirely() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(Trim(balance=3, pace=TRIM_PACE).data())) == OK
    for pace in (Pace(20, 20), Pace(20, 10), Pace(1, 0), Pace(0, 0, 9, 8)):
        refused_count = robot.until(session, session.trim(Trim(balance=9, pace=pace).data()))
        assert refused_count == STATUSES["BAD_VALUE"], pace
        assert trim_from_reply(robot.complete(session, session.trim())) == Trim(
            balance=3, pace=TRIM_PACE
        )


def test_a_pace_survives_a_fault_and_a_torn_save() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(Trim(pace=TRIM_PACE).data())) == OK
    robot.talk(session, 1000)
    memory_before = robot.memory()
    code = unpack(compile_text("SHOW(1 / 0)", KIT).image).code
    assert robot.until(session, session.live(code)) == OK  # the fault is saved beside it
    robot.talk(session, 1000)
    for memory in (memory_before, robot.memory()):
        assert pace_of(memory) == TRIM_PACE
    assert robot.memory() != memory_before
    slots = [offset for offset in (66, 97) if robot.memory()[offset] != 0xFF]
    torn_bytes = bytearray(robot.memory())
    for offset in slots:
        torn_bytes[offset + 4 + 20] ^= 1  # a bit of both records
    assert pace_of(bytes(torn_bytes)) == Pace()


def pace_of(memory: bytes) -> Pace | None:
    robot, session = switched_on(memory), computer(2)
    return trim_from_reply(robot.complete(session, session.trim())).pace


def test_older_firmware_stores_no_pace() -> None:
    older_reply = TrimReply(0, 0, 0, b"")
    assert trim_from_reply(older_reply).pace is None
    assert "centimetres" not in trim_in_words(trim_from_reply(older_reply), "en")


def test_a_person_measures_with_tape_and_protractor(pty_robot: PtyRobot) -> None:
    measuring = "1\n\nx\n-3\n0.5 m\n1e3\n99999\n\n33\n\n66,5 cm\n\n144°\n\n288\n"
    result = run_trim(pty_robot, data=LIFTED_ANSWERS + measuring).gives(0)
    assert stored_trim(pty_robot).pace == Pace(16.5, 33.25, 144, 288)
    assert result.err.count("18 in") == 5
    assert "drives 16.5 cm per second at 40 % and 33.25 at 80 %" in result.out
    report = pty_robots.on(pty_robot, "doctor").out
    assert "turns 144 degrees per second at 40 % and 288 at 80 %" in report


def test_a_lower_speed_at_80_is_measured_again(pty_robot: PtyRobot) -> None:
    wrong_answers = "1\n\n33\n\n33\n"
    result = run_trim(
        pty_robot, data=LIFTED_ANSWERS + wrong_answers + "\n0\n\n13 in\n\n144\n\n288\n"
    )
    assert result.code == 0, result.err
    assert "Measure both again" in result.err
    assert stored_trim(pty_robot).pace == Pace(0, 16.51, 144, 288)


def test_an_interrupted_measurement_keeps_the_stored_pace(pty_robot: PtyRobot) -> None:
    run_trim(pty_robot, "--speed-40", "20").gives(2, "faster than at 40 %")
    assert stored_trim(pty_robot).pace == Pace()
    assert run_trim(pty_robot, "--speed-40", "10", "--speed-80", "20,5", "--balance", "7").code == 0
    for answers in ("1\n", "1\n\n33\n\n"):
        run_trim(pty_robot, data=LIFTED_ANSWERS + answers).gives(3, "the input ended")
        assert stored_trim(pty_robot) == Trim(balance=7, pace=Pace(10, 20.5))
        assert not pty_robot.moves
