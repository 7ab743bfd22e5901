"""Usage: what was found wrong, with the instruction around it, as a place that rows speak of.

What no reader reads is told by the rows of `suggestion_rows` that begin with its code. Here are
the classes of such a place, and the gaps of those rows. Knows no row.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import accumulate, dropwhile, pairwise, takewhile
from typing import NamedTuple

from tiniscript.base.fixed_point import ONE, as_text
from tiniscript.base.kit import Kit
from tiniscript.base.source import Edit, Source, Span
from tiniscript.base.spelling import nearest
from tiniscript.base.words import (
    ALIASES,
    BLOCK_ENDS,
    CONDITION,
    EXTENTS,
    MOVES,
    POWER,
    UNIT_OF,
    VERSION_OF_WORD,
    WORDS,
    Argument,
    Word,
    foreign_word_hints,
)
from tiniscript.diagnostics import codes
from tiniscript.diagnostics.codes import Diagnostic, Repair
from tiniscript.recovery import lines
from tiniscript.recovery.amounts import with_number
from tiniscript.recovery.calls import likely_word, own_example, usage_with
from tiniscript.recovery.ends import places_text, possible_places
from tiniscript.recovery.meanings import (
    ASKING_WORDS,
    INSTRUCTION_WORDS,
    LONG_TIME_S,
    MOST_POWER,
    Lexeme,
    Names,
    closed,
    lexemes,
    lexicon_concept,
    lexicon_meaning,
    made,
    plain,
    words_of,
)
from tiniscript.recovery.orders import Order, block, condition_in, made_up, orders, written
from tiniscript.recovery.suggestions import Gaps, NoGap, Row, holding
from tiniscript.recovery.trailing_tokens import label, set_in, width
from tiniscript.recovery.worded import worded
from tiniscript.recovery.writing import (
    instruction_at,
    laid_out,
    shortened,
    tokens_of,
    without_note,
)
from tiniscript.syntax.free_names import free_word_name
from tiniscript.syntax.lexer import NUMBER, QUOTES, WORD, Token, scan
from tiniscript.syntax.operators import COMPARISONS
from tiniscript.syntax.outline import Failure

_MEMBER_DOTS = re.compile(
    r"(?i)\b(?P<head>(?P<word>IF|LOOP|WHILE)[ \t]*\([^()\n]*\)"
    r"|DEF[ \t]+(?P<name>\w+)(?:[ \t]*\([^()\n]*\))?)[\s;]*"
    r"(?P<here>(?:\.[ \t]*){2,}|\u2026)[ \t]*\n?[ \t]*(?P<end>END_?\w+|ELSE\w*)?"
)
_UNTIL_BLOCK = re.compile(
    r"(?i)(?P<here>UNTIL)\s*(?P<asked>\([^()\n;]+\))[\s;]*(?P<word>[FBLR])\s*\(\s*"
    rf"(?P<power>[0-9]+)\s*\)[\s;]*(?:{words_of('end')}[ _]?UNTIL\b)?"
)
_UNTIL_END = re.compile(rf"{words_of('end')}_?{words_of('until')}")
_PLAIN_NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
_WORDS_WITH_VALUES = (
    "F",
    "B",
    "M",
    "BEEP",
    "W",
)  # of values alone: which way first, then the others
_LOW_POWER = 20  # an example of a low power
_MOST_INSTRUCTIONS = 6  # instructions that an example takes into a block
_END_WORD = re.compile(rf"\b{words_of('end')}")
_BLOCK_WORD = re.compile(rf"(?i)(?:{'|'.join((*BLOCK_ENDS, 'END', 'ELSE'))})\b|END_")
_TOP_LEVEL_WORD = re.compile(r"(?i)\s*(?:TASK|DEF|WHEN)\b")
_WORD_CHARACTER = re.compile(r"\w")
_MEMBER_CALL = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)+(?=[ \t]*\()")
_CALL_WITH_VALUES = re.compile(r"([^\W\d]\w*)\s*\((?=\W{0,40}\w).*\)", re.DOTALL)
_MOST_HEADER_CHARACTERS = 100  # characters of a DEF before the name of a value
_DEF_AT_END = re.compile(r"(?i)\bDEF\s+(\w+[ \t]*\([^()\n]*)?$")
_OWN_WORD = re.compile(r"(\w{3,})\s*(\(\s*(\d{0,3})\s*\))?")
_ANGLE_AND_POWER = re.compile(r"\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)$")
_FOREVER_SECOND = re.compile(r"(?i)([FBLR])\s*\(([^(),]+),\s*FOREVER\s*\)(\s*UNTIL.*)?")
_TURNED_CALL = re.compile(r"(?im)\b[FBLR]\s*\(\s*([0-9.]+)\s*,\s*([0-9]+)\s*\)(?!\s*UNTIL)")
_MOST_CHARACTERS = 120  # characters of a sentence that a message shows
_MOST_DIAGNOSTICS = 30  # diagnostics of which more is said
_VALUE_CODES = (codes.MISSING_COMMA, codes.MISSING_CLOSE, codes.MISSING_VALUE)
_NAME_CODES = (codes.UNKNOWN_NAME, codes.USED_BEFORE_SET)
_DEF_END = re.compile(r"(?i)\bEND_?DEF\b")
_INSTRUCTION_STARTS = (";", "newline", "|")  # what an instruction begins behind
_DEF_ENDS = ("END_DEF", "ENDDEF")
_FARTHEST_CM = 400  # more is rather in milliseconds
_NOUN_OF_UNIT = {"s": "seconds", "%": "percent", "Hz": "hertz"}  # by the unit of a value
_MOST_END_WORDS = 4  # words: `fin del bucle`
_KINDS_NO_CALL = ("leaves", "again", "etc", "end")
_KINDS_AFTER_NUMBER = (
    "unit",
    "value",
    "number",
    "often",
    "times",
    "to",
    "at",
    "by",
)  # behind a number
_KINDS_NO_NAME = (*_KINDS_NO_CALL, "filler", "same")  # without values


def with_usage(diagnostics: Sequence[Diagnostic], source: Source, kit: Kit) -> list[Diagnostic]:
    """Return what is wrong with a text, in words that say how it is written."""
    text = _Text(source, kit)
    text.lacks_loop = [it.values["right"] for it in diagnostics if it.code is codes.NOT_OPEN] == [
        "LOOP"
    ]
    diagnostics = text.with_name(diagnostics)
    result: list[Diagnostic] = []
    for item in diagnostics[:_MOST_DIAGNOSTICS]:
        result.append(
            (_usage_diagnostic(Usage(text, item)) if item.repair is None else None) or item
        )
    parts = [it for it in result if it.values.get("part")]
    if parts and any(item.code is codes.TASK_NOT_TOP for item in result):  # rather an IF
        part = {"part": parts[0].values["part"]}
        result = [it._replace(values={**it.values, **part}) for it in result if it not in parts]
    if any("usage" in item.values for item in result if item.code is codes.OUT_OF_RANGE):
        result += text.turned()
    return [
        item
        for item in (*result, *diagnostics[_MOST_DIAGNOSTICS:])
        if not (item.code in _NAME_CODES and text.is_in_wrong_def(item, result))
    ]


class _Text:
    def __init__(self, source: Source, kit: Kit) -> None:
        self.source = source
        self.names = Names([*map(tokens_of, source.text.split("\n"))], kit)
        self.begun = "".join(re.findall(r"\A\s*(S[IB])\s*\|", source.text.upper()))
        self.lacks_loop = False  # an END_LOOP is left for a header

    @cached_property
    def is_ended(self) -> bool:
        """Whether any block has an end."""
        return _END_WORD.search(plain(self.source.text)) is not None

    def is_in_wrong_def(self, diagnostic: Diagnostic, diagnostics: Sequence[Diagnostic]) -> bool:
        """Whether a name is in the body of a DEF that names no values in its brackets."""
        starts = (it.span.end for it in diagnostics if it.code is codes.PARAMETER_NEEDS_NAME)
        start = max((it for it in starts if it <= diagnostic.span.start), default=-1)
        return start >= 0 and not _DEF_END.search(self.source.text, start, diagnostic.span.start)

    def turned(self) -> list[Diagnostic]:
        """Return moves with the power before the time, as another call of the text has them."""
        diagnostics: list[Diagnostic] = []
        for match in _TURNED_CALL.finditer(self.source.text):
            if LONG_TIME_S <= float(match[1]) <= MOST_POWER and 0 < float(match[2]) < LONG_TIME_S:
                fix = f"{match[0][0].upper()}({match[2]}, {match[1]})"
                values = {"time": match[1], "power": match[2], "fix": fix}
                diagnostics.append(Diagnostic(codes.SWAPPED, Span(*match.span()), values))
        return diagnostics

    def end_at(self, place: int) -> str:
        """Return the end of the innermost block that is open at a place, "" for none."""
        ends: list[str] = []
        for line in self.source.text[:place].split("\n"):
            for part in without_note(line)[0].split(";"):
                first = next((it.text for it in lexemes(part.rpartition("|")[2])), "")
                concept = {"FOREVER": "LOOP"}.get(self.names.meant(first), self.names.meant(first))
                if concept in BLOCK_ENDS:
                    ends.append(BLOCK_ENDS[concept])
                elif ends and (concept in BLOCK_ENDS.values() or lexicon_meaning(first, "end")):
                    ends.pop()
        return "".join(ends[-1:])

    def with_name(self, diagnostics: Sequence[Diagnostic]) -> Sequence[Diagnostic]:
        """Return diagnostics in which the one DEF without a name has that of an unknown call."""
        nameless = [
            diagnostic for diagnostic in diagnostics if diagnostic.code is codes.DEF_NEEDS_NAME
        ]
        unknown_calls = (
            diagnostic for diagnostic in diagnostics if diagnostic.code is codes.UNKNOWN_WORD
        )
        instructions = (
            (it, self.source[instruction_at(it.span, self.source)]) for it in unknown_calls
        )
        called = (
            it.values["found"] for it, instruction in instructions if len(lexemes(instruction)) == 1
        )
        name = next(called, "") if len(nameless) == 1 else ""
        if not name:
            return diagnostics
        nameless_diagnostic, end = nameless[0], nameless[0].span.end
        repair = Repair((Edit(Span(end, end), f" {name}"),), False)
        text = nameless_diagnostic._replace(values={"name": name}, repair=repair)
        return [
            text if diagnostic is nameless_diagnostic else diagnostic
            for diagnostic in diagnostics
            if diagnostic.values.get("found") != name
        ]


def _usage_diagnostic(place: Usage) -> Diagnostic | None:
    """Return what the first row that holds tells of a place, None where there is none."""
    return next((place.told(row, gaps) for row, gaps in holding(place)), None)


class Usage:
    """What was found wrong, and the instruction around its place.

    `row` are the tokens of the instruction; before them rows have what was found.
    """

    def __init__(self, text: _Text, diagnostic: Diagnostic) -> None:
        self.around = text
        self.source = text.source
        self.text = text.source.text
        self.names = text.names
        self.found = diagnostic
        self.piece = instruction_at(diagnostic.span, text.source)
        self.is_begun = self.text[: self.piece.start].strip().upper() == "SB|"
        self.is_first = diagnostic.span.start == self.piece.start
        self.behind_it = self.text[diagnostic.span.end :]
        self.row = lexemes(self.source[self.piece])
        self.words = [token.text for token in self.row if token.kind is WORD]
        self.signs = [token.text for token in self.row]
        self.number = next((it.text for it in self.row[1:] if it.kind is NUMBER), "1")
        self.gaps = GAP_FUNCTIONS
        ends = [*accumulate(map(width, self.row), initial=self.piece.start)][1:]
        spans = (
            Span(end - len(it.source or ""), end) for it, end in zip(self.row, ends, strict=True)
        )
        self.spans = [diagnostic.span, *spans]

    def matched(self, pattern: re.Pattern[str]) -> re.Match[str] | None:
        """Return the match of a pattern whose part `here` begins at the place."""
        result = pattern.finditer(self.text)
        return next((it for it in result if it.start("here") == self.found.span.start), None)

    # -- classes ----------------------------------------------------------------------------------

    def labels(self) -> list[str]:
        """Return the classes of what was found, and of each token, as patterns match them."""
        return [self._label_of_found(), *map(self._label_of, range(len(self.row)))]

    def _label_of_found(self) -> str:
        code, found_text = self.found.code, self.source[self.found.span]
        is_strange = code is codes.UNKNOWN_WORD and self.is_first and bool(self.row)
        is_strange = is_strange and not self.found.values.get("near")
        text = (*self.words, "_".join(self.words[:2]))  # `turn on the led`, `u turn`
        are_sentence = len(self.words) > 1 and len(self.source[self.piece]) <= _MOST_CHARACTERS
        labels: dict[str, object] = {
            code.number: True,
            "@bare": code is codes.MISSING_OPEN and self.is_first,
            f"@{code.number}_{found_text.upper()}": True,
            "@values": code in _VALUE_CODES,
            "@twice": code is codes.SETUP_TWICE,
        }
        if code is codes.ODD_CHARACTER:
            after = self.behind_it[:1]
            labels |= {
                "@upside": found_text in "\u00a1\u00bf" and len(self.words) > 1,
                "@negating": found_text == "!" and after not in ("", "\n", " "),
                "@brace": found_text in ("{", "}"),
                "@quoted": found_text in QUOTES,
            }
        if code is codes.RESERVED:
            labels["@clocked"] = bool(self.other_name.is_set) and self.other_name.word == "TIME"
        if is_strange:
            labels |= {
                "@strange": True,
                "@pressed": self._is_pressed(),
                "@instead": foreign_word_hints(self.signs[0]),
                "@switched": any(lexicon_meaning(each, "on", "off") for each in text),
                "@button": any(map(self.is_button, self.words)) and self.signs[1:2] != ["("],
                "@turned": any(lexicon_meaning(each, "turn", "lap") for each in self.words),
                "@sentence": are_sentence and not {*self.signs} & {*COMPARISONS, "(", "="},
            }
        return label("\x01", labels)

    def _is_pressed(self) -> bool:
        """Whether parts of one word say that a button is pressed: `onButtonPressed(…)`."""
        word_parts = re.findall("[A-Z]?[a-z]+", self.source[self.piece].split("(")[0])
        return len(word_parts) > 1 and any(self.is_button(plain(item)) for item in word_parts)

    def _label_of(self, k: int) -> str:
        text, span = self.row[k].text, self.spans[k + 1]
        has_meaning = bool(self.names.meant(text) or lexicon_meaning(text, "turn", "end", "short"))
        labels = {
            "@quote": text in QUOTES,
            "@known": text in WORDS,
            "@loose": not k and not has_meaning,
            "@button": self.is_button(text),
            "@behind": span.start >= self.found.span.start,
        }
        return label(self.names.label(self.row[k])[:-2], labels)

    # -- where it is told -------------------------------------------------------------------------

    def told(self, row: Row, gaps: Gaps) -> Diagnostic:
        """Return what a row tells: of the place, or where its words say."""
        values, fix = gaps.filled, gaps.filled.get("fix", "")
        span = next(
            (_PLACE_FUNCTIONS[item](self) for item in row.conditions if item in _PLACE_FUNCTIONS),
            self.found.span,
        )
        code = row.code or self.found.code
        if row.code is None:
            values = {**self.found.values, **values}
        place = self.piece if {*row.conditions} & {"offered", "whole"} else None
        repair = Repair((Edit(self.piece, fix),), False) if "offered" in row.conditions else None
        if "everywhere" in row.conditions:
            edits = (Edit(item, values["right"]) for item in self.renamed())
            repair = Repair(tuple(edits), False)
        diagnostic = Diagnostic(code, span, values, place, repair)
        if "again" not in row.conditions:
            return diagnostic
        return _usage_diagnostic(Usage(self.around, diagnostic)) or diagnostic

    def values(self) -> dict[str, str]:
        """Return what is said before the gaps of a row are filled."""
        return {}

    def several(self, name: str, gaps: Gaps) -> Mapping[str, str]:
        """Return values that come together."""
        result = _SEVERAL_FUNCTIONS[name](self, gaps.filled.get("word", ""))
        if not result:
            raise NoGap
        return result

    # -- what its words say -----------------------------------------------------------------------

    def usage(self, word: str) -> str:
        """Return how an instruction is written: a block with its end, where the text has none."""
        if word in ASKING_WORDS and (question := self.question(word)):
            return question
        if word in ("L", "R") and (angle := _ANGLE_AND_POWER.search(self.source[self.piece])):
            if float(angle[1]) >= LONG_TIME_S:  # `turnLeft(90, 70)`: no seconds
                return f"{word}({angle[1]} DEG, {angle[2]})"
        numbers = [token.text for token in self.row if token.kind is NUMBER]
        if (
            len(numbers) == 1
            and "(" not in self.signs
            and (usage_with_number := usage_with(word, numbers[0]))
        ):
            return usage_with_number
        if word == "SHOW" and (
            variables_used := [it for it in self.words if it in self.names.variables]
        ):
            return f"{word}({variables_used[0]})"
        is_ended = word in BLOCK_ENDS and self.around.is_ended
        if word not in BLOCK_ENDS or (is_ended and word != "LOOP"):
            return _usage(word)
        result = lines.read(self.row, self.names) if word == "LOOP" else []  # else a guess
        is_head = bool(result) and [item.kind for item in result[0].items or ()] == ["open"]
        head = laid_out(result[0].tokens).strip("; ") if is_head else _usage(word)
        return head if is_ended else f"{head}; ...; {BLOCK_ENDS[word]}"

    def question(self, word: str) -> str:
        """Return a header with the question that was written, without numbers that were not.

        Nothing where no number is asked for, and no yes or no.
        """
        asked = self.asked(word)
        if not any(item.kind is NUMBER or self.names.is_yes_no(item.text) for item in asked):
            return ""
        text = laid_out(condition_in(asked, self.names))
        return f"{word}({text})" if text else WORDS[word].usage

    def asked(self, word: str) -> list[Lexeme]:
        """Return what stands behind a header, up to what is done."""
        behind = [*dropwhile(lambda it: self.names.meant(it.text) != word, self.row)][1:]
        meant = [self.names.meant(item.text) for item in behind]
        begun = (
            it in INSTRUCTION_WORDS
            and (it not in ("L", "R") or after.text == "(")  # `pared a la derecha`
            for it, after in zip(meant, [*behind, made(";")][1:], strict=True)
        )
        over = [_is_over(item) or is_begun for item, is_begun in zip(behind, begun, strict=True)]
        return behind[: [*over, True].index(True)]

    def is_button(self, word: str) -> bool:
        return "BUTTON" not in self.names.sensors and lexicon_concept(word) == "BUTTON"

    @cached_property
    def ordered(self) -> dict[str, str]:
        """The words of no program that mean an order, and which."""
        meant = {word: self.names.meant(word) for word in self.words if word not in WORDS}
        return {
            it: order_word
            for it, order_word in meant.items()
            if order_word in WORDS and WORDS[order_word].role.is_instruction
        }

    @property
    def meant(self) -> str:
        """The first word that means an order; without brackets it is the one that lacks them."""
        is_bare = self.found.code is codes.MISSING_OPEN
        return self.found.values["word"] if is_bare else next(iter(self.ordered), "")

    @cached_property
    def orders(self) -> list[Order]:
        return orders(self.row, self.names) if self.meant else []

    def named(self, right: str, other: str) -> str:
        """Return the word that means another one, else `other`."""
        return next((it for it in self.signs if self.names.meant(it) == right != it), other)

    @cached_property
    def turn(self) -> _Turn:
        """A turn that says no way, or no number."""
        text = (*self.words, "_".join(self.words[:2]))
        way = next((it for it in map(self.names.meant, self.words) if it in ("L", "R")), "")
        degrees = {"half": "180", "whole": "360"}
        halves = (it for it in degrees if any(lexicon_meaning(each, it) for each in text))
        angle = degrees.get(next(halves, ""), "")
        is_timed = any(
            lexicon_meaning(each, "unit")[:1] not in ((), ("turns",)) for each in self.words
        )
        numbers = [token.text for token in self.row if token.kind is NUMBER]
        if len(numbers) == 1 and float(numbers[0]) >= LONG_TIME_S and not is_timed:
            angle = numbers[0]  # `SPIN 360`: no time, and no power
        turns = orders(self.row, self.names)
        values = laid_out(self.row[1:])
        is_call = all(float(number) <= MOST_POWER for number in numbers)
        if angle and not is_timed:
            return _Turn(way, angle, f"({angle} DEG, 60)")
        is_long = len(turns) == 1 and not any(it.endswith(" s") for it in turns[0].samples)
        if is_long and turns[0].is_side_free:
            return _Turn(way, "", turns[0].text[1:])
        if not way and is_call and lines.is_right(lexemes(f"L{values}"), self.names):
            return _Turn(way, "", values)  # `VOLTA(2, 80)`
        return _Turn(way, "", "")

    @cached_property
    def own(self) -> _Own:
        """A word of the program's own that nothing teaches."""
        piece = plain(self.source[self.piece])
        match = _OWN_WORD.fullmatch(piece)
        name, is_call, number = match.groups() if match else ("", "", "")
        numbers_given = re.findall(rf"(?i)\b{name}\s*\(\s*(\d+)\s*\)", self.text) if name else []
        if (
            not name or number or len({*numbers_given}) > 1
        ):  # seconds, or how often: who writes it knows
            call = _CALL_WITH_VALUES.fullmatch(piece)
            is_known_call = call is None or lexicon_meaning(call[1], *_KINDS_NO_CALL)
            is_often = bool(number and self.around.lacks_loop)
            return _Own("", "" if is_known_call or call is None else call[1], is_often, 0, False)
        if self.names.meant(name):
            return _Own("", "", False, 0, False)  # a function of another language
        lone = re.findall(rf"(?im)(?:^|[;|])[ \t]*{name}[ \t]*(?=;|\r?$)", self.text)
        is_taught = bool(
            is_call or len(lone) > 1 or self.names.defs or lexicon_meaning(name, "taught")
        )
        return _Own(name, "", False, len(lone), is_taught)

    def before(self) -> list[Lexeme]:
        """Return the tokens of the instruction before the place."""
        return lexemes(self.source[Span(self.piece.start, self.found.span.start)])

    def header(self) -> str:
        """Return the word before the brackets that the place is in, "" where none asks."""
        heads = [
            self.names.meant(it.text) for it, sign in pairwise(self.before()) if sign.text == "("
        ]
        return heads[-1] if heads and heads[-1] in ASKING_WORDS else ""

    @cached_property
    def amount(self) -> dict[str, str]:
        """Words that say how much, in the place of a number, and the call with numbers."""
        is_word = self.source[self.found.span][:1].isalnum()
        return with_number(self.text, self.found.span) if is_word else {}

    @cached_property
    def no_value(self) -> _NoValue | None:
        """A word behind a number, which is no value: a unit of something else, or nothing."""
        before = self.before()
        calls = [one.text for one, after in pairwise(before) if after.text == "("]
        found_text = self.source[self.found.span]
        word, found = WORDS.get("".join(calls[-1:])), plain(found_text)
        is_word = found.isidentifier() and found not in WORDS and not self.names.is_name(found)
        if word is None or not word.arguments or before[-1].kind is not NUMBER or not is_word:
            return None
        at = min(sum(item.text == "," for item in before), len(word.arguments) - 1)
        argument = word.arguments[at]
        unit = lexicon_meaning(found, "unit")
        way = UNIT_OF.get(word.text, "")
        is_of_way = bool(way) and unit == (EXTENTS[way].unit, "1000")
        text = f"{before[-1].text} {way}" if is_of_way else ""
        return (
            _NoValue(word, argument, before[-1].text, found_text, unit[0] if unit else "", text)
            if (argument.unit in _NOUN_OF_UNIT)
            else None
        )

    def button(self) -> dict[str, str]:
        """A button that nobody can ask for; a program may begin with the one that starts it."""
        asked = next((it.source for it in self.row if self.is_button(it.text)), "")
        begun = "SB|" if self.around.begun == "SB" else ""
        when = self.source[self.piece] if self.signs[:1] == ["WHEN"] and not begun else ""
        return {"begun": begun, "asked": asked or "BUTTON", "when": when}

    def one_number(self, word: str) -> dict[str, str]:
        """How far a move goes that has one number, which no robot drives so many seconds.

        `forward 50` is a way as in Logo, or a power; what is no power is a way.
        """
        items = [item for item in self.row[1:] if item.text not in ("(", ")")]
        if UNIT_OF.get(word) != "CM" or not items or items[0].kind is not NUMBER:
            return {}
        number, *rest = items
        is_more = bool(rest) and (
            rest[0].kind is not WORD or lexicon_meaning(rest[0].text, *_KINDS_AFTER_NUMBER)
        )
        if is_more or not LONG_TIME_S <= float(number.text) <= _FARTHEST_CM:
            return {}
        way = f"{word}({number.text} CM, {POWER.sample})"
        if float(number.text) > MOST_POWER:
            return {"fix": way, "usage": ""}
        return {"number": number.text, "way": way, "power": f"{word}(2, {number.text})"}

    def bound(self) -> dict[str, str]:
        """`F(2, MAX)`: the range of a value that stands for its end, and a call with numbers."""
        call = _CALL_WITH_VALUES.fullmatch(self.source[self.piece])
        word = WORDS.get(plain(call[1])) if call else None
        values = (
            [it.strip() for it in call[0][call.end(1) :].strip(" ()").split(",")] if call else []
        )
        end = self.found.values["word"]
        if word is None or len(values) != len(word.arguments) or end not in ("MAX", "MIN"):
            return {}
        positions = [k for k, value in enumerate(values) if plain(value) == end]
        if not positions or any(word.arguments[k].unit != POWER.unit for k in positions):
            return {}
        number = as_text(POWER.high) if end == "MAX" else str(_LOW_POWER)
        values_text = ", ".join(
            number if k in positions else value for k, value in enumerate(values)
        )
        low = as_text(word.arguments[positions[0]].low)
        values_said = {"low": low, "high": as_text(word.arguments[positions[0]].high)}
        return values_said | {"greatest" if end == "MAX" else "slow": f"{word.text}({values_text})"}

    def reading(self, word: str) -> str:
        """The sensor on the side of an L or R that stands for a value, and is no name."""
        is_other = self.behind_it.lstrip(" ").startswith("(") or word in set_in(self.text)
        return "" if is_other else self.names.on_side(word)

    def lamp(self, call: str) -> str:
        """What is said of the robot's lamp, "" where it has none."""
        return call if "LED" in self.names.actuators else ""

    def in_words(self, word: str) -> dict[str, str]:
        """A question in words without brackets: `IF BRIGHT THEN STOP`."""
        text = worded([made("THE"), *self.asked(word)], self.names) or {}  # one alone is asked
        return text if text.get("asked") or text.get("question") else {}

    def in_brackets(self, word: str) -> dict[str, str]:
        """A question in words in the brackets of a header: what they ask, else an example."""
        start = next(k for k, each in enumerate(self.row) if self.names.meant(each.text) == word)
        asked = self.row[start + 2 : closed(self.row, start + 1) - 1]
        sample = {"example": WORDS[word].arguments[0].sample, "question": ""}
        return worded(asked, self.names) or sample

    def dots(self) -> dict[str, str]:
        """Dots for what goes inside a block, as the poster has them."""
        match = self.matched(_MEMBER_DOTS)
        if match is None:
            return {}
        head, end = match["head"], (match["end"] or "").upper()
        right = BLOCK_ENDS[(match["word"] or "DEF").upper()]
        values = {"head": head, "right": right, "out": "" if end else match["here"].strip()}
        called = (match["name"] or "").upper()
        rest = self.text[match.end() :] if end == right else ""
        below = _row(rest) or (_before_blocks(rest, called) if called else [])
        calls = [item for item in below if _calls(item, called)]
        if inside := [item for item in below if item not in calls]:
            values["example"] = "; ".join((head, *inside, right, *calls))
        return values

    def unended(self) -> dict[str, str]:
        """Where a block ends that has no end: its indentation, or its line, says so."""
        rows = self.text.splitlines()
        k = self.source.position(self.found.span.start)[0] - 1
        first_line = without_note(self.behind_it[: len(rows[k])])[0]
        rest = [
            item.strip()
            for item in first_line.split("\n")[0].split(";")
            if _WORD_CHARACTER.search(item)
        ]
        lines_below = [n for n in range(k + 1, len(rows)) if rows[n].strip()]
        if rest and k + 1 == len(rows):
            block_text = self.source[Span(self.found.span.start, self.piece.end)]
            places = possible_places(tokens_of(f"{block_text};{first_line}"))
            return {"behind": rest[-1], "places": places_text(places)}
        if not lines_below:
            return {"head": self.source[self.found.span]}
        indentations = [len(row) - len(row.lstrip()) for row in rows]
        top = min(
            (n for n in lines_below if _TOP_LEVEL_WORD.match(rows[n])), default=0
        )  # which no block is around
        lines_inside = [
            *takewhile(lambda n: n < top if top else indentations[n] > indentations[k], lines_below)
        ]
        if not lines_inside:
            return {}
        return {
            "line": str(lines_inside[-1] + 1),
            "last": without_note(rows[lines_inside[-1]])[0].strip(" \t;"),
        }

    @cached_property
    def other_name(self) -> _OtherName:
        """Another name for a word of the language that stands for one."""
        word, text, start = self.found.values["word"], self.text, self.found.span.start
        is_set = re.match(r"\s*=\s*([1-9]?)", self.behind_it)
        is_taught = _DEF_AT_END.search(text[max(0, start - _MOST_HEADER_CHARACTERS) : start])
        right = free_word_name(text, word) if is_set or is_taught else ""
        suggestion = (nearest(word, self.names.variables - {word}) or "") if is_set else ""
        is_clock = bool(is_set and word == "TIME" and not is_set[1])
        is_everywhere = bool(right) and (word in VERSION_OF_WORD or not (suggestion or is_clock))
        return _OtherName(word, right, suggestion, is_taught is not None, is_set, is_everywhere)

    def renamed(self) -> list[Span]:
        """Return each place where a word is meant as a name: S of `F(S, 80)`, not S alone."""
        word, _, _, is_def, _, _ = self.other_name
        tokens = scan(self.text).tokens
        places = (
            range(len(tokens)) if word in VERSION_OF_WORD else _words_as_names(tokens, word, is_def)
        )
        return [
            tokens[k].span for k in places
            if tokens[k].text == word and (k == 0 or tokens[k - 1].kind not in (NUMBER, ")"))
        ]  # fmt: skip

    @property
    def function(self) -> str:
        return self.found.values["found"]

    @cached_property
    def letters(self) -> tuple[str, str]:
        """A name without the letters that a name has not, and what it means."""
        right = re.sub(r"^[^A-Za-z]+|\W", "", plain(self.source[self.found.span]))
        return right, self.names.meant(right)


