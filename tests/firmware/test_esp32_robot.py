"""The sketch of an ESP32, the very files, on a simulated chip: pins, stops, faults and resets."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

import pytest

from tests.machines.esp32 import BROWN_OUT, EMPTY_MEMORY, EXTERNAL, TASK_WATCHDOG, Esp32Robot, Kept
from tests.support.edited_robots import TEXTS
from tests.support.robot_on_host import (
    actions_of,
    computer,
    outcome,
    push_button,
    send,
    wait_until_saved,
)
from tiniscript import compile_text, robots
from tiniscript.bytecode.image import unpack
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.requests import OK
from tiniscript.link.session import Session
from tiniscript.robots.reader import read

STALL = 66  # the fault
AWAY_PROGRAM = "SI|F(60, 80)"
KITS = ("tinibot32", "tinibotc3")
DEVICES_TEXT = """
[[kit.sensors]]
name = "BUMP"
kind = "yes/no"

[[kit.sensors]]
name = "DARK"
kind = "yes/no"

[[kit.actuators]]
name = "ARM"
kind = "number"
range = [0, 180]

[[kit.actuators]]
name = "FAN"
kind = "number"
range = [0, 100]

[[kit.actuators]]
name = "LED"
kind = "yes/no"

[board.sensors.BUMP]
driver = "digital"
pin = 22
pull_up = true
yes_is_low = true

[board.sensors.DARK]
driver = "threshold"
pin = 32
yes_is_low = true

[board.actuators.ARM]
driver = "servo"
pin = 13

[board.actuators.FAN]
driver = "pwm"
pin = 16

