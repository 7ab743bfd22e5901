"""Every driver of the table goes the whole road: the firmware's header, a sketch, a drawing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import pytest

from tests.machines import board as boards
from tests.machines.esp32 import flags_of
from tests.machines.host import SOURCES, missing
from tests.support.casefile import ROOT
from tests.support.esp32_builds import complaints
from tests.support.needs import need
from tests.support.sampling import sample_of
from tests.support.wired_robots import DEVICES, DISCS, MOTORS, robot_with, with_discs
from tiniscript import compile_text, robots
from tiniscript.base.kit import Device
from tiniscript.codegen.sketch.wiring import SketchPlan
from tiniscript.codegen.sketch.writing import sketch_of
from tiniscript.robots import firmware
from tiniscript.robots.driver import Driver, HeaderPart, SensorDriver
from tiniscript.robots.drivers import DRIVERS
from tiniscript.robots.profile import Board, Robot, Wiring


def write_header_and_sketch(robot: Robot) -> tuple[str, str]:
    """Return the header and a sketch of a robot that uses all that it has."""
    uses = [f"SHOW({device.name})" for device in robot.kit.sensors]
    uses += [
        f"{device.name}({'TRUE' if device.is_yes_no else 1})" for device in robot.kit.actuators
    ]
    compilation = compile_text("; ".join(["F(1, 50)", *uses]), robot.kit, "prog.ts")
    assert compilation.program is not None and compilation.is_right, compilation.diagnostics
    sketch = sketch_of(compilation.source, compilation.program, robot, "en")
    return firmware.header([robot], "a test."), sketch


def names(drivers: list[Driver]) -> list[str]:
    return [f"{driver.used_by} {driver.name}" for driver in drivers]


@pytest.mark.parametrize("driver", DEVICES, ids=names(DEVICES))
def test_a_device_is_read_or_set_by_firmware_and_sketch(driver: Driver) -> None:
    header, sketch = write_header_and_sketch(robot_with("l298n", [driver]))
    assert "case 0:  // D0" in header
    for pin in driver.pins:
        assert ("D0_PIN" if pin.key == "pin" else f"D0_{pin.key.upper()}_PIN") in sketch


@pytest.mark.parametrize("driver", DRIVERS.values(), ids=names([*DRIVERS.values()]))
def test_every_driver_is_documented_for_profile_authors(driver: Driver) -> None:
    sample = ROOT / "compiler" / "tiniscript" / "robots" / "tinibot.toml"
    headings = re.findall(r"(?m)^# {3,}(.*)", sample.read_text(encoding="utf-8"))
    assert re.search(rf"\b{driver.name}\b", " ".join(headings)), "python -m tools.generate"


def test_a_driver_without_sketch_support_is_named() -> None:
    """This holds for any names of its pins."""
    for driver in DEVICES:
        robot = robot_with("l298n", [driver])
        board = robot.board
        new_wiring = Wiring("new", {"left": 5}, {})
        board = board._replace(
            sensors=(new_wiring,) * len(board.sensors),
            actuators=(new_wiring,) * len(board.actuators),
        )
        with pytest.raises(LookupError, match="robots/drivers has no driver new"):
            firmware.header([robot._replace(board=board)], "a test.")
        plan = SketchPlan(robot._replace(board=board), str, is_exact=True)
        with pytest.raises(LookupError, match="robots/drivers has no driver new"):
            if board.sensors:
                plan.reader_code(0, "d0", "readD0")
            else:
                plan.setter_code(0, "setD0")


@pytest.mark.parametrize("motors", MOTORS)
def test_motors_are_driven_by_firmware_and_sketch(motors: str) -> None:
    header, sketch = write_header_and_sketch(robot_with(motors, []))
    assert "kLeftMotor" in header and "kRightMotor" in header
    assert "void driveMotor(" in sketch


@pytest.mark.parametrize("chip", ["uno", "nano", "mega", "esp32dev"])
@pytest.mark.parametrize("name", DISCS)
def test_discs_are_counted_by_the_firmware(name: str, chip: str) -> None:
    robot = with_discs(chip, name)
    header = firmware.header([robot], "a test.")
    assert "#define tiniscript_discs\n" in header
    assert robot.board.discs
    has_two = name == "two_channel"
    assert f"kDiscs = {{32673, 277333, {str(has_two).lower()}}};" in header
    for side in ("Left", "Right"):
        disc = re.search(rf"constexpr Disc k{side}Disc = (.*);", header)
        assert disc and ("kNoPin" in disc[1]) == (not has_two)
        if chip != "esp32dev":
            assert re.search(rf"#define tiniscript_disc_{side.lower()} INT\d_vect\n", header)


def robot_without_buzzer(chip: str) -> Robot:
    """Return a robot without a buzzer."""
    robot = robots.load("tinibot" if chip == "uno" else "tinibot32")
    return robot._replace(board=robot.board._replace(buzzer=None))


def test_a_robot_without_a_buzzer_has_no_tone() -> None:
    for chip in ("uno", "esp32dev"):
        assert "#define tiniscript_silent\n" in firmware.header(
            [robot_without_buzzer(chip)], "a test."
        )
    robot = robot_without_buzzer("uno")
    compilation = compile_text("SB|BEEP(1, 440);F(1, 50)", robot.kit, "prog.ts")
    assert compilation.program is not None
    sketch = sketch_of(compilation.source, compilation.program, robot, "en")
    assert "one(" not in sketch and "BUZZER" not in sketch
    assert "waitMs(ms);" in sketch, "a sound takes its time"


# -- the result is valid C++ -----------------------------------------------------------------------


def is_shield(motors: str) -> bool:
    """Return whether a driver uses the pins of an Uno, which an ESP32 has in other places."""
    return any(pin.fixed_number is not None for pin in DRIVERS["motors", motors].pins)


KNOWING = [path for path in sorted((SOURCES / "src" / "boards").glob("*.cpp"))
           if '"kit.h"' in path.read_text(encoding="utf-8")]  # fmt: skip
ALL_ROBOTS = [
    *(pytest.param(robot_with(motors, DEVICES), id=f"mega {motors}") for motors in MOTORS),
    *(pytest.param(robot_with(motors, DEVICES[:3], "nano", False), id=f"nano {motors}")
      for motors in MOTORS),
    *(pytest.param(robot_with(motors, DEVICES[k % 2 :: 2], "esp32dev", False), id=f"esp32 {motors}")
      for k, motors in enumerate(MOTORS) if not is_shield(motors)),
    *(pytest.param(with_discs(chip, discs), id=f"{chip} {discs}")
      for chip in ("mega", "esp32dev") for discs in DISCS),
    *(pytest.param(robot_without_buzzer(chip), id=f"{chip}, silent") for chip in ("uno",
                                                                                  "esp32dev")),
]  # fmt: skip


def compile_all(robot: Robot, folder: Path) -> None:
    """Compile without output: a compiler quickly reports errors that no test of the text finds."""
    header, own_header = firmware.header([robot], "a test."), folder / "own.h"
    own_header.write_text(header, encoding="utf-8")
    own_define = f'-Dtiniscript_own="{own_header}"'
    if robot.board.chip.startswith("esp32"):
        need(missing())
        flags = (*flags_of(robot.board.chip, 2), own_define, "-Wpedantic")
        assert "".join(complaints(path, *flags) for path in KNOWING) == ""
        return
    need(boards.missing())
    words = (*boards.flags_of(robot.board.chip, boards.FLAGS), *boards.CPP, "-Wall", "-Wextra",
             "-Wpedantic", "-Werror", "-fsyntax-only")  # fmt: skip
    boards.run("avr-g++", *words, *boards.flags_for(header), own_define, *KNOWING)
    sketch_path = folder / "sketch.cpp"
    sketch_path.write_text(write_header_and_sketch(robot)[1], encoding="utf-8")
    boards.run("avr-g++", *words, sketch_path)


@pytest.mark.sampled("robot", keep=12)
@pytest.mark.parametrize("robot", ALL_ROBOTS)
def test_generated_code_of_every_driver_compiles(robot: Robot, tmp_path: Path) -> None:
    compile_all(robot, tmp_path)


DEVICE_PARTS = ("sensors", "actuators")
OPTIONAL = [name for name, default in Board._field_defaults.items() if default is None]
SETS_OF_PARTS = [
    parts
    for count in range(len(DEVICE_PARTS) + len(OPTIONAL) + 1)
    for parts in combinations((*DEVICE_PARTS, *OPTIONAL), count)
]


def with_parts(chip: str, parts: Sequence[str]) -> Robot:
    """Return a robot that has of all that a robot may lack only these parts."""
    devices = [
        next(driver for driver in DEVICES if driver.used_by.startswith(part))
        for part in DEVICE_PARTS
        if part in parts
    ]
    kit_robot = robot_with("l298n", devices, chip, is_whole=False)
    donor_boards = (with_discs(chip, DISCS[0]).board, robots.load("tinibot").board)
    chosen: dict[str, Any] = dict.fromkeys(OPTIONAL)
    for name in set(OPTIONAL) & set(parts):
        chosen[name] = next(filter(None, (getattr(board, name) for board in donor_boards)))
    return kit_robot._replace(board=kit_robot.board._replace(**chosen))


@pytest.mark.parametrize("chip", ["uno", "mega", "esp32dev"])
def test_a_robot_without_an_optional_part_compiles(
    chip: str, tmp_path: Path, pytestconfig: pytest.Config
) -> None:
    for parts in ((), *sample_of(pytestconfig, chip, SETS_OF_PARTS, 3)):
        compile_all(with_parts(chip, parts), tmp_path)


def test_motors_without_firmware_support_are_named() -> None:
    robot = robot_with("l298n", DEVICES)
    board = robot.board._replace(motors=robot.board.motors._replace(driver="new"))
    with pytest.raises(LookupError, match="robots/drivers has no driver new"):
        firmware.header([robot._replace(board=board)], "a test.")


def test_a_driver_without_a_sketch_cannot_be_made() -> None:
    class Half(SensorDriver):
        name = "half"
        used_by = "sensors number"
        pins = ()

        def firmware_lines(self, part: HeaderPart, device: Device, wiring: Wiring) -> list[str]:
            return []

    with pytest.raises(TypeError, match=r"Half.*sketch"):
        Half()  # type: ignore[abstract]
