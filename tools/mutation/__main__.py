"""Breaks the C++ machine in hundreds of ways, and asks whether the tests notice each one.

`python -m tools.mutation` tries all of `mutants.py`; words choose those whose names have them;
`--all` tries a change of every operator, constant and statement too; `--avr` one of every line of
the assembly for the AVR, on a simulated chip. What goes unnoticed is a gap in the tests, and exit
code 1. Needs g++, or avr-g++ and simavr.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "compiler"), str(ROOT)]

from tests.machines import avr
from tests.machines.host import SOURCES, missing
from tests.support.avr_sample import AvrSample
from tests.support.cpp_sample import Sample, Unfit
from tools.mutation.assembly import assembly_breaks, gone_from_avr, noticeable_on_avr
from tools.mutation.equivalent import EQUIVALENT
from tools.mutation.mutants import MACHINE, Break, Stale, breaks
from tools.mutation.operators import small_changes

WORKERS = 2
BUILD = "build"  # what notices a break that does not compile without a warning


class Result(NamedTuple):
    """What noticed a break: a kind of check and its name, or two empty words."""

    each: Break
    kind: str
    check: str
    said: str
    seconds: float


def tried(each: Break, sample: Sample) -> Result:
    """Build the machine with one break, and run the checks until one fails."""
    begun = time.monotonic()
    kind, check, said = "", "", ""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("src", "extras/host", "extras/chip"):
            shutil.copytree(SOURCES / name, copy / name)
        (copy / MACHINE / each.file).write_text(each.text, encoding="utf-8")
        try:
            found = sample.failing(copy)
        except AssertionError as error:
            kind, check, said = BUILD, "g++", str(error)
        else:
            if found:
                (kind, check, _), said = found
    return Result(each, kind, check, said, time.monotonic() - begun)


def tried_on_avr(each: Break, sample: AvrSample) -> Result:
    """Build the program of the chip with one break, and ask it until an answer is wrong."""
    begun = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("src", "extras/avr", "extras/chip"):
            shutil.copytree(SOURCES / name, copy / name)
        (copy / MACHINE / each.file).write_text(each.text, encoding="utf-8")
        try:
            check = sample.failing(avr.program(copy))
            kind, said = "chip" if check else "", ""
        except AssertionError as error:
            kind, check, said = BUILD, "avr-g++", str(error)
    return Result(each, kind, check, said, time.monotonic() - begun)


def results(chosen: Sequence[Break], attempt: Callable[[Break], Result]) -> Iterator[Result]:
    """Yield what becomes of each break, in their order."""
    with ThreadPoolExecutor(WORKERS) as pool:
        yield from pool.map(attempt, chosen)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description="Break the C++ machine; say what notices it.")
    parser.add_argument("words", nargs="*", help="only breaks whose names have one of these words")
    parser.add_argument("--all", action="store_true", help="also every operator and constant")
    parser.add_argument("--avr", action="store_true", help="the assembly, on a simulated chip")
    parser.add_argument("--list", action="store_true", help="only print the names of the breaks")
    options = parser.parse_args(arguments)
    why = avr.missing() if options.avr else missing()
    if why:
        print(why, file=sys.stderr)
        return 2
    try:
        found = assembly_breaks(SOURCES) if options.avr else breaks(SOURCES)
        for name in gone_from_avr(found) if options.avr else ():
            print(f"assembly.py has what is no longer there: {name}", file=sys.stderr)
        if options.all and not options.avr:
            found += small_changes(SOURCES)
            for line in gone(found):
                print(f"equivalent.py has what is no longer there: {line}", file=sys.stderr)
    except Stale as error:
        print(f"The machine was rewritten. In tools/: {error}", file=sys.stderr)
        return 2
    worth = noticeable_on_avr(found) if options.avr else noticeable(found)
    chosen = [each for each in worth if _has(each, options.words)]
    if options.list:
        print("\n".join(f"{each.kind}: {each.name}" for each in chosen))
        return 0
    begun = time.monotonic()
    try:
        done = campaign(chosen, options.avr)
    except Unfit as error:
        print(f"The machine as it is, unbroken, fails a check. {error}", file=sys.stderr)
        return 2
    return summary(done, time.monotonic() - begun)


def campaign(chosen: Sequence[Break], is_avr: bool = False) -> list[Result]:
    """Print what becomes of each break."""
    print("| break | noticed by | s |\n|---|---|---:|", flush=True)
    if is_avr:
        return _told(results(chosen, partial(tried_on_avr, sample=AvrSample())))
    with tempfile.TemporaryDirectory() as builds:
        sample = Sample(SOURCES, Path(builds) / "builds")
        try:
            return _told(results(chosen, partial(tried, sample=sample)))
        finally:
            sample.close()


def _told(found: Iterator[Result]) -> list[Result]:
    done = []
    for result in found:
        noticed = f"{result.kind}: {result.check}" if result.kind else "**nothing**"
        print(f"| {result.each.name} | {noticed} | {result.seconds:.1f} |", flush=True)
        done.append(result)
    return done


def noticeable(found: list[Break]) -> list[Break]:
    """Return the breaks without those that change nothing."""
    return [each for each in found if (each.was, each.becomes) not in EQUIVALENT]


def gone(found: list[Break]) -> list[str]:
    """Return the lines that are listed as equivalent, and are not in the machine."""
    return sorted({was for was, _ in EQUIVALENT} - {each.was for each in found})


def _has(each: Break, words: list[str]) -> bool:
    return not words or any(word in f"{each.kind}: {each.name}" for word in words)


def summary(done: list[Result], seconds: float) -> int:
    """Print how many breaks each kind of check noticed, and which ones none did."""
    kinds = Counter(result.kind or "nothing" for result in done)
    counts = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common())
    print(f"\n{len(done)} breaks in {seconds:.0f} s, noticed by: {counts}.")
    unnoticed = [result for result in done if not result.kind]
    for result in unnoticed:
        print(f"unnoticed: {result.each.kind}: {result.each.name}")
        print(f"  {result.each.was}\n  {result.each.becomes}")
    return 1 if unnoticed else 0


if __name__ == "__main__":
    sys.exit(main())
