"""The stack usage of the whole sketch at its deepest, on a simulated board.

The RAM is painted before power-on; then all deep calls happen; bytes that keep the paint were never
stack. The deepest place of the program and the deepest interrupt are measured apart too: that the
one comes in the other is rare, and must not matter.
"""

from __future__ import annotations

import random
import subprocess
from pathlib import Path
from typing import Any

from tests.machines.wired import Wired
from tests.support.images import image_of
from tests.support.owners import Keys
from tiniscript.base.kit import NUMBER, Kit
from tiniscript.bytecode.image import Image
from tiniscript.link.connection import PendingRequest
from tiniscript.link.messages import KEY_OWNER, RESUME_STEP
from tiniscript.link.session import Session
from tiniscript.robots.profile import Robot
from tiniscript.robots.text_levels import NO_TEXT, level_of
from tools.uno import CYCLES_PER_MS, HERTZ, Stack, Uno

MIN_FREE = 150  # bytes
HEAP_START_SYMBOL = "_end"  # the symbol after all variables
RAM_START = 0x800000  # first address of RAM in avr-nm
BOARDS = {"uno": "uno", "nano": "uno", "mega": "mega"}  # the simulated one for each
CALLS_AT_ONCE = 8  # most calls in parallel
MAX_STEPS = 40
# Typed lines, and the robot's output: 16 waiting values, brackets, blocks, long answers.
TYPED_LINES = (
    "HELP\n",
    "PING|CHECK_CONNECTION\n",
    "SI|X=" + "1+(" * 14 + "RANDOM(1,2)" + ")" * 14 + ";SHOW(0-X/3)\n",
    "SI|NAME_OF_A_THING=TRUE;"
    + "IF(NAME_OF_A_THING);" * 9
    + "BEEP(0.1,500);SHOW(NOT NAME_OF_A_THING OR 1.5<2 AND 3>2);"
    + "ENDIF;" * 9
    + "Y=TIME;SHOW(MAX(2,1))\n",
    "SI|F(1,80)UNTIL(TIME<1 OR NOT ((TIME>2 AND TIME<1)))~00000000\n",
    "SI|LOOP(FOREVER);SHOW(-2147483.647);X=1/0.0;END_LOOP\n",
)
ANSWERS = ("END_LOOP", ", kit ", "// -5", "// TRUE", "// 2", "1: ", "-2147483.647", "FAULT DIVIDE")
FLICKER_COUNT, IN_INTERRUPT_CYCLES = 200, 40
SAMPLE_BITS = 9.5625  # bits from a byte's start bit until the chip has it
DIVIDES_BY_ZERO = "X = 0; X = 5 / X"


def measure(firmware: Path, robot: Robot, board: str, has_breakpoints: bool = False) -> Stack:
    """Run a firmware through everything that goes deep. Raises RuntimeError if it does not.

    `board` is that of the firmware: it may be another one than that of the robot's profile. With
    breakpoints, it reads no text.
    """
    baud = robot.board.baud
    with Uno(
        firmware, board=BOARDS[board], baud=baud, tells_sleep=False, watches_stack=True
    ) as uno:
        set_obstacles(uno, robot)
        fill_stack(connect(uno, robot, keys=Keys()), robot, has_breakpoints)
        return uno.stack(heap_start(firmware))


def connect(uno: Uno, robot: Robot, baud: int = 0, keys: Keys | None = None) -> Wired:
    """Start a board with a session on its line, by default at the robot's baud rate."""
    uno.run_ms(300)
    session = Session(1, baud or robot.board.baud, robot.kit.fingerprint, keys=keys)
    return Wired(uno, session)


def heap_start(firmware: Path) -> int:
    """Return the first address of the RAM that only the stack uses."""
    text = subprocess.run(["avr-nm", firmware], capture_output=True, text=True, check=True).stdout
    rows = (row.split() for row in text.splitlines())
    (address,) = [row[0] for row in rows if row[-1] == HEAP_START_SYMBOL]
    return int(address, 16) - RAM_START


def set_obstacles(uno: Uno, robot: Robot) -> None:
    """Set obstacles for its sensors."""
    for device in robot.board.sensors:
        if device.driver == "hc_sr04":
            uno.set_sonar_distance(
                pin(robot, device.pins["trigger"]), pin(robot, device.pins["echo"]), 40
            )


def pin(robot: Robot, number: int) -> str:
    """Return the name of a pin of the profile, numbered as on its own board."""
    first_analog = 54 if robot.board.chip == "mega" else 14
    return f"D{number}" if number < first_analog else f"A{number - first_analog}"


def fill_stack(wired_uno: Wired, robot: Robot, has_breakpoints: bool) -> None:
    uno, session, kit = wired_uno.uno, wired_uno.session, robot.kit
    button = pin(robot, robot.board.start_button)
    require_ok(wired_uno, session.hello())
    require_ok(wired_uno, session.name(b"sixteen letters!"))
    require_ok(wired_uno, session.upload(longest_program(kit, robot.board.program_bytes)))
    noise = random.Random(1)
    for _ in range(30):  # the robot drives, measures, plays, shows and is saved
        uno.send(noise.randbytes(20) + b"\0")
        wired_uno.run(40)
    uno.send(b"SI|F(1, 80)\r\n")
    wired_uno.run(300)
    uno.send(bytes(8))  # stopped in the interrupt
    wired_uno.run(600)
    require_ok(wired_uno, session.status())
    require_ok(wired_uno, session.fetch())
    require_ok(wired_uno, session.start())
    wired_uno.run(500)
    uno.run_ms(1300)  # until the session is gone
    wired_uno.run(500)
    require_ok(wired_uno, session.live(image_of(DIVIDES_BY_ZERO, kit).code))
    wired_uno.run(500)
    require_ok(
        wired_uno, session.upload(longest_program(kit, robot.board.program_bytes), runs=False)
    )
    wired_uno.run(2500)  # until the program is saved
    claim(wired_uno, button)
    if has_breakpoints:
        fill_stack_by_stepping(wired_uno)
    elif level_of(robot.board.chip, robot.board.discs is not None) is NO_TEXT:
        drive_a_way(wired_uno, robot)
    else:
        fill_stack_by_typing(uno, kit)
    uno.reset("external")  # the robot checks its program when it starts
    uno.run_ms(200)
    uno.press(button)
    uno.run_ms(800)
    uno.press(button)
    uno.run_ms(200)


