"""A robot's answers in words: the sentence of each status, in the reader's language.

Knows how the texts of the catalogue are filled, which has IMAGE and RULE for the numbers of images
and of the verifier that have no text of their own. Knows no message. It prints nothing.

Gaps: `{detail}` is the number that follows the status, `{kit}` the same as four hexadecimal digits,
`{version}` the same as major and minor, `{name}` the name of an image's refusal or a rule.
"""

from __future__ import annotations

from typing import NamedTuple

from tiniscript.base import languages
from tiniscript.bytecode.image import REFUSALS
from tiniscript.bytecode.verify import RULES
from tiniscript.link.messages import FIRST_RULE, FIRST_STATUS, STATUS_NAMES

CATALOGUE = "statuses"


class StatusText(NamedTuple):
    """The message, and the next step, which may be empty."""

    message: str
    advice: str


def name_of(status: int) -> str:
    """Return the name of a status, a refusal or a rule; the number if it is unknown."""
    if status in STATUS_NAMES:
        return STATUS_NAMES[status]
    name_by_number = {number: name for name, (number, _) in {**REFUSALS, **RULES}.items()}
    return name_by_number.get(status, str(status))


def status_text(status: int, detail: int, language: str) -> StatusText:
    """Return the sentence for a status and its detail number."""
    name = name_of(status)
    if languages.find_text(CATALOGUE, f"{name}/said", language) is not None:
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
    message = languages.text(CATALOGUE, f"{key}/said", language)
    advice = languages.find_text(CATALOGUE, f"{key}/try", language) or ""
    return StatusText(message.format(**values), advice.format(**values))
