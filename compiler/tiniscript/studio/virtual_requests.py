"""Requests of the page about the virtual robot, worlds and lessons; the worker loads them on
demand.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from typing import Any

from tiniscript.robots import decode_profile
from tiniscript.robots.kinematics import Pose
from tiniscript.robots.profile import ProfileRefused
from tiniscript.robots.refusals import describe
from tiniscript.studio import checking, playing, recordings
from tiniscript.studio.simulation import Marks, Simulation
from tiniscript.studio.world_form import form_of, toml_of
from tiniscript.virtual import worlds
from tiniscript.virtual.bout import driving_in
from tiniscript.virtual.world import World, WorldRefused
from tiniscript.virtual.worlds import read as read_world

Json = dict[str, Any]

_simulation: Simulation | None = None  # a page has one robot
_opened_run: playing.PlayableRecording | None = None  # the recorded run that was opened last


def _world(description: Any) -> World:
    """Return a world: a shipped one's name, a form, or the number and the seed of one of a lesson.

    Raises WorldRefused.
    """
    if isinstance(description, str):
        assert description in worlds.names(), description
        return worlds.load(description)
    if "form" in description:
        return read_world(toml_of(description["form"]), "")
    world: World = _lessons().varied_world(description["lesson"], description["seed"])
    return recordings.stored_form(world)[0]


def _begin(fields: Json, world: World, image: bytes, marks: Marks) -> Simulation:
    if pose := fields.get("pose"):
        with suppress(WorldRefused):  # an obstacle is there, or it has crashed
            return Simulation(fields["robot"], world._replace(start=Pose(*pose)), image, marks)
    return Simulation(fields["robot"], world, image, marks)


def _power_on(fields: Json, data: bytes) -> Json:
    """Switch the virtual robot on in `world`: a shipped one's name, a form, or one of a lesson.

    With `is_held`, it halts before the program's first part. A world of a lesson with an `until_ms`
    brings the run that was judged there, up to then. With a `pose`, it starts there if there is
    room, instead of at the usual start.
    """
    global _simulation
    if _simulation is not None:
        _simulation.close()
        _simulation = None
    description = fields["world"]
    try:
        marks = Marks(tuple(fields.get("parts", ())), tuple(fields.get("breakpoints", ())),
                      fields.get("variables", 0), fields.get("is_held", False))  # fmt: skip
        if fields.get("plays"):
            assert _opened_run is not None, "no run was opened"
            beside_world = None if _opened_run.recording.is_virtual else _world(description)
            _simulation = playing.PlayedRun(_opened_run, beside_world, marks)
        elif "until_ms" in description:
            run_arguments = (
                fields["robot"],
                description["lesson"],
                description["seed"],
                description["until_ms"],
            )
            _simulation = _lessons().JudgedRun(*run_arguments, data, marks)
        else:
            _simulation = _begin(fields, _world(description), data, marks)
    except WorldRefused as refusal:
        return {"refused": describe(refusal, fields["language"])}
    assert _simulation is not None
    return _simulation.state()


def _driving_request(
    act: Callable[[Simulation, Json], object],
) -> Callable[[Json, bytes], Json]:
    """Return a handler that applies `act` to the virtual robot, and answers with its state.

    `held` is what somebody holds of a remote control meanwhile.
    """

    def answer(fields: Json, data: bytes) -> Json:
        assert _simulation is not None, "nothing is switched on"
        if "held" in fields:
            _simulation.press(*fields["held"])
        act(_simulation, fields)
        return _simulation.state()

    return answer


def _open_world(fields: Json, data: bytes) -> Json:
    """Return the form of a world's file, `data`, or why it is none."""
    name = fields["name"]
    try:
        world = read_world(decode_profile(data, name), name.removesuffix(".toml"))
        return {"world": form_of(world)}
    except ProfileRefused as refusal:
        return {"refused": describe(WorldRefused(*refusal.reasons), fields["language"])}


