"""Words of a program that its robot's kit lacks, but those of other known robots have."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from tiniscript import robots
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Span
from tiniscript.base.words import lexicon_meaning
from tiniscript.diagnostics.codes import (
    NO_BUTTON,
    OTHER_ROBOT,
    UNKNOWN_NAME,
    UNKNOWN_WORD,
    Diagnostic,
    Repair,
)
from tiniscript.library.named_robot import named_robot
from tiniscript.recovery.meanings import lexicon_concept
from tiniscript.robots import given
from tiniscript.robots.profile import Robot
from tiniscript.syntax.lexer import WORD, scan

SHOWN_CHARACTERS = 60  # most characters of a path in a message; a longer one could not be copied
_UNKNOWN_CODES = (UNKNOWN_NAME, UNKNOWN_WORD)
BUTTON = "BUTTON"  # a sensor of some kits; every robot has a button that starts it
LESSON_ROBOTS = ("grabber", "liner", "tinibot")
_ORDINALS = ("first", "second", "third")


def with_robot_hints(
    diagnostics: list[Diagnostic], text: str, robot: Robot, is_chosen: bool
) -> list[Diagnostic]:
    """Return diagnostics with hints to the robots that have a word that `robot` lacks.

    `is_chosen`: the user chose it, and the robot that the program names is ignored.
    """
    if not any(diagnostic.code in (*_UNKNOWN_CODES, OTHER_ROBOT) for diagnostic in diagnostics):
        return diagnostics
    hinted_diagnostics = hints_among(_other_kits(), diagnostics, text, robot.name, robot.kit)
    return (
        hinted_diagnostics
        if is_chosen
        else [_add_robot_name(diagnostic, text) for diagnostic in hinted_diagnostics]
    )


def _add_robot_name(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Return a hint about a shipped robot, with the line that names it in a program."""
    first_robot = diagnostic.values.get("first")
    if diagnostic.code is not OTHER_ROBOT or first_robot not in robots.names():
        return diagnostic
    robot_in_text = named_robot(text)
    edit = (
        Edit(robot_in_text.span, first_robot)
        if robot_in_text
        else Edit(Span(0, 0), f"// robot: {first_robot}\n")
    )
    values = {**diagnostic.values, "named": first_robot}
    return diagnostic._replace(values=values, repair=Repair((edit,), False))


def hints_among(
    other_kits: Mapping[str, Kit], diagnostics: Sequence[Diagnostic], text: str, name: str, kit: Kit
) -> list[Diagnostic]:
    """Return diagnostics that name the robots that have an unknown word; at most three of them.

    If a robot has all kit words of the program, robots that lack one are not named. Words that lead
    to the same robots are one mistake, of the first of them.
    """
    own_words = set(kit.names)
    words_by_robot = {
        robot: set(other_kit.names) for robot, other_kit in other_kits.items() if robot != name
    }
    kit_names = own_words.union(*words_by_robot.values())
    words_in_text = {token.text for token in scan(text).tokens if token.kind is WORD}
    used_words = {
        word if word in kit_names else lexicon_concept(word) for word in words_in_text
    } & kit_names
    robot_in_text = named_robot(text)
    named_robot_name = robot_in_text.name.lower() if robot_in_text else ""
    complete_robots = [
        robot for robot, kit_words in words_by_robot.items() if used_words <= kit_words
    ]
    hinted_diagnostics: list[Diagnostic] = []
    hinted_robot_sets: list[set[str]] = []  # robots that words have led to
    hinted_codes = (
        {*_UNKNOWN_CODES, NO_BUTTON} if used_words - own_words - {BUTTON} else {*_UNKNOWN_CODES}
    )
    for diagnostic in diagnostics:
        word = diagnostic.values.get("found", "").upper()
        word = BUTTON if diagnostic.code is NO_BUTTON else word
        word = word if word in kit_names else lexicon_concept(word) or word
        stem = "".join(lexicon_meaning(word, "stem"))
        left_word = f"{stem or word}_L"  # `LINEA`, where others have LINE_L
        word = left_word if left_word in kit_names - own_words else word
        robots_with_word = [
            robot for robot, kit_words in words_by_robot.items() if word in kit_words - own_words
        ]
        if diagnostic.code in hinted_codes and robots_with_word:
            robots_with_word = [
                robot for robot in robots_with_word if robot in complete_robots
            ] or robots_with_word
            # The robot that the program names comes first, then one with more of its words or of a
            # lesson.
            robots_with_word.sort(
                key=lambda robot: (
                    robot != named_robot_name,
                    -len(used_words & words_by_robot[robot]),
                    robot not in LESSON_ROBOTS,
                )
            )
            if any(hinted_robots <= {*robots_with_word} for hinted_robots in hinted_robot_sets):
                continue
            hinted_robot_sets.append({*robots_with_word})
            values = {
                "found": word,
                "own": name,
                **dict(zip(_ORDINALS, robots_with_word, strict=False)),
            }
            diagnostic = Diagnostic(OTHER_ROBOT, diagnostic.span, values)
        hinted_diagnostics.append(diagnostic)
    return hinted_diagnostics


def has_words_of_other_robots(diagnostics: list[Diagnostic]) -> bool:
    """Return whether a program uses another robot's words: its diagnostics went through
    `with_robot_hints`.
    """
    if any(diagnostic.code is OTHER_ROBOT for diagnostic in diagnostics):
        return True
    words = {
        diagnostic.values.get("found")
        for diagnostic in diagnostics
        if diagnostic.code in _UNKNOWN_CODES
    }
    # Profiles whose paths are too long for a message are left out.
    return bool(words) and any(words & set(robot.kit.names) for _, robot in given.profiles())


def _other_kits() -> dict[str, Kit]:
    """Return the known kits, by the name or the path of their robots."""
    kit_by_robot: dict[str, Kit] = {}
    for name in robots.names():
        kit = robots.load(name).kit
        if kit not in kit_by_robot.values():  # robots on other boards may have the kit of one
            kit_by_robot[name] = kit
    for path, robot in given.profiles():
        try:
            shorter_path = min(path, os.path.relpath(path), key=len)
        except ValueError:  # Windows: the path is on another drive
            shorter_path = path
        if len(shorter_path) <= SHOWN_CHARACTERS and " " not in shorter_path:
            kit_by_robot[shorter_path] = robot.kit
    return kit_by_robot
