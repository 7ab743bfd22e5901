"""Recovery of instructions in brackets: `LOOP(4);(F(1, 60);R(1, 60))`, `LOOP(F(1, 50), 4)`, `[S]`.

Knows what stands between the brackets, and which block it is the body of. One diagnostic stands for
all of it: the tokens are replaced by those that were meant, and the grammar reads on.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS, Block
from tiniscript.syntax.call_suggestions import written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.ends import arm_at, comes_later
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.phrases import TIMES
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import foreign_block, with_signs
from tiniscript.words import BLOCK_ENDS, WORDS

_FARTHEST = 1000  # tokens in which the `)` is looked for
_BETWEEN = (";", ",", NEWLINE)


class _Group(NamedTuple):
    """The pieces between two brackets, and the place behind the last one."""

    values: tuple[Sequence[Token], ...]
    orders: tuple[Sequence[Token], ...]
    end: int


class GroupRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block

    # -- where they stand ---------------------------------------------------------------------

    def alone(self, k: int) -> None:
        """`(F(2, 80), S)` at `k`, or the body of the header right before it."""
        group = self._orders_at(k)
        if group is None:
            return
        block = self.in_block.blocks.innermost
        if block is not None and not block.here and self._stands_behind(block, k):
            self.body(block, k)
        times, end = self._times_behind(group.end)
        if times is not None:
            self._loop(times, group, k, end)
        tokens = self.cursor.tokens
        fix = ";".join(self._said(each) for each in group.orders)
        fix += "" if tokens[group.end].kind in AT_END else ";"
        self._report(Span(tokens[k].start, tokens[group.end - 1].end), tokens[k], fix)
        self._read_on(k, group.end, self._row(group, k))

    def body(self, block: Block, k: int) -> None:
        """`LOOP(4)(F(1, 60), S)`: the brackets at `k` hold the body of a block that begins here."""
        group = self._orders_at(k)
        if group is None:
            return
        cursor, tokens = self.cursor, self.cursor.tokens
        right, end = BLOCK_ENDS[block.word], group.end
        is_ended, last = self._end_comes(block.word, end)
        around = self.in_block.blocks.open[:-1]
        is_going_on = not is_ended and self._goes_on(block, around, end)
        orders = ";".join(self._said(each) for each in group.orders)
        last = last if is_ended else end
        place = Span(block.span.start, tokens[last - 1].end)
        fix = ";".join((cursor.source[block.span], orders, right))
        if is_going_on:
            is_beside = not cursor.source.text[block.span.end : tokens[k].start].strip(" \t:")
            place = Span((block.span if is_beside else tokens[k]).start, place.end)
            fix = f"{cursor.source[block.span]};{orders}" if is_beside else orders
        fix += "" if tokens[last].kind in AT_END else ";"
        if not block.is_reported:
            self._report(place, tokens[k], fix)
        else:
            self.reporter.answer(tokens[k])
        row = self._row(group, k)
        if not is_ended and not is_going_on:
            span = tokens[end - 1].span
            row += [Token(WORD, right, *span), Token(";", ";", *span)]
        self._read_on(k, end, row)

    def is_body(self, k: int) -> bool:
        """Whether the bracket at `k` holds instructions: `ELSE(B(1, 50))`."""
        return self.cursor.tokens[k].kind == "(" and self._orders_at(k) is not None

    def is_whole(self, header: Block, k: int) -> bool:
        """Whether an IF with its body at `k` goes on there with ELSE, and has no end of its own."""
        group = self._orders_at(k)
        tokens = self.cursor.tokens
        if group is None or tokens[group.end].kind is not WORD or not arm_at(tokens, group.end):
            return False
        around = [each.word for each in self.in_block.blocks.open[:-1]]
        return not comes_later(header.word, around, tokens, group.end)

    def forever(self, word: Token) -> None:
        """`FOREVER(F(1, 60);R(1, 60))`."""
        group = self._orders_at(self.cursor.i + 1)
        if group is not None:
            number = Token(WORD, "FOREVER", *word.span)
            self._loop(number, group, self.cursor.i, group.end)

    def counted(self, number: Token) -> None:
        """`4 LOOP(F(1, 50))`, `4 veces (F(1, 50);S)`, `4(F(1, 50))`: behind `number`."""
        cursor = self.cursor
        k = cursor.i
        token = cursor.tokens[k]
        word = token.text if token.text in WORDS else foreign_block(token.text)
        k += token.kind == "*" or token.text in (*TIMES, "X") or word == "LOOP"
        group = self._orders_at(k) if cursor.tokens[k].kind == "(" else None
        if group is not None:
            self._loop(number, group, cursor.i - 1, group.end)

    def in_header(self, word: Token, bracket: int, said: int) -> None:
        """`LOOP(F(1, 50), 4)`, `IF(DISTANCE < 10, S)`: the body stands in the header's brackets.

        `said` diagnostics were there before the header was read.
        """
        tokens = self.cursor.tokens
        group = self._group_at(bracket) if tokens[bracket].kind == "(" else None
        if group is None or not group.orders:
            return
        right = BLOCK_ENDS.get(word.text, "")
        times, end = self._times_behind(group.end)
        if times is None and tokens[end].kind is NUMBER and tokens[end + 1].kind in AT_END:
            times, end = tokens[end], end + 1  # `LOOP(F(1, 50)) 4`
        if times is not None and word.text == "LOOP" and not group.values:
            self.reporter.withdraw(said)
            self._loop(times, group, self._place_of(word, bracket), end)
        asked = [each for each in group.values if self._is_head(word.text, each)]
        known = len(asked) == len(group.values) == 1 and bool(right)
        is_one = word.text == "LOOP" or len(group.orders) == 1
        if len(group.values) > len(asked) or len(asked) > 1 or not right:
            return
        self.reporter.withdraw(said)
        span = Span(word.start, tokens[group.end - 1].end)
        orders = ";".join(self._said(each) for each in group.orders)
        head = written(with_signs(asked[0])) if asked else ""
        block = Block(word.text, span, None, None)
        is_going_on = self._goes_on(block, self.in_block.blocks.open, group.end)
        whole = f"{word.text}({head});{orders}"
        whole += "" if is_going_on else f";{right}"
        whole += "" if tokens[group.end].kind in AT_END else ";"
        self.reporter.report(
            codes.GROUPED, span, span, word=word.text, right=right,
            fix=whole if known and is_one else "",
            head=f"{word.text}({head})" if head else WORDS[word.text].usage,
        )  # fmt: skip
        for token in tokens[bracket : group.end]:
            self.reporter.answer(token)
        row = self._row(group, bracket)
        if not is_going_on:
            last = tokens[group.end - 1].span
            row += [Token(WORD, right, *last), Token(";", ";", *last)]
        self.in_block.begin_reported(word.text, span)
        self._read_on(bracket, group.end, row)

    def line_of_def(self, block: Block) -> None:
        """`DEF TURN = R(1, 60)`: behind the sign at the cursor stands what it does."""
        tokens, k = self.cursor.tokens, self.cursor.i
        end = first = k + 1
        orders: list[Sequence[Token]] = []
        depth = 0
        while True:
            depth += (tokens[end].kind == "(") - (tokens[end].kind == ")")
            is_parted = tokens[end].kind in (";", ",") and not depth
            if is_parted or tokens[end].kind in (NEWLINE, END):
                if end > first and not self._is_order(tokens[first:end]):
                    return
                orders += [tokens[first:end]] * (end > first)
                first = end + 1
            if tokens[end].kind in (NEWLINE, END):
                break
            end += 1
        if not orders or block.name is None:
            return
        has_end = ENDS.get(orders[-1][0].text) == "DEF"
        is_ended, last = (True, end) if has_end else self._end_comes("DEF", end)
        is_later = not is_ended and self._goes_on(block, self.in_block.blocks.open[:-1], end)
        right = "" if has_end or is_later else BLOCK_ENDS["DEF"]
        texts = (f"DEF {block.name.text}", *(self._said(each) for each in orders), right)
        self.reporter.answer(tokens[k])
        place = Span(block.span.start, tokens[last - 1].end if is_ended else tokens[end - 1].end)
        fix = ";".join(filter(None, texts))
        self.reporter.report(codes.HEADER_SEPARATOR, tokens[k].span, place, fix=fix,
                             before=self.cursor.source[block.span])  # fmt: skip
        row = self._row(_Group((), tuple(orders), end), k)
        if not is_ended and not is_later:
            row.append(Token(WORD, BLOCK_ENDS["DEF"], *tokens[end - 1].span))
        self._read_on(k, end, row)

    def function_on_a_line(self, block: Block) -> None:
        """`def turn(): R(1, 60)`."""
        tokens, k = self.cursor.tokens, self.cursor.i
        if [each.text for each in tokens[k : k + 3]] == ["(", ")", ":"]:
            self.cursor.i = k + 2
            self.line_of_def(block)
            self.cursor.i = k

    def named(self, name: Token, start: int, said: int) -> None:
        """`TURN = R(1, 60)` at `start` behind the sign, where TURN alone is an instruction below.

        `said` diagnostics were there before the value was read.
        """
        tokens, end = self.cursor.tokens, start
        while tokens[end].kind not in AT_END:
            end += 1
        piece = tokens[start:end]
        if name.text in WORDS or not piece or not self._is_order(piece):
            return
        is_called = any(
            tokens[i].text == name.text
            and tokens[i - 1].kind in AT_END and tokens[i + 1].kind in AT_END
            for i in range(end, len(tokens) - 1)
        )  # fmt: skip
        if not is_called or self.in_block.blocks.open:
            return
        self.reporter.withdraw(said)
        span = Span(name.start, piece[-1].end)
        fix = f"DEF {name.text};{self._said(piece)};{BLOCK_ENDS['DEF']}"
        self.reporter.report(codes.NO_VALUE, piece[0].span, span, word=piece[0].text, fix=fix)
        self.in_block.known.add(name.text)
        last, sign = piece[-1].span, Token(";", ";", *piece[-1].span)
        head = [Token(WORD, "DEF", *name.span), name, sign]
        self._read_on(start - 2, end, [*head, *piece, sign, Token(WORD, BLOCK_ENDS["DEF"], *last)])

    # -- what stands there --------------------------------------------------------------------

    def _orders_at(self, k: int) -> _Group | None:
        """Return the group that begins at `k`, if it has orders and nothing else."""
        group = self._group_at(k)
        return group if group is not None and group.orders and not group.values else None

    def _group_at(self, k: int) -> _Group | None:
        tokens = self.cursor.tokens
        depth, first = 0, k + 1
        values: list[Sequence[Token]] = []
        orders: list[Sequence[Token]] = []
        for i in range(k, min(len(tokens), k + _FARTHEST)):
            token = tokens[i]
            depth += (token.kind == "(") - (token.kind == ")")
            is_next = depth == 1 and i > first and self._begins_order(i)
            if (depth == 1 and i > k and token.kind in _BETWEEN) or is_next or not depth:
                piece = tokens[first:i]
                if piece:
                    (orders if self._is_order(piece) else values).append(piece)
                first = i + (not is_next)
            if not depth:
                return _Group(tuple(values), tuple(orders), i + 1)
            if token.kind in (END, "{", "}"):
                break
        return None

    def _is_order(self, piece: Sequence[Token]) -> bool:
        first = piece[0]
        if first.kind is not WORD:
            return False
        known = self.in_block.known
        command = known.command(first.text)
        if len(piece) == 1:
            return command is not None and command.role in ("stop", "break")
        is_call = piece[1].kind == "("
        is_block = command is not None and command.role in ("block", "arm", "end")
        is_doing = command is not None and (command.is_instruction or command.role == "actuator")
        return (is_call and (is_doing or is_block)) or first.text in ENDS

    def _begins_order(self, i: int) -> bool:
        """Whether `F(` stands at `i` behind a value or an order: `LOOP(3 F(1, 50))`."""
        token, before = self.cursor.tokens[i], self.cursor.tokens[i - 1]
        known = WORDS.get(token.text) if token.kind is WORD else None
        is_call = known is not None and known.is_call and self.cursor.tokens[i + 1].kind == "("
        return is_call and (before.kind in (NUMBER, ")") or before.text in ("S", "STOP"))

    def _is_head(self, word: str, piece: Sequence[Token]) -> bool:
        if word == "LOOP":
            is_value = piece[0].kind is NUMBER or self.in_block.known.is_own(piece[0].text)
            return len(piece) == 1 and (is_value or piece[0].text == "FOREVER")
        return any(each.kind in COMPARISONS for each in with_signs(piece))

    def _said(self, piece: Sequence[Token]) -> str:
        return self.cursor.source[Span(piece[0].start, piece[-1].end)]

    def _stands_behind(self, block: Block, k: int) -> bool:
        """Whether nothing but separators stands between the header of `block` and `k`."""
        text = self.cursor.source.text[block.span.end : self.cursor.tokens[k].start]
        return not text.strip(" \t\r\n;:")

    def _end_comes(self, word: str, k: int) -> tuple[bool, int]:
        """Whether the end of a block of `word` follows at `k`, and the place behind it."""
        tokens = self.cursor.tokens
        while tokens[k].kind in (NEWLINE, ";"):
            k += 1
        return ENDS.get(tokens[k].text) == word, k + 1

    def _goes_on(self, block: Block, around: Sequence[Block], k: int) -> bool:
        """Whether the end of `block` or its ELSE comes behind `k`, and not of those `around` it."""
        tokens = self.cursor.tokens
        if comes_later(block.word, [each.word for each in around], tokens, k):
            return True
        ifs = [each for each in (*around, block) if each.word == "IF" and each.otherwise is None]
        return ifs == [block] and arm_at(tokens, k)

    def _place_of(self, word: Token, k: int) -> int:
        while self.cursor.tokens[k].start > word.start:
            k -= 1
        return k

    def _times_behind(self, k: int) -> tuple[Token | None, int]:
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

    # -- what is read instead -----------------------------------------------------------------

    def _loop(self, times: Token, group: _Group, start: int, end: int) -> None:
        tokens = self.cursor.tokens
        place = Span(tokens[start].start, tokens[end - 1].end)
        orders = ";".join(self._said(each) for each in group.orders)
        around = self.in_block.blocks.open
        is_going_on = self._goes_on(Block("LOOP", place, None, None), around, end)
        fix = f"LOOP({times.text});{orders}"
        fix += "" if is_going_on else f";{BLOCK_ENDS['LOOP']}"
        bracket = next(each for each in tokens[start:end] if each.kind == "(")
        self._report(place, bracket, fix)
        head = [Token(kind, text, *times.span) for kind, text in (
            (WORD, "LOOP"), ("(", "("), (times.kind, times.text), (")", ")"), (";", ";"),
        )]  # fmt: skip
        last = tokens[end - 1].span
        tail = [Token(WORD, BLOCK_ENDS["LOOP"], *last), Token(";", ";", *last)]
        row = [*head, *self._row(group, start)]
        self._read_on(start, end, row if is_going_on else [*row, *tail])

    def _row(self, group: _Group, k: int) -> list[Token]:
        """Return the orders with a `;` around each."""
        sign = Token(";", ";", *self.cursor.tokens[k].span)
        row = [sign]
        for piece in group.orders:
            row += [*piece, sign]
        return row

    def _report(self, place: Span, bracket: Token, fix: str) -> None:
        self.reporter.answer(bracket)
        self.reporter.report(codes.GROUPED, place, place, fix=fix)

    def _read_on(self, start: int, end: int, row: Sequence[Token]) -> None:
        self.cursor.tokens[start:end] = row
        self.cursor.i = start
        raise Resumed
