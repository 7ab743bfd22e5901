"""Talks with a module over a wire, and finds out at which speed it listens and which one it is.

Nothing here changes a module: it sends only AT and queries. Interrupted set-ups are found this way,
too.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.link.modules.dialects import (
    ANSWER_MS,
    BAUDS,
    BT05,
    CC41,
    CRLF,
    HC05,
    HC05_3,
    HC06,
    HC06_3,
    HM10,
    SLOW_ANSWER_MS,
    WAKE_BYTES,
    Dialect,
    is_error,
    is_ok,
)
from tiniscript.link.wire import Wire

MAX_VERSION_CHARACTERS = 60  # characters of a version
TRIES = 2  # the first command after power-on may meet half a command of before


class Module(NamedTuple):
    """A module that answers: its commands, the speed at which it listens now, and its version."""

    dialect: Dialect
    baud: int
    version: str


def ask(wire: Wire, command: str, line_end: bytes, wait_ms: int) -> str:
    """Send a command and return the answer, or an empty text if none comes.

    Some clones say a command again before they answer it: that is no part of the answer.
    """
    wire.send(command.encode("ascii") + line_end)
    text = wire.receive(wait_ms).decode("ascii", "replace").strip()
    return text.removeprefix(command).lstrip()


def find_module(
    wire: Wire,
    bauds: Sequence[int] = BAUDS,
    on_baud: Callable[[int], None] = lambda baud: None,
    wakes_module: bool = True,
) -> Module | None:
    """Return the module on a wire, or None if there is no answer. `on_baud` is called for each
    speed.

    `wakes_module`: if none answers, send a text of 100 bytes, which wakes a sleeping HM-10.
    """
    wire.receive(SLOW_ANSWER_MS, SLOW_ANSWER_MS)  # discards the answers to earlier bytes
    for is_awake in (False, True) if wakes_module else (False,):
        for baud in bauds:
            on_baud(baud)
            wire.set_baud(baud)
            if is_awake:
                wire.send(b"w" * WAKE_BYTES)
                wire.receive(ANSWER_MS)
            line_end = _find_line_ending(wire)
            if line_end is not None:
                dialect, version = _identify_dialect(wire, line_end)
                return Module(dialect, baud, version[:MAX_VERSION_CHARACTERS])
    return None


def is_there(wire: Wire, dialect: Dialect) -> bool:
    """Return whether a module of this kind answers at the wire's speed."""
    return any(is_ok(ask(wire, "AT", dialect.line_end, dialect.wait_ms)) for _ in range(TRIES))


def _find_line_ending(wire: Wire) -> bytes | None:
    """Return the line ending of the module on the wire, or None if there is no answer.

    A module that waits for a silence must not hear more before that; one that waits for the end of
    a line has `AT` already when it comes.
    """
    if _is_accepted(ask(wire, "AT", b"", SLOW_ANSWER_MS)):
        return b""
    text = ask(wire, "", CRLF, SLOW_ANSWER_MS)
    if is_error(text):  # the module still had half of an earlier command
        text = ask(wire, "AT", CRLF, ANSWER_MS)
    return CRLF if _is_accepted(text) else None


def _is_accepted(answer: str) -> bool:
    return "OK" in answer.split()


def _identify_dialect(wire: Wire, line_end: bytes) -> tuple[Dialect, str]:
    """Return the kind of module, and its answer."""
    if not line_end:
        text = ask(wire, "AT+VERSION", line_end, SLOW_ANSWER_MS)
        if text.startswith("OK") and not text.startswith("OK+") and text != "OK":
            return HC06, text.removeprefix("OK")
        release = ask(wire, "AT+VERR?", line_end, SLOW_ANSWER_MS)
        if "HM" in release.upper() or text.startswith("OK+") or "HM" in text.upper():
            return HM10, release or text
        return HC06, text
    text = ask(wire, "AT+VERSION", line_end, ANSWER_MS)
    if "BT05" in text.upper():
        return BT05, _version_line(text)
    if text.startswith("+VERSION="):
        return CC41, _version_line(text)
    role = ask(wire, "AT+ROLE?", line_end, ANSWER_MS)
    if role.startswith("+ROLE"):
        text = ask(wire, "AT+VERSION?", line_end, ANSWER_MS)
        return (HC05_3 if ":3." in text else HC05), _version_line(text)
    return (HC06_3, _version_line(text)) if not is_error(text) else (HC05, "")


def _version_line(answer: str) -> str:
    """Return the version in an answer: its first line, without the label."""
    first_line = answer.splitlines()[0] if answer else ""
    return first_line.removeprefix("+").removeprefix("VERSION").lstrip(":=")
