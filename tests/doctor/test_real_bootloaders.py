"""The bootloaders that boards come with, on a simulated board, greeted as the doctor does it."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

from tests.machines.bootloaders import bootloader
from tests.machines.uno import built, needed
from tests.support.simulated_ends import KIT
from tiniscript.doctor import line as greeting
from tiniscript.doctor.examination import Expected
from tiniscript.doctor.line import Line, looked
from tiniscript.link.ports import opened
from tiniscript.link.wire import SerialWire
from tools.uno import Uno

TRIES = 20  # a simulated board waits for its bootloader as long as a real one, however late it is
CLOSED_S = 0.05  # a pseudo-terminal has no DTR: opening it restarts the board


class Reopened(SerialWire):
    """A wire that restarts its board by opening the port again."""

    def __init__(self, port: str) -> None:
        self._open: Callable[[int], object] = lambda baud: opened(port, baud)
        super().__init__(self._open(9600))
        self._baud = 9600

    def set_baud(self, baud: int) -> None:
        self._baud = baud
        super().set_baud(baud)

    def restart(self) -> None:
        self.close()
        time.sleep(CLOSED_S)
        self._port = self._open(self._baud)


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    needed()


@pytest.mark.sampled("board", "name")
@pytest.mark.parametrize(
    ("board", "name"), [("uno", "uno"), ("nano", "nano-old"), ("mega", "mega")]
)
def test_a_board_with_a_sketch_that_is_silent(board: str, name: str) -> None:
    of = bootloader(board)
    with Uno(
        built("nothing"), board=of.board, bootloader=of.file, baud=of.baud, tells_sleep=False
    ) as uno:
        uno.go(speed=1.5)  # for it to be in time on a busy computer, too
        found = None
        for _ in range(TRIES):
            wire = Reopened(uno.pty)
            found = greeting.answers(wire)
            wire.close()
            if found is not None and not found[1]:
                break
    assert found is not None
    assert (found[0].name, found[1]) == (name, False)


def test_a_board_without_the_firmware() -> None:
    """No robot at any speed, no module, and then a bootloader."""
    with Uno(built("nothing"), bootloader=bootloader("uno").file, tells_sleep=False) as uno:
        uno.go(speed=1.5)  # for it to be in time on a busy computer, too
        expected = Expected(None, "tinibot", {KIT: "tinibot"}.get)
        for _ in range(TRIES):
            wire = Reopened(uno.pty)
            (finding,) = looked(wire, Line(9600, False, 1), expected)
            wire.close()
            if finding.cause == "other_sketch":
                break
    assert (finding.cause, finding.is_sure) == ("other_sketch", False)
