"""Recovery of an UNTIL that does not stand behind its move: `F(2, 80);UNTIL(c)`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.ast import Argument, Command
from tiniscript.syntax.blocks import ENDS, HEADERS, Blocks
from tiniscript.syntax.call_suggestions import call_in, starts_value
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NEWLINE, NUMBER, WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.reporter import Failed, Reporter, Resumed
from tiniscript.syntax.suggestions import (
    after_bracket,
    end_of_values,
    head_in,
    inside,
    opposite,
    with_signs,
)
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import BLOCK_ENDS, WORDS, meant_by, nearest

_TIMED = ("move", "wait")
_ENDS_OF_UNTIL = ("END_UNTIL", "ENDUNTIL", "FIN_UNTIL")
_FARTHEST = 300  # tokens of a body that ends so


def in_its_move(tokens: Sequence[Token], k: int) -> tuple[str, Span] | None:
    """`F(UNTIL(DISTANCE < 20), 60)`: return how it is written, and where it stands."""
    known = WORDS.get(tokens[k - 2].text) if k > 1 and tokens[k - 1].kind == "(" else None
    end = after_bracket(tokens, k + 1) if tokens[k + 1].kind == "(" else None
    if known is None or known.role != "move" or end is None:
        return None
    if [token.kind for token in tokens[end : end + 3]] != [",", NUMBER, ")"]:
        return None
    head = head_in(WORDS["UNTIL"], inside(tokens, k + 1))
    span = Span(tokens[k - 2].start, tokens[end + 2].end)
    return f"{known.text}(FOREVER, {tokens[end + 1].text}) {head}", span


def before_bracket(tokens: Sequence[Token], bracket: int, k: int) -> tuple[str, int] | None:
    """`F(5, 60 UNTIL(DISTANCE < 15))`: return how it is written, and the place behind it."""
    known = WORDS.get(tokens[bracket - 1].text) if bracket else None
    if known is None or known.role not in _TIMED or tokens[k].text != "UNTIL":
        return None
    end = after_bracket(tokens, k + 1) if tokens[k + 1].kind == "(" else None
    if end is None or tokens[end].kind != ")" or tokens[end + 1].kind not in AT_END:
        return None
    call = call_in(known, tokens[bracket + 1 : k])
    return f"{call} {head_in(WORDS['UNTIL'], inside(tokens, k + 1))}", end + 1


class UntilRecovery:
    def __init__(
        self, cursor: Cursor, reporter: Reporter, blocks: Blocks, known: Vocabulary
    ) -> None:
        self.known = known
        self.cursor = cursor
        self.reporter = reporter
        self.blocks = blocks

    def is_taken_for_until(self, word: Token) -> bool:
        """Whether `F(2, 80), UNTIL(c)` or `F(2, 80) HASTA(c)` is meant; then go to that word."""
        cursor = self.cursor
        token, following = cursor.token, cursor.following
        if token.kind == ",":
            if following.kind is not WORD or following.text != "UNTIL":
                return False
            cursor.i += 1
            self._alone(following, cursor.source[Span(word.start, token.start)])
            return True
        if token.kind is WORD and meant_by(token.text) is None and self._is_misspelt(token, word):
            return True
        if token.kind is not WORD or meant_by(token.text) != "UNTIL":
            return False
        if following.text == "QUE":  # `hasta que(DISTANCE < 10)`
            token = Token(WORD, "HASTA QUE", token.start, following.end)
            cursor.tokens[cursor.i : cursor.i + 2] = [token]
            following = cursor.following
        if not starts_value(following):
            return False
        values = inside(cursor.tokens, cursor.i + 1)
        fix = usage = head_in(WORDS["UNTIL"], values)
        place = Span(token.start, end_of_values(cursor.tokens, cursor.i + 1, values))
        near = near_at(cursor.tokens, cursor.i + 1, self.known)
        is_near = near is not None and cursor.tokens[near.end].kind in AT_END
        if near is not None and is_near:  # `hasta la pared`
            fix = usage = f"UNTIL({near.question})"
            place = Span(token.start, cursor.tokens[near.end - 1].end)
        elif (
            following.kind != "("
            and not any(each.kind in COMPARISONS for each in with_signs(values))
            and not (len(values) == 1 and self.known.is_own(self.known.value(values[0].text)))
        ):
            call = cursor.source[Span(word.start, cursor.last.end)]
            fix, usage = "", f"{call} UNTIL(DISTANCE < {self._distance(values)})"
        self.reporter.report(
            codes.OTHER_LANGUAGE,
            token.span,
            place,
            found=token.text,
            right="UNTIL",
            fix=fix,
            usage=usage,
        )
        if is_near or not fix:
            cursor.skip_instruction()
            raise Failed
        return True

    @staticmethod
    def _distance(values: Sequence[Token]) -> str:
        """Return the one number of `hasta 20 cm`, else an example."""
        numbers = [each.text for each in values if each.kind is NUMBER]
        return numbers[0] if len(numbers) == 1 else "10"

    def _is_misspelt(self, token: Token, move: Token) -> bool:
        """`F(5, 60) Útil(DISTANCE < 30)`: behind a move a word with a question is UNTIL."""
        cursor, start = self.cursor, self.cursor.i + 1
        known, its = WORDS.get(token.text), WORDS.get(move.text)
        if known is not None or its is None or its.role not in _TIMED:
            return False
        if self.known.is_own(token.text):
            return False
        is_near = nearest(token.text, ("UNTIL",)) is not None
        values = inside(cursor.tokens, start)
        asks = any(each.kind in COMPARISONS for each in with_signs(values))
        if cursor.tokens[start].kind == "(":
            end = after_bracket(cursor.tokens, start)
            is_last = end is not None and cursor.tokens[end].kind in AT_END
            if not is_last or not values or not (asks or is_near):
                return False
        elif not (is_near and asks):
            return False
        self.reporter.answer(token)
        fix = head_in(WORDS["UNTIL"], values)
        place = Span(token.start, end_of_values(cursor.tokens, start, values))
        found = cursor.source[token.span].upper()
        self.reporter.report(codes.UNKNOWN_WORD, token.span, place, found=found, near=fix, fix=fix)
        return True

    def after_its_move(
        self, word: Token, argument_of: Callable[[Token, bool], Argument]
    ) -> NoReturn:
        """`F(2, 80);UNTIL(c)`: the move has its UNTIL, only not where it belongs."""
        self._as_block(word, is_strict=True)
        here = self.blocks.here
        last = here[-1] if here else None
        known = WORDS.get(last.word) if isinstance(last, Command) else None
        if not isinstance(last, Command) or known is None or known.role not in _TIMED or last.until:
            self._before_its_move(word)
            self._as_block(word, is_strict=bool(self.blocks.open))
            self.reporter.fail(codes.UNTIL_ALONE, word.span, fix="")
        self._alone(word, self.cursor.source[last.span])
        self.cursor.i += 1
        here[-1] = last._replace(until=argument_of(word, True))
        raise Failed

    def _alone(self, until: Token, before: str) -> None:
        values = inside(self.cursor.tokens, self.cursor.i + 1)
        fix = f"{before} {head_in(WORDS['UNTIL'], values)}" if before else ""
        place = None
        if before:
            end = end_of_values(self.cursor.tokens, self.cursor.i + 1, values)
            place = Span(self.cursor.source.text.rindex(before, 0, until.start), end)
        source = self.cursor.source
        said = {"fix": fix}
        if place is not None and "\n" in source[Span(place.start, until.start)]:
            said["line"] = str(source.position(place.start)[0])
            said["here"] = str(source.position(until.start)[0])
        self.reporter.report(codes.UNTIL_ALONE, until.span, place, **said)

    def _as_block(self, until: Token, is_strict: bool) -> None:
        """`UNTIL(DISTANCE < 10)`, a body, `END_UNTIL`: WHILE asks the opposite.

        Where it `is_strict`, END alone may be that of another block.
        """
        cursor = self.cursor
        tokens, start = cursor.tokens, cursor.i + 1
        ends = [
            k
            for k in range(start, min(len(tokens), start + _FARTHEST))
            if tokens[k - 1].kind in (";", NEWLINE) and self._ends_until(k, is_strict)
        ]
        ends = ends or self._end_before_own(start)
        values = inside(tokens, start)
        question = self.known.translated(opposite(with_signs(values)))
        if not ends or not question:
            return
        end = ends[0]
        is_split = tokens[end].text in ("END", "FIN") and tokens[end + 1].text == "UNTIL"
        span = Span(tokens[end].start, tokens[end + is_split].end)
        tokens[end : end + 1 + is_split] = [Token(WORD, BLOCK_ENDS["WHILE"], *span)]
        last = end_of_values(tokens, start, values)
        while cursor.token.start < last or cursor.i < start:
            cursor.i += 1
        place = cursor.span_from(until)
        self.reporter.report(codes.UNTIL_ALONE, until.span, None, fix="",
                             header=f"WHILE({question})", right=BLOCK_ENDS["WHILE"])  # fmt: skip
        self.blocks.begin("WHILE", place).is_reported = True
        raise Resumed

    def _end_before_own(self, start: int) -> list[int]:
        """Return where an END alone stands before the own end of the block around it, if so."""
        tokens, block = self.cursor.tokens, self.blocks.innermost
        depth, found = 0, []
        for k in range(start, min(len(tokens), start + _FARTHEST)):
            text = tokens[k].text
            if block is None or tokens[k - 1].kind not in (";", NEWLINE):
                continue
            depth += text in HEADERS
            if text in ("END", "FIN") and not depth:
                found.append(k)
            elif text in ENDS and not depth:
                return found if len(found) == 1 and ENDS[text] == block.word else []
            depth -= depth > 0 and (text in ENDS or text in ("END", "FIN"))
        return []

    def _ends_until(self, k: int, is_strict: bool) -> bool:
        text, after = self.cursor.tokens[k].text, self.cursor.tokens[k + 1 : k + 2]
        is_any = text in ("END", "FIN") and (not is_strict or after[0].text == "UNTIL")
        return text in _ENDS_OF_UNTIL or is_any

    def _before_its_move(self, until: Token) -> None:
        """`UNTIL(DISTANCE < 10) F(2, 60)`: the question goes behind."""
        cursor, start = self.cursor, self.cursor.i + 1
        middle = after_bracket(cursor.tokens, start) if cursor.tokens[start].kind == "(" else None
        if middle is None:
            return
        move = cursor.tokens[middle]
        known = WORDS.get(move.text)
        is_call = cursor.tokens[min(middle + 1, len(cursor.tokens) - 1)].kind == "("
        end = after_bracket(cursor.tokens, middle + 1) if is_call else None
        is_timed = known is not None and known.role in _TIMED
        if not is_timed or end is None or cursor.tokens[end].kind not in AT_END:
            return
        head = cursor.source[Span(until.start, cursor.tokens[middle - 1].end)]
        call = cursor.source[Span(move.start, cursor.tokens[end - 1].end)]
        cursor.i = end
        place = cursor.span_from(until)
        self.reporter.fail(codes.UNTIL_ALONE, until.span, place, fix=f"{call} {head}")
