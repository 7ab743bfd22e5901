"""Diagnoses from a computer and a port: every cause of the table is found here."""

from __future__ import annotations

import errno
import os
from argparse import Namespace
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, cast

import pytest

from tests.support.fake_computer import FakeComputer
from tests.support.foreign_boards import FIRMATA
from tests.support.simulated_ends import KIT, Firmware, UnpoweredEnd
from tests.support.simulated_wire import OtherEnd, SimulatedWire
from tiniscript.cli.texts.causes import sentences_of
from tiniscript.doctor.diagnosis import Diagnosis, DoctorServices, Question, diagnose
from tiniscript.doctor.examination import Expectations
from tiniscript.doctor.findings import CAUSES
from tiniscript.doctor.robot import MAX_UNANSWERED
from tiniscript.link import errors
from tiniscript.link.connection import LinkConnection
from tiniscript.link.errors import PortError
from tiniscript.link.messages import BY_NAME, OWNED, STATUSES, YOURS
from tiniscript.link.outcomes import (
    CANCELLED,
    LOST,
    OTHER_ROBOT,
    UNPROVEN,
    ConnectionLost,
)
from tiniscript.link.payloads import HelloReply, PingReply, StatusReply
from tiniscript.link.requests import OK, Reply
from tiniscript.link.sharing.registry import Registration
from tiniscript.link.sharing.shared_connection import OtherVersion
from tiniscript.link.wire import Wire

CABLE, RADIO = "/dev/ttyUSB0", "/dev/rfcomm0"
HELLO = HelloReply(**Firmware().hello)  # type: ignore[arg-type]
STATUS = StatusReply(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, b"\0\0")
PONG = PingReply(0, 0, b"")


class OtherCommand:
    """The connection of another tsc: its requests are answered with `replies`, or it has ended."""

    robot = None
    early_bytes = b""

    def __init__(self, *replies: Reply[Any]) -> None:
        self.replies = list(replies)
        self.is_closed = False

    def begin(self, make_request: Callable[[Any], object]) -> object:
        class Session:
            def __getattr__(self, name: str) -> Callable[[], Namespace]:
                return lambda: Namespace(name=name)

        return make_request(Session())

    def wait(self, request: Namespace) -> Reply[Any]:
        assert request.name in ("hello", "status", "ping", "trim") and request.limit_ms > 0
        if not self.replies:
            raise ConnectionLost("")
        return self.replies.pop(0)

    def event(self, timeout_s: float) -> None:
        assert timeout_s > 0

    def close(self) -> None:
        self.is_closed = True


class Case:
    """A computer, the devices on its ports, and the user's answers."""

    def __init__(self, tmp_path: Path) -> None:
        self.system = FakeComputer(tmp_path, "linux")
        self.end: OtherEnd = Firmware()
        self.failure: PortError | None = None
        self.says_yes = False
        self.last_port: str | None = None
        self.opened_names: list[str] = []
        self.wire: SimulatedWire | None = None
        self.asked_names: list[str] = []
        self.other_version: OtherVersion | None = None
        self.shared_connection: OtherCommand | None = None
        self.watched_connection = OtherCommand(Reply(LOST))
        self.watch_ms = 0
        self.virtual_ports: tuple[str, ...] = ()
        self.expectations = Expectations(None, "tinibot", {KIT: "tinibot"}.get)

    def with_bluetooth(self, *paired: str, is_off: bool = False) -> Case:
        self.system.write("/sys/class/bluetooth/hci0/address", "0")
        rows = "".join(f"Device 00:00:00:00:00:0{k} {name}\n" for k, name in enumerate(paired))
        self.system.outputs["bluetoothctl", "devices", "Paired"] = rows
        self.system.write("/sys/class/rfkill/rfkill0/type", "bluetooth")
        self.system.write("/sys/class/rfkill/rfkill0/soft", "1" if is_off else "0")
        return self

    def with_port(self, port: str, description: str = "") -> Case:
        self.system.add_port(port, description)
        self.system.usb("usb1", "1d6b", "0002")
        return self

    def failing(self, reason: str, detail: str = "") -> Case:
        self.failure = PortError(reason, detail)
        return self

    def diagnosis(self, port: str | None = CABLE) -> Diagnosis:
        def open_wire(name: str, baud: int) -> Wire:
            self.opened_names.append(name)
            if self.failure is not None:
                raise self.failure
            if name == CABLE and name not in self.system.owners:
                raise PortError(errors.MISSING)
            self.wire = SimulatedWire(self.end, baud)
            return self.wire

        def join(name: str) -> LinkConnection | None:
            if self.other_version is not None:
                raise self.other_version
            return (
                cast(LinkConnection, self.shared_connection)
                if self.shared_connection is not None
                else None
            )

        def may_open(name: str) -> bool:
            self.asked_names.append(name)
            return self.says_yes

        def share(name: str) -> AbstractContextManager[LinkConnection]:
            return nullcontext(cast(LinkConnection, self.watched_connection))

        doors = DoctorServices(
            self.system, open_wire, join, may_open, lambda name: "rfcomm" in name, share
        )
        question = Question(
            port, self.last_port, 9600, self.expectations, 7, self.watch_ms, self.virtual_ports
        )
        return diagnose(doors, question)

    def cause(self, port: str | None = CABLE) -> tuple[str, bool]:
        (finding,) = self.diagnosis(port).findings
        return finding.cause, finding.is_sure


