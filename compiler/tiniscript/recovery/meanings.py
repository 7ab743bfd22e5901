"""Meanings: the possible meanings of each word and sign of a wrong line.

Knows the lexicons, spelling, and the names that a program has. Knows no instruction of words.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Sequence
from functools import cache, lru_cache
from itertools import chain, pairwise
from typing import NamedTuple

from tiniscript.base.kit import Kit
from tiniscript.base.spelling import Speller, is_slip, nearest
from tiniscript.base.words import ALIASES, BLOCK_ENDS, EXTENTS, WORDS, LexiconEntry, lexicon
from tiniscript.base.words import lexicon_concept as lexicon_concept
from tiniscript.base.words import lexicon_meaning as lexicon_meaning
from tiniscript.syntax.blocks import WORD_OF_END
from tiniscript.syntax.lexer import DASHES, NUMBER, UNKNOWN_SIGN, WORD
from tiniscript.syntax.operators import COMPARISONS, SIGNS
from tiniscript.syntax.outline import KnownNames

KNOWN_COST, MISSPELT_COST, NEAR_COST = 1, 2, 3  # costs of a meaning: exact, misspelt, one slip away
BLOCK_STARTS = frozenset(BLOCK_ENDS) - {"DEF"}
SEPARATORS = frozenset(";|{}")
UNNAMED_END = "FIN"  # stands for the end of a block whose word does not name it; a row replaces it
CALL_WORDS = frozenset(word.text for word in WORDS.values() if word.is_call)
INSTRUCTION_WORDS = CALL_WORDS | {"S", "STOP", "BREAK"}
ASKING_WORDS = frozenset(("IF", "ELSEIF", "WHILE", "WHEN", "UNTIL"))

_TOKEN = re.compile(
    r"(\d+(?:\.\d+)?|(?<!\d)\.\d+)|([A-Za-zÀ-ÿ_][\wÀ-ÿ]*)"
    r"|(<=|>=|<>|==|!=|=!|=>|=<|&&|\|\||->|<-|:=|\+\+|--(?=\s*(?:$|[;)]))|\+=|-=|\*=|\S\uFE0F?)"
)
_SIGNS = SIGNS | frozenset("(),;|")
_MAX_NAME_WORDS = 4  # words of a name
# Classes by the lexicon's meaning of a word outside of the language.
_CLASSES = {
    LexiconEntry("unit", "cm", "1000"): "@in_cm", LexiconEntry("unit", "cm", "100000"): "@in_m",
    LexiconEntry("unit", "s", "1000"): "@in_secs", LexiconEntry("unit", "°", "1000"): "@in_deg",
    LexiconEntry("unit", "steps", "1000"): "@in_steps", LexiconEntry("value", "%"): "@of_power",
    LexiconEntry("value", "s"): "@of_time", LexiconEntry("value", "Hz"): "@of_pitch",
    LexiconEntry("number", "1"): "@one", LexiconEntry("number", "100"): "@hundred",
}  # fmt: skip
NEAR_CM = "10"  # an example of a near distance
LONG_TIME_S = 20  # from here on, a number without a unit may be a power, degrees or centimetres
MAX_POWER = 100
_EIGHTH_TURN, FULL_TURN = (
    45,
    360,
)  # degrees: eighths of a turn, and values that are no power, are probably an angle
# Classes of numbers by their possible meanings.
_CHECK_OF_UNIT: dict[str, Callable[[float], bool]] = {
    "@whole": float.is_integer, "@time": lambda number: number < LONG_TIME_S,
    "@power": lambda number: LONG_TIME_S <= number <= MAX_POWER,
    "@angle": lambda number: (
        MAX_POWER < number <= FULL_TURN or (number >= _EIGHTH_TURN and number % _EIGHTH_TURN == 0)
    ),
}  # fmt: skip
_YEAR_WORDS = ("ANO", "ANOS")  # spellings of AÑO that do not occur
REMEMBERED_LINES = 500  # lines: each is asked for often while one program is read


class Lexeme(NamedTuple):
    """A word in capitals without accents, a number or a sign.

    `source` is how it was written, None if a repair made it; `space` is before it, None where the
    repair has its own layout.
    """

    kind: str
    text: str
    source: str | None = None
    space: str | None = None


class Meaning(NamedTuple):
    """A concept, that is a word of the language or a device, and what it costs to read it so."""

    concept: str
    cost: int


def lexemes(line: str) -> list[Lexeme]:
    return [*_lexemes(line)]


@lru_cache(REMEMBERED_LINES)
def _lexemes(line: str) -> tuple[Lexeme, ...]:
    found_tokens, end_offset = [], 0
    for match in _TOKEN.finditer(line):
        text, kind = match[0], NUMBER if match[1] else WORD if match[2] else UNKNOWN_SIGN
        if kind is WORD:
            text = plain(text)
            if "Ñ" in match[0].upper() and not lexicon().get(text):
                respelt_word = plain(re.sub("[ñÑ]", "ni", match[0]))
                text = respelt_word if lexicon().get(respelt_word) or text in _YEAR_WORDS else text
        elif text in _SIGNS or text in DASHES:
            kind = text = "-" if text in DASHES else text
        elif lexicon_concept(text[0]):
            kind, text = WORD, text[0]  # an arrow is a command
        found_tokens.append(Lexeme(kind, text, match[0], line[end_offset : match.start()]))
        end_offset = match.end()
    return tuple(found_tokens)


def number_text(number: float) -> str:
    return f"{number:.3f}".rstrip("0").rstrip(".")


@cache
def make_token(text: str) -> Lexeme:
    """Return a token that a repair writes."""
    return lexemes(text)[0]._replace(source=None, space=None)


def texts(tokens: Iterable[Lexeme]) -> tuple[str, ...]:
    return tuple(token.text for token in tokens)


def setup_of(tokens: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return the `SI|` at the beginning of a line, or an empty text."""
    is_begun = texts(tokens[1:2]) == ("|",) and tokens[0].text in ("SI", "SB")
    return tokens[:2] if is_begun else tokens[:0]


