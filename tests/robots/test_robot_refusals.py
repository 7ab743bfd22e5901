"""Refused robot profiles: each code, its sentences, failure with files, and broken files.

The results of a good profile are in `test_robots`.
"""

from __future__ import annotations

import json
import random
import re
from itertools import product
from pathlib import Path

import pytest

from tests.support.edited_robots import TEXTS, edit_profile
from tests.support.rows import each_row
from tests.support.texts import LANGUAGES, catalogue_texts
from tiniscript import robots
from tiniscript.robots.boards import ABILITIES, CHIPS
from tiniscript.robots.profile import ProfileRefused, Robot
from tiniscript.robots.reader import read
from tiniscript.robots.refusals import describe, printable_value


def refusal(text: str) -> ProfileRefused:
    with pytest.raises(ProfileRefused) as exception_info:
        read(text, "test")
    return exception_info.value


def codes(refusal: ProfileRefused) -> list[str]:
    return [code for code, _ in refusal.reasons]


TOO_MANY_SENSORS = "\n".join(f'[[kit.sensors]]\nname = "S{i}"\nkind = "yes/no"' for i in range(33))

# code, robot, replaced text, replacement, the path in the message
REFUSED = [
    ("not_toml", "tinibot", 'chip = "uno"', 'chip = "uno', None),
    ("not_toml", "tinibot", "baud = 9600", "baud = 9" + "9" * 5000, None),
    ("key_twice", "tinibot", "buzzer = 11", "buzzer = 11\nbuzzer = 12", None),
    ("at_stop_of_no_servo", "grabber", "pin = 30", 'pin = 30\nat_stop = "hold"',
     "board.actuators.LED.at_stop"),
    ("not_one_of", "grabber", 'at_stop = "release"', 'at_stop = "keep"',
     "board.actuators.GRIPPER.at_stop"),
    ("not_one_of", "tinibot", "baud = 9600", 'baud = 9600\nlanguage = "fr"', "board.language"),
    ("wrong_type", "tinibot", "baud = 9600", "baud = 9600\nlanguage = 5", "board.language"),
    ("wrong_type", "grabber", 'at_stop = "release"', "at_stop = true",
     "board.actuators.GRIPPER.at_stop"),
    ("unknown_key", "tinibot", "echo = 3", 'echo = 3\nat_stop = "hold"',
     "board.sensors.DISTANCE.at_stop"),
    ("missing", "tinibot", "range = [0, 1023]", "", "kit.sensors[1].range"),
    ("missing", "tinibot", 'kind = "number"\nunit', "unit", "kit.sensors[3].kind"),
    ("missing", "tinibot", 'name = "DISTANCE"', "", "kit.sensors[3].name"),
    ("missing", "tinibot", "start_button = 2", "", "board.start_button"),
    ("missing", "liner", '[board.actuators.LED]\ndriver = "digital"\npin = 3', "",
     "board.actuators.LED"),
    ("unknown_key", "tinibot", "baud = 9600", "baud = 9600\nzebra = 1", "board.zebra"),
    ("unknown_key", "tinibot", "unit =", "units =", "kit.sensors[3].units"),
    ("unknown_key", "tinibot", "[labels.en]", "[labels.qu]", "labels.qu"),
    ("wrong_type", "tinibot", "range = [0, 400]", "range = 400", "kit.sensors[3].range"),
    ("wrong_type", "tinibot", "range = [0, 400]", "range = [0, 4, 5]", "kit.sensors[3].range"),
    ("wrong_type", "tinibot", "range = [0, 400]", 'range = [0, "4"]', "kit.sensors[3].range"),
    ("wrong_type", "tinibot", 'name = "DISTANCE"', "name = 5", "kit.sensors[3].name"),
    ("wrong_type", "tinibot", "baud = 9600", "baud = 9600.0", "board.baud"),
    ("wrong_type", "tinibot", "buzzer = 11", "buzzer = true", "board.buzzer"),
    ("wrong_type", "liner", "pull_up = true", "pull_up = 1", "board.sensors.BUTTON.pull_up"),
    ("not_one_of", "tinibot", 'chip = "uno"', 'chip = "pico"', "board.chip"),
    ("not_one_of", "tinibot", "baud = 9600", "baud = 9601", "board.baud"),
    ("not_one_of", "tinibot", '"hc_sr04"', '"digital"', "board.sensors.DISTANCE.driver"),
    ("not_one_of", "tinibot", 'sees = "light"', 'sees = "stars"', "body.sensors.LIGHT_R.sees"),
    ("not_one_of", "grabber", 'sees = "distance"', 'sees = "distance", turns_with = "LED"',
     "body.sensors.DISTANCE.turns_with"),
    ("out_of_range", "tinibot", "baud = 9600", "baud = 0", "board.baud"),
    ("out_of_range", "tinibot", "baud = 9600", "baud = 9600\nprogram_bytes = 390",
     "board.program_bytes"),
    ("out_of_range", "tinibot", "[0, 400]", "[0, 2147483.648]", "kit.sensors[3].range"),
    ("out_of_range", "tinibot", "[0, 400]", f"[0, 0x{'F' * 9000}]", "kit.sensors[3].range"),
    ("out_of_range", "tinibot", "wheel_base_cm = 13.5", "wheel_base_cm = 0", "body.wheel_base_cm"),
    ("too_precise", "tinibot", "[0, 400]", "[0, 0.0001]", "kit.sensors[3].range"),
    ("number_odd", "tinibot", "[0, 400]", "[0, 4e2]", "kit.sensors[3].range"),
    ("range_empty", "tinibot", "[0, 400]", "[400, 0]", "kit.sensors[3].range"),
    ("range_empty", "tinibot", "[0, 400]", "[4, 4]", "kit.sensors[3].range"),
    ("range_not_whole", "grabber", "[0, 180]", "[0.5, 180]", "kit.actuators[1].range"),
    ("name_bad", "liner", 'name = "BATTERY"', 'name = "BATERÍA"', "kit.sensors[4].name"),
    ("name_bad", "liner", 'name = "BATTERY"', 'name = ""', "kit.sensors[4].name"),
    ("name_too_long", "liner", 'name = "BATTERY"', f'name = "{"B" * 25}"', "kit.sensors[4].name"),
    ("name_is_word", "liner", 'name = "BATTERY"', 'name = "time"', "kit.sensors[4].name"),
    ("name_twice", "liner", 'name = "LINE_R"', 'name = "Line_L"', "kit.sensors[2].name"),
    ("name_twice", "liner", 'name = "LED"', 'name = "BUTTON"', "kit.actuators[1].name"),
    ("name_twice", "tinibot", "[board.sensors.LIGHT_L]", "[board.sensors.light_r]",
     "board.sensors.light_r"),
    ("unknown_kind", "tinibot", 'kind = "number"', 'kind = "light"', "kit.sensors[1].kind"),
    ("not_for_yes_no", "liner", 'kind = "yes/no"', 'kind = "yes/no"\nrange = [0, 1]',
     "kit.sensors[1].range"),
    ("not_for_yes_no", "liner", 'kind = "yes/no"', 'kind = "yes/no"\nunit = "V"',
     "kit.sensors[1].unit"),
    ("unit_bad", "tinibot", 'unit = "cm"', 'unit = "c m"', "kit.sensors[3].unit"),
    ("unit_bad", "tinibot", 'unit = "cm"', 'unit = "centimetres"', "kit.sensors[3].unit"),
    ("too_many", "tinibot", '[[kit.sensors]]\nname = "LIGHT_R"',
     TOO_MANY_SENSORS + '\n[[kit.sensors]]\nname = "LIGHT_R"', "kit.sensors"),
    ("not_in_kit", "tinibot", "[board.sensors.DISTANCE]", "[board.sensors.SONAR]",
     "board.sensors.SONAR"),
    ("not_in_kit", "tinibot", "LIGHT_L = {", "LIGTH_L = {", "body.sensors.LIGTH_L"),
    ("not_in_kit", "tinibot", 'DISTANCE = "dis', 'WHEEL = "dis', "labels.en.WHEEL"),
    ("label_bad", "tinibot", 'robot = "TiniBot"', 'robot = " "', "labels.en.robot"),
    ("label_bad", "tinibot", 'robot = "TiniBot"', 'robot = "a\\u001b[2J"', "labels.en.robot"),
    ("no_such_pin", "tinibot", "buzzer = 11", "buzzer = 20", "board.buzzer"),
    ("no_such_pin", "tinibot", 'pin = "A0"', 'pin = "A6"', "board.sensors.LIGHT_R.pin"),
    ("no_such_pin", "tinibot", 'pin = "A0"', 'pin = "D5"', "board.sensors.LIGHT_R.pin"),
    ("pin_of_link", "tinibot", "trigger = 4", "trigger = 1", "board.sensors.DISTANCE.trigger"),
    ("pin_twice", "tinibot", "trigger = 4", "trigger = 11", "board.sensors.DISTANCE.trigger"),
    ("pin_cannot", "tinibot", "left_pwm = 5", "left_pwm = 4", "board.motors.left_pwm"),
    ("pin_cannot", "tinibot", 'pin = "A0"', "pin = 10", "board.sensors.LIGHT_R.pin"),
    ("pin_cannot", "liner", "standby = 4", 'standby = "A6"', "board.motors.standby"),
    ("pin_cannot", "tinibot2", "left = 2 ", "left = 4 ", "board.discs.left"),
    ("pin_twice", "tinibot2", "left = 2 ", "left = 3 ", "board.discs.right"),
    ("missing", "tinibot2", "left = 2 ", "# ", "board.discs.left"),
    ("missing", "tinibot2", 'driver = "slotted"', 'driver = "two_channel"', "board.discs.left_b"),
    ("not_one_of", "tinibot2", 'driver = "slotted"', 'driver = "slots"', "board.discs.driver"),
    ("unknown_key", "tinibot2", "wheel_cm = 6.5", "wheels_cm = 6.5", "board.discs.wheels_cm"),
    ("out_of_range", "tinibot2", "holes = 20", "holes = 4", "board.discs.holes"),
    ("out_of_range", "tinibot2", "wheel_cm = 6.5", "wheel_cm = 65", "board.discs.wheel_cm"),
    ("no_discs", "tinibotc3", "[board.motors]",
     '[board.discs]\ndriver = "slotted"\nleft = 2\nright = 3\n[board.motors]',
     "board.discs.left"),
    ("pin_cannot", "grabber", "echo = 2", "echo = 33", "board.sensors.DISTANCE.echo"),
    ("timer_twice", "tinibot", "left_pwm = 5", "left_pwm = 3", "board.motors.left_pwm"),
    ("timer_twice", "elegoo4", "left_pwm = 6", "left_pwm = 9", "board.motors.left_pwm"),
    ("pin_twice", "elegoo4", "button = 2", "button = 12", "board.sensors.DISTANCE.echo"),
    ("timer_twice", "grabber", "left_pwm = 6", "left_pwm = 12", "board.motors.left_pwm"),
    ("timer_twice", "grabber", "left_pwm = 6", "left_pwm = 9", "board.motors.left_pwm"),
]  # fmt: skip


