"""What is tried with Windows' Python: what a teacher and a pupil do there.

A try returns a sentence about what was seen, and raises Failed with what was not as it should be.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from tools import ROOT
from tools.windows.computer import CODEPAGE, VERSION, Computer, Done

WORD = "María Ñ"  # in the names of folders
PROGRAM = "SI|F(2, 80);SHOW(7)\n"
SLOW_S = 900.0
STOPPED = "Detenido: el robot lo ha confirmado."
CONFIRMED = "lo ha confirmado"
HELD = """\
import sys
with open(sys.argv[1], "rb") as file:
    print("held", flush=True)
    sys.stdin.read()
"""
LEFT = """\
import subprocess, sys
words = [sys.executable, "-m", "tiniscript", "run", "-e", "LOOP(100000);SHOW(1);END_LOOP"]
with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
    running.stdout.readline()
    running.stdout.close()
    said = running.stderr.read()
print(running.returncode, said)
"""
# Tests that ask nothing of Unix, and take no hours on wine.
TESTS = ("tests/syntax", "tests/robots")
LESSON_1 = "F(5, 40)\n"


class Failed(Exception):
    """Something is not as it should be; says how that was seen."""


class Place(NamedTuple):
    """A computer on which `tsc` is installed, the wheel, and a folder for the tries."""

    computer: Computer
    wheel: Path
    desk: Path

    @property
    def installed(self) -> Path:
        return self.computer.home / "TiniScript" / "tsc" / "Scripts"

    def tsc(self, *words: str, **more: str) -> Done:
        return self.computer.run([str(self.installed / "tsc.exe"), *words], self.desk, more)

    def script(self, text: str, *words: str) -> list[str]:
        path = self.desk / "script.py"
        path.write_text(text, encoding="utf-8")
        return [str(self.installed / "python.exe"), "script.py", *words]


def install(place: Place) -> str:
    """The stick for Windows is made here, and its start.bat run there, without PyPI."""
    stick = place.computer.drive / f"Memoria USB {WORD}"
    for old in (stick, place.computer.home / "TiniScript"):
        shutil.rmtree(old, ignore_errors=True)
    words = ["--system", "windows", "--python", VERSION, "--no-firmware", "--no-installer"]
    made = subprocess.run(
        [sys.executable, "-m", "tools.builds.usb_stick", str(stick), *words,
         "--wheel", str(place.wheel)],
        cwd=ROOT, capture_output=True, text=True,
    )  # fmt: skip
    _need(made.returncode == 0, f"no stick: {made.stderr.strip()[-300:]}")
    done = place.computer.run(
        ["cmd", "/c", f"C:\\{stick.name}\\start.bat"], limit_s=SLOW_S,
        encoding=CODEPAGE,
    )  # fmt: skip
    _need((place.installed / "tsc.exe").is_file(), f"start.bat: {done.said[-500:]}")
    said = place.tsc("--version").said
    _need(said.startswith("tsc (TiniScript)"), f"tsc --version: {said!r}")
    return "start.bat has installed tsc from a stick whose name has a space, í and Ñ"


def first_line(place: Place) -> str:
    """README's line, in a folder with spaces and ñ."""
    root = place.computer.home / "Desktop" / f"{WORD} robots" / "tiniscript 0.2"
    listed = subprocess.run(
        ["git", "ls-files", "-z", "compiler", "examples", "tools", "vm_arduino", "*.toml", "*.py",
         "*.in", "README.md", "LICENSE"],
        cwd=ROOT, capture_output=True, check=True,
    )  # fmt: skip
    for name in filter(None, listed.stdout.decode().split("\0")):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, root / name)
    done = place.computer.run(["py", "-3", r"tools\try.py"], root, limit_s=SLOW_S)
    _need(done.code == 0, f"it ends with {done.code}: {done.said[-500:]}")
    driven = re.search(r"recorrió (\d+) cm en 30\.0 s y no tocó nada", done.said)
    _need(driven is not None, f"it says: {done.said[-500:]}")
    _need((root / "way.png").stat().st_size > 1000, "there is no way.png")
    assert driven is not None
    return f"py tools\\try.py sets .venv up from PyPI; the robot drives {driven[1]} cm"


