"""The robot that a message names for a word that the program's own robot lacks."""

from __future__ import annotations

import pytest

from tiniscript import robots
from tiniscript.diagnostics.codes import OTHER_ROBOT
from tiniscript.lessons import catalogue
from tiniscript.library.compiling import compile_source
from tiniscript.library.other_robots import BUTTON, LESSON_ROBOTS


def first_named(text: str, name: str = "tinibot") -> str:
    compiled = compile_source(text.encode(), robots.load(name), "x.ts", False, is_chosen=True)
    return next(
        diagnostic.values["first"]
        for diagnostic in compiled.diagnostics
        if diagnostic.code is OTHER_ROBOT
    )


def test_the_robots_of_the_lessons_are_suggested() -> None:
    kits = {robots.load(catalogue.load(folder).robot).kit for folder in catalogue.folders()}
    assert kits == {robots.load(name).kit for name in LESSON_ROBOTS}


@pytest.mark.parametrize("name", [name for name in robots.names() if name != "tinibot"])
def test_a_robot_named_in_the_program_is_suggested(name: str) -> None:
    """Also where others have the word, too."""
    kit = robots.load(name).kit
    own_names = {BUTTON, *robots.load("tinibot").kit.names}  # of a button there is another message
    for word in {device.name for device in kit.sensors} - own_names:
        assert first_named(f"// robot: {name}\nSI|SHOW({word})") == name


@pytest.mark.parametrize(("text", "meant"), [
    ("SI|SHOW(LINE_L)", "liner"), ("SI|SHOW(BATTERY)", "liner"), ("SI|SHOW(LINE_M)", "elegoo4"),
    ("SI|SHOW(LINE_L);NECK(90)", "elegoo4"), ("SI|SHOW(LINE_L);LED(TRUE)", "liner"),
    ("SI|LED(TRUE);GRIPPER(9)", "grabber"), ("SI|SHOW(LINE_L);SHOW(DISTANCE);LED(TRUE)", "liner"),
])  # fmt: skip
def test_otherwise_the_robot_with_most_words_is_suggested(text: str, meant: str) -> None:
    assert first_named(text) == meant
