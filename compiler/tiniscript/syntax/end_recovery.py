"""Recovery of ends of blocks with a sign or a name in them, and of `LOOP(3) ... END_LOOP`.

Knows how the ends are written, and that the poster has dots where a block's instructions go.
"""

from __future__ import annotations

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.block_recovery import BlockRecovery
from tiniscript.syntax.blocks import ENDS, Block
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NEWLINE, ODD, WORD, Token
from tiniscript.syntax.phrases import ENDS_OF_ANY
from tiniscript.syntax.reporter import Reporter, Resumed
from tiniscript.words import BLOCK_ENDS

_SIGNS = ("-", "/", "*", "+", ".", ":", "·", "–", "—")
_ARMS = ("ELSE", "ELSEIF", "SINO", "ELIF")
_DOTS = (".", "…")
_MANY = 12  # instructions below a block that an example shows


class EndRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, in_block: BlockRecovery) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.in_block = in_block
        self.blocks = in_block.blocks

    def with_a_sign(self, end: Token, sign: Token) -> None:
        """`END-LOOP`, `END.LOOP`: the same as `END LOOP`."""
        cursor = self.cursor
        if end.text not in ENDS_OF_ANY or sign.text not in _SIGNS:
            return
        named = cursor.tokens[cursor.i + 2]
        if named.kind is not WORD or named.text not in BLOCK_ENDS:  # `END .`
            return
        if cursor.tokens[cursor.i + 3].kind not in AT_END:
            return
        self.reporter.answer(sign)
        del cursor.tokens[cursor.i + 1]
        self.in_block.end_in_two_words(end, named)
        raise Resumed

    def with_its_name(self, end: Token) -> None:
        """`END_JUMP`, which ends `DEF JUMP`."""
        block = self.blocks.innermost
        if block is None or block.name is None or self.in_block.is_name(end.text):
            return
        name = block.name.text
        if end.text in (f"{word}{sign}{name}" for word in ENDS_OF_ANY for sign in ("_", "")):
            right = BLOCK_ENDS[block.word]
            self.reporter.report(codes.END_ALONE, end.span, found=end.text, right=right)
            self.cursor.i += 1
            self.blocks.end(end.span)
            raise Resumed

    def named_again(self, end: Token, name: Token) -> None:
        """`END_DEF JUMP`, where JUMP is called below: it says only what ends here."""
        cursor = self.cursor
        if ENDS.get(end.text) != "DEF" or cursor.following.kind not in AT_END:
            return
        later = cursor.tokens[cursor.i + 1 :]
        if self.in_block.known.is_def(name.text) and any(it.text == name.text for it in later):
            cursor.i += 1
            said = name.text
            self.reporter.fail(codes.EXTRA_WORD, name.span, found=said, label=said, fix="")

    def unclosed(self, header: Block | None) -> None:
        """`LOOP(4) {` without its `}`: the message of the bracket says where the block ends."""
        cursor = self.cursor
        if header is not None and cursor.token.kind == "{" and cursor.closing(cursor.i) is None:
            header.is_reported = True
            self.in_block.name_end(header)

    def dots(self, header: Block | None) -> None:
        """`LOOP(3) ... END_LOOP`, as the poster has it: what is done goes where the dots are."""
        cursor = self.cursor
        tokens, start = cursor.tokens, cursor.i
        k = start
        while tokens[k].kind is ODD and tokens[k].text in _DOTS:
            k += 1
        if header is None or not (k - start > 1 or tokens[start].text == "…"):
            return
        if tokens[k].kind not in AT_END and tokens[k].text not in (*ENDS, *_ARMS):
            return  # `LOOP(4) ... F(1, 60) ... END_LOOP`
        for token in tokens[start:k]:
            self.reporter.answer(token)
        if header.is_reported and any(
            each.code is codes.DOTS and each.span.start > header.header.start
            for each in self.reporter.diagnostics
        ):
            cursor.i = k  # of another arm
            raise Resumed
        right = BLOCK_ENDS[header.word]
        span = Span(tokens[start].start, tokens[k - 1].end)
        values = {"head": cursor.source[header.span], "right": right}
        after = cursor.after_newlines(k)
        if tokens[k].kind is NEWLINE and tokens[after].text not in (*ENDS, *_ARMS):
            values["out"] = cursor.source[span]
        else:
            values["example"] = self._with_what_follows(header, right, after)
        self.reporter.report(codes.DOTS, span, None, **values)
        header.is_reported = True
        cursor.i = k
        raise Resumed

    def _with_what_follows(self, header: Block, right: str, k: int) -> str:
        """Return the block with the instructions that stand below its end, where it ends at `k`."""
        tokens = self.cursor.tokens
        head = self.cursor.source[header.span]
        if ENDS.get(tokens[k].text) is None:
            return ""
        rows: list[str] = []
        first = k = k + 1
        while len(rows) <= _MANY and k < len(tokens):
            if tokens[k].kind in AT_END or k == len(tokens) - 1:
                if k > first:
                    piece = tokens[first:k]
                    if piece[0].text in (*BLOCK_ENDS, *ENDS) or piece[0].kind is not WORD:
                        return ""
                    rows.append(self.cursor.source[Span(piece[0].start, piece[-1].end)])
                first = k + 1
            k += 1
        name = header.name.text if header.name is not None else ""
        calls = [each for each in rows if each.upper() == name]
        rows = [each for each in rows if each.upper() != name]
        return "; ".join((head, *rows, right, *calls)) if 0 < len(rows) <= _MANY else ""
