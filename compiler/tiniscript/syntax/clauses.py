"""Reads the orders of a sentence: `avanza 2 segundos y luego para` says F and S.

Knows what each word of such a sentence says. One word that is not understood gives up all of it: no
suggestion is better than a wrong one. Reports nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from tiniscript.source import Span
from tiniscript.syntax.blocks import ENDS
from tiniscript.syntax.call_suggestions import LONG_TIME_S, LONGEST
from tiniscript.syntax.cursor import AT_END
from tiniscript.syntax.lexer import END, NUMBER, ODD, WORD, Token
from tiniscript.syntax.near import near_at
from tiniscript.syntax.phrases import (
    AGAIN,
    BEFORE_MOVE,
    BEFORE_POWER,
    BEFORE_SENTENCE,
    BEFORE_TIME,
    BETWEEN,
    FILLERS,
    TIMES,
    WAYS,
)
from tiniscript.syntax.suggestions import foreign_block
from tiniscript.syntax.time_phrases import with_numbers
from tiniscript.syntax.units import converted
from tiniscript.syntax.vocabulary import Vocabulary
from tiniscript.words import POWER_WORDS, TURN_WORDS, UNITS, WORDS, Word, is_guessed

# What says where to, beside a word for a move: `a la derecha`, `to the left`.
_TOWARDS = FILLERS | {"TO", "TOWARDS", "TOWARD"}
_BEFORE_VALUE = FILLERS | BEFORE_TIME | BEFORE_POWER | {"AT", "WITH", "EN"}
_BEFORE_ORDER = (BEFORE_MOVE | BEFORE_SENTENCE | FILLERS) - TURN_WORDS
# Words for a move that do not say that it is straight: `go left`, `muévete atrás`.
_GOING = frozenset(("GO", "MOVE", "MOVER", "MUEVE", "MUEVETE", "DRIVE", "VE", "IR", "WALK"))
_ROLES = ("move", "wait", "stop", "beep")


class Sentence(NamedTuple):
    """Orders as the language writes them, where they end among the tokens, and what is made up."""

    orders: tuple[str, ...]
    end: int
    examples: tuple[str, ...]  # the time and the power that nobody has said, with their units
    turn: Span | None  # the first that says no way; the orders have R for it

    @property
    def has_until(self) -> bool:
        return any("UNTIL" in order for order in self.orders)


def sentence_at(tokens: Sequence[Token], start: int, known: Vocabulary) -> Sentence | None:
    """Return the orders from `start` to the end of its instruction, None where not understood."""
    end = _end(tokens, start)
    if end is None:
        return None
    row = with_numbers(tokens[start:end])
    if row and row[-1].kind is ODD and row[-1].text == ".":
        del row[-1]
    orders: list[str] = []
    examples: set[str] = set()
    turn = None
    k = 0
    while k < len(row):
        order = _Order(row, k, known)
        if not order.is_read():
            return None
        text = order.text()
        head = text.partition("(")[0] + "("
        is_again = order.is_again and not (order.time or order.power)
        if is_again and any(each.startswith(head) for each in orders):
            text = next(each for each in reversed(orders) if each.startswith(head))
            order.examples.clear()
        if order.is_turn and order.verb is None:
            turn = turn or Span(row[k].start, row[order.k - 1].end)
            order.verb = WORDS["R"]
            text = order.text()
        if not text:
            return None
        orders.append(text)
        examples |= order.examples
        k = order.k
    return Sentence(tuple(orders), end, tuple(sorted(examples)), turn)


def order_at(tokens: Sequence[Token], start: int, known: Vocabulary) -> tuple[str, int] | None:
    """Return one order of a sentence and where it ends among the tokens, None where not sure."""
    end = _end(tokens, start)
    if end is None:
        return None
    row = with_numbers(tokens[start:end])
    order = _Order(row, 0, known)
    text = order.text() if order.is_read() else ""
    if not text:
        return None
    if order.k < len(row):
        end = start
        while tokens[end].start < row[order.k].start:
            end += 1
    return text, end


def _end(tokens: Sequence[Token], start: int) -> int | None:
    """Return where an instruction ends, None where that is far away."""
    end = start
    while tokens[end].kind not in (*AT_END, "{", "}"):
        if end - start > 2 * LONGEST:
            return None
        end += 1
    return end


class _Order:
    """One order of a sentence: who, what, which way, how long, with how much power."""

    def __init__(self, row: Sequence[Token], k: int, known: Vocabulary) -> None:
        self.row = row
        self.k = k  # the token to read next, and at last the first one behind the order
        self.known = known
        self.verb: Word | None = None
        self.is_going = False  # the verb names no way
        self.is_turn = False
        self.time = ""
        self.power = ""
        self.times = ""
        self.until = ""
        self.is_again = False
        self.examples: set[str] = set()

    def _at(self, k: int) -> Token | None:
        return self.row[k] if k < len(self.row) else None

    def is_read(self) -> bool:
        """Read to where the next order begins; return whether each token is understood."""
        while (token := self._at(self.k)) is not None and (
            token.kind == "," or token.text in BEFORE_SENTENCE
        ):
            after = self._at(self.k + 1)
            if after is not None and token.text in ("DESPUES", "AFTER") and after.kind is not WORD:
                return False
            if after is not None and after.text == "DE":
                return False  # `después de 2 segundos`
            self.k += 1
        while (token := self._at(self.k)) is not None:
            is_greeting = token.kind == "," and self._is_empty()
            if is_greeting:  # `Hola robot, avanza`
                self.k += 1
                continue
            if token.kind == "," or (token.kind is WORD and token.text in BETWEEN):
                break
            if self._begins_another(token) or self._is_of_block(token):
                break
            if not (self._is_until(token) or self._is_understood(token)):
                return False
        return self.verb is not None or self.is_turn

    def _is_empty(self) -> bool:
        return self.verb is None and not (self.is_turn or self.time or self.power)

    def _is_until(self, token: Token) -> bool:
        """`hasta la pared`: go past it."""
        if token.text not in ("HASTA", "UNTIL", "TILL") or self.verb is None or self.until:
            return False
        start = self.k + 1
        after = self._at(start)
        start += after is not None and after.text == "QUE"
        near = near_at([*self.row, Token(END, "", 0, 0)], start, self.known)
        if near is None or self.verb.text != "F" or self.is_turn:
            return False
        self.k, self.until = near.end, near.question
        return True

    def _begins_another(self, token: Token) -> bool:
        """Whether an order begins here without a word between: `avanza 1 segundo gira …`."""
        if token.kind is not WORD or (self.verb is None and not self.is_turn):
            return False
        is_whole = self.verb is not None and (self.time or self.verb.role == "stop")
        if not is_whole or self.row[self.k - 1].text in _TOWARDS:
            return False
        after = self._at(self.k + 1)
        if token.text in WAYS or token.text == "PARA":
            counts = after is not None and after.kind is NUMBER
            return counts if token.text in WAYS else after is None
        return token.text in TURN_WORDS or self._command(token) is not None

    def _is_of_block(self, token: Token) -> bool:
        if token.kind is not WORD or self.known.is_own(token.text):
            return False
        after = self._at(self.k + 1)
        if token.text in BEFORE_TIME and after is not None and after.kind is NUMBER:
            return False  # `turn right for 1 second`
        return token.text in ("SI", "IF", *ENDS) or foreign_block(token.text) is not None

    def _command(self, token: Token) -> Word | None:
        """Return the word of the language that surely is meant."""
        text = token.text
        if token.kind is not WORD or self.known.is_own(text) or is_guessed(text):
            return None
        word = self.known.command(text)
        return word if word is not None and word.role in _ROLES else None

    def _is_understood(self, token: Token) -> bool:
        if token.kind is NUMBER:
            return self._number(token)
        if token.kind is not WORD:
            return False
        text, has_verb = token.text, self.verb is not None or self.is_turn
        following = self._at(self.k + 1)
        if has_verb and following is not None and (text, following.text) in AGAIN:
            self.k, self.is_again = self.k + 2, True
            return True
        if text in POWER_WORDS and has_verb and not self.power:
            self.power = POWER_WORDS[text]
            self.k += 1
            return True
        after = self._at(self.k + 1)
        is_verb = self._command(token) is not None or text in TURN_WORDS
        if not has_verb and text in _BEFORE_ORDER and not (is_verb and text not in _GOING):
            if not (text in _GOING and self._ends_order(after)):
                self.k += 1
                self.is_going |= text in _GOING
                return True
        is_small = text in (_TOWARDS | _BEFORE_VALUE)
        if text == "PARA" and after is not None:  # `gira para la derecha`
            is_small = after.text in FILLERS or after.text in WAYS
        if has_verb and is_small and after is not None:
            self.k += 1
            return True
        return self._verb(token)

    def _ends_order(self, token: Token | None) -> bool:
        return token is None or token.kind in (NUMBER, ",") or token.text in BETWEEN

    def _number(self, number: Token) -> bool:
        after = self._at(self.k + 1)
        unit = ""
        if after is not None and (after.text in UNITS and after.text not in BEFORE_POWER):
            unit = UNITS[after.text][0]
        self.k += 1 + bool(unit)
        if unit == "times" and after is not None and after.text in TIMES and not self.times:
            self.times = number.text
            return self.verb is not None and self.verb.role == "beep"
        before = self.row[self.k - 2 - bool(unit)] if self.k > 1 + bool(unit) else None
        is_power = unit == "%" or (before is not None and before.text in (*BEFORE_POWER, "AT"))
        if not unit and not is_power:
            is_power = bool(self.time) or float(number.text) >= LONG_TIME_S
            if is_power and not self.time:
                return False  # `avanza 50`
        if is_power and not self.power and unit in ("", "%"):
            self.power = number.text
            return True
        if unit not in ("", "s") or self.time or is_power:
            return False
        assert after is not None or not unit
        self.time = converted(number.text, after.text) if after and unit else number.text
        return True

    def _verb(self, token: Token) -> bool:
        """A command, or the way of a turn."""
        text = token.text
        self.k += 1
        if text in TURN_WORDS and not self.known.is_own(text):
            is_first = self.verb is None and not self.is_turn
            self.is_turn = True
            return is_first
        word = self._command(token)
        if word is None:
            return False
        if text == "PARA" and (self.verb is not None or self.is_turn):
            return False
        if self.is_turn:
            is_new = self.verb is None and word.text in ("L", "R")
            self.verb = word
            return is_new
        is_going, self.is_going = self.is_going, text in _GOING
        if self.verb is None:
            self.verb = word
            self.is_going |= is_going and text not in WAYS
            return True
        if self.verb.role != "move" or word.role != "move" or text not in WAYS:
            return False
        is_same = self.verb.text == word.text
        self.verb = word
        return is_same or is_going

    def text(self) -> str:
        """Return the order as the language writes it, "" where that is not sure."""
        word = self.verb
        if word is None:
            return ""
        if word.role != "move" and self.power:
            return ""
        if word.role == "stop":
            return f"{word.text};W({self.time})" if self.time else word.text
        samples = [argument.sample for argument in word.arguments]
        if word.role == "beep":
            call = f"BEEP({self.time or '0.5'}, {samples[-1]})"
            self.examples |= {f"{samples[-1]} Hz"} if self.time else {f"{samples[-1]} Hz", "0.5 s"}
            return f"LOOP({self.times});{call};W(0.5);END_LOOP" if self.times else call
        if self.until:
            self.examples |= {"10 cm"} if self.power else {"10 cm", f"{samples[1]} %"}
            call = f"{word.text}({self.time or 'FOREVER'}, {self.power or samples[1]})"
            return f"{call} UNTIL({self.until})" if word.text == "F" else ""
        if not self.time:
            self.examples.add(f"{samples[0]} s")
        if word.role == "wait":
            return f"{word.text}({self.time or samples[0]})"
        if not self.power:
            self.examples.add(f"{samples[1]} %")
        return f"{word.text}({self.time or samples[0]}, {self.power or samples[1]})"
