"""Builds a folder for a USB stick, from which a class without internet works with TiniScript.

    python -m tools.builds.usb_stick stick

holds the wheels for Windows, macOS (both chips) and Linux, for Python 3.10 to 3.15; the installer
of Python for Windows; ready firmware of the shipped robots; guides, wiring and lessons as pages;
the examples; and a start script for each system. Missing parts are listed at the end, and in the
stick's README.txt, and the exit code is then 1. The computer that builds it must be online.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import shutil
import sys
import urllib.request
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from tiniscript import __version__
from tiniscript.base.languages import SOURCE_LANGUAGE, text, translated_languages
from tiniscript.flash import ready
from tools import ROOT, CannotMake
from tools.builds import stick_pages, stick_wheels
from tools.builds.stick_wheels import PYTHONS, SYSTEMS
from tools.site.documents import name_in

SCRIPTS = ROOT / "tools" / "builds" / "stick"
# The wanted packages, and the optional ones for a Python that is too new for their wheels.
EXTRAS = "[firmware,radio,virtual]"
FEWER_EXTRAS = "[firmware,virtual]"
INSTALLER = "3.13.9"  # a release of Python for Windows that has an installer
INSTALLER_URL = "https://www.python.org/ftp/python/{0}/python-{0}-amd64.exe"
# The entry in the catalogue of the Windows package manager (microsoft/winget-pkgs,
# Python.Python.3.13).
INSTALLER_SHA256 = "200ddff856bbff949d2cc1be42e8807c07538abd6b6966d5113a094cf628c5c5"


class MissingPart(NamedTuple):
    """A missing part: the key of its sentence, its values, and the reason for the builder."""

    key: str
    name: str
    reason: str

    def sentence(self, language: str) -> str:
        return text("documents", f"stick/{self.key}", language).format(what=self.name)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="usb_stick", description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="a folder that is not there yet, or is empty")
    parser.add_argument("--system", action="append", choices=SYSTEMS, help="only for this one")
    parser.add_argument("--python", action="append", choices=PYTHONS, help="only for this one")
    parser.add_argument("--no-firmware", action="store_true", help="build no firmware")
    parser.add_argument("--no-installer", action="store_true", help="fetch no installer")
    parser.add_argument("--wheel", type=Path, help="TiniScript's wheel, if it is made already")
    options = parser.parse_args(arguments)
    folder: Path = options.folder
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        print(f"usb_stick: {folder} is there already, and is not empty.", file=sys.stderr)
        return 2
    wheels = folder / "wheels"
    wheels.mkdir(parents=True)
    missing_parts: list[MissingPart] = []
    if not options.no_firmware and not options.wheel:
        missing_parts += _firmware()
    systems, pythons = options.system or list(SYSTEMS), options.python or list(PYTHONS)
    try:
        missing_parts += add_wheels(wheels, systems, pythons, options.wheel)
    except CannotMake as error:
        print(f"usb_stick: {error} Is this computer online?", file=sys.stderr)
        return 2
    if not options.no_installer and "windows" in systems:
        missing_parts += add_installer(folder, INSTALLER_URL.format(INSTALLER))
    add_texts(folder)
    titles = ", ".join(SYSTEMS[system].title for system in systems)
    add_readme(folder, titles, ", ".join(pythons), missing_parts)
    for missing_part in missing_parts:
        print(
            f"missing: {missing_part.sentence(SOURCE_LANGUAGE)} ({missing_part.reason})",
            file=sys.stderr,
        )
    size_bytes = sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    print(f"{folder}: {size_bytes / 1e6:.0f} MB. Copy what is in it to the stick.")
    return 1 if missing_parts else 0


def add_wheels(
    wheels: Path, systems: Sequence[str], pythons: Sequence[str], given_wheel: Path | None = None
) -> list[MissingPart]:
    """Put all wheels into a folder; return the missing parts. Raises CannotMake.

    `given_wheel` is the wheel of TiniScript; if there is none, build it.
    """
    stick_wheels.make_source_wheels(wheels)
    wheel = (
        Path(shutil.copy(given_wheel, wheels))
        if given_wheel
        else stick_wheels.make_own_wheel(ROOT, wheels)
    )
    missing_parts: list[MissingPart] = []
    for name in systems:
        for python in pythons:
            title = f"{SYSTEMS[name].title}, Python {python}"
            print(f"wheels for {title}", flush=True)
            try:
                stick_wheels.fetch(wheel, wheels, SYSTEMS[name], python, EXTRAS)
            except CannotMake as error:
                missing_parts.append(_fetch_fewer_parts(wheel, wheels, name, python, str(error)))
    return missing_parts


def _fetch_fewer_parts(
    wheel: Path, wheels: Path, name: str, python: str, reason: str
) -> MissingPart:
    """Download the most important parts for a class; return the missing ones."""
    title = f"{SYSTEMS[name].title}, Python {python}"
    try:
        stick_wheels.fetch(wheel, wheels, SYSTEMS[name], python, FEWER_EXTRAS)
    except CannotMake:
        return MissingPart("no_system", title, reason)
    return MissingPart("no_radio", title, reason)


def add_installer(folder: Path, url: str, sha256: str = INSTALLER_SHA256) -> list[MissingPart]:
    """Download the installer of Python for Windows; return the missing parts."""
    target = folder / url.rsplit("/", 1)[1]
    try:
        with urllib.request.urlopen(url, timeout=60) as answer, target.open("wb") as file:
            shutil.copyfileobj(answer, file)
        if hashlib.sha256(target.read_bytes()).hexdigest() == sha256:
            return []
        reason = "what came is not that installer"
    except (OSError, ValueError) as error:  # includes the errors of urllib
        reason = str(getattr(error, "reason", error))
    target.unlink(missing_ok=True)
    return [MissingPart("no_installer", url, reason)]


def add_texts(folder: Path) -> None:
    """Put pages, examples, licence and scripts into a folder."""
    stick_pages.make(ROOT, folder / "pages")
    shutil.copytree(ROOT / "examples", folder / "examples")
    shutil.copy(ROOT / "LICENSE", folder)
    for path in sorted(SCRIPTS.iterdir()):
        script = path.read_text(encoding="utf-8")
        # cmd finds a label by its line end; a shell of Unix takes a CR for a part of a word
        line_end = "\r\n" if path.suffix in (".bat", ".ps1") else "\n"
        target = folder / path.name
        target.write_text(script, encoding="utf-8", newline=line_end)
        if path.suffix in (".sh", ".command"):
            target.chmod(0o755)


def add_readme(
    folder: Path, systems: str, pythons: str, missing_parts: Sequence[MissingPart]
) -> None:
    parts = [f"TiniScript {__version__}\n{systems}\nPython {pythons}\n"]
    for language in translated_languages("documents", "stick/title"):
        index = name_in(language, stick_pages.INDEX)
        lacks_format = text("documents", "stick/lacks", language)
        instructions = text("documents", "stick/readme", language).format(index=index)
        rows = [
            instructions,
            *(
                lacks_format.format(what=missing_part.sentence(language))
                for missing_part in missing_parts
            ),
        ]
        title = text("documents", "stick/title", language)
        parts.append("\n".join((title, "", *rows, "")))
    readme_text = "\n".join(parts)
    (folder / "README.txt").write_text(readme_text, encoding="utf-8-sig", newline="\r\n")


def _firmware() -> list[MissingPart]:
    """Put the firmware into our wheel; return the parts that cannot be built."""
    if any(ready.FOLDER.glob("*.hex")):
        return []
    from tools.builds import firmware_files

    if firmware_files.main([]):
        return [MissingPart("no_firmware", "", "see above")]
    return []


if __name__ == "__main__":
    os.environ.setdefault("LC_ALL", "C.UTF-8")
    sys.exit(main())
