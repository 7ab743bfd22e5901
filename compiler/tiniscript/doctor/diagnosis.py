"""The way of the doctor: first the computer, then the port, then what answers there.

A port is opened only where nothing else has it, and that of a cable only after a yes: opening it
restarts most boards.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from contextlib import AbstractContextManager
from typing import NamedTuple

from tiniscript.doctor import line, linux, macos, windows
from tiniscript.doctor.computer import (
    FREE_ACCESS,
    NONE,
    OFF,
    Access,
    Computer,
    adapters_without_driver,
    looks_wireless,
)
from tiniscript.doctor.examination import Expectations, RobotAnswers, examine
from tiniscript.doctor.findings import Finding, probably, sure
from tiniscript.doctor.line import Line
from tiniscript.doctor.robot import SharedRobot
from tiniscript.doctor.system import System
from tiniscript.link import errors
from tiniscript.link.connection import LinkConnection, stranger
from tiniscript.link.errors import PortError
from tiniscript.link.messages import OWNED
from tiniscript.link.outcomes import ConnectionLost
from tiniscript.link.port_names import PSEUDO_TERMINALS, canonical_port, is_address
from tiniscript.link.sharing.shared_connection import OtherVersion
from tiniscript.link.wire import Wire


def inspect_computer(system: System) -> Computer:
    """Look at a computer. Opens no port."""
    if system.platform == "win32":
        return windows.inspect_windows(system)
    look = macos.inspect_macos if system.platform == "darwin" else linux.inspect_linux
    return look(system)


def access(system: System, port: str) -> Access:
    """Return who may use a port and who does. Opens no port."""
    is_told = system.platform != "win32" and not is_address(port)
    owner = system.owner(port) if is_told else None
    if owner is None:
        return FREE_ACCESS
    look = macos.access if system.platform == "darwin" else linux.access
    return look(system, port, owner)


REFUSED, IN_USE = os.strerror(errno.ECONNREFUSED), os.strerror(errno.EBUSY)


class Doors(NamedTuple):
    """What the doctor needs from outside. `may_open` asks the user about the port of a cable.

    `share` opens a port so that other commands share it: a stop gets through while it is watched.
    """

    system: System
    open_wire: Callable[[str, int], Wire]
    join: Callable[[str], LinkConnection | None]
    may_open: Callable[[str], bool]
    is_radio: Callable[[str], bool]
    share: Callable[[str], AbstractContextManager[LinkConnection]]
    on_step: Callable[[str], None] = lambda what: None


class Question(NamedTuple):
    """What the user asks about. `last` is the port that was used last, if it is there.

    `virtual` are the ports of the virtual robots that run on this computer.
    """

    port: str | None
    last: str | None
    baud: int
    expected: Expectations
    nonce: int
    watch_ms: int = 0
    virtual: tuple[str, ...] = ()


class Diagnosis(NamedTuple):
    """`port` is None where none was looked at; `is_opened`: bytes were sent there."""

    port: str | None
    findings: tuple[Finding, ...]
    computer: Computer
    is_opened: bool


def diagnose(doors: Doors, question: Question) -> Diagnosis:
    doors.on_step("computer")
    computer = inspect_computer(doors.system)
    port = question.port or question.last or _only_port(computer, question.virtual)
    if port is None:
        return Diagnosis(None, _missing_port_findings(computer, question.virtual), computer, False)
    question = question._replace(expected=question.expected._replace(port=port))
    client = None
    try:
        client = doors.join(port)
        if client is not None:
            return Diagnosis(port, _diagnose_shared(client, doors, question), computer, True)
    except OtherVersion as other:
        values = {"verb": other.registration.verb, "theirs": other.version}
        return Diagnosis(port, (sure("other_tsc", **values),), computer, False)
    finally:
        if client is not None:
            client.close()
    busy_port = _port_in_use(doors.system, computer, port)
    if busy_port is not None:
        return Diagnosis(port, (busy_port,), computer, False)
    is_radio = doors.is_radio(port) or port.startswith(PSEUDO_TERMINALS)
    if not is_radio and _is_listed(doors.system, computer, port) and not doors.may_open(port):
        return Diagnosis(port, (sure("not_opened"),), computer, False)
    return _diagnose_open_port(doors, question, computer, port, is_radio)


def _diagnose_open_port(
    doors: Doors, question: Question, computer: Computer, port: str, is_radio: bool
) -> Diagnosis:
    try:
        wire = doors.open_wire(port, question.baud)
    except PortError as failure:
        return Diagnosis(
            port, (_open_failure(failure, computer, port, doors.system),), computer, False
        )
    is_radio = is_radio and not port.startswith(PSEUDO_TERMINALS)
    line_asked = Line(question.baud, is_radio, question.nonce)
    expected, answers = question.expected, list[RobotAnswers]()

    def hear(each: RobotAnswers) -> None:
        answers.append(each)
        expected.hear(each)

    try:
        findings = line.diagnose_line(wire, line_asked, expected._replace(hear=hear), doors.on_step)
    except OSError:
        cause = "other_host" if is_address(port) else "port_gone"
        findings = [Finding(cause, not is_address(port))]
    finally:
        wire.close()
    # a key is shown by the connection alone, and a robot with an owner tells more then
    has_key = any(
        each.hello.features & OWNED and expected.has_key(each.hello.id) for each in answers
    )
    if (question.watch_ms or has_key) and not any(finding.is_wrong for finding in findings):
        with doors.share(port) as shared:
            findings = list(_diagnose_shared(shared, doors, question))
    return Diagnosis(port, tuple(findings), computer, True)


def _only_port(computer: Computer, virtual: tuple[str, ...]) -> str | None:
    """Return the only port that may be a robot's: of USB or Bluetooth, else of a virtual one."""
    names = [
        port.port for port in computer.ports
        if "usb" in port.port.lower() or "acm" in port.port.lower()
        or looks_wireless(port.port, port.description) or computer.platform == "win32"
    ]  # fmt: skip
    names = names or [*virtual]
    return names[0] if len(names) == 1 else None


