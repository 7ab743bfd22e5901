"""A warning for instructions that stand in a note: `F(2, 80)//R(1, 60)`.

Knows the notes of a text and what stands before them on their line. Only a note that is a row of
calls with numbers, or that has such a call behind a `;`, is taken for a slip, and only behind an
instruction, where a `;` would do: a whole line may be set aside, and behind a header or `SI|` a
note tells what comes.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tiniscript.base.source import Source
from tiniscript.base.words import WORDS
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.syntax.cursor import AT_END
from tiniscript.syntax.lexer import NEWLINE, Token

_CALL = r"(?:[FBLRM]|BEEP)\(\s*-?[0-9.]+\s*,\s*-?[0-9.]+\s*\)|W\(\s*[0-9.]+\s*\)"
_CALLS = re.compile(rf"/+\s*(?:{_CALL})(?:[;\s]*(?:{_CALL}|STOP|S))*[;\s]*", re.IGNORECASE)
_CALL_IN_IT = re.compile(rf"(?:{_CALL})|STOP|S", re.IGNORECASE)
LONGEST = 200  # characters of a note that is looked at


def in_notes(notes: Sequence[Token], tokens: Sequence[Token], source: Source) -> list[Diagnostic]:
    """Return the warnings for instructions that the robot does not do."""
    found = []
    short = [each for each in notes if len(each.text) <= LONGEST]
    if all(each.kind in AT_END for each in tokens):
        return _all_of_it(short)
    rows = [each for each in short if _CALLS.fullmatch(each.text) or swallowed(each.text)]
    is_ping = [each.text for each in tokens[:2]] == ["PING", "|"]
    depth = k = 0
    for note in rows:
        while tokens[k].start < note.start:
            depth += (tokens[k].kind == "(") - (tokens[k].kind == ")")
            k += 1
        begin = max(source.text.rfind(sign, 0, note.start) for sign in "\r\n") + 1
        if depth or not source.text[begin : note.start].strip(" \t;"):
            continue
        if _ends_instruction(tokens, k) and not is_ping:
            rest = "; ".join(swallowed(note.text))
            values = {"found": rest or note.text.strip("/; \t"), "rest": rest}
            found.append(Diagnostic(codes.IN_A_NOTE, note.span, values))
    return found


def _all_of_it(notes: Sequence[Token]) -> list[Diagnostic]:
    """Return a warning for `// I go F(1, 80); W(2)`, where the program is nothing but notes."""
    for note in notes:
        rest = "; ".join(re.findall(_CALL, note.text, re.IGNORECASE))
        if rest:
            return [Diagnostic(codes.IN_A_NOTE, note.span, {"found": rest, "rest": rest})]
    return []


def swallowed(note: str) -> list[str]:
    """Return the instructions behind the words of a note: `// voy; W(2) // compro`.

    None where a bracket stands in anything but a whole instruction: `// L va; R(1, 60) es derecha`.
    """
    first, *others = (each.strip() for each in re.split(r";|//", note.removeprefix("//")))
    found = [each for each in others if _CALL_IN_IT.fullmatch(each)]
    is_row = all(each in found or not set("()") & set(each) for each in (first, *others))
    is_row = is_row and bool(found) and found != ["S"] * len(found)
    return found if is_row and first else []


def _ends_instruction(tokens: Sequence[Token], end: int) -> bool:
    """Whether what stands before the token at `end` is an instruction, and no header nor `SI|`."""
    k = end - 1
    while k >= 0 and tokens[k].kind == ";":
        k -= 1
    if k < 0 or tokens[k].kind == "|":
        return False
    depth = 0
    while k >= 0 and (depth or tokens[k].kind not in (";", "|", NEWLINE)):
        depth += (tokens[k].kind == ")") - (tokens[k].kind == "(")
        k -= 1
    known = WORDS.get(tokens[k + 1].text)
    return known is None or known.role.name not in ("start", "block", "arm")
