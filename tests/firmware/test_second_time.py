"""A robot's second action is that of a fresh robot, whatever the first one was.

A random program is stopped, ends, loses its computer or is written over at a random moment, while
somebody holds the button or a wheel, or the supply is low; then comes another, the same way or
another, from the same computer or the next. Its visible effects, on motors, devices and messages to
the computer, are those of a robot switched on for this action. After a stop, no program starts
before it.

`python -m tests.firmware.test_second_time 2000` tries more.
"""

from __future__ import annotations

import random
import re
from collections import Counter
from collections.abc import Callable
from typing import NamedTuple

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.oracle.task_programs import task_program
from tests.support.campaign import each_seed, make_options
from tests.support.images import image_for, image_of
from tests.support.kept_programs import read_saved_state
from tests.support.robot_on_host import computer
from tests.support.small_robot import (
    FIRST_READINGS,
    MARK,
    READINGS,
    SmallRobot,
    draw_program,
    without_readings,
)
from tests.support.text_robot import type_text
from tiniscript import robots
from tiniscript.base.source import Source
from tiniscript.bytecode.image import Image, unpack
from tiniscript.codegen.text.line import line_of
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.requests import OK

KIT = robots.load("tinibot").kit
ESP32 = robots.load("tinibot32")
MARK_ACTIONS = ("BEEP 31 1", "TONE 31")
CLOCKS_MS = (0, 2**16 - 900, 2**31 - 900, 2**32 - 900)  # clock values of a robot at its start
RUN_MS = 600  # observed time of the second program
STOP_MESSAGE = b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))


class Scene:
    """A robot, and the computer that talks to it."""

    def __init__(self, kind: str, clock_ms: int = 0) -> None:
        self.robot = KINDS[kind]()
        if not isinstance(self.robot, Esp32Robot):
            self.robot.clock_ms = clock_ms % 2**32
        self.robot.wait(300)
        self.session = computer()
        self.count = 1
        self.before: int | None = None  # the run whose end is not reported during the second one

    def use_next_computer(self) -> None:
        self.count += 1
        self.session = computer(self.count)

    def open_session(self) -> None:
        assert self.robot.until(self.session, self.session.hello()) == OK


KINDS: dict[str, Callable[[], HostFirmware]] = {
    "a mega": lambda: HostFirmware(KIT),
    "an uno": lambda: SmallRobot(KIT),
    "an esp32": lambda: Esp32Robot(ESP32),
}


PUSH_READ_2, PUSH_SENSOR_2 = bytes((0x92,)), bytes((0x8A,))  # PUSH_READ_2 and PUSH_SENSOR_2
# no earlier instruction in the image reads this sensor
UNREAD_SENSOR_PROGRAM = MARK + "SHOW(DISTANCE);W(0.1)"


def image(text: str) -> Image:
    code = image_of(text, KIT).code
    return unpack(
        image_for(
            code.replace(PUSH_READ_2, PUSH_SENSOR_2) if text == UNREAD_SENSOR_PROGRAM else code, KIT
        )
    )


# Ways to start a program. ----------------------------------------------------------------------


def upload_program(scene: Scene, text: str) -> list[str]:
    scene.open_session()
    upload = scene.session.upload(image(text), saves=False)
    assert scene.robot.until(scene.session, upload) == OK
    return []


def save_program(scene: Scene, text: str) -> list[str]:
    scene.open_session()
    assert scene.robot.until(scene.session, scene.session.upload(image(text))) == OK
    return []


def push_button(scene: Scene, text: str) -> list[str]:
    """The button starts the program that was sent."""
    scene.open_session()
    upload = scene.session.upload(image(text), runs=False, saves=False)
    assert scene.robot.until(scene.session, upload) == OK
    scene.robot.talk(scene.session, 100, flags=1)
    scene.robot.talk(scene.session, 1, flags=2)
    return []


def type_program(scene: Scene, text: str) -> list[str]:
    scene.robot.wait(4000)  # until the computer counts as gone
    return type_text(scene.robot, line_of(Source("SI|" + text)) + "\n", 1)


START_ACTIONS: dict[str, Callable[[Scene, str], list[str]]] = {
    "uploads": upload_program,
    "saves": save_program,
    "pushes": push_button,
    "types": type_program,
}

# Ways to end the first one. ---------------------------------------------------------------------


def lose_computer(scene: Scene) -> None:
    scene.robot.wait(2000)


def stop_by_message(scene: Scene) -> None:
    scene.session.stop(scene.robot.now_ms)
    scene.robot.talk(scene.session, 100)


