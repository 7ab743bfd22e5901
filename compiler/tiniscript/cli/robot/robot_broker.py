"""`tsc wifi --broker`: the MQTT broker that a robot connects to."""

from __future__ import annotations

import socket
import time
from argparse import Namespace
from ipaddress import IPv4Address
from typing import TYPE_CHECKING

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.robot import broker_options
from tiniscript.cli.texts.common import text
from tiniscript.link.messages import STATUSES
from tiniscript.link.port_names import is_at_broker

if TYPE_CHECKING:
    from tiniscript.cli.robot.connect import Connection
    from tiniscript.link.payloads import WifiReply
    from tiniscript.link.requests import Reply
    from tiniscript.link.wifi import BrokerSettings

READY_S = 12  # until the robot is at the broker
LOOK_S = 0.5


def settings(options: Namespace, language: str) -> BrokerSettings:
    """Return what the options say; the password is asked for. Raises CommandError."""
    from tiniscript.link.wifi import BrokerSettings

    place, group = broker_options.place(options), broker_options.group(options)
    try:
        found = socket.getaddrinfo(place.host, place.port, socket.AF_INET, socket.SOCK_STREAM)
        address = IPv4Address(found[0][4][0])
    except (OSError, UnicodeError, ValueError) as why:
        reason = (why.strerror if isinstance(why, OSError) else None) or str(why)
        raise CommandError(2, "broker_unknown", host=place.host, why=shown(reason)) from None
    user, password = broker_options.user(options, language)
    return BrokerSettings(address.packed, place.port, group, user, password)


def use(connection: Connection, broker: BrokerSettings | None) -> None:
    """Give the robot a broker, or none, and say whether it is there. Raises CommandError."""
    if is_at_broker(connection.port):
        raise CommandError(2, "broker_over_it", robot=connection.name)
    if broker is not None and IPv4Address(broker.address).is_loopback:
        _refuse_itself(connection, IPv4Address(broker.address))
    reply = connection.give(lambda session: session.use_broker(broker))
    _refuse_old(connection, reply)
    if reply.status:
        raise connection.failure(reply)
    if broker is None:
        print(text("broker_off", connection.language).format(robot=connection.name))
        return
    end_s = time.monotonic() + READY_S
    told = _told(connection)
    while _state(told) == "SEARCHING" and time.monotonic() < end_s:
        time.sleep(LOOK_S)
        told = _told(connection)
    tell(connection, told)


def tell_if_any(connection: Connection) -> None:
    """Say where the robot's broker is, if it has one."""
    reply = connection.wait(connection.do(lambda session: session.broker()))
    if reply.status == STATUSES["OK"] and reply.values.network:
        tell(connection, reply.values)


def tell(connection: Connection, told: WifiReply) -> None:
    from tiniscript.link.wifi import address

    key = f"broker_{_state(told).lower()}" if told.network else "broker_none"
    group = shown(told.network.decode("utf-8", "replace"))
    said = text(key, connection.language)
    print(said.format(robot=connection.name, address=address(told), group=group))


def _state(told: WifiReply) -> str:
    """Return SEARCHING for a robot that has not begun, too."""
    from tiniscript.link.wifi import STATES

    state = STATES[told.state] if told.state < len(STATES) else "OFF"
    return "SEARCHING" if state == "OFF" else state


def _told(connection: Connection) -> WifiReply:
    reply = connection.wait(connection.do(lambda session: session.broker()))
    if reply.status:
        raise connection.failure(reply)
    return reply.values


def _refuse_old(connection: Connection, reply: Reply[WifiReply]) -> None:
    if reply.status == STATUSES["BAD_VALUE"]:
        raise CommandError(3, "broker_old", robot=connection.name)


def _refuse_itself(connection: Connection, broker: IPv4Address) -> None:
    """Refuse a broker at 127.0.0.1: no robot but one that is on this computer is at it."""
    told = connection.ask(lambda session: session.wifi()).values
    its = IPv4Address(told.address.to_bytes(4, "little"))
    if not its.is_loopback:
        raise CommandError(2, "broker_itself", host=str(broker), robot=connection.name)
