"""Descriptions of robots with a changed line."""

from __future__ import annotations

from pathlib import Path

from tiniscript import robots

FOLDER = Path(robots.__file__).parent
TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in FOLDER.glob("*.toml")}


def edit_profile(name: str, old: str, new: str) -> str:
    """The text of a shipped profile with its first `old` replaced."""
    assert old in TEXTS[name]
    return TEXTS[name].replace(old, new, 1)
