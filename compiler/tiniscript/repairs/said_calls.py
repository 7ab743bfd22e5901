"""A single instruction whose values are said in another way: with units, in words, in other signs.

Reads the text of one instruction as a whole, and gives its call only where nothing is left over.
Knows which value is meant by its unit or its name, and no program.
"""

from __future__ import annotations

import re
from collections.abc import Container, Sequence
from typing import NamedTuple
from unicodedata import combining, normalize

from tiniscript.fixed_point import as_text
from tiniscript.syntax.call_suggestions import LONG_TIME_S
from tiniscript.words import (
    NOTE_WORDS,
    NUMBER_WORDS,
    OTHER_WORDS,
    POWER_WORDS,
    TURN_WORDS,
    UNITS,
    WORDS,
    Word,
    meant_by,
    names_of,
)

_ROLES = ("move", "wait", "motors", "beep", "show")
LONGEST = 120  # characters of an instruction that are read
_HEAD = re.compile(r"\s*\(?\s*([A-Za-z]+)(?!\.)")
_SENTENCE_END = re.compile(r"(?<=[A-Za-z%)])\s*\.\s*\Z")
_TURNED = re.compile(  # `girar a la derecha`
    rf"(?i)\A\s*(?:{'|'.join(sorted(TURN_WORDS))})\s+(?:(?:a|al|la|el|hacia|para|to|the)\s+)*"
    r"(izq[a-z]*|der(?:echa)?|left|right)(?![a-z])"
)
_GOES_ON = re.compile(r"\)\s*[^\s)]")  # `F(2, 80) S`
_DOTTED = re.compile(r"^\s*([A-Za-z]+)[._]([0-9]+)[._]([1-9]0|100)\s*$")  # `F.2.80`
_AGAIN = re.compile(r"\)\s*,?\s*\((?=\s*[0-9])")  # `F(2),(80)`
_STOPS = re.compile(r"[^%]*[0-9] +[Ss]")  # `W 1 S`: seconds, or the command
_DIGITS = str.maketrans("OoIl", "0011")
_LETTERED = re.compile(r"(?<![\w.,])(?:[0-9OoIl]+(?:\.[0-9OoIl]+)?)(?![A-Za-z_])")
_LETTER = re.compile(r"(?<=[(,])\s*[OoIl]\s*(?=[,)])")
_SPLITS = re.compile(r"(?<=[0-9])['\u00b4\u2019_\u00b7\u2022](?=[1-9]|0[0-9.])")  # `2'80`, `2_80`
_POINTS = re.compile(r"([0-9]\.[0-9]+)\.([1-9]0|100)(?![\w.])")  # `0.5.80`
_PERCENT = re.compile(r"(?i)\b(por ciento|percent)\b")
_PIECE = re.compile(
    r"(?P<number>[0-9]+(?:\.[0-9]+)?|\.[0-9]+)|(?P<word>[A-Z][A-Z_]*[0-9]*)|(?P<sign>\S)"
)
_BETWEEN = frozenset('()[]{}<>,;:=/"|&')
_SMALL = frozenset("A AL CON POR DE DURANTE EN LA EL THE AT WITH FOR OF TO Y E AND".split())  # noqa: SIM905
_BESIDE_SENSOR = frozenset("EL LA THE DE DEL OF VALOR VALUE SENSOR EN IN CM".split())  # noqa: SIM905
# Names of values, which stand before or behind their number; a unit stands behind it alone.
_NAMES = {
    name: unit
    for argument, unit in (("time", "s"), ("power", "%"), ("hertz", "Hz"))
    for name in names_of(argument)
    if unit == "%" or name not in UNITS
}
_TEENS = {
    "CERO": 0, "ZERO": 0, "ONCE": 11, "DOCE": 12, "TRECE": 13, "CATORCE": 14, "QUINCE": 15,
    "VEINTICINCO": 25, "FIFTEEN": 15,
}  # fmt: skip
_TEENS.update(
    CIENTO=100, DOSCIENTOS=200, TRESCIENTOS=300, CUATROCIENTOS=400, QUINIENTOS=500,
    SEISCIENTOS=600, SETECIENTOS=700, OCHOCIENTOS=800, NOVECIENTOS=900,
)  # fmt: skip
_HALVES = ("MEDIO", "MEDIA", "HALF")
_COUNTED = frozenset((*NUMBER_WORDS, *_TEENS, *_HALVES))
_PARTS = (("1", "2"), ("1", "4"), ("3", "4"))  # of one, with a `/`


