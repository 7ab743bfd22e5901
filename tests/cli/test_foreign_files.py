"""No command writes over a file that tsc has not made, and each may write over its own."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.command import TSC, Tsc, run_in_process
from tests.support.pty_robot import PtyRobot, on
from tests.support.rows import each_row
from tests.support.waiting import HANG_LIMIT_S
from tiniscript.cli.paths import is_foreign

PROGRAM = "SI|F(0.1, 50)"
FOREIGN_CONTENTS = (
    b"a letter", b"\0", b"TS", b"TSV\tfile", b"\x89PNG\r\n\x1a\n a photo", b"\xff\xd8\xff\xe0 JPEG",
    b"// by hand", b"{}", b'{"version": "1"}', b"ms;event;value\n", b"<!DOCTYPE html><p>mine</p>",
    b"F(1,2)~1234567", b"a\nF(1,2)~12345678\n",
    "\ufeffarchivo;resultado;mundo;frase;nota\na.ts;listo;;;18\n".encode(),
    "\ufefffile,verdict,seed,sentence,mark\r\n".encode(),
    "\ufefffile,mistakes,warnings,repaired,line,code,message;\n".encode(),
)  # fmt: skip
WRITING_COMMANDS = [
    (("compile", "-e", PROGRAM, "-o"), "-o"),
    (("compile", "-e", PROGRAM, "--text", "-o"), "-o"),
    (("compile", "-e", PROGRAM, "-o", "a.bin", "--map"), "--map"),
    (("firmware", "--wiring", "-o"), "-o"),
    (("firmware", "--board", "tinibot", "-o"), "-o"),
    (("show", "--arduino", "-e", PROGRAM, "-o"), "-o"),
]


@pytest.mark.parametrize(("words", "option"), WRITING_COMMANDS, ids=lambda value: str(value))
def test_a_foreign_file_is_kept_and_a_generated_one_is_replaced(
    tsc: Tsc, working_folder: Path, words: tuple[str, ...], option: str
) -> None:
    target = working_folder / "there"
    assert tsc(*words, target).code == 0  # the file does not exist
    bytes_before = target.read_bytes()
    assert bytes_before and not is_foreign(target)
    assert tsc(*words, target).code == 0  # the file is its own
    target.write_bytes(b"")
    assert tsc(*words, target).code == 0  # there is nothing to lose
    assert target.read_bytes() == bytes_before
    for content in FOREIGN_CONTENTS:
        target.write_bytes(content)
        for lang, expected in (("en", "tsc did not write it."), ("es", "no lo hizo tsc")):
            tsc(*words, target, "--lang", lang).gives(2, expected, option)
        assert target.read_bytes() == content


@pytest.mark.parametrize("lang", ["es", "en"])
def test_a_table_with_a_teachers_column_is_kept(tsc: Tsc, tmp_path: Path, lang: str) -> None:
    folder, table = tmp_path / "class", tmp_path / "marks.csv"
    folder.mkdir()
    (folder / "ana.ts").write_text(PROGRAM)
    words = ("check", folder, "--lang", lang, "--csv", table)
    assert tsc(*words).code == 0
    bytes_before = table.read_bytes()
    table.write_bytes(bytes_before.replace(b"\n", b"\r\n"))  # a spreadsheet has kept it
    assert tsc(*words).code == 0 and table.read_bytes() == bytes_before
    marked_bytes = bytes_before.replace(b"\n", b";18\n")
    table.write_bytes(marked_bytes)
    tsc(*words).gives(2, "--csv")
    assert table.read_bytes() == marked_bytes


def test_the_default_image_path_spares_a_foreign_file(tsc: Tsc, tmp_path: Path) -> None:
    program, neighbour_path = tmp_path / "photo.ts", tmp_path / "photo.bin"
    program.write_text(PROGRAM)
    neighbour_path.write_bytes(b"a firmware of something else")
    tsc("compile", program).gives(2, "tsc did not write it.")
    assert neighbour_path.read_bytes() == b"a firmware of something else"
    neighbour_path.unlink()
    assert tsc("compile", program).code == tsc("compile", program).code == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such pipes")
@each_row(
    "words",
    [
        ["check", "{pipe}.ts"], ["run", "{pipe}.ts"], ["compile", "{pipe}.ts", "-o", "-"],
        ["fmt", "--check", "{pipe}.ts"], ["show", "{pipe}.ts"],
        ["upload", "{pipe}.ts", "--virtual"], ["check", "-e", "S", "--robot", "{pipe}.toml"],
        ["upload", "-e", "S", "--virtual", "--world", "{pipe}.toml"],
        ["robot", "--memory", "{pipe}"], ["lesson", "check", "1", "{pipe}.ts"],
        ["lesson", "show", "{lesson}"], ["run", "-e", "S", "--replay", "{pipe}"],
    ],
)  # fmt: skip
def test_a_pipe_in_a_folder_is_not_a_file(words: list[str], tmp_path: Path) -> None:
    """The pipe has no writer, so opening it would block forever."""
    for name in ("pipe", "pipe.ts", "pipe.toml", "lesson.toml"):
        (tmp_path / name).unlink(missing_ok=True)
        os.mkfifo(tmp_path / name)
    filled_words = [word.format(pipe=tmp_path / "pipe", lesson=tmp_path) for word in words]
    completed = subprocess.run(
        [*TSC, *filled_words], capture_output=True, text=True, timeout=HANG_LIMIT_S
    )
    assert (
        completed.returncode == 2 and completed.stderr.startswith("tsc: ")
    ) or "cannot" in completed.stderr


@pytest.mark.skipif(not Path("/dev/fd").is_dir(), reason="this system has no /dev/fd")
def test_a_pipe_of_the_shell_is_read() -> None:
    line = f"{sys.executable} -m tiniscript check <(echo 'SI|S')"
    completed = subprocess.run(
        ["bash", "-c", line], capture_output=True, text=True, timeout=HANG_LIMIT_S
    )
    assert (completed.returncode, completed.stderr) == (0, "")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has other permissions")
def test_nobody_else_reads_the_programs_in_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    maps = tmp_path / "tiniscript" / "maps"
    maps.mkdir(parents=True)
    maps.chmod(0o755)  # permissions of an older tsc
    (tmp_path / "p.ts").write_text("SI|S // mine")
    assert run_in_process("compile", tmp_path / "p.ts").code == 0
    (file,) = maps.iterdir()
    assert "mine" in file.read_text()
    assert [stat.S_IMODE(path.stat().st_mode) for path in (maps, file)] == [0o700, 0o600]


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="Windows has no such pipes")
def test_a_link_to_a_foreign_file_is_refused_and_a_pipe_is_not_foreign(
    tsc: Tsc, tmp_path: Path
) -> None:
    letter, link = tmp_path / "letter", tmp_path / "link"
    letter.write_bytes(b"a letter")
    link.symlink_to(letter)
    assert tsc("compile", "-e", PROGRAM, "-o", link).code == 2
    assert letter.read_bytes() == b"a letter"
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    assert not is_foreign(pipe)  # opening the pipe would block


def test_pictures_and_tables_spare_foreign_files(tmp_path: Path) -> None:
    picture = tmp_path / "way.png"
    for _ in range(2):
        assert (
            run_in_process("robot", "--for", "0.1", "--hurry", "max", "--plot", picture).code == 0
        )
        assert not is_foreign(picture)


def test_monitor_output_spares_a_foreign_file(pty_robot: PtyRobot, tmp_path: Path) -> None:
    rows, letter = tmp_path / "rows.csv", tmp_path / "letter.csv"
    letter.write_bytes(b"a;b\n1;2\n")
    rows.write_bytes(b"ms,event,value\n5,SHOW,1\n")  # permissions of an older tsc
    for _ in range(2):
        assert on(pty_robot, "monitor", "--csv", rows, "--max-time", "1").code == 0
        assert rows.read_bytes() == b"ms,event,value,name\n"
    on(pty_robot, "monitor", "--csv", letter, "--max-time", "1").gives(2, "tsc did not write it.")
    assert letter.read_bytes() == b"a;b\n1;2\n"