def break_off_upload(scene: Scene) -> None:
    """The next upload is cut, mostly in its middle, by the next computer."""
    scene.session.upload(image_of("SI|" + "F(0.1, 80); B(0.1, 60);" * 30, KIT))
    scene.robot.talk(scene.session, 3)
    scene.use_next_computer()


END_ACTIONS: dict[str, Callable[[Scene], object]] = {
    "nothing": lambda scene: None,  # the second writes over it
    "zeros": lambda scene: scene.robot.step(bytes(8)),
    "a message": lambda scene: scene.robot.wait(5, STOP_MESSAGE),
    "a line": lambda scene: scene.robot.wait(5, b"\0S\n"),
    "its computer": stop_by_message,
    "the button": lambda scene: scene.robot.push(),
    "the cable": lambda scene: scene.robot.step(flags=8),
    "a stall": lambda scene: scene.robot.step(flags=4),
    "silence": lose_computer,
    "an upload": break_off_upload,
    "a block": lambda scene: type_text(scene.robot, "\nLOOP(2)\n"),
    "a reset": lambda scene: scene.use_next_computer(),
}


# After these, the robot is stopped until the second program.
STOPPING_ENDS = ("zeros", "a message", "a line", "its computer")

# Actions during the first program, and when they end: before the second program, or during it.
ACTIONS_BESIDE: dict[
    str, tuple[Callable[[HostFirmware], object], Callable[[HostFirmware], object]]
] = {
    "nothing": (lambda robot: None, lambda robot: None),
    "the button is down": (lambda robot: robot.step(flags=1), lambda robot: robot.step(flags=2)),
    "a wheel is held": (lambda robot: hold_motors(robot), lambda robot: robot.hold(0)),
    "the supply is low": (lambda it: it.set_supply(True), lambda it: restore_supply(it)),
}


def hold_motors(robot: HostFirmware) -> None:
    robot.hold(1 + robot.now_ms % 2)
    robot.wait(300)


def restore_supply(robot: HostFirmware) -> None:
    """The supply is sufficient: waiting data is saved, if that delays no motor."""
    robot.set_supply(False)
    robot.wait(1500)


class Story(NamedTuple):
    first: str
    begins: str
    runs_ms: int
    ends: str
    waits_ms: int
    is_next: bool  # computer
    second: str
    starts: str
    beside: str = "nothing"
    lasts: bool = False  # into the second


def story(rng: random.Random, starts: str, kind: str) -> Story:
    first, second = draw_program(rng), draw_program(rng)
    if kind == "an esp32":  # a sonar's answer depends on the time of its last ping
        second = without_readings(second)
    elif starts != "types" and rng.random() < 0.1:
        second = UNREAD_SENSOR_PROGRAM
    tale = Story(first, rng.choice([*START_ACTIONS]), rng.choice((1, 30, 100, 300, 900)),
                 rng.choice([*END_ACTIONS]), rng.choice((0, 1, 20, 300)), rng.random() < 0.5,
                 second, starts)  # fmt: skip
    if kind == "an esp32" or rng.random() < 0.5:
        return tale
    beside = rng.choice([*ACTIONS_BESIDE])
    return tale._replace(beside=beside, lasts="button" in beside and rng.random() < 0.5)


def run_second(scene: Scene, tale: Story) -> tuple[list[str], list[str]]:
    """Return the second program's actions, with times from its mark, and the messages heard."""
    robot = scene.robot
    if not isinstance(robot, Esp32Robot):
        robot.set_readings(*READINGS)
    scene.session.events()
    scene.before = scene.session.run
    robot.did.clear()
    heard_lines = START_ACTIONS[tale.starts](scene, tale.second)
    heard_lines += run_and_listen(scene, tale.starts, 40)
    if tale.lasts:
        ACTIONS_BESIDE[tale.beside][1](robot)
    heard_lines += run_and_listen(scene, tale.starts, RUN_MS + 260)
    marks = [k for k, line in enumerate(robot.did) if line.split(" ", 1)[1] in MARK_ACTIONS]
    if not marks:
        return (
            [],
            heard_lines,
        )  # the line is too long for this robot, or another tone covers the mark
    begin_ms = int(robot.did[marks[-1]].split()[0])
    lines = (line.split(" ", 1) for line in robot.did[marks[-1] :])
    actions = [
        f"{int(ms) - begin_ms} {action}" for ms, action in lines if int(ms) <= begin_ms + RUN_MS
    ]
    return actions, heard_lines


