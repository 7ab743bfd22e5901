"""Marks a program by a lesson: lets it drive in one world after the other, until one says no.

Knows no files and no languages: `sentences` has the words for findings.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.bytecode.image import Image
from tiniscript.lessons.findings import STILL_CM, Finding
from tiniscript.lessons.judging import judge_run
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.running import Run, Trial
from tiniscript.lessons.text_judging import (
    explain,
    idle_finding,
    judge_text,
    replace_word,
    without_times,
)
from tiniscript.robots.profile import Robot

PASSED, FAILED = "passed", "failed"


class Outcome(NamedTuple):
    """The result of a program. `seed` is the world in which it failed, or 0.

    `findings` list what is missing; `run` is the last run.
    """

    verdict: str
    seed: int
    findings: tuple[Finding, ...]
    run: Run


class Marking:
    """A program on its way through the worlds of `seeds`, at least one.

    If a lesson requires a LOOP, a DEF, a WHEN or a TASK, a program that has passed runs the worlds
    again without it, until it fails. A program that has failed runs its world again without the
    times of its UNTILs, to find out whether they have ended a move too early.
    """

    def __init__(
        self,
        text: str,
        compile_image: Callable[[str], Image | None],
        robot: Robot,
        lesson: Lesson,
        seeds: Sequence[int],
    ) -> None:
        """`compile_image` returns the image of a text, or None if that has mistakes."""
        image = compile_image(text)
        assert image is not None, "a program with mistakes"
        self._image = image
        self._compile_image = compile_image
        self._robot = robot
        self._lesson = lesson
        self._all_seeds = list(seeds)
        self._seeds = list(seeds)
        self._text = text
        self._text_findings = judge_text(text, lesson)
        self._trial: Trial | None = None  # none before the first world
        self._words_to_try = [
            (word, lesson._replace(criteria=lesson.criteria[:k]))
            for k, criterion in enumerate(lesson.criteria)
            if criterion.kind == "needs"
            for word in criterion.words
        ]
        self._passed_run: Run | None = None  # the last run of the task, once it is done
        self._word_left_out = ""  # the word that the program is tried without now
        self._failed_run: Run | None = None  # the run that is compared with one without times

    @property
    def seed(self) -> int:
        """The seed of the world where it is now."""
        return self._seeds[0]

    def run_to_end(self) -> Outcome:
        """Return the final result. Raises WorldRefused, like `go`."""
        while True:
            outcome = self.advance()
            if outcome is not None:
                return outcome

    def advance(self, most_ms: int | None = None) -> Outcome | None:
        """Advance the robot's time by at most `most_ms`; return the result once it is known.

        Raises WorldRefused if the robot does not fit into the world of `seed`.
        """
        if self._trial is None:
            self._trial = Trial(self._image, self._robot, self._lesson, self.seed)
        run = self._trial.advance(most_ms)
        if run is None:
            return None
        run_findings = judge_run(run, self._lesson)
        if run_findings and self._word_left_out:
            return self._try_next_word(run)
        if self._failed_run is not None:
            run, timeless_run, timeless_findings = self._failed_run, run, run_findings
            run_findings = judge_run(run, self._lesson)
            is_better = {finding.key for finding in timeless_findings} <= {
                finding.key for finding in run_findings
            }
            if is_better and timeless_run.driven_cm > run.driven_cm + STILL_CM:
                run_findings = [Finding("", "timed")]
        elif run_findings and self._try_without_times():
            self._failed_run = run
            return None
        findings = explain(run_findings, self._text, self._lesson, run.ending)
        if findings:
            keys = {finding.key for finding in findings}
            text_findings = [finding for finding in self._text_findings if finding.key not in keys]
            return Outcome(FAILED, self.seed, (*findings, *text_findings), run)
        if len(self._seeds) > 1:
            del self._seeds[0]
            self._trial = None
            return None
        if self._word_left_out:
            assert self._passed_run is not None
            return Outcome(
                FAILED, 0, (idle_finding(self._word_left_out, self._text),), self._passed_run
            )
        self._passed_run = run
        if self._text_findings:
            return Outcome(FAILED, 0, tuple(self._text_findings), run)
        return self._try_next_word(run)

    def _try_without_times(self) -> bool:
        """Begin the world again without the times of UNTILs; return whether there are some."""
        text = without_times(self._text)
        image = self._compile_image(text) if text != self._text else None
        if image is not None:
            self._trial = Trial(image, self._robot, self._lesson, self.seed)
        return image is not None

    def _try_next_word(self, run: Run) -> Outcome | None:
        """Try the program without the next word that the lesson needs; it passes without more."""
        while self._words_to_try:
            self._word_left_out, self._lesson = self._words_to_try.pop(0)
            image = self._compile_image(replace_word(self._word_left_out, self._text))
            if image is not None:
                self._image, self._seeds, self._trial = image, list(self._all_seeds), None
                return None
        return Outcome(PASSED, 0, (), self._passed_run or run)