def _missing_port_findings(computer: Computer, virtual: tuple[str, ...]) -> tuple[Finding, ...]:
    """Return why there is no port to look at; ports that may be no robot's are named beside."""
    listed = ", ".join([*(port.port for port in computer.ports), *virtual])
    if len(computer.ports) > 1:
        return (sure("which_port", ports=listed),)
    no_port_finding = _no_port_finding(computer)
    if listed and no_port_finding.cause in ("no_port", "charging_cable"):
        return (no_port_finding._replace(values={**no_port_finding.values, "ports": listed}),)
    return (no_port_finding,)


def _no_port_finding(computer: Computer) -> Finding:
    """Return why an adapter, or any at all, has no port."""
    for adapter in adapters_without_driver(computer.adapters or ()):
        if adapter.driver == "usbfs" or "brltty" in computer.programs:
            return Finding("brltty", "brltty" in computer.programs, {"chip": adapter.chip})
        return sure("driver_missing", chip=adapter.chip, driver=adapter.wants or adapter.chip)
    if computer.adapters is not None and not computer.adapters:
        return probably("charging_cable")
    return sure("no_port")


def _diagnose_shared(
    client: LinkConnection, doors: Doors, question: Question
) -> tuple[Finding, ...]:
    robot = SharedRobot(client)
    doors.on_step("hello")
    try:
        reply = robot.hello()
        if reply is None:
            foreign_board = stranger(client)
            if foreign_board is not None:
                return (
                    Finding(
                        foreign_board.name, foreign_board.is_sure, {"said": foreign_board.said}
                    ),
                )
            return (probably("falls_silent"),)
        return tuple(examine(robot, reply, question.expected, question.watch_ms, doors.on_step))
    except ConnectionLost:
        return (sure("port_gone"),)


def _port_in_use(system: System, computer: Computer, port: str) -> Finding | None:
    """Return why this user cannot have the port now, as far as it is known without opening it."""
    who = access(system, canonical_port(port))
    if not who.may_use and who.is_joined:
        return sure("login_again", group=who.group)
    if not who.may_use:
        return sure("no_permission", group=who.group)
    if port.startswith(PSEUDO_TERMINALS):
        return None  # whoever has made it has it open, too
    if "ModemManager" in who.users:
        return sure("modem_manager")
    return sure("busy", by=", ".join(who.users)) if who.users else None


def _is_listed(system: System, computer: Computer, port: str) -> bool:
    return is_address(port) or system.owner(port) is not None or any(
        item.port.lower() == port.lower() for item in computer.ports
    )  # fmt: skip


def open_failure(system: System, port: str, failure: PortError) -> Finding:
    """Return why a port that somebody has tried to open did not open."""
    computer = inspect_computer(system)
    return _port_in_use(system, computer, port) or _open_failure(failure, computer, port, system)


def _open_failure(failure: PortError, computer: Computer, port: str, system: System) -> Finding:
    """Return why a port did not open."""
    if failure.reason == errors.MISSING:
        return _missing_port(computer, port, system)
    if failure.reason == errors.FORBIDDEN:
        return sure("no_permission", group="")
    if failure.reason == errors.BUSY:
        if looks_wireless(port) and failure.why == IN_USE:
            return probably("other_host")
        if "ModemManager" in computer.programs:
            return probably("modem_manager")
        return sure("busy", by="")
    if failure.reason in (errors.UNREACHABLE, errors.SLOW):
        if failure.why == REFUSED and not is_address(port):
            return probably("other_host")
        if not is_address(port) and computer.has_module is False and computer.bluetooth != OFF:
            return probably("not_paired")
        return probably("slow_port" if failure.reason == errors.SLOW else "out_of_reach")
    if failure.reason == errors.NO_PORT:
        return sure("no_serial_port")
    return sure("port_broken", why=failure.why)


def _missing_port(computer: Computer, port: str, system: System) -> Finding:
    """Return why the port that was named does not exist."""
    if looks_wireless(port):
        if computer.bluetooth == NONE:
            return sure("no_bluetooth")
        if computer.bluetooth == OFF:
            return sure("bluetooth_off")
        if computer.has_module is False:
            return sure("not_paired")
        if computer.platform == "linux" and "rfcomm" in port:
            return Finding("no_rfcomm", bool(computer.has_module), {"number": port[-1:]})
    if adapters_without_driver(computer.adapters or ()) or not computer.ports:
        return _no_port_finding(computer)
    return sure("port_missing", ports=", ".join(port.port for port in computer.ports))
