"""The header of a robot's firmware: its pins are those of the Arduino core, and it says all."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.machines import board as boards
from tests.support import arduino_builder
from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.edited_robots import TEXTS
from tests.support.platformio import shared_folder
from tiniscript import robots
from tiniscript.robots import firmware
from tiniscript.robots.boards import CHIPS
from tiniscript.robots.ports import AVRS, Bit, Compare
from tiniscript.robots.profile import ProfileRefused, Robot
from tiniscript.robots.reader import read

KITS = ROOT / "vm_arduino" / "src" / "boards" / "kits"
needs_core = pytest.mark.skipif(
    not boards.ARDUINO.exists(), reason="no Arduino core on this computer"
)


def table(board: str, name: str) -> list[str]:
    """Return the rows of a table of the core's pins."""
    path = boards.ARDUINO / "variants" / boards.VARIANTS[board] / "pins_arduino.h"
    text = path.read_text(encoding="utf-8", errors="replace")
    if (
        '#include "../standard/pins_arduino.h"' in text
    ):  # the Nano's is the Uno's, and two pins more
        return table("uno", name)
    array = text.partition(f"{name}[]")[2].partition("{")[2].partition("};")[0]
    array = re.sub(r"#if defined\(__AVR_ATmega8__\).*?#else(.*?)#endif", r"\1", array, flags=re.S)
    array = re.sub(r"//[^\n]*|/\*.*?\*/", "", array, flags=re.S)
    return [row.strip() for row in array.split(",") if row.strip()]


@needs_core
@pytest.mark.parametrize("board", sorted(AVRS))
def test_pins_match_the_core(board: str) -> None:
    ports = table(board, "digital_pin_to_port_PGM")
    masks = table(board, "digital_pin_to_bit_mask_PGM")
    bits = {
        pin: Bit(port[1].lower(), int(re.sub(r"\D", "", mask)))
        for pin, (port, mask) in enumerate(zip(ports, masks, strict=True))
    }
    assert dict(AVRS[board].bit_by_pin) == bits


@needs_core
@pytest.mark.parametrize("board", sorted(AVRS))
def test_pwm_pins_match_the_core(board: str) -> None:
    compares = {
        pin: Compare(int(name[5]), name[6].lower())
        for pin, name in enumerate(table(board, "digital_pin_to_timer_PGM"))
        if name != "NOT_ON_TIMER"
    }
    assert dict(AVRS[board].compare_by_pin) == compares
    assert {pin: compare.timer for pin, compare in compares.items()} == dict(
        CHIPS[board].timer_of_pwm_pin
    )


@pytest.mark.parametrize("board", sorted(AVRS))
def test_every_pin_of_the_profile_check_has_its_registers(board: str) -> None:
    chip, avr = CHIPS[board], AVRS[board]
    assert chip.digital_pins <= set(avr.bit_by_pin)
    assert set(chip.timer_of_pwm_pin) == set(avr.compare_by_pin)
    assert chip.echo_pins <= set(avr.interrupt_by_pin)


# -- the header


def read_changed_profile(board: str, name: str = "tinibot", *changes: tuple[str, str]) -> Robot:
    text = re.sub(r'^chip *= *"\w+"', f'chip = "{board}"', TEXTS[name], flags=re.M)
    for old_text, new_text in changes:
        assert old_text in text
        text = text.replace(old_text, new_text)
    return read(text, name)


def test_shipped_headers_are_for_every_board_that_they_fit() -> None:
    for name, fit in (
        ("tinibot", ["uno", "nano", "mega"]),
        ("liner", ["nano", "mega"]),
        ("grabber", ["mega"]),
        ("tinibot2", ["uno", "nano", "mega"]),
        ("elegoo4", ["uno", "nano", "mega"]),
        ("sumo", ["uno", "nano", "mega"]),
        ("tinibot32", ["esp32dev"]),
        ("tinibotc3", ["esp32c3"]),
    ):
        fitting = []
        for board in firmware.BOARDS:
            try:
                fitting.append(read_changed_profile(board, name))
            except ProfileRefused:
                continue
        assert [robot.board.chip for robot in fitting] == fit
        header = firmware.header(fitting, f"python -m tools.generate from robots/{name}.toml.")
        assert header == (KITS / f"{name}.h").read_text(encoding="utf-8")


