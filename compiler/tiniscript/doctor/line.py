"""Finds out what is at the other end of a port: a robot, an echo, a module, another sketch, nobody.

First it listens, then it says HELLO. Only on a cable, where the user has said yes, it asks at
other speeds, too: a radio carries bytes, whatever speed its port has.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from tiniscript.doctor.examination import Expected, examine
from tiniscript.doctor.findings import Finding, probably, sure
from tiniscript.doctor.robot import CABLE_MS, RADIO_MS, WireRobot
from tiniscript.flash.bootloaders import MEGA, NANO_OLD, UNO, Bootloader
from tiniscript.link.modules import dialects, talk
from tiniscript.link.wire import Wire

# For each: what it is greeted with, and how its answer begins.
GREETINGS: tuple[tuple[Bootloader, bytes, bytes], ...] = (
    (UNO, b"\x30\x20", b"\x14\x10"),
    (NANO_OLD, b"\x30\x20", b"\x14\x10"),
    (MEGA, b"\x1b\x01\x00\x01\x0e\x01\x14", b"\x1b\x01\x00"),
)
BLINK_MS = 450  # Optiboot blinks first, and hears no more than two bytes meanwhile
TRIES = 4
ANSWER_MS = 200
OVER_MS = 5000  # a bootloader that has heard nothing for so long has gone on to what is behind it


def answers(wire: Wire) -> tuple[Bootloader, bool] | None:
    """Restart the board and return the bootloader that answers, or None.

    The second value: it answers later on, too; then there is nothing behind it.
    """
    for line, greeting, answer in GREETINGS:
        wire.set_baud(line.baud)
        wire.restart()
        wire.heard(BLINK_MS, BLINK_MS)
        if _greeted(wire, greeting, answer):
            wire.heard(OVER_MS, OVER_MS)
            return line, _greeted(wire, greeting, answer)
    return None


def _greeted(wire: Wire, greeting: bytes, answer: bytes) -> bool:
    for _ in range(TRIES):
        wire.send(greeting)
        if answer in wire.heard(ANSWER_MS):
            return True
    return False


BOOT_MS = 1700  # an Uno takes 1.4 s after its port was opened, and a Mega wants silence until then
HELLOS = 5  # an old Nano's bootloader takes longer
BAUDS = (9600, 115200, 57600, 38400, 19200)
LISTEN_MS = 400  # at a speed, to what a sketch prints
FEW, MOST_TEXT = 4, 60  # bytes that are looked at, characters that are told
READABLE = 0.9  # the share of printable characters in text


class Line(NamedTuple):
    """What is known of a port; `baud` is the speed that a robot should have there."""

    baud: int
    is_radio: bool
    nonce: int


def diagnose_line(
    wire: Wire, line: Line, expected: Expected,
    on_step: Callable[[str], None] = lambda what: None,
) -> list[Finding]:  # fmt: skip
    """Return what is at the other end. `on_step` gets what is done next, a short name."""
    on_step("listen")
    before = wire.heard(LISTEN_MS if line.is_radio else BOOT_MS)
    robot = _robot(wire, line, expected)
    on_step("hello")
    reply = robot.hello(HELLOS)
    if reply is not None:
        return examine(robot, reply, expected, on_step=on_step)
    heard = before + robot.heard
    if _is_echo(heard, robot.spoken):
        return [sure("echo")]
    if _is_error(heard):
        return [sure("module_set_up", baud=str(line.baud))]
    if line.is_radio:
        return [_by_radio(heard)]
    return _by_cable(wire, line, expected, heard, on_step)


def _robot(wire: Wire, line: Line, expected: Expected) -> WireRobot:
    kit = expected.kit or 0
    return WireRobot(wire, line.nonce, kit, RADIO_MS if line.is_radio else CABLE_MS)


def _is_echo(heard: bytes, spoken: bytes) -> bool:
    """Whether at least one whole frame that was sent came back."""
    frames = [part for part in spoken.split(b"\0") if part]
    return any(frame in heard for frame in frames)


def _is_error(heard: bytes) -> bool:
    """Whether a module in its set-up mode complains."""
    return b"ERROR:(" in heard or b"ERROR=" in heard


def readable(heard: bytes) -> str:
    """Return bytes as text, if they are some; else an empty text."""
    text = heard.decode("ascii", "replace")
    good = sum((letter.isprintable() and letter != "�") or letter in "\r\n\t" for letter in text)
    if len(heard) < FEW or good < READABLE * len(text):
        return ""
    rows = [row.strip() for row in text.splitlines() if row.strip()]
    return rows[len(rows) // 2][:MOST_TEXT] if rows else ""


def _by_radio(heard: bytes) -> Finding:
    """The module has answered, for its port is open: what is behind it?"""
    if readable(heard):
        return probably("other_sketch", said=readable(heard))
    if len(heard) >= FEW:
        return probably("module_baud", n=str(len(heard)))
    return probably("crossed")


def _by_cable(
    wire: Wire, line: Line, expected: Expected, heard: bytes,
    on_step: Callable[[str], None],
) -> list[Finding]:  # fmt: skip
    if readable(heard):
        return [sure("other_sketch", said=readable(heard))]
    garbage = len(heard)
    for baud in BAUDS:
        if baud == line.baud:
            continue
        on_step("bauds")
        wire.set_baud(baud)
        more = wire.heard(LISTEN_MS)
        robot = _robot(wire, line, expected)
        reply = robot.hello(1)
        if reply is not None:
            finding = sure("wrong_baud", baud=str(baud), expected=str(line.baud))
            rest = examine(robot, reply, expected, on_step=on_step)
            return [finding, *(finding for finding in rest if finding.cause != "fine")]
        if readable(more):
            return [sure("other_sketch", said=readable(more))]
        garbage = max(garbage, len(more))
    on_step("module")
    module = talk.find_module(wire, tuple(dict.fromkeys((line.baud, *dialects.BAUDS))), wakes=False)
    if module is not None:
        cause = "module_set_up" if module.dialect.is_fixed else "module_alone"
        return [sure(cause, baud=str(module.baud), module=module.dialect.name)]
    on_step("bootloader")
    found_bootloader = answers(wire)
    if found_bootloader is not None:
        board, is_alone = found_bootloader
        return [sure("bootloader_only", board=board.name) if is_alone
                else probably("other_sketch", said="")]  # fmt: skip
    return [probably("garbled", n=str(garbage)) if garbage >= FEW else probably("silent")]
