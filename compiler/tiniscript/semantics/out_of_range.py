"""Says what was meant where a number does not fit: `F(-2, 80)`, `BEEP(440, 1)`, `F(2, 200)`.

Knows the call as it is written. A repair is given where the numbers leave no doubt; else an example
with the number that fits.
"""

from __future__ import annotations

from tiniscript.fixed_point import as_text
from tiniscript.source import Source
from tiniscript.syntax import ast
from tiniscript.syntax.call_suggestions import LONG_TIME_S, LOWEST_HERTZ
from tiniscript.words import OTHER_WAY, WORDS, Word

_LOW_TONE = 150  # hertz: a note that is no round number, as powers are
_ROUND = 50


def meant(source: Source, node: ast.Command, word: Word) -> dict[str, str]:
    """Return the values of a diagnostic, "" for none: `fix`, or an example."""
    arguments = node.arguments or ()
    texts = [source[each.span] for each in arguments]
    values = {"fix": "", "most": "", "tone": "", "sound": ""}
    if len(texts) != 2 or not all(each.is_plain for each in arguments):
        return values
    first, second = texts
    is_short = first.replace(".", "", 1).isdecimal() and float(first) < LONG_TIME_S
    if word.role == "beep":
        if _is_whole(first) > LOWEST_HERTZ:
            values["fix"] = f"{word.text}({second}, {first})"
        elif is_short:
            values["tone"] = f"{word.text}({first}, {WORDS['BEEP'].arguments[1].sample})"
    elif word.role == "move" and word.text in OTHER_WAY:
        if sum(text.startswith("-") for text in texts) == 1:
            shown = ", ".join(text.lstrip("- ") for text in texts)
            values["fix"] = f"{OTHER_WAY[word.text]}({shown})"
        elif word.text == "B" and is_short and _is_note(second):
            values["sound"] = f"BEEP({first}, {second})"
        elif is_short:
            values["most"] = f"{word.text}({first}, {as_text(word.arguments[1].high)})"
    return values


def _is_whole(text: str) -> int:
    """Return a whole number, 0 for anything else."""
    return int(text[:9]) if text.isdecimal() else 0


def _is_note(text: str) -> bool:
    """Whether a number is rather a tone than a power: 440, but not 200."""
    return _is_whole(text) >= _LOW_TONE and _is_whole(text) % _ROUND != 0
