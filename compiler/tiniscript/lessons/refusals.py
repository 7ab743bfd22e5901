"""The sentences about a refused lesson: a cause and a remedy. Does not know when a code applies."""

from __future__ import annotations

from tiniscript.lessons.lesson import LessonRefused
from tiniscript.robots import refusals


def describe(refused: LessonRefused, language: str) -> list[str]:
    """Return a sentence for each reason."""
    return refusals.describe(refused, language, "lesson", "world")