def brackets_end(tokens: Sequence[Lexeme], start: int) -> int:
    """Return the end of the brackets that begin at a token, or 0 if they do not end."""
    depth = 0
    for k in range(start, len(tokens)):
        depth += (tokens[k].text == "(") - (tokens[k].text == ")")
        if depth <= 0:
            return k + 1 if k > start else 0
    return 0


def plain(text: str) -> str:
    """Return a text in capitals, without accents."""
    parts = unicodedata.normalize("NFD", text)
    return "".join(sign for sign in parts if not unicodedata.combining(sign)).upper()


@cache
def words_of(*kinds: str) -> str:
    """Return a pattern of the words that the lexicon says one of these of."""
    words = (
        word for word, entries in lexicon().items() if any(entry.kind in kinds for entry in entries)
    )
    return f"(?:{'|'.join(map(re.escape, sorted(words, key=len, reverse=True)))})"


_END_PATTERN = re.compile(words_of("end") + "_?")


@cache
def _speller() -> Speller:
    return Speller([*WORDS, *lexicon()])


@lru_cache(4000)
def meanings(word: str) -> tuple[Meaning, ...]:
    """Return the possible meanings of a word, the likeliest first."""
    if word == "SI":
        return (Meaning("IF", KNOWN_COST),)
    if concept := lexicon_concept(word):
        return (Meaning(concept, KNOWN_COST),)
    if word in WORDS or word in lexicon():
        return ()
    shortened_word = re.sub(r"(.)\1\1+", r"\1\1", word)  # `BEEEEEP`
    if shortened_word != word:
        return (
            (Meaning(shortened_word, MISSPELT_COST),)
            if shortened_word in WORDS
            else meanings(shortened_word)
        )
    parts = word.split("_")
    if (
        len(parts) > 1
        and (kept_parts := [part for part in parts if not lexicon_meaning(part, "sensing")])
        != parts
    ):
        return meanings("_".join(kept_parts))  # `SENSOR_LUZ_DERECHA`
    if concept := _sensor_with_side(parts):
        return (Meaning(concept, KNOWN_COST),)
    near_miss = _speller().find_near_miss(word)
    guesses = (
        (homophone_of(word), KNOWN_COST),
        (lexicon_concept(near_miss or ""), MISSPELT_COST),
        (_in_two_words(word), KNOWN_COST),
        (nearest(word, WORDS), NEAR_COST),
    )
    return next(((Meaning(concept, cost),) for concept, cost in guesses if concept), ())


def homophone_of(word: str) -> str | None:
    """Return the word of the language that a word sounds like, which may itself mean another thing.

    No device is called a weight: `WEIGHT(1)` is how WAIT sounds when dictated.
    """
    return lexicon_concept(_speller().find_sound_alike(word) or "")


