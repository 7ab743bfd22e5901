"""One message for blocks that are written as in another language.

Where several mistakes say how a block begins, goes on and ends, the first of them shows the whole
block as it is written here, and the others are left out. It is shown only where all of it is sure:
the repairs that `fixing` makes by itself, and ends of blocks that the text's indents show.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from itertools import takewhile
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import FIX_CHARACTERS
from tiniscript.repairs.accounting import lost, makes_up
from tiniscript.repairs.fixing import fixed
from tiniscript.repairs.placing import edits_of
from tiniscript.source import Source, Span, applied
from tiniscript.syntax.formatter import instruction_text, pieces_of
from tiniscript.syntax.parser import scan
from tiniscript.words import ALIASES, BLOCK_ENDS

Check = Callable[[str], list[Diagnostic]]
LONGEST = 2000  # characters of a program that is read
MANY = 30  # mistakes of it
_ROUNDS = 4  # blocks whose ends are put in, one after the other
_ENDS = frozenset(BLOCK_ENDS.values())
_ARMS = ("ELSE", "ELSEIF")
_OF_BLOCKS = frozenset((*BLOCK_ENDS, *_ENDS, *_ARMS))
_ENDLESS = re.compile(r"(?i)\b(?:LOOP\s*\(\s*FOREVER|WHILE\s*\(\s*TRUE)\s*\)")
# Mistakes of headers, arms and ends.
_STRUCTURE = frozenset((
    codes.BRACES, codes.END_ALONE, codes.END_SPLIT, codes.NEVER_ENDS, codes.SPANISH_IF,
    codes.HEADER_SEPARATOR, codes.ELSE_IF, codes.NEEDLESS_FRAME,
))  # fmt: skip
# Where the word is one of a block.
_HEADED = (codes.OTHER_LANGUAGE, codes.MISSING_OPEN, codes.FOREVER_NOT_HERE)


class _Block(NamedTuple):
    """`text` takes the place of `span`; `line` says the same."""

    span: Span
    text: str
    line: str


def with_whole_blocks(found: list[Diagnostic], source: Source, check: Check) -> list[Diagnostic]:
    """Return the diagnostics with one for blocks that several of them, or brackets, are about.

    `check` finds the diagnostics of another text.
    """
    text = source.text
    of_blocks = [each for each in found if _is_structure(each)]
    bare = [each for each in of_blocks if _is_bare(each)]
    if not of_blocks or len(text) > LONGEST or len(found) > MANY or "\r" in text:
        return found
    kinds = {each.code for each in of_blocks}
    if not bare and kinds in ({codes.NEVER_ENDS}, {codes.EMPTY_BRACKETS}):
        return found
    right, repairs = _repaired(text, check)
    is_uncovered = repairs > sum(bool(edits_of(each, source)) for each in found)
    if not (bare or is_uncovered or len(of_blocks) > 1):
        return found
    at_end = (codes.NEVER_ENDS, codes.EMPTY_BRACKETS)
    heads = [each for each in of_blocks if each.code not in at_end]
    first = (heads or of_blocks)[0]
    block = _differing(text, right, first.span.start, check)
    if block is None:
        return found
    ends = [word for word in re.findall(r"\w+", block.line.upper()) if word in _ENDS]
    said = {"whole": block.line, "block": block.text, "ends": ends[-1] if ends else ""}
    return [
        each._replace(values={**first.values, **said}, place=block.span) if each is first else each
        for each in found
        if each is first or not _is_structure(each)
    ]


def _is_structure(diagnostic: Diagnostic) -> bool:
    said = diagnostic.values
    if diagnostic.code is codes.EMPTY_BRACKETS:
        return bool(said.get("of_def"))  # `def turn():`
    if diagnostic.code in _HEADED:
        word = said.get("right") or said.get("word", "")
        return word.removesuffix("(FOREVER)") in _OF_BLOCKS
    if diagnostic.code is codes.WRONG_END:
        return bool(said.get("fix")) and not said.get("swapped")
    return diagnostic.code in _STRUCTURE


def _is_bare(diagnostic: Diagnostic) -> bool:
    """Whether curly brackets are to go, and the message does not show what comes instead."""
    return diagnostic.code is codes.BRACES and not diagnostic.values.get("fix")


def _repaired(text: str, check: Check) -> tuple[str, int]:
    """Return the program with its blocks as they are written here, and the number of repairs."""
    repairs = 0
    for _ in range(_ROUNDS):
        step = fixed(text, check)
        text = step.text
        repairs += step.repairs
        source = Source(text)
        left = [each for each in step.left if _is_structure(each)]
        heads = [each for each in left if each.code is not codes.NEVER_ENDS]
        ends = [each for each in left if _is_seen(each, source)]
        places = (edits_of(each, source) for each in (*heads, *ends[-1:]))
        edits = next(filter(None, places), None)
        if not edits:
            break
        text = applied(text, edits)
        repairs += 1
    return text, repairs


def _is_seen(diagnostic: Diagnostic, source: Source) -> bool:
    """Whether the text shows where a block ends: by its indents, or as it goes on forever."""
    number = diagnostic.values.get("line", "")
    if diagnostic.code is not codes.NEVER_ENDS or not number:
        return False
    head = source.line_text(source.position(diagnostic.span.start)[0])
    is_endless = _ENDLESS.search(source[diagnostic.span]) is not None
    return is_endless or _indent(source.line_text(int(number))) > _indent(head)


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())


def _differing(text: str, right: str, start: int, check: Check) -> _Block | None:
    """Return the blocks of `right` that differ, where one line says all of them.

    The first begins at `start` of `text`.
    """
    old, new = _lines(text), _lines(right)
    same = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(old, new, strict=False)))
    rest = zip(reversed(old[same:]), reversed(new[same:]), strict=False)
    behind = sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], rest))
    while same and _depths(new[same : len(new) - behind])[0] < 0:
        same -= 1  # up to the header
    while behind and _depths(new[same : len(new) - behind])[1] > 0:
        behind -= 1
    lines = new[same : len(new) - behind]
    line = in_one_line("\n".join(lines))
    if line.startswith("START; ") and "START" not in text.upper():
        line = line.removeprefix("START; ")  # of an empty `void setup() { }`
    if not line or len(line) > FIX_CHARACTERS:
        return None
    copied = Source("\n".join((*new[:same], line, *new[len(new) - behind :])))
    left = [each for each in check(copied.text) if each.is_mistake]
    if any(copied.position(each.span.start)[0] == same + 1 or _is_structure(each) for each in left):
        return None
    begin = sum(len(each) + 1 for each in old[:same])
    written = "\n".join(old[same : len(old) - behind])
    end = begin + len(written)
    if lost(written[max(0, start - begin) :], line) or makes_up(written, line, is_strict=True):
        return None
    return _Block(Span(begin, end), "\n".join(lines), line)


def _depths(lines: Sequence[str]) -> tuple[int, int]:
    """Return the least depth in blocks that lines have, from that of the first; and the last."""
    depth = least = 0
    for piece in pieces_of(scan("\n".join(lines))):
        word = piece.tokens[0].text if piece.is_instruction else ""
        word = ALIASES.get(word, word)
        least = min(least, depth - (word in _ENDS or word in _ARMS))
        depth += (word in BLOCK_ENDS) - (word in _ENDS)
    return least, depth


def _lines(text: str) -> list[str]:
    return text.rstrip("\n").split("\n")


def in_one_line(text: str) -> str:
    """Return the instructions of right lines of a program, without their notes."""
    pieces = [each for each in pieces_of(scan(text)) if each.tokens]
    heads = [f"{each.tokens[0].text}|" for each in pieces if each.is_setup]
    rows = [instruction_text(each.tokens) for each in pieces if each.is_instruction]
    return "".join(heads) + "; ".join(rows)
