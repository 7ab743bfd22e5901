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

READY_TIMEOUT_S = 20  # time for the robot to join the network, or to reach the broker
POLL_INTERVAL_S = 0.5
UNSTARTED_STATES = ("OFF", "RESTS")  # states of the robot's WiFi
_PEM = r"-----BEGIN CERTIFICATE-----.+?-----END CERTIFICATE-----"


def broker_settings(options: Namespace, language: str) -> BrokerSettings:
    """Return the broker settings of the options; the password is asked for. Raises CommandError."""
    is_tls = bool(options.tls)
    broker_address, class_name = (
        broker_options.broker_address(options, is_tls),
        broker_options.class_name(options),
    )
    ip_address = _resolve(broker_address)
    is_host_name = not re.fullmatch(r"[0-9.]+", broker_address.host)
    if is_host_name and len(broker_address.host) > BROKER_NAME_BYTES:
        raise CommandError(
            2, "broker_long_name", host=broker_address.host, bytes=str(BROKER_NAME_BYTES)
        )
    tls = _tls_settings(options, broker_address, is_host_name)
    user, password = broker_options.ask_user(options, language)
    name = broker_address.host.encode() if is_host_name else b""
    return BrokerSettings(
        ip_address.packed, broker_address.port, class_name, user, password, name, tls
    )


def _resolve(broker_address: broker_options.BrokerAddress) -> IPv4Address:
    """Return the broker's current address. Raises CommandError."""
    try:
        addresses = socket.getaddrinfo(
            broker_address.host, broker_address.port, socket.AF_INET, socket.SOCK_STREAM
        )
        return IPv4Address(addresses[0][4][0])
    except (OSError, UnicodeError, ValueError) as error:
        raise CommandError(2, "broker_unknown", host=broker_address.host, why=error) from None


def _tls_settings(
    options: Namespace, broker_address: broker_options.BrokerAddress, is_host_name: bool
) -> Tls | None:
    """Return whom the robot trusts, if it is to speak TLS. Raises CommandError."""
    data = broker_options.read_certificate(options)
    if not options.tls:
        return None
    if data is None:
        raise CommandError(2, "broker_no_trust")
    if not is_host_name:
        raise CommandError(2, "broker_tls_name", host=broker_address.host)
    certificate = _certificate(data)
    if certificate is None or len(certificate) > TRUST_BYTES:
        file = printable_name(options.trust)
        raise CommandError(2, "broker_bad_trust", file=file, bytes=str(TRUST_BYTES))
    return Tls(certificate, int(time.strftime("%Y%m%d")))


def _certificate(data: bytes) -> bytes | None:
    """Return the only certificate in a file, in DER, or None."""
    pem_blocks = re.findall(_PEM, data.decode("latin-1"), re.DOTALL)
    if len(pem_blocks) > 1:
        return None
    try:
        der_data = ssl.PEM_cert_to_DER_cert(pem_blocks[0]) if pem_blocks else data
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        context.load_verify_locations(cadata=der_data)
    except (ssl.SSLError, ValueError):
        return None
    return der_data if context.cert_store_stats()["x509"] == 1 else None


def use_broker(connection: Connection, broker: BrokerSettings | None, options: Namespace) -> None:
    """Configure the robot's broker, or none, and print whether the robot is there.

    Raises CommandError.
    """
    if is_at_broker(connection.port):
        raise CommandError(2, "broker_over_it", robot=connection.name)
    if broker is not None and IPv4Address(broker.address).is_loopback:
        _refuse_loopback(connection, IPv4Address(broker.address))
    connection.request_or_raise(
        lambda session: session.use_broker(broker), "broker_old", "BAD_VALUE"
    )
    if broker is None:
        connection.print_text("broker_off")
        return
    wifi_reply = await_state(
        partial(_broker_state, connection), lambda reply: _state(reply) != "SEARCHING"
    )
    tell_wifi_state(connection, wifi_reply, broker.name.decode(), _class_command(options))


def await_state(
    request_state: Callable[[], WifiReply], is_over: Callable[[WifiReply], bool]
) -> WifiReply:
    """Return the robot's state once it has settled, or after READY_S."""
    end_s = time.monotonic() + READY_TIMEOUT_S
    while not is_over(wifi_reply := request_state()) and time.monotonic() < end_s:
        time.sleep(POLL_INTERVAL_S)
    return wifi_reply


def tell_broker_if_any(connection: Connection) -> None:
    """Say where the robot's broker is, if it has one."""
    reply = connection.wait(connection.begin_request(lambda session: session.broker()))
    if reply.status == STATUSES["OK"] and reply.values.network:
        tell_wifi_state(connection, reply.values)


def tell_wifi_state(
    connection: Connection, wifi_reply: WifiReply, name: str = "", command: str = ""
) -> None:
    """Say where the robot's broker is: under its name, if that is known.

    `command` reaches all robots of the class: a robot reports neither port nor certificate.
    """
    state = _state(wifi_reply)
    key = f"broker_{state.lower()}" if wifi_reply.network else "broker_none"
    class_name = printable_name(wifi_reply.network.decode("utf-8", "replace"))
    sentence = connection.text(key, address=name or address(wifi_reply), group=class_name)
    if command and state == "READY":
        sentence += connection.text("broker_all", command=command)
    print(sentence)


def _class_command(options: Namespace) -> str:
    """Return `tsc class` at the broker of the options, as this computer reaches it."""
    broker_address = broker_options.broker_address(options, bool(options.tls))
    default_address = broker_options.broker_address(
        Namespace(broker=broker_address.host), bool(options.tls)
    )
    words = [
        "--broker",
        broker_address.host if broker_address == default_address else str(broker_address),
    ]
    words += ["--class", broker_options.class_name(options)]
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


def _refuse_loopback(connection: Connection, broker: IPv4Address) -> None:
    """Refuse a broker at 127.0.0.1: no robot but one that is on this computer is at it."""
    wifi_reply = connection.request(lambda session: session.wifi()).values
    robot_address = IPv4Address(wifi_reply.address.to_bytes(4, "little"))
    if not robot_address.is_loopback:
        raise CommandError(2, "broker_itself", host=str(broker), robot=connection.name)
