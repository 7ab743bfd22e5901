"""`tsc robot`: a virtual robot, on a port like any other robot."""

from __future__ import annotations

import errno
import os
import sys
from argparse import Namespace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from tiniscript.base.files import is_pipe
from tiniscript.base.trace import Event
from tiniscript.cli import inputs, outputs, streams
from tiniscript.cli.errors import CommandError
from tiniscript.cli.inputs import printable_name
from tiniscript.cli.options import decimal, name_bytes, whole_number
from tiniscript.cli.robot import simulator_options
from tiniscript.cli.robot.bookkeeping import Bookkeeping
from tiniscript.cli.terminal import FRAME_S
from tiniscript.cli.terminal.keys import Keys, is_in_front
from tiniscript.cli.terminal.screen import Screen
from tiniscript.cli.terminal.signals import handle_signals
from tiniscript.cli.terminal.world_drawing import WorldPicture
from tiniscript.cli.texts import say_aside, text
from tiniscript.library import install_advice, opening
from tiniscript.link.keys import KeyFile
from tiniscript.virtual import directory
from tiniscript.virtual.computer import Computer
from tiniscript.virtual.robot import VirtualRobot
from tiniscript.virtual.simulator import HOLD_MS, IDLE_S, PUSH_MS, Simulator
from tiniscript.virtual.transports import Transports, can_have_terminal

if TYPE_CHECKING:
    from tiniscript.virtual.announcement import Announcement

MAX_MEMORY_BYTES = 1_000_000  # most bytes of a robot's memory file; an ESP32's has 16,640
SAVE_INTERVAL_S = 1.0  # interval between two looks at the robot's stored data
QUIT_KEYS = "qQ\x04"


def run(options: Namespace, language: str) -> int:
    profile = inputs.robot(options, language)
    port = whole_number("--listen", options.listen, 0, 0, 65535, language)
    usual_baud, fastest_baud = profile.board.baud, opening.FASTEST_BAUD
    baud = whole_number("--baud", options.baud, usual_baud, 0, fastest_baud, language)
    pushes = sorted(
        [(time_ms, PUSH_MS) for time_ms in _pushes_ms("--button-at", options.button_at)]
        + [(time_ms, HOLD_MS) for time_ms in _pushes_ms("--hold-at", options.hold_at)]
    )
    end_ms = simulator_options.end_ms(options, language)
    hurry = simulator_options.hurry_of(options, language)
    faults = simulator_options.faults_of(options, language)
    memory = _memory(options.memory)
    robot = simulator_options.make_robot(options, profile, language, memory, baud)
    if memory is not None and len(memory) != len(robot.memory):
        size = str(len(robot.memory))
        raise CommandError(2, "bad_memory", file=printable_name(options.memory), bytes=size)
    if options.name is not None:
        _set_name(robot, options.name)
    transports = _transports(port, options.pty)
    note_path, announcement = None, None
    try:
        if options.announce:
            name = options.name or f"{profile.name}-{transports.port}"
            announcement = _announcement(name, transports.port)
        running_robot = directory.RunningRobot(
            transports.address, robot.profile.name, robot.world.name, options.name or "",
            transports.terminal,
        )  # fmt: skip
        note_path = directory.announce(running_robot)
        simulator = Simulator(robot, transports, hurry, faults)
        simulator.end_ms = end_ms
        stage = _Stage(simulator, options, language)
        stage.announced_port = announcement.port if announcement is not None else ""
        stage.show(pushes, end_ms)
    finally:
        directory.withdraw(note_path)
        if announcement is not None:
            announcement.close()
        transports.close()
    return 0


