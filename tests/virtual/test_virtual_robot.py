"""The virtual robot without a clock: its firmware, its world and a computer, in its own time."""

from __future__ import annotations

from itertools import pairwise
from random import Random

import pytest

from tests.support.casefile import ROOT
from tests.support.command import OBSTACLE
from tests.support.owners import Keys
from tests.support.virtual_robot import Talk, floor, robot_in, trace
from tiniscript import compile_text, robots
from tiniscript.base.trace import Ending, Senses
from tiniscript.bytecode.image import pack, unpack
from tiniscript.link.authority import OWNED_BY_OTHER, OWNED_BY_YOU, ownership_of
from tiniscript.link.messages import (
    KEY_OWNER,
    LARGE_FRAME,
    LARGE_WINDOW,
    SAVED_STORED,
    SMALL_FRAME,
    STATUSES,
)
from tiniscript.link.trim import Trim
from tiniscript.robots.text_levels import LEVELS
from tiniscript.virtual import worlds
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.simulator import HOLD_MS, PUSH_MS, Simulator
from tiniscript.virtual.transports import BadLine
from tiniscript.vm.runner import run
from tools.bench import large_upload

KIT = robots.load("tinibot").kit
OK, TOO_LARGE = STATUSES["OK"], STATUSES["TOO_LARGE"]
LARGEST = {"grabber": 1900, "tinibot32": 8192, "tinibotc3": 8192}  # bytes of code
PROGRAMS = {
    "drive": "SI|F(5,80)",
    "loop": "SI|LOOP(3);F(2,50);END_LOOP",
    # One frame, whose receipt is under way during the first milliseconds.
    "values": "SI|W(0.01);A = 1.5;SHOW(A * 2);SHOW(A > 1);BEEP(0.2, 440);B(0.3, 40);L(0.25, 70)",
    "until": "SI|F(5, 80) UNTIL(DISTANCE < 40);SHOW(TIME);R(0.5, 60)",
    "fault": "SI|F(0.2, 50);X = 0;SHOW(1 / X)",
    "obstacle": "SI|LOOP(6);F(1, 80);DISTANCE;IF(DISTANCE < 10);STOP;R(1, 60);ENDIF;END_LOOP",
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_the_virtual_robot_agrees_with_tsc_run(name: str) -> None:
    """The readings, each line of the trace and each time agree.

    The line takes no time; otherwise its values would wait until the receipt is sent.
    """
    robot = robot_in(worlds.load("obstacles"), baud=0)
    talk = Talk(robot)
    assert talk.upload(PROGRAMS[name]).status == 0
    talk.wait(20_000)
    assert robot.offset is None  # no program runs
    events = robot.take_events()
    lines = trace(events)
    readings: dict[int, list[int]] = {}
    for event in events:
        if event.kind == "READ":
            readings.setdefault(event.values[0], []).append(event.values[1])
    code = unpack(compile_text(PROGRAMS[name], KIT).image).code
    expected = [str(event) for event in run(code, KIT, Senses(KIT, readings))
                if not isinstance(event, Ending)]  # fmt: skip
    assert lines == expected


@pytest.mark.parametrize("name", ["drive", "until", "obstacle"])
def test_a_run_repeats_with_its_seed(name: str) -> None:
    def run_with(seed: int, noise: float) -> tuple[list[str], list[tuple[float, ...]]]:
        robot = robot_in(worlds.load("obstacles"), seed=seed, noise=noise)
        talk = Talk(robot)
        talk.upload(PROGRAMS[name], is_detached=True)
        robot.step(robot.now_ms + 20_000)
        return trace(robot.take_events()), [tuple(corner) for corner in robot.driving.corners]

    assert run_with(1, 0.03) == run_with(1, 0.03)
    assert run_with(1, 0.03)[1] != run_with(2, 0.03)[1]
    assert run_with(1, 0.0)[1] == run_with(2, 0.0)[1]


def test_unequal_motors_drive_a_curve_and_their_trim_makes_it_straight() -> None:
    """The numbers are those that a robot with pins keeps: its right motor is a tenth too weak."""
    for trim, heading in ((Trim(), -0.1 / 2 * 360 * 0.9), (Trim(balance=10), 0)):
        robot = robot_in(floor(size=400, start="x_cm = 100\ny_cm = 100"), motors=(100, 90))
        talk = Talk(robot)
        assert talk.wait_for(talk.session.trim(trim.data())).status == 0
        talk.upload("SI|F(2, 100)")
        robot.step(robot.now_ms + 900)
        assert robot.pose.heading == pytest.approx(heading, rel=0.1, abs=0.5)
        assert robot.pose.x_cm > 130


def test_the_papers_program_avoids_all_obstacles() -> None:
    robot = robot_in(worlds.load("obstacles"))
    Talk(robot).upload(OBSTACLE, is_detached=True)
    robot.step(robot.now_ms + 40_000)
    turns = [event for event in robot.take_events() if event.text == "MOTORS 60 -60"]
    assert robot.driving.bumps == 0
    assert len(turns) >= 7
    assert robot.driving.driven_cm > 900


def test_the_line_example_stays_on_its_line() -> None:
    robot = robot_in(worlds.load("line"), "liner")
    text = (ROOT / "examples" / "line.ts").read_text(encoding="utf-8")
    Talk(robot).upload(text, is_detached=True)
    ms_off_line = 0
    places = []
    for _ in range(300):
        robot.step(robot.now_ms + 100)
        places.append(robot.pose)
        ms_off_line += not any(robot.sensing.peek(number, robot.pose) for number in (0, 1))
    assert ms_off_line < 30
    assert robot.driving.driven_cm > 400
    assert max(place.x_cm for place in places) > 150  # all around
    assert min(pose.x_cm for pose in places) < 45
    assert max(place.y_cm for place in places) > 95


def test_the_light_example_finds_a_lamp() -> None:
    robot = robot_in(worlds.load("light"))
    text = (ROOT / "examples" / "light.ts").read_text(encoding="utf-8")
    Talk(robot).upload(text, is_detached=True)
    nearest = 1e9
    for _ in range(80):
        robot.step(robot.now_ms + 100)
        x, y, _heading = robot.pose
        nearest = min(nearest, ((x - 190) ** 2 + (y - 130) ** 2) ** 0.5)
    assert nearest < 25


# -- the link -------------------------------------------------------------------------------------


def push(robot: VirtualRobot) -> None:
    robot.press()
    robot.let_go()


def test_without_its_computer_an_attached_program_ends_after_a_second() -> None:
    robot = robot_in()
    Talk(robot).upload("SI|LOOP(FOREVER);L(5, 50);END_LOOP")
    began_ms = robot.now_ms
    robot.step(began_ms + 2000)
    last = robot.take_events()[-1]
    assert last.text == "FAULT LINK_LOST"
    assert 900 < last.time_ms - began_ms <= 1050
    assert (robot.driving.left, robot.driving.right) == (0, 0)
    Talk(robot).upload("SI|LOOP(FOREVER);L(5, 50);END_LOOP", is_detached=True)
    robot.step(robot.now_ms + 5000)
    assert robot.is_running
    push(robot)
    assert not robot.is_running
    assert robot.take_events()[-1].text == "STOP"


def test_a_program_that_another_one_replaces_stops_before_it_starts() -> None:
    robot = robot_in()
    talk = Talk(robot)
    talk.upload("SI|LOOP(FOREVER);L(5, 50);END_LOOP", is_detached=True)
    robot.take_events()
    talk.session.start(True)
    robot.step(robot.now_ms + 500, talk.session.poll(robot.now_ms))  # all in one step
    assert [event.kind for event in robot.take_events()] == ["STOP", "START", "MOTORS"]


def test_the_newest_unread_events_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tiniscript.virtual.robot.MAX_EVENTS", 10)
    robot = robot_in()
    Talk(robot).upload("SI|X = 0;LOOP(40);X = X + 1;SHOW(X);END_LOOP", is_detached=True)
    robot.step(robot.now_ms + 2000)
    events = robot.take_events()
    assert len(events) == 10 and [event.text for event in events[-2:]] == ["SHOW 40", "DONE"]


def test_each_task_that_has_not_ended_has_a_place() -> None:
    text = "SI|W(9)\nTASK\nW(9)\nEND_TASK\nTASK\nW(0.1)\nEND_TASK"
    robot = robot_in()
    Talk(robot).upload(text, is_detached=True)
    robot.step(robot.now_ms + 50)
    assert len(robot.task_offsets) == 3
    robot.step(robot.now_ms + 500)
    assert len(robot.task_offsets) == len(set(robot.task_offsets)) == 2


def test_a_saved_program_survives_a_power_cycle() -> None:
    robot = robot_in()
    talk = Talk(robot)
    talk.upload("SB|F(0.1, 50)", runs=False)
    talk.wait(300)
    assert robot.saved_state == "STORED"
    memory = robot.memory
    robot.power_cycle()
    robot.step(robot.now_ms + 300)
    assert robot.is_lit
    push(robot)
    robot.step(robot.now_ms + 200)
    expected = ["0 MOTORS 50 50", "100 MOTORS 0 0", "100 DONE"]
    assert trace(robot.take_events()) == expected
    # The same in another robot with the same memory.
    other = robot_in(memory=memory)
    other.step(300)
    push(other)
    other.step(600)
    assert trace(other.take_events()) == expected


def test_saving_a_byte_takes_time() -> None:
    """A power cut in the middle: the program before is still there."""
    robot = robot_in(eeprom_us=3400)
    talk = Talk(robot)
    talk.upload("SB|F(0.1, 50)", runs=False)
    talk.wait(300)
    talk.upload("SB|B(0.2, 70)", runs=False)
    assert robot.saved_state == "SAVING"
    robot.step(robot.now_ms + 20)
    robot.power_cycle()
    robot.step(robot.now_ms + 300)
    push(robot)
    robot.step(robot.now_ms + 200)
    assert trace(robot.take_events())[0] == "0 MOTORS 50 50"


def test_a_power_cycle_ends_the_run_where_the_robot_is() -> None:
    robot = robot_in()
    Talk(robot).upload("SI|F(5, 80)")
    robot.step(robot.now_ms + 500)
    pose = robot.pose
    robot.power_cycle()
    assert robot.take_events()[-1].text == "OFF"
    robot.step(robot.now_ms + 1000)
    assert robot.pose == pytest.approx(pose)
    assert not robot.is_running


@pytest.mark.parametrize("seed", range(1, 6))
def test_on_a_bad_line_everything_arrives_or_ends(seed: int) -> None:
    robot = robot_in(seed=seed)
    rng = Random(seed)
    to_robot, to_computer = BadLine(15, rng), BadLine(15, rng)
    talk = Talk(robot)
    session = talk.session

    def wait() -> None:
        now_ms = robot.now_ms + 1
        to_robot.send_bytes(session.poll(now_ms), now_ms)
        to_computer.send_bytes(robot.step(now_ms, to_robot.take_arrived(now_ms)), now_ms)
        session.receive(to_computer.take_arrived(now_ms), now_ms)

    long = "SI|" + "".join(f"M({k}, 50);W(0.01);" for k in range(1, 31)) + "S"
    image = unpack(compile_text(long, KIT).image)
    for request in (session.hello(), session.upload(image, True, True, False)):
        while request.outcome is None:
            wait()
        assert request.outcome.status == 0
    for _ in range(3000):
        wait()
    assert to_robot.fault_count + to_computer.fault_count > 1
    lines = trace(robot.take_events())
    assert [line.split(" ", 1)[1] for line in lines][-1] == "DONE"
    assert [line.split()[2] for line in lines if " MOTORS " in line][:3] == ["1", "2", "3"]


def test_a_bad_line_is_reproducible_by_seed() -> None:
    def bytes_through_line(rate: float, seed: int) -> bytes:
        line = BadLine(rate, Random(seed))
        line.send_bytes(bytes(range(256)) * 8, 0)
        return line.take_arrived(10_000_000)

    assert bytes_through_line(0, 1) == bytes(range(256)) * 8
    assert bytes_through_line(20, 1) == bytes_through_line(20, 1) != bytes_through_line(20, 2)
    assert b"OK+LOST\r\n" in bytes_through_line(50, 1)


def test_a_running_robot_continues_by_itself() -> None:
    """Python is not called between events."""
    robot = robot_in(worlds.load("obstacles"))
    Talk(robot).upload("SI|F(50, 1)", is_detached=True)
    request_count = 0
    run_on = robot._firmware.call

    def count_run(name: str, *values: int) -> int:
        nonlocal request_count
        request_count += name == "run"
        return run_on(name, *values)

    robot._firmware.call = count_run
    robot.step(robot.now_ms + 40_000)
    assert request_count == 1


# -- its chip -------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "sizes", "level"), [
    ("tinibot", (SMALL_FRAME, 1), "uno"), ("grabber", (SMALL_FRAME, 1), "mega"),
    ("tinibot32", (LARGE_FRAME, LARGE_WINDOW), "esp32"),
    ("tinibotc3", (LARGE_FRAME, LARGE_WINDOW), "esp32"),
])  # fmt: skip
def test_a_virtual_robot_reports_the_sizes_of_its_chip(
    name: str, sizes: tuple[int, int], level: str
) -> None:
    talk = Talk(robot_in(name=name))
    hello_reply = talk.wait_for(talk.session.hello()).values
    assert (hello_reply.largest, hello_reply.window) == sizes
    assert list(LEVELS)[(hello_reply.features & 3) - 1] == level
    assert hello_reply.room >= talk.robot.profile.board.program_bytes


