"""Counts cycles of the works in the shipped sketch, on a simulated Uno.

The firmware is the one that users put on their boards: the whole of `loop()` comes between the
machine's instructions, and the interrupts do. A work's loop runs between two changes of a motor
pin; the time of these without the loop is measured, too, and subtracted. The program goes on
without tsc, so no frame comes in between. Constants come from a light sensor.
"""

from __future__ import annotations

import re
from pathlib import Path

from tests.machines.wired import Wired
from tests.support.images import image_of
from tiniscript import robots
from tools.bench.firmware_stack import connect, pin, require_ok
from tools.bench.workloads import Workload, check
from tools.uno import Uno

ROBOT = robots.load(robots.DEFAULT)
SENSOR = "LIGHT_L"  # the one for which the constants are
_NUMBER = [sensor.name for sensor in ROBOT.kit.sensors].index(SENSOR)
SENSOR_PIN = pin(ROBOT, ROBOT.board.sensors[_NUMBER].pins["pin"])
WORK_MS, SHOW_MS = 10_000, 500


def text_of(work: Workload, has_loop: bool = True) -> str:
    """Return a work as it is measured here: a motor turns for as long as its loop does.

    The sensor always returns its first reading; the differences of the others are added.
    """
    readings = iter(work.readings)

    def constant(_: re.Match[str]) -> str:
        difference = next(readings) - work.readings[0]
        return f"{SENSOR} + {difference}" if difference else SENSOR

    code_before = re.sub(r"\bDISTANCE\b", constant, work.code_before)
    loop = f"LOOP({work.loop_count}); {work.body} END_LOOP;" if has_loop else ""
    return f"SI|{code_before} M(50, 50); {loop} M(0, 0); {work.code_after}"


def per_iteration(firmware: Path, work: Workload) -> float:
    """Return the cycles of one time around the loop of a work. Raises WrongResult."""
    with Uno(firmware, baud=ROBOT.board.baud, tells_sleep=False) as board:
        wired_uno = connect(board, ROBOT)
        if work.readings:
            board.set_analog(SENSOR_PIN, work.readings[0])
        with_loop, shown_values = _cycles(wired_uno, text_of(work))
        check("the sketch", work, shown_values)
        without_loop, _ = _cycles(wired_uno, text_of(work, has_loop=False))
        return (with_loop - without_loop) / work.loop_count


def _cycles(wired_uno: Wired, text: str) -> tuple[int, list[object]]:
    """Return the time that a motor turns during a program, and the values shown."""
    board, session = wired_uno.uno, wired_uno.session
    motor = f"D{ROBOT.board.motors.pins['left_pwm']}"
    image = image_of(text, ROBOT.kit)
    session.events()
    event_count = len(board.events)
    require_ok(wired_uno, session.upload(image, saves=False, is_detached=True))
    if board.pins[motor].state == "pwm":
        board.run_until(motor, "low", WORK_MS)
    wired_uno.run(SHOW_MS)
    shown_values: list[object] = [event.value for event in session.events() if event.name == "SHOW"]
    begin_cycle, end_cycle = (
        next(event.cycle for event in board.events[event_count:]
             if event.kind == "pin" and event["pin"] == motor and event["is"] == state)
        for state in ("pwm", "low")
    )  # fmt: skip
    return end_cycle - begin_cycle, shown_values
