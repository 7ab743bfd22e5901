"""A robot that is stopped, and stopped again, while a button is down or not, and in every state.

The states are those of the button tests: the robot still holds its program, and its button starts
it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.button_states import STATES, Table, save_typed, store_trim
from tests.support.hostile_client import Client
from tests.support.images import image_of
from tests.support.pty_robot import drives_now
from tests.support.robot_on_host import (
    AWAY_PROGRAM,
    KIT,
    actions_of,
    computer,
    live,
    send,
    switched_on,
)
from tiniscript.link.connection import PendingRequest
from tiniscript.link.frames import Frame, decode_frame, encode_frame
from tiniscript.link.messages import BY_NAME, RUN, STATE_STOPPED
from tiniscript.link.requests import OK
from tiniscript.link.session import Session


def send_waiting_program(robot: HostFirmware, session: Session) -> None:
    """Bring a program that waits for the button."""
    send(robot, session, "SB|F(60, 80)")
    robot.talk(session, 100)
    robot.did.clear()


def run_to_end(
    robot: HostFirmware, session: Session, text: str, last_action: str, milliseconds: int
) -> None:
    """Run a line to its end, without a computer if that end is a lost link."""
    live(robot, session, text)
    if text == AWAY_PROGRAM:
        robot.wait(milliseconds)
    else:
        robot.talk(session, milliseconds)
    assert actions_of(robot)[-1] == last_action


def leave_live(robot: HostFirmware, session: Session) -> None:
    live(robot, session, AWAY_PROGRAM)
    robot.step(flags=8)


ENDLESS_CODE = image_of("SI|LOOP(FOREVER);M(40, 30);W(0.02);END_LOOP").code
STOP_MESSAGE = b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 99, 0))
INTERVENING_STOPS: dict[str, Callable[[HostFirmware, Session], object]] = {
    "stopped by zeros": lambda robot, session: robot.step(bytes(4)),
    "stopped by a message": lambda robot, session: robot.wait(20, STOP_MESSAGE),
    "ended": lambda robot, session: run_to_end(robot, session, "SI|F(0.1, 80)", "FINISHED", 300),
    "faulted": lambda robot, session: run_to_end(
        robot, session, "SI|X = 0; SHOW(5 / X)", "FAULTED", 300
    ),
    "lost": lambda robot, session: run_to_end(robot, session, AWAY_PROGRAM, "FAULTED", 1500),
    "still running": lambda robot, session: live(robot, session, "SI|F(0.3, 80)"),
    "left": leave_live,
}


@pytest.mark.parametrize("intervening_stop", INTERVENING_STOPS)
def test_a_button_pressed_meanwhile_starts_nothing(intervening_stop: str) -> None:
    robot, session = switched_on(), computer()
    send_waiting_program(robot, session)
    robot.talk(session, 1, flags=1)
    robot.talk(session, 50)
    INTERVENING_STOPS[intervening_stop](robot, session)
    robot.did.clear()
    robot.talk(session, 1, flags=2)
    robot.talk(session, 500)
    assert [line for line in actions_of(robot) if line.startswith("MOTORS")] in ([], ["MOTORS 0 0"])
    robot.push()
    robot.wait(10)
    assert actions_of(robot)[-1] == "MOTORS 80 80"


def test_a_button_released_at_the_moment_of_a_stop_starts_nothing() -> None:
    """The stop has arrived in an interrupt; the main loop sees the button first."""
    robot, session = switched_on(), computer()
    send_waiting_program(robot, session)
    robot.step(flags=1)
    robot.wait(50)
    robot.step(bytes(4), flags=2 | 16)
    robot.wait(100)
    assert robot.did == []
    assert robot.is_latched


def test_a_stopping_push_starts_nothing_but_the_next_push_does() -> None:
    robot, session = switched_on(), computer()
    send_waiting_program(robot, session)
    for _ in range(3):
        robot.push()
        robot.wait(10)
        assert actions_of(robot)[-1] == "MOTORS 80 80"
        robot.step(flags=1)
        robot.wait(10)
        robot.step(bytes(8))
        robot.step(flags=2)
        robot.wait(200)
        assert actions_of(robot)[-1] == "MOTORS 0 0"


@pytest.mark.parametrize("stop_kind", ["zeros", "STOP"])
def test_a_stop_works_every_time(stop_kind: str) -> None:
    """Stop, button, stop, button: the sender repeats the stop as if no answer had arrived."""
    robot, session = switched_on(), computer()
    send_waiting_program(robot, session)
    stop = (
        bytes(8)
        if stop_kind == "zeros"
        else b"\0" + encode_frame(Frame(BY_NAME["STOP"].number, 7, 0))
    )
    for _ in range(300):  # more times than an 8-bit counter can count
        robot.push(2)
        assert actions_of(robot)[-1] == "MOTORS 80 80"
        robot.wait(20, stop)
        assert actions_of(robot)[-1] == "MOTORS 0 0"
        assert robot.is_latched
        del robot.did[:-1]


@pytest.mark.parametrize("line", [b"", b"HELLO\n", b"SI|LOOP(2)\n", b"S\n"])
@pytest.mark.parametrize("stops", [1, 2])
def test_a_stop_of_zeros_is_answered_with_a_frame_whatever_was_typed_before(
    line: bytes, stops: int
) -> None:
    robot = switched_on()
    if stops == 2:
        robot.wait(4000, bytes(8))
    robot.wait(1500, line)
    sent_bytes = robot.wait(60, bytes(8))
    assert b"//" not in sent_bytes
    frames = [decode_frame(part) for part in sent_bytes.split(b"\0") if part]
    assert [frame and frame.number for frame in frames] == [BY_NAME["STOPPED"].number]


# -- in every state of the firmware, in every way, once, twice and again and again ----------------


ZEROS = bytes(4)
WAYS: dict[str, Callable[[HostFirmware], bytes]] = {
    "four zeros": lambda robot: robot.step(ZEROS),
    "eight zeros": lambda robot: robot.step(ZEROS + ZEROS),
    "two": lambda robot: robot.step(ZEROS) + robot.wait(30) + robot.step(ZEROS),
    "for a second": lambda robot: b"".join(robot.wait(100, ZEROS) for _ in range(10)),
    "a message": lambda robot: robot.wait(3, STOP_MESSAGE),
    "a message and zeros": lambda robot: robot.wait(3, STOP_MESSAGE) + robot.step(ZEROS),
    "a line": lambda robot: robot.wait(3, b"\0S\n"),
}
# The following press has no effect if the button is down since the reset; in an open block, a line
# S belongs to the program.
NOT_HERE = (("was reset with the button down", None), ("has an open block of text", "a line"))
PAIRS = [
    (state, way)
    for state in STATES
    for way in WAYS
    if not {(state, way), (state, None)} & set(NOT_HERE)
]


def table_in_state(state: str) -> Table:
    table = Table()
    STATES[state](table)
    table.robot.did.clear()
    return table


def after_power_off(table: Table) -> HostFirmware:
    restarted_robot = HostFirmware(KIT, table.robot.memory())
    restarted_robot.wait(100)
    return restarted_robot


@pytest.mark.parametrize(("state", "way"), PAIRS)
def test_a_stop_works_in_every_state(state: str, way: str) -> None:
    table = table_in_state(state)
    robot = table.robot
    was_running = not robot.is_latched
    WAYS[way](robot)
    moves = [line for line in actions_of(robot) if line.startswith("MOTORS")]
    assert set(moves) <= {"MOTORS 0 0"} and (moves or not was_running)
    assert robot.is_latched
    count_before = len(robot.did)
    table.talk(1500)
    later_moves = [line for line in actions_of(robot)[count_before:] if line.startswith("MOTORS")]
    assert set(later_moves) <= {"MOTORS 0 0"}, "nothing begins by itself"
    if state == "is saving its program":
        restarted_robot = after_power_off(table)
        restarted_robot.push()
        restarted_robot.wait(50)
        assert actions_of(restarted_robot)[-1] == f"MOTORS {table.program} {table.program}"
    robot.push()
    table.talk(50)
    if table.program:
        assert actions_of(robot)[-1] == f"MOTORS {table.program} {table.program}"
    else:
        assert robot.is_latched


@pytest.mark.parametrize("after_ms", [0, 1, 2, 3, 5, 8, 13, 21, 34, 55, 89])
@pytest.mark.parametrize("state", [save_typed, store_trim])
def test_a_stop_works_at_any_time_of_a_save(state: Callable[[Table], None], after_ms: int) -> None:
    table = Table()
    state(table)
    table.talk(after_ms)
    table.robot.step(ZEROS)
    assert table.robot.is_latched
    table.robot.wait(1500)
    image_after = after_power_off(table)
    session = computer(7)
    if state is store_trim:
        request = session.trim()
        assert image_after.until(session, request) == OK
        assert request.outcome and request.outcome.values.least in (0, 1)
    image_after.push()
    image_after.talk(session, 50)
    assert actions_of(image_after)[-1] == f"MOTORS {table.program} {table.program}"


def drives(robot: HostFirmware) -> bool:
    return drives_now([line.split(" ", 1)[1] for line in robot.did])


@pytest.mark.parametrize("is_asked", ["search", "upload", "nothing"])
def test_searching_for_a_lost_robot_does_not_keep_it_driving(
    is_asked: str,
) -> None:
    """The robot hears everything, so its program ends by itself, like that of a lost robot."""
    robot, session = switched_on(), computer()
    live(robot, session, "SI|F(60, 80)")
    robot.talk(session, 300)
    assert drives(robot)
    lost_ms: int | None = None
    request: PendingRequest[Any] | None = None
    if is_asked == "upload":
        request = session.upload(image_of("SI|F(60, 80)"), saves=False)
    while lost_ms is None or robot.now_ms < lost_ms + 6000:
        if robot.now_ms % 10 == 0 and any(event.name == "LOST" for event in session.events()):
            lost_ms = lost_ms or robot.now_ms
            if is_asked == "search":
                request = session.hello()
        robot.step(session.poll(robot.now_ms))
        assert lost_ms is None or robot.now_ms < lost_ms + 1500 or not drives(robot)
    robot.talk(session, 3000)
    assert request is None or request.outcome is not None


BEFORE_THE_MAIN_LOOP = 16


def put_at_once(client: Client, data: bytes) -> None:
    """Send bytes that all arrive before the robot's main loop looks, or as usual."""
    if client.rng.random() < 0.7:
        client.receive(client.robot.step(data, flags=BEFORE_THE_MAIN_LOOP))
    else:
        client.put(data, client.rng.randint(1, 3))