def _sensor_with_side(parts: Sequence[str]) -> str:
    """Return the sensor that two words say: `LEFT_LIGHT`, `luzDer`, `JOYSTICK_X`."""
    splits = [(parts[0][:k], parts[0][k:]) for k in range(3, len(parts[0]) - 2)]
    pairs = [tuple(parts)] if len(parts) == 2 else splits if len(parts) == 1 else []
    for stem, side in (*pairs, *(pair[::-1] for pair in pairs)):
        sensor_stem = next(
            (entry.value for entry in lexicon().get(stem, ()) if entry.kind == "stem"), ""
        )
        sides = ("X", "Y") if sensor_stem == "PAD" else ("L", "R")
        side_letter = side if side in sides else lexicon_concept(side)
        if sensor_stem and side_letter in sides:
            return f"{sensor_stem}_{side_letter}"
    return ""


def certain_concept(word: str) -> str | None:
    """Return the word of the language that a word of another language certainly means, misspelt or
    not."""
    return next((meaning.concept for meaning in meanings(word) if meaning.cost < NEAR_COST), None)


def _in_two_words(word: str) -> str | None:
    """Return the meaning of two joined words that form one command: `moverAdelante`."""
    for k in range(2, min(len(word), 24) - 1):
        halves = word[:k].rstrip("_"), word[k:].lstrip("_")
        long_halves = [half for half in halves if len(half) > 2]  # `there` is no THE RE
        concepts = {half if half == "STOP" else lexicon_concept(half) or "" for half in long_halves}
        turns = [half for half in halves if lexicon_meaning(half, "turn")]
        with_frame = halves if len(halves[1]) > 3 else halves[:1]  # `irAdelante`, and no GOAL
        filler_words = [*turns, *(half for half in with_frame if lexicon_meaning(half, "filler"))]
        commands = concepts - {"", "M", "F"} or concepts - {"", "M"}
        is_framed = (
            bool(concepts & {"F", "M"} or filler_words) or len({*map(lexicon_concept, halves)}) == 1
        )
        are_all_known = all(
            half in filler_words or half == "STOP" or lexicon_concept(half) for half in halves
        )
        if len(commands) == 1 and is_framed and are_all_known:
            command = next(iter(commands))
            if command == "STOP" and any(lexicon_meaning(half, "engine") for half in halves):
                return "S"
            if command in (("L", "R") if turns else ("F", "B", "L", "R", "S", "STOP", "BEEP")):
                return command
    return None


class _LineNames(NamedTuple):
    """The names of one line; `spaced_names` are those that are written as several words."""

    variables: set[str]
    defs: set[str]
    in_brackets: set[str]
    spaced_names: set[tuple[str, ...]]
    parameters: dict[str, tuple[str, ...]]  # parameters of each DEF, by its name
    names_with_values: set[tuple[str, ...]]  # the name of a DEF, or one and those of its values
    block_starts: dict[str, str]  # instructions that begin blocks, since their ends are there: PARA
    lone_words: set[str]  # words that are an instruction alone
    compared_words: set[str]  # words next to a sign that compares them with a number
    counted_starts: list[str]  # `PARA(3)`, which begins one, where a bare end is left for it
    open_headers: int  # headers that lack an end
    given_units: set[
        tuple[str, str]
    ]  # units other than of time, and the numbers they become in calls: % 50


