"""Finds lessons: the shipped ones by their numbers, others by their folders; and their files."""

from __future__ import annotations

from pathlib import Path

from tiniscript import robots
from tiniscript.lessons.lesson import Answer, Lesson, LessonRefused
from tiniscript.lessons.numbers import filled
from tiniscript.lessons.reader import read, read_answers
from tiniscript.robots.profile import ProfileRefused
from tiniscript.robots.refusals import shown
from tiniscript.virtual import world_reader

FOLDER = Path(__file__).parent
PUPIL, TEACHER = "pupil", "teacher"  # who a page is for


def folders() -> list[Path]:
    """Return the folders of the shipped lessons, in their order: the first one is lesson 1."""
    return sorted(path.parent for path in FOLDER.glob("[0-9][0-9]_*/lesson.toml"))


def folder_of(name: str) -> Path:
    """Return the folder of a lesson: a number, or the path of a folder. Raises LessonRefused."""
    shipped = folders()
    if name.isascii() and name.isdigit() and 1 <= int(name[:9]) <= len(shipped):
        return shipped[int(name[:9]) - 1]
    path = Path(name)
    try:
        if (path / "lesson.toml").is_file():
            return path
    except (OSError, ValueError):  # a name that no folder can have
        pass
    raise LessonRefused(("no_such_lesson", {"name": shown(name), "most": str(len(shipped))}))


def load(folder: Path) -> Lesson:
    """Return the lesson in a folder. Raises LessonRefused."""
    name = folder.resolve().name
    try:
        text, world_text = (
            robots.text_of(str(folder / each)) for each in ("lesson.toml", "world.toml")
        )
        world = world_reader.read(world_text, name)
    except ProfileRefused as refused:
        raise LessonRefused(*refused.reasons) from None
    return read(text, world, name)


def page(folder: Path, who: str, language: str) -> str:
    """Return a page of a lesson with its numbers, as Markdown. Raises LessonRefused."""
    path = folder / f"{who}.{language}.md"
    if not path.is_file():
        raise LessonRefused(("no_page", {"file": shown(path.name)}))
    return filled(_text(path), shown(path.name), load(folder))


def answers(folder: Path) -> tuple[list[Answer], list[Answer]]:
    """Return the right answers of a lesson and the typical wrong ones. Raises LessonRefused."""
    return read_answers(_text(folder / "answers.toml"))


def _text(path: Path) -> str:
    try:
        return robots.text_of(str(path))
    except ProfileRefused as refused:
        raise LessonRefused(*refused.reasons) from None
