"""The tests for a machine or a robot on a port: `machine.json` and `link.json` as values.

`python -m tools.builds.conformance` makes the files, which a package of a release has. It knows
their format, and how a case is given to a machine: `docs/develop/conformance.md` has both. The
conversations of `link.json` are for tests of others.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

FOLDER = Path(__file__).resolve().parent
MACHINE_FORM = "tiniscript-machine-kit"
MACHINE_VERSION = 5  # version of the file's form; raised when readers or machines must know more


class MachineCase(NamedTuple):
    """One run. `devices` are the kit's lines, in the form that is hashed, and its speed;
    `readings_by_sensor` are thousandths by sensor number; times are milliseconds. A slow sensor has
    a period, and ranges in which it is not ready. `call_intervals_ms` has an entry for each wait;
    the last one applies to all further waits. A machine may lack the case's `needs`, which are as
    in images.
    """

    name: str
    devices: tuple[str, ...]
    image: bytes
    readings_by_sensor: dict[int, tuple[int, ...]]
    seed: int
    begin_ms: int
    call_intervals_ms: tuple[int, ...]
    until_ms: int
    needs: int
    answer: tuple[str, ...]
    delays_by_sensor: dict[int, tuple[int, int, int]]

    def request(self) -> str:
        """Return the lines that ask a machine for this run."""
        reading_rows = [
            " ".join(("readings", str(number), *map(str, values)))
            for number, values in sorted(self.readings_by_sensor.items())
        ]
        slow_rows = [
            f"slow {number} {' '.join(map(str, self.delays_by_sensor[number]))}"
            for number in self.delays_by_sensor
        ]
        rows = (
            *self.devices,
            *reading_rows,
            *slow_rows,
            f"seed {self.seed}",
            f"begin {self.begin_ms}",
            f"every {' '.join(map(str, self.call_intervals_ms))}",
            f"until {self.until_ms}",
            f"image {self.image.hex()}".rstrip(),
            "run",
        )
        return "".join(f"{row}\n" for row in rows)


class NotMade(Exception):
    """This installation has no file of cases."""


def _read_json(name: str) -> Any:
    """Return the content of a file of cases. Raises NotMade."""
    try:
        return json.loads((FOLDER / name).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise NotMade from None


def machine_cases() -> list[MachineCase]:
    """Return all cases, in the order of the file. Raises NotMade."""
    return cases_in(_read_json("machine.json"))


def cases_in(kit_file: Any) -> list[MachineCase]:
    """Return the cases of a file of this version, as JSON has it."""
    assert (kit_file["form"], kit_file["version"]) == (MACHINE_FORM, MACHINE_VERSION)
    kits = [tuple(lines) for lines in kit_file["kits"]]
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
            {int(number): tuple(times) for number, times in row.get("slow", {}).items()},
        )
        for row in kit_file["cases"]
    ]


LINK_FORM = "tiniscript-link-kit"
LINK_VERSION = 1


class LinkProgram(NamedTuple):
    """Code that uses no device and turns no motor. `shows` are values and whether they are TRUE or
    FALSE; `fault` is 0 where it ends by itself, and `fault_offset` where it faults."""

    name: str
    code: bytes
    shows: tuple[tuple[int, int], ...]
    fault: int
    fault_offset: int
    duration_s: float

    def answer(self) -> tuple[str, ...]:
        rows = [f"SHOW {value} {is_yes_no}" for value, is_yes_no in self.shows]
        return (*rows, f"FAULT {self.fault} {self.fault_offset}" if self.fault else "DONE")


class RefusedCode(NamedTuple):
    """Code that breaks a rule, whatever devices the robot has."""

    name: str
    code: bytes
    rule: str
    offset: int


class LinkTestSuite(NamedTuple):
    programs: tuple[LinkProgram, ...]
    refusals: tuple[RefusedCode, ...]


def link_test_suite() -> LinkTestSuite:
    """Return the tests for a robot on a port. Raises NotMade."""
    suite_file = _read_json("link.json")
    assert (suite_file["form"], suite_file["version"]) == (LINK_FORM, LINK_VERSION)
    return LinkTestSuite(
        tuple(
            LinkProgram(
                row["name"],
                bytes.fromhex(row["code"]),
                tuple((value, is_yes_no) for value, is_yes_no in row["shows"]),
                row["fault"],
                row["at"],
                row["takes_ms"] / 1000,
            )
            for row in suite_file["programs"]
        ),
        tuple(
            RefusedCode(row["name"], bytes.fromhex(row["code"]), row["rule"], row["at"])
            for row in suite_file["refused"]
        ),
    )
