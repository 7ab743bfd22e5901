"""`tsc doctor --conform`: checks whether another vendor's machine or robot behaves as specified."""

from __future__ import annotations

import contextlib
import json
import os
import sys
from argparse import Namespace
from collections.abc import Iterable

from tiniscript import robots
from tiniscript.bytecode.opcodes import ISA_MAJOR, ISA_MINOR
from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import whole_number
from tiniscript.cli.robot.connect import baud_of, convert_port_error
from tiniscript.cli.texts import say, text
from tiniscript.conformance import port_checks
from tiniscript.conformance.comparing import AGREES, DIFFERS, LACKS, Verdict, verdicts
from tiniscript.conformance.kit import (
    FOLDER,
    LINK_VERSION,
    MACHINE_VERSION,
    NotMade,
    link_test_suite,
    machine_cases,
)
from tiniscript.conformance.machine_process import CannotStart, MachineProcess
from tiniscript.conformance.wire_robot import Silent, WireRobot
from tiniscript.library import install_advice
from tiniscript.link import ports
from tiniscript.link.messages import MAJOR, MINOR, OWNED, STOP_BYTES
from tiniscript.link.wire import Wire

TIMEOUT_S = 10
MAX_ROWS = 20
CABLE_TIMEOUT_MS, RADIO_TIMEOUT_MS = 300, 700  # time for one try of an exchange
# An Uno takes 1.4 s after its port was opened, and a Mega wants silence until then.
BOOT_WAIT_MS = 1700
CASES_BUILDER = "tools.builds.conformance"  # module that builds the cases; no package contains it
ISA = f"{ISA_MAJOR}.{ISA_MINOR}"


def run(options: Namespace, language: str) -> int:
    timeout_s = whole_number("--timeout", options.timeout, TIMEOUT_S, 1, 3600, language)
    if options.machine is None and options.port is None:
        raise CommandError(2, "conform_which")
    try:
        if options.machine is None:
            return _check_port(options, language)
        if options.port is not None or options.baud is not None:
            raise CommandError(2, "conform_both")
        return _check_machine(options, timeout_s, language)
    except NotMade:
        raise CommandError(2, "conform_not_made", how=build_command()) from None


def build_command() -> str:
    """Return the command that makes the cases of this installation in a clone."""
    words = [sys.executable, "-m", CASES_BUILDER]
    if not install_advice.is_clone(install_advice.CLONE):
        words.append(str(FOLDER))
    return " ".join(map(install_advice.quote, words))


def _check_machine(options: Namespace, timeout_s: int, language: str) -> int:
    cases = [case for case in machine_cases() if (options.only or "") in case.name]
    if not cases:
        raise CommandError(2, "conform_no_case", found=printable_name(options.only))
    process = MachineProcess(options.machine, timeout_s)
    try:
        machine_verdicts = list(verdicts(cases, process.ask))
    except CannotStart as error:
        command = printable_name(options.machine) or "''"
        raise CommandError(
            2, "conform_no_start", command=command, why=printable_name(str(error))
        ) from None
    finally:
        process.close()
    facts = {"version": str(MACHINE_VERSION), "isa": ISA}
    return report(
        machine_verdicts, len(cases), facts, "conform_machine_end", timeout_s, options, language
    )


def _check_port(options: Namespace, language: str) -> int:
    if options.timeout is not None:
        raise CommandError(2, "conform_timeout")
    port = inputs.check_port(options.port)
    baud = baud_of(options, robots.load(robots.DEFAULT), language)
    checks = port_checks.all_checks(link_test_suite())
    checks = [check for check in checks if (options.only or "") in check.name]
    if not checks:
        raise CommandError(2, "conform_no_case", found=printable_name(options.only))
    with convert_port_error(port):
        wire = Wire(ports.open_port(ports.resolve(port), baud))
    is_radio = ports.is_radio(port)
    nonce = int.from_bytes(os.urandom(4), "little")
    robot = WireRobot(wire, nonce, RADIO_TIMEOUT_MS if is_radio else CABLE_TIMEOUT_MS)
    verdicts: list[Verdict] = []
    try:
        wire.receive(0 if is_radio else BOOT_WAIT_MS)
        hello = port_checks.greet(robot)
        if not hello.status and hello.number("features") & OWNED:
            raise CommandError(3, "conform_owned")
        verdicts.extend(port_checks.verdicts(robot, checks))
    except Silent:
        raise CommandError(3, "conform_silent", port=printable_name(port)) from None
    except OSError as error:
        values = {
            "port": printable_name(port),
            "why": printable_name(str(error)),
            "n": str(len(verdicts)),
        }
        raise CommandError(3, "conform_gone", **values) from None
    finally:
        with contextlib.suppress(OSError):  # the robot must stop, however the checks ended
            robot.send(bytes(STOP_BYTES))
        wire.close()
    facts = {"version": str(LINK_VERSION), "link": f"{MAJOR}.{MINOR}", "isa": ISA}
    return report(verdicts, len(checks), facts, "conform_port_end", 0, options, language)


def report(
    verdicts: Iterable[Verdict],
    case_count: int,
    facts: dict[str, str],
    end_key: str,
    timeout_s: int,
    options: Namespace,
    language: str,
) -> int:
    """Print the differences and their number; return the exit code."""
    verdicts = list(verdicts)
    lacking_count = sum(verdict.outcome == LACKS for verdict in verdicts)
    verdicts = [verdict for verdict in verdicts if verdict.outcome != LACKS]
    case_count -= lacking_count
    differing_verdicts = [verdict for verdict in verdicts if verdict.outcome != AGREES]
    agreeing_count = len(verdicts) - len(differing_verdicts)
    if options.json:
        rows = [
            {
                "name": verdict.name,
                "what": verdict.outcome,
                "line": verdict.line,
                "want": verdict.expected_line,
                "got": verdict.actual_line,
                "detail": verdict.detail,
            }
            for verdict in differing_verdicts
        ]
        summary = {
            **facts,
            "cases": case_count,
            "agree": agreeing_count,
            "differ": len(differing_verdicts),
        }
        summary |= {"left_out": lacking_count} if lacking_count else {}
        summary["found"] = rows
        print(json.dumps(summary, indent=2, ensure_ascii=False))
        return int(bool(differing_verdicts))
    for verdict in differing_verdicts[:MAX_ROWS]:
        print("\n".join(_rows(verdict, timeout_s, language)))
    if len(differing_verdicts) > MAX_ROWS:
        say("conform_others", language, n=len(differing_verdicts) - MAX_ROWS)
    if len(verdicts) < case_count:
        say("conform_given_up", language)
    if lacking_count:
        say("conform_left_out", language, n=lacking_count)
    say(end_key, language, good=agreeing_count, all=case_count, **facts)
    return int(bool(differing_verdicts))


def _rows(verdict: Verdict, timeout_s: int, language: str) -> list[str]:
    rows = [text("conform_case", language).format(name=verdict.name)]
    if verdict.outcome != DIFFERS:
        key = (
            "conform_silent_check" if verdict.outcome == "silent" else f"conform_{verdict.outcome}"
        )
        sentence = text(key, language)
        rows.append(sentence.format(detail=printable_name(verdict.detail), seconds=timeout_s))
    if verdict.line:
        nothing_text = text("conform_nothing", language)
        got_text, wanted_text = (
            nothing_text if row is None else printable_name(row)
            for row in (verdict.actual_line, verdict.expected_line)
        )
        rows.append(
            text("conform_line", language).format(line=verdict.line, got=got_text, want=wanted_text)
        )
    return rows
