"""Identifies the other end of a port: a robot, an echo, a module, another board, nothing.

First it listens, then it says HELLO, then it asks the harmless questions of `link.foreign`. Only on
a cable, and if the user has agreed, it also tries other speeds: a radio carries bytes whatever the
speed of its port. Bytes that are text at a speed are of something that has this speed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from tiniscript.doctor.examination import Expectations, examine
from tiniscript.doctor.findings import Finding, probable_finding, sure_finding
from tiniscript.doctor.robot import CABLE_TIMEOUT_MS, RADIO_TIMEOUT_MS, WireRobot
from tiniscript.flash.bootloaders import MEGA, NANO_OLD, UNO, Bootloader
from tiniscript.link import foreign
from tiniscript.link.foreign import ECHO_SKETCH, ForeignBoard
from tiniscript.link.modules import dialects, talk
from tiniscript.link.wire import Wire

# The greeting of each bootloader, and the start of its answer.
GREETINGS: tuple[tuple[Bootloader, bytes, bytes], ...] = (
    (UNO, b"\x30\x20", b"\x14\x10"),
    (NANO_OLD, b"\x30\x20", b"\x14\x10"),
    (MEGA, b"\x1b\x01\x00\x01\x0e\x01\x14", b"\x1b\x01\x00"),
)
BLINK_WAIT_MS = 450  # Optiboot blinks first, and hears no more than two bytes meanwhile
BOOTLOADER_TRIES = 4
ANSWER_TIMEOUT_MS = 200
BOOTLOADER_TIMEOUT_MS = 5000  # silence after which a bootloader has started its sketch


def find_bootloader(
    wire: Wire, on_bytes: Callable[[bytes], None]
) -> tuple[Bootloader, bool] | None:
    """Restart the board and return the bootloader that answers, or None.

    The second value: it still answers later on; then nothing is connected to it. `on_bytes` gets
    the board's output after each restart.
    """
    for bootloader, greeting, answer in GREETINGS:
        wire.set_baud(bootloader.baud)
        wire.reset_board()
        answer_bytes = wire.receive(BLINK_WAIT_MS, BLINK_WAIT_MS)
        has_answered = False
        for _ in range(BOOTLOADER_TRIES):
            wire.send(greeting)
            answer_bytes += wire.receive(ANSWER_TIMEOUT_MS)
            if has_answered := answer in answer_bytes:
                break
        if has_answered:
            wire.receive(BOOTLOADER_TIMEOUT_MS, BOOTLOADER_TIMEOUT_MS)
            return bootloader, _greet(wire, greeting, answer)
        on_bytes(answer_bytes)
    return None


def _greet(wire: Wire, greeting: bytes, answer: bytes) -> bool:
    for _ in range(BOOTLOADER_TRIES):
        wire.send(greeting)
        if answer in wire.receive(ANSWER_TIMEOUT_MS):
            return True
    return False


# An Uno takes 1.4 s after its port was opened, and a Mega wants silence until then.
BOOT_WAIT_MS = 1700
HELLO_TRIES = 5  # an old Nano's bootloader takes longer
BAUDS = (9600, 115200, 57600, 38400, 19200)
LISTEN_MS = 400  # time to listen for a sketch's output at one speed
PROBE_TIMEOUT_MS, RADIO_PROBE_TIMEOUT_MS = 200, 500  # time for the answer of a foreign board
MIN_BYTES = 4  # fewer bytes are not enough


class PortFacts(NamedTuple):
    """Known facts of a port; `baud` is the expected speed of a robot there."""

    baud: int
    is_radio: bool
    nonce: int


def diagnose_line(
    wire: Wire, facts: PortFacts, expectations: Expectations,
    on_step: Callable[[str], None] = lambda step: None,
) -> list[Finding]:  # fmt: skip
    """Return the kind of device at the other end. `on_step` gets the short name of each next
    step.
    """
    on_step("listen")
    early_bytes = wire.receive(LISTEN_MS if facts.is_radio else BOOT_WAIT_MS)
    robot = _wire_robot(wire, facts, expectations)
    on_step("hello")
    reply = robot.hello(HELLO_TRIES)
    if reply is not None:
        return examine(robot, reply, expectations, on_step=on_step)
    received_bytes = early_bytes + robot.received
    if _has_module_error(received_bytes):
        return [sure_finding("module_set_up", baud=str(facts.baud))]
    boards = _ForeignBoards(wire, RADIO_PROBE_TIMEOUT_MS if facts.is_radio else PROBE_TIMEOUT_MS)
    finding = boards.find(
        received_bytes, robot.sent, partial(_identify_echo, wire, facts, expectations)
    )
    if finding is not None:
        return [finding]
    if facts.is_radio:
        return [boards.best_finding() or _diagnose_radio(received_bytes)]
    return _diagnose_cable(wire, facts, expectations, received_bytes, boards, on_step)


def _wire_robot(wire: Wire, facts: PortFacts, expectations: Expectations) -> WireRobot:
    kit = expectations.kit or 0
    return WireRobot(
        wire, facts.nonce, kit, RADIO_TIMEOUT_MS if facts.is_radio else CABLE_TIMEOUT_MS
    )


def _is_echo(received_bytes: bytes, sent_bytes: bytes) -> bool:
    """Return whether at least one whole frame came back."""
    frames = [part for part in sent_bytes.split(b"\0") if part]
    return any(frame in received_bytes for frame in frames)


def _has_module_error(received_bytes: bytes) -> bool:
    """Return whether a module in command mode reports an error."""
    return b"ERROR:(" in received_bytes or b"ERROR=" in received_bytes


class _ForeignBoards:
    """Looks for foreign boards in the received bytes. A certain finding is reported at once; the
    best uncertain one is reported if nothing better is found.
    """

    def __init__(self, wire: Wire, wait_ms: int) -> None:
        self._wire, self._wait_ms = wire, wait_ms
        self._probable_findings: list[Finding] = []

    def find(
        self, received_bytes: bytes, sent_bytes: bytes, identify_echo: Callable[[], Finding]
    ) -> Finding | None:
        """Return a certain finding. `identify_echo` returns the kind of a pure echo."""
        finding = self.identify(received_bytes)
        is_echo = _is_echo(received_bytes, sent_bytes)
        if finding is None and not (is_echo and self.best_finding() is None):
            finding = self.probe(received_bytes, not is_echo)
        if finding is None and is_echo:
            text = _text_beside(received_bytes, sent_bytes)
            finding = sure_finding(ECHO_SKETCH, said=text) if text else identify_echo()
        return finding

    def identify(self, received_bytes: bytes) -> Finding | None:
        """Return the certain sender of these bytes: by its row, or a robot that does not hear."""
        if foreign.is_robot(received_bytes):
            return probable_finding("one_way")
        board = foreign.identify_board(received_bytes)
        return (
            None if board is not None and board.name in foreign.GENERAL_ROWS else self._judge(board)
        )

    def probe(self, received_bytes: bytes, may_be_text: bool) -> Finding | None:
        """Send the probes, and return sure answers, or text that surely came without them.

        Each answer is examined on its own: a device that echoes its input must not be mistaken for
        a board that answers the last probe with the next one.
        """
        for row in foreign.BOARD_KINDS:
            if row.probe:
                self._wire.send(row.probe)
                finding = self._judge(
                    foreign.identify_board(received_bytes + self._wire.receive(self._wait_ms))
                )
                if finding is not None:
                    return finding
        if (best := self.best_finding()) is not None and best.cause == "at_firmware":
            self._wire.send(foreign.AT_VERSION_QUESTION)
            finding = self._judge(
                foreign.identify_board(received_bytes + self._wire.receive(dialects.ANSWER_MS))
            )
            if finding is not None:
                return finding
        return self._judge(foreign.identify_stranger(received_bytes)) if may_be_text else None

    def identify_any(self, received_bytes: bytes) -> Finding | None:
        """Return the sender of these bytes if a question would not help."""
        board = foreign.identify_board(received_bytes)
        return None if board is None else self._judge(board)

    def best_finding(self) -> Finding | None:
        """Return the most probable finding."""
        return self._probable_findings[0] if self._probable_findings else None

    def _judge(self, board: ForeignBoard | None) -> Finding | None:
        if board is None:
            return None
        finding = Finding(board.name, board.is_sure, {"said": board.text})
        if board.is_sure:
            return finding
        self._probable_findings.append(finding)
        return None


def _identify_echo(wire: Wire, facts: PortFacts, expectations: Expectations) -> Finding:
    """Return the kind of echo: a sketch has one speed, a wire works at any."""
    if facts.is_radio:
        return probable_finding("echo")
    wire.set_baud(next(baud for baud in BAUDS if baud != facts.baud))
    robot = _wire_robot(wire, facts, expectations)
    robot.hello(1)
    if _is_echo(robot.received, robot.sent):
        return sure_finding("echo")
    return _identify_echo_of_one_speed(wire, facts.baud)


def _identify_echo_of_one_speed(wire: Wire, baud: int) -> Finding:
    """Return the device that echoes at this speed only, possibly one that accepts commands."""
    return _find_module(wire, (baud,)) or sure_finding(ECHO_SKETCH, said="")


def _text_beside(received_bytes: bytes, sent_bytes: bytes) -> str:
    """Return the text received together with an echo, if any."""
    for frame in sent_bytes.split(b"\0"):
        received_bytes = received_bytes.replace(frame, b"") if frame else received_bytes
    return foreign.readable_line(received_bytes.replace(b"\0", b""))


def _find_module(wire: Wire, bauds: tuple[int, ...]) -> Finding | None:
    """Return the module that answers commands, or the board that does as one does."""
    module = talk.find_module(wire, bauds, wakes_module=False)
    if module is None:
        return None
    if not module.version:  # no module has identified itself
        wire.send(foreign.AT_VERSION_QUESTION)
        board = foreign.identify_board(wire.receive(dialects.ANSWER_MS))
        if board is not None:
            return Finding(board.name, board.is_sure, {"said": board.text})
    cause = "module_set_up" if module.dialect.keeps_baud else "module_alone"
    return sure_finding(cause, baud=str(module.baud), module=module.dialect.name)


def _diagnose_radio(received_bytes: bytes) -> Finding:
    """Diagnose the device connected to a module that answers while its port is open."""
    if len(received_bytes) >= MIN_BYTES:
        return probable_finding("module_baud", n=str(len(received_bytes)))
    return probable_finding("crossed")


def _diagnose_cable(
    wire: Wire,
    facts: PortFacts,
    expectations: Expectations,
    received_bytes: bytes,
    boards: _ForeignBoards,
    on_step: Callable[[str], None],
) -> list[Finding]:
    garbage_bytes = len(received_bytes)
    for baud in BAUDS:
        if baud == facts.baud:
            continue
        on_step("bauds")
        wire.set_baud(baud)
        later_bytes = wire.receive(LISTEN_MS)
        robot = _wire_robot(wire, facts, expectations)
        reply = robot.hello(1)
        if reply is not None:
            finding = sure_finding("wrong_baud", baud=str(baud), expected=str(facts.baud))
            findings = examine(robot, reply, expectations, on_step=on_step)
            return [finding, *(finding for finding in findings if finding.cause != "fine")]
        later_bytes += robot.received
        identify_echo = partial(_identify_echo_of_one_speed, wire, baud)
        other_finding = boards.find(later_bytes, robot.sent, identify_echo)
        if other_finding is not None:
            return [other_finding]
        garbage_bytes = max(garbage_bytes, len(later_bytes))
    on_step("module")
    other_finding = _find_module(wire, tuple(dict.fromkeys((facts.baud, *dialects.BAUDS))))
    if other_finding is not None:
        return [other_finding]
    on_step("bootloader")
    boot_outputs: list[bytes] = []
    found_bootloader = find_bootloader(wire, boot_outputs.append)
    for boot_output in boot_outputs:
        other_finding = boards.identify(boot_output) or boards.identify_any(boot_output)
        if other_finding is not None:
            return [other_finding]
    if found_bootloader is not None:
        board, has_only_bootloader = found_bootloader
        return [
            sure_finding("bootloader_only", board=board.name)
            if has_only_bootloader
            else boards.best_finding() or probable_finding("other_sketch", said="")
        ]
    best_finding = boards.best_finding()
    return [
        best_finding
        or (
            probable_finding("garbled", n=str(garbage_bytes))
            if garbage_bytes >= MIN_BYTES
            else probable_finding("silent")
        )
    ]
