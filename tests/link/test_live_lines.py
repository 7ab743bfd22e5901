"""Live lines over a bad radio: a line whose answer is lost is sent again, but never executed twice.

`python -m tests.link.test_live_lines 1000000` sends more of them than the tests.
"""

from __future__ import annotations

import random
from collections import Counter

from tests.machines.link import CppLink, cpp_link, link_library
from tests.support.campaign import make_options
from tests.support.link_channel import OUTCOMES, World
from tiniscript.bytecode.image import pack, unpack
from tiniscript.bytecode.opcodes import BY_NAME as OPCODES
from tiniscript.link.frames import decode_frame
from tiniscript.link.messages import BY_NAME
from tiniscript.link.statuses import name_of

LINE_COUNT = 2000  # in the tests
LINES = 50  # of one robot
SEED = 4
LIVE = BY_NAME["LIVE"].number


class LiveWorld(World):
    """`sent_count` counts how often lines are sent, including repeats."""

    sent_count = 0

    def overhear(self, data: bytes) -> None:
        frame = decode_frame(data.strip(b"\0"))
        self.sent_count += frame is not None and frame.number == LIVE and not frame.is_reply


def send_live_lines(cpp: CppLink, count: int, seed: int) -> Counter[str]:
    """Send so many lines, each with its own code, over radios that lose answers; return the
    results. A line that the computer confirms begins once, and no line twice.
    """
    rng = random.Random(seed)
    counts: Counter[str] = Counter()
    for first_number in range(0, count, LINES):
        world = LiveWorld(cpp, rng, rng.choice((0.001, 0.005, 0.01)), rng.choice((0, 0.0005)))
        for number in range(first_number, min(first_number + LINES, count)):
            world.sent_count = 0
            request = world.session.live(line_of(number))
            world.run(request)
            assert request.outcome, f"seed {seed}, line {number} has no end"
            status = request.outcome.status
            times = Counter(row for row in world.did if row.startswith("TAKE"))
            image = pack("SI", 0, line_of(number))
            take_count = times[f"TAKE live {unpack(image).checksum:08x}"]
            assert take_count == 1 if status == 0 else take_count <= 1, (
                f"seed {seed}, line {number}: {take_count}"
            )
            assert set(times.values()) <= {1}, f"seed {seed}: an earlier line again, {number}"
            start_count = sum(row.startswith("START") for row in world.did)
            assert start_count == len(times), f"seed {seed}, line {number}: {start_count} starts"
            counts[OUTCOMES.get(status) or name_of(status)] += 1
            counts["sent again"] += world.sent_count > 1
            if status != 0:
                world.reconnect()
    return counts


def line_of(number: int) -> bytes:
    """Return code that no other line has."""
    move = OPCODES["MOVE8_F"].code
    digits = (number // 100**k % 100 for k in range(4))
    return b"".join(bytes((move, 1, digit)) for digit in digits)


def test_live_lines_survive_a_bad_radio() -> None:
    """None is executed twice, however many times its answer is lost."""
    counts = send_live_lines(cpp_link(), LINE_COUNT, SEED)
    assert counts["OK"] > LINE_COUNT * 0.8 and counts["sent again"] > LINE_COUNT * 0.1, counts


if __name__ == "__main__":
    options = make_options(100_000, 1_000_000)
    print(send_live_lines(link_library(), options.count, options.seed))
