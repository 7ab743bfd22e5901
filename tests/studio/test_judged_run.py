"""The page of a lesson without a browser: its steps, and the judged run."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tests.support.texts import LANGUAGES
from tiniscript.lessons import catalogue
from tiniscript.studio import page_lessons
from tiniscript.studio.checking import check
from tiniscript.studio.simulation import Marks
from tools.studio.pack import text_on_page

NUMBERS = range(1, len(catalogue.folders()) + 1)
TERMINAL_WORDS = re.compile(r"\btsc\b|\w\.ts\b|____|--virtual|Ctrl|\[(print|page|hint)\]")


def judge(number: int, program: str) -> tuple[dict[str, object], page_lessons.JudgedRun]:
    """Return the result of a check, and its run again, as the page plays it."""
    marking = page_lessons.LessonCheck(number, program.encode(), "en")
    while not (answer := marking.advance(700))["verdict"]:
        pass
    robot = catalogue.load(catalogue.folder_of(str(number))).robot
    image = check(program.encode(), robot, "en").image
    run = answer["run"]
    judged_run = page_lessons.JudgedRun(
        "tinibot", number, run["seed"], run["until_ms"], image, Marks(())
    )
    for _ in range(10_000):
        if not judged_run.robot.is_running:
            break
        judged_run.advance(33)
    return answer, judged_run


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", NUMBERS)
def test_the_steps_of_a_lesson_are_written_for_the_page(number: int, language: str) -> None:
    steps = page_lessons.steps(number, language)
    assert len(steps) >= 4 and all(step["blocks"] for step in steps)
    assert steps[-1]["hint"]
    assert not TERMINAL_WORDS.search(json.dumps(steps, ensure_ascii=False))
    printed_text = catalogue.page(catalogue.folder_of(str(number)), catalogue.PUPIL, language)
    assert steps[-1]["hint"] not in printed_text
    assert re.search(r"`tsc lesson check \d+ \w+\.ts`", printed_text)
    assert not re.search(r"\[(print|page|hint)\]", printed_text)


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", NUMBERS)
def test_packed_lesson_pages_have_the_same_steps(
    number: int, language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole_steps = page_lessons.steps(number, language)
    pages: list[tuple[str, str]] = []

    def pack_page(path: Path) -> str:
        text = path.read_text(encoding="utf-8")
        if path.suffix != ".md":
            return text
        pages.append((text, text_on_page(text)))
        return pages[-1][1]

    monkeypatch.setattr(catalogue, "_text", pack_page)
    assert page_lessons.steps(number, language) == whole_steps
    assert all("[print]" in text and "[print]" not in less for text, less in pages) and pages


@pytest.mark.parametrize(
    "number, program, seconds, touches",
    [(1, "SI|F(5, 80)", 3.0, True), (1, "SI|F(2.5, 80)", 2.5, False),
     (7, "SB|F(4, 80)", None, True), (10, "M(40, 40); W(20)", 11.5, True)],
)  # fmt: skip
def test_the_judged_run_is_the_shown_one(
    number: int, program: str, seconds: float | None, touches: bool
) -> None:
    """Also where chance moves sensors, motors and walls: it ends where the judge saw it."""
    answer, judged_run = judge(number, program)
    state = judged_run.state()
    assert (state["touches"] is not None) is touches
    assert not state["is_running"]
    run_s = (state["now_ms"] - state["began_ms"]) / 1000
    if touches:
        match = re.search(r"after (\d+\.\d) s", " ".join(answer["said"]))  # type: ignore[arg-type]
        assert match and abs(run_s - float(match[1])) < 0.1
    if seconds is not None:
        assert round(run_s, 1) == seconds


def test_a_run_with_the_judges_keys_is_shown_with_them() -> None:
    """No one else presses keys."""
    drive_program = "LOOP(FOREVER); IF(KEY_UP); M(60, 60); ELSE; M(0, 0); END_IF; W(0.02); END_LOOP"
    answer, judged_run = judge(18, drive_program)
    assert "KEY_RIGHT was held" in answer["said"][0]  # type: ignore[index]
    state = judged_run.state()
    assert state["pose"][0] > 170, "it went forward"
    assert (state["now_ms"] - state["began_ms"]) == 5100
    image = check(drive_program.encode(), "tinibot", "en").image
    judged_run = page_lessons.JudgedRun("tinibot", 18, 1, 900, image, Marks(()))
    for _ in range(9):
        judged_run.press(1, 0, 100)
        judged_run.advance(100)
    assert judged_run.state()["pose"][:2] == [160, 160]


def test_the_shown_goals_match_the_judges() -> None:
    (garage,) = page_lessons.goal_shapes(1, 1)
    assert garage["is_flag"] and garage["around"] == [[95, 25], [150, 25], [150, 75], [95, 75]]
    shop, home = page_lessons.goal_shapes(2, 1)
    assert (shop["x_cm"], shop["y_cm"], shop["radius_cm"], shop["is_flag"]) == (130, 50, 10, True)
    assert not home["is_flag"]
    (exit_at,), (mirrored,) = page_lessons.goal_shapes(8, 1), page_lessons.goal_shapes(8, 2)
    height_cm = page_lessons.varied_world(8, 1).height_cm
    assert exit_at["y_cm"] == height_cm - mirrored["y_cm"]
    lamps = [page_lessons.goal_shapes(10, seed)[0]["x_cm"] for seed in (1, 2)]
    assert lamps[0] != lamps[1]
    for seed in (1, 2):  # a wall is drawn already
        (wall,) = page_lessons.goal_shapes(7, seed)
        assert wall.keys() == {"x_cm", "y_cm", "is_flag"} and not wall["is_flag"]
        assert wall["x_cm"] == page_lessons.varied_world(7, seed).walls[0][0].x
    assert page_lessons.goal_shapes(13, 1) == []


def test_a_judged_run_can_be_stopped_before_its_end() -> None:
    image = check(b"SI|F(2.5, 80)", "tinibot", "en").image
    judged_run = page_lessons.JudgedRun("tinibot", 1, 1, 2500, image, Marks(()))
    judged_run.advance(1000)
    judged_run.stop()
    state_before = judged_run.state()["pose"]
    judged_run.advance(1000)
    assert judged_run.state()["pose"] == state_before and not judged_run.state()["is_running"]