[board.actuators.LED]
driver = "digital"
pin = 17
yes_is_low = true
"""
SERVOS = '[board.motors]\ndriver = "servos"\nleft_pin = 25\nright_pin = 26\n'
ONE_DIRECTION = """[board.motors]
driver = "pwm_dir"
left_pwm = 25
left_forward = 26
right_pwm = 27
right_forward = 33
standby = 13
"""
TWO_WIRE = """[board.motors]
driver = "two_wire"
left_forward = 25
left_backward = 26
right_forward = 27
right_backward = 33
"""


def wire_robot(motors: str, profile_text: str = DEVICES_TEXT) -> Esp32Robot:
    """Return a robot with these motors, and one device of every driver."""
    text = TEXTS["tinibot32"].partition("# ---- Its body")
    head = re.sub(r"\[board\.motors\].*?(?=\n\[board\.sensors)", motors, text[0], flags=re.S)
    kit = re.sub(r"(?m)^\[board\]", profile_text.partition("[board")[0] + "[board]", head)
    body = re.sub(r"(?s)# ---- What people call it.*", "", text[2])
    devices = "[board" + profile_text.partition("[board")[2]
    return switched_on(Esp32Robot(read(kit + devices + text[1] + body, "mine")))


def switched_on(robot: Esp32Robot) -> Esp32Robot:
    robot.wait(200)
    assert robot.did == []
    assert robot.is_latched
    return robot


def run(robot: Esp32Robot, text: str) -> Session:
    kit = robot.robot.kit
    compilation = compile_text(text, kit)
    assert compilation.image, compilation
    session = Session(1, 9600, kit.fingerprint)
    assert robot.until(session, session.upload(unpack(compilation.image))) == OK
    return session


def run_and_list_values(robot: Esp32Robot, text: str) -> list[int]:
    """Run a program; return the values that it shows in half a second."""
    session = run(robot, text)
    robot.talk(session, 500)
    return [event.value for event in session.events() if event.name == "SHOW"]


@pytest.mark.sampled("name", "major", draw="ESP32s", keep=2)
@pytest.mark.parametrize("major", [2, 3])
@pytest.mark.parametrize("name", KITS)
def test_a_program_runs_and_a_panic_turns_the_motors_off(name: str, major: int) -> None:
    robot = switched_on(Esp32Robot(robots.load(name), major=major))
    session, buzzer = computer(), robot.robot.board.buzzer
    assert buzzer is not None
    send(robot, session, "SI|F(1, 80);B(0.5, 100)")
    robot.talk(session, 1800)
    assert actions_of(robot)[:4] == ["MOTORS 80 80", "MOTORS -100 -100", "MOTORS 0 0", "TONE 1047"]
    first, second = (int(line.split()[0]) for line in robot.did[:2])
    assert second - first == 1000
    assert [event.name for event in session.events()] == ["DONE"]
    for hertz in (31, 37, 76, 880, 999, 1000, 20000):
        robot.did.clear()
        send(robot, session, f"SI|BEEP(0.2, {hertz});F(1, 50)")
        robot.talk(session, 100)
        assert f"TONE {hertz}" in actions_of(robot)
        assert robot.output(buzzer) in (127, 128), hertz
        robot.talk(session, 200)
        assert actions_of(robot)[-1] == "TONE 0"
        assert robot.output(buzzer) == 0, hertz
    send(robot, session, AWAY_PROGRAM)
    robot.wait(50)
    assert actions_of(robot)[-1] == "MOTORS 80 80"
    robot.stick_ledc()
    robot.panic()  # registers only, before it prints or dumps anything
    pins = robot.robot.board.motors.pins.values()
    assert [robot.output(pin) for pin in pins] == [0] * len(pins)


def test_no_note_of_a_tune_follows_a_tone() -> None:
    robot, session = switched_on(Esp32Robot()), computer()
    send(robot, session, "SI|F(0.05, 80)")
    while "TONE 1047" not in actions_of(robot):
        robot.talk(session, 1)
    robot.did.clear()
    send(robot, session, "SI|BEEP(0.2, 440);W(1)")
    robot.talk(session, 900)
    assert [action for action in actions_of(robot) if "TONE" in action][-2:] == [
        "TONE 440",
        "TONE 0",
    ]


def test_a_window_of_large_frames_waits_for_a_main_loop_that_writes() -> None:
    """During the write of a flash page, everything a computer may have under way arrives at
    once.
    """
    robot = switched_on(Esp32Robot())
    session = Session(1, 115200, robot.robot.kit.fingerprint)
    robot.until(session, session.hello())
    assert session.robot
    frame = encode_frame(Frame(2, 9, 0, bytes(242)))  # a PING that is too long has no effect
    window = session.robot.values.window
    robot.step(b"\0" + frame * window)
    robot.wait(50)
    request = session.status()
    assert robot.until(session, request) == OK and request.outcome
    assert request.outcome.values.overrun == 0
    assert len(frame) * window > 1000


@pytest.mark.sampled("line", "major", draw="what is shown", keep=2)
@pytest.mark.parametrize("major", [2, 3])
@pytest.mark.parametrize("line", [b"LOOP(FOREVER);SHOW(123456.789);END_LOOP", b"HELP"])
def test_output_faster_than_the_cable_blocks_nothing(line: bytes, major: int) -> None:
    robot = switched_on(Esp32Robot(major=major))
    robot.step(line + b"\r\n")
    robot.wait(300)
    robot.step(bytes(4))
    robot.wait(300)
    assert robot.is_latched


@pytest.mark.parametrize("name", KITS)
def test_a_stop_does_not_depend_on_ledc(name: str) -> None:
    """All motor pins are low, and LEDC's channels still run: no pin is joined to them."""
    robot = switched_on(Esp32Robot(robots.load(name)))
    session = computer()
    send(robot, session, AWAY_PROGRAM)
    robot.talk(session, 100)
    assert actions_of(robot) == ["MOTORS 80 80"]
    robot.stick_ledc()
    robot.step(bytes(4))  # a run of zeros: the link's emergency stop
    assert actions_of(robot)[:2] == ["MOTORS 80 80", "MOTORS 0 0"]
    assert robot.is_latched
    pins = robot.robot.board.motors.pins.values()
    assert [robot.output(pin) for pin in pins] == [0] * len(pins)


def test_a_disconnected_bluetooth_module_ends_an_attached_run() -> None:
    """Its state pin shows that, in addition to the chip's own radios."""
    state = 22
    text = TEXTS["tinibot32"].replace("[board]\n", f"[board]\nbluetooth_state = {state}\n")
    robot = Esp32Robot(read(text, "mine"))
    robot.set_level(state, True)
    switched_on(robot)
    session = computer()
    send(robot, session, AWAY_PROGRAM)
    robot.talk(session, 100)
    robot.set_level(state, False)
    robot.talk(session, 500)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    assert [event.cause for event in session.events() if event.name == "STOPPED"] == [4]


