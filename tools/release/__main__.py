"""Rehearses a release: makes all that is published, twice, and compares.

    python -m tools.release FOLDER

takes the commit that is checked out into two clean folders, makes firmware, studio, the cases of
tsc doctor --conform, wheel, source package, library, site and USB stick in both, and says what is
not the same byte for byte; looks at the packages as a registry does. FOLDER then has the files and
SHA256SUMS. Nothing is uploaded. It takes twenty minutes. With `--tag` the commit then gets the tag
of its version, if nothing is wrong. Each commit tests that what is made installs and works.

`--url https://…` rehearses with an address that pyproject.toml does not have yet; `--as-is` goes on
where something keeps the commit from being released; `--part NAME` makes only some;
`--whole-stick` makes the stick for every system, not for this one alone.
The exit code is 0 if it can be released, 1 if not, and 2 where the rehearsal cannot begin.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from tools import ROOT, CannotMake
from tools.builds.studio import find_tools
from tools.campaign import results
from tools.release import facts
from tools.release.packing import sha256
from tools.release.parts import PARTS, Clone, chosen_parts

SUMS = "SHA256SUMS"
# Two folders of other depths and names: what has a path in it differs.
PLACES = ("one/tiniscript", "two/somewhere else/tiniscript-ñ")
NEEDED = {"setuptools": "release", "twine": "release", "sphinx": "site", "platformio": "firmware"}


def main(words: Sequence[str] | None = None) -> int:
    description, _, epilog = (__doc__ or "").partition("\n\n")
    reader = argparse.ArgumentParser(
        prog="python -m tools.release", description=description, epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    reader.add_argument("folder", type=Path, help="a folder that is not there yet, or is empty")
    reader.add_argument("--url", default="", help="an address instead of pyproject.toml's")
    reader.add_argument("--as-is", action="store_true", help="go on with what cannot be released")
    reader.add_argument("--tag", action="store_true", help="tag this commit if it can be released")
    reader.add_argument("--part", action="append", default=[], choices=PARTS, help="only this one")
    reader.add_argument("--whole-stick", action="store_true", help="for every system and Python")
    options = reader.parse_args(words)
    folder: Path = options.folder.absolute()
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        return _fail(f"{folder} is there already, and is not empty.")
    parts = chosen_parts(options.part)
    lacking = lacks(parts)
    if lacking:
        return _fail(lacking)
    try:
        folder.mkdir(parents=True, exist_ok=True)  # who cannot have it hears so before an hour
        return rehearse(folder, parts, options)
    except OSError as error:
        return _fail(f"{error.strerror or error}: {error.filename or folder}")
    except KeyboardInterrupt:
        return _fail("Ended. Nothing is in the folder.")


def rehearse(folder: Path, parts: Sequence[str], options: argparse.Namespace) -> int:
    """Make parts, look at them and put them into a folder; return the exit code."""
    with tempfile.TemporaryDirectory(prefix="tiniscript-release-") as scratch:
        try:
            clones = _clones(Path(scratch), options.url, options.whole_stick)
        except CannotMake as why:
            return _fail(str(why))
        complaints = list(facts.complaints(clones[0].root))
        complaints += [
            complaint for complaint in facts.complaints(ROOT) if "not committed" in complaint
        ]
        for item in complaints:
            _say(item)
        if complaints and not options.as_is:
            return _fail("Nothing was made. To rehearse all the same:  --as-is")
        try:
            items = [_make(clone, parts) for clone in clones]
            for file in (*items[0].get("wheel", ()), *items[0].get("sdist", ())):
                _say(f"twine check {file.name}")
                clones[0].python("-m", "twine", "check", "--strict", str(file))
        except CannotMake as why:
            return _fail(str(why))
        files = [file for paths in items[0].values() for file in paths]
        second_clone_parts = clones[1].parts
        failed_parts = [
            path.name for path in files if sha256(path) != sha256(second_clone_parts / path.name)
        ]
        shutil.copytree(clones[0].parts, folder, dirs_exist_ok=True)
    sums = "".join(f"{sha256(folder / file.name)}  {file.name}\n" for file in files)
    (folder / SUMS).write_text(sums, encoding="utf-8", newline="\n")
    print(sums, end="")
    if options.url and facts.address(ROOT) != options.url.rstrip("/"):
        _say(f"pyproject.toml does not have {options.url}: what is published is made with it there")
    if old := ", ".join(results.outdated_goals()):
        _say(f"{results.DOCUMENT.relative_to(ROOT)}: figures of older code: {old}")
    for item in failed_parts:
        print(f"made twice, it is not the same: {item}", file=sys.stderr)
    if complaints or failed_parts:
        return 1
    if options.tag:
        try:
            tag(ROOT, facts.version(ROOT))
        except CannotMake as why:
            return _fail(str(why))
    return 0


def tag(root: Path, version: str) -> None:
    """Give the commit of a repository the tag of a version. Raises CannotMake."""
    if f"v{version}" not in facts.tags(root):
        _git(root, [["tag", "--annotate", f"v{version}", "-m", f"TiniScript {version}"]])


def lacks(parts: Sequence[str]) -> str:
    """Return a sentence about what this computer lacks to make parts, or nothing."""
    for name, extra in NEEDED.items():
        if find_spec(name) is None:
            return f'{name} is not installed. Do that with:  pip install -e ".[{extra}]"'
    if "studio" in parts:
        try:
            find_tools()
        except CannotMake as error:
            return str(error)
    return ""


def _clones(scratch: Path, url: str, whole_stick: bool) -> list[Clone]:
    """Take the commit into clean folders, whose times, rights and address are the release's."""
    clones = []
    for number, place in enumerate(PLACES, 1):
        root, parts = scratch / place, scratch / f"parts{number}"
        parts.mkdir()
        words = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(root)]
        completed = subprocess.run(words, capture_output=True, text=True, umask=0o022)
        if completed.returncode:
            sentence = completed.stderr.strip().splitlines() or ["git says nothing"]
            raise CannotMake(f"This folder is no clone that git can copy: {sentence[-1]}")
        project_file = root / "pyproject.toml"
        text = project_file.read_text("utf-8")
        if url and facts.with_address(text, url) != text:
            project_file.write_text(facts.with_address(text, url), encoding="utf-8")
            _commit(root)
        clones.append(Clone(root, parts, facts.version(root), facts.address(root),
                           facts.epoch(ROOT), number, whole_stick))  # fmt: skip
    return clones


