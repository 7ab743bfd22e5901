"""Descriptions of robots with a changed line."""

from __future__ import annotations

from pathlib import Path

from tiniscript import robots

FOLDER = Path(robots.__file__).parent
TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in FOLDER.glob("*.toml")}


def edit_profile(name: str, old_text: str, new_text: str) -> str:
    """The text of a shipped profile with its first `old_text` replaced."""
    assert old_text in TEXTS[name]
    return TEXTS[name].replace(old_text, new_text, 1)
