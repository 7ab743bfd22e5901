"""Compares the text of a program with the criteria of a lesson: which words it has.

Knows tokens: a word in a comment does not count. Does not know what the program does.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from tiniscript import robots
from tiniscript.lessons.judging import Finding
from tiniscript.lessons.lesson import Criterion, Lesson
from tiniscript.syntax.lexer import WORD, scan

MOVES = frozenset("FBLRM")


def judged_text(text: str, lesson: Lesson) -> list[Finding]:
    """Return what is missing in a program's text, whatever it does."""
    words = [token.text for token in scan(text).tokens if token.kind == WORD]
    question = {"question": _question(lesson.robot)}
    found = (JUDGES[each.kind](each, words) for each in lesson.criteria if each.kind in JUDGES)
    return [each._replace(values={**each.values, **question}) for each in found if each]


def _question(robot: str) -> str:
    """Return a question that a robot can answer, for examples: a yes/no sensor, or a distance."""
    sensors = robots.load(robot).kit.sensors
    yes_no = [device.name for device in sensors if device.is_yes_no]
    return yes_no[0] if yes_no else "DISTANCE < 15"


def _uses(criterion: Criterion, words: list[str]) -> Finding | None:
    times, counted = int(criterion.numbers["times"]), Counter(words)
    for word in criterion.words:
        if counted[word] < times:
            key = "uses/none" if not counted[word] else "uses/few"
            values = {"word": word, "times": str(times), "found": str(counted[word])}
            return Finding("uses", key, values)
    return None


def _moves(criterion: Criterion, words: list[str]) -> Finding | None:
    most, found = int(criterion.numbers["at_most"]), sum(word in MOVES for word in words)
    values = {"found": str(found), "most": str(most)}
    return Finding("moves", "moves", values) if found > most else None


JUDGES: dict[str, Callable[[Criterion, list[str]], Finding | None]] = {
    "uses": _uses,
    "moves": _moves,
}