class _Turn(NamedTuple):
    """A turn: `way` is L or R, "" where no word says it; `values` are those of its call."""

    way: str
    angle: str
    values: str


class _Own(NamedTuple):
    """A `name` that stands alone `times` times, or the name of a call with values, `taught`."""

    name: str
    taught: str
    is_often: bool
    times: int
    is_taught: bool


class _NoValue(NamedTuple):
    word: Word
    argument: Argument
    number: str
    found: str
    unit: str
    right: str


class _OtherName(NamedTuple):
    word: str
    right: str
    suggestion: str
    is_def: bool
    is_set: re.Match[str] | None
    is_everywhere: bool


def _words_as_names(tokens: Sequence[Token], word: str, is_def: bool) -> Iterator[int]:
    """Give the places where a word of the language is meant as the name of a DEF, or a variable.

    A DEF is called where its name stands alone, or with as many values as the DEF has and the word
    has not, but not in its own body.
    """
    depth = parameters = 0
    is_inside = is_value = False
    for k, (before, token, after) in enumerate(
        zip([None, *tokens], tokens, tokens[1:], strict=False)
    ):
        depth += (token.kind == "(") - (token.kind == ")")
        is_begun = before is None or (not depth and before.kind in _INSTRUCTION_STARTS)
        is_value = not is_begun and (is_value or (token.kind == "=" and not depth))
        is_inside = (is_inside or token.text == "DEF") and token.text not in _DEF_ENDS
        if token.text != word:
            continue
        if not is_def:
            is_set = is_begun and after.kind == "="
            if is_set or ((depth or is_value) and after.kind != "("):
                yield k
        elif before is not None and before.text == "DEF":
            parameters = max(0, _value_count(tokens, k + 1))
            yield k
        elif is_begun and not is_inside:
            count = _value_count(tokens, k + 1)
            has_own_values = count == parameters and count != (len(WORDS[word].arguments) or -1)
            if has_own_values or after.kind in (*_INSTRUCTION_STARTS, "end"):
                yield k


