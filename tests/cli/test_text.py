"""`tsc compile --text` and `--text-level`: programs for robots that read text."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.command import Tsc

PROGRAM = "si|\n  f(2, 80) // go\n"
LINE = "SI|F(2,80)~72CA4271\n"
LONG_PROGRAM = "S\n" * 260


@pytest.fixture
def program(tmp_path: Path) -> Path:
    path = tmp_path / "go.ts"
    path.write_text(PROGRAM, encoding="utf-8")
    return path


def test_the_line_goes_to_standard_output(tsc: Tsc, program: Path) -> None:
    for options in ([], ["-o", "-"], ["--text-level", "uno"]):
        result = tsc("compile", "--text", program, *options)
        assert (result.code, result.out) == (0, LINE)
        assert f"{program} -> -   20 bytes of text   3 bytes of code" in result.err
    assert [path.name for path in program.parent.iterdir()] == ["go.ts"]


def test_the_line_runs_and_compiles_as_the_program_does(tsc: Tsc, program: Path) -> None:
    line = program.parent / "line.ts"
    result = tsc("compile", "--text", program, "-o", line, "--lang", "es")
    assert result.code == 0 and line.read_bytes() == LINE.encode()
    assert f"{program} -> {line}   20 bytes de texto" in result.out
    assert tsc("run", line).out == tsc("run", program).out
    for path in (line, program):
        assert tsc("compile", path).code == 0
    assert line.with_suffix(".bin").read_bytes() == program.with_suffix(".bin").read_bytes()


def test_a_changed_line_does_nothing(tsc: Tsc) -> None:
    for verb in ("run", "check", "fmt", "compile"):
        options = ["-o", "-"] if verb == "compile" else []
        tsc(verb, "-e", LINE.replace("80", "90"), *options).gives(1, "[TS058]", out="")


def test_exceeding_a_level_is_a_mistake_with_its_place(tsc: Tsc) -> None:
    result = tsc("check", "--text-level", "uno", "-e", LONG_PROGRAM)
    assert result.code == 1
    assert "line 256:  S\n" in result.err
    assert (
        "level uno turns this text into 260 bytes of code, 5 too many: it has room for 255"
        in result.err
    )
    data = tsc("check", "--json", "--text-level", "mega", "-e", LONG_PROGRAM)
    assert '"code": "TS309"' in data.out and '"line": 256' in data.out
    assert tsc("check", "-e", LONG_PROGRAM).code == 0


def test_programs_beyond_a_level_are_not_written(tsc: Tsc, tmp_path: Path) -> None:
    target = tmp_path / "line.ts"
    result = tsc("compile", "--text", "--text-level", "esp32", "-e", LONG_PROGRAM, "-o", target)
    assert result.code == 1 and "[TS309]" in result.err and not target.exists()
    assert tsc("compile", "--text", "-e", LONG_PROGRAM, "-o", target).code == 0
    result = tsc("compile", "--text", "-e", "F(2", "-o", tmp_path / "wrong.ts")
    assert result.code == 1 and not (tmp_path / "wrong.ts").exists()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--text-level", "uno"], "--text-level works only with --text."),
        (["--text", "--map", "x.json"], "a line of text has no map"),
        (["--text", "--text-level", "nano"], "--text-level takes uno, mega or esp32, not nano"),
    ],
)
def test_incompatible_options_are_refused(
    tsc: Tsc, program: Path, arguments: list[str], message: str
) -> None:
    tsc("compile", program, *arguments).gives(2, message)