@each_row("code, name, old, new, path", REFUSED)
def test_invalid_profiles_are_refused(
    code: str, name: str, old: str, new: str, path: str | None
) -> None:
    refusals = refusal(edit_profile(name, old, new))
    if path is None:
        assert codes(refusals) == [code]
    else:
        assert (code, path) in [(reason, values["path"]) for reason, values in refusals.reasons]
    for language in LANGUAGES:
        assert all(sentence for sentence in describe(refusals, language))


FAN = """
[[kit.actuators]]
name = "FAN"
kind = "number"
range = [0, 100]

[board.actuators.FAN]
driver = "pwm"
pin = {pin}
"""


@pytest.mark.parametrize(("motors", "pin", "timer", "first"), [
    ("servos", 9, 1, "board.motors.left_pin"),
    ("servos", 10, 1, "board.motors.left_pin"),
    ("l298n", 3, 2, "board.buzzer"),
    ("l298n", 5, None, ""),  # timer 0 keeps the time, and does PWM besides
])  # fmt: skip
def test_timer_conflicts_of_an_uno_are_refused(
    motors: str, pin: int, timer: int | None, first: str
) -> None:
    """Servos take PWM 9 and 10, the buzzer PWM 3 and 11; the names of both are said."""
    text_before, _, text_after = TEXTS["tinibot"].partition("[board.motors]")
    wired_text = {
        "servos": 'driver = "servos"\nleft_pin = 7\nright_pin = 8\n',
        "l298n": 'driver = "l298n"\nleft_pwm = 6\nleft_forward = 7\nleft_backward = 8\n'
        'right_pwm = 9\nright_forward = "A2"\nright_backward = 10\n',
    }[motors]
    text = f"{text_before}[board.motors]\n{wired_text}{FAN.format(pin=pin)}"
    text += "[board.sensors.LIGHT_R]" + text_after.partition("[board.sensors.LIGHT_R]")[2]
    text = text.replace("echo = 3", 'echo = "A3"')
    if timer is None:
        assert read(text, "test").board.actuators[0].pins == {"pin": pin}
        return
    refusals = refusal(text)
    assert codes(refusals) == ["timer_twice"]
    sentence = describe(refusals, "en")[0]
    assert sentence.startswith(f"board.actuators.FAN.pin is pin {pin}: its PWM needs timer {timer}")
    assert f"which {first} uses." in sentence