@pytest.mark.parametrize(
    "motors", [SERVOS, TWO_WIRE, ONE_DIRECTION], ids=["servos", "two_wire", "pwm_dir"]
)
def test_other_motor_drivers_are_driven(motors: str) -> None:
    robot = wire_robot(motors, DEVICES_TEXT.replace("pin = 13", "pin = 14"))
    run(robot, "SI|M(-40, 60);W(0.1);F(1, 80)")
    robot.wait(300)
    assert [line for line in actions_of(robot) if line.startswith("MOTORS")] == [
        "MOTORS -40 60", "MOTORS 80 80",
    ]  # fmt: skip
    robot.did.clear()
    robot.step(bytes(4))
    robot.wait(40)
    assert "MOTORS 0 0" in actions_of(robot)
    if motors == SERVOS:  # neutral pulses for a second, then no pulses
        assert robot.output(25) > 0
        robot.wait(1100)
        assert robot.output(25) == robot.output(26) == 0
        run(robot, "SI|F(1, 80)")
        robot.wait(300)
        assert robot.output(25) > 0
        robot.panic()
        assert robot.output(25) == robot.output(26) == 0


def test_actuators_are_set_and_released_by_a_stop() -> None:
    robot = wire_robot(TWO_WIRE)
    assert (robot.output(13), robot.output(16), robot.output(17)) == (0, 0, 255)
    run(robot, "SI|ARM(90);FAN(50);LED(TRUE);F(60, 80)")
    robot.wait(100)
    assert "SERVO 0 1500" in actions_of(robot)
    assert (robot.output(16), robot.output(17)) == (128, 0)
    robot.step(bytes(4))
    robot.wait(10)
    assert (robot.output(13), robot.output(16), robot.output(17)) == (0, 0, 255)


def test_sensors_are_read() -> None:
    robot = wire_robot(TWO_WIRE)
    trigger, echo = 18, 19
    robot.set_analog(34, 4095)
    robot.set_analog(35, 400)
    robot.set_analog(32, 100)
    robot.set_level(22, False)
    assert run_and_list_values(robot, "SI|SHOW(DISTANCE)") == [400_000], "it hears nothing"
    robot.set_sonar_distance(trigger, echo, 50)
    right, left, distance, *others = run_and_list_values(
        robot, "SI|SHOW(LIGHT_R);SHOW(LIGHT_L);SHOW(DISTANCE);SHOW(BUMP);SHOW(DARK)"
    )
    assert (right, left) == (1_023_000, 100_000)
    assert abs(distance - 50_000) < 100  # thousandths of a centimetre
    assert others == [1, 1]


def test_an_echo_missed_during_an_erase_is_measured_again() -> None:
    robot, session = switched_on(Esp32Robot()), computer()
    robot.set_sonar_distance(18, 19, 50)
    robot.erase(150)
    send(robot, session, "SI|LOOP(60);SHOW(DISTANCE);W(0.07);END_LOOP")
    wait_until_saved(robot, session)
    robot.talk(session, 1000)
    shown_values = [event.value for event in session.events() if event.name == "SHOW"]
    assert len(shown_values) > 10
    assert all(49_000 < value < 51_000 for value in shown_values), shown_values


def test_nvs_is_written_only_while_the_motors_are_off() -> None:
    """A write may stop the chip while a page is erased: a stop would come late."""
    robot, session = switched_on(Esp32Robot()), computer()
    send(robot, session, AWAY_PROGRAM)
    writes_before = robot.read_kept().writes
    robot.talk(session, 1000)
    assert robot.read_kept().writes == writes_before
    session.stop(robot.now_ms)
    robot.talk(session, 100)
    assert actions_of(robot) == ["MOTORS 80 80", "MOTORS 0 0"]
    wait_until_saved(robot, session)
    assert 0 < robot.read_kept().writes - writes_before <= 9


@pytest.mark.parametrize("room", range(5))
def test_a_full_nvs_is_reported_and_the_previous_program_stays(room: int) -> None:
    """The button starts the stored program, and the light says that it can. The last write needs
    the least room.
    """
    robot, session = switched_on(Esp32Robot()), computer()
    assert not robot.is_lit
    send(robot, session, "SB|F(0.5, 80)")
    wait_until_saved(robot, session)
    kept_memory = robot.read_kept()
    robot.fill_nvs(room)
    send(robot, session, "SB|B(0.5, 60)")
    robot.talk(session, 1000)
    assert robot.complete(session, session.status()).saved == 1  # in memory only
    assert robot.read_kept().entries.items() >= kept_memory.entries.items()
    restarted_robot = switched_on(Esp32Robot(kept_memory=robot.read_kept()))
    assert restarted_robot.is_lit
    assert push_button(restarted_robot, 600)[:2] == ["MOTORS 80 80", "MOTORS 0 0"]


