"""Invisible characters that no keyboard has: their removal names them, as in `U+2028`."""

from __future__ import annotations

from unicodedata import category

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic

_INVISIBLE_CATEGORIES = ("Cc", "Cf", "Zl", "Zp")
_VISIBLE_CONTROLS = "\t\n\r"


def name_invisible_sign(diagnostic: Diagnostic, text: str) -> Diagnostic:
    """Return a mistake whose repair takes invisible signs out alone as one of such a sign."""
    edits = diagnostic.repair.edits if diagnostic.repair else ()
    pairs = [(text[slice(*edit.span)], edit.text) for edit in edits]
    pairs = pairs or [(text[slice(*diagnostic.span)], "")] * (
        diagnostic.code is codes.ODD_CHARACTER
    )
    if not pairs or not all(
        old_text != new_text == _visible_text(old_text) for old_text, new_text in pairs
    ):
        return diagnostic
    sign = next(
        character for old_text, _ in pairs for character in old_text if _is_invisible(character)
    )
    return diagnostic._replace(
        code=codes.ODD_CHARACTER, values={"found": f"U+{ord(sign):04X}", "fix": ""}
    )


def _is_invisible(sign: str) -> bool:
    return sign not in _VISIBLE_CONTROLS and category(sign) in _INVISIBLE_CATEGORIES


def _visible_text(text: str) -> str:
    return "".join(sign for sign in text if not _is_invisible(sign))
