"""A world in the page's form: its text is read as the same world, and other files say why not."""

from __future__ import annotations

import json
from pathlib import Path
from random import Random
from typing import Any

import pytest

from tests.support.node import in_node, page_data
from tests.support.texts import LANGUAGES
from tiniscript import compile
from tiniscript.lessons import catalogue
from tiniscript.lessons.variation import vary
from tiniscript.studio import worker
from tiniscript.studio.world_form import form_of, limits, toml_of
from tiniscript.virtual import worlds
from tiniscript.virtual.world import World
from tiniscript.virtual.worlds import read

__all__ = ["page_data"]  # a fixture
PARTS_SCRIPT = Path(__file__).with_name("world_parts_in_node.mjs")
HISTORIES = 24


def is_near(value: Any, other_value: Any) -> bool:
    """Return whether two values are equal, except for rounding."""
    if isinstance(value, float | int) and not isinstance(value, bool):
        return isinstance(other_value, float | int) and abs(value - other_value) < 0.002
    if isinstance(value, tuple):
        return len(value) == len(other_value) and all(map(is_near, value, other_value))
    return bool(value == other_value)


def list_shipped_worlds() -> list[World]:
    lessons = [catalogue.load(folder) for folder in catalogue.folders()]
    return [*map(worlds.load, worlds.names()), *(vary(lesson, 3) for lesson in lessons)]


def test_the_text_of_a_form_is_the_same_world() -> None:
    worlds = list_shipped_worlds()
    assert len(worlds) > 10 and any(world.lamps for world in worlds)
    for world in worlds:
        round_tripped = read(toml_of(form_of(world)), world.name)
        assert is_near(tuple(round_tripped), tuple(world)), world.name


def test_random_forms_keep_every_number() -> None:
    rng = Random(16)

    def number(low: float, high: float) -> float:
        return round(rng.uniform(low, high), rng.randrange(4))

    def points() -> list[list[float]]:
        return [[number(0, 200), number(0, 150)] for _ in range(rng.randint(2, 9))]

    for _ in range(200):
        form = {
            "name": "own",
            "labels": {
                language: rng.choice(['my "own"', "a\\b", "own", "ñandú 🤖"])
                for language in LANGUAGES
            },
            "width_cm": 200.5,
            "height_cm": 150,
            "has_border": rng.random() < 0.5,
            "ambient_percent": number(0, 100),
            "start": {"x_cm": number(0, 200), "y_cm": number(0, 150), "heading": number(-180, 180)},
            "walls": [{"points": points()} for _ in range(rng.randrange(4))],
            "boxes": [{"x_cm": number(0, 200), "y_cm": number(0, 150), "length_cm": number(1, 60),
                       "width_cm": number(1, 60), "heading": number(-179, 179)}
                      for _ in range(rng.randrange(4))],
            "lines": [{"points": points(), "width_cm": number(0.5, 9)}
                      for _ in range(rng.randrange(3))],
            "lamps": [{"x_cm": number(0, 200), "y_cm": number(0, 150), "reach_cm": number(1, 300)}
                      for _ in range(rng.randrange(3))],
            "flags": [{"x_cm": number(0, 200), "y_cm": number(0, 150), "reach_cm": number(1, 300),
                       "rests": rng.random() < 0.5} for _ in range(rng.randrange(3))],
            "seconds": rng.choice([0, number(1, 600)]),
            "rings": [{"x_cm": number(0, 200), "y_cm": number(0, 150), "radius_cm": number(20, 90),
                       "edge_cm": number(0, 9)} for _ in range(rng.randrange(3))],
            "rivals": [{"x_cm": number(0, 200), "y_cm": number(0, 150),
                        "heading": number(-180, 180), "length_cm": number(5, 50),
                        "width_cm": number(5, 50), "speed_cm_s": number(1, 200),
                        "power_percent": number(0, 100)} for _ in range(rng.randrange(4))],
        }  # fmt: skip
        assert is_near(as_tuples(form_of(read(toml_of(form), "own"))), as_tuples(form))


def as_tuples(value: Any) -> Any:
    if isinstance(value, dict):
        return tuple((key, as_tuples(value[key])) for key in value)
    return tuple(map(as_tuples, value)) if isinstance(value, list) else value


def open_world(data: bytes, name: str = "own.toml", language: str = "en") -> dict[str, Any]:
    request = {"do": "open_world", "name": name, "language": language}
    answer: dict[str, Any] = json.loads(worker.answer(json.dumps(request), data))
    return answer


