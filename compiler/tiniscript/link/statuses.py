"""A robot's answers in words: the sentence of each status, in English or Spanish.

Knows how the texts of `statuses.toml` are filled. Knows no message. Prints nothing.
"""

from __future__ import annotations

import sys
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from tiniscript.bytecode.image import REFUSALS
from tiniscript.bytecode.verify import RULES
from tiniscript.link.messages import FIRST_RULE, FIRST_STATUS, STATUS_NAMES


class Sentence(NamedTuple):
    """The message, and what to do next, which may be empty."""

    said: str
    advice: str


def name_of(status: int) -> str:
    """Return the name of a status, a refusal or a rule; the number if it is unknown."""
    if status in STATUS_NAMES:
        return STATUS_NAMES[status]
    numbered = {number: name for name, (number, _) in {**REFUSALS, **RULES}.items()}
    return numbered.get(status, str(status))


def sentence(status: int, detail: int, lang: str) -> Sentence:
    """Return the sentence for a status and its detail number."""
    name = name_of(status)
    if name in texts():
        key = name
    elif 0 < status < FIRST_STATUS:
        key = "IMAGE" if status < FIRST_RULE else "RULE"
    else:
        key = "UNKNOWN_MESSAGE"  # a newer robot has more statuses
    values = {
        "detail": str(detail),
        "kit": f"{detail:04x}",
        "version": f"{detail >> 8}.{detail & 0xFF}",
        "name": name,
    }
    words = texts()[key]
    advice = words.get(lang + "_try", "")
    return Sentence(words[lang].format(**values), advice.format(**values))


@lru_cache(maxsize=1)
def texts() -> dict[str, dict[str, str]]:
    """Return the table of `statuses.toml`."""
    if sys.version_info >= (3, 11):
        import tomllib
    else:
        import tomli as tomllib
    return tomllib.loads(Path(__file__).with_name("statuses.toml").read_text(encoding="utf-8"))
