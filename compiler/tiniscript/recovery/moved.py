"""Programs whose DEFs and ends stand where they belong: a DEF before all calls and in no block.

Moves instructions as they are written. Does not know whether the moved program is right.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.recovery.meanings import WORD_OF_END
from tiniscript.recovery.writing import without_note

_SETUP = re.compile(r"\s*S[IB]\s*\|\s*", re.IGNORECASE)
_MOST_MOVES = 20
_FIRST_WORDS = re.compile(r"\s*(\w*)[ \t]*(\w*)")


class Moved(NamedTuple):
    """A program in which all DEFs stand right, and what was moved first: its lines, from 1.

    The end of `name` alone where `is_end`, else all of its block; `before` which line. `is_guess`:
    something else may be meant.
    """

    text: str
    name: str
    first: int
    last: int
    before: int
    is_end: bool
    is_guess: bool


class _Piece(NamedTuple):
    """An instruction with what stands around it, and the line that it stands in."""

    text: str
    line: int
    word: str
    name: str  # what follows the word


def ordered(text: str) -> Iterator[Moved]:
    """Give programs with DEFs and ends where they belong: DEFs at the beginning, or later."""
    setup = _SETUP.match(text)
    start = setup.end() if setup else 0
    for is_at_start in (True, False):
        if moved := _reorder(text[start:], is_at_start):
            yield moved._replace(text=text[:start] + moved.text)


def _reorder(text: str, is_at_start: bool) -> Moved | None:
    pieces = [*_pieces(text)]
    first: Moved | None = None
    is_guess = False
    for _ in range(_MOST_MOVES):
        swap, late_end = _swapped_ends(pieces), _end_too_late(pieces)
        move = swap or late_end or _late_def(pieces, is_at_start)
        if move is None:
            return first and first._replace(text=_join_pieces(pieces), is_guess=is_guess)
        begin, end, target = move
        name = next((it.name for it in pieces[begin::-1] if it.word == "DEF"), pieces[0].name)
        is_called = bool([*_calls(pieces, name, 0, len(pieces))])
        is_guess = is_guess or bool(late_end and not swap) or not (swap or is_called)
        if first is None:
            rows = [pieces[k].line for k in move]
            first = Moved(
                text, name, rows[0], rows[1], rows[2], bool(swap or late_end), is_guess=False
            )
        pieces[target : end + 1] = [*pieces[begin : end + 1], *pieces[target:begin]]
    return None


def _pieces(text: str) -> Iterator[_Piece]:
    for line, row in enumerate(text.split("\n"), 1):
        body, note = without_note(row)
        parts = [part for part in body.split(";") if part.strip()] or [""]
        for k, part in enumerate(parts):
            match = _FIRST_WORDS.match(part.upper())
            word, name = match.groups() if match else ("", "")
            piece_text = part + note if note and k + 1 == len(parts) else part.rstrip()
            yield _Piece(piece_text, line, ALIASES.get(word, word), name)


def _join_pieces(pieces: list[_Piece]) -> str:
    """Return a program in which pieces of one line stay in it, where they are neighbours."""
    text = pieces[0].text.lstrip()
    for before, piece in pairwise(pieces):
        is_near = before.line == piece.line and "//" not in before.text
        text += (";" if is_near else "\n") + piece.text
    return text


def _outermost(pieces: list[_Piece], k: int, start: int = 0) -> int:
    """Return where the block around a piece begins that none from `start` on is around."""
    depth, result = 0, k
    for place in range(start, k):
        if pieces[place].word in BLOCK_ENDS:
            result = place if not depth else result
            depth += 1
        elif pieces[place].word in WORD_OF_END:
            depth -= 1
        result = k if not depth else result
    return result


def _defs(pieces: list[_Piece]) -> Iterator[tuple[int, int]]:
    """Give the places of each DEF and of its end."""
    for k, piece in enumerate(pieces):
        if piece.word == "DEF" and piece.name:
            ends = (j for j in range(k, len(pieces)) if pieces[j].word == BLOCK_ENDS["DEF"])
            if (end := next(ends, None)) is not None:
                yield k, end


def _calls(pieces: list[_Piece], name: str, start: int, end: int) -> Iterator[int]:
    return (k for k in range(start, end) if pieces[k].word == name and not pieces[k].name)


_Move = tuple[int, int, int]


def _swapped_ends(pieces: list[_Piece]) -> _Move | None:
    """The ends of two blocks, of which the outer one ends first."""
    open_words: list[str] = []
    for k, piece in enumerate(pieces):
        if piece.word in BLOCK_ENDS:
            open_words.append(BLOCK_ENDS[piece.word])
        elif piece.word in WORD_OF_END and open_words:
            after = pieces[k + 1].word if k + 1 < len(pieces) else ""
            if open_words[-2:] == [piece.word, after] and piece.word != after:
                return k + 1, k + 1, k
            open_words.pop()
    return None


def _end_too_late(pieces: list[_Piece]) -> _Move | None:
    for k, end in _defs(pieces):
        name = pieces[k].name
        call = next(_calls(pieces, name, k + 1, end), None)
        if call is None or [*_calls(pieces, name, end, len(pieces))]:
            continue  # it may be meant to begin again
        to = _outermost(pieces, call, k + 1)
        if to > k + 1:
            return end, end, to
    return None


def _late_def(pieces: list[_Piece], is_at_start: bool) -> _Move | None:
    """A DEF below its first call, or in a block."""
    before = 0
    for k, end in _defs(pieces):
        to = _outermost(pieces, next(_calls(pieces, pieces[k].name, 0, k), k))
        to = before if is_at_start and to < k else to
        before = end + 1
        if to < k:
            return k, end, to
    return None
