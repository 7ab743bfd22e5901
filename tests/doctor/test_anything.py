"""The doctor answers, and soon, whatever is at the other end and whatever the computer reports."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from tests.support.fake_computer import FakeComputer
from tests.support.simulated_ends import Firmware, UnpoweredEnd
from tests.support.simulated_wire import SimulatedWire
from tiniscript.doctor import computer, diagnosis
from tiniscript.doctor.examination import Expectations
from tiniscript.doctor.findings import CAUSES
from tiniscript.doctor.line import PortFacts, diagnose_line
from tiniscript.link.modules.talk import find_module

WORDS = (
    b"OK",
    b"ERROR:(0)\r\n",
    b"+VERSION:",
    b"+ROLE:0",
    b"OK+",
    b"\r\n",
    b"\x14\x10",
    b"\0",
    b"// ",
)
LONGEST_MS = 400_000  # simulated time after which a sender that never stops is left


class RandomEnd(UnpoweredEnd):
    """Sends words of modules, bootloaders and robots, and anything else."""

    def __init__(self, seed: int) -> None:
        super().__init__(random.Random(seed).choice((9600, 38400, 115200)))
        self.rng = random.Random(seed)
        self.rate = self.rng.choice((0.001, 0.02, 0.5))

    def answer(self, data: bytes) -> bytes:
        if self.rng.random() > self.rate and not data:
            return b""
        words = [self.rng.choice(WORDS) for _ in range(self.rng.randrange(4))]
        return b"".join([*words, self.rng.randbytes(self.rng.randrange(3)), data[:3]])


class DamagedFirmware(Firmware):
    """A robot with arbitrary fields, whose answers are sometimes damaged."""

    def __init__(self, seed: int) -> None:
        super().__init__()
        self.rng = random.Random(seed)
        for key, value in self.hello.items():
            if isinstance(value, int) and self.rng.random() < 0.3:
                self.hello[key] = self.rng.randrange(256)
        self.hello["name"] = self.rng.randbytes(self.rng.randrange(17))

    def answer(self, data: bytes) -> bytes:
        reply = bytearray(super().answer(data))
        if reply and self.rng.random() < 0.1:
            reply[self.rng.randrange(len(reply))] ^= 1 << self.rng.randrange(8)
        return bytes(reply)


@pytest.mark.sampled("seed", keep=7)
@pytest.mark.parametrize("seed", range(15))
@pytest.mark.parametrize("kind", [RandomEnd, DamagedFirmware])
def test_any_device_at_the_other_end_is_diagnosed(
    kind: type[RandomEnd | DamagedFirmware], seed: int
) -> None:
    for is_radio in (False, True):
        wire = SimulatedWire(kind(seed))
        findings = diagnose_line(
            wire, PortFacts(9600, is_radio, 1), Expectations(None, "", lambda kit: None)
        )
        assert findings and {finding.cause for finding in findings} <= set(CAUSES)
        assert wire.now_ms < LONGEST_MS
    find_module(SimulatedWire(RandomEnd(seed)))


@pytest.mark.parametrize("platform", ["linux", "darwin", "win32"])
@pytest.mark.parametrize("seed", range(10))
def test_any_output_of_system_tools_is_handled(tmp_path: Path, platform: str, seed: int) -> None:
    rng = random.Random(seed)
    parts = ('{"SPUSBDataType": [', "{}", "]}", "null", "[[", '"_items": 7', "Device", " ", ":",
             "\n", "USB\\VID_1A86&PID_7523", "BTHENUM\\DEV_000000000000", "\0", "é")  # fmt: skip

    class Any(FakeComputer):
        def output(self, *words: str) -> str | None:
            return "".join(rng.choice(parts) for _ in range(rng.randrange(12)))

    system = Any(tmp_path, platform)
    system.usb("1-1", *(rng.choice(("", "1a86", "7523", "\n")) for _ in range(2)))
    system.write("/etc/group", "".join(rng.choice(("a:x:20:b", ":", "\n")) for _ in range(9)))
    system.write("/sys/class/bluetooth/hci0/x", "")
    system.owners["/dev/x"] = (20, True)
    findings = diagnosis.inspect_computer(system)
    assert findings.bluetooth in (computer.ON, computer.OFF, computer.NONE, computer.UNKNOWN)
    diagnosis.port_access(system, "/dev/x")
