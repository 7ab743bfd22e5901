"""The canonical layout of a program's text.

Knows spaces, lines, indentation and where comments go. Works on tokens and comments, so that
numbers and brackets stay as they are written. Knows no names and looks for no mistakes: it is
made for texts whose shape `parser` finds nothing wrong with.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from tiniscript.base.source import Source
from tiniscript.base.words import ALIASES, BLOCK_ENDS
from tiniscript.syntax.lexer import NEWLINE, NUMBER, WORD, Scan, Token, scan
from tiniscript.syntax.operators import SIGNS

INDENT = "  "
COMMENT_GAP = "  "
# `//comment` becomes `// comment`. More spaces stay, and so do rulers like `/////`.
_TIGHT_COMMENT = re.compile(r"\A//(?=[^/\s])")

_ARMS = frozenset(("ELSE", "ELSEIF"))
_INDENTING_WORDS = frozenset(BLOCK_ENDS) | _ARMS  # words that indent the lines after them
_DEDENTING_WORDS = frozenset(BLOCK_ENDS.values()) | _ARMS  # indented less than the text before it
_WORD_OPERATORS = frozenset(("AND", "OR", "NOT"))
_BEFORE_VALUE = _WORD_OPERATORS | SIGNS | {"(", ","}


def format_source(source: Source) -> str:
    """Return the program in the canonical layout: the same instructions, the same comments.

    Formatting the result again changes nothing.
    """
    return "".join(line + "\n" for line in lines_of(_rows(pieces_of(scan(source.text)))))


# -- what the text is made of --------------------------------------------------------------------


class Piece:
    """An instruction, SETUP with its bar, or, if it has no tokens, a line of comment."""

    __slots__ = ("comments", "first_line", "follows_blank", "last_line", "tokens")

    def __init__(self, line: int, follows_blank: bool) -> None:
        self.tokens: list[Token] = []
        self.comments: list[str] = []  # comments inside the instruction and after it
        self.first_line = line
        self.last_line = line
        self.follows_blank = follows_blank  # whether an empty line precedes it

    @property
    def is_setup(self) -> bool:
        return bool(self.tokens) and self.tokens[-1].kind == "|"

    @property
    def is_instruction(self) -> bool:
        return bool(self.tokens) and not self.is_setup


def pieces_of(scan: Scan) -> list[Piece]:
    """Return the pieces of a text in their order. Empty instructions are none."""
    pieces: list[Piece] = []
    is_open = False  # whether the last piece is an instruction that has not ended
    open_brackets = 0  # open in it
    line = 0
    is_empty_line, follows_blank = True, False
    for token in sorted((*scan.tokens[:-1], *scan.comments), key=lambda token: token.start):
        kind = token.kind
        if kind is NEWLINE:
            follows_blank = follows_blank or (is_empty_line and not is_open)
            line += 1
            is_empty_line = True
            is_open = is_open and open_brackets > 0
            continue
        is_empty_line = False
        if kind == ";":
            is_open = False
            continue
        is_comment = kind == "comment"
        is_after_code = is_comment and any(
            piece.tokens and piece.last_line == line for piece in pieces[-1:]
        )
        if not is_open and not is_after_code:
            pieces.append(Piece(line, follows_blank))
            is_open, open_brackets, follows_blank = not is_comment, 0, False
        piece = pieces[-1]
        if is_comment:
            piece.comments.append(_TIGHT_COMMENT.sub("// ", token.text.rstrip()))
            continue
        piece.tokens.append(token._replace(text=ALIASES.get(token.text, token.text)))
        piece.last_line = line
        open_brackets += (kind == "(") - (kind == ")")
        if kind == "|":
            is_open = False
    return pieces


# -- where it goes -------------------------------------------------------------------------------


class Row(NamedTuple):
    """A line of the result without its indentation."""

    word: str  # first word of an instruction without a block
    text: str
    follows_blank: bool


def _rows(pieces: list[Piece]) -> list[Row]:
    """Return the lines that the pieces make."""
    is_single_line = is_one_line(pieces)
    groups: list[list[Piece]] = []
    for piece in pieces:
        if groups and _continues_line(groups[-1][-1], piece, is_single_line):
            groups[-1].append(piece)
        else:
            groups.append([piece])
    return [_row(group, is_single_line) for group in groups]


def is_one_line(pieces: list[Piece]) -> bool:
    """Return whether the instructions belong on one line: already there, or only one.

    A comment between SETUP and the first of them prevents this.
    """
    indexes = [k for k, piece in enumerate(pieces) if piece.is_instruction]
    if not indexes:
        return False
    first_index, last_index = indexes[0], indexes[-1]
    setup_piece = next((piece for piece in pieces[:first_index] if piece.is_setup), None)
    if setup_piece and (setup_piece.comments or setup_piece is not pieces[first_index - 1]):
        return False
    return (
        first_index == last_index or pieces[first_index].first_line == pieces[last_index].last_line
    )


def _continues_line(previous_piece: Piece, piece: Piece, is_single_line: bool) -> bool:
    """Return whether a piece continues the line of the previous one."""
    if not piece.is_instruction:
        return False
    if is_single_line:
        return bool(previous_piece.tokens)
    return previous_piece.is_setup and not previous_piece.comments and not piece.follows_blank


def _row(group: list[Piece], is_single_line: bool) -> Row:
    first_piece = group[0]
    setup = f"{first_piece.tokens[0].text}|" if first_piece.is_setup else ""
    instructions = [instruction_text(piece.tokens) for piece in group if piece.is_instruction]
    text = setup + ";".join(instructions)
    word = ""
    if instructions and not is_single_line:
        text += ";"
        word = group[-1].tokens[0].text
    comment = " ".join(group[-1].comments)
    if text and comment:
        text += COMMENT_GAP
    return Row(word, text + comment, first_piece.follows_blank)


def lines_of(rows: list[Row]) -> list[str]:
    """Return each row with its indentation, and a line end before it where a line is empty."""
    lines: list[str] = []
    previous_word = ""
    for row, depth in zip(rows, _depths(rows), strict=True):
        is_separate = (
            row.follows_blank
            and previous_word not in _INDENTING_WORDS
            and row.word not in _DEDENTING_WORDS
        )
        lines.append(("\n" if is_separate and lines else "") + INDENT * depth + row.text)
        previous_word = row.word
    return lines


def _depths(rows: list[Row]) -> list[int]:
    """Return the number of open blocks around each row; a comment has that of the next row."""
    depths: list[int] = []
    depth = 0
    for row in rows:
        depth = max(0, depth - (row.word in _DEDENTING_WORDS))
        depths.append(depth)
        depth += row.word in _INDENTING_WORDS
    for k in range(len(rows) - 2, -1, -1):
        if not rows[k].word:
            depths[k] = depths[k + 1]
    return depths


# -- within an instruction -----------------------------------------------------------------------


def instruction_text(tokens: list[Token]) -> str:
    """Return an instruction on one line, with spaces where they belong."""
    parts = [tokens[0].text]
    previous_token = tokens[0]
    is_sign = False  # whether `previous_token` is a minus that belongs to the next token
    for token in tokens[1:]:
        if _space_between(previous_token, is_sign, token):
            parts.append(" ")
        is_decimal = token.kind is NUMBER and token.text.startswith(".")
        parts.append("0" + token.text if is_decimal else token.text)
        is_sign = token.kind == "-" and previous_token.text in _BEFORE_VALUE
        previous_token = token
    return "".join(parts)


def _space_between(previous_token: Token, is_sign: bool, token: Token) -> bool:
    """Return whether two tokens are separated by a space; `is_sign`: the first is the minus of
    -X.
    """
    if is_sign or previous_token.kind in ("(", ";", "|") or token.kind in (")", ",", ";", "|"):
        return False
    if token.kind == "(":
        return previous_token.kind is not WORD or previous_token.text in _WORD_OPERATORS
    return True
