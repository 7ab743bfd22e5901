"""Random programs behave the same with and without stepping.

`python -m tests.firmware.test_breakpoints_campaign 1000` runs many.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Callable

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.oracle import programs
from tests.support.debugging import DebuggedRobot
from tests.support.images import image_of
from tests.support.kits import KITS
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import Image
from tiniscript.bytecode.statements import statement_starts
from tiniscript.link.messages import RESUME_GO, RESUME_STEP
from tiniscript.link.payloads import HaltedEvent
from tiniscript.link.requests import OK

LIMIT_MS = 3000  # length of the observed time
RUN_START_MS = 1500  # each run, because the seed of RANDOM depends on the time
END_EVENTS = ("DONE", "FAULT", "STOPPED")


def switched_on(kit: Kit, seed: int) -> HostFirmware:
    robot = HostFirmware(kit, seed=seed)
    robot.wait(200)
    rng = random.Random(seed)
    robot.set_readings(*(rng.choice((0, 5000, 30_000)) for _ in kit.sensors))
    return robot


def run(image: Image, kit: Kit, seed: int, mode: str) -> list[str]:
    """Run a program alone, step by step, or from place to place; return its actions and values,
    without the motor changes of halts, up to the first event after LIMIT_MS of its own time.
    """
    rng = random.Random(seed)
    debugged = DebuggedRobot(image, switched_on(kit, seed), kit.fingerprint)
    statements = statement_starts(image.code)
    if mode != "alone":
        lines_before = (
            statements[:1] if mode == "steps" else rng.sample(statements, min(4, len(statements)))
        )
        assert debugged.places(*lines_before) == OK
    debugged.talk(RUN_START_MS - debugged.robot.now_ms)
    event_count = len(debugged.robot.did)
    debugged.start()
    own_ms, lines_there, halted_in = 0, list[str](), 0
    while own_ms < LIMIT_MS:
        events = debugged.talk(1)
        own_ms += 1
        lines = [line.split(maxsplit=1)[1] for line in debugged.robot.did[event_count:]]
        event_count = len(debugged.robot.did)
        halts = [event for event in events if isinstance(event, HaltedEvent)]
        lines_there += lines
        lines_there += [f"SHOW {event.value}" for event in events if event.name == "SHOW"]
        if any(event.name in END_EVENTS for event in events):
            break
        for event in halts:
            assert event.offset in statements
            halted_in += 1
            debugged.go(RESUME_STEP if mode == "steps" or rng.random() < 0.3 else RESUME_GO)
            lines_there.append("HALT")
    assert mode != "steps" or halted_in
    return lines_there


def without_halts(lines: list[str], kind: str) -> list[str]:
    """Return the lines of one kind; for MOTORS only those that change the program's setting."""
    kind_lines = [line for line in lines if line.split()[0] == kind]
    if kind != "MOTORS":
        return kind_lines
    changes, last_change = list[str](), "MOTORS 0 0"
    for line in kind_lines:
        if line not in ("MOTORS 0 0", last_change):
            changes.append(line)
            last_change = line
    return changes


def compare(seed: int) -> bool:
    """Compare a program; return whether it was long enough to be one."""
    rng = random.Random(seed)
    oracle_kit, kit = KITS[seed % len(KITS)]
    text = programs.program(rng, oracle_kit)
    image = image_of(text, kit)
    if image.start != "SI" or not statement_starts(image.code) or "TIME" in text or image.needs & 1:
        return False
    unstepped_run = run(image, kit, seed, "alone")
    for mode in ("steps", "places"):
        stepped_run = run(image, kit, seed, mode)
        for kind in ("SHOW", "SET", "BEEP", "MOTORS"):
            first, second = without_halts(unstepped_run, kind), without_halts(stepped_run, kind)
            count = min(len(first), len(second))
            assert first[:count] == second[:count], (seed, mode, kind, text)
            have_both_ended = "FINISHED" in unstepped_run and "FINISHED" in stepped_run
            assert not have_both_ended or len(first) == len(second), (seed, mode, kind, text)
        assert not [line for line in stepped_run if "CHANGED" in line or "UNVERIFIED" in line]
    return True


