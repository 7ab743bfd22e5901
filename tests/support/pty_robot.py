"""A robot on a pseudo-terminal: the whole firmware in C++, in real time.

A computer opens `port`; in between is the terminal driver of this system, as with a cable. Time
goes by on the robot as on the wall, or slower where this computer is busy. Only if this process
itself opens the port, in `on`, is time the robot's: no one waits.
"""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path

from tests.machines.host_firmware import EMPTY_EEPROM, POWER_ON, HostFirmware
from tests.support import waiting
from tests.support.command import FOREVER, Command, CommandResult, run_in_process
from tests.support.simulated_port import STRIDE_MS, PtyPort, simulate
from tiniscript.base.kit import Kit

BUTTON_PRESSED, BUTTON_RELEASED, BUTTON_HELD = 1, 2, 32  # flags of a step
LARGEST_LAG_MS = 50  # largest lag before the robot's clock slows down


def drives_now(actions: Sequence[str]) -> bool:
    """Return whether the motors turn after these actions."""
    motor_lines = [line for line in actions if line.startswith("MOTORS")]
    return bool(motor_lines) and motor_lines[-1] != "MOTORS 0 0"


class PtyRobot(PtyPort):
    """A robot and its port; its UART takes and sends `bytes_per_ms`, 1 at 9600 baud."""

    def __init__(self, kit: Kit, memory: bytes = EMPTY_EEPROM, bytes_per_ms: int = 12) -> None:
        super().__init__()
        self.kit = kit
        self.bytes_per_ms = bytes_per_ms
        self.off_after: int | None = None  # bytes after which its battery is empty
        self._new_memory = self._memory = memory
        self._robot: HostFirmware | None = self._make_robot()
        self._flags: list[int] = []  # button events, one for each of the next steps
        self._to_robot, self._to_computer = b"", b""  # bytes on their way
        self._is_over = False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def __enter__(self) -> PtyRobot:
        return self

    def __exit__(self, *_: object) -> None:
        self.clear_away()

    @property
    def actions(self) -> list[str]:
        """The robot's actions since power-on, without the times."""
        return [line.split(" ", 1)[1] for line in self.timed_actions]

    @property
    def timed_actions(self) -> list[str]:
        with self._lock:  # an ESP32 answers over its network before its step is over
            assert self._robot
            return list(self._robot.did)

    @property
    def moves(self) -> bool:
        return drives_now(self.actions)

    @property
    def robot_ms(self) -> int:
        assert self._robot
        return self._robot.now_ms

    def say(self, data: bytes) -> None:
        """Write data to the port in the robot's place."""
        os.write(self.our_end, data)

    def ask(self, function: Callable[[HostFirmware], object]) -> None:
        with self._lock:
            assert self._robot
            function(self._robot)

    def push(self) -> None:
        """Push the button, and let it go."""
        self._flags = [BUTTON_PRESSED, *[0] * 20, BUTTON_RELEASED]

    def hold(self, milliseconds: int = 2300, after_ms: int = 0, times: int = 1) -> None:
        """Hold the button down, after a while; so many times, or until `let_go`."""
        press = [
            BUTTON_PRESSED,
            *[0] * 30,
            BUTTON_HELD,
            *[0] * (milliseconds - 32),
            BUTTON_RELEASED,
        ]
        self._flags = [*[0] * after_ms, *press] * times

    def let_go(self) -> None:
        if self._flags:
            self._flags = [BUTTON_RELEASED]

    def switch_off(self) -> None:
        """Switch the robot off: only its memory is kept."""
        with self._lock:
            self._take_power()

    def switch_on(self) -> None:
        with self._lock:
            self.off_after = None
            self._robot = self._make_robot(seed=0x9ABCDEF1)

    def power_cycle(self) -> None:
        self.switch_off()
        self.switch_on()

    def begin_anew(self) -> None:
        """Switch it off and on; its memory returns to its initial content."""
        with self._lock:
            self._take_power()
            self.off_after, self._memory = None, self._new_memory
            self._robot = self._make_robot()

    def pull(self) -> None:
        """Pull the cable out: the port is not there any more."""
        self._is_over = True
        self._thread.join()
        self._close()

    def clear_away(self) -> None:
        if not self._is_over:
            self.pull()
        if self._robot:
            self._robot.close()

    def until(self, is_reached: Callable[[], bool], description: str) -> None:
        """Wait until something is so."""
        waiting.until(is_reached, description)

    def standstill_after_ms(self, start_ms: int) -> int:
        """Wait until the motors are off; return how long that took of the robot's own time.

        It goes on like the time of the wall, and no further than this computer has come.
        """
        self.until(lambda: not self.moves, "it stands")
        off_actions = [line for line in self.timed_actions if line.split(" ", 1)[1] == "MOTORS 0 0"]
        return int(off_actions[-1].split()[0]) - start_ms

    def _make_robot(self, reset: int = POWER_ON, seed: int = 0x12345678) -> HostFirmware:
        """Return a robot that starts with its stored memory."""
        return HostFirmware(self.kit, self._memory, reset, seed)

    def _take_power(self) -> None:
        if self._robot:
            self._memory = self._robot.memory()
            self._robot.close()
        self._robot = None

    def advance_ms(self, milliseconds: int, data: bytes = b"") -> bytes:
        max_bytes = self.bytes_per_ms * milliseconds
        with self._lock:
            self._to_robot += data
            while milliseconds > 0:
                is_idle = not (self._to_robot or self._flags)
                stride = milliseconds if is_idle else 1
                milliseconds -= stride
                data = self._through_noise(self._to_robot[: self.bytes_per_ms])
                self._to_robot = self._to_robot[self.bytes_per_ms :]
                self.received += data
                if self.off_after is not None and data:
                    self.off_after -= len(data)
                    if self.off_after <= 0:
                        self._take_power()
                flags = self._flags.pop(0) if self._flags else 0
                if self._robot and is_idle:
                    self._to_computer += self._robot.wait(stride)
                elif self._robot:
                    self._to_computer += self._robot.step(data, flags)
            sent_bytes, self._to_computer = (
                self._to_computer[:max_bytes],
                self._to_computer[max_bytes:],
            )
            return self._through_noise(sent_bytes)

    def _run(self) -> None:
        last_s = time.monotonic()
        while not self._is_over:
            is_busy = self._to_robot or self._to_computer or self._flags
            ready_ends, _, _ = select.select(
                [self.our_end], [], [], (1 if is_busy else STRIDE_MS) / 1000
            )
            passed_ms = int((time.monotonic() - last_s) * 1000)
            if self.simulated or not passed_ms:
                time.sleep(0.001)
                last_s = time.monotonic() if self.simulated else last_s
                continue
            last_s += passed_ms / 1000
            sent_bytes = self.advance_ms(min(passed_ms, LARGEST_LAG_MS) - 1)
            sent_bytes += self.advance_ms(1, os.read(self.our_end, 4096) if ready_ends else b"")
            if sent_bytes:
                os.write(self.our_end, sent_bytes)


def on(pty_robot: PtyRobot, *arguments: str | Path, data: bytes = b"") -> CommandResult:
    """Run `tsc` on the robot's port, in this process and in the robot's time.

    With a command that keeps running, it is wall-clock time: the robot must not miss what the
    command sends.
    """
    with nullcontext() if Command.is_any_there() else simulate(pty_robot):
        return run_in_process(*arguments, "--port", pty_robot.port, data=data)


def start_endless_upload(pty_robot: PtyRobot, text: str = FOREVER) -> Command:
    """A program that runs, and the command that attends to it."""
    command = Command("upload", "-e", text, "--port", pty_robot.port)
    command.until("running")
    pty_robot.until(lambda: pty_robot.moves, "it drives")
    return command
