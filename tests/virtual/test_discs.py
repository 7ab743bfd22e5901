"""Moves by centimetres and degrees: how far and how straight robots go, and how such a move ends.

The firmware is the robot's own. Most have a disc on each wheel; wheels, motors and discs are those
of `virtual/wheels.py`. Those without discs go as long as `tsc run` says.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from tests.support.flicker import Flicker
from tests.support.rows import each_row
from tests.support.virtual_robot import Talk, floor, robot_in, trace
from tiniscript import compile_text, robots, run
from tiniscript.base.kit import Kit
from tiniscript.bytecode.image import GO, TASKS, unpack
from tiniscript.bytecode.opcodes import BY_CODE, ESCAPE
from tiniscript.cli.robot.event_printer import fault_sentence
from tiniscript.link.messages import SAVED_STORED, STATUSES, TEXT_LEVEL, TEXT_LEVELS
from tiniscript.robots.kinematics import START, move_pose
from tiniscript.robots.profile import Robot
from tiniscript.virtual import wheels
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.wheels import Roughness, Wheel

OK = STATUSES["OK"]
UNEVEN = ((107.5, 92.5), (92.5, 107.5))
TWO = robots.load("tinibot2")
TWO_CHANNELS = TWO._replace(
    board=TWO.board._replace(
        discs=TWO.board.discs
        and TWO.board.discs._replace(
            driver="two_channel", pins={"left": 2, "right": 3, "left_b": 18, "right_b": 19}
        )
    )
)
WAY = "F(60 CM, 60)"
ONE_TASK = "F(20 CM, 60); R(90 DEG, 60); F(45 CM, 50) UNTIL(TIME > 2)"
TWO_TASKS = f"{ONE_TASK}\nTASK\nW(0.3); B(4.5 CM, 100)\nEND_TASK"


def started_robot(
    text: str, seed: int = 1, profile: Robot = TWO, slip: float = 0.005, is_detached: bool = False
) -> tuple[VirtualRobot, Talk]:
    """A robot with uneven motors in the middle of a floor, whose program has just begun."""
    world = floor(size=500, start="x_cm = 250\ny_cm = 250")
    settings = Settings(seed=seed, motors=UNEVEN[seed % 2], roughness=Roughness(slip))
    robot = VirtualRobot(profile, world, settings)
    talk = Talk(robot)
    assert talk.upload(text, is_detached=is_detached).status == OK
    return robot, talk


def displacement(robot: VirtualRobot) -> tuple[float, float, float]:
    """Return the robot's displacement ahead and to the left, and its rotation."""
    pose = robot.pose
    return pose.x_cm - 250, pose.y_cm - 250, pose.heading


def wheel(robot: VirtualRobot, number: int) -> Wheel:
    assert robot.wheels
    return robot.wheels.wheels[number]


def stands_for_a_while(robot: VirtualRobot) -> bool:
    pose_before = robot.pose
    robot.step(robot.now_ms + 300)
    return math.dist(pose_before[:2], robot.pose[:2]) < 0.01


