"""Slots: a call from the words that say it, each value where its unit, range and order put it.

Every number of the words is in the call, or there is no call. Knows no separators and no blocks.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from tiniscript.base.words import UNIT_OF, WAYS, WORDS, Argument
from tiniscript.base.words import names as is_called
from tiniscript.recovery import rows
from tiniscript.recovery.concepts import CALLED, DONE, NEAR, UNITS, Lexeme, Names, made, said_of
from tiniscript.syntax.devices import actuator_word
from tiniscript.syntax.lexer import NUMBER, WORD

LONG_S = 20  # so much without a unit may be a power, degrees or centimetres
_STEPS_FROM = 10  # so many are as many centimetres
MILLISECONDS_FROM = 100  # no wait is so many seconds
_SIDES = ("left", "right")
MOVES = ("F", "B", "L", "R")
_LETTERS = {"T": "s", "P": "%", "V": "%"}  # how a value of a move is called, in one letter
_PASSED = frozenset("(),:=.-_") | {"->", "%"}


class Filled(NamedTuple):
    """A call in tokens; `times` is how often, where words say so. `is_sure`: nothing is guessed.

    `samples` are the values that no word says, with their units: `80 %`.
    """

    tokens: list[Lexeme]
    cost: float
    is_sure: bool
    times: str | None
    samples: tuple[str, ...] = ()


class _Value(NamedTuple):
    """A number, or the name of what has one, and its unit where that is said."""

    value: float | str
    unit: str | None


def filled(
    words: Sequence[Lexeme], names: Names, has_until: bool, is_order: bool = False
) -> Filled | None:
    """Return the call that some words say, or None where one of them has no place in it.

    `is_order`: it may have no value of its own.
    """
    reader = _Reader(words, names)
    if not reader.read() or reader.command is None or reader.mark:
        return None
    if reader.is_turn and reader.command not in ("L", "R"):
        return None
    return reader.call(has_until, is_order)


def told(number: float) -> str:
    return f"{number:.3f}".rstrip("0").rstrip(".")


class _Reader:
    """Reads the words from left to right."""

    def __init__(self, words: Sequence[Lexeme], names: Names) -> None:
        self.words = words
        self.names = names
        self.command: str | None = None
        self.values: list[_Value] = []
        self.mark: str | None = None  # the unit of the next value, by its name: `potencia 80`
        self.times: float | None = None
        self.is_turn = False
        self.way = ""  # the unit behind the first value of a move: `20 CM`
        self.is_sure = True
        self.cost = 1.0

    # -- words ------------------------------------------------------------------------------

    def read(self) -> bool:
        """Return whether each word has its place."""
        if not self._has_one_group():
            return False
        k = 0
        while k < len(self.words):
            after = self._number(k)
            if after is None:
                after = self._word(k) if self.words[k].kind is WORD else self._sign(k)
            if after is None:
                return False
            k = after
        return True

    def _has_one_group(self) -> bool:
        """Whether nothing follows the brackets of the call; what is odd in them is a guess."""
        signs = [each.text for each in self.words]
        for k, (sign, after) in enumerate(pairwise([*signs, ""])):
            rest = self.words[k + 1 :]
            if sign == ")" and any(it.kind in (WORD, NUMBER) or it.text == "(" for it in rest):
                return False
            is_odd = sign == "," and after in (",", ")")
            is_again = sign == "(" and k > 2 and "(" in signs[:k]
            is_call = sign == "(" and self.names.meant(after, NEAR) in CALLED
            if is_odd or is_again or (is_call and self.names.meant(signs[0], NEAR) != "M"):
                self.is_sure = False
        return True

    def text(self, k: int) -> str:
        return self.words[k].text if 0 <= k < len(self.words) else ""

    def _value_of_words(self, k: int) -> tuple[float, int] | None:
        """Return the number that words say, where they can say nothing else, and what is next."""
        token, after = self.words[k], self.text(k + 1)
        if token.kind is NUMBER:
            is_dotted = token.text[0] == "." and self.text(k - 1) not in ("(", ",")
            self.is_sure = self.is_sure and not is_dotted  # `F.1.5`
            return float(token.text), k + 1
        if token.kind is not WORD or token.text in self.names.known.values:
            return None
        said = said_of(token.text, "number")
        is_one = (
            said == ("1",) and after not in (*UNITS, ",", ")") and not self._is_and_a_half(k + 1)
        )
        if said and self.command and not is_one:
            number, k = self._sum(float(said[0]), k + 1)
            self.is_sure = self.is_sure and said != ("1",)
            self.cost += 0.5
            return number, k
        is_first = self.text(k - 1) == "(" and after == "," and self.command != "M"
        unit = k + 1 + (after == "A")  # `half a second`
        if said_of(token.text, "power") == ("50",) and (self.text(unit) in UNITS or is_first):
            self.is_sure = False
            return 0.5, unit
        return None

    def _sum(self, number: float, k: int) -> tuple[float, int]:
        """Return a number with the smaller ones behind it: `cuatrocientos cuarenta y cinco`."""
        while number % 10 == 0:
            place = k + bool(said_of(self.text(k), "and"))
            said = said_of(self.text(place), "number")
            if not said or number % 10 ** len(said[0]):
                break
            number, k = number + float(said[0]), place + 1
        return number, k

    def _number(self, k: int) -> int | None:
        """Read a number with its unit; return where to read on, None where none is here."""
        found = self._value_of_words(k)
        if found is None:
            return None
        number, k = found
        if self._is_and_a_half(k):
            number, k, self.is_sure = number + 0.5, k + 2, False
        if self.text(k) == "/" and k + 1 < len(self.words):
            return None
        unit, thousandths = self.mark, 1000.0
        if said_of(self.text(k), "by") and said_of(self.text(k + 1), "number") == ("100",):
            unit, k = "%", k + 2
        elif self.text(k) in UNITS:
            unit, thousandths = UNITS[self.text(k)]
            is_stop = self.words[k].source == "S" and bool(self.words[k].space)
            if is_stop and self.values and k + 1 == len(self.words):
                return None  # `R 1 50 S`: an order of its own
            is_comma = self.words[k].text == rows.COMMA_KEY and self._is_number(k + 1)
            self.is_sure, k = self.is_sure and not (is_stop or is_comma), k + 1
            if self._is_and_a_half(k):
                number, k, self.is_sure = number + 0.5, k + 2, False
        elif said_of(self.text(k), "of") and (marked := said_of(self.text(k + 1), "value")):
            unit, k = marked[0], k + 2
        if unit == "times":
            if self.times is not None:
                return None
            self.times = number
            return k
        self.values.append(_Value(number * thousandths / 1000, unit))
        self.mark = None
        return k

    def _is_number(self, k: int) -> bool:
        return k < len(self.words) and self.words[k].kind is NUMBER

    def _is_and_a_half(self, k: int) -> bool:
        is_and = bool(said_of(self.text(k), "and"))
        return is_and and said_of(self.text(k + 1), "power") == ("50",)

    def _sign(self, k: int) -> int | None:
        sign, before = self.text(k), self.text(k - 1)
        is_minus = sign == "-" and [each.kind for each in self.words[k + 1 : k + 2]] == [NUMBER]
        if is_minus and self.command in ("M", "SHOW"):
            self.is_sure = self.is_sure and not (self.values and before != ",")
            self.values.append(_Value(-float(self.text(k + 1)), self.mark))
            self.mark = None
            return k + 2
        if is_minus and self.words[k].space and self.words[k + 1].space == "":
            return None  # `R -1 50`: nobody drops a sign
        if sign not in _PASSED or (sign == "=" and not self.mark):
            return None
        if sign == "," and self.mark and before != ",":
            return None  # a value that is only named
        self.cost += 0.0 if sign in "(),%" else 0.2
        is_behind_number = k > 0 and self.words[k - 1].kind is NUMBER
        is_odd = sign in ("-", ".") or (sign == "%" and not is_behind_number)
        self.is_sure = self.is_sure and not is_odd
        return k + 1

    def _word(self, k: int) -> int | None:
        word, after = self.text(k), self.words[k + 1] if k + 1 < len(self.words) else None
        names, marked = self.names, said_of(self.text(k), "value")
        is_name = word in names.known.values
        own = word if word in DONE and word != "BREAK" else None
        meant = own or self._command_of(word)
        if k and self.words[k].space == "" and self.words[k - 1].kind is NUMBER:
            self.is_sure = False  # `1velocidad`
        is_before_number = after is not None and (after.kind is NUMBER or after.text in "=:")
        if self.command in MOVES and word in _LETTERS and is_before_number:
            self.mark = _LETTERS[word]
        elif said_of(word, "turn"):
            if self.command in ("F", "B") and self.values:
                return None  # another order
            self.is_turn = True
            self.command = None if self.command == "F" else self.command
        elif self._is_mark(word, marked):
            last = self.values[-1] if self.values else None
            is_behind = (after is None or after.text in (",", ")")) and self.text(k - 1) != ","
            if last and last.unit in (None, marked[0]) and is_behind and marked != ("s",):
                self.values[-1] = _Value(last.value, marked[0])
            else:
                self.mark = marked[0]
        elif is_name and self.command:
            self.mark = marked[0] if marked else self.mark
            self._take(word)
        elif self.command == "BEEP" and said_of(word, "note"):
            self.values.append(_Value(float(said_of(word, "note")[0]), "Hz"))
        elif said_of(word, "power") and self.command:
            self.values.append(_Value(float(said_of(word, "power")[0]), "%"))
            self.mark = None
            self.is_sure = False
        elif meant:
            is_again = after is None and meant == self.command == "F"  # `avanza 20 cm adelante`
            taken = is_again or self._take_command(word, meant, is_own=own is not None)
            return k + 1 if taken else None
        elif said_of(word, "filler"):
            is_in_place = k > 0 and self.words[k - 1].kind is NUMBER and self.text(k + 1) in ",)"
            self.is_sure = self.is_sure and not is_in_place  # it may be a unit: `F(8 in, 60)`
            self.cost += 0.1
        else:
            return k + 1 if self._take_value(word) else None
        return k + 1

    def _is_mark(self, word: str, marked: tuple[str, ...]) -> bool:
        is_free = bool(marked) and word not in self.names.known.values
        is_side = is_free and marked[0] in _SIDES
        return (
            is_free and bool(self.command or self.is_turn) and (self.command == "M" or not is_side)
        )

    def _take(self, value: str) -> None:
        self.values.append(_Value(value, self.mark))
        self.mark = None

    def _command_of(self, word: str) -> str | None:
        if self.names.is_name(word):
            return word if word in self.names.actuators else None
        found = [each.concept for each in self.names.meanings(word)]
        return next((each for each in found if each in CALLED or each == "S"), None)

    def _take_command(self, word: str, meant: str, is_own: bool) -> bool:
        meanings = self.names.meanings(word)
        cost = 0 if is_own or not meanings else meanings[0].cost
        self.is_sure = self.is_sure and cost < 2
        before = self.command
        is_way = before == "F" and meant in ("B", "L", "R") and not self.values
        is_side = self.is_turn and meant in ("L", "R") and before not in ("L", "R")
        if before is None or is_way or is_side:
            self.command = meant
        elif before == meant and not self.values and meant in MOVES:
            pass
        elif not (meant == "F" and before in MOVES and said_of(word, "filler")):
            return False
        self.cost += cost * 0.3
        return True

    def _take_value(self, word: str) -> bool:
        for concept, cost in self.names.meanings(word):
            self.is_sure = self.is_sure and cost < 2 and not word[-1].isdigit()
            if self.command and (concept in self.names.sensors or concept in ("TRUE", "FALSE")):
                self.values.append(_Value(concept, None))
                return True
        return False

    # -- the call ---------------------------------------------------------------------------

    def call(self, has_until: bool, is_order: bool) -> Filled | None:
        assert self.command is not None
        device = self.names.actuators.get(self.command)
        word = actuator_word(device) if device else WORDS[self.command]
        times = None if self.times is None else told(self.times)
        if not word.arguments:
            is_sure = self.is_sure and times is None
            return None if self.values else Filled([made(word.text)], self.cost, is_sure, times)
        values = self._in_seconds(self._with_decimals(len(word.arguments)))
        is_said = bool(values) or (is_order and values is not None)
        slots = self._slots(values or [], word.arguments, has_until) if is_said else None
        if not slots:
            return None
        if word.role == "motors" and len(values or ()) == 1:
            return None  # of which motor?
        out = [made(word.text), made("(")]
        for k, (value, argument) in enumerate(zip(slots, word.arguments, strict=True)):
            out += [made(",")] if k else []
            text = (self._own(argument) or argument.sample) if value is None else value
            text = told(text) if isinstance(text, float) else text
            out += [made("-"), made(text[1:])] if text.startswith("-") else [made(text)]
            out += [made(self.way)] if self.way and not k else []
        samples = tuple(
            f"{each.sample} {each.unit}"
            for value, each in zip(slots, word.arguments, strict=True)
            if value is None and not self._own(each)
        )
        return Filled([*out, made(")")], self.cost, self.is_sure, times, samples)

    def _own(self, argument: Argument) -> str:
        """Return the one variable that is called what an argument is: VELOCIDAD for `F(2)`."""
        own = [
            each
            for each in self.names.variables
            if any(is_called(part, argument) for part in each.split("_"))
        ]
        return own[0] if len(own) == 1 else ""

    def _with_decimals(self, count: int) -> list[_Value] | None:
        """Join whole numbers that are halves of decimal ones: `F(1,5,80,0)`, `W(0,5)`."""
        values, numbers = self.values, [each.value for each in self.values]
        is_double = len(values) == 2 * count and (count == 2 or self.command == "W")
        if not is_double or not all(
            isinstance(each, float) and each.is_integer() for each in numbers
        ):
            return values
        if count == 1 and numbers[0] != 0:
            return None
        if any(re.fullmatch("0[0-9]+", each.text) for each in self.words):
            return None  # `W(0, 05)`: a zero may not be lost
        pairs = zip(values[::2], values[1::2], strict=True)
        return [_Value(float(f"{int(a.value)}.{int(b.value)}"), b.unit) for a, b in pairs]

    def _in_seconds(self, values: list[_Value] | None) -> list[_Value] | None:
        """Take a plain number behind a command that counts milliseconds for these."""
        if values is None or not any(isinstance(v, float) and u is None for v, u in values):
            return values
        if said_of(self.words[0].text, "milliseconds"):
            self.is_sure = False
            return [
                _Value(v / 1000, "s") if isinstance(v, float) and u is None else _Value(v, u)
                for v, u in values
            ]
        is_long = any(isinstance(v, float) and v >= MILLISECONDS_FROM for v, u in values if not u)
        return None if self.command == "W" and is_long else values

    @staticmethod
    def _is_tone(value: float | str) -> bool:
        return isinstance(value, float) and value >= LONG_S

    def _slots(
        self, values: list[_Value], arguments: tuple[Argument, ...], has_until: bool
    ) -> list[float | str | None] | None:
        """Return the value of each argument: by its unit, by its range, and then in order."""
        slots: list[float | str | None] = [None] * len(arguments)
        order: dict[int, int] = {}
        way = UNIT_OF.get(self.command or "", "")
        for k, (value, unit) in enumerate(values):
            is_of_scratch = unit == "steps" and self.words[0].text not in WORDS
            if is_of_scratch and way == "CM" and isinstance(value, float) and value >= _STEPS_FROM:
                unit, self.is_sure = WAYS[way].unit, False
            if way and unit == WAYS[way].unit:
                if slots[0] is not None or any(each.unit is None for each in values[:k]):
                    return None
                slots[0], order[k], self.way = value, 0, way
            elif unit is not None:
                free = (i for i, a in enumerate(arguments) if slots[i] is None)
                place = next(
                    (i for i in free if unit in (arguments[i].unit, arguments[i].name)), None
                )
                if place is None:
                    return None
                slots[place], order[k] = value, place
        rest = [k for k in range(len(values)) if k not in order]
        if self.command == "BEEP" and len(rest) == 2:
            rest.sort(key=lambda k: self._is_tone(values[k].value))
        if has_until and slots[0] is None and arguments[0].unit == "s" and not rest:
            slots[0] = "FOREVER"
        for k in rest:
            value = values[k].value
            place = next((i for i, slot in enumerate(slots) if slot is None), None)
            if self.command == "BEEP" and len(values) == 1 and isinstance(value, float):
                place = 1 if value * 1000 >= arguments[1].low else place
            if place is None:
                return None
            slots[place], order[k] = value, place
        places = [order[k] for k in sorted(order)]
        self.is_sure = self.is_sure and places == sorted(places)
        for k, place in order.items():
            value, unit = values[k]
            if arguments[place].unit == "s" and unit is None and isinstance(value, float):
                if value >= LONG_S and len(arguments) > 1:
                    if self.words[0].text not in WORDS:
                        return None  # of another language: rarely seconds, as in `move(50, 50)`
                    self.is_sure = False
        is_low = any(u == "%" and isinstance(v, float) and v < LONG_S for v, u in values)
        if None in slots and is_low:
            return None  # `F(2 VEL)`: the name of a power, and a time
        is_alone = None in slots and rest == [0] and isinstance(values[0].value, float)
        if is_alone and self.command in MOVES and float(values[0].value) >= LONG_S:
            return None  # a power, degrees or centimetres
        if None in slots:
            self.is_sure, self.cost = False, self.cost + 2
            if self.command == "SHOW":
                return None
        for slot, argument in zip(slots, arguments, strict=True):
            if isinstance(slot, float) and not argument.low <= slot * 1000 <= argument.high:
                return None
        return slots
