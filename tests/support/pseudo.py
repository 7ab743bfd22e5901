"""Pseudo-localization: each text a third longer and with accents, as no language has it."""

from __future__ import annotations

import re
from typing import Any

_ACCENTS = str.maketrans("aeinouAEINOU", "äéîñöûÄÉÎÑÖÛ")
_KEPT_PARTS = re.compile(r"(\{[^}]*\}|%[\d%])")  # gaps, and places of values
_WORD = "lóñg"


def pseudo(content: Any) -> Any:
    """Return a text, or all texts of a file of the page, in the pseudo language."""
    if isinstance(content, dict):
        return {key: pseudo(value) if key else value for key, value in content.items()}
    if isinstance(content, list):
        return [pseudo(value) for value in content]
    parts = _KEPT_PARTS.split(content)
    text = "".join(part if k % 2 else part.translate(_ACCENTS) for k, part in enumerate(parts))
    size = sum(map(len, parts[::2]))
    if not re.search(r"[A-Za-z]{2}", "".join(parts[::2])):
        return text
    longer = (f"{_WORD} " * size)[: -(-size // 3)].rstrip()
    return text + longer if size < 10 else f"{text} {longer}"
