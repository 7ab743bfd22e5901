"""The other side of an ESP32's radios: clients of its transports, in the chip's time."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from struct import pack, unpack
from typing import NamedTuple, Protocol

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import TICKS
from tiniscript.link.session import Session

MIN_MTU = 23


class Client(Protocol):
    """A connected client. `poll` returns the bytes to send, `receive` gets the received ones."""

    def poll(self, now_ms: int) -> bytes: ...

    def receive(self, data: bytes, now_ms: int) -> None: ...


class RawClient:
    """A client without a session: the bytes to send, and the received ones."""

    def __init__(self, line: bytes = b"") -> None:
        self.to_send = line
        self.received = b""

    def poll(self, now_ms: int) -> bytes:
        data, self.to_send = self.to_send, b""
        return data

    def receive(self, data: bytes, now_ms: int) -> None:
        self.received += data


class End(Protocol):
    """A transport as its client sees it."""

    def send(self, data: bytes) -> None: ...

    def take(self) -> bytes: ...

    def leave(self) -> None: ...


class LowEnergy:
    """A client of the Nordic UART service. It takes one notification in each `look_interval`."""

    def __init__(self, robot: Esp32Robot, mtu: int = MIN_MTU, look_interval: int = 1) -> None:
        self.robot, self.mtu, self.look_interval = robot, mtu, look_interval
        self.lengths: list[int] = []
        self._notifications: list[bytes] = []
        self._look_count = 0
        self._number = robot.radio("c")
        if mtu != MIN_MTU:
            robot.radio("m", self._number + pack("<H", mtu))
        self.subscribe()

    @property
    def has_ended(self) -> bool:
        return self.robot.radio("e", self._number) == b"\0"

    def subscribe(self, has_subscribed: bool = True) -> None:
        self.robot.radio("s", self._number + bytes([has_subscribed]))

    def send(self, data: bytes) -> None:
        max_bytes = self.mtu - 3
        for k in range(0, len(data), max_bytes):
            self.robot.radio("w", self._number + _text(data[k : k + max_bytes]))

    def take(self) -> bytes:
        answer = self.robot.radio("n", self._number)
        count, answer = int.from_bytes(answer[:4], "little"), answer[4:]
        for _ in range(count):
            data, answer = _split_first(answer)
            self.lengths.append(len(data))
            self._notifications.append(data)
        self._look_count += 1
        if self._look_count % self.look_interval or not self._notifications:
            return b""
        return self._notifications.pop(0)

    def leave(self) -> None:
        self.robot.radio("d", self._number)


class SerialPort:
    """A client of Bluetooth with a serial port."""

    def __init__(self, robot: Esp32Robot) -> None:
        self.robot = robot
        robot.radio("C", b"\1")

    def send(self, data: bytes) -> None:
        if data:
            self.robot.radio("W", _text(data))

    def take(self) -> bytes:
        return _split_first(self.robot.radio("S"))[0]

    def leave(self) -> None:
        self.robot.radio("C", b"\0")


class Network:
    """A client over TCP, on 127.0.0.1."""

    def __init__(self, robot: Esp32Robot) -> None:
        self.robot = robot
        self.has_ended = False
        port = port_of(robot)
        assert port
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.socket.setblocking(False)

    def send(self, data: bytes) -> None:
        try:
            self.socket.sendall(data)
        except OSError:
            self.has_ended = True

    def take(self) -> bytes:
        try:
            data = self.socket.recv(65536)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        self.has_ended = self.has_ended or not data
        return data

    def leave(self) -> None:
        self.socket.close()


class Radios(NamedTuple):
    """The firmware's requests to the radios."""

    advertised: str
    serial_port: str
    host: str
    instance: str
    service: str
    network: str
    password: str
    is_access_point: bool
    joins: int
    sockets: int  # that are open


def radios(robot: Esp32Robot) -> Radios:
    answer = robot.radio("I")
    texts = []
    for _ in range(7):
        text, answer = _split_first(answer)
        texts.append(text.decode())
    advertised_text, serial_port, host, instance, service, network, password = texts
    return Radios(advertised_text, serial_port, host, instance, service, network, password,
                  *unpack("<?II", answer))  # fmt: skip


def port_of(robot: Esp32Robot) -> int:
    return int.from_bytes(robot.radio("P"), "little")


def set_network_in_reach(robot: Esp32Robot, name: str, password: str) -> None:
    """Put a network in reach; an empty name removes it."""
    robot.radio("R", _text(name.encode()) + _text(password.encode()))


def limit_accepted_bytes(robot: Esp32Robot, max_bytes: int) -> None:
    """Limit the bytes that a client in a network accepts at once; 0 accepts none for now."""
    robot.radio("t", pack("<H", max_bytes))


def announce_computer(robot: Esp32Robot, name: str, address: str, wait_ms: int = 0) -> None:
    """Announce a computer's name to the network, whose lookup takes some time."""
    words = _text(name.encode()) + _text(address.encode())
    robot.radio("N", words + wait_ms.to_bytes(2, "little"))


def talk(
    robot: Esp32Robot,
    clients: Sequence[tuple[End | None, Client]],
    milliseconds: int,
    flags: int = 0,
) -> None:
    """Let all of them talk with the robot for a while; None is the end of the cable."""
    for _ in range(milliseconds):
        cable = b""
        for end, client in clients:
            data = client.poll(robot.now_ms)
            if end is None:
                cable += data
            elif data:
                end.send(data)
        heard_bytes = robot.step(cable, flags, TICKS)
        flags = 0
        for end, client in clients:
            client.receive(heard_bytes if end is None else end.take(), robot.now_ms)


def session(nonce: int, robot: Esp32Robot) -> Session:
    return Session(nonce, 115200, robot.robot.kit.fingerprint)


def _text(data: bytes) -> bytes:
    return pack("<I", len(data)) + data


def _split_first(answer: bytes) -> tuple[bytes, bytes]:
    length = int.from_bytes(answer[:4], "little")
    return answer[4 : 4 + length], answer[4 + length :]
