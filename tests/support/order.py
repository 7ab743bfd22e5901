"""Orders tests for several processes, so that none ends long after the others.

pytest-xdist gives each process an equal part of the list, one after the other, and an idle process
takes the last tests of others. So each process begins with slow files and ends with quick tests.
Pages are in half of the parts: each process that has one starts a browser.
"""

from __future__ import annotations

import os
from collections.abc import Sequence

import pytest

PAGES = "tests/studio/test_page"
# The slowest tests apart from pages: builds, emulated chips, processes and real clocks.
LONG_FILES = (
    "tests/flash/test_platformio.py",
    "tests/lessons/test_other_shapes.py",
    "tests/project/test_mutation.py",
    "tests/vm/test_cpp_agreement.py",
    "tests/flash/test_flash.py",
    "tests/flash/test_building.py",
    "tests/flash/test_bootloader.py",
    "tests/between/test_commands.py",
    "tests/cli/test_many_robots.py",
    "tests/cli/test_doctor_command.py",
    "tests/vm/test_agreement.py",
    "tests/link/test_named_robots.py",
    "tests/link/test_bluetooth.py",
    "tests/sketch/test_sketches.py",
    "tests/lessons/test_lessons.py",
    "tests/vm/test_wasm.py",
    "tests/vm/test_cpp_chips.py",
    "tests/project/test_package.py",
    "tests/cli/test_fetching.py",
    "tests/studio/test_hosting.py",
    "tests/studio/test_build.py",
    "tests/studio/test_flashing.py",
    "tests/cli/test_class_command.py",
)


def spread(items: list[pytest.Item]) -> None:
    """Order the tests for the processes of this run; in one alone they stay as they are."""
    count = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    if count > 1:
        names = [item.nodeid.partition("::")[0] for item in items]
        items[:] = [items[k] for k in spread_names(names, count)]


def spread_names(names: Sequence[str], count: int) -> list[int]:
    """Return the order of tests, each of the file of that name, for so many processes."""
    files: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        files.setdefault(name, []).append(k)
    half = (count + 1) // 2
    parts: list[list[int]] = [[] for _ in range(count)]
    pages = [name for name in files if name.startswith(PAGES)]
    other_names = [name for name in LONG_FILES if name in files]
    for part_names, target_parts in ((pages, parts[:half]), (other_names, parts[half:])):
        for k, name in enumerate(part_names):
            target_parts[k % len(target_parts)] += files.pop(name)
    quick = [k for row in files.values() for k in row]
    names_left = len(names)
    for index, part in enumerate(parts):
        size = max(len(part), names_left // (count - index))
        names_left -= size
        room = size - len(part)
        part += quick[:room]
        del quick[:room]
    return [k for part in parts for k in part] + quick
