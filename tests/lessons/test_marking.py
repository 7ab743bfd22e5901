"""A program is marked in all worlds of a lesson, and again without each word that this needs."""

from __future__ import annotations

import random
from typing import NamedTuple

import pytest

from tiniscript import robots
from tiniscript.lessons import catalogue, marking
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.lesson import Criterion
from tiniscript.lessons.marking import FAILED, PASSED, Marking

WORDS = ("LOOP", "DEF", "TASK", "WHEN")
ROBOT = robots.load("tinibot")
LESSON = catalogue.load(catalogue.folders()[0])


class FakeRun(NamedTuple):
    left_out_word: str  # "" is the whole program
    world: int
    ending: str = "DONE"
    driven_cm: float = 0.0


class FakeTrial(NamedTuple):
    """Its image is the word that the program is tried without."""

    image: str
    robot: object
    lesson: object
    world: int

    def advance(self, most_ms: int | None) -> FakeRun:
        return FakeRun(self.image, self.world)


def expected_mark(
    words: list[str], worlds: list[int], wrong: set[str], failing: set[tuple[str, int]]
) -> tuple[str, int, str]:
    """Return the verdict, the world, and the word that the solution does not need."""
    for world in worlds:
        if ("", world) in failing:
            return FAILED, world, ""
    for word in words:
        if word not in wrong and not any((word, world) in failing for world in worlds):
            return FAILED, 0, word
    return PASSED, 0, ""


@pytest.mark.parametrize("seed", range(100))
def test_each_needed_word_is_left_out_in_all_worlds(
    monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    rng = random.Random(seed)
    words = rng.sample(WORDS, rng.randint(1, 4))
    worlds = rng.sample(range(1, 9), rng.randint(1, 4))
    wrong = {word for word in words if rng.random() < 0.2}  # without it, the program has mistakes
    fault_rate = {"": rng.choice((0, 0, 0, 0.2)), **dict.fromkeys(words, 0.4)}
    failing = {
        (word, world) for word in fault_rate for world in worlds if rng.random() < fault_rate[word]
    }
    lesson = LESSON._replace(criteria=(Criterion("needs", {}, tuple(words), (), {}),))
    fault = Finding("", "still")
    monkeypatch.setattr(marking, "Trial", FakeTrial)
    monkeypatch.setattr(marking, "replace_word", lambda word, _: word)
    monkeypatch.setattr(marking, "judge_text", lambda *_: [])
    monkeypatch.setattr(marking, "explain", lambda findings, *_: findings)
    monkeypatch.setattr(
        marking, "judge_run", lambda run, _: [fault] if (run[0], run[1]) in failing else []
    )

    def compile_image(text: str) -> str | None:
        return None if text in wrong else text

    outcome = Marking("", compile_image, ROBOT, lesson, worlds).run_to_end()  # type: ignore[arg-type]
    keys = [finding.key for finding in outcome.findings if finding is not fault]
    verdict, world, word = expected_mark(words, worlds, wrong, failing)
    assert (outcome.verdict, outcome.seed) == (verdict, world)
    assert keys == ([f"needs/{word}"] if word else [])
