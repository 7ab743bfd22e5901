"""The sketch reaches the board as on a real one: by avrdude, over its bootloader."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.machines.bootloaders import Bootloader, bootloader
from tests.machines.uno import build_uno as nothing_but
from tests.machines.uno import skip_unless_available
from tests.support import arduino_builder
from tests.support.command import run_subprocess
from tests.support.images import image_of
from tests.support.needs import need
from tests.support.platformio import firmware, shared_folder
from tests.support.robot_on_uno import (
    AWAY_PROGRAM,
    BAUD,
    FORWARD,
    NAMES,
    OFF,
    computer,
    send,
    states,
)
from tests.support.uno_watchdog import (
    HANGING_LOOP,
    HANGING_LOOP_WITHOUT_INTERRUPTS,
    STALL,
    TIMER_MS,
    WATCHDOG_MS,
    build_hanging_firmware,
    is_on,
)
from tiniscript.link.requests import OK
from tools.uno import CYCLES_PER_MS, Uno

TRY_COUNT = (
    20  # a simulated board waits for its bootloader as long as a real one, however late it is
)

DRIVE_PROGRAM = "SI|F(0.3, 80)"
UNKNOWN_RESET, POWER_RESET, WATCHDOG_RESET = 0, 1, 4  # resets in docs/develop/link.md
WAIT_MS = 2500  # time that an old Nano waits for a sketch


pytestmark = pytest.mark.sampled(of="bootloaders", keep=2)


@pytest.fixture(autouse=True)
def needs_a_chip() -> None:
    skip_unless_available()


def avrdude(uno: Uno, loader: Bootloader, file: Path) -> str:
    """Write a sketch and read it back, as the Arduino IDE and PlatformIO do."""
    if not shutil.which("avrdude"):
        need("no avrdude on this computer")
    completed = subprocess.run(
        [
            "avrdude",
            "-c",
            loader.programmer,
            "-p",
            loader.part,
            "-P",
            uno.pty,
            "-b",
            str(loader.baud),
            "-D",
            "-U",
            f"flash:w:{file}:i",
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        check=False,
    )
    assert completed.returncode == 0, completed.stdout
    return completed.stdout


@pytest.mark.parametrize(
    ("board", "builder"), [("uno", "PlatformIO"), ("nano", "PlatformIO"), ("uno", "Arduino IDE")]
)
def test_avrdude_writes_the_sketch_and_the_robot_drives(
    board: str, builder: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    build_folder = shared_folder(tmp_path_factory)
    if builder == "PlatformIO":
        elf = firmware(board, tmp_path, build_folder)
        sketch = tmp_path / "firmware.hex"
        subprocess.run(["avr-objcopy", "-O", "ihex", "-R", ".eeprom", elf, sketch], check=True)
    else:
        sketch = arduino_builder.firmware(board, tmp_path, build_folder).hex
    loader = bootloader(board)
    program = tmp_path / "drive.ts"
    program.write_text(DRIVE_PROGRAM, encoding="utf-8")
    with Uno(
        nothing_but("nothing"),
        bootloader=loader.file,
        names=NAMES,
        baud=loader.baud,
        tells_sleep=False,
    ) as uno:
        uno.go()
        assert "bytes of flash verified" in avrdude(uno, loader, sketch)
        identified = run_subprocess("doctor", "--identify", "--port", uno.pty).gives(0)
        assert identified.out.startswith(f"tinibot on {uno.pty}")
        assert states(uno) == OFF
        run_subprocess("upload", program, "--port", uno.pty).gives(0)
        uno.pause()
        outputs = [change for change in uno.pins.history("left") if change.state == "pwm"]
        assert len(outputs) == 1
        off_changes = [
            change for change in uno.pins.history("left") if change.cycle > outputs[0].cycle
        ]
        assert off_changes[0].cycle - outputs[0].cycle == pytest.approx(
            300 * CYCLES_PER_MS, rel=0.02
        )
        assert states(uno) == OFF


def test_optiboot_lets_a_hung_robot_continue(tmp_path: Path) -> None:
    """Optiboot recognizes the watchdog's reset, does not wait for a sketch, and hides the cause.

    With interrupts off, only the cause would show it, and that is unknown then.
    """
    elf = build_hanging_firmware(tmp_path, HANGING_LOOP_WITHOUT_INTERRUPTS)
    with Uno(elf, bootloader=bootloader("uno").file, names=NAMES, baud=BAUD) as uno:
        hang(uno, watchdog_ms=WATCHDOG_MS)
        uno.run_ms(500)
        causes = [event["cause"] for event in uno.events if event.kind == "reset"]
        assert causes == ["power-on", "watchdog"]
        assert read_reset_report(uno) == (UNKNOWN_RESET, 0, 0)
        assert states(uno) == OFF


def test_optiboot_does_not_hide_a_hang_that_was_noted(tmp_path: Path) -> None:
    elf = build_hanging_firmware(tmp_path, HANGING_LOOP)
    with Uno(elf, bootloader=bootloader("uno").file, names=NAMES, baud=BAUD) as uno:
        hang(uno, watchdog_ms=TIMER_MS)
        uno.run_ms(700)
        causes = [event["cause"] for event in uno.events if event.kind == "reset"]
        assert causes == ["power-on", "watchdog"]
        assert read_reset_report(uno) == (WATCHDOG_RESET, STALL, image_of(AWAY_PROGRAM).checksum)
        assert states(uno) == OFF


def test_an_old_nano_continues_without_its_bootloader(tmp_path: Path) -> None:
    """The old bootloader would leave the watchdog on, so the robot restarts without it."""
    elf = build_hanging_firmware(tmp_path, HANGING_LOOP, "nano")
    with Uno(elf, bootloader=bootloader("nano").file, names=NAMES, baud=BAUD) as uno:
        hang(uno, watchdog_ms=TIMER_MS)
        uno.run_ms(1000)
        causes = [event["cause"] for event in uno.events if event.kind == "reset"]
        assert causes == ["power-on"]
        assert read_reset_report(uno) == (WATCHDOG_RESET, STALL, image_of(AWAY_PROGRAM).checksum)
        assert states(uno) == OFF


def test_an_old_nano_that_hangs_permanently_stays_off_until_a_power_cycle(tmp_path: Path) -> None:
    elf = build_hanging_firmware(tmp_path, HANGING_LOOP_WITHOUT_INTERRUPTS, "nano")
    with Uno(elf, bootloader=bootloader("nano").file, names=NAMES, baud=BAUD) as uno:
        hang(uno, watchdog_ms=WATCHDOG_MS)
        event_count_before = len(uno.events)
        uno.run_ms(300)
        causes = {
            event["cause"] for event in uno.events[event_count_before:] if event.kind == "reset"
        }
        assert causes == {"watchdog"}
        assert not is_on(uno)
        uno.reset("power-on")
        uno.run_ms(WAIT_MS)
        assert read_reset_report(uno) == (POWER_RESET, 0, 0)


def hang(uno: Uno, watchdog_ms: int) -> None:
    """Make a driving robot hang: its motors must go off."""
    uno.run_ms(WAIT_MS)
    send(computer(uno), AWAY_PROGRAM)
    assert states(uno) == FORWARD
    uno.drive("button", False)
    uno.run_ms(watchdog_ms + 5)
    assert not is_on(uno)
    uno.drive("button", None)


def read_reset_report(uno: Uno) -> tuple[object, ...]:
    """Return the reason of the last reset, the last fault and its program, as reported by the
    robot.
    """
    wired_uno = computer(uno, 2)
    assert wired_uno.until(wired_uno.session.hello()) == OK
    robot = wired_uno.session.robot
    assert robot is not None
    return robot.values.reset, robot.values.fault, robot.values.fault_program


def test_a_reset_mega_is_waited_for(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Early bytes keep it in its bootloader, and its profile is that of an Uno."""
    elf = firmware("mega", tmp_path, shared_folder(tmp_path_factory))
    file = bootloader("mega").file
    with Uno(elf, board="mega", bootloader=file, baud=BAUD, tells_sleep=False) as mega:
        mega.go(speed=3.0)
        for words in (["doctor", "--identify"], ["doctor", "--ports", "--ask"]):
            for _ in range(TRY_COUNT):  # a busy computer may be late; each try resets the board
                result = run_subprocess(*words, "--port", mega.pty)
                if "tinibot" in result.out:
                    break
            assert "tinibot" in result.out, (result.out, result.err)
