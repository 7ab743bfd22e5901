"""Finds the shipped robot nearest to a person's own."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.edited_robots import TEXTS
from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.robots.nearness import nearest_to
from tiniscript.robots.reader import read

BATTERY = '[[kit.sensors]]\nname = "BATTERY"\nkind = "number"\nunit = "V"\nrange = [0, 10]\n\n'


@pytest.mark.parametrize("name", robots.names())
def test_a_shipped_robot_is_nearest_to_itself(name: str) -> None:
    """Robots with the same kit are distinguished by their boards. A kit does not say whether the
    wheels have discs.
    """
    nearest = nearest_to(robots.load(name))
    assert nearest.is_same and not nearest.devices_only_there and not nearest.devices_only_here
    kits = robots.load(name).kit, robots.load(nearest.name).kit
    assert kits[0].fingerprint == kits[1].fingerprint
    chips = robots.load(name).board.chip, robots.load(nearest.name).board.chip
    assert chips[0] == chips[1]


def test_common_parts_count_before_differing_ones() -> None:
    text = TEXTS["liner"].replace(BATTERY, "")
    assert text != TEXTS["liner"]
    head, _, rest = text.partition("[board.sensors.BATTERY]")
    text = head + rest[rest.index("[board.actuators.LED]") :]
    text = text.replace('BATTERY = "battery voltage"\n', "")
    nearest = nearest_to(read(text, "mine"))
    assert nearest == ("liner", False, ("LINE_L", "LINE_R", "BUTTON", "LED"), ("BATTERY",), ())
    other_text = TEXTS["tinibot"].replace('"LIGHT_R"', '"LIGHT_B"', 1)
    for table in ("board.sensors.", "body.sensors."):
        other_text = other_text.replace(f"[{table}LIGHT_R]", f"[{table}LIGHT_B]")
    other_text = other_text.replace("\nLIGHT_R = {", "\nLIGHT_B = {").replace(
        'LIGHT_R = "', 'LIGHT_B = "'
    )
    nearest = nearest_to(read(other_text, "mine"))
    assert nearest == ("tinibot", False, ("LIGHT_L", "DISTANCE"), ("LIGHT_R",), ("LIGHT_B",))
    range_of = TEXTS["grabber"].replace("range = [0, 180]", "range = [0, 90]")
    nearest = nearest_to(read(range_of, "mine"))
    assert (nearest.name, nearest.devices_only_there, nearest.devices_only_here) == (
        "grabber", ("GRIPPER",), ("GRIPPER",),
    )  # fmt: skip


def test_more_common_parts_count_before_fewer_differing_ones() -> None:
    distance, _, button = robots.load("grabber").kit.sensors
    mine = robots.load("tinibot")._replace(kit=Kit((distance, button), ()))
    assert nearest_to(mine)[:3] == ("grabber", False, ("DISTANCE", "BUTTON"))


def test_the_command_names_the_nearest_robot_only_for_custom_files(
    tsc: Tsc, tmp_path: Path
) -> None:
    own_profile = tmp_path / "mine.toml"
    own_profile.write_text(TEXTS["tinibot"], encoding="utf-8")
    result = tsc("firmware", "--board", own_profile, "-o", tmp_path / "own.h")
    assert "Your robot has the same kit as tinibot" in result.err
    own_profile.write_text(TEXTS["grabber"].replace("[0, 180]", "[0, 90]"), encoding="utf-8")
    result = tsc("firmware", "--board", own_profile, "-o", tmp_path / "own.h")
    assert result.err == (
        "Of the robots that come with tsc, grabber is the most similar to yours. In common:"
        " DISTANCE, TEMPERATURE, BUTTON, LED. Only grabber has: GRIPPER. Only yours has: GRIPPER.\n"
    )
    assert tsc("firmware", "--board", "grabber", "-o", tmp_path / "own.h").err == ""