def test_another_board_with_an_unos_chip_is_not_an_uno(monkeypatch: pytest.MonkeyPatch) -> None:
    """The liner's battery is on a pin that an Uno lacks, whatever other device uses that pin."""
    other_chip = CHIPS["nano"]._replace(name="promini")
    monkeypatch.setitem(CHIPS, "promini", other_chip)
    monkeypatch.setitem(AVRS, "promini", AVRS["nano"])
    header = firmware.header(
        [read_changed_profile(board, "liner") for board in ("nano", "promini")], "a test."
    )
    assert (
        "#if defined(__AVR_ATmega328P__) && !defined(ARDUINO_AVR_UNO)  // nano, promini" in header
    )


def test_every_shipped_header_can_be_chosen() -> None:
    chooser = (KITS.parent / "kit.h").read_text(encoding="utf-8")
    settings = (ROOT / "vm_arduino" / "platformio.ini").read_text(encoding="utf-8")
    for name in robots.names():
        assert f'#include "kits/{name}.h"\n' in chooser
        if not name.startswith(robots.DEFAULT):  # the profile of an ESP32's default robot
            assert f"#if defined(tiniscript_{name})" in chooser.replace("elif", "if")
            assert f"-D tiniscript_{name}\n" in settings


def test_a_header_describes_its_robot() -> None:
    robot = read_changed_profile("uno")
    header = firmware.header([robot], "a test.")
    assert header.startswith("// Generated by a test. Do not edit.\n")
    for line in (
        "#if defined(__AVR_ATmega328P__)  // uno",
        "#define tiniscript_motors_bridge",
        "#define tiniscript_ultrasonic_vectors(each) each(PCINT2_vect)",
        f"constexpr uint16_t kBoardKit = 0x{robot.kit.fingerprint:04x};",
        "constexpr uint8_t kBoardSensors = 3;",
        "constexpr uint16_t kProgramBytes = 389;",
        "constexpr uint16_t kMaxRunSeconds = 600;",
        "constexpr uint32_t kBaud = 9600;",
        "constexpr Pin kStartButton = {kPortD, 1 << 2};",
        "constexpr Pin kBuzzer = {kPortB, 1 << 3};",
        "constexpr Pin kBluetoothState = {kPortB, 1 << 4};",
        "    {{{kPortD, 1 << 5}, 0, kChannelB}, {kPortD, 1 << 7}, {kPortB, 1 << 0}};",
        "constexpr Pin kStandby = kNoPin;",
    ):
        assert f"{line}\n" in header
    assert max(map(len, header.splitlines())) <= 100


@pytest.mark.parametrize(("changes", "line"), [
    ((('status_led = 13', ''),), "constexpr Pin kLight = kNoPin;"),
    ((('range = [0, 400]', 'range = [2, 300]'),), "*value = in_limits(*value, 2000, 300000);"),
    ((('pin = "A0"', 'pin = "A0"\nzero = 0\nfull = 10'),), "analog_scaled(*value, 0, 9, 793);"),
    ((('pin = "A0"', 'pin = "A0"\nzero = 1023\nfull = 0'),),
     "analog_scaled(*value, 1023000, -1000, 0);"),
    ((('trigger = 4\necho = 3', 'trigger = 4\necho = "A5"'),), "each(PCINT1_vect)"),
])  # fmt: skip
def test_changes_of_a_profile_appear_in_the_header(
    changes: tuple[tuple[str, str], ...], line: str
) -> None:
    assert line in firmware.header([read_changed_profile("uno", "tinibot", *changes)], "a test.")