@pytest.mark.parametrize("seed", range(12))
def test_a_stepped_program_does_the_same_as_an_unstepped_one(seed: int) -> None:
    compare(seed)


# -- the next run ------------------------------------------------------------------------------

NEXT_PROGRAM = (
    "SI|BEEP(0.001, 31);LOOP(3);SHOW(TIME);F(0.06, 80);END_LOOP;W(0.1);M(30, 30);W(0.2);SHOW(9)"
)
STOPS: dict[str, Callable[[DebuggedRobot], object]] = {
    "nothing": lambda debugged: None,  # the next run ends it
    "zeros": lambda debugged: debugged.session.receive(
        debugged.robot.step(bytes(4)), debugged.robot.now_ms
    ),
    "its computer": lambda debugged: debugged.session.stop(debugged.robot.now_ms),
    "the button": lambda debugged: debugged.robot.talk(debugged.session, 1, flags=1),
    "a stall": lambda debugged: debugged.robot.talk(debugged.session, 1, flags=4),
}


def play_halts(debugged: DebuggedRobot, rng: random.Random) -> None:
    """Start the program, step it, resume it, leave it halted, and end it in some way."""
    for _ in range(rng.randint(1, 3)):
        statements = statement_starts(debugged.image.code)
        debugged.places(*rng.sample(statements, rng.randint(0, 4)))
        debugged.start()
        for _ in range(rng.randint(0, 5)):
            debugged.talk(rng.choice((1, 20, 100, 700)))
            resume_mode = rng.choice((RESUME_GO, RESUME_STEP, RESUME_STEP))
            if rng.random() < 0.7:
                debugged.go(resume_mode)
        if rng.random() < 0.5:
            # Sent while a stop is on its way.
            debugged.session.resume(extent=rng.choice((RESUME_GO, RESUME_STEP)))
            debugged.talk(rng.choice((0, 1, 2, 3)))
        STOPS[rng.choice([*STOPS])](debugged)
        debugged.talk(rng.choice((300, 700)))


def list_next_run(debugged: DebuggedRobot, places: list[int]) -> list[str]:
    """Return the actions and events of a run, with its halts, from its request on."""
    assert debugged.places(*places) == OK
    debugged.events.clear()
    event_count = len(debugged.robot.did)
    debugged.start()
    began_ms, lines, halts = debugged.robot.now_ms, list[str](), 0
    while debugged.robot.now_ms < began_ms + 1500:
        is_halted = False
        for event in debugged.talk(4):
            if event.name in ("SHOW", "HALTED", *END_EVENTS):
                value = getattr(event, "value", getattr(event, "offset", ""))
                lines.append(f"{event.name} {value}")
                is_halted = event.name == "HALTED"
        if is_halted:
            halts += 1
            debugged.go(RESUME_STEP if halts % 3 == 0 else RESUME_GO)
    actions = debugged.robot.did[event_count:]
    while actions and not actions[0].endswith("BEEP 31 1"):
        del actions[0]  # the end of the run before
    rows = (line.split(" ", 1) for line in actions)
    return [*lines, *(f"{int(ms) - began_ms} {value}" for ms, value in rows)]


@pytest.mark.parametrize("seed", range(24))
def test_a_run_after_any_halts_is_as_on_a_fresh_robot(seed: int) -> None:
    rng = random.Random(seed)
    debugged, fresh = DebuggedRobot(NEXT_PROGRAM), DebuggedRobot(NEXT_PROGRAM)
    play_halts(debugged, rng)
    places = rng.sample(statement_starts(debugged.image.code), rng.choice((0, 0, 1, 2)))
    runs = []
    for robot in (fresh, debugged):
        robot.robot.talk(robot.session, -robot.robot.now_ms % 100)
        rows = list_next_run(robot, places)
        runs.append([row for row in rows if "STOPPED" not in row])  # rows of the run before
    assert runs[0] == runs[1] and "SHOW 9000" in runs[0], places


if __name__ == "__main__":
    total = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    counted_count = sum(compare(seed) for seed in range(first, first + total))
    print(
        f"{counted_count} of {total} programs, stepped and from place to place: the same as alone"
    )