_SIDE = "(?P<{}>IZQ[A-Z]*|LEFT|L|DER[A-Z]*|RIGHT|R|D|I)"
_POWER = "(?P<{}>-?[0-9]+)[ ]*%?"
_SIGNS = "[ =:]*"
# `izq 50, der 80`, and `50 izq, 80 der`.
_SIDES = re.compile(
    rf"[ (]*{_SIDE.format('one')}{_SIGNS}{_POWER.format('a')}[ ,;Y]+"
    rf"{_SIDE.format('two')}{_SIGNS}{_POWER.format('b')}[ )]*"
)
_SIDES_BEHIND = re.compile(
    rf"[ (]*{_POWER.format('a')}[ ]*{_SIDE.format('one')}[ ,;Y]+"
    rf"{_POWER.format('b')}[ ]*{_SIDE.format('two')}[ )]*"
)


class Said(NamedTuple):
    """`call` is the instruction; `example` what of it was not said, or nothing.

    `sign` was typed for the `digit` of its key.
    """

    word: Word
    call: str
    example: str
    sign: str = ""
    digit: str = ""


class _Value(NamedTuple):
    text: str
    unit: str  # "" where none is said
    is_joined: bool = False  # a `,` without a space is before it
    thousandths: int = 1000  # of our unit in the one that was said


def said_call(text: str, names: Container[str]) -> Said | None:
    """Return what one instruction says, None where that is not all sure.

    `names` are those of the program's variables.
    """
    text = _AGAIN.sub(",", _DOTTED.sub(r"\1 \2,\3", text[: LONGEST + 1]))
    if len(text) > LONGEST or _GOES_ON.search(text) or _STOPS.fullmatch(text):
        return None
    plain = "".join(c for c in normalize("NFKD", text) if not combining(c)).replace("、", ",")
    plain = _PERCENT.sub("%", plain)
    plain = _SPLITS.sub(",", _POINTS.sub(r"\1,\2", plain))
    plain = _TURNED.sub(r"\1", _SENTENCE_END.sub("", plain))
    head = _HEAD.match(plain)
    is_around = head is not None and "(" in head[0] and plain.count("(") > 1  # `(F(2, 80)`
    if head is None or is_around or head[1].upper() in names:
        return None
    name = head[1].upper()
    word = WORDS.get(name) or WORDS.get(meant_by(name) or "")
    if word is None or word.role not in _ROLES:
        return None
    if word.role == "motors" and (sides := _sides(plain[head.end() :])) is not None:
        return Said(word, f"{word.text}({sides[0]}, {sides[1]})", "")
    if word.role == "show":
        return _shown(word, plain[head.end() :], names)
    values = _values(word, plain[head.end() :], names)
    return None if not values else _fitted(word, values)


def _sides(text: str) -> tuple[str, str] | None:
    """`M(izq 50, der 80)`: the power of the left motor and of the right one."""
    both = _SIDES.fullmatch(text.upper()) or _SIDES_BEHIND.fullmatch(text.upper())
    if both is None:
        return None
    one, two = ({"I": 0, "L": 0}.get(each[0], 1) for each in both.group("one", "two"))
    powers = both.group("a", "b")
    return None if one == two else (powers[one], powers[two])


def _shown(word: Word, text: str, names: Container[str]) -> Said | None:
    """`mostrar luz izquierda`, `SHOW(distancia cm)`: the value that its words say together."""
    if not re.fullmatch(r"[\s()A-Za-z_'\"]+", text):
        return None
    said = re.findall(r"\w+", text.upper())
    words = [each for each in said if each in names or each not in _BESIDE_SENSOR]
    name = "_".join(words)
    meant = name if name in names or name in OTHER_WORDS else meant_by(name)
    if meant is None or (meant in WORDS and WORDS[meant].role != "value"):
        return None
    return Said(word, f"{word.text}({meant})", "")


def _values(word: Word, text: str, names: Container[str]) -> list[_Value] | None:
    text = _LETTERED.sub(lambda match: _digits(match[0]), text)
    text = _LETTER.sub(lambda match: match[0].translate(_DIGITS), text).upper()
    reader = _Reader(word, list(_PIECE.finditer(text)), names)
    return reader.found if reader.is_read() and not reader.unit else None


