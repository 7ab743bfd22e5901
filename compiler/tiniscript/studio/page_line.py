"""Requests of the page to a real robot and to its keys, and the session with that robot.

Its bytes come and go by what a browser can open.
The page's main thread owns the port, and calls `go`. So a page whose main thread hangs sends
nothing, and the robot's dead-man timer ends its run; `go` stops it if the page was away for longer
than HEARD_MS. Knows no browser and no clock.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

from tiniscript.link.authority import KeyRing, RobotKey
from tiniscript.link.connection import LinkConnection, PendingRequest, Requester
from tiniscript.link.keys import BadKeys, decode_keys, encode_keys, with_keys_added
from tiniscript.link.outcomes import Backlog, Event
from tiniscript.link.requests import DeviceInfo
from tiniscript.link.session import Session
from tiniscript.studio.checking import profile_of
from tiniscript.studio.robot_link import Json, RobotLink

T = TypeVar("T")

ATTENDED_MS = 500  # a page that was away for longer no longer attends to its robot


class PageKeys(KeyRing):
    """The keys that a page keeps. `has_changed`: the page has to keep them anew."""

    def __init__(self, data: bytes) -> None:
        """`data` is a file of keys, or nothing. Raises BadKeys."""
        self.keys: list[RobotKey] = decode_keys(data) if data else []
        self.has_changed = False
        self._kept_keys = self.keys  # the last ones that the page was known to keep

    def file(self) -> str:
        self.has_changed = False
        return encode_keys(self.keys).decode("ascii")

    def add(self, data: bytes) -> int:
        """Put the keys of a file in the place of those before; return how many. Raises BadKeys."""
        new_keys = decode_keys(data)
        self._change_keys(lambda stored_keys: with_keys_added(stored_keys, new_keys))
        return len(new_keys)

    def add_kept(self, data: bytes) -> None:
        """Take what the page keeps now: another tab may have changed it. What has changed here
        since then stays as it is here. Raises BadKeys.
        """
        kept_keys = decode_keys(data) if data else []
        keys_before, own_keys, page_keys = (
            {key[:3]: key for key in keys} for keys in (self._kept_keys, self.keys, kept_keys)
        )
        merged_keys = [
            (own_keys if page_keys.get(key) == keys_before.get(key) else page_keys).get(key)
            for key in {**page_keys, **own_keys}
        ]
        self.keys, self._kept_keys = [key for key in merged_keys if key is not None], kept_keys
        self.has_changed = self.keys != kept_keys

    def _stored_keys(self) -> list[RobotKey]:
        return self.keys

    def accepts(self, robot: int) -> bool:
        """Accept any robot: the person has chosen its port, which has no permanent name on the
        page.
        """
        return True

    def _change_keys(self, change: Callable[[list[RobotKey]], list[RobotKey]]) -> bool:
        new_keys = change(self.keys)
        self.has_changed = self.has_changed or new_keys != self.keys
        self.keys = new_keys
        return True


class PageLine(LinkConnection):
    """A session without a thread: what a RobotLink needs of a connection."""

    def __init__(self, baud: int, kit: int, keys: PageKeys) -> None:
        nonce = int.from_bytes(os.urandom(4), "little")
        self.session = Session(nonce, baud, kit, keys=keys)
        self.session.tells_starts = True
        self.now_ms = 0
        self._events = Backlog()

    @property
    def robot(self) -> DeviceInfo | None:
        return self.session.robot

    def begin(self, make_request: Callable[[Requester], PendingRequest[T]]) -> PendingRequest[T]:
        return make_request(self.session)

    def event(self, timeout_s: float = 0) -> tuple[int, Event] | None:
        return self._events.take_event() if self._events else None

    def enable_place_events(self) -> None:
        self.session.tells_places = True

    def stop(self) -> int:
        self.session.stop(self.now_ms)
        return self.now_ms

    def advance(self, data: bytes, now_ms: int) -> bytes:
        """Take the bytes that have arrived; return those to send."""
        self.note_heard(data)
        self.now_ms = now_ms
        self.session.receive(data, now_ms)
        data_to_send = self.session.poll(now_ms)
        events = self.session.events()
        self.is_echoed = self.is_echoed or any(event.name == "ECHO" for event in events)
        self._events.add_events((now_ms, event) for event in events)
        return data_to_send


class PageRobot:
    """The robot of a page that has opened a port."""

    def __init__(self, robot: str, language: str, keys: PageKeys) -> None:
        """`robot` is the profile of the page's programs."""
        profile = profile_of(robot)
        self.keys = keys
        self.line = PageLine(profile.board.baud, profile.kit.fingerprint, keys)
        self.link = RobotLink(self.line, language)
        self._last_ms: int | None = None

    def advance(self, data: bytes, now_ms: int, requests: list[Json]) -> Json:
        """Advance the session with the received bytes and new requests.

        Returns the bytes to `send` as hexadecimal digits, the time at which to call again at the
        latest (`wakes_ms`, or None), and the news.
        """
        last_ms, self._last_ms = self._last_ms, now_ms
        if last_ms is not None and now_ms - last_ms > ATTENDED_MS and self.link.owns_run:
            self.line.now_ms = now_ms
            self.link.stop()
        for request in requests:
            self.link.ask(request)
        data_to_send = self.line.advance(data, now_ms)
        answer: Json = {
            "send": data_to_send.hex(),
            "news": self.link.news(),
            "wakes_ms": self.line.session.next_wake_ms(),
        }
        if self.keys.has_changed:
            answer["keys"] = self.keys.file()
        return answer


_robot: PageRobot | None = None  # a page has one


def _connect(fields: Json, data: bytes) -> Json:
    """Begin a session over what the page has opened; `data` is the file of its keys, or nothing."""
    global _robot
    try:
        keys = PageKeys(data)
    except BadKeys:
        keys = PageKeys(b"")
    _robot = PageRobot(fields["robot"], fields["language"], keys)
    return {}


def _link(fields: Json, data: bytes) -> Json:
    """Go on with the session; `data` has arrived. `kept` is the file of the page's keys where
    another tab has changed it.
    """
    assert _robot is not None, "no robot is connected"
    if "kept" in fields:
        with suppress(BadKeys):  # a damaged file has none
            _robot.keys.add_kept(fields["kept"].encode())
    return _robot.advance(data, fields["now_ms"], fields["asked"])


def _import_keys(fields: Json, data: bytes) -> Json:
    """Add the keys of a file, `data`, to those of the page, whose file is `kept`."""
    try:
        keys = PageKeys(b"") if _robot is None else _robot.keys
        keys.add_kept(fields["kept"].encode())
        count = keys.add(data)
    except BadKeys:
        return {"count": None}
    return {"count": count, "keys": keys.file()}


HANDLERS: dict[str, Callable[[Json, bytes], Json]] = {
    "connect": _connect, "link": _link, "import_keys": _import_keys,
}  # fmt: skip
