"""A program that names its robot is one for that robot, in every verb; `--robot` wins."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import tiniscript
from tests.support.casefile import ROOT
from tests.support.command import Tsc, run_in_process
from tests.support.rows import each_row
from tests.support.virtual_command import robot
from tiniscript import ProgramError
from tiniscript.cli.texts.options import OPTIONS
from tiniscript.cli.texts.verbs import VERBS

LINER_PROGRAM = "// robot: liner\nSI|SHOW(LINE_L)\n"
UNKNOWN_ROBOT_PROGRAM = "// robot: linar\nSI|SHOW(LINE_L)\n"
PRECEDENCE_MESSAGE = "--robot {} takes precedence: {} names the robot {}.\n"
# Each verb with a program, and its other arguments.
OPTIONS_BY_VERB = {
    "check": [], "run": [], "compile": [], "show": [], "fmt": ["--check"],
    # A class sends programs as upload does.
    "upload": ["--virtual"], "lesson": ["check", "1"], "class": None,
}  # fmt: skip


@pytest.fixture
def liner(tmp_path: Path) -> Path:
    path = tmp_path / "line.ts"
    path.write_text(LINER_PROGRAM, encoding="utf-8")
    return path


def test_every_verb_is_covered() -> None:
    robot_verbs = {verb for verb in VERBS for option in OPTIONS if option.applies_to(verb)
             and option.kind is not None and option.kind.name == "program"}  # fmt: skip
    assert robot_verbs == set(OPTIONS_BY_VERB)


@each_row("verb", [verb for verb, words in OPTIONS_BY_VERB.items() if words is not None])
def test_every_verb_takes_the_robot_that_a_program_names(verb: str, tsc: Tsc, liner: Path) -> None:
    words = OPTIONS_BY_VERB[verb] or []
    result = tsc(verb, *words, liner)
    assert "Error: " not in result.err and "[TS" not in result.err, result
    assert result.code == (1 if verb == "lesson" else 0)  # the program does not solve lesson 1


@each_row("verb", ["check", "run", "compile", "show", "upload"])
def test_an_option_takes_precedence_with_one_notice(verb: str, tsc: Tsc, liner: Path) -> None:
    words = OPTIONS_BY_VERB[verb] or []
    result = tsc(verb, *words, liner, "--robot", "tinibot").gives(1)
    assert result.err.startswith(PRECEDENCE_MESSAGE.format("tinibot", liner, "liner"))
    assert result.err.count(" takes precedence: ") == 1
    expected_text = "Try:  Write --robot liner in the command, not tinibot"
    assert expected_text in result.err  # the comment is there already
    same = tsc(verb, *words, liner, "--robot", "LINER").gives(0)
    assert " takes precedence: " not in same.err


def test_a_custom_robot_may_be_named(tsc: Tsc, tmp_path: Path) -> None:
    shipped_path = ROOT / "compiler" / "tiniscript" / "robots" / "liner.toml"
    robot_file = tmp_path / "mine.toml"
    robot_file.write_text(shipped_path.read_text(encoding="utf-8"), encoding="utf-8")
    path = tmp_path / "line.ts"
    path.write_text(LINER_PROGRAM.replace("liner", "mine"), encoding="utf-8")
    assert "No robot is called mine" in tsc("check", path).gives(1).err
    assert tsc("check", path, "--robot", robot_file).gives(0).err == ""


@each_row("verb", ["check", "run", "compile", "show", "upload", "lesson"])
def test_a_name_that_no_robot_has_is_a_mistake(verb: str, tsc: Tsc, tmp_path: Path) -> None:
    path = tmp_path / "x.ts"
    path.write_text(UNKNOWN_ROBOT_PROGRAM, encoding="utf-8")
    result = tsc(verb, *(OPTIONS_BY_VERB[verb] or []), path).gives(1)
    assert result.err.count("[TS") == 1  # the words of this robot are unknown
    assert "line 1:  // robot: linar\n                   ^^^^^\n" in result.err
    assert "No robot is called linar; these come with TiniScript: tinibot, elegoo4" in result.err
    assert "Try:  // robot: liner   [TS138]" in result.err


@each_row(
    "language, message", [("es", "Ningún robot se llama x2"), ("pt", "Nenhum robô se chama x2")]
)
def test_an_unknown_robot_is_reported_in_all_languages(
    language: str, message: str, tsc: Tsc
) -> None:
    result = tsc("check", "-e", "// robot: x2\nS", "--lang", language).gives(1)
    assert message in result.err and "--robot" in result.err


def test_an_editor_gets_the_place_of_the_name(tsc: Tsc) -> None:
    (finding,) = json.loads(tsc("check", "-e", UNKNOWN_ROBOT_PROGRAM, "--json").gives(1).out)
    assert (finding["code"], finding["line"], finding["column"], finding["end_column"]) == (
        "TS138", 1, 11, 16,
    )  # fmt: skip


def test_each_program_of_a_folder_has_its_own_robot(tsc: Tsc, tmp_path: Path) -> None:
    (tmp_path / "a.ts").write_text(LINER_PROGRAM, encoding="utf-8")
    (tmp_path / "b.ts").write_text("SI|SHOW(DISTANCE)\n", encoding="utf-8")
    (tmp_path / "c.ts").write_text("// robot: grabber\nSI|F(2 60);LED(TRUE)\n", encoding="utf-8")
    rows = json.loads(tsc("check", tmp_path, "--json").gives(1).out)
    assert [row["mistakes"] for row in rows] == [0, 0, 1]
    result = tsc("check", tmp_path, "--robot", "liner").gives(1)
    assert result.err == PRECEDENCE_MESSAGE.format("liner", tmp_path / "c.ts", "grabber")
    tsc("check", tmp_path, "--fix").gives(0)
    assert "F(2, 60)" in (tmp_path / "c.ts").read_text(encoding="utf-8")


def test_the_examples_are_correct_unchanged(tsc: Tsc) -> None:
    assert "free of mistakes: 11" in tsc("check", ROOT / "examples").gives(0).out


def test_a_named_robot_takes_precedence_over_the_connected_one(liner: Path) -> None:
    with robot("--robot", "liner", "--world", "line") as running_robot:
        assert (
            run_in_process("upload", liner, "--port", running_robot.port, "--no-run").gives(0).err
            == ""
        )
        assert run_in_process("check", liner, "--virtual").gives(0).err == ""
    with robot() as running_robot:
        run_in_process("upload", liner, "--port", running_robot.port).gives(3, "another kit")
        assert run_in_process("check", liner, "--virtual").gives(0).err == ""


def test_the_library_accepts_a_named_robot() -> None:
    assert tiniscript.compile(LINER_PROGRAM).robot == "liner"
    assert tiniscript.check(LINER_PROGRAM) == []
    assert [event.name for event in tiniscript.run(LINER_PROGRAM).events] == [
        "READ",
        "SHOW",
        "DONE",
    ]
    assert [message.code for message in tiniscript.check(LINER_PROGRAM, "tinibot")] == ["TS119"]
    assert [message.code for message in tiniscript.check(UNKNOWN_ROBOT_PROGRAM)] == ["TS138"]
    assert tiniscript.check(UNKNOWN_ROBOT_PROGRAM, "liner") == []
    with pytest.raises(ProgramError, match="No robot is called linar"):
        tiniscript.compile(UNKNOWN_ROBOT_PROGRAM)
