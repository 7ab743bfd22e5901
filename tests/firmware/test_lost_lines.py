"""Lines that are pasted faster than an Uno reads them: one that is lost is told, whatever it is.

An Uno keeps 31 bytes of text that waits. At 115200 baud lines come sooner than it has read them,
and while it answers it reads none.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.firmware.test_typed_stops import SILENCE_MS, said, switched_on
from tests.machines.uno import needed
from tools.bench.link import built
from tools.uno import Uno

BAUD = 115_200
LOST = "// Bytes were lost. Begin again."
LINES = (
    "F(0.1,80)", "SI|F(0.1,80)", "SB|F(0.1,80)", "SHOW(1)", "X=1", "HELP", "FOO", "(1)", "1=2",
    "S(", "PING|CHECK_CONNECTION", "ñandú", "F(0.1,80);" * 6,
)  # fmt: skip
TWENTY = 20
QUIET_MS = 700  # longer than a program of these lines


@pytest.fixture(scope="module")
def quick_uno(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Uno]:
    """A robot that has heard nothing for a second: tests go aside from there."""
    needed()
    with switched_on(built(BAUD, tmp_path_factory.mktemp("sketch")), BAUD) as uno:
        uno.run_ms(SILENCE_MS)
        yield uno


def told(uno: Uno, data: bytes) -> list[str]:
    """Return the lines that the robot says to this, until it is silent and no program runs."""
    before, seen = len(uno.sent), -1
    uno.send(data)
    while seen != len(uno.sent):
        seen = len(uno.sent)
        uno.run_ms(QUIET_MS)
    return said(uno, before).splitlines()


@pytest.mark.sampled("line", keep=2)
@pytest.mark.parametrize("line", LINES, ids=lambda line: line[:20])
def test_a_pasted_line_that_is_lost_is_told(quick_uno: Uno, line: str) -> None:
    uno, data = quick_uno, line.encode() + b"\r\n"
    with uno.aside():
        one = [each for each in told(uno, data) if each not in ("// DONE", "// 1", LOST)]
        for count in (TWENTY // 2, TWENTY):
            with uno.aside():
                many = told(uno, data * count)
                answers = sum(each in one for each in many)
                assert LOST in many or answers == len(one) * count, many
                assert LOST in many or count < TWENTY, "as twenty lines are, some are lost"
                before = len(uno.sent)
                uno.send(b"SI|SHOW(7)\n")
                uno.run_ms(100)
                assert said(uno, before).endswith("// 7\r\n// DONE\r\n")