def test_the_answer_language_is_the_profiles_or_else_the_users() -> None:
    """The kit's fingerprint does not depend on it: programs run on both."""
    define = "#define tiniscript_language 0x6573\n"
    plain = read_changed_profile("uno")
    fixed_robot = read_changed_profile("uno", "tinibot", ("status_led = 13", 'language = "es"'))
    english = read_changed_profile("uno", "tinibot", ("status_led = 13", 'language = "en"'))
    assert plain.kit.fingerprint == fixed_robot.kit.fingerprint
    for robot, is_spanish in (
        (plain, False), (plain.with_language("en"), False), (plain.with_language("es"), True),
        (fixed_robot, True), (fixed_robot.with_language("en"), True),
        (english.with_language("es"), False),
    ):  # fmt: skip
        assert (define in firmware.header([robot], "a test.")) == is_spanish


def test_two_echoes_share_their_interrupt_vectors() -> None:
    second = '[[kit.sensors]]\nname = "BEHIND"\nkind = "number"\nunit = "cm"\nrange = [0, 400]\n\n'
    text = TEXTS["tinibot"].replace("[board]\n", f"{second}[board]\n", 1)
    for echo, vectors in ((7, "each(PCINT2_vect)"), (12, "each(PCINT2_vect) each(PCINT0_vect)")):
        second_sonar = (
            f'[board.sensors.BEHIND]\ndriver = "hc_sr04"\ntrigger = "A3"\necho = {echo}\n\n'
        )
        changed_text = text.replace("[body]\n", f"{second_sonar}[body]\n", 1)
        changed_text = changed_text.replace("left_forward = 7", 'left_forward = "A4"')
        changed_text = changed_text.replace("bluetooth_state = 12", 'bluetooth_state = "A5"')
        header = firmware.header([read(changed_text, "two")], "a test.")
        assert f"tiniscript_ultrasonic_vectors(each) {vectors}\n" in header


# -- the verb


def test_board_writes_the_header(tsc: Tsc, tmp_path: Path) -> None:
    target = tmp_path / "own.h"
    result = tsc("firmware", "--board", "liner", "-o", target)
    assert result.code == 0 and "pio run -d vm_arduino -e nano" in result.out
    header = target.read_text(encoding="utf-8")
    assert (
        header
        == tsc("firmware", "--board", "liner").out
        == tsc("firmware", "--board", "liner", "-o", "-").out
    )
    assert header == firmware.header(
        [robots.load("liner")], "tsc firmware --board, from a robot profile."
    )


def test_board_speaks_the_language_of_the_command(tsc: Tsc) -> None:
    assert (
        "#define tiniscript_language 0x6573\n"
        in tsc("firmware", "--board", "liner", "--lang", "es").out
    )
    assert "tiniscript_language" not in tsc("firmware", "--board", "liner", "--lang", "en").out


def test_board_refuses_unreadable_profiles(tsc: Tsc) -> None:
    assert tsc("firmware", "--board").code == 2
    assert tsc("firmware", "--board", "nobody").code == 2


def test_the_header_of_an_esp32_has_its_settings(tsc: Tsc) -> None:
    output = tsc("firmware", "--board", "tinibotc3").out
    for line in (
        "#if defined(CONFIG_IDF_TARGET_ESP32C3)  // esp32c3",
        "#define tiniscript_motors_two_wire",
        "#define tiniscript_ultrasonics",
        "constexpr Pwm kBuzzer = {{7}, 0};",
        "constexpr TwoWire kLeftMotor = {{{3}, 2}, {{4}, 3}};",  # a channel each, from an even one
        "  return {{2}, {{6}}};",
    ):
        assert line in output.splitlines()
    assert "kPort" not in output and "ultrasonic_vectors" not in output


# -- the Arduino IDE's own builder


@pytest.mark.long
@pytest.mark.sampled("board")
@pytest.mark.parametrize("board", sorted(arduino_builder.BOARDS))
def test_the_arduino_builder_builds_the_sketch(
    board: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    log = arduino_builder.firmware(board, tmp_path, shared_folder(tmp_path_factory)).log
    assert not [row for row in log.splitlines() if "warning" in row and "/src/" in row]
    assert "Sketch uses" in log
