"""Profiles that a robot was used with before, by the fingerprints of their kits.

The user's cache holds their paths; a profile that has changed or was removed is ignored. The cache
may be lost without harm.
"""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path

from tiniscript import robots
from tiniscript.base import files
from tiniscript.robots.profile import ProfileRefused, Robot

MAX_PROFILES = 20  # profiles; the oldest go first
MAX_FILE_BYTES = 200_000


def remember(path: str, kit: int) -> None:
    """Keep the path of a profile. If the cache cannot be written, the path is not kept."""
    entry = (kit, os.path.abspath(path))  # noqa: PTH100 - Path raises for some names
    if _remembered_profiles()[:1] == [entry]:
        return
    with contextlib.suppress(OSError):
        _path().parent.mkdir(mode=files.OWNER_ONLY, parents=True, exist_ok=True)
        with files.lock_file(_path()):  # other commands do the same
            paths = [
                entry,
                *(
                    remembered_profile
                    for remembered_profile in _remembered_profiles()
                    if remembered_profile != entry
                ),
            ][:MAX_PROFILES]
            files.keep(_path(), json.dumps(paths).encode())


def recall(kit: int) -> Robot | None:
    """Return the known profile with this kit, or None if there is none or its kit has changed."""
    return next((robot for _, robot in profiles() if robot.kit.fingerprint == kit), None)


def profiles() -> list[tuple[str, Robot]]:
    """Return the profiles that still exist, with their paths, the newest first."""
    found_profiles: list[tuple[str, Robot]] = []
    for kit, path in _remembered_profiles():
        with contextlib.suppress(ProfileRefused):
            robot = robots.load(path)
            if robot.kit.fingerprint == kit:
                found_profiles.append((path, robot))
    return found_profiles


def _remembered_profiles() -> list[tuple[int, str]]:
    try:
        entries = json.loads(files.read_limited(_path(), MAX_FILE_BYTES))
        return [(int(kit), str(path)) for kit, path in entries if str(path).isprintable()]
    except (OSError, ValueError, OverflowError, TypeError, RecursionError):
        return []


def _path() -> Path:
    return files.cache_folder() / "profiles.json"
