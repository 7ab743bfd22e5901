"""Pseudo-localization: each text a third longer and with accents, as no language has it."""

from __future__ import annotations

import re
from typing import Any

_ACCENTS = str.maketrans("aeinouAEINOU", "äéîñöûÄÉÎÑÖÛ")
_KEPT = re.compile(r"(\{[^}]*\}|%[\d%])")  # gaps, and places of values
_WORD = "lóñg"


def pseudo(content: Any) -> Any:
    """Return a text, or all texts of a file of the page, in the language that nobody speaks."""
    if isinstance(content, dict):
        return {key: pseudo(value) if key else value for key, value in content.items()}
    if isinstance(content, list):
        return [pseudo(each) for each in content]
    parts = _KEPT.split(content)
    said = "".join(each if k % 2 else each.translate(_ACCENTS) for k, each in enumerate(parts))
    size = sum(map(len, parts[::2]))
    if not re.search(r"[A-Za-z]{2}", "".join(parts[::2])):
        return said
    longer = (f"{_WORD} " * size)[: -(-size // 3)].rstrip()
    return said + longer if size < 10 else f"{said} {longer}"
