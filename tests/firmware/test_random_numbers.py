"""Random numbers of a robot: a run begins with others than the one before."""

from __future__ import annotations

import pytest

from tests.firmware.test_host_firmware import KIT, computer, image_of
from tests.machines.host_firmware import HostFirmware
from tiniscript.link.payloads import ShowEvent


@pytest.mark.parametrize("noise", [0, 0xFFFF0000, 0x12345678])
def test_random_numbers_are_others_at_another_time(noise: int) -> None:
    """Also where the noise of a board is always the same."""
    found = set()
    for wait_ms in range(300, 320):
        robot, session = HostFirmware(KIT, seed=noise), computer()
        robot.wait(wait_ms)
        request = session.live(image_of("SI|SHOW(RANDOM(1, 10000))").code)
        assert robot.until(session, request) == 0
        robot.talk(session, 50)
        found |= {event.value for event in session.events() if isinstance(event, ShowEvent)}
    assert len(found) >= 9, "every second millisecond has numbers of its own"
