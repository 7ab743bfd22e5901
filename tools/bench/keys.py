"""Prints how quick a remote control is, from the hand to the motor pins, on a simulated Uno.

Builds the firmware of the robot `tinibot` for each baud, offline stand-ins included. A session
sends the keys that a hand holds: at any moment of its own heartbeat and of the robot's main loop
the hand changes it, or the line is lost. Cycles are exact; radio modules and USB chips are not in
them.
"""

from __future__ import annotations

import random
import statistics
import sys
from pathlib import Path

from tests.support.images import image_of
from tiniscript import robots
from tiniscript.link.messages import HOLD_MS
from tiniscript.link.remote import GAP_MS, NOTHING_PRESSED, RemoteState
from tools import ROOT
from tools.bench import page
from tools.bench.firmware_stack import connect, require_ok
from tools.bench.link import KIT, MOTORS, ROBOT, on_each_baud
from tools.uno import CYCLES_PER_MS, Uno

PAD_PROGRAM = "SI|LOOP(FOREVER); M(PAD_Y, PAD_Y); END_LOOP"
EXAMPLE = ROOT / "examples" / "remote.ts"  # a program that checks the keys 20 times a second
PAD_AHEAD = RemoteState(0, 0, 80)
PWM_PINS = MOTORS[:2]
TRY_COUNT = 300
HELD_MS = (100, 400)  # durations of holding and releasing keys
SAY_INTERVAL_MS = 100
RECONNECT_MS = 400  # time from a loss until words arrive
LOST_MS = HOLD_MS + 50  # loss that keeps the connection attached
# The slowest times by baud for a program that checks at once. A release may come just after a
# repeated state, and wait for its answer or for GAP_MS.
MAX_HELD_MS = {9600: 25.0, 115_200: 4.0}
MAX_LET_GO_MS = {9600: 25.0 + GAP_MS, 115_200: 8.0}
MAX_LOST_MS = HOLD_MS + 3  # the clock and the program look after that time
ROWS = (
    "stick held, until the motor pins change",
    "stick released, until the motor pins change",
    "stick held, until the motor pins change, with `examples/remote.ts`, "
    "which reads it 20 times a second",
    f"line lost, until the motors are off, in {TRY_COUNT} of {TRY_COUNT}",
)
FORMATS = (".1f", ".1f", ".1f", ".0f")


class Hand:
    """Drives a robot with a stick."""

    def __init__(self, firmware: Path, baud: int, text: str) -> None:
        """Switch it on, and send it a program that reads a stick."""
        self._random_source = random.Random(1)
        self._board = Uno(firmware, baud=baud, tells_sleep=False)
        self._wired_uno = connect(self._board, robots.load(ROBOT), baud)
        require_ok(self._wired_uno, self._wired_uno.session.hello())
        require_ok(self._wired_uno, self._wired_uno.session.upload(image_of(text, KIT)))

    def __enter__(self) -> Hand:
        return self

    def __exit__(self, *signal_arguments: object) -> None:
        self._board.close()

    def measure_change_ms(self, pressed_state: RemoteState) -> float:
        """Return the ms from a change of the held keys to the last change of the pins."""
        begin_cycle, event_count = self._begin()
        self._hold(pressed_state)
        return self._ms_from(begin_cycle, event_count, pressed_state != NOTHING_PRESSED)

    def measure_loss_ms(self) -> float:
        """Return the ms from where a line is lost, over which somebody drives, to motors off."""
        self._hold(PAD_AHEAD, RECONNECT_MS)
        begin_cycle, event_count = self._begin()
        for _ in range(LOST_MS):  # data is lost in both directions
            self._wired_uno.session.poll(self._wired_uno.now_ms)
            self._board.run_ms(1)
        received_cycles = [
            event.cycle for event in self._board.events[event_count:] if event.kind == "received"
        ]
        return self._ms_from(max([begin_cycle, *received_cycles]), event_count, False)

    def _hold(self, pressed_state: RemoteState, more_ms: int = 0) -> None:
        for ms in range(more_ms + self._random_source.randint(*HELD_MS)):
            if ms % SAY_INTERVAL_MS == 0:  # a silent person releases the keys
                self._wired_uno.session.press(*pressed_state)
            self._wired_uno.run(1)

    def _begin(self) -> tuple[int, int]:
        """Return some cycle within the millisecond, and how many events there were before."""
        self._board.run_to(self._board.cycle + self._random_source.randrange(CYCLES_PER_MS))
        return self._board.cycle, len(self._board.events)

    def _ms_from(self, begin_cycle: int, event_count: int, are_on: bool) -> float:
        """Raises RuntimeError if the motors are not as they must be in the end."""
        motor_events = [
            event
            for event in self._board.events[event_count:]
            if event.kind == "pin" and event["pin"] in MOTORS
        ]
        last_state = {event["pin"]: event["is"] for event in motor_events}
        if {last_state.get(pin) for pin in PWM_PINS} != {"pwm" if are_on else "low"}:
            raise RuntimeError(
                f"the motors have not gone {'on' if are_on else 'off'}: {last_state}"
            )
        return (motor_events[-1].cycle - begin_cycle) / CYCLES_PER_MS


def measure(firmware: Path, baud: int) -> list[list[float]]:
    """Return the ms of each try, by row."""
    with Hand(firmware, baud, PAD_PROGRAM) as hand:
        changes = [
            (hand.measure_change_ms(PAD_AHEAD), hand.measure_change_ms(NOTHING_PRESSED))
            for _ in range(TRY_COUNT)
        ]
        losses = [hand.measure_loss_ms() for _ in range(TRY_COUNT)]
    with Hand(firmware, baud, EXAMPLE.read_text(encoding="utf-8")) as hand:
        example_ms = [
            (hand.measure_change_ms(PAD_AHEAD), hand.measure_change_ms(NOTHING_PRESSED))[0]
            for _ in range(TRY_COUNT)
        ]
    return [*map(list, zip(*changes, strict=True)), example_ms, losses]


def main() -> int:
    return on_each_baud(measure, print_figures)


def print_figures(figures_by_baud: dict[int, list[list[float]]], _: Path) -> bool:
    """Print the figures, half and the slowest of each; return whether they are kept."""
    by_row = zip(*figures_by_baud.values(), strict=True)
    page.show(
        "keys",
        [
            (
                row,
                *(
                    f"{statistics.median(ms):{format_spec}} and {max(ms):{format_spec}} ms"
                    for ms in figures
                ),
            )
            for row, format_spec, figures in zip(ROWS, FORMATS, by_row, strict=True)
        ],
    )
    return all(is_within_limits(baud, *rows) for baud, rows in figures_by_baud.items())


def is_within_limits(
    baud: int, held_ms: list[float], let_go_ms: list[float], _: list[float], lost_ms: list[float]
) -> bool:
    """Return whether the slowest are as they must be."""
    return (
        max(held_ms) <= MAX_HELD_MS[baud]
        and max(let_go_ms) <= MAX_LET_GO_MS[baud]
        and max(lost_ms) <= MAX_LOST_MS
    )


if __name__ == "__main__":
    sys.exit(main())
