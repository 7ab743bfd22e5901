"""Terminals in documents show the answers of a robot to the same lines.

A fence `terminal` is a conversation: lines that a person types, and the answers, which begin with
`//`. Here a virtual robot in the document's language answers them.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.support.casefile import ROOT
from tools.site.documents import language_of

PAGES = sorted([*ROOT.glob("README*.md"), *(ROOT / "docs").glob("*/*.md")])
ANSWER_PREFIX = "// "
LONGEST_MS = 5000  # timeout of an answer
SILENCE_MS = 1500  # pause between the answers and the next line: over a second


def conversations(page: Path) -> Iterator[list[str]]:
    """Yield the lines of each fence `terminal`."""
    fence, lines = "", list[str]()
    for row in page.read_text(encoding="utf-8").splitlines():
        if row.startswith("```"):
            if fence == "terminal":
                yield lines
            fence, lines = ("" if fence else row[3:].strip() or "text"), []
        else:
            lines.append(row)


PAGE_BLOCKS = [
    pytest.param(language_of(page.relative_to(ROOT).as_posix()), lines, id=f"{page.name}-{k}")
    for page in PAGES
    for k, lines in enumerate(conversations(page))
]


def play_conversation(lines: list[str], language: str) -> list[str]:
    """Return the conversation: each line, and the answers before the next one."""
    from tests.support.virtual_robot import floor
    from tiniscript import robots
    from tiniscript.virtual.robot import VirtualRobot

    robot = VirtualRobot(robots.load("tinibot").with_language(language), floor())
    transcript = []
    for k, line in enumerate(lines):
        if line.startswith(ANSWER_PREFIX):
            continue
        expected_count = next(
            (n for n, line in enumerate(lines[k + 1 :]) if not line.startswith(ANSWER_PREFIX)),
            len(lines) - k - 1,
        )
        data = robot.step(robot.now_ms + 1, line.encode() + b"\r\n")
        end_ms = robot.now_ms + LONGEST_MS
        while data.count(b"\n") < expected_count and robot.now_ms < end_ms:
            data += robot.step(robot.now_ms + 1)
        data += robot.step(robot.now_ms + SILENCE_MS)
        transcript += [line, *data.decode().splitlines()]
    return transcript


@pytest.mark.parametrize(("language", "lines"), PAGE_BLOCKS)
def test_a_robot_answers_as_the_document_shows(language: str, lines: list[str]) -> None:
    assert len(lines) >= 2
    assert play_conversation(lines, language) == lines


def test_the_front_door_and_both_guides_show_a_terminal() -> None:
    shown_texts = {page.relative_to(ROOT).as_posix() for page in PAGES if list(conversations(page))}
    guides = {"docs/en/monday.md", "docs/es/monday.md"}
    assert {"README.md", "README.es.md", *guides} <= shown_texts
