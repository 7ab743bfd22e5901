"""An unusable lesson is reported with all complaints at once, and with the next step."""

from __future__ import annotations

from pathlib import Path

import pytest

from tiniscript.lessons import catalogue
from tiniscript.lessons.lesson import LessonRefused
from tiniscript.robots.refusals import describe

HEAD = 'robot = "tinibot"\nseconds = 20\n[title]\nen = "A"\nes = "B"\n'
WORLD = "[floor]\nwidth_cm = 200\nheight_cm = 100\n[start]\nx_cm = 50\ny_cm = 50\n"
TOUCH = '[[criteria]]\nkind = "never_touches"\n'


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "world.toml").write_text(WORLD, encoding="utf-8")
    return tmp_path


def refusal_of(folder: Path, text: str, language: str = "en") -> list[str]:
    (folder / "lesson.toml").write_text(text, encoding="utf-8")
    with pytest.raises(LessonRefused) as exception_info:
        catalogue.load(folder)
    return describe(exception_info.value, language)


PRESS = '[[presses]]\nat_seconds = 1\nseconds = 2\nkey = "KEY_A"\n'
CASES = [
    (HEAD, "The lesson has no criteria. Add one"),
    (HEAD + '[[criteria]]\nkind = "never_touch"\n', "Did you mean never_touches?"),
    (HEAD + '[[criteria]]\nkind = "flies"\n', "which is not a criterion. Write one of these: ends_in"),
    (HEAD + TOUCH + "within_cm = 3\n", "The lesson's file has no key criteria[1].within_cm."),
    (HEAD + '[[criteria]]\nkind = "ends_in"\n', 'criteria[1].at is missing. Add it, for example: at = "start"'),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = 5\n', "criteria[1].at is not a place."),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = []\n', "criteria[1].at is not a place."),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = "boxes[1]"\n', "world.toml has only 0 of them"),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = "moon"\n', "Write start, or one of walls"),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = "start"\nwithin_cm = 900\n', "from 1 to 500"),
    (HEAD + '[[criteria]]\nkind = "follows"\nat_least_cm = 0\n', "from 1 to 10000"),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = "start"\nen = ""\n', "criteria[1].en"),
    (HEAD + '[[criteria]]\nkind = "uses"\nwords = ["LOP"]\n', "Did you mean LOOP?"),
    (HEAD + '[[criteria]]\nkind = "uses"\nwords = "LOOP"\n', "is not a list of words"),
    (HEAD + '[[criteria]]\nkind = "order"\nwords = ["sings"]\n', "sings, which is not a known word"),
    (HEAD + '[[criteria]]\nkind = "shows"\nwhat = "LINE_L"\n', "Write one of these: LIGHT_R"),
    (HEAD + '[[criteria]]\nkind = "stands_before"\nlow_cm = 9\nhigh_cm = 5\n', "is larger than criteria[1].high_cm"),
    (HEAD + '[[criteria]]\nkind = "ends_in"\nat = "start"\nx_cm = [5, -5]\n', "must be smaller than the second."),
    (HEAD + '[[criteria]]\nkind = "reaches"\nat = "start"\nwhat = "TIME"\n', "Write one of these: LIGHT_R"),
    (HEAD + '[[criteria]]\nkind = "blinks"\n', 'what = "LED"'),
    (HEAD + '[[criteria]]\nkind = "blinks"\nwhat = "LED"\n', "Write one of these: -"),
    (HEAD + '[[criteria]]\nkind = "needs"\nwords = ["IF"]\n', "IF, which is not a known word"),
    (HEAD + '[[criteria]]\nkind = "moves"\nat_most = 1\nahead = 3\n', "criteria[1].ahead"),
    (HEAD + TOUCH + '[[varies]]\npart = "walls[1]"\n', "world.toml has only 0 of them"),
    (HEAD + TOUCH + '[[varies]]\npart = "start"\nx_cm = [5, -5]\n', "must be smaller than the second."),
    (HEAD + TOUCH + '[[varies]]\npart = "start"\nheading = [-900, 5]\n', "from -360 to 360"),
    (HEAD + TOUCH * 101, "criteria has 101"),
    ("worlds = 99\n" + HEAD + TOUCH, "Write a number from 1 to 20."),
    (HEAD.replace("tinibot", "tinibt") + TOUCH, "robot is tinibt. Write one of these: tinibot"),
    (HEAD.replace('en = "A"\nes = "B"\n', "") + TOUCH, "title.en is missing"),
    (HEAD + '[[criteria]]\nkind = "obeys"\n', "presses is missing. Add it, for example: [[presses]]"),
    (HEAD + TOUCH + '[[presses]]\n', "presses[1].at_seconds is missing. Add it, for example: at_seconds = 0"),
    (HEAD + TOUCH + PRESS + PRESS, "presses[2].at_seconds"),
    (HEAD + TOUCH + PRESS.replace("_A", "_C"), "Write one of these: KEY_UP"),
    (HEAD + TOUCH + PRESS.replace("KEY_A", "PAD_X"), "Write one of these: KEY_UP"),
    (HEAD + TOUCH + PRESS.replace("= 2", "= 0"), "presses[1].seconds"),
    (HEAD + TOUCH + PRESS + "x = 1\n", "The lesson's file has no key presses[1].x."),
    ("x", "Line 1 is not valid TOML."),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), CASES)
