"""The run of a document's case: a robot, readings and limits, and the compiled program."""

from __future__ import annotations

from tests.machines import Senses
from tests.support.casefile import Case
from tiniscript import Compilation, compile_text, robots
from tiniscript.cli.options import decimal
from tiniscript.library.named_robot import shipped_name_in
from tiniscript.robots.profile import Robot


def robot_and_senses(case: Case) -> tuple[Robot, Senses]:
    """Return the content of the fence `senses`: `robot`, `max-time`, `seed`, and a list per
    sensor.
    """
    readings: dict[str, list[int]] = {}
    named_text = shipped_name_in(case.parts.get("tiniscript", "").encode())
    options = {"robot": named_text or robots.DEFAULT, "max-time": "60", "seed": "1"}
    for row in case.parts.get("senses", "").splitlines():
        name, _, values = (part.strip() for part in row.partition("="))
        if name in options:
            options[name] = values
        else:
            words = {"TRUE": 1, "FALSE": 0}
            read_values = [
                words.get(text.strip(), decimal(text.strip())) for text in values.split(",")
            ]
            readings[name] = [value for value in read_values if value is not None]
            assert len(readings[name]) == len(read_values), f"{case.id}: {row}"
    max_ms = decimal(options["max-time"])
    assert max_ms is not None
    return robots.load(options["robot"]), Senses(readings, max_ms, seed=int(options["seed"]))


def compile_case(case: Case) -> Compilation:
    robot, _ = robot_and_senses(case)
    return compile_text(case.parts["tiniscript"].removesuffix("\n"), robot.kit)
