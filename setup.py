"""The parts of packaging that `pyproject.toml` cannot express.

A wheel brings the firmware's sources and the texts of each language, and nothing stale. One without
the studio's page, firmware that is ready or the cases of `tsc doctor --conform` says so; in a
clone, at a terminal, the page is built if somebody wants it.
The links of its description lead to the project's address, where `pyproject.toml` has one. With
SOURCE_DATE_EPOCH a source package has the same bytes whenever and wherever it is made, as
setuptools does that for a wheel.
"""

from __future__ import annotations

import atexit
import gzip
import os
import re
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

ROOT = Path(__file__).resolve().parent
PROJECT = ROOT / "vm_arduino"
INSIDE = Path("tiniscript") / "flash" / "vm_arduino"  # where tsc firmware looks for the sources
# Generated parts of a wheel that are not in git: a file of each, and the module that makes it.
MADE = {
    "the studio's page": ("tiniscript/studio/page/index.html", "tools.builds.studio"),
    "firmware that is ready": ("tiniscript/flash/ready/*.hex", "tools.builds.firmware_files"),
    "the cases of tsc doctor --conform": (
        "tiniscript/conformance/*.json",
        "tools.builds.conformance",
    ),
}
PYTHON = ROOT / ".venv" / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def sources() -> list[Path]:
    """Return the files for building the firmware; `own.h` belongs to the user's own robot."""
    files = sorted((PROJECT / "src").rglob("*"))
    found = [PROJECT / "platformio.ini", PROJECT / "partitions.csv", *files]
    return [path for path in found if path.is_file() and path.name != "own.h"]


def missing(package: Path) -> list[str]:
    """Return the parts of MADE that a folder lacks."""
    return [what for what, (file, _) in MADE.items() if not any(package.glob(file))]


def is_made_into_texts(path: Path) -> bool:
    """Return whether a package has a file of a language in another form."""
    is_of_language = path.parent.parent.name == "languages"
    return is_of_language and (path.suffix == ".toml" or path.name == "seen.txt")


def build_page() -> None:
    """Build the page with the clone's tsc, which states the download size and asks.

    pip gives no terminal: whoever installs from a clone is not asked.
    """
    is_asked = sys.stdin is not None and sys.stdin.isatty() and sys.stderr.isatty()
    if is_asked and PYTHON.is_file() and "the studio's page" in missing(ROOT / "compiler"):
        subprocess.run([PYTHON, "-m", "tiniscript.cli.page_build"], cwd=ROOT)


def tell(lacks: list[str]) -> None:
    """Print the parts that a wheel lacks, and how to include them; or that it is complete."""
    if not lacks:
        has = " and ".join(MADE)
        print(f"tiniscript: this wheel has {has}.", file=sys.stderr, flush=True)
    else:
        commands = "".join(f"  python -m {MADE[what][1]}\n" for what in lacks)
        print(
            f"tiniscript: this wheel is made without {' and without '.join(lacks)}; tsc says so,"
            " too, where somebody needs it.\nIn a clone a wheel has that after\n"
            f"{commands}when  python -m build --wheel  makes it (a source package has none of it).",
            file=sys.stderr,
            flush=True,
        )


class Build(build_py):
    """Fills a folder that is empty: files that are no longer in the repository stay out."""

    def run(self) -> None:
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
            build_page()
        super().run()
        if not self.editable_mode:
            for path, target in self._copies().items():
                target.parent.mkdir(parents=True, exist_ok=True)
                self.copy_file(str(path), str(target))
            for target, data in self._catalogues().items():
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(data)
            # Below all the output of setuptools.
            atexit.register(tell, missing(Path(self.build_lib)))

    def _copies(self) -> dict[Path, Path]:
        inside = Path(self.build_lib) / INSIDE
        return {path: inside / path.relative_to(PROJECT) for path in sources()}

    def _catalogues(self) -> dict[Path, bytes]:
        """Return the texts of each language as the package reads them."""
        sys.path.insert(0, str(ROOT / "compiler"))
        from tiniscript.base.languages import cache_files

        folder = Path(self.build_lib) / "tiniscript" / "languages"
        return {folder / name: data for name, data in cache_files().items()}

    def exclude_data_files(  # type: ignore[no-untyped-def]
        self, package, src_dir, files
    ) -> list[str]:
        """Leave out what these are made of."""
        found: list[str] = super().exclude_data_files(package, src_dir, files)
        return [each for each in found if not is_made_into_texts(Path(each))]

    def get_outputs(self, include_bytecode: bool = True) -> list[str]:
        outputs: list[str] = super().get_outputs(include_bytecode)
        if self.editable_mode:
            return outputs
        return [*outputs, *map(str, (*self._copies().values(), *self._catalogues()))]


class Sources(sdist):
    """Packs files by name, and with nothing of the computer that packs them."""

    def make_archive(  # type: ignore[no-untyped-def]
        self, base_name, format, root_dir=None, base_dir=None, owner=None, group=None
    ):
        if format != "gztar" or not base_dir:
            return super().make_archive(base_name, format, root_dir, base_dir, owner, group)
        epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
        target = Path(f"{base_name}.tar.gz")
        target.parent.mkdir(parents=True, exist_ok=True)
        with (
            target.open("wb") as file,
            gzip.GzipFile("", "wb", fileobj=file, mtime=int(epoch or 0)) as packed,
            tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive,
        ):
            for path in sorted(Path(base_dir).rglob("*")):
                row = archive.gettarinfo(path, path.as_posix())
                row.uid = row.gid = 0
                row.uname = row.gname = ""
                row.mode = 0o755 if row.mode & 0o100 else 0o644
                row.mtime = int(epoch) if epoch else int(row.mtime)
                if row.isfile():
                    with path.open("rb") as content:
                        archive.addfile(row, content)
                else:
                    archive.addfile(row)
        return str(target)


def found_in(name: str, pattern: str) -> str:
    """Return the text that a pattern captures in a file, or ""."""
    found = re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE)
    return found.group(1) if found else ""


def description() -> str:
    """Return README as a registry shows it: away from its neighbours.

    Their addresses are those of GitHub and of forges that do the same.
    """
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    address = found_in("pyproject.toml", r'^Source = "(https://[^"]+)"$').rstrip("/")
    if not address:
        return text
    version = found_in("compiler/tiniscript/base/version.py", r'^__version__ = "([^"]+)"$')
    text = re.sub(r"(!\[[^]]*\]\()(?=[\w.])(?!https?:)", rf"\g<1>{address}/raw/v{version}/", text)
    return re.sub(
        r"((?<!!)\[[^]]*\]\()(?=[\w.])(?!https?:)", rf"\g<1>{address}/blob/v{version}/", text
    )


setup(
    cmdclass={"build_py": Build, "sdist": Sources},
    long_description=description(),
    long_description_content_type="text/markdown",
)
