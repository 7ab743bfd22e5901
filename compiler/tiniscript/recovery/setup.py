"""How a program begins: what stands for `SI|` or `SB|` in its first line. Knows no other line."""

from __future__ import annotations

import re

from tiniscript.base.source import Edit, Span
from tiniscript.base.words import WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery import rows
from tiniscript.recovery.meanings import plain
from tiniscript.recovery.writing import without_note

_INSIDE = re.compile(r"(?:[^()]|\([^()]*\))*(?=\))")  # brackets that are open before it


def setup(text: str) -> Diagnostic | None:
    """Return what is told of the beginning of a program where something stands for its `SI|`."""
    start = len(text) - len(text.lstrip())
    line = text[start:].split("\n", 1)[0]
    body = without_note(line)[0]
    match = re.match(rows.SETUP, body)
    if match is None or match["sep"].strip() == "|":
        return None
    head, sign, rest = plain(match["head"]), match["sep"].strip(), body[match.end() :]
    end = match.end("head") + len(match["sep"].rstrip())
    is_own = head in ("SI", "SB")
    is_begun = is_own and (not rest or sign in rows.BARS)
    is_apart = match.end() > match.end("head")
    is_sealed = "~" in line[end:]  # what has a checksum is copied again
    if is_sealed or not (is_begun or _begins(rest, sign, is_apart)):
        return None
    head_meant = head if is_own else "SI"
    fix = head_meant + "|"
    span = Span(start, start + end)
    edits = [Edit(span, fix)]
    if sign == "(" and (inside := _INSIDE.match(rest)):
        close = start + match.end() + inside.end()
        edits.append(Edit(Span(close, close + 1), ""))
        fix += text[span.end : close]
    said = {"found": head_meant, "letter" if sign.isalpha() else "sign": sign, "fix": fix}
    is_sure = not any(each.isdecimal() for each in head + sign)
    return Diagnostic(codes.SETUP_NEEDS_BAR, span, said, None, Repair(tuple(edits), is_sure))


def _begins(rest: str, sign: str, is_apart: bool) -> bool:
    """Whether an instruction begins, and no condition; a sign before it says that by itself."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", rest)
    if match is None:
        return False
    word, after = plain(match[1]), match[2]
    known = WORDS.get(word)
    if known is None:
        return bool(sign) and after in ("=", "(")
    is_apart = is_apart and (after is not None or known.role.is_call or word == "DEF")
    return known.role.begins and (bool(sign) or after == "(" or is_apart)
