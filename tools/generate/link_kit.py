"""Makes `conformance/link.json`: the requirements of a robot on a port, and conversations to play.

Knows the form of the file, which `docs/develop/conformance.md` describes. Programs and refusals are
those of `machine_kit` that any robot can run without a sensor, a motor or a minute; the
conversations are the cases of the link, row by row.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from tests.support.link_cases import LinkCase, has_session, link_cases
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.disassembly import disassemble
from tiniscript.bytecode.image import HEADER_BYTES, ImageRefused
from tiniscript.bytecode.opcodes import FAULTS
from tiniscript.bytecode.verify import Refused, load_image, verify
from tiniscript.conformance.kit import LINK_FORM, LINK_VERSION
from tiniscript.link.messages import MAJOR, MINOR
from tiniscript.vm.machine import Machine
from tiniscript.vm.state import DONE, FAULT, WAITING
from tools.generate.machine_kit import (
    MAX_STEPS,
    TINIBOT_KIT,
    USUAL_SCHEDULE,
    Run,
    arithmetic_runs,
    documented_runs,
)

LONGEST_RUN_MS = 3000
MAX_SHOWS = 40
MAX_BYTES = 200  # bytes of code that fit in any robot
UNPREDICTABLE_WORDS = ("TIME", "RANDOM")  # words with unpredictable values
KEY_OF_KIND = {">": "computer", "<": "robot", "did": "does", "tells": "tells", "outcome": "outcome"}
BYTES_ROW = re.compile(r"((?:[0-9a-f]{2} ?)+)(?:   (.*))?$")


def link_kit(command: str) -> str:
    """Return the text of the file: a line for each case."""
    runs = [run for run in documented_runs() if run.schedule == USUAL_SCHEDULE and not run.needs]
    runs += [run for run in arithmetic_runs() if answers_fault(run)]
    parts = {
        "programs": list(programs(runs)),
        "refused": list(refusals(runs)),
        "conversations": [conversation_case(case) for case in link_cases("link")],
    }
    head = {"form": LINK_FORM, "version": LINK_VERSION, "made_by": command, "link": [MAJOR, MINOR]}
    text = json.dumps(head, ensure_ascii=False, indent=1).removesuffix("\n}")
    for name, rows in parts.items():
        lines = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
        text += f',\n "{name}": [\n{lines}\n ]'
    return text + "\n}\n"


def answers_fault(run: Run) -> bool:
    return " " in run.name.removeprefix("arithmetic: ")  # names of faulting runs have two words


def programs(runs: list[Run]) -> Iterator[dict[str, object]]:
    for run in runs:
        try:
            image = load_image(run.image, run.kit)
        except (Refused, ImageRefused):
            continue
        code = image.code
        words = disassemble(code).split()
        if (
            image.devices
            or len(code) > MAX_BYTES
            or any(word in words for word in UNPREDICTABLE_WORDS)
        ):
            continue
        robot = TracedRobot(run.kit, int)
        machine = Machine(code, robot, len(run.kit.readings))
        while (status := machine.tick(robot.now_ms, MAX_STEPS)) == WAITING:
            robot.now_ms = machine.wake_ms
            if robot.now_ms > LONGEST_RUN_MS:
                break
        shows = [
            [event.values[0], int(event.text.endswith("E"))]
            for event in robot.events
            if event.kind == "SHOW"
        ]
        is_still = all(not any(e.values) for e in robot.events if e.kind == "MOTORS")
        other_events = {event.kind for event in robot.events} - {"SHOW", "MOTORS"}
        if status not in (DONE, FAULT) or other_events or not is_still or len(shows) > MAX_SHOWS:
            continue
        numbers = {name: number for number, name, _ in FAULTS}
        fault = numbers[machine.fault] if machine.fault else 0
        yield {
            "name": run.name,
            "code": code.hex(),
            "shows": shows,
            "fault": fault,
            "at": machine.offset if fault else 0,
            "takes_ms": robot.now_ms,
        }


def refusals(runs: list[Run]) -> Iterator[dict[str, object]]:
    """Return code that is refused in the same way with any devices."""
    for run in runs:
        code = run.image[HEADER_BYTES:]
        verdicts = {
            verdict_of(code, 0),
            verdict_of(code, 255),
            verdict_of(code, len(TINIBOT_KIT.readings)),
        }
        if len(verdicts) > 1 or "" in verdicts or len(code) > MAX_BYTES:
            continue
        rule, offset = verdicts.pop().split()
        yield {"name": run.name, "code": code.hex(), "rule": rule, "at": int(offset)}


def verdict_of(code: bytes, device_count: int) -> str:
    try:
        verify(code, device_count, device_count)
    except Refused as error:
        return f"{error.name} {error.offset}"
    return ""


def conversation_case(case: LinkCase) -> dict[str, object]:
    """Return a conversation: each row is a list of its kind, its time, and its content."""
    rows: list[dict[str, object]] = []
    for row in case.rows:
        words = row.split(maxsplit=2)
        if not words:
            continue
        if not words[0].isdigit():
            rows.append({"happens": row.strip()})
            continue
        kind, content = words[1], words[2] if len(words) > 2 else ""
        step: dict[str, object] = {"ms": int(words[0])}
        if kind[0] in "<>":
            match = BYTES_ROW.match(content)
            assert match, (case.id, row)
            step[KEY_OF_KIND[kind[0]]] = match[1].strip()
            step["means"] = (match[2] or "").strip()
            if kind.endswith("x"):
                step["is_lost"] = True
        else:
            step[KEY_OF_KIND[kind]] = content
        rows.append(step)
    return {"name": case.id, "has_session": has_session(case), "rows": rows}
