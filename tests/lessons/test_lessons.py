"""Every shipped lesson: right answers pass, wrong ones fail, and its pages are complete."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import pytest

from tests.support.lesson_findings import findings_of
from tests.support.texts import LANGUAGES
from tiniscript import robots
from tiniscript.base.languages import languages, text
from tiniscript.lessons import catalogue, text_judging
from tiniscript.lessons.judging import JUDGES
from tiniscript.lessons.lesson import Answer
from tiniscript.lessons.markdown import blocks
from tiniscript.lessons.marking import Marking
from tiniscript.lessons.sentences import sentence
from tiniscript.lessons.sheet import sheet
from tiniscript.library.compiling import compile_source, image_maker
from tiniscript.studio import page_lessons
from tools.builds.page_texts import page_texts

FOLDERS = catalogue.folders()
MINUTES = "45"
OTHER_SEEDS = range(101, 103)  # worlds that the command itself does not try
BY_HEART_LABEL = "by heart"  # part of a wrong answer's label
HEADINGS = 5  # headings of a pupil's page: title, materials, steps, task, check

each_lesson = pytest.mark.parametrize("folder", FOLDERS, ids=lambda path: path.name)
in_both = pytest.mark.parametrize("language", LANGUAGES)


def answers_of(is_right: bool) -> list[tuple[Path, Answer]]:
    index = 0 if is_right else 1
    return [(folder, answer) for folder in FOLDERS for answer in catalogue.answers(folder)[index]]


def name_of(value: object) -> str:
    if isinstance(value, Path):
        return value.name
    return str(value.label_by_language["en"]).replace(" ", "_")  # type: ignore[attr-defined]


def test_lessons_are_numbered_without_a_gap() -> None:
    assert [int(folder.name[:2]) for folder in FOLDERS] == [*range(1, len(FOLDERS) + 1)]
    assert len(FOLDERS) >= 12


@pytest.mark.sampled("folder", "answer", keep=len(answers_of(True)) // 4)
@pytest.mark.parametrize(("folder", "answer"), answers_of(True), ids=name_of)
def test_a_right_answer_passes(folder: Path, answer: Answer) -> None:
    """In the worlds of the task, and in others."""
    lesson = catalogue.load(folder)
    assert findings_of(answer.program, lesson, range(1, lesson.world_count + 1)) == []
    assert findings_of(answer.program, lesson, OTHER_SEEDS) == []


@pytest.mark.sampled("folder", "answer", keep=len(answers_of(False)) // 2)
@pytest.mark.parametrize(("folder", "answer"), answers_of(False), ids=name_of)
def test_a_wrong_answer_gets_a_helpful_message(folder: Path, answer: Answer) -> None:
    lesson = catalogue.load(folder)
    findings = findings_of(answer.program, lesson, range(1, lesson.world_count + 1))
    assert findings, "it passes"
    for language in languages():
        assert sentence(findings[0], language) == answer.sentence_by_language[language]


@each_lesson
def test_a_lesson_has_answers_and_typical_mistakes(folder: Path) -> None:
    right_answers, wrong_answers = catalogue.answers(folder)
    assert len(right_answers) >= 2
    assert len(wrong_answers) >= 3
    if (
        catalogue.load(folder).world_count > 1 and folder.name[:2] != "08"
    ):  # the other one is "always to the left"
        assert any(BY_HEART_LABEL in answer.label_by_language["en"] for answer in wrong_answers)


@each_lesson
def test_a_varying_lesson_is_checked_in_several_worlds(folder: Path) -> None:
    lesson = catalogue.load(folder)
    assert (lesson.world_count > 1) == bool(lesson.variations or lesson.is_mirrored)


@each_lesson
@in_both
def test_the_pages_of_a_lesson_are_complete(folder: Path, language: str) -> None:
    number = int(folder.name[:2])
    lesson = catalogue.load(folder)
    page = catalogue.page(folder, catalogue.PUPIL, language)
    page_blocks = blocks(page)
    assert page_blocks[0].kind == "title"
    assert page_blocks[0].rows[0][0] == f"{number}. {lesson.title(language)}"
    assert sum(block.kind in ("title", "heading") for block in page_blocks) == HEADINGS
    steps = [block for block in page_blocks if block.kind == "steps"]
    assert [
        block.first_number + k for block in steps for k in range(len(block.rows))
    ] == list(range(1, sum(len(block.rows) for block in steps) + 1))  # fmt: skip
    for block in page_blocks:
        if block.kind == "table":  # an empty cell is a place to write: the sheet draws it
            assert {len(row) for row in block.rows} == {len(block.rows[0])}
    assert f"tsc lesson check {number} " in page
    notes = catalogue.page(folder, catalogue.TEACHER, language)
    table = next(block for block in blocks(notes) if block.kind == "table")
    assert str(sum(int(row[0]) for row in table.rows[1:])) == MINUTES


@each_lesson
@in_both
def test_a_worksheet_draws_its_contents(folder: Path, language: str) -> None:
    """Only moving parts are dashed, and a blank is wide enough to write in."""
    lesson = catalogue.load(folder)
    page = catalogue.page(folder, catalogue.PUPIL, language)
    sheet_text = sheet(page, lesson, False, language)
    dashed = len(
        {(variation.place.part, variation.place.number) for variation in lesson.variations}
    )
    assert sheet_text.count("stroke-dasharray") == dashed
    assert (text("lessons", "sheet/moves", language) in sheet_text) is (dashed > 0)
    assert "__" not in sheet_text and sheet_text.count('class="blank"') == page.count("____")
    match = re.search(r"</svg>\s*<p[^>]*>[^<]*\b(\d+) cm", sheet_text)
    assert match and f'<path d="M{match[1]} 0V' in sheet_text


@each_lesson
@in_both
@pytest.mark.parametrize("role", [catalogue.PUPIL, catalogue.TEACHER])
def test_programs_on_pages_compile(folder: Path, language: str, role: str) -> None:
    lesson = catalogue.load(folder)
    robot = robots.load(lesson.robot)
    programs = [
        "\n".join(row for (row,) in block.rows)
        for block in blocks(catalogue.page(folder, role, language))
        if block.kind == "program"
    ]
    assert programs or role == catalogue.TEACHER
    for program in programs:
        compilation = compile_source(program.encode(), robot, "page.ts", is_strict=True)
        assert compilation.is_right, (program, compilation.diagnostics)


@each_lesson
def test_pages_of_all_languages_have_the_same_parts(folder: Path) -> None:
    for role in (catalogue.PUPIL, catalogue.TEACHER):
        kinds = [
            [(block.kind, len(block.rows)) for block in blocks(catalogue.page(folder, role, lang))]
            for lang in LANGUAGES
        ]
        assert all(kind == kinds[0] for kind in kinds)


@cache
def run_button(language: str) -> str:
    return str(page_texts(language)["run"])


@each_lesson
def test_a_page_names_the_button_that_the_studio_has(folder: Path) -> None:
    counts = [
        len(re.findall(rf"\b{run_button(lang)}\b", catalogue.page(folder, catalogue.PUPIL, lang)))
        for lang in LANGUAGES
    ]
    assert len(set(counts)) == 1


@each_lesson
def test_no_page_gives_away_the_answer(folder: Path) -> None:
    """A program on a pupil's page is an example: it does not solve the task."""
    lesson = catalogue.load(folder)
    for language in LANGUAGES:
        for block in blocks(catalogue.page(folder, catalogue.PUPIL, language)):
            if block.kind == "program":
                text = "\n".join(row for (row,) in block.rows)
                assert findings_of(text, lesson, range(1, lesson.world_count + 1)), text


