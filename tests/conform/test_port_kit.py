"""The checks of a robot on a port: our firmware passes, and changes under way are named."""

from __future__ import annotations

import json
import os
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.pty_robot import PtyRobot, on
from tests.support.robot_on_uno import BAUD, NAMES
from tests.support.simulated_port import simulate
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.conformance.comparing import AGREES
from tiniscript.conformance.kit import link_test_suite
from tiniscript.conformance.port_checks import all_checks, greet, verdicts
from tiniscript.conformance.wire_robot import WireRobot
from tiniscript.link import ports
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR
from tiniscript.link.wire import Wire
from tools.uno import Uno

LINK, ISA = f"{MAJOR}.{MINOR}", f"{ISA_MAJOR}.{ISA_MINOR}"
Change = Callable[[Frame], "Frame | None"]


class ChangedWire(Wire):
    """A wire on which the robot's frames are other ones, or get lost."""

    def __init__(self, port: str, change: Change) -> None:
        super().__init__(ports.open_port(port, 9600))
        self.change = change
        self.rest = b""

    def receive(self, wait_ms: int, quiet_ms: int = 60) -> bytes:
        *packets, self.rest = (self.rest + super().receive(wait_ms, quiet_ms)).split(b"\0")
        frames = (decode_frame(packet) for packet in packets if packet)
        changed_frames = [self.change(frame) for frame in frames if frame]
        return b"".join(encode_frame(frame) for frame in changed_frames if frame)


@contextmanager
def open_changed_robot(robot: PtyRobot, change: Change) -> Iterator[WireRobot]:
    with simulate(robot):
        wire = ChangedWire(robot.port, change)
        try:
            yield WireRobot(wire, 5, 300)
        finally:
            wire.close()


def number_of(name: str) -> int:
    return BY_NAME[name].number


def test_our_firmware_passes_all_checks(pty_robot: PtyRobot, tsc: Tsc) -> None:
    result = tsc("doctor", "--conform", "--port", pty_robot.port).gives(0)
    count = len(all_checks(link_test_suite()))
    assert count > 200
    assert result.out == f"{count} of {count} checks pass. Kit 1, link {LINK}, bytecode {ISA}.\n"
    assert not any("MOTORS" in row and row != "MOTORS 0 0" for row in pty_robot.actions)


@pytest.mark.sampled("group")
@pytest.mark.parametrize("group", ["link: ", "images: ", "stops: ", "programs: moves"])
def test_an_uno_passes_the_checks(group: str, sketch: Path, tmp_path: Path, tsc: Tsc) -> None:
    with Uno(sketch, names=NAMES, eeprom=tmp_path / "eeprom", baud=BAUD, tells_sleep=False) as uno:
        uno.go()
        result = tsc("doctor", "--conform", "--port", uno.pty, "--only", group)
    assert result.code == 0, result.out


def alter_payload(name: str, **fields: Callable[[bytes], bytes]) -> Change:
    """Return a change of one message's payload."""

    def change(frame: Frame) -> Frame | None:
        if frame.number != number_of(name):
            return frame
        return frame._replace(payload=fields["payload"](frame.payload))

    return change


def drop_message(name: str) -> Change:
    return lambda frame: None if frame.number == number_of(name) else frame


def with_status(number: int, status: int) -> Change:
    """Return a change of the status in every answer to a message."""

    def change(frame: Frame) -> Frame | None:
        if frame.number != number or frame.payload[:1] == b"\0":
            return frame
        return frame._replace(payload=bytes([status]) + frame.payload[1:])

    return change


FRAME_CHANGES: dict[str, tuple[Change, str]] = {
    "a value is one more": (
        alter_payload("SHOW", payload=lambda p: bytes([p[0] ^ 1]) + p[1:]), "programs: values"),
    "a value is a number, not TRUE": (
        alter_payload("SHOW", payload=lambda p: p[:4] + b"\0"),
        "programs: instructions: Values other than 0"),
    "values get lost": (drop_message("SHOW"), "programs: values"),
    "a fault is elsewhere": (
        alter_payload("FAULT", payload=lambda p: p[:2] + b"\x07" + p[3:]),
        "programs: arithmetic: DIV"),
    "STOPPED gets lost": (drop_message("STOPPED"), "stops: STOP"),
    "the cause of a stop is another": (
        alter_payload("STOPPED", payload=lambda p: b"\3"), "stops: the stop sequence"),
    "an event has another form": (
        alter_payload("STOPPED", payload=lambda p: p + b"?"), "stops: STOP"),
    "a rule is another": (with_status(number_of("PROGRAM"), 21),
                          "refused: refused: A power over 100"),
    "a message that nobody knows": (with_status(31, 65), "link: a message that nobody knows"),
    "a place of something else": (
        alter_payload("PING", payload=lambda p: p[:3] + bytes(len(p) - 3)),
        "link: where a program is"),
    "a long payload": (with_status(number_of("PING"), 64), "link: a payload that is too long"),
    "damaged frames are not counted": (
        alter_payload("STATUS", payload=lambda p: p[:-4] + bytes(4)), "link: a damaged frame"),
    "a wrong checksum is another error": (
        with_status(number_of("COMMIT"), 76), "images: another checksum"),
    "what is fetched is other code": (
        alter_payload("FETCH", payload=lambda p: p[:-1] + b"\xff"), "images: FETCH"),
}  # fmt: skip


