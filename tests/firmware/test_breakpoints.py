"""Breakpoints on a robot: the halts of a program, their state, and code that never meets a trap."""

from __future__ import annotations

from random import Random

import pytest

from tests.machines.host_firmware import drives
from tests.support.debugging import DebuggedRobot, Halt, debug
from tests.support.images import image_of
from tests.support.robot_on_host import KIT, computer, fetch_image, switched_on, wait_until_saved
from tiniscript.base.trace import TracedRobot
from tiniscript.bytecode.image import Image
from tiniscript.bytecode.opcodes import ISA_MAJOR
from tiniscript.bytecode.statements import statement_starts
from tiniscript.link.frames import Frame, encode_frame
from tiniscript.link.messages import (
    BREAKPOINTS,
    BY_NAME,
    HALTS,
    RUN,
    STATE_FAULTED,
    STATE_IDLE,
    STATE_RUNNING,
    STATE_STOPPED,
    STATUSES,
)
from tiniscript.link.outcomes import ShownEvent
from tiniscript.link.payloads import FaultEvent
from tiniscript.link.requests import OK
from tiniscript.vm.machine import Machine

# The instructions start at 0, 2, 5, 7, 10 and 11.
DRIVE_PROGRAM = "SI|N = 1;F(1, 80);N = 5;B(1, 60);SHOW(N)"
SECOND_MOVE_OFFSET = 2  # offset of F
MAIN_TASK = 4  # the last task
BAD_VALUE = STATUSES["BAD_VALUE"]


def state(debugged: DebuggedRobot) -> int:
    return debugged.robot.complete(debugged.session, debugged.session.status()).state


def test_a_robot_announces_that_it_can_halt() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.hello()) == OK
    assert session.robot and session.robot.values.features & BREAKPOINTS


def test_a_program_halts_before_an_instruction_and_continues() -> None:
    debugged = debug(DRIVE_PROGRAM, SECOND_MOVE_OFFSET)
    assert debugged.halt() == Halt(SECOND_MOVE_OFFSET, MAIN_TASK)
    assert debugged.variables()[:2] == [1000, 0]
    assert drives(debugged.robot.did) == [], "nothing of the instruction is done"
    debugged.talk(3000)
    assert (
        debugged.is_halted()
        and state(debugged) == STATE_RUNNING
        and drives(debugged.robot.did) == []
    )
    assert debugged.go()
    assert debugged.halt() is None
    motor_lines = drives(debugged.robot.did)
    assert [line.split(maxsplit=1)[1] for line in motor_lines] == [
        "MOTORS 80 80", "MOTORS 0 0", "MOTORS -60 -60", "MOTORS 0 0"
    ]  # fmt: skip
    times = [int(line.split()[0]) for line in motor_lines]
    assert times[1] - times[0] == times[3] - times[2] == 1000
    assert not debugged.go(), "nothing is halted any more"


def test_a_step_is_a_statement() -> None:
    debugged = debug(DRIVE_PROGRAM, 0)
    assert debugged.halt() == Halt(0, MAIN_TASK)
    lines = []
    while debugged.step():
        halt = debugged.halt()
        if halt is None:
            break
        lines.append(halt.offset)
    assert lines == [2, 5, 7, 10]
    assert debugged.robot.did[-1].endswith("FINISHED")


@pytest.mark.parametrize(
    "text",
    [
        DRIVE_PROGRAM,
        "SI|N = 1;F(1, 80) UNTIL(DISTANCE < 9 AND LIGHT_L > 5);IF(N > 2 OR LIGHT_R < 3);STOP;ENDIF",
        "SI|WHEN(LIGHT_R > 5);B(0.1, 50);END_WHEN;TASK;F(9, 40) UNTIL(DISTANCE < 10);END_TASK;W(1)",
        "SI|DEF SIDE(SIZE, SPEED);F(SIZE, SPEED);R(9 DEG, 50);END_DEF;LOOP(3);SIDE(2, 60);END_LOOP",
    ],
)
def test_an_offset_inside_a_statement_is_not_a_place(text: str) -> None:
    debugged = DebuggedRobot(text)
    starts = statement_starts(debugged.image.code)
    for offset in range(len(debugged.image.code) + 3):
        assert debugged.places(offset) == (OK if offset in starts else BAD_VALUE), offset
    assert debugged.places(*starts[:4]) == OK
    assert debugged.places(*starts[:3], 1000) == BAD_VALUE


