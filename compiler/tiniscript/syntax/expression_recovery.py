"""Recovery inside expressions and brackets.

Reports tokens that stand where an operand, an operator or a bracket is expected. If the meaning is
clear, it repairs the tokens, and the grammar reads on from there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript.diagnostics import codes
from tiniscript.fixed_point import HIGHEST, LOWEST, as_text
from tiniscript.kit import Kit
from tiniscript.source import Span
from tiniscript.syntax.call_suggestions import (
    call_in,
    count_diagnostic,
    ends_value,
    is_value_word,
    starts_value,
)
from tiniscript.syntax.cursor import AFTER_VALUE, AT_END, Cursor
from tiniscript.syntax.devices import actuator_word
from tiniscript.syntax.joined_questions import JoinedQuestions
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.number_recovery import NumberRecovery
from tiniscript.syntax.operators import COMPARISONS, Operator, Postfix
from tiniscript.syntax.phrases import AFTER_HEADER
from tiniscript.syntax.reporter import Failed, Reporter
from tiniscript.syntax.suggestions import after_bracket, operator_words, tells
from tiniscript.syntax.until_recovery import before_bracket, in_its_move
from tiniscript.syntax.value_constructs import ValueConstructs
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import FUNCTIONS, POWER_WORDS, WORDS, Word, meant_by, nearest


class ExpressionRecovery:
    def __init__(self, cursor: Cursor, reporter: Reporter, kit: Kit | None) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.kit = kit
        self.numbers = NumberRecovery(cursor, reporter)
        known = Vocabulary(cursor.tokens, kit)
        self.constructs = ValueConstructs(cursor, reporter, known)
        self.questions = JoinedQuestions(cursor, reporter, known)

    # -- where an operand is wanted -----------------------------------------------------------

    def no_value(self, token: Token) -> NoReturn:
        """Say what is wrong with a token that stands where a value is wanted."""
        if token.kind is ODD or (token.text == "F" and self.cursor.following.kind is ODD):
            self.constructs.sentence()
            raise Failed
        cursor, fail = self.cursor, self.reporter.fail
        place = cursor.before(cursor.i)
        before = cursor.tokens[place]
        if before.kind == "%" and token.kind in AFTER_VALUE:
            number = cursor.tokens[place - 1]
            span = Span(number.start, before.end)
            fail(codes.UNIT, span, found=cursor.source[span], number=number.text,
                 right=number.text, unit="%")  # fmt: skip
        if token.kind is WORD and WORDS[token.text].role != "operator":
            self._no_value_word(token)
        self.numbers.plus(token, place)
        if before.text in ("AND", "OR") and token.kind in COMPARISONS:
            self._nothing_compared(before, token, place)
        if before.kind == "," == token.kind or (before.kind == "," and token.kind == ")"):
            self._comma_too_many(token, place)
        is_at_end = token.kind in AT_END
        span = before.span if is_at_end else token.span
        found = "" if is_at_end else token.text
        fail(codes.MISSING_VALUE, span, found=found, before=before.text)

    def _nothing_compared(self, word: Token, sign: Token, place: int) -> None:
        """`DISTANCE > 10 AND < 30`: what is compared is said once."""
        cursor = self.cursor
        tokens, after = cursor.tokens, cursor.following
        if place < 3 or tokens[place - 2].kind not in COMPARISONS or not starts_value(after):
            return
        subject = tokens[place - 3]
        if subject.kind is WORD and subject.text not in WORDS:
            fix = f"{word.text} {subject.text} {sign.text} {after.text}"
            span = Span(word.start, after.end)
            self.reporter.fail(
                codes.MISSING_VALUE, sign.span, span, found=sign.text, before=word.text, fix=fix
            )

    def _comma_too_many(self, token: Token, place: int) -> None:
        """`F(2,,80)`, `F(2, 80,)`: with one comma less the values are complete."""
        cursor = self.cursor
        tokens, k = cursor.tokens, place
        depth = 0
        while k and tokens[k].kind not in (";", NEWLINE):
            depth += (tokens[k].kind == ")") - (tokens[k].kind == "(")
            if depth < 0:
                break
            k -= 1
        word = self._word_of(tokens[k - 1]) if k else None
        if word is None or tokens[k].kind != "(":
            return
        values = self._in_brackets(k)
        places = [i for i, each in enumerate(values) if each.start == tokens[place].start]
        fewer = [each for i, each in enumerate(values) if i not in places]
        if sum(each.kind == "," for each in fewer) + 1 == len(word.arguments) == _plain(fewer):
            span = Span(tokens[k - 1].start, self._end_of(k))
            self.reporter.fail(
                codes.MISSING_VALUE, token.span, span, found=token.text,
                before=tokens[place].text, fix=call_in(word, fewer),
            )  # fmt: skip

    def _no_value_word(self, token: Token) -> NoReturn:
        word, fail = WORDS[token.text], self.reporter.fail
        self.questions.asked_twice(token)
        if word.role == "forever":
            fail(codes.FOREVER_NOT_HERE, token.span)
        if word.role == "until":
            found = in_its_move(self.cursor.tokens, self.cursor.i)
            fail(codes.UNTIL_ALONE, token.span, found and found[1], fix=found[0] if found else "")
        if word.text == "SI":  # `X = si`
            fail(codes.OTHER_LANGUAGE, token.span, found="SI", right="TRUE", fix="TRUE", usage="")
        if word.is_call and self.cursor.following.kind == "(":
            fail(codes.NO_VALUE, token.span, word=word.text)
        if word.text in self.reporter.reserved_words:
            raise Failed
        if self.cursor.source[token.span] == "l" and self.cursor.following.kind in (",", ")"):
            fail(codes.BAD_NUMBER, token.span, found="l", right="1")
        place = self.cursor.before(self.cursor.i)
        if self.cursor.tokens[place].kind == "-" and place:
            self._sensor_in_two(self.cursor.tokens[place - 1], token)
        fail(codes.RESERVED, token.span, word=word.text, right=self.cursor.free_name(word.text))

    def literal(self, number: Token, span: Span, value: int) -> int:
        """Report a number that is out of range or too exact, and return what is read for it."""
        if LOWEST <= value <= HIGHEST:
            found, right = number.text[:20], as_text(value)
            self.reporter.report(codes.ROUNDED, span, found=found, right=right)
            return value
        limit = as_text(HIGHEST if value > 0 else LOWEST)
        self.reporter.report(codes.NUMBER_TOO_BIG, span, limit=limit)
        return 0

    def called(self, name: Token) -> None:
        """`DISTANCE()` or `SQRT(4)`: no name of a program is a function."""
        cursor, reporter = self.cursor, self.reporter
        meant = WORDS.get(meant_by(name.text) or nearest(name.text, FUNCTIONS) or "")
        if meant is not None and meant.arguments:
            fix = call_in(meant, self._in_brackets(cursor.i))
            place = Span(name.start, self._end_of(cursor.i))
            reporter.fail(codes.OTHER_LANGUAGE, name.span, place, found=name.text,
                          right=meant.text, fix=fix, usage=meant.usage)  # fmt: skip
        self.constructs.called(name, cursor.token)
        close = cursor.following
        devices = self.kit.sensors if self.kit is not None else ()
        if close.kind != ")" and any(each.name == name.text for each in devices):
            place = Span(name.start, self._end_of(cursor.i))  # `DISTANCE(cm)`
            values = {"word": name.text, "fix": name.text}
            reporter.fail(codes.NO_BRACKETS_HERE, cursor.token.span, place, **values)
        if close.kind != ")":
            reporter.fail(codes.NO_FUNCTION, name.span, found=name.text)
        cursor.i += 2
        reporter.report(codes.EMPTY_BRACKETS, cursor.span_from(name), word=name.text)

    def no_bracket(self, name: Token, function: Word) -> NoReturn:
        """`ABS 5`."""
        tokens, start = self.cursor.tokens, self.cursor.i
        end = start
        while tokens[end].kind in (NUMBER, ",") or is_value_word(tokens[end]):
            if tokens[start].kind == ",":  # `F(RANDOM, 50)`: the 50 is no value of RANDOM
                break
            end += 1
        rest = tokens[start:end]
        is_last = start > 1 and tokens[start - 2].kind == "," and tokens[start].kind == ")"
        if name.text == "MAX" and is_last:  # `F(2, max)`
            self.reporter.fail(codes.UNKNOWN_NAME, name.span, found="MAX", near=POWER_WORDS["MAX"])
        place = Span(name.start, rest[-1].end if rest else name.end)
        fix = call_in(function, rest)
        self.reporter.fail(
            codes.MISSING_OPEN, name.span, place, word=name.text, fix=fix, usage=function.usage
        )

    def wrong_count(self, word: Word, arguments: Sequence[Span], span: Span) -> NoReturn:
        """`word` does not take so many arguments."""
        found = count_diagnostic(self.cursor.source, word, arguments, span)
        self.reporter.fail(found.code, found.span, None, **found.values)

    # -- where an operator is wanted ----------------------------------------------------------

    def is_repaired(self, token: Token, read: Postfix) -> bool:
        """Report a token where an operator is expected; return whether its meaning is clear.

        If so, the tokens are repaired, and the cursor is at the operator, or at the NOT that was
        taken for an operand.
        """
        k = self.cursor.after_newlines(self.cursor.i)
        if token.text == "&" and read.brackets and starts_value(self.cursor.tokens[k + 1]):
            self.reporter.answer(token)
            self.reporter.report(codes.OTHER_SIGN, token.span, found="&", right="AND")
            self.cursor.tokens[k] = Token(WORD, "AND", *token.span)
            return True
        if token.kind is not WORD and not starts_value(token):
            return False
        token = self.numbers.percent(token, k)
        in_brackets = bool(read.brackets)
        return (
            self._is_said_in_words(token, k, in_brackets)
            or self.numbers.is_unit(token, k, in_brackets)
            or (in_brackets and self._is_no(k, read))
        )

    def _is_said_in_words(self, token: Token, k: int, in_brackets: bool) -> bool:
        """`X IS LESS THAN 5`, `A Y B`. On a line of its own a word is rather a name."""
        cursor, tokens = self.cursor, self.cursor.tokens
        said = operator_words(tokens, k)
        begins_instruction = tokens[k + 1].kind in ("=", "(", *AT_END)
        if said is None or (not in_brackets and (begins_instruction or tells(tokens, *said))):
            return False
        if not in_brackets and said[1] == "=" and not self.constructs.is_value(tokens[said[0]]):
            return False  # `X = 5 es velocidad`
        end, right = said
        if right == "AND":
            self._and_for_comma(tokens[cursor.before(k)], tokens[end])
        span = Span(token.start, tokens[end - 1].end)
        found = cursor.source[span]
        self.reporter.report(codes.OTHER_SIGN, span, found=found, right=right)
        tokens[end - 1] = Token(WORD if right.isalpha() else right, right, *span)
        cursor.i = end - 1
        return True

    def _and_for_comma(self, before: Token, after: Token) -> None:
        """`F(2 y 80)`."""
        tokens = self.cursor.tokens
        k = self.cursor.i
        while k and tokens[k].kind not in ("(", *AT_END):
            k -= 1
        word = self._word_of(tokens[k - 1]) if k and tokens[k].kind == "(" else None
        if word is None or before.kind is not NUMBER or after.kind is not NUMBER:
            return
        if len(word.arguments) > 1:
            inner = [each for each in self._in_brackets(k) if each.text not in ("Y", "E", "AND")]
            place, fix = Span(tokens[k - 1].start, self._end_of(k)), call_in(word, inner)
            span = Span(before.start, after.end)
            self.reporter.fail(codes.MISSING_COMMA, span, place, fix=fix, usage=word.usage)

    def _is_no(self, k: int, read: Postfix) -> bool:
        """`IF(NO BUTTON)`: the operand before was a NOT."""
        cursor = self.cursor
        place = cursor.before(k)
        no = cursor.tokens[place]
        if no.kind is not WORD or no.text != "NO" or read.parts[-1].op != "NAME":
            return False
        self.reporter.report(codes.OTHER_SIGN, no.span, found=no.text, right="NOT")
        cursor.tokens[place] = Token(WORD, "NOT", no.start, no.end)
        cursor.i = place
        read.parts.pop()
        return True

    def chained(self, first: Operator, second: Token) -> NoReturn:
        """`1 < X < 5`, which the new recovery writes as two questions."""
        self.reporter.fail(codes.CHAINED, Span(first.token.start, second.end))

    # -- where a bracket is wanted ------------------------------------------------------------

    def no_close(self, bracket: int) -> NoReturn:
        """Report what is missing: a bracket is open and the next token does not fit in it."""
        cursor, fail = self.cursor, self.reporter.fail
        token = cursor.inner()
        last = cursor.tokens[cursor.before(cursor.i)]
        self._sensor_in_two(last, token)
        if token.kind is ODD and token.text != ":":
            self.constructs.sentence()
            raise Failed
        if token.kind == ";" and self._close_comes():
            while cursor.token.kind != ")":
                cursor.i += 1
            cursor.i += 1
            fail(codes.SEMICOLON_INSIDE, token.span)
        if token.kind == "|" and self._close_comes() and starts_value(cursor.following):
            self._nothing_between(last, cursor.following, bracket)
        if token.kind == "=":
            fail(codes.MISSING_VALUE, token.span, found="=", before=last.text)
        if cursor.token is token and starts_value(token) and ends_value(last):
            if self._close_comes():
                self._nothing_between(last, token, bracket)
        if token.kind is ODD:
            self.reporter.answer(token)
            if token.text in (":", ".") and self._close_comes() and starts_value(cursor.following):
                self._nothing_between(last, cursor.following, bracket)
        self._open_too_many(bracket, token)
        self.numbers.cut_in_two(self._word_of(cursor.tokens[bracket - 1]), bracket)
        found = before_bracket(cursor.tokens, bracket, cursor.i)
        if found is not None:
            cursor.i = found[1]
            place = Span(cursor.tokens[bracket - 1].start, cursor.last.end)
            fail(codes.MISSING_CLOSE, last.span, place, last=last.text, fix=found[0])
        fail(codes.MISSING_CLOSE, last.span, last=last.text)

    def _sensor_in_two(self, first: Token, second: Token) -> None:
        """`LIGHT R`, `LIGHT-R`: the kit has a sensor of this name."""
        name = f"{first.text}_{second.text}"
        sensors = self.kit.sensors if self.kit is not None else ()
        if any(each.name == name for each in sensors):
            span = Span(first.start, second.end)
            found = self.cursor.source[span]
            self.reporter.fail(codes.NAME_WITH_SPACE, span, found=found, right=name)

    def _open_too_many(self, bracket: int, token: Token) -> None:
        """`F((2, 80)`: the second bracket is too much."""
        tokens = self.cursor.tokens
        word = self._word_of(tokens[bracket - 2]) if bracket > 1 else None
        end = after_bracket(tokens, bracket)
        if word is None or token.kind != "," or tokens[bracket - 1].kind != "(" or end is None:
            return
        end += tokens[end].kind == ")"
        if tokens[end].kind in AT_END:
            span = Span(tokens[bracket - 2].start, tokens[end - 1].end)
            fix = call_in(word, self._in_brackets(bracket))
            self.cursor.i = end
            self.reporter.fail(
                codes.MISSING_CLOSE, tokens[bracket].span, span, last=tokens[bracket].text, fix=fix
            )

    def _nothing_between(self, last: Token, token: Token, bracket: int) -> NoReturn:
        """Two values in brackets with only a space between them."""
        span = Span(last.start, token.end)
        devices = (*self.kit.sensors, *self.kit.actuators) if self.kit is not None else ()
        known = {*WORDS, *(each.name for each in devices)}
        self.numbers.between(last)
        if last.kind is WORD and token.kind is WORD and not {last.text, token.text} & known:
            right, found = f"{last.text}_{token.text}", self.cursor.source[span]
            meant = meant_by(right)
            if meant in known:
                values = {"found": found, "right": meant, "fix": meant, "usage": meant}
                self.reporter.fail(codes.OTHER_LANGUAGE, span, None, **values)
            self.numbers.amount(span, last, token)
            self.constructs.near_said(span, found, last, token, bracket)
            self.numbers.unknown_time(span, last, token)
            self.constructs.words_shown(right)
            self.reporter.fail(codes.NAME_WITH_SPACE, span, found=found, right=right)
        self.numbers.with_part(last, token)
        owner = self.cursor.tokens[bracket - 1] if bracket else self.cursor.tokens[bracket]
        word = self._word_of(owner)
        if word is not None and len(word.arguments) > 1:
            fix = call_in(word, self._in_brackets(bracket))
            place = Span(owner.start, self._end_of(bracket))
            self.reporter.fail(codes.MISSING_COMMA, span, place, fix=fix, usage=word.usage)
        shown = {"before": last.text, "found": token.text}
        if last.kind == ")" or token.kind == "(" or token.text in AFTER_HEADER:
            shown = {"before": "", "found": ""}
        elif token.kind is WORD and token.text not in known and last.text in known:
            shown["fix"] = f"{last.text} < 10"  # `DISTANCE cerca`: no value that may be compared
        self.reporter.fail(codes.MISSING_SIGN, span, None, **shown)

    def _word_of(self, token: Token) -> Word | None:
        """Return the word of the language or of the kit that takes values in brackets here."""
        if token.kind is not WORD or self.kit is None:
            return WORDS.get(token.text)
        found = (each for each in self.kit.actuators if each.name == token.text)
        return WORDS.get(token.text) or next((actuator_word(each) for each in found), None)

    def _end_of(self, bracket: int) -> int:
        """Return where the brackets end in the text that open at the token `bracket`."""
        end = after_bracket(self.cursor.tokens, bracket)
        inner = self._in_brackets(bracket)
        last = self.cursor.tokens[bracket] if not inner else inner[-1]
        return self.cursor.tokens[end - 1].end if end is not None else last.end

    def _in_brackets(self, bracket: int) -> list[Token]:
        """Return the tokens after a `(` up to its `)`, or to where the instruction ends."""
        tokens = self.cursor.tokens
        depth, k = 1, bracket + 1
        while tokens[k].kind not in (";", END):
            depth += (tokens[k].kind == "(") - (tokens[k].kind == ")")
            if not depth:
                break
            k += 1
        return tokens[bracket + 1 : k]

    def _close_comes(self) -> bool:
        """Whether a `)` comes on this line before another bracket opens."""
        tokens, k = self.cursor.tokens, self.cursor.i
        while tokens[k].kind not in ("(", ")", NEWLINE, END):
            k += 1
        return tokens[k].kind == ")"


def _plain(tokens: Sequence[Token]) -> int:
    """Return how many numbers or names there are with commas between, 0 for anything else."""
    values = [each for each in tokens if each.kind != ","]
    return len(values) if all(each.kind in (NUMBER, WORD) for each in values) else 0
