"""The shipped worlds, and how a world is found by name or by file."""

from __future__ import annotations

from pathlib import Path

from tiniscript import robots
from tiniscript.robots.profile import ProfileRefused
from tiniscript.robots.refusals import shown
from tiniscript.virtual.world import World, WorldRefused
from tiniscript.virtual.world_reader import read
from tiniscript.words import nearest

DEFAULT = "obstacles"
FOLDER = Path(__file__).with_name("worlds")


def names() -> list[str]:
    """Return the names of the shipped worlds, the default first."""
    found = [path.stem for path in FOLDER.glob("*.toml")]
    return sorted(found, key=lambda name: (name != DEFAULT, name))


def load(name_or_path: str) -> World:
    """Return a shipped world (upper or lower case), or the one that a TOML file describes.

    `robots.load` says which names are files. Raises only WorldRefused.
    """
    if name_or_path.lower() in names():
        name = name_or_path.lower()
        return read((FOLDER / f"{name}.toml").read_text(encoding="utf-8"), name)
    if robots.is_path(name_or_path):
        try:
            text = robots.text_of(name_or_path)
        except ProfileRefused as refused:
            raise WorldRefused(*refused.reasons) from None
        return read(text, Path(name_or_path).stem)
    values = {"name": shown(name_or_path), "known": ", ".join(names())}
    near = nearest(name_or_path.lower(), names()) or ""
    raise WorldRefused(("no_such_world", {**values, "near": near}))
