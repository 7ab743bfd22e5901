"""`tsc run --record FILE`: a run on the virtual robot, and its file; `tsc run FILE` plays it."""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

from tiniscript import robots
from tiniscript.bytecode.image import pack
from tiniscript.cli import images, inputs, outputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.faults import fault_text
from tiniscript.cli.inputs import Input
from tiniscript.cli.options import sensor_lists, thousandths, whole_number
from tiniscript.cli.robot.simulator_options import convert_refusal, world_of
from tiniscript.cli.texts import text
from tiniscript.robots.profile import Robot
from tiniscript.studio import recordings
from tiniscript.studio.playing import (
    SAME_OUTCOMES,
    STEP_MS,
    Divergence,
    PlayableRecording,
    PlayedRun,
    prepare,
)
from tiniscript.studio.recordings import MAX_MS, VIRTUAL, BadRecording, Row
from tiniscript.studio.simulation import Simulation
from tiniscript.virtual.robot import Settings

# options of `tsc run` that are not for the virtual robot, and those that a recorded run has in it
UNRECORDED_OPTIONS = ("max_steps", "machine", "show", "pace")
UNPLAYED_OPTIONS = ("sensor", "seed", "max_time", "robot", "record", *UNRECORDED_OPTIONS)
LONGEST_RUN_MS = 60_000


def refuse_options(options: Namespace, names: tuple[str, ...], key: str) -> None:
    """Raise CommandError with the sentence `key` where one of these options is there."""
    for name in names:
        if getattr(options, name) not in (None, False, []):
            raise CommandError(2, key, option="--" + name.replace("_", "-"))


def require_known_robot(robot: Robot) -> None:
    """Raise CommandError if nobody else could play a run of this robot."""
    if robot.name not in robots.names() or robots.load(robot.name).kit != robot.kit:
        raise CommandError(2, "record_robot", known=", ".join(robots.names()))


def source_text(program_input: Input) -> str:
    """Return the text of a program, for the file of its run. Raises CommandError for an image."""
    if program_input.is_image:
        raise CommandError(2, "record_text")
    return program_input.data.decode("utf-8", "replace")


def record(program_input: Input, options: Namespace, language: str) -> int:
    """Run a program on the virtual robot, print its trace, and write the file of the run."""
    refuse_options(options, UNRECORDED_OPTIONS, "record_only")
    source = source_text(program_input)
    robot = inputs.robot_for(program_input, options, language)
    require_known_robot(robot)
    max_ms = thousandths("--max-time", options.max_time, LONGEST_RUN_MS, 0, MAX_MS, language)
    seed = whole_number("--seed", options.seed, 1, 1, 2**32 - 1, language)
    message = sensor_lists(options.sensor, robot, language)
    world, form = recordings.stored_form(world_of(options, language))
    result = images.ready_program(program_input, robot, language, is_strict=True)
    if result is None:
        return 1
    image = result.image
    data = pack(image.start, image.devices, image.code, image.later_fields, image.needs)
    with convert_refusal(world.name, language):
        run = Simulation(
            robot.name, world, data, settings=Settings(seed=seed, given_readings=message)
        )
    if image.start == "SB":
        run.push()
    started_ms = run.robot.started_ms or 0
    while run.robot.now_ms < started_ms + max_ms and not run.is_full:
        run.advance(min(STEP_MS, started_ms + max_ms - run.robot.now_ms))
        if not run.robot.is_running and run.robot.started_ms is not None:
            break
    rows, fault, fault_at = run.rows(), run.robot.fault, run.fault_at
    end_ms = rows[-1].ms if run.is_full and rows else run.robot.now_ms
    run.close()
    _print(rows, started_ms)
    head = recordings.header_line(
        VIRTUAL, source, robot, image.checksum, world=form, seed=seed, given_readings=message
    )
    recording = recordings.encode(head, rows, end_ms)
    outputs.write(Path(options.record), recording.encode(), "unwritable_more --record")
    if fault:
        text = fault_text(
            fault, fault_at or 0, result.program_map, program_input.is_image, language
        )
        print(text, file=sys.stderr)
    return int(bool(fault))


def play(program_input: Input, options: Namespace, language: str) -> int:
    """Play the file of a run again; return the exit code: 1 where it is another run then."""
    refuse_options(options, UNPLAYED_OPTIONS, "play_only")
    run = _read(program_input)
    if options.world is not None and run.recording.is_virtual:
        raise CommandError(2, "play_only", option="--world")
    world = run.recording.world or world_of(options, language)
    with convert_refusal(world.name, language):
        played_run = PlayedRun(run, world)
    while not played_run.is_over:
        played_run.advance(STEP_MS)
    started_ms = played_run.robot.started_ms or 0
    _print(played_run.rows(), started_ms)
    played_run.close()
    sys.stdout.flush()
    divergence = played_run.divergence or Divergence("empty")
    print(
        sentence(divergence, started_ms if run.recording.is_virtual else 0, language),
        file=sys.stderr,
    )
    return int(divergence.outcome not in SAME_OUTCOMES)


def _read(program_input: Input) -> PlayableRecording:
    try:
        return prepare(recordings.decode(program_input.data))
    except BadRecording as error:
        values = {"file": inputs.printable_name(program_input.name), "line": str(error.line)}
        raise CommandError(2, f"recording_{error.reason}", **values) from None


def _print(rows: list[Row], started_ms: int) -> None:
    for row in rows:
        sys.stdout.write(f"{row.ms - started_ms} {row.event}\n")


def sentence(divergence: Divergence, started_ms: int, language: str) -> str:
    """Return the sentence about a comparison; times count from `started_ms`."""
    place = text("replay_line" if divergence.line else "replay_end", language)
    return text(f"replay_{divergence.outcome}", language).format(
        count=divergence.agreed,
        place=place.format(line=divergence.line),
        robot=_row_text(divergence.robot, started_ms, language),
        virtual=_row_text(divergence.virtual, started_ms, language),
        sensor=divergence.sensor,
    )


def _row_text(row: Row | None, started_ms: int, language: str) -> str:
    if row is None:
        return text("replay_nothing", language)
    event = row.event.removeprefix("SHOW ")
    seconds = f"{(row.ms - started_ms) / 1000:.1f}"
    return text("replay_at", language).format(what=event, seconds=seconds)
