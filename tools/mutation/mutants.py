"""Breaks of the C++ machine: small mistakes that someone could make in it, one at a time.

Knows where in `vm_arduino/src/vm` an opcode is read, a rule or a reason refuses, a limit is used
and arithmetic rounds. A place is found by its text; where that text is no longer there, `Stale`
says which entry of this file to mend: no break is left out silently.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from tiniscript.bytecode.image import REFUSALS
from tiniscript.bytecode.opcodes import BY_NAME, OPS, PUSHED, Op
from tiniscript.bytecode.verify import RULES

MACHINE = Path("src/vm")
COPIED = ("steps.h", "arithmetic.h")  # headers with code that is copied into the machine
SHORT_LINE = 24


def has_code(file: str) -> bool:
    return file.endswith(".cpp") or file in COPIED


class Break(NamedTuple):
    """One file of the machine, with its text broken: the line that was, and what it becomes."""

    kind: str
    name: str
    file: str
    text: str
    was: str
    becomes: str


class Stale(Exception):
    """The machine was rewritten: a place that is to be broken is not there."""


def breaks(sources: Path) -> list[Break]:
    """Return the breaks of a folder like `vm_arduino`."""
    texts = {
        path.name: path.read_text(encoding="utf-8")
        for path in sorted((sources / MACHINE).glob("*.[ch]*"))
    }
    found = [
        *opcode_breaks(texts),
        *refusal_breaks(texts, "rule", "Rule", [*RULES]),
        *refusal_breaks(texts, "refusal", "Refusal", [*REFUSALS]),
        *limit_breaks(texts),
        *range_breaks(texts),
        *named_breaks(texts),
    ]
    return found


def broken(
    kind: str, name: str, file: str, texts: dict[str, str], start: int, end: int, instead: str
) -> Break:
    """Return the break that puts something else from `start` to `end`."""
    text = texts[file]
    first, last = text.rfind("\n", 0, start) + 1, text.find("\n", end)
    if last - first < SHORT_LINE:  # it says little: with its neighbours
        first = text.rfind("\n", 0, max(first - 1, 0)) + 1
        last = text.find("\n", last + 1)
    was, becomes = text[first:last], text[first:start] + instead + text[end:last]
    whole = text[:start] + instead + text[end:]
    return Break(kind, name, file, whole, " ".join(was.split()), " ".join(becomes.split()))


def read(sources: Path) -> dict[str, str]:
    """Return the text of each file of the machine."""
    files = sorted((sources / MACHINE).glob("*.[ch]*"))
    return {path.name: path.read_text(encoding="utf-8") for path in files}


# -- opcodes ------------------------------------------------------------------------------------

# Where the machine reads an opcode. The break stands behind it: this one opcode is another.
OPCODE_IS_READ = re.compile(r"const (uint8_t code = \*bytes;)")

# What each instruction does when it is broken: what another one of its size and its stack does, if
# there is one, and the one that is hardest to tell from it.
TWINS = {
    "END": "STOP", "PUSH8": "PUSH_VAR", "PUSH16": "PUSH_MILLI", "PUSH_MILLI": "PUSH16",
    "PUSH32": "PUSH16", "PUSH_TENTHS": "PUSH8", "PUSH_FALSE": "PUSH_TRUE",
    "PUSH_TRUE": "PUSH_FALSE",
    "PUSH_VAR": "PUSH_SENSOR", "PUSH_SENSOR": "PUSH_READ", "PUSH_READ": "PUSH_SENSOR",
    "TIME": "PUSH_FALSE", "RANDOM": "MIN", "ADD": "SUB", "SUB": "ADD", "MUL": "DIV", "DIV": "MUL",
    "MOD": "MIN", "NEG": "ABS", "ABS": "NEG", "MIN": "MAX", "MAX": "MIN", "ROUND": "MAX",
    "EQ": "LE", "NE": "LT", "LT": "LE", "LE": "LT", "GT": "GE", "GE": "GT", "NOT": "ABS",
    "AND": "MIN", "OR": "MAX", "AND_THEN": "OR_ELSE", "OR_ELSE": "AND_THEN", "SET_VAR": "SET",
    "SET_VAR8": "ADD_VAR8", "ADD_VAR8": "SET_VAR8", "ADD_VAR": "ADD_VAR8", "INC_VAR": "DEC_VAR",
    "DEC_VAR": "INC_VAR", "READ": "WHILE",
    "SHOW": "SHOW_YES_NO", "SHOW_YES_NO": "SHOW", "SET": "SET_VAR", "WAIT": "WATCH_WAIT",
    "WAIT8": "WHILE", "WATCH_WAIT": "WAIT", "WATCH_FOREVER_WAIT": "FOREVER", "UNTIL": "SHOW",
    "STOP": "FOREVER", "MOTORS": "WATCH_F", "MOTORS8": "MOVE8_F", "BEEP": "WATCH_F",
    "BEEP8": "IF_VAR8_EQ",
    "IF": "IF_NOT", "IF_NOT": "IF", "ELSE": "WHILE", "FOREVER": "STOP", "WHILE": "ELSE",
    "AGAIN": "WHILE", "LOOP8": "WAIT8", "LOOP": "IF", "NEXT": "AGAIN", "BREAK": "WHILE",
    "BREAK_LOOP": "BREAK", "DEF": "WHILE", "RETURN": "FOREVER", "CALL": "AGAIN",
}  # fmt: skip
TWINS |= {
    f"{what}_{way}": f"{what}_{other}"
    for what in ("MOVE", "MOVE8", "WATCH", "WATCH_FOREVER")
    for way, other in zip("FBLR", "BFRL", strict=True)
}


def twins(op: Op) -> Iterator[str]:
    """Yield the instructions that one is taken for."""
    near = op.name.removesuffix("_FAR")
    _, _, last = op.name.rpartition("_")
    if near in TWINS:
        yield TWINS[near] + op.name.removeprefix(near)
    elif op.implied is not None:  # for its neighbour, and for another one with the same operand
        yield f"{op.family}_{op.implied.value ^ 1}"
        if f"{TWINS[op.family]}_{last}" in BY_NAME:
            yield f"{TWINS[op.family]}_{last}"
    elif op.family == "PUSH_NUM":
        yield f"PUSH_NUM_{PUSHED[PUSHED.index(int(last)) - 1]}"
    elif op.name != op.family and last in TWINS:  # a comparator
        yield op.name.removesuffix(last) + TWINS[last]
    else:
        raise Stale(f"breaks.py, TWINS: {op.name} is taken for nothing")


def opcode_breaks(texts: dict[str, str]) -> Iterator[Break]:
    simple = _only_place(texts, OPCODE_IS_READ, "OPCODE_IS_READ")
    for op in OPS:
        file, place = simple
        for twin in twins(op):
            taken_for = f"if (code == {op.code}) code = {BY_NAME[twin].code};"
            name, instead = f"{op.name} does what {twin} does", f"{place[1]} {taken_for}"
            yield broken("opcode", name, file, texts, place.start(), place.end(), instead)


def _only_place(
    texts: dict[str, str], pattern: re.Pattern[str], entry: str
) -> tuple[str, re.Match[str]]:
    found = [
        (file, place)
        for file, text in texts.items()
        if has_code(file)
        for place in pattern.finditer(text)
    ]
    if len(found) != 1:
        raise Stale(f"breaks.py, {entry} stands in {len(found)} places, not in one")
    return found[0]


# -- what is refused ----------------------------------------------------------------------------


def refusal_breaks(
    texts: dict[str, str], kind: str, enum: str, names: list[str]
) -> Iterator[Break]:
    """Yield two breaks for each place that refuses: it never does, or for another reason."""
    others = [*names[1:], names[0]]
    constants = {camel(name): camel(other) for name, other in zip(names, others, strict=True)}
    seen = dict.fromkeys(constants, 0)
    for file, text in texts.items():
        if not has_code(file):
            continue
        for place in re.finditer(rf"\b{enum}::(k\w+)", blanked(text)):
            if place[1] == "kNone":
                continue
            seen[place[1]] += 1
            where = f"{file}, {place[1]} no. {seen[place[1]]}"
            for instead, what in (("kNone", "never refuses"), (constants[place[1]], "")):
                name = f"{where} {what or 'says ' + instead}"
                yield broken(kind, name, file, texts, place.start(1), place.end(1), instead)
    for constant, places in seen.items():
        if not places:
            raise Stale(f"breaks.py, {enum}::{constant} refuses nowhere in {MACHINE}/*.cpp")


def camel(name: str) -> str:
    """Return the name of a constant in C++: `kBadTarget` for BAD_TARGET."""
    return "k" + "".join(word.capitalize() for word in name.split("_"))


# -- limits -------------------------------------------------------------------------------------

LIMITS = ("kCodeBytes", "kStackValues", "kVariables", "kCounters", "kCalls", "kDefs", "kNestWords",
          "kJoins", "kDevices", "kCheckMs", "kHeaderBytes", "kStarts", "kIsaMajor",
          "kIsaMinor")  # fmt: skip
# The row of an operand: its least value, and how much more it may be.
RANGES = re.compile(r"kRanges\[\]\[2\] tini_progmem = \{\n(.*?)\n\};", re.S)
RANGE = re.compile(r"\{(\d+), (\d+)\},  // (\w+)")


def limit_breaks(texts: dict[str, str]) -> Iterator[Break]:
    """Yield each limit one more or less, everywhere; and at each place where it is used."""
    header = texts["bytecode.h"]
    for limit in LIMITS:
        place = re.search(rf"\b{limit} = (\d+);", header)
        if place is None:
            raise Stale(f"breaks.py, LIMITS: bytecode.h does not say what {limit} is")
        for delta in (1, -1):
            number = int(place[1]) + delta
            if number < 0:
                continue
            name, at = f"{limit} is {number}", place.span(1)
            yield broken("limit", name, "bytecode.h", texts, *at, str(number))
        for file, text in texts.items():
            if not has_code(file):
                continue
            for count, use in enumerate(re.finditer(rf"\b{limit}\b", blanked(text)), 1):
                if _is_size_of_array(text, use.end()):
                    continue
                for sign in "+-":
                    name = f"{file}, {limit} {sign} 1, no. {count}"
                    instead = f"({limit} {sign} 1)"
                    yield broken("limit", name, file, texts, use.start(), use.end(), instead)


def range_breaks(texts: dict[str, str]) -> Iterator[Break]:
    """Yield each range of operands one longer or shorter, at both of its ends."""
    header = texts["bytecode.cpp"]
    table = RANGES.search(header)
    if table is None:
        raise Stale("breaks.py, RANGES: bytecode.cpp has no such table")
    for row in RANGE.finditer(header, *table.span(1)):
        for place, end in ((1, "begins"), (2, "is long")):
            for delta in (1, -1):
                number = int(row[place]) + delta
                if int(row[2]) < 255 and 0 <= number <= 255:
                    name = f"the range of {row[3]} {end} {number}"
                    at = row.span(place)
                    yield broken("limit", name, "bytecode.cpp", texts, *at, str(number))


def _is_size_of_array(text: str, end: int) -> bool:
    """Whether what ends there is the size of a list: more of it does no harm."""
    return re.match(r"( \+ 1)?\];", text[end:]) is not None


# -- arithmetic, time and the robot -------------------------------------------------------------

# name, what is there, what is there instead. Each is found in exactly one place.
NAMED = (
    ("a program catches up with one ms more", r"kLateMs = 20", "kLateMs = 21"),
    ("a program catches up with one ms less", r"kLateMs = 20", "kLateMs = 19"),
    ("a hundredth has 11 ms", r"time \* 10\)", "time * 11)"),
    ("there are 99 hundredths", r"time < 100", "time < 99"),
    ("tenths begin at 0.9 s", r"time - 90", "time - 91"),
    ("there are 99 tenths", r"time < 200", "time < 199"),
    ("whole seconds begin at 10", r"time - 189", "time - 190"),
    ("tens begin at 10", r"n - 9\) \* 10", "n - 10) * 10"),
    ("a half is not rounded up", r"(remainder) >= (divisor -)", r"\1 > \2"),
    ("what is below a half is rounded up", r"(remainder) >= (divisor -)", r"\1 + 1 >= \2"),
    ("ROUND cuts off", r"scaled\((magnitude\(pair\[0\]\), 1, unit)\)", r"divided(\1).quotient"),
    ("ROUND has a unit too few", r"k < 3; k", "k < 2; k"),
    ("a quotient that is too large is cut off", r"quotient > 0xffffffff", "quotient == 0"),
    ("xorshift begins with 12", r"<< 13", "<< 12"),
    ("xorshift goes on with 16", r">> 17", ">> 16"),
    ("xorshift ends with 6", r"<< 5\b", "<< 6"),
    ("the highest random number is left out", r"(high - low\)) \+ 1", r"\1 + 0"),
    ("there is one random number too many", r"(high - low\)) \+ 1", r"\1 + 2"),
    ("no power is over 99", r"low, 100", "low, 99"),
    ("a power is up to 101", r"low, 100", "low, 101"),
    ("a move has a negative power", r"(kMotors \? -100 :) 0;", r"\1 -100;"),
    ("the lowest tone is 32", r"31, 20000", "32, 20000"),
    ("the lowest tone is 30", r"31, 20000", "30, 20000"),
    ("the highest tone is 20001", r"31, 20000", "31, 20001"),
    ("the highest tone is 19999", r"31, 20000", "31, 19999"),
    ("a time may be negative", r"\w+ < 0 \? 0 : (static_cast<uint32_t>\(\w+\))", r"\1"),
    ("a checksum is another one", r"0xedb88320", "0xedb88321"),
    ("a thousandth more is one", r"kOne = 1000", "kOne = 1001"),
)


def named_breaks(texts: dict[str, str]) -> Iterator[Break]:
    for name, pattern, instead in NAMED:
        found = [
            (file, place)
            for file, text in texts.items()
            for place in re.finditer(pattern, blanked(text))
        ]
        if len(found) != 1:
            where = f"{pattern} stands in {len(found)} places, not in one"
            raise Stale(f"breaks.py, NAMED, {name!r}: {where}")
        file, place = found[0]
        put = place.expand(instead)
        yield broken("arithmetic", name, file, texts, place.start(), place.end(), put)


def blanked(text: str) -> str:
    """Return the text with blanks for what does nothing: what is found there lies where it lay."""
    of_chips = r"#else  // a chip of 32 bits\n.*?\n#endif\n\n"  # this computer does not compile it
    nothing = rf"{of_chips}|//[^\n]*|/\*.*?\*/|\bstatic_assert\(.*?\);"
    return re.sub(nothing, lambda found: " " * len(found[0]), text, flags=re.S)