# -- failures


def driving_robot(text: str = AWAY_PROGRAM, is_detached: bool = False) -> Esp32Robot:
    robot, session = switched_on(Esp32Robot()), computer()
    send(robot, session, text, is_detached=is_detached)
    robot.talk(session, 100)
    assert actions_of(robot) == ["MOTORS 80 80"]
    robot.did.clear()
    return robot


def test_a_hanging_main_loop_is_stopped_and_restarted() -> None:
    robot = driving_robot()
    robot.hang(99)
    robot.wait(1)
    assert robot.did == []
    robot.hang(1100)
    robot.step(ticks=0)
    assert actions_of(robot) == ["MOTORS 0 0", "RESTART"]
    restarted_robot = Esp32Robot(kept_memory=robot.read_kept(), reset=TASK_WATCHDOG)
    restarted_robot.wait(200)
    session = computer(2)
    values = restarted_robot.complete(session, session.status())
    assert values.fault == STALL
    assert values.fault_program != 0
    assert restarted_robot.is_latched


def test_a_page_that_is_erased_slowly_is_not_a_stall() -> None:
    """Data sheets of flash chips allow 400 ms; the motors are off before anything is written."""
    robot, session = switched_on(Esp32Robot()), computer()
    robot.erase(150)
    send(robot, session, "SI|W(9);F(1, 80)")
    wait_until_saved(robot, session)
    request = session.status()
    assert robot.until(session, request) == OK
    assert outcome(request).values.fault == 0
    robot.hang(150)  # no write is in progress
    assert robot.until(session, request := session.status()) == OK
    assert outcome(request).values.fault == STALL


def test_a_short_stall_is_a_fault_and_no_restart() -> None:
    robot = driving_robot()
    robot.hang(150)
    robot.wait(20)
    assert actions_of(robot)[0] == "MOTORS 0 0"
    assert "RESTART" not in actions_of(robot)
    restarted_robot = Esp32Robot(kept_memory=robot.read_kept(), reset=TASK_WATCHDOG)
    restarted_robot.wait(200)
    assert restarted_robot.is_latched


def test_each_stall_stops_the_motors() -> None:
    """However many a robot has recovered from."""
    robot, session = switched_on(Esp32Robot()), computer()
    for _ in range(3):
        assert robot.until(session, session.clear()) == OK
        send(robot, session, AWAY_PROGRAM)
        robot.talk(session, 100)
        robot.did.clear()
        robot.hang(150)
        robot.wait(20)
        assert actions_of(robot)[:1] == ["MOTORS 0 0"]


@pytest.mark.parametrize("seed", range(4))
def test_only_a_stall_that_is_too_long_by_itself_stops_a_robot(seed: int) -> None:
    """However many short ones there have been, and however briefly the main loop ran between."""
    rng = random.Random(seed)
    robot = driving_robot(is_detached=True)
    for _ in range(40):
        robot.hang(rng.choice((1, 15, 50, 99)))
        robot.wait(rng.choice((1, 1, 3, 25)))
    assert robot.did == []
    robot.hang(111)  # a look in every 10 ms finds it
    robot.wait(1)
    assert actions_of(robot)[0] == "MOTORS 0 0"


@pytest.mark.parametrize(
    ("reset", "number"),
    [(1, 1), (EXTERNAL, 2), (BROWN_OUT, 3), (TASK_WATCHDOG, 4), (5, 4), (4, 4), (3, 0)],
)
def test_the_cause_of_a_reset_is_reported(reset: int, number: int) -> None:
    robot, session = Esp32Robot(reset=reset), computer()
    robot.wait(200)
    assert robot.complete(session, session.hello()).reset == number


@pytest.mark.parametrize(
    "take", [lambda kept: EMPTY_MEMORY, lambda kept: kept._replace(noinit=b"")]
)
def test_memory_that_survives_a_reset_may_contain_anything(take: Callable[[Kept], Kept]) -> None:
    robot = driving_robot()
    robot.hang(1200)
    restarted_robot = Esp32Robot(kept_memory=take(robot.read_kept()), reset=1)
    restarted_robot.wait(300)
    assert actions_of(restarted_robot) == [] and restarted_robot.is_latched
