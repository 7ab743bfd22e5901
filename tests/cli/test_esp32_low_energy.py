"""`tsc` with bleak as it ships, and the Bluetooth LE of an ESP32, behind a BlueZ of the tests."""

from __future__ import annotations

from collections.abc import Iterator
from struct import pack

import pytest

from tests.machines.esp32 import Esp32Robot
from tests.machines.host_firmware import HostFirmware
from tests.support.ble_robot import NORDIC, PLACE, Peripheral
from tests.support.command import FOREVER, LONG, Command, process
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.fake_bluez import FakeBluez
from tests.support.pty_robot import on

LOOK_S = 0.005
DRIVES = "SI|F(0.2, 80)"


class Esp32Peripheral(Peripheral):
    """The robot's own radio: what its firmware notifies, as long as somebody is connected."""

    def __init__(self, robot: Esp32PtyRobot, mtu: int) -> None:
        super().__init__("tini-5678", service=NORDIC, mtu=mtu)
        self.robot = robot
        self.lengths: list[int] = []
        self.is_heard = False

    def radio(self, what: str, data: bytes = b"") -> bytes:
        said: list[bytes] = []

        def ask(found: HostFirmware) -> None:
            assert isinstance(found, Esp32Robot)
            said.append(found.radio(what, data))

        self.robot.ask(ask)
        return said[0]

    def take(self, data: bytes, kind: str) -> None:
        super().take(data, kind)
        self.radio("w", pack("<I", len(data)) + data)

    def begin(self) -> None:
        self.radio("c")
        if self.mtu != 23:
            self.radio("m", pack("<H", self.mtu))
        self.radio("s", b"\1")
        self.is_heard = True
        self._look()

    def part(self) -> None:
        self.is_heard = False
        self.radio("d")

    def _look(self) -> None:
        if not self.is_heard:
            return
        answer = self.radio("n")[4:]
        while answer:
            length = int.from_bytes(answer[:4], "little")
            self.lengths.append(length)
            self.tell(answer[4 : 4 + length])
            answer = answer[4 + length :]
        self.loop.call_later(LOOK_S, self._look)


@pytest.fixture
def robot() -> Iterator[Esp32PtyRobot]:
    found = Esp32PtyRobot("tinibotc3")
    with found:
        found.until(lambda: found.robot_ms > 300, "its radios have begun")
        yield found


@pytest.fixture
def bus(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeBluez]:
    with FakeBluez() as found:
        monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", found.address)
        yield found


@pytest.mark.parametrize(("mtu", "longest"), [(23, 20), (185, 60)])
def test_programs_one_after_the_other(
    robot: Esp32PtyRobot, bus: FakeBluez, mtu: int, longest: int
) -> None:
    radio = Esp32Peripheral(robot, mtu)
    bus.add(radio)
    for port in ("ble://tini-5678", PLACE):
        done = process("upload", "-e", DRIVES, "--port", port)
        assert done.code == 0, done.err
    assert process("upload", "-e", LONG, "--no-run", "--port", PLACE).code == 0
    assert [line for line in robot.did if "MOTORS" in line] == ["MOTORS 80 80", "MOTORS 0 0"] * 2
    assert 20 <= max(radio.lengths) <= longest
    assert radio.connections == 3


def test_a_stop_from_the_cable_and_a_radio_that_is_out_of_reach(
    robot: Esp32PtyRobot, bus: FakeBluez
) -> None:
    radio = Esp32Peripheral(robot, 23)
    bus.add(radio)
    for end in ("stop", "part"):
        command = Command("upload", "-e", FOREVER, "--port", PLACE)
        command.until("running")
        robot.until(lambda: robot.moves, "it drives")
        began_ms = robot.robot_ms
        if end == "stop":
            assert on(robot, "stop").code == 0
        else:
            bus.part(radio)
        took_ms = robot.stands_after_ms(began_ms)
        assert end == "stop" or took_ms < 1000
        assert command.ended().code == 3
    assert on(robot, "upload", "-e", DRIVES).code == 0, "the cable drives at once"