class _Reader:
    """Takes the pieces of a text one by one into the values that it says."""

    def __init__(self, word: Word, pieces: list[re.Match[str]], names: Container[str]) -> None:
        self._notes = NOTE_WORDS if word.role == "beep" else {}
        self._is_signed = word.role == "motors"  # `M 50 -50`: a `-` says that a wheel goes back
        self._pieces = pieces
        self._names = names
        self.found: list[_Value] = []
        self._has_bracket = any(piece[0] == "(" for piece in pieces)
        self.unit = ""  # of the value that comes
        self._is_behind_value = False
        parts = 1 + sum(piece[0] == "," for piece in pieces)
        self._has_a_part_each = self._has_bracket and parts <= len(word.arguments)

    def is_read(self) -> bool:
        """Whether all pieces are values, what they are, and signs between them."""
        for k, piece in enumerate(self._pieces):
            is_value = False
            if piece.lastgroup == "number":
                is_value = self._is_number(k)
                if not is_value:
                    return False
            elif piece.lastgroup == "word":
                count = len(self.found)
                if not self._is_word(k):
                    return False
                is_value = len(self.found) > count or piece[0] in _COUNTED
            elif not self._is_sign(k):
                return False
            self._is_behind_value = is_value
        return True

    def _add(self, text: str, is_joined: bool = False) -> None:
        self.found.append(_Value(text, self.unit, is_joined))
        self.unit = ""

    def _at(self, k: int) -> str:
        return self._pieces[k][0] if 0 <= k < len(self._pieces) else ""

    def _touches(self, k: int) -> bool:
        """Whether there is no space between this piece and the one before."""
        return self._pieces[k - 1].end() == self._pieces[k].start()

    def _is_number(self, k: int) -> bool:
        text = self._at(k)
        if self._at(k - 1) == "/" and self._divides(k):
            self.found[-1] = self.found[-1]._replace(text=f"{self._at(k - 2)}/{text}")
            return True
        is_joined = k > 1 and self._at(k - 1) == "," and self._touches(k) and self._touches(k - 1)
        self._add(text, is_joined)
        return True

    def _divides(self, k: int) -> bool:
        """Whether `/` makes a part of one: `1/2`, and not `2/80`."""
        over = self._at(k - 2)
        return bool(self.found) and over == self.found[-1].text and (over, self._at(k)) in _PARTS

    def _is_sign(self, k: int) -> bool:
        sign = self._at(k)
        if sign == "%":
            return self._is_behind_value and self._takes_unit("%")
        if sign == "-" and self._is_signed:
            return False
        if sign == "-" and not self._has_bracket and self._is_between_numbers(k):
            return True  # `F2-80`
        if sign == "-":  # between two values, and none of them is negative
            is_between = k + 1 < len(self._pieces) and (k == 0 or self._is_behind_value)
            return is_between and not (k and self._touches(k)) and not self._touches(k + 1)
        return sign in _BETWEEN

    def _is_between_numbers(self, k: int) -> bool:
        beside = self._pieces[max(0, k - 1) : k + 2]
        return len(beside) == 3 and beside[0].lastgroup == beside[2].lastgroup == "number"

    def _is_word(self, k: int) -> bool:
        word = self._at(k)
        number = _TEENS.get(word, NUMBER_WORDS.get(word))
        if word in self._names:
            self._add(word)
        elif word in self._notes and (word != "LA" or self._at(k - 1) in ("NOTA", ",")):
            self.unit = "Hz"
            self._add(self._notes[word])
        elif word in _HALVES:
            return self._is_half(k)
        elif word in POWER_WORDS:
            self.unit = "%"
            self._add(POWER_WORDS[word])
        elif number is not None:
            self._count(k, int(number))
        elif word in _NAMES:
            return self._is_name(k)
        elif word in UNITS:
            return self._is_behind_value and self._takes_unit(word)
        else:
            return word in _SMALL
        return True

    def _is_name(self, k: int) -> bool:
        """`potencia 80`, `80 pot`; but of `2 potencia 80` it may be both."""
        if self._has_a_part_each and self._at(k - 1) in "(," and self._at(k + 1) in ",)":
            return False  # `F(T, 60)`: it is a value itself, of a variable that is not set
        if (
            k
            and self._touches(k)
            and self._pieces[k - 1].lastgroup == "number"
            and len(self._at(k)) > 3
        ):
            return False  # `1velocidad` is rather a name
        if k > 1 and self._at(k - 1) in ("=", ":", ">"):
            return False  # `80 = vel`: of `80 = vel, 2` it may be both, too
        is_before = k + 1 < len(self._pieces) and self._pieces[k + 1].lastgroup == "number"
        is_before = is_before or self._at(k + 1) in ("=", ":", *NUMBER_WORDS)
        is_of = k > 1 and self._at(k - 1) in ("DE", "OF") and self._pieces[k - 2][0][0].isdigit()
        if k and self._touches(k) and len(self._at(k)) == 1 and self.found:  # `8p`, for 80
            if _is_number(self.found[-1].text) and float(self.found[-1].text) < 10:
                return False
        if not is_before and self.found and self.found[-1].unit == _NAMES[self._at(k)] == "%":
            return True  # `80 % de potencia`, `toda la potencia`
        if self._is_behind_value or (is_of and not is_before):  # `80 de potencia`
            return not is_before and self._takes_unit(self._at(k))
        self.unit = _NAMES[self._at(k)]
        return True

    def _takes_unit(self, name: str) -> bool:
        last = self.found[-1]
        unit, thousandths = (_NAMES[name], 1000) if name in _NAMES else UNITS[name]
        text = last.text
        over, _, under = text.partition("/")
        if last.unit or (thousandths != 1000 and not _is_number(over)):
            return False
        if under or thousandths != 1000:
            text = as_text(round(float(over) / float(under or 1) * thousandths))
        self.found[-1] = last._replace(text=text, unit=unit, thousandths=thousandths)
        return True

    def _is_half(self, k: int) -> bool:
        """`medio segundo`, `dos y medio`, `un segundo y medio`."""
        last = self.found[-1] if self.found else None
        if self._at(k - 1) in ("Y", "AND"):
            if last is None or last.unit not in ("", "s") or not _is_number(last.text):
                return False
            value = round(float(last.text) * 1000) + last.thousandths // 2
            self.found[-1] = last._replace(text=as_text(value))
        elif self._is_behind_value:
            return False
        else:
            self._add("0.5")
        return True

    def _count(self, k: int, number: int) -> None:
        """Take a number in words: `dos`, `treinta y cinco`."""
        last = self.found[-1] if self.found else None
        whole = int(last.text[:9]) if last is not None and last.text.isdecimal() else 0
        is_ten = 30 <= whole <= 90 and self._at(k - 1) == "Y" and number < 10
        is_hundred = whole >= 100 and not whole % 100 and self._is_behind_value and number < 100
        if last is not None and not last.unit and (is_ten or is_hundred):
            self.found[-1] = last._replace(text=str(int(last.text) + number))
        else:
            self._add(str(number))