def programs(place: Place) -> str:
    """The images and sentences of each example are those of this computer."""
    examples = sorted((ROOT / "examples").glob("*.ts"))
    for example in examples:
        for end in ("\n", "\r\n"):
            text = example.read_text(encoding="utf-8").replace("\n", end)
            (place.desk / example.name).write_bytes(text.encode())
            verb = ["compile", example.name, "-o", "there.bin"]
            there = place.tsc(*verb)
            here = _here(place.desk, *verb[:3], "here.bin")
            _need(there.code == here.code == 0, f"{verb}: {there.said}")
            same = (place.desk / "there.bin").read_bytes() == (place.desk / "here.bin").read_bytes()
            _need(same, f"{example.name}: another image")
            there, here = (of("check", verb[1]) for of in (place.tsc, place_here(place)))
            _need(there == here, f"check {example.name}:\n{there.said}\n{here.said}")
    done = place.tsc("check", "obst*.ts")
    _need("obstacle_until.ts" in done.said, f"a pattern: {done.said}")
    return f"{len(examples)} examples, with LF and CR LF: the same images and sentences as here"


def repairs(place: Place) -> str:
    """`tsc check --fix` keeps the line ends and the byte order mark of Notepad."""
    path = place.desk / "añil.ts"
    path.write_bytes("\ufeff// línea\r\nSI|F(2 80)\r\n".encode())
    done = place.tsc("check", "--fix", "añil.ts")
    found = path.read_bytes()
    _need(found == "\ufeff// línea\r\nSI|F(2, 80)\r\n".encode(), f"{found!r} {done.said}")
    _need(done.code == 0 and "1 error corregido" in done.said, done.said)
    return "check --fix keeps CR LF and the byte order mark"


def encodings(place: Place) -> str:
    """Files and pipes of cmd, in the code pages of Spanish."""
    for codepage in ("cp1252", "cp850"):
        words = ["cmd", "/c", "tsc wiring --lang es > cable.txt"]
        more = {"PYTHONIOENCODING": codepage, "WINEPATH": _windows(place.installed)}
        place.computer.run(words, place.desk, more)
        said = (place.desk / "cable.txt").read_bytes().decode(codepage)
        for word in ("10 kohm", "batería", "botón"):
            _need(word in said, f"{codepage}: no {word} in {said[:300]}")
        _need("?" not in said and "\\u" not in said, f"{codepage}: {said[:300]}")
    words = ["cmd", "/c", "set LC_ALL=& set LANG=& tsc check mal.ts"]
    (place.desk / "mal.ts").write_text("SI|F(2 80)\n")
    done = place.computer.run(words, place.desk, {"WINEPATH": _windows(place.installed)})
    _need("línea 1:" in done.said, f"without LANG: {done.said}")
    return "cp1252 and cp850 can be read; Windows' own language is followed"


def machines(place: Place) -> str:
    """Both machines, and what a lesson says, are those of this computer."""
    (place.desk / "prog.ts").write_text(PROGRAM)
    text = "F(1, 80) UNTIL(DISTANCE < 10); X = 10 / 4; SHOW(X); R(0.5, 60)"
    for machine in ("python", "cpp"):
        words = ("run", "-e", text, "--machine", machine, "--sensor", "DISTANCE=50,30,9")
        there, here = place.tsc(*words), place_here(place)(*words)
        _need(there == here and there.code == 0, f"{machine}:\n{there.said}\n{here.said}")
    (place.desk / "answer.ts").write_text(LESSON_1, encoding="utf-8")
    for name in ("answer.ts", "prog.ts"):
        there, here = (of("lesson", "check", "1", name) for of in (place.tsc, place_here(place)))
        _need(there == here, f"lesson check {name}:\n{there.said}\n{here.said}")
    return "run on both machines, and lesson check, say what they say here"


