"""The numbers of a lesson that its pages name: `{seconds}`, `{reaches.within_cm}`.

What a page says is what is measured: the numbers come from the criteria and the world. Knows no
files and no sentences.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from tiniscript.lessons.lesson import Criterion, Lesson, LessonRefused
from tiniscript.lessons.variation import point_of

NAMED = re.compile(r"\{([a-z_]+(?:\.[a-z_]+)?)\}")


def filled(page: str, file: str, lesson: Lesson) -> str:
    """Return a page with its numbers. Raises LessonRefused where the lesson has none of a name."""
    known = dict(reversed([*_numbers(lesson)]))  # of two criteria of a kind the first one counts

    def number(match: re.Match[str]) -> str:
        if match[1] not in known:
            reason = {"file": file, "found": match[0], "known": ", ".join(sorted(known))}
            raise LessonRefused(("no_such_number", reason))
        return f"{known[match[1]]:.10g}"

    return NAMED.sub(number, page)


def _numbers(lesson: Lesson) -> Iterator[tuple[str, float]]:
    yield "seconds", lesson.seconds
    yield "worlds", lesson.worlds
    yield "noise_percent", round(lesson.noise * 100, 3)
    for criterion in lesson.criteria:
        for key, value in _numbers_of(criterion, lesson):
            yield f"{criterion.kind}.{key}", value


def _numbers_of(criterion: Criterion, lesson: Lesson) -> Iterator[tuple[str, float]]:
    yield from criterion.numbers.items()
    if criterion.kind == "order":
        yield "times", criterion.words.count(criterion.words[0])
    if criterion.area:
        for key, (low, high) in zip(("x_cm", "y_cm"), criterion.area, strict=True):
            yield key, high - low
    if criterion.places:  # where the first of them is, from the start
        start = lesson.world.start
        x, y = point_of(criterion.places[0], lesson.world, False)
        along = math.radians(start.heading)
        dx, dy = x - start.x_cm, y - start.y_cm
        yield "way_cm", round(math.hypot(dx, dy))
        yield "ahead_cm", round(dx * math.cos(along) + dy * math.sin(along))
        yield "beside_cm", abs(round(dy * math.cos(along) - dx * math.sin(along)))
