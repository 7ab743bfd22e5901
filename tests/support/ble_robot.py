"""Bluetooth LE modules for `fake_bluez`, and a robot on one: the host firmware on a pty.

Every byte goes through the radio module, the pseudo-terminal and the robot's UART, both ways.
"""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from contextlib import suppress

from tests.support.command import FOREVER, Command
from tests.support.pty_robot import PtyRobot

HM10 = "0000ffe0-0000-1000-8000-00805f9b34fb"
NORDIC = "6e400001-b5a3-f393-e0a9-e50e24dcca9e"
LAMP_SERVICE = "0000fff0-0000-1000-8000-00805f9b34fb"
WRITE_KINDS = ["write", "write-without-response"]
CHARACTERISTICS = {
    HM10: [("0000ffe1-0000-1000-8000-00805f9b34fb", ["read", WRITE_KINDS[1], "notify"])],
    NORDIC: [("6e400002-b5a3-f393-e0a9-e50e24dcca9e", WRITE_KINDS),
             ("6e400003-b5a3-f393-e0a9-e50e24dcca9e", ["notify"])],
    LAMP_SERVICE: [("0000fff1-0000-1000-8000-00805f9b34fb", WRITE_KINDS)],
}  # fmt: skip
ADDRESS = "AA:BB:CC:DD:EE:01"
NAME, ADDRESS_PORT = "ble://Tini 1", f"ble://{ADDRESS}"  # ports of the robot
DRIVE_PROGRAM = "SI|F(0.2, 80)"
DRIVE_ACTIONS = ["MOTORS 80 80", "MOTORS 0 0", "FINISHED"]


class Peripheral:
    """A module without a robot: it hears and says nothing.

    It is named after `late_rounds` advertisements. `failing_stage`: its connection ends at
    `connect`, `services` or `notify`; `parts_after`: after so many bytes that it has heard.
    """

    tell: Callable[[bytes], None]
    loop: asyncio.AbstractEventLoop

    def __init__(
        self, name: str, address: str = ADDRESS, service: str = HM10, mtu: int = 23
    ) -> None:
        self.name = name
        self.address = address
        self.service = service
        self.mtu = mtu
        self.characteristics = CHARACTERISTICS[service]
        self.is_on = True
        self.late_rounds = 0
        self.failing_stage = ""
        self.parts_after: int | None = None
        self.connections = 0
        self.writes: list[tuple[str, bytes]] = []  # kind and bytes of each write

    @property
    def received_data(self) -> bytes:
        return b"".join(data for _, data in self.writes)

    @property
    def is_over(self) -> bool:
        return self.parts_after is not None and len(self.received_data) >= self.parts_after

    def take(self, data: bytes, kind: str) -> None:
        self.writes.append((kind, data))

    def begin(self) -> None:
        """Somebody wants to hear it."""

    def part(self) -> None:
        """Disconnect the client."""

    def clear_away(self) -> None:
        pass


class Echo(Peripheral):
    """A module whose TX and RX are connected."""

    def take(self, data: bytes, kind: str) -> None:
        super().take(data, kind)
        self.loop.call_soon(self.tell, data)


class BleRobot(Peripheral):
    """A module with its robot. `late_s`: delay of each notification; `sent_packets` is all
    that the module has sent by radio.
    """

    def __init__(
        self, robot: PtyRobot, name: str = "Tini 1", address: str = ADDRESS, service: str = HM10,
        mtu: int = 23, late_s: float = 0.0,
    ) -> None:  # fmt: skip
        super().__init__(name, address, service, mtu)
        self.robot = robot
        self.late_s = late_s
        self.sent_packets: list[bytes] = []
        self._uart = os.open(robot.port, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        import tty

        tty.setraw(self._uart)

    def take(self, data: bytes, kind: str) -> None:
        super().take(data, kind)
        os.write(self._uart, data)

    def begin(self) -> None:
        import termios

        termios.tcflush(self._uart, termios.TCIFLUSH)
        self.loop.add_reader(self._uart, self._pass_on)

    def part(self) -> None:
        self.loop.remove_reader(self._uart)
        if self.service == HM10:
            with suppress(OSError):  # the robot is gone already
                os.write(self._uart, b"OK+LOST")  # the message of such modules

    def clear_away(self) -> None:
        self.loop.remove_reader(self._uart)
        os.close(self._uart)

    def _pass_on(self) -> None:
        data = b""
        with suppress(OSError):
            data = os.read(self._uart, self.mtu - 3)
        if not data:  # the robot is gone
            self.loop.remove_reader(self._uart)
            return
        self.sent_packets.append(data)
        if self.late_s:
            self.loop.call_later(self.late_s, self.tell, data)
        else:
            self.tell(data)


def start_endless_upload(ble: BleRobot, port: str = ADDRESS_PORT) -> Command:
    """A program that runs, and the command that attends to it."""
    command = Command("upload", "-e", FOREVER, "--port", port)
    command.until("running")
    ble.robot.until(lambda: ble.robot.moves, "it drives")
    return command
