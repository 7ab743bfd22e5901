"""Where a DEF uses a number that stands in its brackets in place of a name: `DEF SIDE(40)`.

Its instructions have the same number, and the name that it gets belongs there, too.
"""

from __future__ import annotations

import re

from tiniscript.base.source import Source
from tiniscript.syntax.lexer import Token

_DEF_END = re.compile(r"(?i)\bEND_?DEF\b")
_PLACEHOLDER_NAME = "SIZE"  # which a message translates
_LONGEST = 60  # characters of an instruction that a message shows


def used_inside(source: Source, number: Token) -> dict[str, str]:
    """Return the number, and the first instruction in the DEF that has it, with a name there."""
    text = source.text
    head = re.compile(r"[^;\r\n]*").match(text, number.end)
    end = _DEF_END.search(text, number.end)
    is_only_number = text[number.end :].lstrip(" \t")[:1] == ")"
    if head is None or end is None or not is_only_number:
        return {}
    for each in re.compile(r"[^;\r\n]+").finditer(text, head.end(), end.start()):
        instruction = each[0].partition("//")[0].strip()
        pattern = rf"(?<![\w.]){re.escape(number.text)}(?![\w.])"
        inside = re.sub(pattern, _PLACEHOLDER_NAME, instruction.upper(), count=1)
        if inside != instruction.upper() and len(instruction) <= _LONGEST:
            return {"number": number.text, "inside": inside}
    return {}
