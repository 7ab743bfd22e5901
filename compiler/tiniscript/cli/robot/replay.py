"""Compares a recording with the same run on the virtual robot: `tsc run --replay`."""

from __future__ import annotations

from argparse import Namespace

from tiniscript import robots
from tiniscript.cli import inputs
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot.simulator_options import refusing, world_of
from tiniscript.cli.texts import text
from tiniscript.library.named_robot import name_in
from tiniscript.studio import recordings
from tiniscript.studio.recordings import BadRecording, Parting, Recorded, Recording, read

SAME = ("same", "missed")
# options of `tsc run` that say what the recording says, or the virtual robot
NOT_TAKEN = ("sensor", "seed", "max_time", "max_steps", "machine", "show", "pace")


def replay(options: Namespace, language: str) -> int:
    """Say where a robot and the virtual one part; return the exit code: 1 where they do."""
    for name in NOT_TAKEN:
        if getattr(options, name) not in (None, False, []):
            raise CommandError(2, "replay_only", option="--" + name.replace("_", "-"))
    given = inputs.program(options)
    if given.is_image:
        raise CommandError(2, "replay_text")
    recording = _read(options.replay)
    robot = _robot(options, recording, given.data)
    world = world_of(options, language)
    with refusing(world.name, language):
        parting = recordings.replay(recording, given.data, robot, world)
    print(sentence(parting, language))
    return int(parting.what not in SAME)


def _robot(options: Namespace, recording: Recording, program: bytes) -> str:
    """Return the robot's name: that of the recording, or where it has none, of `--robot`, or what
    the program names."""
    known = robots.names()
    recorded = recording.robot
    named = (options.robot, recorded, name_in(program), robots.DEFAULT)
    name: str = next(name for name in named if name is not None)
    if name not in known:
        raise CommandError(2, "replay_robot", known=", ".join(known))
    if recorded not in (None, name):
        file, of = inputs.shown(options.replay), inputs.shown(str(recorded))
        raise CommandError(2, "replay_other_robot", file=file, of=of, robot=name)
    return name


def _read(name: str) -> Recording:
    try:
        return read(inputs.file(name).data)
    except BadRecording as bad:
        raise CommandError(
            2, f"recording_{bad.reason}", file=inputs.shown(name), line=str(bad.line)
        ) from None


def sentence(parting: Parting, language: str) -> str:
    """Return what a person reads of a comparison."""
    place = text("replay_line" if parting.line else "replay_end", language)
    return text(f"replay_{parting.what}", language).format(
        count=parting.agreed,
        place=place.format(line=parting.line),
        robot=_told(parting.robot, language),
        virtual=_told(parting.virtual, language),
    )


def _told(event: Recorded | None, language: str) -> str:
    if event is None:
        return ""
    what = event.event.removeprefix("SHOW ")
    return text("replay_at", language).format(what=what, seconds=f"{event.ms / 1000:.1f}")
