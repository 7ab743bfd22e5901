"""Lines that are pasted faster than an Uno reads them: one that is lost is told, whatever it is.

An Uno keeps 31 bytes of text that waits. At 115200 baud lines come sooner than it has read them,
and while it answers it reads none.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.firmware.test_typed_stops import SILENCE_MS, said, switched_on
from tests.machines.uno import needed
from tools.bench.link import built

BAUD = 115_200
LOST = "// Bytes were lost. Begin again."
LINES = (
    "F(0.1,80)", "SI|F(0.1,80)", "SB|F(0.1,80)", "SHOW(1)", "X=1", "HELP", "FOO", "(1)", "1=2",
    "S(", "PING|CHECK_CONNECTION", "ñandú", "F(0.1,80);" * 6,
)  # fmt: skip
TWENTY = 20


@pytest.fixture(scope="session")
def quick_sketch(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needed()
    return built(BAUD, tmp_path_factory.mktemp("sketch"))


@pytest.mark.parametrize("count", [TWENTY // 2, TWENTY])
@pytest.mark.parametrize("line", LINES, ids=lambda line: line[:20])
def test_a_pasted_line_that_is_lost_is_told(quick_sketch: Path, line: str, count: int) -> None:
    with switched_on(quick_sketch, BAUD) as uno:
        uno.run_ms(SILENCE_MS)
        uno.send(line.encode() + b"\r\n")
        uno.run_ms(SILENCE_MS)
        one = [each for each in said(uno, 0).splitlines() if each not in ("// DONE", "// 1", LOST)]
        before = len(uno.sent)
        uno.send((line.encode() + b"\r\n") * count)
        uno.run_ms(3 * SILENCE_MS)
        told = said(uno, before).splitlines()
        answers = sum(each in one for each in told)
        assert LOST in told or answers == len(one) * count, told
        assert LOST in told or count < TWENTY, "as twenty lines are, some are lost"
        before = len(uno.sent)
        uno.send(b"SI|SHOW(7)\n")
        uno.run_ms(100)
        assert said(uno, before).endswith("// 7\r\n// DONE\r\n")
