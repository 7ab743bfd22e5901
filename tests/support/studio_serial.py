"""A Chromium whose Web Serial reaches a pseudo-terminal: with its serial code, but no chooser.

In a mount namespace of its own the pseudo-terminal lies over /dev/ttyS0, which the kernel lists,
and a policy grants the port to the page. Nothing outside the namespace changes. It takes root.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from tests.support import studio

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Playwright

LISTED_PORT = "/dev/ttyS0"
SCRIPT = """#!/bin/sh
exec unshare -m sh -ec '
mount --bind "$ROBOT_PORT" /dev/ttyS0
mkdir -p /etc/chromium
mount -t tmpfs tmpfs /etc/chromium
cd /etc/chromium
mkdir -p policies/managed
echo "{\\"SerialAllowAllPortsForUrls\\": [\\"$ROBOT_PAGE\\"]}" > policies/managed/robot.json
exec "$ROBOT_BROWSER" "$@"' sh "$@"
"""


def missing() -> str:
    """Return the reason why there is no such browser here, or ""."""
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        return "a mount namespace takes root"
    if not Path(LISTED_PORT).is_char_device():
        return f"there is no {LISTED_PORT}"
    if shutil.which("unshare") is None:
        return "there is no unshare"
    completed = subprocess.run(["unshare", "-m", "mount", "--bind", "/dev/null", LISTED_PORT],
                           capture_output=True, text=True)  # fmt: skip
    return completed.stderr.strip() if completed.returncode else ""


@contextmanager
def context(
    playwright: Playwright, folder: Path, port: str, origin: str
) -> Iterator[BrowserContext]:
    """A browser to whose pages at `origin` the port is granted."""
    script = folder / "browser"
    script.write_text(SCRIPT)
    script.chmod(0o755)
    environment: dict[str, str | float | bool] = {
        **os.environ,
        "ROBOT_PORT": port,
        "ROBOT_PAGE": origin.rstrip("/"),
        "ROBOT_BROWSER": str(studio.chromium()),
    }
    opened_browser_context = playwright.chromium.launch_persistent_context(
        str(folder / "profile"), executable_path=str(script), args=list(studio.OPTIONS),
        env=environment, locale="en-US", viewport={"width": 1366, "height": 768},
    )  # fmt: skip
    try:
        yield opened_browser_context
    finally:
        opened_browser_context.close()