def _commit(root: Path) -> None:
    """Keep the address of a rehearsal, so that a clone is clean, and its tags stay where it is."""
    steps = [["commit", "--quiet", "-am", "release: An address to rehearse with."]]
    steps += [["tag", "--force", name] for name in facts.tags(root)]
    _git(root, steps)


def _git(root: Path, steps: Sequence[Sequence[str]]) -> None:
    git_command = [
        "git", "-C", str(root), "-c", "user.name=release", "-c", "user.email=release@localhost",
        "-c", "commit.gpgsign=false", "-c", "tag.gpgsign=false",
    ]  # fmt: skip
    for step in steps:
        completed = subprocess.run([*git_command, *step], capture_output=True, text=True)
        if completed.returncode:
            text = (completed.stderr or completed.stdout).strip().splitlines() or [
                "git says nothing"
            ]
            raise CannotMake(f"git {step[0]} does not work: {text[-1]}")


def _make(clone: Clone, parts: Sequence[str]) -> dict[str, list[Path]]:
    """Make parts in a clone; return the files of each."""
    result = {}
    for name in parts:
        _say(f"{name}, in {clone.root.name}")
        begin_s = time.monotonic()
        result[name] = PARTS[name].make(clone)
        _say(f"{name}: {time.monotonic() - begin_s:.0f} s")
    return result


def _say(line: str) -> None:
    print(f"release: {line}", file=sys.stderr, flush=True)


def _fail(line: str) -> int:
    _say(line)
    return 2


if __name__ == "__main__":
    sys.exit(main())