@pytest.fixture
def case(tmp_path: Path) -> Case:
    return Case(tmp_path)


Make = Callable[[Case], object]


def _port_of_dialout(member: str) -> Make:
    def set_case(case: Case) -> None:
        case.with_port(CABLE)
        case.system.owners[CABLE] = (20, False)
        case.system.write("/etc/group", f"dialout:x:20:{member}\n")

    return set_case


_set_member, _set_stranger = _port_of_dialout("somebody"), _port_of_dialout("")


def _port_in_use(name: str) -> Make:
    def set_case(case: Case) -> None:
        case.with_port(CABLE)
        case.system.program(5, name, opened_port=CABLE)

    return set_case


def _brltty(case: Case) -> None:
    case.system.usb("1-1", "1a86", "7523", driver="usbfs")
    case.system.program(5, "brltty")


def _other_tsc(case: Case) -> None:
    held_registration = Registration(CABLE, 1, "t", "a", "link", 9600, 5)
    case.with_port(CABLE).other_version = OtherVersion(held_registration, "0.1")


def _plug(vendor: str, product: str, driver: str = "") -> Make:
    return lambda case: case.system.usb("1-1", vendor, product, driver)


def _pair(reason: str, *names: str, is_off: bool = False) -> Make:
    """Bluetooth is there, and the port does not open."""
    return lambda case: case.with_bluetooth(*names, is_off=is_off).failing(reason)


def _failing(reason: str, detail: str = "") -> Make:
    return lambda case: case.failing(reason, detail)


def _ports(*names: str) -> Make:
    return lambda case: [case.with_port(name) for name in names]


HUB, CH340 = ("1d6b", "0002"), ("1a86", "7523")
REFUSED_DETAIL = os.strerror(errno.ECONNREFUSED)
ROWS: tuple[tuple[str | None, Make, str, bool], ...] = (
    (None, _ports(), "no_port", True),
    (CABLE, _ports(), "no_port", True),
    (None, _plug(*HUB), "charging_cable", False),
    (CABLE, _plug(*HUB), "charging_cable", False),
    (CABLE, _ports("/dev/ttyUSB7"), "port_missing", True),
    (None, _ports(CABLE, "/dev/ttyACM0"), "which_port", True),
    (None, _plug(*CH340), "driver_missing", True),
    (None, _brltty, "brltty", True),
    (None, _plug(*CH340, "usbfs"), "brltty", False),
    (RADIO, _failing(errors.MISSING), "no_bluetooth", True),
    (RADIO, _pair(errors.MISSING, is_off=True), "bluetooth_off", True),
    (RADIO, _pair(errors.MISSING, "Telephone"), "not_paired", True),
    (RADIO, _pair(errors.MISSING, "HC-05"), "no_rfcomm", True),
    (CABLE, _set_stranger, "no_permission", True),
    (CABLE, _set_member, "login_again", True),
    (CABLE, _port_in_use("minicom"), "busy", True),
    (CABLE, _port_in_use("ModemManager"), "modem_manager", True),
    (CABLE, _other_tsc, "other_tsc", True),
    (RADIO, _failing(errors.BUSY), "busy", True),
    (RADIO, _failing(errors.BUSY, os.strerror(errno.EBUSY)), "other_host", False),
    (RADIO, _pair(errors.UNREACHABLE, "HC-05"), "out_of_reach", False),
    (RADIO, _pair(errors.UNREACHABLE, "Telephone"), "not_paired", False),
    (RADIO, _failing(errors.UNREACHABLE, REFUSED_DETAIL), "other_host", False),
    (RADIO, _pair(errors.SLOW, "HC-05"), "slow_port", False),
    (RADIO, _failing(errors.NO_PORT), "no_serial_port", True),
    (RADIO, _failing(errors.BROKEN, "Input/output error"), "port_broken", True),
    (RADIO, _failing(errors.FORBIDDEN), "no_permission", True),
    (CABLE, _ports(CABLE), "not_opened", True),
    (RADIO, _ports(), "fine", True),
)


