"""What the page asks of a real robot and of its keys; the worker loads it then."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from tiniscript.studio.page_line import BadKeys, PageKeys, PageRobot

Answer = dict[str, Any]

_robot: PageRobot | None = None  # a page has one


def _connect(fields: Answer, data: bytes) -> Answer:
    """Begin a session over what the page has opened; `data` is the file of its keys, or nothing."""
    global _robot
    try:
        keys = PageKeys(data)
    except BadKeys:
        keys = PageKeys(b"")
    _robot = PageRobot(fields["robot"], fields["language"], keys)
    return {}


def _link(fields: Answer, data: bytes) -> Answer:
    """Go on with the session; `data` has arrived."""
    assert _robot is not None, "no robot is connected"
    return _robot.go(data, fields["now_ms"], fields["asked"])


def _import_keys(fields: Answer, data: bytes) -> Answer:
    """Add the keys of a file, `data`, to those of the page, whose file is `kept`."""
    try:
        keys = PageKeys(fields["kept"].encode()) if _robot is None else _robot.keys
        count = keys.add(data)
    except BadKeys:
        return {"count": None}
    return {"count": count, "keys": keys.file()}


ASKED: dict[str, Callable[[Answer, bytes], Answer]] = {
    "connect": _connect, "link": _link, "import_keys": _import_keys,
}  # fmt: skip
