"""Rehearses a release: makes all that is published, twice, and compares.

    python -m tools.release FOLDER

clones the current commit into two clean folders, builds firmware, studio, the cases of tsc doctor
--conform, wheel, source package, library, site and USB stick in both, and reports every difference;
checks the packages as a registry does. FOLDER then has the files and SHA256SUMS. It uploads
nothing. It takes twenty minutes. With `--tag`, the commit then gets the tag of its version, if all
checks pass. Each commit tests that the results install and work.

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

SUMS_FILE = "SHA256SUMS"
# Two folders of different depths and names: embedded paths would differ.
CLONE_FOLDERS = ("one/tiniscript", "two/somewhere else/tiniscript-ñ")
EXTRA_OF_MODULE = {
    "setuptools": "release",
    "twine": "release",
    "sphinx": "site",
    "platformio": "firmware",
}


def main(arguments: Sequence[str] | None = None) -> int:
    description, _, epilog = (__doc__ or "").partition("\n\n")
    parser = argparse.ArgumentParser(
        prog="python -m tools.release", description=description, epilog=epilog,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    parser.add_argument("folder", type=Path, help="a folder that is not there yet, or is empty")
    parser.add_argument("--url", default="", help="an address instead of pyproject.toml's")
    parser.add_argument("--as-is", action="store_true", help="go on with what cannot be released")
    parser.add_argument("--tag", action="store_true", help="tag this commit if it can be released")
    parser.add_argument("--part", action="append", default=[], choices=PARTS, help="only this one")
    parser.add_argument("--whole-stick", action="store_true", help="for every system and Python")
    options = parser.parse_args(arguments)
    folder: Path = options.folder.absolute()
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        return _fail_to_begin(f"{folder} is there already, and is not empty.")
    parts = chosen_parts(options.part)
    missing_tool = find_missing_tool(parts)
    if missing_tool:
        return _fail_to_begin(missing_tool)
    try:
        # An unusable folder is reported at once, not after an hour.
        folder.mkdir(parents=True, exist_ok=True)
        return rehearse(folder, parts, options)
    except OSError as error:
        return _fail_to_begin(f"{error.strerror or error}: {error.filename or folder}")
    except KeyboardInterrupt:
        return _fail_to_begin("Ended. Nothing is in the folder.")


def rehearse(folder: Path, parts: Sequence[str], options: argparse.Namespace) -> int:
    """Make parts, look at them and put them into a folder; return the exit code."""
    with tempfile.TemporaryDirectory(prefix="tiniscript-release-") as scratch:
        try:
            clones = _clones(Path(scratch), options.url, options.whole_stick)
        except CannotMake as error:
            return _fail_to_begin(str(error))
        complaints = list(facts.release_problems(clones[0].root))
        complaints += [
            complaint for complaint in facts.release_problems(ROOT) if "not committed" in complaint
        ]
        for line in complaints:
            _say(line)
        if complaints and not options.as_is:
            return _fail_to_begin("Nothing was made. To rehearse all the same:  --as-is")
        try:
            files_of_part = [_make(clone, parts) for clone in clones]
            for file in (*files_of_part[0].get("wheel", ()), *files_of_part[0].get("sdist", ())):
                _say(f"twine check {file.name}")
                clones[0].python("-m", "twine", "check", "--strict", str(file))
        except CannotMake as error:
            return _fail_to_begin(str(error))
        files = [file for paths in files_of_part[0].values() for file in paths]
        second_clone_parts = clones[1].parts
        failed_parts = [
            path.name for path in files if sha256(path) != sha256(second_clone_parts / path.name)
        ]
        shutil.copytree(clones[0].parts, folder, dirs_exist_ok=True)
    sums_text = "".join(f"{sha256(folder / file.name)}  {file.name}\n" for file in files)
    (folder / SUMS_FILE).write_text(sums_text, encoding="utf-8", newline="\n")
    print(sums_text, end="")
    if options.url and facts.address(ROOT) != options.url.rstrip("/"):
        _say(f"pyproject.toml does not have {options.url}: what is published is made with it there")
    if outdated_text := ", ".join(results.outdated_goals()):
        _say(f"{results.DOCUMENT.relative_to(ROOT)}: figures of older code: {outdated_text}")
    for line in failed_parts:
        print(f"made twice, it is not the same: {line}", file=sys.stderr)
    if complaints or failed_parts:
        return 1
    if options.tag:
        try:
            tag(ROOT, facts.version(ROOT))
        except CannotMake as error:
            return _fail_to_begin(str(error))
    return 0


def tag(root: Path, version: str) -> None:
    """Tag the commit of a repository with a version. Raises CannotMake."""
    if f"v{version}" not in facts.tags(root):
        _git(root, [["tag", "--annotate", f"v{version}", "-m", f"TiniScript {version}"]])


def find_missing_tool(parts: Sequence[str]) -> str:
    """Return a sentence about missing tools on this computer, or an empty text."""
    for name, extra in EXTRA_OF_MODULE.items():
        if find_spec(name) is None:
            return f'{name} is not installed. Do that with:  pip install -e ".[{extra}]"'
    if "studio" in parts:
        try:
            find_tools()
        except CannotMake as error:
            return str(error)
    return ""


def _clones(scratch: Path, url: str, needs_whole_stick: bool) -> list[Clone]:
    """Clone the commit into clean folders with the release's times, permissions and address."""
    clones = []
    for number, clone_folder in enumerate(CLONE_FOLDERS, 1):
        root, parts = scratch / clone_folder, scratch / f"parts{number}"
        parts.mkdir()
        command = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(root)]
        process = subprocess.run(command, capture_output=True, text=True, umask=0o022)
        if process.returncode:
            error_lines = process.stderr.strip().splitlines() or ["git says nothing"]
            raise CannotMake(f"This folder is no clone that git can copy: {error_lines[-1]}")
        project_file = root / "pyproject.toml"
        text = project_file.read_text("utf-8")
        if url and facts.with_address(text, url) != text:
            project_file.write_text(facts.with_address(text, url), encoding="utf-8")
            _commit(root)
        clones.append(Clone(root, parts, facts.version(root), facts.address(root),
                           facts.epoch(ROOT), number, needs_whole_stick))  # fmt: skip
    return clones


