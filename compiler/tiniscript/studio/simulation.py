"""A program on the virtual robot, for the page: the robot's firmware, its world and the link.

Time advances only on request. Knows no page and no clock.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from tiniscript.base.fixed_point import ONE
from tiniscript.base.trace import Event
from tiniscript.bytecode.image import unpack
from tiniscript.link.messages import HOLD_MS
from tiniscript.link.remote import NOTHING_PRESSED, RemoteState
from tiniscript.link.requests import OK
from tiniscript.studio.checking import profile_of
from tiniscript.studio.recordings import DOWN, HALT, HELD, UP, Row, Rows
from tiniscript.virtual.computer import Computer
from tiniscript.virtual.robot import Settings, VirtualRobot
from tiniscript.virtual.score import Score
from tiniscript.virtual.world import World

LONGEST_ANSWER_MS = 10_000  # time for a robot to answer
PUSH_MS = 60
FAULT_MS = 500  # time for a robot to report a fault
NONCE = 1  # the same program makes the same run
PART, BREAKPOINT = 1, 2  # marks in a program's code
MAX_CODE = 1 << 16  # bytes
REPEAT_GAP_MS = HOLD_MS // 10  # shortest time before held keys are sent again


class Marks(NamedTuple):
    """The places where a program may pause, and whether anything is watched.

    `part_offsets` are where parts of its text begin, `variable_count` how many variables it has;
    `is_held`: in front of the first part, too.
    """

    part_offsets: tuple[int, ...]
    breakpoints: tuple[int, ...] = ()
    variable_count: int = 0
    is_held: bool = False


class Simulation:
    """A robot at the start of a world, with the program.

    The program is held in front of its breakpoints, and after a step in front of the next part of
    its text. Time stops while it is held, so its behaviour does not change. For the same reason
    what somebody does waits for the next whole millisecond, and for the robot to have confirmed the
    program.
    """

    def __init__(
        self, robot: str, world: World, image: bytes, marks: Marks | None = None,
        settings: Settings | None = None,
    ) -> None:  # fmt: skip
        """Raises WorldRefused if the robot does not fit into the world."""
        profile = profile_of(robot)
        self.robot = VirtualRobot(profile, world, settings or Settings())
        self._score = Score(world)
        self._computer = Computer(self.robot, NONCE)
        self._begin_rows()
        self.session = self._computer.session
        self.is_stopped = False
        self.fault_at: int | None = None  # place of the last fault that the robot reported
        self.marks = marks or Marks(())
        self._mark_code()
        self._hold_before(is_stepping=self.marks.is_held)
        upload = self._upload = self.session.upload(unpack(image), runs=True, saves=True)
        self._until(lambda: upload.outcome is not None or self.held_at is not None)
        is_taken = upload.outcome is not None and upload.outcome.status == OK
        assert self.held_at is not None or is_taken, "not taken"
        self._hold_before(is_stepping=False)
        self.advance(0)

    def advance(self, duration_ms: int) -> None:
        """Advance time, unless the program pauses.

        After a fault a little longer, until the robot has reported its place.
        """
        self._advance(duration_ms)
        if not self.robot.fault:
            self.fault_at = None
        for _ in range(FAULT_MS):
            if not self.robot.fault or self.fault_at is not None:
                return
            self._advance(1)

    def set_breakpoints(self, breakpoints: Iterable[int]) -> None:
        """Hold the program in front of these offsets from now on, and of no others."""
        self.marks = self.marks._replace(breakpoints=tuple(breakpoints))
        self._mark_code()
        self._hold_before(is_stepping=False)

    def go_on(self) -> None:
        """Let a paused program run to the next breakpoint as time advances."""
        self.robot.go_on()

    def step(self, limit_ms: int) -> None:
        """Advance time until another part of the text is next, or the program has ended."""
        self._hold_before(is_stepping=True)
        self.robot.go_on()
        for _ in range(limit_ms):
            if self.held_at is not None or not self.robot.is_running:
                break
            self.advance(1)
        self._hold_before(is_stepping=False)

    @property
    def held_at(self) -> int | None:
        """Return the offset before which the program is paused, or None."""
        return self.robot.firmware.held_at

    def _mark_code(self) -> None:
        marks = bytearray(MAX_CODE)
        for offsets, bit in ((self.marks.part_offsets, PART), (self.marks.breakpoints, BREAKPOINT)):
            for offset in offsets:
                if 0 <= offset < MAX_CODE:
                    marks[offset] |= bit
        self.robot.firmware.mark(bytes(marks))

    def _hold_before(self, is_stepping: bool) -> None:
        bits = BREAKPOINT * bool(self.marks.breakpoints) | PART * bool(is_stepping)
        self.robot.firmware.hold_before(bits)

    def _begin_rows(self) -> None:
        self._rows = Rows()
        self._taken_count = 0  # rows already delivered
        self._events: list[Event] = []
        self._waiting_inputs: list[str] = []  # inputs of a person, for the next whole millisecond
        self._remote_state, self._pressed_ms = NOTHING_PRESSED, 0
        self._is_held_midway = False  # a millisecond: the program was held

    def _advance(self, duration_ms: int) -> None:
        for _ in range(duration_ms):
            if self.held_at is not None:
                break
            if not self._is_held_midway and self._upload.outcome is not None:
                self._apply_inputs()
            self._computer.wait(1)
            self._is_held_midway = self.held_at is not None
            self._score.update(self.robot)
        self._take_events()

    def _apply_inputs(self) -> None:
        """Pass a person's waiting inputs to the robot."""
        inputs, self._waiting_inputs = self._waiting_inputs, []
        for event in inputs:
            self._replay_event(event)
            self._note_event(event)

    def _replay_event(self, event: str) -> None:
        if event == DOWN:
            self.robot.press()
        elif event == UP:
            self.robot.let_go()
        else:
            remote_state = Row(0, event).remote_state
            assert remote_state is not None, event
            self.session.press(*remote_state)

    def _note_event(self, event: str) -> None:
        self._take_rows()
        self._rows.add(Row(self.robot.now_ms, event))

    def _take_rows(self) -> None:
        """Keep what the robot has done, as the file of a run has it."""
        events = self.robot.take_events()
        self._events += events
        for event in events:
            self._rows.add(Row(event.time_ms, event.text, event.offset))

    def rows(self) -> list[Row]:
        """Return the rows of the run since the last time, as its file has them."""
        self._take_rows()
        rows = self._rows.rows[self._taken_count :]
        self._taken_count = len(self._rows.rows)
        return rows

    @property
    def is_full(self) -> bool:
        """Return whether the run's file has no room for the next rows."""
        return self._rows.is_full

    def take_events(self) -> list[Event]:
        """Return the robot's actions since the last call."""
        self._take_rows()
        events, self._events = self._events, []
        return events

    def _take_events(self) -> None:
        for event in self.session.events():
            self.is_stopped = self.is_stopped or event.name == "STOPPED"
            if event.name == "FAULT":
                self.fault_at = event.offset

    def stop(self) -> None:
        """Stop the robot, as any computer at its line does, and wait until it has confirmed it.

        A held program does nothing more.
        """
        self.is_stopped = False
        self._note_event(HELD if self._is_held_midway else HALT)
        self.session.stop(self.robot.now_ms)
        self._until(lambda: self.is_stopped)

    def push(self) -> None:
        """Push the start button."""
        self._waiting_inputs.append(DOWN)
        self.advance(PUSH_MS)
        self._waiting_inputs.append(UP)
        self.advance(1)

    def press(self, keys: int, x: int, y: int) -> None:
        """Hold these keys of a remote control and its pad in this position until the next call, at
        most for half a second of the robot's time."""
        remote_state, now_ms = RemoteState(keys, x, y), self.robot.now_ms
        if remote_state == self._remote_state and (
            remote_state == NOTHING_PRESSED or now_ms - self._pressed_ms < REPEAT_GAP_MS
        ):
            return
        self._remote_state, self._pressed_ms = remote_state, now_ms
        self._waiting_inputs.append(f"KEYS {keys} {x} {y}")

    def close(self) -> None:
        self.robot.switch_off()

    def state(self) -> dict[str, Any]:
        """Return the visible state, and the events since the last call."""
        robot = self.robot
        x_cm, y_cm, heading = robot.pose
        touch_point = robot.driving.touch_point(robot.pose)
        kit = robot.profile.kit
        readings = [robot.sensing.peek(number, robot.pose) for number in range(len(kit.sensors))]
        return {
            "now_ms": robot.now_ms,
            "began_ms": robot.started_ms,
            "pose": [x_cm, y_cm, heading],
            "motors": [round(robot.driving.left), round(robot.driving.right)],
            "is_running": robot.is_running,
            "is_waiting": robot.is_lit and not robot.is_running,
            "fault": robot.fault,
            "fault_at": self.fault_at if robot.fault else None,
            "bumps": robot.driving.bumps,
            "touches": touch_point and list(touch_point),
            "score": self._score.state(),
            "rivals": [list(pose) for pose in robot.driving.rivals],
            "actuators": [
                None if (value := robot.actuators.get(k)) is None else value / ONE
                for k in range(len(kit.actuators))
            ],
            "turned": dict(robot.sensing.turn_of_actuator),
            "at": robot.offset if self.held_at is None else self.held_at,
            "places": robot.task_offsets,
            "driver": robot.driving_task_offset,
            "is_held": self.held_at is not None,
            "variables": [
                value / ONE for value in robot.firmware.variables(self.marks.variable_count)
            ],
            "readings": [
                {"value": value / ONE, "text": device.text(value)}
                for device, value in zip(kit.sensors, readings, strict=True)
            ],
            "events": [[event.time_ms, event.text, event.offset] for event in self.take_events()],
            "rows": [row.cells for row in self.rows()],
            "is_full": self.is_full,
        }

    def _until(self, is_over: Callable[[], bool]) -> None:
        """Advance time, also for a paused program."""
        for _ in range(LONGEST_ANSWER_MS):
            if is_over():
                return
            self._computer.wait(1)
            self._is_held_midway = self.held_at is not None
            self._take_events()
        raise AssertionError("the virtual robot does not answer")
