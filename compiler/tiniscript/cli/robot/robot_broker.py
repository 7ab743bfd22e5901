"""`tsc set wifi --broker`: the MQTT broker that a robot connects to."""

from __future__ import annotations

import re
import socket
import ssl
import time
from argparse import Namespace
from collections.abc import Callable
from functools import partial
from ipaddress import IPv4Address

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot import broker_options
from tiniscript.cli.robot.connect import Connection
from tiniscript.library.install_advice import quote
from tiniscript.link.messages import BROKER_NAME_BYTES, STATUSES, TRUST_BYTES
from tiniscript.link.payloads import WifiReply
from tiniscript.link.port_names import is_at_broker
from tiniscript.link.wifi import STATES, BrokerSettings, Tls, address

READY_LIMIT_S = 20  # until the robot is in the network, or at the broker
LOOK_INTERVAL_S = 0.5
UNSTARTED_STATES = ("OFF", "RESTS")  # states of the robot's WiFi
_PEM = r"-----BEGIN CERTIFICATE-----.+?-----END CERTIFICATE-----"


def settings(options: Namespace, language: str) -> BrokerSettings:
    """Return what the options say; the password is asked for. Raises CommandError."""
    is_tls = bool(options.tls)
    place, group = broker_options.place(options, is_tls), broker_options.group(options)
    address = _address(place)
    is_host_name = not re.fullmatch(r"[0-9.]+", place.host)
    if is_host_name and len(place.host) > BROKER_NAME_BYTES:
        raise CommandError(2, "broker_long_name", host=place.host, bytes=str(BROKER_NAME_BYTES))
    tls = _tls(options, place, is_host_name)
    user, password = broker_options.user(options, language)
    name = place.host.encode() if is_host_name else b""
    return BrokerSettings(address.packed, place.port, group, user, password, name, tls)


def _address(place: broker_options.Place) -> IPv4Address:
    """Return where the broker is now. Raises CommandError."""
    try:
        result = socket.getaddrinfo(place.host, place.port, socket.AF_INET, socket.SOCK_STREAM)
        return IPv4Address(result[0][4][0])
    except (OSError, UnicodeError, ValueError) as why:
        raise CommandError(2, "broker_unknown", host=place.host, why=why) from None


def _tls(options: Namespace, place: broker_options.Place, is_host_name: bool) -> Tls | None:
    """Return whom the robot trusts, if it is to speak TLS. Raises CommandError."""
    data = broker_options.trust(options)
    if not options.tls:
        return None
    if data is None:
        raise CommandError(2, "broker_no_trust")
    if not is_host_name:
        raise CommandError(2, "broker_tls_name", host=place.host)
    trust = _certificate(data)
    if trust is None or len(trust) > TRUST_BYTES:
        file = printable_name(options.trust)
        raise CommandError(2, "broker_bad_trust", file=file, bytes=str(TRUST_BYTES))
    return Tls(trust, int(time.strftime("%Y%m%d")))


def _certificate(data: bytes) -> bytes | None:
    """Return the one certificate that a file has, in DER, or None."""
    texts = re.findall(_PEM, data.decode("latin-1"), re.DOTALL)
    if len(texts) > 1:
        return None
    try:
        result = ssl.PEM_cert_to_DER_cert(texts[0]) if texts else data
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.load_verify_locations(cadata=result)
    except (ssl.SSLError, ValueError):
        return None
    return result if context.cert_store_stats()["x509"] == 1 else None


def use_broker(connection: Connection, broker: BrokerSettings | None, options: Namespace) -> None:
    """Give the robot the broker of the options, or none, and say whether it is there.

    Raises CommandError.
    """
    if is_at_broker(connection.port):
        raise CommandError(2, "broker_over_it", robot=connection.name)
    if broker is not None and IPv4Address(broker.address).is_loopback:
        _refuse_itself(connection, IPv4Address(broker.address))
    connection.ask_or(lambda session: session.use_broker(broker), "broker_old", "BAD_VALUE")
    if broker is None:
        connection.say("broker_off")
        return
    wifi_reply = await_state(
        partial(_broker_state, connection), lambda reply: _state(reply) != "SEARCHING"
    )
    tell_wifi_state(connection, wifi_reply, broker.name.decode(), _class_command(options))


def await_state(ask: Callable[[], WifiReply], is_over: Callable[[WifiReply], bool]) -> WifiReply:
    """Return what the robot tells when something has come of it, or after READY_S."""
    end_s = time.monotonic() + READY_LIMIT_S
    while not is_over(wifi_reply := ask()) and time.monotonic() < end_s:
        time.sleep(LOOK_INTERVAL_S)
    return wifi_reply


def tell_if_any(connection: Connection) -> None:
    """Say where the robot's broker is, if it has one."""
    reply = connection.wait(connection.begin_request(lambda session: session.broker()))
    if reply.status == STATUSES["OK"] and reply.values.network:
        tell_wifi_state(connection, reply.values)


def tell_wifi_state(
    connection: Connection, wifi_reply: WifiReply, name: str = "", command: str = ""
) -> None:
    """Say where the robot's broker is: under its name, where that is known.

    `command` reaches all robots of the class: a robot tells neither port nor certificate.
    """
    state = _state(wifi_reply)
    key = f"broker_{state.lower()}" if wifi_reply.network else "broker_none"
    group = printable_name(wifi_reply.network.decode("utf-8", "replace"))
    sentence = connection.text(key, address=name or address(wifi_reply), group=group)
    if command and state == "READY":
        sentence += connection.text("broker_all", command=command)
    print(sentence)


def _class_command(options: Namespace) -> str:
    """Return `tsc class` at the broker of the options, as this computer reaches it."""
    place = broker_options.place(options, bool(options.tls))
    default_place = broker_options.place(Namespace(broker=place.host), bool(options.tls))
    words = ["--broker", place.host if place == default_place else str(place)]
    words += ["--class", broker_options.group(options)]
    if options.user is not None:
        words += ["--user", options.user]
    if options.tls:
        words += ["--tls", "--trust", options.trust]
    return printable_name(" ".join(["tsc", "class", *(quote(str(word)) for word in words)]))


def _state(wifi_reply: WifiReply) -> str:
    """Return SEARCHING for a robot that has not begun, or whose WiFi rests, too."""
    state = STATES[wifi_reply.state] if wifi_reply.state < len(STATES) else "OFF"
    return "SEARCHING" if state in UNSTARTED_STATES else state


def _broker_state(connection: Connection) -> WifiReply:
    return connection.request(lambda session: session.broker()).values


def _refuse_itself(connection: Connection, broker: IPv4Address) -> None:
    """Refuse a broker at 127.0.0.1: no robot but one that is on this computer is at it."""
    wifi_reply = connection.request(lambda session: session.wifi()).values
    robot_address = IPv4Address(wifi_reply.address.to_bytes(4, "little"))
    if not robot_address.is_loopback:
        raise CommandError(2, "broker_itself", host=str(broker), robot=connection.name)
