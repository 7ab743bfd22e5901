"""A virtual robot for one command: it runs in the command's process, and on its terminal.

The command uses a socket, as with any other robot. Also finds a virtual robot that runs already:
`tsc robot` in another terminal.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from collections import deque
from threading import RLock
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.base.bell import Bell
from tiniscript.base.trace import Event
from tiniscript.cli.errors import CommandError
from tiniscript.cli.robot import simulator_options
from tiniscript.cli.robot.bookkeeping import Bookkeeping
from tiniscript.cli.terminal import FRAME_S, asking
from tiniscript.cli.texts import text
from tiniscript.robots.profile import Robot
from tiniscript.virtual import directory
from tiniscript.virtual.simulator import SimulatorThread

if TYPE_CHECKING:
    from tiniscript.cli.terminal.screen import Screen
    from tiniscript.cli.terminal.world_drawing import WorldPicture

LONGEST_ROUND_S = 1.0  # the longest round; a robot draws at least 15 pictures per second
SENT_EVENTS = ("SHOW", "DONE", "FAULT", "STOP")  # events that the robot also sends to its client
MAX_EVENTS = 10_000  # most events that wait to be read; the oldest are dropped


def running_address(options: Namespace) -> str | None:
    """Return the address of the only running virtual robot, or None if a new one is needed.

    Raises CommandError if several run, or if none runs and the verb cannot start one.
    """
    can_start = hasattr(options, "world")
    if can_start and simulator_options.needs_own_robot(options):
        return None
    running_robots = directory.unclaimed_robots() if can_start else directory.running_robots()
    if not running_robots and not can_start:
        raise CommandError(3, "no_virtual")
    if len(running_robots) > 1:
        raise CommandError(
            3, "which_virtual", known=", ".join(robot.address for robot in running_robots)
        )
    return running_robots[0].address if running_robots else None


class CommandSimulator(SimulatorThread):
    """The robot. It runs from the constructor until `close`. Raises CommandError."""

    turn_s = FRAME_S

    def __init__(self, options: Namespace, profile: Robot, language: str) -> None:
        hurry = simulator_options.hurry_of(options, language)
        faults = simulator_options.faults_of(options, language)
        self.end_ms = simulator_options.end_ms(options, language)
        self.options = options
        self.language = language
        self.screen: Screen | None = None
        self._picture: WorldPicture | None = None
        self._is_watched = False  # `start_drawing` was called
        self._bookkeeping = Bookkeeping()
        self._frame_s = 0.0
        self._draw_lock = RLock()
        self._round_bell = Bell()
        self._undrawn_events: deque[Event] = deque(maxlen=MAX_EVENTS)
        self._told_events: deque[Event] = deque(maxlen=MAX_EVENTS)  # values of `told_ms`
        self._round_count = 0  # rounds after which the picture is up to date
        robot = simulator_options.make_robot(options, profile, language)
        super().__init__(robot, options.verb, hurry, faults)
        self.simulator.duration_ms = self.end_ms
        self._thread.start()

    @property
    def is_time_over(self) -> bool:
        """Whether the time of `--for` is over.

        It begins with the first program, or with `start_drawing` if the program waits for the
        button.
        """
        return self._is_watched and self.simulator.is_over

    @property
    def is_drawn(self) -> bool:
        """Whether it is drawn on a terminal."""
        return sys.stderr.isatty() and not getattr(self.options, "json", False)

    def start_drawing(self, keys: str = "") -> None:
        """Draw it from now on, if there is a terminal. `keys` is the help for the keys."""
        if not self._is_watched:
            self._is_watched = True
            if self.end_ms is not None:
                self.simulator.end_ms = self.robot.now_ms + self.end_ms
        if not self.is_drawn:
            return
        from tiniscript.cli.terminal.screen import Screen
        from tiniscript.cli.terminal.world_drawing import WorldPicture

        with self._draw_lock:
            self.screen = Screen()
            if self._picture is None:
                self._picture = WorldPicture(self.robot, self.language, keys)
            self.screen.begin()

    def print_line(self, line: str) -> None:
        """Print a line, above the picture if there is one."""
        with self._draw_lock:
            if self.screen is not None:
                self.screen.print_line(line)
                return
        print(line, flush=True)

    def print_error(self, line: str) -> None:
        with self._draw_lock:
            if self.screen is not None and self.screen.is_shared:
                self.screen.print_line(line)
                return
        sys.stdout.flush()
        print(line, file=sys.stderr, flush=True)

    def event_ms(self, event: str) -> int:
        """Return the time of the robot's next event of this kind, since the start of its program.

        For an event that the robot has not reported itself (its values did not arrive), this is the
        current time.
        """
        event_text = "STOP" if event == "STOPPED" else event

        def has_event() -> bool:
            with self._draw_lock:
                return any(event.text == event_text for event in self._told_events)

        is_told = event_text.partition(" ")[0] in SENT_EVENTS and self._round_bell.wait_until(
            has_event, LONGEST_ROUND_S
        )
        with self._draw_lock:
            started_ms = self.robot.started_ms or 0
            if not is_told:
                return self.robot.now_ms - started_ms
            while True:
                told_event = self._told_events.popleft()
                if told_event.text == event_text:
                    return told_event.time_ms - started_ms

    def stop_drawing(self) -> None:
        """Stop drawing; the last picture stays."""
        if self.screen is not None:
            with self._draw_lock:
                wanted_round_count = self._round_count + 1  # the newest events are still under way
            self._round_bell.wait_until(
                lambda: self._round_count >= wanted_round_count, LONGEST_ROUND_S
            )
        with self._draw_lock:
            screen, self.screen = self.screen, None
            if screen is not None:
                if self._picture is not None:
                    self._picture.footer = ""  # the keys have no effect now
                self._draw(screen)
                screen.end()

    def close(self) -> None:
        """End the robot; print a summary, and draw the file of `--plot`."""
        try:
            super().close()
        finally:
            self.stop_drawing()
        if not self._is_watched:
            return
        if self.options.plot is not None:
            simulator_options.draw_picture(self.options, self.robot, self.language)
        is_json = getattr(self.options, "json", False)
        text = simulator_options.summary(
            self.options, self.robot, self.language, self._driving_ms()
        )
        print(text, file=sys.stderr if is_json else sys.stdout, flush=True)

    def _driving_ms(self) -> int:
        """Return the time from the start of the first program to the end of the last one."""
        started_ms, ended_ms = self.robot.started_ms, self.robot.ended_ms
        if started_ms is None:
            return 0
        return (self.robot.now_ms if ended_ms is None else ended_ms) - started_ms

    def on_turn(self) -> None:
        with self._draw_lock:
            events = self.robot.take_events()
            self._told_events.extend(event for event in events if event.kind in SENT_EVENTS)
            self._undrawn_events.extend(events)
            while self._picture is not None and self._undrawn_events:
                event = self._undrawn_events.popleft()
                if not self._bookkeeping.filter_trace_event(event.kind, event.values):
                    self._picture.add_event(event)
            if self.screen is not None and monotonic() >= self._frame_s:
                self._frame_s = monotonic() + FRAME_S
                self._draw(self.screen)
            self._round_count += 1
        self._round_bell.ring()

    def _draw(self, screen: Screen) -> None:
        if self._picture is not None:
            screen.draw(self._picture, self.robot.now_ms)


def offer_virtual_robot(language: str) -> bool:
    """Ask whether to use the virtual robot; an empty answer is yes."""
    answer = asking.ask(text("offer_virtual", language))
    return bool(answer) and answer.strip().lower()[:1] in ("", "y", "s")