@lru_cache(REMEMBERED_LINES)
def _names_of(line: tuple[Lexeme, ...]) -> _LineNames:
    block_starts, counted_starts, open_headers = _block_counts(line)
    found_names = _LineNames(
        set(), set(), set(), set(), {}, set(), block_starts, _standalone_words(line),
        _compared_words(line), counted_starts, open_headers, _given_units(line),
    )  # fmt: skip
    head = line[2:] if len(line) > 1 and line[1].text == "|" else line
    depth = 0
    for next_index, (token, following_token) in enumerate(pairwise([*line, make_token(";")]), 2):
        depth += (token.text == "(") - (token.text == ")")
        if token.kind is not WORD:
            continue
        if depth > 0:
            found_names.in_brackets.add(token.text)
        elif (
            following_token.text in ("=", "++", "--", "+=", "-=", ":=", "<-")
            and token.text not in WORDS
        ):
            found_names.variables.add(token.text)
        is_def = "DEF" in (token.text, lexicon_concept(token.text))
        is_def = is_def or (
            token.text == "TASK" and next_index == len(line)
        )  # a name that it needs not
        is_def = is_def or (
            token.text == "TO" and next_index == 2 and bool(_logo_names(line[next_index:]))
        )
        if is_def and following_token.kind is WORD and following_token.text not in WORDS:
            if (
                not lexicon_meaning(following_token.text, "main")
                and lexicon_concept(following_token.text) != "START"
            ):
                found_names.defs.add(following_token.text)
                if bare_values := _bare_values(line[next_index:]):
                    found_names.names_with_values.add((following_token.text, *bare_values))
                end = brackets_end(line, next_index)
                given_names = (
                    texts(line[next_index + 1 : end - 1 : 2])
                    if end
                    else _logo_names(line[next_index:])
                )
                if all(name.isidentifier() and name not in WORDS for name in given_names):
                    found_names.parameters[following_token.text] = given_names
    if len(head) > 2 and "DEF" in (head[0].text, lexicon_concept(head[0].text)):
        spaced_name, target = _name_in_words(head[1:], ";"), found_names.defs
    else:
        spaced_name, target = _name_in_words(head, "="), found_names.variables
    if spaced_name:
        found_names.spaced_names.add(spaced_name)
        target.add(joined_name(spaced_name))
    return found_names


def _given_units(line: tuple[Lexeme, ...]) -> set[tuple[str, str]]:
    """Return the powers and the pitches that calls of a line give as plain numbers, by unit."""
    windows = zip(line, line[1:], line[2:], line[3:], line[4:], line[5:], strict=False)
    return {
        (WORDS[word.text].arguments[1].unit, value.text)
        for word, open_bracket, _, comma, value, close_bracket in windows
        if (open_bracket.text, comma.text, close_bracket.text) == ("(", ",", ")")
        and value.kind is NUMBER
        if word.text in CALL_WORDS and word.text != "M" and len(WORDS[word.text].arguments) > 1
    }