def _value_count(tokens: Sequence[Token], k: int) -> int:
    """Return how many values the brackets have that open there, -1 where none open."""
    depth = commas = 0
    for at in range(k, len(tokens)):
        depth += (tokens[at].kind == "(") - (tokens[at].kind == ")")
        commas += tokens[at].kind == "," and depth == 1
        if not depth:
            return -1 if at == k else commas + (at > k + 1)
    return -1


def _is_over(token: Lexeme) -> bool:
    """Whether a question ends before a token."""
    return token.text in (":", "{", ",") or bool(lexicon_meaning(token.text, "do"))


def _row(text: str) -> list[str]:
    """Return the instructions of a text, nothing where they are many, or a block is among them."""
    rows = (without_note(line)[0].split(";") for line in text.split("\n"))
    instructions = [item.strip() for row in rows for item in row if item.strip()]
    is_long = len(instructions) > _MOST_INSTRUCTIONS or any(map(_BLOCK_WORD.match, instructions))
    return [] if is_long else instructions


def _before_blocks(text: str, name: str) -> list[str]:
    """Return the instructions before the first block of a text, and before a call of a name."""
    rows = (without_note(line)[0].split(";") for line in text.split("\n"))
    result = (item.strip() for row in rows for item in row if item.strip())
    inside = [*takewhile(lambda it: not _BLOCK_WORD.match(it) and not _calls(it, name), result)]
    return inside if len(inside) <= _MOST_INSTRUCTIONS else []


