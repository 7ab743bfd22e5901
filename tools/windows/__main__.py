"""Runs `tsc` with Windows' own Python, on wine.

    python -m tools.windows [TRY ...]

makes a folder with a Windows of wine in it (once; `--folder` says where), puts python.org's
CPython for Windows there, installs `tsc` from a USB stick by the stick's start.bat, and tries it:
each TRY, or all of them. `install` takes the tree as it is now, other tries alone what is there. It
asks apt for wine where it may, and takes about ten minutes. It needs `.[test]` installed, and PyPI.

wine is no Windows. Python, the packages and their DLLs are those of Windows, and so is what they
ask for: names, handles, sharing of files, code pages, processes, Winsock. What answers is wine: its
cmd, its consoles, its files on this computer's disk. Where it lacks what the packages ask for,
`tools/windows/stand_ins` has it. No driver, no Bluetooth, no PowerShell, no installer and no virus
scanner is in it.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

from tools import ROOT, CannotMake
from tools.windows import computer, tries


def main(words: Sequence[str] | None = None) -> int:
    about, _, more = (__doc__ or "").partition("\n\n")
    reader = argparse.ArgumentParser(
        prog="python -m tools.windows", description=about, epilog=more,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    reader.add_argument("tries", nargs="*", choices=[[], *tries.TRIES], metavar="TRY")
    reader.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / "tini-windows")
    options = reader.parse_args(words)
    folder: Path = options.folder.absolute()
    try:
        windows = computer.make(folder)
        wheel = _wheel(folder)
    except CannotMake as why:
        print(f"tools.windows: {why}", file=sys.stderr)
        return 2
    try:
        return _tried(windows, wheel, options.tries)
    finally:
        windows.end()


def _tried(windows: computer.Computer, wheel: Path, chosen: Sequence[str]) -> int:
    desk = windows.home / "Desktop" / f"{tries.WORD} clase"
    desk.mkdir(parents=True, exist_ok=True)
    place = tries.Place(windows, wheel, desk)
    wrong = 0
    is_there = (place.installed / "tsc.exe").is_file()
    for name, tried in tries.TRIES.items():
        if chosen and name not in chosen and (name != "install" or is_there):
            continue
        begun_s = time.monotonic()
        try:
            said = tried(place)
        except (
            tries.Failed,
            OSError,
            ValueError,
            StopIteration,
            subprocess.SubprocessError,
        ) as why:
            wrong += 1
            said = f"FAILED: {why}"
            if name == "install":
                print(f"{name}: {said}", flush=True)
                break
        print(f"{name}: {said} ({time.monotonic() - begun_s:.0f} s)", flush=True)
    return 1 if wrong else 0


def _wheel(folder: Path) -> Path:
    """Make the wheel of this tree."""
    place = folder / "wheel"
    shutil.rmtree(place, ignore_errors=True)
    words = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", str(place), "."]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    found = sorted(place.glob("*.whl"))
    if done.returncode or not found:
        raise CannotMake(f"no wheel: {done.stderr.strip()[-300:]}")
    return found[0]


if __name__ == "__main__":
    raise SystemExit(main())