def claim(wired_uno: Wired, button: str) -> None:
    """Claim the robot, authenticate and give it up."""
    request = wired_uno.session.claim(KEY_OWNER)
    wired_uno.run(300)
    wired_uno.uno.press(button, 2200)
    require_ok(wired_uno, request)
    require_ok(wired_uno, wired_uno.session.identify())
    require_ok(wired_uno, wired_uno.session.trim())
    require_ok(wired_uno, wired_uno.session.disown(KEY_OWNER))


def fill_stack_by_stepping(wired_uno: Wired) -> None:
    """Step through the longest program, which is there; at each halt ask for all that it tells."""
    session = wired_uno.session
    require_ok(wired_uno, session.break_at([0]))
    require_ok(wired_uno, session.start())
    for _ in range(MAX_STEPS):
        wired_uno.run(60)
        require_ok(wired_uno, session.read_variables())
        require_ok(wired_uno, session.read_tasks())
        require_ok(wired_uno, session.resume(RESUME_STEP))
    require_ok(wired_uno, session.break_at([]))


def fill_stack_by_typing(uno: Uno, kit: Kit) -> None:
    """Type lines that take most of the reader and of its answers; no other client is connected.

    Raises RuntimeError if one is not done.
    """
    uno.run_ms(4000)
    byte_count_before = len(uno.sent_bytes)
    for text in TYPED_LINES:
        uno.send(text.encode())
        uno.run_ms(2 * len(text) + 400)
    output = bytes(byte.value for byte in uno.sent_bytes[byte_count_before:]).decode("latin-1")
    for answer in ANSWERS:
        if answer not in output:
            raise RuntimeError(f"the robot has not said {answer} but {output}")


def drive_a_way(wired_uno: Wired, robot: Robot) -> None:
    """Go by discs that flicker, and then do not turn: with all that a way takes, until that is a
    fault. Just before a byte comes an edge of the one, and in its interrupt one of the other.
    """
    text = "F(100 CM, 60) UNTIL(DISTANCE < 1)"
    require_ok(wired_uno, wired_uno.session.live(image_of(text, robot.kit).code))
    discs = robot.board.discs
    assert discs
    uno, bit_cycles = wired_uno.uno, HERTZ / robot.board.baud
    begin_cycle = uno.cycle + CYCLES_PER_MS
    uno.send(b"noise" * (FLICKER_COUNT // 5) + b"\0", begin_cycle)
    for k in range(FLICKER_COUNT):
        cycle = begin_cycle + round((10 * k + SAMPLE_BITS) * bit_cycles) - k
        for number, name in enumerate(discs.pins.values()):
            uno.drive(pin(robot, name), k % 2 == 0, at_cycle=cycle + number * IN_INTERRUPT_CYCLES)
    wired_uno.run(1500)


def require_ok(wired_uno: Wired, request: PendingRequest[Any]) -> None:
    status = wired_uno.until(request)
    if status != 0:
        raise RuntimeError(f"the robot has answered {status}")


def longest_program(kit: Kit, room: int) -> Image:
    """Return a program that fills a robot, goes as deep as one can, and uses all that there is."""
    show_count = 0
    while len((larger_image := image_of(deep_program_text(kit, show_count + 1), kit)).code) <= room:
        show_count += 1
        image = larger_image
    return image


def all_devices(kit: Kit) -> list[str]:
    """Return statements that read each sensor and set each actuator."""
    read_statements = [
        f"Y = {sensor.name}" if sensor.kind == NUMBER else f"IF({sensor.name}); Y = 1; ENDIF"
        for sensor in kit.sensors
    ]
    set_statements = [
        f"{actuator.name}({'X' if actuator.kind == NUMBER else 'TRUE'})"
        for actuator in kit.actuators
    ]
    return [*read_statements, *set_statements]


def deep_program_text(kit: Kit, show_count: int) -> str:
    lines = ["X = 0; Y = 0", "DEF D1", *all_devices(kit)]
    lines += ["BEEP(0.02, 440 + X)", "SHOW(X * 1.5 / 7)", "END_DEF"]
    for number in range(2, CALLS_AT_ONCE + 1):
        lines += [f"DEF D{number}", "LOOP(1)", f"D{number - 1}", "END_LOOP", "END_DEF"]
    sum_of_all = "X / 7 % 5"
    for number in range(12):
        sum_of_all = f"0.{number + 1} {'+-*'[number % 3]} ({sum_of_all})"
    lines += ["LOOP(FOREVER)", "X = X % 100 + 1", "M(50, 0 - 50)", f"D{CALLS_AT_ONCE}"]
    lines += [f"Z = {sum_of_all}", "F(0.05, 80) UNTIL(X > 50 AND NOT (Y < 3 OR Z > 1))"]
    lines += [f"SHOW(X + {number})" for number in range(show_count)]
    return "SI|" + "; ".join([*lines, "END_LOOP"])