def virtual_robot(place: Place) -> str:
    """One command is the robot, others upload and stop; Ctrl-C stops one of theirs."""
    (place.desk / "prog.ts").write_text(PROGRAM)
    words = [str(place.installed / "tsc.exe"), "robot", "--listen", "0", "--name", "Ñandú"]
    with place.computer.running(words, place.desk) as robot:
        assert robot.stdout is not None
        port = robot.stdout.readline().decode().strip()
        _need(port.startswith("socket://"), f"robot: {port!r}")
        done = place.tsc("upload", "prog.ts", "--port", port)
        _need(done.code == 0 and "7" in done.said, f"upload: {done.said}")
        done = place.tsc(
            "upload", "-e", "SI|LOOP(FOREVER);F(1,50);END_LOOP", "--virtual", "--detach"
        )
        _need(done.code == 0, f"upload --detach: {done.said}")
        done = place.tsc("stop", "--virtual")
        _need(done.code == 0 and CONFIRMED in done.said, f"stop: {done.said}")
    endless = ["upload", "obstacle_until.ts", "--virtual"]
    done = place.computer.at_a_console(
        [str(place.installed / "tsc.exe"), *endless], place.desk, "en marcha", "\x03"
    )
    _need(done.code == 2 and STOPPED in done.said, f"Ctrl-C: {done.code} {done.said[-300:]}")
    return "robot, upload, upload --detach and stop over TCP; Ctrl-C at a console stops it"


def serial_port(place: Place) -> str:
    """COM15 is a pseudo-terminal of this computer, with the virtual robot at its other end.

    wine 8 calls it a failure when nothing has come for a while, and pyserial believes it: what
    takes longer than a stop ends there.
    """
    command = [sys.executable, "-m", "tiniscript", "robot", "--pty", "--listen", "0"]
    with subprocess.Popen(
        command, cwd=place.desk, env=_own_variables(place.desk), stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL, text=True,
    ) as robot:  # fmt: skip
        try:
            assert robot.stdout is not None
            robot.stdout.readline()
            link = place.computer.prefix / "dosdevices" / "com15"
            link.unlink(missing_ok=True)
            link.symlink_to(robot.stdout.readline().strip())
            done = place.tsc("stop", "--port", "com15")
            _need(done.code == 0 and CONFIRMED in done.said, f"stop: {done.said}")
        finally:
            robot.terminate()
    done = place.tsc("stop", "--port", "COM77")
    _need(done.code == 3 and "COM77" in done.said, f"no port: {done.said}")
    return "COM15 and com15: a robot that stops; COM77, which is not there, is said"


def files(place: Place) -> str:
    """What Windows does not let be written is said, and the old file stays."""
    (place.desk / "prog.ts").write_text(PROGRAM)
    target = place.desk / "prog.bin"
    _need(place.tsc("compile", "prog.ts").code == 0, "compile")
    image = target.read_bytes()
    target.write_bytes(b"TS\2old")
    place.computer.run(["attrib", "+r", "prog.bin"], place.desk)
    done = place.tsc("compile", "prog.ts")
    _need(done.code == 2 and "prog.bin" in done.said, f"read-only: {done.said}")
    place.computer.run(["attrib", "-r", "prog.bin"], place.desk)
    with _held(place, "prog.bin"):
        done = place.tsc("compile", "prog.ts")
        _need(done.code == 2 and "prog.bin" in done.said, f"open elsewhere: {done.said}")
        _need(target.read_bytes() == b"TS\2old", "it was written")
    _need(place.tsc("compile", "prog.ts").code == 0, "compile, when it is closed")
    _need(target.read_bytes() == image, "another image")
    for name in ("aux.bin", "con.bin", "x:y.bin"):
        done = place.tsc("compile", "prog.ts", "-o", name)
        _need(done.code == 2 and "Traceback" not in done.said, f"{name}: {done.said}")
    done = place.tsc("check", "aux.ts")
    _need(done.code == 2 and "aux.ts" in done.said, f"aux.ts is read: {done.said}")
    left = [each.name for each in place.desk.iterdir() if each.name.endswith((".new", ".lock"))]
    _need(not left, f"left behind: {left}")
    return "read-only, open elsewhere, aux.bin: refused, and the old file stays"


