"""How a program begins: what stands for `SI|` or `SB|` in its first line. Knows no other line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.words import WORDS
from tiniscript.recovery import rows
from tiniscript.recovery.concepts import plain
from tiniscript.recovery.writing import without_note

_INSIDE = re.compile(r"(?:[^()]|\([^()]*\))*(?=\))")  # brackets that are open before it


class Setup(NamedTuple):
    """Of line `line`, from 0, columns `start` to `end` are `head` and the bar.

    `close` is the column of the `)` that belongs to a `(` in the bar's place, None without one.
    `is_sure`: no digit stands in their place.
    """

    line: int
    start: int
    end: int
    head: str
    close: int | None
    is_sure: bool

    @property
    def right(self) -> str:
        return self.head + "|"


def setup(lines: Sequence[str]) -> Setup | None:
    """Return what stands for `SI|` at the beginning of a program, None where nothing does."""
    k = next((k for k, line in enumerate(lines) if line.strip()), 0)
    body = without_note(lines[k])[0] if lines else ""
    match = re.match(rows.SETUP, body)
    if match is None or match["sep"].strip() == "|":
        return None
    head, sign, rest = plain(match["head"]), match["sep"].strip(), body[match.end() :]
    end = match.end("head") + len(match["sep"].rstrip())
    is_own = head in ("SI", "SB")
    is_apart = match.end() > match.end("head")
    if not ((is_own and (not rest or sign in rows.BARS)) or _begins(rest, sign, is_apart)):
        return None
    inside = _INSIDE.match(rest) if sign == "(" else None
    close = match.end() + inside.end() if inside else None
    is_sure = not any(each.isdecimal() for each in head + sign)
    return Setup(k, match.start("head"), end, head if is_own else "SI", close, is_sure)


def _begins(rest: str, sign: str, is_apart: bool) -> bool:
    """Whether an instruction begins, and no question; a sign before it says that by itself."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", rest)
    if match is None:
        return False
    word, after = plain(match[1]), match[2]
    known = WORDS.get(word)
    if known is None:
        return bool(sign) and after in ("=", "(")
    is_apart = is_apart and (after is not None or known.is_call or word == "DEF")
    is_order = known.role not in ("setup", "value", "operator", "function")
    return is_order and (bool(sign) or after == "(" or is_apart)
