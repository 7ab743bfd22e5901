"""`tsc lesson` as teachers and pupils use it."""

from __future__ import annotations

import csv
import json
import os
import re
import sys
from argparse import Namespace
from pathlib import Path

import pytest

from tests.support.command import Tsc
from tests.support.texts import LANGUAGES
from tiniscript.cli import lesson_check
from tiniscript.lessons import catalogue

RIGHT_ANSWER, SHORT_ANSWER, WRONG_ANSWER = "SI|F(2.5, 80)", "SI|F(2, 80)", "SI|F(2 80)"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with the programs of a class."""
    pupils = tmp_path / "class"
    pupils.mkdir()
    for name, text in {
        "ana": RIGHT_ANSWER,
        "beto": SHORT_ANSWER,
        "carla": WRONG_ANSWER,
        "=dani": "SI|F(5, 80)",
    }.items():
        (pupils / f"{name}.ts").write_text(text, encoding="utf-8")
    (pupils / "eva.ts.txt").write_text(RIGHT_ANSWER, encoding="utf-8")
    (pupils / "fox.ts").write_bytes(b"\xff\xfe\x00")
    (pupils / "notes.pdf").write_bytes(b"%PDF")
    return pupils


def test_the_lessons_are_listed(tsc: Tsc) -> None:
    result = tsc("lesson", "--lang", "es").gives(0)
    rows = result.out.splitlines()
    assert len(rows) == 18
    assert rows[0] == " 1  La primera línea   (tinibot)"


def test_a_program_is_checked(tsc: Tsc, folder: Path) -> None:
    result = tsc("lesson", "check", "1", folder / "ana.ts")
    assert result.code == 0
    assert "done! This solves lesson 1." in result.out
    tsc("lesson", "check", "1", folder / "beto.ts", "--lang", "es").gives(
        1, out="- El robot se quedó 18 cm antes del centro de la cochera. Haz que avance más."
    )
    tsc("lesson", "check", "1", "-e", WRONG_ANSWER).gives(1, "TS017", out="fix the mistakes first")


def test_the_world_of_a_failed_check_can_be_repeated(tsc: Tsc, tmp_path: Path) -> None:
    path = tmp_path / "left.ts"
    path.write_text("SI|F(2.6, 60);L(0.42, 60);IF(TRUE);F(2.4, 60);ENDIF", encoding="utf-8")
    result = tsc("lesson", "check", "8", path).gives(1)
    match = re.search(r"--seed (\d+)", result.out)
    assert match and f"not yet, in world {match[1]}." in result.out
    (sentence,) = [row for row in result.out.splitlines() if row.startswith("- ")]
    tsc("lesson", "check", "8", path, "--seed", match[1]).gives(1, out=sentence)
    assert tsc("lesson", "check", "8", path, "--seed", "1").code == 0


def test_a_folder_gets_a_table(tsc: Tsc, folder: Path, tmp_path: Path) -> None:
    rows = tmp_path / "marks.csv"
    result = tsc("lesson", "check", "1", folder, "--csv", rows).gives(1)
    table = {row.split()[0]: row for row in result.out.splitlines()}
    assert re.match(r"ana\.ts +done$", table["ana.ts"])
    assert "not yet" in table["beto.ts"] and "18 cm before" in table["beto.ts"]
    assert "mistakes" in table["carla.ts"] and "line 1" in table["carla.ts"]
    assert "done" in table["eva.ts.txt"]
    assert "mistakes" in table["fox.ts"]
    assert result.out.splitlines()[-1] == "Lesson 1 done: 2 of 6."
    data = rows.read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")  # spreadsheets on Windows ask for it
    cells = list(csv.reader(data.decode("utf-8-sig").splitlines()))
    assert cells[0] == ["file", "verdict", "seed", "sentence"]
    assert cells[1][0] == "'=dani.ts"  # no formula
    assert {row[1] for row in cells[1:]} == {"passed", "failed", "mistakes"}


def test_the_table_of_a_teacher_in_lima_is_spanish_and_may_be_written_again(
    tsc: Tsc, folder: Path, tmp_path: Path
) -> None:
    rows = tmp_path / "notas.csv"
    (folder / "a,=1+1;@x.ts").write_text("F(", encoding="utf-8")
    for _ in range(2):  # pupils repair after a lesson, and the teacher checks again
        assert tsc("lesson", "check", "1", folder, "--lang", "es", "--csv", rows).code == 1
    data = rows.read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")
    cells = list(csv.reader(data.decode("utf-8-sig").splitlines(), delimiter=";"))
    assert cells[0] == ["archivo", "resultado", "mundo", "frase"]
    assert {row[1] for row in cells[1:]} == {"listo", "todavía no", "errores"}
    assert {len(row) for row in cells} == {4}
    assert "a,'=1+1;'@x.ts" in [row[0] for row in cells]  # any possible end of a cell
    assert tsc("lesson", "check", "1", folder, "--csv", rows).code == 1  # the same in English
    assert rows.read_text("utf-8-sig").startswith("file,verdict,seed,sentence\n")


def test_json_is_a_list(tsc: Tsc, folder: Path) -> None:
    rows = json.loads(tsc("lesson", "check", "1", folder, "--json").out)
    assert [row["verdict"] for row in rows] == [
        "failed", "passed", "failed", "mistakes", "passed", "mistakes"]  # fmt: skip
    assert rows[2]["findings"][0]["kind"] == "ends_in"
    assert rows[2]["seed"] == 1
    (result,) = json.loads(tsc("lesson", "check", "1", "-e", RIGHT_ANSWER, "--json").out)
    assert result == {"file": "-e", "verdict": "passed", "seed": None, "findings": []}


def test_a_mark_is_the_same_whatever_was_marked_before(tsc: Tsc, tmp_path: Path) -> None:
    programs = [
        RIGHT_ANSWER, SHORT_ANSWER, WRONG_ANSWER, "SI|F(2.5, 80);SHOW(DISTANCE)",
        "// robot: liner\nSI|F(2.5, 80)", "// robot: liner\nSI|F(2.5, 80);SHOW(LINE_L)",
        "SI|F(2.5, 80);SHOW(LINE_L)", "", "SB|F(2.5, 80)",
    ]  # fmt: skip

    def marks_of(texts: list[str]) -> list[dict[str, object]]:
        for number, text in enumerate(texts):
            (tmp_path / f"{number}.ts").write_text(text, encoding="utf-8")
        return [
            {**row, "file": ""}
            for row in json.loads(tsc("lesson", "check", "1", tmp_path, "--json").out)
        ]

    marks = [marks_of([program])[0] for program in programs]
    assert len({mark["verdict"] for mark in marks}) == 3
    for program, mark in zip(programs, marks, strict=True):  # each one before all
        assert marks_of([program, *programs]) == [mark, *marks]


def test_lesson_draws_the_path_and_prints_a_page_for_a_terminal(tsc: Tsc, tmp_path: Path) -> None:
    picture = tmp_path / "way.png"
    assert tsc("lesson", "check", "1", "-e", SHORT_ANSWER, "--plot", picture).code == 1
    assert picture.read_bytes().startswith(b"\x89PNG")
    result = tsc("lesson", "show", "4", "--teacher").gives(
        0, out=("    SI|LOOP(4)\n", "Answers\n-------")
    )
    assert "```" not in result.out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["jump"], "lesson takes show, check or sheet, not jump"),
        (["--json"], "--json does not work with tsc lesson."),
        (["show"], "which lesson?"),
        (["show", "19"], "There is no lesson 19. Give a number from 1 to 18"),
        (["show", "0"], "There is no lesson 0."),
        (["show", "²"], "There is no lesson ²."),
        (["show", "9" * 5000], "There is no lesson 999"),
        (["show", "a\0b"], "There is no lesson"),
        (["check", "1"], "which program?"),
        (["check", "1", "nothing.ts"], "there is no file nothing.ts"),
        (["check", "1", "x.ts", "-e", "F(1,1)"], "one program only"),
        (["check", "1", "-e", "F(1,1)", "--seed", "0"], "--seed takes a whole number"),
        (
            ["check", "1", "-e", "F(1,1)", "--teacher"],
            "--teacher does not work with tsc lesson check",
        ),
        (["show", "1", "--json"], "--json does not work with tsc lesson show"),
        (["show", "1", "x.ts"], "x.ts does not work with tsc lesson show"),
        (["sheet", "1"], "where should the page go?"),
        (["sheet", "1", "-o", "no/such/folder.html"], "cannot be written"),
        (["check", "1", "."], "has no programs"),
    ],
)
def test_wrong_use_names_the_next_step(
    tsc: Tsc, arguments: list[str], sentence: str, working_folder: Path
) -> None:
    result = tsc("lesson", *arguments).gives(2, sentence)
    assert tsc("lesson", *arguments, "--lang", "es").err != result.err


def test_an_irregular_file_has_a_row(tsc: Tsc, folder: Path, tmp_path: Path) -> None:
    """Circular and dangling links, a pipe, an image: none blocks, and none is left out."""
    (tmp_path / "a.bin").write_bytes(b"TS\x02")
    assert "its source" in tsc("lesson", "check", "1", tmp_path / "a.bin").err
    (folder / "image.ts").write_bytes(b"TS\x02\0")
    (folder / "circle.ts").symlink_to("circle.ts")
    (folder / "nothing.ts").symlink_to("gone")
    (folder / "above").symlink_to(".")
    os.mkfifo(folder / "pipe.ts")  # no process writes to the pipe
    result = tsc("lesson", "check", "1", folder, "--json")
    rows = {row["file"]: row for row in json.loads(result.out)}
    assert (result.code, len(rows), rows["image.ts"]["verdict"]) == (1, 10, "unreadable")
    for name in ("circle.ts", "nothing.ts", "pipe.ts"):
        assert rows[name]["verdict"] == "unreadable"
        (finding,) = rows[name]["findings"]
        assert name in finding["sentence"]
        assert str(folder) not in finding["sentence"]
        assert not finding["sentence"].startswith("tsc")


def test_a_custom_lesson_is_checked(tsc: Tsc, tmp_path: Path) -> None:
    shipped_path = catalogue.folders()[0]
    for name in ("lesson.toml", "world.toml"):
        (tmp_path / name).write_bytes((shipped_path / name).read_bytes())
    assert tsc("lesson", "check", tmp_path, "-e", RIGHT_ANSWER).code == 0
    tsc("lesson", "show", tmp_path).gives(2, "pupil.en.md is missing")
    text = (tmp_path / "world.toml").read_text(encoding="utf-8")
    (tmp_path / "world.toml").write_text(text.replace("x_cm = 30", "x_cm = 2"), encoding="utf-8")
    tsc("lesson", "check", tmp_path, "-e", RIGHT_ANSWER).gives(2, "the robot does not fit")
    (tmp_path / "lesson.toml").write_text("worlds = 0", encoding="utf-8")
    tsc("lesson", "check", tmp_path, "-e", RIGHT_ANSWER).gives(2, "robot is missing")


@pytest.mark.parametrize("language", LANGUAGES)
@pytest.mark.parametrize("number", range(1, 15))
def test_worksheets_are_complete_pages(
    tsc: Tsc, number: int, language: str, tmp_path: Path
) -> None:
    """A sheet is one file: it downloads nothing, closes every element, and includes the drawing."""
    for options in ([], ["--teacher"]):
        path = tmp_path / "sheet.html"
        tsc("lesson", "sheet", str(number), "-o", path, "--lang", language, *options).gives(0)
        page = path.read_text(encoding="utf-8")
        assert not re.search(r"(src|href|url|@import|<script|<link)\b", page)
        assert page.count("<svg") == 1
        assert "**" not in page and "```" not in page and "`" not in page
        assert "size: A4" in page
        open_tags: list[str] = []
        for is_end, tag, is_whole in re.findall(r"<(/?)(\w+)[^>]*?(/?)>", page):
            if is_end:
                assert open_tags and open_tags.pop() == tag, tag
            elif tag != "meta" and not is_whole:
                open_tags.append(tag)
        assert open_tags == []


def test_a_word_of_another_robot_suggests_no_option_that_lesson_lacks(tsc: Tsc) -> None:
    for language in ("en", "es"):
        result = tsc("lesson", "check", "1", "-e", "SI|F(1,60) UNTIL(LINE_L)", "--lang", language)
        assert result.code == 1
        assert "robot:" not in result.err + result.out and "--robot" not in result.err + result.out
        assert "LINE_L" in result.err + result.out
    assert "// robot: liner" in tsc("check", "-e", "SI|F(1,60) UNTIL(LINE_L)").err


def test_a_class_folder_may_contain_anything(tsc: Tsc, tmp_path: Path) -> None:
    """Broken, empty, huge, binary and wrongly stored files have a row each, and none is lost."""
    pupils = tmp_path / "class"
    pupils.mkdir()
    odd_files = {
        "empty.ts": (b"", "not yet"), "blank.ts": (b"  \n\n", "not yet"),
        "binary.ts": (bytes(range(256)) * 10, "mistakes"),
        "huge.ts": (b"F(1,80);" * 200_000, "mistakes"),
        "latin1.ts": ("SI|F(2.5, 80) // año".encode("latin-1"), "mistakes"),
        "utf16.ts": (RIGHT_ANSWER.encode("utf-16"), "mistakes"),
        "notepad.txt": (b"\xef\xbb\xbf" + RIGHT_ANSWER.encode() + b"\r\n", "done"),
        "ping.ts": (b"PING|CHECK_CONNECTION", "not yet"),
        "José Ñañez.ts": (RIGHT_ANSWER.encode(), "done"),
        "red\x1b[31m.ts": (RIGHT_ANSWER.encode(), "done"),
    }  # fmt: skip
    for name, (data, _) in odd_files.items():
        (pupils / name).write_bytes(data)
    for number in range(30 - len(odd_files)):
        (pupils / f"pupil {number}.ts").write_text(RIGHT_ANSWER, encoding="utf-8")
    (pupils / "folder.ts").mkdir()
    rows = tmp_path / "marks.csv"
    result = tsc("lesson", "check", "1", pupils, "--csv", rows).gives(1)
    assert result.out.splitlines()[-1] == "Lesson 1 done: 23 of 30."
    assert "\x1b" not in result.out
    assert b"\x1b" not in rows.read_bytes()
    verdicts = {"done": "passed", "not yet": "failed", "mistakes": "mistakes"}
    verdict_by_name = {
        row[0]: row[1] for row in csv.reader(rows.read_text("utf-8-sig").splitlines())
    }
    for name, (_, verdict) in odd_files.items():
        assert verdict_by_name[name.replace("\x1b", "?")] == verdicts[verdict], name


def test_notes_are_ignored_and_folders_of_pupils_are_checked(tsc: Tsc, tmp_path: Path) -> None:
    pupils = tmp_path / "año 3 ñandú"
    for name in ("Ana", "Beto", "x.ts"):
        (pupils / name).mkdir(parents=True)
        (pupils / name / "square.ts").write_text(RIGHT_ANSWER, encoding="utf-8")
    notes = {
        "README.txt": "Para entregar: los de tercero.\nGracias (a todos).\n",
        "Léeme primero.TXT": "Ana 15\nBeto 12\n", "notas (2).txt": "Todo bien",
    }  # fmt: skip
    files = {
        "notepad.txt": RIGHT_ANSWER, "wrong.txt": "ADELANTE (2)", "notasio.txt": "hola",
        "readme ana.txt": RIGHT_ANSWER, "notes.txt": "SI\rforward 5", "notas.txt": "F 2 80;R 1 60",
        "empty.txt": "", "note.ts": "Ana 15", "also.ts.txt": "Ana 15", "lista.txt": "Ana 15",
    }  # fmt: skip
    for name, content in {**files, **notes}.items():
        (pupils / name).write_text(content, encoding="utf-8")
    (pupils / ".hidden").mkdir()
    (pupils / ".hidden" / "old.ts").write_text(RIGHT_ANSWER, encoding="utf-8")
    rows = tmp_path / "marks.csv"
    result = tsc("lesson", "check", "1", pupils, "--json", "--csv", rows).gives(1)
    verdict_by_file = {
        row["file"].replace(os.sep, "/"): row["verdict"] for row in json.loads(result.out)
    }
    assert verdict_by_file == {
        "also.ts.txt": "mistakes", "empty.txt": "failed", "note.ts": "mistakes",
        "notepad.txt": "passed", "wrong.txt": "mistakes", "Ana/square.ts": "passed",
        "Beto/square.ts": "passed", "x.ts/square.ts": "passed", "notasio.txt": "mistakes",
        "readme ana.txt": "passed", "notes.txt": "mistakes", "notas.txt": "mistakes",
        "lista.txt": "mistakes", **dict.fromkeys(notes, "no_program"),
    }  # fmt: skip
    verdicts = [row[1] for row in csv.reader(rows.read_text("utf-8-sig").splitlines())]
    assert verdicts.count("no_program") == len(notes)
    assert result.err.startswith(
        "Not checked because they look like notes: Léeme primero.TXT, README"
    )
    table = tsc("lesson", "check", "1", pupils).out.splitlines()
    assert [row[len("README.txt") :].strip() for row in table if row.startswith("README")] == [
        "no program"
    ]
    assert table[-1] == "Lesson 1 done: 5 of 13."
    for name in files:
        (pupils / name).unlink()
    assert tsc("lesson", "check", "1", pupils).code == 0  # notes do not count as failures
    for name in ("Ana", "Beto", "x.ts"):
        (pupils / name / "square.ts").unlink()
    for language, words in (("en", "has no programs"), ("es", "no hay ningún programa")):
        tsc("lesson", "check", "1", pupils, "--lang", language).gives(2, words, out="")


def test_a_wrong_program_of_a_pupil_has_a_row(tsc: Tsc, tmp_path: Path) -> None:
    for wrong_program in (
        "SI\nF 2,80\nR 1,60", "F 2 80;R 1 60", "adelante 5 segundos\nderecha 1",
        "forward 5\nright 90", "if distancia < 10 parar", "Nombre: Ana\nSI;F 2,80;R 1,60",
    ):  # fmt: skip
        (tmp_path / "ana.txt").write_text(wrong_program, encoding="utf-8")
        result = tsc("lesson", "check", "1", tmp_path, "--json")
        (row,) = json.loads(result.out)
        assert (result.code, row["file"], row["verdict"]) == (1, "ana.txt", "mistakes"), (
            wrong_program
        )


def test_a_note_of_empty_lines_is_looked_at_once(tsc: Tsc, tmp_path: Path) -> None:
    """Quadratic time would take minutes."""
    (tmp_path / "README.txt").write_text("\n" * 100_000 + " " * 100_000 + "." + "a" * 100_000)
    assert "has no programs" in tsc("lesson", "check", "1", tmp_path).err


@pytest.mark.parametrize("columns", [40, 80, 200])
def test_a_table_fits_the_terminal(
    columns: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    sentence = "The robot stood 18 cm before the middle of the garage. Make it drive further. " * 2
    marks = [
        lesson_check.Mark("José Ñáñez (1).ts", "failed", 1, (("", sentence),)),
        lesson_check.Mark("ana.ts", "passed", 0, ()),
    ]
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setattr(lesson_check, "get_terminal_size", lambda: os.terminal_size((columns, 24)))
    lesson_check._print_table(marks, Namespace(number="1"), "en")
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) < columns
    assert " ".join(" ".join(lines).split()).count("Make it drive further.") == 2
    assert "ana.ts             done" in lines