def at_half_power(program: str) -> str:
    return re.sub(
        r"\b([FBLR]\([^,()]+, *)(\d+)\)", lambda move: f"{move[1]}{int(move[2]) // 2})", program
    )


# What follows from a word in a hint or in a message.
ADVISED_CHANGES = {"slow": at_half_power, "FOREVER": text_judging.without_times}


@each_lesson
def test_advice_never_makes_a_program_worse(folder: Path) -> None:
    """A program passes at least as many worlds as before if somebody follows a hint, or what the
    checker says of it."""
    number, lesson = int(folder.name[:2]), catalogue.load(folder)
    seeds = range(1, lesson.world_count + 1)

    @cache
    def worlds_passed(program: str) -> int:
        robot = robots.load(lesson.robot)
        outcome = Marking(program, image_maker(robot), robot, lesson, seeds).run_to_end()
        return outcome.seed - 1 if outcome.seed else lesson.world_count

    hint = page_lessons.steps(number, "en")[-1]["hint"]
    _, wrong_answers = catalogue.answers(folder)
    for program, wrong_sentence in [
        *((answer.program, answer.sentence_by_language["en"]) for answer in wrong_answers),
        *((program, "") for program in page_lessons._programs(number, "en")),
    ]:
        for word, change in ADVISED_CHANGES.items():
            if word in hint + wrong_sentence and change(program) != program:
                assert worlds_passed(change(program)) >= worlds_passed(program), (word, program)


def test_every_criterion_is_judged() -> None:
    from tiniscript.lessons.lesson import KINDS

    assert {*JUDGES, *text_judging.JUDGES} == set(KINDS)


def test_spanish_texts_address_one_pupil() -> None:
    for folder in FOLDERS:
        page = catalogue.page(folder, catalogue.PUPIL, "es")
        assert not re.search(r"\b(usted|ustedes|vosotros|coloque|escriba|pruebe)\b", page, re.I)


def test_the_line_fits_between_the_sensors_as_the_page_says() -> None:
    """In the middle both sensors see white, as in the first row of lesson 12's table."""
    lesson = catalogue.load(FOLDERS[11])
    left, right_answers = (
        robots.load(lesson.robot).body.places[name] for name in ("LINE_L", "LINE_R")
    )
    assert left.y_cm - right_answers.y_cm > max(line.width_cm for line in lesson.world.lines)
