"""Breaks other rooms than the machine, a sample of small changes of each: `python -m
tools.mutation.rooms`.

A room is a folder or a file, in C++ or Python, and the tests that are about it. Each change is made
in a copy of the repository, in which these tests run until one fails. What no test notices is
printed: it wants a test, or a reason in `rooms_equivalent.py`. `--write` puts the shares into
`docs/promises.md`, and keeps what was unnoticed; `--again` tries that again, and nothing else.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime, timezone
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.campaign.results import commit
from tools.mutation.mutants import blanked
from tools.mutation.operators import changes
from tools.mutation.python_operators import python_changes
from tools.mutation.rooms_equivalent import EQUIVALENT

WRITTEN = Path(__file__).with_name("rooms.json")
LEFT_OUT = ("-k", "not keeps_to_its_size")  # a size notices any change
LIMIT_S = 600  # for the tests of one change: an endless loop is noticed, too
COPIED = ("compiler", "vm_arduino", "tests", "tools", "docs", "examples")
KEPT = ("README.md", "CONTRIBUTING.md", "bytecode_spec.md", "pyproject.toml", "setup.py")


class Room(NamedTuple):
    """`files` are patterns below the repository; `tests` are given to pytest, quick ones first.

    Of a file whose name is in `about`, only those run that have one of its words.
    """

    name: str
    files: tuple[str, ...]
    tests: tuple[str, ...]
    about: Mapping[str, str] = MappingProxyType({})

    def tests_of(self, file: str) -> tuple[str, ...]:
        words = self.about.get(Path(file).name, "").split()
        fit = [test for word in words for test in self.tests if word in test]
        return tuple(dict.fromkeys(fit)) or self.tests


_CPP, _PY = "vm_arduino/src", "compiler/tiniscript"
ROOMS = (
    Room(
        "link",
        (f"{_CPP}/link/[!m]*.cpp",),  # `messages.cpp` is a table
        (
            "tests/link/test_link_cases.py",
            "tests/link/test_siphash.py",
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_owners.py",
            "tests/firmware/test_authority.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_text_limits.py",
            "tests/link/test_robot_times.py",
            "tests/firmware/test_terminal_programs.py",
            "tests/firmware/test_text.py",
            "tests/link/test_damaged_frames.py",
        ),
        {
            "siphash.cpp": "siphash",
            "link_owners.cpp": "link_cases owners authority",
            "console.cpp": "link_cases text_limits terminal",
            "console_writing.cpp": "link_cases text_limits terminal",
            "link_text.cpp": "link_cases text_limits terminal",
            "frames.cpp": "link_cases robot_times damaged",
            "receiver.cpp": "link_cases robot_times text_limits",
            "link.cpp": "link_cases robot_times host owners keeping",
            "link_programs.cpp": "link_cases host text_limits",
            "link_writing.cpp": "link_cases host owners",
        },
    ),
    Room(
        "store",
        (f"{_CPP}/store/store.cpp",),
        (
            "tests/firmware/test_store.py::test_with_the_plug_in",
            "tests/firmware/test_store.py::test_old_or_new",
            "tests/firmware/test_store.py::test_what_breaks_are_noticed_by_finds_nothing",
            "tests/firmware/test_undo.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_other_versions.py",
            "tests/firmware/test_owners.py",
        ),
    ),
    Room(
        "firmware",
        (f"{_CPP}/firmware/*.cpp",),
        (
            "tests/firmware/test_host_firmware.py",
            "tests/firmware/test_keeping.py",
            "tests/firmware/test_undo.py",
            "tests/firmware/test_stops.py",
            "tests/firmware/test_other_versions.py",
            "tests/firmware/test_button.py",
            "tests/firmware/test_owners.py",
            "tests/firmware/test_actuator_stops.py",
            "tests/firmware/test_trim.py",
            "tests/firmware/test_text.py",
            "tests/firmware/test_random_numbers.py",
            "tests/firmware/test_replaced_runs.py",
            "tests/firmware/test_stop_states.py",
            "tests/firmware/test_uno_robot.py::test_a_stop_silences_the_buzzer",
        ),
        {
            "owners.cpp": "owners",
            "identify.cpp": "owners",
            "trim.cpp": "trim",
            "identity.cpp": "keeping owners host",
            "program.cpp": "host keeping undo other_versions",
            "holding.cpp": "host keeping undo other_versions",
            "keeping.cpp": "keeping undo host owners",
            "run.cpp": "random replaced host stops button keeping stop_states silences",
            "firmware.cpp": "host button keeping owners",
        },
    ),
    Room(
        "boards",
        (f"{_CPP}/boards/*.cpp", f"{_CPP}/boards/avr/*.cpp"),
        (
            "tests/firmware/test_boards.py",
            "tests/firmware/test_board_devices.py",
            "tests/firmware/test_board_sonar.py",
            "tests/firmware/test_board_stops.py",
            "tests/firmware/test_uno_robot.py",
            "tests/firmware/test_uno_line.py",
            "tests/firmware/test_uno_watchdog.py",
            "tests/firmware/test_uno_supply.py",
            "tests/firmware/test_uno_stops.py",
        ),
        {
            "analog.cpp": "devices supply",
            "board.cpp": "boards devices",
            "button.cpp": "boards uno_robot",
            "clock.cpp": "boards uno_robot uno_stops",
            "eeprom.cpp": "uno_robot",
            "interrupts.cpp": "uno_line uno_stops",
            "motors.cpp": "boards board_stops",
            "servo.cpp": "boards devices",
            "sound.cpp": "devices",
            "uart.cpp": "uno_line uno_robot uno_stops",
            "ultrasonic.cpp": "sonar devices",
            "watchdog.cpp": "watchdog uno_robot",
        },
    ),
    Room(
        "verifier",
        (f"{_PY}/bytecode/verify.py", f"{_PY}/bytecode/image.py"),
        ("tests/bytecode/test_image.py", "tests/vm/test_cases.py", "tests/bytecode"),
    ),
    Room(
        "session",
        (
            f"{_PY}/link/session.py",
            f"{_PY}/link/requests.py",
            f"{_PY}/link/robot_state.py",
            f"{_PY}/link/receiver.py",
        ),
        (
            "tests/link/test_link_cases.py",
            "tests/link/test_session.py",
            "tests/link/test_session_resets.py",
            "tests/link/test_session_waits.py",
            "tests/link/test_robot_times.py",
        ),
    ),
    Room(
        "sharing",
        (f"{_PY}/sharing/*.py",),
        (
            "tests/sharing/test_peers.py",
            "tests/sharing/test_run_owners.py",
            "tests/sharing/test_shared_port.py",
            "tests/sharing/test_shared_port_visitors.py",
            "tests/sharing/test_strangers.py",
        ),
    ),
    Room(
        "optimizer",
        (f"{_PY}/semantics/optimizer.py",),
        ("tests/semantics", "tests/vm/test_cases.py"),
    ),
    Room("lowering", (f"{_PY}/codegen/*.py",), ("tests/codegen", "tests/vm/test_cases.py")),
    Room(
        "checker",
        (f"{_PY}/semantics/checker.py", f"{_PY}/semantics/types.py"),
        (
            "tests/semantics",
            "tests/vm/test_cases.py",
            "tests/pupils/test_pupils.py",
            "tests/diagnostics/test_rendering.py",
        ),
    ),
)
BY_NAME = {room.name: room for room in ROOMS}


class Change(NamedTuple):
    """A file below the repository with one small change: its line, and what that becomes."""

    file: str
    line: int
    was: str
    becomes: str
    text: str


def changes_of(room: Room, root: Path = ROOT) -> Iterator[Change]:
    """Yield every small change of a room that something may notice."""
    for path in sorted(path for pattern in room.files for path in root.glob(pattern)):
        text = path.read_text(encoding="utf-8")
        is_python = path.suffix == ".py"
        for start, end, instead in python_changes(text) if is_python else changes(blanked(text)):
            changed = text[:start] + instead + text[end:]
            line = text.count("\n", 0, start)
            was, becomes = (each.splitlines()[line].strip() for each in (text, changed))
            before = text.splitlines()[line - 1].strip()
            with_before = (f"{before} {was}", f"{before} {becomes}")
            if not {(was, becomes), with_before} & EQUIVALENT:
                name = path.relative_to(root).as_posix()
                yield Change(name, line + 1, was, becomes, changed)


def copied(to: Path) -> None:
    """Make a copy of what the tests need."""
    leave = shutil.ignore_patterns("__pycache__", "*.egg-info", ".pio")
    for name in COPIED:
        shutil.copytree(ROOT / name, to / name, ignore=leave)
    for name in KEPT:
        shutil.copy(ROOT / name, to / name)


def failing(copy: Path, tests: Sequence[str]) -> str:
    """Return what fails first of the tests of a copy, or nothing."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(copy / "compiler"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *LEFT_OUT]
    command += tests
    try:
        done = subprocess.run(
            command, cwd=copy, env=environment, capture_output=True, text=True, errors="replace",
            timeout=LIMIT_S, stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return "it does not end"
    if done.returncode == 0:
        return ""
    said = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return said[0] if said else f"exit code {done.returncode}"


def survivors(room: Room, chosen: Sequence[Change]) -> list[Change]:
    """Try each change; return those that nothing notices. Raises ValueError where a test fails
    without any change."""
    found: list[Change] = []
    if not chosen:
        return found
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        copied(copy)
        needed = {test for change in chosen for test in room.tests_of(change.file)}
        why = failing(copy, [test for test in room.tests if test in needed])
        if why:
            raise ValueError(why)
        for change in chosen:
            begun = time.monotonic()
            path = copy / change.file
            right = path.read_bytes()
            path.write_text(change.text, encoding="utf-8")
            noticed = failing(copy, room.tests_of(change.file))
            path.write_bytes(right)
            seconds = time.monotonic() - begun
            print(
                f"{change.file}:{change.line}: {noticed or '**nothing**'} ({seconds:.0f} s)",
                flush=True,
            )
            if not noticed:
                print(f"  {change.was}\n  {change.becomes}", flush=True)
                found.append(change)
    return found


# -- what was found, for the document -------------------------------------------------------------

HEAD = ("room", "changes", "tried", "unnoticed", "seed", "date", "commit", "open")
Shares = dict[str, dict[str, Any]]


def shares() -> Shares:
    """Return what was written last. Under `open` are file, line and what that becomes."""
    try:
        found: Shares = json.loads(WRITTEN.read_text(encoding="utf-8"))
    except OSError:
        return {}
    return found


def rows() -> list[tuple[object, ...]]:
    """Return the table of `docs/promises.md`."""
    found: list[tuple[object, ...]] = []
    for room in ROOMS:
        share = shares().get(room.name)
        if share is None:
            found.append((f"`{room.name}`", "", "not run yet", *[""] * (len(HEAD) - 3)))
        else:
            told = (share[name] for name in HEAD[1:-1])
            found.append((f"`{room.name}`", *told, len(share["open"])))
    return found


def write(room: Room, share: dict[str, Any], unnoticed: Sequence[Change]) -> None:
    """Put a share into the document, with all that wants a test or a reason."""
    named = {(each.file, each.was, each.becomes) for each in unnoticed}
    now = {**shares(), room.name: {**share, "open": sorted(named)}}
    WRITTEN.write_text(json.dumps(now, indent=2) + "\n", encoding="utf-8")
    regenerate()


def regenerate() -> None:
    subprocess.run([sys.executable, "-m", "tools.generate"], cwd=ROOT, check=True)


def still_open(room: Room, changes: Sequence[Change]) -> list[Change]:
    """Return the changes that were unnoticed; a line that has changed is none any more."""
    named = {tuple(each) for each in shares().get(room.name, {}).get("open", ())}
    return [each for each in changes if (each.file, each.was, each.becomes) in named]


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Break rooms of the house; say what notices it.")
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=", ".join(BY_NAME))
    parser.add_argument("--tries", type=int, default=20, help="of each room (20); 0: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", action="store_true", help="only what is open, and write that")
    parser.add_argument("--write", action="store_true", help="keep the shares for the document")
    options = parser.parse_args(arguments)
    unknown = [name for name in options.rooms if name not in BY_NAME]
    if unknown:
        parser.error(f"no room is called {', '.join(unknown)}. There are: {', '.join(BY_NAME)}")
    unnoticed = 0
    for room in [BY_NAME[name] for name in options.rooms] or ROOMS:
        all_changes = list(changes_of(room))
        open_before = still_open(room, all_changes)
        tries = min(options.tries or len(all_changes), len(all_changes))
        chosen = random.Random(options.seed).sample(all_changes, tries)
        if options.again:
            chosen, tries = open_before, len(open_before)
        try:
            found = survivors(room, chosen)
        except ValueError as why:
            print(f"{room.name}: its tests fail as it is, unbroken: {why}", file=sys.stderr)
            return 2
        unnoticed += len(found)
        print(
            f"{room.name}: {len(found)} of {tries} unnoticed, of {len(all_changes)} changes\n",
            flush=True,
        )
        if options.again and room.name in shares():
            write(room, shares()[room.name], found)
        elif options.write:
            share = (len(all_changes), tries, len(found), options.seed,
                     datetime.now(timezone.utc).date().isoformat(), commit())  # fmt: skip
            untried = [each for each in open_before if each not in chosen]
            write(room, dict(zip(HEAD[1:-1], share, strict=True)), [*found, *untried])
    return 1 if unnoticed else 0


if __name__ == "__main__":
    sys.exit(main())
