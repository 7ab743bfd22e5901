"""Reads instructions in brackets: `(F(1, 60), S)`, `(F(1, 60);R(1, 60))`.

Knows which pieces between two brackets are instructions, and what stands behind them. Reports
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS, Block
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.ends import arm_at, comes_later
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import TIMES
from tiniscript.syntax.suggestions import with_signs
from tiniscript.words import WORDS

_FARTHEST = 1000  # tokens in which the `)` is looked for
_BETWEEN = (";", ",", NEWLINE)


class Group(NamedTuple):
    """The pieces between two brackets, and the place behind the last one."""

    values: tuple[Sequence[Token], ...]
    orders: tuple[Sequence[Token], ...]
    end: int


class Groups:
    def __init__(self, cursor: Cursor, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.in_block = in_block

    def orders_at(self, k: int) -> Group | None:
        """Return the group that begins at `k`, if it has orders and nothing else."""
        group = self.group_at(k)
        return group if group is not None and group.orders and not group.values else None

    def group_at(self, k: int) -> Group | None:
        tokens = self.cursor.tokens
        depth, first = 0, k + 1
        values: list[Sequence[Token]] = []
        orders: list[Sequence[Token]] = []
        for i in range(k, min(len(tokens), k + _FARTHEST)):
            token = tokens[i]
            depth += (token.kind == "(") - (token.kind == ")")
            is_next = depth == 1 and i > first and self.begins_order(i)
            if (depth == 1 and i > k and token.kind in _BETWEEN) or is_next or not depth:
                piece = tokens[first:i]
                if piece:
                    (orders if self.is_order(piece) else values).append(piece)
                first = i + (not is_next)
            if not depth:
                return Group(tuple(values), tuple(orders), i + 1)
            if token.kind in (END, "{", "}"):
                break
        return None

    def is_order(self, piece: Sequence[Token]) -> bool:
        first = piece[0]
        if first.kind is not WORD:
            return False
        known = self.in_block.known
        command = known.command(first.text)
        if len(piece) == 1:
            is_alone = command is not None and command.role in ("stop", "break")
            return is_alone or first.text in ENDS
        is_call = piece[1].kind == "("
        is_block = command is not None and command.role in ("block", "arm", "end")
        is_doing = command is not None and (command.is_instruction or command.role == "actuator")
        return (is_call and (is_doing or is_block)) or first.text in ENDS

    def begins_order(self, i: int) -> bool:
        """Whether `F(` stands at `i` behind a value or an order: `LOOP(3 F(1, 50))`."""
        token, before = self.cursor.tokens[i], self.cursor.tokens[i - 1]
        known = WORDS.get(token.text) if token.kind is WORD else None
        is_call = known is not None and known.is_call and self.cursor.tokens[i + 1].kind == "("
        return is_call and (before.kind in (NUMBER, ")") or before.text in ("S", "STOP"))

    def is_head(self, word: str, piece: Sequence[Token]) -> bool:
        if word == "LOOP":
            is_value = piece[0].kind is NUMBER or self.in_block.known.is_own(piece[0].text)
            return len(piece) == 1 and (is_value or piece[0].text == "FOREVER")
        return any(each.kind in COMPARISONS for each in with_signs(piece))

    def said(self, piece: Sequence[Token]) -> str:
        return self.cursor.source[Span(piece[0].start, piece[-1].end)]

    def stands_behind(self, block: Block, k: int) -> bool:
        """Whether nothing but separators stands between the header of `block` and `k`."""
        text = self.cursor.source.text[block.span.end : self.cursor.tokens[k].start]
        return not text.strip(" \t\r\n;:")

    def end_comes(self, word: str, k: int) -> tuple[bool, int]:
        """Whether the end of a block of `word` follows at `k`, and the place behind it."""
        tokens = self.cursor.tokens
        while tokens[k].kind in (NEWLINE, ";"):
            k += 1
        return ENDS.get(tokens[k].text) == word, k + 1

    def goes_on(self, block: Block, around: Sequence[Block], k: int) -> bool:
        """Whether the end of `block` or its ELSE comes behind `k`, and not of those `around` it."""
        tokens = self.cursor.tokens
        if comes_later(block.word, [each.word for each in around], tokens, k):
            return True
        ifs = [each for each in (*around, block) if each.word == "IF" and each.otherwise is None]
        return ifs == [block] and arm_at(tokens, k)

    def place_of(self, word: Token, k: int) -> int:
        while self.cursor.tokens[k].start > word.start:
            k -= 1
        return k

    def times_behind(self, k: int) -> tuple[Token | None, int]:
        """`[F(1, 60), S] * 4`: return how often, and the place behind it."""
        tokens = self.cursor.tokens
        is_sign = tokens[k].kind == "*" or tokens[k].text in ("X", "POR")
        number = tokens[k + is_sign] if tokens[k].kind is not END else tokens[k]
        after = k + is_sign + 1
        if number.kind is not NUMBER:
            return None, k
        is_said = tokens[after].text in TIMES
        after += is_said
        return (
            (number, after) if (is_sign or is_said) and tokens[after].kind in AT_END else (None, k)
        )
