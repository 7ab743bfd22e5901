"""Prints every figure that the documents name: `python -m tools.bench`, or only those named.

Runs each benchmark as a process of its own, one after the other, and tells which of them failed.
Takes minutes; times of this computer mean something only where nothing else runs.
"""

from __future__ import annotations

import argparse
import subprocess
import sys

BENCHMARKS = (
    # in the order of `docs/en/figures.md`, then what other documents quote
    "compiler",
    "machine",
    "code_size",
    "link",
    "keys",
    "text",
    "tasks",
    "virtual",
    "obstacles",
    "ways",
    "upload",
    "large_upload",
    "studio",
    "firmware_size",
    "sizes",
)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m tools.bench", description="Print every figure that the documents name."
    )
    parser.add_argument("names", nargs="*", metavar="name", help=f"only some of {BENCHMARKS}")
    names: list[str] = parser.parse_args(arguments).names or list(BENCHMARKS)
    unknown = [name for name in names if name not in BENCHMARKS]
    if unknown:
        parser.error(f"no such benchmark: {', '.join(unknown)}")
    failed = []
    for name in names:
        print(f"\n# python -m tools.bench.{name}\n", flush=True)
        if subprocess.run([sys.executable, "-m", f"tools.bench.{name}"], check=False).returncode:
            failed.append(name)
    if failed:
        print(f"\nnot within its limits, or not done: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