def _calls(instruction: str, name: str) -> bool:
    return instruction.upper().partition("(")[0].strip() == name


def _usage(word: str) -> str:
    known = WORDS.get(ALIASES.get(word, word))
    is_asking = known is not None and [argument.name for argument in known.arguments] == [
        CONDITION.name
    ]
    return (known.example if is_asking else known.usage) if known else word


# -- gaps -----------------------------------------------------------------------------------------


def _intended_word(gaps: Gaps) -> str:
    """The word that means what is written in its place."""
    return _usage_at(gaps).named(_offered_word(gaps), _usage_at(gaps).meant)


def _offered_word(gaps: Gaps) -> str:
    """The word that what is offered begins with."""
    return re.split("[(;]", gaps.filled["fix"])[0]


def _block(gaps: Gaps) -> str:
    """The block that words say."""
    usage = _usage_at(gaps)
    below = usage.text[usage.piece.end :].lstrip("; \t\r\n").upper()
    is_open = bool(re.match(r"SI ?NO\b|ELSE", below))
    return block(usage.row, usage.names, is_open)


def _order(gaps: Gaps) -> str:
    """The one order that words say."""
    text = _usage_at(gaps).orders
    return text[0].text if len(text) == 1 and not text[0].is_side_free else ""


def _spoken_orders(gaps: Gaps, is_sided: bool) -> str:
    """The orders that words say; `is_sided`: of one nobody says which way it turns."""
    text = _usage_at(gaps).orders
    is_free = any(item.is_side_free for item in text)
    return written(text) if len(text) > 1 and is_free is is_sided else ""


