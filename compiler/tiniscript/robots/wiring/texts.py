"""The texts of a wiring page: the catalogue `wiring`, which includes the drivers' sentences."""

from __future__ import annotations

from tiniscript.base import languages


def has_text(key: str) -> bool:
    return languages.find_text("wiring", key, languages.SOURCE_LANGUAGE) is not None


def text(key: str, language: str, default: str = "") -> str:
    """Return a text; `default` where the key has none and a name stands for itself."""
    return (
        languages.find_text("wiring", key, language)
        or default
        or languages.text("wiring", key, language)
    )
