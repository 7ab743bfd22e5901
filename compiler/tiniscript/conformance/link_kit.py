"""What `link.json` has: programs and refusals for a robot on a port, and conversations to play.

`python -m tools.generate` makes the file; `docs/conformance.md` has its form. The conversations are
for tests of others, and are not read here.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import NamedTuple

FORM = "tiniscript-link-kit"
VERSION = 1


class LinkProgram(NamedTuple):
    """Code that uses no device and turns no motor. `shows` are values and whether they are TRUE or
    FALSE; `fault` is 0 where it ends by itself, and `at` where it faults."""

    name: str
    code: bytes
    shows: tuple[tuple[int, int], ...]
    fault: int
    at: int
    takes_s: float

    def answer(self) -> tuple[str, ...]:
        rows = [f"SHOW {value} {is_yes_no}" for value, is_yes_no in self.shows]
        return (*rows, f"FAULT {self.fault} {self.at}" if self.fault else "DONE")


class LinkRefused(NamedTuple):
    """Code that breaks a rule, whatever devices the robot has."""

    name: str
    code: bytes
    rule: str
    at: int


class LinkKit(NamedTuple):
    programs: tuple[LinkProgram, ...]
    refused: tuple[LinkRefused, ...]


def link_kit() -> LinkKit:
    path = resources.files("tiniscript") / "conformance" / "link.json"
    found = json.loads(path.read_text(encoding="utf-8"))
    assert (found["form"], found["version"]) == (FORM, VERSION)
    return LinkKit(
        tuple(
            LinkProgram(
                row["name"],
                bytes.fromhex(row["code"]),
                tuple((value, is_yes_no) for value, is_yes_no in row["shows"]),
                row["fault"],
                row["at"],
                row["takes_ms"] / 1000,
            )
            for row in found["programs"]
        ),
        tuple(
            LinkRefused(row["name"], bytes.fromhex(row["code"]), row["rule"], row["at"])
            for row in found["refused"]
        ),
    )
