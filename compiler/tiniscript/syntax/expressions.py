"""The parser's half that reads expressions and arguments.

Knows precedence and brackets. Reads by operator precedence with a stack of its own and gives
parts in the order in which a stack machine meets them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from tiniscript import problems
from tiniscript.problems import Code, Problem
from tiniscript.source import Source, Span
from tiniscript.syntax.ast import Argument, Part
from tiniscript.syntax.call_suggestions import call_in, count_problem, ends_value, starts_value
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.suggestions import operator_words
from tiniscript.thousandths import HIGHEST, LOWEST, as_text, read_literal
from tiniscript.words import UNITS, WORDS, Word, meant_by, other_name

_BINARY = {
    "OR": (1, "OR"), "AND": (2, "AND"),
    "=": (4, "EQ"), "<>": (4, "NE"), "<": (4, "LT"), "<=": (4, "LE"), ">": (4, "GT"),
    ">=": (4, "GE"),
    "+": (5, "ADD"), "-": (5, "SUB"), "*": (6, "MUL"), "/": (6, "DIV"), "%": (6, "MOD"),
}  # fmt: skip
_NOT, _COMPARE, _MINUS, _OPEN = 3, 4, 7, 0
_FUNCTIONS = frozenset(word.text for word in WORDS.values() if word.role == "function")
_ENDS = frozenset((";", NEWLINE, END))
_AFTER_VALUE = frozenset((",", ")", *_ENDS))


class Failed(Exception):
    """An instruction that could not be read; the problem is already reported."""


class _Operator:
    """An operator, an open bracket or an open function call that waits for what follows."""

    __slots__ = ("arguments", "at", "index", "name", "precedence")

    def __init__(self, precedence: int, name: str, at: Token, index: int) -> None:
        self.precedence = precedence
        self.name = name
        self.at = at
        self.index = index
        self.arguments: list[Span] = []  # of a function call, for messages


class Expressions:
    """Reads from `tokens` at `i`; adds to `problems`. Mends tokens that are slips as it goes."""

    def __init__(self, source: Source, tokens: list[Token], found: list[Problem]) -> None:
        self.source = source
        self.tokens = tokens
        self.problems = found
        self.i = 0
        self.answered: set[int] = set()  # places of odd signs of which more is known now
        self.reserved: set[str] = set()  # words that were set like variables: said there, once

    def report(self, code: Code, span: Span, **values: str) -> None:
        self.problems.append(Problem(code, span, values))

    def fail(self, code: Code, span: Span, **values: str) -> NoReturn:
        self.report(code, span, **values)
        raise Failed

    # -- arguments --------------------------------------------------------------------------

    def arguments(self) -> tuple[Argument, ...]:
        """Read `(a, b)` from the bracket on, and return its arguments."""
        bracket = self.i
        self.i += 1
        if self._inner().kind == ")":
            self._to_inner()
            self.i += 1
            return ()
        arguments = [self._argument_or_forever()]
        while self._inner().kind == ",":
            self._to_inner()
            self.i += 1
            arguments.append(self._argument_or_forever())
        if self._inner().kind != ")":
            self._no_close(bracket)
        self._to_inner()
        self.i += 1
        return tuple(arguments)

    def argument(self, inside: bool) -> Argument:
        """Read one expression; `inside` brackets the end of a line is white space."""
        first = self.i
        parts = self._expression(inside)
        span = Span(self.tokens[first].start, self.tokens[self.i - 1].end)
        return Argument(parts, span, self._is_plain(first))

    def count_problem(self, word: Word, arguments: Sequence[Span], span: Span) -> None:
        self.problems.append(count_problem(self.source, word, arguments, span))

    def _argument_or_forever(self) -> Argument:
        token = self._inner()
        if token.kind is WORD and token.text == "FOREVER":
            self._to_inner()
            self.i += 1
            part = Part("FOREVER", 0, token.start, token.end)
            return Argument((part,), token.span, False)
        self._to_inner()
        return self.argument(inside=True)

    def _is_plain(self, first: int) -> bool:
        """Whether the tokens from `first` to here are one number, perhaps after one minus."""
        tokens = self.tokens
        if tokens[first].kind == "-":
            first += 1
            while tokens[first].kind is NEWLINE:
                first += 1
        return tokens[first].kind is NUMBER and self.i == first + 1

    # -- looking over line ends ---------------------------------------------------------------

    def _inner(self) -> Token:
        """Return the next token that is no line end, without going there."""
        k = self.i
        while self.tokens[k].kind is NEWLINE:
            k += 1
        return self.tokens[k]

    def _to_inner(self) -> None:
        while self.tokens[self.i].kind is NEWLINE:
            self.i += 1

    # -- expressions --------------------------------------------------------------------------

    def _expression(self, inside: bool) -> tuple[Part, ...]:
        out: list[Part] = []
        waiting: list[_Operator] = []
        tokens = self.tokens
        brackets = 1 if inside else 0
        while True:
            # an operand is wanted here
            if brackets:
                self._to_inner()
            index = self.i
            token = tokens[index]
            kind = token.kind
            if kind is NUMBER:
                self.i += 1
                out.append(self._number(token, index, waiting))
            elif kind is WORD and token.text not in WORDS:
                self.i += 1
                if tokens[self.i].kind == "(":
                    self._call_of_a_name(token)
                out.append(Part("NAME", token.text, token.start, token.end))
            elif kind == "-":
                self.i += 1
                waiting.append(_Operator(_MINUS, "NEG", token, index))
                continue
            elif kind == "(":
                self.i += 1
                waiting.append(_Operator(_OPEN, "(", token, index))
                brackets += 1
                continue
            elif kind is WORD and token.text in ("TRUE", "FALSE", "TIME"):
                self.i += 1
                if tokens[self.i].kind == "(":
                    self._call_of_a_name(token)
                out.append(Part(token.text, 0, token.start, token.end))
            elif kind is WORD and token.text == "NOT":
                if waiting and waiting[-1].precedence > _NOT:
                    self.fail(problems.NOT_NEEDS_BRACKETS, token.span)
                self.i += 1
                waiting.append(_Operator(_NOT, "NOT", token, index))
                continue
            elif kind is WORD and token.text in _FUNCTIONS:
                self.i += 1
                if brackets:
                    self._to_inner()
                if tokens[self.i].kind != "(":
                    example = WORDS[token.text].example
                    self.fail(problems.MISSING_OPEN, token.span, word=token.text, fix=example)
                waiting.append(_Operator(_OPEN, token.text, token, self.i))
                self.i += 1
                brackets += 1
                if self._inner().kind == ")":
                    self._to_inner()
                    self.i += 1
                    span = Span(token.start, tokens[self.i - 1].end)
                    self.count_problem(WORDS[token.text], (), span)
                    raise Failed
                continue
            else:
                self._no_value(token, waiting)
            # an operator, a comma or a bracket is wanted here
            while True:
                token = self._inner() if brackets else tokens[self.i]
                binary = _BINARY.get(token.text) if token.kind is not ODD else None
                if binary is not None:
                    if brackets:
                        self._to_inner()
                    self._push_binary(token, binary, waiting, out)
                    self.i += 1
                    break
                if token.kind not in _AFTER_VALUE and self._mended(token, brackets, out):
                    if out[-1].op != "NAME" or tokens[self.i].text != "NOT":
                        continue
                    out.pop()  # the NO that is a NOT now: an operand is wanted again
                    break
                bracket = self._reduce_to_bracket(waiting, out)
                if bracket is None:
                    return tuple(out)
                if token.kind == ")":
                    self._to_inner()
                    self.i += 1
                    brackets -= 1
                    waiting.pop()
                    if bracket.name != "(":
                        self._end_call(bracket, out)
                    continue
                if token.kind == "," and bracket.name != "(":
                    self._end_argument(bracket)
                    self._to_inner()
                    self.i += 1
                    break
                self._no_close(bracket.index)

    def _push_binary(
        self, token: Token, binary: tuple[int, str], waiting: list[_Operator], out: list[Part]
    ) -> None:
        precedence, name = binary
        while waiting and waiting[-1].precedence >= precedence:
            if precedence == _COMPARE == waiting[-1].precedence:
                self._chained(waiting[-1], token)
            self._apply(waiting.pop(), out)
        if precedence <= 2:  # AND and OR: the left side may decide
            out.append(Part(name + "_LEFT", 0, token.start, token.end))
        waiting.append(_Operator(precedence, name, token, self.i))

    def _chained(self, first: _Operator, second: Token) -> NoReturn:
        """`1 < X < 5`: suggest `1 < X AND X < 5`."""
        left = self.tokens[first.index - 1]
        middle = self.source.text[first.at.end : second.start].strip()
        right = self.tokens[self.i + 1]
        fix = f"{left.text} {first.at.text} {middle} AND {middle} {second.text} {right.text}"
        self.fail(problems.CHAINED, Span(first.at.start, second.end), fix=fix)

    def _reduce_to_bracket(self, waiting: list[_Operator], out: list[Part]) -> _Operator | None:
        """Apply what waits since the innermost open bracket, and return that bracket."""
        while waiting and waiting[-1].precedence != _OPEN:
            self._apply(waiting.pop(), out)
        return waiting[-1] if waiting else None

    @staticmethod
    def _apply(operator: _Operator, out: list[Part]) -> None:
        out.append(Part(operator.name, 0, operator.at.start, operator.at.end))

    def _end_argument(self, call: _Operator) -> None:
        """Note where an argument of a function ended, for messages."""
        before = call.arguments[-1].end + 1 if call.arguments else None
        first = self.tokens[call.index].end if before is None else before
        end = self.tokens[self.i - 1].end
        text = self.source.text[first:end]
        start = first + len(text) - len(text.lstrip())
        call.arguments.append(Span(start, end))

    def _end_call(self, call: _Operator, out: list[Part]) -> None:
        close = self.tokens[self.i - 1]
        self.i -= 1
        self._end_argument(call)
        self.i += 1
        word = WORDS[call.name]
        if len(call.arguments) != len(word.arguments):
            span = Span(call.at.start, close.end)
            self.count_problem(word, call.arguments, span)
            raise Failed
        out.append(Part(call.name, 0, call.at.start, close.end))

    def _number(self, token: Token, index: int, waiting: list[_Operator]) -> Part:
        value, exact = read_literal(token.text)
        start = token.start
        if (
            waiting
            and waiting[-1].precedence == _MINUS
            and waiting[-1].index == self._before(index)
        ):
            start = waiting.pop().at.start
            value = -value
        if not LOWEST <= value <= HIGHEST:
            limit = as_text(HIGHEST if value > 0 else LOWEST)
            self.report(problems.NUMBER_TOO_BIG, Span(start, token.end), limit=limit)
            value = 0
        elif not exact:
            span = Span(start, token.end)
            self.report(problems.ROUNDED, span, found=token.text[:20], right=as_text(value))
        return Part("NUMBER", value, start, token.end)

    def _before(self, index: int) -> int:
        """Return the index of the token before `index`, line ends passed over."""
        index -= 1
        while self.tokens[index].kind is NEWLINE:
            index -= 1
        return index

    # -- what can be wrong --------------------------------------------------------------------

    def _mended(self, token: Token, brackets: int, out: list[Part]) -> bool:
        """Name what stands where an operator is wanted, and mend it if it is clear what it means.

        Then reading goes on at `i`, where an operator is now.
        """
        tokens = self.tokens
        if token.kind is not WORD and not starts_value(token):
            return False
        k = self.i
        while tokens[k].kind is NEWLINE:
            k += 1
        said = operator_words(tokens, k)
        if said is not None and (brackets or not self._begins_line(k)):
            end, right = said
            span = Span(token.start, tokens[end - 1].end)
            self.report(problems.OTHER_SIGN, span, found=self.source[span], right=right)
            kind = WORD if right.isalpha() else right
            tokens[end - 1] = Token(kind, right, span.start, span.end)
            self.i = end - 1
            return True
        last = self._before(k)
        before = tokens[last]
        is_name = before.kind is WORD and token.text not in WORDS and bool(brackets)
        if token.text in UNITS and (before.kind is NUMBER or is_name):
            after = tokens[k + 1].kind
            wanted = _AFTER_VALUE if brackets else _ENDS
            if (after in wanted and (brackets or token.text not in WORDS)) or after in _BINARY:
                span = Span(before.start, token.end)
                self.report(problems.UNIT, span, found=self.source[span], right=before.text)
                self.i = k + 1
                return True
        if before.kind is WORD and before.text == "NO" and out[-1].op == "NAME" and brackets:
            self.report(problems.OTHER_SIGN, before.span, found=before.text, right="NOT")
            tokens[last] = Token(WORD, "NOT", before.start, before.end)
            self.i = last
            return True
        return False

    def _begins_line(self, k: int) -> bool:
        """Whether the word at `k` is rather a name: `X = 3 Y = 4`, `X = 3 Y(4)`."""
        return self.tokens[k + 1].kind in ("=", "(", *_ENDS)

    def _no_value(self, token: Token, waiting: list[_Operator]) -> NoReturn:
        """Say what is wrong with a token that stands where a value is wanted."""
        if token.kind is ODD:
            raise Failed
        before = self.tokens[self._before(self.i)]
        at_end = token.kind in _ENDS
        if before.kind == "%" and token.kind in _AFTER_VALUE:
            number = self.tokens[self._before(self.i) - 1]
            span = Span(number.start, before.end)
            self.fail(problems.UNIT, span, found=self.source[span], right=number.text)
        if token.kind is WORD and WORDS[token.text].role != "operator":
            self._no_value_word(token)
        span = before.span if at_end else token.span
        found = "" if at_end else token.text
        self.fail(problems.MISSING_VALUE, span, found=found, before=before.text)

    def _no_value_word(self, token: Token) -> NoReturn:
        word = WORDS[token.text]
        if word.role == "forever":
            self.fail(problems.FOREVER_NOT_HERE, token.span)
        if word.role == "until":
            self.fail(problems.UNTIL_ALONE, token.span, fix="")
        if word.role in ("move", "wait", "motors", "beep", "show"):
            if self.tokens[self.i + 1].kind == "(":
                self.fail(problems.NO_VALUE, token.span, word=word.text)
        if word.text in self.reserved:
            raise Failed
        self.fail(problems.RESERVED, token.span, word=word.text, right=other_name(word.text))

    def _call_of_a_name(self, name: Token) -> None:
        """`DISTANCE()` or `SQRT(4)` in an expression: no name of a program is a function."""
        meant = WORDS.get(meant_by(name.text) or "")
        if meant is not None and meant.arguments:
            fix = call_in(meant, self._in_brackets(self.i))
            self.fail(
                problems.OTHER_LANGUAGE, name.span, found=name.text, right=meant.text, fix=fix
            )
        close = self.tokens[self.i + 1]
        if close.kind != ")":
            self.fail(problems.NO_FUNCTION, name.span, found=name.text)
        self.report(problems.EMPTY_BRACKETS, Span(name.start, close.end), word=name.text)
        self.i += 2

    def _in_brackets(self, bracket: int) -> list[Token]:
        """Return the tokens after a `(` up to its `)`, or to where the instruction ends."""
        depth, k = 1, bracket + 1
        while self.tokens[k].kind not in (";", END):
            depth += (self.tokens[k].kind == "(") - (self.tokens[k].kind == ")")
            if not depth:
                break
            k += 1
        return self.tokens[bracket + 1 : k]

    def _no_close(self, bracket: int) -> NoReturn:
        """A bracket is open and what comes cannot stand in it: say what is missing."""
        token = self._inner()
        last = self.tokens[self._before(self.i)]
        same_line = self.tokens[self.i] is token
        if token.kind is ODD and token.text != ":":
            raise Failed
        if token.kind == ";" and self._close_comes():
            while self.tokens[self.i].kind != ")":
                self.i += 1
            self.i += 1
            self.fail(problems.SEMICOLON_INSIDE, token.span)
        if token.kind == "=":
            self.fail(problems.MISSING_VALUE, token.span, found="=", before=last.text)
        if same_line and starts_value(token) and ends_value(last) and self._close_comes():
            self._nothing_between(last, token, bracket)
        if token.kind is ODD:
            self.answered.add(token.start)
        self.fail(problems.MISSING_CLOSE, last.span, last=last.text)

    def _nothing_between(self, last: Token, token: Token, bracket: int) -> NoReturn:
        """Two values in brackets with only a space between them."""
        span = Span(last.start, token.end)
        owner = self.tokens[bracket - 1] if bracket else self.tokens[bracket]
        word = self.word_of(owner)
        if word is not None and len(word.arguments) > 1:
            fix = call_in(word, self._in_brackets(bracket))
            self.fail(problems.MISSING_COMMA, span, fix=fix)
        sign = "<" if last.kind is WORD or last.kind == ")" else "+"
        fix = f"{last.text} {sign} {token.text}" if last.kind != ")" and token.kind != "(" else ""
        self.fail(problems.MISSING_SIGN, span, before=last.text, found=token.text, fix=fix)

    def word_of(self, token: Token) -> Word | None:
        """Return the word of the language that takes values in brackets here."""
        return WORDS.get(token.text) if token.kind is WORD else None

    def _close_comes(self) -> bool:
        """Whether a `)` comes on this line before another bracket opens."""
        for k in range(self.i, len(self.tokens)):
            kind = self.tokens[k].kind
            if kind in ("(", NEWLINE, END):
                return False
            if kind == ")":
                return True
        return False
