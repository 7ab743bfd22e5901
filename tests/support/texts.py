"""What is said, of all catalogues."""

from __future__ import annotations

from functools import cache

from tiniscript.base.languages import languages, texts

LANGUAGES = languages()


@cache
def said(language: str, name: str = "command") -> dict[str, str]:
    """Return all texts of a catalogue by key; of one with a plural, its last form."""
    found = texts(name, language)
    return {
        key: value if isinstance(value, str) else value["other"] for key, value in found.items()
    }


def in_all(key: str) -> list[str]:
    """Return a text of the command in each language, English first."""
    return [said(language)[key] for language in languages()]