@pytest.mark.parametrize(
    ("port", "set_case", "cause", "is_sure"), ROWS, ids=lambda value: str(value)[:20]
)
def test_each_cause_at_the_computer_or_port_is_found(
    case: Case, port: str | None, set_case: Make, cause: str, is_sure: bool
) -> None:
    set_case(case)
    assert case.cause(port) == (cause, is_sure)


def test_a_cable_is_opened_only_after_consent_and_a_radio_without_it(case: Case) -> None:
    diagnosis = case.diagnosis(RADIO)
    assert (diagnosis.findings[0].cause, diagnosis.is_opened) == ("fine", True)
    assert (case.opened_names.pop(), case.asked_names) == (RADIO, [])
    case.with_port(CABLE)
    assert case.cause() == ("not_opened", True)
    assert (case.opened_names, case.asked_names) == ([], [CABLE])
    case.says_yes = True
    assert case.cause() == ("fine", True)
    assert case.opened_names == [CABLE]
    assert case.wire is not None and case.wire.is_gone  # the port is closed


def test_ports_without_a_cable_are_named_in_the_finding(case: Case) -> None:
    """`tsc doctor --ports` lists them, so the doctor does not claim that there are no ports."""
    case.virtual_ports = ("socket://127.0.0.1:7007", "socket://127.0.0.1:7008")
    (finding,) = case.diagnosis(None).findings
    assert (finding.cause, finding.values) == ("no_port", {"ports": ", ".join(case.virtual_ports)})
    case.with_port("/dev/ttyS0")
    (finding,) = case.diagnosis(None).findings
    assert finding.cause == "charging_cable"
    assert finding.values == {"ports": f"/dev/ttyS0, {', '.join(case.virtual_ports)}"}
    for language in ("en", "es"):
        _, sentence, hint = sentences_of(finding, language)
        assert finding.values["ports"] in sentence
        assert "tsc doctor --port" in hint


def test_the_only_virtual_robot_is_examined_if_there_is_no_cable(case: Case) -> None:
    case.says_yes = True
    case.virtual_ports = ("socket://127.0.0.1:7007",)
    assert case.diagnosis(None).port == case.virtual_ports[0]
    case.with_port(CABLE)
    assert case.diagnosis(None).port == CABLE


@pytest.mark.parametrize(
    "set_case", [_set_stranger, _set_member, _port_in_use("minicom"), _other_tsc]
)
def test_a_foreign_port_is_not_opened(case: Case, set_case: Make) -> None:
    set_case(case)
    case.says_yes = True
    assert not case.diagnosis().is_opened
    assert case.opened_names == []


def test_the_last_or_only_port_is_chosen(case: Case) -> None:
    case.with_port("/dev/ttyS0").with_port(CABLE)
    assert case.diagnosis(None).port == CABLE  # the other one is no robot's
    case.with_port("/dev/ttyACM0")
    assert case.diagnosis(None).port is None
    case.last_port = RADIO
    assert case.diagnosis(None).port == RADIO


@pytest.mark.parametrize(
    ("platform", "port", "description"),
    [("linux", "/dev/tty5", "Bluetooth"), ("win32", "COM3", ""), ("darwin", "/dev/tty.HC-05", "")],
)
def test_the_only_port_is_found_on_each_system(
    case: Case, platform: str, port: str, description: str
) -> None:
    case.system.platform = platform
    case.with_port(port, description)
    assert case.diagnosis(None).port == port


@pytest.mark.parametrize(
    ("port", "cause", "is_sure"),
    [(RADIO, "port_gone", True), ("socket://robot:7000", "other_host", False)],
)
def test_a_vanishing_port_is_reported(case: Case, port: str, cause: str, is_sure: bool) -> None:
    class Gone(UnpoweredEnd):
        def answer(self, data: bytes) -> bytes:
            raise OSError("gone")

    case.end, case.says_yes = Gone(), True
    assert case.cause(port) == (cause, is_sure)


@pytest.mark.parametrize(
    ("replies", "cause"),
    [
        ([], "port_gone"),
        ([Reply(LOST)], "falls_silent"),
        ([Reply(CANCELLED)], "falls_silent"),
        ([Reply(STATUSES["OTHER_LINK"], 2)], "firmware_newer"),
        ([Reply(OTHER_ROBOT, 7)], "other_robot"),
        ([Reply(UNPROVEN)], "unproven"),
    ],
)
def test_a_robot_is_examined_through_another_tsc(
    case: Case, replies: list[Reply[Any]], cause: str
) -> None:
    case.shared_connection = OtherCommand(*replies)
    diagnosis = case.diagnosis()
    assert [finding.cause for finding in diagnosis.findings] == [cause]
    assert diagnosis.is_opened and case.shared_connection.is_closed
    assert case.opened_names == []


