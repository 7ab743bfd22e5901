"""What comes along when a program is copied from a page, a chat or a terminal.

Knows tags of HTML, entities, the fences of Markdown, prompts, and who says something in a chat.
None of them is part of a program.
"""

from __future__ import annotations

import re

_LINES = "br|p|div|li|ul|ol|tr|table|h[1-6]|pre|body|html|head|script|blockquote"
_TAGS = f"{_LINES}|code|span|strong|em|font|td|b|i|u|a"
# `[20:14] Luis: `, `21/11/2026, 20:14 - Luis: ` at the beginning of a line, for a verbose pattern.
SPEAKER = r"""(?<![^\n])(?:
                \[[^\]\r\n]{0,30}[0-9]{1,2}:[0-9]{2}[^\]\r\n]{0,20}\][ ]*[^:;()\r\n]{1,30}:[ ]?
                |[0-9]{1,2}[/.-][0-9]{1,2}[/.-][0-9]{2,4},?[ ]*[0-9]{1,2}:[0-9]{2}
                    [^:;()\r\n]{0,12}[ ]-[ ][^:;()\r\n]{1,30}:[ ]?)"""
# As a group of the lexer's pattern, which is verbose. `1<P>5` compares: no value is before a tag.
PATTERN = rf"""```[^\s`]*
            | (?i:</(?:{_TAGS})>|(?<![\w)\]])<(?:{_TAGS})(?:[ ][^<>\r\n]*)?/?>
                |<(?:br|code|span|strong|em)[ ]?/?>)
            | (?i:<!--[^>]*-->|<!doctype[^>]*>)
            | &(?:nbsp|lt|gt|amp|quot|apos|\#[0-9]{{1,5}});
            | >>>[ ]?|\$[ ](?=tsc)[^\r\n]*"""
_ENTITIES = {"&lt;": "<", "&gt;": ">", "&nbsp;": " ", "&amp;": " AND "}
_LINE_TAG = re.compile(rf"(?i)</?(?:{_LINES})\b")
_PIECE = re.compile(f"{SPEAKER} | {PATTERN}", re.VERBOSE)


def meant(piece: str) -> str:
    """Return what a piece stands for: a line end, a sign, or nothing."""
    if piece in _ENTITIES:
        return _ENTITIES[piece]
    return "\n" if _LINE_TAG.match(piece) or piece.startswith("```") else ""


def pieces(text: str) -> list[tuple[int, int, str]]:
    """Return start and end of each piece in a text outside of notes, and what it stands for."""
    found = []
    place, is_note = 0, False
    for match in _PIECE.finditer(text):
        between = text[place : match.start()]
        line_end = between.rfind("\n")
        is_note = (is_note and line_end < 0) or "//" in between[line_end + 1 :]
        place = match.end()
        if not is_note:
            found.append((*match.span(), meant(match[0])))
    return found