def _bare_values(tokens: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return the names of `X, Y` or `X Y`, which lack their brackets; none if there is other
    text."""
    values_text = " ".join(texts(tokens)).partition(";")[0]
    names = tuple(values_text.replace(",", " ").split())
    return names if all(name.isidentifier() and name not in WORDS for name in names) else ()


def _logo_names(tokens: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return the names of `:SIZE :SPEED`, or none if there is other text."""
    signs, names = texts(tokens[::2]), texts(tokens[1::2])
    return names if {*signs} == {":"} and len(signs) == len(names) else ()


def _standalone_words(line: tuple[Lexeme, ...]) -> set[str]:
    """Return words that are alone between separators."""
    texts_around = (";", *texts(line), ";")
    triples = zip(texts_around, texts_around[1:], texts_around[2:], strict=False)
    return {
        word
        for previous_text, word, following_text in triples
        if previous_text in ";|" and following_text == ";"
    }


def _compared_words(line: tuple[Lexeme, ...]) -> set[str]:
    """Return words that are compared with a number, as only values are."""
    windows = [*zip(line, line[1:], line[2:], line[3:], strict=False)]
    lone_words = {
        name.text
        for head, previous_token, name, following_token in windows
        if (previous_token.text, following_token.text) == ("(", ")")
        and name.kind is head.kind is WORD
        if name.text not in lexicon() and (lexicon_concept(head.text) or head.text) in ASKING_WORDS
    }
    return lone_words | {
        name.text
        for previous_token, left, sign, right in windows
        for name, number in ((left, right), (right, left))
        if sign.text in COMPARISONS - {"="} and name.kind is WORD and number.kind is NUMBER
        if previous_token.text not in SEPARATORS
    }


def _name_in_words(tokens: Sequence[Lexeme], end_text: str) -> tuple[str, ...]:
    """Return a name of several words that ends before `end_text`: `mi vel = 5`, `DEF paso 1`."""
    name_words: list[str] = []
    is_number_glued_to_word = (
        end_text == ";" and len(tokens) > 1 and tokens[1].kind is WORD and tokens[1].space == ""
    )
    for token in tokens[: _MAX_NAME_WORDS + 1]:
        text = token.text
        if (
            token.kind not in (WORD, NUMBER, "-")
            or text in BLOCK_STARTS
            or text in INSTRUCTION_WORDS
        ):
            break
        if not name_words and (
            lexicon_meaning(text, "count") or (token.kind is NUMBER and not is_number_glued_to_word)
        ):
            break
        is_reserved = (
            text in WORDS or lexicon_meaning(text, "declare") or lexicon_meaning(text, "set")
        )
        if token.kind is WORD and is_reserved and len(name_words) != 1:
            break
        name_words.append(text)
    next_text = tokens[len(name_words)].text if len(tokens) > len(name_words) else ";"
    is_long_name = (
        len(name_words) > 1
        and next_text == end_text
        and name_words[0] not in WORDS
        and name_words[-1] != "-"
    )
    return tuple(name_words) if is_long_name else ()


class Names:
    """The names of one program, by a look at its tokens; `label` is what rewrites match."""

    def __init__(self, token_lines: Sequence[Sequence[Lexeme]], kit: Kit) -> None:
        readings = [reading for reading in kit.readings if reading.name]
        self.sensors = frozenset(reading.name for reading in readings)
        self.sensor_names = tuple(sorted(sensor.name for sensor in kit.sensors))
        self.number_readings = {
            reading.name: reading for reading in readings if not reading.is_yes_no
        }
        self.actuators = {actuator.name: actuator for actuator in kit.actuators}
        names_of_lines = [_names_of(tuple(line)) for line in token_lines]
        self.in_brackets = {name for line in names_of_lines for name in line.in_brackets}
        self.spaced_names = {row for line in names_of_lines for row in line.spaced_names}
        self.parameters = {
            name: parameters_of_def
            for line in names_of_lines
            for name, parameters_of_def in line.parameters.items()
        }
        for name_with_values in {
            name_with_values
            for line in names_of_lines
            for name_with_values in line.names_with_values
        }:
            if self.in_brackets.issuperset(
                name_with_values[1:]
            ):  # `DEF LADO X`, and `F(X, 50)` below
                self.parameters[name_with_values[0]] = name_with_values[1:]
                self.spaced_names.discard(name_with_values)
        self.block_of_word = {
            word: block for line in names_of_lines for word, block in line.block_starts.items()
        }
        if sum(line.open_headers for line in names_of_lines) < 0:
            self.block_of_word |= {
                word: "LOOP" for line in names_of_lines for word in line.counted_starts
            }
        self.variables = {name for line in names_of_lines for name in line.variables}
        self.variables.update(chain.from_iterable(self.parameters.values()))
        self.defs = {name for line in names_of_lines for name in line.defs} - {
            row[0] for row in self.spaced_names
        }
        units_and_numbers = {pair for line in names_of_lines for pair in line.given_units}
        units = [unit for unit, _ in units_and_numbers]
        self.usual_values = {
            unit: text for unit, text in units_and_numbers if units.count(unit) == 1
        }
        self.called_defs = frozenset(
            self.defs & {word for line in names_of_lines for word in line.lone_words}
        )
        counts = {name: len(self.parameters.get(name, ())) for name in self.defs}
        defs_without_values = {name for name, count in counts.items() if not count}
        names_and_value_counts = {*counts.items(), *((name, 1) for name in self.actuators)}
        values, instructions = self.sensors | self.variables, self.sensors | defs_without_values
        self.known_names = KnownNames(
            frozenset(values), instructions, frozenset(names_and_value_counts)
        )
        # An unknown compared word does not prevent the reading of the text around it.
        compared_names = {
            name for line in names_of_lines for name in line.compared_words if name not in WORDS
        }
        word_of_name = {
            name: self.find_meaning(name, NEAR_COST) for name in compared_names - values
        }
        self.unknown_names = {
            name for name, concept in word_of_name.items() if not concept or concept in CALL_WORDS
        }
        self.readable_names = self.known_names._replace(
            values=frozenset(values | self.unknown_names)
        )
        words = (frozenset(names) for names in (self.defs, self.in_brackets, self.spaced_names))
        self._content = (
            self.readable_names,
            *words,
            self.called_defs,
            frozenset(self.block_of_word.items()),
            frozenset(self.usual_values.items()),
            kit.actuators,
        )
        self._labels: dict[tuple[str, str, bool], str] = {}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Names) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    def is_name(self, word: str) -> bool:
        return word in self.known_names.values or word in self.defs or word in self.actuators

    def is_yes_no(self, word: str) -> bool:
        """Return whether a word is a yes-no value by itself, without a comparison."""
        return word in ("TRUE", "FALSE") or (
            word in self.sensors and word not in self.number_readings
        )

    def meanings(self, word: str) -> tuple[Meaning, ...]:
        """Return the possible meanings of a word that is not a name of the program."""
        if self.is_name(word):
            return ()
        if word in self.block_of_word:
            return (Meaning(self.block_of_word[word], KNOWN_COST),)
        end, _, block = word.partition("_")
        if lexicon_meaning(end, "end") and block in (*WORDS, *self.defs):
            return (Meaning(UNNAMED_END, KNOWN_COST),)
        if concept := self.sensor_with_side(word) or self._lamp_of(word):
            return (Meaning(concept, KNOWN_COST),)
        word_meanings = meanings(word)
        return tuple(
            meaning
            for meaning in word_meanings
            if meaning.concept in WORDS or self.is_device_or_end(meaning.concept)
        )

    def sensor_with_side(self, word: str) -> str:
        """Return the sensor of a side that `SENSOR_L` names, or ""."""
        parts = word.split("_")
        kept_parts = [part for part in parts if not lexicon_meaning(part, "sensing")]
        if len(kept_parts) != 1 or len(parts) == 1:
            return ""
        side = "".join(lexicon_meaning(kept_parts[0], "left", "right"))[:1].upper()
        return self.sensor_on_side(side or lexicon_concept(kept_parts[0]) or kept_parts[0])

    def _lamp_of(self, word: str) -> str:
        """Return the lamp that a word for light means on a robot without a light sensor."""
        is_light = lexicon_meaning(word, "stem") == ("LIGHT",) and "LED" in self.actuators
        return "LED" * (is_light and not any(name.startswith("LIGHT_") for name in self.sensors))

    def sensor_on_side(self, side: str) -> str:
        """Return the one sensor of the robot on L or R, "" for none or several."""
        sensors = [name for name in self.sensors if name.endswith(f"_{side}")]
        return sensors[0] if len(sensors) == 1 and side in ("L", "R") else ""

    def find_meaning(self, word: str, highest_cost: int = MISSPELT_COST) -> str:
        """Return the word of the language that a word means, or "" if it has none, or a less likely
        one."""
        if word in WORDS and word != "SI":
            return word
        word_meanings = self.meanings(word)
        return (
            word_meanings[0].concept
            if word_meanings and word_meanings[0].cost <= highest_cost
            else ""
        )

    def is_device_or_end(self, concept: str) -> bool:
        """Return whether a concept is a device of the kit, or the end of a block."""
        return concept in self.sensors or concept in self.actuators or concept == UNNAMED_END

    def takes_values(self, word: str) -> bool:
        """Return whether a word is an instruction with values in brackets."""
        return word in CALL_WORDS or word in self.actuators or bool(self.parameters.get(word))

    def label(self, token: Lexeme) -> str:
        """Return all classes of a token, as one text that a pattern finds them in."""
        is_glued = token.space == "" or token.text in EXTENTS
        is_unit_position = (
            is_glued and token.text in WORDS and lexicon_meaning(token.text, "unit")
        )  # `5S`, `5 CM`
        key = (token.kind, token.text, bool(is_unit_position))
        if key not in self._labels:
            classes = [*self._word_classes(token), *(["@unit"] if is_unit_position else [])]
            self._labels[key] = f"\x01|{'|'.join(dict.fromkeys(classes))}|\x02"
        return self._labels[key]

    def _word_classes(self, token: Lexeme) -> list[str]:
        text = token.text
        if token.kind is NUMBER:
            fitting_classes = (name for name, check in _CHECK_OF_UNIT.items() if check(float(text)))
            return [text, "@num", *WILDCARD_LABELS, *fitting_classes]
        if token.kind is not WORD:
            fitting_classes = (
                name for name, excluded_names in _EXCLUSIONS.items() if text not in excluded_names
            )
            own_classes = ["@close"] if text == ")" else ["@unit"] if text in "%°" else []
            return [f"s{text}", *fitting_classes, *own_classes]
        return [text, "@word", *self._classes_of_word(text)]

    def _classes_of_word(self, text: str) -> list[str]:
        kinds = [meaning.kind for meaning in lexicon().get(text, ())]
        is_own_name = text in self.variables or text in self.defs
        classes = [kind for kind in kinds if kind.islower() and not is_own_name]
        if text not in WORDS:
            classes += [_CLASSES[entry] for entry in lexicon().get(text, ()) if entry in _CLASSES]
        classes += ["@unit"] if "unit" in kinds and text not in WORDS and not is_own_name else []
        classes += ["@cross"] if text == "X" and not is_own_name else []
        if "unit" not in kinds and text not in WORDS and not is_own_name:
            classes += [f"@like_{unit_word}" for unit_word in EXTENTS if is_slip(text, unit_word)]
        concepts = [meaning.concept for meaning in self.meanings(text) if meaning.cost < NEAR_COST]
        word = text if text in WORDS else concepts[0] if concepts else ""
        classes += [ALIASES[word]] if word in ALIASES else []
        is_name = self.is_name(text)
        classes += concepts
        classes += [
            label
            for label in WILDCARD_LABELS
            if not lexicon_meaning(text, "do") or label not in _LABELS_WITHOUT_DO
        ]
        if (
            text in self.readable_names.values
            or word in ("TRUE", "FALSE", "TIME")
            or word in self.sensors
        ):
            classes.append("@val")
            classes += ["@measured"] if {word, text} & self.number_readings.keys() else []
            classes += [] if self.is_yes_no(word) or self.is_yes_no(text) else ["@amount"]
        if text in self.defs:
            def_classes = ["@defw", "@callw"] if self.takes_values(text) else ["@step", "@close"]
            classes += ["@def", "@start", "@startm", *def_classes]
        is_device = word in self.actuators or text in self.actuators
        if (word in INSTRUCTION_WORDS or is_device) and (not is_name or is_device):
            classes += ["@start", *(["@startm"] if word != "BEEP" else [])]
            classes += ["@callw"] if self.takes_values(word or text) else ["@close"]
            classes += ["@device"] if is_device else []
        if word in BLOCK_STARTS and not is_name:
            classes.append("@start")
        if "turn" in classes and not is_name:
            classes += ["@start", "@startm"]
        if word in WORD_OF_END:
            classes.append("@close")
        if text in self.variables or (text not in WORDS and not concepts):
            classes.append("@name")
            if "turn" not in classes and not re.fullmatch("[FBLRWM][0-9]+", text):
                classes += ["@newname", *(["@usedname"] if text in self.in_brackets else [])]
        return classes


