"""A robot with an ESP32 on a pseudo-terminal: its sketch on a simulated chip, in real time."""

from __future__ import annotations

from tests.machines.esp32 import EMPTY_MEMORY, POWER_ON, TASK_WATCHDOG, Esp32Robot, Kept
from tests.machines.host_firmware import HostFirmware
from tests.support.pty_robot import PtyRobot
from tiniscript import robots


class Esp32PtyRobot(PtyRobot):
    """The robot of a profile. The contents of NVS survive power-off."""

    def __init__(self, name: str, seed: int = 0x12345678) -> None:
        """`seed` makes its id."""
        self.profile = robots.load(name)
        self.seed = seed
        self._kept_memory: Kept = EMPTY_MEMORY
        super().__init__(self.profile.kit)

    def hang(self, milliseconds: int) -> None:
        """Stop the main loop for a while."""

        def hang(robot: HostFirmware) -> None:
            assert isinstance(robot, Esp32Robot)
            robot.hang(milliseconds)
            robot.step(ticks=0)

        self.ask(hang)

    def restart(self) -> None:
        """Carry out the reset that the watchdog has requested."""
        with self._lock:
            self._take_power()
            self._robot = self._make_robot(TASK_WATCHDOG)

    def _make_robot(self, reset: int = POWER_ON, seed: int = 0) -> HostFirmware:
        return Esp32Robot(self.profile, self._kept_memory, reset, seed or self.seed)

    def _take_power(self) -> None:
        if self._robot:
            assert isinstance(self._robot, Esp32Robot)
            self._kept_memory = self._robot.read_kept()
            self._robot.close()
        self._robot = None
