"""Findings of a lesson's check."""

from __future__ import annotations

from collections.abc import Sequence

from tiniscript import robots
from tiniscript.lessons.findings import Finding
from tiniscript.lessons.lesson import Lesson
from tiniscript.library.compiling import image_maker


def findings_of(text: str, lesson: Lesson, seeds: Sequence[int]) -> list[Finding]:
    """Return the findings in the first world that has some, or in the text."""
    from tiniscript.lessons.marking import Marking

    robot = robots.load(lesson.robot)
    return list(Marking(text, image_maker(robot), robot, lesson, seeds).run_to_end().findings)