def _other_orders(gaps: Gaps) -> set[str]:
    """Orders beside a turn, which it alone would lose."""
    text = _usage_at(gaps).ordered.items()
    return {order for word, order in text if not lexicon_meaning(word, "right")} - {
        "L",
        "R",
        "B",
        "S",
    }


def _forever_word(gaps: Gaps) -> str:
    """The word for FOREVER, where words say no order."""
    usage = _usage_at(gaps)
    endless = (word for word in usage.words if usage.names.meant(word) == "FOREVER")
    return "" if usage.meant else next(endless, "")


def _foreign_word(gaps: Gaps) -> str:
    """The word of another language that begins an instruction, or says one."""
    usage = _usage_at(gaps)
    return next(filter(usage.names.meant, (*usage.words[:1], usage.meant)), "")


def _concept(gaps: Gaps) -> str:
    """The word of the language that it means."""
    usage, word = _usage_at(gaps), _foreign_word(gaps)
    concept = usage.names.meant(word)
    is_order = concept in WORDS and WORDS[concept].role.begins and concept != "FOREVER"
    is_among = concept == "S" and {*usage.ordered.values()} != {"S"}  # `ve para adelante`
    return concept if is_order and concept != word and not is_among else ""


def _concept_alone(gaps: Gaps, is_numbered: bool) -> str:
    """The same of one without values, alone or with a number, which it would lose."""
    concept, row = _concept(gaps), _usage_at(gaps).row
    if not concept or WORDS[concept].arguments:
        return ""
    has_number = any(item.kind is NUMBER for item in row)
    return concept if (has_number if is_numbered else len(row) == 1) else ""


