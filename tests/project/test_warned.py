"""The warnings that programs get, the rarest first."""

from __future__ import annotations

from pathlib import Path

import pytest

from tools import warned


def test_warnings_of_a_folder_are_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, program in (("a", "X = 5"), ("b", "X = 5;F(500, 50)"), ("c", "F(1, 50)")):
        (tmp_path / f"{name}.ts").write_text(program, encoding="utf-8")
    assert warned.main([str(tmp_path)]) == 0
    *others, long_time, unused_text = capsys.readouterr().out.splitlines()
    assert (long_time, unused_text) == ("TS811 1 of 3", "TS806 2 of 3")
    assert others and all(row.endswith(" 0 of 3") for row in others)
    (tmp_path / "empty").mkdir()
    with pytest.raises(SystemExit, match="no programs"):
        warned.main([str(tmp_path / "empty")])


def test_no_right_answer_of_a_lesson_gets_a_warning() -> None:
    answers = [*warned.programs_in(None)]
    assert len(answers) > 30
    assert {program: warned.warnings_in(program) for program in answers} == {
        program: set() for program in answers
    }
