"""The steps of the doctor: first the computer, then the port, then the device there.

A port is opened only if no other program has it open, and the port of a cable only after the user
agrees: opening it restarts most boards.
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
from tiniscript.doctor.findings import Finding, probable_finding, sure_finding
from tiniscript.doctor.line import PortFacts
from tiniscript.doctor.robot import SharedRobot
from tiniscript.doctor.system import System
from tiniscript.link import errors
from tiniscript.link.connection import LinkConnection, find_stranger
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
    inspect = macos.inspect_macos if system.platform == "darwin" else linux.inspect_linux
    return inspect(system)


def port_access(system: System, port: str) -> Access:
    """Return the access rights and the users of a port, without opening it."""
    may_have_owner = system.platform != "win32" and not is_address(port)
    owner = system.owner(port) if may_have_owner else None
    if owner is None:
        return FREE_ACCESS
    system_access = macos.access if system.platform == "darwin" else linux.access
    return system_access(system, port, owner)


REFUSED_MESSAGE, IN_USE_MESSAGE = os.strerror(errno.ECONNREFUSED), os.strerror(errno.EBUSY)


class DoctorServices(NamedTuple):
    """Services of the doctor's environment. `may_open` asks the user about the port of a cable.

    `share` opens a port so that other commands share it: a stop gets through while it is watched.
    """

    system: System
    open_wire: Callable[[str, int], Wire]
    join: Callable[[str], LinkConnection | None]
    may_open: Callable[[str], bool]
    is_radio: Callable[[str], bool]
    share: Callable[[str], AbstractContextManager[LinkConnection]]
    on_step: Callable[[str], None] = lambda step: None


class Question(NamedTuple):
    """A question to the user. `last_port` is the last port used, if it exists.

    `virtual_ports` are the ports of the virtual robots that run on this computer.
    """

    port: str | None
    last_port: str | None
    baud: int
    expectations: Expectations
    nonce: int
    watch_ms: int = 0
    virtual_ports: tuple[str, ...] = ()


class Diagnosis(NamedTuple):
    """`port` is None if none was looked at; `is_opened`: bytes were sent there."""

    port: str | None
    findings: tuple[Finding, ...]
    computer: Computer
    is_opened: bool


def diagnose(services: DoctorServices, question: Question) -> Diagnosis:
    services.on_step("computer")
    computer = inspect_computer(services.system)
    port = question.port or question.last_port or _only_port(computer, question.virtual_ports)
    if port is None:
        return Diagnosis(
            None, _missing_port_findings(computer, question.virtual_ports), computer, False
        )
    question = question._replace(expectations=question.expectations._replace(port=port))
    shared_connection = None
    try:
        shared_connection = services.join(port)
        if shared_connection is not None:
            return Diagnosis(
                port, _diagnose_shared(shared_connection, services, question), computer, True
            )
    except OtherVersion as error:
        values = {"verb": error.registration.verb, "theirs": error.version}
        return Diagnosis(port, (sure_finding("other_tsc", **values),), computer, False)
    finally:
        if shared_connection is not None:
            shared_connection.close()
    busy_finding = _port_in_use(services.system, computer, port)
    if busy_finding is not None:
        return Diagnosis(port, (busy_finding,), computer, False)
    is_radio = services.is_radio(port) or port.startswith(PSEUDO_TERMINALS)
    if not is_radio and _is_listed(services.system, computer, port) and not services.may_open(port):
        return Diagnosis(port, (sure_finding("not_opened"),), computer, False)
    return _diagnose_open_port(services, question, computer, port, is_radio)


def _diagnose_open_port(
    services: DoctorServices, question: Question, computer: Computer, port: str, is_radio: bool
) -> Diagnosis:
    try:
        wire = services.open_wire(port, question.baud)
    except PortError as error:
        return Diagnosis(
            port, (_open_failure(error, computer, port, services.system),), computer, False
        )
    is_radio = is_radio and not port.startswith(PSEUDO_TERMINALS)
    port_facts = PortFacts(question.baud, is_radio, question.nonce)
    expectations, answers = question.expectations, list[RobotAnswers]()

    def on_answers(answer: RobotAnswers) -> None:
        answers.append(answer)
        expectations.on_answers(answer)

    try:
        findings = line.diagnose_line(
            wire, port_facts, expectations._replace(on_answers=on_answers), services.on_step
        )
    except OSError:
        cause = "other_host" if is_address(port) else "port_gone"
        findings = [Finding(cause, not is_address(port))]
    finally:
        wire.close()
    # only the connection authenticates, and then an owned robot reports more
    has_key = any(
        answer.hello.features & OWNED and expectations.has_key(answer.hello.id)
        for answer in answers
    )
    if (question.watch_ms or has_key) and not any(finding.is_wrong for finding in findings):
        with services.share(port) as connection:
            findings = list(_diagnose_shared(connection, services, question))
    return Diagnosis(port, tuple(findings), computer, True)


def _only_port(computer: Computer, virtual_ports: tuple[str, ...]) -> str | None:
    """Return the only port that may be a robot's: on USB or Bluetooth, otherwise a virtual
    one's."""
    names = [
        port.port for port in computer.ports
        if "usb" in port.port.lower() or "acm" in port.port.lower()
        or looks_wireless(port.port, port.description) or computer.platform == "win32"
    ]  # fmt: skip
    names = names or [*virtual_ports]
    return names[0] if len(names) == 1 else None