def _block_counts(line: tuple[Lexeme, ...]) -> tuple[dict[str, str], list[str], int]:
    """Return the counts of block words in a line, and of headers without an end."""
    block_of_word: dict[str, str] = {}
    counted_starts: list[str] = []
    open_headers = 0
    for k, (word_before, token) in enumerate(pairwise([make_token(";"), *line])):
        pair = (
            [word_before.text, token.text]
            if lexicon_meaning(word_before.text, "end")
            else [token.text]
        )
        block = WORD_OF_END.get(lexicon_concept("_".join(pair)) or "", "")
        word = _END_PATTERN.sub("", "_".join(pair), count=1)
        if block and lexicon_concept(word) in INSTRUCTION_WORDS:
            block_of_word[word] = block
        is_called = k + 1 < len(line) and line[k + 1].text == "("
        if is_called and lexicon_meaning(token.text, "count") and lexicon_concept(token.text):
            counted_starts.append(token.text)
        open_headers += (lexicon_concept(token.text) or token.text) in BLOCK_ENDS
        open_headers -= bool(lexicon_meaning(token.text, "end") or token.text in WORD_OF_END)
    return block_of_word, counted_starts, open_headers


def joined_name(words: Iterable[str]) -> str:
    parts = [word for word in words if word != "-"]
    if parts[0][0].isdecimal():  # `2PASOS`
        return "".join((*parts[1:], parts[0]))
    return "_".join(parts)


# Classes of pieces: any token but these.
_EXCLUSIONS: dict[str, tuple[str, ...]] = {
    "@all": ("{", "}"), "@flat": ("{", "}", "(", ")"), "@any": (";", "{", "}"),
    "@cond": (";", ":", "{", "}", "?"), "@nobrace": ("{", "}", "(", ")", "<", ">"),
    "@noparen": (";", "{", "}", "(", ")"),
}  # fmt: skip
WILDCARD_LABELS = tuple(_EXCLUSIONS)
SEPARATOR_LABELS = "|".join(
    ("s;", *(name for name, excluded in _EXCLUSIONS.items() if ";" not in excluded))
)
_LABELS_WITHOUT_DO = ("@cond", "@noparen")
