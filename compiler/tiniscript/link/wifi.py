"""The exchanges about a robot's WiFi and its MQTT broker: read, change or remove the settings.

Knows the order of messages. A name and a password go out sealed and covered: `seal` and `session`
see to that.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.link import requests
from tiniscript.link.messages import (
    BROKER_NAME_BYTES,
    CLASS_BYTES,
    NETWORK_BYTES,
    PASSWORD_BYTES,
    TRUST_BYTES,
    WIFI_MODES,
    WIFI_STATES,
    WIFI_STEPS,
    WIFI_TEXT_BYTES,
)
from tiniscript.link.payloads import WifiReply
from tiniscript.link.requests import OK, Exchange, Request

MODES = tuple(name for name, _ in WIFI_MODES)
STATES = tuple(name for name, _ in WIFI_STATES)
_STEPS = tuple(name for name, _ in WIFI_STEPS)


class Network(NamedTuple):
    """A network to join or, as `is_access_point`, to be: 1 to 32 bytes, and 8 to 63."""

    name: bytes
    password: bytes
    is_access_point: bool = False

    def __repr__(self) -> str:  # a password is in no message
        return f"Network({self.name!r})"


class Tls(NamedTuple):
    """The TLS settings of a robot: a trusted certificate in DER, and today's date."""

    trust: bytes
    date: int  # the date in the form 20261121


class BrokerSettings(NamedTuple):
    """The broker of a robot: an IPv4 address and a port, its class, and the credentials.

    The robot looks up `name`, if there is one, and uses the four bytes if the lookup fails.
    """

    address: bytes
    port: int
    group: str
    user: bytes = b""
    password: bytes = b""
    name: bytes = b""
    tls: Tls | None = None

    @property
    def is_sound(self) -> bool:
        return (
            len(self.address) == 4
            and 0 < self.port < 1 << 16
            and is_class_name(self.group)
            and len(self.user) <= NETWORK_BYTES
            and len(self.password) <= PASSWORD_BYTES
            and len(self.name) <= BROKER_NAME_BYTES
            and b"\0" not in self.user + self.password + self.name
            and (self.tls is None or self._is_sound_tls(self.tls))
        )

    def _is_sound_tls(self, tls: Tls) -> bool:
        return bool(self.name) and 0 < len(tls.trust) <= TRUST_BYTES and 0 < tls.date < 1 << 32

    def __repr__(self) -> str:  # a password is in no message
        return f"BrokerSettings({self.group!r})"


def is_class_name(name: str) -> bool:
    """Return whether a class may be called so: its name is a part of topics."""
    return re.fullmatch(rf"[a-z0-9-]{{1,{CLASS_BYTES}}}", name) is not None


def query(step: str) -> Exchange[WifiReply]:
    """TELL: ask for the WiFi settings; TELL_BROKER: for those of the broker."""
    return requests.send_single(_request(step), WifiReply)


def forget_network() -> Exchange[WifiReply]:
    return requests.save_and_confirm(_request("FORGET"), WifiReply)


def join(network: Network) -> Exchange[WifiReply]:
    """Send the robot a network in parts that fit in a frame, and save it."""
    steps = [_request("NETWORK", network.name), *_parts("PASSWORD", network.password)]
    return _run_steps(steps, "HOST" if network.is_access_point else "JOIN")


def use_broker(broker: BrokerSettings | None) -> Exchange[WifiReply]:
    """Send the robot a broker, or none, and save it."""
    steps = [_request("BROKER")]
    if broker is not None:
        endpoint = broker.address + broker.port.to_bytes(2, "little") + broker.group.encode()
        steps = [_request("BROKER", endpoint), _request("BROKER_USER", broker.user)]
        steps += _parts("BROKER_PASSWORD", broker.password) + _parts("BROKER_NAME", broker.name)
        if broker.tls is not None:
            steps.append(_request("BROKER_TLS", broker.tls.date.to_bytes(4, "little")))
            steps += _parts("BROKER_TRUST", broker.tls.trust)
    return _run_steps(steps, "USE_BROKER")


def address(reply: WifiReply) -> str:
    """Return the robot's address in the network, or an empty text while it has none."""
    return ".".join(map(str, reply.address.to_bytes(4, "little"))) if reply.address else ""


def _request(step: str, text: bytes = b"") -> Request:
    return Request("WIFI", {"step": _STEPS.index(step), "text": text})


def _parts(step: str, text: bytes) -> list[Request]:
    """Return the requests that send a text in parts that fit in a frame."""
    offsets = range(0, len(text), WIFI_TEXT_BYTES)
    return [_request(step, text[offset : offset + WIFI_TEXT_BYTES]) for offset in offsets]


def _run_steps(steps: list[Request], last_step: str) -> Exchange[WifiReply]:
    """Take the steps up to the first that is refused, then the one that has them kept."""
    for step in steps:
        reply = yield from requests.send_single(step, WifiReply)
        if reply.status != OK:
            return reply
    return (yield from requests.save_and_confirm(_request(last_step), WifiReply))
