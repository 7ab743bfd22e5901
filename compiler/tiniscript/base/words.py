"""The table of words: the meaning of each word of the language, and its arguments.

Knows names, argument counts, ranges and units. Does not know how they are compiled. Ranges are
thousandths. The words of a kit (its sensors and actuators) come from `kit`, not from here.
`lexicon` has the meanings of people's words, from the folder of each language.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import NamedTuple

from tiniscript.base.fixed_point import HIGHEST, LOWEST, ONE
from tiniscript.base.languages import SOURCE_LANGUAGE, languages, read_language_file


class Argument(NamedTuple):
    """The meaning of an argument, and of a plain number in its place."""

    name: str
    unit: str
    low: int = LOWEST
    high: int = HIGHEST
    sample: str = "1"

    @property
    def whole_limits(self) -> tuple[int, int] | None:
        """The whole numbers to which a robot rounds and limits it; None: it does not."""
        if self.low == LOWEST or self.high == HIGHEST:
            return None
        return self.low // ONE, self.high // ONE


class Role(NamedTuple):
    """The purpose of a word. Stages use these fields, or have their own table by role name."""

    name: str
    is_instruction: bool = False  # a robot does something at it
    has_duration: bool = False  # whether it lasts for a time, or until a condition is true
    is_move: bool = False  # whether it has a power, and a time or a distance
    takes_time: bool = False  # the next instruction comes after the time among its values
    belongs_to_blocks: bool = False
    belongs_to_values: bool = False
    can_start_item: bool = True  # whether it can be the start of something in a line
    is_offered: bool = True  # no other spelling, and no word of later versions


class Word(NamedTuple):
    """A word with the role `fixed` stands for instructions, `BEEP(0.5, 440)`.

    If the word takes values, their names appear there, each exactly once and as a whole value:
    `LOOP(N);L(0.2, 60);R(0.2, 60);END_LOOP`.
    """

    text: str
    role: Role
    arguments: tuple[Argument, ...] = ()
    expansion: str = ""

    @property
    def has_tone(self) -> bool:
        """Return whether it has a time and a frequency, in this order."""
        return self.arguments == (SECONDS, HERTZ)

    @property
    def is_call(self) -> bool:
        """Return whether it is an instruction with values in brackets."""
        return self.role.is_instruction and bool(self.arguments)

    @property
    def usage(self) -> str:
        """`F(time, power)`, as messages print it."""
        names = ", ".join(argument.name for argument in self.arguments)
        return f"{self.text}({names})" if names else self.text

    @property
    def example(self) -> str:
        """`F(2, 80)`, as messages suggest it."""
        samples = ", ".join(argument.sample for argument in self.arguments)
        return f"{self.text}({samples})" if samples else self.text


# fmt: off
ROLES = {role.name: role for role in (
    Role("move", is_instruction=True, has_duration=True, is_move=True, takes_time=True),
    Role("wait", is_instruction=True, has_duration=True, takes_time=True),
    Role("beep", is_instruction=True, takes_time=True),
    *(Role(name, is_instruction=True) for name in ("motors", "show", "stop", "fixed")),
    *(Role(name, belongs_to_blocks=True) for name in ("block", "arm", "end")),
    *(Role(name, belongs_to_values=True, can_start_item=False) for name in ("value", "operator", "function")),
    *(Role(name, is_offered=False) for name in ("alias", "later")),
    Role("setup", can_start_item=False), *map(Role, ("start", "until", "forever", "break", "unit", "actuator")),
)}

SECONDS = Argument("seconds", "s", 0)
TIME = Argument("time", "s", 0, sample="2")
POWER = Argument("power", "%", 0, 100_000, "80")
# Distances that may replace a move's time, by the unit after them.
EXTENTS = {"CM": Argument("distance", "cm", 0, sample="20 CM"), "DEG": Argument("angle", "°", 0, sample="90 DEG")}
UNIT_OF = {"F": "CM", "B": "CM", "L": "DEG", "R": "DEG"}
LEFT = Argument("left", "%", -100_000, 100_000, "50")
RIGHT = Argument("right", "%", -100_000, 100_000, "80")
HERTZ = Argument("hertz", "Hz", 31_000, 20_000_000, "440")
VALUE = Argument("value", "", sample="DISTANCE")
CONDITION = Argument("c", "", sample="DISTANCE < 10")
A, B = Argument("a", "", sample="5"), Argument("b", "", sample="DISTANCE")
LOW, HIGH = Argument("low", "", sample="1"), Argument("high", "", sample="6")


def _row(text: str, role: str, arguments: tuple[Argument, ...] = (), expansion: str = "") -> Word:
    return Word(text, ROLES[role], arguments, expansion)


WORDS = {word.text: word for word in (
    _row("PING", "setup"), _row("SI", "setup"), _row("SB", "setup"), _row("CHECK_CONNECTION", "setup"),
    _row("F", "move", (TIME, POWER)), _row("B", "move", (TIME, POWER)),
    _row("L", "move", (TIME, POWER)), _row("R", "move", (TIME, POWER)),
    _row("W", "wait", (SECONDS,)),
    _row("M", "motors", (LEFT, RIGHT)),
    _row("S", "stop"), _row("STOP", "stop"), _row("START", "start"),
    _row("BEEP", "beep", (SECONDS, HERTZ)),
    _row("SHOW", "show", (VALUE,)),
    _row("UNTIL", "until", (CONDITION,)), _row("FOREVER", "forever"),
    _row("IF", "block", (CONDITION,)), _row("ELSEIF", "arm", (CONDITION,)), _row("ELSE", "arm"),
    _row("ENDIF", "end"),
    _row("LOOP", "block", (Argument("n", "", sample="3"),)), _row("END_LOOP", "end"),
    _row("WHILE", "block", (Argument("c", "", sample="DISTANCE > 10"),)), _row("END_WHILE", "end"),
    _row("BREAK", "break"),
    _row("DEF", "block"), _row("END_DEF", "end"),
    _row("TASK", "block"), _row("END_TASK", "end"),
    _row("WHEN", "block", (Argument("c", "", sample="DISTANCE < 15"),)), _row("END_WHEN", "end"),
    _row("TRUE", "value"), _row("FALSE", "value"), _row("TIME", "value"),
    _row("AND", "operator"), _row("OR", "operator"), _row("NOT", "operator"),
    _row("ROUND", "function", (VALUE, Argument("decimals", ""))),
    _row("ABS", "function", (A,)), _row("MIN", "function", (A, B)), _row("MAX", "function", (A, B)),
    _row("RANDOM", "function", (LOW, HIGH)),
    _row("END_IF", "alias"), _row("ENDLOOP", "alias"), _row("ENDWHILE", "alias"), _row("ENDDEF", "alias"),
    _row("ENDTASK", "alias"), _row("ENDWHEN", "alias"),
    _row("CM", "unit"), _row("DEG", "unit"),
    _row("SEND", "later"),
)}

MOVES = tuple(word.text for word in WORDS.values() if word.role.is_move)
FUNCTIONS = tuple(word.text for word in WORDS.values() if word.role.name == "function")
ALIASES = {
    "END_IF": "ENDIF", "ENDLOOP": "END_LOOP", "ENDWHILE": "END_WHILE", "ENDDEF": "END_DEF",
    "ENDTASK": "END_TASK", "ENDWHEN": "END_WHEN",
}
BLOCK_ENDS = {
    "IF": "ENDIF", "LOOP": "END_LOOP", "WHILE": "END_WHILE", "DEF": "END_DEF",
    "TASK": "END_TASK", "WHEN": "END_WHEN",
}
# Names and signs, in the order of their numbers in instructions.
COMPARATORS = ("EQ", "="), ("NE", "<>"), ("LT", "<"), ("LE", "<="), ("GT", ">"), ("GE", ">=")
# Words that are younger than 0.2: a program of then may use one as a name.
VERSION_OF_WORD = dict.fromkeys(
    ("CM", "DEG", "TASK", "WHEN", "END_TASK", "END_WHEN", "ENDTASK", "ENDWHEN"), "0.3"
)
TASKS = ("TASK", "WHEN")  # blocks that run beside the rest of the program

OPPOSITE_MOVES = {"F": "B", "B": "F", "L": "R", "R": "L"}  # the moves, and those that undo them
# Features of other languages that this one lacks: pins, jumps, clocks, with their replacements.
_REPLACEMENT_HINTS = {"pins": "F(2, 80)", "jump": "LOOP(FOREVER)", "every": "LOOP(FOREVER)", "leaves": "END_DEF"}

# fmt: on


class LexiconEntry(NamedTuple):
    """A lexicon entry: `kind` is a word of TiniScript, or the kind of its `value`.

    A unit also has the number of its thousandths: `unit s 60000`.
    """

    kind: str
    value: str = ""
    scale: str = ""


@cache
def lexicon() -> dict[str, list[LexiconEntry]]:
    """Return the meanings of each word in all languages, English last."""
    entries_by_word: dict[str, list[LexiconEntry]] = {}
    for language in (*languages()[1:], SOURCE_LANGUAGE):
        for row in read_language_file(language, "lexicon.txt").split("\n"):
            if not row.startswith("#"):
                meaning, _, words = row.partition("|")
                for word in words.split():
                    entries_by_word.setdefault(word, []).append(LexiconEntry(*meaning.split()))
    return entries_by_word


@lru_cache(4000)
def lexicon_meaning(word: str, *kinds: str) -> tuple[str, ...]:
    """Return the lexicon values of a word for these kinds: `("s", "1000")` for SEG, `unit`."""
    for kind, value, scale in lexicon().get(word, ()):
        if kind in kinds:
            return (value, scale) if scale else (value or kind,)
    return ()


def expand_short(word: str) -> list[str]:
    """Return the commands that a word is short for in some language: E for W, and for L."""
    return [entry.value for entry in lexicon().get(word, ()) if entry.kind == "short"]


def lexicon_concept(word: str) -> str | None:
    """Return the word of the language or of a kit that the lexicon says a word for."""
    for kind, value, _ in lexicon().get(word, ()):
        if kind.isupper() and not value:
            return kind
    return None


def names_argument(word: str, argument: Argument) -> bool:
    """Return whether a word is a usual name of an argument: POTENCIA, VEL, T."""
    meaning = lexicon_meaning(word, "value") or lexicon_meaning(word, "letter")
    return meaning[:1] == (argument.name if argument in (LEFT, RIGHT) else argument.unit,)


def foreign_word_hints(word: str) -> dict[str, str]:
    """Return the message for a word of another language without an equivalent here."""
    if word.startswith("MOTOR"):
        return {"motors": "M(left, right)"}
    return {kind: hint for kind, hint in _REPLACEMENT_HINTS.items() if lexicon_meaning(word, kind)}


def other_name(word: str) -> str:
    """Return a name that a variable or a DEF may have in place of a word of the language."""
    return word + "_1"
