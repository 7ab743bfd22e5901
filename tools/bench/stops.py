"""The slowest stop of a busy robot on a simulated chip: from its last byte to the motor pins.

What else the chip does at that moment decides how long a stop takes: an interrupt that is at work,
or a part of the program that keeps interrupts off. So the last byte is sent at many places: all
over the period of the clock, more often around the slowest one, and there with an edge of an echo
just before, or with one of each disc. Meanwhile the robot runs a program that measures, plays,
sends values and reads text.

No sweep meets all of that at once. So the simulator also tells for how long each place keeps
interrupts off, and what may come before a stop is added up.
"""

from __future__ import annotations

import random
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from tests.support.images import image_of
from tiniscript.base.kit import Kit
from tiniscript.robots.profile import Robot
from tools.bench.firmware_stack import BOARDS, SEEN_BITS, all_devices, connect, pin, require_ok
from tools.uno import CYCLES_PER_MS, HERTZ, Masked, Uno

TEXT = b"// nobody reads that\n", b"// nor this line, which nobody ends"
STOP = bytes(8)
STOP_ZEROS = 4

PERIOD = 16_384  # cycles between two interrupts of the clock
COARSE = 64  # cycles: the interrupt takes longer
FINE, AROUND = 4, 64
ECHOES = range(-160, 33, 8)  # cycles
EDGES = range(-480, 33, 16)  # of both discs
SHORT_ECHO, LONG_ECHO = 1000, 8000  # cycles
BITS_PER_BYTE = 10  # of a byte on the wire
QUIET_MS = 25
PING_MS = 100  # pings are less apart
RECEIVE_INTERRUPT = {"uno": 18, "mega": 25}  # the number of the interrupt that sees a stop
INSTRUCTION = 4  # cycles of the longest one


class Place(NamedTuple):
    """Where a stop falls: a cycle of the clock's period, and cycles from it to an edge: of an echo,
    or of each disc.
    """

    at: int
    echo: int | None = None
    is_rise: bool = False
    edge: int | None = None


class Slowest(NamedTuple):
    """Of how many stops, and microseconds; `together` is what they would take at most."""

    stop_count: int
    us: float
    median_us: float
    together_us: float


