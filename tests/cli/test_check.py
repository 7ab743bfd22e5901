"""`tsc check` for several programs and folders, and `--fix`: files, output and exit codes."""

from __future__ import annotations

import csv
import json
import os
from io import StringIO
from itertools import product
from pathlib import Path

import pytest

from tests.support.command import Tsc

RIGHT_PROGRAM, WRONG_PROGRAM = "SI|F(2, 80)\n", "SI|F(2 80)\n"
LEFT = "SI|F(2 80);girar(derecha, 90)\n"  # the first repair is certain, the second is not


@pytest.fixture
def folder(working_folder: Path) -> Path:
    (working_folder / "a.ts").write_text(RIGHT_PROGRAM, encoding="utf-8")
    (working_folder / "b.ts").write_text(WRONG_PROGRAM, encoding="utf-8")
    (working_folder / "sub").mkdir()
    (working_folder / "sub" / "c.ts").write_text(LEFT, encoding="utf-8")
    (working_folder / "sub" / "notes.txt").write_text("no program", encoding="utf-8")
    return working_folder


# -- several programs ---------------------------------------------------------------------------


def test_a_folder_has_a_line_for_each_program_and_a_table(folder: Path, tsc: Tsc) -> None:
    result = tsc("check", ".", "--lang", "es").gives(1)
    assert result.out == (
        "./a.ts: sin errores\n"
        "./b.ts: línea 1: Entre dos valores va una coma.   [TS017]\n"
        "./sub/c.ts: línea 1: Entre dos valores va una coma.   [TS017]\n"
        "\n"
        "programa     errores   avisos   primero\n"
        "./a.ts             0        0\n"
        "./b.ts             1        0   1: TS017\n"
        "./sub/c.ts         2        0   1: TS017\n"
        "programas: 3, sin errores: 1\n"
    )


def test_correct_programs_give_exit_code_0_and_are_checked_once(folder: Path, tsc: Tsc) -> None:
    """A single program has no table; a folder may be empty."""
    result = tsc("check", "a.ts", "./a.ts", "a.ts")
    assert (result.code, result.out.count("no mistakes")) == (0, 1)
    result = tsc("check", "a.ts", "--csv", "t.csv")
    assert (result.code, (folder / "t.csv").exists()) == (2, False)
    assert "--csv is for several programs or a folder" in result.err
    (folder / "empty").mkdir()
    result = tsc("check", "empty").gives(2, out="")
    assert result.err.startswith(
        "tsc: there is no program in empty. Names of programs end in .ts or .tini."
    )


def test_the_table_as_data_and_for_a_spreadsheet(folder: Path, tsc: Tsc) -> None:
    """Its messages are those of the command, except for an initial sign that begins a formula."""
    (folder / "=1+1.ts").write_text(RIGHT_PROGRAM, encoding="utf-8")
    (folder / "d.ts").write_text("SI|F(2, =X)", encoding="utf-8")
    (folder / "e.ts").write_text("SI|+F(2,80)", encoding="utf-8")
    result = tsc("check", "=1+1.ts", "b.ts", "d.ts", "e.ts", "--json", "--csv", "table.csv")
    rows = json.loads(result.out)
    assert [(row["file"], row["mistakes"], row["problem"]) for row in rows[:2]] == [
        ("=1+1.ts", 0, ""),
        ("b.ts", 1, ""),
    ]
    assert rows[1]["messages"][0]["fix"] == "F(2, 80)"
    table = list(csv.DictReader(StringIO((folder / "table.csv").read_text("utf-8-sig"))))
    assert [row["file"] for row in table] == ["'=1+1.ts", "b.ts", "d.ts", "e.ts"]
    assert (table[1]["mistakes"], table[1]["line"], table[1]["code"]) == ("1", "1", "TS017")
    messages = [row["messages"][0]["message"] for row in rows[2:]]
    assert [row["message"] for row in table[2:]] == [messages[0], f"'{messages[1]}"]


def test_a_spreadsheet_in_spanish_has_semicolons_and_may_be_written_again(
    folder: Path, tsc: Tsc
) -> None:
    for _ in range(2):
        tsc("check", "a.ts", "b.ts", "--lang", "es", "--csv", "tabla.csv").gives(1)
    table = StringIO((folder / "tabla.csv").read_text("utf-8-sig"))
    first_row, second_row = csv.DictReader(table, delimiter=";")
    assert (first_row["archivo"], first_row["errores"], first_row["mensaje"]) == ("a.ts", "0", "")
    assert (second_row["errores"], second_row["línea"], second_row["código"]) == ("1", "1", "TS017")


def test_an_unreadable_file_has_its_row_and_gives_exit_code_2(folder: Path, tsc: Tsc) -> None:
    result = tsc("check", "a.ts", "none.ts", "b.ts")
    assert result.code == 2
    assert "none.ts: there is no file none.ts" in result.out
    assert "none.ts          -          -   not read\n" in result.out
    assert "b.ts: line 1" in result.out


def test_other_contents_of_a_folder_do_no_harm(folder: Path, tsc: Tsc) -> None:
    (folder / "x\n\x1b[31m.ts").write_text(RIGHT_PROGRAM, encoding="utf-8")
    (folder / "bytes.ts").write_bytes(b"\0\xff")
    (folder / ".hidden.ts").write_text(WRONG_PROGRAM, encoding="utf-8")
    (folder / "loop").symlink_to(".")
    (folder / "dangling.ts").symlink_to("nowhere")
    os.mkfifo(folder / "pipe.ts")
    result = tsc("check", ".").gives(2)
    assert "\x1b" not in result.out
    assert ".hidden" not in result.out
    assert "./x??[31m.ts: no mistakes" in result.out
    assert "./bytes.ts: line 1: This file is not text" in result.out
    assert "./pipe.ts is not a text file" in result.out
    assert "./dangling.ts: there is no file" in result.out


