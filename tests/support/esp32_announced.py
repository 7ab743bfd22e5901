"""An ESP32's real multicast DNS announcement: on 127.0.0.1, by zeroconf.

The firmware's calls of `MDNS` decide the announcements and their times: this repeats them.
"""

from __future__ import annotations

import threading
from typing import Any

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.esp32_radio import Radios, port_of, radios

LOOK_S = 0.1
PORT = 8473  # port that the firmware announces; robots on this computer use free ports


class AnnouncedNames:
    """Repeats what a robot announces until `close`."""

    def __init__(self, robot: Esp32PtyRobot) -> None:
        from zeroconf import Zeroconf

        self._robot = robot
        self._network = Zeroconf(interfaces=["127.0.0.1"])
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._thread.start()

    def __enter__(self) -> AnnouncedNames:
        return self

    def __exit__(self, *_: object) -> None:
        self._is_over.set()
        self._thread.join()
        self._network.close()

    def _follow(self) -> None:
        last_state: Any = None
        while not self._is_over.wait(LOOK_S):
            radios, number = self._read_radios()
            state = _info(radios, number) if radios.service else None
            if state == last_state:
                continue
            if last_state is not None:
                self._network.unregister_service(last_state)
            if state is not None:
                self._network.register_service(state)
            last_state = state

    def _read_radios(self) -> tuple[Radios, int]:
        packets: list[tuple[Radios, int]] = []

        def follow_radios(robot: HostFirmware) -> None:
            assert isinstance(robot, Esp32Robot)
            packets.append((radios(robot), port_of(robot)))

        self._robot.ask(follow_radios)
        return packets[0]


def _info(radios: Radios, number: int) -> Any:
    from zeroconf import ServiceInfo

    kind, port = radios.service.split()
    service = f"{kind}.local."
    return ServiceInfo(
        service, f"{radios.instance}.{service}", number if int(port) == PORT else int(port),
        addresses=[bytes((127, 0, 0, 1))], server=f"{radios.host}.local.",
    )  # fmt: skip
