"""Recovery of values that other languages have and this one has not.

Knows lists, `input()`, a choice in the middle of a value, sentences to show, and a question behind
an instruction. One diagnostic stands for all of it.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

from tiniscript.diagnostics import codes
from tiniscript.source import Span
from tiniscript.syntax.call_suggestions import LONGEST, call_in, starts_value, written
from tiniscript.syntax.cursor import AT_END, Cursor
from tiniscript.syntax.lexer import NUMBER, ODD, QUOTES, WORD, Token
from tiniscript.syntax.phrases import FILLERS, READING
from tiniscript.syntax.reporter import Reporter
from tiniscript.syntax.suggestions import (
    after_bracket,
    with_signs,
)
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import BLOCK_ENDS, NEAR_WORDS, WORDS, Word, meant_by

_ENDIF = BLOCK_ENDS["IF"]
_FARTHEST = 2000  # tokens in which the end of a block is looked for
_AROUND = re.compile(r"([0-9]+(?:\.[0-9]+)?)([FBLR])([0-9]+)")
_ASKING = frozenset(
    ("INPUT", "READ", "SCANF", "LEER", "PREGUNTAR", "ENTRADA", "PROMPT", "RAW_INPUT")
)
_JOINING = ("+", ",", "&", ".", ";")  # what stands between a sentence and a value


class ValueConstructs:
    def __init__(self, cursor: Cursor, reporter: Reporter, known: Vocabulary) -> None:
        self.cursor = cursor
        self.reporter = reporter
        self.known = known
        self._lists: set[str] = set()

    # -- what a variable gets -----------------------------------------------------------------

    def unread_value(self, name: Token, start: int, said: int) -> None:
        """Look at what `name` gets, which cannot be read: the tokens from `start` on.

        `said` diagnostics were there before it was read.
        """
        row = self._line(start)
        if row and self._is_list(row):
            self._list(name, row, said)
        choice = self._choice(name, row)
        if choice:
            self._chosen(name, row, choice, said)

    def _line(self, start: int) -> list[Token]:
        tokens, k = self.cursor.tokens, start
        while tokens[k].kind not in AT_END and k < start + LONGEST:
            is_call = tokens[k].kind is WORD and tokens[k + 1].kind == "("
            command = self.known.command(tokens[k].text) if is_call else None
            if command is not None and (command.is_instruction or command.role == "actuator"):
                break  # `X = 50, F(2, X)`
            k += 1
        return list(tokens[start:k])

    def _is_list(self, row: Sequence[Token]) -> bool:
        source = self.cursor.source.text
        begins = source[row[0].start : row[0].end]
        depth, commas = 0, 0
        for token in row[1 if begins == "(" else 0 :]:  # `ROUND(1,5, 0)` has none
            commas += token.kind == "," and not depth
            depth += (token.kind == "(") - (token.kind == ")")
        return begins in ("[", "{") or commas > 1

    def _list(self, name: Token, row: Sequence[Token], said: int) -> None:
        values = [token for token in row if token.kind is NUMBER]
        if not all(token.kind in (NUMBER, ",", "(", ")", "{", "}", "-", "]") for token in row):
            values = []
        has_minus = any(token.kind == "-" for token in row)
        pairs = [f"{name.text}_{k + 1} = {each.text}" for k, each in enumerate(values)]
        self._lists.add(name.text)
        self.reporter.withdraw(said)
        for token in row:
            self.reporter.answer(token)
        self.cursor.i = self.cursor.tokens.index(row[-1]) + 1
        fix = ";".join(pairs) if 0 < len(pairs) <= 5 and not has_minus else ""
        self.reporter.fail(
            codes.LISTS, Span(name.start, row[-1].end), None, found=name.text, fix=fix
        )

    def _choice(self, name: Token, row: Sequence[Token]) -> str:
        """Return the IF that `c ? a : b` or `a if c else b` was meant to be."""
        texts = [token.text for token in row]
        for first, second, asks_first in (("?", ":", True), ("IF", "ELSE", False)):
            if first not in texts or second not in texts[texts.index(first) + 1 :]:
                continue
            k = texts.index(first)
            other = texts.index(second, k + 1)
            pieces = (row[:k], row[k + 1 : other], row[other + 1 :])
            question, yes, no = pieces if asks_first else (pieces[1], pieces[0], pieces[2])
            if not (question and yes and no) or any(
                token.kind is ODD for piece in pieces for token in piece
            ):
                return ""
            asked, one, two = (self._said(piece) for piece in (question, yes, no))
            return f"IF({asked});{name.text} = {one};ELSE;{name.text} = {two};{_ENDIF}"
        return ""

    def _said(self, tokens: Sequence[Token]) -> str:
        is_framed = tokens[0].kind == "(" and tokens[-1].kind == ")" and (
            sum(token.kind == "(" for token in tokens) == 1
        )  # fmt: skip
        return self.known.translated(written(with_signs(tokens[1:-1] if is_framed else tokens)))

    def _chosen(self, name: Token, row: Sequence[Token], fix: str, said: int) -> None:
        self.reporter.withdraw(said)
        for token in row:
            self.reporter.answer(token)
        self.cursor.skip_instruction()
        span = Span(name.start, row[-1].end)
        self.reporter.fail(codes.CHOICE_IN_VALUE, span, None, fix=fix)

    def is_said_with_more(self, word: Token) -> bool:
        """Whether a name has a word beside it that says no more; then read on with the name."""
        return self._is_dotted(word) or self._is_article(word)

    def _is_dotted(self, word: Token) -> bool:
        """`DISTANCE.read()`, `robot.DISTANCE`: what a sensor measures is its name alone."""
        tokens, k = self.cursor.tokens, self.cursor.i
        point = self.cursor.following
        if point.kind is not ODD or point.text != "." or tokens[k + 2].kind is not WORD:
            return False
        names = [self.known.value(tokens[i].text) for i in (k, k + 2)]
        names = [name for name in names if self.known.is_own(name)]
        end = k + 3
        if tokens[end].kind == "(" and tokens[end + 1].kind == ")":
            end += 2
        if len(names) != 1 or tokens[end].kind == "(":
            return False
        self.reporter.answer(point)
        span = Span(word.start, tokens[end - 1].end)
        shown = self.cursor.source[span]
        self.reporter.report(codes.OTHER_LANGUAGE, span, span, found=shown, right=names[0],
                             fix=names[0], usage=names[0])  # fmt: skip
        tokens[k:end] = [Token(WORD, names[0], *span)]
        return True

    def _is_article(self, word: Token) -> bool:
        """`X = la distancia`: report the word before a name of the program, and go on behind it."""
        after = self.cursor.following
        name = self.known.value(after.text)
        if word.text not in FILLERS or after.kind is not WORD or self.known.is_own(word.text):
            return False
        if not self.known.is_own(name):
            return False
        span = Span(word.start, after.end)
        shown = self.cursor.source[span]
        self.reporter.report(codes.OTHER_LANGUAGE, span, span, found=shown, right=name, fix=name,
                             usage=name)  # fmt: skip
        self.cursor.i += 1
        return True

    def is_value(self, token: Token) -> bool:
        """Whether a token is a number, or the name of something that has a value."""
        return token.kind is NUMBER or self.known.is_own(self.known.value(token.text))

    # -- what looks like a function -----------------------------------------------------------

    def called(self, name: Token, bracket: Token) -> None:
        """`input()`, `V[0]`: no function, and no list."""
        source = self.cursor.source.text
        if source[bracket.start : bracket.end] == "[":
            self.reporter.answer(bracket)
            end = after_bracket(self.cursor.tokens, self.cursor.i)
            for token in self.cursor.tokens[self.cursor.i : end]:
                self.reporter.answer(token)
            span = self._to(name, end)
            if name.text in self._lists:
                index = self.cursor.following.text
                number = str(int(index) + 1) if index.isdecimal() else "1"
                self.reporter.fail(codes.LISTS, span, span, found=name.text,
                                   fix=f"{name.text}_{number}")  # fmt: skip
            self.reporter.fail(codes.LISTS, span, None, found=name.text, fix="")
        sensor = self.known.value(self.cursor.following.text)
        if name.text in READING and self.known.is_name(sensor):  # `X = leer(DISTANCE)`
            end = after_bracket(self.cursor.tokens, self.cursor.i)
            span = self._to(name, end)
            shown = self.cursor.source[span]
            self.reporter.fail(codes.OTHER_LANGUAGE, span, span, found=shown, right=sensor,
                               fix=sensor, usage=sensor)  # fmt: skip
        if name.text in _ASKING and not self.known.is_own(name.text):
            end = after_bracket(self.cursor.tokens, self.cursor.i)
            for token in self.cursor.tokens[self.cursor.i : end]:
                self.reporter.answer(token)
            self.reporter.fail(codes.NO_INPUT, self._to(name, end), None, found=name.text)

    def _to(self, first: Token, end: int | None) -> Span:
        if end is None:
            return first.span
        self.cursor.i = end
        return Span(first.start, self.cursor.tokens[end - 1].end)

    # -- what is shown ------------------------------------------------------------------------

    def sentence(self) -> None:
        """`SHOW("d = " + DISTANCE)`: the value can be shown, the sentence cannot."""
        cursor = self.cursor
        bracket = self._bracket_of_show()
        end = None if bracket is None else after_bracket(cursor.tokens, bracket)
        if bracket is None or end is None:
            return
        word = cursor.tokens[bracket - 1]
        row = cursor.tokens[bracket + 1 : end - 1]
        if not any(token.kind is ODD and token.text[:1] in QUOTES for token in row):
            return
        values = [
            token
            for token, after in pairwise((*row, cursor.tokens[end - 1]))
            if token.kind is not ODD and not (token.text == "F" and after.kind is ODD)
        ]
        while values and values[0].kind in _JOINING:
            del values[0]
        while values and values[-1].kind in _JOINING:
            del values[-1]
        is_one = len(values) == 1 and starts_value(values[0]) and len(values) < len(row)
        fix = f"SHOW({self.known.value(values[0].text)})" if is_one else self._shown_within(row)
        if values and not fix:
            return
        for token in row:
            self.reporter.answer(token)
        span = Span(row[0].start, row[-1].end)
        place = Span(word.start, cursor.tokens[end - 1].end)
        cursor.i = end
        self.reporter.fail(codes.WORDS_SHOWN, span, place, fix=fix)

    def _shown_within(self, row: Sequence[Token]) -> str:
        """`print(f"{DISTANCE} cm")`: the one value that a sentence of Python names."""
        text = self.cursor.source[Span(row[0].start, row[-1].end)]
        names = [self.known.value(name.upper()) for name in re.findall(r"\{(\w+)\}", text)]
        is_one = len(names) == 1 and self.known.is_own(names[0])
        return f"SHOW({names[0]})" if is_one else ""

    def near_said(self, span: Span, found: str, last: Token, token: Token, bracket: int) -> None:
        """`IF(HAY PARED)`: what a robot measures is how far it is."""
        owner = self.cursor.tokens[bracket - 1].text if bracket else ""
        is_near = last.text in NEAR_WORDS or token.text in NEAR_WORDS
        end = self.cursor.following.kind
        if is_near and end == ")" and owner in ("IF", "ELSEIF", "WHILE", "UNTIL") and (
            self.known.is_number("DISTANCE")
        ):  # fmt: skip
            self.cursor.i += 1
            self.reporter.fail(codes.UNKNOWN_NAME, span, None, found=found, near="DISTANCE < 10")

    def words_shown(self, name: str) -> None:
        """`SHOW(hello world)`: words that are no name of the program."""
        bracket = self._bracket_of_show()
        if bracket is None or self.known.is_own(name):
            return
        tokens = self.cursor.tokens
        end = after_bracket(tokens, bracket)
        if end is None or any(each.kind is not WORD for each in tokens[bracket + 1 : end - 1]):
            return
        span = Span(tokens[bracket].end, tokens[end - 1].start)
        self.cursor.i = end
        self.reporter.fail(codes.WORDS_SHOWN, span, None, fix="")

    def _bracket_of_show(self) -> int | None:
        """Return the place of the bracket around the cursor's, if it is that of SHOW or PRINT."""
        tokens, k = self.cursor.tokens, self.cursor.i
        while k and tokens[k].kind not in ("(", *AT_END):
            k -= 1
        word = tokens[k - 1] if k and tokens[k].kind == "(" else None
        if word is None or word.kind is not WORD:
            return None
        meant = word.text if word.text in WORDS else meant_by(word.text)
        return k if meant == "SHOW" else None

    # -- a question behind an instruction -----------------------------------------------------

    def goes_on(self, first: Token) -> None:
        """Look at what stands where the instruction that begins with `first` must end."""
        cursor = self.cursor
        k = cursor.i
        while k and cursor.tokens[k] is not first:
            k -= 1
        if cursor.tokens[k + 1].kind == "=":
            self.unread_value(first, k + 2, len(self.reporter.diagnostics))
        command = self.known.command(first.text)
        if command is not None and (command.is_instruction or command.role == "actuator"):
            self._brackets_behind(first, k, command)

    def _brackets_behind(self, first: Token, k: int, word: Word) -> None:
        """`F(2)(80)`: each value in brackets of its own."""
        cursor = self.cursor
        tokens, begin = cursor.tokens, cursor.i
        end = after_bracket(tokens, begin) if cursor.token.kind == "(" else None
        if end is None or tokens[k + 1].kind != "(" or tokens[end].kind not in AT_END:
            return
        if any(token.kind == "," for token in tokens[k:end]):
            return  # `F(2, 80) (avanza)`
        between = Token(",", ",", *tokens[begin].span)
        values = [*tokens[k + 2 : begin - 1], between, *tokens[begin + 1 : end - 1]]
        fix = call_in(word, values) if len(word.arguments) > 1 else ""
        if fix:
            cursor.i = end
            span = Span(first.start, tokens[end - 1].end)
            self.reporter.fail(codes.MISSING_COMMA, span, span, fix=fix, usage=word.usage)

    # -- values in front of their word --------------------------------------------------------

    def values_in_front(self, first: Token) -> None:
        """`(2, 80)F`, `2F80`: the values stand before their word, or around it."""
        cursor = self.cursor
        if first.kind is NUMBER:
            glued = _AROUND.fullmatch(cursor.source[first.span].upper())
            if glued is not None and cursor.token.kind in AT_END:
                self.reporter.answer(first)
                known = WORDS[glued[2]]
                fix = f"{glued[2]}({glued[1]}, {glued[3]})"
                self.reporter.fail(codes.MISSING_OPEN, first.span, None, word=known.text, fix=fix,
                                   usage=known.usage)  # fmt: skip
            return
        end = after_bracket(cursor.tokens, cursor.i - 1)
        if end is None:
            return
        word = cursor.tokens[end]
        command = self.known.command(word.text) if word.kind is WORD else None
        if command is None or not command.arguments or cursor.tokens[end + 1].kind not in AT_END:
            return
        fix = call_in(command, cursor.tokens[cursor.i : end - 1])
        cursor.i = end + 1
        span = Span(first.start, word.end)
        self.reporter.fail(codes.MISSING_OPEN, span, span, word=command.text, fix=fix,
                           usage=command.usage)  # fmt: skip