def test_invalid_breakpoint_requests_are_refused() -> None:
    robot, session = switched_on(), computer()
    assert robot.until(session, session.break_at((0,))) == STATUSES["NO_PROGRAM"]
    debugged = DebuggedRobot(DRIVE_PROGRAM)
    for payload in (b"\0", b"\0\0\0", b"\0" * 10):
        assert bytes((STATUSES["BAD_LENGTH"],)) in answer(debugged, "BREAK", payload)
    assert debugged.robot.until(debugged.session, debugged.session.resume(2)) == BAD_VALUE
    assert debugged.robot.until(debugged.session, debugged.session.read_variables(32)) == BAD_VALUE


def answer(debugged: DebuggedRobot, name: str, payload: bytes) -> bytes:
    """Return the robot's answer to a request that no session sends."""
    debugged.session._seq += 1
    frame = Frame(
        BY_NAME[name].number, debugged.session._seq & 255, debugged.session._epoch, payload
    )
    return debugged.robot.step(b"\0" + encode_frame(frame))


# -- code that never sees a trap -----------------------------------------------------------------

TASK_FROM_OPERAND = (
    "SI|W(3.5);SHOW(1);W(3.5);SHOW(2)"  # a trap there would make an operand an instruction
)


def test_a_start_finds_the_tasks_of_the_program_and_no_others() -> None:
    debugged = debug(TASK_FROM_OPERAND, 0)
    assert debugged.halt() == Halt(0, MAIN_TASK)
    assert [state for state, _, _ in debugged.tasks()[:MAIN_TASK]] == [0] * MAIN_TASK
    debugged.go()
    debugged.start()
    assert debugged.halt() == Halt(0, MAIN_TASK), "the next start, with places set"
    assert [state for state, _, _ in debugged.tasks()[:MAIN_TASK]] == [0] * MAIN_TASK


def test_a_halted_program_is_fetched_as_it_was_sent() -> None:
    debugged = debug(DRIVE_PROGRAM, 0, SECOND_MOVE_OFFSET, 5, 7)
    assert debugged.halt()
    assert fetch_image(debugged.robot, debugged.session)[15:] == debugged.image.code
    debugged.step()
    assert debugged.halt()
    assert fetch_image(debugged.robot, debugged.session)[15:] == debugged.image.code


def test_a_program_that_is_halted_is_saved_as_it_was_sent() -> None:
    robot, session = switched_on(), computer()
    image = image_of(DRIVE_PROGRAM)
    assert robot.until(session, session.upload(image, runs=False)) == OK
    assert robot.until(session, session.break_at((0, SECOND_MOVE_OFFSET, 5, 7))) == OK
    assert robot.until(session, session.start()) == OK
    wait_until_saved(robot, session)
    assert robot.complete(session, session.read_tasks()).is_halted
    restarted_robot = switched_on(robot.memory())
    assert fetch_image(restarted_robot, other_session := computer(7))[15:] == image.code
    assert restarted_robot.complete(other_session, other_session.status()).program == image.checksum


def test_a_place_is_reported_with_the_programs_checksum() -> None:
    debugged = debug(DRIVE_PROGRAM, SECOND_MOVE_OFFSET)
    assert debugged.halt()
    debugged.session.tells_places = True
    events = debugged.talk(1000)
    assert [(e.program, e.offset) for e in events if e.name == "PLACE"] == [
        (debugged.image.checksum, SECOND_MOVE_OFFSET)
    ]


