"""Meanings: what each word and sign of a wrong line may stand for.

Knows the lexicons, spelling, and the names that a program has. Knows no order of words.
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
from tiniscript.syntax.blocks import ENDS
from tiniscript.syntax.lexer import DASHES, NUMBER, ODD, WORD
from tiniscript.syntax.operators import COMPARISONS, SIGNS
from tiniscript.syntax.outline import KnownNames

WORD_OF_END = ENDS
KNOWN, MISSPELT, NEAR = 1, 2, 3  # what a meaning costs: said, written nearly so, a slip away
BLOCK_STARTS = frozenset(BLOCK_ENDS) - {"DEF"}
SEPARATORS = frozenset(";|{}")
SOME_END = "FIN"  # of a block that its word does not name: what a row makes of each such end
CALL_WORDS = frozenset(word.text for word in WORDS.values() if word.is_call)
INSTRUCTION_WORDS = CALL_WORDS | {"S", "STOP", "BREAK"}
ASKING_WORDS = frozenset(("IF", "ELSEIF", "WHILE", "WHEN", "UNTIL"))

_TOKEN = re.compile(
    r"(\d+(?:\.\d+)?|(?<!\d)\.\d+)|([A-Za-zÀ-ÿ_][\wÀ-ÿ]*)"
    r"|(<=|>=|<>|==|!=|=!|=>|=<|&&|\|\||->|<-|:=|\+\+|--(?=\s*(?:$|[;)]))|\+=|-=|\*=|\S\uFE0F?)"
)
_SIGNS = SIGNS | frozenset("(),;|")
_MOST_NAME_WORDS = 4  # words of a name
# Classes by what the lexicon says of a word that is none of the language.
_CLASSES = {
    LexiconEntry("unit", "cm", "1000"): "@in_cm", LexiconEntry("unit", "cm", "100000"): "@in_m",
    LexiconEntry("unit", "s", "1000"): "@in_secs", LexiconEntry("unit", "°", "1000"): "@in_deg",
    LexiconEntry("unit", "steps", "1000"): "@in_steps", LexiconEntry("value", "%"): "@of_power",
    LexiconEntry("value", "s"): "@of_time", LexiconEntry("value", "Hz"): "@of_pitch",
    LexiconEntry("number", "1"): "@one", LexiconEntry("number", "100"): "@hundred",
}  # fmt: skip
NEAR_CM = "10"  # an example of what is near
LONG_TIME_S = 20  # so much without a unit may be a power, degrees or centimetres
MOST_POWER = 100
_EIGHTH, LAP = 45, 360  # degrees: eighths of a turn, and what is no power, are rather an angle
# Classes of numbers by what they may be.
_CHECK_OF_UNIT: dict[str, Callable[[float], bool]] = {
    "@whole": float.is_integer, "@time": lambda it: it < LONG_TIME_S,
    "@power": lambda it: LONG_TIME_S <= it <= MOST_POWER,
    "@angle": lambda it: MOST_POWER < it <= LAP or (it >= _EIGHTH and it % _EIGHTH == 0),
}  # fmt: skip
_YEAR_WORDS = ("ANO", "ANOS")  # nobody writes AÑO so
REMEMBERED_LINES = 500  # lines: each is asked for often while one program is read


class Lexeme(NamedTuple):
    """A word in capitals without accents, a number or a sign.

    `source` is how it was written, None where a repair made it; `space` stands before it, None
    where the repair's own layout counts.
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
    result, end = [], 0
    for match in _TOKEN.finditer(line):
        text, kind = match[0], NUMBER if match[1] else WORD if match[2] else ODD
        if kind is WORD:
            text = plain(text)
            if "Ñ" in match[0].upper() and not lexicon().get(text):
                other = plain(re.sub("[ñÑ]", "ni", match[0]))
                text = other if lexicon().get(other) or text in _YEAR_WORDS else text
        elif text in _SIGNS or text in DASHES:
            kind = text = "-" if text in DASHES else text
        elif lexicon_concept(text[0]):
            kind, text = WORD, text[0]  # an arrow says a command
        result.append(Lexeme(kind, text, match[0], line[end : match.start()]))
        end = match.end()
    return tuple(result)


def number_text(number: float) -> str:
    return f"{number:.3f}".rstrip("0").rstrip(".")


@cache
def made(text: str) -> Lexeme:
    """Return a token that a repair writes."""
    return lexemes(text)[0]._replace(source=None, space=None)


