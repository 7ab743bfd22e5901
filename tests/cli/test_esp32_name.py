"""`tcp://NAME` and `tsc ports --ask` against the firmware of an ESP32, by real multicast DNS."""

from __future__ import annotations

from tests.cli.test_esp32_radio import asked, driving, joined, robot
from tests.support.command import inside
from tests.support.esp32_announced import Announced
from tests.support.esp32_pty_robot import Esp32PtyRobot
from tests.support.pty_robot import on

PLACE = "tcp://tini-5678"

__all__ = ("joined", "robot")


def is_listed() -> bool:
    rows = [row for row in inside("ports", "--ask").out.split("\n") if row.startswith(PLACE)]
    return any("announced in the network" in row and "robot tinibot (yours)" in row for row in rows)


def test_a_robot_is_found_and_driven_by_its_name(joined: Esp32PtyRobot) -> None:
    with Announced(joined):
        for place in (f"{PLACE}.local", PLACE):  # the last one is remembered
            assert inside("ping", "--port", place, "--count", "1").code == 0
        joined.until(is_listed, "it is listed")  # a busy computer misses what comes after 2 s
        command = driving(joined, PLACE)
        assert inside("stop", "--port", PLACE).code == 0
        assert not joined.moves
        command.ended()
        assert on(joined, "wifi", "--forget").code == 0
        assert asked(joined, "service") == ""
        joined.until(
            lambda: "announces itself" in inside("ping", "--port", PLACE).err, "it is silent"
        )