def test_a_fault_is_reported_for_the_original_image() -> None:
    debugged = debug("SI|N = 0;SHOW(1 / N)", 0, SECOND_MOVE_OFFSET)
    assert debugged.halt() == Halt(0, MAIN_TASK)
    debugged.step()
    assert debugged.halt() == Halt(SECOND_MOVE_OFFSET, MAIN_TASK)
    debugged.go()
    fault = debugged.until(lambda event: event.name == "FAULT")
    assert isinstance(fault, FaultEvent) and fault.program == debugged.image.checksum


def test_the_board_finds_the_same_code_at_each_start_and_while_it_runs() -> None:
    """The robot for tests looks at the code that runs after each tick: CHANGED, UNVERIFIED."""
    debugged = debug(
        "SI|LOOP(5);F(0.1, 50) UNTIL(DISTANCE < 5);SHOW(1);END_LOOP", 0, SECOND_MOVE_OFFSET
    )
    while debugged.halt():
        debugged.step()
    assert not [line for line in debugged.robot.did if "CHANGED" in line or "UNVERIFIED" in line]


# -- ends of a run ---------------------------------------------------------------------------------

RUN_ENDS = (
    "stop",
    "button",
    "message",
    "lost",
    "undo",
    "program",
    "live",
    "start",
    "hello",
    "text",
)


@pytest.mark.parametrize("way", RUN_ENDS)
def test_whatever_ends_a_run_also_ends_a_halted_one(way: str) -> None:
    debugged = debug("SI|LOOP(FOREVER);F(0.2, 80);SHOW(1);END_LOOP", 1)
    robot, session = debugged.robot, debugged.session
    assert debugged.halt() == Halt(1, MAIN_TASK)
    expected = STATE_IDLE
    if way == "stop":
        session.stop(robot.now_ms)
        assert debugged.until(lambda event: event.name == "STOPPED")
        expected = STATE_STOPPED
    elif way == "button":
        robot.push()
        assert debugged.until(lambda event: event.name == "STOPPED")
        expected = STATE_STOPPED
    elif way == "message":
        session.end_run(session.run or 0, robot.now_ms)
        debugged.talk(100)
        expected = STATE_STOPPED
    elif way == "lost":
        robot.wait(1100)
        assert robot.did[-1].endswith("FAULTED")
        expected = STATE_FAULTED
    elif way == "undo":
        assert robot.until(session, session.undo()) == STATUSES["NO_PREVIOUS"]
    elif way == "program":
        assert robot.until(session, session.upload(image_of("SB|SHOW(1)"), saves=False)) == OK
    elif way == "live":
        assert robot.until(session, session.live(image_of("SI|SHOW(7)").code)) == OK
        assert debugged.until(lambda event: event.name == "DONE")
    elif way == "start":
        assert robot.until(session, session.start()) == OK
        assert debugged.halt() == Halt(1, MAIN_TASK), "it begins anew, and halts there again"
        expected = STATE_RUNNING
    elif way == "hello":
        debugged.session = computer(99)
        assert robot.until(debugged.session, debugged.session.hello()) == OK
    elif way == "text":
        robot.wait(5, b"\0")
        robot.wait(1200)
        robot.wait(100, b"SI|W(0.01)\n")
    assert state(debugged) == expected
    assert drives(robot.did) == [], "no motor has turned"
    if way not in ("program", "start", "text", "hello", "live"):
        assert fetch_image(robot, debugged.session)[15:] == debugged.image.code


@pytest.mark.parametrize("way", ["stop", "done", "start"])
@pytest.mark.parametrize("halted_ms", [100, 3000])
def test_a_run_after_a_halted_one_has_its_own_clock(way: str, halted_ms: int) -> None:
    debugged = debug("SI|W(0.5);SHOW(TIME)", 0)
    assert debugged.halt() == Halt(0, MAIN_TASK)
    debugged.talk(halted_ms)
    if way == "stop":
        debugged.session.stop(debugged.robot.now_ms)
        assert debugged.until(lambda event: event.name == "STOPPED")
        assert debugged.robot.until(debugged.session, debugged.session.clear()) == OK
    elif way == "done":
        debugged.go()
        assert debugged.until(lambda event: event.name == "DONE")
    assert debugged.places() == OK
    began_ms = debugged.robot.now_ms
    debugged.start()
    shown_left_event = debugged.until(lambda event: event.name == "SHOW")
    assert isinstance(shown_left_event, ShownEvent) and shown_left_event.value == 500
    assert debugged.robot.now_ms - began_ms < 600


