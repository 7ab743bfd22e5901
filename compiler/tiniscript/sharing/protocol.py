"""What a holder and its guests say to each other: lines of JSON of a limited length.

    guest                                        holder
    {"tsc": "0.1.0", "token": "..", "verb": ".."}
                                                 {"tsc": "0.1.0", "answer": ".."}
    {"do": "upload", "id": 1, "limit_ms": 6000, "image": "..", ..}
                                                 {"id": 1, "done_bytes": 54}
                                                 {"id": 1, "status": 0, "detail": 0, "values": {..},
                                                  "heard": 99, "is_echoed": false}
                                                 {"event": "SHOW", "ms": 1234, "values": {..}}
    {"do": "stop"}
    {"do": "beat"}                               {"beat": true}
                                                 {"over": "ended", "why": ""}

Whoever does not begin with the right token is not answered, and nothing that it says is read as
JSON: a greeting has one form, to the byte. The greeting and `stop` stay as they are in every
version, so that each tsc can stop what another one holds. Bytes are written in hex.
Knows no socket.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.link.outcomes import Event

HOST = "127.0.0.1"
LINE_BYTES = 100_000  # the longest program has 32,781 bytes
GREETING_BYTES = 1000
LOOKER = "ports"  # the verb of a guest that only looks who is there
BEAT_S = 0.2  # between two beats of a guest that waits for something
TETHER_S = 1.0  # a run ends when the guest that has started it is silent for so long

Note = dict[str, object]

_GREETING = re.compile(
    rb'{"tsc":"[0-9A-Za-z.+-]{1,40}","token":"([0-9a-f]{32})","verb":"([A-Za-z]{1,20})"}\n'
)


class BadNote(Exception):
    """What came is no note, or not the one that was expected."""


class Greeting(NamedTuple):
    token: bytes
    verb: str
    rest: bytes  # what follows it


def greeting(data: bytes) -> Greeting | None:
    """Return the greeting that data begins with, or None while it may still become one.

    Raises BadNote.
    """
    found = _GREETING.match(data)
    if found is not None:
        return Greeting(found[1], found[2].decode("ascii"), data[found.end() :])
    if data[:1] != b"{" or b"\n" in data or len(data) > GREETING_BYTES:
        raise BadNote
    return None


class Notes:
    """Bytes to notes. `limit_bytes` is that of the longest line."""

    def __init__(self, limit_bytes: int) -> None:
        self.limit_bytes = limit_bytes
        self._rest = b""

    def put(self, data: bytes) -> list[Note]:
        """Return the notes that are complete. Raises BadNote."""
        *lines, self._rest = (self._rest + data).split(b"\n")
        if any(len(line) > self.limit_bytes for line in (*lines, self._rest)):
            raise BadNote
        return [_note(line) for line in lines]


def written(note: Mapping[str, object]) -> bytes:
    return json.dumps(note, separators=(",", ":")).encode() + b"\n"


def _note(line: bytes) -> Note:
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        raise BadNote from None
    if not isinstance(found, dict):
        raise BadNote
    return found


def word(note: Note, name: str) -> str:
    """Return a field that is text. Raises BadNote where it is none."""
    found = note.get(name)
    if not isinstance(found, str):
        raise BadNote
    return found


def number(note: Note, name: str) -> int:
    """Return a field that is a whole number. Raises BadNote where it is none."""
    found = note.get(name)
    if type(found) is not int:
        raise BadNote
    return found


def answer(note: Note, name: str) -> bool:
    """Return a field that is true or false. Raises BadNote where it is neither."""
    found = note.get(name)
    if type(found) is not bool:
        raise BadNote
    return found


def data(note: Note, name: str) -> bytes:
    """Return a field that is bytes. Raises BadNote where it is none."""
    try:
        return bytes.fromhex(word(note, name))
    except ValueError:
        raise BadNote from None


def plain(values: Mapping[str, int | bytes]) -> Note:
    """Return the values of a reply or an event as JSON has them."""
    return {name: each.hex() if isinstance(each, bytes) else each for name, each in values.items()}


def values(note: Note, name: str = "values") -> dict[str, int | bytes]:
    """Return the values in a note. Raises BadNote."""
    found = note.get(name)
    if not isinstance(found, dict):
        raise BadNote
    return {
        key: number(found, key) if type(each) is int else data(found, key)
        for key, each in found.items()
    }


def event(note: Note) -> tuple[int, Event]:
    """Return the event in a note and when it came (ms). Raises BadNote."""
    return number(note, "ms"), Event(word(note, "event"), values(note))