def _write_world(fields: Json, data: bytes) -> Json:
    """Return the text of a form, and whether the robot fits at its start, or why it is no world."""
    text = toml_of(fields["form"])
    try:
        world = read_world(text, "")
    except WorldRefused as refusal:
        return {"refused": describe(refusal, fields["language"])}
    body = checking.profile_of(fields["robot"]).body
    return {"text": text, "is_blocked": driving_in(body, world).is_blocked()}


def _open_run(fields: Json, data: bytes) -> Json:
    """Return the data for playing a run's file, `data`, or the reason why it cannot be played."""
    global _opened_run
    try:
        _opened_run = playing.prepare(recordings.decode(data))
    except recordings.BadRecording as error:
        return {"what": error.reason, "line": error.line}
    recording = _opened_run.recording
    world: Any = None
    world_shapes = None
    if recording.world is not None:
        world_shapes = form_of(recording.world)
        world = (
            recording.world.name
            if recording.world.name in worlds.names()
            else {"form": world_shapes}
        )
    return {
        "of": recording.robot_kind,
        "text": recording.text,
        "robot": recording.robot,
        "world": world,
        "shapes": world_shapes,
        "rows": [row.cells for row in recording.rows],
        "end_ms": recording.end_ms,
        "is_by_button": recording.was_started_by_button,
    }


def _write_run(fields: Json, data: bytes) -> Json:
    """Return the file of a run that the page has kept."""
    robot = checking.profile_of(fields["robot"])
    rows = recordings.from_rows(fields["rows"])
    world = (
        recordings.stored_form(_world(fields["world"]))[1]
        if fields["of"] == recordings.VIRTUAL
        else None
    )
    was_started_by_button = fields.get("is_by_button", False)
    header = recordings.header_line(fields["of"], fields["text"], robot, int(fields["program"], 16),
                            world=world, was_started_by_button=was_started_by_button)  # fmt: skip
    return {"file": recordings.encode(header, rows, fields["end_ms"])}


_lesson_check_now: Any = None  # the one that continues


def _lessons() -> Any:
    """Return the lessons, which the page has fetched meanwhile; its first archive lacks them."""
    sys.path_importer_cache.clear()
    return import_module("tiniscript.studio.page_lessons")


def _lesson_world(fields: Json, data: bytes) -> Json:
    arguments = (fields["number"], fields["seed"])
    return {"world": _lessons().world_form(*arguments), "goals": _lessons().goal_shapes(*arguments)}


def _lesson_check(fields: Json, data: bytes) -> Json:
    global _lesson_check_now
    _lesson_check_now = _lessons().LessonCheck(fields["number"], data, fields["language"])
    return {}


HANDLERS: dict[str, Callable[[Json, bytes], Json]] = {
    "power_on": _power_on,
    "go": _driving_request(lambda robot, fields: robot.advance(fields["duration_ms"])),
    "step": _driving_request(lambda robot, fields: robot.step(fields["limit_ms"])),
    "go_on": _driving_request(lambda robot, fields: robot.go_on()),
    "breakpoints": _driving_request(
        lambda robot, fields: robot.set_breakpoints(fields["breakpoints"])
    ),
    "stop": _driving_request(lambda robot, fields: robot.stop()),
    "push": _driving_request(lambda robot, fields: robot.push()),
    "open_world": _open_world,
    "write_world": _write_world,
    "open_run": _open_run,
    "write_run": _write_run,
    "lesson_titles": lambda fields, data: {"lessons": _lessons().titles(fields["language"])},
    "lesson_steps": lambda fields, data: {
        "steps": _lessons().steps(fields["number"], fields["language"]),
        "block_steps": _lessons().steps(fields["number"], fields["language"], "blocks"),
        "offered": _lessons().offered_kinds(fields["number"], fields["language"]),
        "needed": _lessons().needed_kinds(fields["number"], fields["language"]),
        "new": _lessons().new_pieces(fields["number"], fields["language"]),
        "spoken": _lessons().spoken_blocks(fields["number"], fields["language"]),
    },
    "lesson_world": _lesson_world,
    "lesson_check": _lesson_check,
    "lesson_go": lambda fields, data: _lesson_check_now.advance(fields["most_ms"]),
}
