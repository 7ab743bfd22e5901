"""Breaks other rooms than the machine, a sample of small changes of each: `python -m
tools.mutation.rooms`.

A room is a folder or a file, in C++, Python or JavaScript, and the tests that are about it. Each change is made
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
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path
from typing import Any, NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tools.builds.studio import MODULES
from tools.campaign.results import commit
from tools.mutation.javascript_operators import javascript_changes
from tools.mutation.mutants import blanked
from tools.mutation.operators import changes
from tools.mutation.python_operators import python_changes
from tools.mutation.rooms_equivalent import EQUIVALENT
from tools.mutation.rooms_table import BY_NAME, ROOMS, Room

WRITTEN = Path(__file__).with_name("rooms.json")
LEFT_OUT = "not keeps_to_its_size"  # a size notices any change
LIMIT_S = 600  # for the tests of one change: an endless loop is noticed, too
COPIED = ("compiler", "vm_arduino", "tests", "tools", "docs", "examples")
KEPT = ("README.md", "CONTRIBUTING.md", "bytecode_spec.md", "pyproject.toml", "setup.py")


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
        for start, end, instead in _small_changes(path.suffix, text):
            changed = text[:start] + instead + text[end:]
            line = text.count("\n", 0, start)
            was, becomes = (each.splitlines()[line].strip() for each in (text, changed))
            before = text.splitlines()[line - 1].strip()
            with_before = (f"{before} {was}", f"{before} {becomes}")
            if not {(was, becomes), with_before} & EQUIVALENT:
                name = path.relative_to(root).as_posix()
                yield Change(name, line + 1, was, becomes, changed)


def _small_changes(suffix: str, text: str) -> Iterator[tuple[int, int, str]]:
    if suffix == ".py":
        return python_changes(text)
    return javascript_changes(text) if suffix == ".js" else changes(blanked(text))


def copied(to: Path) -> None:
    """Make a copy of what the tests need."""
    leave = shutil.ignore_patterns("__pycache__", "*.egg-info", ".pio", MODULES.name)
    for name in COPIED:
        shutil.copytree(ROOT / name, to / name, ignore=leave)
    if MODULES.is_dir():
        (to / MODULES.relative_to(ROOT)).symlink_to(MODULES)
    for name in KEPT:
        shutil.copy(ROOT / name, to / name)


def environment_of(copy: Path) -> dict[str, str]:
    return {
        **os.environ,
        "PYTHONPATH": str(copy / "compiler"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def unbuilt(copy: Path) -> str:
    """Build the page of a copy with its sources; return why that fails, or nothing."""
    command = [sys.executable, "-m", "tools.builds.studio", "--again"]
    done = subprocess.run(
        command, cwd=copy, env=environment_of(copy), stdin=subprocess.DEVNULL, text=True,
        capture_output=True, check=False,
    )  # fmt: skip
    return "" if done.returncode == 0 else f"the build: {done.stderr.strip()[-200:]}"


def failing(copy: Path, tests: Sequence[str], without: Sequence[str] = ()) -> str:
    """Return what fails first of the tests of a copy, or nothing."""
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    command += ["-k", " and not ".join((LEFT_OUT, *without)), *tests]
    done = subprocess.Popen(
        command, cwd=copy, env=environment_of(copy), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True,
    )  # fmt: skip
    try:
        output, _ = done.communicate(timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        os.killpg(done.pid, signal.SIGKILL)  # and robots that its tests have started
        done.communicate()
        return "it does not end"
    if done.returncode == 0:
        return ""
    said = [line for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))]
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
        why = unbuilt(copy) if room.is_page else ""
        why = why or failing(copy, [test for test in room.tests if test in needed], room.without)
        if why:
            raise ValueError(why)
        for change in chosen:
            begun = time.monotonic()
            path = copy / change.file
            right = path.read_bytes()
            path.write_text(change.text, encoding="utf-8")
            noticed = unbuilt(copy) if room.is_page else ""
            noticed = noticed or failing(copy, room.tests_of(change.file), room.without)
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