@pytest.mark.parametrize(("name", "old_text", "pin", "code"), [
    *(("tinibot32", "right_backward = 21", pin, "pin_at_boot") for pin in (0, 5, 12, 14, 15)),
    ("tinibot32", "left_pwm = 25", 12, "pin_at_boot"),
    ("tinibot32", "start_button = 4", 0, "pin_of_reset"),
    *(("tinibot32", "right_backward = 21", pin, "no_such_pin") for pin in range(6, 12)),
    *(("tinibot32", "right_backward = 21", pin, "pin_of_link") for pin in (1, 3)),
    *(("tinibot32", "right_backward = 21", pin, "pin_cannot") for pin in (34, 35, 36, 39)),
    *(("tinibot32", "pin = 34", pin, "pin_cannot") for pin in (0, 2, 12, 13, 14, 15)),
    # Pins of a device other than a motor.
    *(("tinibot32", "trigger = 18", pin, "") for pin in (0, 5, 12, 14, 15)),
    *(("tinibotc3", "right_backward = 10", pin, "pin_at_boot") for pin in (2, 6, 9)),
    *(("tinibotc3", "right_backward = 10", pin, "no_such_pin") for pin in range(11, 18)),
    *(("tinibotc3", "right_backward = 10", pin, "pin_of_link") for pin in (18, 19, 20, 21)),
    *(("tinibotc3", "buzzer = 7", pin, "pin_of_link") for pin in (18, 19)),
    ("tinibotc3", "pin = 0", 2, ""),
    ("tinibotc3", "pin = 0", 9, "pin_cannot"),
    ("tinibotc3", "start_button = 8", 9, "pin_of_reset"),
    ("tinibotc3", "start_button = 8", 2, ""),
])  # fmt: skip
def test_unsuitable_pins_of_esp32s_are_refused(
    name: str, old_text: str, pin: int, code: str
) -> None:
    """A pin with a reset pulse starts no motor; flash, link, inputs and ADC2 are checked."""
    key, _, value_text = old_text.partition(" = ")
    text, count = re.subn(rf"(?m)^{old_text}\b", f"{key} = {pin}", TEXTS[name])
    assert count == 1
    if (name, pin) == ("tinibotc3", 2):
        text = text.replace("trigger = 2", f"trigger = {value_text}")
    if not code:
        assert read(text, "test").board.chip.startswith("esp32")
        return
    refusals = refusal(text)
    assert codes(refusals) == [code]
    if name == "tinibot32" and code in ("pin_at_boot", "pin_of_reset"):
        sentence = describe(refusals, "en")[0]
        assert sentence.endswith(" 2, 4, 13, 16, 17, 18, 19, 21, 22, 23, 25, 26, 27, 32, 33.")