def test_the_button_starts_the_verified_program_which_halts_again() -> None:
    debugged = debug("SI|F(0.2, 80);SHOW(1)", 0)
    assert debugged.halt() == Halt(0, MAIN_TASK)
    debugged.robot.push()
    debugged.talk(100)
    assert state(debugged) == STATE_STOPPED
    debugged.robot.push()
    assert debugged.halt() == Halt(0, MAIN_TASK)
    debugged.go()
    assert debugged.until(lambda event: event.name == "DONE")
    assert debugged.image.code == debugged.robot.codes()[-1]


def test_uploading_any_program_clears_the_breakpoints() -> None:
    debugged = debug("SI|W(0.05);SHOW(1)", 0)
    assert debugged.halt()
    for text in ("SI|W(0.05);SHOW(2)", "SI|W(0.05);SHOW(1)"):
        assert (
            debugged.robot.until(
                debugged.session, debugged.session.upload(image_of(text), saves=False)
            )
            == OK
        )
        assert debugged.halt() is None and debugged.events[-1].name == "DONE"


def test_a_new_session_has_no_breakpoints() -> None:
    debugged = debug("SI|W(0.05);SHOW(1)", 0)
    assert debugged.halt()
    debugged.session = computer(99)
    assert debugged.robot.until(debugged.session, debugged.session.start()) == OK
    assert debugged.halt() is None and debugged.events[-1].name == "DONE"


# -- parts that halt and parts that continue -------------------------------------------------------


def test_nothing_halts_without_a_client() -> None:
    robot = switched_on()
    debugged = DebuggedRobot("SI|LOOP(FOREVER);F(1.2, 80);END_LOOP", robot)
    assert debugged.places(1) == OK
    debugged.start(is_detached=True)
    assert debugged.halt() == Halt(1, MAIN_TASK)
    debugged.go()
    robot.wait(5000)
    assert len(drives(robot.did)) == 9
    assert not [line for line in robot.did if "FAULTED" in line], "a detached run goes on alone"


def test_a_halted_run_becomes_attached() -> None:
    debugged = DebuggedRobot("SI|LOOP(FOREVER);F(0.2, 80);W(0.2);END_LOOP")
    assert debugged.places(1) == OK
    debugged.start(is_detached=True)
    assert debugged.halt()
    debugged.robot.wait(1100)
    assert [line for line in debugged.robot.did if "FAULTED" in line]
    assert state(debugged) == STATE_FAULTED


def test_the_longest_run_time_counts_halts() -> None:
    debugged = DebuggedRobot("SI|W(5);SHOW(1)", switched_on(max_run_ms=3000))
    assert debugged.places(0) == OK
    debugged.start(is_detached=True)
    assert debugged.halt()
    assert debugged.until(lambda event: event.name == "FAULT") and state(debugged) == STATE_FAULTED


def test_a_halt_stops_the_motors_and_a_move_keeps_its_remaining_time() -> None:
    """Another task halts while a move of one second has 600 ms left."""
    debugged = DebuggedRobot("SI|TASK;F(1, 80);END_TASK;W(0.4);SHOW(1);W(2);SHOW(TIME)")
    show = statement_starts(debugged.image.code)[4]
    assert debugged.places(show) == OK
    debugged.start()
    halted_halt = debugged.halt()
    assert halted_halt is not None and halted_halt.task == MAIN_TASK
    assert [line.split(maxsplit=1)[1] for line in drives(debugged.robot.did)] == [
        "MOTORS 80 80",
        "MOTORS 0 0",
    ]
    [driving] = [task for task in debugged.tasks() if task[0] == 3]
    assert driving[2] == 600
    debugged.talk(700)
    debugged.go()
    assert debugged.halt() is None
    times = [int(line.split()[0]) for line in drives(debugged.robot.did)]
    assert times[1] - times[0] == 400 and times[3] - times[2] == 600
    shown_values = [event.value for event in debugged.events if event.name == "SHOW"]
    assert shown_values[-1] == 2400, "TIME stands while it is halted"


