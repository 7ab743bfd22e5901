"""Programs of each release and their traces, as `tests/vm/programs_of_*.txt` have them."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

from tests.support.casefile import ROOT

FOLDER = ROOT / "tests" / "vm"
FIRST_VERSION = "0.2.0"


class ReleasedProgram(NamedTuple):
    robot: str
    text: str
    trace: str


def file_of_version(version: str) -> Path:
    return FOLDER / f"programs_of_{version.replace('.', '_')}.txt"


def released_programs(version: str = FIRST_VERSION) -> list[ReleasedProgram]:
    parts = re.findall(r"(?m)^= (\w+)\n((?:.*\n)*?)((?:> .*\n)*)(?:\n|\Z)(?=\Z|= )",
                       file_of_version(version).read_text(encoding="utf-8"))  # fmt: skip
    return [ReleasedProgram(robot, text, trace) for robot, text, trace in parts]
