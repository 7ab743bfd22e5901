"""The slowest stop of a busy robot on a simulated Uno: from its last byte to the motor pins.

What else the chip does at that moment decides how long a stop takes, above all the interrupt of
the clock, which comes each 16,384 cycles. So the last byte is sent at many places of that period,
and then, cycle by cycle, around the slowest one. Meanwhile the robot runs a program that measures
with its sonar, sends values and reads text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from tiniscript import compile_text
from tiniscript.bytecode.image import unpack
from tiniscript.kit import Kit
from tools.uno import CYCLES_PER_MS, HERTZ

if TYPE_CHECKING:
    from tools.bench.link import Talk

# What keeps the robot busy while it is stopped: the machine, the echo, the EEPROM, the link.
BUSY = "SI|X = 0; LOOP(FOREVER); M(80, 80); DISTANCE; SHOW(X * 1.5 / 7); X = X + 1; END_LOOP"
TEXT = b"// nobody reads that\n", b"// nor this line, which nobody ends"
STOP = bytes(8)
STOP_RUN = 4
SONAR = "D4", "D3", 50.0  # trigger, echo, cm

PERIOD = 16_384  # cycles between two interrupts of the clock
COARSE = 64  # cycles: the interrupt takes longer
FINE, AROUND = 4, 64
BITS = 10  # of a byte on the wire
QUIET_MS = 25


class Slowest(NamedTuple):
    """Of how many stops, and microseconds."""

    stops: int
    us: float
    median_us: float


def slowest(talk: Talk, kit: Kit, baud: int, motors: tuple[str, ...]) -> Slowest:
    """Return the slowest of some hundred stops."""
    talk.board.sonar(*SONAR)
    talk.until(talk.session.upload(unpack(compile_text(BUSY, kit).image)))
    found = {at: stopped(talk, at, baud, motors) for at in range(0, PERIOD, COARSE)}
    center = max(found, key=lambda at: found[at])
    for at in range(center - AROUND, center + AROUND, FINE):
        found[at] = max(found.get(at, 0), stopped(talk, at, baud, motors))
    talk.session.stop(talk.board.cycle // CYCLES_PER_MS)
    talk.run(300)
    each = sorted(found.values())
    return Slowest(
        len(each), each[-1] / CYCLES_PER_MS * 1000, each[len(each) // 2] / CYCLES_PER_MS * 1000
    )


def stopped(talk: Talk, at: int, baud: int, motors: tuple[str, ...]) -> int:
    """Return the cycles of a stop whose last byte ends at a place of the clock's period."""
    board = talk.board
    talk.until(talk.session.clear())
    talk.until(talk.session.start())
    board.run_ms(QUIET_MS)  # nothing of the session is on the wire any more
    text = TEXT[at // FINE % len(TEXT)]
    cycles = (len(text) + STOP_RUN) * BITS * HERTZ // baud
    begin = board.cycle + CYCLES_PER_MS
    begin += (at - begin - cycles) % PERIOD
    since = len(board.events)
    board.send(text + STOP, begin)
    board.run_to(begin + cycles + 10 * BITS * HERTZ // baud)
    new = board.events[since:]
    zeros = [event.cycle for event in new if event.what == "received" and event["byte"] == 0]
    numbers = {board.pins.number(pin) for pin in motors}
    off = [
        event.cycle
        for event in new
        if event.what == "pin"
        and event.cycle > begin
        and event["is"] == "low"
        and board.pins.number(event["pin"]) in numbers
    ]
    talk.run(2 * QUIET_MS)
    return max(off) - zeros[STOP_RUN - 1]
