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
    FULL_TURN,
    INSTRUCTION_WORDS,
    LONG_TIME_S,
    NEAR_COST,
    Lexeme,
    Names,
    lexemes,
    make_token,
    number_text,
)
from tiniscript.syntax.lexer import NUMBER, WORD

_MIN_STEPS = 10  # from this many steps on, one step is one centimetre
MIN_MILLISECONDS = 100  # no wait has so many seconds
_SIDES = ("left", "right")
# One-letter names of a move's values, with their units.
_UNIT_OF_LETTER = {"T": "s", "P": "%", "V": "%"}
_IGNORED_SIGNS = frozenset("(),:=.-_") | {"->", "%"}


class FilledCall(NamedTuple):
    """A call in tokens; `times` is its number in words. `is_sure`: no part is a guess.

    `samples` are the values that no word says, with their units: `80 %`.
    """

    tokens: list[Lexeme]
    cost: float
    is_sure: bool
    times: str | None
    samples: tuple[str, ...] = ()


class _Value(NamedTuple):
    """A number, or the name of something that has one, and its unit if given."""

    text: str
    unit: str | None

    @property
    def number(self) -> float:
        """Return the number, or NaN for a name, so that no comparison is true."""
        return nan if self.text.isidentifier() else float(self.text)


def fill_call(
    words: Sequence[Lexeme], names: Names, has_until: bool, is_instruction: bool = False
) -> FilledCall | None:
    """Return the call that some words describe, or None if one of them has no place in it.

    `is_instruction`: it may have no value of its own.
    """
    reader = _Reader(words, names)
    if not reader.read() or reader.command is None or reader.next_unit:
        return None
    if reader.is_turn and reader.command not in ("L", "R"):
        return None
    return reader.make_call(has_until, is_instruction)


