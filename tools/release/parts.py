"""The parts of a release, and how each is made in a clone.

Knows the commands of `tools/builds` and setuptools. Each part is built by processes with the
clone's sources, time and permissions, so that it does not depend on its build folder.
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
from tools.release.packing import pack_folder

_BUILD_CODE = "import sys; from setuptools import build_meta; build_meta.build_{0}(sys.argv[1])"
_BRING_FIRMWARE_CODE = """\
from tools.builds import studio
studio.bring_firmware(studio.PAGE)
"""
READY_FOLDER = "compiler/tiniscript/flash/ready"
PAGE_FOLDER = "compiler/tiniscript/studio/page"


class Clone(NamedTuple):
    """A clean copy of the repository, and where its parts go."""

    root: Path
    parts: Path
    version: str
    address: str
    epoch: int  # s since 1970: the time of its commit
    seed: int  # seed of Python's set order
    needs_whole_stick: bool

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

    def python(self, *arguments: str, good_codes: tuple[int, ...] = (0,)) -> str:
        """Run Python in the clone; return its output. Raises CannotMake.

        `good_codes` are the exit codes of success.
        """
        command = [sys.executable, *arguments]
        process = subprocess.run(command, cwd=self.root, env=self.environment(), umask=0o022,
                              capture_output=True, text=True, errors="replace")  # fmt: skip
        if process.returncode not in good_codes:
            output_lines = (process.stdout + process.stderr).strip().splitlines() or ["nothing"]
            name = " ".join(arguments[:2]).partition("\n")[0]
            raise CannotMake(f"python {name} said:\n" + "\n".join(output_lines[-12:]))
        return process.stdout

    def file_of(self, part: str) -> Path:
        """Return the file of a part that is a folder."""
        return self.parts / f"tiniscript-{part}-{self.version}.zip"


def make_firmware(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.firmware_files")
    return [pack_folder(clone.root / READY_FOLDER, clone.file_of("firmware"), clone.epoch)]


def make_studio(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.studio")
    page_folder = clone.root / PAGE_FOLDER
    if not (page_folder / "licences.txt").is_file():
        raise CannotMake("the page names no licences of the packages that are in it")
    return []


def make_conformance(clone: Clone) -> list[Path]:
    clone.python("-m", "tools.builds.conformance")
    return []


def make_wheel(clone: Clone) -> list[Path]:
    clone.python("-c", _BUILD_CODE.format("wheel"), str(clone.parts))
    return list(clone.parts.glob("*.whl"))


def make_sdist(clone: Clone) -> list[Path]:
    clone.python("-c", _BUILD_CODE.format("sdist"), str(clone.parts))
    return list(clone.parts.glob("*.tar.gz"))


def make_page(clone: Clone) -> list[Path]:
    """Build the page for a static host, with the firmware, which a wheel has elsewhere."""
    if (clone.root / READY_FOLDER).is_dir():
        clone.python("-c", _BRING_FIRMWARE_CODE)
    stamp_path = clone.root / PAGE_FOLDER / "build.json"
    stamp_data = stamp_path.read_bytes()
    stamp_path.unlink()  # record of its sources, not a file of the page
    path = pack_folder(clone.root / PAGE_FOLDER, clone.file_of("studio"), clone.epoch)
    stamp_path.write_bytes(stamp_data)
    return [path]


def make_library(clone: Clone) -> list[Path]:
    folder = clone.parts / "TiniScript"
    clone.python("-m", "tools.builds.library", str(folder))
    # The form that Arduino's "Add .ZIP Library" accepts.
    path = clone.parts / f"TiniScript-{clone.version}.zip"
    pack_folder(folder, path, clone.epoch)
    shutil.rmtree(folder)
    return [path]


def make_site(clone: Clone) -> list[Path]:
    folder = clone.parts / "site"
    no_studio = () if (clone.root / PAGE_FOLDER).is_dir() else ("--no-studio",)
    clone.python("-m", "tools.builds.site", str(folder), *no_studio)
    path = pack_folder(folder, clone.file_of("site"), clone.epoch)
    shutil.rmtree(folder)
    return [path]


def make_stick(clone: Clone) -> list[Path]:
    folder = clone.parts / "stick"
    arguments = ["--wheel", str(next(clone.parts.glob("*.whl")))]
    if not clone.needs_whole_stick:
        python_version = f"{sys.version_info[0]}.{sys.version_info[1]}"
        arguments += ["--system", "linux", "--python", python_version, "--no-installer"]
    # 1: something could not be had, which the stick's README.txt then names
    good_codes = (0, 1) if clone.needs_whole_stick else (0,)
    clone.python("-m", "tools.builds.usb_stick", str(folder), *arguments, good_codes=good_codes)
    path = pack_folder(folder, clone.file_of("stick"), clone.epoch)
    shutil.rmtree(folder)
    return [path]


class Part(NamedTuple):
    make: Callable[[Clone], list[Path]]
    needs: tuple[str, ...] = ()  # parts that are made before


# In the order in which they are made: a wheel brings firmware, page and the cases of
# tsc doctor --conform, a stick brings the wheel.
PARTS = {
    "firmware": Part(make_firmware),
    "studio": Part(make_studio),
    "conformance": Part(make_conformance),
    "wheel": Part(make_wheel, ("conformance",)),
    "sdist": Part(make_sdist),
    "page": Part(make_page, ("studio",)),
    "library": Part(make_library),
    "site": Part(make_site),
    "stick": Part(make_stick, ("wheel",)),
}


def chosen_parts(names: list[str]) -> list[str]:
    """Return parts with those that they need, in the order in which they are made."""
    wanted_names = set(names or PARTS)
    for name in reversed(PARTS):
        if name in wanted_names:
            wanted_names |= set(PARTS[name].needs)
    return [name for name in PARTS if name in wanted_names]
