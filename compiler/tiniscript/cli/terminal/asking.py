"""Asking the person at the terminal: for a yes, or for a password.

A password is in no argument, so no list of processes and no history has it.
"""

from __future__ import annotations

import sys
from getpass import getpass

from tiniscript.cli.errors import CommandError

YES_ANSWERS = ("1", "y", "yes", "s", "si", "sí")


def can_ask() -> bool:
    """Return whether a person can read and answer questions."""
    return sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()


def ask(question: str) -> str:
    """Ask, and return the typed line; an empty text without an answer."""
    print(question, end="", file=sys.stderr, flush=True)
    return sys.stdin.readline()


def confirm(question: str) -> bool:
    """Ask, and return whether the answer is a yes: an empty one is not."""
    return ask(question).strip().lower() in YES_ANSWERS


LONGEST_LINE = 1024  # bytes of standard input that may be a password


def ask_password(prompt: str, least_bytes: int, most_bytes: int, error_key: str) -> bytes:
    """Ask without an echo, or take the first line of standard input, if it is not a terminal.

    Raises CommandError `error_key` if its length is wrong, or it contains characters that cannot be
    typed.
    """
    if sys.stdin is not None and sys.stdin.isatty():
        try:
            data = getpass(prompt).encode("utf-8", "surrogateescape")
        except EOFError:
            data = b""
    else:
        data = b"" if sys.stdin is None else sys.stdin.buffer.readline(LONGEST_LINE)
        data = data.rstrip(b"\r\n")
    is_typeable = all(byte >= ord(" ") and byte != 0x7F for byte in data)
    if not least_bytes <= len(data) <= most_bytes or not is_typeable:
        raise CommandError(2, error_key)
    return data