def test_a_measured_move_continues_with_its_rest() -> None:
    distances = []
    for is_halted in (False, True):
        robot = switched_on()
        robot.mount_discs(cm=100_000, degrees=20_000)
        debugged = DebuggedRobot("SI|TASK;F(30 CM, 80);END_TASK;W(0.2);SHOW(1)", robot)
        show = statement_starts(debugged.image.code)[4]
        assert debugged.places(*[show] * is_halted) == OK
        debugged.start()
        if is_halted:
            assert debugged.halt() == Halt(show, MAIN_TASK)
            debugged.talk(1000)
            halted_at = robot.wheel_edges()[0]
            debugged.talk(500)
            assert 0 < halted_at == robot.wheel_edges()[0], "it stands"
            debugged.go()
        assert debugged.halt() is None and debugged.events[-1].name == "DONE"
        debugged.talk(1000)
        distances.append(robot.wheel_edges()[0])
    assert abs(distances[1] - distances[0]) < 1.5, "edges"


def test_a_check_that_is_repeated_halts_once() -> None:
    debugged = DebuggedRobot("SI|LOOP(2);F(0.3, 40) UNTIL(DISTANCE < 10);END_LOOP;SHOW(1)")
    code = debugged.image.code
    _, check = statement_starts(code)[1:3]
    debugged.robot.set_readings(*[30_000] * len(KIT.sensors))
    assert debugged.places(check) == OK
    debugged.start()
    halts = []
    while (halt := debugged.halt()) is not None:
        halts.append(halt.offset)
        debugged.go()
    assert halts == [check, check], "once for each move"


def test_a_when_halts_once_until_it_has_gone_through() -> None:
    debugged = DebuggedRobot("SI|WHEN(LIGHT_R > 5);SHOW(1);END_WHEN;W(3)")
    check = statement_starts(debugged.image.code)[1]
    quiet, loud = ([0] * len(KIT.sensors) for _ in range(2))
    loud[KIT.names.index("LIGHT_R")] = 9000
    debugged.robot.set_readings(*quiet)
    assert debugged.places(check) == OK
    debugged.start()
    assert debugged.halt() == Halt(check, 0)
    debugged.go()
    assert debugged.halt(500) is None, "its check is FALSE again and again"
    debugged.robot.set_readings(*loud)
    assert debugged.halt() == Halt(check, 0), "once it has gone through it begins anew"
    assert [event.value for event in debugged.events if event.name == "SHOW"] == [1000]


def count_visits(image: Image, place: int) -> int:
    """Return how many times the Python machine begins the instruction at a place."""
    machine = Machine(image.code, TracedRobot(KIT, lambda sensor: 0), len(KIT.readings))
    count = now_ms = 0
    while True:
        is_there = machine.task.pc == place and now_ms >= machine.task.wake_ms
        outcome = machine.tick(now_ms, 1)
        count += is_there
        if outcome in ("done", "fault"):
            return count
        if outcome == "waiting":
            now_ms = max(now_ms + 1, machine.task.wake_ms)


