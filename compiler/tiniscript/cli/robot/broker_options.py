"""The MQTT broker of a command's options: its address, the class, and the user."""

from __future__ import annotations

import re
from argparse import Namespace
from pathlib import Path
from typing import NamedTuple

from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.terminal import asking
from tiniscript.cli.texts import text
from tiniscript.link.messages import NETWORK_BYTES, PASSWORD_BYTES
from tiniscript.link.wifi import is_class_name

PLAIN_PORT, TLS_PORT = 1883, 8883
DEFAULT_CLASS = "class"  # the class of all robots without one


class BrokerAddress(NamedTuple):
    host: str
    port: int

    def __str__(self) -> str:
        return f"{self.host}:{self.port}"


def broker_address(options: Namespace, is_tls: bool = False) -> BrokerAddress:
    """Return the address of the broker. Raises CommandError."""
    match = re.fullmatch(r"([A-Za-z0-9][A-Za-z0-9._-]{0,252})(?::([0-9]{1,5}))?", options.broker)
    port = int(match[2] or (TLS_PORT if is_tls else PLAIN_PORT)) if match else 0
    if match is None or not 0 < port < 1 << 16:
        raise CommandError(2, "broker_bad_host", found=printable_name(options.broker) or "''")
    return BrokerAddress(match[1].lower(), port)


def class_name(options: Namespace) -> str:
    """Return the name of the class. Raises CommandError."""
    name = DEFAULT_CLASS if options.group is None else str(options.group)
    if not is_class_name(name):
        raise CommandError(2, "class_bad_name", found=printable_name(name) or "''")
    return name


def ask_user(options: Namespace, language: str) -> tuple[bytes, bytes]:
    """Return a name and its password, or two empty ones. Raises CommandError."""
    if options.user is None:
        return b"", b""
    name = options.user.encode("utf-8", "surrogateescape")
    if not 1 <= len(name) <= NETWORK_BYTES or not options.user.isprintable():
        raise CommandError(2, "broker_bad_user")
    prompt = text("broker_password", language).format(user=printable_name(options.user))
    return name, asking.ask_password(prompt, 1, PASSWORD_BYTES, "broker_bad_password")


def read_certificate(options: Namespace) -> bytes | None:
    """Return the content of the certificate file; None without this option.

    Raises CommandError.
    """
    if options.trust is None:
        return None
    if not options.tls:
        raise CommandError(2, "broker_trust_alone")
    try:
        return Path(options.trust).read_bytes()
    except (OSError, ValueError) as error:
        raise CommandError(
            2, "broker_unread", file=printable_name(options.trust), why=error
        ) from None
