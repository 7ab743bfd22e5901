"""The first bytes of a browser never reach a virtual robot; those of `tsc` or a person do."""

from __future__ import annotations

import contextlib
import socket
from random import Random
from time import monotonic

import pytest

from tests.support.foreign_protocols import FOREIGN_GREETINGS, tls_hello
from tests.support.rows import each_row
from tests.support.simulator_visits import PING, receive, until, visit, wait_until_answered
from tests.support.virtual_robot import floor, robot_in
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, MAJOR, MINOR, PAYLOAD_BYTES, RUN, encode_payload
from tiniscript.link.session import Session
from tiniscript.virtual import transports as limits
from tiniscript.virtual.protocol_sniffer import MAX_LINE_BYTES, sniff_robot_client
from tiniscript.virtual.simulator import Simulator
from tiniscript.virtual.transports import MAX_CALLERS


def verdicts(data: bytes) -> list[bool | None]:
    """Return the verdicts on all prefixes of data, the shortest first."""
    return [sniff_robot_client(data[:k]) for k in range(len(data) + 1)]


def frame(name: str, epoch: int = 0, seq: int = 1, **values: int | bytes) -> bytes:
    message = BY_NAME[name]
    return encode_frame(Frame(message.number, seq, epoch, encode_payload(message.request, values)))


def program() -> bytes:
    """A session and a program that moves, as a page would put them into the body of a POST.

    A page has to guess the epoch that a robot will have; this one knows it.
    """
    kit = robots.load("tinibot").kit
    versions = {"major": MAJOR, "minor": MINOR, "isa_major": ISA_MAJOR, "isa_minor": ISA_MINOR}
    hello = b"\0" + frame("HELLO", **versions, kit=kit.fingerprint, nonce=9)
    reply = robot_in(floor()).step(500, hello)
    epochs = {frame.epoch for frame in map(decode_frame, reply.split(b"\0")) if frame is not None}
    code = unpack(compile_text("SI|F(5,80)", kit).image).code
    return hello + frame("LIVE", epochs.pop(), 2, mode=RUN, code=code)


@each_row("name", FOREIGN_GREETINGS)
def test_no_prefix_of_a_browser_request_is_accepted(name: str) -> None:
    """However slowly it comes, byte by byte."""
    data = FOREIGN_GREETINGS[name]
    answers = verdicts(data)
    assert True not in answers
    assert answers[-1] is False


def test_all_frames_of_a_computer_are_accepted() -> None:
    rng = Random(3)
    session = Session(7, 9600, 5)
    session.hello()
    firsts = [session.poll(0), bytes(8), bytes(2)]
    assert firsts[0][0] == 0
    numbers = [message.number for message in BY_NAME.values() if message.number < 32]
    for _ in range(20_000):
        payload = rng.randbytes(rng.randrange(PAYLOAD_BYTES))
        if rng.random() < 0.5:
            payload = bytes(rng.choice((0, 0, 3, 22)) for _ in payload)
        number = rng.choice(numbers)
        if number == BY_NAME["STATUS"].number:
            payload = b""
        data = encode_frame(Frame(number, rng.randrange(256), rng.randrange(256), payload))
        firsts.append(b"\0" + data)
    for data in firsts:
        assert sniff_robot_client(data) is True, data.hex()
        assert False not in [sniff_robot_client(data[:k]) for k in range(4)], data.hex()


@each_row("text, after", [
    ("SI|F(2,80)\n", 5), ("W(1)\r\n", 2), ("POST = 5\n", 6), ("S // stop\n", 10), ("S\r", 2),
    ("PING|\n", 6),  # a method may have this name: at the end of the line it is not one
    ("// HTTP/1.1\n", 1), ("año = 5\n", 2), ("SHOW(1) \n", 5), ("S\0", 2), ("1\n", 2), (" S", 1),
    ("\x1b[A", 3), ("\3\3\3", 3), ("\0F(1)\n", 3), ("\0S\n", 3), ("\ufeffS", 1), ("\t\tS", 3),
    ('SHOW("GET / HTTP/1.1")\n', 5),
])  # fmt: skip
def test_a_line_of_text_is_accepted_as_soon_as_it_is_recognizable(text: str, after: int) -> None:
    answers = verdicts(text.encode())
    assert False not in answers
    assert answers.index(True) == after
    assert None not in answers[after:]


def test_a_first_line_has_an_end() -> None:
    assert sniff_robot_client(b"A" * MAX_LINE_BYTES) is None
    assert sniff_robot_client(b"A" * (MAX_LINE_BYTES + 1)) is False
    assert sniff_robot_client(b"") is sniff_robot_client(b"\0") is None


# -- at the port --------------------------------------------------------------------------------


def wait_until_hung_up(simulator: Simulator, client: socket.socket) -> None:
    """Wait until it is hung up on without a word."""

    def try_to_send() -> bool:
        reply = b"?"
        with contextlib.suppress(BlockingIOError, ConnectionError):
            reply = client.recv(1000)
            assert reply == b""
        with contextlib.suppress(BlockingIOError):
            try:
                client.send(b"x")
            except ConnectionError:
                return True
        return reply == b""

    until(simulator, try_to_send)