def test_a_loop_around_one_statement_halts_each_time() -> None:
    for text in (
        "SI|N = 0;LOOP(4);N = N + 1;END_LOOP",
        "SI|LOOP(4);W(0);END_LOOP",
        "SI|N = 0;DEF MORE;N = N + 1;END_DEF;LOOP(4);MORE;END_LOOP",
        "SI|N = 0;LOOP(2);LOOP(2);N = N + 1;END_LOOP;LOOP(0);W(9);END_LOOP;END_LOOP;SHOW(N)",
        "SI|N = 0;WHILE(N < 3);N = N + 1;IF(N = 2);BREAK;ENDIF;END_WHILE;W(0.1)",
    ):
        debugged = DebuggedRobot(text)
        for offset in statement_starts(debugged.image.code):
            session = debugged.session
            assert debugged.robot.until(session, session.break_at((offset,))) == OK
            debugged.start()
            count = 0
            while debugged.halt() is not None:
                count += 1
                assert count < 20
                debugged.go()
            assert count == count_visits(debugged.image, offset), (text, offset, count)


def test_a_show_without_room_halts_once() -> None:
    robot = switched_on()
    robot.set_byte_ticks(40)
    debugged = debug("SI|LOOP(6);SHOW(1);END_LOOP", SECOND_MOVE_OFFSET, robot=robot)
    show = statement_starts(debugged.image.code)[1]
    assert debugged.places(show) == OK
    count = 0
    while debugged.halt(3000) is not None:
        count += 1
        debugged.go()
    assert count in (5, 6)  # the first may have been before its place was set


def test_a_halt_is_reported_repeatedly_but_a_session_passes_it_on_once() -> None:
    debugged = debug(DRIVE_PROGRAM, SECOND_MOVE_OFFSET)
    assert debugged.halt()
    number = bytes((BY_NAME["HALTED"].number | 0x80,))
    sent_bytes = b""
    for _ in range(1600):
        data = debugged.session.poll(debugged.robot.now_ms)
        piece = debugged.robot.step(data)
        sent_bytes += piece
        debugged.session.receive(piece, debugged.robot.now_ms)
    assert sent_bytes.count(number) >= 3
    assert not [event for event in debugged.session.events() if event.name == "HALTED"]
    debugged.step()
    assert debugged.halt() == Halt(5, MAIN_TASK)


def test_breakpoints_may_change_while_running_or_halted() -> None:
    debugged = debug("SI|N = 0;LOOP(FOREVER);W(0.1);N = N + 1;SHOW(N);END_LOOP")
    assert debugged.halt(300) is None
    _, _, _, add, show, _ = statement_starts(debugged.image.code)
    assert debugged.places(add) == OK
    assert debugged.halt() == Halt(add, MAIN_TASK)
    assert debugged.places(show) == OK
    debugged.go()
    assert debugged.halt() == Halt(show, MAIN_TASK)
    debugged.go()
    assert debugged.halt() == Halt(show, MAIN_TASK)
    assert debugged.places() == OK
    debugged.go()
    assert debugged.halt(500) is None and state(debugged) == STATE_RUNNING


@pytest.mark.parametrize("seed", range(6))
def test_a_program_halts_where_the_last_accepted_request_said(seed: int) -> None:
    """A refused request changes nothing, whichever of its places is wrong."""
    rng = Random(seed)
    it = debug("SI|N = 0;LOOP(FOREVER);W(0.1);N = N + 1;SHOW(N);N = N - 1;END_LOOP")
    starts = statement_starts(it.image.code)
    round_offsets = starts[2:-1]
    wrong_offsets = [offset for offset in range(len(it.image.code) + 9) if offset not in starts]
    accepted: set[int] = set()
    for _ in range(8):
        offsets = rng.sample(round_offsets, rng.randint(0, 3))
        is_wrong = rng.random() < 0.6
        if is_wrong:
            offsets.insert(rng.randint(0, len(offsets)), rng.choice(wrong_offsets))
        assert it.places(*offsets) == (BAD_VALUE if is_wrong else OK)
        accepted = accepted if is_wrong else set(offsets)
        reached = set()
        for _ in range(2 * len(round_offsets)):
            if it.is_halted():
                it.go()
            halt = it.halt(300)
            if halt is not None:
                reached.add(halt.offset)
        assert reached == accepted, (offsets, accepted)


