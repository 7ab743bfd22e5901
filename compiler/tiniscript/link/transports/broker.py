"""Robots at an MQTT broker: which ones are there, a port for each, and a stop for all of them.

All robots of a broker share a connection of this process. A message is a piece of the port's byte
stream: no message is retained, and all have QoS 0, because the session repeats lost bytes. Knows
paho-mqtt; importing this fails without it. Anyone who may publish at the broker can send anything:
the seals of the link decide what is trusted. Knows no sentences.
"""

from __future__ import annotations

import os
import re
import ssl
from contextlib import suppress
from pathlib import Path
from threading import Lock, RLock
from time import monotonic
from typing import Any, NamedTuple

import paho.mqtt.client as mqtt
from paho.mqtt.enums import CallbackAPIVersion

from tiniscript.base.bell import Bell
from tiniscript.link import errors
from tiniscript.link.errors import PortError
from tiniscript.link.messages import NAME_BYTES, STOP_BYTES
from tiniscript.link.port_names import MQTT
from tiniscript.link.transports import READ_S
from tiniscript.link.transports.pushed import PushedTransport
from tiniscript.link.wifi import is_class_name

PLAIN_PORT, TLS_PORT = 1883, 8883
ROOT = "tiniscript"
CONNECT_S = 5.0
KEEP_ALIVE_S = 4
LIST_S = 10.0  # time for a broker to send its retained messages
LEAVE_S = 0.5
PATIENCE_S = 4.0  # a robot frees its place when a client that was killed has been silent for 3 s
QUIET_S = 0.3  # silence after which the list is complete
MAX_ROBOTS = 250  # most robots in a list
MESSAGE_BYTES = 4096  # bytes of the longest message accepted; a robot sends less
SKIPPED_BYTES = 1 << 20  # bytes of the longest message skipped; a longer one ends the connection
MAX_SKIPPED, TOPIC_CHARACTERS = 20, 80  # topics that are named, and of one
_PUBLISH, _PINGRESP = 0x30, 0xD0  # kinds of packets
PIECE_BYTES = 400  # bytes of a message's piece; a robot accepts 512
DRIVER_S = 0.5  # silence of the driver after which its run is not kept alive
_PORT = re.compile(rf"{MQTT}(.+):(\d{{1,5}})/([a-z0-9-]{{1,16}})/([0-9a-f]{{8}})", re.IGNORECASE)


class Access(NamedTuple):
    """The credentials of this process; an empty name means none; `trusted_file` holds a
    certificate.
    """

    user: str = ""
    password: str = ""
    is_tls: bool = False
    trusted_file: str | None = None

    def __repr__(self) -> str:  # a password is in no message
        return f"Access({self.user!r})"


class RobotPresence(NamedTuple):
    """A robot that has said that it is there, or for which the broker says that it is not."""

    id: str
    name: str
    is_here: bool


_access_by_broker: dict[tuple[str, int], Access] = {}
_brokers: dict[tuple[str, int], Broker] = {}
_lock = Lock()


def port_of(host: str, port: int, group: str, robot_id: str) -> str:
    """Return the port of a robot."""
    return f"{MQTT}{host}:{port}/{group}/{robot_id}"


def sign_in(host: str, port: int, access: Access) -> None:
    """Set the credentials of this process."""
    _access_by_broker[host, port] = access


def resolve(port: str) -> str:
    return port


def open_port(port: str, baud: int, timeout_s: float) -> BrokerPort:
    """Return the port of a robot. Raises PortError, after CONNECT_S at the latest."""
    match = _PORT.fullmatch(port)
    if match is None or int(match[2]) >= 1 << 16:
        raise PortError(errors.NO_PORT, port)
    return connect(match[1], int(match[2])).port_of(match[3].lower(), match[4].lower())


def connect(host: str, port: int) -> Broker:
    """Return the connection of this process to a broker. Raises PortError."""
    with _lock:
        broker = _brokers.get((host, port))
        if broker is None or broker.end_reason:
            broker = Broker(host, port, _access_by_broker.get((host, port), Access()))
            _brokers[host, port] = broker
        return broker


def _tls_context(path: str | None) -> ssl.SSLContext:
    """Return the certificates that TLS trusts: those of a file, in PEM or DER, or those of this
    computer.

    A broker's own certificate is enough, whoever has signed it. Raises OSError.
    """
    data = None if path is None else Path(path).read_bytes()
    if data is None or b"-----BEGIN" in data:
        context = ssl.create_default_context(cafile=path)
    else:
        context = ssl.create_default_context(cadata=data)
    context.verify_flags |= ssl.VERIFY_X509_PARTIAL_CHAIN
    return context