def run_and_listen(scene: Scene, begins: str, milliseconds: int) -> list[str]:
    """Run a program that was started like this; return the messages that its computer or person
    hears.
    """
    if begins == "types":
        return scene.robot.wait(milliseconds).decode("latin-1").splitlines()
    scene.robot.talk(scene.session, milliseconds)
    events = scene.session.events()
    if scene.before is not None:
        events = [event for event in events if getattr(event, "run", None) != scene.before]
    return [re.sub(r"run=\d+", "run", str(event)) for event in events]


def robot_after_first(tale: Story, scene: Scene) -> Scene:
    """Return the robot when the first program is over."""
    robot = scene.robot
    if not isinstance(robot, Esp32Robot):
        robot.set_readings(*FIRST_READINGS)
    START_ACTIONS[tale.begins](scene, tale.first)
    run_and_listen(scene, tale.begins, tale.runs_ms)
    begins, is_over = ACTIONS_BESIDE[tale.beside]
    begins(robot)
    END_ACTIONS[tale.ends](scene)
    action_count_before = len(robot.did)
    if tale.waits_ms:
        robot.wait(tale.waits_ms)
    if not tale.lasts:
        is_over(robot)
        robot.wait(30)
    motor_lines = [
        line for line in robot.did[action_count_before:] if not line.endswith(" MOTORS 0 0")
    ]
    assert tale.ends not in STOPPING_ENDS or (robot.is_latched and not motor_lines), (
        f"{tale} {motor_lines}"
    )
    if tale.is_next:
        scene.use_next_computer()
    return scene


# Events of the first program that are still to come: its end, a failed save, or an open block.
FIRST_PROGRAM_EVENTS = (
    "MissedEvent",
    "StartedEvent",
    "// Started again",
    "// The old program is lost.",
)


def without_first_program_events(heard_lines: list[str]) -> list[str]:
    return [line for line in heard_lines if not line.startswith(FIRST_PROGRAM_EVENTS)]


def fitting_story(rng: random.Random, starts: str, kind: str) -> tuple[Story, list[str], list[str]]:
    """Return a story whose second part this robot can begin, and the actions and messages of a
    fresh one."""
    for _ in range(20):
        tale = story(rng, starts, kind)
        expected, expected_words = run_second(Scene(kind), tale)
        if expected:
            return tale, expected, expected_words
    raise AssertionError(f"{kind}: of 20 programs none begins by {starts}")


def check(seed: int, starts: str, kind: str) -> str:
    tale, expected, expected_words = fitting_story(
        random.Random(f"{seed} {starts} {kind}"), starts, kind
    )
    scene = robot_after_first(tale, Scene(kind, random.Random(seed).choice(CLOCKS_MS)))
    goes_on = not scene.robot.is_latched  # until the second program begins
    actions, heard_lines = run_second(scene, tale)
    heard_lines, expected_words = (
        without_first_program_events(heard_lines),
        without_first_program_events(expected_words),
    )
    if tale.beside == "the button is down":
        heard_lines = [line for line in heard_lines if "StoppedEvent(cause=3" not in line]
    if goes_on and heard_lines == ["// Still saving. Send it again."]:
        return "it says why not"  # the saved program drives
    if goes_on:
        heard_lines = heard_lines[max(0, len(heard_lines) - len(expected_words)) :]
    explanation = f"{kind} {tale}\n{actions}\n{heard_lines}\nnot\n{expected}\n{expected_words}"
    assert actions == expected and heard_lines == expected_words, explanation
    return tale.ends


# cases of each start that a commit draws
CASES_PER_PART = {"a mega": 20, "an uno": 10, "an esp32": 3}
PARTS = 20


@pytest.mark.sampled("kind", "part")
@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("starts", START_ACTIONS)
def test_the_second_program_runs_as_on_a_fresh_robot(starts: str, kind: str, part: int) -> None:
    if (kind, starts) == ("an esp32", "pushes"):
        starts = "uploads"  # the button takes longer here; `test_button` covers it
    count = CASES_PER_PART[kind]
    counts = Counter(check(seed, starts, kind) for seed in range(part * count, (part + 1) * count))
    assert counts["it says why not"] <= count / 2, counts


# -- a start that waits for the memory --------------------------------------------------------


def waiting_start() -> tuple[Scene, bytes]:
    """Return a robot whose button is down, and that cannot read its program while it saves."""
    scene = Scene("a mega")
    scene.robot = robot = HostFirmware(KIT, write_ms=12)
    robot.wait(300)
    scene.open_session()
    image = image_of("SI|" + "F(0.1, 80); B(0.1, 60);" * 30, KIT)
    assert robot.until(scene.session, scene.session.upload(image)) == OK
    while read_saved_state(robot, scene.session) != "STORED":
        robot.talk(scene.session, 100)
    scene.session.stop(robot.now_ms)
    robot.talk(scene.session, 100)
    break_off_upload(scene)  # the robot holds the saved program
    scene.open_session()
    scene.session.name(b"Pia")
    robot.talk(scene.session, 15)  # saving takes longer
    robot.step(flags=1)
    robot.codes()
    return scene, image.code


