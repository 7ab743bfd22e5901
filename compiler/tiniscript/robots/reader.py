"""Reads the text of a profile into a Robot, or raises all complaints about it at once.

Reads `[kit]`, `[body]` and `[labels]`; `board_reader` reads `[board]`. Opens no files.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from tiniscript.base.fixed_point import ONE
from tiniscript.base.kit import MAX_DEVICES, NUMBER, YES_NO, Device, Kit
from tiniscript.base.languages import SOURCE_LANGUAGE, ByLanguage, languages
from tiniscript.base.words import WORDS
from tiniscript.robots.board_reader import device_tables, read_board
from tiniscript.robots.profile import SEEN_KINDS, Body, Place, ProfileRefused, Robot
from tiniscript.robots.refusals import printable_value
from tiniscript.robots.toml_table import Table, root_of

MAX_NAME_CHARACTERS = 24
MAX_UNIT_CHARACTERS = 8
MAX_LABEL_CHARACTERS = 60
FARTHEST_CM = 1000 * ONE
FASTEST_CM_S = 1000 * ONE
FASTEST_TURN = 10_000 * ONE


def read(text: str, name: str, chip: str | None = None) -> Robot:
    """Return the robot that a profile's text describes, under `name`.

    `chip` replaces the board that the profile names. Raises ProfileRefused.
    """
    with root_of(text, ProfileRefused) as root:
        kit = _read_kit(root.table("kit", "[kit]"))
        board_table = root.table("board", "[board]")
        if chip is not None:
            board_table.set_value("chip", chip)
        board = read_board(board_table, kit)
        body = _read_body(root.table("body", "[body]"), kit)
        labels = _read_labels(root.table("labels"), kit, printable_value(name))
    return Robot(printable_value(name), kit, board, body, labels)


def _read_kit(table: Table) -> Kit:
    taken_names: set[str] = set()

    def speed(key: str, highest: int) -> int:
        return table.number(key, 1, highest) if table.check_for(key) else 0

    kit = Kit(
        _read_devices(table, "sensors", taken_names),
        _read_devices(table, "actuators", taken_names),
        speed("speed", FASTEST_CM_S),
        speed("turn", FASTEST_TURN),
    )
    table.finish()
    return kit


def _read_devices(table: Table, key: str, taken_names: set[str]) -> tuple[Device, ...]:
    tables = table.tables(key)
    if len(tables) > MAX_DEVICES:
        table.complain("too_many", key, found=str(len(tables)), most=str(MAX_DEVICES))
    return tuple(_read_device(table, key == "actuators", taken_names) for table in tables)


def _read_device(table: Table, is_actuator: bool, taken_names: set[str]) -> Device:
    name = _read_name(table, taken_names)
    kind = table.choice("kind", (NUMBER, YES_NO), "unknown_kind")
    unit, low, high = "", 0, 1
    if kind == YES_NO:
        for key in ("unit", "range"):
            if table.check_for(key):
                table.complain("not_for_yes_no", key)
    else:
        if table.check_for("unit"):
            unit = _read_unit(table)
        example = "range = [0, 180]" if is_actuator else "range = [0, 1023]"
        low, high = _read_range(table, example if kind else "", is_actuator)
    table.finish()
    return Device(name, kind, unit, low, high)


def _read_name(table: Table, taken_names: set[str]) -> str:
    text = table.text("name", 'name = "DISTANCE"')
    if text is None:
        return ""
    name = text.upper()
    if not _is_name(text):
        table.complain("name_bad", "name", found=printable_value(text))
    elif len(name) > MAX_NAME_CHARACTERS:
        table.complain(
            "name_too_long", "name", found=printable_value(name), most=str(MAX_NAME_CHARACTERS)
        )
    elif name in WORDS:
        table.complain("name_is_word", "name", found=name)
    elif name in taken_names:
        table.complain("name_twice", "name", found=name)
    taken_names.add(name)
    return name


def _is_name(text: str) -> bool:
    return text.isascii() and text[:1].isalpha() and text.replace("_", "a").isalnum()


def _read_unit(table: Table) -> str:
    unit = table.text("unit") or ""
    if len(unit) > MAX_UNIT_CHARACTERS or not unit.isprintable() or " " in unit:
        table.complain(
            "unit_bad", "unit", found=printable_value(unit), most=str(MAX_UNIT_CHARACTERS)
        )
    return unit


def _read_range(table: Table, example: str, is_actuator: bool) -> tuple[int, int]:
    reason_count_before = len(table.reasons)
    low, high = table.pair("range", example)
    if len(table.reasons) == reason_count_before and table.check_for("range"):
        if low >= high:
            table.complain("range_empty", "range")
        elif is_actuator and (low % ONE or high % ONE):
            table.complain("range_not_whole", "range")
    return low, high


def _read_body(table: Table, kit: Kit) -> Body:
    def size(key: str, sample: str, greatest: int = FARTHEST_CM) -> float:
        return table.number(key, 1, greatest, f"{key} = {sample}") / ONE

    wheel_base_cm = size("wheel_base_cm", "13.5")
    given_cm_s = 0.0
    if table.check_for("speed_cm_s") or not kit.speed:
        given_cm_s = size("speed_cm_s", "45", FASTEST_CM_S)
    speed_cm_s = kit.speed / ONE or given_cm_s
    wheel_turn_s = math.degrees(2 * speed_cm_s / wheel_base_cm) if wheel_base_cm else 0.0
    turn_s = kit.turn / ONE or wheel_turn_s
    length_cm, width_cm = size("length_cm", "20"), size("width_cm", "15")
    sensor_tables = device_tables(table, "sensors", kit.sensors)
    servos = tuple(device.name for device in kit.actuators if not device.is_yes_no)
    places = {
        name: _read_place(sensor_tables[name], servos)
        for name, *_ in kit.sensors
        if name in sensor_tables
    }
    table.finish()
    return Body(wheel_base_cm, speed_cm_s, turn_s, length_cm, width_cm, places)


def _read_place(table: Table, servos: Sequence[str]) -> Place:
    def number(key: str, greatest: int, example: str = "") -> float:
        return table.number(key, -greatest, greatest, example) / ONE

    x_cm = number("x_cm", FARTHEST_CM, "x_cm = 8")
    y_cm = number("y_cm", FARTHEST_CM, "y_cm = 0")
    place = Place(x_cm, y_cm, number("heading", 360 * ONE), table.choice("sees", SEEN_KINDS))
    if table.check_for("turns_with"):
        place = place._replace(turns_with=table.choice("turns_with", servos))
    table.finish()
    return place


def _read_labels(table: Table, kit: Kit, name: str) -> Mapping[str, Mapping[str, str]]:
    """Return the labels by language, English and those that are written.

    A missing one is taken from another language, or is the name itself.
    """
    devices = (*kit.sensors, *kit.actuators)
    label_languages = [language for language in languages() if table.check_for(language)]
    labels_by_language = {
        label_language: _read_language(table, label_language, devices)
        for label_language in label_languages
    }
    table.finish()
    labels: ByLanguage[dict[str, str]] = ByLanguage()
    for language in dict.fromkeys((SOURCE_LANGUAGE, *label_languages)):
        labels[language] = {"robot": name, **{device.name: device.name for device in devices}}
        for label_language in (*label_languages, language):
            labels[language].update(labels_by_language.get(label_language, {}))
    return labels


def _read_language(table: Table, language: str, devices: Sequence[Device]) -> dict[str, str]:
    labels = table.table(language)
    known_names = {device.name: device.name for device in devices}
    label_of_name = {}
    for key in labels.key_names():
        name = "robot" if key == "robot" else known_names.get(key.upper())
        if name is None:
            labels.complain_not_in_kit(key, tuple(known_names))
        elif (label := labels.label(key, MAX_LABEL_CHARACTERS)) is not None:
            label_of_name[name] = label
    return label_of_name