@pytest.mark.parametrize("seed", range(20))
def test_nothing_sent_before_a_stop_acts_after_it(seed: int) -> None:
    """Whatever waits when a stop comes, also while the robot is stopped already."""
    client = Client(seed)
    rng = client.rng
    client.send_hello()
    for _ in range(40):
        burst, must_stand = b"", False
        for _ in range(rng.randint(2, 6)):
            name = rng.choice(("CLEAR", "CLEAR", "LIVE", "PING", "STOP", "zeros", "zeros"))
            if name == "zeros":
                burst += bytes(4)
            else:
                payload = bytes([RUN]) + ENDLESS_CODE if name == "LIVE" else b""
                client.seq = (client.seq + 1) % 256
                number = BY_NAME[name].number
                frame = encode_frame(Frame(number, client.seq, client.epoch, payload))
                burst += (b"" if burst else client.zero()) + frame
            must_stand = name == "zeros" or (must_stand and name != "CLEAR")
            if rng.random() < 0.3:
                put_at_once(client, burst)
                burst = b""
        put_at_once(client, burst)
        client.put(b"", 30)
        if must_stand:
            assert client.ask_by_name("STATUS")[1] == STATE_STOPPED
            client.robot.did.clear()  # it lacks what was done before the main loop looked
            client.put(b"", 100)
            assert client.robot.is_latched and client.robot.did == []
        client.ask_by_name(rng.choice(("PING", "CLEAR")))
