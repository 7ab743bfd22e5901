"""The duration of a turn, and a WHEN's lateness while others count: `python -m tools.bench.tasks`.

A simulated Uno with the firmware that ships runs up to four tasks besides the main one: a WHEN that
looks at a light sensor every 20 ms, and others that count and never wait by themselves. The light
goes on at moments that fit no 20 ms, and each time the WHEN turns the motors on. Its checks are on
a grid of 20 ms; the output is the distance between them. The clock of an AVR advances every 1.024
ms, so even a single task has a millisecond.

It also prints the flash and RAM that tasks take, by part: the functions of the firmware with and
without them.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections import Counter
from itertools import pairwise
from pathlib import Path

from tests.support.images import image_of
from tiniscript import robots
from tiniscript.flash import building
from tools import uno
from tools.bench import avr_bench, firmware_size, page
from tools.bench.firmware_stack import connect, require_ok
from tools.bench.machine import JUMP_BUDGET, run_on_chip
from tools.bench.sketch_cycles import SENSOR_PIN
from tools.uno import CYCLES_PER_MS, Uno

ROBOT = robots.load(robots.DEFAULT)
LOOK_INTERVAL_MS = 20
LOOK_COUNT = 40
COUNTING_TASK = "TASK; {0} = 0; LOOP(FOREVER); {0} = {0} + 1; END_LOOP; END_TASK;"
TURN_COUNT = 1000
WITH_TASKS = "-Dtiniscript_with_tasks"
WATCH_TASK = "WHEN(LIGHT_L > 500); M(50, 50); W(0.04); M(0, 0); W(0.06); END_WHEN;"

# Prefixes of the functions and tables of each part.
PATTERN_OF_PART = {
    "turns, rounds and waiting": r"run_round|end_turn|Machine::go_on",
    "which task has the motors, and moves that are paused":
        r"tiniscript_moves|Machine::(take|want|sends|motors|set_motors|drive|end_move|watch|until|block|keep_move)"
        r"|robot_motors",
    "verifier": r"::pass\(|kForm|to_the_end",
    "the start of a run, and everything else: 20 bytes of RAM for each of four more tasks": "",
}  # fmt: skip
COUNTING_ROWS = {0: "none", 3: "three"}
ROWS = (*COUNTING_ROWS.values(), *PATTERN_OF_PART)
SYMBOL = re.compile(r"\d+ (\d+) (\w) (.*)")


def main() -> int:
    if reason := uno.missing() or avr_bench.missing_reason():
        print(reason, file=sys.stderr)
        return 2
    try:
        firmware = firmware_size.measure("uno").firmware
        firmware_without_tasks = firmware_size.measure(building.SMALLER_FIRMWARE["uno"][0]).firmware
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 2
    page.show("tasks", [(row, f"{jitter_ms(firmware, task_count):.2f} ms")
                        for task_count, row in COUNTING_ROWS.items()])  # fmt: skip
    round_cycles = [turns_cycles(tasks) for tasks in range(5)]
    first_turn, *later_rounds = [
        (cycles_after - cycles_before) / TURN_COUNT
        for cycles_before, cycles_after in pairwise(round_cycles)
    ]
    least_cycles, most_cycles = min(later_rounds), max(later_rounds)
    print(
        f"A turn of the first task takes {first_turn:,.0f} cycles; each further task adds "
        f"{least_cycles:,.0f} to {most_cycles:,.0f}.\n"
    )
    parts_without_tasks = parts_of(firmware_without_tasks)
    rows = []
    for part, size in parts_of(firmware).items():
        size_without = parts_without_tasks[part]
        rows.append(
            (part, *(f"{size[memory] - size_without[memory] or ''}" for memory in ("flash", "ram")))
        )
    page.show("tasks", rows, position=1)
    return 0


def parts_of(firmware: Path) -> dict[str, Counter[str]]:
    """Return the bytes of flash and RAM of a firmware, by part."""
    command = ["avr-nm", "-S", "-C", "--radix=d", str(firmware)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    parts: dict[str, Counter[str]] = {part: Counter() for part in PATTERN_OF_PART}
    for size, kind, name in SYMBOL.findall(text):
        part = next(part for part, names in PATTERN_OF_PART.items() if re.search(names, name))
        parts[part]["ram" if kind in "bBdD" else "flash"] += int(size)
    return parts


def turns_cycles(task_count: int) -> int:
    """Return the cycles of the machine while each task runs `TURN_COUNT` empty rounds."""
    text = f"TASK;LOOP({TURN_COUNT});END_LOOP;END_TASK;" * task_count + "W(1.2)"
    code = image_of(text, ROBOT.kit).code
    return run_on_chip(code, (), JUMP_BUDGET, WITH_TASKS)[1]


def jitter_ms(firmware: Path, task_count: int) -> float:
    """Return the jitter of a WHEN on its grid of 20 ms."""
    text = (
        "SI|W(3600);"
        + WATCH_TASK
        + "".join(COUNTING_TASK.format(name) for name in "XYZ"[:task_count])
    )
    names = {"left": f"D{ROBOT.board.motors.pins['left_pwm']}"}
    with tempfile.TemporaryDirectory() as folder, Uno(
        firmware, names=names, eeprom=Path(folder) / "eeprom",
        baud=ROBOT.board.baud, resets_on_open=False,
    ) as board:  # fmt: skip
        wired_uno = connect(board, ROBOT)
        image = image_of(text, ROBOT.kit)
        require_ok(wired_uno, wired_uno.session.upload(image, saves=False, is_detached=True))
        times_ms: list[float] = []
        for number in range(LOOK_COUNT):
            board.run_ms(LOOK_INTERVAL_MS * number / LOOK_COUNT + 0.3)
            board.set_analog(SENSOR_PIN, 900)
            pin_change = board.run_until("left", "pwm", 3 * LOOK_INTERVAL_MS)
            times_ms.append(pin_change.cycle / CYCLES_PER_MS)
            board.set_analog(SENSOR_PIN, 100)
            board.run_ms(120)
        first_ms = times_ms[0]
        lateness_ms = [
            (time_ms - first_ms + LOOK_INTERVAL_MS / 2) % LOOK_INTERVAL_MS for time_ms in times_ms
        ]
        return max(lateness_ms) - min(lateness_ms)


if __name__ == "__main__":
    sys.exit(main())