def _fitted(word: Word, values: Sequence[_Value]) -> Said | None:
    """Give each value its place, by its unit or else in order."""
    values = _with_points(values, len(word.arguments))
    units = [each.unit for each in word.arguments]
    places = [""] * len(units)
    loose = []
    for value in values:
        if not value.unit:
            loose.append(value.text)
        else:
            free = [k for k, unit in enumerate(units) if unit == value.unit and not places[k]]
            if not free:
                return None
            places[free[0]] = value.text
    is_time_loose = bool(loose) and not places[0] and word.role != "motors"
    for text in loose:
        if all(places):
            return None
        places[places.index("")] = text
    return _checked(word, places, is_unnamed=len(loose) == len(values), is_time_loose=is_time_loose)


def _checked(word: Word, places: list[str], is_unnamed: bool, is_time_loose: bool) -> Said | None:
    example = ""
    numbers = [float(text) if _is_number(text) else None for text in places]
    first = numbers[0]
    second = numbers[-1]
    if is_unnamed and word.role == "beep" and first and second and second < LONG_TIME_S < first:
        return _checked(word, places[::-1], is_unnamed, is_time_loose)  # `BEEP 440 1`
    if is_time_loose and first is not None and first >= LONG_TIME_S:
        return None  # the power, degrees, milliseconds
    if word.role == "beep" and not places[0] and second is not None:
        its = word.arguments[0]
        return Said(word, f"{word.text}({its.sample}, {places[1]})", f"{its.sample} {its.unit}")
    if "" in places:
        if places.count("") > 1 or first is None or "." in places[0] or word.role == "motors":
            return None
        last = word.arguments[-1]
        example = f"{last.sample} {last.unit}"
        places[-1] = last.sample
    for argument, number in zip(word.arguments, numbers, strict=True):
        if number is not None and not argument.low <= number * 1000 <= argument.high:
            return None
        if number is not None and argument.unit == "%" and 0 < number < 1:
            return None  # `medio` is a half of something
    return Said(word, f"{word.text}({', '.join(places)})", example)


def _with_points(values: Sequence[_Value], wanted: int) -> Sequence[_Value]:
    """`0,5, 80` is 0.5 and 80, where that makes as many as there should be."""
    if len(values) == wanted + 1 == 3 and values[2].text == "0" and values[1].text.isdecimal():
        whole = values[1]._replace(text=f"{values[1].text}.0")  # `80,0`
        is_meant = values[2].is_joined and not values[1].is_joined
        return [values[0], whole] if is_meant else values
    if len(values) != wanted + 1 or not values[1].is_joined or values[0].unit:
        return values
    first, second = values[:2]
    is_whole = first.text.isdecimal() and second.text.isdecimal()
    if not is_whole or second.text.endswith("0") or values[-1].text == "0":  # `2,8 0`
        return values
    return [second._replace(text=f"{first.text}.{second.text}", is_joined=False), *values[2:]]


def _digits(text: str) -> str:
    """`O.5` is 0.5, `8O` is 80; a letter alone stays."""
    return text.translate(_DIGITS) if any(c.isdecimal() for c in text) else text


def _is_number(text: str) -> bool:
    return re.fullmatch(r"[0-9]+(?:\.[0-9]+)?|\.[0-9]+", text) is not None
