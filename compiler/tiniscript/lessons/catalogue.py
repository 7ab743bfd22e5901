"""Finds lessons: the shipped ones by their numbers, others by their folders; their files, and the
numbers that their pages name: `{seconds}`, `{reaches.within_cm}`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from pathlib import Path

from tiniscript import robots
from tiniscript.base.languages import SOURCE_LANGUAGE
from tiniscript.lessons.forms import TEXT, sentences_in_form
from tiniscript.lessons.lesson import Answer, Criterion, Lesson, LessonRefused
from tiniscript.lessons.markdown import printed_part
from tiniscript.lessons.reader import read, read_answers
from tiniscript.lessons.variation import point_of
from tiniscript.robots.refusals import printable_value
from tiniscript.virtual import worlds

NUMBER_GAP = re.compile(r"\{([a-z_]+(?:\.[a-z_]+)?)\}")


def fill_numbers(page: str, file: str, lesson: Lesson) -> str:
    """Return a page with its numbers. Raises LessonRefused if the lesson has none of a name."""
    number_of_name = dict(
        reversed([*_numbers(lesson)])
    )  # the first of two criteria of a kind counts

    def number(match: re.Match[str]) -> str:
        if match[1] not in number_of_name:
            reason = {"file": file, "found": match[0], "known": ", ".join(sorted(number_of_name))}
            raise LessonRefused(("no_such_number", reason))
        return f"{number_of_name[match[1]]:.10g}"

    return NUMBER_GAP.sub(number, page)


def _numbers(lesson: Lesson) -> Iterator[tuple[str, float]]:
    yield "seconds", lesson.seconds
    yield "worlds", lesson.world_count
    yield "noise_percent", round(lesson.noise * 100, 3)
    for criterion in lesson.criteria:
        for key, value in _numbers_of(criterion, lesson):
            yield f"{criterion.kind}.{key}", value


def _numbers_of(criterion: Criterion, lesson: Lesson) -> Iterator[tuple[str, float]]:
    yield from criterion.number_by_key.items()
    if criterion.kind == "order":
        yield "times", criterion.words.count(criterion.words[0])
    if criterion.area:
        for key, (low, high) in zip(("x_cm", "y_cm"), criterion.area, strict=True):
            yield key, high - low
    if criterion.places:  # the distance to the first place, from the start
        start = lesson.world.start
        x, y = point_of(criterion.places[0], lesson.world, False)
        along = math.radians(start.heading)
        dx, dy = x - start.x_cm, y - start.y_cm
        yield "way_cm", round(math.hypot(dx, dy))
        yield "ahead_cm", round(dx * math.cos(along) + dy * math.sin(along))
        yield "beside_cm", abs(round(dy * math.cos(along) - dx * math.sin(along)))


FOLDER = Path(__file__).parent
PUPIL, TEACHER = "pupil", "teacher"  # readers of a page


def folders() -> list[Path]:
    """Return the folders of the shipped lessons, in their order: the first one is lesson 1."""
    return sorted(path.parent for path in FOLDER.glob("[0-9][0-9]_*/lesson.toml"))


def folder_of(name: str) -> Path:
    """Return the folder of a lesson: a number, or the path of a folder. Raises LessonRefused."""
    shipped_paths = folders()
    if name.isascii() and name.isdigit() and 1 <= int(name[:9]) <= len(shipped_paths):
        return shipped_paths[int(name[:9]) - 1]
    path = Path(name)
    try:
        if (path / "lesson.toml").is_file():
            return path
    except (OSError, ValueError):  # a name that no folder can have
        pass
    raise LessonRefused(
        ("no_such_lesson", {"name": printable_value(name), "most": str(len(shipped_paths))})
    )


def load(folder: Path) -> Lesson:
    """Return the lesson in a folder. Raises LessonRefused."""
    name = folder.resolve().name
    text, world = _text(folder / "lesson.toml"), _text(folder / "world.toml")
    return read(text, worlds.read(world, name, LessonRefused), name)


def page(folder: Path, audience: str, language: str) -> str:
    """Return a page of a lesson as it is printed, as Markdown. Raises LessonRefused."""
    return printed_part(whole_page(folder, audience, language))


def whole_page(folder: Path, audience: str, language: str, form: str = TEXT) -> str:
    """Return a page of a lesson with its numbers and its marks, for readers of one form of
    programs. Raises LessonRefused.
    """
    paths = [folder / f"{audience}.{item}.md" for item in (language, SOURCE_LANGUAGE)]
    path = next((path for path in paths if path.is_file()), None)
    if path is None:
        raise LessonRefused(("no_page", {"file": printable_value(paths[0].name)}))
    text = sentences_in_form(_text(path), form)
    return fill_numbers(text, printable_value(path.name), load(folder))


def answers(folder: Path) -> tuple[list[Answer], list[Answer]]:
    """Return the right answers of a lesson and the typical wrong ones. Raises LessonRefused."""
    return read_answers(_text(folder / "answers.toml"))


def _text(path: Path) -> str:
    return robots.text_of(str(path), LessonRefused)
