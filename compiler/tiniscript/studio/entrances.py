"""Authenticates the user of `tsc studio`: the token of the run, and single-use codes for it.

An address on a command line, such as a browser's, is read by every user of the computer. So no
address contains the token. It has a code, for which a page gets the token the first time. Knows no
HTTP.
"""

from __future__ import annotations

import hmac
import secrets
import socket
from collections.abc import Callable
from threading import Lock
from time import monotonic
from typing import NamedTuple

from tiniscript.link.sharing import peers

TOKEN_BYTES = 16
OPEN_TIMEOUT_S = 120.0  # time for this computer's browser to open


class _Code(NamedTuple):
    is_for_this_computer: bool
    until_s: float


class Entrances:
    """Any thread may call it."""

    def __init__(self, clock: Callable[[], float] = monotonic) -> None:
        self.token = new_token()
        self._clock = clock
        self._lock = Lock()
        self._codes: dict[str, _Code] = {}
        self._used_codes: set[str] = set()

    def new_code(self, is_for_this_computer: bool = False) -> str:
        """Return a new code. `is_for_this_computer`: its browser gets it, and is quick."""
        code = new_token()
        until_s = self._clock() + OPEN_TIMEOUT_S if is_for_this_computer else float("inf")
        with self._lock:
            self._codes[code] = _Code(is_for_this_computer, until_s)
        return code

    def is_unused(self, code: str) -> bool:
        with self._lock:
            return code in self._codes

    def token_for(self, code: str, peer: socket.socket) -> str:
        """Return the token, or nothing if this code gives none.

        If no system tells whose a connection is, another user may have been first: a code that
        comes again ends what it has given.
        """
        if not may_be_owner(peer):
            return ""
        with self._lock:
            if code in self._used_codes and not peers.tells_users():
                self.token = new_token()
            entry = self._codes.get(code)
            if entry is None or (
                entry.is_for_this_computer and not peers.is_on_this_computer(peer)
            ):
                return ""
            del self._codes[code]
            self._used_codes.add(code)
            return self.token if self._clock() <= entry.until_s else ""

    def is_owner(self, token: str, peer: socket.socket) -> bool:
        """Return whether the token is that of this run, shown by this user or another computer."""
        is_token = hmac.compare_digest(token.encode("utf-8", "replace"), self.token.encode())
        return is_token and may_be_owner(peer)


def may_be_owner(peer: socket.socket) -> bool:
    """Return whether a connection belongs to this user, or to another computer."""
    return peers.is_of_this_user(peer) or not peers.is_on_this_computer(peer)


def new_token() -> str:
    return secrets.token_hex(TOKEN_BYTES)
