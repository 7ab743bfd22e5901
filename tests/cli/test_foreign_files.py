"""No command writes over a file that tsc has not made, and each may write over its own."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.support.command import Tsc, inside
from tests.support.pty_robot import PtyRobot, on
from tiniscript.cli.paths import is_foreign

PROGRAM = "SI|F(0.1, 50)"
FOREIGN = (
    b"a letter", b"\0", b"TS", b"TSV\tfile", b"\x89PNG\r\n\x1a\n a photo", b"\xff\xd8\xff\xe0 JPEG",
    b"// by hand", b"{}", b'{"version": "1"}', b"ms;event;value\n", b"<!DOCTYPE html><p>mine</p>",
    b"F(1,2)~1234567", b"a\nF(1,2)~12345678\n",
    "\ufeffarchivo;resultado;mundo;frase;nota\na.ts;listo;;;18\n".encode(),
    "\ufefffile,verdict,seed,sentence,mark\r\n".encode(),
    "\ufefffile,mistakes,warnings,repaired,line,code,message;\n".encode(),
)  # fmt: skip
WRITERS = [
    (("compile", "-e", PROGRAM, "-o"), "-o"),
    (("compile", "-e", PROGRAM, "--text", "-o"), "-o"),
    (("compile", "-e", PROGRAM, "-o", "a.bin", "--map"), "--map"),
    (("wiring", "-o"), "-o"),
    (("board", "tinibot", "-o"), "-o"),
    (("show", "--arduino", "-e", PROGRAM, "-o"), "-o"),
]


@pytest.mark.parametrize(("words", "option"), WRITERS, ids=lambda each: str(each))
def test_a_foreign_file_stays_and_an_own_one_is_replaced(
    tsc: Tsc, here: Path, words: tuple[str, ...], option: str
) -> None:
    target = here / "there"
    assert tsc(*words, target).code == 0  # nothing is there
    made = target.read_bytes()
    assert made and not is_foreign(target)
    assert tsc(*words, target).code == 0  # its own
    target.write_bytes(b"")
    assert tsc(*words, target).code == 0  # nothing to lose
    assert target.read_bytes() == made
    for content in FOREIGN:
        target.write_bytes(content)
        for lang, said in (("en", "tsc has not made it"), ("es", "no lo hizo tsc")):
            tsc(*words, target, "--lang", lang).gives(2, said, option)
        assert target.read_bytes() == content


@pytest.mark.parametrize("lang", ["es", "en"])
def test_a_table_with_a_column_of_the_teacher_stays(tsc: Tsc, tmp_path: Path, lang: str) -> None:
    folder, table = tmp_path / "class", tmp_path / "marks.csv"
    folder.mkdir()
    (folder / "ana.ts").write_text(PROGRAM)
    words = ("check", folder, "--lang", lang, "--csv", table)
    assert tsc(*words).code == 0
    made = table.read_bytes()
    table.write_bytes(made.replace(b"\n", b"\r\n"))  # a spreadsheet has kept it
    assert tsc(*words).code == 0 and table.read_bytes() == made
    marked = made.replace(b"\n", b";18\n")
    table.write_bytes(marked)
    tsc(*words).gives(2, "--csv")
    assert table.read_bytes() == marked


def test_the_image_that_nobody_names_spares_a_foreign_file(tsc: Tsc, tmp_path: Path) -> None:
    program, beside = tmp_path / "photo.ts", tmp_path / "photo.bin"
    program.write_text(PROGRAM)
    beside.write_bytes(b"a firmware of something else")
    tsc("compile", program).gives(2, "tsc has not made it")
    assert beside.read_bytes() == b"a firmware of something else"
    beside.unlink()
    assert tsc("compile", program).code == tsc("compile", program).code == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such pipes")
def test_a_link_leads_to_a_foreign_file_and_a_pipe_is_none(tsc: Tsc, tmp_path: Path) -> None:
    letter, link = tmp_path / "letter", tmp_path / "link"
    letter.write_bytes(b"a letter")
    link.symlink_to(letter)
    assert tsc("compile", "-e", PROGRAM, "-o", link).code == 2
    assert letter.read_bytes() == b"a letter"
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert not is_foreign(pipe)  # it would be waited for


def test_a_picture_and_rows(tmp_path: Path) -> None:
    picture = tmp_path / "way.png"
    for _ in range(2):
        assert inside("robot", "--for", "0.1", "--hurry", "max", "--plot", picture).code == 0
        assert not is_foreign(picture)


def test_rows_of_a_monitor(pty_robot: PtyRobot, tmp_path: Path) -> None:
    rows, letter = tmp_path / "rows.csv", tmp_path / "letter.csv"
    letter.write_bytes(b"a;b\n1;2\n")
    for _ in range(2):
        assert on(pty_robot, "monitor", "--csv", rows, "--max-time", "1").code == 0
        assert rows.read_bytes() == b"ms,event,value\n"
    on(pty_robot, "monitor", "--csv", letter, "--max-time", "1").gives(2, "tsc has not made it")
    assert letter.read_bytes() == b"a;b\n1;2\n"
