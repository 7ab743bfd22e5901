"""What the page calls: requests and answers are JSON.

Knows the form of both. Runs in Pyodide, in a worker; knows nothing of a browser.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

from tiniscript.bytecode.image import checksum
from tiniscript.diagnostics.rendering import Message
from tiniscript.robots import decoded
from tiniscript.robots.profile import ProfileRefused
from tiniscript.studio import checking
from tiniscript.studio.block_form import data_of, from_data, size_of
from tiniscript.studio.block_printing import print_blocks
from tiniscript.studio.block_reading import read

if TYPE_CHECKING:
    from tiniscript.studio.page_line import PageRobot
    from tiniscript.studio.simulation import Simulation
    from tiniscript.virtual.world import World

Answer = dict[str, Any]
MOST_BLOCKS = 1500  # that a page can move about


def answer(request: str, data: bytes = b"") -> str:
    """Return the answer to a request; `data` is a program's text or file."""
    fields = json.loads(request)
    return json.dumps(_ASKED[fields["do"]](fields, data), ensure_ascii=False)


def _check(fields: Answer, data: bytes) -> Answer:
    found = checking.check(data, fields["robot"], fields["language"])
    return {
        "image": found.image.hex(),
        "program": f"{checksum(found.image):08x}" if found.image else "",
        "bytes": found.code_bytes,
        "findings": [
            {**each.message._asdict(), "repair": [change._asdict() for change in each.repair]}
            for each in found.findings
        ],
        "places": found.places,
        "variables": [each._asdict() for each in found.variables],
        "start": found.start,
    }


def _open(fields: Answer, data: bytes) -> Answer:
    found = checking.opened(data, fields["robot"], fields["language"])
    if isinstance(found, Message):
        return {"message": found.message, "fix": found.fix}
    return {"text": found}


def _line(fields: Answer, data: bytes) -> Answer:
    found = checking.line(data, fields["robot"], fields["language"])
    if isinstance(found, Message):
        return {"message": found.message, "fix": found.fix}
    return {"text": found}


def _blocks(fields: Answer, data: bytes) -> Answer:
    """Return the blocks of the editor's text; of one with too many only their number."""
    form = read(data.decode(), checking.profile_of(fields["robot"]).kit)
    size = size_of(form)
    return {"size": size} if size > MOST_BLOCKS else {"size": size, **data_of(form)}


def _text(fields: Answer, data: bytes) -> Answer:
    return print_blocks(from_data(fields["form"]))._asdict()


_simulation: Simulation | None = None  # a page has one robot


def _world(where: Any) -> World:
    """Return a world: a shipped one's name, a form, or the number and the seed of one of a lesson.

    Raises WorldRefused.
    """
    from tiniscript.studio.world_form import toml_of
    from tiniscript.virtual import worlds
    from tiniscript.virtual.worlds import read as read_world

    if isinstance(where, str):
        assert where in worlds.names(), where
        return worlds.load(where)
    if "form" in where:
        return read_world(toml_of(where["form"]), "")
    found: World = _lessons().world(where["lesson"], where["seed"])
    return found


def _power_on(fields: Answer, data: bytes) -> Answer:
    """Switch the virtual robot on in `world`: a shipped one's name, a form, or one of a lesson.

    With `is_held` it stands in front of the program's first part.
    """
    from tiniscript.studio.simulation import Marks, Simulation
    from tiniscript.virtual.world import WorldRefused, describe

    global _simulation
    if _simulation is not None:
        _simulation.close()
        _simulation = None
    try:
        world = _world(fields["world"])
        marks = Marks(tuple(fields.get("parts", ())), tuple(fields.get("breakpoints", ())),
                      fields.get("variables", 0), fields.get("is_held", False))  # fmt: skip
        _simulation = Simulation(fields["robot"], world, data, marks)
    except WorldRefused as refused:
        return {"refused": describe(refused, fields["language"])}
    return _simulation.state()