class _Stage:
    """The output of the robot: a picture on the terminal, or lines."""

    def __init__(self, simulator: Simulator, options: Namespace, language: str) -> None:
        self.simulator = simulator
        self.options = options
        self.language = language
        self.screen: Screen | None = None
        self.picture: WorldPicture | None = None
        self.announced_port = ""  # the port by which it is found
        self.began_ms = 0  # start time of the program whose lines are printed
        self._bookkeeping = Bookkeeping()
        self._saved_memory = simulator.robot.memory
        self._last_save_s = monotonic()
        self._frame_s = 0.0

    def show(self, pushes: list[tuple[int, int]], end_ms: int | None) -> None:
        """Run the robot until its time is over or the user ends it."""
        robot = self.simulator.robot
        self._print_addresses()
        try:
            with Keys() as keys, handle_signals() as end_request:
                self._begin()
                while not end_request.is_set and (end_ms is None or robot.now_ms < end_ms):
                    if pushes and robot.now_ms >= pushes[0][0]:
                        self.simulator.push(pushes.pop(0)[1])
                    self.simulator.turn(self._timeout_s(pushes, end_ms))
                    self._print_events(robot.take_events())
                    self._save_state(is_forced=False)
                    if not self._handle_keys(keys.read_keys()):
                        break
        except KeyboardInterrupt:
            streams.drop_unread_output()
        finally:
            robot.switch_off()  # motors that still run belong to the output
            if self.screen is not None and self.picture is not None:
                for event in robot.take_events():
                    self.picture.add_event(event)
                self.screen.draw(self.picture, robot.now_ms)
                self.screen.end()
            self._save_state(is_forced=True)
        if self.options.plot is not None:
            simulator_options.draw_picture(self.options, robot, self.language)
        print(simulator_options.summary(self.options, robot, self.language), file=sys.stderr)

    def _print_addresses(self) -> None:
        transports, robot = self.simulator.transports, self.simulator.robot
        print(transports.address, flush=True)
        if transports.terminal:
            print(transports.terminal, flush=True)
        if self.announced_port:
            print(printable_name(self.announced_port), flush=True)
        language = self.language
        name = printable_name(self.options.name or "") or robot.profile.labels[language]["robot"]
        say_aside("robot_here", language, robot=name, world=robot.world.labels[language])

    def _begin(self) -> None:
        if not (sys.stderr.isatty() and is_in_front()):
            return
        keys = text("robot_keys", self.language) if sys.stdin.isatty() else ""
        self.screen = Screen()
        self.picture = WorldPicture(self.simulator.robot, self.language, keys)
        self.screen.begin()

    def _timeout_s(self, pushes: list[tuple[int, int]], end_ms: int | None) -> float:
        """Return the time until the next action is due."""
        limits_s = [FRAME_S if self.screen else IDLE_S]
        for due_ms in (
            *(time_ms for time_ms, _ in pushes[:1]),
            *([end_ms] if end_ms is not None else []),
        ):
            limits_s.append(max(0.001, (due_ms - self.simulator.robot.now_ms) / 1000))
        return min(limits_s)

    def _print_events(self, events: list[Event]) -> None:
        prints_lines = self.screen is None or not sys.stdout.isatty()
        for event in events:
            if self._bookkeeping.filter_trace_event(event.kind, event.values):
                continue
            if event.kind == "START":
                self.began_ms = event.time_ms
            if self.picture is not None:
                self.picture.add_event(event)
            if prints_lines:
                print(f"{event.time_ms - self.began_ms} {event.text}")
        if events and prints_lines:
            sys.stdout.flush()
        self._draw()

    def _draw(self) -> None:
        if self.screen is not None and self.picture is not None:
            if monotonic() >= self._frame_s:
                self._frame_s = monotonic() + FRAME_S
                self.screen.draw(self.picture, self.simulator.robot.now_ms)

    def _handle_keys(self, keys: str) -> bool:
        """Handle keys; return whether to continue."""
        for key in keys:
            if key in QUIT_KEYS:
                return False
            if key in "bB ":
                self.simulator.push()
            elif key in "hH":
                self.simulator.push(HOLD_MS)
            elif key in "rR":
                self.simulator.robot.power_cycle(2)
            elif key in "pP":
                self.simulator.robot.power_cycle()
        return True

    def _save_state(self, is_forced: bool) -> None:
        """Write the robot's EEPROM to its file, if it has changed."""
        if self.options.memory is None or not (
            is_forced or monotonic() > self._last_save_s + SAVE_INTERVAL_S
        ):
            return
        self._last_save_s = monotonic()
        memory = self.simulator.robot.memory
        if memory != self._saved_memory or is_forced:
            outputs.write(Path(self.options.memory), memory, "unwritable_at --memory")
            self._saved_memory = memory


def _transports(port: int, has_terminal: bool) -> Transports:
    if has_terminal and not can_have_terminal():
        raise CommandError(2, "no_pty")
    try:
        return Transports(port, has_terminal)
    except OSError as error:
        raise CommandError(3, "listen_taken", port=str(port), why=error) from None


def _announcement(name: str, port: int) -> Announcement:
    try:
        from tiniscript.virtual.announcement import Announcement, NameTaken
    except ImportError as error:
        install_command = install_advice.command(install_advice.RADIO)
        reason = error.name or ""
        raise CommandError(
            2, "port_not_installed", port="--announce", why=reason, how=install_command
        ) from None
    try:
        return Announcement(name, port)
    except NameTaken:
        raise CommandError(3, "name_taken", name=printable_name(name)) from None
    except OSError as reason:
        raise CommandError(3, "no_announcement", why=reason) from None


def _pushes_ms(option: str, typed_times: str | None) -> list[int]:
    if typed_times is None:
        return []
    values = [decimal(part.strip()) for part in typed_times.split(",")]
    pushes_ms = [value for value in values if value is not None and value >= 0]
    if len(pushes_ms) != len(values):
        raise CommandError(
            2, "bad_button", option=option, found=printable_name(typed_times) or "''"
        )
    return pushes_ms


def _memory(name: str | None) -> bytes | None:
    """Return the memory of a robot from a file; a missing file means a new robot."""
    if name is None:
        return None
    if is_pipe(name):
        raise CommandError(
            2, "unreadable_memory", file=printable_name(name), why=os.strerror(errno.ESPIPE)
        )
    try:
        with Path(name).open("rb") as file:
            return file.read(MAX_MEMORY_BYTES)
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise CommandError(2, "unreadable_memory", file=printable_name(name), why=error) from None


def _set_name(robot: VirtualRobot, name: str) -> None:
    """Name the robot as `tsc set name` does, before any client connects."""
    data = name_bytes(name)
    keys = KeyFile(serves_virtual_robots=True)
    computer = Computer(robot, robot.random_source.getrandbits(32), keys)
    computer.wait_for(computer.session.name(data))
    robot.step(robot.now_ms + 500)  # time for the robot to save
    robot.power_cycle()
