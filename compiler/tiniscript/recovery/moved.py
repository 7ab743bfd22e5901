"""Programs whose DEFs and ends are where they belong: a DEF before all calls and in no block.

Moves instructions as they are written. Does not know whether the moved program is right.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import pairwise
from typing import NamedTuple

from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.recovery.writing import split_note
from tiniscript.syntax.blocks import WORD_OF_END

_SETUP = re.compile(r"\s*S[IB]\s*\|\s*", re.IGNORECASE)
_MAX_MOVES = 20
_FIRST_WORDS = re.compile(r"\s*(\w*)[ \t]*(\w*)")


class MovedProgram(NamedTuple):
    """A program with all DEFs in the right place, and the first moved part: its lines, from 1.

    Moves only the end of `name` if `moves_only_end`, otherwise all of its block, to `target_line`.
    `is_guess`: the person may have meant something else.
    """

    text: str
    name: str
    first_line: int
    last_line: int
    target_line: int
    moves_only_end: bool
    is_guess: bool


class _Piece(NamedTuple):
    """An instruction with the text around it, and its line."""

    text: str
    line: int
    word: str
    name: str  # the text after the word


def reorder_defs(text: str) -> Iterator[MovedProgram]:
    """Yield programs with DEFs and ends moved to valid places: to the beginning, or later."""
    setup_match = _SETUP.match(text)
    start = setup_match.end() if setup_match else 0
    for is_at_start in (True, False):
        if moved_program := _reorder(text[start:], is_at_start):
            yield moved_program._replace(text=text[:start] + moved_program.text)


def _reorder(text: str, is_at_start: bool) -> MovedProgram | None:
    pieces = [*_pieces(text)]
    first_move: MovedProgram | None = None
    is_guess = False
    for _ in range(_MAX_MOVES):
        swap, late_end = _swapped_ends(pieces), _late_end(pieces)
        move = swap or late_end or _late_def(pieces, is_at_start)
        if move is None:
            return first_move and first_move._replace(text=_join_pieces(pieces), is_guess=is_guess)
        start, end, target = move
        name = next(
            (piece.name for piece in pieces[start::-1] if piece.word == "DEF"), pieces[0].name
        )
        is_called = bool([*_call_indexes(pieces, name, 0, len(pieces))])
        is_guess = is_guess or bool(late_end and not swap) or not (swap or is_called)
        if first_move is None:
            line_numbers = [pieces[k].line for k in move]
            first_move = MovedProgram(
                text,
                name,
                line_numbers[0],
                line_numbers[1],
                line_numbers[2],
                bool(swap or late_end),
                is_guess=False,
            )
        pieces[target : end + 1] = [*pieces[start : end + 1], *pieces[target:start]]
    return None


def _pieces(text: str) -> Iterator[_Piece]:
    for line_number, line_text in enumerate(text.split("\n"), 1):
        body, note = split_note(line_text)
        parts = [part for part in body.split(";") if part.strip()] or [""]
        for k, part in enumerate(parts):
            match = _FIRST_WORDS.match(part.upper())
            word, name = match.groups() if match else ("", "")
            piece_text = part + note if note and k + 1 == len(parts) else part.rstrip()
            yield _Piece(piece_text, line_number, ALIASES.get(word, word), name)


def _join_pieces(pieces: list[_Piece]) -> str:
    """Return a program in which pieces of one line stay in it, where they are neighbours."""
    text = pieces[0].text.lstrip()
    for previous_piece, piece in pairwise(pieces):
        is_near = previous_piece.line == piece.line and "//" not in previous_piece.text
        text += (";" if is_near else "\n") + piece.text
    return text


def _outermost_start(pieces: list[_Piece], k: int, start: int = 0) -> int:
    """Return the start of the outermost block around a piece that begins before `start`."""
    depth, outermost = 0, k
    for index in range(start, k):
        if pieces[index].word in BLOCK_ENDS:
            outermost = index if not depth else outermost
            depth += 1
        elif pieces[index].word in WORD_OF_END:
            depth -= 1
        outermost = k if not depth else outermost
    return outermost


def _def_ranges(pieces: list[_Piece]) -> Iterator[tuple[int, int]]:
    """Yield the start and end of each DEF."""
    for k, piece in enumerate(pieces):
        if piece.word == "DEF" and piece.name:
            ends = (j for j in range(k, len(pieces)) if pieces[j].word == BLOCK_ENDS["DEF"])
            if (end := next(ends, None)) is not None:
                yield k, end


def _call_indexes(pieces: list[_Piece], name: str, start: int, end: int) -> Iterator[int]:
    return (k for k in range(start, end) if pieces[k].word == name and not pieces[k].name)


_Move = tuple[int, int, int]


def _swapped_ends(pieces: list[_Piece]) -> _Move | None:
    """Return the ends of two blocks if the outer one ends first."""
    open_words: list[str] = []
    for k, piece in enumerate(pieces):
        if piece.word in BLOCK_ENDS:
            open_words.append(BLOCK_ENDS[piece.word])
        elif piece.word in WORD_OF_END and open_words:
            next_word = pieces[k + 1].word if k + 1 < len(pieces) else ""
            if open_words[-2:] == [piece.word, next_word] and piece.word != next_word:
                return k + 1, k + 1, k
            open_words.pop()
    return None


def _late_end(pieces: list[_Piece]) -> _Move | None:
    for k, end in _def_ranges(pieces):
        name = pieces[k].name
        call = next(_call_indexes(pieces, name, k + 1, end), None)
        if call is None or [*_call_indexes(pieces, name, end, len(pieces))]:
            continue  # this may be meant as a new beginning
        target = _outermost_start(pieces, call, k + 1)
        if target > k + 1:
            return end, end, target
    return None


def _late_def(pieces: list[_Piece], is_at_start: bool) -> _Move | None:
    """A DEF below its first call, or in a block."""
    def_end = 0
    for k, end in _def_ranges(pieces):
        target = _outermost_start(pieces, next(_call_indexes(pieces, pieces[k].name, 0, k), k))
        target = def_end if is_at_start and target < k else target
        def_end = end + 1
        if target < k:
            return k, end, target
    return None