def _go(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.go(fields["duration_ms"])
    return _simulation.state()


def _step(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.step(fields["limit_ms"])
    return _simulation.state()


def _go_on(fields: Answer, data: bytes) -> Answer:
    """Let a held program go on, as soon as time does."""
    assert _simulation is not None, "nothing is switched on"
    _simulation.go_on()
    return _simulation.state()


def _breakpoints(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.set_breakpoints(fields["breakpoints"])
    return _simulation.state()


def _stop(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.stop()
    return _simulation.state()


def _push(fields: Answer, data: bytes) -> Answer:
    assert _simulation is not None, "nothing is switched on"
    _simulation.push()
    return _simulation.state()


def _open_world(fields: Answer, data: bytes) -> Answer:
    """Return the form of a world's file, `data`, or why it is none."""
    from tiniscript.studio.world_form import form_of
    from tiniscript.virtual.world import WorldRefused, describe
    from tiniscript.virtual.worlds import read as read_world

    name = fields["name"]
    try:
        world = read_world(decoded(data, name), name.removesuffix(".toml"))
        return {"world": form_of(world)}
    except ProfileRefused as refused:
        return {"refused": describe(WorldRefused(*refused.reasons), fields["language"])}


def _write_world(fields: Answer, data: bytes) -> Answer:
    """Return the text of a form, and whether the robot fits at its start, or why it is no world."""
    from tiniscript.studio.world_form import toml_of
    from tiniscript.virtual.driving import Driving
    from tiniscript.virtual.world import WorldRefused, describe
    from tiniscript.virtual.worlds import read as read_world

    text = toml_of(fields["form"])
    try:
        world = read_world(text, "")
    except WorldRefused as refused:
        return {"refused": describe(refused, fields["language"])}
    body = checking.profile_of(fields["robot"]).body
    return {"text": text, "is_blocked": Driving(body, world.obstacles(), world.start).is_blocked()}


def _replay(fields: Answer, data: bytes) -> Answer:
    """Compare a recording, `data`, with the same run of the program `text` on a virtual robot."""
    from tiniscript.studio import recordings
    from tiniscript.virtual.world import WorldRefused, describe

    try:
        recording = recordings.read(data)
        found = recordings.replay(
            recording, fields["text"].encode(), fields["robot"], _world(fields["world"])
        )
    except recordings.BadRecording as bad:
        return {"what": bad.reason, "line": bad.line}
    except WorldRefused as refused:
        return {"what": "refused", "said": " ".join(describe(refused, fields["language"]))}
    robot, virtual = (each and each._asdict() for each in (found.robot, found.virtual))
    return {**found._asdict(), "robot": robot, "virtual": virtual}


_robot: PageRobot | None = None  # a page has one of these, too


def _connect(fields: Answer, data: bytes) -> Answer:
    """Begin a session over what the page has opened; `data` is the file of its keys, or nothing."""
    from tiniscript.studio.page_line import BadKeys, PageKeys, PageRobot

    global _robot
    try:
        keys = PageKeys(data)
    except BadKeys:
        keys = PageKeys(b"")
    _robot = PageRobot(fields["robot"], fields["language"], keys)
    return {}


def _link(fields: Answer, data: bytes) -> Answer:
    """Go on with the session; `data` has arrived."""
    assert _robot is not None, "no robot is connected"
    return _robot.go(data, fields["now_ms"], fields["asked"])


def _import_keys(fields: Answer, data: bytes) -> Answer:
    """Add the keys of a file, `data`, to those of the page, whose file is `kept`."""
    from tiniscript.studio.page_line import BadKeys, PageKeys

    try:
        keys = PageKeys(fields["kept"].encode()) if _robot is None else _robot.keys
        count = keys.add(data)
    except BadKeys:
        return {"count": None}
    return {"count": count, "keys": keys.file()}


_check_of_lesson: Any = None  # the one that goes on


def _lessons() -> Any:
    """Return the lessons, which the page has fetched meanwhile; its first archive lacks them."""
    sys.path_importer_cache.clear()
    return import_module("tiniscript.studio.page_lessons")


def _lesson_titles(fields: Answer, data: bytes) -> Answer:
    return {"lessons": _lessons().titles(fields["language"])}


def _lesson_page(fields: Answer, data: bytes) -> Answer:
    return {"blocks": _lessons().page(fields["number"], fields["language"])}


def _lesson_world(fields: Answer, data: bytes) -> Answer:
    return {"world": _lessons().world_form(fields["number"], fields["seed"])}


def _lesson_check(fields: Answer, data: bytes) -> Answer:
    global _check_of_lesson
    _check_of_lesson = _lessons().Check(fields["number"], data, fields["language"])
    return {}


def _lesson_go(fields: Answer, data: bytes) -> Answer:
    found: Answer = _check_of_lesson.go(fields["most_ms"])
    return found


_ASKED: dict[str, Callable[[Answer, bytes], Answer]] = {
    "check": _check, "open": _open, "line": _line, "blocks": _blocks, "text": _text,
    "power_on": _power_on, "go": _go, "step": _step, "go_on": _go_on, "breakpoints": _breakpoints,
    "stop": _stop, "push": _push, "open_world": _open_world, "write_world": _write_world,
    "replay": _replay,
    "lesson_titles": _lesson_titles, "lesson_page": _lesson_page, "lesson_world": _lesson_world,
    "lesson_check": _lesson_check, "lesson_go": _lesson_go,
    "connect": _connect, "link": _link, "import_keys": _import_keys,
}  # fmt: skip
