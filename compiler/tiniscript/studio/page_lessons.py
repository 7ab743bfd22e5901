"""The lessons in the page: their pages, their worlds, and what comes of a program.

Pupils see there what `tsc lesson show` shows, and hear what `tsc lesson check` says. The page
fetches this when lessons are first looked at.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

from tiniscript.lessons import catalogue
from tiniscript.lessons.lesson import Lesson
from tiniscript.lessons.markdown import Block, blocks
from tiniscript.lessons.marking import Marking, Outcome
from tiniscript.lessons.sentences import sentence
from tiniscript.lessons.variation import varied
from tiniscript.library.compiling import compiled, for_robot, maker
from tiniscript.studio.checking import profile_of
from tiniscript.studio.world_form import Form, form_of
from tiniscript.virtual.world import World

MISTAKES = "mistakes"
COMMAND = "`tsc lesson check "  # a paragraph for those who have a terminal


def titles(language: str) -> list[dict[str, Any]]:
    """Return what each lesson is called, and for which robot it is; the first one is lesson 1."""
    return [
        {"name": lesson.name, "title": lesson.titles[language], "robot": lesson.robot,
         "worlds": lesson.worlds}
        for lesson in map(_lesson, range(1, len(catalogue.folders()) + 1))
    ]  # fmt: skip


def page(number: int, language: str) -> list[dict[str, Any]]:
    """Return the blocks of a pupil's page, without its title."""
    found = blocks(catalogue.page(_folder(number), catalogue.PUPIL, language))
    return [each._asdict() for each in found if not _is_left_out(each)]


def world(number: int, seed: int) -> World:
    """Return the world of a lesson where a program is tried."""
    return varied(_lesson(number), seed)


def world_form(number: int, seed: int) -> Form:
    return form_of(world(number, seed))


class Check:
    """A program's text on its way through the worlds of a lesson."""

    def __init__(self, number: int, data: bytes, language: str) -> None:
        lesson = _lesson(number)
        self._language = language
        self._worlds = lesson.worlds
        self._marking: Marking | None = None
        profile = profile_of(lesson.robot)
        found = for_robot(compiled(data, profile, "", is_strict=True), profile)
        if found.is_right:
            seeds = range(1, lesson.worlds + 1)
            text = found.source.text
            self._marking = Marking(text, maker(profile), profile, lesson, seeds)

    def go(self, most_ms: int) -> dict[str, Any]:
        """Let the robot's time go on, at most by `most_ms`.

        `verdict` is empty while it goes on. `seed` is that of the world where it is, or where the
        program failed: 0 for none.
        """
        if self._marking is None:
            return self._said(MISTAKES, 0)
        outcome = self._marking.go(most_ms)
        if outcome is None:
            return self._said("", self._marking.seed)
        return self._said(outcome.verdict, outcome.seed, outcome)

    def _said(self, verdict: str, seed: int, outcome: Outcome | None = None) -> dict[str, Any]:
        findings = outcome.findings if outcome is not None else ()
        said = [sentence(each, self._language) for each in findings]
        return {"verdict": verdict, "seed": seed, "worlds": self._worlds, "said": said}


def _is_left_out(block: Block) -> bool:
    first = block.rows[0][0] if block.rows else ""
    return block.kind == "title" or (block.kind == "paragraph" and first.startswith(COMMAND))


def _folder(number: int) -> Path:
    return catalogue.folder_of(str(number))


@cache
def _lesson(number: int) -> Lesson:
    return catalogue.load(_folder(number))
