"""The sentences of the library's errors and listings, which the catalogue `library` has.

The command has sentences of its own, which name its options.
"""

from __future__ import annotations

from collections.abc import Mapping

from tiniscript.base import languages


def sentence(reason: str, language: str, values: Mapping[str, str]) -> str:
    """Return the sentence for a reason, with its gaps filled."""
    return languages.text("library", reason, language).format(**values)
