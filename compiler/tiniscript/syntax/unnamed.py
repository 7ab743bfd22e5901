"""Numbers in the brackets of a DEF instead of names, and their uses: `DEF SIDE(40)`.

Its instructions have the same number, and the name that it gets belongs there, too.
"""

from __future__ import annotations

import re

from tiniscript.base.source import Source
from tiniscript.syntax.lexer import Token

_DEF_END = re.compile(r"(?i)\bEND_?DEF\b")
_PLACEHOLDER_NAME = "SIZE"  # name that a message translates
_MAX_CHARACTERS = 60  # characters of an instruction that a message shows


def hints_of_use(source: Source, number: Token) -> dict[str, str]:
    """Return the number, and the first instruction in the DEF that has it, with a name there."""
    text = source.text
    header_rest = re.compile(r"[^;\r\n]*").match(text, number.end)
    end_match = _DEF_END.search(text, number.end)
    is_only_number = text[number.end :].lstrip(" \t")[:1] == ")"
    if header_rest is None or end_match is None or not is_only_number:
        return {}
    for match in re.compile(r"[^;\r\n]+").finditer(text, header_rest.end(), end_match.start()):
        instruction = match[0].partition("//")[0].strip()
        pattern = rf"(?<![\w.]){re.escape(number.text)}(?![\w.])"
        renamed_instruction = re.sub(pattern, _PLACEHOLDER_NAME, instruction.upper(), count=1)
        if renamed_instruction != instruction.upper() and len(instruction) <= _MAX_CHARACTERS:
            return {"number": number.text, "inside": renamed_instruction}
    return {}
