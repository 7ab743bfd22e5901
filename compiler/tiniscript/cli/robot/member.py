"""The robots of a verb that works on many: their ports, what each does now, and its result.

The ports come from `--all`, or several `--port`. The thread of a robot writes, all others read.
"""

from __future__ import annotations

import json
from argparse import Namespace
from collections import deque
from collections.abc import Mapping
from typing import NamedTuple

from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.robot.connect import Connection
from tiniscript.cli.texts import text
from tiniscript.link import known_ports
from tiniscript.link.port_names import canonical_port, exists
from tiniscript.link.sharing.registry import find_all
from tiniscript.virtual import directory


class Target(NamedTuple):
    """A port and the last known name of its robot. `is_named`: the user has named the port;
    `is_known`: a robot has answered there before."""

    port: str
    name: str
    is_named: bool
    is_known: bool


def select_port(options: Namespace) -> bool:
    """Return whether the options select many robots; otherwise set `port` to the only port."""
    options.port = options.ports[0] if options.ports else None
    if options.virtual and (options.all or options.ports):
        raise CommandError(2, "virtual_and_port")
    if options.all and options.ports:
        raise CommandError(2, "all_or_ports", verb=options.verb)
    return bool(options.all) or len(options.ports) > 1 or options.verb == "class"


def targets(options: Namespace) -> list[Target]:
    """Return each port once: the named ones, else all that may have a robot.

    Ports in use come first, then ports of known robots. It opens none.
    """
    names_by_port = known_ports.remembered_ports().name_by_port
    candidate_ports = [inputs.check_port(port) for port in options.ports]
    if options.all:
        candidate_ports = [registration.port for registration in find_all()]
        candidate_ports += [
            port for port in names_by_port if exists(port) and not directory.is_gone(port)
        ]
        from tiniscript.link import ports

        candidate_ports += [listed_port.port for listed_port in ports.list_ports()]
        candidate_ports += [robot.address for robot in directory.running_robots()]
    name_by_canonical = {
        canonical_port(port): name for port, name in reversed(names_by_port.items())
    }
    port_by_canonical: dict[str, str] = {}
    for port in candidate_ports:
        port_by_canonical.setdefault(canonical_port(port), port)
    return [
        Target(
            port,
            name_by_canonical.get(canonical, ""),
            not options.all,
            canonical in name_by_canonical,
        )
        for canonical, port in port_by_canonical.items()
    ]


class Result(NamedTuple):
    """The result for one robot, as a sentence and as data. `is_absent`: no robot is there."""

    is_done: bool
    sentence: str
    fields: Mapping[str, object] = {}
    is_absent: bool = False


class Member:
    """One robot of a fleet: its own thread writes it, the others read it."""

    def __init__(self, target: Target, lines: deque[str]) -> None:
        self.target = target
        self.lines = lines  # lines for the printing thread
        self.name = target.name  # replaced by the robot's own name once it has answered
        self.state: tuple[str, dict[str, object]] = ("crew_opening", {})
        self.value = ""  # the last that it has shown
        self.result: Result | None = None
        self.connection: Connection | None = None
        self.bug: Exception | None = None

    def set_state(self, key: str, **values: object) -> None:
        """Set the current state."""
        self.state = key, values

    def queue_line(self, line: str) -> None:
        """Queue a line for printing."""
        self.lines.append(line)

    def meet_robot(self, connection: Connection) -> None:
        """Send HELLO to the robot. Raises CommandError."""
        self.set_state("crew_asking")
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

    def state_text(self, language: str) -> str:
        """Return the current state, or the result."""
        if self.result is not None:
            return self.result.sentence
        key, values = self.state
        sentence = text(key, language).format(**values)
        return f"{sentence}   {self.value}" if self.value else sentence

    @property
    def result_line(self) -> str:
        text = self.result.sentence if self.result is not None else ""
        name = (
            f"{printable_name(self.name)} ({printable_name(self.target.port)})"
            if self.name
            else self.target.port
        )
        return f"{name}: {text}"

    def as_json(self) -> str:
        assert self.result is not None
        is_done, sentence, fields, is_absent = self.result
        return json.dumps({
            "event": "RESULT", "port": self.target.port, "robot": self.name or None,
            "is_done": is_done, "is_absent": is_absent, "said": sentence, **fields,
        })  # fmt: skip
