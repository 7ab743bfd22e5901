"""What is said of a call with too few values, or too many.

Looks at what was written. What was meant is for `recovery`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base.source import Source, Span
from tiniscript.base.words import Word
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic

LONG_TIME_S = 20  # a longer move is rarely meant: so much is a power, degrees or steps
LOWEST_HERTZ = 30
_MOST_POWER = 100
_TIME_AND_POWER = (0, 1)  # their places
_NUMBER = re.compile(r"[0-9]+(\.[0-9]+)?|\.[0-9]+")
_UNTIL = re.compile(r"(?i)\s*\bUNTIL\b.*")  # with its condition


def count_diagnostic(
    source: Source, word: Word, arguments: Sequence[Span], span: Span
) -> Diagnostic:
    """Return the diagnostic of `word` with these arguments; `span` is the place to point at."""
    texts = [source[each] for each in arguments]
    values = {
        "word": word.text,
        "usage": word.usage,
        "example": "" if texts else word.example,
        **_said_of_count(texts, word, _UNTIL.search(source[span])),
        "wanted": str(len(word.arguments)),
        "found": str(len(arguments)),
    }
    return Diagnostic(codes.ARGUMENT_COUNT, span, values)


def _said_of_count(texts: Sequence[str], word: Word, until: re.Match[str] | None) -> dict[str, str]:
    """Return what is said of a wrong number of values: `power` of F(80), `spare` of F(2, 80, 5).

    `kept` is W(2) for W(2, 80): a wait has no power. With UNTIL the time may be FOREVER.
    """
    numbers = [float(text) if _NUMBER.fullmatch(text) else -1 for text in texts]
    said = {"power": "", "spare": "", "kept": ""}
    if word.role.is_move and len(texts) == 1 and LONG_TIME_S <= numbers[0] <= _MOST_POWER:
        said["power"] = f"{word.text}( , {texts[0]})"
        if until is not None:
            said["endless"] = f"{word.text}(FOREVER, {texts[0]}){until[0]}"
        said["number"] = texts[0]
    elif len(texts) > len(word.arguments) and min(numbers) >= 0:
        is_sound = word.role.name == "beep" and numbers[1] > LOWEST_HERTZ
        if is_sound or len(word.arguments) == 1:
            said["spare"] = _call(word, texts[: len(word.arguments)])
        if word.role.is_move and numbers[0] < LONG_TIME_S <= numbers[1] <= _MOST_POWER:
            said["spare"] = _call(word, texts[:2])
        is_timed = word.role.name == "wait" and len(texts) == len(_TIME_AND_POWER)
        for first, second in (_TIME_AND_POWER, _TIME_AND_POWER[::-1]):
            if is_timed and 0 <= numbers[first] < LONG_TIME_S <= numbers[second] <= _MOST_POWER:
                said["kept"] = _call(word, [texts[first]])
    return said


def _call(word: Word, texts: Sequence[str]) -> str:
    return f"{word.text}({', '.join(texts)})"