def texts(tokens: Iterable[Lexeme]) -> tuple[str, ...]:
    return tuple(token.text for token in tokens)


def setup_of(tokens: Sequence[Lexeme]) -> Sequence[Lexeme]:
    """Return the `SI|` that a line begins with, or nothing."""
    is_begun = texts(tokens[1:2]) == ("|",) and tokens[0].text in ("SI", "SB")
    return tokens[:2] if is_begun else tokens[:0]


def closed(tokens: Sequence[Lexeme], start: int) -> int:
    """Return where the brackets end that begin at a token, 0 where they do not."""
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
    result = (word for word in lexicon() if lexicon_meaning(word, *kinds))
    return f"(?:{'|'.join(map(re.escape, sorted(result, key=len, reverse=True)))})"


_END_PATTERN = re.compile(words_of("end") + "_?")


@cache
def _speller() -> Speller:
    return Speller([*WORDS, *lexicon()])


@lru_cache(4000)
def meanings(word: str) -> tuple[Meaning, ...]:
    """Return which words of the language a word may mean, the likeliest first."""
    if word == "SI":
        return (Meaning("IF", KNOWN),)
    if found := lexicon_concept(word):
        return (Meaning(found, KNOWN),)
    if word in WORDS or word in lexicon():
        return ()
    shortened = re.sub(r"(.)\1\1+", r"\1\1", word)  # `BEEEEEP`
    if shortened != word:
        return (Meaning(shortened, MISSPELT),) if shortened in WORDS else meanings(shortened)
    parts = word.split("_")
    if (
        len(parts) > 1
        and (kept_parts := [part for part in parts if not lexicon_meaning(part, "sensing")])
        != parts
    ):
        return meanings("_".join(kept_parts))  # `SENSOR_LUZ_DERECHA`
    if found := _sensor_with_side(parts):
        return (Meaning(found, KNOWN),)
    near_miss = _speller().find_near_miss(word)
    guesses = (
        (heard_as(word), KNOWN),
        (lexicon_concept(near_miss or ""), MISSPELT),
        (_in_two_words(word), KNOWN),
        (nearest(word, WORDS), NEAR),
    )
    return next(((Meaning(each, cost),) for each, cost in guesses if each), ())


def heard_as(word: str) -> str | None:
    """Return the word of the language that a word sounds like, which may itself mean another thing.

    Nobody calls a weight: `WEIGHT(1)` is what somebody hears who is told to write WAIT.
    """
    return lexicon_concept(_speller().find_sound_alike(word) or "")


def _sensor_with_side(parts: Sequence[str]) -> str:
    """Return the sensor that two words say: `LEFT_LIGHT`, `luzDer`, `JOYSTICK_X`."""
    splits = [(parts[0][:k], parts[0][k:]) for k in range(3, len(parts[0]) - 2)]
    pairs = [tuple(parts)] if len(parts) == 2 else splits if len(parts) == 1 else []
    for stem, side in (*pairs, *(pair[::-1] for pair in pairs)):
        sensor_stem = next((it.value for it in lexicon().get(stem, ()) if it.kind == "stem"), "")
        ways = ("X", "Y") if sensor_stem == "PAD" else ("L", "R")
        way = side if side in ways else lexicon_concept(side)
        if sensor_stem and way in ways:
            return f"{sensor_stem}_{way}"
    return ""


def meant_by(word: str) -> str | None:
    """Return the word of the language that a word of another one surely says, misspelt or not."""
    return next((meaning.concept for meaning in meanings(word) if meaning.cost < NEAR), None)


def _in_two_words(word: str) -> str | None:
    """Return what `moverAdelante` means: two words that say one command."""
    for k in range(2, min(len(word), 24) - 1):
        halves = word[:k].rstrip("_"), word[k:].lstrip("_")
        long = [half for half in halves if len(half) > 2]  # `there` is no THE RE
        texts = {half if half == "STOP" else lexicon_concept(half) or "" for half in long}
        turns = [half for half in halves if lexicon_meaning(half, "turn")]
        with_frame = halves if len(halves[1]) > 3 else halves[:1]  # `irAdelante`, and no GOAL
        filler_words = [*turns, *(half for half in with_frame if lexicon_meaning(half, "filler"))]
        commands = texts - {"", "M", "F"} or texts - {"", "M"}
        is_framed = (
            bool(texts & {"F", "M"} or filler_words) or len({*map(lexicon_concept, halves)}) == 1
        )
        are_all_known = all(
            half in filler_words or half == "STOP" or lexicon_concept(half) for half in halves
        )
        if len(commands) == 1 and is_framed and are_all_known:
            only = next(iter(commands))
            if only == "STOP" and any(lexicon_meaning(half, "engine") for half in halves):
                return "S"
            if only in (("L", "R") if turns else ("F", "B", "L", "R", "S", "STOP", "BEEP")):
                return only
    return None


