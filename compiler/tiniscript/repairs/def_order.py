"""One message for a DEF whose block, or whose end, stands in the wrong place.

A DEF below its calls, or in another block, is moved up to the beginning, or before its first call
where it needs what comes before. An END_DEF behind the calls is moved before the first of them.
Where that leaves no mistake of theirs, all is said at once.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic
from tiniscript.diagnostics.rendering import FIX_CHARACTERS
from tiniscript.repairs.whole_blocks import LONGEST, in_one_line
from tiniscript.source import Edit, Source, Span, applied
from tiniscript.syntax.formatter import Piece, pieces_of
from tiniscript.syntax.parser import scan
from tiniscript.words import ALIASES, BLOCK_ENDS

Check = Callable[[str], list[Diagnostic]]
_ENDS = frozenset(BLOCK_ENDS.values())


class _Def(NamedTuple):
    """`first` and `last` are the places of its header and its end among the pieces."""

    name: str
    first: int
    last: int


def with_moved_defs(found: list[Diagnostic], source: Source, check: Check) -> list[Diagnostic]:
    """Return the diagnostics with one for each DEF that stands in the wrong place.

    `check` finds the diagnostics of another text.
    """
    for code in (codes.CALLS_ITSELF, codes.CALL_BEFORE_DEF, codes.DEF_NOT_TOP):
        names = {each.values.get("name", "") for each in found if each.code is code}
        for name in sorted(names) if len(source.text) <= LONGEST else ():
            found = _moved(found, code, name, source, check)
    if any(each.code is codes.DEF_NOT_TOP for each in found):
        pieces = [each for each in pieces_of(scan(source.text)) if each.tokens]
        names = {each.tokens[1].text for each in pieces if _word(each) == "DEF" and each.tokens[1:]}
        return [each for each in found if not _is_unknown(each, names, source)]
    return found


def _is_unknown(diagnostic: Diagnostic, names: set[str], source: Source) -> bool:
    is_word = diagnostic.code in (codes.UNKNOWN_WORD, codes.WHICH_WAY)
    return is_word and source[diagnostic.span].upper() in names


def _moved(
    found: list[Diagnostic], code: codes.Code, name: str, source: Source, check: Check
) -> list[Diagnostic]:
    of_it = [each for each in found if each.code is code and each.values.get("name", "") == name]
    others = [each for each in found if each not in of_it[1:]]  # the same is said once
    pieces = [each for each in pieces_of(scan(source.text)) if each.tokens]
    one = _def_at(pieces, of_it[0].span) if not name else _def_of(pieces, name)
    if one is None:
        return others
    is_late = code is codes.CALLS_ITSELF
    before = [each for each in found if each.is_mistake and each not in of_it]
    unknown = [each for each in before if each.values.get("found", "").upper() == one.name]
    if code is codes.DEF_NOT_TOP and not _is_used_around(pieces, one):
        return others
    ways = _end_moved(pieces, one, source) if is_late else _block_moved(pieces, one, source)
    down = _calls_moved(pieces, one, source) if code is codes.CALL_BEFORE_DEF else []
    for edits in (*ways, *down):
        new = applied(source.text, edits)
        after = [each for each in check(new) if each.is_mistake]
        if len(after) <= len(before) - len(unknown):
            break
    else:
        return others
    line = in_one_line(new) if not after else ""
    is_down = edits in down
    target = edits[-1].span.start if is_late else edits[0].span.start
    first, last = (str(_line(source, pieces[k])) for k in (one.first, one.last))
    lines = {"first": first, "last": last} if first != last or is_late else {"row": first}
    lines = {"down": last} if is_down else lines
    values = {
        **of_it[0].values, **lines, "name": one.name, "block": new,
        "whole": line if len(line) <= FIX_CHARACTERS else "",
        "line": str(source.position(target)[0]),
    }  # fmt: skip
    said = of_it[0]._replace(values=values, place=Span(0, len(source.text)))
    return [said if each is of_it[0] else each for each in others if each not in unknown]


def _line(source: Source, piece: Piece) -> int:
    return source.position(piece.tokens[0].start)[0]


def _word(piece: Piece) -> str:
    text = piece.tokens[0].text if piece.is_instruction else ""
    return ALIASES.get(text, text)


def _def_of(pieces: Sequence[Piece], name: str) -> _Def | None:
    """Return the DEF of this name, if its end is known."""
    for k, piece in enumerate(pieces):
        if _word(piece) == "DEF" and [each.text for each in piece.tokens[1:]] == [name]:
            for end in range(k + 1, len(pieces)):
                if _word(pieces[end]) == "DEF":
                    break
                if _word(pieces[end]) == BLOCK_ENDS["DEF"]:
                    return _Def(name, k, end)
    return None


def _def_at(pieces: Sequence[Piece], span: Span) -> _Def | None:
    for piece in pieces:
        if piece.tokens[0].start == span.start and len(piece.tokens) == 2:
            return _def_of(pieces, piece.tokens[1].text)
    return None


def _end_moved(pieces: Sequence[Piece], one: _Def, source: Source) -> list[list[Edit]]:
    """Return the changes that put END_DEF before the first instruction with a call in the DEF.

    There are none where the DEF is called below, too: it may be meant to begin again.
    """
    if any(_word(each) == one.name for each in pieces[one.last :]):
        return []
    target = _first_call(pieces, one.name, one.first + 1)
    if target <= one.first + 1:
        return []  # nothing would be left in the DEF
    end = source[Span(pieces[one.last].tokens[0].start, pieces[one.last].tokens[-1].end)]
    return [
        [_gone(pieces, one.last, one.last, source.text), _put(end, pieces[target], source.text)]
    ]


def _block_moved(pieces: Sequence[Piece], one: _Def, source: Source) -> list[list[Edit]]:
    """Return the changes that put the DEF before the first instruction, or its first call."""
    start = next(k for k, each in enumerate(pieces) if each.is_instruction)
    block = source[Span(pieces[one.first].tokens[0].start, pieces[one.last].tokens[-1].end)]
    gone = _gone(pieces, one.first, one.last, source.text)
    places = dict.fromkeys((start, _first_call(pieces, one.name, start)))
    return [[_put(block, pieces[k], source.text), gone] for k in places if k < one.first]


def _calls_moved(pieces: Sequence[Piece], one: _Def, source: Source) -> list[list[Edit]]:
    """Return the changes that put the calls, and what follows them, behind the end of the DEF.

    There are none where other instructions stand between, or notes that belong to the calls.
    """
    start = next(k for k, each in enumerate(pieces) if each.is_instruction)
    first = _first_call(pieces, one.name, start)
    below = next((k for k in range(first, one.last) if _word(pieces[k]) == "DEF"), first)
    last = pieces[one.last].tokens[-1].end
    depth = 0
    for piece in pieces[below : one.last + 1]:
        depth += (_word(piece) == "DEF") - (_word(piece) == BLOCK_ENDS["DEF"])
        if not depth and _word(piece) != BLOCK_ENDS["DEF"]:
            return []
    gone = Span(pieces[first].tokens[0].start, pieces[below].tokens[0].start)
    calls = source[gone].rstrip("; \t\r\n")
    if "//" in source[gone] or not calls:
        return []
    between = "\n" if "\n" in source.text else "; "
    return [[Edit(gone, ""), Edit(Span(last, last), between + calls)]]


def _is_used_around(pieces: Sequence[Piece], one: _Def) -> bool:
    """Whether something stays in the block around a DEF, and a LOOP, IF or WHILE calls it."""
    depth, start = 0, one.first
    while start > 0 and depth >= 0:
        start -= 1
        depth += (_word(pieces[start]) in _ENDS) - (_word(pieces[start]) in BLOCK_ENDS)
    depth, end = 0, one.last
    while end < len(pieces) - 1 and depth >= 0:
        end += 1
        depth += (_word(pieces[end]) in BLOCK_ENDS) - (_word(pieces[end]) in _ENDS)
    stays = (*pieces[start + 1 : one.first], *pieces[one.last + 1 : end])
    if _word(pieces[start]) == "DEF":
        return bool(stays)
    return any(_word(each) == one.name for each in stays)


def _first_call(pieces: Sequence[Piece], name: str, start: int) -> int:
    """Return the place of the first instruction from `start` on that calls, or has a call in it."""
    depth, place = 0, start
    for k in range(start, len(pieces)):
        word = _word(pieces[k])
        place = k if not depth else place
        if word == name:
            break
        depth += (word in BLOCK_ENDS) - (word in _ENDS)
    return place


def _put(new: str, piece: Piece, text: str) -> Edit:
    """Put instructions before a piece: on lines of their own where it begins one."""
    start = piece.tokens[0].start
    line = text[text.rfind("\n", 0, start) + 1 : start]
    is_first = not line.strip() or line.rstrip().endswith("|")
    indent = "" if line.strip() else line
    is_alone = is_first and "\n" in text
    return Edit(Span(start, start), f"{new}\n{indent}" if is_alone else f"{new}; ")


def _gone(pieces: Sequence[Piece], first: int, last: int, text: str) -> Edit:
    """Take pieces out, with their lines where nothing else stands there."""
    start, end = pieces[first].tokens[0].start, pieces[last].tokens[-1].end
    while text[end : end + 1] in (";", " ", "\t"):
        end += 1
    begin = text.rfind("\n", 0, start) + 1
    if text[end : end + 1] in ("\r", "\n", "") and not text[begin:start].strip():
        return Edit(Span(max(0, begin - 1), end), "") if begin else Edit(Span(0, end + 1), "")
    return Edit(Span(start, end), "")
