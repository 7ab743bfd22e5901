"""Finds the text of a condition in the brackets of IF, WHILE or UNTIL, to write it elsewhere."""

from __future__ import annotations

import re

from tiniscript.base.source import Source, Span

LONGEST = 120  # characters of a condition that a message can hold


def written_condition(source: Source, span: Span, word: str) -> str:
    """Return what is in the brackets behind `word`, the last of that name in `span`.

    Nothing where it is long, or goes over several lines.
    """
    text = source[span]
    places = [each.end() for each in re.finditer(rf"\b{word}\s*\(", text, re.IGNORECASE)]
    if not places:
        return ""
    begin = places[-1] if word == "UNTIL" else places[0]
    depth = 1
    for k in range(begin, min(len(text), begin + LONGEST)):
        depth += (text[k] == "(") - (text[k] == ")")
        if not depth:
            condition = text[begin:k].strip()
            return "" if re.search(r"[\r\n]|//", condition) else condition
    return ""
