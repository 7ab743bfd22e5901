"""Suggests how a whole line is written whose block is written in another way.

Reads `si distancia < 10 entonces para`, `LOOP(4) { F(1, 60) }` or `WHILE X > 1 F(1, 50) END_WHILE`,
and writes it as the language does. A line that has one word that is not understood is given up:
no suggestion is better than a wrong one. Reports nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.syntax.blocks import ENDS, HEADERS
from tiniscript.syntax.call_suggestions import LONGEST, call_in, written
from tiniscript.syntax.clauses import order_at
from tiniscript.syntax.ends import ends_behind
from tiniscript.syntax.lexer import END, NEWLINE, NUMBER, ODD, WORD, Token
from tiniscript.syntax.near import ASKING, near_at
from tiniscript.syntax.operators import SIGNS
from tiniscript.syntax.phrases import AFTER_HEADER, BETWEEN, COUNTING, ENDS_OF_ANY, FILLERS
from tiniscript.syntax.suggestions import (
    after_bracket,
    asked_again,
    body_begins,
    foreign_block,
    operator_words,
)
from tiniscript.syntax.units import converted
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import BLOCK_ENDS, IN_MILLISECONDS, UNITS, WORDS, Word

_LOOSE = (";", ",", "{", "|", ODD)  # signs between instructions, here or elsewhere
# What goes on behind a block as well as in it: `repite 4 veces avanza y luego pita`.
_AFTERWARDS = frozenset(("LUEGO", "DESPUES", "NEXT", "FINALMENTE", "FINALLY"))


class Line(NamedTuple):
    """A line as the language writes it, the place of its end, and the blocks open there."""

    text: str
    end: int
    open: tuple[str, ...]
    variables: tuple[Token, ...]  # that it sets


def line_of_block(
    tokens: Sequence[Token], start: int, block: str, known: Vocabulary
) -> Line | None:
    """Return the line that begins with a header at `start`, None where it is not understood.

    A block that the line begins ends with the line, unless its end follows further down.
    """
    return _Reader(tokens, start, known).line(block)


class _Reader:
    def __init__(self, tokens: Sequence[Token], start: int, known: Vocabulary) -> None:
        self.tokens = tokens
        self.k = start
        self.known = known
        self.row: list[str] = []
        self.open: list[str] = []
        self.variables: list[Token] = []
        self.has_braces = False
        self.has_parted = False  # a `;` stands behind an instruction of a block

    @property
    def token(self) -> Token:
        return self.tokens[self.k]

    def line(self, block: str) -> Line | None:
        start = self.k
        if not self._header(block):
            return None
        while self.token.kind not in (NEWLINE, END):
            if self.k > start + 2 * LONGEST or not self._step():
                return None
        if self.open and self.open[-1] != "LOOP" and self.has_parted and not self.has_braces:
            return None  # `IF(c) S; F(1, 50)`: which of them belong to it is not said
        if self.open and self.has_braces and self._closes_below(start):
            return None
        if self.open and not self._goes_on(start):
            while self.open:
                self._end()
        heads = (WORDS.get(each.partition("(")[0]) for each in self.row)
        if all(word is not None and word.role in ("block", "arm", "end") for word in heads):
            return None  # no instruction: the header alone is to be mended
        return Line(";".join(self.row), self.k, tuple(self.open), tuple(self.variables))

    def _closes_below(self, start: int) -> bool:
        """Whether a `{` of the line has its `}` on another one, or none where more follows."""
        row = [each.kind for each in self.tokens[start : self.k]]
        rest = self.tokens[self.k : self.k + 20 * LONGEST]
        is_followed = any(each.kind not in (NEWLINE, END) for each in rest)
        return row.count("{") > row.count("}") and is_followed

    def _step(self) -> bool:
        """Read an instruction or what stands between two; return whether it is understood."""
        token = self.token
        if token.kind in _LOOSE or (token.kind is WORD and token.text in (*AFTER_HEADER, *BETWEEN)):
            self.k += 1
            self.has_braces |= token.kind == "{"
            after = self.token.kind is WORD and not self._is_of_block(self.token)
            is_body = bool(self.open) and self.row[-1].partition("(")[0] not in (*HEADERS, "ELSE")
            if token.text in _AFTERWARDS and is_body and self.open[-1] == "LOOP":
                return False
            self.has_parted |= token.kind == ";" and is_body and after
            return token.kind is not ODD or token.text in (":", ".")
        if token.kind == "}" and self.has_parted and not self.has_braces:
            return False  # `while (c) { if (d) break; F(1, 50); }`: the `}` is of another block
        if token.kind in ("}", ")"):  # a `]` is a `)` by now
            self.k += 1
            goes_on = self._block_of(self.token) in ("ELSE", "ELSEIF")
            return goes_on or self._end()
        if token.kind == "(":
            self.k += 1
            return bool(self.open)
        return token.kind is WORD and self._word(token)

    def _word(self, word: Token) -> bool:
        following = self.tokens[self.k + 1]
        text = word.text
        block = self._block_of(word) or text
        if text == "SI" and following.text != "NO":
            block = "IF"
        if text == "SI" and following.text == "NO":
            self.k += 1
            block = "ELSE"
        if block == "END" or (text == "END" and following.text in BLOCK_ENDS):
            self.k += 1
            if self.token.kind is WORD and self._names_block(self.token.text):
                self.k += 1
            return self._end()
        if block in ENDS:
            self.k += 1
            return self._end()
        if block == "ELSE" and self.tokens[self.k + 1].text in ("IF", "SI"):
            self.k += 1
            block = "ELSEIF"
        if block in ("ELSE", "ELSEIF") and (not self.open or self.open[-1] != "IF"):
            return False
        if block == "ELSE":
            self.k += 1
            self.row.append("ELSE")
            self.has_parted = False
            return True
        if block in HEADERS and following.kind in (NEWLINE, END) and block in self.open[-1:]:
            self.k += 1  # `LOOP(4) F(1, 50) LOOP`
            return self._end()
        if block == "IF" and not self.has_braces and self._stands_beside():
            return False  # `IF(a) S IF(b) S`: the second may be in the first, or behind it
        if block in HEADERS or block == "ELSEIF":
            return self._header(block) and (self.token.kind == "{" or not self.has_braces)
        if following.kind == "=":
            return self._assignment(word)
        order = order_at(self.tokens, self.k, self.known) if following.kind != "(" else None
        if order is not None:
            text, self.k = order
            self.row.append(text)
            return True
        return self._command(word)

    def _stands_beside(self) -> bool:
        """Whether an IF comes behind what another one does, with no ends on the line."""
        is_within = self.open[-1:] == ["IF"] and self.row[-1].partition("(")[0] not in (
            *HEADERS, "ELSE", "ELSEIF"
        )  # fmt: skip
        k = self.k
        while is_within and self.tokens[k].kind not in (NEWLINE, END):
            is_within = self._block_of(self.tokens[k]) not in (*ENDS, "END")
            k += 1
        return is_within

    def _block_of(self, token: Token) -> str | None:
        """Return the word of a block that a token means, here or elsewhere."""
        if token.kind is not WORD or self.known.is_name(token.text):
            return None
        return token.text if token.text in WORDS else foreign_block(token.text)

    def _is_of_block(self, token: Token) -> bool:
        block = self._block_of(token) or token.text
        return block in (*HEADERS, *ENDS, "ELSE", "ELSEIF", *ENDS_OF_ANY)

    def _names_block(self, word: str) -> bool:
        return word == "SI" or word in BLOCK_ENDS or foreign_block(word) in BLOCK_ENDS

    def _end(self) -> bool:
        if not self.open:
            return False
        self.row.append(BLOCK_ENDS[self.open.pop()])
        self.has_parted = False
        return True

    def _header(self, block: str) -> bool:
        word = self.token
        self.k += 1
        near = near_at(self.tokens, self.k, self.known) if block in ASKING else None
        if near is not None:
            self.row.append(f"{block}({near.question})")
            self.open += [] if block == "ELSEIF" else [block]
            self.k = near.end
            return True
        values = self._values()
        if block == "LOOP" and word.text in COUNTING:
            return False  # the count may be used in the body
        if block == "LOOP":
            values = [each for each in values if each.text not in AFTER_HEADER]
            if len(values) != 1:
                return False
        if not values:
            return False
        inside = self._question(values)
        if inside is None:
            return False
        self.row.append(f"{block}({inside})")
        if block != "ELSEIF":
            self.open.append(block)
        return True

    def _values(self) -> list[Token]:
        """Return the tokens of the values that come next, without their brackets."""
        tokens, k = self.tokens, self.k
        while tokens[k].text in FILLERS:
            k += 1
        if tokens[k].kind == "(":
            end = after_bracket(tokens, k)
            if end is not None:
                after = tokens[end]
                goes_on = after.kind in SIGNS or after.text in ("AND", "OR", "Y", "O")
                if not goes_on:
                    self.k = end
                    return list(tokens[k + 1 : end - 1])
        self.k = body_begins(tokens, k)
        for i in range(k + 1, self.k):  # `LOOP 4 [F(1, 60)]`
            if tokens[i].kind == "(" and tokens[i - 1].kind is NUMBER:
                self.k = i
        return list(tokens[k : self.k])

    def _question(self, values: Sequence[Token]) -> str | None:
        """Return a condition or a value in the signs and words of the language."""
        row: list[Token] = []
        padded = [*values, Token(END, "", 0, 0), Token(END, "", 0, 0)]
        k = 0
        while k < len(values):
            token = padded[k]
            row += asked_again(row, token)
            said = operator_words(padded, k) if row else None
            if said is not None:
                k, sign = said
                row.append(Token(WORD if sign.isalpha() else sign, sign, *token.span))
                continue
            k += 1
            if token.kind is WORD and token.text in FILLERS:
                continue
            if token.text in UNITS and row and row[-1].kind is NUMBER and token.kind is WORD:
                if UNITS[token.text] != ("cm", 1000):
                    return None
                continue
            if token.kind is ODD or token.kind == ",":
                return None
            if token.kind is WORD and self.known.is_name(token.text) and padded[k].kind == "(":
                return None  # `DISTANCE(15)`
            text = self.known.value(token.text) if token.kind is WORD else token.text
            joined = self.known.value(f"{token.text}_{padded[k].text}")
            if token.kind is padded[k].kind is WORD and self.known.is_number(joined):
                text, k = joined, k + 1  # `luz derecha`
            row.append(token._replace(text=text))
        return written(row) or None

    def _assignment(self, name: Token) -> bool:
        if name.text in WORDS or self.known.is_name(name.text):
            return False
        end = body_begins(self.tokens, self.k + 2, names_end=False)
        value = self._question(self.tokens[self.k + 2 : end])
        if value is None:
            return False
        self.row.append(f"{name.text} = {value}")
        self.variables.append(name)
        self.k = end
        return True

    def _command(self, token: Token) -> bool:
        word = self.known.command(token.text)
        if word is None:
            if not self.known.is_name(token.text):
                return False
            self.k += 1
            self.row.append(token.text)
            return True
        if word.role in ("stop", "break"):
            self.k += 1
            if self.token.kind == "(" and self.tokens[self.k + 1].kind == ")":
                self.k += 2
            self.row.append(word.text)
            return self.token.kind is not NUMBER
        if not word.is_call and word.role != "actuator":
            return False
        return self._call(word, token.text in IN_MILLISECONDS)

    def _call(self, word: Word, is_in_ms: bool) -> bool:
        """`is_in_ms`: its one value is a number of milliseconds, as in `delay(1000)`."""
        self.k += 1
        if self.token.kind == "(":
            end = after_bracket(self.tokens, self.k)
            if end is None:
                return False
            values, self.k = list(self.tokens[self.k + 1 : end - 1]), end
        else:
            end = body_begins(self.tokens, self.k)
            values, self.k = list(self.tokens[self.k : end]), end
        values = [
            each._replace(text=self.known.value(each.text)) if each.kind is WORD else each
            for each in values
        ]
        if is_in_ms:
            if len(values) != 1 or values[0].kind is not NUMBER:
                return False
            values = [values[0]._replace(text=converted(values[0].text, "MS"))]
        call = call_in(word, values)
        if not call:
            return False
        if word.role in ("move", "wait") and self._is_until():
            question = self._question(self._values())
            if question is None:
                return False
            call = f"{call} UNTIL({question})"
        self.row.append(call)
        return True

    def _is_until(self) -> bool:
        """Whether `UNTIL` or `HASTA QUE` comes next; then go past it."""
        token = self.token
        meant = self.known.command(token.text) if token.kind is WORD else None
        if meant is None or meant.role != "until":
            return False
        self.k += 1
        return True

    def _goes_on(self, start: int) -> bool:
        """Whether an open block of this line ends further down."""
        tokens, after = self.tokens, self.k
        while tokens[after].kind is NEWLINE:
            after += 1
        if tokens[after].kind is END:
            return False
        if _column(tokens, after) > _column(tokens, start):
            return True
        return next(ends_behind(tokens, after), None) is not None


def _column(tokens: Sequence[Token], k: int) -> int:
    """Return how far a line is indented, in characters, whose token is at `k`."""
    while k and tokens[k - 1].kind is not NEWLINE:
        k -= 1
    return tokens[k].start - (tokens[k - 1].end if k else 0)
