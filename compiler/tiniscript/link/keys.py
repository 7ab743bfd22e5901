"""The keys of a person's robots: a file that only this person can read.

It lies in the user's folder for settings: a lost key is made good at the robot alone. Knows the
form of the file, and of a class list, which has the same form. No exception and no text has a key
in it.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock

from tiniscript.base import files
from tiniscript.base.source import printable
from tiniscript.link import met_robots
from tiniscript.link.authority import KeyRing, RobotKey
from tiniscript.link.messages import KEY_BYTES, KEYS

FILE_BYTES = 1_000_000
NAME_CHARACTERS = 16
MAX_KEYS = 2000  # keys in a file
FILE_MODE = 0o600  # readable by this user only
_LOCK = Lock()  # the robots of a fleet have threads of their own
# Names of a key's fields in the file.
_MARK_FIELDS = {"is_pending": "is_pending", "is_stale": "is_stale", "seals": "uses_seals"}
_KEY_KINDS = tuple(name.lower() for name, _ in KEYS)


class BadKeys(Exception):
    """A file without keys, or that cannot be read or written; `detail` is the system's message."""

    def __init__(self, detail: str = "") -> None:
        super().__init__(detail)
        self.detail = detail


class TooManyKeys(BadKeys):
    """More keys than a file can have: none was written."""


class KeyFile(KeyRing):
    """The keys in a file; the user's own if no path is given. Each call reads it anew."""

    def __init__(
        self,
        path: Path | None = None,
        serves_virtual_robots: bool = False,
        accepts_all: bool = False,
    ) -> None:
        """`serves_virtual_robots`: the robot may be a virtual one that starts anew each time, with
        the same id and without its former owner. `accepts_all`: any robot may replace another one.
        """
        self._accepts_all = accepts_all
        self.path = path or files.settings_folder() / "keys.json"
        self._serves_virtual_robots = serves_virtual_robots

    def all(self) -> list[RobotKey]:
        """Return all keys. Raises BadKeys if the file is none."""
        try:
            data = files.read_limited(self.path, FILE_BYTES)
        except FileNotFoundError:
            return []
        except OSError as failure:
            raise BadKeys(failure.strerror or str(failure)) from None
        return decode_keys(data)

    def add(self, keys: Iterable[RobotKey]) -> int:
        """Put keys into the file in the place of those before; return how many are new or other.

        Raises BadKeys, and TooManyKeys where keys that are there would go for it.
        """
        with self._lock():
            stored_keys = self.all()
            all_keys = with_keys_added(stored_keys, keys)
            changed_count = sum(key not in stored_keys for key in all_keys)
            if changed_count:
                self._write_keys(all_keys)
            return changed_count

    def forget(self, robot_id: int) -> None:
        """Take the keys of a robot out of the file. Raises BadKeys."""
        with self._lock():
            self._write_keys([key for key in self.all() if key.id != robot_id])

    def accept(self, robot_id: int) -> None:
        """Accept another robot at the same place or with the same name. Raises BadKeys."""
        try:
            met_robots.accept(self._met_robots_path, robot_id)
        except OSError as failure:
            raise BadKeys(failure.strerror or str(failure)) from None

    # -- as a KeyRing: where the file cannot be read there is no key ------------------------------

    def _stored_keys(self) -> list[RobotKey]:
        with suppress(BadKeys):
            robot_keys = self.all()
            return (
                [key._replace(uses_seals=False) for key in robot_keys]
                if self._serves_virtual_robots
                else robot_keys
            )
        return []

    @property
    def _met_robots_path(self) -> Path:
        return self.path.with_name("robots.json")

    def robot_at(self, place: str) -> int | None:
        return met_robots.read_met_robots(self._met_robots_path).id_by_place.get(place)

    def remember_robot(self, place: str, robot_id: int) -> None:
        if not self._serves_virtual_robots:
            met_robots.remember_robot(self._met_robots_path, place, robot_id)

    def accepts(self, robot_id: int) -> bool:
        return (
            self._accepts_all
            or robot_id in met_robots.read_met_robots(self._met_robots_path).accepted_ids
        )

    def _change_keys(self, change: Callable[[list[RobotKey]], list[RobotKey]]) -> bool:
        try:
            with self._lock():
                old_keys = self.all()
                new_keys = change(old_keys)
                if new_keys != old_keys:
                    self._write_keys(new_keys)
        except BadKeys:
            return False
        return True

    @contextmanager
    def _lock(self) -> Iterator[None]:
        """No other thread and no other process changes the file. Raises BadKeys."""
        with _LOCK:
            try:
                self._make_folder()
                with files.lock_file(self.path, FILE_MODE):
                    yield
            except OSError as failure:
                raise BadKeys(failure.strerror or str(failure)) from None

    def _make_folder(self) -> None:
        self.path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        self.path.parent.chmod(0o700)

    def _write_keys(self, keys: list[RobotKey]) -> None:
        if len(keys) > MAX_KEYS:
            raise TooManyKeys
        try:
            files.replace(self.path, encode_keys(keys), FILE_MODE)
        except (OSError, ValueError) as failure:
            raise BadKeys(getattr(failure, "strerror", None) or str(failure)) from None


