"""What a release consists of, and how each part is made in a clone.

Knows the commands of `tools/builds` and setuptools. Each part is built by processes whose sources,
time and rights are the clone's, so that it depends on nothing of the folder it is made in.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from tools import CannotMake
from tools.release.packing import pack

_SETUPTOOLS = "import sys; from setuptools import build_meta; build_meta.build_{0}(sys.argv[1])"
_FIRMWARE_BESIDE = """\
from tools.builds import studio
studio.bring_firmware(studio.PAGE)
"""
READY = "compiler/tiniscript/flash/ready"
PAGE = "compiler/tiniscript/studio/page"


class Clone(NamedTuple):
    """A clean copy of the repository, and where its parts go."""

    root: Path
    parts: Path
    version: str
    address: str
    epoch: int  # s since 1970: the time of its commit
    seed: int  # of the order of Python's sets
    whole_stick: bool

    def environment(self) -> dict[str, str]:
        """Return the variables of a process that builds."""
        variables = {name: value for name, value in os.environ.items()
                     if not name.startswith(("PIP_REQUIRE", "PYTHON", "XDG_STATE"))}  # fmt: skip
        return {
            **variables,
            "PYTHONPATH": os.pathsep.join(map(str, (self.root, self.root / "compiler"))),
            "PYTHONHASHSEED": str(self.seed),
            "PYTHONDONTWRITEBYTECODE": "1",
            "SOURCE_DATE_EPOCH": str(self.epoch),
            "LC_ALL": "C.UTF-8",
            "TZ": "UTC",
        }

    def python(self, *words: str, good: tuple[int, ...] = (0,)) -> str:
        """Run Python in the clone; return what it printed. Raises CannotMake.

        `good` are the exit codes with which it has made what it should.
        """
        command = [sys.executable, *words]
        completed = subprocess.run(command, cwd=self.root, env=self.environment(), umask=0o022,
                              capture_output=True, text=True, errors="replace")  # fmt: skip
        if completed.returncode not in good:
            text = (completed.stdout + completed.stderr).strip().splitlines() or ["nothing"]
            name = " ".join(words[:2]).partition("\n")[0]
            raise CannotMake(f"python {name} said:\n" + "\n".join(text[-12:]))
        return completed.stdout

    def file_of(self, part: str) -> Path:
        """Return the file of a part that is a folder."""
        return self.parts / f"tiniscript-{part}-{self.version}.zip"


def firmware(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.firmware_files")
    return [pack(clone.root / READY, clone.file_of("firmware"), clone.epoch)]


def studio(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.studio")
    page = clone.root / PAGE
    if not (page / "licences.txt").is_file():
        raise CannotMake("the page names no licences of the packages that are in it")
    return []


def conformance(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.conformance")
    return []


def wheel(clone: Clone) -> list[Path]:
    clone.python("-c", _SETUPTOOLS.format("wheel"), str(clone.parts))
    return list(clone.parts.glob("*.whl"))


def sdist(clone: Clone) -> list[Path]:
    clone.python("-c", _SETUPTOOLS.format("sdist"), str(clone.parts))
    return list(clone.parts.glob("*.tar.gz"))


def page(clone: Clone) -> list[Path]:
    """For a static host: with the firmware, which a wheel has elsewhere already."""
    if (clone.root / READY).is_dir():
        clone.python("-c", _FIRMWARE_BESIDE)
    stamp = clone.root / PAGE / "build.json"
    stamp_data = stamp.read_bytes()
    stamp.unlink()  # says of which files it was built, not a file of the page
    path = pack(clone.root / PAGE, clone.file_of("studio"), clone.epoch)
    stamp.write_bytes(stamp_data)
    return [path]


def library(clone: Clone) -> list[Path]:
    folder = clone.parts / "TiniScript"
    clone.python("-m", "tools.builds.library", str(folder))
    path = clone.parts / f"TiniScript-{clone.version}.zip"  # as Arduino's "Add .ZIP Library" takes
    pack(folder, path, clone.epoch)
    shutil.rmtree(folder)
    return [path]


def site(clone: Clone) -> list[Path]:
    folder = clone.parts / "site"
    no_studio = () if (clone.root / PAGE).is_dir() else ("--no-studio",)
    clone.python("-m", "tools.builds.site", str(folder), *no_studio)
    path = pack(folder, clone.file_of("site"), clone.epoch)
    shutil.rmtree(folder)
    return [path]


def stick(clone: Clone) -> list[Path]:
    folder = clone.parts / "stick"
    words = ["--wheel", str(next(clone.parts.glob("*.whl")))]
    if not clone.whole_stick:
        python_version = f"{sys.version_info[0]}.{sys.version_info[1]}"
        words += ["--system", "linux", "--python", python_version, "--no-installer"]
    # 1: something could not be had, which the stick's README.txt then names
    good = (0, 1) if clone.whole_stick else (0,)
    clone.python("-m", "tools.builds.usb_stick", str(folder), *words, good=good)
    path = pack(folder, clone.file_of("stick"), clone.epoch)
    shutil.rmtree(folder)
    return [path]


class Part(NamedTuple):
    make: Callable[[Clone], list[Path]]
    needs: tuple[str, ...] = ()  # parts that are made before


# In the order in which they are made: a wheel brings firmware, page and the cases of
# tsc doctor --conform, a stick brings the wheel.
PARTS = {
    "firmware": Part(firmware),
    "studio": Part(studio),
    "conformance": Part(conformance),
    "wheel": Part(wheel, ("conformance",)),
    "sdist": Part(sdist),
    "page": Part(page, ("studio",)),
    "library": Part(library),
    "site": Part(site),
    "stick": Part(stick, ("wheel",)),
}


def chosen_parts(names: list[str]) -> list[str]:
    """Return parts with those that they need, in the order in which they are made."""
    expected = set(names or PARTS)
    for name in reversed(PARTS):
        if name in expected:
            expected |= set(PARTS[name].needs)
    return [name for name in PARTS if name in expected]
