"""Finds out what is at the other end of a port: a robot, an echo, a module, another board, nobody.

First it listens, then it says HELLO, then it asks the harmless questions of `link.foreign`. Only on
a cable, where the user has said yes, it asks at other speeds, too: a radio carries bytes, whatever
speed its port has. Bytes that are text at a speed are of something that has this speed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from tiniscript.doctor.examination import Expectations, examine
from tiniscript.doctor.findings import Finding, probably, sure
from tiniscript.doctor.robot import CABLE_MS, RADIO_MS, WireRobot
from tiniscript.flash.bootloaders import MEGA, NANO_OLD, UNO, Bootloader
from tiniscript.link import foreign
from tiniscript.link.foreign import ECHO_SKETCH, Foreign
from tiniscript.link.modules import dialects, talk
from tiniscript.link.wire import Wire

# For each: what it is greeted with, and how its answer begins.
GREETINGS: tuple[tuple[Bootloader, bytes, bytes], ...] = (
    (UNO, b"\x30\x20", b"\x14\x10"),
    (NANO_OLD, b"\x30\x20", b"\x14\x10"),
    (MEGA, b"\x1b\x01\x00\x01\x0e\x01\x14", b"\x1b\x01\x00"),
)
BLINK_WAIT_MS = 450  # Optiboot blinks first, and hears no more than two bytes meanwhile
BOOTLOADER_TRIES = 4
ANSWER_LIMIT_MS = 200
BOOTLOADER_MS = (
    5000  # a bootloader that has heard nothing for so long has gone on to what is behind it
)


def find_bootloader(wire: Wire, hear: Callable[[bytes], None]) -> tuple[Bootloader, bool] | None:
    """Restart the board and return the bootloader that answers, or None.

    The second value: it answers later on, too; then there is nothing behind it. `hear` gets what
    the board says after each restart.
    """
    for line, greeting, answer in GREETINGS:
        wire.set_baud(line.baud)
        wire.reset_board()
        answer_bytes = wire.receive(BLINK_WAIT_MS, BLINK_WAIT_MS)
        has_answered = False
        for _ in range(BOOTLOADER_TRIES):
            wire.send(greeting)
            answer_bytes += wire.receive(ANSWER_LIMIT_MS)
            if has_answered := answer in answer_bytes:
                break
        if has_answered:
            wire.receive(BOOTLOADER_MS, BOOTLOADER_MS)
            return line, _greet(wire, greeting, answer)
        hear(answer_bytes)
    return None


def _greet(wire: Wire, greeting: bytes, answer: bytes) -> bool:
    for _ in range(BOOTLOADER_TRIES):
        wire.send(greeting)
        if answer in wire.receive(ANSWER_LIMIT_MS):
            return True
    return False


# An Uno takes 1.4 s after its port was opened, and a Mega wants silence until then.
BOOT_WAIT_MS = 1700
HELLO_TRIES = 5  # an old Nano's bootloader takes longer
BAUDS = (9600, 115200, 57600, 38400, 19200)
LISTEN_LIMIT_MS = 400  # at a speed, to what a sketch prints
PROBE_MS, RADIO_PROBE_MS = 200, 500  # for an answer of a board that is not ours
LEAST_BYTES = 4  # bytes: fewer say nothing


class Line(NamedTuple):
    """What is known of a port; `baud` is the speed that a robot should have there."""

    baud: int
    is_radio: bool
    nonce: int


def diagnose_line(
    wire: Wire, line: Line, expected: Expectations,
    on_step: Callable[[str], None] = lambda what: None,
) -> list[Finding]:  # fmt: skip
    """Return what is at the other end. `on_step` gets what is done next, a short name."""
    on_step("listen")
    before = wire.receive(LISTEN_LIMIT_MS if line.is_radio else BOOT_WAIT_MS)
    robot = _wire_robot(wire, line, expected)
    on_step("hello")
    reply = robot.hello(HELLO_TRIES)
    if reply is not None:
        return examine(robot, reply, expected, on_step=on_step)
    received = before + robot.heard
    if _is_error(received):
        return [sure("module_set_up", baud=str(line.baud))]
    strangers = _Strangers(wire, RADIO_PROBE_MS if line.is_radio else PROBE_MS)
    finding = strangers.find(received, robot.spoken, partial(_identify_echo, wire, line, expected))
    if finding is not None:
        return [finding]
    if line.is_radio:
        return [strangers.best_finding() or _diagnose_radio(received)]
    return _diagnose_cable(wire, line, expected, received, strangers, on_step)


def _wire_robot(wire: Wire, line: Line, expected: Expectations) -> WireRobot:
    kit = expected.kit or 0
    return WireRobot(wire, line.nonce, kit, RADIO_MS if line.is_radio else CABLE_MS)


def _is_echo(received: bytes, sent: bytes) -> bool:
    """Whether at least one whole frame that was sent came back."""
    frames = [part for part in sent.split(b"\0") if part]
    return any(frame in received for frame in frames)


def _is_error(received: bytes) -> bool:
    """Whether a module in its set-up mode complains."""
    return b"ERROR:(" in received or b"ERROR=" in received


class _Strangers:
    """Looks for boards that are not ours in what is heard. What is sure is told at once; of the
    rest the best is kept until nothing else is found."""

    def __init__(self, wire: Wire, wait_ms: int) -> None:
        self._wire, self._wait_ms = wire, wait_ms
        self._kept: list[Finding] = []

    def find(self, received: bytes, sent: bytes, echo: Callable[[], Finding]) -> Finding | None:
        """Return what is surely there. `echo` returns what it is that sends back what is sent, and
        says nothing else."""
        finding = self.look(received)
        is_echo = _is_echo(received, sent)
        if finding is None and not (is_echo and self.best_finding() is None):
            finding = self.ask(received, not is_echo)
        if finding is None and is_echo:
            text = _text_beside(received, sent)
            finding = sure(ECHO_SKETCH, said=text) if text else echo()
        return finding

    def look(self, received: bytes) -> Finding | None:
        """Return what has surely sent these bytes, by its row or as a robot that does not hear."""
        if foreign.is_robot(received):
            return probably("one_way")
        board = foreign.identify_board(received)
        return (
            None if board is not None and board.name in foreign.GENERAL_ROWS else self._judge(board)
        )

    def ask(self, received: bytes, may_be_text: bool) -> Finding | None:
        """Send the probes, and return what surely answers, or is surely text without them.

        Each answer is looked at by itself: one who says again what it gets must not be taken for a
        board that answers the last probe with the next one.
        """
        for row in foreign.ROWS:
            if row.probe:
                self._wire.send(row.probe)
                finding = self._judge(
                    foreign.identify_board(received + self._wire.receive(self._wait_ms))
                )
                if finding is not None:
                    return finding
        if (best := self.best_finding()) is not None and best.cause == "at_firmware":
            self._wire.send(foreign.AT_VERSION_QUESTION)
            finding = self._judge(
                foreign.identify_board(received + self._wire.receive(dialects.ANSWER_MS))
            )
            if finding is not None:
                return finding
        return self._judge(foreign.identify_stranger(received)) if may_be_text else None

    def settle(self, received: bytes) -> Finding | None:
        """Return what has sent these bytes, where no question would help."""
        board = foreign.identify_board(received)
        return None if board is None else self._judge(board)

    def best_finding(self) -> Finding | None:
        """Return what is probably there."""
        return self._kept[0] if self._kept else None

    def _judge(self, board: Foreign | None) -> Finding | None:
        if board is None:
            return None
        finding = Finding(board.name, board.is_sure, {"said": board.said})
        if board.is_sure:
            return finding
        self._kept.append(finding)
        return None


def _identify_echo(wire: Wire, line: Line, expected: Expectations) -> Finding:
    """Return what sends back: a sketch has one speed, a wire has every one."""
    if line.is_radio:
        return probably("echo")
    wire.set_baud(next(baud for baud in BAUDS if baud != line.baud))
    robot = _wire_robot(wire, line, expected)
    robot.hello(1)
    if _is_echo(robot.heard, robot.spoken):
        return sure("echo")
    return _identify_echo_of_one_speed(wire, line.baud)


def _identify_echo_of_one_speed(wire: Wire, baud: int) -> Finding:
    """Return what sends back at this speed only: what takes commands may do so, too."""
    return _find_module(wire, (baud,)) or sure(ECHO_SKETCH, said="")


def _text_beside(received: bytes, sent: bytes) -> str:
    """Return the text that came with what was sent and came back, if any did."""
    for frame in sent.split(b"\0"):
        received = received.replace(frame, b"") if frame else received
    return foreign.readable_line(received.replace(b"\0", b""))


def _find_module(wire: Wire, bauds: tuple[int, ...]) -> Finding | None:
    """Return the module that answers commands, or the board that does as one does."""
    module = talk.find_module(wire, bauds, wakes=False)
    if module is None:
        return None
    if not module.version:  # no module has told which one it is
        wire.send(foreign.AT_VERSION_QUESTION)
        board = foreign.identify_board(wire.receive(dialects.ANSWER_MS))
        if board is not None:
            return Finding(board.name, board.is_sure, {"said": board.said})
    cause = "module_set_up" if module.dialect.is_fixed else "module_alone"
    return sure(cause, baud=str(module.baud), module=module.dialect.name)


def _diagnose_radio(received: bytes) -> Finding:
    """The module has answered, for its port is open: what is behind it?"""
    if len(received) >= LEAST_BYTES:
        return probably("module_baud", n=str(len(received)))
    return probably("crossed")


def _diagnose_cable(
    wire: Wire, line: Line, expected: Expectations, received: bytes, strangers: _Strangers,
    on_step: Callable[[str], None],
) -> list[Finding]:  # fmt: skip
    garbage_bytes = len(received)
    for baud in BAUDS:
        if baud == line.baud:
            continue
        on_step("bauds")
        wire.set_baud(baud)
        received_later = wire.receive(LISTEN_LIMIT_MS)
        robot = _wire_robot(wire, line, expected)
        reply = robot.hello(1)
        if reply is not None:
            finding = sure("wrong_baud", baud=str(baud), expected=str(line.baud))
            findings = examine(robot, reply, expected, on_step=on_step)
            return [finding, *(finding for finding in findings if finding.cause != "fine")]
        received_later += robot.heard
        identify_echo = partial(_identify_echo_of_one_speed, wire, baud)
        other_finding = strangers.find(received_later, robot.spoken, identify_echo)
        if other_finding is not None:
            return [other_finding]
        garbage_bytes = max(garbage_bytes, len(received_later))
    on_step("module")
    other_finding = _find_module(wire, tuple(dict.fromkeys((line.baud, *dialects.BAUDS))))
    if other_finding is not None:
        return [other_finding]
    on_step("bootloader")
    booted: list[bytes] = []
    found_bootloader = find_bootloader(wire, booted.append)
    for boot_text in booted:
        other_finding = strangers.look(boot_text) or strangers.settle(boot_text)
        if other_finding is not None:
            return [other_finding]
    if found_bootloader is not None:
        board, has_only_bootloader = found_bootloader
        return [sure("bootloader_only", board=board.name) if has_only_bootloader
                else strangers.best_finding() or probably("other_sketch", said="")]  # fmt: skip
    best_finding = strangers.best_finding()
    return [
        best_finding
        or (
            probably("garbled", n=str(garbage_bytes))
            if garbage_bytes >= LEAST_BYTES
            else probably("silent")
        )
    ]
