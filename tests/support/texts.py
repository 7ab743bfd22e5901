"""What is said, of all catalogues."""

from __future__ import annotations

from functools import cache

from tiniscript.base.catalogue_compiler import merged
from tiniscript.base.languages import files, languages

LANGUAGES = languages()


@cache
def said(language: str, name: str = "command") -> dict[str, str]:
    """Return all texts of a catalogue by key; of one with a plural, its last form."""
    return {key: forms[-1] for key, forms in merged(*files(name, language))[1].items()}


def in_all(key: str) -> list[str]:
    """Return a text of the command in each language, English first."""
    return [said(language)[key] for language in languages()]
