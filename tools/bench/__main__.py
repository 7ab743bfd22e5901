"""Prints the figures that `docs/en/figures.md` shows: `python -m tools.bench`, or only those named.

Runs each benchmark as the page names it, as a process of its own, one after the other, and tells
which of them failed; each fills in the tables of its section (`page`). It takes minutes; the times
of this computer mean something only if no other program runs.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from pathlib import Path

PAGE = Path(__file__).parent.parent.parent / "docs" / "en" / "figures.md"


def commands() -> list[list[str]]:
    """Return the name of each benchmark of the page and its arguments, in the page's order."""
    text = " ".join(PAGE.read_text(encoding="utf-8").split())
    matches = re.findall(r"`python -m tools\.bench\.(\w+(?: [^`]+)?)`", text)
    return [command.split() for command in dict.fromkeys(matches)]


def main(arguments: list[str] | None = None) -> int:
    rows = commands()
    known_names = list(dict.fromkeys(name for name, *_ in rows))
    parser = argparse.ArgumentParser(
        prog="python -m tools.bench", description="Print the figures of docs/en/figures.md."
    )
    parser.add_argument("names", nargs="*", metavar="name", help=f"only some of {known_names}")
    names: list[str] = parser.parse_args(arguments).names or known_names
    unknown_names = [name for name in names if name not in known_names]
    if unknown_names:
        parser.error(f"no such benchmark: {', '.join(unknown_names)}")
    failed_names = []
    for name, *more_arguments in rows:
        if name not in names:
            continue
        print(
            "\n# python -m",
            " ".join([f"tools.bench.{name}", *more_arguments]),
            end="\n\n",
            flush=True,
        )
        command = [sys.executable, "-m", f"tools.bench.{name}", *more_arguments]
        if subprocess.run(command, check=False).returncode:
            failed_names.append(" ".join([name, *more_arguments]))
    if failed_names:
        print(f"\nnot within its limits, or not done: {', '.join(failed_names)}", file=sys.stderr)
    return 1 if failed_names else 0


if __name__ == "__main__":
    sys.exit(main())