@pytest.mark.parametrize("is_all", [False, True])
@pytest.mark.parametrize("name", LARGEST)
def test_a_virtual_robot_holds_the_promised_program_size(name: str, is_all: bool) -> None:
    robot = robot_in(name=name)
    assert robot.profile.board.program_bytes == LARGEST[name]
    talk = Talk(robot)
    room = talk.wait_for(talk.session.hello()).values.room
    image = pack("SI", 0, large_upload.program(room if is_all else LARGEST[name]).code)
    assert talk.wait_for(talk.session.upload(unpack(image), runs=False)).status == OK
    talk.wait(20_000)
    assert talk.wait_for(talk.session.status()).values.saved == SAVED_STORED
    robot.power_cycle()
    second_talk = Talk(robot, nonce=6)
    assert (
        second_talk.wait_for(second_talk.session.hello()).values.program == unpack(image).checksum
    )
    assert second_talk.wait_for(second_talk.session.fetch()).values.image == image


def test_a_program_too_large_for_the_virtual_robot_is_refused() -> None:
    talk = Talk(robot_in(name="grabber"))
    room = talk.wait_for(talk.session.hello()).values.room
    image = unpack(pack("SI", 0, large_upload.program(room + 1).code))
    assert talk.wait_for(talk.session.upload(image, runs=False)).status == TOO_LARGE
    assert len(talk.robot.memory) == 4096  # bytes of a Mega's EEPROM