def _asking(word: str) -> str:
    return word if word in ASKING_WORDS else ""


def _variable(gaps: Gaps) -> str:
    usage = _usage_at(gaps)
    return next((word for word in usage.words if word in usage.names.variables), "")


def _own_example(gaps: Gaps) -> str:
    """The instruction with its unit where that goes, if that makes it right."""
    usage = _usage_at(gaps)
    example = own_example(usage.source[usage.piece])
    return example if lines.is_right(lexemes(example.split("; ")[-1]), usage.names) else ""


def _loop_of_repeated(gaps: Gaps) -> str:
    """The loop of a word that stands several times."""
    own = _usage_at(gaps).own
    return f"LOOP({own.times});{own.name};END_LOOP" if own.times > 1 else ""


def _own_name(gaps: Gaps) -> str:
    own = _usage_at(gaps).own
    return "" if own.is_taught or lexicon_meaning(own.name, *_KINDS_NO_NAME) else own.name


def _end(gaps: Gaps) -> str:
    """The end that words say, or that of the block which is open."""
    usage = _usage_at(gaps)
    named = (BLOCK_ENDS.get(usage.names.meant(word), "") for word in usage.words[1:])
    return next(named, "") or usage.around.end_at(usage.piece.start)


def _method_call(gaps: Gaps) -> str:
    """What a part of a thing does, if that is a call: WRITE of `servo.write`."""
    thing, _, done = plain(gaps.place.text[slice(*_member(_usage_at(gaps)))]).rpartition(".")
    right = "" if lexicon_meaning(thing, "device") else gaps.place.names.meant(done)
    return right if gaps.place.names.takes_values(right) else ""


def _member(usage: Usage) -> Span:
    match = _MEMBER_CALL.match(usage.text, usage.found.span.start)
    return Span(*match.span()) if match else Span(0, 0)


def _unit_behind(gaps: Gaps) -> str:
    """A unit behind a calculation: `F(RANDOM(1, 3) sec, 50)`."""
    usage = _usage_at(gaps)
    here = usage.source[usage.found.span]
    end = _end_of_value(usage)
    return here if lexicon_meaning(plain(here), "unit") and usage.text[end - 1] == ")" else ""


def _end_of_value(usage: Usage) -> int:
    return len(usage.text[: usage.found.span.start].rstrip())


def _without_seconds(gaps: Gaps) -> str:
    """The instruction without a word for seconds."""
    usage = _usage_at(gaps)
    span, piece, source = usage.found.span, usage.piece, usage.source
    if lexicon_meaning(plain(source[span]), "unit") != ("s", "1000"):
        return ""
    return source[Span(piece.start, _end_of_value(usage))] + source[Span(span.end, piece.end)]


def _missing_value(gaps: Gaps, is_unit: bool) -> _NoValue | None:
    result = _usage_at(gaps).no_value
    return result if result and bool(result.unit) is is_unit else None


def _number_said(gaps: Gaps) -> str:
    """A number with a unit that values have, or with that of a way."""
    text = _missing_value(gaps, is_unit=True)
    is_own = text is not None and (text.unit == text.argument.unit or bool(text.right))
    here = _usage_at(gaps).source[_usage_at(gaps).found.span]
    return f"{text.number} {here}" if text and is_own else ""


def _spoken_direction(gaps: Gaps) -> str:
    text = _missing_value(gaps, is_unit=True)
    return text.right if text and text.unit != text.argument.unit else ""


def _other_robots_word(gaps: Gaps) -> str:
    """A word with values that this robot does not have: whoever writes it wants the word."""
    usage = _usage_at(gaps)
    word = "".join(usage.words[:1])
    is_other = usage.names.meant(word) or usage.names.is_name(word)
    return "" if usage.signs[:2] != [word, "("] or is_other else word


def _in_words(gaps: Gaps) -> str:
    """The header with a question in words in its brackets."""
    usage = _usage_at(gaps)
    own = {*WORDS, *usage.names.known.values} - {"SI"}
    return "" if {*usage.words} <= own else usage.header()


def _worded_header(gaps: Gaps) -> str:
    """The header of a name that asks something in words: DARK of `X > 5 OR DARK`."""
    usage = _usage_at(gaps)
    name = plain(usage.source[usage.found.span])
    before = usage.before()  # in its line
    is_compared = bool(before) and before[-1].text in COMPARISONS
    return usage.header() if lexicon_meaning(name, "light", "ahead") and not is_compared else ""


def _endless_move(gaps: Gaps) -> str:
    """A move with FOREVER as its time, and an UNTIL."""
    usage = _usage_at(gaps)
    is_endless = usage.names.meant(plain(usage.source[usage.found.span])) == "FOREVER"
    if not is_endless or not usage.signs or usage.signs[0] not in MOVES:
        return ""
    start, end = (place - usage.piece.start for place in usage.found.span)
    text = usage.source[usage.piece]
    return f"{text[:start]}FOREVER{text[end:]} UNTIL({WORDS['UNTIL'].arguments[0].sample})"


def _swapped_forever(gaps: Gaps) -> str:
    """`F(50, FOREVER)`: FOREVER is a time, and goes first."""
    match = _FOREVER_SECOND.fullmatch(_usage_at(gaps).source[_usage_at(gaps).piece])
    if match is None:
        return ""
    until = match[3] or f" UNTIL({WORDS['UNTIL'].arguments[0].sample})"
    return f"{match[1].upper()}(FOREVER, {match[2].strip()}){until}"


def _until_with_move(gaps: Gaps) -> str:
    """An UNTIL with the move that it lacks."""
    usage = _usage_at(gaps)
    match = re.match(r"\s*(\([^()\n]+\))", usage.text[usage.found.span.start + 5 :])
    return f"F(2, 80) UNTIL{match[1]}" if match else ""


def _until_block(gaps: Gaps) -> str:
    """An UNTIL that is written as a block around one move, which has but its power."""
    match = _usage_at(gaps).matched(_UNTIL_BLOCK)
    return re.sub(r"\s*[;\n][\s;]*", "; ", match[0].strip("; \r\n")) if match else ""


def _until_endless(gaps: Gaps) -> str:
    match = _usage_at(gaps).matched(_UNTIL_BLOCK)
    move = f"{match['word'].upper()}(FOREVER, {match['power']})" if match else ""
    return f"{move} UNTIL{match['asked']}" if match else ""


def _until_end(gaps: Gaps) -> str:
    usage = _usage_at(gaps)
    return usage.signs[0] if len(usage.row) == 1 and _UNTIL_END.fullmatch(usage.signs[0]) else ""


def _started(gaps: Gaps) -> str:
    """The name of a TASK that stands alone elsewhere, as if it started there."""
    usage = _usage_at(gaps)
    name = usage.source[usage.found.span].upper()
    lone = rf"(?im)(?:^|[;|])[ \t]*{re.escape(name)}[ \t]*(?:\([ \t]*\))?[ \t]*(?=;|//|\r?$)"
    return name if name.isidentifier() and re.search(lone, usage.text) else ""


def _begun_behind(gaps: Gaps) -> str:
    """The beginning of a program that stands at its end: `F(2, 80)|SB`."""
    match = re.compile(r"(?i)\|\s*(S[IB])\s*\Z").match(
        _usage_at(gaps).text, _usage_at(gaps).found.span.start
    )
    return match[0].upper().strip() if match else ""


