"""What a machine or a robot on a port must do: what `machine.json` and `link.json` say, as values.

`python -m tools.generate` makes the files. Knows their form, and how a case is told to a machine:
`docs/conformance.md` has both. The conversations of `link.json` are for tests of others.
"""

from __future__ import annotations

import json
from importlib import resources
from typing import NamedTuple

FORM = "tiniscript-machine-kit"
VERSION = 4  # of the form; grows when a reader of the file, or a machine, must know more


class MachineCase(NamedTuple):
    """One run. `devices` are the kit's lines, as the specification hashes them, and how fast it is;
    `readings` are thousandths by the number of the sensor; times are milliseconds. `every_ms` has
    one for each wait, the last for all that follow. A machine may lack what a case `needs`, as
    images say it."""

    name: str
    devices: tuple[str, ...]
    image: bytes
    readings: dict[int, tuple[int, ...]]
    seed: int
    begin_ms: int
    every_ms: tuple[int, ...]
    until_ms: int
    needs: int
    answer: tuple[str, ...]

    def request(self) -> str:
        """Return the lines that ask a machine for this run."""
        lists = [
            " ".join(("readings", str(number), *map(str, values)))
            for number, values in sorted(self.readings.items())
        ]
        rows = (
            *self.devices,
            *lists,
            f"seed {self.seed}",
            f"begin {self.begin_ms}",
            f"every {' '.join(map(str, self.every_ms))}",
            f"until {self.until_ms}",
            f"image {self.image.hex()}".rstrip(),
            "run",
        )
        return "".join(f"{row}\n" for row in rows)


def machine_cases() -> list[MachineCase]:
    """Return all cases, in the order of the file."""
    path = resources.files("tiniscript") / "conformance" / "machine.json"
    return cases_of(path.read_text(encoding="utf-8"))


def cases_of(text: str) -> list[MachineCase]:
    """Return the cases of a file of this version."""
    found = json.loads(text)
    assert (found["form"], found["version"]) == (FORM, VERSION)
    kits = [tuple(lines) for lines in found["kits"]]
    return [
        MachineCase(
            row["name"],
            kits[row["kit"]],
            bytes.fromhex(row["image"]),
            {int(number): tuple(values) for number, values in row["readings"].items()},
            row["seed"],
            row["begin"],
            tuple(row["every"]),
            row["until"],
            row.get("needs", 0),
            tuple(row["answer"]),
        )
        for row in found["cases"]
    ]


LINK_FORM = "tiniscript-link-kit"
LINK_VERSION = 1


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
    assert (found["form"], found["version"]) == (LINK_FORM, LINK_VERSION)
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