def _missing_port_findings(
    computer: Computer, virtual_ports: tuple[str, ...]
) -> tuple[Finding, ...]:
    """Return the reasons why there is no port to examine, with ports that may not be robots."""
    listed_ports = ", ".join([*(port.port for port in computer.ports), *virtual_ports])
    if len(computer.ports) > 1:
        return (sure_finding("which_port", ports=listed_ports),)
    no_port_finding = _no_port_finding(computer)
    if listed_ports and no_port_finding.cause in ("no_port", "charging_cable"):
        return (no_port_finding._replace(values={**no_port_finding.values, "ports": listed_ports}),)
    return (no_port_finding,)


def _no_port_finding(computer: Computer) -> Finding:
    """Return the reason why an adapter, or the computer, has no port."""
    for adapter in adapters_without_driver(computer.adapters or ()):
        if adapter.driver == "usbfs" or "brltty" in computer.programs:
            return Finding("brltty", "brltty" in computer.programs, {"chip": adapter.chip})
        return sure_finding(
            "driver_missing", chip=adapter.chip, driver=adapter.wanted_driver or adapter.chip
        )
    if computer.adapters is not None and not computer.adapters:
        return probable_finding("charging_cable")
    return sure_finding("no_port")


def _diagnose_shared(
    connection: LinkConnection, services: DoctorServices, question: Question
) -> tuple[Finding, ...]:
    robot = SharedRobot(connection)
    services.on_step("hello")
    try:
        reply = robot.hello()
        if reply is None:
            foreign_board = find_stranger(connection)
            if foreign_board is not None:
                return (
                    Finding(
                        foreign_board.name, foreign_board.is_sure, {"said": foreign_board.text}
                    ),
                )
            return (probable_finding("falls_silent"),)
        return tuple(
            examine(robot, reply, question.expectations, question.watch_ms, services.on_step)
        )
    except ConnectionLost:
        return (sure_finding("port_gone"),)


def _port_in_use(system: System, computer: Computer, port: str) -> Finding | None:
    """Return the reason why this user cannot use the port now, as far as known without opening
    it.
    """
    access = port_access(system, canonical_port(port))
    if not access.may_use and access.is_joined:
        return sure_finding("login_again", group=access.group)
    if not access.may_use:
        return sure_finding("no_permission", group=access.group)
    if port.startswith(PSEUDO_TERMINALS):
        return None  # the program that created the port also has it open
    if "ModemManager" in access.using_programs:
        return sure_finding("modem_manager")
    return (
        sure_finding("busy", by=", ".join(access.using_programs)) if access.using_programs else None
    )


def _is_listed(system: System, computer: Computer, port: str) -> bool:
    return is_address(port) or system.owner(port) is not None or any(
        listed_port.port.lower() == port.lower() for listed_port in computer.ports
    )  # fmt: skip


def open_failure(system: System, port: str, error: PortError) -> Finding:
    """Return the reason why a port failed to open."""
    computer = inspect_computer(system)
    return _port_in_use(system, computer, port) or _open_failure(error, computer, port, system)


def _open_failure(error: PortError, computer: Computer, port: str, system: System) -> Finding:
    """Return the reason why a port did not open."""
    if error.reason == errors.MISSING:
        return _missing_port(computer, port, system)
    if error.reason == errors.FORBIDDEN:
        return sure_finding("no_permission", group="")
    if error.reason == errors.BUSY:
        if looks_wireless(port) and error.detail == IN_USE_MESSAGE:
            return probable_finding("other_host")
        if "ModemManager" in computer.programs:
            return probable_finding("modem_manager")
        return sure_finding("busy", by="")
    if error.reason in (errors.UNREACHABLE, errors.SLOW):
        if error.detail == REFUSED_MESSAGE and not is_address(port):
            return probable_finding("other_host")
        if not is_address(port) and computer.has_module is False and computer.bluetooth != OFF:
            return probable_finding("not_paired")
        return probable_finding("slow_port" if error.reason == errors.SLOW else "out_of_reach")
    if error.reason == errors.NO_PORT:
        return sure_finding("no_serial_port")
    return sure_finding("port_broken", why=error.detail)


def _missing_port(computer: Computer, port: str, system: System) -> Finding:
    """Return the reason why the named port does not exist."""
    if looks_wireless(port):
        if computer.bluetooth == NONE:
            return sure_finding("no_bluetooth")
        if computer.bluetooth == OFF:
            return sure_finding("bluetooth_off")
        if computer.has_module is False:
            return sure_finding("not_paired")
        if computer.platform == "linux" and "rfcomm" in port:
            return Finding("no_rfcomm", bool(computer.has_module), {"number": port[-1:]})
    if adapters_without_driver(computer.adapters or ()) or not computer.ports:
        return _no_port_finding(computer)
    return sure_finding("port_missing", ports=", ".join(port.port for port in computer.ports))