class _Reader:
    """Reads the words from left to right."""

    def __init__(self, words: Sequence[Lexeme], names: Names) -> None:
        self.words = words
        self.names = names
        self.command: str | None = None
        self.values: list[_Value] = []
        self.next_unit: str | None = None  # the unit of the next value, by its name: `potencia 80`
        self.times: str | None = None
        self.is_turn = False
        self.is_reversed = False  # `R -1 50`: the other way
        self.extent_word = ""  # the unit after the first value of a move: `20 CM`
        self.is_sure = True
        self.cost = 1.0

    def read(self) -> bool:
        """Return whether each word has its place."""
        if not self._has_one_group():
            return False
        k = 0
        while k < len(self.words):
            next_k = self._read_number(k)
            if next_k is None:
                next_k = self._read_word(k) if self.words[k].kind is WORD else self._read_sign(k)
            if next_k is None:
                return False
            k = next_k
        return True

    def _has_one_group(self) -> bool:
        """Return whether nothing follows the brackets of the call; unusual contents make it a
        guess."""
        signs = [word.text for word in self.words]
        for k, (sign, next_sign) in enumerate(pairwise([*signs, ""])):
            tokens_after = self.words[k + 1 :]
            if sign == ")" and any(
                token.kind in (WORD, NUMBER) or token.text == "(" for token in tokens_after
            ):
                return False
            is_odd_comma = sign == "," and next_sign in (",", ")")
            has_second_group = sign == "(" and k > 2 and "(" in signs[:k]
            is_call = sign == "(" and self.names.find_meaning(next_sign, NEAR_COST) in CALL_WORDS
            if (
                is_odd_comma
                or has_second_group
                or (is_call and self.names.find_meaning(signs[0], NEAR_COST) != "M")
            ):
                self.is_sure = False
        return True

    def text_at(self, k: int) -> str:
        return self.words[k].text if 0 <= k < len(self.words) else ""

    def _value_of_words(self, k: int) -> tuple[float, int] | None:
        """Return the number that words unambiguously mean, and the next index."""
        token, next_text = self.words[k], self.text_at(k + 1)
        if token.kind is NUMBER:
            is_dotted = token.text[0] == "." and self.text_at(k - 1) not in ("(", ",")
            self.is_sure = self.is_sure and not is_dotted  # `F.1.5`
            return float(token.text), k + 1
        if token.kind is not WORD or token.text in self.names.known_names.values:
            return None
        number_meaning = lexicon_meaning(token.text, "number")
        has_context = (
            next_text in (",", ")") or lexicon_meaning(next_text, "unit") or self._is_half(k + 1)
        )
        is_bare_one = number_meaning == ("1",) and not has_context
        if number_meaning and self.command and not is_bare_one:
            number, k = self._add_smaller_numbers(float(number_meaning[0]), k + 1)
            self.is_sure = self.is_sure and number_meaning != ("1",)
            return number, k
        is_first_value = self.text_at(k - 1) == "(" and next_text == "," and self.command != "M"
        unit_k = k + 1 + (next_text == "A")  # `half a second`
        if lexicon_meaning(token.text, "power") == ("50",) and (
            lexicon_meaning(self.text_at(unit_k), "unit") or is_first_value
        ):
            self.is_sure = False
            return 0.5, unit_k
        return None

    def _add_smaller_numbers(self, number: float, k: int) -> tuple[float, int]:
        """Return a number with the smaller ones after it: `cuatrocientos cuarenta y cinco`."""
        while number % 10 == 0:
            number_k = k + bool(lexicon_meaning(self.text_at(k), "and"))
            meaning = lexicon_meaning(self.text_at(number_k), "number")
            if not meaning or number % 10 ** len(meaning[0]):
                break
            number, k = number + float(meaning[0]), number_k + 1
        return number, k

    def _read_number(self, k: int) -> int | None:
        """Read a number with its unit; return where to continue, or None if there is none here."""
        number_and_next = self._value_of_words(k)
        if number_and_next is None:
            return None
        number, k = number_and_next
        if self._is_half(k):
            number, k, self.is_sure = number + 0.5, k + 2, False
        unit, thousandths = self.next_unit, 1000.0
        if lexicon_meaning(self.text_at(k), "by") and lexicon_meaning(
            self.text_at(k + 1), "number"
        ) == ("100",):
            unit, k = "%", k + 2
        elif unit_meaning := lexicon_meaning(
            self.text_at(unit_k := k + bool(lexicon_meaning(self.text_at(k), "of"))), "unit"
        ):
            k = unit_k  # `un cuarto de vuelta`
            unit, thousandths = unit_meaning[0], float(unit_meaning[1])
            is_stop = self.words[k].source == "S" and bool(self.words[k].space)
            if is_stop and self.values and k + 1 == len(self.words):
                return None  # `R 1 50 S`: an instruction of its own
            is_comma = self.words[k].text == rows.COMMA_KEY and self._is_number(k + 1)
            self.is_sure, k = self.is_sure and not (is_stop or is_comma), k + 1
            if self._is_half(k):
                number, k, self.is_sure = number + 0.5, k + 2, False
        elif lexicon_meaning(self.text_at(k), "of") and (
            value_meaning := lexicon_meaning(self.text_at(k + 1), "value")
        ):
            unit, k = value_meaning[0], k + 2
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
        is_and = bool(lexicon_meaning(self.text_at(k), "and"))
        return is_and and lexicon_meaning(self.text_at(k + 1), "power") == ("50",)

    def _read_sign(self, k: int) -> int | None:
        sign, previous_text = self.text_at(k), self.text_at(k - 1)
        is_minus = sign == "-" and self._is_number(k + 1)
        if is_minus and self.command in ("M", "SHOW"):
            self.is_sure = self.is_sure and not (self.values and previous_text != ",")
            self._add_value("-" + number_text(float(self.text_at(k + 1))), self.next_unit)
            return k + 2
        if is_minus and (previous_text in ("(", ",") or self._is_glued(k)):
            is_minus_of_move = self.command in MOVES and not self.is_reversed and not self.values
            self.is_sure, self.is_reversed = False, True
            return k + 1 if is_minus_of_move else None  # a sign is never dropped
        if sign not in _IGNORED_SIGNS or (sign == "=" and not self.next_unit):
            return None
        if sign == "," and self.next_unit and previous_text != ",":
            return None  # a value that is only named
        self.cost += 0.0 if sign in "(),%" else 0.2
        is_odd = sign in ("-", ".") or (sign == "%" and not self._is_number(k - 1))
        self.is_sure = self.is_sure and not is_odd
        return k + 1

    def _is_glued(self, k: int) -> bool:
        """Return whether a sign belongs to the text after it: `R -1 50`."""
        return bool(self.words[k].space) and self.words[k + 1].space == ""

    def _read_word(self, k: int) -> int | None:
        word, next_text = self.text_at(k), self.text_at(k + 1)
        names, value_meaning = self.names, lexicon_meaning(word, "value")
        is_command = word in names.actuators or (word in INSTRUCTION_WORDS and word != "BREAK")
        concepts = [word] if is_command else [meaning.concept for meaning in names.meanings(word)]
        command = next(
            (
                concept
                for concept in concepts
                if is_command or concept in CALL_WORDS or concept == "S"
            ),
            None,
        )
        is_before_number = self._is_number(k + 1) or next_text in ("=", ":")
        if self.command in MOVES and word in _UNIT_OF_LETTER and is_before_number:
            self.next_unit = _UNIT_OF_LETTER[word]
        elif lexicon_meaning(word, "turn"):
            if self.command in ("F", "B") and self.values:
                return None  # a different instruction
            self.is_turn = True
            self.command = None if self.command == "F" else self.command
        elif self._names_unit(word, value_meaning):
            last_value = self.values[-1] if self.values else None
            ends_value = next_text in ("", ",", ")") and self.text_at(k - 1) != ","
            if (
                last_value
                and last_value.unit in (None, value_meaning[0])
                and ends_value
                and value_meaning != ("s",)
            ):
                self.values[-1] = last_value._replace(unit=value_meaning[0])
            else:
                self.next_unit = value_meaning[0]
        elif word in names.known_names.values and self.command:
            self._add_value(word, value_meaning[0] if value_meaning else self.next_unit)
        elif (
            self.command == "BEEP"
            and (note := lexicon_meaning(word, "note") or lexicon_meaning(word + "4", "note"))
            and not (len(word) == 1 and self._is_number(k + 1))
        ):  # `pita 1 segundo a 440`
            self.values.append(_Value(note[0], "Hz"))
            self.is_sure = self.is_sure and len(word) > 1  # `C`
        elif names.find_meaning(word) == "FOREVER" and self.command in MOVES and self._is_worded():
            self._add_value("FOREVER", "s")
            self.is_sure = False
        elif lexicon_meaning(word, "power") and self.command:
            self._add_value(lexicon_meaning(word, "power")[0], "%")
            self.is_sure = False
        elif command:
            is_repetition = next_text in ("", ",") and command == self.command and command in MOVES
            return k + 1 if is_repetition or self._take_command(word, command) else None
        elif lexicon_meaning(word, "filler"):
            may_be_unit = self._is_number(k - 1) and next_text in ",)"
            self.is_sure = self.is_sure and not may_be_unit  # it may be a unit: `F(8 in, 60)`
            self.cost += 0.1
        else:
            for concept, cost in names.meanings(word):
                self.is_sure = self.is_sure and cost < 2 and not word[-1].isdigit()
                if self.command and (concept in names.sensors or concept in ("TRUE", "FALSE")):
                    self.values.append(_Value(concept, None))
                    return k + 1
            return None
        return k + 1

    def _is_worded(self) -> bool:
        """Return whether a move is in words, without values and brackets: `avanzar siempre`."""
        return not self.values and all(word.text != "(" for word in self.words)

    def _names_unit(self, word: str, value_meaning: tuple[str, ...]) -> bool:
        if (
            not value_meaning
            or word in self.names.known_names.values
            or not (self.command or self.is_turn)
        ):
            return False
        return self.command == "M" or value_meaning[0] not in _SIDES

    def _add_value(self, text: str, unit: str | None) -> None:
        self.values.append(_Value(text, unit))
        self.next_unit = None

    def _take_command(self, word: str, command: str) -> bool:
        meanings = () if word in INSTRUCTION_WORDS else self.names.meanings(word)
        cost = meanings[0].cost if meanings else 0
        self.is_sure = self.is_sure and cost < 2
        old_command = self.command
        is_direction_of_f = old_command == "F" and command in ("B", "L", "R") and not self.values
        is_side_of_turn = self.is_turn and command in ("L", "R") and old_command not in ("L", "R")
        if old_command is None or is_direction_of_f or is_side_of_turn:
            self.command = command
        elif old_command == command and not self.values and command in MOVES:
            pass
        elif not (command == "F" and old_command in MOVES and lexicon_meaning(word, "filler")):
            return False
        self.cost += cost * 0.3
        return True

    def make_call(self, has_until: bool, is_instruction: bool) -> FilledCall | None:
        assert self.command is not None
        self.command = OPPOSITE_MOVES[self.command] if self.is_reversed else self.command
        device = self.names.actuators.get(self.command)
        word = device.word if device else WORDS[self.command]
        if not word.arguments:
            is_sure = self.is_sure and self.times is None
            stop = FilledCall([make_token(word.text)], self.cost, is_sure, self.times)
            return None if self.values else stop
        values = self._in_seconds(self._with_decimals(len(word.arguments)))
        if values is None or not (values or is_instruction):
            return None
        slots = self._fill_slots(values, word.arguments, has_until)
        if not slots or (word.text == "M" and len(values) == 1):
            return None  # the motor is ambiguous
        texts: list[str] = []
        samples: list[str] = []
        for value, argument in zip(slots, word.arguments, strict=True):
            given_text = value.text if value else self._own_value(argument)
            samples += [] if given_text else [f"{argument.sample} {argument.unit}"]
            texts.append(given_text or argument.sample)
        call = f"{word.text}({','.join(texts)})".replace(",", f" {self.extent_word},", 1)
        tokens = [make_token(token.text) for token in lexemes(call)]
        return FilledCall(tokens, self.cost, self.is_sure, self.times, tuple(samples))

    def _own_value(self, argument: Argument) -> str:
        """Return the program's own value for an argument, or "" if there is not exactly one.

        The one variable with such a name, VELOCIDAD for `F(2)`, or else the value of all other
        calls.
        """
        own_values = [
            variable
            for variable in self.names.variables
            if any(is_called(part, argument) for part in variable.split("_"))
        ]
        return (
            own_values[0]
            if len(own_values) == 1
            else ""
            if own_values
            else self.names.usual_values.get(argument.unit, "")
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
        plain_values = [
            value for value in values or () if value.unit is None and not value.text.isidentifier()
        ]
        if plain_values and values and lexicon_meaning(self.words[0].text, "milliseconds"):
            self.is_sure = False
            return [
                _Value(number_text(value.number / 1000), "s") if value in plain_values else value
                for value in values
            ]
        is_in_milliseconds = any(value.number >= MIN_MILLISECONDS for value in plain_values)
        return None if self.command == "W" and is_in_milliseconds else values

    def _fill_slots(
        self, values: list[_Value], arguments: tuple[Argument, ...], has_until: bool
    ) -> list[_Value | None] | None:
        """Return the value of each argument: by its unit, by its range, and then in order."""
        slots: list[_Value | None] = [None] * len(arguments)
        slot_of_value: dict[int, int] = {}
        extent_word = UNIT_OF.get(self.command or "", "")
        for k, value in enumerate(values):
            unit = value.unit
            is_scratch_steps = unit == "steps" and self.words[0].text not in WORDS
            if is_scratch_steps and extent_word == "CM" and value.number >= _MIN_STEPS:
                unit, self.is_sure = EXTENTS[extent_word].unit, False
            if unit == "turns" and extent_word == "DEG":
                unit, self.is_sure = EXTENTS[extent_word].unit, False
                value = _Value(number_text(value.number * FULL_TURN), unit)
            if extent_word and unit == EXTENTS[extent_word].unit:
                if slots[0] is not None or any(value.unit is None for value in values[:k]):
                    return None
                slots[0], slot_of_value[k], self.extent_word = value, 0, extent_word
            elif unit is not None:
                fitting_slots = (
                    i
                    for i, argument in enumerate(arguments)
                    if unit in (argument.unit, argument.name)
                )
                slot_k = next((i for i in fitting_slots if slots[i] is None), None)
                if slot_k is None:
                    return None
                slots[slot_k], slot_of_value[k] = value, slot_k
        unplaced_indexes = [k for k in range(len(values)) if k not in slot_of_value]
        if self.command == "BEEP" and len(unplaced_indexes) == 2:
            unplaced_indexes.sort(key=lambda k: values[k].number >= LONG_TIME_S)
        if has_until and slots[0] is None and arguments[0].unit == "s" and not unplaced_indexes:
            slots[0] = _Value("FOREVER", None)
        for k in unplaced_indexes:
            slot_k = next((i for i, slot in enumerate(slots) if slot is None), None)
            if self.command == "BEEP" and len(values) == 1:
                slot_k = 1 if values[k].number * 1000 >= arguments[1].low else slot_k
            if slot_k is None:
                return None
            slots[slot_k], slot_of_value[k] = values[k], slot_k
        slot_order = [slot_of_value[k] for k in sorted(slot_of_value)]
        self.is_sure = self.is_sure and slot_order == sorted(slot_order)
        for k, slot_k in slot_of_value.items():
            is_long_time = values[k].number >= LONG_TIME_S and values[k].unit is None
            if is_long_time and arguments[slot_k].unit == "s" and len(arguments) > 1:
                if self.words[0].text not in WORDS:
                    return None  # values of another language are rarely seconds: `move(50, 50)`
                self.is_sure = False
        if None in slots:
            if any(value.unit == "%" and value.number < LONG_TIME_S for value in values):
                return None  # `F(2 VEL)`: the name of a power, and a time
            is_move = self.command in MOVES and unplaced_indexes == [0]
            if self.command == "SHOW" or (is_move and values[0].number >= LONG_TIME_S):
                return None  # a power, degrees or centimetres
            self.is_sure, self.cost = False, self.cost + 2
        for slot, argument in zip(slots, arguments, strict=True):
            thousandths = slot.number * 1000 if slot else nan
            if thousandths < argument.low or thousandths > argument.high:
                return None
        return slots
