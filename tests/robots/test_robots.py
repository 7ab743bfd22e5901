"""Robot profiles: the shipped ones, the content of a file, and the basis of a fingerprint."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.edited_robots import FOLDER, TEXTS, edit_profile
from tests.support.texts import LANGUAGES
from tiniscript import robots
from tiniscript.robots.boards import ABILITIES, CHIPS, Chip
from tiniscript.robots.drivers import DRIVERS, drivers_for
from tiniscript.robots.reader import read

FINGERPRINTS = {"tinibot": 0x231B, "liner": 0xFC65, "grabber": 0x74B5,
                "tinibot2": 0x231B, "tinibot32": 0x231B, "tinibotc3": 0x231B,
                "elegoo4": 0x73BC, "sumo": 0x742B}  # fmt: skip


# ---- the shipped robots


def test_the_default_comes_first_and_every_toml_is_shipped() -> None:
    assert robots.names()[0] == robots.DEFAULT
    assert sorted(robots.names()) == sorted(TEXTS) == sorted(FINGERPRINTS)


@pytest.mark.parametrize("name", sorted(TEXTS))
def test_a_shipped_robot_matches_its_toml(name: str) -> None:
    robot = robots.load(name)
    assert robot == robots.load(str(FOLDER / f"{name}.toml"))
    assert robots.load(name.upper()) == read(TEXTS[name], name)
    assert robot.kit.fingerprint == FINGERPRINTS[name], "it is a promise"
    devices = (*robot.kit.sensors, *robot.kit.actuators)
    for language in LANGUAGES:
        assert set(robot.labels[language]) == {"robot", *(device.name for device in devices)}
        assert all(robot.labels[language][device.name] != device.name for device in devices)
    assert len(robot.board.sensors) == len(robot.kit.sensors)
    assert len(robot.board.actuators) == len(robot.kit.actuators)
    assert robot.board.program_bytes == CHIPS[robot.board.chip].program_bytes


def test_the_default_is_the_robot_of_the_paper() -> None:
    robot = robots.load(robots.DEFAULT)
    sensors = [(sensor.name, sensor.unit, sensor.low, sensor.high) for sensor in robot.kit.sensors]
    assert sensors == [
        ("LIGHT_R", "", 0, 1_023_000),
        ("LIGHT_L", "", 0, 1_023_000),
        ("DISTANCE", "cm", 0, 400_000),
    ]
    assert robot.kit.actuators == ()
    assert robot.board.motors.driver == "l298n"
    assert robot.board.sensors[0].pins == {"pin": 14}


def test_a_shipped_robot_needs_no_toml() -> None:
    program = (
        "import sys; from tiniscript import robots; robots.load(robots.DEFAULT);"
        "print(*{'tomllib', 'tomli', 'dataclasses', 'difflib'} & set(sys.modules))"
    )
    environment = {**os.environ, "PYTHONPATH": str(FOLDER.parents[1])}
    command = [sys.executable, "-c", program]
    completed = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert completed.stdout.strip() == ""


# ---- the fingerprint


@pytest.mark.parametrize(
    ("old_text", "new_text"),
    [
        ('robot = "Grabber"', 'robot = "Big hand"'),
        ('LED = "lamp"', ""),
        ("baud = 57600", "baud = 9600"),
        ("left_pwm = 6", "left_pwm = 8"),
        ("speed = 40", "speed = 40.5"),
        ("x_cm = 14", "x_cm = -14"),
        ('name = "GRIPPER"', 'name = "Gripper"'),
        ("range = [-40, 125]", "range = [-40.000, 125.0]"),
    ],
)
def test_the_fingerprint_ignores_parts_that_programs_do_not_use(
    old_text: str, new_text: str
) -> None:
    assert (
        read(edit_profile("grabber", old_text, new_text), "x").kit.fingerprint
        == FINGERPRINTS["grabber"]
    )


@pytest.mark.parametrize(
    ("old_text", "new_text"),
    [
        ('unit = "cm"', 'unit = "mm"'),
        ('unit = "cm"', ""),
        ("range = [0, 400]", "range = [0, 400.001]"),
        ("range = [0, 400]", "range = [-0.001, 400]"),
        ("range = [0, 180]", "range = [1, 180]"),
        ("range = [0, 180]", "range = [0, 181]"),
    ],
)
def test_the_fingerprint_covers_ranges_and_units(old_text: str, new_text: str) -> None:
    assert (
        read(edit_profile("grabber", old_text, new_text), "x").kit.fingerprint
        != FINGERPRINTS["grabber"]
    )


def test_the_fingerprint_covers_names_kinds_and_order() -> None:
    text = TEXTS["tinibot"]
    swapped_text = text.replace("LIGHT_R", "LIGHT_X").replace("LIGHT_L", "LIGHT_R")
    renamed_text = text.replace("LIGHT_R", "LAMP")
    other_kind = text.replace('kind = "number"\nrange = [0, 1023]', 'kind = "yes/no"', 1).replace(
        'driver = "analog"', 'driver = "digital"', 1
    )
    texts = [swapped_text.replace("LIGHT_X", "LIGHT_L"), renamed_text, other_kind]
    fingerprints = {read(text, "x").kit.fingerprint for text in texts}
    assert len(fingerprints) == 3
    assert FINGERPRINTS["tinibot"] not in fingerprints


# ---- reading


def test_names_are_stored_in_capitals_everywhere() -> None:
    robot = read(TEXTS["liner"].replace("LINE_L", "line_l"), "x")
    assert robot.kit.sensors[0].name == "LINE_L"
    assert robot.labels["es"]["LINE_L"] == "sensor de línea izquierdo"
    assert "LINE_L" in robot.body.places


def test_numbers_are_exact() -> None:
    text = edit_profile("tinibot", "range = [0, 400]", "range = [-2147483.648, 2147483.647]")
    distance = read(text, "x").kit.sensors[2]
    assert (distance.low, distance.high) == (-(2**31), 2**31 - 1)
    text = edit_profile("tinibot", "range = [0, 400]", "range = [+0.1000, 1_000.25]")
    assert read(text, "x").kit.sensors[2][3:] == (100, 1_000_250)


def test_a_missing_label_falls_back_to_another_language_or_the_name() -> None:
    text = TEXTS["tinibot"].partition("[labels.en]")[0]
    assert read(text, "mine").labels["es"] == {
        "robot": "mine",
        "LIGHT_R": "LIGHT_R",
        "LIGHT_L": "LIGHT_L",
        "DISTANCE": "DISTANCE",
    }
    labels = read(text + '[labels.es]\nrobot = "Mío"\n', "mine").labels
    assert labels["en"]["robot"] == labels["es"]["robot"] == "Mío"


def test_a_robot_may_have_no_devices() -> None:
    board = TEXTS["tinibot"].partition("[board]")[2].partition("# Drivers of sensors")[0]
    body = TEXTS["tinibot"].partition("[body]")[2].partition("[body.sensors]")[0]
    text = f"[kit]\nspeed = 45\n[board]{board}[body]{body}"
    assert read(text, "x").kit.sensors == ()


def test_a_wire_that_is_optional_may_be_missing() -> None:
    board = read(
        edit_profile("liner", "status_led = 13\n", "").replace("standby = 4", ""), "x"
    ).board
    assert board.status_led is None
    assert board.bluetooth_state is None
    assert "standby" not in board.motors.pins


@pytest.mark.parametrize(
    ("motors", "settings"),
    [
        ('driver = "l293d"', {}),
        (
            'driver = "two_wire"\nleft_forward = 5\nleft_backward = 6\n'
            "right_forward = 9\nright_backward = 10",
            {},
        ),
        (
            'driver = "servos"\nleft_pin = 9\nright_pin = 10',
            {
                "left_reversed": 0,
                "right_reversed": 1,
                "left_still_us": 1500,
                "right_still_us": 1500,
            },
        ),
    ],
)
def test_motor_drivers_are_read(motors: str, settings: dict[str, int]) -> None:
    text_before, _, text_after = TEXTS["tinibot"].partition("\n[board.motors]\n")
    pins = text_after.partition("left_pwm")[2].partition("\n\n")
    used_pin = f"left_pwm{pins[0]}" if "l293d" in motors else ""
    text = f"{text_before}\n[board.motors]\n{motors}\n{used_pin}\n{pins[2]}"
    assert read(text, "x").board.motors.settings == settings


def test_a_file_may_have_any_name_a_bom_and_crlf(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = TEXTS["tinibot"].replace("\n", "\r\n")
    (tmp_path / "mine").write_bytes(b"\xef\xbb\xbf" + text.encode())
    monkeypatch.chdir(tmp_path)
    robot = robots.load("mine")
    assert robot == robots.load("tinibot")._replace(name="mine")


# ---- tables of the boards


def test_every_driver_has_a_use_and_needs_known_abilities() -> None:
    uses = {used_by for used_by, _ in DRIVERS}
    kinds = {
        f"{group} {kind}" for group in ("sensors", "actuators") for kind in ("number", "yes/no")
    }
    assert uses == {"motors", "discs", *kinds}
    assert all(drivers_for(used_by) for used_by in uses)
    for driver in DRIVERS.values():
        assert all(pin.ability in ABILITIES for pin in driver.pins)
        assert all(setting.low <= setting.default <= setting.high for setting in driver.settings)


@pytest.mark.parametrize("chip", CHIPS.values(), ids=list(CHIPS))
def test_every_ability_has_a_pin_and_link_pins_have_none(chip: Chip) -> None:
    all_pins = chip.digital_pins | chip.reading_pins | chip.analog_pins
    assert not all_pins & chip.link_pins
    assert set(chip.timer_of_pwm_pin) <= chip.digital_pins
    assert all(chip.has_ability(pin, "input") for pin in chip.digital_pins | chip.reading_pins)
    missing = {
        need for need in ABILITIES if not any(chip.has_ability(pin, need) for pin in all_pins)
    }
    assert missing == ({"count"} if chip.name == "esp32c3" else set())
    assert all(chip.pin_number(_parse_key(chip.pin_name(pin))) == pin for pin in all_pins)


def _parse_key(name: str) -> object:
    return int(name) if name.isdigit() else name
