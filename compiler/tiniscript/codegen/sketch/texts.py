"""What a sketch says in words, and what its functions are called: the catalogue `sketch`."""

from __future__ import annotations

import re

from tiniscript.base.languages import found, keys, text

# What has a name of its own in each language, and the parameters and variables of helpers.
IDENTIFIERS, LOCALS = (
    [key.partition("/")[2] for key in keys("sketch") if key.startswith(kind)]
    for kind in ("name/", "local/")
)
_LOCAL = re.compile(rf"(?<![$\w.])({'|'.join(LOCALS)})(?!\w)")


def said(key: str, language: str) -> str:
    """Return a note, or nothing where nothing is said."""
    return found("sketch", f"said/{key}", language) or ""


def called(key: str, language: str) -> str:
    """Return what something is called; other names stay what they are."""
    return found("sketch", f"name/{key}", language) or key


def with_locals(code: str, language: str) -> str:
    """Return a helper whose parameters and own variables are called as in the language."""
    return _LOCAL.sub(lambda match: text("sketch", f"local/{match[1]}", language), code)
