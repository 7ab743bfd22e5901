"""Random runs of the virtual robot, with tasks, ways, DEFs with values, keys, pushes of the button,
and stops: played again, not one event differs. A program that goes on from a breakpoint may do what
follows within a millisecond an eighth of one later, so one that is held is stopped there.

`python -m tests.studio.runs_again 1000` tries so many.
"""

from __future__ import annotations

import random
import sys

from tests.oracle.task_programs import TaskAuthor
from tiniscript import robots
from tiniscript.bytecode.image import checksum, unpack
from tiniscript.bytecode.statements import statement_starts
from tiniscript.library.compiling import compile_source, fit_to_robot
from tiniscript.studio.playing import play, prepare
from tiniscript.studio.recordings import VIRTUAL, Row, decode, encode, header_line
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import Settings

ROBOTS = ("tinibot", "tinibot2", "tinibot32", "grabber")  # an Uno, discs, an ESP32, a Mega


def record_run(number: int, is_held: bool = False) -> tuple[bytes, list[Row]]:
    """Return the file of a random run, and its events without a person's inputs.

    A run that `is_held` ends at a breakpoint, if it reaches one.
    """
    rng = random.Random(number)
    while True:
        profile = robots.load(rng.choice(ROBOTS))
        text = rng.choice(("", "SB|")) + TaskAuthor(rng, ways=rng.random() < 0.7).program()
        compilation = compile_source(text.encode(), profile, "", is_strict=True, is_chosen=True)
        compilation = fit_to_robot(compilation, profile)
        if compilation.image:
            break
    world = rng.choice(worlds.names())
    recorded_readings = {0: [rng.randrange(2, 100) * 1000, 1000]} if rng.random() < 0.3 else {}
    if profile.kit.sensors[0].is_yes_no:
        recorded_readings = {}
    settings = Settings(seed=number + 1, given_readings=recorded_readings)
    run = Simulation(profile.name, worlds.load(world), compilation.image, settings=settings)
    code = unpack(compilation.image).code
    if is_held:
        run.set_breakpoints([rng.choice(statement_starts(code)[1:] or [0])])
    for _ in range(rng.randint(1, 25)):
        _act(rng, run)
    if run.held_at is not None or rng.random() < 0.3:
        run.stop()
        if rng.random() < 0.5:
            run.advance(rng.randint(0, 30))
    rows, end_ms = run.rows(), run.robot.now_ms
    run.close()
    header = header_line(VIRTUAL, text, profile, checksum(compilation.image), world=world,
                        seed=number + 1, given_readings=recorded_readings)  # fmt: skip
    output_rows = [row for row in rows if not row.is_input]
    return encode(header, rows, end_ms).encode(), output_rows


def _act(rng: random.Random, run: Simulation) -> None:
    if rng.random() < 0.4:
        run.press(rng.randrange(64), rng.choice((0, -100, 40)), rng.choice((0, 7)))
    if rng.random() < 0.15:
        run.push()
    run.advance(rng.randint(0, 200))


def replay_difference(number: int, is_held: bool = False) -> str | None:
    """Return the difference between a random run and its replay, or None."""
    data, rows = record_run(number, is_held)
    played_run = play(prepare(decode(data)))
    replayed_rows = [row for row in played_run.rows() if not row.is_input]
    parting = played_run.divergence
    played_run.close()
    if parting is None or parting.outcome != "again" or parting.agreed != len(rows):
        return f"{parting}\n{data.decode()}"
    return None if replayed_rows[: len(rows)] == rows else f"{replayed_rows}\n{data.decode()}"


if __name__ == "__main__":
    count = int(sys.argv[1])
    events = 0
    for round_number in range(count):
        wrong = replay_difference(round_number)
        if wrong is not None:
            sys.exit(f"run {round_number}: {wrong}")
        if round_number % 100 == 99:
            print(f"{round_number + 1} runs", flush=True)