SWITCH = """
[[kit.sensors]]
name = "SWITCH"
kind = "yes/no"

[board.sensors.SWITCH]
driver = "digital"
pin = {pin}
pull_up = {pull_up}
"""


@pytest.mark.parametrize("name", ["tinibot", "liner", "grabber", "tinibot32", "tinibotc3"])
def test_a_pull_up_needs_a_pin_that_has_one(name: str) -> None:
    """A pin that only reads takes a sensor without one."""
    chip = CHIPS[read(TEXTS[name], "test").board.chip]
    for pin, pull_up in product(chip.digital_pins | chip.reading_pins, ("true", "false")):
        text_before, mark, text_after = TEXTS[name].partition("[board.motors]")
        switch_text = SWITCH.format(pin=json.dumps(_parse_pin(chip.pin_name(pin))), pull_up=pull_up)
        try:
            read(text_before + switch_text + mark + text_after, "test")
            reasons = []
        except ProfileRefused as refusal:
            reasons = [(code, values["path"]) for code, values in refusal.reasons]
        is_refused = ("pin_cannot", "board.sensors.SWITCH.pin") in reasons
        assert is_refused == (pull_up == "true" and pin not in chip.digital_pins), (pin, reasons)


def _parse_pin(name: str) -> object:
    return int(name) if name.isdigit() else name


