"""An ESP32 robot near the command, and its network."""

from __future__ import annotations

from pathlib import Path

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.esp32_radio import set_network_in_reach

NETWORK, PASSWORD = "Aula 3", b"a secret of the school"
DRIVE_PROGRAM = "SI|F(0.2, 80)"
DRIVE_ACTIONS = ["MOTORS 80 80", "MOTORS 0 0"]


def put_network_in_reach(robot: Esp32PtyRobot, password: bytes = PASSWORD) -> None:
    def reach(host_firmware: HostFirmware) -> None:
        assert isinstance(host_firmware, Esp32Robot)
        set_network_in_reach(host_firmware, NETWORK, password.decode())

    robot.ask(reach)


def list_motor_changes(robot: Esp32PtyRobot) -> list[str]:
    return [line for line in robot.actions if line.startswith("MOTORS")]


def files_with(folder: Path, words: bytes) -> list[str]:
    return [
        str(path) for path in folder.rglob("*") if path.is_file() and words in path.read_bytes()
    ]
