"""`tsc conform`: whether a machine or a robot that others have made does what it should."""

from __future__ import annotations

import json
from argparse import Namespace
from collections.abc import Iterable

from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import shown
from tiniscript.cli.options import whole_number
from tiniscript.cli.texts.common import text
from tiniscript.conformance.comparing import AGREES, DIFFERS, Verdict, verdicts
from tiniscript.conformance.kit import VERSION, machine_cases
from tiniscript.conformance.machine_process import CannotStart, MachineProcess

PATIENCE_S = 10
MOST_SHOWN = 20
ISA = f"{ISA_MAJOR}.{ISA_MINOR}"


def run(options: Namespace, language: str) -> int:
    timeout_s = whole_number("--timeout", options.timeout, PATIENCE_S, 1, 3600, language)
    if options.machine is None:
        raise CommandError(2, "conform_which")
    return _machine(options, timeout_s, language)


def _machine(options: Namespace, timeout_s: int, language: str) -> int:
    cases = [case for case in machine_cases() if (options.only or "") in case.name]
    if not cases:
        raise CommandError(2, "conform_no_case", found=shown(options.only))
    process = MachineProcess(options.machine, timeout_s)
    try:
        found = list(verdicts(cases, process.ask))
    except CannotStart as why:
        command = shown(options.machine) or "''"
        raise CommandError(2, "conform_no_start", command=command, why=shown(str(why))) from None
    finally:
        process.close()
    facts = {"version": str(VERSION), "isa": ISA}
    return report(found, len(cases), facts, "conform_machine_end", timeout_s, options, language)


def report(
    found: Iterable[Verdict],
    count: int,
    facts: dict[str, str],
    end: str,
    timeout_s: int,
    options: Namespace,
    language: str,
) -> int:
    """Print what differs, and the sum; return the exit code."""
    found = list(found)
    differing = [each for each in found if each.what != AGREES]
    good = len(found) - len(differing)
    if options.json:
        rows = [each._asdict() for each in differing]
        sums = {**facts, "cases": count, "agree": good, "differ": len(differing), "found": rows}
        print(json.dumps(sums, indent=2, ensure_ascii=False))
        return int(bool(differing))
    for each in differing[:MOST_SHOWN]:
        print("\n".join(_rows(each, timeout_s, language)))
    if len(differing) > MOST_SHOWN:
        print(text("conform_others", language).format(n=len(differing) - MOST_SHOWN))
    if len(found) < count:
        print(text("conform_given_up", language))
    print(text(end, language).format(good=good, all=count, **facts))
    return int(bool(differing))


def _rows(each: Verdict, timeout_s: int, language: str) -> list[str]:
    rows = [text("conform_case", language).format(name=each.name)]
    if each.what != DIFFERS:
        said = text(f"conform_{each.what}", language)
        rows.append(said.format(detail=shown(each.detail), seconds=timeout_s))
    if each.line:
        nothing = text("conform_nothing", language)
        got, want = (nothing if row is None else shown(row) for row in (each.got, each.want))
        rows.append(text("conform_line", language).format(line=each.line, got=got, want=want))
    return rows