def test_a_step_stays_in_its_task_unless_another_task_reaches_a_breakpoint() -> None:
    text = "SI|TASK;W(0.1);SHOW(1);W(0.1);SHOW(2);END_TASK;W(0.15);SHOW(8);W(1);SHOW(9)"
    debugged = DebuggedRobot(text)
    places = statement_starts(debugged.image.code)
    main = places.index(next(offset for offset in places if offset >= places[6]))
    assert debugged.places(places[1]) == OK
    debugged.start()
    assert debugged.halt() == Halt(places[1], 0)
    for place in places[2:6]:
        debugged.step()
        assert debugged.halt() == Halt(place, 0)
    assert main


def test_a_typed_program_also_halts() -> None:
    robot, session = switched_on(), computer()
    robot.wait(200, b"SI|LOOP(FOREVER);W(0.1);SHOW(1);END_LOOP\n")
    assert robot.until(session, session.hello()) == OK
    assert robot.complete(session, session.status()).state == STATE_RUNNING
    assert robot.until(session, session.break_at((1,))) == OK
    robot.talk(session, 500)
    assert robot.complete(session, session.read_tasks()).is_halted


def test_a_session_sets_breakpoints_only_on_robots_that_can_halt() -> None:
    debugged = DebuggedRobot(DRIVE_PROGRAM)
    assert debugged.session.robot
    features = debugged.session.robot.values.features & ~BREAKPOINTS
    debugged.session._handshake._take_features(features)
    assert (
        debugged.robot.until(debugged.session, debugged.session.break_at((0,)))
        == STATUSES["NO_BREAKPOINTS"]
    )
    assert debugged.robot.until(debugged.session, debugged.session.break_at(())) == OK


def test_a_line_asked_to_halt_does_so_before_its_first_statement() -> None:
    """It has no breakpoint when it runs again, and neither has the stored program."""
    debugged = DebuggedRobot(DRIVE_PROGRAM)
    code = image_of(DRIVE_PROGRAM).code
    assert debugged.robot.until(debugged.session, debugged.session.live(code, halts=True)) == OK
    assert debugged.halt() == Halt(0, MAIN_TASK) and debugged.variables()[0] == 0
    assert debugged.places(SECOND_MOVE_OFFSET) == OK and debugged.go()
    assert debugged.halt() == Halt(SECOND_MOVE_OFFSET, MAIN_TASK) and debugged.step()
    assert debugged.halt() and debugged.places() == OK and debugged.go()
    assert debugged.halt() is None and len(drives(debugged.robot.did)) == 4
    assert debugged.robot.until(debugged.session, debugged.session.live(code)) == OK
    assert debugged.halt() is None
    debugged.start()
    assert debugged.halt() is None


@pytest.mark.parametrize(
    "text",
    [
        "TASK;SHOW(1);END_TASK;SHOW(2)",
        "LOOP(2);SHOW(3);END_LOOP",
    ],
)
def test_a_halted_line_does_the_same_as_an_unhalted_one(text: str) -> None:
    variables = []
    for halts in (True, False):
        debugged = DebuggedRobot(DRIVE_PROGRAM)
        request = debugged.session.live(image_of(f"SI|{text}").code, halts=halts)
        assert debugged.robot.until(debugged.session, request) == OK
        while debugged.halt(200):
            assert halts
            debugged.go()
        variables.append([event.value for event in debugged.events if event.name == "SHOW"])
    assert variables[0] == variables[1] != []


@pytest.mark.parametrize(
    ("name", "extra_bytes"),
    [("PROGRAM", b"\0"), ("BEGIN", bytes((ISA_MAJOR, 0, 0, 16, 0, 0, 1, 0))), ("START", b"")],
)
def test_only_a_line_can_be_asked_to_halt(name: str, extra_bytes: bytes) -> None:
    debugged = DebuggedRobot(DRIVE_PROGRAM)
    mode = HALTS | RUN * (name != "START")
    assert bytes((BAD_VALUE,)) in answer(debugged, name, bytes((mode,)) + extra_bytes)