def test_a_refused_lesson_gives_the_reason(folder: Path, text: str, message: str) -> None:
    complaints = refusal_of(folder, text)
    assert any(message in sentence for sentence in complaints), complaints
    assert len(refusal_of(folder, text, "es")) == len(complaints)


def test_all_complaints_are_reported_at_once(folder: Path) -> None:
    text = 'speed = 3\nrobot = "tinibot"\nseconds = 0\n[title]\nen = ""\nes = "B"\n' + TOUCH
    assert len(refusal_of(folder, text)) == 3


def test_the_world_of_a_lesson_is_an_ordinary_world(folder: Path) -> None:
    (folder / "world.toml").write_text(WORLD.replace("floor", "flor"), encoding="utf-8")
    assert "The lesson's file has no key flor" in " ".join(refusal_of(folder, HEAD + TOUCH))


def test_answers_are_read_strictly(folder: Path) -> None:
    (folder / "answers.toml").write_text("[[right]]\nen = 'a'\nes = 'b'\nsays = 3\n")
    with pytest.raises(LessonRefused) as exception_info:
        catalogue.answers(folder)
    sentences = describe(exception_info.value, "en")
    assert any("right[1].program is missing" in complaint for complaint in sentences)
    assert any("right[1].says" in complaint for complaint in sentences)


@pytest.mark.parametrize(
    ("message_table", "message"),
    [
        ("", "wrong[1].says.key is missing"),
        ("key = 'stil'", "wrong[1].says.key has stil, which is not a known word"),
        ("key = 'touches/wall'", 'wrong[1].says.seconds is missing. Add it, for example: seconds = "…"'),
        ("key = 'touches/wall', seconds = 3", "says.seconds is a number. Write text in quotes there"),
        ("key = 'still', cm = '3'", "The lesson's file has no key wrong[1].says.cm"),
    ],
)  # fmt: skip
def test_a_wrong_answers_message_exists_in_the_checker(
    folder: Path, message_table: str, message: str
) -> None:
    rows = f"[[wrong]]\nen = 'a'\nprogram = 'S'\nsays = {{ {message_table} }}\n"
    (folder / "answers.toml").write_text(rows, encoding="utf-8")
    with pytest.raises(LessonRefused) as exception_info:
        catalogue.answers(folder)
    (why,) = describe(exception_info.value, "en")
    assert message in why


def test_a_custom_goal_is_named_in_each_language(folder: Path) -> None:
    rows = "[[wrong]]\nen = 'a'\nprogram = 'S'\n[wrong.says]\nkey = 'ends_in/short'\ncm = '9'\n"
    rows += "place = 'the blue flag'\nes = 'la bandera azul'\n"
    (folder / "answers.toml").write_text(rows, encoding="utf-8")
    _, (answer,) = catalogue.answers(folder)
    assert "9 cm before the middle of the blue flag" in answer.sentence_by_language["en"]
    assert "de la bandera azul" in answer.sentence_by_language["es"]


def test_a_page_states_the_numbers_of_its_lesson(folder: Path) -> None:
    pauses = '[[criteria]]\nkind = "pauses"\nat_least_seconds = 2.5\nat = [90, 80]\n'
    (folder / "lesson.toml").write_text(HEAD + pauses, encoding="utf-8")
    page = folder / "pupil.en.md"
    page.write_text("{pauses.at_least_seconds} s, {pauses.way_cm} cm, {} {X}", encoding="utf-8")
    assert catalogue.page(folder, catalogue.PUPIL, "en") == "2.5 s, 50 cm, {} {X}"
    page.write_text("{pauses.seconds}", encoding="utf-8")
    with pytest.raises(LessonRefused) as exception_info:
        catalogue.page(folder, catalogue.PUPIL, "en")
    (sentence,) = describe(exception_info.value, "en")
    assert (
        "pupil.en.md uses {pauses.seconds}, but the lesson has no number with that name" in sentence
    )
    assert "pauses.at_least_seconds" in sentence
    assert describe(exception_info.value, "es") != [sentence]
