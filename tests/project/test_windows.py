"""The rules of Windows, as far as they can be tried on another system.

Types for Windows are checked by `mypy --platform win32` in `tools/test.sh`.
"""

from __future__ import annotations

import ctypes
import errno
import io
import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from tests.support.casefile import ROOT
from tests.support.command import Tsc
from tests.support.needs import need
from tests.support.rows import each_row
from tests.support.texts import catalogue_texts as said_in
from tiniscript.base import files
from tiniscript.base.languages import languages
from tiniscript.cli import EXIT_OF_CLOSED_PIPE, streams
from tiniscript.cli.windows_names import has_no_file, is_device

PROGRAM = "SI|F(2, 80)\n"


# -- names


@each_row(
    "name",
    ["con", "CON.bin", "aux.html", "nul.txt", "com1.csv", "lpt9", "COM¹.bin", "x/prn.toml",
     r"C:\x\con.bin", "x.", "x ", "sheet:1.html", "what?.bin", "a\tb", r"d:\x\a:b", "con .bin"],
)  # fmt: skip
def test_reserved_file_names_are_recognized(name: str) -> None:
    assert has_no_file(name)


@each_row(
    "name",
    ["prog.bin", "console.bin", "com.bin", "com10.csv", "C:prog.bin", r"C:\Users\Ana María\p.bin",
     r"..\x\prog.bin", "./prog.bin", r"\\school\pupils\prog.bin", "lpt.bin", "año.bin", ".x"],
)  # fmt: skip
def test_file_names_are_checked(name: str) -> None:
    assert not has_no_file(name)


