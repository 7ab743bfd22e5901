"""Builds the simulated Uno, where it is used and from its sources.

It links libsimavr, which is under GPLv3: the program is never shipped.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import tempfile
from functools import lru_cache
from pathlib import Path

SOURCE_FOLDER = Path(__file__).resolve().parent
SIMULATOR_HEADER = Path("/usr/include/simavr/sim_avr.h")
FLAGS = ("-std=gnu11", "-O2", "-flto")
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror")
LIBRARIES = ("-Wl,-Bstatic", "-lsimavr", "-Wl,-Bdynamic", "-lelf", "-lutil", "-lm")


def missing() -> str:
    """Return the reason why there is no simulated Uno, or ""."""
    if not shutil.which("gcc"):
        return "no gcc: the simulated Uno is not built"
    if not SIMULATOR_HEADER.exists():
        return "no libsimavr: no simulated Uno (apt-get install libsimavr-dev libelf-dev)"
    return ""


@lru_cache(maxsize=1)
def build() -> Path:
    """Return the program; an earlier build from the same sources is reused.

    Several may build at the same time: each builds for itself, and the last one stays.
    """
    if reason := missing():
        raise RuntimeError(reason)
    inputs = sorted(SOURCE_FOLDER.glob("*.[ch]"))
    key = hashlib.sha256(
        repr((WARNINGS, FLAGS, LIBRARIES)).encode() + SIMULATOR_HEADER.read_bytes()
    )
    for path in inputs:
        key.update(path.name.encode() + path.read_bytes())
    folder = Path(tempfile.gettempdir()) / f"tiniscript-uno-{os.getuid()}"
    program = folder / key.hexdigest()[:16]
    if not program.exists():
        folder.mkdir(mode=0o700, exist_ok=True)
        temporary = program.with_suffix(f".{os.getpid()}")
        source_paths = [str(path) for path in inputs if path.suffix == ".c"]
        process = subprocess.run(
            ["gcc", *FLAGS, *WARNINGS, *source_paths, *LIBRARIES, "-o", str(temporary)],
            capture_output=True,
            text=True,
        )
        if process.returncode != 0:
            raise RuntimeError(f"gcc refuses the simulated Uno:\n{process.stderr[:4000]}")
        temporary.replace(program)
    return program
