"""`tiniscript.connect` and `tiniscript.virtual_robot`: a robot that stops when it is left."""

from __future__ import annotations

import math
import os
import signal
import threading
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest

import tiniscript
from tests.support.command import FOREVER, OBSTACLE, Command, run_subprocess
from tests.support.link_events import event
from tests.support.pty_robot import PtyRobot
from tests.support.virtual_command import robot as virtual_robot
from tests.support.waiting import until
from tiniscript.library import opening
from tiniscript.library.client import Client
from tiniscript.library.endings import End, Follower
from tiniscript.link.connection import LinkConnection, PendingRequest
from tiniscript.link.outcomes import CANCELLED, Event, LostEvent, RestartedEvent, StartedEvent
from tiniscript.link.payloads import DoneEvent
from tiniscript.link.requests import OK, Reply
from tiniscript.virtual import directory


def raises_error(
    kind: type[tiniscript.RobotError | tiniscript.UsageError], reason: str
) -> pytest.RaisesExc[tiniscript.RobotError | tiniscript.UsageError]:
    """Expect an error of this kind, for this reason."""
    return pytest.raises(kind, check=lambda error: error.reason == reason)


# -- a virtual robot -------------------------------------------------------------------------------


@pytest.fixture
def virtual() -> Iterator[tiniscript.VirtualRobotConnection]:
    with tiniscript.virtual_robot(hurry=math.inf) as robot:
        yield robot


