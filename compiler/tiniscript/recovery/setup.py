"""How a program begins: what stands for its `SI|`, or above it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span, apply_edits
from tiniscript.base.words import WORDS, lexicon_meaning
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.diagnostics.fixing import is_better
from tiniscript.recovery import lines, rows
from tiniscript.recovery.meanings import Names, lexemes, plain
from tiniscript.recovery.writing import without_note

SEAL = "~"  # begins a checksum: what has one is copied again
_LONGEST = 4_000  # characters of a first line that are read
_CALL = re.compile(r"(?i)\s*(?:[FBLRMW]|BEEP)\s*\(")
_BEGUN, _ROW = re.compile(r"(?im)^\s*S[IB]\s*\|"), re.compile(r"\S[^\n]*")
_INSIDE = re.compile(r"(?:[^()]|\([^()]*\))*(?=\))")  # brackets that are open before it


Check = Callable[[str], Sequence[Diagnostic]]


def beginning(
    source: Source, diagnostics: Sequence[Diagnostic], check: Check, kit: Kit
) -> list[Diagnostic]:
    """Return what is told of a text by the way that it begins: with it the rest is read."""
    text = setup(source.text)
    if text and text.repair:
        after = check(apply_edits(source.text, text.repair.edits))
        is_call = _CALL.match(source.text, text.repair.edits[0].span.end) is not None
        if is_call or is_better(after, diagnostics, text.repair.edits):
            return [text]
    return _titles(source, kit)


def other_word(source: Source, diagnostics: Sequence[Diagnostic]) -> Diagnostic | None:
    """Return what is told of a word before the bar that is no `SI`."""
    first = lexemes(source.text[:_LONGEST].lstrip().partition("\n")[0])[:1]
    is_own = SEAL in source.text or (first and first[0].text in ("SI", "SB"))
    message = (diagnostic for diagnostic in diagnostics if diagnostic.code is codes.SETUP_UNKNOWN)
    return None if is_own else next(message, None)


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
    if SEAL in line[end:] or not (is_begun or _begins_instruction(rest, sign, is_apart)):
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
    is_sure = not any(item.isdecimal() for item in head + sign)
    return Diagnostic(codes.SETUP_NEEDS_BAR, span, said, None, Repair(tuple(edits), is_sure))


def _begins_instruction(rest: str, sign: str, is_apart: bool) -> bool:
    """Whether an instruction begins, and no condition; a sign before it says that by itself."""
    match = re.match(r"([^\W\d]\w*)\s*(\(|=|;|$)?", rest)
    if match is None:
        return False
    word, after = plain(match[1]), match[2]
    known = WORDS.get(word)
    if known is None:
        return bool(sign) and after in ("=", "(")
    is_apart = is_apart and (after is not None or known.is_call or word == "DEF")
    return known.role.begins and (bool(sign) or after == "(" or is_apart)


def _titles(source: Source, kit: Kit) -> list[Diagnostic]:
    """Return lines before `SI|` that are none of a program: its title, who wrote it."""
    match = _BEGUN.search(source.text)
    diagnostics: list[Diagnostic] = []
    for row in _ROW.finditer(source.text[: match.start() if match else 0]):
        title = without_note(row[0])[0].strip()
        words = lexemes(title)
        if not words:
            continue
        is_set = lexicon_meaning(words[0].text, "set") or title.lower().startswith("#define")
        if is_set or lines.is_right(words, Names([], kit)) or "(" in title or "{" in title:
            return []
        span, fix = Span(row.start(), row.start() + len(title)), f"// {title}"
        values = {"command": title} if words[0].text == "TSC" else {"fix": fix}
        diagnostics.append(
            Diagnostic(codes.PROSE, span, values, span, Repair((Edit(span, fix),), False))
        )
    return diagnostics