@pytest.mark.sampled("change_name", keep=len(FRAME_CHANGES) // 4)
@pytest.mark.parametrize("change_name", FRAME_CHANGES)
def test_a_frame_changed_in_transit_is_named(change_name: str, pty_robot: PtyRobot) -> None:
    change, named_text = FRAME_CHANGES[change_name]
    checks = [
        check for check in all_checks(link_test_suite()) if check.name.startswith(named_text)
    ][:3]
    assert checks
    with open_changed_robot(pty_robot, lambda frame: frame) as robot:
        greet(robot)
        assert {verdict.outcome for verdict in verdicts(robot, checks)} == {AGREES}
    with open_changed_robot(pty_robot, change) as robot:
        greet(robot)
        judged = list(verdicts(robot, checks))
    assert any(verdict.outcome != AGREES for verdict in judged), judged


def test_a_robot_that_falls_silent_ends_the_checks(pty_robot: PtyRobot) -> None:
    with open_changed_robot(pty_robot, lambda frame: frame) as robot:
        greet(robot)
        robot.answer_timeout_ms = 10
        assert isinstance(robot.wire, ChangedWire)
        robot.wire.change = lambda frame: None
        judged = list(verdicts(robot, all_checks(link_test_suite())))
    assert [(verdict.outcome, verdict.detail) for verdict in judged] == [("silent", "PING")] * 3


def test_json_names_the_checks(pty_robot: PtyRobot) -> None:
    result = on(pty_robot, "doctor", "--conform", "--only", "link: PING", "--json")
    assert json.loads(result.out) == {
        "version": "1", "link": LINK, "isa": ISA,
        "cases": 1, "agree": 1, "differ": 0, "found": [],
    }  # fmt: skip


@contextmanager
def server(serve: Callable[[socket.socket], None]) -> Iterator[str]:
    """Yield the port of a server that is not a robot."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def work() -> None:
            peer, _ = listening.accept()
            with peer:
                try:
                    serve(peer)
                except OSError:
                    return

        thread = threading.Thread(target=work, daemon=True)
        thread.start()
        yield f"socket://127.0.0.1:{listening.getsockname()[1]}"


def flood(peer: socket.socket) -> None:
    while True:
        peer.sendall(os.urandom(512))


@pytest.mark.parametrize(
    ("serve", "expected_text"),
    [
        (lambda peer: None, "disappeared"),
        (lambda peer: peer.recv(1), "disappeared"),
        (flood, "responds to HELLO"),
    ],
    ids=["closes", "closes later", "floods"],
)
def test_other_devices_on_the_port_are_reported(
    serve: Callable[[socket.socket], None],
    expected_text: str,
    tsc: Tsc,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from tiniscript.cli.commands import doctor_conform

    monkeypatch.setattr(doctor_conform, "RADIO_TIMEOUT_MS", 50)
    with server(serve) as port:
        result = tsc("doctor", "--conform", "--port", port)
    assert result.code == 3
    assert expected_text in result.err


def test_a_pulled_cable_is_reported(pty_robot: PtyRobot, tsc: Tsc) -> None:
    pulled_timer = threading.Timer(3.0, pty_robot.pull)
    pulled_timer.start()
    result = tsc("doctor", "--conform", "--port", pty_robot.port)
    pulled_timer.join()
    assert result.code == 3
    assert "disappeared after" in result.err


def test_a_missing_port_is_refused(tsc: Tsc) -> None:
    assert tsc("doctor", "--conform", "--port", "/dev/ttyNO").code == 3
    assert tsc("doctor", "--conform", "--port", " ").code == 2


def test_an_owned_robot_is_not_checked(pty_robot: PtyRobot, tsc: Tsc,
                                       monkeypatch: pytest.MonkeyPatch) -> None:  # fmt: skip
    from tiniscript.conformance import port_checks
    from tiniscript.conformance.wire_robot import Answer
    from tiniscript.link.messages import OWNED

    monkeypatch.setattr(port_checks, "greet", lambda robot: Answer(0, 0, {"features": OWNED}, b""))
    tsc("doctor", "--conform", "--port", pty_robot.port).gives(3, "tsc set owner --give-up")


def test_wrong_use_of_a_port_is_refused(tsc: Tsc) -> None:
    assert tsc("doctor", "--conform", "--port", "P", "--machine", "x").code == 2
    assert tsc("doctor", "--conform", "--port", "P", "--timeout", "3").code == 2
    assert tsc("doctor", "--conform", "--port", "P", "--only", "no such check").code == 2
    assert tsc("doctor", "--conform", "--machine", "x", "--baud", "9600").code == 2
