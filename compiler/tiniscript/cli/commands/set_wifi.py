"""`tsc set wifi`: which network the robot joins, or is, and which MQTT broker it uses.

A password is asked for, and kept nowhere.
"""

from __future__ import annotations

from argparse import Namespace
from functools import partial

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot import robot_broker
from tiniscript.cli.robot.connect import Connection, connect
from tiniscript.cli.terminal import asking
from tiniscript.cli.texts import text
from tiniscript.link.messages import (
    MIN_PASSWORD,
    NETWORK_BYTES,
    OWNED,
    PASSWORD_BYTES,
    SEALS,
)
from tiniscript.link.payloads import WifiReply
from tiniscript.link.wifi import MODES, STATES, Network, address

# states that are final on their own
FINAL_STATES = tuple(map(STATES.index, ("READY", "REFUSED", "RESTS")))


def run(options: Namespace, language: str) -> int:
    if options.forget and (options.network is not None or options.access_point):
        raise CommandError(2, "wifi_one_way")
    if options.access_point and options.network is None:
        raise CommandError(2, "wifi_no_network")
    is_about_broker = options.broker is not None or options.no_broker
    is_about_network = options.network is not None or options.forget
    if is_about_broker and (is_about_network or (options.broker is not None and options.no_broker)):
        raise CommandError(2, "wifi_one_way")
    broker_options = (options.user, options.group, options.trust, options.tls or None)
    if options.broker is None and any(option is not None for option in broker_options):
        raise CommandError(2, "broker_no_user")
    broker = robot_broker.broker_settings(options, language) if options.broker is not None else None
    name = None if options.network is None else _name_bytes(options.network)
    with connect(options, language) as connection:
        info = connection.meet()
        features = info.values.features
        if not features & SEALS:
            raise CommandError(3, "wifi_none", robot=connection.name)
        if not features & OWNED:
            raise CommandError(3, "wifi_unowned", robot=connection.name)
        if is_about_broker:
            robot_broker.use_broker(connection, broker, options)
            return 0
        if options.forget or name is not None:
            _refuse_over_wifi(connection)
        if options.forget:
            connection.request(lambda session: session.forget_wifi())
            connection.print_text("wifi_forgotten")
        elif name is not None:
            _join(connection, name, options.access_point)
        else:
            _print_wifi_state(connection, _wifi_state(connection))
            robot_broker.tell_broker_if_any(connection)
    return 0


def _refuse_over_wifi(connection: Connection) -> None:
    """Refuse to change the network over the network: the result could not be reported.

    A robot that would refuse anyway does so here, before anybody is asked for a password.
    """
    _wifi_state(connection)
    if connection.port.startswith(("tcp://", "socket://")):
        raise CommandError(2, "wifi_itself", robot=connection.name)


def _join(connection: Connection, name: bytes, is_access_point: bool) -> None:
    prompt = text("wifi_password", connection.language)
    password = asking.ask_password(prompt, MIN_PASSWORD, PASSWORD_BYTES, "wifi_bad_password")
    network = Network(name, password, is_access_point)
    connection.request(lambda session: session.join(network))
    ask = partial(_wifi_state, connection)
    _print_wifi_state(
        connection,
        robot_broker.await_state(ask, lambda wifi_reply: wifi_reply.state in FINAL_STATES),
    )


def _wifi_state(connection: Connection) -> WifiReply:
    return connection.request_or_raise(
        lambda session: session.wifi(), "wifi_none", "UNKNOWN_MESSAGE"
    ).values


def _print_wifi_state(connection: Connection, wifi_reply: WifiReply) -> None:
    mode, state = (
        row[number] if number < len(row) else "OFF"
        for row, number in ((MODES, wifi_reply.mode), (STATES, wifi_reply.state))
    )
    key = "wifi_off" if mode == "OFF" else f"wifi_{mode}_{state}".lower()
    if mode != "OFF" and state == "OFF":
        key = "wifi_station_searching"
    network = printable_name(wifi_reply.network.decode("utf-8", "replace"))
    host = f"tini-{connection.device_info.id & 0xFFFF:04x}"
    connection.print_text(key, network=network, address=address(wifi_reply), host=host)


def _name_bytes(name: str) -> bytes:
    """Return the name of a network as bytes. Raises CommandError if there is no such name."""
    data = name.encode("utf-8", "surrogateescape")
    if not 1 <= len(data) <= NETWORK_BYTES or not name.isprintable():
        raise CommandError(2, "wifi_bad_network", bytes=str(len(data)))
    return data