class _Client(mqtt.Client):
    """Leaves out a message that is too large, and ends the connection if it is far too large: it is
    never kept in memory.

    `skipped_bytes` maps the topics of omitted messages to their sizes.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.size_error = ""
        self.skipped_bytes: dict[str, int] = {}

    def _sock_recv(self, bufsize: int) -> bytes:
        """Return received bytes, at most the rest of a packet or one byte of its head."""
        packet = self._in_packet
        if bufsize > MESSAGE_BYTES and packet["command"] & 0xF0 not in (_PUBLISH, _PINGRESP):
            bufsize = SKIPPED_BYTES + bufsize
        if bufsize > SKIPPED_BYTES:
            self.size_error = f"the broker sends a message of {packet['remaining_length']} bytes"
            raise ConnectionError(self.size_error)
        while bufsize > MESSAGE_BYTES:
            data = super()._sock_recv(MESSAGE_BYTES)
            if not data:
                return data
            if packet["command"] != _PINGRESP:
                self._skip(data, packet["remaining_length"])
                # The rest is not a message; paho ignores this one.
                packet["command"], packet["remaining_length"] = _PINGRESP, 0
            bufsize -= len(data)
            packet["to_process"] = bufsize
        return super()._sock_recv(bufsize)

    def _skip(self, head: bytes, size: int) -> None:
        topic = head[2 : 2 + int.from_bytes(head[:2], "big")].decode("utf-8", "replace")
        if len(self.skipped_bytes) < MAX_SKIPPED:
            self.skipped_bytes[topic[:TOPIC_CHARACTERS]] = size


class Broker:
    """A connection to a broker. `end_reason` says why it has ended."""

    def __init__(self, host: str, port: int, access: Access) -> None:
        """Connect. Raises PortError, at the latest after CONNECT_S for each of its addresses."""
        self.end_reason = ""
        self.peer = os.urandom(4).hex()
        # Time of the last heartbeat; None without a driver.
        self.driver_heard_s: float | None = None
        self._lock = RLock()
        self._bell = Bell()
        self._presences_by_group: dict[str, dict[str, RobotPresence]] = {}
        self._answered_s = 0.0  # when a message was sent or a request answered
        self._acknowledged_numbers: set[int] = set()
        self._port_by_group_and_id: dict[tuple[str, str], BrokerPort] = {}
        self._refusal: str | None = None  # reason of a refusal; empty if accepted
        self._client = _Client(
            CallbackAPIVersion.VERSION2, protocol=mqtt.MQTTv311, reconnect_on_failure=False
        )
        self._client.connect_timeout = CONNECT_S
        self._client.on_connect = self._on_connect
        self._client.on_subscribe = self._on_subscribe
        self._client.on_disconnect = self._on_disconnect
        self._client.on_message = self._on_message
        self._connect(host, port, access)

    def port_of(self, group: str, robot_id: str) -> BrokerPort:
        """Return the port of a robot, which may be there or not. Raises PortError."""
        port = BrokerPort(self, group, robot_id)
        with self._lock:
            if self.end_reason:
                raise PortError(errors.UNREACHABLE, self.end_reason)
            self._port_by_group_and_id[group, robot_id] = port
        self._client.subscribe(f"{ROOT}/{group}/{robot_id}/out/{self.peer}")
        return port

    def list_robots(self, group: str) -> list[RobotPresence]:
        """Return the robots of a class that the broker knows, in the order of their names.

        A broker does one request after the other. So the answer to a second request, which asks for
        nothing, comes after the retained messages; silence counts from then on. Raises PortError.
        """
        assert is_class_name(group)
        end_s = monotonic() + LIST_S
        with self._lock:
            self._presences_by_group[group] = {}
            topics = [f"{ROOT}/{group}/+", f"{ROOT}/{group}/+/out/{self.peer}"]
            subscription_numbers = {self._client.subscribe(topic)[1] or 0 for topic in topics}
        while monotonic() < end_s and not self.end_reason:
            if (
                subscription_numbers <= self._acknowledged_numbers
                and monotonic() > self._answered_s + QUIET_S
            ):
                break
            self._bell.wait(READ_S)
        with self._lock:
            presences = list(self._presences_by_group.pop(group).values())
            is_answered = subscription_numbers <= self._acknowledged_numbers
            self._acknowledged_numbers -= subscription_numbers
        if not is_answered:
            raise PortError(errors.UNREACHABLE, self.end_reason or "no answer of a broker")
        self._client.unsubscribe(topics)
        return sorted(presences, key=lambda presence: (presence.name.casefold(), presence.id))

    @property
    def skipped_topics(self) -> dict[str, int]:
        """Return the topics of messages that were too large, and their bytes."""
        return dict(self._client.skipped_bytes)

    def stop(self, group: str) -> bool:
        """Stop every robot of a class: one message for all. No reply confirms it.

        Return whether it was sent to the broker. Raises OSError.
        """
        delivery = self.publish(f"{ROOT}/{group}/stop", bytes(STOP_BYTES))
        with suppress(RuntimeError, ValueError):
            delivery.wait_for_publish(LEAVE_S)
            return delivery.is_published()
        return False

    def publish(self, topic: str, data: bytes) -> mqtt.MQTTMessageInfo:
        """Raises OSError."""
        if self.end_reason:
            raise OSError(self.end_reason)
        return self._client.publish(topic, data, qos=0, retain=False)

    def attend(self) -> None:
        """Note that the driver is present, which it must repeat every DRIVER_S."""
        self.driver_heard_s = monotonic()

    @property
    def has_driver(self) -> bool:
        return self.driver_heard_s is None or monotonic() - self.driver_heard_s < DRIVER_S

    def forget(self, port: BrokerPort) -> None:
        """Release the robot for another client."""
        with self._lock:
            if self._port_by_group_and_id.get((port.group, port.robot_id)) is port:
                del self._port_by_group_and_id[port.group, port.robot_id]
        with suppress(OSError, RuntimeError, ValueError):  # the broker is lost
            # Completes before the process ends.
            self.publish(port.topic, b"").wait_for_publish(LEAVE_S)

    def close(self) -> None:
        self._client.disconnect()
        self._client.loop_stop()

    # -- paho's thread ----------------------------------------------------------------------------

    def _connect(self, host: str, port: int, access: Access) -> None:
        if access.user:
            self._client.username_pw_set(access.user, access.password)
        try:
            if access.is_tls:
                self._client.tls_set_context(_tls_context(access.trusted_file))
            self._client.connect(host, port, KEEP_ALIVE_S)
        except ssl.SSLError as error:
            raise PortError(errors.UNTRUSTED, str(error.reason or error)) from None
        except (OSError, ValueError) as error:
            raise PortError(errors.UNREACHABLE, _error_text(error)) from None
        self._client.loop_start()
        end_s = monotonic() + CONNECT_S
        while self._refusal is None and not self.end_reason and monotonic() < end_s:
            self._bell.wait(READ_S)
        refusal = self._refusal
        if refusal == "":
            return
        self.close()
        if refusal is None:
            raise PortError(errors.UNREACHABLE, self.end_reason or "no answer of a broker")
        raise PortError(errors.REFUSED, refusal)

    def _on_connect(self, *rest: Any) -> None:
        code = rest[3]
        with self._lock:
            self._refusal = str(code) if code.is_failure else ""
            self._bell.ring()

    def _on_subscribe(self, _: Any, __: Any, number: int, *rest: Any) -> None:
        with self._lock:
            self._acknowledged_numbers.add(number)
            self._answered_s = monotonic()
            self._bell.ring()

    def _on_disconnect(self, *_: Any) -> None:
        with self._lock:
            self.end_reason = self.end_reason or self._client.size_error or "the broker has gone"
            self._bell.ring()
            for port in self._port_by_group_and_id.values():
                port.end(self.end_reason)

    def _on_message(self, _: Any, __: Any, message: mqtt.MQTTMessage) -> None:
        try:
            levels = message.topic.split("/")
        except UnicodeDecodeError:
            return
        with self._lock:
            if len(levels) == 3:
                self._take_presence(levels[1], levels[2], bytes(message.payload))
            elif len(levels) == 5 and not message.retain:
                port = self._port_by_group_and_id.get((levels[1], levels[2]))
                if port is not None:
                    port.take_message(bytes(message.payload))

    def _take_presence(self, group: str, robot_id: str, payload: bytes) -> None:
        presences = self._presences_by_group.get(group)
        is_robot = re.fullmatch(r"[0-9a-f]{8}", robot_id) is not None
        if presences is None or not is_robot or not 1 <= len(payload) <= 1 + NAME_BYTES:
            return
        if payload[:1] not in (b"+", b"-") or (
            len(presences) == MAX_ROBOTS and robot_id not in presences
        ):
            return
        name = payload[1:].decode("utf-8", "replace")
        presences[robot_id] = RobotPresence(robot_id, name, payload[:1] == b"+")
        self._answered_s = monotonic()
        self._bell.ring()


class BrokerPort(PushedTransport):
    """A robot at a broker. `read`, `write`, `in_waiting`, `cancel_read` and `close` are as in
    pyserial; where the connection has ended they raise OSError."""

    def __init__(self, broker: Broker, group: str, robot_id: str) -> None:
        super().__init__()
        self.group, self.robot_id = group, robot_id
        self.topic = f"{ROOT}/{group}/{robot_id}/in/{broker.peer}"
        self._broker = broker
        self._patient_until_s = monotonic() + PATIENCE_S

    def write(self, data: bytes) -> None:
        """Send bytes in pieces. If no driver attends to the run, the robot is stopped instead."""
        if self._end_reason:
            raise OSError(self._end_reason)
        if not self._broker.has_driver:
            data = bytes(STOP_BYTES)
        for k in range(0, len(data), PIECE_BYTES):
            self._broker.publish(self.topic, data[k : k + PIECE_BYTES])

    def close(self) -> None:
        self.end("closed")  # a frame after the goodbye would register again
        self._broker.forget(self)

    def take_message(self, data: bytes) -> None:
        """A message of the robot has come; an empty one says that another client has it."""
        if not data:
            if monotonic() > self._patient_until_s:
                self.end(errors.TAKEN)
            return
        self._patient_until_s = 0.0
        self.add_received(data)


def _error_text(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