def _arm(gaps: Gaps) -> str:
    """`si no`, alone."""
    usage = _usage_at(gaps)
    arm = usage.names.meant("_".join(usage.words[:2]))
    return arm if arm == "ELSE" and len(usage.row) == 2 else ""


def _second_start(gaps: Gaps) -> str:
    """A beginning in the midst of a program, with its bar."""
    usage = _usage_at(gaps)
    is_bar = usage.behind_it.lstrip()[:1] == "|"
    return usage.source[usage.found.span].upper() + "|" * is_bar


def _question_begun(gaps: Gaps) -> str:
    """IF, where SI has no bar behind it."""
    return "IF" if _second_start(gaps) == "SI" else ""


def _saying_button(gaps: Gaps) -> str:
    """A word before the bar that says the button, or looks like it."""
    word = _usage_at(gaps).found.values["found"]
    return word if word == "S8" or lexicon_concept(word) == "BUTTON" else ""


def _part_of_when(gaps: Gaps) -> str:
    """An ELSE in a WHEN."""
    usage = _usage_at(gaps)
    before = usage.text[: usage.found.span.start]
    is_open = re.search(r"(?is)\bWHEN\b(?!.*\bEND_?WHEN\b)", before)
    return usage.found.values["found"] if is_open else ""


def _two_digits(gaps: Gaps) -> str:
    """A colon between digits, and these."""
    start, end = _usage_at(gaps).found.span
    around = _usage_at(gaps).text[max(0, start - 1) : end + 1]
    return around if re.fullmatch("[0-9]:[0-9]", around) else ""


def _quoted_span(usage: Usage) -> Span:
    """Return the place from a quotation mark to the next one of its line."""
    start, end = usage.found.span
    closed = re.compile(rf"[^\n]*?{usage.text[start:end]}").match(usage.text, end)
    return Span(start, closed.end() if closed else end)


def _dotted_span(usage: Usage) -> Span:
    match = usage.matched(_MEMBER_DOTS)
    return Span(*match.span("here")) if match else usage.found.span


def _rows_of_name(gaps: Gaps) -> list[str]:
    """The lines in which a word is meant as a name."""
    usage = _usage_at(gaps)
    return [str(usage.source.position(item.start)[0]) for item in usage.renamed()]


def _other_rows(gaps: Gaps) -> list[str]:
    return list(dict.fromkeys(_rows_of_name(gaps)))[1:]


def _later_rows(gaps: Gaps) -> list[str]:
    """The lines in which TIME stands behind the first place."""
    usage = _usage_at(gaps)
    places = [match.start() for match in re.finditer(r"(?i)\bTIME\b", usage.text)][1:]
    return [str(usage.source.position(place)[0]) for place in places]


def _single_line(lines: Sequence[str]) -> str:
    return lines[0] if len(lines) == 1 else ""


def _line_list(lines: Sequence[str]) -> str:
    return "" if len(lines) == 1 else ", ".join(lines)


def _times_in_line(gaps: Gaps) -> str:
    rows = _rows_of_name(gaps)
    return str(len(rows)) if len(rows) > 1 and not _other_rows(gaps) else ""


def _words_behind(gaps: Gaps) -> str:
    """What begins no instruction comes behind one: with a `;` between them it is as wrong."""
    usage = _usage_at(gaps)
    text = usage.source[_following_span(usage)]
    right = lines.right(lexemes(text), usage.names)
    return shortened(text) if isinstance(right, Failure) and right.at == 0 else ""


def _following_span(usage: Usage) -> Span:
    return Span(usage.found.span.start, usage.piece.end)


def _unaccented_name(gaps: Gaps) -> str:
    """A name in the letters that a name has, which the language knows."""
    right, concept = _usage_at(gaps).letters
    return right if concept in WORDS or _usage_at(gaps).names.has(concept) else ""


def _called_name(gaps: Gaps) -> str:
    usage = _usage_at(gaps)
    word = usage.source[usage.found.span].upper()
    is_call = usage.behind_it.lstrip(" ").startswith("(")
    is_taught = re.search(rf"(?i)\bDEF\s+{re.escape(word)}(?!\w)", usage.text)
    return word if is_call and not is_taught else ""  # a DEF's calls go by its name


def _lamp_here(gaps: Gaps) -> str:
    """A word for a lamp with an accent, where the kit has no lamp."""
    usage = _usage_at(gaps)
    has_lamp = "LED" in usage.names.actuators
    word = usage.source[usage.found.span].upper()
    return word if usage.is_first and not has_lamp and lexicon_concept(plain(word)) == "LED" else ""


def _lamp_set(gaps: Gaps) -> str:
    """The lamp that words switch on or off."""
    usage = _usage_at(gaps)
    words = (*usage.words, "_".join(usage.words[:2]))
    return usage.lamp(
        f"LED({'FALSE' if any(lexicon_meaning(it, 'off') for it in words) else 'TRUE'})"
    )


def _leading_filler(gaps: Gaps) -> str:
    """A word that says nothing, or the button, and begins an instruction."""
    usage, right = _usage_at(gaps), _usage_at(gaps).letters[0]
    is_said = lexicon_meaning(right, "filler") or usage.is_button(right)
    return right if usage.is_first and is_said else ""


def _may_be(argument: Argument, number: float) -> bool:
    is_long = argument.unit == "s" and number >= LONG_TIME_S
    return argument.low <= number * ONE <= argument.high and not is_long


def _taking(gaps: Gaps) -> list[str]:
    """The values in brackets that no word is before, behind each word that takes such ones."""
    usage = _usage_at(gaps)
    values = [it.strip() for it in usage.source[usage.piece].strip("() ").split(",")]
    if not all(_PLAIN_NUMBER.fullmatch(value) for value in values):
        return []
    words = (
        WORDS[word] for word in _WORDS_WITH_VALUES if len(WORDS[word].arguments) == len(values)
    )
    return [
        f"{word.text}({', '.join(values)})"
        for word in words
        if all(
            _may_be(argument, float(it))
            for argument, it in zip(word.arguments, values, strict=True)
        )
    ]


def _in_capitals(gaps: Gaps) -> str:
    usage, right = _usage_at(gaps), _usage_at(gaps).letters[0]
    return right if usage.source[usage.found.span].isupper() else right.capitalize()


def _amount_place(usage: Usage) -> Span:
    start = usage.text.index(usage.amount["amount"], usage.piece.start)
    return Span(start, start + len(usage.amount["amount"]))


def _usage_at(gaps: Gaps) -> Usage:
    assert isinstance(gaps.place, Usage)
    return gaps.place


def _gap_of(get: Callable[[Usage], str | None]) -> Callable[[Gaps], str]:
    return lambda gaps: get(_usage_at(gaps)) or ""