def with_keys_added(stored_keys: list[RobotKey], added_keys: Iterable[RobotKey]) -> list[RobotKey]:
    """Return stored keys with those of a list, each in the place of the one before.

    A pending key is kept as well: only the robot knows which of the two is right. The file also
    keeps that an earlier key's robot seals.
    """
    sealing_keys = {key.key for key in stored_keys if key.uses_seals}
    new_keys = {
        key.slot: key._replace(uses_seals=key.uses_seals or key.key in sealing_keys)
        for key in added_keys
    }
    other_keys = [key for key in stored_keys if key.is_pending or key.slot not in new_keys]
    return [*other_keys, *new_keys.values()]


def is_shared(path: Path) -> bool:
    """Return whether others may read a file; if the system has no such bits, assume no."""
    if sys.platform == "win32":
        return False
    try:
        return bool(path.stat().st_mode & 0o077)
    except OSError:
        return False


def encode_keys(keys: Iterable[RobotKey]) -> bytes:
    """Return keys as a file."""
    rows = [
        {
            "id": f"{key.id:08x}",
            "name": key.name,
            "kind": _KEY_KINDS[key.kind],
            "key": key.key.hex(),
            **{mark: True for mark, field in _MARK_FIELDS.items() if getattr(key, field)},
        }
        for key in keys
    ]
    return (json.dumps({"tiniscript_keys": 1, "keys": rows}, indent=1) + "\n").encode()


def decode_keys(data: bytes) -> list[RobotKey]:
    """Return the keys in a file. Raises BadKeys if it is none, without anything from it."""
    try:
        document = json.loads(data)
        if document["tiniscript_keys"] != 1:
            raise BadKeys
        if len(document["keys"]) > MAX_KEYS:
            raise BadKeys
        return [_key(row) for row in document["keys"]]
    except (ValueError, TypeError, KeyError, IndexError, RecursionError):
        raise BadKeys from None


def _key(row: dict[str, object]) -> RobotKey:
    robot_id, kind, key_hex = (str(row[name]) for name in ("id", "kind", "key"))
    data = bytes.fromhex(key_hex)
    if (
        not re.fullmatch("[0-9a-f]{8}", robot_id)
        or len(data) != KEY_BYTES
        or not any(data)
        or kind not in _KEY_KINDS
    ):
        raise ValueError
    name = printable(str(row.get("name", "")), NAME_CHARACTERS)
    marks = {field: row.get(mark) is True for mark, field in _MARK_FIELDS.items()}
    return RobotKey(int(robot_id, 16), _KEY_KINDS.index(kind), data, name, **marks)