def test_a_foreign_board_heard_by_another_tsc_is_recognized(case: Case) -> None:
    case.shared_connection = OtherCommand(Reply(LOST))
    case.shared_connection.early_bytes = FIRMATA
    (finding,) = case.diagnosis().findings
    assert (finding.cause, finding.values["said"]) == ("firmata", "StandardFirmata.ino 2.5")


@pytest.mark.parametrize("answered_count", [0, 3, 12])
def test_a_robot_that_falls_silent_behind_another_tsc_is_given_up(
    case: Case, answered_count: int
) -> None:
    """Each request waits for the retries of that tsc, and for its search for the robot."""
    known_replies = [
        Reply(OK, 0, HELLO),
        Reply(OK, 0, STATUS),
        *[Reply(OK, 0, PONG)] * answered_count,
    ]
    lost_replies: list[Reply[Any]] = [Reply(LOST)] * MAX_UNANSWERED
    case.shared_connection = OtherCommand(*known_replies, *lost_replies)
    assert "falls_silent" in [finding.cause for finding in case.diagnosis().findings]
    case.shared_connection = OtherCommand(
        *known_replies, *lost_replies[1:], *[Reply(OK, 0, PONG)] * 3, *lost_replies
    )
    assert "falls_silent" in [finding.cause for finding in case.diagnosis().findings]
    assert case.shared_connection.replies == [], "one that is heard again has all of them again"


def test_a_healthy_robot_on_a_shared_port_is_watched(case: Case) -> None:
    case.watch_ms = 1000
    # The reason that the shared connection reports.
    assert case.cause(RADIO) == ("falls_silent", False)
    assert case.wire is not None and case.wire.is_gone
    case.end = UnpoweredEnd()
    assert case.cause(RADIO) == ("crossed", False)


@pytest.mark.parametrize("cause", ["other_robot", "unproven"])
def test_a_doubtful_robot_gets_no_further_requests(case: Case, cause: str) -> None:
    places = []

    def note_port(port: str, hello: HelloReply) -> str:
        places.append(port)
        return cause

    case.expectations = case.expectations._replace(doubt_of=note_port)
    (finding,) = case.diagnosis(RADIO).findings
    assert (finding.cause, finding.values) == (cause, {"id": "12347f3a"})
    assert places == [RADIO] and finding.is_wrong
    assert isinstance(case.end, Firmware) and set(case.end.requests) == {BY_NAME["HELLO"].number}


@pytest.mark.parametrize(("features", "has_key", "cause"), [
    (OWNED, True, "falls_silent"), (OWNED, False, "of_another_owner"), (0, True, "fine"),
])  # fmt: skip
def test_the_key_of_a_robot_with_an_owner_is_shown_by_the_connection(
    case: Case, features: int, has_key: bool, cause: str
) -> None:
    """The robot's unproven statement about its owner is false."""
    case.end = Firmware(features=features)
    case.expectations = case.expectations._replace(has_key=lambda robot: has_key)
    assert case.diagnosis(RADIO).findings[0].cause == cause


def test_the_ownership_of_a_robot_is_shown_by_its_answer_to_a_key(case: Case) -> None:
    case.expectations = case.expectations._replace(has_key=lambda robot: True)
    case.shared_connection = OtherCommand(Reply(OK, 0, HELLO._replace(features=OWNED)), Reply(LOST))
    assert "of_another_owner" in [finding.cause for finding in case.diagnosis().findings]
    case.shared_connection = OtherCommand(
        Reply(OK, 0, HELLO._replace(features=OWNED | YOURS)), Reply(LOST)
    )
    assert "of_another_owner" not in [finding.cause for finding in case.diagnosis().findings]


def test_an_unopened_port_is_not_reported_as_opened(case: Case) -> None:
    _plug(*CH340)(case)
    diagnosis = case.diagnosis(None)
    assert diagnosis.findings[0].values == {"chip": "CH340", "driver": "ch341"}
    assert not diagnosis.is_opened
    assert not case.failing(errors.SLOW).diagnosis(RADIO).is_opened


def test_every_cause_has_a_test() -> None:
    """Each is in a table of this folder, or named in a test of another user of the doctor."""
    folder = Path(__file__).parent
    commands = (
        folder.parent / "cli" / f"test_{name}.py" for name in ("selftest", "module_command", "trim")
    )
    tables = (folder / "test_line.py", folder / "test_diagnosis.py", *commands)
    source = "".join(path.read_text(encoding="utf-8") for path in tables)
    assert [cause for cause in CAUSES if f'"{cause}"' not in source] == []
    assert len(CAUSES) >= 20