# Where a row tells what it says, but where it was found.
_PLACE_FUNCTIONS: dict[str, Callable[[Usage], Span]] = {
    "here": lambda it: it.piece, "behind": _following_span, "member": _member,
    "quoted": _quoted_span,
    "dots": _dotted_span,
    "first": lambda it: Span(it.piece.start, it.piece.start + len(it.words[0])),
    "amount": _amount_place,
}  # fmt: skip
# Values that come together, of a place and the word that is told of.
_SEVERAL_FUNCTIONS: dict[str, Callable[[Usage, str], Mapping[str, str]]] = {
    "amount": lambda it, _: it.amount, "bound": lambda it, _: it.bound(),
    "button": lambda it, _: it.button(),
    "dots": lambda it, _: it.dots(), "unended": lambda it, _: it.unended(),
    "instead": lambda it, _: foreign_word_hints(it.signs[0]), "in_words": Usage.in_words,
    "in_brackets": Usage.in_brackets, "one_number": Usage.one_number,
    "in_dark": lambda it, word: said if (said := it.in_brackets(word)).get("question") else {},
}  # fmt: skip
GAP_FUNCTIONS: dict[str, Callable[[Gaps], str]] = {
    "said": _gap_of(lambda it: it.source[it.piece]),
    "here": _gap_of(lambda it: it.source[it.found.span]),
    "first": _gap_of(lambda it: it.signs[0]), "sign": _gap_of(lambda it: it.signs[1]),
    "step": _gap_of(lambda it: it.signs[1][0]), "number": _gap_of(lambda it: it.number),
    "found": _gap_of(lambda it: it.found.values["found"]),
    "word": _gap_of(lambda it: it.found.values["word"]),
    "reading": _gap_of(lambda it: it.reading(it.found.values["word"])),
    "lamp": _gap_of(lambda it: it.lamp("LED")), "lamp_on": _gap_of(lambda it: it.lamp("LED(TRUE)")),
    "lamp_off": _gap_of(lambda it: it.lamp("LED(FALSE)")),
    "lamp_named": _gap_of(lambda it: it.lamp(it.source[it.piece])), "lamp_set": _lamp_set,
    "right": _offered_word, "named": _intended_word,
    "named_first": lambda gaps: _usage_at(gaps).named(_offered_word(gaps),
        _usage_at(gaps).signs[0]),
    "usage": lambda gaps: _usage(_offered_word(gaps)),
    "takes": lambda gaps: _usage(_offered_word(gaps)) if _usage_at(gaps).orders[0].samples else "",
    "block": _block, "order": _order, "sided": lambda gaps: _spoken_orders(gaps, is_sided=True),
    "several": lambda gaps: _spoken_orders(gaps, is_sided=False),
    "made_up": _gap_of(lambda it: made_up(it.orders)), "endless": _forever_word,
    "others": lambda gaps: ", ".join(_other_orders(gaps)),
    "way": _gap_of(lambda it: it.turn.way), "angle": _gap_of(lambda it: it.turn.angle),
    "side": _gap_of(lambda it: {"L": "left", "R": "right"}.get(it.turn.way)),
    "turned": _gap_of(lambda it: it.turn.values),
    "way_usage": _gap_of(lambda it: _usage(it.turn.way)),
    "word_said": _foreign_word, "concept": _concept, "asking": lambda gaps: _asking(_concept(gaps)),
    "concept_alone": lambda gaps: _concept_alone(gaps, is_numbered=False),
    "concept_numbered": lambda gaps: _concept_alone(gaps, is_numbered=True),
    "concept_usage": lambda gaps: _usage_at(gaps).usage(_concept(gaps)), "variable": _variable,
    "often_taught": _gap_of(lambda it: "LOOP" * it.own.is_often),
    "taught": _gap_of(lambda it: it.own.taught),
    "untaught": _gap_of(lambda it: it.own.name * it.own.is_taught), "often": _loop_of_repeated,
    "likely": _gap_of(lambda it: likely_word(it.signs[0], it.source[it.piece])),
    "plus": _gap_of(lambda it: "-" if f"-{it.number}" in "".join(it.signs) else "+"),
    "own_example": _own_example,
    "own": _own_name, "end": _end, "done": _method_call,
    "done_usage": lambda gaps: _usage_at(gaps).usage(_method_call(gaps)),
    "member": _gap_of(lambda it: it.text[slice(*_member(it))]),
    "bare_asking": _gap_of(lambda it: _asking(it.found.values["word"])),
    "bare_example": _gap_of(lambda it: WORDS[it.meant].example
                        if len(it.row) == 1 and it.meant in WORDS and WORDS[it.meant].arguments
                        else ""),
    "bare_usage": _gap_of(lambda it: it.usage(it.found.values["word"])),
    "first_usage": _gap_of(lambda it: it.usage(it.signs[0])),
    "unit": _unit_behind, "without_seconds": _without_seconds, "number_said": _number_said,
    "way_said": _spoken_direction,
    "value_name": lambda gaps: it.argument.name if (it := _missing_value(gaps, True)) else "",
    "wanted": lambda gaps: (
        _NOUN_OF_UNIT[it.argument.unit] if (it := _missing_value(gaps, True)) else ""
    ),
    "extra": lambda gaps: it.found if (it := _missing_value(gaps, False)) else "",
    "value_found": _gap_of(lambda it: it.no_value and it.no_value.found),
    "value_word": _gap_of(lambda it: it.no_value and it.no_value.word.text),
    "value_usage": _gap_of(lambda it: it.no_value and it.no_value.word.usage),
    "foreign": _other_robots_word, "in_words": _in_words, "in_dark": _worded_header,
    "amount": _gap_of(lambda it: it.amount.get("amount")),
    "until_block": _until_block, "until_endless": _until_endless, "until_end": _until_end,
    "started": _started, "button_behind": lambda gaps: "SB" * _begun_behind(gaps).endswith("SB"),
    "begun_behind": _begun_behind,
    "endless_move": _endless_move, "forever_first": _swapped_forever,
    "asked_behind": _until_with_move,
    "arm": _arm, "begun_again": _second_start, "question_begun": _question_begun,
    "twice": lambda gaps: _second_start(gaps) if _usage_at(gaps).around.begun == "SB" else "",
    "named_endless": lambda gaps: _usage_at(gaps).named("LOOP", _forever_word(gaps)),
    "instead": _gap_of(lambda it: it.around.begun), "saying_button": _saying_button,
    "part": _part_of_when, "two_digits": _two_digits,
    "sign_means": _gap_of(lambda it: lexicon_concept(it.source[it.found.span])),
    "sign_usage": _gap_of(lambda it: _usage(lexicon_concept(it.source[it.found.span]) or "")),
    "everywhere": _gap_of(lambda it: it.other_name.right if it.other_name.is_everywhere else ""),
    "since": _gap_of(lambda it: VERSION_OF_WORD.get(it.other_name.word)),
    "name_line": lambda gaps: "".join(_other_rows(gaps)[:1]),
    "name_lines": lambda gaps: _line_list(_other_rows(gaps)), "name_times": _times_in_line,
    "name_right": _gap_of(lambda it: it.other_name.suggestion or it.other_name.right),
    "time_right": _gap_of(lambda it: it.other_name.right
                      if it.other_name.is_set and it.other_name.is_set[1] else ""),
    "clock": _gap_of(lambda it: it.other_name.right
                 if it.other_name.is_set and not it.other_name.is_set[1] else ""),
    "time_line": lambda gaps: _single_line(_later_rows(gaps)),
    "time_lines": lambda gaps: _line_list(_later_rows(gaps)),
    "note": _gap_of(lambda it: "/*" if it.text.startswith("/*", it.found.span.start) else ""),
    "sensor": _gap_of(lambda it: it.function if it.function in it.names.sensors else ""),
    "input": _gap_of(lambda it: it.function if lexicon_meaning(it.function, "input") else ""),
    "words_behind": _words_behind, "before": _gap_of(lambda it: it.found.values["before"]),
    "plain_letters": _unaccented_name, "letters_mean": _gap_of(lambda it: it.letters[1]),
    "letters_usage": _gap_of(lambda it: it.usage(it.letters[1])), "called_here": _called_name,
    "taking_one": lambda gaps: "".join(_taking(gaps)[:1]),
    "taking_another": lambda gaps: "".join(_taking(gaps)[1:2]),
    "waiting": _gap_of(lambda it: "SB|" if it.around.begun == "SB" and it.is_begun else ""),
    "lamp_here": _lamp_here,
    "said_first": _leading_filler, "cased": _in_capitals,
}  # fmt: skip
