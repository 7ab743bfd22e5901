"""Whatever real apps and modules send before and after a correct line, it runs, or an answer gives
the reason. No input is ignored silently.

`python -m tests.text.test_bytes_around 20000` tries more.
"""

from __future__ import annotations

import random
import re
from collections import Counter

import pytest

from tests.machines.host_firmware import HostFirmware
from tests.support.bytes_around import PIECES
from tests.support.campaign import each_seed, make_options
from tests.support.robot_on_host import KIT

LINE = "SI|BEEP(0.1,97);W(9)"
LINE_ENDS = (b"\n", b"\r\n", b"\r")
BEEPS = "BEEP 97 100"
# The bytes between two zeros are a frame unless each is one of a line; a damaged frame is not
# answered.
DAMAGED_FRAME = re.compile(rb"\0[^\0]*[^ -~\0][^\0]*\0")


class SmallRobot(HostFirmware):
    """A robot that, like an Uno, reads text into the place of its program."""

    has_draft = False


def draw_surroundings(rng: random.Random) -> list[bytes]:
    """Return random bytes before and after a line."""
    return [b"".join(rng.choices(PIECES, k=rng.choice((0, 1, 1, 2, 4)))) for _ in "12"]


def check(seed: int) -> str:
    rng = random.Random(seed)
    robot = rng.choice((HostFirmware, SmallRobot))(KIT)
    robot.wait(rng.choice((200, 4000)))
    bytes_before, bytes_after = draw_surroundings(rng)
    line, end = LINE.encode(), rng.choice(LINE_ENDS)
    is_spread = rng.random() < 0.7
    sent_bytes = b""
    for data in (bytes_before, line + end, bytes_after):
        if data:
            sent_bytes += robot.latched_while(len(data), data, is_spread)[0]
        sent_bytes += robot.wait(rng.choice((0, 0, 300, 1200)))
    sent_bytes += robot.wait(5000)
    if any(did.endswith(BEEPS) for did in robot.did):
        return "it runs"
    if b"// " not in sent_bytes and DAMAGED_FRAME.search(bytes_before + line + end + bytes_after):
        return "no line"
    is_answered = b"// " in sent_bytes or (
        bytes(4) in bytes_before and sent_bytes
    )  # a stop, by a frame
    assert is_answered, f"seed {seed}: {bytes_before!r} {end!r} {bytes_after!r} {sent_bytes!r}"
    return "an answer"


@pytest.mark.sampled("part")
@pytest.mark.parametrize("part", range(40))
def test_a_right_line_runs_or_is_answered_with_a_reason(part: int) -> None:
    counts = Counter(check(seed) for seed in range(part * 100, (part + 1) * 100))
    assert counts["it runs"] > 10 and counts["an answer"] > 10 and counts["no line"] < 4, counts


if __name__ == "__main__":
    each_seed(check, make_options(2000, 10_000))