def test_thirty_programs_and_deep_folders(folder: Path, tsc: Tsc) -> None:
    deep_folder = folder
    for k in range(30):
        deep_folder = deep_folder / "d"
        deep_folder.mkdir()
        (deep_folder / f"p{k}.ts").write_text(
            WRONG_PROGRAM if k % 2 else RIGHT_PROGRAM, encoding="utf-8"
        )
    result = tsc("check", "d").gives(1)
    assert result.out.endswith("programs: 30, free of mistakes: 15\n")


# -- repairs ------------------------------------------------------------------------------------


def test_fix_writes_the_sure_repairs_and_reports_the_remaining_mistakes(
    folder: Path, tsc: Tsc
) -> None:
    """Twice is once."""
    result = tsc("check", "--fix", "sub/c.ts", "--lang", "es").gives(1)
    once = (folder / "sub" / "c.ts").read_bytes()
    assert once == b"SI|F(2, 80);girar(derecha, 90)\n"
    assert result.out == (
        "--- sub/c.ts\n+++ sub/c.ts\n@@ -1,2 +1,2 @@\n"
        "-SI|F(2 80);girar(derecha, 90)\n+SI|F(2, 80);girar(derecha, 90)\n \n"
    )
    assert result.err.startswith(
        "sub/c.ts: 1 error corregido.\n"
        "El resto, tsc no lo puede corregir con seguridad. Corrígelo tú:\n"
    )
    assert "la palabra es R" in result.err
    result = tsc("check", "--fix", "sub/c.ts")
    assert ((folder / "sub" / "c.ts").read_bytes(), result.out) == (once, "")
    assert "tsc cannot safely repair anything here." in result.err


@pytest.mark.parametrize("option", ["--diff", "--dry-run"])
def test_showing_the_difference_writes_nothing(folder: Path, tsc: Tsc, option: str) -> None:
    """Without a file, the program is printed."""
    for options in ([option], ["--fix", option]):
        result = tsc("check", *options, "b.ts")
        assert (folder / "b.ts").read_text("utf-8") == WRONG_PROGRAM
        assert result.code == 1
        assert "-SI|F(2 80)\n+SI|F(2, 80)\n" in result.out
        assert result.err == "b.ts: 1 mistake can be repaired. Try:  tsc check --fix\n"
    result = tsc("check", "--fix", "-e", "F(2 80)")
    assert (result.code, result.out) == (0, "F(2, 80)")


def test_a_file_keeps_its_line_ends_and_its_mark(folder: Path, tsc: Tsc) -> None:
    for end, bom, has_last in product(("\n", "\r\n", "\r"), (b"", b"\xef\xbb\xbf"), (False, True)):
        last_line_end = end if has_last else ""
        text = f"SI|F(2 80) // ñandú{end}{end}\tR(1,5, 60){last_line_end}"
        (folder / "b.ts").write_bytes(bom + text.encode())
        assert tsc("check", "--fix", "b.ts").code == 0, (end, bom, last_line_end)
        repaired_text = f"SI|F(2, 80) // ñandú{end}{end}\tR(1.5, 60){last_line_end}"
        assert (folder / "b.ts").read_bytes() == bom + repaired_text.encode()


def test_binary_data_and_a_line_with_a_checksum_stay_as_they_are(folder: Path, tsc: Tsc) -> None:
    for data, code in ((b"F(2 80)\xff", "TS003"), (b"SI|F(2 80);S~21FFE748\n", "TS")):
        (folder / "b.ts").write_bytes(data)
        result = tsc("check", "--fix", "b.ts")
        assert (result.code, (folder / "b.ts").read_bytes()) == (1, data)
        assert code in result.err


def test_notepad_s_unicode_is_text_in_another_encoding(tmp_path: Path, tsc: Tsc) -> None:
    """PowerShell's > writes this encoding too; `explain TS003` names it and the remedy."""
    path = tmp_path / "unicode.ts"
    for encoding, mark in (("utf-16", ""), ("utf-16-be", "\ufeff"), ("utf-16-le", "\ufeff")):
        path.write_bytes((mark + RIGHT_PROGRAM).encode(encoding))
        assert "TS003" in tsc("check", path).err, encoding
    path.write_bytes(
        RIGHT_PROGRAM.encode("utf-16-le")
    )  # without a byte order mark, it may be anything
    assert "TS002" in tsc("check", path).err


def test_a_file_that_cannot_be_written_is_as_it_was(
    folder: Path, tsc: Tsc, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail_full_disk(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("tiniscript.base.files.replace", fail_full_disk)
    result = tsc("check", "--fix", "b.ts")
    assert (result.code, (folder / "b.ts").read_text("utf-8")) == (2, WRONG_PROGRAM)
    assert (
        "b.ts cannot be written: No space left on device. The file stays as it was." in result.err
    )
    tsc("check", "--fix", "b.ts", "a.ts").gives(2, out="a.ts: no mistakes")


def test_a_folder_is_repaired_with_a_column_of_its_own(folder: Path, tsc: Tsc) -> None:
    result = tsc("check", "--fix", ".")
    assert result.code == 1
    assert "program      mistakes   warnings   repaired   first\n" in result.out
    assert "./b.ts              0          0          1\n" in result.out
    assert "./sub/c.ts          1          0          1   1: TS121\n" in result.out
    assert (folder / "b.ts").read_text("utf-8") == "SI|F(2, 80)\n"