def test_keys_are_pressed_and_unknown_ones_refused(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    virtual.press("UP", "A", x=-100, y=100)
    virtual.press()
    for key in ("C", "up", "KEY_UP"):
        with raises_error(tiniscript.UsageError, "bad_key"):
            virtual.press(key)
    with raises_error(tiniscript.UsageError, "bad_number"):
        virtual.press(x=101)


def test_a_program_runs_on_a_robot_and_reports_its_values(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    assert (virtual.info.robot, virtual.info.port) == ("tinibot", virtual.port)
    assert virtual.info.room == 389
    program = tiniscript.compile("SI|F(1, 50);SHOW(1.5);SHOW(TRUE AND 1 > 0)")
    receipt = virtual.upload(program)
    assert (receipt.checksum, receipt.is_running) == (program.checksum, True)
    events = list(virtual.events())
    assert [(robot_event.name, robot_event.values) for robot_event in events] == [
        ("STARTED", {"checksum": program.checksum}),
        ("SHOW", {"value": 1.5}),
        ("SHOW", {"value": True, "name": "TRUE AND 1 > 0", "line": 1, "column": 23}),
        ("DONE", {}),
    ]
    assert [robot_event.ms for robot_event in events] == sorted(
        robot_event.ms for robot_event in events
    )
    assert virtual.wait() == tiniscript.Ending("DONE")
    assert virtual.driven_cm == pytest.approx(22.5, abs=1)
    assert (virtual.pose[2], virtual.bumps) == (0, 0)


def test_a_fault_has_the_line_of_the_program(virtual: tiniscript.VirtualRobotConnection) -> None:
    virtual.upload("SI|X = 0\nSHOW(1 / X)", save=False)
    ending = virtual.wait()
    assert (ending.name, ending.cause) == ("FAULT", None)
    assert ending.fault is not None
    assert (ending.fault.name, ending.fault.line) == ("DIVIDE_BY_ZERO", 2)


def test_a_line_runs_at_once_and_the_stored_program_stays(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    stored = virtual.upload("SI|SHOW(7)")
    virtual.wait()
    virtual.live("SHOW(8)")
    assert [
        robot_event.values for robot_event in virtual.events() if robot_event.name == "SHOW"
    ] == [{"value": 8}]
    started = virtual.start()
    assert (started.checksum, started.saved) == (stored.checksum, "STORED")
    assert [
        robot_event.values for robot_event in virtual.events() if robot_event.name == "SHOW"
    ] == [{"value": 7}]


def test_a_program_may_wait_for_the_button(virtual: tiniscript.VirtualRobotConnection) -> None:
    assert not virtual.upload("SB|SHOW(3)").is_running
    virtual.push_button()
    assert [
        robot_event.values for robot_event in virtual.events() if robot_event.name == "SHOW"
    ] == [{"value": 3}]


def test_a_running_program_has_not_ended_and_a_line_runs_after_its_stop(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    virtual.upload(FOREVER, save=False)
    with raises_error(tiniscript.RobotError, "still_running"):
        virtual.wait(0.05)
    assert list(virtual.events(0)) == []
    virtual.stop()
    assert virtual.wait() == tiniscript.Ending("STOPPED", cause="SEQUENCE")
    virtual.live("SHOW(1)")
    assert virtual.wait().name == "DONE"


def test_a_time_limit_ends_an_endless_stream(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    virtual.upload("SI|LOOP(FOREVER);SHOW(1);W(0.01);END_LOOP", save=False)
    assert "SHOW" in {robot_event.name for robot_event in virtual.events(0.3)}
    with raises_error(tiniscript.RobotError, "still_running"):
        virtual.wait(0.2)


def test_world_and_readings_of_a_virtual_robot_can_be_chosen() -> None:
    sensors = {"DISTANCE": [100, 5]}
    with tiniscript.virtual_robot(world="light", sensors=sensors, hurry=50) as robot:
        robot.upload(OBSTACLE, save=False)
        robot.live("SHOW(DISTANCE);SHOW(DISTANCE)")
        shown_values = [
            robot_event.values["value"]
            for robot_event in robot.events()
            if robot_event.name == "SHOW"
        ]
        assert shown_values[-1] == 5


@pytest.mark.parametrize(
    ("reason", "arguments"),
    [("world_refused", {"world": "moon"}), ("bad_number", {"hurry": 0}),
     ("bad_number", {"noise": 2}), ("bad_number", {"motors": (100, 500)}),
     ("no_sensor", {"sensors": {"EYES": 1}}), ("profile_refused", {"robot": "tinbot"})],
)  # fmt: skip
def test_a_virtual_robot_refuses_invalid_settings(
    reason: str, arguments: dict[str, object]
) -> None:
    with raises_error(tiniscript.UsageError, reason):
        tiniscript.virtual_robot(**arguments)  # type: ignore[arg-type]
    assert directory.running_robots() == []


def test_wrong_use_of_a_connection_raises_an_error(
    virtual: tiniscript.VirtualRobotConnection,
) -> None:
    for reason, wrong_call in (
        ("nothing_started", lambda: virtual.wait()),
        ("live_button", lambda: virtual.live("SB|F(1, 50)")),
        ("ping_program", lambda: virtual.upload("PING|check_connection")),
        ("bad_number", lambda: list(virtual.events(-1))),
    ):
        with raises_error(tiniscript.UsageError, reason):
            wrong_call()
    with pytest.raises(tiniscript.ProgramError, match="TS"):
        virtual.live("F(1 50)")
    with pytest.raises(tiniscript.ProgramError) as too_long:
        virtual.live("SHOW(1);" * 60)
    assert (too_long.value.reason, too_long.value.diagnostics) == ("TOO_LARGE", ())
    virtual.close()
    virtual.close()
    with raises_error(tiniscript.UsageError, "closed"):
        virtual.live("F(1, 50)")


def test_a_virtual_robot_ends_with_its_context() -> None:
    count_before = threading.active_count()
    with tiniscript.virtual_robot() as robot:
        assert [entry.address for entry in directory.running_robots()] == [robot.port]
    assert not list(directory._folder().iterdir())
    assert threading.active_count() == count_before


def test_the_virtual_robot_of_another_process_is_found_without_a_port() -> None:
    with virtual_robot("--robot", "liner") as running_robot, tiniscript.connect() as robot:
        assert robot.port == running_robot.port
        assert robot.info.robot == "liner"
        robot.live("SHOW(LINE_L)")  # a word of its own
        assert robot.wait().name == "DONE"
    with raises_error(tiniscript.RobotError, "which_port"):
        tiniscript.connect()


# -- a robot on a port -----------------------------------------------------------------------------


def test_the_button_a_command_and_leaving_stop_the_robot(pty_robot: PtyRobot) -> None:
    with tiniscript.connect(pty_robot.port) as robot:

        def drive() -> None:
            robot.upload(FOREVER)
            pty_robot.until(lambda: pty_robot.moves, "it drives")

        drive()
        pty_robot.push()
        assert robot.wait() == tiniscript.Ending("STOPPED", cause="BUTTON")
        drive()
        result = run_subprocess("stop", "--port", pty_robot.port)
        assert (result.code, pty_robot.moves) == (0, False)
        assert robot.wait() == tiniscript.Ending("STOPPED", cause="SEQUENCE")
        with raises_error(tiniscript.RobotError, "WRONG_KIT"):
            robot.upload(tiniscript.compile("GRIPPER(30)", "grabber"))
        drive()
    assert not pty_robot.moves


def test_an_exception_stops_the_robot_and_propagates(pty_robot: PtyRobot) -> None:
    with pytest.raises(ZeroDivisionError), tiniscript.connect(pty_robot.port) as robot:
        robot.upload(FOREVER, detached=True)
        pty_robot.until(lambda: pty_robot.moves, "it drives")
        _ = 1 / 0
    assert not pty_robot.moves


def test_ctrl_c_stops_the_robot(pty_robot: PtyRobot) -> None:
    program = (
        "import sys, tiniscript\n"
        "with tiniscript.connect(sys.argv[1]) as robot:\n"
        f"    robot.upload({FOREVER!r}, detached=True)\n"
        "    print('running', flush=True)\n"
        "    robot.wait()\n"
    )
    command = Command(pty_robot.port, code=program)
    command.until("running")
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    command.signal(signal.SIGINT)
    _, err = command.process.communicate()
    assert not pty_robot.moves
    assert err.rstrip().endswith(b"KeyboardInterrupt")  # no other error came after it


def test_a_detached_program_continues(pty_robot: PtyRobot) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        robot.upload(FOREVER, save=False, detached=True)
        pty_robot.until(lambda: pty_robot.moves, "it drives")
    assert pty_robot.moves
    with tiniscript.connect(pty_robot.port) as robot:
        robot.stop()
    assert not pty_robot.moves


def test_an_unconfirmed_stop_raises_an_error(
    pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(opening, "CONFIRM_TIMEOUT_S", 0.5)
    robot = tiniscript.connect(pty_robot.port)
    with pytest.raises(tiniscript.StopNotConfirmed, match="batteries") as error_info, robot:
        robot.upload(FOREVER)
        pty_robot.switch_off()
        raise ZeroDivisionError
    assert isinstance(error_info.value.__context__, ZeroDivisionError)


class ToldEvents:
    """A connection that is stopped at 5 ms of its own clock, on which these events come then."""

    def __init__(self, *names: str, time_ms: int = 5) -> None:
        self.events = [(time_ms, event(name)) for name in names]
        self.stops = 0

    def stop(self) -> int:
        self.stops += 1
        return 5

    def event(self, timeout_s: float = 0) -> tuple[int, Event] | None:
        return self.events.pop(0) if self.events else None


def client_of(line: object) -> Client:
    client = Client.__new__(Client)
    client.connection = cast(LinkConnection, line)
    return client


THE_ROBOT: Any = object()


class StoppedAtFirst:
    """A connection through a holder; another client's stop cancels the first of its requests."""

    holder_verb = "monitor"
    heard, is_echoed = 9, False

    def __init__(self, stops: int) -> None:
        self.stops = stops
        self.robot: object = None

    def begin(self, make: Callable[[Any], PendingRequest[Any]]) -> PendingRequest[Any]:
        return make(SimpleNamespace(hello=PendingRequest))

    def wait(self, request: PendingRequest[Any], look: Callable[[], None]) -> Reply[Any]:
        if self.stops:
            self.stops -= 1
            return Reply(CANCELLED)
        self.robot = THE_ROBOT
        return Reply(OK)


@pytest.mark.parametrize("stops", range(4))
@pytest.mark.parametrize("patience", range(4))
def test_a_connection_succeeds_while_others_stop_the_robot(stops: int, patience: int) -> None:
    """It waits for as long as its time limit allows."""
    answers = iter([True] * patience + [False] * 9)
    client = client_of(line := StoppedAtFirst(stops))
    client.port, client.language, client._poll = "P", "en", lambda: None
    if patience >= stops:
        assert client.meet(should_retry=lambda: next(answers)) is THE_ROBOT
        return
    with raises_error(tiniscript.RobotError, "stopped_elsewhere"):
        client.meet(should_retry=lambda: next(answers))
    assert line.stops == stops - patience - 1


def test_only_the_robots_own_answer_confirms_a_stop() -> None:
    for names, is_confirmed in (
        (["SHOW", "STOPPED"], True),
        (["SHOW", "LOST"], False),
        ([], False),
    ):
        line = ToldEvents(*names)
        assert client_of(line).stop(0.01) is is_confirmed
        assert line.stops == 1
    earlier = ToldEvents("STOPPED", time_ms=4)
    assert not client_of(earlier).stop(0.01)


def test_earlier_end_events_do_not_end_a_run() -> None:
    follower = Follower(5)
    stopped_event = event("STOPPED")
    started = [StartedEvent(run, 1) for run in (5, 6)]
    assert not follower.follow(stopped_event, "P")
    assert follower.end(DoneEvent(4)) is None
    assert follower.follow(started[0], "P")
    assert follower.follow(stopped_event, "P")
    assert follower.end(stopped_event) == End("STOPPED")
    assert follower.end(DoneEvent(5)) == End("DONE")
    for last_event, reason in (
        (started[1], "replaced"), (LostEvent(), "link_lost"), (RestartedEvent(), "restarted")
    ):  # fmt: skip
        with raises_error(tiniscript.RobotError, reason):
            follower.follow(last_event, "P")


def test_a_reset_during_a_run_does_not_count_as_an_end(pty_robot: PtyRobot) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        robot.upload("SI|F(200, 80)", save=False)
        pty_robot.until(lambda: pty_robot.moves, "it drives")
        pty_robot.power_cycle()
        with raises_error(tiniscript.RobotError, "restarted"):
            robot.wait()
        robot.live("W(0.01)")
        assert robot.wait().name == "DONE"


def test_a_reset_of_an_idle_robot_is_not_reported(pty_robot: PtyRobot) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        for _ in range(2):
            robot.upload("SI|SHOW(1)", save=False)
            assert robot.wait().name == "DONE"
            pty_robot.power_cycle()


def test_a_program_is_saved_by_the_end_of_a_wait_or_a_connection(
    pty_robot: PtyRobot,
) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        receipt = robot.upload("SI|" + "SHOW(1);" * 120)
        assert receipt.saved == "SAVING"
        robot.live("W(0.01)")
        assert robot.wait().name == "DONE"
        assert robot.start().saved == "STORED"
        program = robot.upload("SB|" + "SHOW(2);" * 120)
    pty_robot.power_cycle()
    with tiniscript.connect(pty_robot.port) as robot:
        assert robot.start().checksum == program.checksum


def test_the_previous_program_is_restored(pty_robot: PtyRobot) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        programs = []
        for power in (30, 40):
            programs.append(robot.upload(f"SI|F(0.05, {power})"))
            robot.wait()
            if power == 30:
                with pytest.raises(tiniscript.RobotError, match="tsc upload") as error_info:
                    robot.undo()
                assert error_info.value.reason == "NO_PREVIOUS"
        receipt = robot.undo()
        assert (receipt.checksum, receipt.is_running) == (programs[0].checksum, False)
        with raises_error(tiniscript.UsageError, "nothing_started"):
            robot.wait()
    pty_robot.power_cycle()
    with tiniscript.connect(pty_robot.port) as robot:
        assert robot.start().checksum == programs[0].checksum
        assert robot.wait().name == "DONE"
        assert robot.undo().checksum == programs[1].checksum


def test_a_way_through_another_command_is_usable(pty_robot: PtyRobot, link: Command) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        robot.upload("SI|SHOW(4)")
        assert [
            robot_event.values for robot_event in robot.events() if robot_event.name == "SHOW"
        ] == [{"value": 4}]
        robot.upload(FOREVER)
        pty_robot.until(lambda: pty_robot.moves, "it drives")
    assert not pty_robot.moves
    link.kill()


def test_a_pulled_cable_is_reported_twice(pty_robot: PtyRobot) -> None:
    robot = tiniscript.connect(pty_robot.port)
    with pytest.raises(tiniscript.StopNotConfirmed) as error_info, robot:
        robot.upload(FOREVER)
        pty_robot.pull()
        robot.wait()
    earlier_error = error_info.value.__context__
    assert isinstance(earlier_error, tiniscript.RobotError)
    assert earlier_error.reason == "port_gone"


def test_a_silent_port_is_reported(pty_robot: PtyRobot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(opening, "CABLE_ANSWER_TIMEOUT_MS", 300)
    monkeypatch.setattr(opening, "LONG_QUIET_S", 0.0)
    pty_robot.switch_off()
    count_before = threading.active_count()
    with pytest.raises(tiniscript.RobotError) as error_info:
        tiniscript.connect(pty_robot.port, language="es")
    assert threading.active_count() == count_before
    assert error_info.value.reason == "link_silent"
    assert "Nada responde" in str(error_info.value)
    # and the port is free again
    pty_robot.switch_on()
    with tiniscript.connect(pty_robot.port) as robot:
        assert robot.info.robot == "tinibot"


def test_a_missing_port_raises_an_error() -> None:
    with pytest.raises(tiniscript.RobotError) as error_info:
        tiniscript.connect("/dev/no-such-port" if os.name == "posix" else "COM199")
    assert error_info.value.reason in ("port_missing", "port_missing_but")


def test_a_missing_port_has_one_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its sentence says which ones there are; its reason is the one that the documents name."""
    from tiniscript.link import ports

    for listed in ([], [ports.ListedPort("/dev/other", "")]):
        monkeypatch.setattr(ports, "list_ports", lambda listed=listed: listed)
        with raises_error(tiniscript.RobotError, "port_missing") as error_info:
            tiniscript.connect("/dev/none-here")
        assert ("/dev/other" in str(error_info.value)) == bool(listed)


@pytest.mark.parametrize("is_watched", [True, False])
def test_a_run_of_another_command_continues_after_the_connection_is_left(
    pty_robot: PtyRobot, is_watched: bool
) -> None:
    """A thread holds the port until the other has ended.."""
    robot = tiniscript.connect(pty_robot.port)
    robot.upload(FOREVER)
    other_command = Command(
        "upload", "-e", "SI|LOOP(FOREVER);F(1, 30);END_LOOP", "--port", pty_robot.port
    )
    other_command.until("running")
    pty_robot.until(lambda: "MOTORS 30 30" in pty_robot.actions, "it does the other's")
    if is_watched:
        with raises_error(tiniscript.RobotError, "replaced"):
            robot.wait()
    with pytest.warns(RuntimeWarning, match="holds the port until the other command has ended."):
        robot.close()
    robot.close()  # no effect
    began_ms = pty_robot.robot_ms
    pty_robot.until(lambda: pty_robot.robot_ms > began_ms + 2000, "it goes on")
    assert pty_robot.moves and other_command.process.poll() is None
    with tiniscript.connect(pty_robot.port) as second_robot:  # through the holder of the port
        assert second_robot.info.port == pty_robot.port
        second_robot.stop()
    assert other_command.wait_for_result().code == 3
    until(
        lambda: not any(thread.name == "holder" for thread in threading.enumerate()), "it lets go"
    )
    run_subprocess("doctor", "--identify", "--port", pty_robot.port).gives(0)


def test_ctrl_c_stops_a_run_of_another_command_through_this_one(pty_robot: PtyRobot) -> None:
    other_command: Command | None = None
    with pytest.raises(KeyboardInterrupt), tiniscript.connect(pty_robot.port):
        other_command = Command("upload", "-e", FOREVER, "--port", pty_robot.port)
        other_command.until("running")
        raise KeyboardInterrupt
    assert other_command is not None and other_command.wait_for_result().code == 3
    pty_robot.until(lambda: not pty_robot.moves, "it stands")


def test_a_replaced_client_stops_nothing_through_the_holder(
    pty_robot: PtyRobot, link: Command
) -> None:
    with tiniscript.connect(pty_robot.port) as robot:
        robot.upload(FOREVER)
        other_command = Command("upload", "-e", FOREVER, "--port", pty_robot.port)
        other_command.until("running")
        with raises_error(tiniscript.RobotError, "replaced"):
            robot.wait()
    began_ms = pty_robot.robot_ms
    pty_robot.until(lambda: pty_robot.robot_ms > began_ms + 1500, "it goes on")
    assert pty_robot.moves and other_command.process.poll() is None
    other_command.kill()
    assert link.process.poll() is None