def test_too_many_pwm_pins_of_an_esp32_c3_are_refused() -> None:
    """It has three timers, for two pins of one frequency each, so a fan in addition to four motor
    pins has none."""
    text_before, mark, text_after = TEXTS["tinibotc3"].partition("[board.sensors.LIGHT_R]")
    text = text_before + FAN.format(pin=9) + mark + text_after
    refusals = refusal(text)
    assert codes(refusals) == ["timers_used_up"]
    assert describe(refusals, "en")[0].startswith("board.actuators.FAN.pin is pin 9: its PWM needs")
    for old_text, new_text in (
        ("two_wire", "l298n"),
        ("left_forward = 3", "left_pwm = 3\nleft_forward = 6"),
        ("right_forward = 5", "right_pwm = 5\nright_forward = 2"),
    ):
        text = text.replace(old_text, new_text)
    assert "pin_at_boot" in codes(refusal(text)), "direction pins need no timer"
    dev = TEXTS["tinibot32"].partition("[board.sensors.LIGHT_R]")
    assert read(dev[0] + FAN.format(pin=22) + dev[1] + dev[2], "test").board.actuators


def test_every_code_has_a_test() -> None:
    of_boards = {"pin_at_boot", "pin_of_reset", "timers_used_up"}
    of_shields = {"shield_of_uno", "shield_pin_twice", "shield_timer_twice"}  # test_board_shield
    tested = (
        of_boards
        | of_shields
        | {"no_such_robot", *(code for code, *_ in FILES)}
        | {code for code, *_ in REFUSED}
    )
    texts = catalogue_texts("en", "refusals")
    codes = {key.removeprefix("profile/") for key in texts if key.startswith("profile/")}
    assert tested == {code for code in codes if not code.endswith("/near")}
    assert {f"need/{need}" for need in ABILITIES} == {key for key in texts if key[:5] == "need/"}