class _OfLine(NamedTuple):
    """The names of one line; `rows` are those that are written as several words."""

    variables: set[str]
    defs: set[str]
    in_brackets: set[str]
    rows: set[tuple[str, ...]]
    parameters: dict[str, tuple[str, ...]]  # of each DEF: names in brackets after its own
    pairs: set[tuple[str, ...]]  # the name of a DEF, or one and those of its values
    block_starts: dict[str, str]  # orders that begin blocks, since their ends are there: PARA
    called: set[str]  # words that are an instruction alone
    compared_words: set[str]  # words beside a sign that compares them with a number
    counted_starts: list[str]  # `PARA(3)`, which begins one, where a bare end is left for it
    open_headers: int  # headers that lack an end
    units_given: set[
        tuple[str, str]
    ]  # units of what is no time, and the numbers that calls give: % 50


@lru_cache(REMEMBERED_LINES)
def _names_of(line: tuple[Lexeme, ...]) -> _OfLine:
    block_starts, counted_starts, open_headers = _block_counts(line)
    of_line = _OfLine(
        set(), set(), set(), set(), {}, set(), block_starts, _standalone_words(line),
        _compared_words(line), counted_starts, open_headers, _given(line),
    )  # fmt: skip
    head = line[2:] if len(line) > 1 and line[1].text == "|" else line
    depth = 0
    for at, (token, after) in enumerate(pairwise([*line, made(";")]), 2):
        depth += (token.text == "(") - (token.text == ")")
        if token.kind is not WORD:
            continue
        if depth > 0:
            of_line.in_brackets.add(token.text)
        elif after.text in ("=", "++", "--", "+=", "-=", ":=", "<-") and token.text not in WORDS:
            of_line.variables.add(token.text)
        is_def = "DEF" in (token.text, lexicon_concept(token.text))
        is_def = is_def or (token.text == "TASK" and at == len(line))  # a name that it needs not
        is_def = is_def or (token.text == "TO" and at == 2 and bool(_logo_names(line[at:])))
        if is_def and after.kind is WORD and after.text not in WORDS:
            if not lexicon_meaning(after.text, "main") and lexicon_concept(after.text) != "START":
                of_line.defs.add(after.text)
                if bare_values := _bare_values(line[at:]):
                    of_line.pairs.add((after.text, *bare_values))
                end = closed(line, at)
                names_given = texts(line[at + 1 : end - 1 : 2]) if end else _logo_names(line[at:])
                if all(item.isidentifier() and item not in WORDS for item in names_given):
                    of_line.parameters[after.text] = names_given
    if len(head) > 2 and "DEF" in (head[0].text, lexicon_concept(head[0].text)):
        row, names = _name_in_words(head[1:], ";"), of_line.defs
    else:
        row, names = _name_in_words(head, "="), of_line.variables
    if row:
        of_line.rows.add(row)
        names.add(joined_name(row))
    return of_line


def _given(line: tuple[Lexeme, ...]) -> set[tuple[str, str]]:
    """Return the powers and the pitches that calls of a line give as plain numbers, by unit."""
    rows = zip(line, line[1:], line[2:], line[3:], line[4:], line[5:], strict=False)
    return {
        (WORDS[word.text].arguments[1].unit, value.text)
        for word, is_open, _, comma, value, is_closed in rows
        if (is_open.text, comma.text, is_closed.text) == ("(", ",", ")") and value.kind is NUMBER
        if word.text in CALL_WORDS and word.text != "M" and len(WORDS[word.text].arguments) > 1
    }