def test_an_output_name_that_windows_would_lose_is_refused(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from serial.tools import list_ports  # noqa: F401 - it looks at the platform when imported

    monkeypatch.chdir(tmp_path)
    Path("prog.ts").write_text(PROGRAM)
    monkeypatch.setattr(sys, "platform", "win32")
    for language, expected in (("en", "file with this name"), ("es", "este nombre")):
        result = tsc("compile", "prog.ts", "-o", "aux.bin", "--lang", language)
        assert result.code == 2
        assert expected in result.err
    assert not Path("aux.bin").exists()
    assert tsc("compile", "prog.ts", "-o", "good.bin").code == 0


def test_a_device_is_not_a_program(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reading the console or a serial port would wait forever."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x").mkdir()
    names = ("aux.ts", "con", "x/NUL.ts", r"C:\x\com1.txt")
    for name in names:
        (tmp_path / name).write_text(PROGRAM)
    assert tsc("check", *names).code == 0
    monkeypatch.setattr(sys, "platform", "win32")
    for name in names:
        result = tsc("check", name, "--lang", "en")
        assert result.code == 2 and "there is no file" in result.err, name
        assert is_device(name) and not is_device(f"{name}/prog.ts"), name
    assert not is_device("console.ts")


def test_a_pattern_means_its_files(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """cmd and PowerShell hand `*.ts` on as it is; a shell of Unix has looked already."""
    monkeypatch.chdir(tmp_path)
    for name in ("b.ts", "a.ts", "[1].ts", "notes.txt"):
        Path(name).write_text("SI|F(2 80)\n")
    result = tsc("check", "*.ts", "--lang", "en")
    assert result.code == 2 and "there is no file *.ts" in result.err
    from serial.tools import list_ports  # noqa: F401 - it looks at the platform when imported

    monkeypatch.setattr(sys, "platform", "win32")
    assert tsc("check", "--fix", "?.ts", "[1]*.ts", "--lang", "en").code == 0
    for name in ("b.ts", "a.ts", "[1].ts"):
        assert Path(name).read_text() == "SI|F(2, 80)\n"
    result = tsc("check", "*.ts", "b.ts", "--lang", "en")
    assert [line for line in result.out.splitlines() if line.startswith("programs: 3")]
    assert Path("notes.txt").read_text() == "SI|F(2 80)\n"
    result = tsc("check", "*.tini", "--lang", "en")
    assert result.code == 2 and "*.tini" in result.err


# -- texts


def test_a_program_of_notepad_is_the_same_program(
    tsc: Tsc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With CR LF and a byte order mark; mistakes have the same message."""
    monkeypatch.chdir(tmp_path)
    wrong_text = "SI|F(2, 80)\nW(1)\nR(2 60)\n"
    outputs = set()
    for name, bom, end in (("a", "", "\n"), ("b", "\ufeff", "\r\n")):
        for kind, program in (("right", PROGRAM + "B(1, 50)\n"), ("wrong", wrong_text)):
            text = bom + program.replace("\n", end)
            Path(f"{kind}_{name}.ts").write_bytes(text.encode())
        assert tsc("compile", f"right_{name}.ts").code == 0
        result = tsc("check", f"wrong_{name}.ts")
        assert result.code == 1
        outputs.add(result.out + result.err)
    assert Path("right_a.bin").read_bytes() == Path("right_b.bin").read_bytes()
    assert len({output.replace("wrong_b", "wrong_a") for output in outputs}) == 1


# -- outputs that are no terminal


def misread(text: str, encoding: str) -> str:
    """Return a sentence that was written in one encoding and read in another."""
    streams.register()
    return text.encode(encoding, streams.ERROR_HANDLER).decode(encoding)


@each_row("encoding", ["cp1252", "cp850", "cp437"])
def test_every_sentence_can_be_read_in_an_encoding_of_windows(encoding: str) -> None:
    sentences = [sentence for language in languages() for sentence in said_in(language).values()]
    assert len(sentences) > 500
    for sentence in sentences:
        assert "\\u" not in misread(sentence, encoding), sentence


def test_unencodable_characters_are_replaced_by_plain_ones() -> None:
    assert misread("10 kΩ − 5…", "cp850") == "10 kohm - 5..."
    assert misread("10 kΩ − 5…", "cp1252") == "10 kohm - 5…"
    assert misread("┤█│→", "cp1252") == "|#|>"
    assert misread("π", "cp1252") == "\\u03c0"
    assert misread("línea ñ", "cp850") == "línea ñ"


def test_a_wiring_list_goes_through_a_pipe_of_windows() -> None:
    environment = {"PYTHONPATH": str(ROOT / "compiler"), "PYTHONIOENCODING": "cp850"}
    completed = subprocess.run(
        [sys.executable, "-m", "tiniscript", "firmware", "--wiring", "--lang", "es"],
        capture_output=True, env=environment,
    )  # fmt: skip
    assert completed.returncode == 0
    output = completed.stdout.decode("cp850")
    assert "kohm" in output
    assert "\\u" not in output


# -- the system


WITHOUT_UNIX = r"""
import argparse, asyncio, json, os, platform, select, shlex, shutil, signal, socket, ssl, subprocess
import sys, tempfile, threading, uuid, webbrowser
import cobs.cobs, platformdirs, rich.console, rich.live
import serial.tools.list_ports, wasmtime, PIL.Image, bleak, zeroconf, rich.logging
gone = ("termios", "tty", "pty", "fcntl", "readline", "pwd", "grp", "resource", "syslog")
class Missing:
    def find_spec(self, name, path=None, target=None):
        if name in gone:
            raise ModuleNotFoundError(name)
sys.meta_path.insert(0, Missing())
for name in gone:
    sys.modules.pop(name, None)
for name in ("SIGKILL", "SIGHUP", "SIGTSTP", "SIGCONT", "SIGUSR1", "SIGWINCH", "SIGPIPE"):
    delattr(signal, name)
for name in ("killpg", "fork", "getuid", "geteuid", "fchmod", "ttyname", "tcgetpgrp", "openpty",
             "getpgrp", "O_NOFOLLOW", "O_NONBLOCK", "O_NOCTTY", "O_DIRECTORY"):
    delattr(os, name)
sys.platform = "win32"
import pkgutil, importlib, tiniscript
count = 0
for each in pkgutil.walk_packages(tiniscript.__path__, "tiniscript."):
    if each.name in ("tiniscript.__main__", "tiniscript.studio.worker", "tiniscript.vm.page_wasm"):
        continue  # the command itself, and what runs in a browser alone
    if "flash.vm_arduino" not in each.name:
        importlib.import_module(each.name)
        count += 1
assert count > 200, count
from tiniscript.cli import main
commands = [
    ["check", "prog.ts"], ["compile", "prog.ts", "-o", "prog.bin"], ["show", "prog.bin"],
    ["run", "prog.ts"], ["fmt", "--check", "prog.ts"], ["check", "--explain", "TS012"],
    ["firmware", "--wiring", "-o", "wiring.html"],
    ["firmware", "--board", "tinibot", "-o", "own.h"], ["help"],
    ["lesson", "sheet", "1", "-o", "sheet.html"],
]
for words in commands:
    code = main(words)
    assert code == 0, (words, code)
"""


def test_only_unix_modules_use_unix_functions(tmp_path: Path) -> None:
    """Without the modules that Windows lacks, each module can be imported, and commands without a
    robot run."""
    for needed_module in ("wasmtime", "PIL", "bleak", "zeroconf"):
        need("" if find_spec(needed_module) else f"no package {needed_module}")
    (tmp_path / "prog.ts").write_text(PROGRAM)
    completed = subprocess.run(
        [sys.executable, "-c", WITHOUT_UNIX], cwd=tmp_path, capture_output=True, text=True,
        env={"PYTHONPATH": str(ROOT / "compiler"), "HOME": str(tmp_path),
             "PYTHONIOENCODING": "cp1252", "TINISCRIPT_DEBUG": "1"},
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    assert (tmp_path / "wiring.html").stat().st_size > 1000


COARSE_CLOCK_CODE = """\
import math, sys, time
real, rest = time.monotonic, time.sleep
STEP_S = {step_s}
class Clock:
    def __call__(self): return math.floor(real() / STEP_S) * STEP_S
class Sleep:
    def __call__(self, s): return rest(math.ceil(s / STEP_S) * STEP_S if s > 0 else s)
time.monotonic, time.sleep = Clock(), Sleep()
from tiniscript.cli import main
sys.exit(main(["upload", "-e", "SI|F(1, 80)", "--virtual", "--hurry", "10", "--lang", "en"]))
"""


def test_a_clock_that_goes_in_steps_of_16_ms_is_enough(tmp_path: Path) -> None:
    """The clock of Windows before Python 3.13; sleeps also end at its steps."""
    completed = subprocess.run(
        [sys.executable, "-c", COARSE_CLOCK_CODE.format(step_s=1 / 64)], cwd=tmp_path,
        capture_output=True,
        text=True, env={"PYTHONPATH": str(ROOT / "compiler"), "HOME": str(tmp_path)},
    )  # fmt: skip
    assert completed.returncode == 0, completed.stderr
    assert "drove 36 cm in 1.0 s" in completed.stdout, completed.stdout


class Console(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_keys_come_from_the_console(monkeypatch: pytest.MonkeyPatch) -> None:
    from tiniscript.cli.terminal.keys import Keys

    waiting = list("bq")
    console = ModuleType("msvcrt")
    console.kbhit = lambda: bool(waiting)  # type: ignore[attr-defined]
    console.getwch = lambda: waiting.pop(0)  # type: ignore[attr-defined]
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setattr(sys, "stdin", Console())
    monkeypatch.setitem(sys.modules, "msvcrt", console)
    with Keys() as keys:
        assert keys.read_keys() == "bq"
        assert keys.read_keys() == ""
        waiting += "\x03"
        with pytest.raises(KeyboardInterrupt):
            keys.read_keys()


class Kernel:
    """A `kernel32` with console modes, and the bits that each accepts."""

    def __init__(self, mode: int, taken: int) -> None:
        self.mode, self.taken = mode, taken

    def GetConsoleMode(self, handle: ctypes.c_void_p, mode: Any) -> int:  # noqa: N802
        mode._obj.value = self.mode
        return int(handle.value == 42)

    def SetConsoleMode(self, handle: ctypes.c_void_p, mode: ctypes.c_ulong) -> int:  # noqa: N802
        assert handle.value == 42
        if mode.value & ~self.taken:
            return 0
        self.mode = mode.value
        return 1


@pytest.mark.parametrize(
    ("mode_before", "taken", "handle", "is_read", "mode_after"),
    [
        (3, 7, 42, True, 7),  # cmd: it can, and was not asked
        (2, 7, 42, True, 7),
        (7, 7, 42, True, 7),  # PowerShell, the Windows Terminal
        (3, 3, 42, False, 3),  # before Windows 10
        (3, 7, 5, False, 3),  # NUL, which is a terminal to C's library
    ],
)  # fmt: skip
def test_colors_are_for_consoles_that_read_them(
    mode_before: int, taken: int, handle: int, is_read: bool, mode_after: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    kernel = Kernel(mode_before, taken)
    runtime = ModuleType("msvcrt")
    runtime.get_osfhandle = lambda number: handle  # type: ignore[attr-defined]
    monkeypatch.setattr(sys, "platform", "win32")
    monkeypatch.setitem(sys.modules, "msvcrt", runtime)
    monkeypatch.setattr(ctypes, "windll", SimpleNamespace(kernel32=kernel), raising=False)
    monkeypatch.delenv("NO_COLOR", raising=False)
    console = Console()
    assert not streams.reads_sequences(console), "it has no number"
    monkeypatch.setattr(console, "fileno", lambda: 1)
    assert streams.reads_sequences(console) is is_read
    assert kernel.mode == mode_after
    assert streams.has_colors(console) is is_read
    monkeypatch.setenv("NO_COLOR", "1")
    assert not streams.has_colors(console)
    assert not streams.reads_sequences(io.StringIO())


LEFTOVER_CODE = """\
import errno, sys
class Left:
    encoding = "cp1252"
    def write(self, text):
        failure = OSError({number}, "Invalid argument")
        {about} = {value!r}
        raise failure
    def flush(self): pass
    def isatty(self): return False
sys.stdout = Left()
from tiniscript.cli import main
sys.platform = "{platform}"
sys.exit(main(["help"]))
"""


@pytest.mark.parametrize(
    ("platform", "number", "about", "value", "code"),
    [
        ("win32", errno.EINVAL, "other", None, EXIT_OF_CLOSED_PIPE),
        ("win32", errno.EINVAL, "failure.filename", "a.bin", 2),
        ("win32", errno.EINVAL, "failure.winerror", 87, 2),
        ("win32", errno.ENOSPC, "other", None, 2),
        ("linux", errno.EINVAL, "other", None, 2),
    ],
)
def test_a_closed_reader_is_not_an_error(
    platform: str, number: int, about: str, value: object, code: int
) -> None:
    """`tsc help | more`, and then q: the C library of Windows calls that an invalid argument."""
    script = LEFTOVER_CODE.format(platform=platform, number=number, about=about, value=value)
    completed = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True,
        env={"PYTHONPATH": str(ROOT / "compiler"), "LC_ALL": "C.UTF-8"},
    )  # fmt: skip
    assert completed.returncode == code
    assert bool(completed.stderr) is (code != EXIT_OF_CLOSED_PIPE), completed.stderr


# -- files


@pytest.mark.parametrize("opened_s", [0.1, 60.0])  # times of a clock that advances only by sleeping
def test_a_file_that_is_open_elsewhere_is_replaced_a_moment_later(
    opened_s: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A virus scanner opens a newly written file; a spreadsheet keeps it open."""
    path = tmp_path / "keys.json"
    path.write_bytes(b"old")
    now_s, tries = [0.0], [0]
    real_replace = Path.replace

    def replace(self: Path, target: Path) -> Path:
        tries[0] += 1
        if now_s[0] < opened_s:
            raise PermissionError(13, "in use")
        return real_replace(self, target)

    monkeypatch.setattr(Path, "replace", replace)

    def skip_seconds(seconds: float) -> None:
        now_s[0] += seconds

    monkeypatch.setattr(files, "monotonic", lambda: now_s[0])
    monkeypatch.setattr(files, "sleep", skip_seconds)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(PermissionError):
        files.replace(path, b"new")  # other systems do not wait
    assert (tries, now_s) == ([1], [0.0])
    monkeypatch.setattr(sys, "platform", "win32")
    if opened_s > 1:
        with pytest.raises(PermissionError):
            files.replace(path, b"new")
    else:
        files.replace(path, b"new")
    assert now_s[0] == pytest.approx(min(opened_s, files.REPLACE_WAIT_S), abs=0.03)
    assert tries[0] == 2 + round(now_s[0] / 0.02)
    assert path.read_bytes() == (b"old" if opened_s > 1 else b"new")
    assert [path.name for path in tmp_path.iterdir()] == ["keys.json"]


def test_programs_on_a_command_line_stand_in_double_quotes() -> None:
    """PowerShell, cmd and every shell take those; cmd hands single ones on to tsc."""
    sentences = [sentence for language in languages() for sentence in said_in(language).values()]
    pages = [*ROOT.glob("README*.md"), *ROOT.glob("docs/*/*.md"), *ROOT.glob("tools/try*")]
    sentences += [page.read_text(encoding="utf-8") for page in pages]
    assert not [
        command
        for sentence in sentences
        for command in re.findall(r"(?:-e|tsc live) '[^']*'", sentence)
    ]
