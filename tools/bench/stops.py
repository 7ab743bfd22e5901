"""The slowest stop of a busy robot on a simulated chip: from its last byte to the motor pins.

The chip's state at that moment decides how long a stop takes: an interrupt may be running, or a
part of the program that keeps interrupts off. So the last byte is sent at many points: throughout
the period of the clock, more densely around the slowest one, and there with an edge of an echo just
before, or with one of each disc. Meanwhile the robot runs a program that measures, plays, sends
values and reads text.

No sweep meets all of that at once. So the simulator also measures how long each place keeps
interrupts off, and the delays that may precede a stop are added up.
"""

from __future__ import annotations

import random
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from tests.support.images import image_of
from tiniscript.base.kit import Kit
from tiniscript.robots.profile import Robot
from tools.bench.firmware_stack import BOARDS, SAMPLE_BITS, all_devices, connect, pin, require_ok
from tools.uno import CYCLES_PER_MS, HERTZ, MaskedSpan, Uno

NOISE_TEXTS = b"// nobody reads that\n", b"// nor this line, which nobody ends"
STOP = bytes(8)
STOP_ZEROS = 4

CLOCK_PERIOD = 16_384  # cycles between two interrupts of the clock
COARSE_STEP = 64  # cycles: the interrupt takes longer
FINE_STEP, FINE_RANGE = 4, 64
ECHO_OFFSETS = range(-160, 33, 8)  # cycles
EDGE_OFFSETS = range(-480, 33, 16)  # offsets of the edges on both discs
SHORT_ECHO, LONG_ECHO = 1000, 8000  # cycles
BITS_PER_BYTE = 10  # bits of a byte on the wire
QUIET_MS = 25
PING_MS = 100  # pings are less apart
RECEIVE_INTERRUPT = {"uno": 18, "mega": 25}  # the number of the interrupt that sees a stop
INSTRUCTION_CYCLES = 4  # cycles of the longest one


class Place(NamedTuple):
    """The place of a stop: a cycle of the clock's period, and the cycles to an edge of an echo or
    of each disc.
    """

    cycle: int
    echo_offset: int | None = None
    is_rise: bool = False
    edge_offset: int | None = None


class StopTimes(NamedTuple):
    """The number of stops, and microseconds; `together` is the sum of the longest parts."""

    stop_count: int
    us: float
    median_us: float
    together_us: float