def test_a_virtual_robot_runs_a_long_live_line() -> None:
    talk = Talk(robot_in(name="tinibot32"))
    talk.wait_for(talk.session.hello())
    assert talk.wait_for(talk.session.live(large_upload.program(240).code)).status == OK
    assert talk.robot.is_running


# -- its owner ------------------------------------------------------------------------------------


def owner_of(talk: Talk) -> str:
    talk.wait_for(talk.session.hello())
    assert talk.session.robot
    return ownership_of(talk.session.robot)


@pytest.mark.parametrize(("held_ms", "status"), [(HOLD_MS, "OK"), (PUSH_MS, "HOLD_BUTTON")])
def test_the_button_of_a_virtual_robot_confirms_a_claim(held_ms: int, status: str) -> None:
    keys, robot = Keys(), robot_in()
    talk = Talk(robot, keys=keys)
    request = talk.session.claim(KEY_OWNER)
    talk.wait(500)
    robot.press()
    talk.wait(held_ms)
    robot.let_go()
    assert talk.wait_for(request).status == STATUSES[status]
    if status == "OK":
        assert [key.uses_seals for key in keys.stored_keys] == [True]
        robot.power_cycle()
        assert owner_of(Talk(robot, 6)) == OWNED_BY_OTHER
        assert owner_of(Talk(robot, 7, keys)) == OWNED_BY_YOU


def test_identify_can_be_seen_and_heard() -> None:
    robot = robot_in()
    talk = Talk(robot)
    assert talk.wait_for(talk.session.identify()).status == 0
    lights = []
    for _ in range(35):
        talk.wait(100)
        lights.append(robot.is_lit)
    assert sum(was_lit != is_lit for was_lit, is_lit in pairwise(lights)) >= 10
    assert [event.kind for event in robot.take_events()] == ["BEEP"] * 3


def test_a_long_push_of_the_simulator_lasts(
    simulator: Simulator, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = simulator.robot
    pushed: list[tuple[str, int]] = []
    monkeypatch.setattr(robot, "press", lambda: pushed.append(("down", robot.now_ms)))
    monkeypatch.setattr(robot, "let_go", lambda: pushed.append(("up", robot.now_ms)))
    simulator.push(HOLD_MS)
    simulator.push()  # waits until the long one is over
    for _ in range(3000):
        simulator._step(1, False)
    (_, began_ms), (_, ended_ms), (_, again_ms), (_, over_ms) = pushed
    assert ended_ms - began_ms == HOLD_MS
    assert again_ms > ended_ms
    assert over_ms - again_ms == PUSH_MS
