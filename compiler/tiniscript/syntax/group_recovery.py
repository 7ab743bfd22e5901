"""Recovery of instructions in brackets: `LOOP(4);(F(1, 60);R(1, 60))`, `LOOP(F(1, 50), 4)`, `[S]`.

Knows what stands between the brackets, and which block it is the body of. One diagnostic stands for
all of it: the tokens are replaced by those that were meant, and the grammar reads on.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.amounts import is_amount
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS, HEADERS, Block
from tiniscript.syntax.call_suggestions import written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.groups import Group, Groups
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.near import ASKING, near_at
from tiniscript.syntax.one_line import line_of_block
from tiniscript.syntax.phrases import TIMES
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.syntax.suggestions import foreign_block, with_signs
from tiniscript.words import BLOCK_ENDS, WORDS


class GroupRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self.seen = Groups(cursor, in_block)

    # -- where they stand ---------------------------------------------------------------------

    def alone(self, k: int) -> None:
        """`(F(2, 80), S)` at `k`, or the body of the header right before it."""
        group = self.seen.orders_at(k)
        if group is None:
            return
        block = self.in_block.blocks.innermost
        if block is not None and not block.here and self.seen.stands_behind(block, k):
            self.body(block, k)
        times, end = self.seen.times_behind(group.end)
        if times is not None:
            self._loop(times, group, k, end)
        tokens = self.cursor.tokens
        fix = ";".join(self.seen.said(each) for each in group.orders)
        fix += "" if tokens[group.end].kind in AT_END else ";"
        self._report(Span(tokens[k].start, tokens[group.end - 1].end), tokens[k], fix)
        self._read_on(k, group.end, self._row(group, k))

    def body(self, block: Block, k: int) -> None:
        """`LOOP(4)(F(1, 60), S)`: the brackets at `k` hold the body of a block that begins here."""
        group = self.seen.orders_at(k)
        if group is None:
            return
        cursor, tokens = self.cursor, self.cursor.tokens
        right, end = BLOCK_ENDS[block.word], group.end
        is_ended, last = self.seen.end_comes(block.word, end)
        around = self.in_block.blocks.open[:-1]
        is_going_on = not is_ended and self.seen.goes_on(block, around, end)
        orders = ";".join(self.seen.said(each) for each in group.orders)
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
        return self.cursor.tokens[k].kind == "(" and self.seen.orders_at(k) is not None

    def counted(self, number: Token) -> None:
        """`4 LOOP(F(1, 50))`, `4 veces (F(1, 50);S)`, `4(F(1, 50))`: behind `number`."""
        cursor = self.cursor
        k = cursor.i
        token = cursor.tokens[k]
        word = token.text if token.text in WORDS else foreign_block(token.text)
        k += token.kind == "*" or token.text in (*TIMES, "X") or word == "LOOP"
        group = self.seen.orders_at(k) if cursor.tokens[k].kind == "(" else None
        if group is not None:
            self._loop(number, group, cursor.i - 1, group.end)

    def in_header(self, word: Token, bracket: int, said: int) -> None:
        """`LOOP(F(1, 50), 4)`, `IF(DISTANCE < 10, S)`: the body stands in the header's brackets.

        `said` diagnostics were there before the header was read.
        """
        tokens = self.cursor.tokens
        group = self.seen.group_at(bracket) if tokens[bracket].kind == "(" else None
        if group is None or not group.orders:
            return
        right = BLOCK_ENDS.get(word.text, "")
        times, end = self.seen.times_behind(group.end)
        if times is None and tokens[end].kind is NUMBER and tokens[end + 1].kind in AT_END:
            times, end = tokens[end], end + 1  # `LOOP(F(1, 50)) 4`
        if times is not None and word.text == "LOOP" and not group.values:
            self.reporter.withdraw(said)
            self._loop(times, group, self.seen.place_of(word, bracket), end)
        asked = [each for each in group.values if self.seen.is_head(word.text, each)]
        near = near_at(tokens, bracket + 1, self.in_block.known) if word.text in ASKING else None
        if not asked and near is not None and tokens[near.end].kind == ",":
            asked = list(group.values[:1])  # `IF(hay pared, S)`
        else:
            near = None
        known = len(asked) == len(group.values) == 1 and bool(right)
        is_one = word.text == "LOOP" or len(group.orders) == 1
        if len(group.values) > len(asked) or len(asked) > 1 or not right:
            return
        self.reporter.withdraw(said)
        span = Span(word.start, tokens[group.end - 1].end)
        orders = ";".join(self.seen.said(each) for each in group.orders)
        head = self.in_block.known.translated(written(with_signs(asked[0]))) if asked else ""
        head = near.question if near is not None else head
        if asked and is_amount(asked[0][-1].text):  # `IF(distancia < poca, S)`
            known = False
            sample = "20" if head.startswith("DISTANCE") else "500"
            head = head.removesuffix(asked[0][-1].text) + sample
        block = Block(word.text, span, None, None)
        is_going_on = self.seen.goes_on(block, self.in_block.blocks.open, group.end)
        other = self._other_order(group.end) if word.text == "IF" and known and is_one else None
        if other is not None:
            self._with_other(word, head, orders, other)
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

    def _other_order(self, k: int) -> tuple[Sequence[Token], int] | None:
        """`ELSE F(1, 60)` or `ELSE(F(1, 60))` at `k`: return the order, and the place behind it."""
        tokens = self.cursor.tokens
        while tokens[k].kind in (NEWLINE, ";"):
            k += 1
        start = end = k + 1
        if tokens[k].text != "ELSE":
            return None
        group = self.seen.orders_at(start) if tokens[start].kind == "(" else None
        while tokens[end].kind not in AT_END and tokens[end].text != BLOCK_ENDS["IF"]:
            end += 1
        piece: Sequence[Token] = tokens[start:end]
        if group is not None and len(group.orders) == 1 and group.end == end:
            piece = group.orders[0]
        is_ended, last = self.seen.end_comes("IF", end)
        if tokens[end].kind == ";" and not is_ended:
            return None  # what else belongs to it is not said
        return (piece, last if is_ended else end) if piece and self.seen.is_order(piece) else None

    def _with_other(
        self, word: Token, head: str, orders: str, other: tuple[Sequence[Token], int]
    ) -> NoReturn:
        """`IF(DISTANCE < 10, S) ELSE F(1, 60)`: one message for all of it."""
        piece, end = other
        last = self.cursor.tokens[end - 1].end
        right = BLOCK_ENDS["IF"]
        fix = ";".join((f"IF({head})", orders, "ELSE", self.seen.said(piece), right))
        span = Span(word.start, last)
        for token in self.cursor.tokens[self.cursor.i : end]:
            self.reporter.answer(token)
        self.cursor.i = end
        self.reporter.report(
            codes.GROUPED, span, span, word=word.text, right=right, fix=fix, head=f"IF({head})"
        )
        raise Resumed

    def line_of_def(self, block: Block) -> None:
        """`DEF TURN = R(1, 60)`, `DEF TURN R(1, 60)`: at the cursor, what it does, or the sign."""
        tokens, k = self.cursor.tokens, self.cursor.i
        has_sign = tokens[k].kind is not WORD
        end = first = k + has_sign
        self._block_of_def(block, first)
        if tokens[first].text in HEADERS:
            return
        orders: list[Sequence[Token]] = []
        depth = 0
        while True:
            depth += (tokens[end].kind == "(") - (tokens[end].kind == ")")
            is_parted = tokens[end].kind in (";", ",") and not depth
            is_next = (
                not depth
                and end > first
                and (self.seen.begins_order(end) or tokens[end].text in (*ENDS, "END", "FIN"))
            )
            if is_parted or is_next or tokens[end].kind in (NEWLINE, END):
                piece = tokens[first:end]
                if [each.text for each in piece] in (["END"], ["FIN"]):
                    piece = [piece[0]._replace(text=BLOCK_ENDS["DEF"])]
                if piece and not self.seen.is_order(piece):
                    return
                orders += [piece] * bool(piece)
                first = end + (not is_next)
            if tokens[end].kind in (NEWLINE, END):
                break
            end += 1
        if not orders or block.name is None:
            return
        end_word = orders[-1][0]
        has_end = ENDS.get(end_word.text) == "DEF"
        is_ended, last = (True, end) if has_end else self.seen.end_comes("DEF", end)
        is_later = not is_ended and self.seen.goes_on(block, self.in_block.blocks.open[:-1], end)
        if not (has_sign or has_end or is_ended or is_later or self._is_over(end)):
            return
        right = "" if is_later else end_word.text if has_end else BLOCK_ENDS["DEF"]
        said = (self.seen.said(each) for each in (orders[:-1] if has_end else orders))
        texts = (f"DEF {block.name.text}", *said, right)
        self.reporter.answer(tokens[k])
        place = Span(block.span.start, tokens[last - 1].end if is_ended else tokens[end - 1].end)
        fix = ";".join(filter(None, texts))
        self.reporter.report(codes.HEADER_SEPARATOR, tokens[k].span, place, fix=fix,
                             before=self.cursor.source[block.span])  # fmt: skip
        row = self._row(Group((), tuple(orders), end), k)
        if not is_ended and not is_later:
            row.append(Token(WORD, BLOCK_ENDS["DEF"], *tokens[end - 1].span))
        self._read_on(k, end, row)

    def _is_over(self, k: int) -> bool:
        """Whether a DEF whose line ends at `k` has no more: a call, a DEF or nothing follows."""
        tokens, known = self.cursor.tokens, self.in_block.known
        k = self.cursor.after_newlines(k)
        while tokens[k].text in HEADERS:  # a block that begins with a call
            while tokens[k].kind not in AT_END:
                k += 1
            k = self.cursor.after_newlines(k)
        return tokens[k].kind is END or tokens[k].text == "DEF" or known.is_def(tokens[k].text)

    def _block_of_def(self, block: Block, start: int) -> None:
        """`DEF DANCE: LOOP(2): F(1, 60)`: all of the line is what it does."""
        cursor = self.cursor
        first = cursor.tokens[start]
        line = None
        if first.text in HEADERS and block.name is not None:
            line = line_of_block(cursor.tokens, start, first.text, self.in_block.known)
        if line is None or block.name is None or block.is_reported:
            return
        is_later, _ = self.seen.end_comes("DEF", line.end)
        if line.open and not is_later:
            return
        ends = [BLOCK_ENDS[word] for word in reversed(line.open)]
        ends += [] if is_later else [BLOCK_ENDS["DEF"]]
        texts = [f"DEF {block.name.text}", line.text, *ends]

        place = Span(block.span.start, cursor.tokens[line.end - 1].end)
        for token in cursor.tokens[cursor.i : line.end]:
            self.reporter.answer(token)
        sign = cursor.token.span
        self.reporter.report(codes.HEADER_SEPARATOR, sign, place, fix=";".join(texts),
                             before=cursor.source[block.span])  # fmt: skip
        block.is_reported = True
        cursor.i = line.end
        if not is_later:
            self.in_block.blocks.end(place)
        raise Resumed

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
        if name.text in WORDS or not piece or not self.seen.is_order(piece):
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
        fix = f"DEF {name.text};{self.seen.said(piece)};{BLOCK_ENDS['DEF']}"
        self.reporter.report(codes.NO_VALUE, piece[0].span, span, word=piece[0].text, fix=fix)
        self.in_block.known.add(name.text)
        last, sign = piece[-1].span, Token(";", ";", *piece[-1].span)
        head = [Token(WORD, "DEF", *name.span), name, sign]
        self._read_on(start - 2, end, [*head, *piece, sign, Token(WORD, BLOCK_ENDS["DEF"], *last)])

    # -- what is read instead -----------------------------------------------------------------

    def _loop(self, times: Token, group: Group, start: int, end: int) -> None:
        tokens = self.cursor.tokens
        place = Span(tokens[start].start, tokens[end - 1].end)
        orders = ";".join(self.seen.said(each) for each in group.orders)
        around = self.in_block.blocks.open
        is_going_on = self.seen.goes_on(Block("LOOP", place, None, None), around, end)
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

    def _row(self, group: Group, k: int) -> list[Token]:
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