class BusyRobot:
    """A busy robot on a simulated chip, to be stopped again and again."""

    def __init__(self, firmware: Path, robot: Robot, board: str, baud: int) -> None:
        """Switch it on; `board` is that of the firmware, which may be another than the robot's."""
        self.robot, self.baud, self.stop_cycles = robot, baud, list[int]()
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
                self.chip.set_sonar_distance(self._trigger, self._sonar, None)
        discs = robot.board.discs
        self._discs = [pin(robot, number) for number in discs.pins.values()] if discs else []
        self._level = False  # level of the discs' outputs
        for name in self._discs:
            self.chip.drive(name, self._level)
        self._wired = connect(self.chip, robot, baud)
        require_ok(self._wired, self._wired.session.hello())
        require_ok(
            self._wired, self._wired.session.upload(image_of(busy_program(robot.kit), robot.kit))
        )

    def __enter__(self) -> BusyRobot:
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        self.chip.close()

    @property
    def has_echo(self) -> bool:
        return self._sonar != ""

    @property
    def has_discs(self) -> bool:
        return self._discs != []

    def stop(self, place: Place) -> int:
        """Return the cycles of a stop whose last byte arrives at a given place."""
        chip, session = self.chip, self._wired.session
        require_ok(self._wired, session.clear())
        require_ok(self._wired, session.start())
        chip.run_ms(QUIET_MS)  # until the session's bytes have left the wire
        text = NOISE_TEXTS[place.cycle // FINE_STEP % len(NOISE_TEXTS)]
        if place.echo_offset is not None:  # the robot waits for an echo only after a ping
            text = text[:1]
            chip.run_until(self._trigger, "high", PING_MS)
            chip.run_until(self._trigger, "low", PING_MS)
        bit_cycles = HERTZ / self.baud
        cycles = round(
            (len(text) + STOP_ZEROS - 1) * BITS_PER_BYTE * bit_cycles + SAMPLE_BITS * bit_cycles
        )
        begin_cycle = chip.cycle + CYCLES_PER_MS
        begin_cycle += (place.cycle - begin_cycle - cycles) % CLOCK_PERIOD
        last_byte_cycle = begin_cycle + cycles
        if place.echo_offset is not None:
            pulse_cycles = SHORT_ECHO if place.is_rise else LONG_ECHO
            chip.drive(
                self._sonar,
                not place.is_rise,
                at_cycle=last_byte_cycle + place.echo_offset - pulse_cycles,
            )
            chip.drive(self._sonar, place.is_rise, at_cycle=last_byte_cycle + place.echo_offset)
        if place.edge_offset is not None:
            self._level = not self._level
            for name in self._discs:
                chip.drive(name, self._level, at_cycle=last_byte_cycle + place.edge_offset)
        event_count = len(chip.events)
        chip.send(text + STOP, begin_cycle)
        chip.run_to(last_byte_cycle + round(BITS_PER_BYTE * BITS_PER_BYTE * bit_cycles))
        new_events = chip.events[event_count:]
        zero_cycles = [
            event.cycle for event in new_events if event.kind == "received" and event["byte"] == 0
        ]
        off_cycles = [
            event.cycle
            for event in new_events
            if event.kind == "pin"
            and event.cycle > begin_cycle
            and event["is"] == "low"
            and event["pin"] in self._motors
        ]
        self._wired.run(2 * QUIET_MS)
        self.stop_cycles.append(max(off_cycles) - zero_cycles[STOP_ZEROS - 1])
        return self.stop_cycles[-1]

    def worst_case_cycles(self) -> int:
        """Return the cycles of a stop before which all comes that may: once, at its longest."""
        receive_vector = RECEIVE_INTERRUPT[self.chip.board]
        masked_spans = [
            masked_span
            for masked_span in self.chip.longest_masked_spans()
            if masked_span.vector != receive_vector
        ]
        entries = {
            span.vector: span.cycle_count
            for span in masked_spans
            if _is_before(span, receive_vector)
        }
        cycles_before = max(
            span.cycle_count + sum(entries[vector] for vector in entries if vector != span.vector)
            for span in masked_spans
        )
        return min(self.stop_cycles) + INSTRUCTION_CYCLES + cycles_before


def _is_before(place: MaskedSpan, received_cycle: int) -> bool:
    """Return whether it is an interrupt that is served before the one of a byte."""
    return place.is_entry and 0 < place.vector < received_cycle


def busy_program(kit: Kit) -> str:
    """Return a program that endlessly measures, moves, plays and sends."""
    lines = ["X = 0", "LOOP(FOREVER)", "M(80, 80)", *all_devices(kit), "BEEP(0.005, 5000)"]
    return "SI|" + "; ".join([*lines, "SHOW(X * 1.5 / 7)", "X = (X + 1) % 100", "END_LOOP"])


def slowest(firmware: Path, robot: Robot, board: str, baud: int) -> StopTimes:
    """Return the slowest of some hundred stops."""
    with BusyRobot(firmware, robot, board, baud) as busy_robot:
        cycles_at = {
            cycle: busy_robot.stop(Place(cycle)) for cycle in range(0, CLOCK_PERIOD, COARSE_STEP)
        }
        center = max(cycles_at, key=lambda cycle: cycles_at[cycle])
        for cycle in range(center - FINE_RANGE, center + FINE_RANGE, FINE_STEP):
            busy_robot.stop(Place(cycle))
        if busy_robot.has_echo:
            for place in with_echoes([center]):
                busy_robot.stop(place)
        if busy_robot.has_discs:
            for place in with_edges([center]):
                busy_robot.stop(place)
        return sum_up(busy_robot)


def sum_up(busy_robot: BusyRobot) -> StopTimes:
    sorted_cycles = sorted(busy_robot.stop_cycles)
    return StopTimes(
        len(sorted_cycles),
        *map(
            _microseconds,
            (
                sorted_cycles[-1],
                sorted_cycles[len(sorted_cycles) // 2],
                busy_robot.worst_case_cycles(),
            ),
        ),
    )


def with_echoes(cycles: Iterable[int]) -> list[Place]:
    return [
        Place(cycle, offset, rises)
        for cycle in cycles
        for offset in ECHO_OFFSETS
        for rises in (False, True)
    ]


def with_edges(cycles: Iterable[int]) -> list[Place]:
    return [Place(cycle, edge_offset=offset) for cycle in cycles for offset in EDGE_OFFSETS]


def sample(busy_robot: BusyRobot, count: int, seed: int) -> list[Place]:
    """Return so many places, half of them with an echo's edge if there are echoes. Discs add all
    their edges.
    """
    random_source = random.Random(seed)
    places = [Place(random_source.randrange(CLOCK_PERIOD)) for _ in range(count)]
    if busy_robot.has_echo:
        echoes = random_source.sample(with_echoes([places[0].cycle]), count // 2)
        places = [*places[count // 2 :], *echoes]
    return places + (with_edges([places[0].cycle]) if busy_robot.has_discs else [])


def _microseconds(cycle_count: int) -> float:
    return cycle_count / CYCLES_PER_MS * 1000