def test_all_complaints_are_reported_at_once() -> None:
    text = edit_profile("tinibot", "range = [0, 400]", "range = [4, 0]")
    text = text.replace("trigger = 4", "trigger = 1").replace('"LIGHT_R"', '"LOOP"', 1)
    text = text.replace("length_cm = 21", "length = 21")
    paths = codes(refusal(text))
    assert {"range_empty", "pin_of_link", "name_is_word", "missing", "unknown_key"} <= set(paths)


def test_a_missing_table_is_one_complaint() -> None:
    text_before, _, text_after = TEXTS["tinibot"].partition("[body]")
    text = text_before + "[labels.en]" + text_after.partition("[labels.en]")[2]
    assert [(code, values["path"]) for code, values in refusal(text).reasons] == [
        ("missing", "body")
    ]


def test_a_lamp_cannot_be_held() -> None:
    refusals = refusal(edit_profile("grabber", "pin = 30", 'pin = 30\nat_stop = "hold"'))
    assert codes(refusals) == ["at_stop_of_no_servo"]
    assert describe(refusals, "en")[0].endswith(
        "Remove the line; only a servo can keep its position."
    )
    assert "Quita esa línea" in describe(refusals, "es")[0]


def test_a_refusal_names_the_next_step() -> None:
    refusals = refusal(edit_profile("tinibot", "left_pwm = 5", "left_pwm = 4"))
    assert describe(refusals, "en") == [
        "board.motors.left_pwm is pin 4, which cannot be a PWM output on the board uno."
        " These can: 3, 5, 6, 9, 10, 11."
    ]
    refusals = refusal(edit_profile("tinibot", "[0, 400]", "400"))
    assert describe(refusals, "es") == [
        "kit.sensors[3].range es un número. Escribe ahí dos números, [menor, mayor]."
    ]
    refusals = refusal(edit_profile("tinibot", "baud =", "buad ="))
    assert "Did you mean baud?" in describe(refusals, "en")[0]


@pytest.mark.parametrize(
    ("name", "old_text", "new_text", "sentences"),
    [
        ("tinibot", "[board]", "[bord]", ["Did you mean board?"]),
        ("tinibot", "length_cm", "lenght_cm", ["Did you mean length_cm?"]),
        ("tinibot", "left_pwm = 5", "left_pvm = 5", ["Did you mean left_pwm?"]),
        ("tinibot", 'name = "DISTANCE"', 'name = "F"', ["a word of TiniScript"]),
        ("tinibot", 'name = "DISTANCE"', 'name = "AÑO"', ["without accents or ñ."]),
        # Parts missing for another reason are reported.
        ("tinibot", "length_cm = 21\nwidth_cm", "lenght_cm = 21\n#",
         ["width_cm is missing", "Did you mean length_cm?"]),
        ("tinibot", "trigger = 4\necho", "triger = 4\n#",
         ["echo is missing", "Did you mean trigger?"]),
    ],
)  # fmt: skip
def test_one_mistake_is_one_complaint(
    name: str, old_text: str, new_text: str, sentences: list[str]
) -> None:
    complaints = describe(refusal(edit_profile(name, old_text, new_text)), "en")
    assert len(complaints) == len(sentences), complaints
    for sentence, complaint in zip(sentences, complaints, strict=True):
        assert sentence in complaint


def test_a_renamed_device_names_all_tables_to_change() -> None:
    sentences = describe(
        refusal(edit_profile("tinibot", 'name = "DISTANCE"', 'name = "DISTANCIA"')), "en"
    )
    assert [sentence.partition(":")[0] for sentence in sentences] == [
        "board.sensors.DISTANCE", "body.sensors.DISTANCE",
        *(f"labels.{label}.DISTANCE" for label in robots.load("tinibot").labels),
    ]  # fmt: skip
    assert all(sentence.endswith("Did you mean DISTANCIA?") for sentence in sentences)


def test_shown_values_are_short_and_printable() -> None:
    assert printable_value("a\x1b[2J\n" + "b" * 99) == "a?[2J?" + "b" * 34 + "…"
    assert printable_value(16**9000) == "…"


