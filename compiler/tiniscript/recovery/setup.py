"""How a program begins: what stands for `SI|` or `SB|` in its first line. Knows no other line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.base.words import WORDS
from tiniscript.recovery import rows
from tiniscript.recovery.concepts import plain
from tiniscript.recovery.writing import without_note


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
    if sign in rows.NOTES and not re.match(r"\w+\s*\(", rest):
        sign, rest, end = "", "", match.end("head")
    is_own = head in ("SI", "SB")
    is_sign = bool(sign) and not sign.isalnum()
    is_apart = bool(sign) or body[match.end("head") : match.end()].isspace()
    is_alone = not rest and is_own and (is_sign or not sign)
    if not (is_alone or (is_own and sign in rows.BARS) or _begins(rest, is_sign, is_apart)):
        return None
    close = _close(rest) if sign == "(" else None
    close = None if close is None else match.end() + close
    is_sure = not any(each.isdecimal() for each in head + sign)
    return Setup(k, match.start("head"), end, head if is_own else "SI", close, is_sure)


def _begins(rest: str, is_sign: bool, is_apart: bool) -> bool:
    """Whether an instruction begins, and no question; a sign before it says that by itself."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", rest)
    if match is None:
        return False
    word, after = plain(match[1]), match[2]
    known = WORDS.get(word)
    if known is not None and known.role not in ("setup", "value", "operator", "function"):
        is_call = after == "(" or (is_apart and (after is not None or known.is_call))
        return is_sign or is_call or (is_apart and word == "DEF")
    return is_sign and known is None and after in ("=", "(")


def _close(text: str) -> int | None:
    """Return where the bracket closes that is open before a text."""
    depth = 1
    for k, sign in enumerate(text):
        depth += (sign == "(") - (sign == ")")
        if not depth:
            return k
    return None