def test_a_start_by_the_button_happens_once() -> None:
    scene, code = waiting_start()
    robot = scene.robot
    robot.step(flags=2)
    assert robot.codes() == []  # the robot waits
    robot.wait(100)
    assert robot.codes() == [code]
    robot.wait(3000)
    robot.push()  # a stop
    assert robot.codes() == []


@pytest.mark.parametrize("ending", STOPPING_ENDS)
def test_a_pending_button_start_is_cancelled_by_a_stop(ending: str) -> None:
    scene, _ = waiting_start()
    scene.robot.step(flags=2)
    END_ACTIONS[ending](scene)
    scene.robot.wait(500)
    assert scene.robot.codes() == [] and scene.robot.is_latched


def test_a_pending_button_start_is_cancelled_by_another_program() -> None:
    scene, _ = waiting_start()
    robot = scene.robot
    other_code = image_of("SI|B(60, 40)", KIT).code
    scene.use_next_computer()
    scene.open_session()
    request = scene.session.live(other_code)
    robot.talk(scene.session, 1, flags=2)
    assert robot.until(scene.session, request) == OK
    robot.talk(scene.session, 500)
    assert robot.codes() == [other_code] and not robot.is_latched


# -- with discs -------------------------------------------------------------------------------

EDGES = (32_673, 277_333)  # edges on the discs of a tinibot2
EDGE_TOLERANCE, ROLLING_EDGE_TOLERANCE = 2.5, 9.0  # the latter from a move whose wheels still roll
TIME_TOLERANCE_MS = 400


def with_discs() -> Scene:
    scene = Scene("a mega")
    scene.robot.mount_discs(*EDGES)
    return scene


def ways(rng: random.Random, max_way_count: int) -> str:
    """Return moves by centimetres and degrees, which do the same at any position of the discs."""
    moves = [f"{rng.choice('FB')}({rng.choice((5, 12, 30, 60))} CM, {rng.choice((40, 60, 100))})"
             for _ in range(rng.randint(1, max_way_count))]  # fmt: skip
    moves.insert(rng.randrange(len(moves) + 1), f"R({rng.choice((45, 90))} DEG, 60)")
    return MARK + ";".join(moves)


def quiet(rng: random.Random) -> str:
    """Return a program without measurements."""
    return MARK + rng.choice(("W(2)", "S;W(1);SHOW(1)", "M(20, 20);W(0.3);M(0, 0)", "F(0.5, 50)"))


def drive(scene: Scene, starts: str, text: str) -> tuple[list[str], int, float, float]:
    """Return a program's actions, their duration, and the distance of the wheels."""
    robot = scene.robot
    robot.did.clear()
    left, right = robot.wheel_edges()
    START_ACTIONS[starts](scene, text)
    rows: list[list[str]] = []
    while not rows or rows[-1][1] not in ("FINISHED", "FAULTED"):
        run_and_listen(scene, starts, 100)
        events = [line.split(" ", 1) for line in robot.did]
        marks = [k for k, row in enumerate(events) if row[1] in MARK_ACTIONS]
        rows = events[marks[-1] :] if marks else []
        assert robot.now_ms < 120_000, text
    run_and_listen(scene, starts, 700)  # until its wheels stop
    duration_ms = int(rows[-1][0]) - int(rows[0][0])
    left_mm, right_mm = robot.wheel_edges()
    return [action for _, action in rows], duration_ms, left_mm - left, right_mm - right


def is_standing(robot: HostFirmware) -> bool:
    wheel_edges_before = robot.wheel_edges()
    robot.wait(50)
    return all(
        abs(a - b) < 0.05 for a, b in zip(wheel_edges_before, robot.wheel_edges(), strict=True)
    )


