"""A fault says which task of a program it has ended: in both languages, from any robot."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.command import run_in_process

DEF, WHEN, TASK = (
    f"{head}\n  W(0.05); {{}}\n{end}\n"
    for head, end in (("def A", "END_DEF"), ("WHEN(TRUE)", "END_WHEN"), ("Task", "ENDTASK"))
)
FAULT = "SHOW(1 / N)"


def program(place: str) -> str:
    blocks = (("DEF", DEF), ("WHEN", WHEN), ("TASK", TASK))
    inner = {"DEF": "A", place: FAULT}
    inner["DEF"] = FAULT if place == "DEF" else "S"
    text = "N = 0; TASKS = 1\n" + "".join(block.format(inner.get(k, "A")) for k, block in blocks)
    return text + (f"W(0.01); {FAULT}\n" if place == "main" else "")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "tasks.ts"


@pytest.mark.parametrize(
    ("place", "english", "spanish"),
    [
        ("WHEN", "line 6, in the WHEN on line 5:  ", "línea 6, en el WHEN de la línea 5:  "),
        ("TASK", "line 9, in the TASK on line 8:  ", "línea 9, en el TASK de la línea 8:  "),
        ("main", "line 11, in the main task:  ", "línea 11, en la tarea principal:  "),
        ("DEF", "line 3:  ", "línea 3:  "),  # both tasks call it
    ],
)
def test_a_fault_names_its_line_and_its_task(
    place: str, english: str, spanish: str, path: Path
) -> None:
    path.write_text(program(place), encoding="utf-8")
    for language, sentence in (("en", english), ("es", spanish)):
        result = run_in_process("run", path, "--lang", language)
        assert result.code == 1 and result.out.endswith("FAULT DIVIDE_BY_ZERO\n")
        line = result.err.splitlines()[-1]
        assert line.startswith(sentence) and line.endswith(FAULT), line


def test_a_fault_of_a_program_without_tasks_names_no_task(path: Path) -> None:
    path.write_text("N = 0\nTASKS = 1 / N\n", encoding="utf-8")
    assert run_in_process("run", path).err.endswith("line 2:  TASKS = 1 / N\n")


@pytest.mark.parametrize("robot", ["grabber", "tinibot32"])
def test_a_fault_on_a_robot_names_its_task(robot: str, path: Path) -> None:
    path.write_text(program("WHEN"), encoding="utf-8")
    result = run_in_process("upload", path, "--virtual", "--robot", robot)
    assert (result.code, "line 6, in the WHEN on line 5:  " in result.err) == (1, True), result.err
    text = "N = 0; WHEN(TRUE); SHOW(1 / N); END_WHEN"
    run_in_process("live", text, "--virtual", "--robot", robot).gives(
        1, "line 1, in the WHEN on line 1:  "
    )
