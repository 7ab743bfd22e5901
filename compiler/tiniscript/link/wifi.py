"""The exchanges about a robot's WiFi: what it is set to, another network, none.

Knows the order of messages. A name and a password go out sealed and covered: `seal` and `session`
see to that.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.link import requests
from tiniscript.link.messages import WIFI_MODES, WIFI_STATES, WIFI_STEPS, WIFI_TEXT_BYTES
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


def tell() -> Exchange[WifiReply]:
    return requests.single(_request("TELL"), WifiReply)


def forget() -> Exchange[WifiReply]:
    return requests.kept(_request("FORGET"), WifiReply)


def give(network: Network) -> Exchange[WifiReply]:
    """Give the robot a network, in the parts that find room in a frame, and have it kept."""
    steps = [_request("NETWORK", network.name)]
    for k in range(0, len(network.password), WIFI_TEXT_BYTES):
        steps.append(_request("PASSWORD", network.password[k : k + WIFI_TEXT_BYTES]))
    for each in steps:
        reply = yield from requests.single(each, WifiReply)
        if reply.status != OK:
            return reply
    last = "HOST" if network.is_access_point else "JOIN"
    return (yield from requests.kept(_request(last), WifiReply))


def address(reply: WifiReply) -> str:
    """Return the robot's address in the network, or nothing while it has none."""
    return ".".join(map(str, reply.address.to_bytes(4, "little"))) if reply.address else ""


def _request(step: str, text: bytes = b"") -> Request:
    return Request("WIFI", {"step": _STEPS.index(step), "text": text})
