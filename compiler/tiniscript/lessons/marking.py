"""Marks a program by a lesson: lets it drive in one world after the other, until one says no.

Knows no files and no languages: `sentences` has the words for findings.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.bytecode.image import Image
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.judging import judged
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.running import Run, Trial
from tiniscript.lessons.text_judging import explained, judged_text
from tiniscript.robots.profile import Robot

PASSED, FAILED = "passed", "failed"


class Outcome(NamedTuple):
    """What came of a program. `seed` is that of the world where it failed, 0 for none.

    `findings` say what is missing; `run` is the last run.
    """

    verdict: str
    seed: int
    findings: tuple[Finding, ...]
    run: Run


class Marking:
    """A program on its way through the worlds of `seeds`, at least one."""

    def __init__(
        self, text: str, image: Image, robot: Robot, lesson: Lesson, seeds: Sequence[int]
    ) -> None:
        self._image = image
        self._robot = robot
        self._lesson = lesson
        self._seeds = list(seeds)
        self._text = text
        self._of_text = judged_text(text, lesson)
        self._trial: Trial | None = None  # none before a world

    @property
    def seed(self) -> int:
        """The seed of the world where it is now."""
        return self._seeds[0]

    def whole(self) -> Outcome:
        """Return what came of it in the end. Raises WorldRefused, as `go`."""
        while True:
            outcome = self.go()
            if outcome is not None:
                return outcome

    def go(self, most_ms: int | None = None) -> Outcome | None:
        """Let the robot's time go on, at most by `most_ms`; return what came of it, once it has.

        Raises WorldRefused where the robot does not fit into the world of `seed`.
        """
        if self._trial is None:
            self._trial = Trial(self._image, self._robot, self._lesson, self.seed)
        run = self._trial.go(most_ms)
        if run is None:
            return None
        findings = explained(judged(run, self._lesson), self._text, self._lesson, run.ending)
        if findings:
            said = {each.key for each in findings}
            of_text = [each for each in self._of_text if each.key not in said]
            return Outcome(FAILED, self.seed, (*findings, *of_text), run)
        if len(self._seeds) > 1:
            del self._seeds[0]
            self._trial = None
            return None
        verdict = FAILED if self._of_text else PASSED
        return Outcome(verdict, 0, tuple(self._of_text), run)
