"""A terminal as a remote control: the arrow keys, a and b, until q or Ctrl-C.

A terminal does not report the release of a key. It repeats one that is held, the first time after
250 ms or more: so a first press holds it longer than a repeat. Knows the clock.
"""

from __future__ import annotations

import re
import sys
from time import monotonic

from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.terminal.keys import Keys
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import STATUSES
from tiniscript.link.outcomes import CANCELLED, LOST
from tiniscript.link.payloads import EmptyReply
from tiniscript.link.remote import NOTHING_PRESSED, RemoteState, has_remote, remote_state_of
from tiniscript.link.requests import OK, Reply

# How long a press holds a key, at first and when it repeats.
FIRST_HOLD_S, REPEAT_HOLD_S = 0.7, 0.15
# Interval at which held keys are sent; after half a second of silence the robot releases them.
SEND_INTERVAL_S = 0.1
POLL_S = 0.02  # between two looks at the keys
_QUIT_KEYS = ("q", "Q", "\x04")
_ARROWS = {"A": "UP", "B": "DOWN", "C": "RIGHT", "D": "LEFT"}
_WINDOWS_ARROWS = {"H": "UP", "P": "DOWN", "M": "RIGHT", "K": "LEFT"}
_LETTERS = ("A", "B")
_KEY_START = r"\x1b(?:[\[O][0-9;]*)?"  # a key of several characters may arrive in two pieces
_WHOLE_KEY = re.compile(r"\x1b[\[O][0-9;]*([A-Za-z~])|[\0\xe0](.)|(.)", re.DOTALL)
_UNFINISHED_KEY = re.compile(_KEY_START + (r"\Z|[\0\xe0]\Z" if sys.platform == "win32" else r"\Z"))


class HeldKeys:
    """Which keys are held, as far as a terminal reports it."""

    def __init__(self) -> None:
        self._release_s_by_key: dict[str, float] = {}
        self._unfinished_key = ""

    def press_typed(self, typed_keys: str, now_s: float) -> bool:
        """Process typed characters; return whether the person wants to leave."""
        text, offset = self._unfinished_key + typed_keys, 0
        self._unfinished_key = ""
        while offset < len(text):
            if _UNFINISHED_KEY.match(text, offset):
                self._unfinished_key = text[offset:]
                return False
            match = _WHOLE_KEY.match(text, offset)
            assert match
            offset = match.end()
            arrow, windows, letter = match.groups()
            if letter in _QUIT_KEYS:
                return True
            name = _ARROWS.get(arrow) or _WINDOWS_ARROWS.get(windows)
            if letter is not None and letter.upper() in _LETTERS:
                name = letter.upper()
            if name:
                self._hold_key(name, now_s)
        return False

    def _hold_key(self, name: str, now_s: float) -> None:
        is_repeat = now_s < self._release_s_by_key.get(name, now_s)
        self._release_s_by_key[name] = now_s + (REPEAT_HOLD_S if is_repeat else FIRST_HOLD_S)

    def keys_at(self, now_s: float) -> RemoteState:
        return remote_state_of(
            name for name, release_s in self._release_s_by_key.items() if now_s < release_s
        )


class TerminalRemote:
    """Sends the held keys to the robot, while somebody watches. Raises KeyboardInterrupt for q."""

    def __init__(self, connection: Connection) -> None:
        self.has_quit = False
        self._connection = connection
        self._keys = Keys()
        self._held_keys = HeldKeys()
        self._sent_keys, self._sent_s = NOTHING_PRESSED, 0.0
        self._request: PendingRequest[EmptyReply] | None = None

    def __enter__(self) -> TerminalRemote:
        if not has_remote(self._connection.device_info):
            raise self._connection.error_for_reply(Reply(STATUSES["NO_REMOTE"]))
        self._keys.__enter__()
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        self._keys.__exit__(*signal_arguments)

    def poll(self) -> None:
        """Pass on held keys. Raises CommandError if the robot accepts no keys from here."""
        now_s = monotonic()
        if self._held_keys.press_typed(self._keys.read_keys(), now_s):
            self.has_quit = True
            raise KeyboardInterrupt
        self._check_reply()
        pressed_keys = self._held_keys.keys_at(now_s)
        if pressed_keys == self._sent_keys and (
            pressed_keys == NOTHING_PRESSED or now_s - self._sent_s < SEND_INTERVAL_S
        ):
            return
        self._sent_keys, self._sent_s = pressed_keys, now_s
        self._request = self._connection.begin_request(lambda session: session.press(*pressed_keys))

    def _check_reply(self) -> None:
        outcome = None if self._request is None else self._request.outcome
        if outcome is not None and outcome.status not in (OK, CANCELLED, LOST):
            raise self._connection.error_for_reply(outcome)
