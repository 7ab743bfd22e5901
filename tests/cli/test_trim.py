"""`tsc trim`: what a robot keeps of its motors, asked of a person or set at once."""

from __future__ import annotations

import json
import signal
import subprocess
from collections.abc import Callable
from typing import cast

import pytest

from tests.machines.host_firmware import EMPTY, HostFirmware
from tests.support import pty_robot as pty_robots
from tests.support.command import TSC, Done, Tsc
from tests.support.pty_robot import PtyRobot
from tests.support.waiting import HANGS_S
from tiniscript import robots
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import trim_wizard
from tiniscript.cli.robot.connect import Connection
from tiniscript.link.messages import STATUSES
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.link.trim import Trim, told

KIT = robots.load("tinibot").kit


def on(pty_robot: PtyRobot, *arguments: str, data: str = "") -> Done:
    return pty_robots.on(pty_robot, "trim", *arguments, data=data.encode())


def keeps(pty_robot: PtyRobot) -> Trim:
    """What the robot says that it keeps."""
    fields = json.loads(on(pty_robot, "--show", "--json").out)
    return Trim(*(fields[name] for name in Trim._fields))


def switched_on(memory: bytes = EMPTY) -> HostFirmware:
    robot = HostFirmware(KIT, memory)
    robot.wait(200)
    return robot


def computer(nonce: int = 1) -> Session:
    return Session(nonce, 9600, KIT.fingerprint)


def driven(robot: HostFirmware, session: Session, left: int, right: int) -> list[str]:
    """Return what the outputs of the driver get for so much power, in percent."""
    before = len(robot.did)
    assert robot.until(session, session.live(bytes((0x5A, left & 0xFF, right & 0xFF)))) == OK
    robot.talk(session, 20)
    return [line.split(" ", 2)[2] for line in robot.did[before:] if "MOTORS" in line]


# -- the robot ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("trim", "found"),
    [
        (Trim(), "80 40"),
        (Trim(is_exchanged=True), "40 80"),
        (Trim(is_left_reversed=True), "-80 40"),
        (Trim(is_right_reversed=True), "80 -40"),
        (Trim(is_exchanged=True, is_left_reversed=True), "40 -80"),
        (Trim(balance=25), "60 40"),
        (Trim(balance=-25), "80 30"),
        (Trim(least=20), "84 52"),  # 20, and 80 % of what is asked
        (Trim(balance=40, least=40), "56 64"),
    ],
)
def test_motors_get_what_the_trim_makes_of_it(trim: Trim, found: str) -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(trim.data())) == OK
    assert driven(robot, session, 80, 40) == [found, "0 0"]


def test_one_percent_moves_and_none_is_none() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(Trim(balance=10, least=30).data())) == OK
    assert driven(robot, session, 1, -1) == ["30 -30", "0 0"]
    assert driven(robot, session, 100, -100) == ["90 -100", "0 0"]
    assert driven(robot, session, 0, 0) == []


def test_without_a_trim_each_percent_is_itself() -> None:
    robot, session = switched_on(), computer()
    for percent in range(1, 101):
        assert driven(robot, session, percent, -percent)[0] == f"{percent} {-percent}"


def test_a_trim_survives_and_so_does_the_name() -> None:
    robot, session = switched_on(), computer()
    trim = Trim(True, False, True, -7, 12)
    assert robot.until(session, session.name(b"TINI")) == OK
    robot.talk(session, 1000)
    assert robot.until(session, session.trim(trim.data())) == OK
    robot.talk(session, 1000)
    again, other = switched_on(robot.memory()), computer(2)
    asked = other.trim()
    assert again.until(other, asked) == OK
    assert asked.outcome is not None and told(asked.outcome.values) == trim
    assert other.robot is not None and other.robot.name == "TINI"


@pytest.mark.parametrize(
    "data", [b"\x08\0\0", b"\0\x29\0", b"\0\xd7\0", b"\0\x80\0", b"\0\0\x29", b"\0\0", b"\0"]
)
def test_a_trim_that_makes_no_sense_is_refused(data: bytes) -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.trim(Trim(balance=3).data())) == OK
    expected = "BAD_VALUE" if len(data) == 3 else "BAD_LENGTH"
    assert robot.until(session, session.trim(data)) == STATUSES[expected]
    asked = session.trim()
    assert robot.until(session, asked) == OK
    assert asked.outcome is not None and told(asked.outcome.values) == Trim(balance=3)


# -- the command ----------------------------------------------------------------------------------