def _bare_values(tokens: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return the names of `X, Y` or `X Y`, which lack their brackets, none beside other things."""
    row = " ".join(texts(tokens)).partition(";")[0]
    names = tuple(row.replace(",", " ").split())
    return names if all(name.isidentifier() and name not in WORDS for name in names) else ()


def _logo_names(tokens: Sequence[Lexeme]) -> tuple[str, ...]:
    """Return the names of `:SIZE :SPEED`, none where anything else is there."""
    signs, names = texts(tokens[::2]), texts(tokens[1::2])
    return names if {*signs} == {":"} and len(signs) == len(names) else ()


def _standalone_words(line: tuple[Lexeme, ...]) -> set[str]:
    """Return words that stand alone between separators."""
    around = (";", *texts(line), ";")
    triples = zip(around, around[1:], around[2:], strict=False)
    return {word for before, word, after in triples if before in ";|" and after == ";"}


def _compared_words(line: tuple[Lexeme, ...]) -> set[str]:
    """Return words that are compared with a number, as nothing but a value is."""
    rows = [*zip(line, line[1:], line[2:], line[3:], strict=False)]
    lone_words = {
        name.text
        for head, before, name, after in rows
        if (before.text, after.text) == ("(", ")") and name.kind is head.kind is WORD
        if name.text not in lexicon() and (lexicon_concept(head.text) or head.text) in ASKING_WORDS
    }
    return lone_words | {
        name.text
        for before, one, sign, other in rows
        for name, number in ((one, other), (other, one))
        if sign.text in COMPARISONS - {"="} and name.kind is WORD and number.kind is NUMBER
        if before.text not in SEPARATORS
    }


def _name_in_words(tokens: Sequence[Lexeme], after: str) -> tuple[str, ...]:
    """Return a name of several words that ends before `after`: `mi vel = 5`, `DEF paso 1`."""
    row: list[str] = []
    is_glued = after == ";" and len(tokens) > 1 and tokens[1].kind is WORD and tokens[1].space == ""
    for token in tokens[: _MOST_NAME_WORDS + 1]:
        text = token.text
        if (
            token.kind not in (WORD, NUMBER, "-")
            or text in BLOCK_STARTS
            or text in INSTRUCTION_WORDS
        ):
            break
        if not row and (lexicon_meaning(text, "count") or (token.kind is NUMBER and not is_glued)):
            break
        is_reserved = (
            text in WORDS or lexicon_meaning(text, "declare") or lexicon_meaning(text, "set")
        )
        if token.kind is WORD and is_reserved and len(row) != 1:
            break
        row.append(text)
    ends = tokens[len(row)].text if len(tokens) > len(row) else ";"
    is_long_name = len(row) > 1 and ends == after and row[0] not in WORDS and row[-1] != "-"
    return tuple(row) if is_long_name else ()


class Names:
    """The names of one program, by a look at its tokens; `label` is what rewrites match."""

    def __init__(self, lines: Sequence[Sequence[Lexeme]], kit: Kit) -> None:
        readings = [reading for reading in kit.readings if reading.name]
        self.sensors = frozenset(reading.name for reading in readings)
        self.measuring = tuple(sorted(sensor.name for sensor in kit.sensors))
        self.asked = {reading.name: reading for reading in readings if not reading.is_yes_no}
        self.actuators = {actuator.name: actuator for actuator in kit.actuators}
        of_lines = [_names_of(tuple(line)) for line in lines]
        self.in_brackets = {name for line in of_lines for name in line.in_brackets}
        self.rows = {row for line in of_lines for row in line.rows}
        self.parameters = {
            k: parameters_of_def
            for line in of_lines
            for k, parameters_of_def in line.parameters.items()
        }
        for pair in {pair for line in of_lines for pair in line.pairs}:
            if self.in_brackets.issuperset(pair[1:]):  # `DEF LADO X`, and `F(X, 50)` below
                self.parameters[pair[0]] = pair[1:]
                self.rows.discard(pair)
        self.begun = {word: block for line in of_lines for word, block in line.block_starts.items()}
        if sum(line.open_headers for line in of_lines) < 0:
            self.begun |= {word: "LOOP" for line in of_lines for word in line.counted_starts}
        self.variables = {name for line in of_lines for name in line.variables}
        self.variables.update(chain.from_iterable(self.parameters.values()))
        self.defs = {name for line in of_lines for name in line.defs} - {
            row[0] for row in self.rows
        }
        units_and_numbers = {pair for line in of_lines for pair in line.units_given}
        units = [unit for unit, _ in units_and_numbers]
        self.usual = {unit: text for unit, text in units_and_numbers if units.count(unit) == 1}
        self.called = frozenset(self.defs & {word for line in of_lines for word in line.called})
        counts = {name: len(self.parameters.get(name, ())) for name in self.defs}
        defs_without_values = {name for name, count in counts.items() if not count}
        calls = {*counts.items(), *((name, 1) for name in self.actuators)}
        values, instructions = self.sensors | self.variables, self.sensors | defs_without_values
        self.known = KnownNames(frozenset(values), instructions, frozenset(calls))
        # What nobody knows, and is compared, is no reason not to read what is around it.
        compared_names = {
            name for line in of_lines for name in line.compared_words if name not in WORDS
        }
        word_of_name = {name: self.meant(name, NEAR) for name in compared_names - values}
        self.strange = {
            name for name, concept in word_of_name.items() if not concept or concept in CALL_WORDS
        }
        self.read_as = self.known._replace(values=frozenset(values | self.strange))
        words = (frozenset(item) for item in (self.defs, self.in_brackets, self.rows))
        self._content = (
            self.read_as,
            *words,
            self.called,
            frozenset(self.begun.items()),
            frozenset(self.usual.items()),
            kit.actuators,
        )
        self._labels: dict[tuple[str, str, bool], str] = {}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Names) and self._content == other._content

    def __hash__(self) -> int:
        return hash(self._content)

    def is_name(self, word: str) -> bool:
        return word in self.known.values or word in self.defs or word in self.actuators

    def is_yes_no(self, word: str) -> bool:
        """Whether a word is a yes or a no by itself, which nothing is compared with."""
        return word in ("TRUE", "FALSE") or (word in self.sensors and word not in self.asked)

    def meanings(self, word: str) -> tuple[Meaning, ...]:
        """Return what a word that is no name of the program may mean."""
        if self.is_name(word):
            return ()
        if word in self.begun:
            return (Meaning(self.begun[word], KNOWN),)
        end, _, block = word.partition("_")
        if lexicon_meaning(end, "end") and block in (*WORDS, *self.defs):
            return (Meaning(SOME_END, KNOWN),)
        if concept := self.sided(word) or self._lamp(word):
            return (Meaning(concept, KNOWN),)
        result = meanings(word)
        return tuple(
            meaning for meaning in result if meaning.concept in WORDS or self.has(meaning.concept)
        )

    def sided(self, word: str) -> str:
        """Return the sensor of a side that `SENSOR_L` says, "" for none."""
        parts = word.split("_")
        kept_parts = [part for part in parts if not lexicon_meaning(part, "sensing")]
        if len(kept_parts) != 1 or len(parts) == 1:
            return ""
        side = "".join(lexicon_meaning(kept_parts[0], "left", "right"))[:1].upper()
        return self.on_side(side or lexicon_concept(kept_parts[0]) or kept_parts[0])

    def _lamp(self, word: str) -> str:
        """Return the lamp that a word for light says of a robot which sees none."""
        is_light = lexicon_meaning(word, "stem") == ("LIGHT",) and "LED" in self.actuators
        return "LED" * (is_light and not any(it.startswith("LIGHT_") for it in self.sensors))

    def on_side(self, side: str) -> str:
        """Return the one sensor of the robot on L or R, "" for none or several."""
        sensors = [name for name in self.sensors if name.endswith(f"_{side}")]
        return sensors[0] if len(sensors) == 1 and side in ("L", "R") else ""

    def meant(self, word: str, most_cost: int = MISSPELT) -> str:
        """Return the word of the language that a word means, "" for none or a less likely one."""
        if word in WORDS and word != "SI":
            return word
        result = self.meanings(word)
        return result[0].concept if result and result[0].cost <= most_cost else ""

    def has(self, concept: str) -> bool:
        """Whether a concept is a device of the kit, or the end of any block."""
        return concept in self.sensors or concept in self.actuators or concept == SOME_END

    def takes_values(self, word: str) -> bool:
        """Whether a word is an instruction with values in brackets."""
        return word in CALL_WORDS or word in self.actuators or bool(self.parameters.get(word))

    def label(self, token: Lexeme) -> str:
        """Return all classes of a token, as one text that a pattern finds them in."""
        is_glued = token.space == "" or token.text in EXTENTS
        is_unit_position = (
            is_glued and token.text in WORDS and lexicon_meaning(token.text, "unit")
        )  # `5S`, `5 CM`
        key = (token.kind, token.text, bool(is_unit_position))
        if key not in self._labels:
            classes = [*self._classes(token), *(["@unit"] if is_unit_position else [])]
            self._labels[key] = f"\x01|{'|'.join(dict.fromkeys(classes))}|\x02"
        return self._labels[key]

    def _classes(self, token: Lexeme) -> list[str]:
        text = token.text
        if token.kind is NUMBER:
            fitting = (name for name, fits in _CHECK_OF_UNIT.items() if fits(float(text)))
            return [text, "@num", *ANY_LABELS, *fitting]
        if token.kind is not WORD:
            fitting = (name for name, without in _EXCLUSIONS.items() if text not in without)
            own = ["@close"] if text == ")" else ["@unit"] if text in "%°" else []
            return [f"s{text}", *fitting, *own]
        return [text, "@word", *self._classes_of_word(text)]

    def _classes_of_word(self, text: str) -> list[str]:
        texts = [meaning.kind for meaning in lexicon().get(text, ())]
        is_own_name = text in self.variables or text in self.defs
        classes = [item for item in texts if item.islower() and not is_own_name]
        if text not in WORDS:
            classes += [_CLASSES[item] for item in lexicon().get(text, ()) if item in _CLASSES]
        classes += ["@unit"] if "unit" in texts and text not in WORDS and not is_own_name else []
        classes += ["@cross"] if text == "X" and not is_own_name else []
        if "unit" not in texts and text not in WORDS and not is_own_name:
            classes += [f"@like_{way}" for way in EXTENTS if is_slip(text, way)]
        meant = [meaning.concept for meaning in self.meanings(text) if meaning.cost < NEAR]
        word = text if text in WORDS else meant[0] if meant else ""
        classes += [ALIASES[word]] if word in ALIASES else []
        is_name = self.is_name(text)
        classes += meant
        classes += [
            item
            for item in ANY_LABELS
            if not lexicon_meaning(text, "do") or item not in _LABELS_WITHOUT_DO
        ]
        if text in self.read_as.values or word in ("TRUE", "FALSE", "TIME") or word in self.sensors:
            classes.append("@val")
            classes += ["@measured"] if {word, text} & self.asked.keys() else []
            classes += [] if self.is_yes_no(word) or self.is_yes_no(text) else ["@amount"]
        if text in self.defs:
            own = ["@defw", "@callw"] if self.takes_values(text) else ["@step", "@close"]
            classes += ["@def", "@start", "@startm", *own]
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
        if text in self.variables or (text not in WORDS and not meant):
            classes.append("@name")
            if "turn" not in classes and not re.fullmatch("[FBLRWM][0-9]+", text):
                classes += ["@newname", *(["@usedname"] if text in self.in_brackets else [])]
        return classes


def _block_counts(line: tuple[Lexeme, ...]) -> tuple[dict[str, str], list[str], int]:
    """Return what a line says of orders that begin blocks, and how many headers lack an end."""
    block_of_word: dict[str, str] = {}
    counted_starts: list[str] = []
    open_headers = 0
    for k, (one, other) in enumerate(pairwise([made(";"), *line])):
        pair = [one.text, other.text] if lexicon_meaning(one.text, "end") else [other.text]
        block = WORD_OF_END.get(lexicon_concept("_".join(pair)) or "", "")
        word = _END_PATTERN.sub("", "_".join(pair), count=1)
        if block and lexicon_concept(word) in INSTRUCTION_WORDS:
            block_of_word[word] = block
        is_called = k + 1 < len(line) and line[k + 1].text == "("
        if is_called and lexicon_meaning(other.text, "count") and lexicon_concept(other.text):
            counted_starts.append(other.text)
        open_headers += (lexicon_concept(other.text) or other.text) in BLOCK_ENDS
        open_headers -= bool(lexicon_meaning(other.text, "end") or other.text in WORD_OF_END)
    return block_of_word, counted_starts, open_headers


def joined_name(row: Iterable[str]) -> str:
    parts = [item for item in row if item != "-"]
    if parts[0][0].isdecimal():  # `2PASOS`
        return "".join((*parts[1:], parts[0]))
    return "_".join(parts)


# Classes of pieces: any token but these.
_EXCLUSIONS: dict[str, tuple[str, ...]] = {
    "@all": ("{", "}"), "@flat": ("{", "}", "(", ")"), "@any": (";", "{", "}"),
    "@cond": (";", ":", "{", "}", "?"), "@nobrace": ("{", "}", "(", ")", "<", ">"),
    "@noparen": (";", "{", "}", "(", ")"),
}  # fmt: skip
ANY_LABELS = tuple(_EXCLUSIONS)
SEPARATOR = "|".join(("s;", *(name for name, without in _EXCLUSIONS.items() if ";" not in without)))
_LABELS_WITHOUT_DO = ("@cond", "@noparen")