def pipes(place: Place) -> str:
    """`tsc ... | more`, and then q."""
    done = place.computer.run(place.script(LEFT), place.desk)
    _need(done.said.strip() == "141 b''", f"it says {done.said}")
    return "a reader that leaves ends the command without a word"


def tests(place: Place) -> str:
    """Tests of this repository that ask nothing of Unix, with Windows' Python."""
    root = place.computer.home / "tests of tiniscript"
    for name in ("compiler", "tests", "examples", "docs", "tools", "vm_arduino"):
        shutil.copytree(ROOT / name, root / name, dirs_exist_ok=True, ignore=_built)
    for name in ("pyproject.toml", "bytecode_spec.md", "README.md"):
        shutil.copy(ROOT / name, root / name)
    python = str(place.installed / "python.exe")
    wanted = ["-m", "pip", "install", "--quiet", "pytest", "hypothesis"]
    done = place.computer.run([python, *wanted], root, limit_s=SLOW_S)
    _need(done.code == 0, f"pip: {done.said[-300:]}")
    words = [python, "-X", "utf8", "-m", "pytest", "-q", "-p", "no:cacheprovider", *TESTS]
    done = place.computer.run(words, root, limit_s=SLOW_S, encoding="utf-8")
    _need(done.code == 0, done.said[-2000:])
    passed = re.search(r"(\d+) passed", done.said)
    return f"{passed[1] if passed else 'the'} tests of {', '.join(TESTS)}"


TRIES: dict[str, Callable[[Place], str]] = {
    each.__name__: each
    for each in (install, first_line, programs, repairs, encodings, machines, virtual_robot,
                 serial_port, files, pipes, tests)
}  # fmt: skip


@contextmanager
def _held(place: Place, name: str) -> Iterator[None]:
    """Another program has a file open."""
    with place.computer.running(place.script(HELD, name), place.desk) as holder:
        assert holder.stdout is not None
        _need(holder.stdout.readline().strip() == b"held", "the file cannot be held")
        yield


def place_here(place: Place) -> Callable[..., Done]:
    return lambda *words: _here(place.desk, *words)


def _here(desk: Path, *words: str) -> Done:
    """Run tsc on this computer, in the same folder."""
    command = [sys.executable, "-m", "tiniscript", *words]
    done = subprocess.run(
        command, cwd=desk, env=_own_variables(desk), stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, timeout=120,
    )  # fmt: skip
    return Done(done.returncode, done.stdout.decode(CODEPAGE, "replace"))


def _own_variables(desk: Path) -> dict[str, str]:
    own = {
        "PYTHONPATH": str(ROOT / "compiler"), "LC_ALL": "es_PE.UTF-8", "PYTHONUTF8": "0",
        "PYTHONIOENCODING": CODEPAGE, "XDG_CACHE_HOME": str(desk / "here"),
        "XDG_CONFIG_HOME": str(desk / "here"),
    }  # fmt: skip
    return {"PATH": os.environ["PATH"], "HOME": str(desk), **own}


def _windows(path: Path) -> str:
    """Return a path of this computer as Windows has it."""
    return "Z:" + str(path).replace("/", "\\")


def _built(folder: str, names: list[str]) -> list[str]:
    return [name for name in names if name in (".pio", "__pycache__", "node_modules")]


def _need(is_so: bool, wrong: str) -> None:
    if not is_so:
        raise Failed(wrong)