def _has_moved(simulator: Simulator) -> bool:
    return any(event.kind == "MOTORS" for event in simulator.robot.take_events())


def test_a_web_request_moves_a_robot_only_without_its_header(simulator: Simulator) -> None:
    for header in (FOREIGN_GREETINGS["post"], FOREIGN_GREETINGS["any method"], tls_hello(), b""):
        with visit(simulator) as client:
            for part in (header[:3], header[3:], program()):
                with contextlib.suppress(ConnectionError):
                    client.sendall(part)
                simulator.turn(0.01)
            if header:
                wait_until_hung_up(simulator, client)
                assert simulator.transports.visit_count == 0
                assert simulator.robot.take_events() == []
            else:
                until(simulator, lambda: _has_moved(simulator))


def test_a_web_page_is_also_refused_after_another_client(simulator: Simulator) -> None:
    with visit(simulator) as first:
        first.sendall(PING)
        until(simulator, lambda: simulator.transports.visit_count == 1)
        with visit(simulator) as page:
            page.sendall(FOREIGN_GREETINGS["post"] + program())
            simulator.turn(0.01)
            wait_until_hung_up(simulator, page)
    until(simulator, lambda: not simulator.transports.is_connected)
    assert not _has_moved(simulator)


def test_a_line_sent_letter_by_letter_is_answered(simulator: Simulator) -> None:
    with visit(simulator) as client:
        for letter in b"PING|\r\n":
            client.send(bytes([letter]))
            for _ in range(3):
                simulator.turn(0.01)
        wait_until_answered(simulator, client, b"\n")
        assert simulator.transports.visit_count == 1


# -- many of them -------------------------------------------------------------------------------


def crowd(simulator: Simulator, count: int, says: bytes = b"") -> list[socket.socket]:
    """Return connections that are there, or on their way."""
    connections = []
    for _ in range(count):
        client = socket.socket()
        client.setblocking(False)
        client.connect_ex(("127.0.0.1", simulator.transports.port))
        connections.append(client)
        if says:
            simulator.turn(0)
            with contextlib.suppress(OSError):
                client.send(says)
    return connections


@pytest.mark.parametrize("says", [b"", b"\0", b"POS"])
def test_many_silent_clients_block_nobody(simulator: Simulator, says: bytes) -> None:
    idle = crowd(simulator, 300, says)
    [client] = crowd(simulator, 1)
    is_said, max_callers, heard_bytes = False, 0, bytearray()

    def ask_and_look() -> bool:
        nonlocal is_said, max_callers
        max_callers = max(max_callers, len(simulator.transports._callers))
        # The server may not be ready yet.
        with contextlib.suppress(BlockingIOError, BrokenPipeError):
            if not is_said:
                is_said = client.send(PING) > 0
        return is_said and b"\0" in receive(client, heard_bytes)

    until(simulator, ask_and_look)
    assert MAX_CALLERS / 2 < max_callers <= MAX_CALLERS
    for connection in (client, *idle):
        connection.close()


def test_silent_clients_are_disconnected(
    simulator: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(limits, "SILENCE_TIMEOUT_S", 0.05)
    monkeypatch.setattr(limits, "OPENING_TIMEOUT_S", 0.0)
    for says in (b"", b"GE"):
        with visit(simulator) as client:
            client.sendall(says)
            wait_until_hung_up(simulator, client)


def test_a_silent_client_gives_way_to_an_active_one(
    simulator: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    with visit(simulator) as first, visit(simulator) as second:
        first.sendall(PING)
        until(simulator, lambda: simulator.transports.visit_count == 1)
        monkeypatch.setattr(limits, "REFUSAL_DELAY_S", 1000.0)
        now_s = [monotonic()]
        monkeypatch.setattr(limits, "monotonic", lambda: now_s[0])
        second.sendall(PING)
        for _ in range(5):  # a client that sends stays connected
            first.sendall(PING)
            for _ in range(10):
                simulator.turn(0.01)
            now_s[0] += 0.7 * limits.IDLE_TIMEOUT_S
            assert simulator.transports.visit_count == 1
        now_s[0] += limits.IDLE_TIMEOUT_S
        until(simulator, lambda: simulator.transports.visit_count == 2)
        wait_until_answered(simulator, second)


def test_the_server_survives_too_many_open_files(
    simulator: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    idle = crowd(simulator, 5)
    until(simulator, lambda: len(simulator.transports._callers) == 5)
    server = simulator.transports._server
    look_count = 0

    class Full:
        """A server whose process has no room for one more file."""

        def accept(self) -> tuple[socket.socket, object]:
            nonlocal look_count
            look_count += 1
            raise OSError(24, "Too many open files")

        def fileno(self) -> int:
            return server.fileno()

    simulator.transports._server = Full()  # type: ignore[assignment]
    with visit(simulator) as client:
        client.sendall(PING)
        until(simulator, lambda: look_count > 1)
        assert len(simulator.transports._callers) < 5
        simulator.transports._server = server
        until(simulator, lambda: simulator.transports.is_connected)
    for connection in idle:
        connection.close()
