"""Slots: a call from the words that say it, each value where its unit, range and order put it.

Every number of the words is in the call, or there is no call. Knows no separators and no blocks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import nan
from typing import NamedTuple

from tiniscript.base.words import (
    EXTENTS,
    MOVES,
    OPPOSITE_MOVES,
    UNIT_OF,
    WORDS,
    Argument,
    lexicon_meaning,
)
from tiniscript.base.words import names_argument as is_called
from tiniscript.recovery import rows
from tiniscript.recovery.meanings import (
    CALL_WORDS,
    INSTRUCTION_WORDS,
    LAP,
    LONG_TIME_S,
    NEAR,
    Lexeme,
    Names,
    lexemes,
    made,
    number_text,
)
from tiniscript.syntax.lexer import NUMBER, WORD

_LEAST_STEPS = 10  # so many are as many centimetres
MILLISECONDS_FROM = 100  # no wait is so many seconds
_SIDES = ("left", "right")
_UNIT_OF_LETTER = {"T": "s", "P": "%", "V": "%"}  # how a value of a move is called, in one letter
_PASSED_SIGNS = frozenset("(),:=.-_") | {"->", "%"}


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

    text: str
    unit: str | None

    @property
    def number(self) -> float:
        """Of a name none: no comparison with it holds."""
        return nan if self.text.isidentifier() else float(self.text)


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


class _Reader:
    """Reads the words from left to right."""

    def __init__(self, words: Sequence[Lexeme], names: Names) -> None:
        self.words = words
        self.names = names
        self.command: str | None = None
        self.values: list[_Value] = []
        self.mark: str | None = None  # the unit of the next value, by its name: `potencia 80`
        self.times: str | None = None
        self.is_turn = False
        self.is_back = False  # `R -1 50`: the other way
        self.way = ""  # the unit after the first value of a move: `20 CM`
        self.is_sure = True
        self.cost = 1.0

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
        signs = [word.text for word in self.words]
        for k, (sign, after) in enumerate(pairwise([*signs, ""])):
            rest = self.words[k + 1 :]
            if sign == ")" and any(it.kind in (WORD, NUMBER) or it.text == "(" for it in rest):
                return False
            is_odd_comma = sign == "," and after in (",", ")")
            has_second_group = sign == "(" and k > 2 and "(" in signs[:k]
            is_call = sign == "(" and self.names.meant(after, NEAR) in CALL_WORDS
            if (
                is_odd_comma
                or has_second_group
                or (is_call and self.names.meant(signs[0], NEAR) != "M")
            ):
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
        text = lexicon_meaning(token.text, "number")
        has_context = after in (",", ")") or lexicon_meaning(after, "unit") or self._is_half(k + 1)
        is_bare_one = text == ("1",) and not has_context
        if text and self.command and not is_bare_one:
            number, k = self._sum(float(text[0]), k + 1)
            self.is_sure = self.is_sure and text != ("1",)
            return number, k
        is_first = self.text(k - 1) == "(" and after == "," and self.command != "M"
        unit = k + 1 + (after == "A")  # `half a second`
        if lexicon_meaning(token.text, "power") == ("50",) and (
            lexicon_meaning(self.text(unit), "unit") or is_first
        ):
            self.is_sure = False
            return 0.5, unit
        return None

    def _sum(self, number: float, k: int) -> tuple[float, int]:
        """Return a number with the smaller ones after it: `cuatrocientos cuarenta y cinco`."""
        while number % 10 == 0:
            place = k + bool(lexicon_meaning(self.text(k), "and"))
            text = lexicon_meaning(self.text(place), "number")
            if not text or number % 10 ** len(text[0]):
                break
            number, k = number + float(text[0]), place + 1
        return number, k

    def _number(self, k: int) -> int | None:
        """Read a number with its unit; return where to read on, None where none is here."""
        result = self._value_of_words(k)
        if result is None:
            return None
        number, k = result
        if self._is_half(k):
            number, k, self.is_sure = number + 0.5, k + 2, False
        unit, thousandths = self.mark, 1000.0
        if lexicon_meaning(self.text(k), "by") and lexicon_meaning(self.text(k + 1), "number") == (
            "100",
        ):
            unit, k = "%", k + 2
        elif unit_meaning := lexicon_meaning(
            self.text(of := k + bool(lexicon_meaning(self.text(k), "of"))), "unit"
        ):
            k = of  # `un cuarto de vuelta`
            unit, thousandths = unit_meaning[0], float(unit_meaning[1])
            is_stop = self.words[k].source == "S" and bool(self.words[k].space)
            if is_stop and self.values and k + 1 == len(self.words):
                return None  # `R 1 50 S`: an order of its own
            is_comma = self.words[k].text == rows.COMMA_KEY and self._is_number(k + 1)
            self.is_sure, k = self.is_sure and not (is_stop or is_comma), k + 1
            if self._is_half(k):
                number, k, self.is_sure = number + 0.5, k + 2, False
        elif lexicon_meaning(self.text(k), "of") and (
            marked := lexicon_meaning(self.text(k + 1), "value")
        ):
            unit, k = marked[0], k + 2
        if unit == "times":
            if self.times is not None:
                return None
            self.times = number_text(number)
            return k
        self._add_value(number_text(number * thousandths / 1000), unit)
        return k

    def _is_number(self, k: int) -> bool:
        return 0 <= k < len(self.words) and self.words[k].kind is NUMBER

    def _is_half(self, k: int) -> bool:
        is_and = bool(lexicon_meaning(self.text(k), "and"))
        return is_and and lexicon_meaning(self.text(k + 1), "power") == ("50",)

    def _sign(self, k: int) -> int | None:
        sign, before = self.text(k), self.text(k - 1)
        is_minus = sign == "-" and self._is_number(k + 1)
        if is_minus and self.command in ("M", "SHOW"):
            self.is_sure = self.is_sure and not (self.values and before != ",")
            self._add_value("-" + number_text(float(self.text(k + 1))), self.mark)
            return k + 2
        if is_minus and (before in ("(", ",") or self._is_glued(k)):
            is_minus_of_move = self.command in MOVES and not self.is_back and not self.values
            self.is_sure, self.is_back = False, True
            return k + 1 if is_minus_of_move else None  # nobody drops a sign
        if sign not in _PASSED_SIGNS or (sign == "=" and not self.mark):
            return None
        if sign == "," and self.mark and before != ",":
            return None  # a value that is only named
        self.cost += 0.0 if sign in "(),%" else 0.2
        is_odd = sign in ("-", ".") or (sign == "%" and not self._is_number(k - 1))
        self.is_sure = self.is_sure and not is_odd
        return k + 1

    def _is_glued(self, k: int) -> bool:
        """Whether a sign belongs to what is after it, not to what is before it: `R -1 50`."""
        return bool(self.words[k].space) and self.words[k + 1].space == ""

    def _word(self, k: int) -> int | None:
        word, after = self.text(k), self.text(k + 1)
        names, marked = self.names, lexicon_meaning(word, "value")
        is_command = word in names.actuators or (word in INSTRUCTION_WORDS and word != "BREAK")
        text = [word] if is_command else [meaning.concept for meaning in names.meanings(word)]
        command = next(
            (item for item in text if is_command or item in CALL_WORDS or item == "S"), None
        )
        is_before_number = self._is_number(k + 1) or after in ("=", ":")
        if self.command in MOVES and word in _UNIT_OF_LETTER and is_before_number:
            self.mark = _UNIT_OF_LETTER[word]
        elif lexicon_meaning(word, "turn"):
            if self.command in ("F", "B") and self.values:
                return None  # another order
            self.is_turn = True
            self.command = None if self.command == "F" else self.command
        elif self._is_mark(word, marked):
            last = self.values[-1] if self.values else None
            is_last = after in ("", ",", ")") and self.text(k - 1) != ","
            if last and last.unit in (None, marked[0]) and is_last and marked != ("s",):
                self.values[-1] = last._replace(unit=marked[0])
            else:
                self.mark = marked[0]
        elif word in names.known.values and self.command:
            self._add_value(word, marked[0] if marked else self.mark)
        elif (
            self.command == "BEEP"
            and (note := lexicon_meaning(word, "note") or lexicon_meaning(word + "4", "note"))
            and not (len(word) == 1 and self._is_number(k + 1))
        ):  # `pita 1 segundo a 440`
            self.values.append(_Value(note[0], "Hz"))
            self.is_sure = self.is_sure and len(word) > 1  # `C`
        elif names.meant(word) == "FOREVER" and self.command in MOVES and self._is_said():
            self._add_value("FOREVER", "s")
            self.is_sure = False
        elif lexicon_meaning(word, "power") and self.command:
            self._add_value(lexicon_meaning(word, "power")[0], "%")
            self.is_sure = False
        elif command:
            is_repetition = after in ("", ",") and command == self.command and command in MOVES
            return k + 1 if is_repetition or self._take_command(word, command) else None
        elif lexicon_meaning(word, "filler"):
            is_in_place = self._is_number(k - 1) and after in ",)"
            self.is_sure = self.is_sure and not is_in_place  # it may be a unit: `F(8 in, 60)`
            self.cost += 0.1
        else:
            for concept, cost in names.meanings(word):
                self.is_sure = self.is_sure and cost < 2 and not word[-1].isdigit()
                if self.command and (concept in names.sensors or concept in ("TRUE", "FALSE")):
                    self.values.append(_Value(concept, None))
                    return k + 1
            return None
        return k + 1

    def _is_said(self) -> bool:
        """Whether words say a move, without values and brackets: `avanzar siempre`."""
        return not self.values and all(word.text != "(" for word in self.words)

    def _is_mark(self, word: str, marked: tuple[str, ...]) -> bool:
        if not marked or word in self.names.known.values or not (self.command or self.is_turn):
            return False
        return self.command == "M" or marked[0] not in _SIDES

    def _add_value(self, text: str, unit: str | None) -> None:
        self.values.append(_Value(text, unit))
        self.mark = None

    def _take_command(self, word: str, command: str) -> bool:
        meanings = () if word in INSTRUCTION_WORDS else self.names.meanings(word)
        cost = meanings[0].cost if meanings else 0
        self.is_sure = self.is_sure and cost < 2
        before = self.command
        is_way_of_f = before == "F" and command in ("B", "L", "R") and not self.values
        is_side_of_turn = self.is_turn and command in ("L", "R") and before not in ("L", "R")
        if before is None or is_way_of_f or is_side_of_turn:
            self.command = command
        elif before == command and not self.values and command in MOVES:
            pass
        elif not (command == "F" and before in MOVES and lexicon_meaning(word, "filler")):
            return False
        self.cost += cost * 0.3
        return True

    def call(self, has_until: bool, is_order: bool) -> Filled | None:
        assert self.command is not None
        self.command = OPPOSITE_MOVES[self.command] if self.is_back else self.command
        device = self.names.actuators.get(self.command)
        word = device.word if device else WORDS[self.command]
        if not word.arguments:
            is_sure = self.is_sure and self.times is None
            stop = Filled([made(word.text)], self.cost, is_sure, self.times)
            return None if self.values else stop
        values = self._in_seconds(self._with_decimals(len(word.arguments)))
        if values is None or not (values or is_order):
            return None
        slots = self._slots(values, word.arguments, has_until)
        if not slots or (word.text == "M" and len(values) == 1):
            return None  # of which motor?
        texts: list[str] = []
        samples: list[str] = []
        for value, argument in zip(slots, word.arguments, strict=True):
            own_text = value.text if value else self._own_value(argument)
            samples += [] if own_text else [f"{argument.sample} {argument.unit}"]
            texts.append(own_text or argument.sample)
        call = f"{word.text}({','.join(texts)})".replace(",", f" {self.way},", 1)
        tokens = [made(lexeme.text) for lexeme in lexemes(call)]
        return Filled(tokens, self.cost, self.is_sure, self.times, tuple(samples))

    def _own_value(self, argument: Argument) -> str:
        """Return what a program has for an argument, "" for nothing or more than one thing.

        The one variable that is called so, VELOCIDAD for `F(2)`, else what all other calls give.
        """
        own_values = [
            it
            for it in self.names.variables
            if any(is_called(part, argument) for part in it.split("_"))
        ]
        return (
            own_values[0]
            if len(own_values) == 1
            else ""
            if own_values
            else self.names.usual.get(argument.unit, "")
        )

    def _with_decimals(self, count: int) -> list[_Value] | None:
        """Join whole numbers that are halves of decimal ones: `F(1,5,80,0)`, `W(0,5)`."""
        values = self.values
        is_double = len(values) == 2 * count and (count == 2 or self.command == "W")
        if not is_double or not all(value.text.isdecimal() for value in values):
            return values
        if count == 1 and values[0].text != "0":
            return None
        pairs = zip(values[::2], values[1::2], strict=True)
        return [_Value(number_text(float(f"{a.text}.{b.text}")), b.unit) for a, b in pairs]

    def _in_seconds(self, values: list[_Value] | None) -> list[_Value] | None:
        """Take a plain number after a command that counts milliseconds for these."""
        plain_values = [it for it in values or () if it.unit is None and not it.text.isidentifier()]
        if plain_values and values and lexicon_meaning(self.words[0].text, "milliseconds"):
            self.is_sure = False
            return [
                _Value(number_text(it.number / 1000), "s") if it in plain_values else it
                for it in values
            ]
        is_in_milliseconds = any(it.number >= MILLISECONDS_FROM for it in plain_values)
        return None if self.command == "W" and is_in_milliseconds else values

    def _slots(
        self, values: list[_Value], arguments: tuple[Argument, ...], has_until: bool
    ) -> list[_Value | None] | None:
        """Return the value of each argument: by its unit, by its range, and then in order."""
        slots: list[_Value | None] = [None] * len(arguments)
        order: dict[int, int] = {}
        way = UNIT_OF.get(self.command or "", "")
        for k, value in enumerate(values):
            unit = value.unit
            is_of_scratch = unit == "steps" and self.words[0].text not in WORDS
            if is_of_scratch and way == "CM" and value.number >= _LEAST_STEPS:
                unit, self.is_sure = EXTENTS[way].unit, False
            if unit == "turns" and way == "DEG":
                unit, self.is_sure = EXTENTS[way].unit, False
                value = _Value(number_text(value.number * LAP), unit)
            if way and unit == EXTENTS[way].unit:
                if slots[0] is not None or any(value.unit is None for value in values[:k]):
                    return None
                slots[0], order[k], self.way = value, 0, way
            elif unit is not None:
                fitting_places = (
                    i
                    for i, expected in enumerate(arguments)
                    if unit in (expected.unit, expected.name)
                )
                place = next((i for i in fitting_places if slots[i] is None), None)
                if place is None:
                    return None
                slots[place], order[k] = value, place
        rest = [k for k in range(len(values)) if k not in order]
        if self.command == "BEEP" and len(rest) == 2:
            rest.sort(key=lambda k: values[k].number >= LONG_TIME_S)
        if has_until and slots[0] is None and arguments[0].unit == "s" and not rest:
            slots[0] = _Value("FOREVER", None)
        for k in rest:
            place = next((i for i, slot in enumerate(slots) if slot is None), None)
            if self.command == "BEEP" and len(values) == 1:
                place = 1 if values[k].number * 1000 >= arguments[1].low else place
            if place is None:
                return None
            slots[place], order[k] = values[k], place
        places = [order[k] for k in sorted(order)]
        self.is_sure = self.is_sure and places == sorted(places)
        for k, place in order.items():
            is_long_time = values[k].number >= LONG_TIME_S and values[k].unit is None
            if is_long_time and arguments[place].unit == "s" and len(arguments) > 1:
                if self.words[0].text not in WORDS:
                    return None  # of another language: rarely seconds, as in `move(50, 50)`
                self.is_sure = False
        if None in slots:
            if any(value.unit == "%" and value.number < LONG_TIME_S for value in values):
                return None  # `F(2 VEL)`: the name of a power, and a time
            is_move = self.command in MOVES and rest == [0]
            if self.command == "SHOW" or (is_move and values[0].number >= LONG_TIME_S):
                return None  # a power, degrees or centimetres
            self.is_sure, self.cost = False, self.cost + 2
        for slot, argument in zip(slots, arguments, strict=True):
            thousandths = slot.number * 1000 if slot else nan
            if thousandths < argument.low or thousandths > argument.high:
                return None
        return slots