def test_numbers_are_set_one_by_one_and_reset_at_once(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "--balance", "-5", "--least", "12").out.startswith("tinibot (")
    done = on(pty_robot, "--exchange", "yes", "--reverse-right", "yes")
    assert done.out.endswith(
        "keeps: motors swapped, right wheel reversed, right wheel 5 % weaker, "
        "wheels move from 12 % on\n"
    )
    assert keeps(pty_robot) == Trim(True, False, True, -5, 12)
    assert on(pty_robot, "--exchange", "no", "--balance", "0").code == 0
    assert keeps(pty_robot) == Trim(False, False, True, 0, 12)
    assert "as they are wired, both wheels equally strong" in on(pty_robot, "--reset").out
    assert keeps(pty_robot) == Trim()


@pytest.mark.parametrize(
    "wrong", [("--balance", "41"), ("--least", "-1"), ("--exchange", "maybe"), ("--least", "x")]
)
def test_what_cannot_be_set_is_said_without_a_robot(tsc: Tsc, wrong: tuple[str, str]) -> None:
    done = tsc("trim", *wrong, "--port", "/nowhere")
    assert done.code == 2 and wrong[0] in done.err


# Enter; the left output turns the right wheel, backward; the right one the left wheel, forward;
# 5 and 10 % do not move both, 15 do; on the floor it goes to its left, its right, then straight
ANSWERS = "\n2\n2\n1\n1\n2\n2\n1\n\n2\n9\n3\n1\n"


def test_a_person_is_guided_to_a_robot_that_drives_straight(pty_robot: PtyRobot) -> None:
    assert pty_robots.on(pty_robot, "live", "W(0)").code == 0
    done = on(pty_robot, data=ANSWERS)
    assert done.code == 0, done.err
    assert keeps(pty_robot) == Trim(True, False, True, -8, 15)
    assert "A number from 1 to 4" in done.err
    assert done.err.index("One motor turned") < done.err.index("The other motor turned")
    moves = [line for line in pty_robot.did if line.startswith("MOTORS") and line != "MOTORS 0 0"]
    assert moves == [
        "MOTORS 60 0", "MOTORS 0 60",  # as they are wired
        "MOTORS -5 5", "MOTORS -10 10", "MOTORS -15 15",
        "MOTORS -66 66", "MOTORS -56 66", "MOTORS -61 66",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("answers", "said"),
    [
        ("\n1\n1\n1\n1\n", "the same wheel"),
        ("\n3\n", "did not turn"),
        ("\n1\n1\n2\n1\n" + "2\n" * 8, "do not turn with 40 %"),
        ("\n1\n1\n2\n1\n1\n\n" + "2\n" * 3, "more than 40 % stronger"),
        ("\n1\n", "the answers ended"),
    ],
)
def test_a_robot_that_cannot_be_trimmed_keeps_what_it_had(
    pty_robot: PtyRobot, answers: str, said: str
) -> None:
    assert on(pty_robot, "--balance", "7", "--least", "3").code == 0
    done = on(pty_robot, data=answers)
    assert done.code == 3
    assert said in done.err
    assert keeps(pty_robot) == Trim(balance=7, least=3)
    assert not pty_robot.moves


@pytest.mark.parametrize("key", ["stopped_elsewhere", "plain"])
def test_a_stop_from_elsewhere_while_a_trim_is_set_leaves_the_one_before(
    monkeypatch: pytest.MonkeyPatch, key: str
) -> None:
    """Another terminal stops the robot in the moment in which it is given a trim to try."""
    given: list[bytes] = []
    stops = ["stopped_elsewhere", "plain"]  # it goes on: what is asked meanwhile is stale

    class Asked:
        def trim(self, data: bytes) -> None:
            given.append(data)

    class Connected:
        def give(self, make: Callable[[Asked], None]) -> None:
            if stops:
                raise CommandError(3, stops.pop())
            make(Asked())

    def stopped(wizard: trim_wizard.TrimWizard) -> Trim:
        raise CommandError(3, key)

    monkeypatch.setattr(trim_wizard.TrimWizard, "trim", stopped)
    monkeypatch.setattr(trim_wizard.TrimWizard, "__init__", lambda wizard, connection: None)
    with pytest.raises(CommandError, match=key):
        trim_wizard.guided(cast("Connection", Connected()), Trim(balance=7))
    assert given == [Trim(balance=7).data()]


def test_ctrl_c_stops_the_robot_and_it_keeps_what_it_had(pty_robot: PtyRobot) -> None:
    assert on(pty_robot, "--balance", "7").code == 0
    command = subprocess.Popen(
        [*TSC, "trim", "--port", pty_robot.port],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip
    assert command.stdin
    command.stdin.write(b"\n")
    command.stdin.flush()
    pty_robot.until(lambda: pty_robot.moves, "a motor turns")
    command.send_signal(signal.SIGINT)
    out, err = command.communicate(timeout=HANGS_S)
    done = Done(command.returncode, out.decode(), err.decode())
    assert done.code == 2
    assert not pty_robot.moves
    assert keeps(pty_robot) == Trim(balance=7)