GOOD_WORLD = b"[floor]\nwidth_cm = 100\nheight_cm = 80\n[start]\nx_cm = 30\ny_cm = 30\n"
HOSTILE_VALUES = {
    "nothing": (b"", "floor"),
    "no TOML": (b"SI|F(2, 80)", "Line 1"),
    "no UTF-8": (b"\xff\xfe[floor]", "UTF-8"),
    "too large": (b"#" * 2_000_000, "has more than"),
    "another key": (GOOD_WORLD + b"[lamp]\nx = 1\n", "lamp"),
    "a start outside": (GOOD_WORLD.replace(b"x_cm = 30", b"x_cm = 300"), "starts outside"),
    "endless": (GOOD_WORLD.replace(b"100", b"inf"), "width_cm"),
    "too many parts": (GOOD_WORLD + b"[[lamps]]\nx_cm = 1\ny_cm = 1\n" * 101, "101 parts"),
    "a long number": (GOOD_WORLD.replace(b"100", b"9" * 5000), ""),
    "deep": (b"a = " + b"[" * 5000, ""),
}


@pytest.mark.parametrize("name", HOSTILE_VALUES)
def test_a_file_that_is_not_a_world_is_refused_with_a_reason(name: str) -> None:
    data, message = HOSTILE_VALUES[name]
    for language in ("en", "es"):
        answer = open_world(data, language=language)
        assert set(answer) == {"refused"} and answer["refused"]
        assert all(len(sentence) < 400 and sentence.isprintable() for sentence in answer["refused"])
        assert language == "es" or message in " ".join(answer["refused"])


@pytest.mark.parametrize("name", ["a.toml", ".toml", "", "x" * 5000 + ".toml", "\x1b[31m\n.toml"])
def test_files_of_any_name_can_be_opened_and_written(name: str) -> None:
    opened_world = open_world(GOOD_WORLD, name)
    request = {
        "do": "write_world",
        "form": opened_world["world"],
        "robot": "tinibot",
        "language": "en",
    }
    answer = json.loads(worker.answer(json.dumps(request)))
    assert not answer["is_blocked"]
    assert read(answer["text"], "own").start == (30, 30, 0)


def test_a_robot_that_does_not_fit_or_is_off_the_floor_is_reported() -> None:
    world = open_world(GOOD_WORLD.replace(b"x_cm = 30", b"x_cm = 3"))["world"]
    request = {"do": "write_world", "form": world, "robot": "tinibot", "language": "en"}
    assert json.loads(worker.answer(json.dumps(request)))["is_blocked"]
    start = {"do": "power_on", "robot": "tinibot", "world": {"form": world}, "language": "en"}
    assert "does not fit" in json.loads(worker.answer(json.dumps(start)))["refused"][0]
    world["start"]["x_cm"] = 100.1
    for language, expected in (
        ("en", "starts outside the floor"),
        ("es", "empieza fuera del piso"),
    ):
        answer = json.loads(worker.answer(json.dumps({**request, "language": language})))
        assert set(answer) == {"refused"} and expected in answer["refused"][0]


def test_a_robot_begins_at_its_start_if_there_is_room() -> None:
    world = open_world(GOOD_WORLD)["world"]
    start = {"do": "power_on", "robot": "tinibot", "world": {"form": world}, "language": "en"}
    image = compile("SI|S").image
    at = (world["start"]["x_cm"], world["start"]["y_cm"], world["start"]["heading"])
    for pose, place in ((None, at), ((40, 35, 90), (40, 35, 90)), ((1, 1, 0), at)):
        answer = json.loads(worker.answer(json.dumps({**start, "pose": pose}), image))
        assert tuple(answer["pose"]) == pytest.approx(place), pose


def test_the_limits_are_those_of_the_reader() -> None:
    parts, points = limits()["parts"], limits()["points"]
    form = open_world(GOOD_WORLD)["world"]
    form["walls"] = [{"points": [[1, 1]] * points}] * parts
    assert len(read(toml_of(form), "").walls) == parts


def count_parts(form: dict[str, Any]) -> dict[str, int]:
    return {kind: len(parts) for kind, parts in form.items() if isinstance(parts, list)}


def test_what_somebody_draws_moves_and_turns_is_the_world_that_was_asked_for(
    page_data: Path,
) -> None:
    """Each change changes its part alone; whatever comes of many is a world, with every part."""
    lines = in_node(PARTS_SCRIPT, str(page_data), "0", str(HISTORIES))
    assert len(lines) == HISTORIES
    for line in lines:
        form = json.loads(line)
        assert count_parts(form_of(read(toml_of(form), form["name"]))) == count_parts(form)
