"""The page's own sources in node: a script of the tests plays a part of the page, no browser."""

from __future__ import annotations

import subprocess
from pathlib import Path

from tests.support.needs import need
from tests.support.waiting import HANGS_S
from tiniscript.studio.building import SOURCES
from tools import CannotMake
from tools.builds.studio import find_tools


def in_node(script: Path, *words: str, given: str = "") -> list[str]:
    """Run a script with the folder of the page's sources and these words; return the lines that it
    prints. It reads `given` on its standard input."""
    try:
        node = find_tools().node
    except CannotMake as why:
        need(str(why))
    command = [*node, str(script), str(SOURCES / "src"), *words]
    done = subprocess.run(
        command, input=given, capture_output=True, text=True, timeout=2 * HANGS_S, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()