class Busy:
    """A busy robot on a simulated chip, to be stopped again and again."""

    def __init__(self, firmware: Path, robot: Robot, board: str, baud: int) -> None:
        """Switch it on; `board` is that of the firmware, which may be another than the robot's."""
        self.robot, self.baud, self.cycles = robot, baud, list[int]()
        self.chip = Uno(
            firmware, board=BOARDS[board], baud=baud, tells_sleep=False, watches_masked=True
        )
        self._motors = {pin(robot, number) for number in robot.board.motors.pins.values()}
        self._sonar = ""
        for device in robot.board.sensors:
            if device.driver == "hc_sr04":
                self._trigger, self._sonar = (
                    pin(robot, device.pins[name]) for name in ("trigger", "echo")
                )
                self.chip.sonar(self._trigger, self._sonar, None)
        discs = robot.board.discs
        self._discs = [pin(robot, number) for number in discs.pins.values()] if discs else []
        self._level = False  # of the discs
        for name in self._discs:
            self.chip.drive(name, self._level)
        self._wired = connect(self.chip, robot, baud)
        require_ok(self._wired, self._wired.session.hello())
        require_ok(self._wired, self._wired.session.upload(image_of(busy(robot.kit), robot.kit)))

    def __enter__(self) -> Busy:
        return self

    def __exit__(self, *raised: object) -> None:
        self.chip.close()

    @property
    def has_echo(self) -> bool:
        return self._sonar != ""

    @property
    def has_discs(self) -> bool:
        return self._discs != []

    def stop(self, place: Place) -> int:
        """Return the cycles of a stop whose last byte comes at a place."""
        chip, session = self.chip, self._wired.session
        require_ok(self._wired, session.clear())
        require_ok(self._wired, session.start())
        chip.run_ms(QUIET_MS)  # nothing of the session is on the wire any more
        text = TEXT[place.at // FINE % len(TEXT)]
        if place.echo is not None:  # which the robot waits for only after a ping
            text = text[:1]
            chip.run_until(self._trigger, "high", PING_MS)
            chip.run_until(self._trigger, "low", PING_MS)
        bit = HERTZ / self.baud
        cycles = round((len(text) + STOP_ZEROS - 1) * BITS_PER_BYTE * bit + SEEN_BITS * bit)
        begin = chip.cycle + CYCLES_PER_MS
        begin += (place.at - begin - cycles) % PERIOD
        last = begin + cycles
        if place.echo is not None:
            before = SHORT_ECHO if place.is_rise else LONG_ECHO
            chip.drive(self._sonar, not place.is_rise, at=last + place.echo - before)
            chip.drive(self._sonar, place.is_rise, at=last + place.echo)
        if place.edge is not None:
            self._level = not self._level
            for name in self._discs:
                chip.drive(name, self._level, at=last + place.edge)
        event_count = len(chip.events)
        chip.send(text + STOP, begin)
        chip.run_to(last + round(BITS_PER_BYTE * BITS_PER_BYTE * bit))
        new = chip.events[event_count:]
        zeros = [event.cycle for event in new if event.what == "received" and event["byte"] == 0]
        off_cycles = [
            event.cycle
            for event in new
            if event.what == "pin"
            and event.cycle > begin
            and event["is"] == "low"
            and event["pin"] in self._motors
        ]
        self._wired.run(2 * QUIET_MS)
        self.cycles.append(max(off_cycles) - zeros[STOP_ZEROS - 1])
        return self.cycles[-1]

    def together(self) -> int:
        """Return the cycles of a stop before which all comes that may: once, at its longest."""
        received = RECEIVE_INTERRUPT[self.chip.board]
        spans = [item for item in self.chip.longest_masked() if item.vector != received]
        entries = {span.vector: span.cycle_count for span in spans if _is_before(span, received)}
        before = max(
            span.cycle_count + sum(entries[vector] for vector in entries if vector != span.vector)
            for span in spans
        )
        return min(self.cycles) + INSTRUCTION + before


def _is_before(place: Masked, received_cycle: int) -> bool:
    """Return whether it is an interrupt that is served before the one of a byte."""
    return place.is_entry and 0 < place.vector < received_cycle


def busy(kit: Kit) -> str:
    """Return a program that measures, moves what can move, plays and sends without end."""
    lines = ["X = 0", "LOOP(FOREVER)", "M(80, 80)", *all_devices(kit), "BEEP(0.005, 5000)"]
    return "SI|" + "; ".join([*lines, "SHOW(X * 1.5 / 7)", "X = (X + 1) % 100", "END_LOOP"])


def slowest(firmware: Path, robot: Robot, board: str, baud: int) -> Slowest:
    """Return the slowest of some hundred stops."""
    with Busy(firmware, robot, board, baud) as stopped:
        stop_ms_at = {at: stopped.stop(Place(at)) for at in range(0, PERIOD, COARSE)}
        center = max(stop_ms_at, key=lambda at: stop_ms_at[at])
        for at in range(center - AROUND, center + AROUND, FINE):
            stopped.stop(Place(at))
        if stopped.has_echo:
            for place in with_echoes([center]):
                stopped.stop(place)
        if stopped.has_discs:
            for place in with_edges([center]):
                stopped.stop(place)
        return sum_up(stopped)


def sum_up(stopped: Busy) -> Slowest:
    item = sorted(stopped.cycles)
    return Slowest(
        len(item), *map(_microseconds, (item[-1], item[len(item) // 2], stopped.together()))
    )


def with_echoes(places: Iterable[int]) -> list[Place]:
    return [Place(at, echo, rises) for at in places for echo in ECHOES for rises in (False, True)]


def with_edges(places: Iterable[int]) -> list[Place]:
    return [Place(at, edge=edge) for at in places for edge in EDGES]


def sample(stopped: Busy, count: int, seed: int) -> list[Place]:
    """Return so many places, half of them with the edge of an echo where there are echoes. Where
    there are discs, all of their edges come on top.
    """
    chance = random.Random(seed)
    places = [Place(chance.randrange(PERIOD)) for _ in range(count)]
    if stopped.has_echo:
        echoes = chance.sample(with_echoes([places[0].at]), count // 2)
        places = [*places[count // 2 :], *echoes]
    return places + (with_edges([places[0].at]) if stopped.has_discs else [])


def _microseconds(cycle_count: int) -> float:
    return cycle_count / CYCLES_PER_MS * 1000