# ---- files

FILES: list[tuple[str, bytes | None]] = [
    ("file_missing", None),
    ("file_too_large", b"#" * (robots.MAX_FILE_BYTES + 1)),
    ("file_not_utf8", b'[kit]\n# caf\xe9 = "x"\n'),
    ("file_is_directory", None),
    ("file_unreadable", None),
]


@pytest.mark.parametrize(("code", "content"), FILES)
def test_file_errors_are_reported(code: str, content: bytes | None, tmp_path: Path) -> None:
    path = str(tmp_path / "robot.toml")
    if content is not None:
        Path(path).write_bytes(content)
    elif code == "file_is_directory":
        path = str(tmp_path)
    elif code == "file_unreadable":
        path = "\0.toml"
    with pytest.raises(ProfileRefused) as exception_info:
        robots.load(path)
    assert codes(exception_info.value) == [code]
    assert all(describe(exception_info.value, language) for language in LANGUAGES)


def test_a_wrong_name_suggests_the_nearest_one() -> None:
    with pytest.raises(ProfileRefused) as exception_info:
        robots.load("Tinybot")
    assert describe(exception_info.value, "es") == [
        "No hay un robot Tinybot. ¿Quisiste decir tinibot? Los robots son: "
        f"{', '.join(robots.names())}."
    ]
    for name in ("", "zzz", "\0", "💥", "{path}"):
        with pytest.raises(ProfileRefused) as exception_info:
            robots.load(name)
        assert codes(exception_info.value) == ["no_such_robot"]
        assert (
            "Choose one of these, or give a .toml file: " in describe(exception_info.value, "en")[0]
        )


# ---- anything at all

ODD_NUMBERS = (
    "0", "-1", "1e999", "nan", "-inf", "1.0000000001", "9" * 5000, "0x" + "F" * 999, "true", '""',
    '"x"', '"A0"', '"\\u0000"', "[]", "[[]]", "[1, 2]", "[nan, {}]", "{}", "{ a = 1 }", "[{}]",
    "1979-05-27T07:32:00Z", "07:32:00", "'''", "", "[" * 3000, '"' + "ñ" * 99 + '"', "{path}",
)  # fmt: skip


def mutate(text: str, rng: random.Random) -> str:
    """A text with some lines deleted, doubled, moved, or given another value."""
    lines = text.split("\n")
    for _ in range(rng.choice((1, 1, 2, 5, 20))):
        index = rng.randrange(len(lines))
        key, equals, _ = lines[index].partition("=")
        kind = rng.randrange(6)
        if kind == 0:
            del lines[index]
        elif kind == 1:
            lines.insert(rng.randrange(len(lines)), lines[index])
        elif kind == 2 and lines[index]:
            cut = rng.randrange(len(lines[index]))
            lines[index] = (
                lines[index][:cut] + rng.choice('"[]{}=.#\\x5\x00') + lines[index][cut + 1 :]
            )
        elif kind == 3:
            lines[index] = re.sub(r"-?\d+", lambda _: rng.choice(ODD_NUMBERS), lines[index])
        elif equals:
            lines[index] = f"{key}= {rng.choice(ODD_NUMBERS)}"
        lines = lines or [""]
    return "\n".join(lines)


@pytest.mark.sampled("seed", keep=10)
@pytest.mark.parametrize("seed", range(40))
def test_a_broken_profile_is_always_refused(seed: int) -> None:
    rng = random.Random(seed)
    for _ in range(50):
        name = rng.choice(sorted(TEXTS))
        try:
            robot = read(mutate(TEXTS[name], rng), name)
        except ProfileRefused as refusal:
            assert refusal.reasons
            for language in LANGUAGES:
                for sentence in describe(refusal, language):
                    assert sentence.isprintable()
        else:
            assert isinstance(robot, Robot)
            assert 1 <= robot.kit.fingerprint <= 0xFFFF