@pytest.mark.parametrize("profile", [TWO, TWO_CHANNELS], ids=["slotted", "two_channel"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_moves_are_straight_and_of_the_requested_length(profile: Robot, seed: int) -> None:
    robot, talk = started_robot("F(100 CM, 60)", seed, profile)
    talk.wait(9000)
    ahead, aside, _ = displacement(robot)
    assert abs(ahead - 100) <= 1.5 and abs(aside) <= 3.2
    lines = trace(robot.take_events())
    assert lines[0] == "0 MOTORS 60 60" and len(lines) == 3
    assert [line.split(" ", 1)[1] for line in lines[1:]] == ["MOTORS 0 0", "DONE"]


@pytest.mark.parametrize("profile", [TWO, TWO_CHANNELS], ids=["slotted", "two_channel"])
@pytest.mark.parametrize(("text", "turn"), [("L(360 DEG, 60)", 360), ("R(90 DEG, 80)", -90)])
def test_turns_have_the_requested_angle(profile: Robot, text: str, turn: int) -> None:
    robot, talk = started_robot(text, 2, profile)
    talk.wait(6000)
    assert abs(displacement(robot)[2] - turn) <= 6


def test_the_controller_learns_how_its_wheels_roll_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """If wheels stop earlier than most, later moves end earlier, with fewer corrections."""
    monkeypatch.setattr(wheels, "LAG_MS", 30)
    robot, talk = started_robot("LOOP(6); F(30 CM, 70); SHOW(TIME); END_LOOP", slip=0.0)
    talk.wait(9000)
    lines = [line.partition("SHOW ")[2] for line in trace(robot.take_events())]
    at_s = [float(line) for line in lines if line]
    assert at_s[5] - at_s[2] < at_s[2] - 0.25


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("lag_ms", [30, 60, 90])
def test_later_turns_are_as_exact_as_the_first(
    monkeypatch: pytest.MonkeyPatch, lag_ms: int, seed: int
) -> None:
    """Each may be corrected, however many were before it and however long the wheels roll on."""
    monkeypatch.setattr(wheels, "LAG_MS", lag_ms)
    robot, _ = started_robot(
        "LOOP(12); R(90 DEG, 60); W(0.3); END_LOOP", seed, slip=0.0, is_detached=True
    )
    robot.step(robot.now_ms + 40_000)
    assert abs(displacement(robot)[2] + 12 * 90) <= 20


def test_backward_short_and_zero_moves_are_exact() -> None:
    robot, talk = started_robot("B(30 CM, 100); F(2 CM, 40); F(0 CM, 0)")
    talk.wait(6000)
    assert abs(displacement(robot)[0] + 28) < 1.5 and robot.fault == ""
    assert [line.split(" ", 1)[1] for line in trace(robot.take_events())] == [
        "MOTORS -100 -100", "MOTORS 0 0", "MOTORS 40 40", "MOTORS 0 0", "MOTORS 0 0", "MOTORS 0 0",
        "DONE",
    ]  # fmt: skip


def test_a_kit_without_speed_also_measures_and_power_0_is_a_fault() -> None:
    robot, talk = started_robot("P = 0; F(20 CM, P)")
    talk.wait(500)
    assert robot.fault == "NO_POWER"


@pytest.mark.parametrize("text", [
    f"{WAY} UNTIL(TIME > 0.5); SHOW(1)",
    f"{WAY}; SHOW(1)\nTASK\nW(0.5); S\nEND_TASK",
])  # fmt: skip
def test_interrupted_moves_end_at_once(text: str) -> None:
    """There is no correction: the distance that it rolls on remains."""
    robot, talk = started_robot(text)
    talk.wait(540)
    assert "MOTORS 0 0" in " ".join(trace(robot.take_events()))
    talk.wait(500)
    ahead = displacement(robot)[0]
    assert 4 < ahead < 20 and stands_for_a_while(robot)


@pytest.mark.parametrize("after_ms", [0, 5, 60, 700, 2400, 2500, 2560, 2620, 2700])
@pytest.mark.parametrize("stopper", ["button", "client"])
def test_a_stop_in_any_phase_stops(after_ms: int, stopper: str) -> None:
    """While it drives, slows down, rolls, or goes back: no motor is driven again."""
    robot, talk = started_robot("F(60 CM, 60); R(90 DEG, 60)")
    talk.wait(after_ms)
    if stopper == "button":
        robot.press()
        robot.let_go()
    else:
        talk.session.stop(robot.now_ms)
    talk.wait(60)
    assert not robot.is_running
    for _ in range(30):
        assert not any(wheel(robot, number).wanted_speed for number in (0, 1))
        talk.wait(20)
    assert stands_for_a_while(robot)


def test_a_lost_link_ends_a_move() -> None:
    robot, talk = started_robot("F(200 CM, 20)")
    talk.wait(300)
    robot.step(robot.now_ms + 1200)
    assert robot.fault == "LINK_LOST" and stands_for_a_while(robot)


def test_an_interrupted_move_continues_when_it_has_the_motors_again() -> None:
    """The turn comes with the motors, and the rest of the way is after it."""
    robot, talk = started_robot(
        "X = 0; F(60 CM, 60)\nWHEN(X = 0 AND TIME > 0.6)\nX = 1; R(90 DEG, 60)\nEND_WHEN"
    )
    talk.wait(6000)
    talk.session.stop(robot.now_ms)
    talk.wait(100)
    ahead, aside, turned_degrees = displacement(robot)
    assert 8 < ahead < 25 and abs(ahead - aside - 60) < 8 and abs(turned_degrees + 90) < 6


def interrupt_moves(way: str, times: int, body: str) -> str:
    """A way that a WHEN interrupts so often."""
    return f"""X = 0; {way}; SHOW(1)
WHEN(X < {times} AND TIME > 0.35 + X * 0.65)
X = X + 1; {body}
END_WHEN"""


STANDING = ("M(0, 0); W(0.4)", "M(0, 0); W(0.05)", "M(0, 0)")
WAYS = [(way, times) for way in ("F(100 CM, 80)", "F(100 CM, 60)", "R(360 DEG, 30)")
        for times in (1, 3, 10)]  # fmt: skip
WAYS += [("R(90 DEG, 80)", 1), ("R(240 DEG, 80)", 3)]
INTERRUPTIONS = [(*way, STANDING[0]) for way in WAYS]
INTERRUPTIONS += [("F(100 CM, 60)", 3, body) for body in STANDING[1:]]


@pytest.mark.sampled("profile", "way", "times", "body", keep=6)
@pytest.mark.parametrize("profile", [TWO, TWO_CHANNELS], ids=["slotted", "two_channel"])
@pytest.mark.parametrize(("way", "times", "body"), INTERRUPTIONS)
def test_an_interrupted_move_keeps_its_length_and_direction(
    profile: Robot, way: str, times: int, body: str
) -> None:
    """Rolling after a WHEN takes the motors counts as a part of the move."""
    for seed in (2, 3, 5):
        robot, talk = started_robot(interrupt_moves(way, times, body), seed, profile)
        talk.wait(13_000)
        lines = [line.split(" ", 1)[1] for line in trace(robot.take_events())]
        assert lines[-1] == "SHOW 1"
        assert sum(line == lines[0] for line in lines) == times + 1, "it has gone on so often"
        ahead, aside, turned_degrees = displacement(robot)
        if way[0] == "F":
            assert abs(ahead - 100) <= 1.5 and abs(aside) <= 3.2
        else:
            assert abs(turned_degrees + int(way[2:].split()[0])) <= 6


@pytest.mark.parametrize(("body", "more_cm", "off_cm"), [
    ("M(0, 0); W(0.3); B(5 CM, 60)", -5, 0.6),  # a way of its own
    ("M(0, 0); W(0.05); F(5 CM, 60)", 5, 0.7),
    # The same distance forward and back.
    ("M(60, 60); W(0.2); M(-60, -60); W(0.2); M(0, 0); W(0.4)", 0, 0.5),
    ("M(-40, -40); W(0.2); M(40, 40); W(0.2); M(0, 0); W(0.4)", 0, 0.5),
])  # fmt: skip
def test_distance_driven_by_an_interruption_does_not_count(
    body: str, more_cm: float, off_cm: float
) -> None:
    """The result is not exact: how far a wheel driven meanwhile would have rolled is a guess."""
    for seed in (1, 2, 3):
        robot, talk = started_robot(interrupt_moves("F(100 CM, 60)", 3, body), seed)
        talk.wait(13_000)
        ahead, _, _ = displacement(robot)
        assert abs(ahead - 100 - 3 * more_cm) <= 1.5 + 3 * off_cm


def test_two_suspended_moves_are_both_completed() -> None:
    """A higher WHEN interrupts a lower one's way, which has interrupted the main task's."""
    text = """X = 0; F(60 CM, 60); SHOW(3)
WHEN(X = 1 AND TIME > 1); X = 2; M(0, 0); W(0.4); SHOW(1); END_WHEN
WHEN(X = 0 AND TIME > 0.6); X = 1; F(40 CM, 60); SHOW(2); END_WHEN"""
    robot, talk = started_robot(text, 2)
    talk.wait(9000)
    ahead, _, _ = displacement(robot)
    values = [line.partition("SHOW ")[2] for line in trace(robot.take_events())]
    assert [text for text in values if text] == ["1", "2", "3"]
    assert abs(ahead - 100) <= 2


def test_a_move_after_an_ended_one_has_its_full_length() -> None:
    """A move ended by S is not continued, even if the same task makes the next one."""
    text = """F(60 CM, 60); F(30 CM, 60); SHOW(1)
TASK; W(0.5); S; W(60); END_TASK"""
    robot, talk = started_robot(text, 2)
    talk.wait(500)
    ahead_before, _, _ = displacement(robot)
    talk.wait(5000)
    assert abs(displacement(robot)[0] - ahead_before - 30) <= 2


@pytest.mark.parametrize("profile", [TWO, TWO_CHANNELS], ids=["slotted", "two_channel"])
@pytest.mark.parametrize("hertz", [3, 8, 40, 300])
@pytest.mark.parametrize("text", [
    "F(30 CM, 60); SHOW(1)", "R(90 DEG, 60); SHOW(1)",
    "W(60)\nWHEN(TIME > 0.1); F(30 CM, 60); SHOW(1); END_WHEN",
])  # fmt: skip
def test_a_move_ends_even_if_a_disc_flickers_at_rest(
    profile: Robot, hertz: float, text: str
) -> None:
    """A second after the motors were turned off at most: then no wheel turns."""
    for numbers in ((0,), (0, 1)):
        robot, talk = started_robot(text, 2, profile)
        for number in numbers:
            Flicker(robot, number, hertz)
        driven_ms = 0
        while not any(event.kind == "SHOW" for event in robot.take_events()):
            if any(wheel(robot, number).wanted_speed for number in (0, 1)):
                driven_ms = robot.now_ms
            talk.wait(10)
            assert robot.fault == "" and robot.now_ms < 8000
        assert robot.now_ms - driven_ms <= 1050


@pytest.mark.parametrize("number", [0, 1])
def test_edges_of_a_flickering_disc_do_not_count(number: int) -> None:
    """While a WHEN lets the robot stand, no more count than wheels may roll."""
    robot, talk = started_robot(interrupt_moves("F(100 CM, 60)", 2, "M(0, 0); W(3)"), 2)
    Flicker(robot, number, 40)
    talk.wait(16_000)
    assert trace(robot.take_events())[-1].endswith("SHOW 1")
    assert abs(displacement(robot)[0] - 100) <= 1.5 + 2 * 2


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("text", [WAY, f"{WAY} UNTIL(DISTANCE = 1)",
                                  f"W(0.01); {WAY}\nTASK\nW(60)\nEND_TASK"])  # fmt: skip
def test_a_silent_disc_is_the_fault_stuck(
    number: int, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot, talk = started_robot(text)
    monkeypatch.setattr(wheel(robot, number), "has_working_sensor", False)
    talk.wait(480)
    assert robot.is_running
    talk.wait(100)
    assert robot.fault == ("STUCK_LEFT", "STUCK_RIGHT")[number] and not robot.is_running
    status = talk.wait_for(talk.session.status()).values
    sentence = fault_sentence(status.fault, status.fault_at, 0, None, "en")
    side = ("left", "right")[number]
    assert sentence.startswith(f"fault {robot.fault}: the {side} wheel does not turn: free it")
    fault_offset = status.fault_at
    code = unpack(compile_text(text, TWO.kit).image).code
    op = BY_CODE[code[fault_offset]]
    assert op.control_role == "until" if op else code[fault_offset] == ESCAPE, (
        "the GO, or the UNTIL"
    )
    assert (op is not None) == ("UNTIL" in text)
    talk.wait(300)
    assert stands_for_a_while(robot)


def test_two_standing_wheels_are_stuck_in_any_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    robot, talk = started_robot(WAY)
    talk.wait(600)
    for number, later_ms in ((1, 120), (0, 0)):
        monkeypatch.setattr(wheel(robot, number), "has_working_sensor", False)
        talk.wait(later_ms)
    talk.wait(520)
    assert robot.fault == "STUCK" and not robot.is_running


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("text", [WAY, "B(60 CM, 60)", "R(90 DEG, 60)"])
def test_exchanged_disc_channels_end_the_move(
    text: str, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It counts backward while the wheel turns forward, so the robot would drive in circles."""
    robot, talk = started_robot(text, profile=TWO_CHANNELS)
    one = wheel(robot, number)
    step = one.step

    def step_backward(has_two: bool) -> float:
        counted_edges_before = one.counted_edges
        speed = step(has_two)
        one.counted_edges = 2 * counted_edges_before - one.counted_edges
        return speed

    monkeypatch.setattr(one, "step", step_backward)
    talk.wait(600)
    assert robot.fault == ("STUCK_LEFT", "STUCK_RIGHT")[number]
    talk.wait(300)
    assert stands_for_a_while(robot)


@pytest.mark.parametrize(("profile", "sees"), [(TWO, False), (TWO_CHANNELS, True)])
def test_a_wheel_turned_back_by_hand_is_measured(profile: Robot, sees: bool) -> None:
    """With two channels the wheel repeats that distance. With one channel, it seems to have gone
    ahead."""
    robot, talk = started_robot(WAY, profile=profile)
    one = wheel(robot, 0)
    start_cm = one.turned_cm
    talk.wait(800)
    for _ in range(12):
        one.turned_cm -= one.edge_cm
        talk.wait(20)
    talk.wait(6000)
    assert robot.fault == "" and not robot.is_running
    off_cm = one.turned_cm - start_cm - 60
    assert abs(off_cm) < 1.5 if sees else -14 < off_cm < -8


def noise(talk: Talk) -> tuple[int, ...]:
    return tuple(talk.wait_for(talk.session.status()).values.noise)


@pytest.mark.parametrize("profile", [TWO, TWO_CHANNELS], ids=["slotted", "two_channel"])
@pytest.mark.parametrize("number", [0, 1])
def test_a_disc_that_flickers_at_rest_is_reported_in_status(profile: Robot, number: int) -> None:
    """This holds with and without a program, once the wheels have stopped rolling."""
    robot, talk = started_robot("W(1)", profile=profile)
    talk.wait(2000)
    assert noise(talk) == (0, 0)
    Flicker(robot, number, 40)
    noise_before = noise(talk)
    talk.wait(2000)
    noise_after = noise(talk)
    assert 75 <= noise_after[number] - noise_before[number] <= 90 and noise_after[1 - number] == 0
    talk.upload("M(60, 60); W(0.5); M(0, 0); W(3)")
    talk.wait(1300)
    noise_before = noise(talk)
    talk.wait(2000)
    noise_after = noise(talk)
    assert 40 <= noise_after[number] - noise_before[number] <= 90 and noise_after[1 - number] == 0


@pytest.mark.parametrize("text", [
    "F(60 CM, 60); W(0.4); R(90 DEG, 80); B(3 CM, 40)",
    "M(90, 90); W(0.3); S; W(0.1); M(0, 90); W(1)",
    interrupt_moves("F(60 CM, 60)", 3, "M(0, 0); W(0.4)"),
    interrupt_moves("F(60 CM, 60)", 2, "B(0.3, 80)"),
])  # fmt: skip
def test_edges_of_rolling_wheels_are_not_noise(text: str) -> None:
    for seed in (1, 2, 3):
        robot, talk = started_robot(text, seed)
        talk.wait(8000)
        assert noise(talk) == (0, 0) and wheel(robot, 0).counted_edges > 20


def test_a_robot_without_discs_reports_no_noise() -> None:
    for name in ("tinibot", "tinibot32"):
        assert noise(Talk(robot_in(name=name))) == ()


def hold(one: Wheel, monkeypatch: pytest.MonkeyPatch) -> None:
    """A person holds a wheel: it neither turns nor shows an edge."""
    one.speed = 0.0
    monkeypatch.setattr(one, "step", lambda has_two: 0.0)


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize(("text", "end_kind"), [
    (WAY, "held"), (WAY, "stopped"), (f"{WAY} UNTIL(TIME > 0.5)", "held"), (WAY, "lost"),
    (f"{WAY}\nTASK; W(0.4); S; W(60); END_TASK", "held"),
])  # fmt: skip
def test_the_next_program_drives_straight_after_any_end_of_a_move(
    text: str, end_kind: str, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A wheel that stood left the other one's lead in the controller: the robot drove a curve."""
    for seed in (1, 2):
        robot, talk = started_robot(text.replace("60)", "80)", 1), seed)
        talk.wait(50)
        with monkeypatch.context() as patch:
            hold(wheel(robot, number), patch)
            talk.wait(420 if end_kind == "stopped" else 900)
        if end_kind == "lost":
            robot.step(robot.now_ms + 1500)
        talk.session.stop(robot.now_ms)
        talk.wait_for(talk.session.clear())
        talk.wait(1000)
        pose_before = robot.pose
        assert talk.upload("F(100 CM, 80)").status == OK
        talk.wait(7000)
        assert robot.fault == "" and not robot.is_running
        along = math.radians(pose_before.heading)
        x, y = robot.pose.x_cm - pose_before.x_cm, robot.pose.y_cm - pose_before.y_cm
        assert abs(x * math.cos(along) + y * math.sin(along) - 100) <= 1.5
        assert abs(y * math.cos(along) - x * math.sin(along)) <= 3.2


@pytest.mark.parametrize("number", [0, 1])
def test_a_briefly_held_wheel_bends_no_later_move(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Too short for a fault. The next way of the same program is straight."""
    for seed in (1, 2):
        robot, talk = started_robot("F(60 CM, 80); W(2); F(100 CM, 80)", seed)
        talk.wait(300)
        with monkeypatch.context() as patch:
            hold(wheel(robot, number), patch)
            talk.wait(450)
        talk.wait(3000)
        assert stands_for_a_while(robot) and robot.is_running
        pose_before = robot.pose
        talk.wait(7000)
        assert robot.fault == "" and not robot.is_running
        along = math.radians(pose_before.heading)
        x, y = robot.pose.x_cm - pose_before.x_cm, robot.pose.y_cm - pose_before.y_cm
        assert abs(y * math.cos(along) - x * math.sin(along)) <= 3.2


@pytest.mark.parametrize("number", [0, 1])
def test_a_wheel_that_stands_while_its_two_channels_flicker_is_stuck(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its edges alternate forever, so the wheel makes no progress."""
    robot, talk = started_robot(WAY, profile=TWO_CHANNELS)
    Flicker(robot, number, 20)
    talk.wait(700)
    hold(wheel(robot, number), monkeypatch)
    talk.wait(650)
    assert robot.fault == ("STUCK_LEFT", "STUCK_RIGHT")[number] and not robot.is_running


def test_counters_may_wrap_around() -> None:
    robot, talk = started_robot("W(0.1); F(30 CM, 60)")
    for number in (0, 1):
        wheel(robot, number).counted_edges = (1 << 16) - 7
    talk.wait(4000)
    assert abs(displacement(robot)[0] - 30) < 1.5


def test_the_same_seed_gives_the_same_run_at_any_polling_rate() -> None:
    def run_way(look: Callable[[VirtualRobot], object], step_ms: int) -> object:
        robot, talk = started_robot(WAY, seed=5)
        for _ in range(4000 // step_ms):
            talk.wait(step_ms)
            look(robot)
        return robot.pose, trace(robot.take_events())

    assert run_way(lambda robot: None, 1000) == run_way(lambda robot: robot.pose, 8)


def test_an_uno_with_discs_reads_no_text_but_a_typed_stop() -> None:
    """A typed stop works immediately, even during a move by distance."""
    robot, talk = started_robot("F(60 CM, 60); SHOW(1)", is_detached=True)
    hello_reply = talk.wait_for(talk.session.hello()).values
    assert TEXT_LEVELS[hello_reply.features & TEXT_LEVEL][0] == "NONE"
    talk.wait(300)
    for line in (b"SI|R(1, 80)\r\n", b"HELP\r\n", b"PING|check_connection\r\n", b"\xff\n"):
        assert b"//" not in robot.step(robot.now_ms + 200, line)
    assert robot.is_running and robot.fault == ""
    robot.step(robot.now_ms + 30, b"STOP\r\n")
    assert not robot.is_running and not any(wheel(robot, number).wanted_speed for number in (0, 1))


def test_a_mega_with_discs_reads_text() -> None:
    talk = Talk(VirtualRobot(robots.load("tinibot2", "mega"), floor()))
    hello_reply = talk.wait_for(talk.session.hello()).values
    assert TEXT_LEVELS[hello_reply.features & TEXT_LEVEL][0] == "MEGA"


# -- without discs --------------------------------------------------------------------------------


def list_trace(text: str, name: str) -> list[str]:
    return [f"{event.ms} {event.text}" for event in run(text, robot=name).events]


@pytest.mark.parametrize("name", ["grabber", "tinibot32"])
@pytest.mark.parametrize("text", [ONE_TASK, TWO_TASKS])
def test_the_duration_of_a_program_follows_the_profile(name: str, text: str) -> None:
    robot = robot_in(name=name)
    talk = Talk(robot)
    assert talk.upload(text).status == OK
    talk.wait(6000)
    assert trace(robot.take_events()) == list_trace(text, name)
    assert talk.wait_for(talk.session.status()).values.saved == SAVED_STORED


@each_row("name", robots.names())
def test_a_simulated_body_moves_and_turns_at_its_kits_speeds(name: str) -> None:
    profile = robots.load(name)
    go_ms = profile.kit.go_ms(20_000, 60, is_turn=False)
    turn_ms = profile.kit.go_ms(90_000, 60, is_turn=True)
    assert go_ms is not None and turn_ms is not None
    assert move_pose(profile.body, START, 60, 60, go_ms).x_cm == pytest.approx(20, abs=0.05)
    assert move_pose(profile.body, START, 60, -60, turn_ms).heading == pytest.approx(-90, abs=0.3)


@pytest.mark.parametrize(
    ("text", "needs"), [(ONE_TASK, GO), (TWO_TASKS, GO | TASKS), ("W(0.1)", 0)]
)
def test_the_robot_determines_the_needs_of_code(text: str, needs: int) -> None:
    """For a program in one frame, and for a live line, its image equals the compiler's."""
    robot = robot_in(name="tinibot32")
    talk = Talk(robot)
    image = compile_text(text, robot.profile.kit).image
    assert unpack(image).needs == needs
    assert talk.upload(text, runs=False).status == OK
    talk.wait(2000)
    assert talk.wait_for(talk.session.fetch()).values.image == image
    assert talk.wait_for(talk.session.live(unpack(image).code)).status == OK
    talk.wait(6000)
    assert trace(robot.take_events()) == list_trace(text, "tinibot32")


def test_a_measured_move_without_speeds_faults() -> None:
    """A profile without `speed` rejects such programs; a program sent anyway faults."""
    robot = robot_in(name="grabber")
    kit = robot.profile.kit
    assert kit.go_ms(20_000, 60, is_turn=False)
    robot.profile = robot.profile._replace(kit=Kit(kit.sensors, kit.actuators))
    robot.power_cycle()
    talk = Talk(robot)
    talk.wait_for(talk.session.hello())
    image = unpack(compile_text("W(0.1); F(20 CM, 60)", kit).image)
    assert talk.wait_for(talk.session.upload(image, True, True)).status == OK
    talk.wait(3000)
    assert robot.fault == "NO_POWER"