def check_ways(seed: int) -> str:
    rng = random.Random(seed)
    tale = story(rng, rng.choice([*START_ACTIONS]), "a mega")
    first = rng.choice((tale.first, ways(rng, 4), task_program(rng, ways=True)[0], "F(60 CM, 60)"))
    tale = tale._replace(
        first=MARK + first,
        second=rng.choice((ways(rng, 2), quiet(rng))),
        runs_ms=rng.choice((1, 200, 700, 2500)),
        waits_ms=rng.choice((0, 20, 300, 800, 1500)),
    )
    scene = robot_after_first(tale, with_discs())
    is_over, stood = scene.robot.is_latched, is_standing(scene.robot)
    actions, duration_ms, *distances_cm = drive(scene, tale.starts, tale.second)
    expected, end_ms, *distances = drive(with_discs(), tale.starts, tale.second)
    explanation = (
        f"{tale}\n{actions} {duration_ms} {distances_cm}\nnot\n{expected} {end_ms} {distances}"
    )
    assert actions == expected and abs(duration_ms - end_ms) < TIME_TOLERANCE_MS * len(expected), (
        explanation
    )
    if is_over:
        tolerance = EDGE_TOLERANCE if stood else ROLLING_EDGE_TOLERANCE
        assert all(abs(a - b) < tolerance for a, b in zip(distances_cm, distances, strict=True)), (
            explanation
        )
    return "from a run" if not is_over else "from where it stood" if stood else "from a move"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(PARTS))
def test_measured_moves_after_any_history_are_as_on_a_fresh_robot(part: int) -> None:
    counts = Counter(check_ways(seed) for seed in range(part * 60, (part + 1) * 60))
    assert counts["from where it stood"] > 20 and counts["from a move"] > 0, counts


def find_max_lead_mm(scene: Scene) -> float:
    """Return the greatest lead of one wheel over the other in a straight move."""
    robot = scene.robot
    upload_program(scene, "F(60 CM, 60)")
    left, right = robot.wheel_edges()
    max_lead_mm = 0.0
    for _ in range(60):
        robot.talk(scene.session, 20)
        left_mm, right_mm = robot.wheel_edges()
        max_lead_mm = max(max_lead_mm, abs(left_mm - left - right_mm + right))
    return max_lead_mm


@pytest.mark.parametrize("wheels", [1, 2])
def test_the_next_program_does_not_make_up_for_a_held_wheel(wheels: int) -> None:
    assert find_max_lead_mm(with_discs()) < 0.01
    scene = with_discs()
    upload_program(scene, "F(60 CM, 60)")
    scene.robot.talk(scene.session, 300)
    scene.robot.hold(wheels)
    scene.robot.talk(scene.session, 420)
    scene.robot.hold(0)
    END_ACTIONS["zeros"](scene)
    scene.robot.wait(2000)
    scene.use_next_computer()
    assert find_max_lead_mm(scene) < 0.15


def ends_of_move(scene: Scene, wheels: int, from_edges: float) -> tuple[float, ...]:
    """Return the distances of the wheels in a move; some are blocked briefly at a distance of the
    left one.
    """
    robot = scene.robot
    wheel_edges_before = robot.wheel_edges()
    robot.did.clear()
    upload_program(scene, "F(12 CM, 60)")
    held_ms = 0
    while not robot.did[-1].endswith("FINISHED"):
        if robot.wheel_edges()[0] - wheel_edges_before[0] > from_edges:
            held_ms += 1
        robot.hold(wheels if 0 < held_ms < 200 else 0)
        robot.talk(scene.session, 1)
        assert robot.now_ms < 60_000
    robot.hold(0)
    robot.talk(scene.session, 700)
    return tuple(
        after - earlier
        for after, earlier in zip(robot.wheel_edges(), wheel_edges_before, strict=True)
    )


@pytest.mark.parametrize("wheels", [1, 2, 3])
def test_each_move_is_corrected_after_any_number_of_corrections(wheels: int) -> None:
    way, _ = ends_of_move(with_discs(), 0, 0)
    scene = with_discs()
    for _ in range(6):
        end_distances = ends_of_move(scene, wheels, way - 2)
        assert all(abs(end - way) < 1.5 for end in end_distances), end_distances
        scene.robot.wait(300)


@pytest.mark.parametrize("is_typed", [True, False])
@pytest.mark.parametrize("first", ["W(0.05)", "F(60, 40)"])
def test_a_detached_run_continues_after_an_attached_one(first: str, is_typed: bool) -> None:
    scene = Scene("a mega")
    robot = scene.robot
    upload_program(scene, first)
    robot.talk(scene.session, 300)
    if is_typed:
        robot.wait(4200)  # until no client counts as heard
        robot.wait(300, b"SI|F(5, 50)\r\n")
    else:
        image = image_of("SI|F(5, 50)", KIT)
        upload = scene.session.upload(image, saves=False, is_detached=True)
        assert robot.until(scene.session, upload) == OK
    robot.wait(3000)
    assert not robot.is_latched


def check_all(seed: int) -> str:
    for starts in START_ACTIONS:
        check(seed, starts, [*KINDS][seed % len(KINDS)])
    return check_ways(seed)


if __name__ == "__main__":
    each_seed(check_all, make_options(2000, 10_000))
