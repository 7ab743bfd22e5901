"""One robot of many: what it does now, and its result. Its thread writes, all others read."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.cli.inputs import shown
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.robot.targets import Target
from tiniscript.cli.texts.common import text


class Result(NamedTuple):
    """The result for one robot, as a sentence and as data. `is_absent`: there is none."""

    is_done: bool
    said: str
    fields: Mapping[str, object] = {}
    is_absent: bool = False


class Member:
    """One robot of many: its thread writes, all others read."""

    def __init__(self, target: Target, lines: deque[str]) -> None:
        self.target = target
        self.lines = lines  # to be printed by the one thread that prints for all
        self.name = target.name  # its own name once it has answered
        self.state: tuple[str, dict[str, object]] = ("crew_opening", {})
        self.value = ""  # the last that it has shown
        self.result: Result | None = None
        self.connection: Connection | None = None
        self.bug: Exception | None = None

    def tell(self, key: str, **values: object) -> None:
        """Say what happens now."""
        self.state = key, values

    def print(self, line: str) -> None:
        """Queue a line for printing."""
        self.lines.append(line)

    def meet(self, connection: Connection) -> None:
        """Send HELLO to the robot. Raises CommandError."""
        self.tell("crew_asking")
        connection.meet()
        self.name = connection.name

    @property
    def is_absent(self) -> bool:
        return self.result is not None and self.result.is_absent

    @property
    def mark(self) -> str:
        if self.result is None:
            return ""
        return "absent" if self.is_absent else "ok" if self.result.is_done else "bad"

    def said(self, language: str) -> str:
        """Return the current state, or the result."""
        if self.result is not None:
            return self.result.said
        key, values = self.state
        said = text(key, language).format(**values)
        return f"{said}   {self.value}" if self.value else said

    @property
    def row(self) -> str:
        said = self.result.said if self.result is not None else ""
        name = f"{shown(self.name)} ({shown(self.target.port)})" if self.name else self.target.port
        return f"{name}: {said}"

    def as_json(self) -> str:
        assert self.result is not None
        is_done, said, fields, is_absent = self.result
        return json.dumps({
            "event": "RESULT", "port": self.target.port, "robot": self.name or None,
            "is_done": is_done, "is_absent": is_absent, "said": said, **fields,
        })  # fmt: skip