def _commit(root: Path) -> None:
    """Keep the address of a rehearsal, so that a clone is clean, and its tags stay where it is."""
    git_steps = [["commit", "--quiet", "-am", "release: An address to rehearse with."]]
    git_steps += [["tag", "--force", name] for name in facts.tags(root)]
    _git(root, git_steps)


def _git(root: Path, steps: Sequence[Sequence[str]]) -> None:
    git_command = [
        "git", "-C", str(root), "-c", "user.name=release", "-c", "user.email=release@localhost",
        "-c", "commit.gpgsign=false", "-c", "tag.gpgsign=false",
    ]  # fmt: skip
    for step in steps:
        process = subprocess.run([*git_command, *step], capture_output=True, text=True)
        if process.returncode:
            output_lines = (process.stderr or process.stdout).strip().splitlines() or [
                "git says nothing"
            ]
            raise CannotMake(f"git {step[0]} does not work: {output_lines[-1]}")


def _make(clone: Clone, parts: Sequence[str]) -> dict[str, list[Path]]:
    """Make parts in a clone; return the files of each."""
    files_of_part = {}
    for name in parts:
        _say(f"{name}, in {clone.root.name}")
        begin_s = time.monotonic()
        files_of_part[name] = PARTS[name].make(clone)
        _say(f"{name}: {time.monotonic() - begin_s:.0f} s")
    return files_of_part


def _say(line: str) -> None:
    print(f"release: {line}", file=sys.stderr, flush=True)


def _fail_to_begin(line: str) -> int:
    _say(line)
    return 2


if __name__ == "__main__":
    sys.exit(main())
